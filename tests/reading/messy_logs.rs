//! Logs as machines and people write them: each is read as the clean one, or refused with the
//! place and the remedy. All of them are made here, from one joint.

mod clocks;
mod columns;
mod log;
mod marks;
mod sensors;
mod texts;

use std::fmt::Write as _;
use std::fs;

use tauscope::delay::{FirstLast, Method, Settings, estimate_joint};
use tauscope::experiment::{Experiment, ReadOptions};

use log::{Expected, Messy, SAME, clean, messy, plain};

/// The delays of the first joint, in seconds, of all trials one after another.
fn delays(experiment: &Experiment) -> Vec<Option<f64>> {
    let settings = Settings { first_last: FirstLast::Keep, ..Settings::of(Method::TWO_LINE) };
    let joint = &experiment.joints[0];
    let found = estimate_joint(&joint.trials, &settings);
    let trials = joint.trials.iter().zip(found);
    let of = |(trial, found): (&tauscope::Trial, Result<tauscope::delay::TrialEstimate, _>)| {
        let period = trial.period().seconds();
        let found = found.unwrap();
        let delays = found.decisions.iter().map(|decision| Some(decision.delay()? * period));
        delays.collect::<Vec<_>>()
    };
    trials.flat_map(of).collect()
}

fn read_file(log: &Messy) -> Experiment {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(log.name);
    fs::write(&path, &log.bytes).unwrap();
    let options = ReadOptions { columns: log.columns.clone(), ..ReadOptions::default() };
    Experiment::read(&[path], &options)
}

#[test]
fn every_messy_log_is_read_as_the_clean_one_or_refused_with_the_remedy() {
    let expected = delays(&read_file(&messy("clean.csv", plain(&clean()), SAME)));
    assert!(expected.len() > 15 && expected.iter().all(Option::is_some), "{expected:?}");
    let logs = [
        clocks::clocks(),
        clocks::jumps(),
        clocks::repeated_times(),
        clocks::which_times(),
        clocks::in_words(),
        clocks::other_dates(),
        columns::sensors(),
        columns::names_alone(),
        columns::units_and_names(),
        sensors::sensors(),
        sensors::stamps(),
        marks::ends_and_comments(),
        marks::cells_and_units(),
        texts::texts(),
        texts::ends(),
        texts::cells_and_rows(),
        texts::programs(),
        texts::marks(),
        texts::blanks(),
        texts::thousands(),
        texts::words_below(),
        texts::broken(),
        texts::other_formats(),
    ];
    let logs: Vec<Messy> = logs.into_iter().flatten().collect();
    assert!(logs.len() >= 30);
    let wrong: Vec<String> = logs.iter().filter_map(|log| complaint(log, &expected)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What is wrong with how `log` is read.
fn complaint(log: &Messy, clean: &[Option<f64>]) -> Option<String> {
    let experiment = read_file(log);
    let failures: Vec<String> =
        experiment.failures.iter().map(|failure| with_causes(&failure.error)).collect();
    let name = log.name;
    match log.expected {
        Expected::Refused(says) => {
            let message = failures.join("; ");
            let missing: Vec<_> = says.iter().filter(|part| !message.contains(**part)).collect();
            let is_read = !experiment.joints.is_empty();
            (is_read || !missing.is_empty())
                .then(|| format!("{name}: no {missing:?} in `{message}`"))
        }
        Expected::Read { within_s, says } => {
            if !failures.is_empty() {
                return Some(format!("{name}: {failures:?}"));
            }
            let notes = experiment.notes.join("; ");
            if !notes.contains(says) || (says.is_empty() && within_s < 1e-5 && !notes.is_empty()) {
                return Some(format!("{name}: notes `{notes}`, not `{says}`"));
            }
            if within_s > 1e3 {
                return None;
            }
            let found = delays(&experiment);
            let off = |(a, b): (&Option<f64>, &Option<f64>)| match (a, b) {
                (Some(a), Some(b)) => (a - b).abs() > within_s,
                _ => true,
            };
            let differ = found.len() != clean.len() || found.iter().zip(clean).any(off);
            differ.then(|| format!("{name}: {found:?}, not {clean:?}; {notes}"))
        }
    }
}

/// An error with its causes.
fn with_causes(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        write!(text, ": {error}").unwrap();
        cause = error.source();
    }
    text
}

/// Trials keep their rows where a table begins with its newest row.
#[test]
fn trials_of_unequal_length_are_turned_with_their_rows() {
    let mut rows: Vec<String> = Vec::new();
    for (k, row) in clean().into_iter().enumerate() {
        let trial = if k < 500 { "a" } else { "b" };
        rows.push(format!("{trial},{:.2},{},{}\n", row.time, row.input, row.output));
    }
    let header = format!("trial,{}\n", log::HEADER);
    let read =
        |rows: &[String]| read_file(&messy("turned.csv", header.clone() + &rows.concat(), SAME));
    let oldest_first = read(&rows);
    rows.reverse();
    let newest_first = read(&rows);
    assert_eq!(newest_first.joints[0].trials, oldest_first.joints[0].trials);
    assert_eq!(newest_first.joints[0].trials[0].len(), 500);
}

/// A logger that notes the input when it changes does not note it where a trial begins.
#[test]
fn an_input_that_is_noted_at_its_changes_is_held_into_the_next_trial() {
    let log = |at_changes: bool| {
        let mut text = format!("trial,{}\n", log::HEADER);
        let mut last = f64::NAN;
        for (k, row) in clean().into_iter().enumerate() {
            let is_noted = !at_changes || row.input.to_bits() != last.to_bits();
            last = row.input;
            let input = if is_noted { row.input.to_string() } else { String::new() };
            let trial = if k < 855 { "a" } else { "b" };
            writeln!(text, "{trial},{:.2},{input},{}", row.time, row.output).unwrap();
        }
        read_file(&messy("trials.csv", text, SAME))
    };
    let (whole, noted) = (log(false), log(true));
    assert_eq!(whole.joints[0].trials.len(), 2);
    for (whole, noted) in whole.joints[0].trials.iter().zip(&noted.joints[0].trials) {
        assert_eq!(whole.input(), noted.input());
    }
}
