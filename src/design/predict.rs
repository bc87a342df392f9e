//! What a model says will happen, and how sure that is.

use super::free_run::FreeRunError;
use super::schedule::Schedule;
use super::trend::Travel;
use crate::effect::is_unlimited;
use crate::experiment::{Joint, Trial};
use crate::fit::{FitRecord, Horizon, Split};
use crate::model::{JointModel, Surroundings, simulate_input};
use crate::units::SamplePeriod;

/// The joint on which an input is to be played.
#[derive(Clone, Debug)]
pub struct TestRig {
    /// Its name.
    pub name: String,
    /// Unit of the input.
    pub input_unit: Option<String>,
    /// Unit of the output; degrees where it is not known.
    pub output_unit: Option<String>,
    /// Seconds between samples.
    pub period: SamplePeriod,
    /// The angle at which the input starts, output units.
    pub start: f64,
    /// Lowest and highest angle that it may come to, output units.
    pub range: Option<(f64, f64)>,
}

/// A model and how far each of its parameters may be off.
#[derive(Clone, Debug)]
pub struct Uncertain {
    /// The model.
    pub model: JointModel,
    /// Standard deviation of each parameter, in the order of [`JointModel::values`].
    pub deviations: Vec<f64>,
    /// Models that the record holds for as likely, where there is a record.
    pub draws: Vec<JointModel>,
    /// How far its predictions were off where it was not fitted, where that is known.
    pub free_run: Option<FreeRunError>,
}

/// The angle at each sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// What the model says, output units.
    pub output: Vec<f64>,
    /// How far it may be off, output units: two standard deviations of what models do that are
    /// as likely, or what predictions of this joint were off, whichever is more.
    pub margin: Vec<f64>,
}

/// Standard deviations within which an angle is held to stay: 95 %.
const DEVIATIONS: f64 = 2.0;

impl Uncertain {
    /// `model` with each parameter off by `share` of its value.
    pub fn by_share(model: JointModel, share: f64) -> Self {
        let off = |value: f64| if is_unlimited(value) { 0.0 } else { share * value.abs() };
        let deviations = model.values().iter().map(|value| off(value.value)).collect();
        Self { model, deviations, draws: Vec::new(), free_run: None }
    }

    /// The model with the parameter at `place` off by so many standard deviations.
    fn with_off(&self, place: usize, by: f64) -> JointModel {
        let value = values(&self.model).get(place).copied().unwrap_or_default();
        let deviation = self.deviations.get(place).copied().unwrap_or_default();
        with_value(&self.model, place, value + by * deviation)
    }
}

/// The values of all parameters of `model`.
pub(super) fn values(model: &JointModel) -> Vec<f64> {
    model.values().iter().map(|value| value.value).collect()
}

/// `model` with another value of the parameter at `place`.
pub(super) fn with_value(model: &JointModel, place: usize, value: f64) -> JointModel {
    let mut values = values(model);
    if let Some(slot) = values.get_mut(place) {
        *slot = value;
    }
    model.with_values(&values)
}

impl TestRig {
    /// What `model` does with `schedule`, output units at each sample.
    pub fn output(&self, model: &JointModel, schedule: &Schedule) -> Vec<f64> {
        let surroundings =
            Surroundings { radians_per_output_unit: self.radians(), ..Surroundings::default() };
        let period_s = self.period.seconds();
        simulate_input(model, &schedule.input(), period_s, self.start, &surroundings).output
    }

    /// The output with its margin: how far it may be off.
    ///
    /// That is what the models do that a record holds for as likely, and no less than predictions
    /// were off where the model was not fitted. Where there is no record, it is the deviations of
    /// all parameters, each by itself, added as independent ones are.
    pub fn prediction(&self, uncertain: &Uncertain, schedule: &Schedule) -> Prediction {
        /// Models that are looked at.
        const LIKELY: usize = 12;
        let output = self.output(&uncertain.model, schedule);
        let mut variance = vec![0.0; output.len()];
        let likely = uncertain.draws.len().min(LIKELY);
        let mut add = |model: &JointModel, weight: f64| {
            let moved = self.output(model, schedule);
            for (sum, (moved, output)) in variance.iter_mut().zip(moved.iter().zip(&output)) {
                *sum += weight * (moved - output).powi(2);
            }
        };
        for model in uncertain.draws.iter().take(likely) {
            // The mean square about the prediction.
            add(model, 1.0 / likely as f64);
        }
        let off = uncertain.deviations.iter().enumerate();
        for (place, _) in off.filter(|(_, off)| **off > 0.0 && likely == 0) {
            // Independent deviations: variances add up.
            add(&uncertain.with_off(place, 1.0), 1.0);
        }
        let mut margin: Vec<f64> =
            variance.iter().map(|variance| DEVIATIONS * variance.sqrt()).collect();
        if let Some(free_run) = &uncertain.free_run {
            let measured = measured_margin(free_run, &output, self.period.seconds());
            for (margin, measured) in margin.iter_mut().zip(measured) {
                *margin = margin.max(measured);
            }
        }
        Prediction { output, margin }
    }

    /// What is foreseen while an input is drawn, one level after the other: the
    /// [prediction](Self::prediction), of whose margin only the measured part is computed where
    /// there is one.
    pub(super) fn foreseen(&self, uncertain: &Uncertain, schedule: &Schedule) -> Prediction {
        let Some(free_run) = &uncertain.free_run else {
            return self.prediction(uncertain, schedule);
        };
        let output = self.output(&uncertain.model, schedule);
        let margin = measured_margin(free_run, &output, self.period.seconds());
        Prediction { output, margin }
    }

    /// The log of this joint, had it done `output`.
    pub(super) fn log(&self, schedule: &Schedule, output: Vec<f64>) -> Option<Joint> {
        let trial = Trial::new("1", 0.0, self.period, schedule.input(), output).ok()?;
        let (input_unit, output_unit) = (self.input_unit.clone(), self.output_unit.clone());
        Some(Joint { input_unit, output_unit, ..Joint::new(self.name.clone(), vec![trial]) })
    }

    /// Radians in one unit of the output, as a fit takes them.
    fn radians(&self) -> f64 {
        let output_unit = self.output_unit.clone();
        let joint = Joint { output_unit, ..Joint::new("", Vec::new()) };
        let record = FitRecord::new(&joint, Split::Time(1.0), Horizon::FreeRun);
        record.range(0.0).radians_per_output_unit
    }
}

/// How far the prediction `output` may be off at each sample, by predictions that were made.
fn measured_margin(free_run: &FreeRunError, output: &[f64], period_s: f64) -> Vec<f64> {
    let mut way = 0.0;
    let start = output.first().copied().unwrap_or(0.0);
    let mut before = start;
    let margin = |(sample, angle): (usize, &f64)| {
        way += (angle - before).abs();
        before = *angle;
        let (seconds, distance) = (sample as f64 * period_s, angle - start);
        free_run.margin(Travel { seconds, way, distance })
    };
    output.iter().enumerate().map(margin).collect()
}

impl Prediction {
    /// This one, and that of the trial after it.
    #[must_use]
    pub(super) fn followed_by(mut self, next: Self) -> Self {
        self.output.extend(next.output);
        self.margin.extend(next.margin);
        self
    }

    /// Lowest and highest angle with the margin.
    pub fn extent(&self) -> (f64, f64) {
        let both = self.output.iter().zip(&self.margin);
        let ends = both.map(|(angle, margin)| (angle - margin, angle + margin));
        let none = (f64::INFINITY, f64::NEG_INFINITY);
        ends.fold(none, |(low, high), (l, h)| (low.min(l), high.max(h)))
    }

    /// The largest margin.
    pub(crate) fn largest_margin(&self) -> f64 {
        self.margin.iter().copied().fold(0.0, f64::max)
    }

    /// How far the joint may go beyond `range` from sample `from` on.
    pub(super) fn excess(&self, (low, high): (f64, f64), from: usize) -> f64 {
        let both = self.output.iter().zip(&self.margin).skip(from);
        let beyond = both.map(|(angle, margin)| (low - angle + margin).max(angle + margin - high));
        beyond.fold(0.0, f64::max)
    }

    /// Samples until the joint may leave `range`; `None` where it does not.
    pub(crate) fn kept_until(&self, (low, high): (f64, f64)) -> Option<usize> {
        /// What rounding may add.
        const ROUNDING: f64 = 1e-9;
        let slack = ROUNDING * (high - low);
        let mut both = self.output.iter().zip(&self.margin);
        both.position(|(angle, margin)| {
            angle - margin < low - slack || angle + margin > high + slack
        })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::schedule::Hold;
    use super::*;
    use crate::effect::DeadBand;
    use crate::model::Component;

    pub(crate) fn rig(range: Option<(f64, f64)>) -> TestRig {
        TestRig {
            name: "boom".to_owned(),
            input_unit: Some("V".to_owned()),
            output_unit: Some("deg".to_owned()),
            period: SamplePeriod::from_seconds(0.01).unwrap(),
            start: 0.0,
            range,
        }
    }

    #[test]
    fn the_margin_is_what_each_parameter_adds() {
        let holds = vec![Hold { level: 0.0, samples: 10 }, Hold { level: 2.0, samples: 101 }];
        let schedule = Schedule::new(rig(None).period, holds);
        let band = vec![(-0.5).into(), 0.5.into()];
        let band = Component::new(&DeadBand, band).unwrap();
        let model = JointModel::integrator(10.0, 0.0).with(band);
        let uncertain = Uncertain::by_share(model, 0.1);
        let found = rig(None).prediction(&uncertain, &schedule);
        // After one second at 1.5 V beyond the band: 15 deg; a tenth of the gain is 1.5 deg,
        // a tenth of the upper end 0.5 deg.
        let last = found.output.len() - 1;
        assert!((found.output[last] - 15.0).abs() < 1e-9);
        let expected = 2.0 * 1.5_f64.hypot(0.5);
        assert!((found.margin[last] - expected).abs() < 1e-9, "{}", found.margin[last]);
        let (low, high) = found.extent();
        assert!(low.abs() < 1e-9 && (high - 15.0 - expected).abs() < 1e-9);
        assert_eq!(found.kept_until((-1.0, 20.0)), None);
        assert!(found.kept_until((-1.0, 16.0)).is_some_and(|sample| sample > 70));
        assert!((found.excess((-1.0, 16.0), 0) - (high - 16.0)).abs() < 1e-9);
    }

    #[test]
    fn a_limit_that_is_none_is_not_uncertain() {
        let model = JointModel::integrator(10.0, 0.1);
        let uncertain =
            Uncertain::by_share(model.with(Component::neutral(&crate::effect::EndStop)), 0.1);
        assert_eq!(&uncertain.deviations[2..], [0.0, 0.0]);
    }
}
