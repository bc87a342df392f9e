//! The static curve of a joint: what its input stands for, piecewise linear.

use crate::numerics::quantile;

/// Bends of the curve. Dead band, saturation and two gains are a curve of four bends.
const BENDS: usize = 4;

/// `f(u) = c_0 + c_1 u + Σ c_j max(u − b_j, 0)`: all but the constant are columns of a
/// regression.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    middle: f64,
    scale: f64,
    bends: Vec<f64>,
}

impl Curve {
    /// A curve for these inputs, which bends at quantiles of the samples at which they move;
    /// `None` where they do not.
    pub(super) fn of<'a>(inputs: impl Iterator<Item = &'a [f64]> + Clone) -> Option<Self> {
        let moving = inputs.flat_map(|input| {
            let pairs = input.iter().zip(input.iter().skip(1));
            pairs.filter(|(before, after)| (*before - *after).abs() > 0.0).map(|(_, after)| *after)
        });
        let moving: Vec<f64> = moving.collect();
        let middle = quantile(&moving, 0.5)?;
        let scale = quantile(&moving, 0.95)? - quantile(&moving, 0.05)?;
        if scale <= 0.0 {
            return None;
        }
        let bend = |number: usize| quantile(&moving, number as f64 / (BENDS + 1) as f64);
        let mut bends: Vec<f64> = (1..=BENDS).filter_map(bend).collect();
        bends.dedup();
        Some(Self { middle, scale, bends })
    }

    /// Columns of the regression.
    pub(super) fn columns(&self) -> usize {
        1 + self.bends.len()
    }

    /// Column `index` at an input.
    pub(super) fn at(&self, index: usize, input: f64) -> f64 {
        match index.checked_sub(1).and_then(|bend| self.bends.get(bend)) {
            Some(bend) => (input - bend).max(0.0) / self.scale,
            None => (input - self.middle) / self.scale,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_bends_where_the_input_moves() {
        let input: Vec<f64> = (0..500).map(|k| f64::from((k % 100).min(50))).collect();
        let curve = Curve::of(std::iter::once(input.as_slice())).unwrap();
        assert_eq!(curve.columns(), 5);
        assert!(curve.at(0, 50.0) > 0.0 && curve.at(0, 0.0) < 0.0);
        assert!(curve.at(4, 30.0) == 0.0 && curve.at(4, 50.0) > 0.0);
        assert!(Curve::of(std::iter::once([1.0; 9].as_slice())).is_none());
    }
}
