//! Rank statistics: they ask for order alone, not for a line or a bell curve.
//!
//! Ties share the mean of the ranks they fill. Nothing here knows what is ranked; a value
//! that is not a number must be left out by the caller.

use statrs::function::beta::checked_beta_reg;

use crate::numerics::moments::dot;

/// Pairs below which a rank correlation is not computed: of three, any order is likely.
const MIN_PAIRS: usize = 4;

/// Most pairs whose orders are all tried: `9! = 362 880` of them take a millisecond.
const EXACT_PAIRS: usize = 9;

/// Rounding of a rank sum, as a part of it.
const ROUNDING: f64 = 1e-9;

/// A statistic and how likely one at least as far out is by chance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankTest {
    /// Spearman's ρ.
    pub statistic: f64,
    /// Two-sided: the share of equally likely orders that are at least as far out.
    pub p_value: f64,
}

/// The rank of each value from 1 up; equal values share the mean of their ranks.
pub fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    let mut below = 0;
    for tied in order.chunk_by(|&a, &b| values[a] >= values[b]) {
        let mean = below as f64 + f64::midpoint(1.0, tied.len() as f64);
        for &index in tied {
            ranks[index] = mean;
        }
        below += tied.len();
    }
    ranks
}

/// Spearman's rank correlation of the pairs `(x_i, y_i)`.
///
/// ```text
/// ρ = Σ (r_i - r̄)(s_i - s̄) / √( Σ (r_i - r̄)² · Σ (s_i - s̄)² )
/// ```
///
/// with `r` and `s` the ranks of `x` and `y`. Up to nine pairs the p-value is exact: the
/// share of the `n!` ways to pair the ranks whose `|ρ|` is no smaller. Above, Student's t
/// with `n - 2` degrees of freedom stands in for them, `t = ρ √((n - 2) / (1 - ρ²))`.
///
/// `None` when a variable is constant, with fewer than four pairs, or when the lengths
/// differ.
///
/// # References
/// M. G. Kendall, "Rank Correlation Methods", 4th ed. (1970): ties, exact distribution,
/// Student's t.
///
/// # Examples
/// ```
/// use tauscope::numerics::spearman;
/// let rises = spearman(&[1.0, 2.0, 3.0, 4.0], &[0.1, 0.2, 0.4, 0.8]).unwrap();
/// assert!((rises.statistic - 1.0).abs() < 1e-12);
/// assert!((rises.p_value - 2.0 / 24.0).abs() < 1e-12);
/// ```
pub fn spearman(x: &[f64], y: &[f64]) -> Option<RankTest> {
    if x.len() != y.len() || x.len() < MIN_PAIRS {
        return None;
    }
    let (x, y) = (centred(ranks(x)), centred(ranks(y)));
    let spread = (dot(&x, &x) * dot(&y, &y)).sqrt();
    if spread <= 0.0 {
        return None;
    }
    let sum = dot(&x, &y);
    let rho = (sum / spread).clamp(-1.0, 1.0);
    let exact = x.len() <= EXACT_PAIRS;
    let limit = sum.abs() - ROUNDING * spread;
    let p_value = if exact { all_orders(&x, y, limit) } else { student_p(rho, x.len())? };
    Some(RankTest { statistic: rho, p_value })
}

fn centred(mut ranks: Vec<f64>) -> Vec<f64> {
    let mean = f64::midpoint(1.0, ranks.len() as f64);
    for rank in &mut ranks {
        *rank -= mean;
    }
    ranks
}

/// The share of the orders of `y` whose `|Σ x y|` reaches `limit`.
///
/// B. R. Heap, "Permutations by interchanges", The Computer Journal 6 (1963), 293-298: the
/// next order is one exchange away, and so is its sum.
fn all_orders(x: &[f64], mut y: Vec<f64>, limit: f64) -> f64 {
    let mut sum = dot(x, &y);
    let (mut reached, mut orders) = (0.0, 0.0);
    let mut count = |sum: f64| {
        orders += 1.0;
        reached += f64::from(u8::from(sum.abs() >= limit));
    };
    count(sum);
    let mut turns = vec![0; x.len()];
    let mut at = 1;
    while at < x.len() {
        if turns[at] < at {
            // Heap's rule: the exchange partner is the first for an even index, the counter for an
            // odd one.
            let other = if at % 2 == 0 { 0 } else { turns[at] };
            // Σ x y changes by −(x_i − x_j)(y_i − y_j) when y_i and y_j change places.
            sum -= (x[at] - x[other]) * (y[at] - y[other]);
            y.swap(at, other);
            count(sum);
            turns[at] += 1;
            at = 1;
        } else {
            turns[at] = 0;
            at += 1;
        }
    }
    reached / orders
}

/// `P(|T| ≥ |t|) = I_x(ν/2, 1/2)` with `x = ν / (ν + t²) = 1 - ρ²` and `ν = n - 2`.
fn student_p(rho: f64, n: usize) -> Option<f64> {
    let rest = (1.0 - rho) * (1.0 + rho);
    checked_beta_reg((n as f64 - 2.0) / 2.0, 0.5, rest).ok()
}

/// Holm's correction: p-values that may each be held against the level of all together.
///
/// The `k`-th smallest of `m` is multiplied by `m - k + 1`, and none comes out below one
/// that was smaller before.
///
/// # References
/// S. Holm, "A simple sequentially rejective multiple test procedure", Scandinavian
/// Journal of Statistics 6 (1979), 65-70.
pub(crate) fn holm(p_values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&a, &b| p_values[a].total_cmp(&p_values[b]));
    let mut corrected = vec![1.0; p_values.len()];
    let mut largest: f64 = 0.0;
    for (done, index) in order.into_iter().enumerate() {
        let left = (p_values.len() - done) as f64;
        // p'_(k) = max over j ≤ k of (m − j + 1) p_(j), at most 1.
        largest = largest.max((left * p_values[index]).min(1.0));
        corrected[index] = largest;
    }
    corrected
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_share_their_mean_rank() {
        let expected = [3.5, 1.0, 3.5, 2.0, 5.0];
        for (rank, expected) in ranks(&[2.0, -1.0, 2.0, 0.0, 9.0]).into_iter().zip(expected) {
            assert!((rank - expected).abs() < 1e-15);
        }
        assert_eq!(ranks(&[]), Vec::<f64>::new());
    }

    #[test]
    fn there_is_none_of_a_constant_or_of_three_pairs() {
        assert_eq!(spearman(&[1.0; 5], &[1.0, 2.0, 3.0, 4.0, 5.0]), None);
        assert_eq!(spearman(&[1.0, 2.0, 3.0], &[1.0, 2.0, 3.0]), None);
        assert_eq!(spearman(&[1.0; 4], &[1.0; 5]), None);
    }

    #[test]
    fn holm_by_hand() {
        let corrected = holm(&[0.01, 0.04, 0.03, 0.005]);
        for (value, expected) in corrected.into_iter().zip([0.03, 0.06, 0.06, 0.02]) {
            assert!((value - expected).abs() < 1e-15);
        }
        assert_eq!(holm(&[]), Vec::<f64>::new());
    }
}
