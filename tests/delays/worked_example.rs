//! The paper's worked example: steps at samples 89 and 116, α = 10.

use std::path::PathBuf;

use tauscope::delay::{Decision, Method, Segment, Settings, Verdict, estimate};
use tauscope::experiment::{Experiment, ReadOptions};

fn second_step(settings: &Settings) -> Decision {
    let paths = [PathBuf::from("data/worked_example.csv")];
    let experiment = Experiment::read(&paths, &ReadOptions::default());
    let trial = &experiment.joints[0].trials[0];
    estimate(trial, settings).unwrap().decisions[1].clone()
}

#[test]
fn five_columns_break_at_the_fifth_row() {
    let settings = Settings { low_pass: None, ..Settings::of(Method::TWO_LINE) };
    let decision = second_step(&settings);
    assert_eq!((settings.alpha, settings.beta), (10, 5));
    assert_eq!(decision.input_step.sample, 89);
    assert_eq!(decision.segment, Segment { first: 79, last: 126 });
    assert_eq!(decision.segment.len(), 48);
    assert_eq!(decision.candidates.len(), 8, "M = 9 rows");
    let best = decision.breakpoint().unwrap();
    assert_eq!((best.candidate.f, best.candidate.breakpoint, best.delay), (5, 104, 15));
    assert_eq!(decision.verdict(), Verdict::Accepted);
}

#[test]
fn two_columns_give_23_candidates() {
    let settings = Settings { low_pass: None, beta: 2, ..Settings::of(Method::TWO_LINE) };
    let decision = second_step(&settings);
    assert_eq!(decision.candidates.len(), 23);
    assert!((decision.breakpoint().unwrap().delay - 15).abs() <= 1);
}

#[test]
fn the_low_pass_moves_nothing() {
    let decision = second_step(&Settings::of(Method::TWO_LINE));
    assert_eq!(decision.breakpoint().unwrap().candidate.breakpoint, 104);
}
