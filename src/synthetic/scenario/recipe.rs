//! How each effect is hidden: from a strength of 0, no effect, to 1, all that is plausible.

use super::super::effects::{
    ActuatorLag, AsymmetricFriction, AsymmetricSaturation, Backlash, CoulombFriction, CreepMemory,
    DeadBand, DirectionGain, Disturbance, EndStop, FlowCurve, GravityLoad, InputNotch, InputOffset,
    InputSaturation, Leakage, OilColumn, PositionGain, RateLimit, Resonance, SensorNonlinearity,
    SpoolLag, StickySpot, Stiction, SupplyDroop, ThermalDrift, VariableDelay,
};
use super::super::spec::JointSpec;

/// What makes one instance of an effect differ from the next: drawn from 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chances(pub(super) [f64; 3]);

impl Chances {
    /// Number `index` between `from` and `to`.
    fn between(self, index: usize, from: f64, to: f64) -> f64 {
        from + (to - from) * self.0.get(index).copied().unwrap_or(0.5)
    }

    /// 1 or -1.
    fn sign(self, index: usize) -> f64 {
        if self.between(index, -1.0, 1.0) < 0.0 { -1.0 } else { 1.0 }
    }
}

/// Puts the effect `name` on a joint; `strength` is from 0 to 1.
pub(super) fn hide(name: &str, joint: &mut JointSpec, strength: f64, chances: Chances) {
    match name {
        "input_offset" => input_offset(joint, strength, chances),
        "dead_band" => dead_band(joint, strength, chances),
        "stiction" => stiction(joint, strength, chances),
        "input_saturation" => input_saturation(joint, strength, chances),
        "asymmetric_saturation" => asymmetric_saturation(joint, strength, chances),
        "flow_curve" => flow_curve(joint, strength, chances),
        "direction_gain" => direction_gain(joint, strength, chances),
        "rate_limit" => rate_limit(joint, strength, chances),
        "variable_delay" => variable_delay(joint, strength, chances),
        "actuator_lag" => actuator_lag(joint, strength, chances),
        "spool_lag" => spool_lag(joint, strength, chances),
        "resonance" => resonance(joint, strength, chances),
        "oil_column" => oil_column(joint, strength, chances),
        "coulomb_friction" => coulomb_friction(joint, strength, chances),
        "asymmetric_friction" => asymmetric_friction(joint, strength, chances),
        "gravity_load" => gravity_load(joint, strength, chances),
        "position_gain" => position_gain(joint, strength, chances),
        "thermal_drift" => thermal_drift(joint, strength, chances),
        "supply_droop" => supply_droop(joint, strength, chances),
        "leakage" => leakage(joint, strength, chances),
        "end_stop" => end_stop(joint, strength, chances),
        "backlash" => backlash(joint, strength, chances),
        "input_notch" => input_notch(joint, strength, chances),
        "creep_memory" => creep_memory(joint, strength, chances),
        "sticky_spot" => sticky_spot(joint, strength, chances),
        "disturbance" => disturbance(joint, strength, chances),
        "sensor_nonlinearity" => sensor_nonlinearity(joint, strength, chances),
        _ => {}
    }
}

/// Largest level that a recipe is made for, in input units.
pub(super) const LARGEST_LEVEL: f64 = 2.5;

fn input_offset(joint: &mut JointSpec, strength: f64, chances: Chances) {
    joint.effect.input_offset = Some(InputOffset { offset: chances.sign(0) * strength });
}

fn dead_band(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let lower = -1.5 * strength * chances.between(0, 0.6, 1.0);
    let upper = 1.5 * strength * chances.between(1, 0.6, 1.0);
    joint.effect.dead_band = Some(DeadBand { lower, upper });
}

fn stiction(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let start = LARGEST_LEVEL * strength;
    let stop = start * chances.between(0, 0.3, 0.6);
    joint.effect.stiction = Some(Stiction { start, stop });
}

fn input_saturation(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let limit = LARGEST_LEVEL * (1.05 - 0.95 * strength);
    // Where the corners of the valve are rounded, this one is as a rule, too.
    let sharp = 40.0 * (0.004 / joint.valve_edge).sqrt();
    let sharpness = if chances.sign(0) > 0.0 { sharp } else { 8.0 };
    joint.effect.input_saturation = Some(InputSaturation { limit, sharpness });
}

/// The limits differ by a quarter or more.
fn asymmetric_saturation(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let limit = LARGEST_LEVEL * (1.05 - 0.95 * strength);
    let apart = chances.between(1, 1.25, 1.6);
    let negative_ratio = if chances.sign(2) > 0.0 { apart } else { apart.recip() };
    let sharpness = if chances.sign(0) > 0.0 { 40.0 } else { 8.0 };
    let saturation = AsymmetricSaturation { limit, negative_ratio, sharpness };
    joint.effect.asymmetric_saturation = Some(saturation);
}

fn flow_curve(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let exponent = (chances.sign(0) * strength).exp();
    joint.effect.flow_curve = Some(FlowCurve { exponent });
}

fn direction_gain(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let negative_factor = (chances.sign(0) * strength).exp();
    joint.effect.direction_gain = Some(DirectionGain { negative_factor });
}

fn rate_limit(joint: &mut JointSpec, strength: f64, _chances: Chances) {
    joint.effect.rate_limit = Some(RateLimit { seconds_per_input: strength });
}

/// Two of the four terms: nearby steps differ, and so do those far apart.
fn variable_delay(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let (first, second) = (strength * chances.between(0, 0.6, 1.0), strength);
    let none = VariableDelay::default();
    joint.effect.variable_delay = Some(match (chances.sign(1) > 0.0, chances.sign(2) > 0.0) {
        (true, true) => VariableDelay { small_s: first, falling_s: second, ..none },
        (true, false) => VariableDelay { small_s: first, cold_s: second, ..none },
        (false, true) => VariableDelay { rested_s: first, falling_s: second, ..none },
        (false, false) => VariableDelay { rested_s: first, small_s: second, ..none },
    });
}

fn actuator_lag(joint: &mut JointSpec, strength: f64, _chances: Chances) {
    // The shortest that the time steps can follow, and more.
    joint.effect.actuator_lag = Some(ActuatorLag { time_constant: 0.01 + strength });
}

fn spool_lag(joint: &mut JointSpec, strength: f64, _chances: Chances) {
    joint.effect.spool_lag = Some(SpoolLag { time_constant: 0.01 + strength });
}

fn resonance(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let damping = chances.between(0, 0.08, 0.25);
    joint.effect.resonance = Some(Resonance { period: 0.08 + 1.5 * strength, damping });
}

/// With the valve wide open as much damping again, and a period that differs by a third
/// between the angles at which the joint is.
fn oil_column(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let period = 0.1 + 1.5 * strength;
    let damping = chances.between(0, 0.05, 0.12);
    let valve_damping = chances.between(1, 0.05, 0.15);
    let slope = chances.sign(2) * 0.005;
    let of_joint = OilColumn { period, damping, valve_damping, slope, reference: joint.start };
    joint.effect.oil_column = Some(of_joint);
}

fn coulomb_friction(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let positive = 1.5 * strength * chances.between(0, 0.6, 1.0);
    let negative = 1.5 * strength * chances.between(1, 0.6, 1.0);
    let time_constant = 0.02 + 0.3 * strength * chances.between(2, 0.5, 1.0);
    joint.effect.coulomb_friction = Some(CoulombFriction { positive, negative, time_constant });
}

/// Some part more or less both of the constant and of the viscous friction.
fn asymmetric_friction(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let positive = 1.2 * strength * chances.between(0, 0.6, 1.0);
    let negative = positive * chances.between(1, 0.7, 1.4);
    let time_constant = 0.05 + 0.2 * strength;
    let negative_viscous =
        if chances.sign(2) > 0.0 { 1.0 + strength } else { 1.0 / (1.0 + strength) };
    let friction = AsymmetricFriction { positive, negative, time_constant, negative_viscous };
    joint.effect.asymmetric_friction = Some(friction);
}

fn gravity_load(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let kappa = 0.9 * strength;
    let y0 = chances.between(0, -40.0, 40.0);
    let creep = 3.0 * strength * chances.between(1, 0.0, 1.0);
    joint.effect.gravity_load = Some(GravityLoad { kappa, y0, creep });
}

fn position_gain(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let ratio = chances.between(0, 0.2, 0.4);
    // Between square to the cylinder and the dead points.
    let mount = 90.0 + chances.sign(2) * chances.between(1, 25.0, 40.0);
    let leverage = 0.9 * strength;
    joint.effect.position_gain = Some(PositionGain { ratio, mount, leverage, reference: 0.0 });
}

fn thermal_drift(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let change = if chances.sign(0) > 0.0 { 2.0 * strength } else { -0.9 * strength };
    let time_constant = chances.between(1, 30.0, 70.0);
    joint.effect.thermal_drift = Some(ThermalDrift { change, time_constant });
}

fn supply_droop(joint: &mut JointSpec, strength: f64, _chances: Chances) {
    joint.effect.supply_droop = Some(SupplyDroop { droop: 0.95 * strength });
}

fn leakage(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let y0 = chances.between(0, -20.0, 20.0);
    joint.effect.leakage = Some(Leakage { rate: 0.6 * strength, y0 });
}

fn end_stop(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let low = -70.0 + 65.0 * strength;
    let high = 70.0 - 65.0 * strength * chances.between(0, 0.7, 1.0);
    joint.effect.end_stop = Some(EndStop { low: Some(low), high: Some(high) });
}

fn backlash(joint: &mut JointSpec, strength: f64, _chances: Chances) {
    joint.effect.backlash = Some(Backlash { width: 15.0 * strength });
}

/// Around one of the levels between the largest and the smallest, of either sign.
fn input_notch(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let middle = chances.sign(0) * chances.between(1, 0.9, 1.5);
    let (from, to) = (middle - 0.35, middle + 0.35);
    joint.outside.input_notch = Some(InputNotch { from, to, share: 1.0 - strength });
}

fn creep_memory(joint: &mut JointSpec, strength: f64, _chances: Chances) {
    joint.outside.creep_memory = Some(CreepMemory { share: strength });
}

fn sticky_spot(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let (middle, half) = (chances.between(0, -20.0, 20.0), chances.between(1, 6.0, 9.0));
    let (from, to) = (middle - half, middle + half);
    joint.outside.sticky_spot = Some(StickySpot { from, to, share: 1.0 - 0.95 * strength });
}

fn disturbance(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let from_s = chances.between(0, 20.0, 80.0);
    let to_s = from_s + chances.between(1, 5.0, 12.0);
    let speed = 20.0 * strength * chances.sign(2);
    joint.outside.disturbance = Some(Disturbance { from_s, to_s, speed });
}

fn sensor_nonlinearity(joint: &mut JointSpec, strength: f64, chances: Chances) {
    let (amplitude, zero) = (8.0 * strength, chances.between(0, -45.0, 45.0));
    let period = chances.between(1, 30.0, 60.0);
    joint.outside.sensor_nonlinearity = Some(SensorNonlinearity { amplitude, period, zero });
}
