//! What `explain` and `improve` have found of a joint.

use super::consequence::Consequence;
use super::{Before, ComparedJoint};
use crate::diagnosis::sensor_noise;
use crate::effect::Spec;
use crate::explain::{Attribution, Candidate, Judgement, Verdict};
use crate::model::Component;
use crate::study::JointEstimate;

/// A joint, the verdict on its model, and the race behind it.
#[derive(Clone, Copy, Debug)]
pub struct Finding<'a> {
    /// The model that the verdict is about.
    pub compared: ComparedJoint<'a>,
    /// The verdict.
    pub verdict: Verdict,
    /// The candidates, best first.
    pub ranking: &'a [Candidate],
    /// What follows the effect on the command line that adds it.
    pub add_arguments: &'a str,
    /// The model to which effects were added, where any were.
    pub before: Option<Before<'a>>,
    /// What each effect carries that was added, or is proposed, where that was found out.
    pub attribution: Option<&'a Attribution>,
    /// The delays of its steps, where they were estimated.
    pub delays: Option<&'a JointEstimate>,
}

impl<'a> Finding<'a> {
    /// The candidate that is proposed.
    pub(super) fn proposed(&self) -> Option<&'a Candidate> {
        let mut added = self.ranking.iter().filter(|candidate| candidate.judgement.is_added());
        added.next().filter(|_| self.verdict == Verdict::MissingEffect)
    }

    /// What the effects explain that were added, or that are proposed.
    pub(super) fn consequence(&self) -> Consequence<'a> {
        let comparison = self.compared.comparison;
        let (fit, before, after) = match (self.before, self.proposed()) {
            (None, Some(best)) => {
                let before = comparison.judged().map(|error| error.rmse);
                (&best.fit.assessed, before, best.validation.or(best.training))
            }
            (before, _) => {
                let before = before.and_then(|before| before.rmse());
                (&comparison.fit.assessed, before, comparison.judged())
            }
        };
        let (joint, attribution) = (self.compared.joint, self.attribution);
        Consequence {
            joint,
            fit,
            attribution,
            before,
            after,
            sensor_noise: sensor_noise(&joint.trials),
        }
    }
}

/// The effects that a candidate added, in its order.
pub(super) fn added(candidate: &Candidate) -> impl Iterator<Item = &Component> {
    let components = candidate.fit.model.components();
    let of_id =
        |id: &&'static str| components.iter().find(|component| component.effect().spec().id == *id);
    candidate.effects.iter().filter_map(of_id)
}

pub(super) fn specs(candidate: &Candidate) -> impl Iterator<Item = &'static Spec> {
    added(candidate).map(|component| component.effect().spec())
}

/// `added: shown, …` or `refused: …`.
pub(super) fn judgement_text(judgement: &Judgement) -> String {
    format!("{}: {}", decision_id(judgement), judgement.reason())
}

/// What became of a candidate.
pub(super) fn decision_id(judgement: &Judgement) -> &'static str {
    if judgement.is_added() { "added" } else { "refused" }
}
