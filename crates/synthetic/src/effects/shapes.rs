//! Rounded corners, so that no hidden effect is the formula that is fitted.

/// 0 below, 1 above, rounded over some `width` about zero.
pub(super) fn rise(x: f64, width: f64) -> f64 {
    0.5 * (1.0 + (0.5 * x / width).tanh())
}

/// `max(x, 0)` with a corner that is rounded over some `width`.
pub(super) fn ramp(x: f64, width: f64) -> f64 {
    x.max(0.0) + width * (-x.abs() / width).exp().ln_1p()
}

/// 1 between `from` and `to`, 0 outside, each end rounded over some `width`.
pub(super) fn window(x: f64, from: f64, to: f64, width: f64) -> f64 {
    rise(x - from, width) * rise(to - x, width)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounded_shapes_are_sharp_ten_widths_away() {
        for (x, slope, step) in [(-1.0, 0.0, 0.0), (1.0, 1.0, 1.0)] {
            assert!((ramp(x, 0.1) - slope).abs() < 1e-4);
            assert!((rise(x, 0.1) - step).abs() < 1e-4);
        }
        assert!((ramp(0.0, 0.1) - 0.1 * 2_f64.ln()).abs() < 1e-12);
        assert!((window(0.0, -1.0, 1.0, 0.1) - 1.0).abs() < 1e-3);
        assert!(window(2.0, -1.0, 1.0, 0.1) < 1e-4);
    }
}
