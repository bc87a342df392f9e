//! A verdict in words that an engineer can act on.

use super::finding::added;
use crate::delay;
use crate::effect::Stage;
use crate::explain::{Candidate, Verdict};
use crate::fit::{AssessedModel, Status};
use crate::report::{DelayRange, EstimatedJoint, Finding, JointSummary};
use crate::wording::{hanging, parameter_value};

mod passage;
mod verdict;

use passage::first_order;
pub(crate) use passage::{Passage, Topic};

/// What is concluded of a joint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Conclusion {
    /// The verdict in one sentence.
    pub(crate) headline: String,
    /// What it rests on, question by question.
    pub(crate) passages: Vec<Passage>,
    /// Commands that do what it proposes.
    pub(crate) commands: Vec<String>,
}

impl Conclusion {
    /// What it rests on, without the questions.
    pub(crate) fn sentences(&self) -> String {
        let texts: Vec<String> = self.passages.iter().map(Passage::text).collect();
        texts.join(" ")
    }

    /// The words below the headline as they are printed.
    pub(super) fn printed(&self) -> String {
        let passage = |one: &Passage| hanging(&format!("{}: {}", one.topic.0, one.text()));
        let passages: Vec<String> = self.passages.iter().map(passage).collect();
        let commands = self.commands.iter().map(|command| format!("    {command}"));
        let blocks = std::iter::once(passages.join("\n")).chain(commands);
        blocks.collect::<Vec<_>>().join("\n\n") + "\n"
    }
}

impl Finding<'_> {
    /// The verdict in words.
    pub(crate) fn conclusion(&self) -> Conclusion {
        let best = self.proposed();
        let mut passages = match (self.verdict, best) {
            (_, Some(best)) => self.missing(best),
            (Verdict::Adequate, None) => self.adequate(),
            (Verdict::MissingEffect, None) => self.fails(),
            (_, None) => self.unexplained(),
        };
        passages.extend(self.curves());
        let structure = first_order(self.joint(), self.consequence().fit);
        passages.extend(Passage::of(Topic::STRUCTURE, structure));
        passages.extend(Passage::of(Topic::DELAY, self.delay()));
        passages.extend(Passage::of(Topic::TRIALS, self.conditions(best)));
        let command = |id: &&'static str| {
            // A bracket is a pattern to a shell.
            let id = if id.contains('[') { format!("'{id}'") } else { (*id).to_owned() };
            format!("tauscope add {id} {}", self.add_arguments)
        };
        let commands = best.iter().flat_map(|best| &best.effects).map(command).collect();
        let headline = format!("{}: {}", self.joint().name, self.headline());
        Conclusion { headline, passages, commands }
    }

    /// The verdict in one sentence, without the name of the joint.
    pub(crate) fn headline(&self) -> String {
        let found = match (self.verdict, self.proposed()) {
            (_, Some(best)) => self.missing_headline(best),
            (Verdict::Adequate, None) => self.adequate_headline(),
            (Verdict::MissingEffect, None) => self.open_headline(),
            (_, None) => self.unexplained_headline(),
        };
        self.caution().map_or(found.clone(), |caution| format!("{caution}; {found}"))
    }

    /// Why the input of the log may not be what moves the joint: a model of other columns explains
    /// nothing.
    pub(crate) fn caution(&self) -> Option<String> {
        let joint = EstimatedJoint { joint: self.joint(), estimate: self.delays? };
        Some(format!("{}: check the columns first", joint.obstacle()?.short))
    }

    /// In which trials the effects act that do not act in all.
    fn conditions(&self, best: Option<&Candidate>) -> Option<String> {
        let model = self.consequence().fit.model.components().iter();
        let components = model.chain(best.into_iter().flat_map(added));
        let of = components.filter_map(|component| component.effect().within_trials());
        let mut words: Vec<&str> = of.map(|of| of.word).collect();
        words.sort_unstable();
        words.dedup();
        let acts = |word: &&str| {
            format!("Effects with `[{word}]` act only in trials whose label contains `{word}`.")
        };
        (!words.is_empty()).then(|| words.iter().map(acts).collect::<Vec<_>>().join(" "))
    }

    /// The delay of the model beside those that were measured.
    fn delay(&self) -> Option<String> {
        let estimate = self.delays?;
        let measured = EstimatedJoint { joint: self.joint(), estimate };
        model_delay(self.consequence().fit, measured)
    }
}

/// What is to be said of the delay of a model: its value beside the measured ones, where it is one
/// number that a fit found, or that is fixed.
fn model_delay(of: &AssessedModel, measured: EstimatedJoint<'_>) -> Option<String> {
    let is_law =
        of.model.components().iter().any(|part| part.effect().spec().stage == Stage::Transport);
    let delay =
        of.parameters.iter().find(|parameter| parameter.name == "delay").filter(|_| !is_law)?;
    let measured = match measured.estimate.dead_time.as_ref().map(|found| found.finding) {
        Some(delay::Finding::Known(bounds) | delay::Finding::LagOnly(bounds)) => {
            format!("the dead time of the record is {:.3} to {:.3} s", bounds.low_s, bounds.high_s)
        }
        Some(delay::Finding::Unknown(_)) => return None,
        None => {
            let DelayRange { min, median, max } = JointSummary::of(measured).delay_s?;
            format!("those measured at the steps are {min:.3} to {max:.3} s, median {median:.3} s")
        }
    };
    let fitted = if delay.status == Status::Fixed {
        ""
    } else {
        " A measured delay includes lags after it, which a model may describe by another effect."
    };
    Some(format!("The delay of the model is {}; {measured}.{fitted}", parameter_value(delay, "s")))
}
