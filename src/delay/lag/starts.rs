//! Lags to start a search from: all over what a record can show, or near one that is known.

use super::model::{LagModel, MAX_PARAMETERS, Poles};
use super::response::Response;

/// Mean lateness of the shortest lag to start from, samples: that of the shortest pole.
const SHORTEST: f64 = 0.2;

impl LagModel {
    /// Starts for each kind of lag that is about as late as this one.
    pub(crate) fn nearby(&self) -> Vec<Vec<Self>> {
        /// Times the frequency that is known, about √3 apart; chosen.
        const FACTORS: [f64; 3] = [0.6, 1.0, 1.7];
        /// Damping ratios, from ringing to sluggish; chosen.
        const ZETAS: [f64; 3] = [0.2, 0.5, 1.2];
        let mean = Response::of(self).mean.max(SHORTEST);
        let real = vec![Self::real(mean)];
        let pairs = match self.pair() {
            Some((omega, zeta)) => {
                FACTORS.map(|factor| Self::pair_of(omega * factor, zeta)).to_vec()
            }
            None => ZETAS.map(|zeta| Self::pair_of(2.0 * zeta / mean, zeta)).to_vec(),
        };
        let both = match (self.time_constant(), self.pair()) {
            (Some(_), Some(_)) => vec![*self],
            (_, Some((omega, _))) => [0.1, 0.5].map(|part| self.behind(part / omega)).to_vec(),
            _ => {
                ZETAS.map(|zeta| Self::pair_of(4.0 * zeta / mean, zeta).behind(mean / 2.0)).to_vec()
            }
        };
        vec![vec![Self::NONE], real, pairs, both]
    }

    /// Lags with fewer poles that are about as late, or have the same pair.
    pub(crate) fn simpler(&self) -> Vec<Self> {
        let real = Self::real(Response::of(self).mean.max(SHORTEST));
        let pair = self.pair().map(|(omega, zeta)| Self::pair_of(omega, zeta));
        match self.poles {
            Poles::None => Vec::new(),
            Poles::Real => vec![Self::NONE],
            Poles::Pair => vec![Self::NONE, real],
            Poles::RealAndPair => [Self::NONE, real].into_iter().chain(pair).collect(),
        }
    }
}

/// Real poles from half a sample on.
pub(super) fn reals(longest: f64) -> Vec<LagModel> {
    doubling(0.5, longest / 2.0).map(LagModel::real).collect()
}

/// Pairs from weakly to strongly damped, of periods from five samples on.
pub(super) fn pairs(longest: f64) -> Vec<LagModel> {
    let periods = doubling(5.0, 2.0 * longest);
    let pair = |period: f64| {
        [0.15, 0.5, 1.2].map(|zeta| LagModel::pair_of(std::f64::consts::TAU / period, zeta))
    };
    periods.flat_map(pair).collect()
}

/// A real pole before a `pair`, from much faster to slower than it.
pub(super) fn behind_poles(pair: LagModel, longest: f64) -> Vec<LagModel> {
    let [omega, ..] = pair.logs;
    let behind = |part: f64| pair.behind(part / omega.exp()).moved(&[0.0; MAX_PARAMETERS], longest);
    [0.1, 0.5, 2.0].map(behind).to_vec()
}

/// `from`, twice as much, and so on up to `to`.
fn doubling(from: f64, to: f64) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(from), |value| Some(2.0 * value))
        .take_while(move |v| *v <= to.max(from))
}
