//! Measured logs of real machines, read with options alone. They are not part of this
//! project: the folder that holds them is `TAUSCOPE_REAL_LOGS`, or `../shared/data`.

use std::path::Path;
use std::process::Command;

use serde::Deserialize;
use tauscope::delay::delay_scan;

use crate::real::log;

#[derive(Deserialize)]
struct Row {
    joint: String,
    trial: String,
    i: usize,
    q: Option<f64>,
    delta_s: Option<f64>,
    verdict: String,
}

/// The decisions of Algorithm 1 with these options.
fn decisions(log: &Path, options: &str) -> Vec<Row> {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("decisions.csv");
    let output = Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .args(["estimate", "--method", "two-line", "--quiet", "--keep-first-last", "--decisions"])
        .arg(&table)
        .arg(log)
        .args(options.split(' '))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    csv::Reader::from_path(&table).unwrap().deserialize().map(Result::unwrap).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn the_arm_of_an_excavator_starts_late_and_later_at_low_duty() {
    let Some(log) = log("excavator_full_arm_single.csv") else { return };
    let options = "--joint arm=u_duty_pct:angle_deg --beta 2 --max-delay 100";
    let rows = decisions(&log, options);
    let starts: Vec<_> = rows.iter().filter(|row| row.i == 1).collect();
    assert_eq!(starts.len(), 28);
    assert!(starts.iter().all(|row| row.verdict == "accepted"));
    // Motion begins 0.15 s to 0.8 s after the valve was told to; the lag adds to that.
    let delay = |row: &&Row| row.delta_s.unwrap();
    assert!(starts.iter().map(delay).all(|delay| (0.15..1.2).contains(&delay)));
    let at = |duty: &str| {
        let of_duty = starts.iter().filter(|row| row.trial.contains(duty));
        median(of_duty.map(delay).collect())
    };
    assert!(at("-40-") > at("-100-") + 0.2, "{} {}", at("-40-"), at("-100-"));
}

#[test]
fn the_cylinders_of_a_model_excavator_start_within_a_quarter_second() {
    let Some(log) = log("excavator_rc_steps.csv") else { return };
    let options = "--joint boom=u_boom_duty:y_boom --joint stick=u_stick_duty:y_stick \
                   --joint bucket=u_bucket_duty:y_bucket --trial run --resample 0.02 --fill 2 \
                   --max-delay 30 --beta 2";
    let rows = decisions(&log, options);
    assert_eq!(rows.len(), 9, "one step in each run, of the joint it is named after");
    assert!(rows.iter().all(|row| row.verdict == "accepted"));
    assert!(rows.iter().all(|row| (0.1..0.25).contains(&row.delta_s.unwrap())));
    assert!(rows.iter().any(|row| row.joint == "boom"));
}

#[derive(Deserialize)]
struct Label {
    stroke: String,
    k_onset_twoline: f64,
}

#[test]
fn a_rotary_actuator_breaks_away_where_its_labels_say() {
    let Some(log) = log("rotary_hydraulic_strokes.csv") else { return };
    let options = "--trial stroke --joint rotary=p_drive_cnt:angle_cnt --sample-period 0.004 \
                   --min-step 4000 --beta 1 --passband none --max-delay 40";
    let rows = decisions(&log, options);
    let labels = log.with_file_name("rotary_hydraulic_labels.csv");
    let labels: Vec<Label> =
        csv::Reader::from_path(labels).unwrap().deserialize().map(Result::unwrap).collect();
    let error = |row: &Row| {
        let label = labels.iter().find(|label| label.stroke == row.trial)?;
        // Labels count samples from 0.
        Some(row.q? - 1.0 - label.k_onset_twoline)
    };
    let first = rows.iter().filter(|row| row.i == 1 && row.verdict == "accepted");
    let errors: Vec<f64> = first.filter_map(error).collect();
    assert_eq!(errors.len(), 120);
    let mean = errors.iter().sum::<f64>() / 120.0;
    let spread = (errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / 119.0).sqrt();
    assert!(mean.abs() < 3.0 && spread < 2.5, "mean {mean}, spread {spread}");
}

/// The whole delay that explains a table's output best, from its columns.
fn scanned(log: &Path, input: usize, output: usize) -> usize {
    let mut table = csv::Reader::from_path(log).unwrap();
    let rows: Vec<Vec<f64>> = table.deserialize().map(Result::unwrap).collect();
    let column = |index: usize| rows.iter().map(|row| row[index]).collect::<Vec<_>>();
    let errors = delay_scan(&column(input), &column(output), 10);
    (0..errors.len()).min_by(|a, b| errors[*a].total_cmp(&errors[*b])).unwrap()
}

/// The dead time of `estimate` and its interval, seconds, of a joint given as for `--joint`.
fn dead_time(log: &Path, joint: &str) -> [f64; 3] {
    let output = Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .args(["estimate", "--quiet", "--format=json", "--joint", joint])
        .arg(log)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let dead_time = &found["joints"][0]["dead_time"];
    ["value_s", "low_s", "high_s"].map(|key| dead_time[key].as_f64().unwrap())
}

/// The textbook's three samples hold the one that any sampled system takes.
#[test]
fn sales_follow_their_leading_indicator_after_three_months() {
    let Some(log) = log("bj_sales_seriesM.csv") else { return };
    assert_eq!(scanned(&log, 1, 2), 3);
    let [value, low, high] = dead_time(&log, "sales=lead:sales");
    assert!((1.9..2.1).contains(&value) && low > 1.8 && high < 2.2, "{value}, {low} to {high}");
}

#[test]
fn carbon_dioxide_follows_the_gas_after_three_samples() {
    let Some(log) = log("gas_furnace_seriesJ.csv") else { return };
    assert_eq!(scanned(&log, 1, 2), 3);
    let [value, low, high] = dead_time(&log, "co2=gas_rate:co2_pct");
    assert!((18.0..=27.0).contains(&value), "{value}");
    assert!(low < 20.0 && 18.0 < high && high - low < 20.0, "{low} to {high}");
}
