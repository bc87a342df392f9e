//! The samples that belong to one decision.

use std::ops::Range;

/// Samples `first ..= last` of a trial, counted from 1; never empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// `r_i`: the first sample.
    pub first: usize,
    /// The last sample: `p_(i+1) + α`, clipped to the trial; for a joint that reacts within α, the one
    /// before `p_(i+1)`.
    pub last: usize,
}

impl Segment {
    /// Samples from `first` to `last`, clipped to a trial of `samples`.
    ///
    /// A segment that would end before it starts is its first sample alone.
    pub(super) fn clipped(first: usize, last: usize, samples: usize) -> Self {
        let first = first.clamp(1, samples.max(1));
        Self { first, last: last.clamp(first, samples.max(first)) }
    }

    /// Number of samples.
    #[expect(clippy::len_without_is_empty, reason = "a segment is never empty")]
    pub fn len(&self) -> usize {
        self.last + 1 - self.first
    }

    /// Its samples as indices of a slice, counted from 0.
    pub fn indices(&self) -> Range<usize> {
        self.first - 1..self.last
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_clipped_to_the_trial() {
        assert_eq!(Segment::clipped(0, 50, 40), Segment { first: 1, last: 40 });
        assert_eq!(Segment::clipped(45, 50, 40), Segment { first: 40, last: 40 });
    }
}
