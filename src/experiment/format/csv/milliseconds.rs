//! Times of day whose milliseconds have no leading zeros: `9:59:50.10` is 10 ms behind the second, not
//! 100.

/// What the decimals of the times so far say, and what each time changes by if they are milliseconds.
pub(super) struct Milliseconds {
    /// Seconds to add to each time; none where the decimals are known to be decimals.
    changes: Option<Vec<f64>>,
    /// Whether a time has decimals that end in a zero, as no decimals do that are shortened.
    ends_in_zero: bool,
    /// Whether a time has three decimals, and another one fewer, as no milliseconds do that are filled up.
    has_three: bool,
    has_fewer: bool,
    /// Times that were changed.
    changed: usize,
}

impl Milliseconds {
    pub(super) fn new() -> Self {
        let changes = Some(Vec::new());
        Self { changes, ends_in_zero: false, has_three: false, has_fewer: false, changed: 0 }
    }

    /// Whether the times are kept a second time.
    pub(super) fn is_open(&self) -> bool {
        self.changes.is_some()
    }

    /// Takes the `cell` of the last of so many times.
    pub(super) fn take(&mut self, cell: &[u8], times: usize) {
        let Some(changes) = &mut self.changes else { return };
        let Some(decimals) = decimals(cell) else {
            // What was changed stays so.
            if self.changed == 0 {
                self.changes = None;
            } else {
                changes.resize(times, 0.0);
            }
            return;
        };
        self.has_three |= decimals.len() == 3;
        self.has_fewer |= decimals.len() < 3;
        self.ends_in_zero |= decimals.len() > 1 && decimals.ends_with('0');
        let of = |digits: i32| {
            let scale = 10_f64.powi(digits);
            decimals.parse::<f64>().map_or(0.0, |number| number / scale)
        };
        let shown = i32::try_from(decimals.len()).unwrap_or_default();
        changes.resize(times, of(3) - of(shown));
    }

    /// Changes the `times` that were taken, where they all are milliseconds without leading zeros;
    /// whether they are.
    pub(super) fn apply(&mut self, times: &mut [f64]) -> bool {
        let are_milliseconds = self.ends_in_zero && self.has_three && self.has_fewer;
        let Some(changes) = self.changes.as_ref().filter(|_| are_milliseconds) else {
            return false;
        };
        let new = times.iter_mut().zip(changes).skip(self.changed);
        new.for_each(|(time, change)| *time += change);
        self.changed = changes.len();
        true
    }
}

/// The decimals of a time of day, where they may be milliseconds without leading zeros: one digit to
/// three, of which the first is no zero unless it is the only one.
fn decimals(cell: &[u8]) -> Option<&str> {
    let text = std::str::from_utf8(cell).ok()?.trim_matches('"');
    let (clock, decimals) = text.rsplit_once(['.', ','])?;
    let is_number = !decimals.is_empty() && decimals.bytes().all(|byte| byte.is_ascii_digit());
    let has_zero = decimals.len() > 1 && decimals.starts_with('0');
    (clock.contains(':') && is_number && decimals.len() <= 3 && !has_zero).then_some(decimals)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changed(cells: &[&str], looks: &[usize]) -> Vec<f64> {
        let (mut milliseconds, mut times) = (Milliseconds::new(), Vec::new());
        for (index, cell) in cells.iter().enumerate() {
            let (_, decimals) = cell.split_once('.').unwrap_or((cell, "0"));
            times.push(format!("0.{decimals}").parse().unwrap());
            milliseconds.take(cell.as_bytes(), times.len());
            if looks.contains(&index) {
                milliseconds.apply(&mut times);
            }
        }
        milliseconds.apply(&mut times);
        times
    }

    fn are(found: &[f64], expected: &[f64]) -> bool {
        found.len() == expected.len()
            && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12)
    }

    #[test]
    fn milliseconds_without_leading_zeros_are_told_from_decimals() {
        let cells = ["1:00:00.0", "1:00:00.10", "1:00:00.20", "1:00:00.110", "1:00:00.7"];
        for looks in [&[][..], &[2], &[0, 1, 3]] {
            assert!(are(&changed(&cells, looks), &[0.0, 0.01, 0.02, 0.11, 0.007]));
        }
        // Shortened decimals, filled up milliseconds, and what is no time of day.
        assert!(are(&changed(&["1:00:00.1", "1:00:00.11", "1:00:00.2"], &[]), &[0.1, 0.11, 0.2]));
        let padded = ["1:00:00.980", "1:00:00.990", "1:00:01.000", "1:00:01.010"];
        assert!(are(&changed(&padded, &[1]), &[0.98, 0.99, 0.0, 0.01]));
        assert!(are(&changed(&["0.10", "0.2", "0.100"], &[]), &[0.1, 0.2, 0.1]));
        assert!(are(&changed(&["1:00:00.10", "1:00:00.2", "1:00:00.050"], &[]), &[0.1, 0.2, 0.05]));
    }
}
