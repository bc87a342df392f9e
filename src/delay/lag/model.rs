//! Which poles a lag has, and where: the parameters that a joint's steps share.

/// Most parameters of a lag.
pub(crate) const MAX_PARAMETERS: usize = 3;

/// Which poles a lag has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Poles {
    None,
    Real,
    Pair,
    RealAndPair,
}

/// A lag by the logarithms of its parameters, times in samples: `ln T`, `ln ω`, `ln ζ`,
/// as far as it has them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LagModel {
    pub(crate) poles: Poles,
    pub(crate) logs: [f64; MAX_PARAMETERS],
}

/// Step of a numerical derivative in a logarithm.
const STEP: f64 = 1e-5;

impl LagModel {
    pub(crate) const NONE: Self = Self { poles: Poles::None, logs: [0.0; MAX_PARAMETERS] };

    pub(crate) fn real(time_constant: f64) -> Self {
        Self { poles: Poles::Real, logs: [time_constant.ln(), 0.0, 0.0] }
    }

    pub(crate) fn pair_of(omega: f64, zeta: f64) -> Self {
        Self { poles: Poles::Pair, logs: [omega.ln(), zeta.ln(), 0.0] }
    }

    /// This pair with a real pole before it.
    pub(crate) fn behind(self, time_constant: f64) -> Self {
        let [omega, zeta, _] = self.logs;
        Self { poles: Poles::RealAndPair, logs: [time_constant.ln(), omega, zeta] }
    }

    pub(crate) fn order(&self) -> usize {
        match self.poles {
            Poles::None => 0,
            Poles::Real => 1,
            Poles::Pair => 2,
            Poles::RealAndPair => 3,
        }
    }

    pub(super) fn time_constant(&self) -> Option<f64> {
        matches!(self.poles, Poles::Real | Poles::RealAndPair).then(|| self.logs[0].exp())
    }

    /// Where the pair's parameters begin.
    pub(super) fn pair_at(&self) -> usize {
        usize::from(self.poles == Poles::RealAndPair)
    }

    /// ω and ζ.
    pub(super) fn pair(&self) -> Option<(f64, f64)> {
        match (self.poles, self.logs) {
            (Poles::Pair, [omega, zeta, _]) | (Poles::RealAndPair, [_, omega, zeta]) => {
                Some((omega.exp(), zeta.exp()))
            }
            _ => None,
        }
    }

    /// Whether it has the same poles as `other`, at about the same onsets.
    pub(crate) fn is_close_to(&self, other: &Self) -> bool {
        /// Difference of a logarithm.
        const NEAR: f64 = 0.01;
        let pairs = self.logs.iter().zip(&other.logs);
        self.poles == other.poles && pairs.take(self.order()).all(|(a, b)| (a - b).abs() < NEAR)
    }

    /// This lag with all times `factor` as long.
    pub(super) fn scaled(mut self, factor: f64) -> Self {
        let shift = factor.ln();
        match (self.poles, &mut self.logs) {
            (Poles::None, _) => {}
            (Poles::Real, [time, ..]) => *time += shift,
            (Poles::Pair, [omega, ..]) => *omega -= shift,
            (Poles::RealAndPair, [time, omega, _]) => {
                *time += shift;
                *omega -= shift;
            }
        }
        self
    }

    /// This model with one logarithm a little larger.
    pub(crate) fn perturbed(mut self, index: usize) -> Self {
        if let Some(log) = self.logs.get_mut(index) {
            *log += STEP;
        }
        self
    }

    /// What a step of [`perturbed`](Self::perturbed) is to be divided by.
    pub(crate) const fn perturbation() -> f64 {
        STEP
    }

    /// This model moved by `change`, within what samples can show: poles from a fifth of a
    /// sample to `longest` samples, damping of 0.02 to 3, of 0.95 beside a real pole.
    pub(crate) fn moved(mut self, change: &[f64; MAX_PARAMETERS], longest: f64) -> Self {
        for (log, change) in self.logs.iter_mut().zip(change) {
            *log += change.clamp(-1.0, 1.0);
        }
        let times = 0.2_f64.ln()..=longest.max(1.0).ln();
        let omegas = -longest.max(1.0).ln()..=1.5_f64.ln();
        let within = |log: f64, range: &std::ops::RangeInclusive<f64>| {
            log.clamp(*range.start(), *range.end())
        };
        let zetas = |most: f64| 0.02_f64.ln()..=most.ln();
        match (self.poles, &mut self.logs) {
            (Poles::None, _) => {}
            (Poles::Real, [time, ..]) => *time = within(*time, &times),
            (Poles::Pair, [omega, zeta, _]) => {
                (*omega, *zeta) = (within(*omega, &omegas), within(*zeta, &zetas(3.0)));
            }
            (Poles::RealAndPair, [time, omega, zeta]) => {
                *time = within(*time, &times);
                (*omega, *zeta) = (within(*omega, &omegas), within(*zeta, &zetas(0.95)));
            }
        }
        self
    }

    /// Derivatives of `value` to the logarithms.
    pub(super) fn slopes(&self, value: impl Fn(&Self) -> f64) -> [f64; MAX_PARAMETERS] {
        let at = value(self);
        let mut slopes = [0.0; MAX_PARAMETERS];
        for (index, slope) in slopes[..self.order()].iter_mut().enumerate() {
            *slope = (value(&self.perturbed(index)) - at) / STEP;
        }
        slopes
    }
}
