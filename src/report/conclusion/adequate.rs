//! What is said where no effect is missing.

use super::figures::ABOVE_NOISE;
use super::{Passage, Topic};
use crate::diagnosis::{Comparison, LackOfFit, NEGLIGIBLE, SIGNIFICANCE};
use crate::experiment::Trial;
use crate::fit::{Status, is_rounding};
use crate::report::consequence::times_as_large;
use crate::report::finding::Finding;
use crate::wording::{measure, p_text, percent, range_text, rounded};

/// The level of the tests of other programs, most often.
const USUAL: f64 = 0.05;

impl Finding<'_> {
    pub(super) fn adequate_headline(&self) -> String {
        let is_shown = self.comparison().lack_of_fit.is_some_and(|test| !test.adequate);
        let of_consequence = if is_shown { " of consequence" } else { "" };
        match self.explained() {
            None => format!("no missing effect{of_consequence} found"),
            Some(explained) => format!("{explained}; nothing more{of_consequence} is missing"),
        }
    }

    pub(super) fn adequate(&self) -> Vec<Passage> {
        let error = [self.test(), self.size()].into_iter().chain(self.misses_validation());
        let limits = std::iter::once(self.limits()).chain(self.undetermined());
        let passages = [
            Passage::of(Topic::Error, error),
            Passage::of(Topic::Shares, self.consequence().sentences()),
            Passage::of(Topic::Limits, limits),
        ];
        passages.into_iter().flatten().collect()
    }

    /// What the test of the lack of fit says of an adequate model.
    pub(super) fn test(&self) -> String {
        match self.comparison().lack_of_fit {
            Some(LackOfFit { edges: Some(edges), .. }) => {
                let (spread, share) = (measure(edges.spread_s, Some("s")), percent(edges.share));
                format!(
                    "The steps of the input lie between the samples of the log, and their times, the \
                     middle 80 % of which are spread over {spread}, explain {share} of the squared \
                     residual; beside that no lack of fit is shown. A log with the samples of the \
                     controller, or a faster one, would show smaller errors of the model."
                )
            }
            Some(test) if test.p_value >= SIGNIFICANCE => {
                let p_value = p_text(test.p_value);
                // What would pass for significant elsewhere is said to be below the level here.
                let level = 100.0 * SIGNIFICANCE;
                let level =
                    if test.p_value < USUAL { format!(" at {level} %") } else { String::new() };
                format!("No lack of fit is shown{level} ({p_value}).")
            }
            Some(test) => {
                let share = rounded(100.0 * test.misfit_share);
                if test.misfit_share < NEGLIGIBLE {
                    return format!(
                        "The lack of fit is {share} % of the squared error: negligible."
                    );
                }
                let p_value = p_text(test.p_value);
                let rest = if test.adequate {
                    "which as a whole is close to the noise"
                } else {
                    "and no tried effect explains a relevant part of it"
                };
                format!(
                    "A pattern is left in {share} % of the squared residual ({p_value}), {rest}."
                )
            }
            None if self.is_exact() => {
                "The residual is only rounding error: there is nothing to test.".to_owned()
            }
            None => "There are too few samples to test it.".to_owned(),
        }
    }

    /// Whether no residual of either part is more than rounding.
    fn is_exact(&self) -> bool {
        let Comparison { training, validation, .. } = self.comparison();
        let largest = training.iter().chain(validation).map(|error| error.max);
        is_rounding(&self.joint().trials, largest.fold(0.0, f64::max))
    }

    /// A warning where the part that was not fitted is worse than noise, and than the other one.
    fn misses_validation(&self) -> Option<String> {
        let validation = self.comparison().validation?.rmse;
        let times = validation / self.comparison().training?.rmse;
        let is_worse = times > ABOVE_NOISE && validation > ABOVE_NOISE * self.noise()?;
        is_worse.then(|| {
            format!(
                "The test covers the training part; on the validation part, which shows what to \
                 expect of new data, the error is {}.",
                times_as_large(times)
            )
        })
    }

    /// What the record covers: beyond it nothing was shown.
    fn limits(&self) -> String {
        let input = self.joint().trials.iter().flat_map(Trial::input);
        let output = self.joint().trials.iter().flat_map(Trial::output);
        let input = range_text(input.copied(), self.joint().input_unit.as_deref());
        let output = range_text(output.copied(), self.joint().output_unit.as_deref());
        format!("Valid only in the range of the record: input {input}, output {output}.")
    }

    fn undetermined(&self) -> Option<String> {
        let all = self.comparison().fit.parameters.iter();
        let open = all.filter(|parameter| {
            matches!(parameter.status, Status::Undetermined | Status::BeyondReach)
        });
        let names: Vec<&str> = open.map(|parameter| parameter.name.as_str()).collect();
        (!names.is_empty()).then(|| format!("It does not determine {}.", names.join(", ")))
    }
}
