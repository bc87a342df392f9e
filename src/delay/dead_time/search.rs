//! The dead time and the lags that leave the least error.

use super::moments::Moments;
use super::record::{Design, Whitened};
use super::response::{Lags, NO_LAG, Numerators, Structure};

/// A structure with its dead time and lags, in samples, and its squared error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fitted {
    pub(super) structure: Structure,
    pub(super) delay: f64,
    pub(super) lags: Lags,
    pub(super) error: f64,
}

impl Fitted {
    /// The regression that it is the best of.
    pub(super) fn design(&self, trials: &[Whitened]) -> Design {
        let numerators = Numerators::of(self.structure, self.delay, self.lags);
        Design::of(trials, &numerators, self.lags)
    }
}

/// Dead times tried, per sample.
const PER_SAMPLE: usize = 2;

/// The best lags of every dead time from 0 to `longest` samples, for each structure.
pub(super) fn profiles(trials: &[Whitened], longest: usize, lags: &[Lags]) -> Vec<Vec<Fitted>> {
    let delays: Vec<f64> =
        (0..=longest * PER_SAMPLE).map(|k| k as f64 / PER_SAMPLE as f64).collect();
    let nothing = Lags::new(NO_LAG, NO_LAG);
    let unknown = |structure| {
        let of =
            |delay: &f64| Fitted { structure, delay: *delay, lags: nothing, error: f64::INFINITY };
        delays.iter().map(of).collect::<Vec<_>>()
    };
    let mut found = Structure::ALL.map(unknown);
    for lags in lags {
        let moments = Moments::of(trials, *lags, 0, longest);
        for best in found.iter_mut().flatten() {
            let error = moments.error(&Numerators::of(best.structure, best.delay, *lags));
            if error < best.error {
                (best.error, best.lags) = (error, *lags);
            }
        }
    }
    found.to_vec()
}

/// Shortest lag that shows in samples.
const SEEN: f64 = 0.2;

/// Pairs of lags from none to `longest` samples, neighbours having this `ratio`.
pub(super) fn grid(ratio: f64, longest: f64) -> Vec<Lags> {
    /// Longest of the faster lag, samples: two slow lags are an integrator and a slow one.
    const FAST: f64 = 30.0;
    let seen = move || std::iter::successors(Some(SEEN), move |t| Some(t * ratio));
    let constants = move || std::iter::once(NO_LAG).chain(seen());
    let slow = constants().take_while(|t| *t <= longest.max(NO_LAG));
    let pairs = slow.flat_map(|slow| {
        constants().take_while(move |fast| *fast <= slow.min(FAST)).map(move |fast| (slow, fast))
    });
    pairs.map(|(slow, fast)| Lags::new(slow, fast)).collect()
}

/// The best of a profile.
pub(super) fn least(profile: &[Fitted]) -> Option<Fitted> {
    profile.iter().copied().min_by(|a, b| a.error.total_cmp(&b.error))
}

/// Distances of neighbours by which lags are searched, in logarithms of the sum of both lags where that
/// shows: lags that are off by a twentieth move the dead time by as much of them, which good records
/// show. From those of a grid, and from the best ones of a dead time nearby.
pub(super) const FROM_GRID: &[f64] = &[0.24, 0.06, 0.015];
pub(super) const FROM_NEIGHBOUR: &[f64] = &[0.06, 0.015];

/// Lags that fit a dead time best, near those that it starts from: by the least of the parabola
/// through ever closer neighbours.
pub(super) fn with_best_lags(
    trials: &[Whitened],
    fitted: Fitted,
    longest: f64,
    steps: &[f64],
) -> Fitted {
    /// Most parabolas of a distance.
    const MOST: usize = 8;
    /// What shows of the faster lag by itself goes with its square.
    const COARSER: f64 = 4.0;
    // A record determines the sum of the lags far better than how it is shared.
    let near = |best: Fitted, sum: f64, fast: f64| {
        let sum = moved(best.lags.mean(), sum);
        let fast = moved(best.lags.fast, COARSER * fast).min(0.5 * sum).max(NO_LAG);
        let lags = Lags::new((sum - fast).clamp(NO_LAG, longest), fast);
        if lags == best.lags { best } else { at_lags(trials, best, lags) }
    };
    let mut best = at_lags(trials, fitted, fitted.lags);
    for step in steps {
        for _ in 0..MOST {
            let tried = NEIGHBOURS.map(|(sum, fast)| near(best, sum * step, fast * step));
            let (sum, fast) = least_of_parabola(best.error, tried.map(|tried| tried.error));
            let lowest = near(best, sum * step, fast * step);
            let all = tried.into_iter().chain([lowest]).chain([best]);
            let before = best;
            best = all.min_by(|a, b| a.error.total_cmp(&b.error)).unwrap_or(best);
            // Within its neighbours, or nowhere better.
            if (sum.abs() < 1.0 && fast.abs() < 1.0) || best.error >= before.error {
                break;
            }
        }
    }
    best
}

/// A lag that is longer by so much of its logarithm where it shows in samples, by as much of [`SEEN`]
/// where it does not.
fn moved(lag: f64, by: f64) -> f64 {
    (SEEN * ((lag / SEEN).asinh() + by).sinh()).max(NO_LAG)
}

/// The best fit with one lag, near `start`, which may have two.
pub(super) fn with_one_lag(trials: &[Whitened], start: Fitted, longest: f64) -> Fitted {
    /// First and last step of the search, samples.
    const FIRST: f64 = 0.5;
    const LAST: f64 = 0.01;
    let at = |delay: f64, lag: f64| {
        at_lags(trials, Fitted { delay: delay.max(0.0), ..start }, Lags::new(lag, NO_LAG))
    };
    let within = |lag: f64| lag.clamp(2.0 * NO_LAG, longest);
    let mut best = at(start.delay + start.lags.fast, within(start.lags.slow));
    let mut step = FIRST;
    while step > LAST {
        let mut tried = NEIGHBOURS.iter().map(|(later, slower)| {
            at(best.delay + later * step, within(best.lags.slow + slower * step))
        });
        match tried.find(|tried| tried.error < best.error) {
            Some(better) => best = better,
            None => step *= 0.5,
        }
    }
    best
}

/// Steps to the neighbours of a pair of lags.
const NEIGHBOURS: [(f64, f64); 6] =
    [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (1.0, -1.0), (-1.0, 1.0)];

/// Where the parabola through `middle` and its [`NEIGHBOURS`] is least, at most a step away; it
/// stays in a direction in which it does not bend upwards.
fn least_of_parabola(middle: f64, around: [f64; 6]) -> (f64, f64) {
    let [right, left, up, down, lower_right, upper_left] = around;
    let (slope_a, slope_b) = (0.5 * (right - left), 0.5 * (up - down));
    let (bend_a, bend_b) = (right - 2.0 * middle + left, up - 2.0 * middle + down);
    // f(1, −1) and f(−1, 1) contain −2·f_ab.
    let twist = 0.5 * (bend_a + bend_b - (lower_right - 2.0 * middle + upper_left));
    let alone = |slope: f64, bend: f64| if bend > 0.0 { -slope / bend } else { 0.0 };
    let determinant = bend_a * bend_b - twist * twist;
    let (a, b) = if bend_a > 0.0 && determinant > 1e-6 * bend_a * bend_b {
        // Newton's step −H⁻¹g of the parabola.
        let a = (twist * slope_b - bend_b * slope_a) / determinant;
        (a, (twist * slope_a - bend_a * slope_b) / determinant)
    } else {
        (alone(slope_a, bend_a), alone(slope_b, bend_b))
    };
    (a.clamp(-1.0, 1.0), b.clamp(-1.0, 1.0))
}

/// `fitted` with other lags.
pub(super) fn at_lags(trials: &[Whitened], fitted: Fitted, lags: Lags) -> Fitted {
    let fitted = Fitted { lags, ..fitted };
    Fitted { error: fitted.design(trials).error(), ..fitted }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_least_where_its_slopes_are_none() {
        let f = |a: f64, b: f64| 3.0 + 2.0 * (a - 0.3).powi(2) + (b + 0.2).powi(2) + a * b;
        // Slopes 4 (a − 0.3) + b and 2 (b + 0.2) + a.
        let (a, b) = least_of_parabola(f(0.0, 0.0), NEIGHBOURS.map(|(a, b)| f(a, b)));
        assert!((4.0 * (a - 0.3) + b).abs() < 1e-12 && (2.0 * (b + 0.2) + a).abs() < 1e-12);
    }

    #[test]
    fn a_direction_without_a_bend_is_not_followed() {
        let f = |a: f64, _: f64| (a - 0.4).powi(2);
        let (a, b) = least_of_parabola(f(0.0, 0.0), NEIGHBOURS.map(|(a, b)| f(a, b)));
        assert!((a - 0.4).abs() < 1e-12 && b == 0.0);
    }
}
