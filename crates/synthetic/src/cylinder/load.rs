//! What the piston works against: friction, its ends, and the mass on the joint.

use super::spec::{CylinderSpec, Part};

/// Fall of gravity in metres per second squared.
const GRAVITY: f64 = 9.80665;

/// Speed over which the friction of the seals turns round, in metres per second.
const TURNING_SPEED: f64 = 1e-3;

/// Stiffness of the ends, in newtons per metre.
const END_STIFFNESS: f64 = 1e8;

/// Excess of the ends' force per speed of the piston, in seconds per metre: what it gives
/// back is less than what it took.
const END_LOSS: f64 = 5.0;

/// Damping of a fully entered cushion, in newton seconds per metre.
const CUSHION_DAMPING: f64 = 2e5;

/// The load of one cylinder, in SI units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Load {
    coulomb: f64,
    static_excess: f64,
    stribeck: f64,
    viscous: f64,
    weight_moment: f64,
    pub(super) inertia: f64,
    cushion: f64,
}

impl Load {
    pub(super) fn of(spec: &CylinderSpec) -> Self {
        let seals = if spec.has(Part::Friction) { 1.0 } else { 0.0 };
        let weight = if spec.has(Part::Gravity) { GRAVITY * spec.mass_kg } else { 0.0 };
        Self {
            coulomb: seals * spec.coulomb_n,
            static_excess: seals * (spec.static_n - spec.coulomb_n),
            stribeck: spec.stribeck_m_s,
            viscous: spec.viscous_n_s_m,
            weight_moment: weight * spec.centre_m,
            inertia: spec.inertia_kg_m2,
            cushion: spec.cushion_mm * 1e-3,
        }
    }

    /// Moment of the weight against a rising joint.
    pub(super) fn weight(&self, angle: f64) -> f64 {
        self.weight_moment * angle.cos()
    }

    /// Friction against the `speed` of the piston.
    ///
    /// ```text
    /// (Fc + (Fs - Fc) exp(-(v / vs)²)) tanh(v / 1 mm/s) + b v
    /// ```
    pub(super) fn friction(&self, speed: f64) -> f64 {
        let slow = (-(speed / self.stribeck).powi(2)).exp();
        let seals = self.coulomb + self.static_excess * slow;
        seals * (speed / TURNING_SPEED).tanh() + self.viscous * speed
    }

    /// Force of cushions and ends, outward, with the piston `out` of its inner end,
    /// `left` of its outer one.
    pub(super) fn ends(&self, out: f64, left: f64, speed: f64) -> f64 {
        self.end(out, speed) - self.end(left, -speed)
    }

    /// Force away from an end that is `away`, with the piston leaving it at `speed`.
    fn end(&self, away: f64, speed: f64) -> f64 {
        let entered = (1.0 - away / self.cushion).clamp(0.0, 1.0);
        let braked = CUSHION_DAMPING * entered * (-speed).max(0.0);
        let pressed = END_STIFFNESS * (-away).max(0.0) * (1.0 - END_LOSS * speed).max(0.0);
        braked + pressed
    }

    /// The fastest rate of a piston that moves `mass`.
    pub(super) fn rate(&self, mass: f64) -> f64 {
        let seals = (self.coulomb + self.static_excess) / TURNING_SPEED;
        (seals + self.viscous + CUSHION_DAMPING) / mass + (END_STIFFNESS / mass).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_falls_from_the_static_to_the_coulomb_one_and_rises_again() {
        let spec = CylinderSpec { viscous_n_s_m: 1000.0, ..CylinderSpec::default() };
        let load = Load::of(&spec);
        let cases = [
            (0.0, 0.0),
            (0.005, 2500.0 + 1000.0 * (-0.25_f64).exp() + 5.0),
            (0.1, 2500.0 + 100.0),
            (-0.1, -2600.0),
        ];
        for (speed, expected) in cases {
            let found = load.friction(speed);
            assert!((found - expected).abs() < 1.0, "{found} N at {speed} m/s");
        }
    }

    #[test]
    fn the_ends_push_back_and_never_pull() {
        let load = Load::of(&CylinderSpec::default());
        assert!(load.ends(0.3, 0.5, 0.2).abs() < 1e-12);
        assert!(load.ends(0.01, 0.5, -0.2) > 1e4);
        assert!(load.ends(0.01, 0.5, 0.2).abs() < 1e-12);
        assert!(load.ends(0.5, 0.01, 0.2) < -1e4);
        assert!(load.ends(-0.001, 0.9, 0.5) >= 0.0);
        assert!((load.ends(-0.001, 0.9, 0.0) - 1e5).abs() < 1e-6);
    }

    #[test]
    fn the_weight_is_largest_on_a_level_arm() {
        let load = Load::of(&CylinderSpec::default());
        assert!((load.weight(0.0) - 1000.0 * GRAVITY * 2.2).abs() < 1e-9);
        assert!((load.weight(1.0) / load.weight(0.0) - 1.0_f64.cos()).abs() < 1e-12);
    }
}
