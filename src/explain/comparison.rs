//! Models with an effect more beside the model without: how much each explains, how surely,
//! and which of them the record cannot distinguish.

use super::candidate::{ALIKE, Candidate};
use super::evidence::{Evidence, NoiseMemory};
use super::extension::Extension;
use super::judgement::Judgement;
use super::misfit::{Errors, generalizes};
use crate::diagnosis::ErrorFigures;
use crate::fit::{Fit, FitRecord, Part};

/// What the error with measured delays must be, in parts of the error with a law of the delay,
/// for them to take its place; and that with a finer form of an effect, in parts of the error with
/// any other, for it to be offered at once.
pub(super) const MUCH_LESS: f64 = 0.8;

/// The candidates that `extensions` of the model of `base` are, best first.
pub(super) fn compared(
    record: &FitRecord<'_>,
    base: &Fit,
    noise_floor: f64,
    extensions: Vec<Extension>,
) -> Vec<Candidate> {
    let error = |one: &Extension| one.fit.errors.whole;
    let Some(best) = extensions.iter().min_by(|a, b| error(a).total_cmp(&error(b))) else {
        return Vec::new();
    };
    let noise = NoiseMemory::of(record, &best.fit.on(record));
    let (of_base, errors) = (Judged::of(record, base, &noise), Errors::of(record, base));
    let candidate = |extension| of_base.candidate(record, &noise, noise_floor, &errors, extension);
    let mut candidates: Vec<Candidate> = extensions.into_iter().map(candidate).collect();
    candidates.sort_by(|a, b| a.behind.total_cmp(&b.behind));
    keep_one_form(&mut candidates);
    let least = candidates.first().map_or(0.0, |best| best.behind);
    let alike = alike(&candidates);
    for (candidate, alike) in candidates.iter_mut().zip(alike) {
        candidate.behind -= least;
        candidate.indistinguishable_from = alike;
    }
    candidates
}

/// The errors of a model and its evidence.
struct Judged {
    training: Option<ErrorFigures>,
    validation: Option<ErrorFigures>,
    evidence: Evidence,
}

impl Judged {
    fn of(record: &FitRecord<'_>, fit: &Fit, noise: &NoiseMemory) -> Self {
        let error = |part| ErrorFigures::of(record, &fit.evaluation, part);
        let evidence = noise.evidence(record, fit);
        Self { training: error(Part::Training), validation: error(Part::Validation), evidence }
    }

    /// The mean square error on the training part.
    fn training_square(&self) -> f64 {
        self.training.map_or(f64::NAN, |e| e.rmse * e.rmse)
    }

    /// `extension` beside this model, which it extends and which has these `errors`.
    fn candidate(
        &self,
        record: &FitRecord<'_>,
        noise: &NoiseMemory,
        noise_floor: f64,
        errors: &Errors,
        extension: Extension,
    ) -> Candidate {
        let fit = extension.fit.on(record);
        let own = Self::of(record, &fit, noise);
        let (square, base_square) = (own.training_square(), self.training_square());
        let (before, after) = match (self.validation, own.validation) {
            (Some(before), Some(after)) => (before.rmse, after.rmse),
            _ => (base_square.sqrt(), square.sqrt()),
        };
        let (behind, deviance) = (own.evidence.criterion(), own.evidence.deviance());
        let evidence = self.evidence.criterion() - behind;
        let tested = if extension.nests() { own.evidence } else { own.evidence.not_nested() };
        let p_value = tested.p_value_against(&self.evidence);
        let misfit = (base_square - noise_floor * noise_floor).max(f64::MIN_POSITIVE);
        Candidate {
            effects: extension.effects,
            training: own.training,
            validation: own.validation,
            error_reduction_percent: 100.0 * (1.0 - after / before),
            training_reduction_percent: 100.0 * (1.0 - (square / base_square).sqrt()),
            p_value,
            // Where the error is that of the noise there is hardly a misfit to share.
            share_of_misfit: ((base_square - square) / misfit).clamp(-1.0, 1.0),
            behind,
            evidence,
            judgement: Judgement {
                generalises: generalizes(errors, &extension.fit.errors),
                ..Judgement::pending(evidence)
            },
            deviance,
            indistinguishable_from: Vec::new(),
            separated_by: Vec::new(),
            fit: extension.fit,
        }
    }
}

/// Of an effect that is there by its law and by measured delays keeps one: the law, which says
/// more, where the error with measured delays is not much less.
fn keep_one_form(candidates: &mut Vec<Candidate>) {
    let is_measured = |candidate: &Candidate| candidate.fit.model.takes_measured_delays();
    let forms: Vec<_> =
        candidates.iter().map(|c| (c.effects.clone(), is_measured(c), c.rmse())).collect();
    candidates.retain(|candidate| {
        let measured = is_measured(candidate);
        let mut twins = forms
            .iter()
            .filter(|(effects, of_twin, _)| *effects == candidate.effects && *of_twin != measured);
        twins.all(|(_, _, of_twin)| {
            let (law, delays) =
                if measured { (*of_twin, candidate.rmse()) } else { (candidate.rmse(), *of_twin) };
            measured == (delays < MUCH_LESS * law)
        })
    });
}

/// For each candidate the others under which the record is as likely, but for what noise
/// does.
fn alike(candidates: &[Candidate]) -> Vec<Vec<&'static str>> {
    let of = |one: &Candidate| {
        let others = candidates.iter().filter(|other| other.effects != one.effects);
        let others = others.filter(|other| (other.deviance - one.deviance).abs() < ALIKE);
        others.flat_map(|other| other.effects.iter().copied()).collect()
    };
    candidates.iter().map(of).collect()
}
