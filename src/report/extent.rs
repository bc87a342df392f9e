//! What was measured of each joint, as a table.

use super::text_table::TextTable;
use crate::experiment::{Joint, Trial};
use crate::wording::{measure, range_text};

/// A row per joint: how long it was measured, and in which range.
pub(crate) fn extent_table(joints: &[Joint]) -> String {
    let header = ["joint", "input", "output", "trials", "samples", "period", "duration"];
    let row = |joint: &Joint| {
        let trials = || joint.trials.iter();
        let samples: usize = trials().map(Trial::len).sum();
        let mut periods: Vec<String> = trials().map(|trial| trial.period().to_string()).collect();
        periods.dedup();
        let period = match periods.as_slice() {
            [one] => one.clone(),
            _ => "several".to_owned(),
        };
        let duration: f64 =
            trials().map(|trial| trial.len() as f64 * trial.period().seconds()).sum();
        [
            joint.name.clone(),
            range_text(trials().flat_map(Trial::input).copied(), joint.input_unit.as_deref()),
            range_text(trials().flat_map(Trial::output).copied(), joint.output_unit.as_deref()),
            joint.trials.len().to_string(),
            samples.to_string(),
            period,
            measure(duration, Some("s")),
        ]
    };
    format!("{}\n", TextTable::of(header, &[3, 4, 5, 6], joints.iter().map(row)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::SamplePeriod;

    #[test]
    fn a_joint_has_its_ranges_and_its_time_over_all_trials() {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = |label: &str, top: f64| {
            let input: Vec<f64> = (0..100).map(|k| if k < 50 { -1.0 } else { 2.5 }).collect();
            let output: Vec<f64> = (0..100).map(|k| top * f64::from(k) / 99.0).collect();
            Trial::new(label, 0.0, period, input, output).unwrap()
        };
        let joint = Joint::new("boom", [trial("1", 10.0), trial("2", 30.0)]).with_units("V", "deg");
        let text = extent_table(&[joint]);
        let row = text.lines().find(|line| line.contains("boom")).unwrap();
        let cells: Vec<&str> =
            row.trim_matches('│').split("  ").map(str::trim).filter(|c| !c.is_empty()).collect();
        assert_eq!(cells, ["boom", "-1 to 2.5 V", "0 to 30 deg", "2", "200", "0.01 s", "2 s"]);
    }
}
