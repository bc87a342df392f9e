//! Effects with inertia against an integration in small steps, with other formulas.

use std::f64::consts::TAU;

use proptest::prelude::*;
use tauscope::effect::{
    ActuatorLag, AsymmetricFriction, CoulombFriction, DeadBand, DirectionGain, Effect,
    LimitingCase, Moment, OilColumn, RateLimit, Resonance,
};

/// Small steps in an interval.
const STEPS: u32 = 2000;

/// A part of a record: the input held, and for how many seconds.
type Hold = (f64, f64);

/// The mean of `effect` over each of `holds`, from rest.
fn means(effect: &dyn Effect, parameters: &[f64], holds: &[Hold]) -> Vec<f64> {
    let mut memory = vec![0.0; effect.spec().memory];
    let mean = |(signal, dt_s): &Hold| {
        let at = Moment {
            signal: *signal,
            position: 0.0,
            velocity: 0.0,
            time_s: 0.0,
            dt_s: *dt_s,
            others: 0.0,
            measured: f64::NAN,
            radians_per_output_unit: 1.0,
        };
        effect.step(parameters, &mut memory, &at)
    };
    holds.iter().map(mean).collect()
}

/// The mean of `x` over each of `holds`, from rest, `x` and its rate being moved over a
/// small step by `small_step`, which is told them, the input and the length in seconds.
fn integrated(holds: &[Hold], small_step: impl Fn([f64; 2], f64, f64) -> [f64; 2]) -> Vec<f64> {
    let mut state = [0.0; 2];
    let mut mean = |(input, dt_s): &Hold| {
        let mut sum = 0.0;
        for _ in 0..STEPS {
            let before = state[0];
            state = small_step(state, *input, dt_s / f64::from(STEPS));
            sum += f64::midpoint(before, state[0]);
        }
        sum / f64::from(STEPS)
    };
    holds.iter().map(&mut mean).collect()
}

/// The midpoint rule for `x' = slope(x)`.
fn midpoint_rule(x: [f64; 2], h: f64, slope: impl Fn([f64; 2]) -> [f64; 2]) -> [f64; 2] {
    let [a, b] = slope(x);
    let [a, b] = slope([x[0] + 0.5 * h * a, x[1] + 0.5 * h * b]);
    [x[0] + h * a, x[1] + h * b]
}

/// Inputs up to 1, in units that make `tolerance` a relative one.
fn holds() -> impl Strategy<Value = Vec<Hold>> {
    prop::collection::vec((-1.0_f64..1.0, 0.1_f64..1.0), 1..6)
}

fn agree(found: &[f64], expected: &[f64], tolerance: f64) -> Result<(), TestCaseError> {
    for (a, b) in found.iter().zip(expected) {
        prop_assert!((a - b).abs() <= tolerance, "{found:?} is not {expected:?}");
    }
    Ok(())
}

/// `holds` after `effect`.
fn behind(effect: &dyn Effect, parameters: &[f64], holds: &[Hold]) -> Vec<Hold> {
    let outputs = means(effect, parameters, holds);
    outputs.into_iter().zip(holds).map(|(output, (_, dt_s))| (output, *dt_s)).collect()
}

#[test]
fn frictions_say_what_they_are_without_inertia() {
    let parameter = "time_constant";
    let case = |effects| Some(LimitingCase { parameter, effects });
    assert_eq!(CoulombFriction.spec().limiting_case, case(&["dead_band"]));
    let asymmetric = AsymmetricFriction.spec().limiting_case;
    assert_eq!(asymmetric, case(&["dead_band", "direction_gain"]));
}

proptest! {
    #[test]
    fn without_inertia_a_friction_is_its_limiting_case(
        holds in holds(),
        (positive, negative) in (0.0_f64..0.5, 0.0_f64..0.5),
        negative_viscous in 0.3_f64..3.0,
    ) {
        let overlap = behind(&DeadBand, &[-negative, positive], &holds);
        let outputs: Vec<f64> = overlap.iter().map(|(output, _)| *output).collect();
        agree(&means(&CoulombFriction, &[positive, negative, 0.0], &holds), &outputs, 1e-12)?;
        let by_direction = means(&DirectionGain, &[1.0 / negative_viscous], &overlap);
        let friction = [positive, negative, 0.0, negative_viscous];
        agree(&means(&AsymmetricFriction, &friction, &holds), &by_direction, 1e-12)?;
    }

    #[test]
    fn lag(holds in holds(), constant in 0.5_f64..100.0) {
        let expected = integrated(&holds, |x, input, h| {
            midpoint_rule(x, h, |[x, _]| [(input - x) / constant, 0.0])
        });
        // The midpoint rule errs by (h / T)² / 6 and the trapezia by as much: 3e-7.
        agree(&means(&ActuatorLag, &[constant], &holds), &expected, 1e-6)?;
    }

    #[test]
    fn resonance(
        holds in holds(),
        omega in prop_oneof![1e-4..1e-2, 0.01..1.0],
        damping in prop_oneof![Just(1.0), 0.0..0.3, 0.9..1.1, 1.0..2.5],
    ) {
        let expected = integrated(&holds, |x, input, h| {
            let force = |[x, v]: [f64; 2]| omega * (omega * (input - x) - 2.0 * damping * v);
            midpoint_rule(x, h, |x| [x[1], force(x)])
        });
        agree(&means(&Resonance, &[TAU / omega, damping], &holds), &expected, 1e-6)?;
    }

    #[test]
    fn oil_column(
        holds in holds(),
        omega in 0.01..1.0,
        damping in 0.0..0.3,
        valve_damping in 0.0..2.0,
        (slope, away) in (-0.02..0.02, -20.0..20.0),
    ) {
        // All the time at the angle 0.
        let there = omega / (1.0 - slope * away);
        let expected = integrated(&holds, |x, input, h| {
            let braked = 2.0 * (damping + valve_damping * input.abs());
            let force = |[x, v]: [f64; 2]| there * (there * (input - x) - braked * v);
            midpoint_rule(x, h, |x| [x[1], force(x)])
        });
        let parameters = [TAU / omega, damping, valve_damping, slope, 0.0, away];
        agree(&means(&OilColumn, &parameters, &holds), &expected, 1e-6)?;
    }

    #[test]
    fn rate_limit(
        holds in holds(), seconds_per_input in 0.05_f64..20.0, falling in -0.5_f64..2.0,
    ) {
        let expected = integrated(&holds, |[x, _], input, h| {
            let most = h / seconds_per_input;
            [x + (input - x).clamp(-most / (1.0 + falling), most), 0.0]
        });
        // The small step in which a ramp ends is cut across, by half its height for its
        // time: 0.5 h² / (s dt), with h = dt / 2000.
        let shorter = seconds_per_input * (1.0 + falling.min(0.0));
        let cut = 0.5 / (shorter * f64::from(STEPS).powi(2));
        let found = means(&RateLimit, &[seconds_per_input, falling], &holds);
        agree(&found, &expected, 1e-9 + cut)?;
    }

    #[test]
    fn friction(
        holds in holds(), positive in 0.0_f64..0.5, negative in 0.0_f64..0.5,
        constant in 0.2_f64..10.0,
    ) {
        let expected = integrated(&holds, |[v, _], input, h| {
            let free = v + h * (input - v) / constant;
            let braked = free.abs() - h * if free > 0.0 { positive } else { negative } / constant;
            [braked.max(0.0).copysign(free), 0.0]
        });
        // Euler's rule, of first order: h / T up to 2.5e-3 times a change of up to 1.5.
        let found = means(&CoulombFriction, &[positive, negative, constant], &holds);
        agree(&found, &expected, 4e-3 / constant.max(1.0))?;
    }

    #[test]
    fn asymmetric_friction(
        holds in holds(), levels in (0.0_f64..0.5, 0.0_f64..0.5),
        constant in 0.5_f64..10.0, ratio in 0.4_f64..2.5,
    ) {
        let (positive, negative) = levels;
        let expected = integrated(&holds, |[v, _], input, h| {
            let viscous = if v < 0.0 { ratio * v } else { v };
            let free = v + h * (input - viscous) / constant;
            let braked = free.abs() - h * if free > 0.0 { positive } else { negative } / constant;
            [braked.max(0.0).copysign(free), 0.0]
        });
        let found = means(&AsymmetricFriction, &[positive, negative, constant, ratio], &holds);
        // As above, at a time constant of down to T / ratio.
        agree(&found, &expected, 1e-2 / constant.max(1.0))?;
    }
}
