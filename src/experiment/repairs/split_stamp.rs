//! Stamps in two columns, whole seconds and what they leave over, as those of ROS are.

use super::repair::Repair;
use crate::experiment::log::Log;

/// The column of whole seconds, that of the rest, and the unit of the rest in seconds.
pub(super) struct SplitStamp {
    whole: usize,
    rest: usize,
    unit_s: f64,
}

impl Repair for SplitStamp {
    fn detect(log: &Log<'_>) -> impl IntoIterator<Item = Self> {
        let columns = log.layout.time.column().zip(log.layout.time_rest);
        columns.map(|(whole, (rest, unit_s))| Self { whole, rest, unit_s })
    }

    /// Where the second column holds more than parts of a second, each says the time by itself.
    fn apply(self, log: &mut Log<'_>) -> Option<String> {
        let Self { whole, rest, unit_s } = self;
        let (seconds, parts) = (log.column(whole)?, log.column(rest)?);
        let is_part = |part: &f64| part.is_nan() || (0.0..1.0).contains(&(unit_s * part));
        let is_whole = |value: &f64| value.is_nan() || value.fract() == 0.0;
        let are_two = parts.values.iter().all(is_part) && seconds.values.iter().all(is_whole);
        if are_two {
            let parts = parts.values.clone();
            let seconds = &mut log.column_mut(whole)?.values;
            seconds.iter_mut().zip(parts).for_each(|(value, part)| *value += unit_s * part);
        }
        let (whole, rest) = (log.cell_of_header(whole), log.cell_of_header(rest));
        let and =
            if are_two { format!(" and `{rest}`") } else { format!("; `{rest}` is not used") };
        Some(log.named(&format!("the times are those in `{whole}`{and}")))
    }
}
