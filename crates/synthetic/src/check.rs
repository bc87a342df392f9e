//! What a plant file may say: the numbers of the plant and of each joint.

use std::collections::HashSet;
use std::fmt::Debug;

use crate::clock::{Clock, whole};
use crate::delay_law::DelayLaw;
use crate::error::{
    BELOW_ONE, BETWEEN_ONES, EDGE, FINITE, LASTS_A_LAG, LASTS_A_PERIOD, NOT_NEGATIVE, NOT_ZERO,
    POSITIVE, Place, PlantError, SHARE,
};
use crate::input::InputSpec;
use crate::spec::{JointSpec, PlantSpec, SCHEMA, default};

/// Samples of all joints together: 14 hours of a joint at 100 Hz. Keeps a slip of
/// the pen from filling the memory.
const MAX_SAMPLES: f64 = 5e7;

/// Shortest sample period in seconds: a log has the time to a nanosecond.
const MIN_SAMPLE_PERIOD_S: f64 = 1e-6;

/// Most time steps per sample.
const MAX_SUBSTEPS: u32 = 1000;

/// Time steps of all joints together: minutes of work, not days of it.
const MAX_TIME_STEPS: f64 = 2e9;

/// Steps of the inputs of all joints together, each of which has a row of the truth: a
/// gigabyte of them.
const MAX_INPUT_STEPS: f64 = 5e6;

impl PlantSpec {
    /// Refuses a plant that cannot be simulated.
    ///
    /// # Errors
    /// [`PlantError::Schema`] for another schema, [`PlantError::Value`] for the first
    /// value that is not allowed, [`PlantError::ListedDelays`] when steps are given
    /// and delays are listed, but not one for each.
    pub fn check(&self) -> Result<(), PlantError> {
        if self.schema != SCHEMA {
            return Err(PlantError::Schema { found: self.schema.clone() });
        }
        let clock = self.clock()?;
        let mut names = HashSet::new();
        let mut input_steps = 0.0;
        for joint in &self.joints {
            let place = Place::joint(&joint.name);
            let is_new = names.insert(joint.name.as_str());
            place.require(&[("name", &joint.name, is_new, "a name that no other joint has")])?;
            joint.check(&clock, &place)?;
            input_steps += joint.input.steps_in(&clock);
            let (hold_s, few) = (joint.input.mean_hold_s(&clock), input_steps <= MAX_INPUT_STEPS);
            let allowed = "so long that there are five million steps of all joints or fewer";
            place.require(&[("input.hold_s", &hold_s, few, allowed)])?;
        }
        Ok(())
    }

    /// The times of the record.
    pub(crate) fn clock(&self) -> Result<Clock, PlantError> {
        let Self { sample_period_s: period_s, duration_s, substeps, .. } = *self;
        let count = self.joints.len();
        let samples = (duration_s / period_s).round();
        let (of_all, steps) =
            (samples * count as f64, samples * count as f64 * f64::from(substeps));
        let apart = period_s.is_finite() && period_s >= MIN_SAMPLE_PERIOD_S;
        let short = samples >= 2.0 && of_all <= MAX_SAMPLES;
        let few = (1..=MAX_SUBSTEPS).contains(&substeps) && steps <= MAX_TIME_STEPS;
        let lengths = "two sample periods or more; fifty million samples of all joints or fewer";
        let parts = "1 to 1000; two thousand million time steps of all joints or fewer";
        Place::Plant.require(&[
            ("joint", &count, count > 0, "one table [[joint]] or more"),
            ("sample_period_s", &period_s, apart, "finite seconds, 1e-6 or more"),
            ("duration_s", &duration_s, short, lengths),
            ("substeps", &substeps, few, parts),
        ])?;
        Ok(Clock { period_s, samples: whole(samples), substeps })
    }
}

impl JointSpec {
    fn check(&self, clock: &Clock, place: &Place) -> Result<(), PlantError> {
        self.check_words(place)?;
        self.input.check(clock, place)?;
        self.delay.check(clock, place)?;
        self.check_list(place)?;
        self.check_numbers(clock, place)?;
        self.check_range(place)?;
        self.check_cylinder(clock, place)?;
        self.effect.check("effect", place, clock)?;
        self.outside.check("outside", place, clock)
    }

    fn check_words(&self, place: &Place) -> Result<(), PlantError> {
        let fits = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
        let is_name = !self.name.is_empty() && self.name.chars().all(fits);
        let bad = |c: char| c == '[' || c == ']' || c.is_control();
        let is_unit = |unit: &str| !unit.trim().is_empty() && !unit.contains(bad);
        let (input, output) = (&self.input_unit, &self.output_unit);
        place.require(&[
            ("name", &self.name, is_name, "letters, digits, `_` and `-`"),
            ("input_unit", input, is_unit(input), "a unit without brackets"),
            ("output_unit", output, is_unit(output), "a unit without brackets"),
        ])
    }

    fn check_list(&self, place: &Place) -> Result<(), PlantError> {
        match (&self.input, &self.delay) {
            (InputSpec::Steps { steps, .. }, DelayLaw::Listed { seconds })
                if steps.len() != seconds.len() =>
            {
                let (given, needed) = (seconds.len(), steps.len());
                Err(PlantError::ListedDelays { place: place.clone(), given, needed })
            }
            _ => Ok(()),
        }
    }

    fn check_range(&self, place: &Place) -> Result<(), PlantError> {
        let Some(range) = self.range else { return Ok(()) };
        let [lowest, highest] = range;
        let rises = lowest < highest && lowest.is_finite() && highest.is_finite();
        let inside = (lowest..=highest).contains(&self.start);
        let drawn = matches!(self.input, InputSpec::Levels { .. });
        place.require(&[
            ("range", &range, rises, "[lowest, highest], finite"),
            ("start", &self.start, inside, "an angle within `range`"),
            ("range", &range, drawn, "none, as `input.steps` are given, not drawn"),
        ])
    }

    fn check_numbers(&self, clock: &Clock, place: &Place) -> Result<(), PlantError> {
        let (ringing, spikes) = (self.ringing, self.spikes);
        let numbers = [
            ("start", Some(self.start), FINITE),
            ("gain", Some(self.gain), NOT_ZERO),
            ("valve_edge", Some(self.valve_edge), EDGE),
            ("saturation", self.saturation, POSITIVE),
            ("lag_s", self.lag_s, LASTS_A_LAG),
            ("ringing.period_s", ringing.map(|ringing| ringing.period_s), LASTS_A_PERIOD),
            ("ringing.damping", ringing.map(|ringing| ringing.damping), BELOW_ONE),
            ("noise", Some(self.noise), NOT_NEGATIVE),
            ("noise_correlation", Some(self.noise_correlation), BETWEEN_ONES),
            ("resolution", self.resolution, POSITIVE),
            ("spikes.share", spikes.map(|spikes| spikes.share), SHARE),
            ("spikes.size", spikes.map(|spikes| spikes.size), NOT_NEGATIVE),
        ];
        for (key, number, rule) in numbers {
            number.map_or(Ok(()), |number| place.number(key, number, rule, clock))?;
        }
        let Some([lower, upper]) = self.dead_band else { return Ok(()) };
        let rises = lower <= upper && lower.is_finite() && upper.is_finite();
        place.require(&[("dead_band", &[lower, upper], rises, "[lower, upper], finite")])
    }

    fn check_cylinder(&self, clock: &Clock, place: &Place) -> Result<(), PlantError> {
        let Some(cylinder) = &self.cylinder else { return Ok(()) };
        self.check_replaced(place)?;
        let unit = self.output_unit.as_str();
        let is_angle = matches!(unit, "deg" | "rad");
        let allowed = "`deg` or `rad`, as `cylinder` moves the joint";
        place.require(&[("output_unit", &unit, is_angle, allowed)])?;
        cylinder.check(clock, place)?;
        let turn = if unit == "rad" { 1.0_f64.to_degrees() } else { 1.0 };
        let [lowest, highest] = cylinder.angle_limits_deg;
        let reached = |angle: &f64| (lowest..=highest).contains(&(angle * turn));
        let allowed = "an angle within `cylinder.angle_limits_deg`";
        place.require(&[("start", &self.start, reached(&self.start), allowed)])?;
        let Some(range) = self.range else { return Ok(()) };
        let allowed = "angles within `cylinder.angle_limits_deg`";
        place.require(&[("range", &range, range.iter().all(reached), allowed)])
    }

    /// Refuses what does not act beside a cylinder.
    fn check_replaced(&self, place: &Place) -> Result<(), PlantError> {
        let allowed = "none, as `cylinder` moves the joint: remove one of the two";
        let gain = ((self.gain - default::gain()).abs() > 0.0).then_some(self.gain);
        let named = |names: Vec<&'static str>| (!names.is_empty()).then_some(names);
        let (effect, outside) = (named(self.effect.names()), named(self.outside.hindering()));
        let given: [(_, Option<&dyn Debug>); 7] = [
            ("gain", gain.as_ref().map(|gain| gain as _)),
            ("dead_band", self.dead_band.as_ref().map(|band| band as _)),
            ("saturation", self.saturation.as_ref().map(|limit| limit as _)),
            ("lag_s", self.lag_s.as_ref().map(|lag_s| lag_s as _)),
            ("ringing", self.ringing.as_ref().map(|ringing| ringing as _)),
            ("effect", effect.as_ref().map(|names| names as _)),
            ("outside", outside.as_ref().map(|names| names as _)),
        ];
        let first = given.into_iter().find_map(|(key, value)| Some((key, value?)));
        first.map_or(Ok(()), |(key, value)| Err(place.refuse(key, value, allowed)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::tests::{DELAY, INPUT, joint};

    const STEPS: &str = "input = { steps = [[40, 1], [89, -1]] }\n";

    /// Asserts that a value of `key` is what is refused.
    #[track_caller]
    fn assert_refused(found: Result<PlantSpec, PlantError>, expected: &str) {
        match found {
            Err(PlantError::Value { key, .. }) => assert_eq!(key, expected),
            other => panic!("`{expected}` is not refused: {other:?}"),
        }
    }

    #[test]
    fn another_schema_is_refused() {
        let mut spec = joint(&[INPUT, DELAY]).unwrap();
        spec.schema = "tauscope/plant/2".to_owned();
        assert!(matches!(spec.check(), Err(PlantError::Schema { .. })));
    }

    #[test]
    fn each_bad_value_of_the_plant_is_refused() {
        let with = |change: fn(&mut PlantSpec)| {
            let mut spec = joint(&[INPUT, DELAY]).unwrap();
            change(&mut spec);
            spec.check().map(|()| spec)
        };
        assert_refused(with(|spec| spec.joints.clear()), "joint");
        assert_refused(with(|spec| spec.joints.push(spec.joints[0].clone())), "name");
        assert_refused(with(|spec| spec.sample_period_s = f64::NAN), "sample_period_s");
        assert_refused(with(|spec| spec.sample_period_s = f64::INFINITY), "sample_period_s");
        assert_refused(with(|spec| spec.sample_period_s = -0.01), "sample_period_s");
        assert_refused(with(|spec| spec.duration_s = 0.01), "duration_s");
        assert_refused(with(|spec| spec.duration_s = 1e9), "duration_s");
        assert_refused(with(|spec| spec.duration_s = f64::NAN), "duration_s");
        assert_refused(with(|spec| spec.substeps = 0), "substeps");
    }

    #[test]
    fn each_bad_number_of_a_joint_is_refused() {
        let cases = [
            ("gain = 0\n", "gain"),
            ("gain = inf\n", "gain"),
            ("start = nan\n", "start"),
            ("range = [1, -1]\n", "range"),
            ("range = [1, 2]\n", "start"),
            ("input_unit = ''\n", "input_unit"),
            ("output_unit = '[deg]'\n", "output_unit"),
            ("dead_band = [0.1, -0.1]\n", "dead_band"),
            ("saturation = 0\n", "saturation"),
            ("lag_s = 0.001\n", "lag_s"),
            ("ringing = { period_s = 0.01, damping = 0.2 }\n", "ringing.period_s"),
            ("ringing = { period_s = 0.4, damping = 1.0 }\n", "ringing.damping"),
            ("noise = -0.1\n", "noise"),
            ("noise_correlation = 1\n", "noise_correlation"),
            ("resolution = 0\n", "resolution"),
        ];
        for (part, key) in cases {
            assert_refused(joint(&[part, INPUT, DELAY]), key);
        }
        assert_refused(joint(&["range = [-9, 9]\n", STEPS, DELAY]), "range");
    }

    #[test]
    fn each_bad_input_is_refused() {
        let cases = [
            ("{ levels = [1, 1], hold_s = [1, 2] }", "input.levels"),
            ("{ levels = [], hold_s = [1, 2] }", "input.levels"),
            ("{ levels = [1, nan], hold_s = [1, 2] }", "input.levels"),
            ("{ levels = [-1, 1], hold_s = [2, 1] }", "input.hold_s"),
            ("{ levels = [-1, 1], hold_s = [0, 1] }", "input.hold_s"),
            ("{ steps = [[1, 1]] }", "input.steps"),
            ("{ steps = [[5, 1], [5, 2]] }", "input.steps"),
            ("{ steps = [[1001, 1]] }", "input.steps"),
            ("{ steps = [[5, 1], [6, 1]] }", "input.steps"),
            ("{ steps = [[5, 1]], initial = inf }", "input.initial"),
        ];
        for (input, key) in cases {
            assert_refused(joint(&["input = ", input, "\n", DELAY]), key);
        }
    }

    #[test]
    fn each_bad_delay_is_refused() {
        let cases = [
            ("law = 'constant', seconds = -0.1", "delay.seconds"),
            ("law = 'uniform', min = 0.5, max = 0.1", "delay.min"),
            ("law = 'uniform', min = 0.5, max = inf", "delay.max"),
            ("law = 'step_size', min = 0.1, max = 0.5, scale = 0", "delay.scale"),
            ("law = 'direction', rising = nan, falling = 0.1", "delay.rising"),
            ("law = 'warming', first = 0.1, last = -1", "delay.last"),
            ("law = 'listed', seconds = [0.1, -0.1]", "delay.seconds"),
        ];
        for (law, key) in cases {
            assert_refused(joint(&[STEPS, "delay = { ", law, " }\n"]), key);
        }
    }

    #[test]
    fn a_list_of_delays_must_fit_the_steps() {
        let found = joint(&[STEPS, "delay = { law = 'listed', seconds = [0.1] }\n"]);
        assert!(matches!(found, Err(PlantError::ListedDelays { given: 1, needed: 2, .. })));
    }
}
