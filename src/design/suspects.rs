//! Two effects, of which one is missing from a model.

use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Normal};

use super::predict::{TestRig, Uncertain};
use super::random::{RandomSteps, random_steps};
use crate::diagnosis::sensor_noise;
use crate::effect::Effect;
use crate::explain::ALIKE;
use crate::fit::{Fit, FitError, FitRecord, Horizon, Split, fit};
use crate::model::{Component, JointModel};

/// A model that lacks one of two effects.
#[derive(Clone, Debug)]
pub struct Suspects {
    /// The effects.
    pub effects: [&'static dyn Effect; 2],
    /// The model with neither.
    pub base: JointModel,
    /// The model with each, at the numbers that are known.
    pub models: [Uncertain; 2],
    /// Standard deviation of the measurement noise, output units.
    pub noise: f64,
    /// Whether a record speaks against each, clearly: an experiment need not be made for it.
    pub excluded: [bool; 2],
}

/// Why there is nothing to separate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SuspectsError {
    /// A model cannot be fitted.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The noise of the record is not known.
    #[error("no noise can be seen in the record")]
    NoNoise,
}

impl Suspects {
    /// Both effects fitted to a record, each beside `base`. The noise is that of the record
    /// where it is not given; what the record does not determine is off by `share` of its value.
    ///
    /// # Errors
    /// [`SuspectsError`].
    pub fn of_record(
        record: &FitRecord<'_>,
        base: &JointModel,
        effects: [&'static dyn Effect; 2],
        noise: Option<f64>,
        share: f64,
    ) -> Result<Self, SuspectsError> {
        let plain = fitted(record, base)?;
        let [one, other] = effects.map(|effect| {
            let starts = plain.model.with(Component::neutral(effect));
            fitted(record, &starts)
        });
        let (one, other) = (one?, other?);
        let noise =
            noise.or_else(|| sensor_noise(&record.measured().trials)).filter(|noise| *noise > 0.0);
        let noise = noise.ok_or(SuspectsError::NoNoise)?;
        let models = [&one, &other].map(|fit| Uncertain::of_fit(record, fit, noise, share));
        let ahead = behind(&other) - behind(&one);
        let excluded = [-ahead > CLEAR, ahead > CLEAR];
        Ok(Self { effects, base: plain.assessment.assessed.model, models, noise, excluded })
    }

    /// `model`, which has the first of `effects`, and the same with the second in its place: as
    /// a record of random `steps` of the first would show it.
    ///
    /// # Errors
    /// [`SuspectsError`].
    pub fn of_model(
        model: &JointModel,
        effects: [&'static dyn Effect; 2],
        noise: f64,
        share: f64,
        (rig, steps): (&TestRig, &RandomSteps),
    ) -> Result<Self, SuspectsError> {
        let known = Uncertain::by_share(model.clone(), share);
        let schedule = random_steps(steps, rig, Some(&known), 0);
        let mut random = ChaCha8Rng::seed_from_u64(steps.seed);
        let output = noisy(rig.output(model, &schedule), noise, &mut random);
        let Some(joint) = rig.log(&schedule, output) else { return Err(SuspectsError::NoNoise) };
        let record = FitRecord::new(&joint, Split::of(&joint), Horizon::Steps);
        let base = model.without(effects[0].spec().id);
        let of_record = Self::of_record(&record, &base, effects, Some(noise), share)?;
        let [_, other] = of_record.models;
        let models = [known, Uncertain::by_share(other.model, share)];
        // What the model would do is no evidence against the other.
        Ok(Self { models, excluded: [false; 2], ..of_record })
    }

    /// Ids of the effects.
    pub fn ids(&self) -> [&'static str; 2] {
        self.effects.map(|effect| effect.spec().id)
    }
}

/// Twice the difference in log-likelihood at which a record speaks against a suspect: well
/// beyond that at which two are distinguished, as neither model is the joint.
const CLEAR: f64 = 10.0 * ALIKE;

/// Twice the negative log-likelihood of `fit`, but for what all fits of a record share.
fn behind(fit: &Fit) -> f64 {
    let residuals = fit.evaluation.residuals.iter().flatten();
    let (samples, sum) = residuals.fold((0, 0.0), |(n, sum), e| (n + 1, sum + e * e));
    f64::from(samples) * (sum / f64::from(samples.max(1))).max(f64::MIN_POSITIVE).ln()
}

fn fitted(record: &FitRecord<'_>, model: &JointModel) -> Result<Fit, FitError> {
    fit(record, model, &record.range_for(model))
}

/// `output` with white noise.
pub(super) fn noisy(output: Vec<f64>, noise: f64, random: &mut ChaCha8Rng) -> Vec<f64> {
    let Ok(normal) = Normal::new(0.0, noise) else { return output };
    output.into_iter().map(|angle| angle + normal.sample(random)).collect()
}
