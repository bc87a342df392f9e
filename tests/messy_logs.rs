//! Logs as machines and people write them: each is read as the clean one, or refused with the
//! place and the remedy. All of them are made here, from one joint.
#![expect(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;

use flate2::Compression;
use flate2::write::GzEncoder;
use tauscope::delay::{FirstLast, Settings, estimate_joint};
use tauscope::experiment::{ColumnMap, Experiment, JointColumns, ReadOptions};

/// A row of the log: when, what drove the joint, what it did.
#[derive(Clone, Copy)]
struct Row {
    time: f64,
    input: f64,
    output: f64,
}

const ROWS: usize = 1800;
const PERIOD: f64 = 0.01;

/// A number between −1 and 1 that looks random, the same each time.
fn noise(k: usize) -> f64 {
    ((k as f64 * 12.9898).sin() * 43_758.545_3).fract()
}

/// A joint at 100 Hz that follows its steps 14 samples late.
fn clean() -> Vec<Row> {
    let level = |k: usize| [0.0, 1.5, -1.0, 0.5, -2.0][k / 90 % 5];
    let mut angle = 20.0;
    let row = |k: usize| {
        angle += 0.1 * level(k.saturating_sub(14));
        Row { time: PERIOD * k as f64, input: level(k), output: angle + 0.005 * noise(k) }
    };
    (0..ROWS).map(row).collect()
}

/// The clean log with other times.
fn timed(time: impl Fn(usize) -> f64) -> Vec<Row> {
    clean().into_iter().enumerate().map(|(k, row)| Row { time: time(k), ..row }).collect()
}

/// A table with this header, delimiter and a way to write numbers.
fn table(header: &str, rows: &[Row], delimiter: &str, number: impl Fn(f64) -> String) -> String {
    let mut text = format!("{header}\n");
    for row in rows {
        let cells = [row.time, row.input, row.output].map(&number);
        writeln!(text, "{}", cells.join(delimiter)).unwrap();
    }
    text
}

fn plain(rows: &[Row]) -> String {
    table(HEADER, rows, ",", |value| format!("{value:.6}"))
}

const HEADER: &str = "time_s,boom.input,boom.output";

/// What a messy log is, and what becomes of it.
struct Messy {
    name: &'static str,
    bytes: Vec<u8>,
    columns: ColumnMap,
    expected: Expected,
}

enum Expected {
    /// Read, with delays that differ by no more than so many seconds, and a note that says this.
    Read { within_s: f64, says: &'static str },
    /// Refused with all of this in the message.
    Refused(&'static [&'static str]),
}

fn messy(name: &'static str, bytes: impl Into<Vec<u8>>, expected: Expected) -> Messy {
    Messy { name, bytes: bytes.into(), columns: ColumnMap::default(), expected }
}

/// Read as the clean log is, to the last digit but for rounding.
const SAME: Expected = Expected::Read { within_s: 1e-6, says: "" };

fn read(within_s: f64, says: &'static str) -> Expected {
    Expected::Read { within_s, says }
}

/// The delays of the first joint, in seconds, of all trials one after another.
fn delays(experiment: &Experiment) -> Vec<Option<f64>> {
    let settings = Settings { first_last: FirstLast::Keep, ..Settings::default() };
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

fn utf16(text: &str) -> Vec<u8> {
    text.encode_utf16().flat_map(u16::to_le_bytes).collect()
}

fn gzip(text: &str) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(text.as_bytes()).unwrap();
    packed.finish().unwrap()
}

/// The time of row `k` as a date.
fn date(k: usize) -> String {
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
fn clocks() -> Vec<Messy> {
    let at = |k: usize| PERIOD * k as f64;
    vec![
        messy(
            "jitter.csv",
            plain(&timed(|k| at(k) + 8e-4 * noise(k))),
            read(1e-3, "the clock jitters by"),
        ),
        messy(
            "drift.csv",
            plain(&timed(|k| at(k) + 0.03 * (at(k) / 6.0).sin() + 3e-4 * noise(k))),
            read(0.002, "drifts"),
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
    ]
}

/// Clocks that jump, and rows at the wrong place.
fn jumps() -> Vec<Messy> {
    let at = |k: usize| PERIOD * k as f64;
    let lost: Vec<Row> = clean()
        .into_iter()
        .enumerate()
        .filter(|(k, _)| k % 401 != 300)
        .map(|(_, row)| row)
        .collect();
    let pause = timed(|k| at(k) + if k < 870 { 0.0 } else { 12.34 });
    let anew = timed(|k| at(if k < 870 { k } else { k - 870 }));
    let mut twice = clean();
    twice.insert(700, twice[699]);
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
        messy("lost_rows.csv", plain(&lost), read(0.051, "rows are lost in 4 gaps")),
        messy("pause.csv", plain(&pause), read(0.051, "(of 12.4 s, before row 872)")),
        messy(
            "clock_anew.csv",
            plain(&anew),
            read(0.051, "the clock starts anew once (first at row 872)"),
        ),
        messy("row_twice.csv", plain(&twice), read(1e-3, "1 row is there twice")),
        messy("out_of_order.csv", plain(&swapped), read(1e-3, "out of order")),
        messy("far_out_of_order.csv", plain(&mixed), read(1e-3, "out of order")),
        messy(
            "clock_rests.csv",
            plain(&still),
            read(1e9, "30 rows are stamped while the clock stood still"),
        ),
        messy(
            "other_rate.csv",
            plain(&slower),
            read(
                0.055,
                "the sample rate changes at row 903, from a sample per 10 ms to one per 20 ms",
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

/// Sensors that begin anew after a turn, or say nonsense now and then.
fn sensors() -> Vec<Messy> {
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
    vec![
        messy(
            "turns.csv",
            table(HEADER, &wrapped, ",", |x| x.to_string()),
            read(1e-6, "wraps at a turn of 360"),
        ),
        messy("spikes.csv", plain(&spiky), read(0.051, "")),
    ]
}

/// Logs without a word on which columns are those of a joint.
fn names_alone() -> Vec<Messy> {
    let foreign = |header: &str| table(header, &clean(), ",", |x| x.to_string());
    vec![
        messy(
            "names_say_it.csv",
            foreign("t_s,u_boom_duty_pct,y_boom (deg)"),
            read(1e-6, "joints by the names of the columns: boom (input `u_boom_duty_pct`"),
        ),
        messy("one_joint.csv", foreign("t_s,valve_cmd,angle"), read(1e-6, "`valve_cmd`")),
        messy(
            "names_say_nothing.csv",
            foreign("t_s,a,b"),
            Expected::Refused(&["no joint found", "the columns are: t_s, a, b"]),
        ),
    ]
}

fn units_and_names() -> Vec<Messy> {
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

/// `text` with another cell at this row and column.
fn cell(text: &str, row: usize, column: usize, with: &str) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let mut cells: Vec<&str> = lines[row - 1].split(',').collect();
    cells[column] = with;
    lines[row - 1] = cells.join(",");
    lines.join("\n") + "\n"
}

fn texts() -> Vec<Messy> {
    let rows = clean();
    let comma = |x: f64| format!("{x:.6}").replace('.', ",");
    let semicolon = HEADER.replace(',', ";");
    let mut dated = String::new();
    for (k, row) in rows.iter().enumerate() {
        writeln!(dated, "{},{},{}", date(k), row.input, row.output).unwrap();
    }
    let degrees = format!("time_s;boom.input [%];boom.output [°]\n{}", {
        let text = table("", &rows, ";", |x| format!("{x:.6}"));
        text.trim_start().to_owned()
    });
    let latin1: Vec<u8> = degrees.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
    let all = plain(&rows);
    vec![
        messy("decimal_comma.csv", table(&semicolon, &rows, ";", comma), SAME),
        messy("tabs_and_commas.txt", table(&HEADER.replace(',', "\t"), &rows, "\t", comma), SAME),
        messy("dates.csv", format!("timestamp,boom.input,boom.output\n{dated}"), read(1e-4, "")),
        messy(
            "preamble.csv",
            format!("Logger 4.2\nMachine: boom, with a long name\nDate: 2024-05-01\n\n{all}"),
            SAME,
        ),
        messy("row_of_units.csv", all.replacen('\n', "\ns,V,deg\n", 1), SAME),
        messy("latin1.csv", latin1, SAME),
        messy("utf16.csv", utf16(&format!("\u{feff}{degrees}")), SAME),
        messy("utf16_unmarked.csv", utf16(&degrees), SAME),
        messy("packed.csv.gz", gzip(&all), SAME),
        messy("cut_off.csv", &all[..all.len() - 12], read(0.011, "cut off")),
        messy(
            "padded_preamble.csv",
            format!("\"Run 7\";;\nDate;01.03.2026;\n;;\n{}", all.replace(',', ";")),
            SAME,
        ),
        messy(
            "footer.csv",
            format!("{all}End of measurement\n"),
            read(1e-3, "the last row, 1802, is left out: it holds no number"),
        ),
        messy(
            "padded_footer.csv",
            format!("{all}\nEnd of measurement,,\nCounted,by,hand\n"),
            read(1e-3, "the last 2 rows, from 1803 on, are left out: they hold no number"),
        ),
        messy(
            "unit_ends_names.csv",
            all.replacen(HEADER, "t_s,boom.input_pct,boom.output_deg", 1),
            SAME,
        ),
        messy("missing_NA.csv", cell(&all, 617, 2, "#N/A"), read(0.051, "1 cell is empty or NaN")),
        messy("missing_dash.csv", cell(&all, 617, 2, "--"), read(0.051, "1 cell is empty or NaN")),
        messy(
            "missing_null.csv",
            cell(&all, 617, 1, "null"),
            read(0.051, "1 cell is empty or NaN"),
        ),
        messy("empty_cell.csv", cell(&all, 617, 2, ""), read(0.051, "1 cell is empty or NaN")),
    ]
}

/// The first lines of a log of LabVIEW, and the header of its table.
const LABVIEW: (&str, &str) = (
    "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t.\n***End_of_Header***\t\n\t\n\
     Channels\t2\t\t\nSamples\t1800\t1800\t\nDelta_X\t0.01\t0.01\t\n***End_of_Header***\t\t\t\n",
    "X_Value\tboom.input\tboom.output\tComment",
);

/// A mark between cells at the end of each line.
fn trailing(text: &str) -> String {
    text.replace('\n', ",\n")
}

/// Texts as loggers and programs write them.
fn programs() -> Vec<Messy> {
    let rows = clean();
    let all = plain(&rows);
    let (labview, header) = LABVIEW;
    let table_of_labview = table(header, &rows, "\t", |x| format!("{x:.6}"));
    let (_, next_segment) = labview.split_once("***End_of_Header***\t\n").unwrap();
    let days = |origin: f64| timed(move |k| origin + PERIOD * k as f64 / 86_400.0);
    let dated =
        |rows: &[Row]| table("time,boom.input,boom.output", rows, ",", |x| format!("{x:.11}"));
    vec![
        messy("bars.txt", all.replace(',', "|"), SAME),
        messy("labview.lvm", format!("{labview}{table_of_labview}"), SAME),
        messy(
            "two_segments.lvm",
            format!("{labview}{table_of_labview}{next_segment}{table_of_labview}"),
            Expected::Refused(&["two_segments.lvm, row 1811"]),
        ),
        messy("days_of_a_sheet.csv", dated(&days(45_658.0)), read(1e-3, "as spreadsheets count")),
        messy("datenum.csv", dated(&days(739_618.0)), read(1e-3, "MATLAB's datenum")),
        messy(
            "preamble_of_another_mark.csv",
            format!("Logger 4.2, boom test\n{}", all.replace(',', ";")),
            SAME,
        ),
    ]
}

/// Marks between cells behind the last one, and within numbers.
fn marks() -> Vec<Messy> {
    let rows = clean();
    let all = plain(&rows);
    let (_, below) = all.split_once('\n').unwrap();
    let quoted = |x: f64| format!("\"{}\"", format!("{x:.6}").replace('.', ","));
    vec![
        messy("marks_behind_rows.csv", format!("{HEADER}\n{}", trailing(below)), SAME),
        messy("mark_behind_header.csv", all.replacen('\n', ",\n", 1), SAME),
        messy("marks_behind_all.csv", trailing(&all), SAME),
        messy(
            "lost_cell_between_marks.csv",
            trailing(&all).replacen("\n5.000000,", "\n", 1),
            Expected::Refused(&["row 502", "3 cells"]),
        ),
        messy("quoted_commas.csv", table(HEADER, &rows, ",", quoted), SAME),
        messy(
            "thousands.csv",
            cell(&all, 617, 2, "here").replace("here", "\"1,234\""),
            Expected::Refused(&["row 617", "`boom.output`", "1,234"]),
        ),
        messy(
            "tail_of_thousands.csv",
            format!("{all}\"1,000\",\"2,000\",\"3,000\"\n"),
            Expected::Refused(&["row 1802", "1,000"]),
        ),
    ]
}

/// Rows of words below the header, and what names the time and its unit.
fn words_below() -> Vec<Messy> {
    let all = plain(&clean());
    let in_ms = plain(&timed(|k| 1e3 * PERIOD * k as f64)).replacen("time_s", "t", 1);
    let below = |log: &str, rows: &str| log.replacen('\n', rows, 1);
    let left_out = |row: u32| match row {
        2 => read(1e-6, "row 2, below the header, is left out"),
        _ => read(1e-6, "row 3, below the header, is left out"),
    };
    let named = |time: &str| in_ms.replacen("t,", time, 1);
    let warm = |(k, row): (usize, Row)| {
        let Row { time, input, output } = row;
        format!("{},{time:.6},{input:.6},{output:.6}\n", 20.0 + 1e-3 * k as f64)
    };
    let warm: String = clean().into_iter().enumerate().map(warm).collect();
    vec![
        messy("types.csv", below(&all, "\ns,V,deg\nfloat,float,float\n"), left_out(3)),
        messy("units_below.csv", below(&in_ms, "\nDOUBLE,DOUBLE,DOUBLE\nms,V,deg\n"), left_out(2)),
        messy("one_unit.csv", below(&in_ms, "\nms,digits,Grad\n"), left_out(2)),
        messy(
            "described_below_padding.csv",
            format!("Run 7,,\n{}", below(&named("t [ms],"), "\nclock,valve,angle\n")),
            left_out(3),
        ),
        messy(
            "described_below_a_mark.csv",
            below(&named("t [ms],"), ",\nclock,valve,angle\n"),
            left_out(2),
        ),
        messy("UPPER_MS.csv", named("TIME_MS,"), SAME),
        messy("millis_itself.csv", named("millis,"), SAME),
        messy("temperature.csv", format!("T,timestamp,boom.input,boom.output\n{warm}"), SAME),
        messy(
            "two_clocks.csv",
            trailing(&all).replace(",\n", ",0\n").replacen(",0\n", ",time_s\n", 1),
            Expected::Refused(&["two columns are named `time_s`", "rename one"]),
        ),
    ]
}

/// What no number can be made of.
fn broken() -> Vec<Messy> {
    let all = plain(&clean());
    vec![
        messy(
            "no_number.csv",
            cell(&all, 617, 2, "#REF!"),
            Expected::Refused(&["row 617", "`boom.output`", "#REF!", "write a number"]),
        ),
        messy(
            "infinite.csv",
            cell(&all, 617, 1, "inf"),
            Expected::Refused(&["row 617", "`boom.input`", "infinite", "remove the row"]),
        ),
        messy(
            "short_row.csv",
            cell(&all, 617, 1, "").replacen(",,", ",", 1),
            Expected::Refused(&["row 617", "2 cells", "has 3"]),
        ),
        messy(
            "german_dates.csv",
            cell(&all, 617, 0, "01.03.2026 09:59:50"),
            Expected::Refused(&["row 617", "`time_s`", "ISO 8601"]),
        ),
        messy(
            "half_days.csv",
            cell(&all, 2, 0, "03/01/2026 09:59:50 AM"),
            Expected::Refused(&["row 2", "`time_s`", "ISO 8601"]),
        ),
        messy(
            "blanks.txt",
            all.replace(',', "  "),
            Expected::Refused(&["blanks.txt", "parted by blanks", "commas"]),
        ),
        messy(
            "no_header.csv",
            all.split_once('\n').unwrap().1,
            Expected::Refused(&["no_header.csv, row 1", "numbers", "write a header"]),
        ),
        messy(
            "words_between.csv",
            all.replacen("\n1.000000,", "\nhere it stopped\n1.000000,", 1),
            Expected::Refused(&["row 102", "1 cells", "has 3"]),
        ),
        messy(
            "archive.zip",
            b"PK\x03\x04 and more".as_slice(),
            Expected::Refused(&["archive.zip", "ZIP archive", "unpack it first"]),
        ),
        messy(
            "bag.db3",
            b"SQLite format 3\0 and more".as_slice(),
            Expected::Refused(&["bag.db3", "ros2 bag convert", "mcap"]),
        ),
        messy(
            "old.xls",
            b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1".as_slice(),
            Expected::Refused(&["old.xls", ".xlsx"]),
        ),
        messy("packed.gz", &gzip(&all)[..2000], Expected::Refused(&["packed.gz"])),
    ]
}

#[test]
fn every_messy_log_is_read_as_the_clean_one_or_refused_with_the_remedy() {
    let expected = delays(&read_file(&messy("clean.csv", plain(&clean()), SAME)));
    assert!(expected.len() > 15 && expected.iter().all(Option::is_some), "{expected:?}");
    let logs: Vec<Messy> = clocks()
        .into_iter()
        .chain(jumps())
        .chain(sensors())
        .chain(names_alone())
        .chain(units_and_names())
        .chain(texts())
        .chain(programs())
        .chain(marks())
        .chain(words_below())
        .chain(broken())
        .collect();
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
