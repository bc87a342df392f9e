//! How much of what a model lacked an effect explains, and when that has a practical consequence.

use std::sync::Arc;

use crate::diagnosis::{BEYOND_NOISE, ErrorFigures, sensor_noise};
use crate::fit::{Fit, FitRecord, Part};

/// The share of the misfit from which an effect has a practical consequence near the noise: what other
/// effects leave whose law is not quite that of the plant is as large. Of 171 simulated records with laws
/// of another form than the catalogue's, 1 of 312 effects that act took less, and 5 of 33 that do not.
const CONSEQUENCE: f64 = 0.03;

/// The share from which it has one where the error without it is far from the noise, or where it takes nearly
/// all that is left: there something is missing for sure.
const FAR_FROM_NOISE: f64 = 0.01;

/// The part of the misfit below which what a model leaves is explained.
const HARDLY: f64 = 0.05;

/// What an error may be larger by and still be as much: a digit that is hardly printed.
pub(super) const AS_MUCH: f64 = 1.001;

/// Whether `after` predicts the part that was not fitted as well as `before`: a model that fits what it
/// has seen and nothing else explains nothing.
///
/// The squared errors of both are compared batch by batch, `d_b = Σ e_after² − Σ e_before²`. It does where
/// their mean is at most one standard error above 0 (the rule of one standard error of L. Breiman et al.,
/// "Classification and Regression Trees", 1984, section 3.4.3), or the error grows by less than is printed:
/// what does not act there changes it a little, too, in either direction.
pub(super) fn generalizes(before: &Errors, after: &Errors) -> bool {
    let batches = before.unseen_batches.iter().zip(after.unseen_batches.iter());
    let changes: Vec<f64> = batches.map(|(before, after)| after - before).collect();
    let count = changes.len() as f64;
    let mean = changes.iter().sum::<f64>() / count;
    let spread = changes.iter().map(|change| (change - mean).powi(2)).sum::<f64>();
    let is_as_much = before.unseen.zip(after.unseen).is_none_or(|(a, b)| b <= AS_MUCH * a);
    is_as_much || mean <= (spread / (count * (count - 1.0))).sqrt()
}

/// How far the model was off to which effects are added: what shares are parts of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Misfit {
    /// The error of that model on the whole record.
    first: f64,
    /// The error of that model on the part that was not fitted, where there is one.
    unseen: Option<f64>,
    noise: f64,
}

/// The root-mean-square errors of a model.
#[derive(Clone, Debug)]
pub(super) struct Errors {
    /// On the whole record.
    pub(super) whole: f64,
    /// On the part that was fitted, where it has samples.
    pub(super) seen: Option<f64>,
    /// On the part that was not fitted, where there is one.
    unseen: Option<f64>,
    /// The sums of squares of that part, batch by batch.
    unseen_batches: Arc<[f64]>,
}

impl Errors {
    pub(super) fn of(record: &FitRecord<'_>, fit: &Fit) -> Self {
        let whole = ErrorFigures::of_record(record, &fit.evaluation);
        let on = |part| Some(ErrorFigures::of(record, &fit.evaluation, part)?.rmse);
        Self {
            whole: whole.map_or(f64::NAN, |error| error.rmse),
            seen: on(Part::Training),
            unseen: on(Part::Validation),
            unseen_batches: batches(&record.cut(&fit.evaluation.residuals, Part::Validation)),
        }
    }

    /// That by which a model is judged.
    pub(super) fn judged(&self) -> f64 {
        self.unseen.or(self.seen).unwrap_or(self.whole)
    }

    /// That of the part on which it is larger: where a record is explained, both its parts are.
    pub(super) fn largest(&self) -> f64 {
        self.seen.into_iter().chain(self.unseen).fold(self.whole, f64::max)
    }

    /// Whether the error of the whole record is less than so large a part of that of `other`.
    pub(super) fn leave_less_than(&self, part: f64, other: &Self) -> bool {
        self.whole < part * other.whole
    }
}

/// The sums of squares of the residuals of windows, each of which is cut into as many batches as it takes to
/// have ten of all.
fn batches(windows: &[Vec<f64>]) -> Arc<[f64]> {
    /// Batches that give a standard error, at least: of the 10 to 30 that are usual (B. Schmeiser, "Batch
    /// size effects in the analysis of simulation output", Operations Research 30 (1982), 556-568).
    const FEWEST: usize = 10;
    let of_each = FEWEST.div_ceil(windows.len().max(1));
    let cut = |window: &Vec<f64>| {
        let length = window.len().div_ceil(of_each).max(1);
        let sums = window.chunks(length).map(|batch| batch.iter().map(|e| e * e).sum());
        sums.collect::<Vec<f64>>()
    };
    windows.iter().flat_map(cut).collect()
}

impl Misfit {
    /// That of a model with the errors `first`.
    pub(super) fn of(record: &FitRecord<'_>, first: &Errors) -> Self {
        let (first, unseen) = (first.whole, first.unseen);
        let noise = sensor_noise(&record.measured().trials).unwrap_or(0.0).min(first);
        Self { first, unseen, noise }
    }

    /// What the error of `worse` is larger than that of `better`, in parts of the misfit.
    pub(super) fn share(self, worse: &Errors, better: &Errors) -> f64 {
        self.part_of(self.first, worse.whole - better.whole)
    }

    /// The larger of the shares on the whole record and on the part that was not fitted.
    ///
    /// An effect that only the unseen part needs is needed.
    pub(super) fn share_of_either(self, worse: &Errors, better: &Errors) -> f64 {
        let unseen = self.unseen.zip(worse.unseen.zip(better.unseen));
        let unseen = unseen.map(|(first, (worse, better))| self.part_of(first, worse - better));
        self.share(worse, better).max(unseen.unwrap_or(f64::NEG_INFINITY))
    }

    /// Whether an effect has a practical consequence with which the error falls from that of
    /// `worse` to that of `better`: where it takes a part of the misfit, a smaller one where it takes most of
    /// what is left without it; or where the error without it is beyond a few times the noise and it takes a
    /// part of what is left, however small a part of the misfit that is.
    pub(super) fn has_consequence(self, worse: &Errors, better: &Errors) -> bool {
        /// The part of the squared error beyond the noise. Chosen: an eighth of the error.
        const OF_WHAT_IS_LEFT: f64 = 0.25;
        /// The part of it that is most of it: half of the error is left at most.
        const MOST: f64 = 0.75;
        let takes_most = self.takes(MOST, worse, better);
        let least = if takes_most { FAR_FROM_NOISE } else { self.least_share(worse) };
        self.share(worse, better) >= least
            || self.is_far_from_noise(worse) && self.takes(OF_WHAT_IS_LEFT, worse, better)
    }

    /// The share of the misfit from which an effect has a practical consequence, where the error without
    /// it is that of `worse`.
    pub(super) fn least_share(self, worse: &Errors) -> f64 {
        if self.is_far_from_noise(worse) { FAR_FROM_NOISE } else { CONSEQUENCE }
    }

    /// Whether an effect is credible without which the error is that of `without`, and with it that of
    /// `with`: where it takes at least half of the squared error beyond the noise that is there without
    /// it, so that no more is left unexplained than it explains.
    ///
    /// Of a misfit that no known effect makes, the nearest of them takes a part by chance; of one
    /// that it makes itself it takes nearly all.
    pub(super) fn is_credible(self, without: &Errors, with: &Errors) -> bool {
        /// The part of the squared error that it takes at least. Chosen: of misfits from outside the
        /// catalogue the nearest effect takes less.
        const HALF: f64 = 0.5;
        self.takes(HALF, without, with)
    }

    /// Whether so large a part of the squared error of `worse` beyond the noise is not there in `better`.
    fn takes(self, part: f64, worse: &Errors, better: &Errors) -> bool {
        /// The noise, in parts of its estimate, at most. Chosen: that of 132 simulated records was 1.03
        /// times its estimate at most.
        const NOISE: f64 = 1.1;
        let noise = NOISE * self.noise;
        let beyond = |errors: &Errors| (errors.whole.powi(2) - noise.powi(2)).max(0.0);
        beyond(worse) - beyond(better) >= part * beyond(worse)
    }

    /// Whether a model leaves more than a few times the noise.
    pub(super) fn is_far_from_noise(self, errors: &Errors) -> bool {
        errors.judged() > BEYOND_NOISE * self.noise
    }

    /// Whether what a model leaves beside the noise is hardly a part of the misfit, and no more than a
    /// few times the noise.
    pub(super) fn is_explained(self, errors: &Errors) -> bool {
        self.part_of(self.first, errors.whole - self.noise) < HARDLY
            && !self.is_far_from_noise(errors)
    }

    /// `error` in parts of that of the first model beyond the noise.
    fn part_of(self, first: f64, error: f64) -> f64 {
        error / (first - self.noise).max(f64::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::experiment::{Joint, Trial};
    use crate::fit::{Horizon, Split, fit};
    use crate::model::JointModel;
    use crate::units::SamplePeriod;

    /// An integrator that was driven up and down.
    fn joint() -> Joint {
        let input: Vec<f64> = (0..400).map(|k| if k / 40 % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let mut angle = 0.0;
        let mut turn = |u: &f64| {
            angle += 0.02 * u;
            angle
        };
        let output = input.iter().map(&mut turn).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trials = vec![Trial::new("1", 0.0, period, input, output).unwrap()];
        let name = "boom".to_owned();
        Joint {
            name,
            input_unit: None,
            output_unit: None,
            covariates: Vec::new(),
            trials: trials.into(),
        }
    }

    #[test]
    fn what_predicts_the_unseen_part_worse_does_not_generalize() {
        let joint = joint();
        let record = FitRecord::new(&joint, Split::Time(0.6), Horizon::Auto);
        let exact = fit(&record, &JointModel::integrator(1.0, 0.0), &record.range(1.0)).unwrap();
        // The unseen part is off by so much everywhere.
        let off_by = |error: f64| {
            let mut fit = exact.clone();
            let evaluation = Arc::make_mut(&mut fit.assessment.evaluation);
            let residuals = evaluation.residuals.iter_mut().flatten();
            residuals.enumerate().for_each(|(k, e)| *e = if k < 240 { 0.1 } else { error });
            Errors::of(&record, &fit)
        };
        let holds = |before, after| generalizes(&off_by(before), &off_by(after));
        assert!(holds(0.5, 0.2) && holds(0.2, 0.2001));
        assert!(!holds(0.2, 0.201) && !holds(0.5, 0.51));
        // Worse on the whole, but in one part of it alone, and better in the others.
        let mut mixed = off_by(0.2);
        mixed.unseen = Some(0.21);
        let part = |k: usize, sum: &f64| if k == 0 { 3.0 * sum } else { 0.9 * sum };
        mixed.unseen_batches =
            mixed.unseen_batches.iter().enumerate().map(|(k, sum)| part(k, sum)).collect();
        assert!(generalizes(&off_by(0.2), &mixed));
        let whole = FitRecord::new(&joint, Split::Time(1.0), Horizon::Auto);
        let errors = Errors::of(&whole, &exact);
        assert!(generalizes(&errors, &errors), "nothing is unseen");
    }

    #[test]
    fn what_is_left_counts_where_it_is_far_beyond_the_noise() {
        let misfit = Misfit { first: 10.0, unseen: None, noise: 0.01 };
        let of =
            |whole: f64| Errors { whole, seen: None, unseen: None, unseen_batches: Arc::default() };
        assert!(misfit.has_consequence(&of(10.0), &of(9.8)), "a part of the misfit");
        let small = Misfit { first: 0.1, ..misfit };
        assert!(!small.has_consequence(&of(0.025), &of(0.0235)), "a small part near the noise");
        assert!(small.has_consequence(&of(0.025), &of(0.02)), "a part near the noise");
        assert!(misfit.has_consequence(&of(0.08), &of(0.04)), "most of what is left");
        assert!(!misfit.has_consequence(&of(0.08), &of(0.075)), "little of what is left");
        assert!(!misfit.has_consequence(&of(0.025), &of(0.012)), "what is left is near the noise");
        let larger = Misfit { first: 0.5, ..misfit };
        assert!(larger.has_consequence(&of(0.025), &of(0.012)), "nearly all of what is left");
        assert!(!larger.has_consequence(&of(0.025), &of(0.017)), "less than most of it");
    }
}
