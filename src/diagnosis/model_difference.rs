//! Two models of one record: which of them is better, where, and whether that is more than chance.

use serde::Serialize;

use super::compare::Comparison;
use super::failure::Region;
use super::step_error::StepError;
use crate::fit::Part;
use crate::numerics::fisher_tail;

/// One model beside another one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ModelDifference {
    /// Steps that both are judged on: those of the validation part, where there is one.
    pub steps: usize,
    /// Whether they are of the validation part.
    pub is_validation: bool,
    /// Root mean square of the residual on them of this model, output units.
    pub rmse: f64,
    /// Root mean square of the other model's residual on them, output units.
    pub other_rmse: f64,
    /// Steps on which this model has the smaller error.
    pub better_steps: usize,
    /// The test whether the difference is more than chance; none with fewer than
    /// [`ModelDifference::FEWEST`] steps, or without any difference.
    pub test: Option<DifferenceTest>,
    /// Where this model is better, and where the other one: the parts that make up most of the
    /// difference, the largest first.
    pub better_where: Vec<RegionPair>,
    /// Where the other one is better, likewise.
    pub worse_where: Vec<RegionPair>,
}

/// Diebold and Mariano's test of the root mean square of each step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DifferenceTest {
    /// Mean difference of the root mean squares of the steps by its standard error; negative where
    /// this model is better. Squares themselves would leave the word to the few largest steps.
    pub statistic: f64,
    /// Two-sided p-value.
    pub p_value: f64,
}

impl DifferenceTest {
    /// p-value up to which a difference is more than chance.
    pub(crate) const LEVEL: f64 = 0.05;
}

/// A part of the record as both models have it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct RegionPair {
    /// With the error of this model.
    #[serde(flatten)]
    pub region: Region,
    /// Root mean square of the other model's residual there, output units.
    pub other_rmse: f64,
}

impl ModelDifference {
    /// Steps that the test needs: it estimates a variance and its correlation from them.
    pub(crate) const FEWEST: usize = 10;

    /// Whether the model with the smaller error is better by more than chance; none without a test.
    pub(crate) fn is_significant(&self) -> Option<bool> {
        let test = self.test?;
        let is_better = self.rmse < self.other_rmse;
        Some(test.p_value <= DifferenceTest::LEVEL && (test.statistic < 0.0) == is_better)
    }

    /// `model` beside `other`, which is one of the same record; none where they share no step.
    pub(crate) fn of(model: &Comparison, other: &Comparison) -> Option<Self> {
        let known = |step: &StepError| {
            let same = |it: &&StepError| {
                (it.trial, it.start, it.samples) == (step.trial, step.start, step.samples)
            };
            Some((*step, *other.per_step.iter().find(same)?))
        };
        let all: Vec<_> = model.per_step.iter().filter_map(known).collect();
        let of_part = |part| all.iter().filter(move |(step, _)| step.part == part);
        let is_validation = of_part(Part::Validation).next().is_some();
        let part = if is_validation { Part::Validation } else { Part::Training };
        let judged: Vec<_> = of_part(part).copied().collect();
        let samples: usize = judged.iter().map(|(step, _)| step.samples).sum();
        if samples == 0 {
            return None;
        }
        let rmse = |of: fn(&(StepError, StepError)) -> f64| {
            (judged.iter().map(of).sum::<f64>() / samples as f64).sqrt()
        };
        let better =
            |(own, other): &&(StepError, StepError)| own.squared_error < other.squared_error;
        let differences: Vec<f64> =
            judged.iter().map(|(own, other)| own.rmse() - other.rmse()).collect();
        let pairs = region_pairs(&model.regions, &other.regions);
        Some(Self {
            steps: judged.len(),
            is_validation,
            rmse: rmse(|(own, _)| own.squared_error),
            other_rmse: rmse(|(_, other)| other.squared_error),
            better_steps: judged.iter().filter(better).count(),
            test: diebold_mariano(&differences),
            better_where: largest(&pairs, 1.0),
            worse_where: largest(&pairs, -1.0),
        })
    }
}

/// Whether the mean of `differences` is zero: the mean by its standard error, which allows for the
/// correlation of neighbours with Bartlett's weights, against Student's distribution.
///
/// # References
/// Diebold and Mariano (1995), Comparing predictive accuracy; the small-sample factor of Harvey,
/// Leybourne and Newbold (1997), equation 9, for one step ahead.
fn diebold_mariano(differences: &[f64]) -> Option<DifferenceTest> {
    let count = differences.len();
    if count < ModelDifference::FEWEST {
        return None;
    }
    let n = count as f64;
    let mean = differences.iter().sum::<f64>() / n;
    let covariance = |lag: usize| {
        let later = differences.iter().skip(lag);
        differences.iter().zip(later).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>() / n
    };
    // Lags up to the cube root of the steps, as is usual for this estimator.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
    let lags = n.cbrt().floor() as usize;
    let own = covariance(0);
    // Bartlett's weights 1 − h/(L + 1).
    let weighted = (1..=lags).map(|lag| (1.0 - lag as f64 / (lags as f64 + 1.0)) * covariance(lag));
    let variance = own + 2.0 * weighted.sum::<f64>();
    // A negative correlation of neighbours is no reason to be surer than without any.
    let variance = variance.max(own);
    if variance <= 0.0 {
        return None;
    }
    // Harvey, Leybourne and Newbold: √((n + 1 − 2h + h(h − 1)/n)/n) with h = 1.
    let statistic = mean / (variance / n).sqrt() * ((n - 1.0) / n).sqrt();
    // The square of Student's t is F with 1 degree of freedom: both tails at once.
    let p_value = fisher_tail(statistic * statistic, 1, count - 1)?;
    Some(DifferenceTest { statistic, p_value })
}

/// The parts that both models cut the record into.
fn region_pairs(own: &[Region], other: &[Region]) -> Vec<RegionPair> {
    let pair = |region: &Region| {
        let same = |it: &&Region| it.feature == region.feature && it.label == region.label;
        let other_rmse = other.iter().find(same)?.rmse;
        Some(RegionPair { region: region.clone(), other_rmse })
    };
    own.iter().filter_map(pair).collect()
}

/// The parts that make up most of the difference in one direction: one of each feature, the
/// largest first.
fn largest(pairs: &[RegionPair], sign: f64) -> Vec<RegionPair> {
    /// Parts that are named.
    const MOST: usize = 3;
    /// What the errors must differ by, in parts of the larger one, to be worth a word.
    const WORTH: f64 = 0.1;
    let gain = |pair: &RegionPair| {
        let RegionPair { region, other_rmse } = pair;
        sign * region.share_of_time * (other_rmse * other_rmse - region.rmse * region.rmse)
    };
    let is_worth = |pair: &&RegionPair| {
        let (small, large) =
            (pair.region.rmse.min(pair.other_rmse), pair.region.rmse.max(pair.other_rmse));
        gain(pair) > 0.0 && small < (1.0 - WORTH) * large
    };
    let mut found: Vec<&RegionPair> = pairs.iter().filter(is_worth).collect();
    found.sort_by(|a, b| gain(b).total_cmp(&gain(a)));
    let mut named: Vec<RegionPair> = Vec::new();
    for pair in found {
        if named.iter().all(|known| known.region.feature != pair.region.feature) {
            named.push(pair.clone());
        }
    }
    named.truncate(MOST);
    named
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_statistic_of_alternating_differences_is_students_t() {
        // Mean 0.5, neighbours are negatively correlated: the plain variance counts.
        let differences: Vec<f64> = (0..20).map(|k| if k % 2 == 0 { 1.5 } else { -0.5 }).collect();
        let test = diebold_mariano(&differences).unwrap();
        // t = 0.5 / (1 / sqrt(20)) · sqrt(19 / 20)
        assert!((test.statistic - 0.5 * 19f64.sqrt()).abs() < 1e-12, "{test:?}");
        // scipy.stats.t.sf(2.179449, 19) * 2
        assert!((test.p_value - 0.042_087).abs() < 1e-5, "{test:?}");
    }

    #[test]
    fn runs_of_one_sign_make_it_less_sure() {
        let runs: Vec<f64> = (0..20).map(|k| if k < 10 { 1.5 } else { -0.5 }).collect();
        assert!(diebold_mariano(&runs).unwrap().p_value > 0.1);
    }

    #[test]
    fn there_is_no_test_of_a_few_steps_or_of_no_difference() {
        assert_eq!(diebold_mariano(&[1.0; 9]), None);
        assert_eq!(diebold_mariano(&[0.0; 50]), None);
    }
}
