//! Exponential decay over an interval, computed once for as long as nothing changes.

/// What an interval leaves of a deviation `d` that decays as `d · exp(−t/T)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Decay {
    /// `exp(−dt/T)`: the part that is left at its end.
    pub(super) left: f64,
    /// `(T/dt) · (1 − exp(−dt/T))`: the mean part over the interval.
    pub(super) mean: f64,
}

/// Numbers of memory that [`Decay::recall`] needs.
pub(super) const DECAY_MEMORY: usize = 4;

/// [`Decay::over`] as equations: `left` and `mean` of an `interval` with `time_constant`.
pub(super) const DECAY: &str = "
    ratio = interval / time_constant
    is_over = time_constant <= 0 || !is_finite(ratio)
    left = if(is_over, 0, exp(-ratio))
    mean = if(is_over, 0, if(ratio < 1e-300, 1, -expm1(-ratio) / ratio))
";

/// The decay over `dt` with the time constant `lag`.
pub(super) const LAG_DECAY: &str = "
    ratio = interval / lag
    is_over = lag <= 0 || !is_finite(ratio)
    left = if(is_over, 0, exp(-ratio))
    mean = if(is_over, 0, if(ratio < 1e-300, 1, -expm1(-ratio) / ratio))
";

impl Decay {
    /// The decay over `dt_s` with time constant `time_constant`; nothing is left at 0.
    pub(super) fn over(dt_s: f64, time_constant: f64) -> Self {
        let ratio = dt_s / time_constant;
        if time_constant <= 0.0 || ratio.is_infinite() {
            return Self { left: 0.0, mean: 0.0 };
        }
        if ratio < f64::MIN_POSITIVE {
            return Self { left: 1.0, mean: 1.0 };
        }
        Self { left: (-ratio).exp(), mean: -(-ratio).exp_m1() / ratio }
    }

    /// [`over`](Self::over), taken from `memory` where it was last computed
    /// for the same two numbers.
    pub(super) fn recall(memory: &mut [f64], dt_s: f64, time_constant: f64) -> Self {
        let [known_dt, known_constant, left, mean] = memory else {
            return Self::over(dt_s, time_constant);
        };
        let same = |a: f64, b: f64| a.to_bits() == b.to_bits();
        if !(same(*known_dt, dt_s) && same(*known_constant, time_constant)) {
            let fresh = Self::over(dt_s, time_constant);
            [*known_dt, *known_constant, *left, *mean] =
                [dt_s, time_constant, fresh.left, fresh.mean];
        }
        Self { left: *left, mean: *mean }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_time_constant_leaves_a_part_of_e() {
        let decay = Decay::over(0.2, 0.2);
        assert!((decay.left - 0.367_879_441_171_442_3).abs() < 1e-15);
        assert!((decay.mean - 0.632_120_558_828_557_7).abs() < 1e-15);
    }

    #[test]
    fn the_limits_are_all_and_nothing() {
        assert_eq!(Decay::over(0.01, 0.0), Decay { left: 0.0, mean: 0.0 });
        assert_eq!(Decay::over(0.01, 1e-320), Decay { left: 0.0, mean: 0.0 });
        assert_eq!(Decay::over(0.0, 1.0), Decay { left: 1.0, mean: 1.0 });
    }

    #[test]
    fn what_is_recalled_is_what_would_be_computed() {
        let mut memory = [0.0; DECAY_MEMORY];
        for (dt_s, constant) in [(0.01, 0.1), (0.01, 0.1), (0.02, 0.1), (0.02, 0.3), (0.0, 0.0)] {
            let expected = Decay::over(dt_s, constant);
            assert_eq!(Decay::recall(&mut memory, dt_s, constant), expected);
        }
    }
}
