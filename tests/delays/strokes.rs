//! Strokes from rest into a stop: right delays without a setting.

use crate::real;
use crate::sample::{least, size};
use crate::stroke::{first_motion, stroke, strokes};
use tauscope::delay::{
    Condition, FirstLast, Method, Settings, TrialEstimate, Verdict, estimate_joint,
};
use tauscope::experiment::{Record, Trial};

fn estimated(trials: &Record, settings: &Settings) -> Vec<TrialEstimate> {
    estimate_joint(trials, settings).into_iter().map(Result::unwrap).collect()
}

#[test]
fn intervals_hold_the_first_motion_as_often_as_they_say() {
    let of = |seed: u32| {
        let level = f64::from(seed % 11) * 0.5 + 2.0;
        let level = if seed.is_multiple_of(2) { level } else { -level };
        (level, 0.05 + 0.011 * f64::from(seed % 40))
    };
    let made = |seed: u32| {
        let (level, delay_s) = of(seed);
        (stroke(seed, level, delay_s), first_motion(seed, level, delay_s))
    };
    let (trials, delays): (Vec<Trial>, Vec<f64>) = (300..300 + size(12, 40)).map(made).unzip();
    let trials = Record::from(trials);
    for method in Method::all().filter(|method| method.spec().has_intervals) {
        let held = estimated(&trials, &Settings::of(method)).into_iter().zip(&delays);
        let held = held.filter(|(estimate, delay)| {
            let fine = estimate.decisions[0].fine.unwrap();
            (fine.low..=fine.high).contains(*delay)
        });
        let held = held.count();
        let count = trials.len();
        assert!(held >= least(count, 0.95, 3.0), "{method}: {held} of {count}");
    }
}

#[test]
fn starts_are_found_and_rest_is_told_by_every_method() {
    let (trials, delays) = strokes();
    for method in Method::all() {
        let found = estimated(&trials, &Settings::of(method));
        for ((estimate, delay), trial) in found.iter().zip(&delays).zip(&trials) {
            let [start, stop] = &estimate.decisions[..] else { panic!("{method}: two steps") };
            let found = start.accepted_delay().unwrap_or(f64::NAN);
            // The valve has to open and the oil to press before anything moves.
            assert!(
                (-1.0..20.0).contains(&(found - delay)),
                "{method} {}: {found}, {delay}",
                trial.label()
            );
            let rests = stop.failed().any(|failed| failed == Condition::AtRest);
            assert!(rests, "{method} {}: {}", trial.label(), stop.verdict());
        }
    }
}

#[test]
fn the_paper_rejects_both_ends_of_a_stroke() {
    let (trials, _) = strokes();
    let paper =
        Settings { paper: true, first_last: FirstLast::Reject, ..Settings::of(Method::TWO_LINE) };
    for estimate in estimated(&trials[..2].to_vec().into(), &paper) {
        let rejected = Verdict::Rejected(Condition::FirstOrLast);
        assert!(estimate.decisions.iter().all(|decision| decision.verdict() == rejected));
    }
}

#[test]
fn a_stroke_that_starts_at_a_limit_of_the_output_is_not_rejected_for_it() {
    let (trials, _) = strokes();
    let resting = trials[0].output()[..100].iter().copied().fold(f64::INFINITY, f64::min);
    let limits = Some((resting + 0.1, 1e3));
    let settings = Settings { output_limits: limits, ..Settings::of(Method::HINGE) };
    let found = estimated(&trials[..1].to_vec().into(), &settings);
    assert_eq!(found[0].decisions[0].verdict(), Verdict::Accepted);
}

/// Trials of a measured excavator: rest, one step of the duty, a stroke to the stop, a step back.
fn measured(log: &str, columns: &str) -> Option<Record> {
    let path = real::log(log)?;
    let joints = vec![columns.parse().unwrap()];
    let columns = tauscope::experiment::ColumnMap { joints, ..Default::default() };
    let options = tauscope::experiment::ReadOptions { columns, ..Default::default() };
    let read = tauscope::experiment::Experiment::read(&[path], &options);
    Some(read.joints[0].trials.clone())
}

/// Seconds from the first step until the output has left its rest by 0.2 degrees.
fn departure_s(trial: &Trial) -> Option<f64> {
    let (input, output) = (trial.input(), trial.output());
    let step = input.windows(2).position(|pair| (pair[0] - pair[1]).abs() > 0.0)? + 1;
    let rest: f64 = output[step - 20..step].iter().sum::<f64>() / 20.0;
    let away = |y: &f64| (y - rest) * input[step].signum() > 0.2;
    Some(output[step..].iter().position(away)? as f64 * trial.period().seconds())
}

#[test]
fn strokes_of_an_excavator_are_found_without_a_setting() {
    for (log, columns) in [
        ("excavator_full_arm_single.csv", "arm=u_duty_pct:angle_deg"),
        ("excavator_full_bucket_single.csv", "bucket=u_duty_pct:angle_deg"),
    ] {
        let Some(trials) = measured(log, columns) else { return };
        for (method, most) in
            [(Method::TWO_LINE, 0.05), (Method::HINGE, 0.05), (Method::LAG_AWARE, 0.12)]
        {
            let found = estimated(&trials, &Settings::of(method));
            let errors = trials.iter().zip(&found).filter_map(|(trial, found)| {
                let delay = found.decisions[0].accepted_delay()? * trial.period().seconds();
                Some((delay - departure_s(trial)?).abs())
            });
            let mut errors: Vec<f64> = errors.collect();
            errors.sort_by(f64::total_cmp);
            assert!(errors.len() * 100 >= 85 * trials.len(), "{log} {method}: {}", errors.len());
            assert!(errors[errors.len() / 2] <= most, "{log} {method}: {errors:?}");
        }
    }
}
