//! The simulation against another one, in steps 100 times finer and with other formulas.
//!
//! Nothing of the library's arithmetic is used here: levels are looked up by their times,
//! every effect is written anew, and what moves is integrated by trapezia, Verlet's rule or
//! in small steps.

use tauscope::effect::find;
use tauscope::model::{
    Commands, Component, JointModel, Restart, Surroundings, simulate, simulate_input,
};

/// Fine steps in a sample period.
const FINE: usize = 100;
const PERIOD_S: f64 = 0.01;
const GAIN: f64 = 12.0;
const DELAY_S: f64 = 0.1234;
const START_S: f64 = 3.7;
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// An effect and its parameters.
type Part<'a> = (&'a str, &'a [f64]);

/// A joint, what drives it, and when it is set anew.
struct Case<'a> {
    parts: &'a [Part<'a>],
    input: Vec<f64>,
    others: Vec<f64>,
    restarts: Vec<(usize, f64)>,
    delays: Option<Vec<Option<f64>>>,
}

/// Reproducible numbers from 0 to 1, on whose draws the stated accuracy was measured.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963);
        (self.0 >> 40) as f64 / (1u64 << 24) as f64
    }

    /// Random levels up to 5, each held for `from` to `to` samples; now and then zero.
    fn levels(&mut self, samples: usize, [from, to]: [f64; 2]) -> Vec<f64> {
        let (mut levels, mut level, mut until) = (Vec::new(), 0.0, 0.0);
        for sample in 0..samples {
            if sample as f64 >= until {
                level = if self.next() < 0.2 { 0.0 } else { 10.0 * self.next() - 5.0 };
                until += from + (to - from) * self.next();
            }
            levels.push(level);
        }
        levels
    }
}

fn case<'a>(parts: &'a [Part<'a>], seed: u64) -> Case<'a> {
    let mut random = Random(seed);
    let input = random.levels(1500, [5.0, 120.0]);
    let others = random.levels(1500, [20.0, 200.0]).into_iter().map(|level| level.abs() / 5.0);
    Case { parts, others: others.collect(), input, restarts: vec![(0, 10.0)], delays: None }
}

impl Case<'_> {
    fn model(&self) -> JointModel {
        let component = |(id, values): &Part<'_>| {
            let values = values.iter().map(|value| (*value).into()).collect();
            Component::new(find(id).unwrap(), values).unwrap()
        };
        let plain = JointModel::integrator(GAIN, DELAY_S);
        self.parts.iter().map(component).fold(plain, |model, component| model.with(component))
    }

    fn simulated(&self) -> Vec<f64> {
        let commands = Commands::new(&self.input, PERIOD_S);
        let arrivals = commands.arriving(&self.model(), START_S, self.delays.as_deref());
        let restart = |(sample, output): &(usize, f64)| Restart {
            sample: *sample,
            output: *output,
            speed: None,
        };
        let restarts: Vec<_> = self.restarts.iter().map(restart).collect();
        let surroundings = Surroundings {
            others: &self.others,
            radians_per_output_unit: DEGREE,
            start_s: START_S,
            ..Surroundings::default()
        };
        let samples = self.input.len();
        simulate(&self.model(), &arrivals, samples, PERIOD_S, &restarts, &surroundings).output
    }

    /// The largest difference from the fine integration, in parts of the largest output.
    fn difference(&self) -> f64 {
        let (found, expected) = (self.simulated(), Fine::new(self).run());
        let largest = expected.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
        let pairs = found.iter().zip(&expected);
        pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) / largest
    }

    fn part(&self, id: &str) -> Option<&[f64]> {
        self.parts.iter().find(|(name, _)| *name == id).map(|(_, values)| *values)
    }

    /// Time and level of each change as commanded, with the time at which it acts.
    fn changes(&self) -> Vec<(f64, f64)> {
        let (mut changes, mut since) = (Vec::new(), 0.0);
        for k in 1..self.input.len() {
            let (before, after) = (self.input[k - 1], self.input[k]);
            if (before - after).abs() == 0.0 {
                continue;
            }
            let now = k as f64 * PERIOD_S;
            let extra = self.part("variable_delay").map_or(0.0, |p| {
                let falls = f64::from(u8::from(after < before));
                let levels_off = |x: f64, scale: f64| scale * (1.0 - (-x / scale).exp());
                let slow =
                    p[2] * levels_off(now - since, p[5]) + p[3] * levels_off(now + START_S, p[6]);
                p[0] * levels_off((after - before).abs(), p[4]) + p[1] * falls + slow
            });
            let known = self.delays.as_ref().and_then(|delays| delays[changes.len()]);
            changes.push((now + known.unwrap_or(DELAY_S + extra).max(0.0), after));
            since = now;
        }
        changes
    }
}

/// The fine integration.
struct Fine<'a> {
    case: &'a Case<'a>,
    changes: Vec<(f64, f64)>,
    moving: f64,
    states: Vec<[f64; 2]>,
    angle: f64,
    shown: f64,
}

impl<'a> Fine<'a> {
    fn new(case: &'a Case<'a>) -> Self {
        let changes = case.changes();
        let mut fine =
            Self { case, changes, moving: 0.0, states: Vec::new(), angle: 0.0, shown: 0.0 };
        let mut signal = fine.after_valve(case.input[0]);
        for (id, p) in case.parts {
            if matches!(*id, "coulomb_friction" | "asymmetric_friction") {
                signal = signal - signal.clamp(-p[1], p[0]);
                let viscous = if signal < 0.0 { p.get(3).copied() } else { None };
                signal /= viscous.unwrap_or(1.0);
            }
            let held = if *id == "spool_lag" { case.input[0] } else { signal };
            fine.states.push([held, 0.0]);
        }
        fine
    }

    /// The level that was commanded last of those that have arrived.
    fn level(&self, time_s: f64) -> f64 {
        let arrived = self.changes.iter().rev().find(|(acts, _)| *acts <= time_s);
        arrived.map_or(self.case.input[0], |(_, level)| *level)
    }

    fn run(mut self) -> Vec<f64> {
        let mut times: Vec<f64> = self.changes.iter().map(|(acts, _)| *acts).collect();
        times.sort_by(f64::total_cmp);
        let mut outputs = Vec::new();
        for k in 0..self.case.input.len() {
            for (sample, output) in &self.case.restarts {
                if *sample == k {
                    let play = self.angle - self.shown;
                    self.angle = output + if k == 0 { 0.0 } else { play };
                    self.shown = *output;
                }
            }
            outputs.push(self.shown);
            let start = k as f64 * PERIOD_S;
            let fine = (0..=FINE).map(|i| start + PERIOD_S * i as f64 / FINE as f64);
            let within = times.iter().copied().filter(|t| (start..start + PERIOD_S).contains(t));
            let mut grid: Vec<f64> = fine.chain(within).collect();
            grid.sort_by(f64::total_cmp);
            for pair in grid.windows(2).filter(|pair| pair[1] > pair[0]) {
                // The level in the middle: not in doubt by rounding at the ends.
                let level = self.level(f64::midpoint(pair[0], pair[1]));
                self.step(level, pair[0], pair[1] - pair[0], self.case.others[k]);
            }
        }
        outputs
    }

    fn step(&mut self, level: f64, time_s: f64, h: f64, others: f64) {
        let mut command = level;
        for (place, (_, p)) in
            self.case.parts.iter().enumerate().filter(|part| part.1.0 == "spool_lag")
        {
            let before = self.states[place][0];
            let part = 0.5 * h / p[0];
            let after = (before * (1.0 - part) + 2.0 * part * command) / (1.0 + part);
            self.states[place][0] = after;
            command = f64::midpoint(before, after);
        }
        let mut signal = self.after_valve(command);
        for (place, (id, p)) in self.case.parts.iter().enumerate() {
            let state = &mut self.states[place];
            let before = state[0];
            match *id {
                "rate_limit" => {
                    let falling = h / (p[0] * (1.0 + p[1]));
                    state[0] += (signal - before).clamp(-falling, h / p[0]);
                }
                "actuator_lag" => {
                    let part = 0.5 * h / p[0];
                    state[0] = (before * (1.0 - part) + 2.0 * part * signal) / (1.0 + part);
                }
                "resonance" => swing(state, signal, std::f64::consts::TAU / p[0], p[1], h),
                "oil_column" => {
                    let (away, braked) = (self.angle - p[5], p[1] + p[2] * signal.abs());
                    let period = p[0] * (1.0 + p[3] * away + p[4] * away * away);
                    swing(state, signal, std::f64::consts::TAU / period, braked, h);
                }
                "coulomb_friction" | "asymmetric_friction" => {
                    state[0] = braked(before, signal, p, h);
                }
                _ => continue,
            }
            signal = f64::midpoint(before, state[0]);
        }
        let slope = |y: f64, t: f64| self.after_load(GAIN * signal, y, t, others);
        let now = time_s + START_S;
        // Runge and Kutta's rule.
        let k1 = slope(self.angle, now);
        let k2 = slope(self.angle + 0.5 * h * k1, now + 0.5 * h);
        let k3 = slope(self.angle + 0.5 * h * k2, now + 0.5 * h);
        let k4 = slope(self.angle + h * k3, now + h);
        self.angle += h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
        if let Some(p) = self.case.part("end_stop") {
            self.angle = self.angle.clamp(p[0], p[1]);
        }
        let half = self.case.part("backlash").map_or(0.0, |p| 0.5 * p[0]);
        self.shown = self.shown.clamp(self.angle - half, self.angle + half);
    }

    /// What the valve lets through of a held level.
    fn after_valve(&mut self, level: f64) -> f64 {
        let mut u = level;
        for (id, p) in self.case.parts {
            u = match *id {
                "input_offset" => u + p[0],
                "dead_band" => u - u.clamp(p[0], p[1]),
                "stiction" => {
                    let least = if u * self.moving > 0.0 { p[1] } else { p[0] };
                    self.moving = if u.abs() >= least { u } else { 0.0 };
                    self.moving
                }
                "input_saturation" => u.signum() * knee(u.abs(), p[0], p[1]),
                "asymmetric_saturation" if u < 0.0 => -knee(-u, p[2], p[1]),
                "asymmetric_saturation" => knee(u, p[0], p[1]),
                "flow_curve" if u == 0.0 => 0.0,
                "flow_curve" => u.signum() * (p[0] * u.abs().ln()).exp(),
                "direction_gain" => u.max(0.0) + p[0] * u.min(0.0),
                _ => u,
            };
        }
        u
    }

    /// What the load leaves of a speed, at an angle and a time of the record.
    fn after_load(&self, speed: f64, y: f64, t: f64, others: f64) -> f64 {
        let mut v = speed;
        for (id, p) in self.case.parts {
            v = match *id {
                "gravity_load" => {
                    let g = (DEGREE * y).cos() * (DEGREE * p[1]).cos()
                        + (DEGREE * y).sin() * (DEGREE * p[1]).sin();
                    let pressure = if v > 0.0 { 1.0 - p[0] * g } else { 1.0 + p[0] * g };
                    v * pressure.sqrt() - p[2] * g
                }
                "position_gain" => {
                    let x = y - p[3];
                    v / (1.0 - p[0] * x - p[1] * x * x - p[2] * x.powi(3)).max(0.05)
                }
                "thermal_drift" => v * (1.0 + p[0] * p[1] * (1.0 - (-t / p[1]).exp())),
                "supply_droop" => v - v * p[0] * others,
                "leakage" => v - p[0] * y + p[0] * p[1],
                _ => v,
            };
        }
        v
    }
}

/// A limit with a soft knee, as the integral of its slope, which falls from 1 to 0.
fn knee(size: f64, limit: f64, softness: f64) -> f64 {
    let (from, to) = (limit * (1.0 - softness), limit * (1.0 + softness));
    let inside = size.clamp(from, to) - from;
    size.min(from) + inside * (1.0 - 0.5 * inside / (to - from).max(1e-12))
}

/// One step of a swing, by Newmark's rule with constant mean force.
fn swing(state: &mut [f64; 2], input: f64, omega: f64, damping: f64, h: f64) {
    let [x, v] = *state;
    let force = |x: f64, v: f64| omega * omega * (input - x) - 2.0 * damping * omega * v;
    let stiff = 1.0 + damping * omega * h + 0.25 * omega * omega * h * h;
    let change = (h * force(x, v) - 0.5 * h * h * omega * omega * v) / stiff;
    *state = [x + h * (v + 0.5 * change), v + change];
}

/// One step of a speed with inertia and friction, which at most stops it; what is left
/// of the step after a stop is another one.
fn braked(speed: f64, input: f64, p: &[f64], h: f64) -> f64 {
    let part = 0.5 * h / p[2];
    let driven = |input: f64, viscous: f64| {
        (speed * (1.0 - part * viscous) + 2.0 * part * input) / (1.0 + part * viscous)
    };
    let viscous = p.get(3).copied().unwrap_or(1.0);
    let (up, down) = (driven(input - p[0], 1.0), driven(input + p[1], viscous));
    let after = if speed > 0.0 { up } else { down };
    if speed == 0.0 {
        up.max(0.0) + down.min(0.0)
    } else if speed * after >= 0.0 {
        after
    } else {
        braked(0.0, input, p, h * after / (after - speed))
    }
}

fn assert_within(parts: &[Part<'_>], tolerance: f64) {
    for seed in 1..4 {
        let difference = case(parts, seed).difference();
        assert!(difference <= tolerance, "{parts:?}, seed {seed}: {difference:.1e}");
    }
}

#[test]
fn the_plain_integrator_is_exact() {
    assert_within(&[], 1e-10);
}

#[test]
fn effects_of_the_input_and_of_transport_are_exact() {
    assert_within(&[("input_offset", &[0.3])], 1e-10);
    assert_within(&[("dead_band", &[-0.8, 1.1])], 1e-10);
    assert_within(&[("stiction", &[2.0, 0.7])], 1e-10);
    assert_within(&[("input_saturation", &[2.5, 0.0])], 1e-10);
    assert_within(&[("input_saturation", &[2.5, 0.6])], 1e-10);
    assert_within(&[("asymmetric_saturation", &[2.5, 0.6, 1.75])], 1e-10);
    assert_within(&[("flow_curve", &[1.6])], 1e-10);
    assert_within(&[("direction_gain", &[0.7])], 1e-10);
    assert_within(&[("variable_delay", &[-0.013, 0.021, 0.017, 0.003, 1.7, 0.9, 6.0, 0.0])], 1e-10);
}

#[test]
fn a_period_that_follows_the_angle_is_that_of_the_middle_of_an_interval() {
    // The middle is ahead by half of what the joint moved in the interval before.
    assert_within(&[("oil_column", &[0.25, 0.05, 0.03, 0.004, 1e-5, 5.0])], 5e-5);
}

#[test]
fn effects_of_the_dynamics_are_exact() {
    // What is left is the fine integration's own error.
    assert_within(&[("actuator_lag", &[0.12])], 1e-8);
    assert_within(&[("spool_lag", &[0.12])], 1e-8);
    assert_within(&[("resonance", &[0.25, 0.15])], 1e-6);
    assert_within(&[("resonance", &[0.3, 1.7])], 1e-6);
    assert_within(&[("rate_limit", &[0.031, 0.6])], 1e-7);
    assert_within(&[("coulomb_friction", &[0.6, 0.4, 0.15])], 1e-6);
    assert_within(&[("asymmetric_friction", &[0.6, 0.4, 0.15, 1.7])], 1e-6);
}

#[test]
fn effects_of_the_load_are_those_of_the_midpoint_rule() {
    assert_within(&[("gravity_load", &[0.5, 30.0, 2.0])], 5e-5);
    assert_within(&[("position_gain", &[0.006, -0.000_05, 1e-7, 20.0])], 5e-5);
    assert_within(&[("thermal_drift", &[0.05, 6.0])], 1e-7);
    assert_within(&[("supply_droop", &[0.4])], 1e-10);
    assert_within(&[("leakage", &[0.3, 15.0])], 1e-5);
}

#[test]
fn effects_of_the_output_are_exact_without_inertia() {
    assert_within(&[("end_stop", &[-20.0, 35.0])], 1e-10);
    assert_within(&[("backlash", &[2.5])], 1e-10);
}

#[test]
fn effects_together() {
    let valve: [Part<'_>; 5] = [
        ("input_offset", &[0.2]),
        ("dead_band", &[-0.5, 0.7]),
        ("input_saturation", &[3.0, 0.3]),
        ("flow_curve", &[1.3]),
        ("direction_gain", &[0.8]),
    ];
    assert_within(&valve, 1e-10);
    assert_within(&[("actuator_lag", &[0.1]), ("resonance", &[0.2, 0.2])], 1e-4);
    assert_within(&[("rate_limit", &[0.04, -0.3]), ("actuator_lag", &[0.1])], 1e-4);
    assert_within(&[("dead_band", &[-0.5, 0.7]), ("actuator_lag", &[0.1])], 1e-8);
    assert_within(&[("spool_lag", &[0.1]), ("dead_band", &[-0.5, 0.7])], 5e-4);
    let load: [Part<'_>; 3] =
        [("gravity_load", &[0.5, 30.0, 2.0]), ("supply_droop", &[0.4]), ("leakage", &[0.1, 15.0])];
    assert_within(&load, 1e-5);
    assert_within(&[("actuator_lag", &[0.1]), ("gravity_load", &[0.5, 30.0, 2.0])], 1e-4);
    assert_within(&[("actuator_lag", &[0.1]), ("backlash", &[2.5])], 1e-4);
    assert_within(&[("actuator_lag", &[0.1]), ("end_stop", &[-20.0, 35.0])], 5e-4);
    assert_within(
        &[
            ("dead_band", &[-0.5, 0.7]),
            ("variable_delay", &[-0.01, 0.02, 0.01, 0.001, 3.0, 2.0, 20.0, 0.0]),
            ("coulomb_friction", &[0.3, 0.3, 0.1]),
            ("position_gain", &[0.004, -0.000_03, 0.0, 0.0]),
            ("backlash", &[0.5]),
        ],
        1e-4,
    );
}

#[test]
fn steps_that_overtake_others_take_their_place() {
    // Delays from none to 0.4 s, and holds from 1 sample: most steps are overtaken.
    for seed in 1..6 {
        let mut random = Random(seed);
        let mut hasty = case(&[("actuator_lag", &[0.1])], seed);
        hasty.input = random.levels(1500, [1.0, 20.0]);
        let delays = (0..1500).map(|_| (random.next() < 0.9).then(|| 0.4 * random.next()));
        hasty.delays = Some(delays.collect());
        let difference = hasty.difference();
        assert!(difference < 1e-7, "seed {seed}: {difference:.1e}");
    }
}

#[test]
fn a_restart_sets_the_output_and_nothing_else() {
    let parts: [Part<'_>; 3] =
        [("actuator_lag", &[0.1]), ("leakage", &[0.1, 15.0]), ("backlash", &[2.5])];
    let mut restarted = case(&parts, 5);
    restarted.restarts.extend([(333, -20.0), (700, 5.0), (701, 8.0), (1499, 0.0)]);
    let outputs = restarted.simulated();
    for (sample, output) in &restarted.restarts {
        assert!((outputs[*sample] - output).abs() < 1e-10);
    }
    let difference = restarted.difference();
    assert!(difference < 1e-4, "{difference:.1e}");
}

#[test]
fn an_input_that_changes_at_every_sample_is_held_from_one_to_the_next() {
    let mut wave = case(&[("coulomb_friction", &[0.6, 0.4, 0.15])], 1);
    wave.input = (0..1500).map(|k| 4.0 * (0.02 * f64::from(k)).sin()).collect();
    let difference = wave.difference();
    assert!(difference < 1e-5, "{difference:.1e}");
}

#[test]
fn a_trial_begins_as_if_its_first_level_had_long_been_held() {
    let parts: [Part<'_>; 2] =
        [("resonance", &[0.25, 0.1]), ("coulomb_friction", &[0.5, 0.5, 0.2])];
    let mut steady = case(&parts, 1);
    steady.input = vec![2.0; 200];
    let outputs = steady.simulated();
    for (k, output) in outputs.iter().enumerate() {
        let expected = 10.0 + GAIN * 1.5 * PERIOD_S * k as f64;
        assert!((output - expected).abs() < 1e-9, "{k}: {output} {expected}");
    }
}

#[test]
fn a_restart_with_a_speed_goes_on_at_it() {
    let lag =
        Component::new(find("coulomb_friction").unwrap(), vec![0.5.into(), 0.5.into(), 0.2.into()]);
    let model = JointModel::integrator(GAIN, 0.0).with(lag.unwrap());
    let arrivals = Commands::new(&[1.0; 300], PERIOD_S).arriving(&model, 0.0, None);
    let restarts = [(0, 0.0), (100, -6.0)].map(|(sample, speed)| Restart {
        sample,
        output: 1.0,
        speed: Some(speed),
    });
    let simulated = simulate(&model, &arrivals, 300, PERIOD_S, &restarts, &Surroundings::default());
    // 12 · 0.5 = 6 in the end; from −6 with friction the other way it stops after
    // 0.2 s · ln(1 + 0.5/1.5), and starts anew.
    let stop = 0.2 * (0.5_f64 / 1.5).ln_1p();
    let speed = |t: f64| {
        if t < stop {
            18.0 - 24.0 * (-t / 0.2).exp()
        } else {
            6.0 - 6.0 * (-(t - stop) / 0.2).exp()
        }
    };
    for k in 0..100 {
        let rising = 6.0 * (1.0 - (-(k as f64 + 0.5) * PERIOD_S / 0.2).exp());
        assert!((simulated.velocity[k] - rising).abs() < 0.01, "{k}");
        let turned = speed((k as f64 + 0.5) * PERIOD_S);
        assert!((simulated.velocity[100 + k] - turned).abs() < 0.05, "{k} {turned}");
    }
}

#[test]
fn a_joint_whose_ends_leave_out_zero_starts_where_it_is_set() {
    let stops = Component::new(find("end_stop").unwrap(), vec![20.0.into(), 60.0.into()]).unwrap();
    let model = JointModel::integrator(10.0, 0.0).with(stops);
    let input: Vec<f64> = (0..100).map(|k| if k < 50 { 0.0 } else { 1.0 }).collect();
    let made = simulate_input(&model, &input, 0.01, 30.0, &Surroundings::default());
    assert!((made.output[0] - 30.0).abs() < 1e-12 && (made.output[50] - 30.0).abs() < 1e-12);
    assert!((made.output[99] - 34.9).abs() < 1e-9, "{}", made.output[99]);
}
