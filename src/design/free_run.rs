//! How far the predictions of a model are off on parts of a record that it was not fitted to.

use super::left_out::{LeftOut, Run};
use super::trend::{Travel, Trend};
use crate::experiment::Joint;
use crate::model::JointModel;

/// How much farther off a prediction may be than the farthest so far. A few parts of one record
/// stand for all that is to come: the farthest of five normal errors is 1.2 standard deviations
/// on average, and 2.6 are to be kept for a hundredth. Chosen; `examples/statistics/design_validation.rs`
/// shows the result.
pub const RESERVE: f64 = 2.0;

/// How much farther still where the log shows motions from stop to stop alone: no rest on the way,
/// and no turn. Chosen, as [`RESERVE`] is.
const UNSEEN: f64 = 1.5;

/// How many times as long as the longest run a prediction may be for which the margin stands. That
/// an error goes on in proportion is a guess, and farther out a wrong one: a load that changes along
/// the stroke shows in two minutes and not in ten seconds. Chosen, as [`RESERVE`] is.
const EXTRAPOLATED: f64 = 2.0;

/// How far free-running predictions were off on parts of a record that were left out of the fit,
/// by the time since their start, and by the way that the joint was to go.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeRunError {
    by_time: Growth,
    by_way: Growth,
    /// What is off each time in the same way, of motions from stop to stop.
    trend: Option<Trend>,
    /// Whether an error is forgotten: the output regulates itself.
    is_bounded: bool,
}

/// The largest error up to each place of an axis.
#[derive(Clone, Debug, PartialEq)]
struct Growth {
    /// Width of a bin on the axis.
    width: f64,
    /// The largest error up to the end of each bin; rises.
    largest: Vec<f64>,
}

impl FreeRunError {
    /// The errors of `model` on `joint`, its numbers fitted anew to what is left each time a part
    /// is left out: a fifth of the trials, or a fifth of the time of each where they are few.
    ///
    /// A stop removes the error that a run has made. So runs end where the joint comes to a
    /// stop, and go on where it leaves it with the error that they had; so do they from one trial
    /// to the next. Where motions from stop to stop are too few to show a trend, each is by
    /// itself, and what is off in it is off in proportion later. Of an output that regulates
    /// itself each run is by itself: it forgets its error.
    ///
    /// `None` where too little can be left out.
    pub fn of(joint: &Joint, model: &JointModel) -> Option<Self> {
        let left_out = LeftOut::of(joint, model)?;
        let LeftOut { has_stops, is_bounded, .. } = left_out;
        let trend = Trend::of(&left_out.motions()).filter(|_| !is_bounded && has_stops);
        let runs = left_out.runs(trend.as_ref());
        let seconds = |run: &Run, sample: usize| sample as f64 * run.period_s;
        let way = |run: &Run, sample: usize| run.way.get(sample).copied().unwrap_or(0.0);
        let (by_time, by_way) = (Growth::of(&runs, seconds), Growth::of(&runs, way));
        Some(Self { by_time, by_way, trend, is_bounded })
    }

    /// How far a prediction may be off when the joint is to have gone so far: the farthest that
    /// one was off so far, [`RESERVE`] times, by time or by way, or what is off each time in the
    /// same way, whichever is more; and half as much again of motions from stop to stop. Beyond
    /// the longest run it grows in proportion, which no error with increments of one kind exceeds.
    /// Of an output that regulates itself it is the same all the time.
    pub fn margin(&self, travel: Travel) -> f64 {
        if self.is_bounded {
            return RESERVE * self.largest();
        }
        let measured = self.by_time.at(travel.seconds).max(self.by_way.at(travel.way));
        match &self.trend {
            Some(trend) => self.reserve() * trend.at(travel).max(measured),
            None => self.reserve() * measured,
        }
    }

    /// How many times the errors so far a margin is.
    pub(crate) fn reserve(&self) -> f64 {
        if self.trend.is_some() { UNSEEN * RESERVE } else { RESERVE }
    }

    /// How long a prediction may be for which the margin stands, seconds: beyond the longest run it
    /// is an extrapolation.
    pub(crate) fn trusted_s(&self) -> f64 {
        if self.is_bounded { f64::INFINITY } else { EXTRAPOLATED * self.longest_s() }
    }

    /// Whether the error of a prediction does not grow with its length.
    pub(crate) fn is_bounded(&self) -> bool {
        self.is_bounded
    }

    /// Errors that grow by so much in a second.
    #[cfg(test)]
    pub(super) fn growing(per_second: f64) -> Self {
        let width = 0.1;
        let largest = (1..=100).map(|bin| per_second * width * f64::from(bin)).collect();
        let none = Growth { width: 1.0, largest: vec![0.0; 100] };
        Self { by_time: Growth { width, largest }, by_way: none, trend: None, is_bounded: false }
    }

    /// Seconds of the longest run.
    pub fn longest_s(&self) -> f64 {
        self.by_time.width * self.by_time.largest.len() as f64
    }

    /// The largest error of all runs, output units.
    pub fn largest(&self) -> f64 {
        self.by_time.largest.last().copied().unwrap_or(0.0)
    }
}

impl Growth {
    fn of(runs: &[Run], axis: impl Fn(&Run, usize) -> f64) -> Self {
        /// Bins of an axis.
        const BINS: usize = 100;
        let ends = runs.iter().map(|run| axis(run, run.error.len().saturating_sub(1)));
        let end = ends.fold(0.0, f64::max);
        let width = if end > 0.0 { end / BINS as f64 } else { 1.0 };
        let mut largest = vec![0.0; BINS];
        for run in runs {
            for (sample, error) in run.error.iter().enumerate() {
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "≥ 0")]
                let bin = ((axis(run, sample) / width) as usize).min(BINS - 1);
                if let Some(slot) = largest.get_mut(bin) {
                    *slot = error.abs().max(*slot);
                }
            }
        }
        let rise = |so_far: &mut f64, error: f64| {
            *so_far = so_far.max(error);
            Some(*so_far)
        };
        let largest = largest.into_iter().scan(0.0, rise).collect();
        Self { width, largest }
    }

    fn at(&self, place: f64) -> f64 {
        let end = self.width * self.largest.len() as f64;
        let last = self.largest.last().copied().unwrap_or(0.0);
        if place >= end {
            // In proportion: an error with increments of one kind grows no faster.
            return last * place / end;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "≥ 0")]
        let bin = (place / self.width).max(0.0) as usize;
        self.largest.get(bin).copied().unwrap_or(last)
    }
}

#[cfg(test)]
mod tests {
    use super::super::predict::tests::rig;
    use super::super::random::{RandomSteps, random_steps};
    use super::*;
    use crate::effect::{DirectionGain, Leakage};
    use crate::model::Component;

    /// A log of a joint that is a third slower in one direction.
    fn log(duration_s: f64) -> Joint {
        let levels = vec![-2.0, -1.0, 0.0, 1.0, 2.0];
        let steps = RandomSteps { levels, hold_s: (0.5, 1.5), duration_s, seed: 3 };
        let rig = rig(None);
        let schedule = random_steps(&steps, &rig, None, 0);
        rig.log(&schedule, rig.output(&slower(), &schedule)).unwrap()
    }

    fn after(seconds: f64) -> Travel {
        Travel { seconds, ..Travel::default() }
    }

    fn slower() -> JointModel {
        let effect = Component::new(&DirectionGain, vec![0.7.into()]).unwrap();
        JointModel::integrator(10.0, 0.15).with(effect)
    }

    #[test]
    fn a_model_that_is_right_is_hardly_off_and_one_that_lacks_an_effect_is() {
        let log = log(60.0);
        let right = FreeRunError::of(&log, &slower()).unwrap();
        let wrong = FreeRunError::of(&log, &JointModel::integrator(9.0, 0.15)).unwrap();
        assert!(right.largest() < 0.05, "{}", right.largest());
        assert!(wrong.largest() > 3.0, "{}", wrong.largest());
        assert!((right.longest_s() - 12.0).abs() < 0.1, "{}", right.longest_s());
    }

    #[test]
    fn margins_grow_with_time_and_way_and_in_proportion_beyond_the_longest_run() {
        let wrong = FreeRunError::of(&log(60.0), &JointModel::integrator(9.0, 0.15)).unwrap();
        let margins: Vec<f64> = (0..30).map(|k| wrong.margin(after(f64::from(k)))).collect();
        assert!(margins.windows(2).all(|pair| pair[0] <= pair[1]));
        let at = |seconds| wrong.margin(after(seconds));
        assert!((at(48.0) / at(24.0) - 2.0).abs() < 1e-9);
        assert!((at(12.1) - RESERVE * wrong.largest()).abs() < 0.02 * at(12.1));
        let far = Travel { way: 1e4, ..after(0.5) };
        assert!(wrong.margin(far) > at(0.5));
    }

    #[test]
    fn what_regulates_itself_is_no_farther_off_later() {
        let leakage = Component::new(&Leakage, vec![8.0.into(), 1.0.into()]).unwrap();
        let settling = JointModel::integrator(80.0, 0.1).with(leakage);
        let levels = vec![-2.0, -1.0, 0.0, 1.0, 2.0];
        let steps = RandomSteps { levels, hold_s: (0.5, 1.5), duration_s: 40.0, seed: 5 };
        let rig = rig(None);
        let schedule = random_steps(&steps, &rig, None, 0);
        let log = rig.log(&schedule, rig.output(&settling, &schedule)).unwrap();
        let found = FreeRunError::of(&log, &settling).unwrap();
        assert!(found.is_bounded());
        assert!((found.margin(after(500.0)) - found.margin(after(0.0))).abs() < 1e-12);
        assert!(!FreeRunError::of(&self::log(60.0), &slower()).unwrap().is_bounded());
    }

    #[test]
    fn a_record_of_which_nothing_can_be_left_out_shows_no_errors() {
        assert_eq!(FreeRunError::of(&log(0.8), &slower()), None);
    }
}
