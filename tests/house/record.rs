//! What a record is stands in one place each: who needs it asks the record, which finds it once.

use std::fs;

use super::layering::sources;

/// What finds a property of a record, and the files that may call it.
const FINDERS: [(&str, &[&str]); 6] = [
    ("::find(self)", &["experiment/record.rs"]),
    ("best_lag(", &["delay/first_order.rs"]),
    ("held_inputs(", &["delay/held_input.rs", "fit/mended.rs"]),
    ("Spikes::of(", &["fit/mended.rs"]),
    ("Follower::shown(", &["fit/first_order.rs"]),
    ("trial_starts(", &["fit/extent.rs"]),
];

/// The code of a file without its unit tests and comments.
fn code(text: &str) -> String {
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    code.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_property_of_a_record_is_found_in_one_place() {
    let mut seen = [0; FINDERS.len()];
    for path in sources("src".as_ref()) {
        let file = path.strip_prefix("src").unwrap().to_str().unwrap().to_owned();
        let code = code(&fs::read_to_string(&path).unwrap());
        for ((finder, allowed), seen) in FINDERS.iter().zip(&mut seen) {
            let calls = code.contains(finder);
            assert!(
                !calls || allowed.contains(&file.as_str()),
                "{file} calls `{finder}`: ask for the property of the record"
            );
            *seen += usize::from(calls);
        }
    }
    assert!(seen.iter().all(|files| *files > 0), "a finder is gone: {seen:?}");
}
