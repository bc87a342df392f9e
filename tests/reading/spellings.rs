//! Every way in which a log may be written, and what is read from it.

mod files;
mod gaps;

use std::fs;
use std::path::PathBuf;

use proptest::prelude::*;
use tauscope::batch::Threads;
use tauscope::delay::{Method, Settings, estimate};
use tauscope::experiment::{
    ColumnMap, Experiment, Joint, JointColumns, ReadError, ReadErrorKind, ReadOptions,
    expand_folders,
};
use tauscope::report::{EstimatedJoint, write_delays};
use tauscope::study::{JointEstimate, estimate_joints};
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate, write_log};
use tauscope::units::SamplePeriod;
use tempfile::TempDir;

/// Logs in a folder of their own, and how they are read.
struct Reading {
    folder: TempDir,
    paths: Vec<PathBuf>,
    options: ReadOptions,
}

impl Reading {
    fn of(text: impl AsRef<[u8]>) -> Self {
        Self::nothing().and("log.csv", text)
    }

    fn nothing() -> Self {
        let folder = tempfile::tempdir().unwrap();
        Self { folder, paths: Vec::new(), options: ReadOptions::default() }
    }

    fn and(mut self, name: &str, text: impl AsRef<[u8]>) -> Self {
        let path = self.file(name, text);
        self.paths.push(path);
        self
    }

    fn file(&self, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
        let path = self.folder.path().join(name);
        fs::write(&path, text).unwrap();
        path
    }

    fn time(mut self, column: &str) -> Self {
        self.options.columns.time = Some(column.to_owned());
        self
    }

    fn trial(mut self, column: &str) -> Self {
        self.options.columns.trial = Some(column.to_owned());
        self
    }

    fn joint(mut self, name: &str, input: &str, output: &str) -> Self {
        self.options.columns.joints.push(JointColumns::new(name, input, output));
        self
    }

    fn mapping(mut self, toml: &str) -> Self {
        self.options.columns = ColumnMap::read(&self.file("map.toml", toml)).unwrap();
        self
    }

    fn only(mut self, joint: &str) -> Self {
        self.options.joints.push(joint.to_owned());
        self
    }

    fn sample_period(mut self, seconds: f64) -> Self {
        self.options.columns.sample_period_s = Some(seconds);
        self
    }

    fn resample(mut self, seconds: f64) -> Self {
        self.options.repair.resample = SamplePeriod::from_seconds(seconds);
        self
    }

    fn unrepaired(mut self) -> Self {
        self.options.repair.as_it_stands = true;
        self
    }

    fn fill(mut self, seconds: f64) -> Self {
        self.options.repair.fill_s = Some(seconds);
        self
    }

    fn read(&self) -> Experiment {
        Experiment::read(&self.paths, &self.options)
    }

    /// All joints; nothing failed.
    fn joints(&self) -> Vec<Joint> {
        let Experiment { joints, failures, .. } = self.read();
        assert!(failures.is_empty(), "{failures:#?}");
        joints
    }

    /// The only joint; nothing failed.
    fn the_joint(&self) -> Joint {
        let [joint] = <[Joint; 1]>::try_from(self.joints()).unwrap();
        joint
    }

    /// The only failure.
    fn error(&self) -> ReadError {
        let mut failures = self.read().failures;
        assert_eq!(failures.len(), 1, "{failures:#?}");
        failures.remove(0).error
    }
}

fn labels(joint: &Joint) -> Vec<&str> {
    joint.trials.iter().map(tauscope::experiment::Trial::label).collect()
}

fn outputs(joint: &Joint) -> Vec<&[f64]> {
    joint.trials.iter().map(tauscope::experiment::Trial::output).collect()
}

fn inputs(joint: &Joint) -> Vec<&[f64]> {
    joint.trials.iter().map(tauscope::experiment::Trial::input).collect()
}

fn periods(joint: &Joint) -> Vec<String> {
    joint.trials.iter().map(|trial| trial.period().to_string()).collect()
}

fn starts(joint: &Joint) -> Vec<String> {
    joint.trials.iter().map(|trial| format!("{:.6}", trial.time_s(1))).collect()
}

/// Equal to 1e-9, far below what is logged and far above rounding.
fn assert_near(found: &[f64], expected: &[f64]) {
    let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-9;
    let equal = found.len() == expected.len() && found.iter().zip(expected).all(near);
    assert!(equal, "{found:?}, not {expected:?}");
}

const PLAIN: &str = "time_s,boom.input,boom.output\n0,0,1.5\n0.01,-2,1.25\n0.02,-2,1e-3\n";

fn is_plain(joint: &Joint) {
    assert_eq!((joint.name.as_str(), labels(joint)), ("boom", vec!["1"]));
    assert_eq!(inputs(joint), [[0.0, -2.0, -2.0]]);
    assert_eq!(outputs(joint), [[1.5, 1.25, 1e-3]]);
    assert_eq!((periods(joint), starts(joint)), (vec!["0.01 s".into()], vec!["0.000000".into()]));
}

#[test]
fn a_plain_log_is_read_as_it_stands() {
    is_plain(&Reading::of(PLAIN).the_joint());
}

#[test]
fn comma_semicolon_and_tab_part_the_cells() {
    for delimiter in [",", ";", "\t", " , ", "\t "] {
        is_plain(&Reading::of(PLAIN.replace(',', delimiter)).the_joint());
    }
}

#[test]
fn byte_order_mark_line_endings_comments_and_blank_lines_are_taken_off() {
    let commented = "# made, by; hand\n#\n".to_owned() + &PLAIN.replace("0.02", "# pause\n\n0.02");
    for text in [
        format!("\u{feff}{PLAIN}"),
        PLAIN.replace('\n', "\r\n"),
        format!("\u{feff}{}", PLAIN.replace('\n', "\r\n")),
        PLAIN.trim_end().to_owned(),
        PLAIN.replace('\n', "\r\n").trim_end().to_owned(),
        format!("{PLAIN}\n\n"),
        commented.clone(),
        commented.replace('\n', "\r\n"),
        PLAIN.replace("boom.input", "\"boom.input\"").replace("1.5", "\"1.5\""),
    ] {
        is_plain(&Reading::of(text).the_joint());
    }
}

#[test]
fn a_comment_behind_the_byte_order_mark_does_not_hide_the_delimiter() {
    let text = format!("\u{feff}# a, b, c, d, e\n{}", PLAIN.replace(',', ";"));
    is_plain(&Reading::of(text).the_joint());
}

/// As spreadsheet programs write it.
#[test]
fn a_name_may_have_its_unit_on_the_next_line_of_its_cell() {
    let (names, rows) = PLAIN.split_once('\n').unwrap();
    let quoted = names.replace("boom.input", "\"boom.input\n[V]\"");
    let quoted = quoted.replace("boom.output", "\"boom.output\n[deg]\"");
    let joint = Reading::of(format!("{quoted}\n{rows}")).the_joint();
    assert_eq!(joint.input_unit.as_deref(), Some("V"));
    is_plain(&joint);
}

#[test]
fn units_in_brackets_are_kept_beside_the_name() {
    let text = "time_s [s],boom.input [V],boom.output [deg/s]\n0,0,1\n1,0,1\n";
    let joint = Reading::of(text).the_joint();
    assert_eq!(
        (joint.input_unit.as_deref(), joint.output_unit.as_deref()),
        (Some("V"), Some("deg/s"))
    );
    let none = Reading::of(PLAIN).the_joint();
    assert_eq!((none.input_unit, none.output_unit), (None, None));
}

#[test]
fn a_unit_may_hold_what_parts_cells_elsewhere() {
    for unit in ["a;b;c;d", "\"N·m, static\""] {
        let cell = format!("boom.output [{}]", unit.trim_matches('"'));
        let cell = if unit.starts_with('"') { format!("\"{cell}\"") } else { cell };
        let joint = Reading::of(PLAIN.replace("boom.output", &cell)).the_joint();
        assert_eq!(joint.output_unit.as_deref(), Some(unit.trim_matches('"')));
    }
}

#[test]
fn time_has_four_names_and_the_preferred_one_counts() {
    for name in ["time_s", "t_s", "time", "t", "Time_S", "T"] {
        is_plain(&Reading::of(PLAIN.replace("time_s", name)).the_joint());
    }
    let text = "t,time_s,boom.input,boom.output\n0,5,0,0\n1,5.5,0,0\n2,6,0,0\n";
    assert_eq!(periods(&Reading::of(text).the_joint()), ["0.5 s"]);
}

#[test]
fn a_time_in_another_unit_is_not_taken_for_seconds() {
    let text = "time [ms],boom.input,boom.output\n0,0,0\n10,0,0\n20,0,0\n";
    let experiment = Reading::of(text).read();
    let periods: Vec<_> = experiment.joints.iter().flat_map(periods).collect();
    assert!(periods.iter().all(|period| period == "0.01 s"), "{periods:?}");
}

#[test]
fn sample_numbers_need_the_period_between_them() {
    let text = "sample,boom.input,boom.output\n11,0,1.5\n12,-2,1.25\n13,-2,1e-3\n";
    let joint = Reading::of(text).sample_period(0.02).the_joint();
    assert_eq!((periods(&joint), starts(&joint)), (vec!["0.02 s".into()], vec!["0.220000".into()]));
    assert_eq!(outputs(&joint), [[1.5, 1.25, 1e-3]]);
    let error = Reading::of(text).error();
    assert!(matches!(error.kind, ReadErrorKind::NoTime(None)), "{error}");
    assert_eq!(error.row(), Some(1));
}

#[test]
fn a_lost_sample_number_is_noticed_and_can_be_filled() {
    let text = "sample,boom.input,boom.output\n1,5,1\n2,5,2\n4,6,4\n5,6,5\n";
    let lost = Reading::of(text).sample_period(0.02);
    let strict = Reading::of(text).sample_period(0.02).unrepaired();
    let error = strict.error();
    assert!(matches!(error.kind, ReadErrorKind::NotUniform { .. }), "{error}");
    assert_eq!(error.row(), Some(4));
    let joint = lost.fill(0.04).the_joint();
    assert_eq!(outputs(&joint), [[1.0, 2.0, 3.0, 4.0, 5.0]]);
    assert_eq!(inputs(&joint), [[5.0, 5.0, 5.0, 6.0, 6.0]]);
}

#[test]
fn rows_alone_do_with_a_sample_period() {
    let text = "boom.input,boom.output\n0,1\n0,2\n";
    let joint = Reading::of(text).sample_period(0.25).the_joint();
    assert_eq!((periods(&joint), starts(&joint)), (vec!["0.25 s".into()], vec!["0.000000".into()]));
}

#[test]
fn trial_test_and_run_part_a_log() {
    for name in ["trial", "test", "run", "Trial"] {
        let text = format!(
            "time_s,{name},boom.input,boom.output\n\
             0,b-1,1,1\n1,b-1,1,2\n0,a 2,3,3\n0.5,a 2,3,4\n1,a 2,3,5\n9,7,0,0\n9.1,7,0,0\n"
        );
        let joint = Reading::of(text).the_joint();
        assert_eq!(labels(&joint), ["b-1", "a 2", "7"]);
        assert_eq!(outputs(&joint), [&[1.0, 2.0][..], &[3.0, 4.0, 5.0], &[0.0, 0.0]]);
        assert_eq!(periods(&joint), ["1 s", "0.5 s", "0.1 s"]);
        assert_eq!(starts(&joint), ["0.000000", "0.000000", "9.000000"]);
    }
}

#[test]
fn labels_that_differ_by_a_control_character_are_two_trials() {
    let half = |label: &str| stepping(label, 100, 1.0);
    let text = format!("time_s,trial,boom.input,boom.output\n{}{}", half("x\u{1}"), half("x\u{2}"));
    let joint = Reading::of(text).the_joint();
    assert_eq!(labels(&joint), [r"x\u{1}", r"x\u{2}"]);
}

#[test]
fn a_trial_that_comes_back_is_refused() {
    let text = "time_s,trial,boom.input,boom.output\n0,a,1,1\n1,a,1,2\n0,b,3,3\n1,b,3,4\n2,a,0,0\n";
    let error = Reading::of(text).error();
    assert!(matches!(error.kind, ReadErrorKind::TrialNotContiguous), "{error}");
    assert_eq!(error.row(), Some(6));
}

#[test]
fn filling_never_crosses_the_border_of_a_trial() {
    let text = "time_s,trial,boom.input,boom.output\n\
                0,a,1,1\n1,a,1,2\n2,a,1,\n3,b,,\n4,b,5,6\n5,b,5,7\n";
    for reading in [Reading::of(text).fill(9.0), Reading::of(text).fill(9.0).resample(1.0)] {
        let joint = reading.the_joint();
        assert_eq!(labels(&joint), ["a", "b"]);
        assert_eq!(outputs(&joint), [[1.0, 2.0], [6.0, 7.0]]);
        assert_eq!(inputs(&joint), [[1.0, 1.0], [5.0, 5.0]]);
        assert_eq!(starts(&joint), ["0.000000", "4.000000"]);
    }
}

/// A joint that steps every 40 samples and follows after 12, at 100 Hz.
fn stepping(trial: &str, samples: usize, sign: f64) -> String {
    let level = |k: usize| sign * [0.0, 1.0, -1.0][(k + 20) / 40 % 3];
    let mut angle = 0.0;
    let mut row = |k: usize| {
        angle += level(k.saturating_sub(12));
        format!("{:.2},{trial},{},{angle}\n", k as f64 * 0.01, level(k))
    };
    (0..samples).map(&mut row).collect()
}

#[test]
fn nothing_is_estimated_across_the_border_of_a_trial() {
    let header = "time_s,trial,boom.input,boom.output\n";
    let (a, b) = (stepping("a", 210, 1.0), stepping("b", 190, -3.0));
    let together = Reading::of(format!("{header}{a}{b}")).the_joint();
    let settings = Settings::of(Method::TWO_LINE);
    for (trial, alone) in together.trials.iter().zip([&a, &b]) {
        let alone = Reading::of(format!("{header}{alone}")).the_joint();
        assert_eq!(trial, &alone.trials[0]);
        let found = estimate(trial, &settings).unwrap();
        let expected = estimate(&alone.trials[0], &settings).unwrap();
        // Compared as text: NaN marks the samples without a delay.
        assert_eq!(format!("{found:?}"), format!("{expected:?}"));
        assert!(found.decisions.iter().all(|d| d.segment.last <= trial.len()));
    }
}

const FOREIGN: &str = "Clock;Try;u_duty (pct);angle_deg [deg];p.bar;note\n\
                       0;x;0;1;200;hello\n0.1;x;0;2;201;\n0.2;y;0;3;;n/a\n0.3;y;0;4;203;\n";

#[test]
fn options_map_the_columns_of_a_foreign_log() {
    let reading = Reading::of(FOREIGN).time("Clock").trial("Try");
    let joint = reading.joint("arm", "u_duty (pct)", "angle_deg").the_joint();
    assert_eq!((joint.name.as_str(), labels(&joint)), ("arm", vec!["x", "y"]));
    assert_eq!(outputs(&joint), [[1.0, 2.0], [3.0, 4.0]]);
    let units = (joint.input_unit.as_deref(), joint.output_unit.as_deref());
    assert_eq!(units, (Some("%"), Some("deg")));
}

#[test]
fn a_file_maps_the_columns_of_a_foreign_log() {
    let mapping = "time = 'Clock'\ntrial = 'Try'\n[joint.arm]\ninput = 'u_duty (pct)'\n\
                   output = 'angle_deg [deg]'\ninput_unit = '%'\n\
                   covariates = { pressure = 'p.bar' }\n";
    let joint = Reading::of(FOREIGN).mapping(mapping).the_joint();
    assert_eq!(labels(&joint), ["x", "y"]);
    assert_eq!(
        (joint.input_unit.as_deref(), joint.output_unit.as_deref()),
        (Some("%"), Some("deg"))
    );
    assert_eq!(joint.covariates[0].name, "pressure");
    assert_eq!(joint.trials[0].covariates(), [[200.0, 201.0]]);
}

#[test]
fn a_mapped_log_keeps_only_the_joints_that_were_asked_for() {
    let text = "t,u,x,y\n0,1,2,3\n1,1,2,3\n";
    let reading = Reading::of(text).joint("a", "u", "x").joint("b", "u", "y");
    assert_eq!(reading.joints().len(), 2, "one input may drive two joints");
    assert_eq!(reading.only("b").the_joint().name, "b");
}

#[test]
fn columns_that_nobody_asked_for_may_hold_anything() {
    let text = "t,u,y,note,note,,\n0,1,2,a,b,,\n1,1,2,inf,,,x\n";
    let joint = Reading::of(text).joint("arm", "u", "y").the_joint();
    assert_eq!(outputs(&joint), [[2.0, 2.0]]);
}

#[test]
fn columns_of_one_name_are_told_apart_by_their_units() {
    let text = "t,u,y [deg],y [rad]\n0,1,57,1\n1,1,114,2\n";
    let joint = Reading::of(text).joint("arm", "u", "y [rad]").the_joint();
    assert_eq!(outputs(&joint), [[1.0, 2.0]]);
}

#[test]
fn further_signals_of_a_joint_are_kept() {
    let text = "time_s,boom.input,boom.pressure [bar],boom.output,arm.input,arm.output,boom.temp\n\
                0,1,200,3,4,5,20\n1,1,,3,4,5,21\n";
    let joints = Reading::of(text).joints();
    let [boom, arm] = joints.as_slice() else { panic!("{joints:?}") };
    let signals: Vec<_> =
        boom.covariates.iter().map(|s| (s.name.as_str(), s.unit.as_deref())).collect();
    assert_eq!(signals, [("pressure", Some("bar")), ("temp", None)]);
    let [pressure, temperature] = boom.trials[0].covariates() else { panic!("{boom:?}") };
    assert!(pressure[0].to_string() == "200" && pressure[1].is_nan(), "{pressure:?}");
    assert_eq!(temperature, &[20.0, 21.0]);
    assert!(arm.covariates.is_empty());
}

#[test]
fn names_of_joints_may_hold_dots_spaces_and_slashes() {
    let text = "time_s,/left arm/a.b.input [V],/left arm/a.b.output,Übung 1.input,Übung 1.output\n\
                0,1,2,3,4\n1,1,2,3,4\n";
    let joints = Reading::of(text).joints();
    let names: Vec<_> = joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["/left arm/a.b", "Übung 1"]);
}

fn plant() -> impl Strategy<Value = PlantSpec> {
    let unit = prop::sample::select(vec!["V", "%", "deg", "m/s²", "N·m, static", "\"\""]);
    let joint = (unit.clone(), unit, -1e3..1e3f64, 0.0..10.0f64, any::<bool>()).prop_map(
        |(input_unit, output_unit, start, noise, given)| {
            let input = if given {
                InputSpec::Steps { steps: vec![(2, 0.1), (9, -1e-7)], initial: 1.0 / 3.0 }
            } else {
                InputSpec::Levels { levels: vec![-2.0, 0.1, 1e9], hold_s: [0.1, 0.4] }
            };
            let joint = JointSpec::new("", input, DelayLaw::Constant { seconds: 0.05 });
            let (input_unit, output_unit) = (input_unit.to_owned(), output_unit.to_owned());
            JointSpec { input_unit, output_unit, start, noise, ..joint }
        },
    );
    let named = prop::collection::btree_map("[a-zA-Z0-9_äΩ-]{1,6}", joint, 1..4);
    let period = prop::sample::select(vec![0.01, 0.001, 0.02, 0.004, 1.0 / 60.0, 1.0 / 3.0]);
    (any::<u64>(), period, 10_u32..300, named).prop_map(
        |(seed, sample_period_s, samples, joints)| {
            let named = joints.into_iter().map(|(name, joint)| JointSpec { name, ..joint });
            let duration_s = f64::from(samples) * sample_period_s;
            PlantSpec { sample_period_s, ..PlantSpec::new(seed, duration_s, named.collect()) }
        },
    )
}

proptest! {
    #[test]
    fn what_is_written_is_read_again(plant in plant()) {
        let mut made = simulate(&plant).unwrap();
        let round = |made: &_| {
            let mut bytes = Vec::new();
            write_log(made, &mut bytes).unwrap();
            Reading::of(bytes).joints()
        };
        let read = round(&made);
        prop_assert_eq!(read.len(), made.joints.len());
        for (read, made) in read.iter().zip(&made.joints) {
            prop_assert_eq!(&read.name, &made.name);
            prop_assert_eq!(&read.input_unit, &made.input_unit);
            prop_assert_eq!(&read.output_unit, &made.output_unit);
            let (read, made) = (&read.trials[0], &made.trials[0]);
            prop_assert_eq!(read.label(), made.label());
            prop_assert_eq!(read.input(), made.input());
            // The log has six decimals of the output and nine of the time.
            let period = read.period().seconds() / made.period().seconds();
            prop_assert!((period - 1.0).abs() < 1e-6, "{}", period);
            for (read, made) in read.output().iter().zip(made.output()) {
                let rounding = 0.5e-6 + 1e-15 * made.abs();
                prop_assert!((read - made).abs() <= rounding, "{} {}", read, made);
            }
        }
        made.joints = read;
        prop_assert_eq!(round(&made), made.joints);
    }
}

/// Where a clock counts from 1970 or from when a machine was switched on, and the same log at zero.
#[test]
fn a_clock_that_counts_from_1970_is_counted_from_the_first_second_of_the_log() {
    let log = |first: f64| {
        let rows = (0..300).map(|k| {
            let (time, level) = (first + 0.25 + f64::from(k) * 0.02, f64::from(k / 60 % 2));
            format!("{time:.2},{level},{}\n", f64::from(k) * 0.1)
        });
        format!("time_s,boom.input,boom.output\n{}", rows.collect::<String>())
    };
    let plain = Reading::of(log(0.0)).the_joint();
    for (first, date) in [(1.7e9, "2023-11-14T22:13:20Z (1700000000 s"), (54_321.0, "54321 s")] {
        let read = Reading::of(log(first)).read();
        let trial = &read.joints[0].trials[0];
        assert!((trial.time_s(1) - plain.trials[0].time_s(1)).abs() < 1e-6);
        assert!((trial.logged_time_s(2) - first - 0.27).abs() < 1e-6);
        assert_eq!(trial.origin_s().to_string(), first.to_string());
        assert_eq!(outputs(&read.joints[0]), outputs(&plain));
        let said = format!("times count from {date} of its clock)");
        let said = said.trim_end_matches(')');
        assert!(read.notes.iter().any(|note| note.contains(said)), "{:?}", read.notes);
    }
    // Two logs of one clock keep the time between them.
    let both = Reading::of(log(1.7e9)).and("later.csv", log(1.7e9 + 60.0)).the_joint();
    assert!((both.trials[1].time_s(1) - 60.25).abs() < 1e-6);
    let mut table = Vec::new();
    let joints = [both];
    let estimate = estimate_joints(&joints, &Settings::of(Method::TWO_LINE), || (), &Threads)
        .remove(0)
        .unwrap();
    let estimated = EstimatedJoint { joint: &joints[0], estimate: &estimate };
    write_delays(&[estimated], &mut table).unwrap();
    let table = String::from_utf8(table).unwrap();
    assert!(table.lines().nth(2).unwrap().contains(",2,1700000000.27,"), "{}", &table[..200]);
}

#[test]
fn times_that_cannot_be_seconds_are_refused_and_so_are_too_few() {
    let log = |name: &str, step: f64| {
        let rows = (0..50).map(|k| format!("{},{},{k}\n", f64::from(k) * step, k / 10 % 2));
        format!("{name},boom.input,boom.output\n{}", rows.collect::<String>())
    };
    for (name, step) in [("t", 1e4), ("t", 1e7), ("time_s", 1e7)] {
        let error = Reading::of(log(name, step)).error();
        let text = error.to_string();
        assert!(text.contains("so they are probably not in seconds"), "{name} {step}: {text}");
    }
    assert_eq!(periods(&Reading::of(log("t [us]", 1e4)).the_joint()), ["0.01 s"]);
    assert_eq!(periods(&Reading::of(log("time_s", 1e4)).the_joint()), ["10000 s"]);
    // A date says that the rows are half an hour apart.
    let rows = (0..40).map(|k| {
        format!("2026-03-{:02} {:02}:{:02}:00,{},{k}\n", 1 + k / 48, k / 2, k % 2 * 30, k / 10 % 2)
    });
    let seldom = format!("time,boom.input,boom.output\n{}", rows.collect::<String>());
    assert_eq!(periods(&Reading::of(seldom).the_joint()), ["1800 s"]);
    // Seconds since 1970 as a 32-bit number.
    let rows =
        (0..4000).map(|k| format!("{},{},{k}\n", 1_699_999_872 + k / 2500 * 128, k / 500 % 2));
    let coarse = format!("time_s,boom.input,boom.output\n{}", rows.collect::<String>());
    let error = Reading::of(coarse).error();
    let text = error.to_string();
    assert!(text.contains("the 4000 rows of this trial have only 2 different times"), "{text}");
}
