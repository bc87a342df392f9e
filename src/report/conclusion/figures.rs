//! The figures of a finding that several sentences name: error, noise, what is explained.

use crate::diagnosis::{Comparison, sensor_noise};
use crate::experiment::Joint;
use crate::fit::{AssessedModel, follows_input, time_constant_s};
use crate::report::Finding;
use crate::wording::{effects_text, measure, percent, rounded};

/// Times the noise above which an error is said to be more than noise.
pub(super) const ABOVE_NOISE: f64 = 1.15;

impl Finding<'_> {
    pub(super) fn joint(&self) -> &Joint {
        self.compared.joint
    }

    pub(super) fn comparison(&self) -> &Comparison {
        self.compared.comparison
    }

    /// A number in output units.
    pub(super) fn output(&self, value: f64) -> String {
        measure(value, self.joint().output_unit.as_deref())
    }

    pub(super) fn error(&self) -> f64 {
        self.comparison().judged().map_or(f64::NAN, |error| error.rmse)
    }

    pub(super) fn noise(&self) -> Option<f64> {
        sensor_noise(&self.joint().trials)
    }

    /// What the effects that were added explain of the error, where any were:
    /// `dead_band and end_stop explain 70 % of the error beyond the noise (2.89 to 0.88 deg)`.
    pub(super) fn explained(&self) -> Option<String> {
        let before = self.before?;
        let mut gained = before.gained(&self.comparison().fit.model);
        let doubtful = self.attribution.map_or(&[][..], |known| &known.doubtful);
        gained.retain(|id| doubtful.iter().all(|one| one.effect != *id));
        let names = self.gained_in_words(gained)?;
        let explain = if names.contains(' ') { "explain" } else { "explains" };
        Some(format!("{names} {explain} {}", self.explained_share()?))
    }

    /// `70 % of the error beyond the noise (2.89 to 0.88 deg)`.
    pub(super) fn explained_share(&self) -> Option<String> {
        let share = percent(self.consequence().explained()?);
        let (from, to) = (rounded(self.before?.rmse()?), self.output(self.error()));
        Some(format!("{share} of the error beyond the noise ({from} to {to})"))
    }

    /// `dead_band and end_stop`; of many those that carry most: `dead_band, end_stop and 4 more`.
    fn gained_in_words(&self, mut gained: Vec<&'static str>) -> Option<String> {
        let found = self.attribution.map_or(&[][..], |known| &known.found);
        let share =
            |id: &str| found.iter().find(|one| one.effect == id).map_or(0.0, |one| one.error_share);
        if gained.len() > MOST {
            gained.sort_by(|a, b| share(b).total_cmp(&share(a)));
        }
        first_of(&gained)
    }

    /// What the model explains of the motion: `1 − e/d` with the standard deviation `d` of what
    /// was measured.
    pub(super) fn follows(&self) -> String {
        let model = match effects_text(&self.comparison().fit.model) {
            alone if self.comparison().fit.model.components().is_empty() => format!("the {alone}"),
            effects => format!("a model with {effects}"),
        };
        match self.comparison().judged().map(|error| error.fit_percent) {
            Some(fit) if fit > 0.0 => {
                format!("{model} explains {} of the motion", percent(fit / 100.0))
            }
            _ => format!("{model} does not explain the motion"),
        }
    }
}

/// Names that a person takes in.
const MOST: usize = 4;

/// `dead_band and end_stop`; of many the first: `dead_band, end_stop, leakage and 4 more`. Nothing of none.
pub(super) fn first_of(names: &[impl AsRef<str>]) -> Option<String> {
    /// Names that are said of more.
    const FIRST: usize = 3;
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    let (last, others) = names.split_last()?;
    Some(match others {
        [] => (*last).to_owned(),
        others if others.len() < MOST => format!("{} and {last}", others.join(", ")),
        _ => {
            let first = names.get(..FIRST).unwrap_or_default().join(", ");
            format!("{first} and {} more", names.len() - FIRST)
        }
    })
}

/// `The output follows the input itself, not its integral (r² 0.93): the model is a first order
/// with dead time, of time constant 0.16 s.`
pub(super) fn first_order(joint: &Joint, of: &AssessedModel) -> Option<String> {
    let time_constant_s = time_constant_s(&of.model)?;
    let r_squared = follows_input(joint)?;
    Some(format!(
        "The output follows the input itself, not its integral (r² {r_squared:.2}): the model is \
         a first order with dead time, of time constant {} s.",
        rounded(time_constant_s)
    ))
}
