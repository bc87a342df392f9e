//! The smallest log that a test needs.

use std::fmt::Write as _;

/// The text of a log of one joint that steps and follows.
pub(crate) fn log_text() -> String {
    let mut text = "time_s,a.input,a.output\n".to_owned();
    let mut angle = 0.0;
    for k in 0..300_u32 {
        let level = |k: u32| f64::from((k / 60) % 2);
        angle += 0.1 * level(k.saturating_sub(15));
        writeln!(text, "{:.2},{},{angle:.3}", f64::from(k) * 0.01, level(k)).unwrap();
    }
    text
}
