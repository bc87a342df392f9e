//! What the words of a column's name say of it.

/// Words that name what drives a joint; the first ones are the likelier.
pub(super) const INPUT_WORDS: [&str; 26] = [
    "u",
    "cmd",
    "command",
    "input",
    "duty",
    "valve",
    "pwm",
    "joystick",
    "lever",
    "spool",
    "control",
    "in",
    "drive",
    "setpoint",
    "demand",
    "target",
    "desired",
    "reference",
    "ref",
    "current",
    "volt",
    "voltage",
    "stick",
    "servo",
    "throttle",
    "signal",
];
/// Words that name what a joint does.
pub(super) const OUTPUT_WORDS: [&str; 22] = [
    "y",
    "angle",
    "pos",
    "position",
    "output",
    "q",
    "phi",
    "theta",
    "stroke",
    "displacement",
    "encoder",
    "length",
    "extension",
    "travel",
    "out",
    "speed",
    "velocity",
    "vel",
    "rate",
    "level",
    "height",
    "meas",
];
/// Words of neither, whatever else the name says.
pub(super) const OTHER_WORDS: [&str; 31] = [
    "ref",
    "reference",
    "setpoint",
    "target",
    "desired",
    "sp",
    "pressure",
    "bar",
    "temp",
    "temperature",
    "error",
    "raw",
    "pilot",
    "torque",
    "force",
    "acc",
    "valid",
    "enable",
    "enabled",
    "flag",
    "status",
    "state",
    "limit",
    "min",
    "max",
    "std",
    "var",
    "seq",
    "count",
    "counter",
    "fault",
];
/// Words of what is wanted: a position that a name with one of them has is commanded, and not measured.
pub(super) const WANTED_WORDS: [&str; 4] = ["cmd", "command", "demand", "des"];

/// The words of a name in lower case: of `uBoom_duty (pct)` they are `u`, `boom`, `duty`, `pct`.
pub(super) fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut lower = false;
    for letter in name.chars() {
        let parts = !letter.is_alphanumeric() || lower && letter.is_uppercase();
        if parts && words.last().is_some_and(|word| !word.is_empty()) {
            words.push(String::new());
        }
        if let Some(word) = words.last_mut().filter(|_| letter.is_alphanumeric()) {
            word.extend(letter.to_lowercase());
        }
        lower = letter.is_lowercase();
    }
    words.retain(|word| !word.is_empty());
    words
}

/// The place in `known` of the likeliest of `words`.
pub(super) fn rank(words: &[String], known: &[&str]) -> Option<usize> {
    words.iter().filter_map(|word| known.iter().position(|known| known == word)).min()
}
