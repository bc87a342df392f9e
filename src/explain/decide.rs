//! Whether an effect is worth adding: one decision, for all who ask.
//!
//! An effect is added where the record shows it, determines it, and physics allows its values; where
//! nothing that is there already looks the same; where what was not fitted is predicted as well; and
//! where the error that it takes away has a practical consequence. The first of these that fails is the
//! reason for which it is refused.

use super::candidate::Candidate;
use super::determined::{are_determined, implausible};
use super::judgement::{Judgement, Refusal};
use super::likeness::are_distinguished;
use super::limiting_case::limiting_case_of;
use super::misfit::{AS_MUCH, Errors, Misfit};
use super::options::Options;
use crate::fit::{AssessedModel, Fit, FitRecord};

/// What candidates for one model are judged by.
pub(super) struct Judge<'a, 'r> {
    pub(super) record: &'a FitRecord<'r>,
    pub(super) base: &'a Fit,
    pub(super) own: Errors,
    pub(super) misfit: Misfit,
    pub(super) options: &'a Options,
    /// Whether many curves match the few levels of the input: more is then asked of a curve.
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
        let share = self.misfit.share(&self.own, &candidate.fit.errors);
        let determined = are_determined(&candidate.fit, &candidate.effects)
            && (!self.are_levels_few
                || candidate.determines_as_much_as(self.base)
                    && (candidate.is_distinct() || !candidate.is_steady()));
        let implausible = implausible(self.record, &candidate.fit, &candidate.effects);
        let mut judgement = Judgement {
            evidence: candidate.evidence,
            determined,
            plausible: implausible.is_none(),
            generalises: candidate.judgement.generalises,
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
        let (fit, new) = (&candidate.fit, &candidate.effects);
        if let Some(like) = like_another(self.record, fit, new, self.options) {
            return Some(like);
        }
        if !judged.generalises {
            return Some(Refusal::DoesNotGeneralise);
        }
        let matters = self.misfit.has_consequence(&self.own, &candidate.fit.errors);
        (!matters && !self.options.keeps_refinements).then_some(Refusal::NoConsequence)
    }

    /// Judges all of a ranking, of which the first that nothing speaks against is added and those
    /// after it are not; the place of the one that is added.
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

/// What the effects `new` of a fitted model are not distinguished from, where there is any such: an effect
/// beside them, or a simpler one in their place.
fn like_another(
    record: &FitRecord<'_>,
    fit: &AssessedModel,
    new: &[&'static str],
    options: &Options,
) -> Option<Refusal> {
    if !are_distinguished(fit, new, &record.range_for(&fit.model)) {
        return Some(Refusal::LikeAnother);
    }
    limiting_case_of(record, fit, new, options).map(Refusal::LimitingCase)
}

/// Whether nothing speaks against the effects `new` in the fitted model itself, whatever it is compared
/// with.
pub(super) fn is_founded(
    record: &FitRecord<'_>,
    fit: &AssessedModel,
    new: &[&'static str],
    options: &Options,
) -> bool {
    are_determined(fit, new)
        && implausible(record, fit, new).is_none()
        && like_another(record, fit, new, options).is_none()
}

/// A ranking as it is shown: by what each effect leaves on the part that was not fitted; of those that
/// leave as much, the one that is added comes first.
pub(super) fn in_order(mut ranking: Vec<Candidate>) -> Vec<Candidate> {
    ranking.sort_by(|a, b| a.rmse().total_cmp(&b.rmse()));
    if let Some(added) = ranking.iter().position(|one| one.judgement.is_added()) {
        let least = ranking[added].rmse() / AS_MUCH;
        let first = ranking[..added].partition_point(|one| one.rmse() < least);
        ranking[first..=added].rotate_right(1);
    }
    ranking
}

#[cfg(test)]
mod tests {
    use super::super::options::Tried;
    use super::super::ranking::{Scope, rank};
    use super::super::workers::Sequential;
    use super::*;
    use crate::effect::{
        ActuatorLag, Backlash, DeadBand, DirectionGain, Effect, FlowCurve, GravityLoad,
        InputOffset, InputSaturation, Leakage, RateLimit, ThermalDrift,
    };
    use crate::experiment::{Joint, Trial};
    use crate::fit::{Horizon, Split, fit};
    use crate::model::{Component, JointModel, Value};
    use crate::numerics::testing::normals;
    use crate::units::SamplePeriod;

    /// An integrator that is slower down than up, measured with noise.
    fn joint() -> Joint {
        let levels = [1.0, -0.7, 0.4, -1.0, 0.7, -0.4];
        let input: Vec<f64> = (0..2400).map(|k| levels[k / 60 % levels.len()]).collect();
        let (mut angle, mut normal) = (0.0, normals(3));
        let mut turn = |u: &f64| {
            angle += 0.02 * if *u < 0.0 { 0.8 * u } else { *u };
            angle + 0.01 * normal()
        };
        let output = input.iter().map(&mut turn).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trials = vec![Trial::new("1", 0.0, period, input, output).unwrap()];
        Joint {
            name: "boom".to_owned(),
            input_unit: None,
            output_unit: None,
            covariates: Vec::new(),
            trials: trials.into(),
        }
    }

    /// The integrator that fits `record` best.
    fn integrator(record: &FitRecord<'_>) -> Fit {
        let base = JointModel::integrator(1.0, 0.0);
        fit(record, &base, &record.range_for(&base)).unwrap()
    }

    #[test]
    fn of_many_effects_those_are_fitted_that_promise_most_and_all_that_are_asked_for() {
        let joint = joint();
        let record = FitRecord::new(&joint, Split::Blocks, Horizon::Auto);
        let base = integrator(&record);
        let effects: Vec<&'static dyn Effect> = vec![
            &ActuatorLag,
            &Backlash,
            &DeadBand,
            &DirectionGain,
            &FlowCurve,
            &GravityLoad,
            &InputOffset,
            &InputSaturation,
            &Leakage,
            &RateLimit,
            &ThermalDrift,
        ];
        let ranked = |tried| {
            let options = Options { effects: effects.clone(), tried, ..Options::default() };
            let misfit = Misfit::of(&record, &Errors::of(&record, &base));
            let judge = Judge::new(&record, &base, misfit, &options);
            let all = rank(&judge, Scope::SingleEffects, &Sequential);
            all.iter().map(Candidate::name).collect::<Vec<_>>()
        };
        let (some, all) = (ranked(Tried::WhereLacking), ranked(Tried::Always));
        assert!(some.len() < effects.len() && all.len() == effects.len(), "{some:?}, {all:?}");
        assert_eq!((some[0].as_str(), all[0].as_str()), ("direction_gain", "direction_gain"));
    }

    #[test]
    fn each_thing_that_speaks_against_an_effect_refuses_it() {
        let joint = joint();
        let record = FitRecord::new(&joint, Split::Blocks, Horizon::Auto);
        let base = integrator(&record);
        let options = Options { effects: vec![&DirectionGain], ..Options::default() };
        let misfit = Misfit::of(&record, &Errors::of(&record, &base));
        let judge = Judge::new(&record, &base, misfit, &options);
        let ranking = rank(&judge, Scope::SingleEffects, &Sequential);
        let candidate = &ranking[0];
        let sound = judge.judge(candidate);
        assert!(sound.is_added(), "{sound:?}");
        let with = |change: fn(&mut Judgement), implausible: Option<&str>| {
            let mut judgement = sound.clone();
            change(&mut judgement);
            judge.refusal(candidate, &judgement, implausible.map(str::to_owned))
        };
        assert_eq!(with(|one| one.determined = false, None), Some(Refusal::Undetermined));
        assert_eq!(with(|one| one.generalises = false, None), Some(Refusal::DoesNotGeneralise));
        let mut small = candidate.clone();
        small.fit.errors = judge.own.clone();
        assert_eq!(judge.refusal(&small, &sound, None), Some(Refusal::NoConsequence));
        let implausible = Refusal::Implausible("factor".to_owned());
        assert_eq!(with(|_| (), Some("factor")), Some(implausible));
        assert_eq!(with(|_| (), None), None);
        // Beside a limit that lies beyond the record, a curve that bends is not distinguished from it.
        let mut alike = candidate.clone();
        let limit = Component::new(&InputSaturation, [5.0, 0.2].map(Value::from).to_vec()).unwrap();
        alike.effects = vec!["flow_curve"];
        alike.fit.assessed.model = base.model.with(limit).with(Component::neutral(&FlowCurve));
        assert_eq!(judge.refusal(&alike, &sound, None), Some(Refusal::LikeAnother));
    }
}
