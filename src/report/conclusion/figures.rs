//! The figures of a finding that several sentences name: error, noise, what is explained.

use crate::diagnosis::{Comparison, sensor_noise};
use crate::experiment::Joint;
use crate::fit::{AssessedModel, follows_input, time_constant_s};
use crate::report::Finding;
use crate::wording::{effects_text, listed, measure, percent, rounded};

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
        let gained: Vec<String> = gained.into_iter().map(str::to_owned).collect();
        let explain = match gained.as_slice() {
            [] => return None,
            [_] => "explains",
            _ => "explain",
        };
        let share = percent(self.consequence().explained()?);
        let (from, to) = (rounded(self.before?.rmse()?), self.output(self.error()));
        let names = listed(&gained, "and");
        Some(format!("{names} {explain} {share} of the error beyond the noise ({from} to {to})"))
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
