//! Each effect that a plant can hide, against a computation by hand.
//!
//! The joint has a gain of 10 deg/s/V and a delay of 0.1 s. Tolerances allow for what the
//! plant rounds: corners of 0.4 % of the largest level, edges of a time step (0.5 ms).

use std::f64::consts::{PI, TAU};

use tauscope::effect::REGISTRY;
use tauscope::synthetic::effects::{CATALOGUE, FINER, OUTSIDE};
use tauscope::synthetic::{
    DelayLaw, InputSpec, JointSpec, PlantError, PlantSpec, Spikes, Synthetic, simulate,
};

const GAIN: f64 = 10.0;
const DELAY_S: f64 = 0.1;
const PERIOD_S: f64 = 0.01;

/// A joint that hides an effect, `name: key = number, ...`; none where the text is empty.
fn hiding(text: &str, steps: &[(usize, f64)]) -> JointSpec {
    let input = InputSpec::Steps { steps: steps.to_vec(), initial: 0.0 };
    let mut joint = JointSpec::new("joint", input, DelayLaw::Constant { seconds: DELAY_S });
    if let Some((name, numbers)) = text.split_once(':') {
        let number = |part: &str| {
            let (key, number) = part.split_once('=').unwrap();
            (key.trim().to_owned(), number.trim().parse().unwrap())
        };
        let numbers: Vec<_> = numbers.split(',').map(number).collect();
        joint.hide(name, &numbers).unwrap();
    }
    joint
}

fn made(joint: JointSpec, duration_s: f64) -> Synthetic {
    simulate(&PlantSpec::new(1, duration_s, vec![joint])).unwrap()
}

fn output(joint: JointSpec, duration_s: f64) -> Vec<f64> {
    made(joint, duration_s).joints[0].trials[0].output().to_vec()
}

/// The sample at `time_s`, or the next one.
fn at(output: &[f64], time_s: f64) -> f64 {
    // Half a sample early, so that rounding does not matter.
    let sample = (0..output.len()).find(|k| *k as f64 > time_s / PERIOD_S - 0.5).unwrap();
    output[sample]
}

/// Mean speed between two times.
fn speed(output: &[f64], from_s: f64, to_s: f64) -> f64 {
    (at(output, to_s) - at(output, from_s)) / (to_s - from_s)
}

/// Speed from 2 s to 2.5 s of a joint that gets `level` at 1 s.
fn steady(text: &str, level: f64) -> f64 {
    let steps: &[(usize, f64)] = if level == 0.0 { &[(300, 1.0)] } else { &[(101, level)] };
    speed(&output(hiding(text, steps), 3.0), 2.0, 2.5)
}

#[track_caller]
fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} is not {expected} ± {tolerance}");
}

#[test]
fn the_valve_opens_as_computed() {
    let half = 2_f64.powf(-1.0 / 4.0);
    let cases = [
        ("", 1.0, 10.0),
        ("input_offset:offset=0.3", 1.0, 13.0),
        ("input_offset:offset=0.3", 0.0, 3.0),
        ("dead_band:lower=-0.4,upper=0.6", 1.0, 4.0),
        ("dead_band:lower=-0.4,upper=0.6", 0.5, 0.0),
        ("dead_band:lower=-0.4,upper=0.6", -1.0, -6.0),
        ("input_saturation:limit=1.5", 1.0, 10.0),
        ("input_saturation:limit=1.5", -3.0, -15.0),
        ("input_saturation:limit=1.5,sharpness=4", 1.5, 15.0 * half),
        ("flow_curve:exponent=1.5", 4.0, 80.0),
        ("flow_curve:exponent=0.5", -4.0, -20.0),
        ("direction_gain:negative_factor=0.7", -2.0, -14.0),
        ("direction_gain:negative_factor=0.7", 2.0, 20.0),
        ("input_notch:from=0.8,to=1.4,share=0.3", 1.1, 3.3),
        ("input_notch:from=0.8,to=1.4,share=0.3", 2.0, 20.0),
    ];
    for (text, level, expected) in cases {
        let found = steady(text, level);
        assert!((found - expected).abs() < 0.01 * GAIN, "{text} at {level} V: {found}");
    }
}

#[test]
fn a_joint_that_sticks_starts_above_one_level_and_stops_below_another() {
    let levels = [0.8, 1.5, 0.8, 0.3, -0.8, -1.2, 1.2];
    let expected = [0.0, 15.0, 8.0, 0.0, 0.0, -12.0, 12.0];
    let steps: Vec<_> = (1..).zip(levels).map(|(k, level)| (100 * k + 1, level)).collect();
    let output = output(hiding("stiction:start=1.0,stop=0.5", &steps), 9.0);
    for (k, expected) in (1..).zip(expected) {
        let from_s = f64::from(k) + 0.2;
        assert_near(speed(&output, from_s, from_s + 0.8), expected, 1e-3);
    }
}

#[test]
fn a_spool_of_limited_speed_is_late_by_half_its_ramp() {
    let output = output(hiding("rate_limit:seconds_per_input=0.5", &[(101, 2.0)]), 4.0);
    // A ramp of 1 s: half of 20 deg/s is missing for that time.
    assert_near(at(&output, 3.5), 20.0 * (3.5 - 1.0 - DELAY_S) - 10.0, 0.05);
    assert_near(speed(&output, 1.59, 1.61), 10.0, 0.1);
}

#[test]
fn a_lag_is_late_by_its_time_constant() {
    let output = output(hiding("actuator_lag:time_constant=0.2", &[(101, 2.0)]), 4.0);
    let t = 0.3_f64;
    let expected = 20.0 * (t - 0.2 * (1.0 - (-t / 0.2).exp()));
    assert_near(at(&output, 1.0 + DELAY_S + t), expected, 1e-6);
}

#[test]
fn oil_that_springs_overshoots_as_its_damping_says() {
    let output = output(hiding("resonance:period=0.5,damping=0.2", &[(101, 2.0)]), 4.0);
    let root = (1.0_f64 - 0.04).sqrt();
    let peak_s = 1.0 + DELAY_S + 0.25 / root;
    let expected = 20.0 * (1.0 + (-0.2 * PI / root).exp());
    // The mean of 20 ms about the peak is below it by (ω 0.02)² / 24, 0.3 % of the swing.
    assert_near(speed(&output, peak_s - 0.01, peak_s + 0.01), expected, 0.1);
    assert_near(speed(&output, 3.5, 3.9), 20.0, 0.1);
}

#[test]
fn friction_holds_slows_and_stops() {
    let friction = "coulomb_friction:positive=0.5,negative=0.8,time_constant=0.1";
    for (level, expected) in [(0.4, 0.0), (2.0, 15.0), (-2.0, -12.0), (-0.7, 0.0)] {
        assert_near(steady(friction, level), expected, 0.02);
    }
    // From 1.5 V to a stop in 0.1 ln(1 + 1.5 / 0.5) s, by 10 (0.1 · 1.5 − 0.5 · 0.1386) deg.
    let output = output(hiding(friction, &[(101, 2.0), (201, 0.0)]), 4.0);
    let stop_s = 0.1 * (1.5_f64 / 0.5).ln_1p();
    let way = at(&output, 3.5) - at(&output, 2.0 + DELAY_S);
    assert_near(way, GAIN * (0.1 * 1.5 - 0.5 * stop_s), 0.02);
    // The bristles, a fiftieth of a degree, swing for some time constants.
    assert_near(speed(&output, 2.5, 3.9), 0.0, 0.01);
}

#[test]
fn a_delay_that_varies_is_in_the_truth_and_in_the_log() {
    let text = "variable_delay:small_s=0.2,scale=2,falling_s=0.05,rested_s=0.3,rest_s=2,\
                cold_s=0.1,warming_s=50";
    let made = made(hiding(text, &[(101, 2.0), (301, -1.0)]), 6.0);
    let expected = [
        DELAY_S + 0.2 * (-1.0_f64).exp() + 0.3 * (1.0 - (-0.5_f64).exp()) + 0.1 * (-0.02_f64).exp(),
        DELAY_S
            + 0.2 * (-1.5_f64).exp()
            + 0.05
            + 0.3 * (1.0 - (-1.0_f64).exp())
            + 0.1 * (-0.06_f64).exp(),
    ];
    for (step, expected) in made.truth.iter().zip(expected) {
        assert_near(step.delay_s, expected, 1e-12);
    }
    let output = made.joints[0].trials[0].output();
    assert_near(at(output, 3.0), 20.0 * (3.0 - 1.0 - expected[0]), 1e-9);
}

#[test]
fn a_weight_slows_the_way_up_and_helps_down() {
    let gravity = "gravity_load:kappa=0.5,y0=0,creep=2";
    let speed_at = |level: f64, start: f64| {
        let joint = JointSpec { start, gain: 1.0, ..hiding(gravity, &[(2, level)]) };
        speed(&output(joint, 1.0), 0.15, 0.25)
    };
    // At 60 degrees half of the weight pulls; some tenths of a degree are gone by then.
    assert_near(speed_at(2.0, 0.0), 2.0 * 0.5_f64.sqrt() - 2.0, 0.01);
    assert_near(speed_at(-2.0, 0.0), -2.0 * 1.5_f64.sqrt() - 2.0, 0.01);
    assert_near(speed_at(2.0, 60.0), 2.0 * 0.75_f64.sqrt() - 1.0, 0.01);
}

#[test]
fn the_cylinder_of_a_linkage_moves_evenly() {
    let text = "position_gain:ratio=0.3,mount=60,leverage=0.8,reference=0";
    let joint = JointSpec { start: -30.0, ..hiding(text, &[(101, 1.0)]) };
    let output = output(joint, 6.0);
    // Distance from the foot at (1, 0) to the head on a circle of radius 0.3.
    let length = |time_s: f64| {
        let phi = (60.0 + 0.8 * at(&output, time_s)).to_radians();
        (0.3 * phi.cos() - 1.0).hypot(0.3 * phi.sin())
    };
    let early = (length(1.6) - length(1.2)) / 0.4;
    let late = (length(5.8) - length(5.4)) / 0.4;
    assert_near(late / early, 1.0, 1e-6);
    // The gain is that of the joint at the reference.
    let crossing = output.iter().position(|y| *y >= 0.0).unwrap() as f64 * PERIOD_S;
    assert_near(speed(&output, crossing - 0.02, crossing + 0.02), GAIN, 0.05);
}

#[test]
fn warm_oil_changes_the_gain() {
    let output = output(hiding("thermal_drift:change=0.5,time_constant=20", &[(2, 1.0)]), 61.0);
    for t in [1.0, 20.0, 60.0] {
        let expected = GAIN * (1.0 + 0.5 * (1.0 - (-t / 20.0_f64).exp()));
        assert_near(speed(&output, t - 0.1, t + 0.1), expected, 0.01);
    }
}

#[test]
fn a_pump_that_is_shared_droops_with_the_others_demand() {
    let other = JointSpec { name: "other".to_owned(), ..hiding("", &[(201, 2.0), (401, -1.0)]) };
    let joint = hiding("supply_droop:droop=0.4", &[(101, 1.0)]);
    let made = simulate(&PlantSpec::new(1, 6.0, vec![joint, other])).unwrap();
    let output = made.joints[0].trials[0].output();
    for (from_s, expected) in [(1.5, 10.0), (2.5, 6.0), (4.5, 8.0)] {
        assert_near(speed(output, from_s, from_s + 0.4), expected, 1e-3);
    }
}

#[test]
fn two_joints_on_one_pump_slow_each_other_down() {
    let joints = ["a", "b"].map(|name| JointSpec {
        name: name.to_owned(),
        ..hiding("supply_droop:droop=0.4", &[(101, 1.0)])
    });
    let made = simulate(&PlantSpec::new(1, 3.0, joints.to_vec())).unwrap();
    for joint in &made.joints {
        assert_near(speed(joint.trials[0].output(), 2.0, 2.5), 6.0, 1e-3);
    }
}

#[test]
fn a_leak_lets_the_joint_drift_to_its_balance() {
    let joint = JointSpec { start: 20.0, ..hiding("leakage:rate=0.1,y0=5", &[(500, 1.0)]) };
    assert_near(at(&output(joint, 6.0), 4.0), 5.0 + 15.0 * (-0.4_f64).exp(), 1e-6);
}

#[test]
fn a_stop_holds_the_joint_until_the_input_turns() {
    let output = output(hiding("end_stop:low=-30,high=10", &[(101, 2.0), (301, -1.0)]), 5.0);
    // It gives by one time step, 0.5 ms, at 20 deg/s.
    assert_near(at(&output, 2.5), 10.0, 0.011);
    assert_near(at(&output, 3.6), 10.0 - GAIN * 0.5, 0.02);
}

#[test]
fn play_is_used_up_before_the_sensor_follows() {
    let output = output(hiding("backlash:width=4", &[(101, 1.0), (301, -1.0)]), 5.0);
    // From the middle: half of the play; after the turn the whole of it.
    assert_near(at(&output, 1.0 + DELAY_S + 0.19), 0.0, 1e-9);
    assert_near(at(&output, 2.9), GAIN * (1.9 - DELAY_S) - 2.0, 0.01);
    assert_near(speed(&output, 3.12, 3.48), 0.0, 0.02);
    assert_near(speed(&output, 4.0, 4.5), -GAIN, 1e-3);
}

#[test]
fn a_joint_is_slow_in_a_sticky_spot_and_nowhere_else() {
    let output = output(hiding("sticky_spot:from=10,to=20,share=0.2", &[(2, 1.0)]), 9.0);
    let time_of = |angle: f64| output.iter().position(|y| *y >= angle).unwrap() as f64 * PERIOD_S;
    assert_near((18.0 - 12.0) / (time_of(18.0) - time_of(12.0)), 2.0, 0.1);
    assert_near(10.0 / (time_of(35.0) - time_of(25.0)), 10.0, 0.15);
}

#[test]
fn a_disturbance_pushes_while_it_lasts() {
    let output = output(hiding("disturbance:from_s=2,to_s=4,speed=-3", &[(101, 1.0)]), 6.0);
    for (from_s, expected) in [(1.2, 10.0), (2.5, 7.0), (4.5, 10.0)] {
        assert_near(speed(&output, from_s, from_s + 0.4), expected, 0.01);
    }
}

#[test]
fn what_creeps_comes_in_part_at_once_and_in_the_end_whole() {
    let output = output(hiding("creep_memory:share=0.4", &[(101, 1.0)]), 200.0);
    assert_near(speed(&output, 1.1, 1.12), 6.0, 0.1);
    let half_life = speed(&output, 2.95, 3.05);
    let left = [0.5, 2.0, 8.0, 32.0].map(|tau: f64| (-1.9 / tau).exp());
    assert_near(half_life, 10.0 * (1.0 - 0.4 * left.iter().sum::<f64>() / 4.0), 0.01);
    assert_near(speed(&output, 198.0, 199.0), 10.0, 0.01);
}

#[test]
fn a_sensor_out_of_centre_adds_a_sine_of_the_angle() {
    let text = "sensor_nonlinearity:amplitude=2,period=30,zero=5";
    let output = output(hiding(text, &[(101, 1.0)]), 5.0);
    for t in [2.0, 3.0, 4.5] {
        let angle = GAIN * (t - 1.0 - DELAY_S);
        assert_near(at(&output, t), angle + 2.0 * (TAU * (angle - 5.0) / 30.0).sin(), 1e-9);
    }
}

#[test]
fn spikes_are_as_many_and_as_large_as_wanted_and_leave_the_noise_alone() {
    let quiet = JointSpec { noise: 0.05, ..hiding("", &[(101, 0.1)]) };
    let spikes = Some(Spikes { share: 0.01, size: 5.0 });
    let spiked = output(JointSpec { spikes, ..quiet.clone() }, 200.0);
    let quiet = output(quiet, 200.0);
    let off: Vec<f64> = spiked.iter().zip(&quiet).map(|(a, b)| a - b).collect();
    let hit: Vec<&f64> = off.iter().filter(|off| off.abs() > 0.0).collect();
    // 200 expected, with a deviation of 14.
    assert!((140..=260).contains(&hit.len()), "{}", hit.len());
    assert!(hit.iter().all(|off| (off.abs() - 5.0).abs() < 1e-9));
    assert!(hit.iter().any(|off| **off > 0.0) && hit.iter().any(|off| **off < 0.0));
}

/// Each effect at its neutral numbers, and how far it may lead: what takes time takes four
/// time steps at least, 2 ms at up to 20 deg/s.
const NEUTRAL: [(&str, f64); 27] = [
    ("input_offset:offset=0", 1e-9),
    ("dead_band:lower=0,upper=0", 1e-9),
    ("stiction:start=0,stop=0", 0.1),
    ("flow_curve:exponent=1", 1e-9),
    ("direction_gain:negative_factor=1", 1e-9),
    ("input_saturation:limit=1e9", 1e-9),
    ("asymmetric_saturation:limit=1e9,negative_ratio=1", 1e-9),
    ("variable_delay:small_s=0", 1e-9),
    ("rate_limit:seconds_per_input=1e-9", 0.1),
    ("actuator_lag:time_constant=0.002", 0.1),
    ("spool_lag:time_constant=0.002", 0.1),
    ("resonance:period=0.02,damping=0.9", 0.2),
    ("oil_column:period=0.02,damping=0.9,valve_damping=0,slope=0,reference=0", 0.2),
    ("coulomb_friction:positive=0,negative=0,time_constant=0.002", 0.1),
    ("asymmetric_friction:positive=0,negative=0,time_constant=0.002,negative_viscous=1", 0.1),
    ("position_gain:ratio=0.3,mount=60,leverage=0,reference=0", 1e-9),
    ("thermal_drift:change=0,time_constant=10", 1e-9),
    ("supply_droop:droop=0", 1e-9),
    ("gravity_load:kappa=0", 1e-9),
    ("leakage:rate=0", 1e-9),
    ("end_stop:high=1e9", 1e-9),
    ("backlash:width=0", 0.02),
    ("input_notch:from=1,to=2,share=1", 1e-9),
    ("creep_memory:share=0", 1e-9),
    ("sticky_spot:from=0,to=5,share=1", 1e-9),
    ("disturbance:from_s=1,to_s=2,speed=0", 1e-9),
    ("sensor_nonlinearity:amplitude=0,period=30", 1e-9),
];

#[test]
fn an_effect_at_its_neutral_numbers_changes_nothing() {
    let steps = [(101, 1.5), (201, -0.7), (301, 0.0), (401, -2.0), (501, 0.3)];
    let plain = output(hiding("", &steps), 6.0);
    for (text, tolerance) in NEUTRAL {
        let output = output(hiding(text, &steps), 6.0);
        let far = output.iter().zip(&plain).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(far <= tolerance, "{text}: {far:.2e}");
    }
}

#[test]
fn finer_time_steps_change_little() {
    let steps = [(101, 1.5), (201, -0.7), (301, 0.0), (401, -2.0), (501, 0.3)];
    let mut joint = hiding("coulomb_friction:positive=0.4,negative=0.5,time_constant=0.1", &steps);
    for (name, numbers) in [
        ("stiction", vec![("start", 0.5), ("stop", 0.2)]),
        ("rate_limit", vec![("seconds_per_input", 0.1)]),
        ("resonance", vec![("period", 0.3), ("damping", 0.1)]),
        ("gravity_load", vec![("kappa", 0.4)]),
        ("end_stop", vec![("low", -8.0), ("high", 6.0)]),
        ("backlash", vec![("width", 1.0)]),
    ] {
        let numbers: Vec<_> = numbers.into_iter().map(|(k, v)| (k.to_owned(), v)).collect();
        joint.hide(name, &numbers).unwrap();
    }
    let with = |substeps| {
        let plant = PlantSpec { substeps, ..PlantSpec::new(1, 6.0, vec![joint.clone()]) };
        simulate(&plant).unwrap().joints[0].trials[0].output().to_vec()
    };
    let (coarse, fine) = (with(10), with(100));
    let far = coarse.iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // A contact lasts some time steps of 1 ms, at up to 20 deg/s.
    assert!(far < 0.06, "{far}");
}

#[test]
fn an_experimenter_who_sees_the_joint_keeps_its_range() {
    for text in [
        "input_offset:offset=0.4",
        "leakage:rate=0.2,y0=50",
        "thermal_drift:change=1.5,time_constant=30",
    ] {
        let input =
            InputSpec::Levels { levels: vec![-2.0, -1.0, 0.0, 1.0, 2.0], hold_s: [0.5, 2.0] };
        let joint = JointSpec { input, range: Some([-30.0, 40.0]), ..hiding(text, &[(2, 1.0)]) };
        let output = output(joint, 120.0);
        let outside = output.iter().filter(|y| !(-32.0..=42.0).contains(*y)).count();
        assert_eq!(outside, 0, "{text}");
        assert!(output.iter().any(|y| *y > 30.0), "{text}");
    }
}

#[test]
fn numbers_that_mean_nothing_are_refused_by_name() {
    let cases = [
        ("input_offset:offset=nan", "effect.input_offset.offset"),
        ("dead_band:lower=0.1,upper=1", "effect.dead_band.lower"),
        ("stiction:start=1,stop=2", "effect.stiction.stop"),
        ("input_saturation:limit=0", "effect.input_saturation.limit"),
        ("flow_curve:exponent=-1", "effect.flow_curve.exponent"),
        ("direction_gain:negative_factor=0", "effect.direction_gain.negative_factor"),
        ("rate_limit:seconds_per_input=0", "effect.rate_limit.seconds_per_input"),
        ("variable_delay:small_s=-1", "effect.variable_delay.small_s"),
        ("actuator_lag:time_constant=1e-6", "effect.actuator_lag.time_constant"),
        ("resonance:period=0.01,damping=0.1", "effect.resonance.period"),
        (
            "coulomb_friction:positive=-1,negative=0,time_constant=1",
            "effect.coulomb_friction.positive",
        ),
        ("position_gain:ratio=1.5,mount=60,leverage=1", "effect.position_gain.ratio"),
        ("thermal_drift:change=-1,time_constant=10", "effect.thermal_drift.change"),
        ("supply_droop:droop=1", "effect.supply_droop.droop"),
        ("gravity_load:kappa=1", "effect.gravity_load.kappa"),
        ("leakage:rate=-1", "effect.leakage.rate"),
        ("end_stop:low=1,high=-1", "effect.end_stop.high"),
        ("backlash:width=-1", "effect.backlash.width"),
        ("input_notch:from=1,to=0,share=1", "outside.input_notch.to"),
        ("creep_memory:share=2", "outside.creep_memory.share"),
        ("sticky_spot:from=0,to=5,share=-1", "outside.sticky_spot.share"),
        ("disturbance:from_s=2,to_s=1,speed=0", "outside.disturbance.to_s"),
        ("sensor_nonlinearity:amplitude=1,period=0", "outside.sensor_nonlinearity.period"),
    ];
    for (text, expected) in cases {
        let found = simulate(&PlantSpec::new(1, 6.0, vec![hiding(text, &[(101, 1.0)])]));
        match found {
            Err(PlantError::Value { key, .. }) => assert_eq!(key, expected),
            other => panic!("{text}: {other:?}"),
        }
    }
}

#[test]
fn odd_numbers_give_data_or_an_error_but_no_panic() {
    const ODD: [f64; 8] = [0.0, -1.0, 1e300, -1e300, 5e-324, 1e-9, f64::NAN, f64::INFINITY];
    for (text, _) in NEUTRAL {
        let (name, numbers) = text.split_once(':').unwrap();
        let keys: Vec<_> =
            numbers.split(',').map(|number| number.split_once('=').unwrap()).collect();
        for (odd, changed) in ODD.iter().flat_map(|odd| keys.iter().map(move |key| (odd, key.0))) {
            let value = |key: &str, number: &str| {
                if key == changed { *odd } else { number.parse().unwrap() }
            };
            let numbers: Vec<_> =
                keys.iter().map(|(key, number)| ((*key).to_owned(), value(key, number))).collect();
            let mut joint = hiding("", &[(51, 1.5), (101, -0.7)]);
            joint.hide(name, &numbers).unwrap();
            let made = simulate(&PlantSpec::new(1, 1.5, vec![joint]));
            let finite =
                |made: Synthetic| made.joints[0].trials[0].output().iter().all(|y| y.is_finite());
            assert!(made.map_or(true, finite), "{name}: {changed} = {odd}");
        }
    }
}

#[test]
fn the_names_are_those_of_the_catalogue_and_all_are_documented() {
    let sorted = |names: &mut dyn Iterator<Item = &'static str>| {
        let mut names: Vec<_> = names.collect();
        names.sort_unstable();
        names
    };
    // Of these the catalogue knows a law, and plants of other programs hide them.
    let not_simulated = [
        "accumulator_droop",
        "asymmetric_stiction",
        "creep",
        "input_quantization",
        "position_ripple",
        "spool_rate_limit",
        "valve_curve",
        "valve_hysteresis",
    ];
    let fitted = sorted(&mut REGISTRY.iter().map(|effect| effect.spec().id));
    let known = CATALOGUE.into_iter().chain(FINER).chain(not_simulated);
    assert_eq!(sorted(&mut { known }), fitted);
    assert!(OUTSIDE.iter().all(|name| !fitted.contains(name)));
    let text = std::fs::read_to_string("docs/simulating.md").unwrap();
    let names = NEUTRAL.map(|(text, _)| text.split_once(':').unwrap());
    assert_eq!(names.len(), CATALOGUE.len() + OUTSIDE.len() + FINER.len());
    for (name, numbers) in names {
        let row = text.lines().find(|line| line.starts_with(&format!("| `{name}` |"))).unwrap();
        for number in numbers.split(',') {
            let key = number.split('=').next().unwrap();
            assert!(row.contains(&format!("`{key}`")), "{name}: {key}");
        }
    }
}

#[test]
fn the_plant_file_of_the_documents_makes_a_log() {
    let text = std::fs::read_to_string("docs/simulating.md").unwrap();
    let (_, after) = text.split_once("```toml\n").unwrap();
    let plant = PlantSpec::from_toml(after.split("```").next().unwrap()).unwrap();
    assert_eq!(simulate(&plant).unwrap().joints[0].trials[0].len(), 12_000);
    let wrong = plant.to_toml().unwrap().replace("lower = -0.3", "lowr = -0.3");
    let refused = PlantSpec::from_toml(&wrong).unwrap_err();
    let PlantError::Parse { source } = &refused else { panic!("{refused:?}") };
    let text = source.to_string();
    assert!(text.contains("lowr") && text.contains("expected `lower` or `upper`"), "{text}");
}
