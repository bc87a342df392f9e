//! Clocks that run unevenly, jump, or say their times in words.

use std::fmt::Write as _;

use super::log::*;

/// The time of row `k` as a date.
pub(crate) fn date(k: usize) -> String {
    let (seconds, hundredths) = (k / 100, k % 100);
    format!("2024-05-01 12:{:02}:{:02}.{hundredths:02}", seconds / 60, seconds % 60)
}

/// Sampled when there was time: the output is that of the moment.
fn uneven() -> Vec<Row> {
    let clean = clean();
    let mut now = 0.0_f64;
    let mut rows = Vec::new();
    for k in 0..ROWS {
        let before = (1..ROWS).take_while(|row| *row as f64 <= now).count();
        let after = (before + 1).min(ROWS - 1);
        let part = now.fract();
        let output = (1.0 - part) * clean[before].output + part * clean[after].output;
        rows.push(Row { time: now * PERIOD, input: clean[before].input, output });
        now += 1.0 + 0.4 * noise(k);
        if now > (ROWS - 1) as f64 {
            break;
        }
    }
    rows
}

/// Clocks that run, but not evenly.
pub(crate) fn clocks() -> Vec<Messy> {
    let at = |k: usize| PERIOD * k as f64;
    let newest_first: Vec<Row> = clean().into_iter().rev().collect();
    vec![
        messy(
            "jitter.csv",
            plain(&timed(|k| at(k) + 8e-4 * noise(k))),
            read(1e-3, "the clock jitters by"),
        ),
        messy(
            "drift.csv",
            plain(&timed(|k| at(k) + 0.03 * (at(k) / 6.0).sin() + 3e-4 * noise(k))),
            read(0.002, "the clock jitters by 2 %"),
        ),
        messy("rounded.csv", table(HEADER, &clean(), ",", |x| format!("{x:.2}")), read(0.051, "")),
        messy(
            "half_seconds.csv",
            plain(&timed(|k| (k / 50) as f64 * 0.5)),
            read(0.002, "the times are rounded to 500 ms"),
        ),
        messy(
            "late_stamps.csv",
            plain(&timed(|k| if k % 300 > 290 { at(k - k % 300 + 300) - 1e-5 } else { at(k) })),
            read(0.002, "the clock jitters by"),
        ),
        messy("uneven.csv", plain(&uneven()), read(0.055, "interpolated")),
        messy("newest_first.csv", plain(&newest_first), read(1e-3, "the newest row is first")),
    ]
}

/// Clocks that jump, and rows at the wrong place.
pub(crate) fn jumps() -> Vec<Messy> {
    let at = |k: usize| PERIOD * k as f64;
    let lost: Vec<Row> = clean()
        .into_iter()
        .enumerate()
        .filter(|(k, _)| k % 401 != 300)
        .map(|(_, row)| row)
        .collect();
    let pause = timed(|k| at(k) + if k < 870 { 0.0 } else { 12.34 });
    let anew = timed(|k| at(if k < 870 { k } else { k - 870 }));
    let mut swapped = clean();
    swapped.swap(500, 501);
    let mut mixed = clean();
    for k in 0..100 {
        mixed.swap(17 * k, 1799 - 3 * k);
    }
    let still = timed(|k| at(if (870..901).contains(&k) { 870 } else { k }));
    let slower: Vec<Row> = clean()
        .into_iter()
        .enumerate()
        .filter(|(k, _)| *k < 900 || k % 2 == 0)
        .map(|(_, row)| row)
        .collect();
    vec![
        messy("lost_rows.csv", plain(&lost), read(0.051, "4 gaps of")),
        messy("pause.csv", plain(&pause), read(0.051, "(of 12.4 s, before row 872)")),
        messy(
            "clock_anew.csv",
            plain(&anew),
            read(0.051, "the clock starts anew once (first at row 872)"),
        ),
        messy("out_of_order.csv", plain(&swapped), read(1e-3, "out of order")),
        messy("far_out_of_order.csv", plain(&mixed), read(1e-3, "out of order")),
        messy("clock_rests.csv", plain(&still), read(1e9, "trial `1` is split in 2 at long gaps")),
        messy(
            "other_rate.csv",
            plain(&slower),
            read(
                0.055,
                "449 gaps of up to 2 periods (first before row 903), where rows are lost or the logger is slower",
            ),
        ),
        messy(
            "stamp_of_nonsense.csv",
            plain(&timed(|k| if k == 60 { 4711.0 } else { at(k) })),
            Expected::Refused(&["stamp_of_nonsense.csv", "row 63", "remove the row"]),
        ),
        messy(
            "clock_stands_still.csv",
            plain(&timed(|_| 1.5)),
            Expected::Refused(&["clock_stands_still.csv", "row 3", "must increase"]),
        ),
    ]
}

/// Times that stand in several rows.
/// Seconds, and from row 702 on milliseconds.
fn unit_changes() -> Messy {
    let time = |k: usize| (100.0 + PERIOD * k as f64) * if k < 700 { 1.0 } else { 1e3 };
    let refused = Expected::Refused(&["row 702", "`time_s`", "in another unit"]);
    messy("unit_changes.csv", plain(&timed(time)), refused)
}

pub(crate) fn repeated_times() -> Vec<Messy> {
    let mut twice = clean();
    twice.insert(700, twice[699]);
    // Both levels of a step in rows of one time, as a step is drawn.
    let mut both_levels = clean();
    for k in (1..both_levels.len()).rev().filter(|k| k % 90 == 0) {
        let before = Row { input: both_levels[k - 1].input, ..both_levels[k] };
        both_levels.insert(k, before);
    }
    let doubled = |other: &dyn Fn(Row) -> Row| -> Vec<Row> {
        clean().into_iter().flat_map(|row| [row, other(row)]).collect()
    };
    let mut of_each_sensor = format!("{HEADER}\n");
    for Row { time, input, output } in clean() {
        writeln!(of_each_sensor, "{time},{input},\n{time},,{output}").unwrap();
    }
    vec![
        unit_changes(),
        messy(
            "row_for_each_sensor.csv",
            of_each_sensor,
            read(1e-6, "1800 rows have the time of the row before and only values that it lacks"),
        ),
        messy(
            "row_twice.csv",
            plain(&twice),
            read(1e-3, "1 row is at the same time as the row before"),
        ),
        messy(
            "copies.csv",
            plain(&doubled(&|row| row)),
            read(1e-6, "1800 rows are copies of the row before, and left out"),
        ),
        messy(
            "row_for_each_joint.csv",
            plain(&doubled(&|row| Row { input: -row.input, output: 90.0 - row.output, ..row })),
            Expected::Refused(&["each time is repeated in 2 rows", "`boom.output`"]),
        ),
        messy(
            "both_levels.csv",
            plain(&both_levels),
            read(
                1e-6,
                "19 rows are at the same time as the row before; one of the two is left out",
            ),
        ),
    ]
}

/// Several columns that may hold the times, and times that name no unit.
pub(crate) fn which_times() -> Vec<Messy> {
    let rows = clean();
    let with = |header: &str, other: &dyn Fn(usize) -> f64| {
        let mut text = format!("{header}\n");
        for (k, row) in rows.iter().enumerate() {
            let (time, other) = (k as f64 * PERIOD, other(k));
            writeln!(text, "{time:.2},{other:.3},{:.6},{:.6}", row.input, row.output).unwrap();
        }
        text
    };
    let half = |k: usize| 0.5 * k as f64 * PERIOD;
    let warm = |k: usize| 35.0 + 0.1 * (k / 100) as f64;
    let signals = "boom.input,boom.output";
    vec![
        // TwinCAT and LabVIEW write one for each signal.
        messy(
            "clock_for_each_signal.csv",
            with(&format!("time_s,time_s,{signals}"), &|k| k as f64 * PERIOD),
            SAME,
        ),
        messy(
            "second_clock.csv",
            with(&format!("time_s,time_s.1,{signals}"), &half),
            read(1e-6, "`time_s.1` is not used"),
        ),
        messy(
            "clock_of_another_joint.csv",
            with(&format!("time_s,arm.time_s,{signals}"), &half),
            read(1e-6, "`arm.time_s` is not used"),
        ),
        messy(
            "clock_without_a_name.csv",
            with(&format!("time_s,,{signals}"), &half),
            read(1e-6, "column 2 (without a name) is not used"),
        ),
        messy("temperature.csv", with(&format!("ts,T,{signals}"), &warm), SAME),
        messy(
            "milliseconds_at_1_khz.csv",
            table(HEADER, &timed(|k| k as f64), ",", |x| x.to_string())
                .replacen("time_s", "time", 1),
            read(1e9, "are 1 samples a second right?"),
        ),
    ]
}

/// The clean log with the times of its rows in words.
fn with(header: &str, time: impl Fn(usize) -> String) -> String {
    let mut text = format!("{header},boom.input,boom.output\n");
    for (k, row) in clean().iter().enumerate() {
        writeln!(text, "{},{:.6},{:.6}", time(k), row.input, row.output).unwrap();
    }
    text
}

/// Seconds of a minute, with two digits after the point.
fn seconds(k: usize) -> String {
    format!("{:02}.{:02}", k / 100 % 60, k % 100)
}

/// Times in words: dates, times of day, and times that have passed.
pub(crate) fn in_words() -> Vec<Messy> {
    let mixed = with("time_s", |k| match k {
        617 => "2024-05-01 12:00:06.17".to_owned(),
        _ => format!("{:.2}", k as f64 * PERIOD),
    });
    vec![
        // A unit that a program writes into each header does not change what a date is.
        messy("date_under_ms.csv", with("time [ms]", date), read(1e-6, "times count from 2024")),
        messy(
            "time_of_day_under_min.csv",
            with("time [min]", |k| format!("10:00:{}", seconds(k))),
            read(1e-6, "times count from 36000 s"),
        ),
        messy("pandas.csv", with("time", |k| format!("0 days 00:00:{}", seconds(k))), SAME),
        messy("minutes.csv", with("time", |k| format!("00:{}", seconds(k))), SAME),
        messy(
            "more_than_a_day.csv",
            with("time", |k| format!("25:00:{}", seconds(k))),
            read(1e-6, "times count from 90000 s"),
        ),
        messy(
            "matlab_durations.csv",
            with("time", |k| format!("{:.2} sec", k as f64 * PERIOD)),
            SAME,
        ),
        messy(
            "matlab_dates.csv",
            with("time", |k| date(k).replace("2024-05-01", "01-May-2024")),
            read(1e-6, "times count from 2024-05-01"),
        ),
        messy(
            "over_midnight.csv",
            with("time", |k| match k {
                0..900 => format!("23:59:{:05.2}", 51.0 + PERIOD * k as f64),
                _ => format!("00:00:{:05.2}", PERIOD * k as f64 - 9.0),
            }),
            read(1e9, "the clock starts anew once"),
        ),
        messy(
            "how_it_is_written.csv",
            with("Time [hh:mm:ss]", |k| format!("00:00:{}", seconds(k))),
            SAME,
        ),
        messy("date_among_numbers.csv", mixed, Expected::Refused(&["row 619", "`time_s`"])),
    ]
}

/// Forms that are not those of ISO 8601.
pub(crate) fn other_dates() -> Vec<Messy> {
    vec![
        messy(
            "german_dates.csv",
            with("time", |k| date(k).replace("2024-05-01", "01.05.2024")),
            read(1e-6, "times count from 2024-05-01"),
        ),
        messy(
            "american_dates.csv",
            with("time", |k| date(k).replace("2024-05-01", "5/1/2024") + " PM"),
            read(1e-6, "times count from 2024-05-01"),
        ),
        messy(
            "dates_of_unknown_order.csv",
            with("time", |k| date(k).replace("2024-05-01", "5/1/2024")),
            Expected::Refused(&["row 2", "`time`", "ISO 8601"]),
        ),
        messy(
            "milliseconds_behind_a_colon.csv",
            with("time", |k| format!("10:00:{}0", seconds(k).replace('.', ":"))),
            read(1e-6, "times count from 36000 s"),
        ),
    ]
}
