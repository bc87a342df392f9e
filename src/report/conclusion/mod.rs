//! A verdict in words that an engineer can act on.

mod adequate;
mod missing;
mod passage;
mod place;
mod unexplained;

pub(crate) use passage::{Passage, Topic};

use super::EstimatedJoint;
use super::add::gained;
use super::consequence::noise_of;
use super::finding::{Finding, added};
use super::first_order::first_order;
use super::model_delay::model_delay;
use crate::diagnosis::Comparison;
use crate::experiment::Joint;
use crate::explain::{Candidate, Verdict};
use crate::wording::{effects_text, hanging, measure, percent, rounded};

/// What is concluded of a joint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Conclusion {
    /// The verdict in one sentence.
    pub(crate) headline: String,
    /// What is behind it, question by question.
    pub(crate) passages: Vec<Passage>,
    /// Commands that do what it proposes.
    pub(crate) commands: Vec<String>,
}

impl Conclusion {
    /// What is behind it, without the questions.
    pub(crate) fn sentences(&self) -> String {
        let texts: Vec<String> = self.passages.iter().map(Passage::text).collect();
        texts.join(" ")
    }

    /// The words below the headline as they are printed.
    pub(super) fn printed(&self) -> String {
        let passage = |one: &Passage| hanging(&format!("{}: {}", one.topic.label(), one.text()));
        let passages: Vec<String> = self.passages.iter().map(passage).collect();
        let commands = self.commands.iter().map(|command| format!("    {command}"));
        let blocks = std::iter::once(passages.join("\n")).chain(commands);
        blocks.collect::<Vec<_>>().join("\n\n") + "\n"
    }
}

/// Times the noise above which an error is said to be more than noise.
const ABOVE_NOISE: f64 = 1.15;

impl Finding<'_> {
    /// The verdict in words.
    pub(crate) fn conclusion(&self) -> Conclusion {
        let best = self.proposed();
        let (headline, mut passages) = match (self.verdict, best) {
            (_, Some(best)) => (self.missing_headline(best), self.missing(best)),
            (Verdict::Adequate, None) => (self.adequate_headline(), self.adequate()),
            (Verdict::MissingEffect, None) => (self.open_headline(), self.fails()),
            (_, None) => (self.unexplained_headline(), self.unexplained()),
        };
        let structure = first_order(self.joint(), self.consequence().fit);
        passages.extend(Passage::of(Topic::Structure, structure));
        passages.extend(Passage::of(Topic::Delay, self.delay()));
        passages.extend(Passage::of(Topic::Trials, self.conditions(best)));
        let command = |id: &&'static str| {
            // A bracket is a pattern to a shell.
            let id = if id.contains('[') { format!("'{id}'") } else { (*id).to_owned() };
            format!("tauscope add {id} {}", self.add_arguments)
        };
        let commands = best.iter().flat_map(|best| &best.effects).map(command).collect();
        Conclusion { headline, passages, commands }
    }

    /// In which trials the effects act that do not act in all.
    fn conditions(&self, best: Option<&Candidate>) -> Option<String> {
        let model = self.consequence().fit.model.components().iter();
        let components = model.chain(best.into_iter().flat_map(added));
        let of = components.filter_map(|component| component.effect().within_trials());
        let mut words: Vec<&str> = of.map(|of| of.word).collect();
        words.sort_unstable();
        words.dedup();
        let acts = |word: &&str| format!("`[{word}]`: in trials with `{word}` in their label.");
        (!words.is_empty()).then(|| words.iter().map(acts).collect::<Vec<_>>().join(" "))
    }

    /// The delay of the model beside those that were measured.
    fn delay(&self) -> Option<String> {
        let estimate = self.delays?;
        let measured = EstimatedJoint { joint: self.joint(), estimate };
        model_delay(self.consequence().fit, measured)
    }

    fn joint(&self) -> &Joint {
        self.compared.joint
    }

    fn comparison(&self) -> &Comparison {
        self.compared.comparison
    }

    /// A number in output units.
    fn output(&self, value: f64) -> String {
        measure(value, self.joint().output_unit.as_deref())
    }

    fn error(&self) -> f64 {
        self.comparison().judged().map_or(f64::NAN, |error| error.rmse)
    }

    fn noise(&self) -> Option<f64> {
        noise_of(self.joint())
    }

    /// What the effects that were added explain of the error, where any were:
    /// `dead_band and end_stop explain 70 % of the error beyond the noise (2.89 to 0.88 deg)`.
    fn explained(&self) -> Option<String> {
        let before = self.before?;
        let mut gained = gained(&before.fit.model, &self.comparison().fit.model);
        let last = gained.pop()?;
        let (names, explain) = match gained.as_slice() {
            [] => (last.to_owned(), "explains"),
            others => (format!("{} and {last}", others.join(", ")), "explain"),
        };
        let share = percent(self.consequence().explained()?);
        let (from, to) = (rounded(before.judged()?.rmse), self.output(self.error()));
        Some(format!("{names} {explain} {share} of the error beyond the noise ({from} to {to})"))
    }

    /// What the model explains of the motion: `1 − e/d` with the standard deviation `d` of what
    /// was measured.
    fn follows(&self) -> String {
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
