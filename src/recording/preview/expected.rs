//! The input of a joint and what is expected of it, as it is recorded.

use crate::design::{Apart, Prediction, apart};
use crate::recording::chunk::Index;
use crate::recording::palette::{self, Rgb};
use crate::report::DesignedJoint;

/// What is expected of an input: of the model, or where one of the suspects is there.
pub(super) struct Expectation<'a> {
    /// The id of the suspect, or `model`.
    pub(super) name: &'a str,
    pub(super) prediction: &'a Prediction,
    pub(super) rgb: Rgb,
}

/// The input of a joint, as it is recorded.
pub(super) struct Preview<'a> {
    pub(super) joint: &'a DesignedJoint,
    pub(super) expected: Vec<Expectation<'a>>,
    /// Where two suspects differ.
    pub(super) apart: Option<Apart>,
}

impl<'a> Preview<'a> {
    pub(super) fn of(joint: &'a DesignedJoint) -> Self {
        let expected = joint.expected().into_iter().zip(palette::models());
        let expected =
            expected.map(|((name, prediction), rgb)| Expectation { name, prediction, rgb });
        let expected: Vec<_> = expected.collect();
        let noise = joint.discrimination.as_ref().map(|found| found.noise);
        let apart = match (expected.as_slice(), noise) {
            ([one, other], Some(noise)) => {
                let [one, other] = [one, other].map(|expected| &expected.prediction.output);
                Some(apart(&joint.schedule, one, other, noise))
            }
            _ => None,
        };
        Self { joint, expected, apart }
    }

    /// Seconds from the start to a sample, from 0.
    pub(super) fn seconds(&self, sample: usize) -> f64 {
        sample as f64 * self.joint.schedule.period().seconds()
    }

    /// Where a sample, from 0, lies on `sample` and `time`.
    fn place(&self, sample: usize) -> (i64, i64) {
        /// Nanoseconds in a second.
        const NANO: f64 = 1e9;
        #[expect(clippy::cast_possible_truncation, reason = "three centuries fit")]
        let time_ns = (NANO * self.seconds(sample)).round() as i64;
        (i64::try_from(sample).unwrap_or(i64::MAX).saturating_add(1), time_ns)
    }

    /// A row for each of the first `samples`.
    pub(super) fn samples(&self, samples: usize) -> Index {
        self.index(0..samples)
    }

    fn index(&self, samples: impl Iterator<Item = usize>) -> Index {
        let (samples, times): (Vec<_>, Vec<_>) = samples.map(|k| self.place(k)).unzip();
        Index::on("sample", samples).with("time", times)
    }

    /// The first sample of each hold, from 0, and the one behind its last.
    pub(super) fn holds(&self) -> Vec<(usize, usize)> {
        let start = |next: &mut usize, samples: usize| {
            let start = *next;
            *next += samples;
            Some((start, *next))
        };
        let holds = self.joint.schedule.holds().iter().map(|hold| hold.samples);
        holds.scan(0, start).collect()
    }

    /// A row for each hold, where it begins.
    pub(super) fn hold_rows(&self) -> Index {
        let holds = self.holds();
        let index = self.index(holds.iter().map(|(start, _)| *start));
        index.with("segment", (1..).take(holds.len()))
    }
}
