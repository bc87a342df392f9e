//! Times of day whose milliseconds have no leading zeros: `9:59:50.10` is 10 ms after the second, not
//! 100.

/// What the decimals of the times say.
#[derive(Debug, Default)]
pub(super) struct Milliseconds {
    /// One and as many zeros as each time has decimals.
    scales: Vec<f64>,
    /// Whether a time has decimals that end in a zero, as no decimals do that are shortened.
    ends_in_zero: bool,
    /// Whether one has other decimals than milliseconds without leading zeros.
    has_others: bool,
}

impl Milliseconds {
    /// Takes the cell of the next time.
    pub(super) fn take(&mut self, cell: &[u8]) {
        let Some(decimals) = decimals(cell).filter(|_| !self.has_others) else {
            self.has_others = true;
            return;
        };
        self.ends_in_zero |= decimals.len() > 1 && decimals.ends_with('0');
        self.scales.push(decimals.bytes().fold(1.0, |scale, _| 10.0 * scale));
    }

    /// Changes the `times` that were taken, where they all are milliseconds without leading zeros, some of three
    /// digits and others of fewer, as none are that are filled up; whether they are.
    pub(super) fn apply(&self, times: &mut [f64]) -> bool {
        let are_milliseconds = !self.has_others
            && self.ends_in_zero
            && self.scales.iter().any(|scale| *scale > 100.0)
            && self.scales.iter().any(|scale| *scale < 1000.0);
        for (time, scale) in times.iter_mut().zip(&self.scales).filter(|_| are_milliseconds) {
            *time = time.floor() + (time.fract() * scale).round() / 1000.0;
        }
        are_milliseconds
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

    fn changed(cells: &[&str]) -> Vec<f64> {
        let mut milliseconds = Milliseconds::default();
        for cell in cells {
            milliseconds.take(cell.as_bytes());
        }
        let decimals = cells.iter().map(|cell| cell.split_once('.').map_or("0", |(_, part)| part));
        let mut times: Vec<f64> =
            decimals.map(|decimals| format!("0.{decimals}").parse().unwrap()).collect();
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
        assert!(are(&changed(&cells), &[0.0, 0.01, 0.02, 0.11, 0.007]));
        // Shortened decimals, filled up milliseconds, and what is no time of day.
        assert!(are(&changed(&["1:00:00.1", "1:00:00.11", "1:00:00.2"]), &[0.1, 0.11, 0.2]));
        let padded = ["1:00:00.980", "1:00:00.990", "1:00:01.000", "1:00:01.010"];
        assert!(are(&changed(&padded), &[0.98, 0.99, 0.0, 0.01]));
        assert!(are(&changed(&["0.10", "0.2", "0.100"]), &[0.1, 0.2, 0.1]));
        assert!(are(&changed(&["1:00:00.10", "1:00:00.2", "1:00:00.050"]), &[0.1, 0.2, 0.05]));
    }
}
