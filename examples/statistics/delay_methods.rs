//! How well each method finds known delays, beside what no method can do better.
//!
//! Seeded joints that only integrate, lag, ring, are noisy or are held for a short time are
//! simulated; every step is estimated by every method. Two more columns are the error at the
//! bound of Cramér and Rao, for all parameters of the record together, and the least mean error
//! that a joint without a lag allows: noise bends the curve that a break draws, so that where
//! samples are few beside it no method comes down to the bound.

use std::f64::consts::{FRAC_2_PI, TAU};
use std::time::{Duration, Instant};

use anyhow::Context as _;
use nalgebra::DMatrix;
use tauscope::delay::{FirstLast, Method, Settings, TrialEstimate, estimate};
use tauscope::experiment::Trial;
use tauscope::synthetic::{
    DelayLaw, InputSpec, JointSpec, PlantSpec, Ringing, StepTruth, Synthetic, simulate,
};

/// Records per plant where no number is given.
const RECORDS: u64 = 20;
/// Records of a plant for which the bound is computed, at most.
const BOUNDS: u64 = 40;
/// Records with a computed bound where many steps make it take long.
const SLOW_BOUNDS: u64 = 3;
/// The seed of the first record where none is given.
const FIRST_SEED: u64 = 1000;
const PERIOD_S: f64 = 0.01;
/// Length of a record where none is given.
const DURATION_S: f64 = 120.0;
/// Standard deviation of the noise, output units.
const NOISE: f64 = 0.05;
const LAG_S: f64 = 0.06;
const RINGING: Ringing = Ringing { period_s: 0.4, damping: 0.25 };

/// The plants by name.
fn plants() -> Vec<(&'static str, JointSpec)> {
    let levels = (-4..=4).map(|half| 0.5 * f64::from(half)).collect::<Vec<_>>();
    let input = |hold_s| InputSpec::Levels { levels: levels.clone(), hold_s };
    let delay = |max| DelayLaw::Uniform { min: 0.05, max };
    let ideal =
        JointSpec { noise: NOISE, ..JointSpec::new("ideal", input([0.9, 2.0]), delay(0.4)) };
    let lag_s = Some(LAG_S);
    let ringing = Some(RINGING);
    let noise_correlation = 0.8;
    let short = JointSpec { input: input([0.2, 0.5]), delay: delay(0.3), ..ideal.clone() };
    let small = vec![-1.0, -0.4, -0.2, 0.2, 0.4, 1.0];
    let dead = InputSpec::Levels { levels: small, hold_s: [0.9, 2.0] };
    let dead = JointSpec { input: dead, dead_band: Some([-0.5, 0.5]), gain: 20.0, ..ideal.clone() };
    vec![
        ("ideal", ideal.clone()),
        ("lag of 6", JointSpec { lag_s, ..ideal.clone() }),
        ("ringing", JointSpec { ringing, ..ideal.clone() }),
        ("lag and ringing", JointSpec { lag_s, ringing, ..ideal.clone() }),
        ("noise x 16", JointSpec { noise: 16.0 * NOISE, ..ideal.clone() }),
        ("noise x 16, lag", JointSpec { noise: 16.0 * NOISE, lag_s, ..ideal.clone() }),
        ("coloured noise", JointSpec { noise_correlation, ..ideal.clone() }),
        ("coloured noise, both", JointSpec { noise_correlation, lag_s, ringing, ..ideal.clone() }),
        ("short holds", short.clone()),
        ("short holds, lag", JointSpec { lag_s, ..short.clone() }),
        ("short holds, ringing", JointSpec { ringing, ..short }),
        ("dead band", dead.clone()),
        ("dead band, lag", JointSpec { lag_s, ..dead }),
    ]
}

fn settings(method: Method) -> Settings {
    let settings = Settings { first_last: FirstLast::Keep, ..Settings::of(method) };
    // Means nothing to methods without rows.
    Settings { beta: 2, ..settings }
}

/// What became of the steps of a plant under one method.
#[derive(Debug, Default)]
struct Tally {
    errors: Vec<f64>,
    covered: usize,
    intervals: usize,
    steps: usize,
    still: usize,
    still_accepted: usize,
    time: Duration,
    samples: usize,
}

impl Tally {
    fn add(&mut self, truth: &[StepTruth], found: &TrialEstimate) {
        for (truth, decision) in truth.iter().zip(&found.decisions) {
            let accepted = decision.accepted_delay();
            if truth.slope_change.abs() < 1e-9 {
                self.still += 1;
                self.still_accepted += usize::from(accepted.is_some());
                continue;
            }
            self.steps += 1;
            let Some(delay) = accepted else { continue };
            self.errors.push(delay - truth.delay_samples);
            if let Some(fine) = decision.fine {
                self.intervals += 1;
                self.covered += usize::from((fine.low..=fine.high).contains(&truth.delay_samples));
            }
        }
    }

    fn mean_error(&self) -> f64 {
        self.errors.iter().map(|error| error.abs()).sum::<f64>() / self.errors.len() as f64
    }

    fn bias(&self) -> f64 {
        self.errors.iter().sum::<f64>() / self.errors.len() as f64
    }

    fn coverage(&self) -> f64 {
        100.0 * self.covered as f64 / self.intervals as f64
    }
}

/// Steps that have a neighbour on each side and whose reaction is in the record.
fn inner<'a>(made: &'a Synthetic, trial: &Trial) -> &'a [StepTruth] {
    let last = made.truth.len().saturating_sub(1);
    let end = made
        .truth
        .iter()
        .position(|step| step.p as f64 + step.delay_samples + 10.0 > trial.len() as f64);
    made.truth.get(..end.unwrap_or(last).min(last)).unwrap_or_default()
}

/// A response that starts `t` samples before, integrated; the equations are solved here
/// again, so that the bound does not depend on the estimator.
fn response(lag: Option<f64>, ringing: Option<(f64, f64)>, t: f64) -> f64 {
    if t <= 0.0 {
        return 0.0;
    }
    let ring = |t: f64, (omega, zeta): (f64, f64)| {
        let damped = omega * (1.0 - zeta * zeta).sqrt();
        let (sine, cosine) = (damped * t).sin_cos();
        let decay = (-zeta * omega * t).exp();
        let part = (2.0 * zeta * zeta - 1.0) / damped;
        t - 2.0 * zeta / omega + decay * (2.0 * zeta / omega * cosine + part * sine)
    };
    match (lag, ringing) {
        (None, None) => t,
        (Some(lag), None) => t - lag * (1.0 - (-t / lag).exp()),
        (None, Some(ringing)) => ring(t, ringing),
        (Some(lag), Some(ringing)) => ring_behind(lag, ringing, t),
    }
}

/// What rings, after a lag: `T·z' + z` is the answer of what rings alone, solved with a line, the
/// same oscillation and `e^(−t/T)`.
fn ring_behind(lag: f64, (omega, zeta): (f64, f64), t: f64) -> f64 {
    let damped = omega * (1.0 - zeta * zeta).sqrt();
    let sigma = zeta * omega;
    let (p, r) = (2.0 * zeta / omega, (2.0 * zeta * zeta - 1.0) / damped);
    let (a, b) = (1.0 - lag * sigma, lag * damped);
    let size = a * a + b * b;
    let (cosine_part, sine_part) = ((a * p - b * r) / size, (a * r + b * p) / size);
    let mean = p + lag;
    let (sine, cosine) = (damped * t).sin_cos();
    let oscillation = (-sigma * t).exp() * (cosine_part * cosine + sine_part * sine);
    t - mean + (mean - cosine_part) * (-t / lag).exp() + oscillation
}

/// The mean error at the bound of Cramér and Rao over the steps that are judged.
fn bound(spec: &JointSpec, made: &Synthetic, trial: &Trial) -> Option<f64> {
    let moving: Vec<_> = made.truth.iter().filter(|s| s.slope_change.abs() > 1e-9).collect();
    let lag = spec.lag_s.map(|lag| lag / PERIOD_S);
    let ringing = spec.ringing.map(|r| (TAU * PERIOD_S / r.period_s, r.damping));
    let arrival = |step: &StepTruth| step.p as f64 - 1.0 + step.delay_samples;
    let of = |step: &StepTruth, lag, ringing| {
        let place = arrival(step);
        (0..trial.len()).map(move |k| response(lag, ringing, k as f64 - place))
    };
    let nudge = 1e-4;
    let mut columns: Vec<Vec<f64>> = vec![vec![1.0; trial.len()]];
    columns.push((0..trial.len()).map(|k| k as f64 / trial.len() as f64).collect());
    for step in &moving {
        columns.push(of(step, lag, ringing).map(|g| g / trial.len() as f64).collect());
    }
    let shapes = [
        lag.map(|lag| (Some(lag * (1.0 + nudge)), ringing)),
        ringing.map(|(omega, zeta)| (lag, Some((omega * (1.0 + nudge), zeta)))),
        ringing.map(|(omega, zeta)| (lag, Some((omega, zeta * (1.0 + nudge))))),
    ];
    for (lag_2, ringing_2) in shapes.into_iter().flatten() {
        let mut column = vec![0.0; trial.len()];
        for step in &moving {
            let pairs = of(step, lag_2, ringing_2).zip(of(step, lag, ringing));
            let slots = column.iter_mut().zip(pairs);
            slots.for_each(|(slot, (b, a))| *slot += step.slope_change * (b - a) / nudge);
        }
        columns.push(column);
    }
    let first = columns.len();
    for step in &moving {
        let place = arrival(step);
        let at = |k: usize, by: f64| response(lag, ringing, k as f64 - place - by);
        let slope = |k| step.slope_change * (at(k, nudge) - at(k, -nudge)) / (2.0 * nudge);
        columns.push((0..trial.len()).map(slope).collect());
    }
    let phi = spec.noise_correlation;
    let whitened: Vec<Vec<f64>> = columns
        .iter()
        .map(|c| c.windows(2).map(|w| (w[1] - phi * w[0]) / (1.0 - phi * phi).sqrt()).collect())
        .collect();
    let count = whitened.len();
    let product = |i: usize, j: usize| -> f64 {
        whitened[i].iter().zip(&whitened[j]).map(|(a, b)| a * b).sum()
    };
    let mut information = DMatrix::zeros(count, count);
    for i in 0..count {
        for j in i..count {
            information[(i, j)] = product(i, j);
            information[(j, i)] = information[(i, j)];
        }
    }
    let scale: Vec<f64> = (0..count).map(|i| information[(i, i)].sqrt()).collect();
    let scaled = DMatrix::from_fn(count, count, |i, j| information[(i, j)] / (scale[i] * scale[j]));
    let inverse = (scaled + DMatrix::identity(count, count) * 1e-12).cholesky()?.inverse();
    let judged = inner(made, trial);
    let deviations = moving.iter().enumerate().filter(|(_, step)| judged.contains(step));
    let deviations: Vec<f64> = deviations
        .map(|(i, _)| spec.noise * inverse[(first + i, first + i)].sqrt() / scale[first + i])
        .collect();
    Some(FRAC_2_PI.sqrt() * deviations.iter().sum::<f64>() / deviations.len() as f64)
}

/// The mean error of the median of all places, each weighted by how likely it is, where the
/// noise and the neighbours of a step are known: over delays of which nothing else is known, no
/// method has less. None for a joint with a lag, or with holds too short for it.
fn least(spec: &JointSpec, made: &Synthetic, trial: &Trial) -> Option<f64> {
    if spec.lag_s.is_some() || spec.ringing.is_some() {
        return None;
    }
    let moving: Vec<_> = made.truth.iter().filter(|s| s.slope_change.abs() > 1e-9).collect();
    let arrival = |step: &StepTruth| step.p as f64 - 1.0 + step.delay_samples;
    let judged = inner(made, trial);
    let error = |steps: &[&StepTruth]| {
        let &[before, step, after] = steps else { return None };
        let (from, place, to) = (arrival(before), arrival(step), arrival(after));
        let values = trial.output().iter().enumerate();
        let values = values.filter(|(k, _)| (from..to).contains(&(*k as f64)));
        let values: Vec<_> = values.map(|(k, y)| (k as f64 - place, *y)).collect();
        let reach = 3.0 * spec.noise / step.slope_change.abs() + 1.0;
        let room = reach.min(place - from - 4.0).min(to - place - 4.0);
        (room >= 1.0 && judged.contains(step))
            .then(|| median_place(&values, spec.noise_correlation, room).abs())
    };
    let errors: Vec<f64> = moving.windows(3).filter_map(error).collect();
    // Steps without room would be missing among the worst.
    let enough = 10 * errors.len() >= 9 * moving.len();
    enough.then(|| errors.iter().sum::<f64>() / errors.len() as f64)
}

/// The median of the likely breaks of a broken line within `reach` of zero; the change of slope,
/// the line and the level of the noise are integrated out.
fn median_place(values: &[(f64, f64)], phi: f64, reach: f64) -> f64 {
    const PLACES: i32 = 300;
    let whitened = |column: &dyn Fn(&(f64, f64)) -> f64| -> Vec<f64> {
        values.windows(2).map(|w| column(&w[1]) - phi * column(&w[0])).collect()
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let take_off = |column: &mut [f64], by: &[f64]| {
        let part = dot(column, by) / dot(by, by);
        column.iter_mut().zip(by).for_each(|(value, by)| *value -= part * by);
    };
    let level = whitened(&|_| 1.0);
    let mut slope = whitened(&|(x, _)| *x);
    take_off(&mut slope, &level);
    let left = |mut column: Vec<f64>| {
        take_off(&mut column, &level);
        take_off(&mut column, &slope);
        column
    };
    let output = left(whitened(&|(_, y)| *y));
    let power = dot(&output, &output);
    let freedom = output.len() as f64 - 3.0;
    let place = |n: i32| f64::from(n) * reach / f64::from(PLACES);
    let chance = |n: i32| {
        let ramp = left(whitened(&|(x, _)| (x - place(n)).max(0.0)));
        let (size, with) = (dot(&ramp, &ramp), dot(&ramp, &output));
        -0.5 * (freedom * (power - with * with / size).ln() + size.ln())
    };
    let chances: Vec<f64> = (-PLACES..=PLACES).map(chance).collect();
    let most = chances.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = chances.iter().map(|chance| (chance - most).exp()).collect();
    let mut half = 0.5 * weights.iter().sum::<f64>();
    let behind = weights.iter().zip(-PLACES..).find(|(weight, _)| {
        half -= **weight;
        half <= 0.0
    });
    behind.map_or(0.0, |(_, n)| place(n))
}

fn made(spec: &JointSpec, seed: u64, duration_s: f64) -> anyhow::Result<Synthetic> {
    let spec = PlantSpec {
        sample_period_s: PERIOD_S,
        ..PlantSpec::new(seed, duration_s, vec![spec.clone()])
    };
    Ok(simulate(&spec)?)
}

/// Which records are made.
#[derive(Debug, Clone, Copy)]
struct Records {
    count: u64,
    first_seed: u64,
    duration_s: f64,
}

/// Every method on the records of a plant; the mean bound and the least error of the first ones.
fn measure(spec: &JointSpec, records: Records) -> anyhow::Result<(Vec<Tally>, [Option<f64>; 2])> {
    let mut tallies: Vec<Tally> = Method::all().map(|_| Tally::default()).collect();
    let (mut bounds, mut leasts) = (Vec::new(), Vec::new());
    for seed in 0..records.count {
        let made = made(spec, records.first_seed + seed, records.duration_s)?;
        let joint = made.joints.first().context("a plant has a joint")?;
        let trial = joint.trials.first().context("a joint has a trial")?;
        for (method, tally) in Method::all().zip(&mut tallies) {
            let begun = Instant::now();
            let found = estimate(trial, &settings(method))?;
            tally.time += begun.elapsed();
            tally.samples += trial.len();
            tally.add(inner(&made, trial), &found);
        }
        let slow = made.truth.len() > 200;
        if seed < if slow { SLOW_BOUNDS } else { BOUNDS } {
            bounds.extend(bound(spec, &made, trial));
            leasts.extend(least(spec, &made, trial));
        }
    }
    let mean =
        |all: Vec<f64>| (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64);
    Ok((tallies, [mean(bounds), mean(leasts)]))
}

fn print(name: &str, tallies: &[Tally], limits: [Option<f64>; 2]) {
    let limits = limits.map(|limit| limit.map_or_else(|| "-".to_owned(), |l| format!("{l:.3}")));
    for (method, tally) in Method::all().zip(tallies) {
        let dash = |text: String, known: bool| if known { text } else { "-".to_owned() };
        println!(
            "{name:21}{:10}{:6}{:8.1}{:9.3}{:+8.3}{:>8}{:>8}{:>8}{:>8}{:8.1}",
            method.id(),
            tally.steps,
            100.0 * tally.errors.len() as f64 / tally.steps as f64,
            tally.mean_error(),
            tally.bias(),
            dash(format!("{:.1}", tally.coverage()), tally.intervals > 0),
            dash(
                format!("{:.2}", 100.0 * tally.still_accepted as f64 / tally.still as f64),
                tally.still > 0
            ),
            limits[0],
            limits[1],
            tally.samples as f64 * 1e-6 / tally.time.as_secs_f64(),
        );
    }
}

/// Errors of each method on joints whose delays are known, beside what no method can do better
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Records of each plant
    #[arg(default_value_t = RECORDS)]
    records: u64,

    /// Seed of the first record
    #[arg(default_value_t = FIRST_SEED)]
    first_seed: u64,

    /// Length of each record, seconds
    #[arg(default_value_t = DURATION_S)]
    duration_s: f64,

    /// Only these plants
    #[arg(value_name = "PLANT")]
    plants: Vec<String>,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    let Args { records: count, first_seed, duration_s, plants: ref chosen } = *args;
    let records = Records { count, first_seed, duration_s };
    println!(
        "{count} records of {duration_s} s each, seeds from {first_seed} on; errors in samples, \
         shares in percent, speed in million samples/s"
    );
    println!(
        "plant                method    steps accepted  error    bias covered   false   bound   least   speed"
    );
    for (name, spec) in plants() {
        if chosen.is_empty() || chosen.iter().any(|chosen| chosen == name) {
            let (tallies, limits) = measure(&spec, records)?;
            print(name, &tallies, limits);
        }
    }
    Ok(())
}

/// One record: dead time is told from lag.
#[test]
fn the_lag_is_not_booked_as_delay() -> anyhow::Result<()> {
    let all = plants();
    for name in ["ideal", "lag of 6"] {
        let (_, spec) = all.iter().find(|(plant, _)| *plant == name).context("it is one")?;
        let records = Records { count: 1, first_seed: FIRST_SEED, duration_s: DURATION_S };
        let (tallies, _) = measure(spec, records)?;
        let error = tallies.last().context("a tally for each method")?.mean_error();
        assert!(error < 0.15, "{name}: {error}");
    }
    Ok(())
}

/// After a lag, what rings obeys `T·z' + z = ring`.
#[test]
fn the_response_of_lag_and_ringing_solves_its_equation() {
    let (lag, ringing) = (6.0, (0.157, 0.25));
    for t in [0.5, 3.0, 40.0, 9000.0] {
        let at = |t| response(Some(lag), Some(ringing), t);
        let slope = (at(t + 1e-3) - at(t - 1e-3)) / 2e-3;
        let alone = response(None, Some(ringing), t);
        assert!((lag * slope + at(t) - alone).abs() < 1e-6, "{t}");
    }
}
