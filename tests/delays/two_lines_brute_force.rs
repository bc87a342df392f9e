//! The fast search against a two-line fit written straight from the equations: for each
//! candidate both lines are solved anew by a singular value decomposition.

use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use tauscope::delay::{Candidates, FirstLast, Line, Method, Settings, estimate};
use tauscope::experiment::Trial;
use tauscope::units::SamplePeriod;

/// The line through `y` at the sample numbers from `first` on, and its squared error.
fn line_fit(y: &[f64], first: usize) -> (Line, f64) {
    let k = |row: usize| (first + row) as f64;
    let design = DMatrix::from_fn(y.len(), 2, |row, column| if column == 0 { 1.0 } else { k(row) });
    let y = DVector::from_column_slice(y);
    let solution = design.clone().svd(true, true).solve(&y, 1e-13).unwrap();
    let error = (&design * &solution - y).norm_squared();
    (Line { intercept: solution[0], slope: solution[1] }, error)
}

/// Every pair of lines: `(breakpoint, squared error, before, after)`.
fn all_pairs(y: &[f64], first: usize, beta: usize) -> Vec<(usize, f64, Line, Line)> {
    let rows = y.len() / beta;
    let used = &y[..rows * beta];
    (1..rows)
        .map(|f| {
            let (before, error_before) = line_fit(&used[..f * beta], first);
            let (after, error_after) = line_fit(&used[f * beta..], first + f * beta);
            (first + f * beta, error_before + error_after, before, after)
        })
        .collect()
}

/// A broken line with steps of noise, of any size from flat to steep.
fn segment() -> impl Strategy<Value = Vec<f64>> {
    let shape = (-5.0..5.0, -5.0..5.0, -100.0..100.0, 0.0..1.0f64, 0.0..0.5);
    (4usize..160, shape).prop_flat_map(|(length, (before, after, level, part, noise))| {
        let kink = part * length as f64;
        prop::collection::vec(-1.0..1.0f64, length).prop_map(move |errors| {
            let line = |k: f64| level + before * k.min(kink) + after * (k - kink).max(0.0);
            errors.iter().enumerate().map(|(k, e)| line(k as f64) + noise * e).collect()
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn squared_errors_and_lines_are_those_of_the_equations(
        y in segment(), beta in 2usize..12, first in 1usize..5000,
    ) {
        let found = Candidates::search(&y, first, beta);
        let expected = all_pairs(&y, first, beta);
        prop_assert_eq!(found.len(), expected.len());
        let scale = y.iter().map(|v| v * v).sum::<f64>() + 1.0;
        for (candidate, (breakpoint, sse, before, after)) in found.iter().zip(expected) {
            prop_assert_eq!(candidate.breakpoint, breakpoint);
            prop_assert!((candidate.sse - sse).abs() <= 1e-9 * scale, "{} {sse}", candidate.sse);
            // Lines are compared where they are used: at the breakpoint.
            let k = breakpoint as f64;
            prop_assert!((candidate.before.at(k) - before.at(k)).abs() <= 1e-6 * scale.sqrt());
            prop_assert!((candidate.after.at(k) - after.at(k)).abs() <= 1e-6 * scale.sqrt());
            prop_assert!((candidate.before.slope - before.slope).abs() <= 1e-7 * scale.sqrt());
        }
    }

    #[test]
    fn the_chosen_breakpoint_has_the_least_error(y in segment(), beta in 1usize..12) {
        let found = Candidates::search(&y, 1, beta);
        let expected = all_pairs(&y, 1, beta);
        let Some(best) = found.best() else {
            prop_assert!(expected.is_empty());
            return Ok(());
        };
        let chosen = expected[best.f - 1].1;
        let least = expected.iter().map(|pair| pair.1).fold(f64::INFINITY, f64::min);
        let mean = y.iter().sum::<f64>() / y.len() as f64;
        let total: f64 = y.iter().map(|v| (v - mean).powi(2)).sum();
        // The tie of 1e-12, and the rounding of the decomposition.
        prop_assert!(chosen <= least + 1e-10 * total + 1e-18, "{chosen} {least} {total}");
    }

    #[test]
    fn an_offset_of_a_million_degrees_changes_no_decision(y in segment(), beta in 1usize..8) {
        // Noise of 0.01 degrees in steps that stay exact at 1e6.
        let near: Vec<f64> = y.iter().map(|v| (v * 1024.0).round() / 1024.0).collect();
        let far: Vec<f64> = near.iter().map(|v| v + 1_048_576.0).collect();
        let (near, far) = (Candidates::search(&near, 1, beta), Candidates::search(&far, 1, beta));
        prop_assert_eq!(near.best().map(|c| c.f), far.best().map(|c| c.f));
    }

    #[test]
    fn a_command_given_later_is_found_later(shift in 0usize..40, seed in 0u64..1000) {
        let trial = |shift: usize| {
            let noise = |k: usize| ((k as u64 * 2_654_435_761 + seed) % 997) as f64 * 1e-6;
            let level = |k: usize| if k < 100 { 0.0 } else if k < 200 { 1.0 } else { -1.0 };
            let moved = |k: usize| k.saturating_sub(115).min(100) as f64
                - k.saturating_sub(215) as f64;
            let earlier = |k: usize| k.saturating_sub(shift);
            let input = (0..400).map(|k| level(earlier(k))).collect();
            let output = (0..400).map(|k| moved(earlier(k)) + noise(earlier(k))).collect();
            let period = SamplePeriod::from_seconds(0.01).unwrap();
            Trial::new("1", 0.0, period, input, output).unwrap()
        };
        let settings = Settings { low_pass: None, first_last: FirstLast::Keep, ..Settings::of(Method::TWO_LINE) };
        let still = estimate(&trial(0), &settings).unwrap();
        let shifted = estimate(&trial(shift), &settings).unwrap();
        for (a, b) in still.decisions.iter().zip(&shifted.decisions) {
            prop_assert_eq!(a.input_step.sample + shift, b.input_step.sample);
        }
        let delay = |e: &tauscope::delay::TrialEstimate| e.decisions[0].breakpoint().unwrap().delay;
        prop_assert_eq!(delay(&still), delay(&shifted));
    }
}

#[test]
fn a_row_of_one_sample_has_a_level_line() {
    let found = Candidates::search(&[5.0, 1.0, 2.0, 3.0], 1, 1);
    let first = found.get(0).unwrap();
    assert!(first.before.slope.abs() < 1e-300);
    assert!((first.before.at(1.0) - 5.0).abs() < 1e-12);
    assert!(first.sse < 1e-20);
}
