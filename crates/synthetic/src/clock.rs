//! Samples and the finer time steps between them.

/// Fewest time steps in a lag: the error of one step is then below 1e-5.
pub(crate) const MIN_STEPS_PER_LAG: f64 = 4.0;

/// Fewest time steps in a period of ringing: the error of one step is below 1e-6.
pub(crate) const MIN_STEPS_PER_PERIOD: f64 = 40.0;

/// The times of a record.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clock {
    /// Seconds between samples.
    pub(crate) period_s: f64,
    /// Samples in the record.
    pub(crate) samples: usize,
    /// Time steps from one sample to the next.
    pub(crate) substeps: u32,
}

impl Clock {
    /// Length of one time step in seconds.
    pub(crate) fn substep_s(&self) -> f64 {
        self.period_s / f64::from(self.substeps)
    }

    /// Time of the sample with the 1-based number `sample`, in seconds.
    pub(crate) fn time_s(&self, sample: usize) -> f64 {
        (sample as f64 - 1.0) * self.period_s
    }

    /// Ends of the time steps between `sample` and the next one, in seconds.
    pub(crate) fn substep_ends(&self, sample: usize) -> impl Iterator<Item = f64> + use<> {
        let (start, parts, period_s) = (sample as f64 - 1.0, self.substeps, self.period_s);
        (1..=parts).map(move |j| (start + f64::from(j) / f64::from(parts)) * period_s)
    }

    /// Time of the sample `sample` as a fraction of the record's length.
    pub(crate) fn progress(&self, sample: usize) -> f64 {
        (sample as f64 - 1.0) / (self.samples as f64 - 1.0).max(1.0)
    }

    /// Whole samples nearest to `seconds`.
    pub(crate) fn samples_in(&self, seconds: f64) -> usize {
        whole(seconds / self.period_s)
    }
}

/// The whole number nearest to `count`; 0 for a negative one.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the cast saturates, and what is out of reach of a record may be cut"
)]
pub(crate) fn whole(count: f64) -> usize {
    count.round() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_time_step_ends_at_the_next_sample() {
        let clock = Clock { period_s: 0.01, samples: 100, substeps: 20 };
        let ends: Vec<f64> = clock.substep_ends(7).collect();
        assert_eq!(ends.len(), 20);
        assert!((ends[0] - 0.0605).abs() < 1e-12);
        assert!((ends[19] - clock.time_s(8)).abs() < 1e-12);
    }

    #[test]
    fn counts_what_is_out_of_reach_as_very_many_or_none() {
        assert_eq!([whole(1e300), whole(-3.0), whole(2.5)], [usize::MAX, 0, 3]);
    }
}
