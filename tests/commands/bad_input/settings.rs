//! Settings that the program or the log cannot follow.

use super::workspace::{Workspace, boom};

#[test]
fn settings_out_of_range_are_refused_with_their_name() {
    let workspace = Workspace::new().with_log(&boom());
    for (setting, name) in [
        ("--alpha 0", "--alpha"),
        ("--beta 0", "--beta"),
        ("--beta 2.5", "--beta"),
        ("--beta 99999999999999999999", "--beta"),
        ("--passband 0", "--passband"),
        ("--passband=-1", "--passband"),
        ("--passband fast", "--passband"),
        ("--passband 50", "--passband"),
        ("--passband 51", "--passband"),
        ("--passband inf", "--passband"),
        ("--filter-order 0", "--filter-order"),
        ("--output-limits 40,-40", "--output-limits"),
        ("--output-limits 40,40", "--output-limits"),
        ("--output-limits 40", "--output-limits"),
        ("--output-limits NaN,40", "--output-limits"),
        ("--min-slope-change=-1", "--min-slope-change"),
        ("--max-sse NaN", "--max-sse"),
        ("--min-step x", "--min-step"),
        ("--threads 0", "--threads"),
        ("--resample 0", "--resample"),
        ("--fill=-1", "--fill"),
        ("--sample-period 0", "--sample-period"),
    ] {
        workspace.estimate(&format!("log.csv {setting}")).is_refused().says(&[name]);
    }
}

#[test]
fn a_row_of_more_samples_than_can_be_counted_is_refused() {
    let outcome = Workspace::new().with_log(&boom()).estimate("log.csv --beta 9223372036854775808");
    outcome.is_refused().says(&["`--beta`"]);
}

#[test]
fn a_negative_number_is_refused_with_the_name_of_its_option() {
    let workspace = Workspace::new().with_log(&boom());
    for name in ["--alpha", "--beta", "--passband", "--min-slope-change", "--fill", "--resample"] {
        workspace.estimate(&format!("log.csv {name} -1")).is_refused().says(&[name]);
    }
}

#[test]
fn a_grid_of_more_samples_than_can_be_counted_is_refused() {
    let outcome = Workspace::new().with_log(&boom()).estimate("log.csv --resample 1e-9");
    outcome.is_refused().says(&["log.csv", "resample"]);
}

#[test]
fn a_smoothing_that_cannot_be_designed_is_refused() {
    let workspace = Workspace::new().with_log(&boom());
    for setting in ["--passband 1e-320", "--passband 1e-9"] {
        workspace.estimate(&format!("log.csv {setting}")).is_refused().says(&["passband"]);
    }
}

#[test]
fn signals_whose_squares_are_no_numbers_are_refused() {
    let good = boom();
    for (signal, column) in [("boom.input", 1), ("boom.output", 2)] {
        let value = |k: usize| good.lines[k + 1][column].clone();
        for exponent in ["e300", "e200", "e-200", "e-300"] {
            let log = boom().column(signal, |k| value(k) + exponent);
            let outcome = Workspace::new().with_log(&log).estimate("log.csv --format json");
            outcome.is_refused().says(&["log.csv", signal, "what double precision can square"]);
        }
        let small = boom().column(signal, |k| value(k) + "e-70");
        let outcome = Workspace::new().with_log(&small).estimate("log.csv --format json");
        assert_eq!(outcome.joints()[0]["accepted"], 3, "{}", outcome.stdout);
    }
}

#[test]
fn a_filter_order_that_is_too_high_is_refused_with_its_name() {
    let outcome = Workspace::new().with_log(&boom()).estimate("log.csv --filter-order 13");
    outcome.is_refused().says(&["filter order", "13", "12"]);
}

#[test]
fn a_smoothing_that_the_log_is_too_slow_for_says_what_it_allows() {
    let outcome = Workspace::new().with_log(&boom()).estimate("log.csv --passband 50");
    outcome.is_refused().says(&["50 Hz", "Nyquist", "`--passband none`"]);
}
