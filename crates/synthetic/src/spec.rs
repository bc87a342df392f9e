//! The plant file: which joints, how they move, what drives them.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::cylinder::CylinderSpec;
use crate::delay_law::{DelayLaw, Occasion};
use crate::effects::{self, Hidden, Instance, LAG, RINGING, Stage, Twin};
use crate::error::PlantError;
use crate::input::InputSpec;

/// The schema of a plant file.
pub const SCHEMA: &str = "tauscope/plant/1";

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
    #[serde(
        default,
        deserialize_with = "effects::catalogue",
        skip_serializing_if = "Hidden::is_empty"
    )]
    pub effect: Hidden,
    /// Effects that it does not have.
    #[serde(
        default,
        deserialize_with = "effects::outside",
        skip_serializing_if = "Hidden::is_empty"
    )]
    pub outside: Hidden,
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
pub(crate) mod default {
    pub(crate) fn sample_period_s() -> f64 {
        0.01
    }

    /// Corners as sharp as a machined land has them.
    pub(crate) fn valve_edge() -> f64 {
        0.004
    }

    /// Enough for a lag of a fifth of a sample, and for ringing with a period of two samples,
    /// the shortest that sampling can show.
    pub(crate) fn substeps() -> u32 {
        20
    }

    pub(crate) fn gain() -> f64 {
        10.0
    }

    pub(crate) fn input_unit() -> String {
        "V".to_owned()
    }

    pub(crate) fn output_unit() -> String {
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
    /// # use tauscope_synthetic::{PlantSpec, simulate};
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
    /// assert_eq!(made.joints[0].output.len(), 160);
    /// assert_eq!(made.truth[1].p, 89);
    /// # Ok::<(), tauscope_synthetic::PlantError>(())
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
            effect: Hidden::default(),
            outside: Hidden::default(),
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
    /// # use tauscope_synthetic::scenario::ideal;
    /// let mut plant = ideal(1);
    /// plant.joints[0].hide("backlash", &[("width".to_owned(), 1.5)])?;
    /// assert_eq!(plant.joints[0].effect.get("backlash"), Some(&[1.5][..]));
    /// # Ok::<(), tauscope_synthetic::PlantError>(())
    /// ```
    pub fn hide(&mut self, name: &str, numbers: &[(String, f64)]) -> Result<(), PlantError> {
        let twin = effects::find(name)?.twin;
        let numbers = effects::numbers(twin, &numbers.iter().cloned().collect());
        let numbers = numbers
            .map_err(|cause| PlantError::Numbers { name: twin.name, cause: Box::new(cause) })?;
        self.put(twin, &numbers);
        Ok(())
    }

    /// Hides an effect with these numbers.
    pub(crate) fn put(&mut self, twin: &'static Twin, numbers: &[f64]) {
        let is_outside = effects::OUTSIDE.contains(&twin.name);
        let hidden = if is_outside { &mut self.outside } else { &mut self.effect };
        hidden.put(twin, numbers);
    }

    /// Its effects that act, in the order in which the signal passes them; plain lag and ringing
    /// are two of them.
    pub(crate) fn effects(&self) -> impl Iterator<Item = Instance> {
        let mut all: Vec<_> = self.effect.acting().chain(self.outside.acting()).cloned().collect();
        all.sort_by_key(Instance::place);
        let lag = self.lag_s.map(|lag_s| Instance::new(&LAG, &[lag_s]));
        let ringing = self
            .ringing
            .map(|Ringing { period_s, damping }| Instance::new(&RINGING, &[period_s, damping]));
        all.into_iter().chain(lag).chain(ringing)
    }

    /// Radians in an angle of one output unit; degrees where the unit is no angle.
    pub(crate) fn radians(&self) -> f64 {
        match self.output_unit.as_str() {
            "rad" => 1.0,
            "mrad" => 1e-3,
            "turn" | "rev" => TAU,
            _ => 1_f64.to_radians(),
        }
    }

    /// Whether its motion is that of dead band, saturation, lag and ringing alone.
    pub(crate) fn is_plain(&self) -> bool {
        self.effects().all(|one| matches!(one.twin.stage, Stage::Delay | Stage::Speed))
    }

    /// Delay of one step in seconds; `None` where the list of delays is too short.
    pub(crate) fn delay_s(&self, at: &Occasion) -> Option<f64> {
        let law_s = self.delay.delay_s(at)?;
        let effects_s: f64 = self.effect.acting().map(|one| one.delay_s(at)).sum();
        let pilot_s = self.cylinder.as_ref().map_or(0.0, |spec| spec.pilot_s(at.before, at.after));
        Some(law_s + effects_s + pilot_s)
    }

    /// A delay in seconds that no step exceeds.
    pub(crate) fn longest_delay_s(&self) -> f64 {
        let effects_s: f64 = self.effect.acting().map(Instance::longest_delay_s).sum();
        let pilot_s = self.cylinder.as_ref().map_or(0.0, CylinderSpec::longest_pilot_s);
        self.delay.longest_s() + effects_s + pilot_s
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    const HEAD: &str = "schema = 'tauscope/plant/1'\nseed = 1\nduration_s = 10\n";
    pub(crate) const INPUT: &str = "input = { levels = [-1, 1], hold_s = [1, 2] }\n";
    pub(crate) const DELAY: &str = "delay = { law = 'constant', seconds = 0.1 }\n";

    /// A plant of one joint with the lines `parts`.
    pub(crate) fn joint(parts: &[&str]) -> Result<PlantSpec, PlantError> {
        PlantSpec::from_toml(&format!("{HEAD}[[joint]]\nname = 'a'\n{}", parts.concat()))
    }

    #[test]
    fn a_short_file_gets_the_defaults() {
        let spec = joint(&[INPUT, DELAY]).unwrap();
        let input = InputSpec::Levels { levels: vec![-1.0, 1.0], hold_s: [1.0, 2.0] };
        let delay = DelayLaw::Constant { seconds: 0.1 };
        assert_eq!(spec, PlantSpec::new(1, 10.0, vec![JointSpec::new("a", input, delay)]));
        assert_eq!(spec.clock().unwrap().samples, 1000);
    }

    #[test]
    fn a_full_file_is_read_as_it_was_written() {
        let text = "gain = -5\nstart = 3\nrange = [-90, 90]\ndead_band = [-0.2, 0.1]\n\
             saturation = 1.5\nlag_s = 0.06\nringing = { period_s = 0.4, damping = 0.2 }\n\
             noise = 0.05\nnoise_correlation = 0.3\nresolution = 0.01\n";
        let hidden = "effect.end_stop.high = 10\n\
             outside.sticky_spot = { from = 1, to = 2, share = 0.5 }\n";
        let cylinder = "start = 20\ncylinder = { only = ['gravity'], bore_mm = 70 }\n";
        for text in [text, hidden, cylinder] {
            let spec = joint(&[text, INPUT, DELAY]).unwrap();
            assert_eq!(PlantSpec::from_toml(&spec.to_toml().unwrap()).unwrap(), spec, "{text}");
        }
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
}
