//! How well a record knows the numbers of a model.
//!
//! # References
//! J. Goodman and J. Weare, "Ensemble samplers with affine invariance", Communications in
//! Applied Mathematics and Computational Science 5 (2010), 65-80.

use rand::seq::IndexedRandom as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

use super::predict::{Uncertain, values, with_value};
use crate::effect::is_unlimited;
use crate::experiment::Trial;
use crate::fit::{Assessment, FitRecord, Status};
use crate::model::JointModel;

/// Standard deviations within which a number lies.
const DEVIATIONS: f64 = 2.0;

impl Uncertain {
    /// A fitted model with its standard errors.
    ///
    /// A parameter that has none, such as a level between two levels of the input, is
    /// somewhere in the range in which the record is as likely: it is put into the middle of
    /// that, which is four standard deviations wide. Where there is no such range, it is off by
    /// `share` of its value.
    pub fn of_fit(record: &FitRecord<'_>, fit: &Assessment, noise: f64, share: f64) -> Self {
        let mut known = Self::by_share(fit.model.clone(), share);
        for (place, parameter) in fit.parameters.iter().enumerate() {
            let is_free = matches!(
                parameter.status,
                Status::Undetermined | Status::BeyondReach | Status::AtBound
            );
            let span = is_free.then(|| span(record, &known.model, place, noise)).flatten();
            let deviation = match (span, parameter.std_error) {
                (Some((low, high)), _) => {
                    known.model = with_value(&known.model, place, 0.5 * (low + high));
                    0.5 * (high - low) / DEVIATIONS
                }
                (None, Some(error)) => error,
                (None, None) => continue,
            };
            if let Some(slot) = known.deviations.get_mut(place) {
                *slot = deviation;
            }
        }
        let (draws, best) = likely(record, &known, noise);
        known.draws = draws;
        // A descent may have ended in a corner that a walk finds the way out of.
        Self { model: best.unwrap_or(known.model), ..known }
    }

    /// The model with numbers that are drawn from what is known of them.
    pub(super) fn drawn(&self, random: &mut ChaCha8Rng) -> JointModel {
        let drawn = self.draws.choose(random).cloned();
        drawn.unwrap_or_else(|| self.apart(1.0, random))
    }

    /// The model with each number drawn by itself, `scale` times as far as it may be off.
    fn apart(&self, scale: f64, random: &mut ChaCha8Rng) -> JointModel {
        let limits = limits(&self.model);
        let values = self.model.values().into_iter().zip(&self.deviations).zip(limits);
        let drawn = values.map(|((value, deviation), (low, high))| {
            let by: f64 = StandardNormal.sample(random);
            let by = by.clamp(-DEVIATIONS, DEVIATIONS);
            (value.value + scale * by * deviation).clamp(low, high)
        });
        self.model.with_values(&drawn.collect::<Vec<_>>())
    }
}

/// Models with numbers that the record holds for likely, all parameters drawn together.
///
/// An ensemble of models moves along the lines between them (Goodman and Weare 2010), which
/// needs no scale: it follows what only a combination of parameters determines, and crosses
/// ranges in which nothing changes. Where the model cannot follow the record, its residual
/// takes the place of the noise. The second is the best of all, where it is clearly better
/// than the one that is known.
fn likely(
    record: &FitRecord<'_>,
    known: &Uncertain,
    noise: f64,
) -> (Vec<JointModel>, Option<JointModel>) {
    /// Models of the ensemble.
    const WALKERS: usize = 24;
    /// The first models lie near the best one: so far, in parts of what is known by itself.
    const NEAR: f64 = 0.3;
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let samples: usize = record.joint().trials.iter().map(Trial::len).sum();
    let least = cost(record, &known.model, noise);
    // Variances are of the noise, or of the residual where that is more.
    let scale = (least / samples.max(1) as f64).max(1.0);
    let cost = |model: &JointModel| cost(record, model, noise) / scale;
    let walker = |_| {
        let model = known.apart(NEAR, &mut random);
        Walker { cost: cost(&model), values: values(&model) }
    };
    let mut walkers: Vec<Walker> = (0..WALKERS).map(walker).collect();
    let free = known.deviations.iter().filter(|deviation| **deviation > 0.0).count();
    let limits = limits(&known.model);
    // Better than what is known by two standard deviations.
    let mut best = Walker { cost: least / scale - DEVIATIONS * DEVIATIONS, values: Vec::new() };
    for _ in 0..sweeps(samples, WALKERS) {
        for place in 0..WALKERS {
            // Any other, with equal probability: the move is symmetric but for z.
            let other = (place + random.random_range(1..WALKERS)) % WALKERS;
            let stretch = stretch(random.random());
            let Some((old, new)) = stretched(&walkers, place, other, stretch, &limits) else {
                continue;
            };
            let new = Walker { cost: cost(&known.model.with_values(&new)), values: new };
            if new.cost < best.cost {
                best = new.clone();
            }
            // Goodman and Weare: accepted with the probability min(1, z^(k−1)·p(new)/p(old)).
            let gain = 0.5 * (old - new.cost) + (free.max(1) - 1) as f64 * stretch.ln();
            if gain >= random.random::<f64>().ln()
                && let Some(walker) = walkers.get_mut(place)
            {
                *walker = new;
            }
        }
    }
    let model = |walker: &Walker| known.model.with_values(&walker.values);
    let better = (!best.values.is_empty()).then(|| model(&best));
    (walkers.iter().map(model).collect(), better)
}

/// A model of an ensemble.
#[derive(Clone)]
struct Walker {
    values: Vec<f64>,
    /// Twice its negative log-likelihood.
    cost: f64,
}

/// How often each model of an ensemble is moved: fewer times on a long record, which is long
/// in coming and determines more.
fn sweeps(samples: usize, walkers: usize) -> usize {
    const SAMPLES: usize = 60_000_000;
    (SAMPLES / (samples * walkers).max(1)).clamp(10, 80)
}

/// How far a model moves on the line from another, of a random number from 0 to 1: from half
/// the distance to twice, with a density of one over the root.
fn stretch(random: f64) -> f64 {
    /// Goodman and Weare's `a`, for which they take 2.
    const MOST: f64 = 2.0;
    // The inverse of the distribution of z on [1/a, a] with the density ∝ 1/√z.
    ((MOST - 1.0) * random + 1.0).powi(2) / MOST
}

/// The cost of the model at `place`, and where it comes to on the line from the `other`;
/// `None` where that is not allowed.
fn stretched(
    walkers: &[Walker],
    place: usize,
    other: usize,
    stretch: f64,
    limits: &[(f64, f64)],
) -> Option<(f64, Vec<f64>)> {
    let (here, from) = (walkers.get(place)?, walkers.get(other)?);
    let moved = from.values.iter().zip(&here.values).map(|(from, here)| {
        // What is fixed stays as it is, digit for digit.
        // x_j + z·(x_k − x_j).
        from + stretch * (here - from)
    });
    let moved: Vec<f64> = moved.collect();
    let is_allowed = |(value, (low, high)): (&f64, &(f64, f64))| value >= low && value <= high;
    moved.iter().zip(limits).all(is_allowed).then_some((here.cost, moved))
}

/// The squared residual of `model`, in variances of the noise.
fn cost(record: &FitRecord<'_>, model: &JointModel, noise: f64) -> f64 {
    let residuals = record.evaluate_residuals(model).residuals;
    residuals.iter().flatten().map(|e| e * e).sum::<f64>() / (noise * noise)
}

/// Lowest and highest value of each parameter.
fn limits(model: &JointModel) -> Vec<(f64, f64)> {
    let specs = model.components().iter().map(|component| component.effect().spec());
    let own = specs.flat_map(|spec| spec.parameters.iter().map(|p| (p.min, p.max)));
    [(f64::MIN, f64::MAX), (0.0, f64::MAX)].into_iter().chain(own).collect()
}

/// The range of a parameter about its value in which the record is as likely, the others
/// held.
fn span(
    record: &FitRecord<'_>,
    model: &JointModel,
    place: usize,
    noise: f64,
) -> Option<(f64, f64)> {
    /// First step from the value, in parts of it, and the growth of further ones.
    const FIRST: f64 = 0.01;
    const GROWTH: f64 = 1.5;
    const STEPS: i32 = 18;
    /// Twice the log-likelihood ratio of two standard deviations.
    const AS_LIKELY: f64 = DEVIATIONS * DEVIATIONS;
    let value = model.values().get(place)?.value;
    let (low, high) = limits(model).get(place).copied()?;
    if is_unlimited(value) || value.abs() <= f64::MIN_POSITIVE {
        return None;
    }
    let cost = |value: f64| cost(record, &with_value(model, place, value), noise);
    let least = cost(value);
    let end = |sign: f64| {
        let steps = (0..STEPS).map(|k| FIRST * GROWTH.powi(k) * value.abs());
        let mut reached = value;
        for step in steps {
            let next = (value + sign * step).clamp(low, high);
            if cost(next) > least + AS_LIKELY {
                break;
            }
            reached = next;
        }
        reached
    };
    let span = (end(-1.0), end(1.0));
    (span.1 > span.0).then_some(span)
}

#[cfg(test)]
mod tests {
    use super::super::predict::tests::rig;
    use super::super::random::{RandomSteps, random_steps};
    use super::*;
    use crate::effect::Stiction;
    use crate::fit::{Horizon, Split, assess};
    use crate::model::Component;

    #[test]
    fn a_level_between_two_of_the_input_is_anywhere_between() {
        let levels = vec![-2.0, -1.0, -0.5, 0.5, 1.0, 2.0];
        let steps = RandomSteps { levels, hold_s: (0.5, 1.5), duration_s: 30.0, seed: 1 };
        let rig = rig(None);
        let schedule = random_steps(&steps, &rig, None, 0);
        let effect = Component::new(&Stiction, vec![0.7.into(), 0.6.into()]).unwrap();
        let model = JointModel::integrator(10.0, 0.1).with(effect);
        let joint = rig.log(&schedule, rig.output(&model, &schedule)).unwrap();
        let record = FitRecord::new(&joint, Split::Time(0.7), Horizon::Steps);
        let fit = assess(&record, &model, &record.range(20.0)).unwrap();
        let known = Uncertain::of_fit(&record, &fit, 0.05, 0.1);
        // Steps of the search end a little before 1.0 V.
        let start = (known.model.values()[2].value, known.deviations[2]);
        assert!((start.0 - 0.77).abs() < 0.06 && (0.08..0.13).contains(&start.1), "{start:?}");
        let drawn = known.drawn(&mut ChaCha8Rng::seed_from_u64(1));
        assert!((0.45..1.05).contains(&drawn.values()[2].value));
        assert!((drawn.gain.value - 10.0).abs() < 0.1);
    }
}
