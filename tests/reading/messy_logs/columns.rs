//! Signals, and the names and units of columns.

use std::fmt::Write as _;

use super::log::*;
use tauscope::experiment::{ColumnMap, JointColumns};

/// Sensors that begin anew after a turn, or say nonsense now and then.
pub(crate) fn sensors() -> Vec<Messy> {
    let outputs = || clean().into_iter().map(|row| row.output);
    let (low, high) = outputs().fold((f64::MAX, f64::MIN), |(l, h), y| (l.min(y), h.max(y)));
    let turns = |row: Row| Row {
        output: (720.0 * (row.output - low) / (high - low) + 100.0).rem_euclid(360.0),
        ..row
    };
    let wrapped: Vec<Row> = clean().into_iter().map(turns).collect();
    let mut spiky = clean();
    for row in spiky.iter_mut().skip(40).step_by(97) {
        row.output += 2.0 * (high - low);
    }
    // The sensor has one value for two of the valve.
    let mut seldom = format!("{HEADER}\n");
    for (k, row) in clean().into_iter().enumerate() {
        let output = if k % 2 == 0 { row.output.to_string() } else { String::new() };
        writeln!(seldom, "{:.2},{},{output}", row.time, row.input).unwrap();
    }
    vec![
        messy(
            "turns.csv",
            table(HEADER, &wrapped, ",", |x| x.to_string()),
            read(1e-6, "wraps at a turn of 360"),
        ),
        messy("spikes.csv", plain(&spiky), read(0.051, "")),
        messy(
            "seldom_measured_by_other_names.csv",
            seldom.replacen(HEADER, "time,u_boom,y_boom", 1),
            read(0.021, "boom (input `u_boom`, output `y_boom`)"),
        ),
        messy(
            "seldom_measured.csv",
            seldom,
            read(0.021, "only 900 of 1800 rows have an output; it is interpolated between them"),
        ),
    ]
}

/// Logs without a word on which columns are those of a joint.
pub(crate) fn names_alone() -> Vec<Messy> {
    let foreign = |header: &str| table(header, &clean(), ",", |x| x.to_string());
    vec![
        messy(
            "names_say_it.csv",
            foreign("t_s,u_boom_duty_pct,y_boom (deg)"),
            read(1e-6, "joints by the names of the columns: boom (input `u_boom_duty_pct`"),
        ),
        messy("one_joint.csv", foreign("t_s,valve_cmd,angle"), read(1e-6, "`valve_cmd`")),
        messy(
            "names_say_it_and_a_cell_is_a_word.csv",
            cell(&foreign("t_s,u_boom,y_boom"), 617, 2, "stop"),
            Expected::Refused(&["row 617", "`y_boom`", "stop"]),
        ),
        messy(
            "names_say_it_and_thousands.csv",
            cell(&foreign("t_s,u_boom,y_boom"), 2, 2, "\"9,993.91\""),
            Expected::Refused(&["row 2", "`y_boom`", "9,993.91"]),
        ),
        messy(
            "more_names_than_columns.csv",
            format!("# t_s,u_boom,y_boom,error\n{}", foreign("").trim_start()),
            Expected::Refused(&["row 2", "3 cells", "the header has 4"]),
        ),
        messy(
            "one_decimal_comma.csv",
            cell(&plain(&clean()), 452, 2, "\"1,5\""),
            Expected::Refused(&["row 452", "`boom.output`", "other decimal mark"]),
        ),
        Messy {
            columns: ColumnMap {
                time: Some("Time".to_owned()),
                joints: vec![JointColumns::new("heater", "Q1", "T1")],
                ..ColumnMap::default()
            },
            ..messy("an_output_is_called_like_a_time.csv", foreign("Time,Q1,T1"), SAME)
        },
        messy(
            "names_say_nothing.csv",
            foreign("t_s,a,b"),
            Expected::Refused(&["no joint found", "the columns are: t_s, a, b"]),
        ),
    ]
}

pub(crate) fn units_and_names() -> Vec<Messy> {
    let scaled = |factor: f64| timed(move |k| (PERIOD * k as f64 * factor).round());
    let foreign = |header: &str, rows: &[Row]| table(header, rows, ",", |x| x.to_string());
    let mapped = |log: Messy, time: Option<&str>| {
        let joint = JointColumns::new("boom", "u_duty_pct", "angle (deg)");
        let columns = ColumnMap {
            time: time.map(str::to_owned),
            joints: vec![joint],
            ..ColumnMap::default()
        };
        Messy { columns, ..log }
    };
    let header = |time: &str| format!("{time},u_duty_pct,angle (deg)");
    vec![
        mapped(
            messy("time_ms.csv", foreign(&header("time_ms"), &scaled(1e3)), SAME),
            Some("time_ms"),
        ),
        Messy {
            columns: ColumnMap {
                joints: vec![JointColumns::new("boom", "valve", "pos")],
                ..ColumnMap::default()
            },
            ..messy("bare_names.csv", foreign("t_s,valve_pct,pos_mm", &clean()), SAME)
        },
        mapped(messy("t_us.csv", foreign(&header("t_us"), &scaled(1e6)), SAME), None),
        mapped(messy("Time_s.csv", foreign(&header("Time (s)"), &clean()), SAME), None),
        mapped(messy("elapsed.csv", foreign(&header("elapsed [ms]"), &scaled(1e3)), SAME), None),
        mapped(messy("millis.csv", foreign(&header("t"), &scaled(1e3)), SAME), Some("t [ms]")),
        mapped(
            messy("unit_unsaid.csv", foreign(&header("t"), &scaled(1e3)), read(1e9, "`t [ms]`")),
            None,
        ),
        mapped(
            messy(
                "epoch_ns.csv",
                foreign(&header("timestamp"), &timed(|k| 1.7e18 + 1e7 * k as f64)),
                read(1e-3, "nanoseconds since 1970"),
            ),
            None,
        ),
    ]
}
