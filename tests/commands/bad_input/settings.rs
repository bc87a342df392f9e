//! Settings that the program or the log cannot follow.

use super::workspace::{Workspace, boom};

#[test]
fn settings_out_of_range_are_refused_with_their_name() {
    let workspace = Workspace::new().with_log(&boom());
    let refused: [(&str, &[&str]); 26] = [
        ("--alpha 0", &["--alpha"]),
        ("--beta 0", &["--beta"]),
        ("--beta 2.5", &["--beta"]),
        ("--beta 99999999999999999999", &["--beta"]),
        // More samples than can be counted.
        ("--beta 9223372036854775808", &["`--beta`"]),
        ("--passband 0", &["--passband"]),
        ("--passband fast", &["--passband"]),
        ("--passband inf", &["--passband"]),
        ("--passband 51", &["--passband"]),
        ("--passband 50", &["50 Hz", "Nyquist", "`--passband none`"]),
        // A filter that cannot be designed in double precision.
        ("--passband 1e-320", &["passband"]),
        ("--passband 1e-9", &["passband"]),
        ("--filter-order 0", &["--filter-order"]),
        ("--filter-order 13", &["filter order", "13", "12"]),
        ("--output-limits 40,-40", &["--output-limits"]),
        ("--output-limits 40,40", &["--output-limits"]),
        ("--output-limits 40", &["--output-limits"]),
        ("--output-limits NaN,40", &["--output-limits"]),
        ("--min-slope-change=-1", &["--min-slope-change"]),
        ("--max-sse NaN", &["--max-sse"]),
        ("--min-step x", &["--min-step"]),
        ("--threads 0", &["--threads"]),
        ("--resample 0", &["--resample"]),
        // More samples than a log may have.
        ("--resample 1e-9", &["log.csv", "resample"]),
        ("--fill=-1", &["--fill"]),
        ("--passband=-1", &["--passband"]),
    ];
    for (setting, says) in refused {
        workspace.estimate(&format!("log.csv {setting}")).is_refused().says(says);
    }
    // A number that begins like an option.
    for name in ["--alpha", "--beta", "--passband", "--min-slope-change", "--fill", "--resample"] {
        workspace.estimate(&format!("log.csv {name} -1")).is_refused().says(&[name]);
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
            outcome.is_refused().says(&["log.csv", signal, "its square is"]);
        }
        let small = boom().column(signal, |k| value(k) + "e-70");
        let outcome = Workspace::new().with_log(&small).estimate("log.csv --format json");
        assert_eq!(outcome.joints()[0]["accepted"], 3, "{}", outcome.stdout);
    }
}
