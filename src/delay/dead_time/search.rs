//! The dead time and the lags that leave the least error.

use super::moments::{Moments, error_of};
use super::record::Whitened;
use super::response::{Lags, NO_LAG, Numerators, Structure};

/// A structure with its dead time and lags, in samples, and the error that it leaves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fitted {
    pub(super) structure: Structure,
    pub(super) delay: f64,
    pub(super) lags: Lags,
    pub(super) error: f64,
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

/// Pairs of lags from none to `longest` samples, neighbours having this `ratio`.
pub(super) fn grid(ratio: f64, longest: f64) -> Vec<Lags> {
    /// Longest of the faster lag, samples: two slow lags are an integrator and a slow one.
    const FAST: f64 = 30.0;
    let constants = || std::iter::successors(Some(NO_LAG), move |t| Some(t * ratio));
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

/// Lags that fit a dead time best, near those that it starts from.
pub(super) fn with_best_lags(trials: &[Whitened], start: Fitted, longest: f64) -> Fitted {
    /// First and last step of the search, in logarithms of a time constant.
    const FIRST: f64 = 0.24;
    const LAST: f64 = 0.05;
    const DIRECTIONS: [(f64, f64); 8] = [
        (1.0, 0.0),
        (-1.0, 0.0),
        (0.0, 1.0),
        (0.0, -1.0),
        (1.0, -1.0),
        (-1.0, 1.0),
        (1.0, 1.0),
        (-1.0, -1.0),
    ];
    let mut best = at_lags(trials, start, start.lags);
    let mut step = FIRST;
    while step > LAST {
        let moved = DIRECTIONS.iter().find_map(|(slow, fast)| {
            let Lags { slow: a, fast: b } = best.lags;
            let (a, b) = (a * (slow * step).exp(), b * (fast * step).exp());
            let lags = Lags::new(a.clamp(NO_LAG, longest), b.clamp(NO_LAG, longest));
            let tried = (lags != best.lags).then(|| at_lags(trials, best, lags))?;
            (tried.error < best.error).then_some(tried)
        });
        match moved {
            Some(better) => best = better,
            None => step *= 0.5,
        }
    }
    best
}

/// The same with other lags.
pub(super) fn at_lags(trials: &[Whitened], fitted: Fitted, lags: Lags) -> Fitted {
    let numerators = Numerators::of(fitted.structure, fitted.delay, lags);
    Fitted { lags, error: error_of(trials, &numerators, lags), ..fitted }
}
