//! Whether an effect is worth adding: one decision, whoever asks.
//!
//! An effect is added where the record shows it, determines it, and physics allows its values; where
//! nothing that is there already looks the same; where what was not fitted is predicted as well; and
//! where the error that it takes away is of consequence. The first of these that fails is the reason
//! for which it is refused.

use super::candidate::Candidate;
use super::determined::{implausible, is_determined, is_reached};
use super::judgement::{Judgement, Refusal};
use super::likeness::are_distinguished;
use super::limiting_case::limiting_case_of;
use super::misfit::{CONSEQUENCE, Errors, Misfit};
use super::options::Options;
use crate::fit::{Fit, FitRecord};

/// What candidates for one model are judged by.
pub(super) struct Judge<'a, 'r> {
    record: &'a FitRecord<'r>,
    base: &'a Fit,
    own: Errors,
    misfit: Misfit,
    options: &'a Options,
    /// Whether many curves match the few levels of the input: more is then asked of an effect.
    pub(super) are_levels_few: bool,
}

impl<'a, 'r> Judge<'a, 'r> {
    pub(super) fn new(
        record: &'a FitRecord<'r>,
        base: &'a Fit,
        misfit: Misfit,
        options: &'a Options,
    ) -> Self {
        let (own, are_levels_few) = (Errors::of(record, base), false);
        Self { record, base, own, misfit, options, are_levels_few }
    }

    /// Judges one candidate by itself.
    pub(super) fn judge(&self, candidate: &Candidate) -> Judgement {
        let share = self.misfit.share(self.own, candidate.fit.errors);
        let determines =
            |one| is_reached(&candidate.fit, one) && is_determined(&candidate.fit, one);
        let determined = candidate.added().all(determines)
            && (!self.are_levels_few
                || candidate.determines_as_much_as(self.base) && candidate.is_distinct());
        let range = self.record.range_for(&candidate.fit.model);
        let implausible = candidate.added().find_map(|one| implausible(one, &range));
        let generalises = self.misfit.generalizes(self.own, candidate.fit.errors);
        let mut judgement = Judgement {
            evidence: candidate.evidence,
            determined,
            plausible: implausible.is_none(),
            generalises,
            consequence_percent: 100.0 * share,
            refusal: None,
        };
        judgement.refusal = self.refusal(candidate, &judgement, implausible);
        judgement
    }

    /// The first thing that speaks against a candidate.
    fn refusal(
        &self,
        candidate: &Candidate,
        judged: &Judgement,
        implausible: Option<String>,
    ) -> Option<Refusal> {
        if !candidate.is_shown() {
            return Some(Refusal::NotSignificant);
        }
        if !judged.determined {
            return Some(Refusal::Undetermined);
        }
        if let Some(parameter) = implausible {
            return Some(Refusal::Implausible(parameter));
        }
        let range = self.record.range_for(&candidate.fit.model);
        if !are_distinguished(&candidate.fit, &candidate.effects, &range) {
            return Some(Refusal::LikeAnother);
        }
        let (record, options) = (self.record, self.options);
        if let Some(case) = limiting_case_of(record, &candidate.fit, &candidate.effects, options) {
            return Some(Refusal::LimitingCase(case));
        }
        if !judged.generalises {
            return Some(Refusal::DoesNotGeneralise);
        }
        let is_small = judged.consequence_percent < 100.0 * CONSEQUENCE;
        (is_small && !options.keeps_refinements).then_some(Refusal::NoConsequence)
    }

    /// Judges all of a ranking, of which the first that nothing speaks against is added and those
    /// behind it are not; the place of the one that is added.
    pub(super) fn judge_all(&self, ranking: &mut [Candidate]) -> Option<usize> {
        for candidate in &mut *ranking {
            candidate.judgement = self.judge(candidate);
        }
        let best = ranking.iter().position(|candidate| candidate.judgement.is_added())?;
        let name = ranking[best].name();
        let others = ranking.iter_mut().enumerate().filter(|(index, _)| *index != best);
        for (_, other) in others.filter(|(_, other)| other.judgement.is_added()) {
            other.judgement.refusal = Some(Refusal::Behind(name.clone()));
        }
        Some(best)
    }
}

/// A ranking as it is shown: by what each effect leaves on the part that was not fitted.
pub(super) fn in_order(mut ranking: Vec<Candidate>) -> Vec<Candidate> {
    ranking.sort_by(|a, b| a.rmse().total_cmp(&b.rmse()));
    ranking
}
