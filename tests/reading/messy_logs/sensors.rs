//! Sensors and loggers that are slow, noisy, or begin anew.

use std::fmt::Write as _;

use super::log::*;

/// The clean log with another input and output in each row.
fn measured(input: impl Fn(usize, f64) -> f64, output: impl Fn(&[Row], usize) -> f64) -> Vec<Row> {
    let clean = clean();
    let row =
        |k: usize| Row { input: input(k, clean[k].input), output: output(&clean, k), ..clean[k] };
    (0..ROWS).map(row).collect()
}

pub(crate) fn sensors() -> Vec<Messy> {
    let as_read = |rows: &[Row], k: usize| rows[k].output;
    let as_sent = |_: usize, level: f64| level;
    vec![
        messy(
            "noisy_input.csv",
            plain(&measured(|k, level| level + 0.1 * noise(k), as_read)),
            read(0.051, ""),
        ),
        messy(
            "glitch.csv",
            plain(&measured(|k, level| if k == 777 { 500.0 } else { level }, as_read)),
            SAME,
        ),
        messy(
            "dropped_values.csv",
            plain(&measured(|k, level| if k % 311 == 200 { 0.0 } else { level }, as_read)),
            SAME,
        ),
        messy(
            "zero_set_anew.csv",
            plain(&measured(as_sent, |rows, k| {
                rows[k].output + if k < 1000 { 0.0 } else { -250.0 }
            })),
            read(0.011, "the output jumps by -250 at row 1002"),
        ),
        messy(
            "slow_sensor.csv",
            plain(&measured(as_sent, |rows, k| rows[k - k % 4].output)),
            read(0.051, "each reading of the output is repeated in 4 rows"),
        ),
        messy(
            "counter.csv",
            plain(&measured(as_sent, |rows, k| {
                (1000.0 * rows[k].output).round().rem_euclid(5000.0)
            })),
            read(0.051, "the output wraps at a turn of 5000"),
        ),
    ]
}

pub(crate) fn stamps() -> Vec<Messy> {
    let at = |k: usize| PERIOD * k as f64;
    let packets =
        |size: usize| timed(move |k| at(k - k % size + size - 1) + 1e-4 * (k % size) as f64);
    // Near 100,000 s numbers of 32 bits are a 128th of a second apart.
    let single = |x: f64| (128.0 * x).round() / 128.0;
    let mut in_two = String::from("sec,nanosec,boom.input,boom.output\n");
    let mut of_two_clocks = format!("{HEADER},time_y\n");
    let mut counted = format!("{HEADER},trial\n");
    for (k, row) in clean().iter().enumerate() {
        let Row { time, input, output } = *row;
        writeln!(counted, "{time},{input},{output},{}", 1 + (k + 1) / ROWS).unwrap();
        let (seconds, rest) = (1_700_000_000 + k / 100, k % 100 * 10_000_000);
        writeln!(in_two, "{seconds},{rest},{input},{output}").unwrap();
        writeln!(of_two_clocks, "{time},{input},{output},{}", time - 0.3).unwrap();
    }
    vec![
        messy("packets_of_50.csv", plain(&packets(50)), read(0.051, "rows come in bursts")),
        messy("packets_of_7.csv", plain(&packets(7)), read(0.051, "rows come in bursts")),
        messy(
            "single_precision.csv",
            plain(&timed(|k| single(100_000.0 + at(k)))),
            read(0.002, "the times are rounded to 7.812 ms"),
        ),
        messy("in_two.csv", in_two, read(1e-6, "the times are those in `sec` and `nanosec`")),
        messy("late_count.csv", counted, read(1e-3, "trial `2` has one row only and is left out")),
        messy("two_clocks.csv", of_two_clocks, read(1e-6, "`time_y` is not used")),
    ]
}
