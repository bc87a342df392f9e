//! Sampling that is uneven, cells that are missing, and gaps.

use super::*;

#[test]
fn a_jittered_log_keeps_its_rows_unless_another_grid_is_asked_for() {
    let text =
        "time_s,boom.input,boom.output\n0,1,0\n0.009,2,9\n0.021,3,21\n0.03,4,30\n0.04,4,40\n";
    let error = Reading::of(text).unrepaired().error();
    assert!(matches!(error.kind, ReadErrorKind::NotUniform { .. }), "{error}");
    assert_eq!(error.row(), Some(3));
    let experiment = Reading::of(text).read();
    assert_eq!(periods(&experiment.joints[0]), ["0.01 s"]);
    assert_eq!(outputs(&experiment.joints[0]), [[0.0, 9.0, 21.0, 30.0, 40.0]]);
    assert!(experiment.notes[0].contains("the clock jitters by"), "{:?}", experiment.notes);
    let joint = Reading::of(text).resample(0.005).the_joint();
    assert_eq!(periods(&joint), ["0.005 s"]);
    assert_near(outputs(&joint)[0], &[0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0]);
    assert_eq!(inputs(&joint), [[1.0, 1.0, 2.0, 2.0, 2.0, 3.0, 4.0, 4.0, 4.0]]);
}

#[test]
fn resampling_to_its_own_period_changes_nothing() {
    let text = format!("time_s,trial,boom.input,boom.output\n{}", stepping("a", 150, 1.0));
    let (as_it_is, again) =
        (Reading::of(&text).the_joint(), Reading::of(&text).resample(0.01).the_joint());
    assert_eq!(inputs(&again), inputs(&as_it_is));
    assert_near(outputs(&again)[0], outputs(&as_it_is)[0]);
}

#[test]
fn resampling_takes_the_last_input_that_was_logged() {
    // The input is logged where it changes, between the samples of the output.
    let text = "time_s,boom.input,boom.output\n\
                0,1,0\n0.3,2,\n0.5,,5\n1,,10\n1.2,7,\n1.4,8,\n1.5,,15\n2,,20\n";
    let joint = Reading::of(text).resample(0.5).fill(1.0).the_joint();
    assert_near(outputs(&joint)[0], &[0.0, 5.0, 10.0, 15.0, 20.0]);
    assert_eq!(inputs(&joint), [[1.0, 2.0, 2.0, 8.0, 8.0]]);
}

/// An input that is logged less often than the output, and a gap in both.
const SPARSE: &str = "time_s,boom.input,boom.output\n\
    0,1,0\n1,1,1\n2,3,2\n3,3,\n4,3,\n5,,\n6,,6\n7,,7\n8,4,8\n";

/// After the gap the input is still the last one logged.
fn holds_the_input_over_the_gap(joint: &Joint) {
    assert_eq!(labels(joint), ["1#1", "1#2"]);
    assert_eq!(inputs(joint), [[1.0, 1.0, 3.0], [3.0, 3.0, 4.0]]);
}

#[test]
fn the_input_is_held_over_a_gap() {
    holds_the_input_over_the_gap(&Reading::of(SPARSE).fill(2.0).the_joint());
}

#[test]
fn the_input_is_held_over_a_gap_when_resampled_too() {
    holds_the_input_over_the_gap(&Reading::of(SPARSE).fill(2.0).resample(1.0).the_joint());
}

#[test]
fn a_part_of_a_trial_never_takes_the_name_of_another_trial() {
    let text = "time_s,trial,boom.input,boom.output\n\
                0,a,1,0\n1,a,1,\n2,a,1,2\n3,a,1,3\n0,a#2,1,4\n1,a#2,1,5\n";
    let joint = Reading::of(text).fill(0.0).the_joint();
    let mut names = labels(&joint);
    assert_eq!(names.len(), 3);
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), 3, "{names:?}");
}

#[test]
fn a_missing_value_is_filled_with_a_note_and_refused_where_a_log_is_to_stand_as_it_is() {
    for cell in ["", "NaN", " "] {
        let text = stepping("a", 150, 1.0).replacen(",1,0\n", &format!(",1,{cell}\n"), 1);
        let text = format!("time_s,trial,boom.input,boom.output\n{text}");
        let experiment = Reading::of(&text).read();
        assert_eq!(labels(&experiment.joints[0]), ["a"]);
        assert!(experiment.notes[0].contains("1 cell is empty or NaN"), "{:?}", experiment.notes);
        let text = PLAIN.replace("1.25", cell);
        let error = Reading::of(text).unrepaired().error();
        assert!(matches!(error.kind, ReadErrorKind::Missing), "{error}");
        assert_eq!((error.row(), error.column()), (Some(3), Some("boom.output")));
    }
}

#[test]
fn short_gaps_are_filled_and_long_ones_split_the_trial() {
    let text = "time_s,boom.input,boom.output\n\
                0,1,0\n0.1,1,\n0.2,2,2\n0.3,2,3\n0.4,3,\n0.5,3,\n0.6,3,\n0.7,4,7\n0.8,4,8\n";
    let joint = Reading::of(text).fill(0.2).the_joint();
    assert_eq!(labels(&joint), ["1#1", "1#2"]);
    assert_eq!(outputs(&joint), [&[0.0, 1.0, 2.0, 3.0][..], &[7.0, 8.0]]);
    assert_eq!(inputs(&joint), [&[1.0, 1.0, 2.0, 2.0][..], &[4.0, 4.0]]);
    assert_eq!(starts(&joint), ["0.000000", "0.700000"]);
    let whole = Reading::of(text).fill(0.4).the_joint();
    assert_eq!(labels(&whole), ["1"]);
    assert_near(outputs(&whole)[0], &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
}

#[test]
fn a_gap_as_long_as_the_limit_is_filled_at_every_period() {
    for (period, steps) in [(0.1, 3), (0.01, 29), (0.02, 7), (0.001, 57), (0.05, 6), (0.1, 7)] {
        let row = |k: i32| format!("{},0,{k}\n", f64::from(k) * period);
        let rows = (0..=20).chain((20 + steps)..=60 + steps).map(row);
        let text: String =
            std::iter::once("t,boom.input,boom.output\n".to_owned()).chain(rows).collect();
        let reading = Reading::of(text).fill(f64::from(steps) * period);
        assert_eq!(labels(&reading.the_joint()), ["1"], "{steps} periods of {period} s");
    }
    // 0.3 as a person writes it, not three times 0.1.
    let text = "t,boom.input,boom.output\n0,0,0\n0.1,0,1\n0.2,0,\n0.3,0,\n0.4,0,4\n0.5,0,5\n";
    assert_eq!(labels(&Reading::of(text).fill(0.3).the_joint()), ["1"]);
    assert_eq!(labels(&Reading::of(text).fill(0.3).resample(0.1).the_joint()), ["1"]);
}

#[test]
fn a_fill_of_zero_splits_at_every_gap() {
    let text = "t,boom.input,boom.output\n0,0,0\n1,0,1\n2,0,\n3,0,3\n4,0,4\n6,0,6\n7,0,7\n";
    let joint = Reading::of(text).fill(0.0).the_joint();
    assert_eq!(outputs(&joint), [[0.0, 1.0], [3.0, 4.0], [6.0, 7.0]]);
}

#[test]
fn a_clock_that_is_set_anew_loses_no_samples() {
    // 5e7 periods of 1 ms between the third and the fourth row.
    let text = "t,boom.input,boom.output\n0,0,0\n0.001,0,1\n0.002,0,2\n\
                50000,0,3\n50000.001,0,4\n50000.002,0,5\n";
    let joint = Reading::of(text).fill(1.0).the_joint();
    assert_eq!(outputs(&joint), [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]);
}

#[test]
fn each_sample_of_the_delays_has_its_own_time_where_joints_split_apart() {
    // Gaps at different places: part 2 of one joint is not part 2 of the other.
    let cells = |line: &str, k: usize, gap: usize| {
        let cells: Vec<_> = line.split(',').collect();
        let output = if (gap..gap + 20).contains(&k) { "" } else { cells[3] };
        format!("{},{output}", cells[2])
    };
    let row = |(k, line): (usize, &str)| {
        format!("{:.2},{},{}\n", k as f64 * 0.01, cells(line, k, 130), cells(line, k, 230))
    };
    let header = "time_s,a.input,a.output,b.input,b.output\n".to_owned();
    let log: String = stepping("", 400, 1.0).lines().enumerate().map(row).collect();
    let joints = Reading::of(header + &log).fill(0.05).joints();
    let settings = Settings { low_pass: None, ..Settings::of(Method::TWO_LINE) };
    let estimates: Vec<JointEstimate> = estimate_joints(&joints, &settings, || (), &Threads)
        .into_iter()
        .map(Result::unwrap)
        .collect();
    let pairs = joints.iter().zip(&estimates);
    let both: Vec<_> = pairs.map(|(joint, estimate)| EstimatedJoint { joint, estimate }).collect();
    for (place, joint) in both.iter().enumerate() {
        let alone = delays_in_time(&[*joint], 0);
        assert!(alone.len() > 100, "{alone:?}");
        assert_eq!(delays_in_time(&both, place), alone, "joint {}", joint.joint.name);
    }
}

/// Time and delay of every sample that has a delay, of the joint in column `joint`.
fn delays_in_time(joints: &[EstimatedJoint<'_>], joint: usize) -> Vec<(String, String)> {
    let mut bytes = Vec::new();
    write_delays(joints, &mut bytes).unwrap();
    let mut table = csv::Reader::from_reader(bytes.as_slice());
    let rows = table.records().map(Result::unwrap);
    rows.map(|row| (row[2].to_owned(), row[3 + joint].to_owned()))
        .filter(|(_, tau)| !tau.is_empty())
        .collect()
}
