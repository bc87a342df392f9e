//! A column of what runs evenly: times, indices of trials, lengths of holds.

/// A value for each sample, held as the parts over which it runs evenly.
///
/// Part `j` begins at sample `b_j` and is `v_j + (k − b_j) s_j` at sample `k`, so that a column of
/// times is no longer than the trials are many, and one of holds than the steps. Two are equal that
/// have the same parts.
///
/// ```
/// use tauscope::diagnosis::failure::EvenColumn;
///
/// let mut column = EvenColumn::from(vec![0.0, 0.5, 1.0]);
/// column.push_even(7.0, 0.0, 1000);
/// assert_eq!((column.len(), column.get(2), column.get(500)), (1003, Some(1.0), Some(7.0)));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EvenColumn {
    parts: Vec<Part>,
    /// The part of the first sample of each block of [`BLOCK`].
    of_block: Vec<usize>,
    samples: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Part {
    start: usize,
    first: f64,
    slope: f64,
}

/// Samples among whose parts one is searched for: few enough that a search takes no time.
const BLOCK: usize = 256;

impl Part {
    fn at(&self, sample: usize) -> f64 {
        self.first + (sample - self.start) as f64 * self.slope
    }
}

impl EvenColumn {
    /// Appends `samples` values `first + k · slope`, k = 0, 1, …
    pub fn push_even(&mut self, first: f64, slope: f64, samples: usize) {
        if samples == 0 {
            return;
        }
        let part = self.parts.len();
        self.parts.push(Part { start: self.samples, first, slope });
        self.samples += samples;
        // Blocks that begin before it are known, or begin with it.
        self.of_block.resize(self.samples.div_ceil(BLOCK), part);
    }

    /// The value at a sample.
    pub fn get(&self, sample: usize) -> Option<f64> {
        if sample >= self.samples {
            return None;
        }
        let block = sample / BLOCK;
        let first = *self.of_block.get(block)?;
        let last = self.of_block.get(block + 1).copied().unwrap_or(self.parts.len() - 1);
        let parts = self.parts.get(first..=last)?;
        let behind = parts.partition_point(|part| part.start <= sample);
        parts.get(behind.checked_sub(1)?).map(|part| part.at(sample))
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.samples
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.samples == 0
    }
}

impl From<Vec<f64>> for EvenColumn {
    /// Equal values in a row become one part; others stay as they are.
    fn from(values: Vec<f64>) -> Self {
        let mut column = Self::default();
        for run in values.chunk_by(|a, b| a.to_bits() == b.to_bits()) {
            column.push_even(run.first().copied().unwrap_or_default(), 0.0, run.len());
        }
        column
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn what_is_not_a_number_stays_so() {
        let column = EvenColumn::from(vec![f64::NAN, f64::NAN, 1.0]);
        assert_eq!(column.parts.len(), 2);
        assert!(column.get(1).is_some_and(f64::is_nan));
        assert_eq!((column.get(2), column.get(3)), (Some(1.0), None));
    }

    proptest! {
        #[test]
        fn it_holds_what_was_put_in(
            parts in prop::collection::vec((-1e3..1e3, -1.0..1.0, 0..700_usize), 0..40),
        ) {
            let mut column = EvenColumn::default();
            let mut values = Vec::new();
            for (first, slope, samples) in parts {
                column.push_even(first, slope, samples);
                values.extend((0..samples).map(|k| first + k as f64 * slope));
            }
            prop_assert_eq!(column.len(), values.len());
            let got = (0..=values.len()).filter_map(|sample| column.get(sample));
            prop_assert!(got.eq(values.iter().copied()));
        }
    }
}
