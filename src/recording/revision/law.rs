//! The law that a model draws through the levels of the input: the speed, or the output, to which
//! each brings the joint.

use super::figure::Law;
use super::holds::{Shown, mean_hold_s};
use crate::experiment::{Joint, Trial};
use crate::fit::{FitRecord, Horizon, Split};
use crate::model::{Arrivals, JointModel, Restart, Surroundings, simulate};
use crate::recording::canvas::Span;
use crate::units::floor_to_index;
use crate::wording::measure;

/// Levels at which a law is computed.
const LEVELS: u32 = 120;

/// Whether two laws are so near that the difference is not seen.
pub(super) fn are_alike(law: &Law, other: &Law) -> bool {
    /// In parts of the range of both.
    const SEEN: f64 = 0.04;
    let range = Span::around(law.iter().chain(other).map(|point| point.1), 0.0);
    let seen = SEEN * (range.high - range.low);
    law.len() == other.len() && law.iter().zip(other).all(|(a, b)| (a.1 - b.1).abs() <= seen)
}

/// A joint that is kept in the middle of its record while its speed settles.
pub(super) struct Still {
    angle: f64,
    /// The largest output of the record.
    highest: f64,
    time_s: f64,
    period_s: f64,
    radians_per_output_unit: f64,
    input: Span,
    shown: Shown,
    /// How long a level is held, on average, seconds; none where none is.
    hold_s: Option<f64>,
}

impl Still {
    pub(super) fn of(joint: &Joint, shown: Shown) -> Self {
        let record = FitRecord::new(joint, Split::Time(1.0), Horizon::FreeRun);
        let range = record.range(1.0);
        let input = joint.trials.iter().flat_map(Trial::input).copied();
        Self {
            angle: f64::midpoint(range.output_min, range.output_max),
            highest: range.output_max,
            time_s: 0.5 * range.duration_s,
            period_s: range.sample_period_s,
            radians_per_output_unit: range.radians_per_output_unit,
            input: Span::around(input, 0.0),
            shown,
            hold_s: mean_hold_s(joint),
        }
    }

    pub(super) fn levels(&self) -> Vec<f64> {
        let Span { low, high } = self.input;
        (0..=LEVELS).map(|k| low + (high - low) * f64::from(k) / f64::from(LEVELS)).collect()
    }

    /// What `model` makes of levels that have long been held, or of a hold where an output is shown.
    pub(super) fn law(&self, model: &JointModel) -> Law {
        self.levels().into_iter().map(|level| (level, self.speed(model, level))).collect()
    }

    /// `revision 9`; where what `model` makes of a level depends on where the joint is, with
    /// the output of the law: `revision 9 (line: at -45 deg)`.
    pub(super) fn legend(&self, number: u32, model: &JointModel, joint: &Joint) -> String {
        let aside = Self { angle: self.angle + 0.5 * (self.highest - self.angle), ..*self };
        if are_alike(&self.law(model), &aside.law(model)) {
            return format!("revision {number}");
        }
        let output = measure(self.angle, joint.output_unit.as_deref());
        format!("revision {number} (line: at {output})")
    }

    fn speed(&self, model: &JointModel, level: f64) -> f64 {
        /// Seconds after which the memories of effects no longer change.
        const SETTLED_S: f64 = 2.0;
        /// Samples of a hold that is simulated.
        const LONGEST: f64 = 2000.0;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "in bounds")]
        let samples = match self.shown {
            Shown::Speed => (SETTLED_S / self.period_s).clamp(2.0, 400.0) as usize,
            Shown::Output => {
                let samples = self.hold_s.map_or(f64::INFINITY, |hold_s| hold_s / self.period_s);
                floor_to_index(samples.min(LONGEST)).max(2)
            }
        };
        let arrivals = Arrivals { initial: level, changes: Vec::new() };
        let back = |sample| Restart { sample, output: self.angle, speed: None };
        let restarts: Vec<Restart> = match self.shown {
            Shown::Speed => (0..samples).map(back).collect(),
            Shown::Output => vec![back(0)],
        };
        let surroundings = Surroundings {
            others: &[],
            radians_per_output_unit: self.radians_per_output_unit,
            start_s: self.time_s,
            ..Surroundings::default()
        };
        let simulated =
            simulate(model, &arrivals, samples, self.period_s, &restarts, &surroundings);
        let last = match self.shown {
            Shown::Speed => simulated.velocity.last(),
            Shown::Output => simulated.output.last(),
        };
        last.copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{DeadBand, PositionGain};
    use crate::model::Component;
    use crate::units::SamplePeriod;

    fn trial(input: Vec<f64>, output: Vec<f64>) -> Trial {
        Trial::new("", 0.0, SamplePeriod::from_seconds(0.1).unwrap(), input, output).unwrap()
    }

    fn joint() -> Joint {
        Joint {
            name: "boom".to_owned(),
            input_unit: None,
            output_unit: Some("deg".to_owned()),
            covariates: Vec::new(),
            trials: [trial(vec![-2.0, 2.0, 1.0], vec![0.0, 5.0, 3.0])].into(),
        }
    }

    #[test]
    fn the_law_of_a_dead_band_is_its_equation() {
        let band = Component::new(&DeadBand, vec![(-0.5).into(), 0.6.into()]).unwrap();
        let law =
            Still::of(&joint(), Shown::Speed).law(&JointModel::integrator(10.0, 0.2).with(band));
        for (level, speed) in law {
            let expected = 10.0 * ((level - 0.6).max(0.0) + (level + 0.5).min(0.0));
            assert!((speed - expected).abs() < 1e-9, "{level}: {speed}");
        }
    }

    #[test]
    fn a_law_says_where_it_is_only_if_it_depends_on_that() {
        let (still, plain) = (Still::of(&joint(), Shown::Speed), JointModel::integrator(10.0, 0.2));
        assert_eq!(still.legend(3, &plain, &joint()), "revision 3");
        let slower = Component::new(&PositionGain, vec![0.2.into(), 0.0.into(), 0.0.into()]);
        let bent = plain.with(slower.unwrap());
        assert_eq!(still.legend(4, &bent, &joint()), "revision 4 (line: at 2.5 deg)");
    }
}
