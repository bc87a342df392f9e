//! The plant file: which joints, how they move, what drives them.

use std::collections::HashSet;
use std::fmt::Debug;

use serde::{Deserialize, Serialize};

use super::clock::{Clock, MIN_STEPS_PER_LAG, MIN_STEPS_PER_PERIOD, whole};
use super::cylinder::CylinderSpec;
use super::delay_law::{DelayLaw, Occasion};
use super::effects::{self, Change, Effects, Outside, Valve};
use super::error::{Allowed, Place, PlantError, above_zero};
use super::input::InputSpec;
use super::schema::SCHEMA;
use crate::units::SamplePeriod;

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

/// Joints to simulate, as a plant file holds them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlantSpec {
    /// [`SCHEMA`].
    pub schema: String,
    /// Where all random numbers come from: the same seed, the same data.
    pub seed: u64,
    /// Seconds between samples; 0.01 where a file leaves it out.
    #[serde(default = "default::sample_period_s")]
    pub sample_period_s: f64,
    /// Length of the record in seconds, rounded to whole samples.
    pub duration_s: f64,
    /// Time steps per sample; 20 where a file leaves it out.
    #[serde(default = "default::substeps")]
    pub substeps: u32,
    /// The joints, `[[joint]]` in a file, in the order of the log.
    #[serde(rename = "joint")]
    pub joints: Vec<JointSpec>,
}

/// One joint of a plant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointSpec {
    /// Name: letters, digits, `_` and `-`.
    pub name: String,
    /// Steady speed per input, in output units per second and input unit; 10 where a
    /// file leaves it out.
    #[serde(default = "default::gain")]
    pub gain: f64,
    /// Angle at the first sample, in output units.
    #[serde(default)]
    pub start: f64,
    /// Lowest and highest angle that the experimenter allows, in output units. Only
    /// for an input that is drawn: a level whose hold could leave the range has its
    /// sign flipped, and where that does not help another one is drawn. Noise, the
    /// overshoot of ringing and effects that no level can stop may still exceed it.
    pub range: Option<[f64; 2]>,
    /// Unit of the input.
    #[serde(default = "default::input_unit")]
    pub input_unit: String,
    /// Unit of the output.
    #[serde(default = "default::output_unit")]
    pub output_unit: String,
    /// What drives it.
    pub input: InputSpec,
    /// How long each step of the input takes to act.
    pub delay: DelayLaw,
    /// Lower and upper end of the dead band, in input units: no motion between, and
    /// beyond it only the excess counts.
    pub dead_band: Option<[f64; 2]>,
    /// Largest magnitude, in input units, that passes after the dead band.
    pub saturation: Option<f64>,
    /// Time constant of a first-order lag of the speed, in seconds.
    pub lag_s: Option<f64>,
    /// Ringing of the speed.
    pub ringing: Option<Ringing>,
    /// Width over which the corners of the valve's effects are rounded, as a part of the
    /// largest level of the input; 0.004 where a file leaves it out.
    #[serde(default = "default::valve_edge")]
    pub valve_edge: f64,
    /// The cylinder that moves it, instead of gain, dead band, saturation, lag, ringing and
    /// effects but those of the sensor.
    pub cylinder: Option<CylinderSpec>,
    /// Standard deviation of the measurement noise, in output units.
    #[serde(default)]
    pub noise: f64,
    /// Correlation of the noise of neighbouring samples, between -1 and 1; 0 is white.
    #[serde(default)]
    pub noise_correlation: f64,
    /// Step of the encoder, in output units.
    pub resolution: Option<f64>,
    /// Samples that are far off.
    pub spikes: Option<Spikes>,
    /// Effects that the catalogue of models has.
    #[serde(default, skip_serializing_if = "Effects::is_empty")]
    pub effect: Effects,
    /// Effects that it does not have.
    #[serde(default, skip_serializing_if = "Outside::is_empty")]
    pub outside: Outside,
}

/// Single samples that are far off, as of a loose contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spikes {
    /// Part of the samples.
    pub share: f64,
    /// How far off, to either side, in output units.
    pub size: f64,
}

/// A second-order response of the speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ringing {
    /// Period without damping, in seconds. The peaks in the record are
    /// `period_s / sqrt(1 - damping²)` apart.
    pub period_s: f64,
    /// Damping ratio, below 1.
    pub damping: f64,
}

/// What a file may leave out.
mod default {
    /// Time steps per sample: enough for a lag of a fifth of a sample, and for ringing
    /// with a period of two samples, the shortest that sampling can show.
    const SUBSTEPS: u32 = 20;

    pub(super) fn sample_period_s() -> f64 {
        0.01
    }

    /// Corners as sharp as a machined land has them.
    pub(super) fn valve_edge() -> f64 {
        0.004
    }

    pub(super) fn substeps() -> u32 {
        SUBSTEPS
    }

    pub(super) fn gain() -> f64 {
        10.0
    }

    pub(super) fn input_unit() -> String {
        "V".to_owned()
    }

    pub(super) fn output_unit() -> String {
        "deg".to_owned()
    }
}

impl PlantSpec {
    /// `joints` recorded for `duration_s` seconds; the rest as in a file that
    /// leaves it out.
    pub fn new(seed: u64, duration_s: f64, joints: Vec<JointSpec>) -> Self {
        Self {
            schema: SCHEMA.to_owned(),
            seed,
            sample_period_s: default::sample_period_s(),
            duration_s,
            substeps: default::substeps(),
            joints,
        }
    }

    /// Reads a plant file and checks it.
    ///
    /// # Errors
    /// [`PlantError::Parse`] when the text is no plant file, else as
    /// [`check`](Self::check).
    ///
    /// # Examples
    /// ```
    /// # use tauscope::synthetic::{PlantSpec, simulate};
    /// let spec = PlantSpec::from_toml(
    ///     r#"
    ///     schema = "tauscope/plant/1"
    ///     seed = 1
    ///     duration_s = 1.6
    ///     [[joint]]
    ///     name = "elbow"
    ///     input = { steps = [[40, 1.0], [89, -1.0]] }
    ///     delay = { law = "constant", seconds = 0.15 }
    ///     "#,
    /// )?;
    /// let made = simulate(&spec)?;
    /// assert_eq!(made.joints[0].trials[0].len(), 160);
    /// assert_eq!(made.truth[1].p, 89);
    /// # Ok::<(), tauscope::synthetic::PlantError>(())
    /// ```
    pub fn from_toml(text: &str) -> Result<Self, PlantError> {
        let parsed = toml::from_str::<Self>(text);
        let spec = parsed.map_err(|source| PlantError::Parse { source: Box::new(source) })?;
        spec.check()?;
        Ok(spec)
    }

    /// The text of a plant file, which gives the same log.
    ///
    /// # Errors
    /// [`PlantError::Write`] for what TOML cannot hold.
    pub fn to_toml(&self) -> Result<String, PlantError> {
        toml::to_string(self).map_err(|source| PlantError::Write { source: Box::new(source) })
    }

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
            let allowed = "a name that no other joint has";
            place.require("name", joint.name.as_str(), allowed, |name| names.insert(*name))?;
            joint.check(&clock, &place)?;
            input_steps += joint.input.steps_in(&clock);
            let allowed = "so long that there are five million steps of all joints or fewer";
            let holds = joint.input.mean_hold_s(&clock);
            place.require("input.hold_s", holds, allowed, |_| input_steps <= MAX_INPUT_STEPS)?;
        }
        Ok(())
    }

    /// The times of the record.
    pub(super) fn clock(&self) -> Result<Clock, PlantError> {
        let plant = Place::Plant;
        let count = self.joints.len();
        plant.require("joint", count, "one table [[joint]] or more", |count| *count > 0)?;
        let period_s = self.sample_period_s;
        let period = SamplePeriod::from_seconds(period_s)
            .filter(|period| period.seconds() >= MIN_SAMPLE_PERIOD_S);
        let Some(period) = period else {
            let allowed = "finite seconds, 1e-6 or more";
            return Err(plant.refuse("sample_period_s", period_s, allowed));
        };
        let samples = (self.duration_s / period_s).round();
        let allowed = "two sample periods or more; fifty million samples of all joints or fewer";
        plant.require("duration_s", self.duration_s, allowed, |_| {
            samples >= 2.0 && samples * count as f64 <= MAX_SAMPLES
        })?;
        let allowed = "1 to 1000; two thousand million time steps of all joints or fewer";
        plant.require("substeps", self.substeps, allowed, |substeps| {
            let steps = samples * count as f64 * f64::from(*substeps);
            (1..=MAX_SUBSTEPS).contains(substeps) && steps <= MAX_TIME_STEPS
        })?;
        Ok(Clock::new(period, whole(samples), self.substeps))
    }
}

impl JointSpec {
    /// A joint with neither dead band, saturation, lag, ringing nor noise; the rest
    /// as in a file that leaves it out.
    pub fn new(name: &str, input: InputSpec, delay: DelayLaw) -> Self {
        Self {
            name: name.to_owned(),
            gain: default::gain(),
            start: 0.0,
            range: None,
            input_unit: default::input_unit(),
            output_unit: default::output_unit(),
            input,
            delay,
            dead_band: None,
            saturation: None,
            lag_s: None,
            ringing: None,
            valve_edge: default::valve_edge(),
            cylinder: None,
            noise: 0.0,
            noise_correlation: 0.0,
            resolution: None,
            spikes: None,
            effect: Effects::default(),
            outside: Outside::default(),
        }
    }

    /// Hides the effect `name`, of the catalogue or outside it, with these numbers: the
    /// keys of its table in a plant file. An effect of that name that is there goes.
    ///
    /// # Errors
    /// [`PlantError::Unknown`] and [`PlantError::Numbers`].
    ///
    /// # Examples
    /// ```
    /// # use tauscope::synthetic::scenario::ideal;
    /// let mut plant = ideal(1);
    /// plant.joints[0].hide("backlash", &[("width".to_owned(), 1.5)])?;
    /// assert!(plant.joints[0].effect.backlash.is_some());
    /// # Ok::<(), tauscope::synthetic::PlantError>(())
    /// ```
    pub fn hide(&mut self, name: &str, numbers: &[(String, f64)]) -> Result<(), PlantError> {
        let name = effects::name(name)?;
        if effects::CATALOGUE.contains(&name) || effects::FINER.contains(&name) {
            self.effect = effects::with_part(&self.effect, name, numbers)?;
        } else {
            self.outside = effects::with_part(&self.outside, name, numbers)?;
        }
        Ok(())
    }

    /// Whether its motion is that of valve, lag and ringing alone.
    pub(super) fn is_plain(&self) -> bool {
        self.effect.only_delay() && self.outside.is_empty()
    }

    /// Its valve.
    pub(super) fn valve(&self) -> Valve<'_> {
        Valve::new(&self.effect, &self.outside, self.valve_edge * self.input.largest())
    }

    /// Delay of one step in seconds; `None` where the list of delays is too short.
    pub(super) fn delay_s(&self, at: &Occasion) -> Option<f64> {
        let law_s = self.delay.delay_s(at)?;
        let variable_s = self.effect.variable_delay.map_or(0.0, |variable| {
            let (rise, held_s, time_s) = (at.after - at.before, at.held_s, at.time_s);
            variable.extra_s(&Change { rise, held_s, time_s })
        });
        let pilot_s = self.cylinder.as_ref().map_or(0.0, |spec| spec.pilot_s(at.before, at.after));
        Some(law_s + variable_s + pilot_s)
    }

    /// A delay in seconds that no step exceeds.
    pub(super) fn longest_delay_s(&self) -> f64 {
        let variable_s = self.effect.variable_delay.map_or(0.0, |variable| variable.longest_s());
        let pilot_s = self.cylinder.as_ref().map_or(0.0, CylinderSpec::longest_pilot_s);
        self.delay.longest_s() + variable_s + pilot_s
    }

    fn check(&self, clock: &Clock, place: &Place) -> Result<(), PlantError> {
        self.check_words(place)?;
        self.input.check(clock, place)?;
        self.delay.check(place)?;
        self.check_list(place)?;
        self.check_range(place)?;
        self.check_statics(place)?;
        self.check_dynamics(clock, place)?;
        self.check_cylinder(clock, place)?;
        self.check_sensor(place)?;
        self.effect.check(place, clock)?;
        self.outside.check(place, clock)
    }

    fn check_words(&self, place: &Place) -> Result<(), PlantError> {
        let fits = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
        place.require("name", &self.name, "letters, digits, `_` and `-`", |name| {
            !name.is_empty() && name.chars().all(fits)
        })?;
        for (key, unit) in [("input_unit", &self.input_unit), ("output_unit", &self.output_unit)] {
            let bad = |c: char| c == '[' || c == ']' || c.is_control();
            place.require(key, unit, "a unit without brackets", |unit| {
                !unit.trim().is_empty() && !unit.contains(bad)
            })?;
        }
        Ok(())
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
        place.require("start", self.start, "finite", |start| start.is_finite())?;
        let Some(range) = self.range else {
            return Ok(());
        };
        let [lowest, highest] = range;
        place.require("range", range, "[lowest, highest], finite", |_| {
            lowest < highest && lowest.is_finite() && highest.is_finite()
        })?;
        place.require("start", self.start, "an angle within `range`", |start| {
            (lowest..=highest).contains(start)
        })?;
        place.require("range", range, "none, as `input.steps` are given, not drawn", |_| {
            matches!(self.input, InputSpec::Levels { .. })
        })
    }

    fn check_statics(&self, place: &Place) -> Result<(), PlantError> {
        place.require("gain", self.gain, "finite, not zero", |gain| {
            gain.is_finite() && gain.abs() > 0.0
        })?;
        if let Some(band) = self.dead_band {
            place.require("dead_band", band, "[lower, upper], finite", |[lower, upper]| {
                lower <= upper && lower.is_finite() && upper.is_finite()
            })?;
        }
        place.require("valve_edge", self.valve_edge, "above 0, 1 or less", |edge| {
            *edge > 0.0 && *edge <= 1.0
        })?;
        above_zero(place, "saturation", self.saturation)
    }

    fn check_dynamics(&self, clock: &Clock, place: &Place) -> Result<(), PlantError> {
        let lasts =
            |seconds: f64, steps: f64| seconds.is_finite() && seconds >= steps * clock.substep_s();
        if let Some(lag_s) = self.lag_s {
            let allowed = "finite seconds, four time steps or more (sample_period_s / substeps)";
            place.require("lag_s", lag_s, allowed, |lag_s| lasts(*lag_s, MIN_STEPS_PER_LAG))?;
        }
        let Some(Ringing { period_s, damping }) = self.ringing else {
            return Ok(());
        };
        let allowed = "finite seconds, forty time steps or more (sample_period_s / substeps)";
        place.require("ringing.period_s", period_s, allowed, |period_s| {
            lasts(*period_s, MIN_STEPS_PER_PERIOD)
        })?;
        place.require("ringing.damping", damping, "0 or more, below 1", |damping| {
            (0.0..1.0).contains(damping)
        })
    }

    fn check_cylinder(&self, clock: &Clock, place: &Place) -> Result<(), PlantError> {
        let Some(cylinder) = &self.cylinder else { return Ok(()) };
        self.check_replaced(place)?;
        let unit = self.output_unit.as_str();
        let allowed = "`deg` or `rad`, as `cylinder` moves the joint";
        place.require("output_unit", unit, allowed, |unit| matches!(*unit, "deg" | "rad"))?;
        cylinder.check(clock, place)?;
        let turn = if unit == "rad" { 1.0_f64.to_degrees() } else { 1.0 };
        let [lowest, highest] = cylinder.angle_limits_deg;
        let reached = |angle: f64| (lowest..=highest).contains(&(angle * turn));
        let allowed = "an angle within `cylinder.angle_limits_deg`";
        place.require("start", self.start, allowed, |start| reached(*start))?;
        let Some(range) = self.range else { return Ok(()) };
        let allowed = "angles within `cylinder.angle_limits_deg`";
        place.require("range", range, allowed, |range| range.iter().all(|angle| reached(*angle)))
    }

    /// Refuses what does not act beside a cylinder.
    fn check_replaced(&self, place: &Place) -> Result<(), PlantError> {
        let allowed = "none, as `cylinder` moves the joint: remove one of the two";
        let gain = ((self.gain - default::gain()).abs() > 0.0).then_some(self.gain);
        let named = |names: Vec<&'static str>| (!names.is_empty()).then_some(names);
        let (effect, outside) = (named(self.effect.names()), named(self.outside.hindering()));
        let replaced: [(_, Option<&dyn Debug>); 7] = [
            ("gain", gain.as_ref().map(|gain| gain as _)),
            ("dead_band", self.dead_band.as_ref().map(|band| band as _)),
            ("saturation", self.saturation.as_ref().map(|limit| limit as _)),
            ("lag_s", self.lag_s.as_ref().map(|lag_s| lag_s as _)),
            ("ringing", self.ringing.as_ref().map(|ringing| ringing as _)),
            ("effect", effect.as_ref().map(|names| names as _)),
            ("outside", outside.as_ref().map(|names| names as _)),
        ];
        for (key, given) in replaced {
            if let Some(value) = given {
                return Err(place.refuse(key, value, allowed));
            }
        }
        Ok(())
    }

    fn check_sensor(&self, place: &Place) -> Result<(), PlantError> {
        place.require("noise", self.noise, "finite, not negative", |noise| {
            noise.is_finite() && *noise >= 0.0
        })?;
        let (key, allowed) = ("noise_correlation", "above -1, below 1");
        place.require(key, self.noise_correlation, allowed, |phi| phi.abs() < 1.0)?;
        above_zero(place, "resolution", self.resolution)?;
        let Some(Spikes { share, size }) = self.spikes else {
            return Ok(());
        };
        place.number("spikes.share", share, Allowed::Share)?;
        place.number("spikes.size", size, Allowed::NotNegative)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "schema = 'tauscope/plant/1'\nseed = 1\nduration_s = 10\n";
    const INPUT: &str = "input = { levels = [-1, 1], hold_s = [1, 2] }\n";
    const STEPS: &str = "input = { steps = [[40, 1], [89, -1]] }\n";
    const DELAY: &str = "delay = { law = 'constant', seconds = 0.1 }\n";

    /// A plant of one joint with the lines `parts`.
    fn joint(parts: &[&str]) -> Result<PlantSpec, PlantError> {
        PlantSpec::from_toml(&format!("{HEAD}[[joint]]\nname = 'a'\n{}", parts.concat()))
    }

    /// Asserts that a value of `key` is what is refused.
    #[track_caller]
    fn assert_refused(found: Result<PlantSpec, PlantError>, expected: &str) {
        match found {
            Err(PlantError::Value { key, .. }) => assert_eq!(key, expected),
            other => panic!("`{expected}` is not refused: {other:?}"),
        }
    }

    #[test]
    fn a_short_file_gets_the_defaults() {
        let spec = joint(&[INPUT, DELAY]).unwrap();
        let input = InputSpec::Levels { levels: vec![-1.0, 1.0], hold_s: [1.0, 2.0] };
        let delay = DelayLaw::Constant { seconds: 0.1 };
        assert_eq!(spec, PlantSpec::new(1, 10.0, vec![JointSpec::new("a", input, delay)]));
        assert_eq!(spec.clock().unwrap().samples(), 1000);
    }

    #[test]
    fn a_full_file_is_read_as_it_was_written() {
        let text = "gain = -5\nstart = 3\nrange = [-90, 90]\ndead_band = [-0.2, 0.1]\n\
             saturation = 1.5\nlag_s = 0.06\nringing = { period_s = 0.4, damping = 0.2 }\n\
             noise = 0.05\nnoise_correlation = 0.3\nresolution = 0.01\n";
        let spec = joint(&[text, INPUT, DELAY]).unwrap();
        let written = toml::to_string(&spec).unwrap();
        assert_eq!(PlantSpec::from_toml(&written).unwrap(), spec);
    }

    #[test]
    fn joints_keep_the_order_of_the_file() {
        let tables = ["zeta", "alpha", "mid"]
            .map(|name| format!("[[joint]]\nname = '{name}'\n{INPUT}{DELAY}"));
        let spec = PlantSpec::from_toml(&format!("{HEAD}{}", tables.concat())).unwrap();
        let names: Vec<&str> = spec.joints.iter().map(|joint| joint.name.as_str()).collect();
        assert_eq!(names, ["zeta", "alpha", "mid"]);
    }

    #[test]
    fn text_that_is_no_plant_is_refused() {
        for text in ["", "seed", "schema = 'tauscope/plant/1'\nseed = -1\nduration_s = 1"] {
            let found = PlantSpec::from_toml(text);
            assert!(matches!(found, Err(PlantError::Parse { .. })), "{text}");
        }
        for part in ["gian = 1\n", "ringing = { period_s = 1 }\n", "dead_band = [0.1]\n"] {
            let found = joint(&[part, INPUT, DELAY]);
            assert!(matches!(found, Err(PlantError::Parse { .. })), "{part}");
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
