//! A measured servo drive, from its force to its position: published parameters are found
//! again. The data are not part of this project: the folder that holds them is
//! `TAUSCOPE_REAL_LOGS`, or `../shared/data`.

use crate::real;
use crate::sample::size;
use tauscope::effect::find;
use tauscope::experiment::{Joint, Trial};
use tauscope::explain::{Options, Sequential, improve};
use tauscope::fit::{AssessedModel, Assessment, Fit, FitRecord, Horizon, Split, fit};
use tauscope::model::{Component, JointModel};
use tauscope::numerics::LowPass;
use tauscope::units::SamplePeriod;

/// The record, or `None` after saying that the test is skipped.
fn joint(name: &str) -> Option<Joint> {
    let path = real::log(name)?;
    let mut reader = csv::Reader::from_path(path).unwrap();
    let headers = reader.headers().unwrap().clone();
    let place = |name: &str| headers.iter().position(|header| header == name).unwrap();
    let (force, position) = (place("force_N"), place("q_m"));
    let (mut input, mut output) = (Vec::new(), Vec::new());
    for row in reader.records() {
        let row = row.unwrap();
        input.push(row[force].parse().unwrap());
        output.push(row[position].parse().unwrap());
    }
    let period = SamplePeriod::from_seconds(0.001).unwrap();
    let trial = Trial::new("run", 0.0, period, input, output).unwrap();
    Some(Joint::new("emps", vec![trial]).with_units("N", "m"))
}

/// Gain, inertia and friction; the offset is the difference of the two friction levels,
/// which an [input offset](tauscope::effect::InputOffset) could not be told from.
fn start() -> JointModel {
    let mut plain = JointModel::integrator(0.01, 0.0);
    plain.delay.fixed = true;
    plain.with(Component::neutral(find("coulomb_friction").unwrap()))
}

fn fitted(joint: &Joint, horizon: Horizon) -> Fit {
    let record = FitRecord::new(joint, Split::Time(1.0), horizon);
    fit(&record, &start(), &record.range(0.5)).unwrap()
}

/// Root mean square error over the whole record, metres.
fn error_m(joint: &Joint, model: &JointModel, horizon: Horizon) -> f64 {
    let record = FitRecord::new(joint, Split::Time(1.0), horizon);
    let residuals = record.evaluate(model).residuals.concat();
    (residuals.iter().map(|r| r * r).sum::<f64>() / residuals.len() as f64).sqrt()
}

/// `M a + Fv v + Fc sign(v) + OF = F`, divided by `Fv`, is the model: its levels are
/// `Fc + OF` and `Fc − OF`.
fn physical(fit: &AssessedModel) -> [f64; 4] {
    let value = |name: &str| fit.parameters.iter().find(|p| p.name == name).unwrap().value;
    let viscous = 1.0 / value("gain");
    let [up, down, constant] = ["positive", "negative", "time_constant"]
        .map(|name| value(&format!("coulomb_friction.{name}")));
    [viscous * constant, viscous, f64::midpoint(up, down), f64::midpoint(up, -down)]
}

/// Inertia in kg, viscous friction in N s/m, Coulomb friction and offset in N: Janot,
/// Gautier and Brunot, 2019, Data Set and Reference Models of EMPS.
const PUBLISHED: [f64; 4] = [95.1089, 203.5034, 20.3935, -3.1648];

/// Runs of 0.2 s.
const SHORT: Horizon = Horizon::Seconds(0.2);

#[test]
fn published_parameters_are_found_within_five_percent_and_the_offset_within_ten() {
    let Some(joint) = joint("emps_train.csv") else { return };
    // The friction of this drive differs by direction in a way that the model cannot have.
    // The shorter the windows, the nearer is their error to one of the force, as published.
    let fit = fitted(&joint, SHORT);
    let found = physical(&fit);
    // The offset is the small difference of the two friction levels, where that lack shows most:
    // plain least squares of the position have -3.39 N, those of the force -3.16 N.
    for ((found, published), within) in found.iter().zip(PUBLISHED).zip([0.05, 0.05, 0.05, 0.1]) {
        assert!((found / published - 1.0).abs() < within, "{found} is not {published}");
    }
    let Some(pulses) = self::joint("emps_test_pulses.csv") else { return };
    // The published model errs 1.47 times as much there, in the force.
    let error = |joint| error_m(joint, &fit.model, SHORT);
    let (own, other) = (error(&joint), error(&pulses));
    assert!(own < 1e-4 && other < 1.5 * own, "{own} m, {other} m");
    // 25 s without a restart, of a way of a quarter metre.
    let free = error_m(&pulses, &fit.model, Horizon::FreeRun);
    assert!(free < 0.01, "{free} m");
}

/// What a force explains of the measured one, in percent of it that is left: both sides of
/// `F = M a + Fv v + Fc sign(v) + OF`, the position low-passed at 100 Hz, then both at 40 Hz;
/// every tenth sample, without the ends, where filters know one side only.
fn force_error_percent(joint: &Joint, [inertia, viscous, coulomb, offset]: [f64; 4]) -> f64 {
    let forward = [viscous, coulomb + offset];
    force_error_by_direction_percent(joint, inertia, [forward, [viscous, coulomb - offset]])
}

/// [`force_error_percent`] with frictions of their own forward and backward.
fn force_error_by_direction_percent(joint: &Joint, inertia: f64, friction: [[f64; 2]; 2]) -> f64 {
    let [[viscous_up, up], [viscous_down, down]] = friction;
    let rest = f64::midpoint(up, -down);
    let trial = &joint.trials[0];
    let period = trial.period();
    let smooth = |values: &[f64], cutoff_hz: f64, order: usize| {
        LowPass { cutoff_hz, order }.smooth(values, period).unwrap()
    };
    let slope = |values: &[f64]| -> Vec<f64> {
        let inner = values.windows(3).map(|w| (w[2] - w[0]) / (2.0 * period.seconds()));
        let inner: Vec<f64> = inner.collect();
        [&inner[..1], &inner, &inner[inner.len() - 1..]].concat()
    };
    let velocity = slope(&smooth(trial.output(), 100.0, 4));
    let explained = velocity.iter().zip(slope(&velocity)).map(|(v, a)| {
        let braked = if *v > 0.0 {
            viscous_up * v + up
        } else if *v < 0.0 {
            viscous_down * v - down
        } else {
            rest
        };
        inertia * a + braked
    });
    let explained: Vec<f64> = explained.collect();
    let (force, explained) = (smooth(trial.input(), 40.0, 8), smooth(&explained, 40.0, 8));
    let inner = 50..force.len() - 50;
    let pairs = force[inner.clone()].iter().zip(&explained[inner]).step_by(10);
    let (left, whole) =
        pairs.fold((0.0, 0.0), |(left, whole), (f, e)| (left + (f - e) * (f - e), whole + f * f));
    100.0 * f64::sqrt(left / whole)
}

#[test]
fn the_published_parameters_explain_the_force_as_published() {
    let Some(joint) = joint("emps_train.csv") else { return };
    let error = force_error_percent(&joint, PUBLISHED);
    assert!((error - 4.08).abs() < 0.1, "{error} %");
}

#[test]
fn coulomb_friction_is_named_first_and_the_force_error_falls_as_published() {
    let Some(joint) = joint("emps_train.csv") else { return };
    let record = FitRecord::new(&joint, Split::Time(0.7), SHORT);
    let mut viscous = JointModel::integrator(0.005, 0.0);
    viscous.delay.fixed = true;
    let viscous = viscous.with(Component::neutral(find("actuator_lag").unwrap()));
    let base = fit(&record, &viscous, &record.range(0.5)).unwrap();
    let first = improve(&record, base, &Options::default(), &Sequential, |_| false);
    let [revision] = first.revisions.as_slice() else { panic!("more than was asked for") };
    let best = &revision.ranking[0];
    assert_eq!(best.effects, ["coulomb_friction"]);
    // Published: 17.97 % with inertia and viscous friction, 4.08 % with Coulomb friction and
    // offset, which are two levels here.
    let value = |fit: &Assessment, name: &str| {
        fit.parameters.iter().find(|p| p.name == name).unwrap().value
    };
    let base = &revision.comparison.fit;
    let viscous = 1.0 / value(base, "gain");
    let inertia = viscous * value(base, "actuator_lag.time_constant");
    let before = force_error_percent(&joint, [inertia, viscous, 0.0, 0.0]);
    let after = force_error_percent(&joint, physical(&best.fit));
    println!("force error: {before:.2} % without, {after:.2} % with Coulomb friction");
    assert!(before > 17.9 && after < 4.5, "{before} %, {after} %");
}

/// Inertia in kg, then viscous friction in N s/m and constant friction in N of forward and of
/// backward motion: Janot, Gautier and Brunot, 2019.
const PUBLISHED_BY_DIRECTION: (f64, [[f64; 2]; 2]) =
    (95.1540, [[166.7061, 20.1440], [240.4236, 20.6277]]);

#[test]
fn friction_that_differs_by_direction_comes_after_coulomb_friction_and_explains_the_force() {
    let Some(joint) = joint("emps_train.csv") else { return };
    let (inertia, friction) = PUBLISHED_BY_DIRECTION;
    let published = force_error_by_direction_percent(&joint, inertia, friction);
    assert!((published - 3.11).abs() < 0.15, "{published} %");
    let record = FitRecord::new(&joint, Split::Time(0.7), SHORT);
    let base = fit(&record, &start(), &record.range(0.5)).unwrap();
    let coulomb = force_error_percent(&joint, physical(&base));
    // In the small sample the effects that may be taken for it.
    let alike = ["asymmetric_friction", "direction_gain", "input_offset"];
    let effects = alike.map(|id| find(id).unwrap()).to_vec();
    let whole = Options { keeps_refinements: true, ..Options::default() };
    let options = size(Options { effects, ..whole.clone() }, whole);
    let improvement = improve(&record, base, &options, &Sequential, |revision| {
        let effects = revision.comparison.fit.model.components();
        !effects.iter().any(|part| part.effect().spec().id == "asymmetric_friction")
    });
    let last = &improvement.revisions.last().unwrap().comparison.fit;
    let value = |name: &str| last.parameters.iter().find(|p| p.name == name).unwrap().value;
    let viscous = 1.0 / value("gain");
    let [up, down, constant, ratio] = ["positive", "negative", "time_constant", "negative_viscous"]
        .map(|name| value(&format!("asymmetric_friction.{name}")));
    let friction = [[viscous, up], [ratio * viscous, down]];
    let asymmetric = force_error_by_direction_percent(&joint, viscous * constant, friction);
    println!("force error: {coulomb:.2} % with Coulomb friction, {asymmetric:.2} % by direction");
    assert!(asymmetric <= 3.2 && asymmetric < coulomb, "{coulomb} %, {asymmetric} %");
}
