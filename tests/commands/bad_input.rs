//! Bad input: what the program says, how it exits and what it leaves behind.

mod beside_good;
mod content;
mod outputs;
mod settings;
mod workspace;

use workspace::{Workspace, boom};

#[test]
fn the_log_of_these_tests_is_good() {
    let outcome = Workspace::new().with_log(&boom()).estimate("log.csv --format json");
    outcome.is_whole();
    assert_eq!(outcome.joints()[0]["accepted"], 3, "{}", outcome.stdout);
    assert_eq!(outcome.stderr, "");
}
