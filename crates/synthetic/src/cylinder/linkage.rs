//! The triangle of joint, foot and rod eye.

use super::spec::{CylinderSpec, Part};

/// From the joint's angle θ (radians) to the length c of the cylinder.
///
/// ```text
///            eye
///          ´  |        c² = a² + b² - 2 a b cos ψ,   ψ = θ + ψ0
///     b  ´    | c
///      ´ ψ    |        lever = dc/dθ = a b sin ψ / c
/// joint - - - foot
///         a
/// ```
///
/// Without the part `linkage` the lever is everywhere that of the middle angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Linkage {
    foot: f64,
    eye: f64,
    offset: f64,
    limits: [f64; 2],
    straight: bool,
}

impl Linkage {
    pub(super) fn of(spec: &CylinderSpec) -> Self {
        Self {
            foot: spec.foot_m,
            eye: spec.eye_m,
            offset: spec.linkage_deg.to_radians(),
            limits: spec.angle_limits_deg.map(f64::to_radians),
            straight: !spec.has(Part::Linkage),
        }
    }

    /// Length of the cylinder at `angle`.
    pub(super) fn length(&self, angle: f64) -> f64 {
        if !self.straight {
            return self.side(angle);
        }
        let middle = self.middle();
        self.side(middle) + self.arm(middle) * (angle - middle)
    }

    /// Way of the piston per angle.
    pub(super) fn lever(&self, angle: f64) -> f64 {
        self.arm(if self.straight { self.middle() } else { angle })
    }

    /// Lengths with the piston at its ends.
    pub(super) fn ends(&self) -> [f64; 2] {
        self.limits.map(|angle| self.length(angle))
    }

    /// The longest lever arm between the limits.
    pub(super) fn longest_lever(&self) -> f64 {
        let [lowest, highest] = self.limits;
        let angles = (0..=100).map(|i| lowest + (highest - lowest) * f64::from(i) / 100.0);
        angles.map(|angle| self.lever(angle)).fold(0.0, f64::max)
    }

    /// The side of the triangle that the cylinder is.
    fn side(&self, angle: f64) -> f64 {
        let cosine = (angle + self.offset).cos();
        let squares = self.foot * self.foot + self.eye * self.eye;
        (squares - 2.0 * self.foot * self.eye * cosine).sqrt()
    }

    fn arm(&self, angle: f64) -> f64 {
        self.foot * self.eye * (angle + self.offset).sin() / self.side(angle)
    }

    fn middle(&self) -> f64 {
        f64::midpoint(self.limits[0], self.limits[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_right_angle_gives_the_triangle_of_three_four_five() {
        let spec = CylinderSpec {
            foot_m: 0.3,
            eye_m: 0.4,
            linkage_deg: 90.0,
            angle_limits_deg: [-60.0, 60.0],
            ..CylinderSpec::default()
        };
        let linkage = Linkage::of(&spec);
        assert!((linkage.length(0.0) - 0.5).abs() < 1e-12);
        // The height of that triangle: 0.3 × 0.4 / 0.5.
        assert!((linkage.lever(0.0) - 0.24).abs() < 1e-12);
        // Two sides meet at 30°: 0.3² + 0.4² - 2 × 0.12 × cos 30°.
        let closed = (0.25 - 0.24 * 0.75_f64.sqrt()).sqrt();
        assert!((linkage.ends()[0] - closed).abs() < 1e-12);
    }

    #[test]
    fn the_lever_is_the_slope_of_the_length() {
        for only in [None, Some(vec![])] {
            let linkage = Linkage::of(&CylinderSpec { only, ..CylinderSpec::default() });
            for angle in [-0.4, 0.0, 0.5, 1.2] {
                let slope = (linkage.length(angle + 1e-5) - linkage.length(angle - 1e-5)) / 2e-5;
                assert!((linkage.lever(angle) - slope).abs() < 1e-9, "at {angle}");
            }
        }
    }

    #[test]
    fn a_straight_one_has_one_lever() {
        let spec = CylinderSpec { only: Some(vec![]), ..CylinderSpec::default() };
        let linkage = Linkage::of(&spec);
        assert!((linkage.lever(-0.4) - linkage.lever(1.2)).abs() < 1e-15);
        let bent = Linkage::of(&CylinderSpec::default());
        assert!(bent.lever(1.2) < 0.85 * bent.lever(0.0));
    }
}
