//! The delays of several steps in a few numbers, and how well their median is known.

use super::decision::{Decision, Verdict};
use super::interval::FineDelay;
use crate::numerics::{coin_quantile, limits, median, student_quantile, to_nanoseconds};
use crate::units::SamplePeriod;

/// How often the interval of a median holds it.
const CONFIDENCE: f64 = 0.95;

/// The fewest delays of which two bound the median so surely: outside of them all it lies
/// once in `2^(n−1)` times.
const ORDERED: usize = 6;

/// The median of several delays, its interval, and the least and the greatest; seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TypicalDelay {
    /// The median.
    pub median_s: f64,
    /// The interval that holds the median of such steps at 95 %; none where nothing shows it.
    pub interval_s: Option<(f64, f64)>,
    /// The least delay.
    pub min_s: f64,
    /// The greatest delay.
    pub max_s: f64,
}

/// The delay of an accepted step, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StepSample {
    delay_s: f64,
    /// Lower and upper end of its own 95 % interval, where the method gives one.
    own_s: Option<(f64, f64)>,
}

impl StepSample {
    pub(super) fn of(decision: &Decision, period: SamplePeriod) -> Option<Self> {
        let accepted = decision.verdict() == Verdict::Accepted;
        let period_s = period.seconds();
        let own = |fine: FineDelay| {
            // To 95 % from what was asked for.
            let scale = normal(CONFIDENCE) / normal(fine.confidence);
            let end = |end: f64| period_s * (fine.delay + scale * (end - fine.delay));
            (end(fine.low), end(fine.high))
        };
        let delay_s = decision.delay().filter(|_| accepted)? * period_s;
        Some(Self { delay_s, own_s: decision.fine.map(own) })
    }

    /// Variance of the step's own delay, where its interval is known.
    fn variance(&self) -> Option<f64> {
        self.own_s.map(|(low, high)| ((high - low) / (2.0 * normal(CONFIDENCE))).powi(2))
    }
}

/// How much delays of one kind scatter at one level: what levels with few steps share.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Scatter {
    squares: f64,
    freedom: f64,
}

impl Scatter {
    /// Pooled over groups of steps that are alike: the squares about each group's mean.
    pub(super) fn pooled<'a>(groups: impl IntoIterator<Item = &'a [StepSample]>) -> Self {
        groups.into_iter().filter(|group| !group.is_empty()).fold(Self::default(), |sum, group| {
            let mean = mean(group);
            let squares = group.iter().map(|sample| (sample.delay_s - mean).powi(2));
            Self {
                squares: sum.squares + squares.sum::<f64>(),
                freedom: sum.freedom + group.len() as f64 - 1.0,
            }
        })
    }
}

fn mean(samples: &[StepSample]) -> f64 {
    samples.iter().map(|sample| sample.delay_s).sum::<f64>() / samples.len() as f64
}

/// The number that a normal variable's magnitude stays below with `probability`.
fn normal(probability: f64) -> f64 {
    student_quantile(0.5 + 0.5 * probability, f64::INFINITY)
}

impl TypicalDelay {
    /// Of these delays; none where there are none.
    ///
    /// The interval is, for six delays or more, that between two of them in order,
    /// `x_(k) … x_(n+1−k)` with the largest `k` for which a fair coin falls heads fewer than
    /// `k` times of `n` with a probability of 2.5 % at most: it asks nothing of the
    /// distribution. For fewer it is Student's about their mean,
    /// `t √(max(s², ē²) / n)`, with the variance `s²` of `scatter` and the mean square `ē²` of
    /// the errors that the steps' own intervals state; it takes delays for normal, and to
    /// scatter alike in all groups. Where these scatter more, it goes from the least to the greatest
    /// of them, which hold the median of five or fewer less often than 95 %. Where nothing is known of
    /// the scatter, it is the step's own.
    ///
    /// # References
    /// H. A. David, H. N. Nagaraja, "Order Statistics", 3rd ed. (2003), section 7.1.
    pub(super) fn of(samples: &[StepSample], scatter: Scatter) -> Option<Self> {
        let mut delays: Vec<f64> = samples.iter().map(|sample| sample.delay_s).collect();
        delays.sort_by(f64::total_cmp);
        let interval_s = match delays.len() {
            0 => return None,
            1 if scatter.freedom < 1.0 => samples.first()?.own_s,
            1..ORDERED => student(samples, scatter),
            _ => ordered(&delays),
        };
        let (least, greatest) = (*delays.first()?, *delays.last()?);
        // Student's interval does not know that an effect follows its cause.
        let causal = |low: f64| low.max(least.min(0.0));
        Some(Self {
            median_s: to_nanoseconds(median(&delays)?),
            interval_s: interval_s
                .map(|(low, high)| (to_nanoseconds(causal(low)), to_nanoseconds(high))),
            min_s: to_nanoseconds(least),
            max_s: to_nanoseconds(greatest),
        })
    }
}

/// Student's interval of the mean, and no less than from the least to the greatest: these may differ by
/// more than delays of other groups.
fn student(samples: &[StepSample], scatter: Scatter) -> Option<(f64, f64)> {
    let count = samples.len() as f64;
    let own: Option<f64> = samples.iter().map(StepSample::variance).sum();
    let variance = (scatter.squares / scatter.freedom).max(own.map_or(0.0, |own| own / count));
    let quantile = student_quantile(0.5 + 0.5 * CONFIDENCE, scatter.freedom);
    let reach = quantile * (variance / count).sqrt();
    let (least, greatest) = limits(samples.iter().map(|sample| sample.delay_s));
    // Delays on a grid may agree by chance.
    (variance > 0.0)
        .then_some(((mean(samples) - reach).min(least), (mean(samples) + reach).max(greatest)))
}

/// The two delays in order that bound the median.
fn ordered(delays: &[f64]) -> Option<(f64, f64)> {
    let below = rank(delays.len()).checked_sub(1)?;
    Some((*delays.get(below)?, *delays.get(delays.len() - 1 - below)?))
}

/// The largest `k` for which a fair coin falls heads fewer than `k` times of `count` with at
/// most half of what is left to the confidence.
fn rank(count: usize) -> usize {
    coin_quantile(f64::midpoint(1.0, -CONFIDENCE), count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::normals;

    /// How often the interval of `count` delays holds the true median: delays that scatter by
    /// `scatter`, skewed by `skew`, known to `error` each, in one of `groups` that are alike.
    fn coverage(count: usize, groups: usize, (scatter, skew): (f64, f64), error: f64) -> f64 {
        let mut normal = normals(count as u64 + 99);
        let runs = 4000;
        let mut group = || {
            let sample = |_| {
                let z = normal();
                let own = error * normal();
                let delay_s = 5.0 + scatter * (skew * z).exp_m1() / skew + own;
                let reach = 1.96 * error;
                let own_s = (error > 0.0).then_some((delay_s - reach, delay_s + reach));
                StepSample { delay_s, own_s }
            };
            (0..count).map(sample).collect::<Vec<_>>()
        };
        let hits = (0..runs).filter(|_| {
            let groups: Vec<_> = (0..groups).map(|_| group()).collect();
            let scatter = Scatter::pooled(groups.iter().map(Vec::as_slice));
            let found = TypicalDelay::of(&groups[0], scatter).and_then(|found| found.interval_s);
            found.is_some_and(|(low, high)| low <= 5.0 && 5.0 <= high)
        });
        hits.count() as f64 / f64::from(runs)
    }

    #[test]
    fn intervals_of_medians_hold_them_as_often_as_they_say() {
        // Three standard errors of 4000 runs are 0.01; ranks are whole numbers.
        let (normal, skewed) = ((0.1, 1e-6), (0.1, 1.0));
        for count in 2..=20 {
            let groups = if count < 6 { 3 } else { 1 };
            for error in [0.0, 0.05] {
                let found = coverage(count, groups, normal, error);
                assert!((0.94..0.995).contains(&found), "{count} {error}: {found}");
            }
        }
        for count in [6, 9, 15, 40] {
            let found = coverage(count, 1, skewed, 0.0);
            assert!((0.94..0.985).contains(&found), "{count}: {found}");
        }
        // Of one step alone nothing is known but its own error.
        let found = coverage(1, 1, (0.0, 1.0), 0.05);
        assert!((0.94..0.96).contains(&found), "{found}");
    }

    #[test]
    fn ranks_are_those_of_the_binomial_tables() {
        // SciPy: the largest k with binom.cdf(k - 1, n, 0.5) <= 0.025.
        let known = [(5, 0), (6, 1), (8, 1), (9, 2), (12, 3), (20, 6), (50, 18), (100, 40)];
        assert_eq!(known.map(|(n, _)| (n, rank(n))), known);
        assert_eq!(rank(2000), 956);
    }

    #[test]
    fn without_scatter_and_errors_nothing_is_claimed() {
        let same = [StepSample { delay_s: 0.15, own_s: None }; 3];
        let scatter = Scatter::pooled([same.as_slice()]);
        let found = TypicalDelay::of(&same, scatter).unwrap();
        assert_eq!((found.median_s.to_string(), found.interval_s), ("0.15".to_owned(), None));
        assert_eq!(TypicalDelay::of(&[], scatter), None);
    }
}
