//! Models of measured joints: effects that are known to be there are found. The data are not
//! part of this project: the folder that holds them is `TAUSCOPE_REAL_LOGS`, or
//! `../shared/data`.

use std::process::Command;

use serde_json::Value;

use crate::real::log;
use crate::sample::size;

fn parameter(revision: &Value, name: &str) -> f64 {
    revision["parameters"][name]["value"].as_f64().unwrap()
}

/// The sidecar of the log: dead bands of 43.5 % out and 45.5 % in (by another fit 40.2 and
/// 36.0 %), and each stroke goes from stop to stop.
#[test]
fn dead_band_and_stops_of_an_excavator_are_found() {
    let Some(log) = log("excavator_full_arm_single.csv") else { return };
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .args(["improve", "--quiet", "--format", "json", "--max-effects", "3", "--write"])
        .arg(folder.path().join("model.toml"))
        .arg(log)
        .args(["--joint", "arm=u_duty_pct:angle_deg"])
        .args(["--effects", "dead_band,input_saturation,end_stop"])
        .args(size(&["--resample", "0.03"][..], &[]))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let revisions = found["joints"][0]["revisions"].as_array().unwrap();
    let last = revisions.last().unwrap();
    let error = |revision: &Value| revision["error"]["validation"]["rmse"].as_f64().unwrap();
    let ladder: Vec<f64> = revisions.iter().map(error).collect();
    assert!(ladder.windows(2).all(|pair| pair[1] < pair[0]), "{ladder:?}");
    assert!(ladder.last().unwrap() < &(0.5 * ladder[0]), "{ladder:?}");
    let (inward, outward) =
        (parameter(last, "dead_band.lower"), parameter(last, "dead_band.upper"));
    assert!(
        (-48.0..-37.0).contains(&inward) && (34.0..45.0).contains(&outward),
        "{inward} {outward}"
    );
    // In and out differ: the direction is seen.
    assert!(-inward - outward > 2.0, "{inward} {outward}");
    let (low, high) = (parameter(last, "end_stop.low"), parameter(last, "end_stop.high"));
    assert!((low + 155.5).abs() < 1.5 && (high + 33.8).abs() < 0.5, "{low} {high}");
}
