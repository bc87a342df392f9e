//! Linkage: how far the joint turns for the same way of the cylinder depends on the angle.
//!
//! ```text
//! out = in / max(1 − slope · d − curvature · d² − cubic · d³, 0.05),   d = y − reference
//! ```
//!
//! The polynomial stands for the lever arm of the cylinder about the joint, through which the speed of
//! the one is divided to get that of the other. By the law of cosines the arm has a maximum and falls
//! to both sides, to one of them faster. Where the gain changes by a factor of 2.5 to 5, a cubic follows
//! the arm within 0.02 % over 40 to 110 degrees and within 0.6 % over 110 to 140; a parabola leaves 0.3 and
//! 2.7 %, and a cubic in the place of the gain 1.5 and 3.4 % (medians of 1000 random linkages each; see the
//! test). The gain of the joint is that at `reference`, which is a choice and not fitted: the middle of the
//! record, so that the gain is known best. Outside the angles of the record the polynomial says nothing,
//! and the floor only keeps the joint from turning round.
//!
//! # References
//! Koivo, A. J., 1994, Kinematics of excavators (backhoes) for transferring surface
//! material, Journal of Aerospace Engineering 7 (the lever arms in full).

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct PositionGain;

static SPEC: Spec =
    Spec::new("position_gain", Stage::Load, "linkage: the gain depends on the angle")
        .equation("out = in / (1 - slope d - curvature d^2 - cubic d^3), d = y - reference")
        .source(
            "Koivo, 1994, Kinematics of excavators (backhoes) for transferring surface material, \
             Journal of Aerospace Engineering 7",
        )
        .parameters(&[
            Parameter::new(
                "slope",
                "relative change of the gain with the angle, near `reference`",
                Dimension::PerOutput,
            ),
            Parameter::new(
                "curvature",
                "relative decrease of the lever arm with its square",
                Dimension::PerOutputSquared,
            ),
            Parameter::new(
                "cubic",
                "relative decrease of the lever arm with its cube",
                Dimension::PerOutputCubed,
            ),
            Parameter::new(
                "reference",
                "angle at which the gain is that of the joint",
                Dimension::Output,
            )
            .not_fitted(),
        ])
        .confused_with(&["gravity_load"])
        .equations(Equations::new(&["away = position - reference
             out = signal / max(1 - away * (slope + away * (curvature + cubic * away)), 0.05)"]));

/// Smallest lever arm, in parts of that at `reference`.
const SMALLEST_ARM: f64 = 0.05;

impl Effect for PositionGain {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[slope, curvature, cubic, reference] = parameters else { return at.signal };
        let away = at.position - reference;
        at.signal / (1.0 - away * (slope + away * (curvature + cubic * away))).max(SMALLEST_ARM)
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        vec![vec![0.0, 0.0, 0.0, record.output_middle()]]
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::super::testing::{assert_close, moment};
    use super::*;
    use crate::numerics::median;
    use crate::numerics::testing::uniform;

    #[test]
    fn divides_by_a_polynomial_about_the_reference_with_a_floor() {
        let gain = |position| {
            let at = Moment { position, ..moment(-10.0) };
            PositionGain.step(&[-0.01, 0.001, 0.0001, 20.0], &mut [], &at)
        };
        assert_close(
            &[20.0, 10.0, 0.0, 100.0].map(gain),
            &[-10.0, -10.0 / 0.9, -10.0 / 1.2, -200.0],
        );
    }

    /// The root-mean-square relative error of the polynomial of this degree that is nearest to `values`,
    /// evenly spaced.
    fn beside_polynomial(values: &[f64], degree: i32) -> f64 {
        let middle = 0.5 * (values.len() - 1) as f64;
        let place = |k: usize| (k as f64 - middle) / middle;
        let powers: Vec<i32> = (0..=degree).collect();
        let power = |row: usize, column: usize| place(row).powi(powers[column]) / values[row];
        let columns = DMatrix::from_fn(values.len(), powers.len(), power);
        let ones = DVector::from_element(values.len(), 1.0);
        let best = columns.clone().svd(true, true).solve(&ones, 1e-12).unwrap();
        ((columns * best - ones).norm_squared() / values.len() as f64).sqrt()
    }

    /// The medians of what a cubic and a parabola leave of the lever arms of 1000 random linkages, and a
    /// cubic of their gains, over angles of `least` to `most` degrees.
    fn left_over(least: f64, most: f64) -> [f64; 3] {
        let mut uniform = uniform(1);
        let mut between = |low: f64, high: f64| low + (high - low) * (0.5 + uniform());
        let mut left: [Vec<f64>; 3] = Default::default();
        while left[0].len() < 1000 {
            // The cylinder between two sides of a triangle, one of them 1, with this angle between them.
            let (side, span) = (between(0.3, 1.0), between(least, most));
            let start = between(5.0, 170.0);
            if start + span > 175.0 {
                continue;
            }
            let arm = |k: u32| {
                let (sine, cosine) = (start + span * f64::from(k) / 100.0).to_radians().sin_cos();
                side * sine / (1.0 + side * side - 2.0 * side * cosine).sqrt()
            };
            let arms: Vec<f64> = (0..=100).map(arm).collect();
            let gains: Vec<f64> = arms.iter().map(|arm| 1.0 / arm).collect();
            let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
            if (2.5..=5.0).contains(&(largest(&arms) * largest(&gains))) {
                left[0].push(beside_polynomial(&arms, 3));
                left[1].push(beside_polynomial(&arms, 2));
                left[2].push(beside_polynomial(&gains, 3));
            }
        }
        left.map(|values| median(&values).unwrap())
    }

    #[test]
    fn a_cubic_follows_a_lever_arm_better_than_a_parabola_and_than_its_gain() {
        let narrow = left_over(40.0, 110.0);
        let wide = left_over(110.0, 140.0);
        let documented = [(narrow, [0.0002, 0.003, 0.015]), (wide, [0.006, 0.027, 0.034])];
        for (found, said) in documented {
            let is_near =
                found.iter().zip(said).all(|(found, said)| (found / said - 1.0).abs() < 0.15);
            assert!(is_near, "{found:?}");
        }
    }
}
