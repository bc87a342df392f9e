//! The files: a log that can be read back, and the truth beside it.

use std::io::Write;

use crate::simulate::Recorded;
use crate::truth::StepTruth;

/// Decimals of the time in seconds: a nanosecond keeps any sample rate uniform.
const TIME_DECIMALS: usize = 9;

/// Decimals of the output in its unit: far below any noise, and short.
const OUTPUT_DECIMALS: usize = 6;

/// Decimals of what the truth derives from other numbers.
const TRUTH_DECIMALS: usize = 9;

/// What stands in a column of the truth.
type Cell = fn(&StepTruth) -> String;

/// The columns of the truth, and what stands in them.
const TRUTH_COLUMNS: [(&str, Cell); 11] = [
    ("joint", |step| step.joint.clone()),
    ("trial", |step| step.trial.clone()),
    ("i", |step| step.i.to_string()),
    ("p", |step| step.p.to_string()),
    ("input_before", |step| step.input_before.to_string()),
    ("input_after", |step| step.input_after.to_string()),
    ("hold_samples", |step| step.hold_samples.to_string()),
    ("delay_samples", |step| decimal(step.delay_samples, TRUTH_DECIMALS)),
    ("delay_s", |step| step.delay_s.to_string()),
    ("slope_change", |step| decimal(step.slope_change, TRUTH_DECIMALS)),
    ("overtaken", |step| step.overtaken.to_string()),
];

/// Writes the records of joints as one CSV table, as long as the first one.
///
/// The columns are `time_s`, then `<joint>.input [unit]` and `<joint>.output [unit]`
/// for each joint. The time is rounded to 1e-9 s, the output to 1e-6 of its unit;
/// the input reads back exactly.
///
/// # Errors
/// What writing to `out` gives.
pub fn write_log(joints: &[Recorded], out: impl Write) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_writer(out);
    let mut header = vec!["time_s".to_owned()];
    header.extend(joints.iter().flat_map(column_names));
    table.write_record(header)?;
    if let Some(first) = joints.first() {
        for index in 0..first.output.len() {
            let mut row = vec![decimal(index as f64 * first.period_s, TIME_DECIMALS)];
            row.extend(joints.iter().flat_map(|joint| cells(joint, index)));
            table.write_record(row)?;
        }
    }
    table.flush()?;
    Ok(())
}

/// Writes the truth as a CSV table, one row per step.
///
/// The columns are `joint`, `trial`, `i`, `p`, `input_before`, `input_after`,
/// `hold_samples`, `delay_samples`, `delay_s`, `slope_change`, `overtaken`.
/// `delay_samples` and `slope_change` are rounded to 1e-9; the other numbers read
/// back exactly.
///
/// # Errors
/// What writing to `out` gives.
pub fn write_truth(truth: &[StepTruth], out: impl Write) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record(TRUTH_COLUMNS.map(|(name, _)| name))?;
    for step in truth {
        table.write_record(TRUTH_COLUMNS.map(|(_, cell)| cell(step)))?;
    }
    table.flush()?;
    Ok(())
}

/// Names of the columns of one joint; without brackets where a unit is empty.
fn column_names(joint: &Recorded) -> [String; 2] {
    [("input", &joint.input_unit), ("output", &joint.output_unit)].map(|(signal, unit)| {
        let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
        format!("{}.{signal}{unit}", joint.name)
    })
}

/// Input and output of one row; empty beyond the end of the record.
fn cells(joint: &Recorded, index: usize) -> [String; 2] {
    let input = joint.input.get(index).map(f64::to_string);
    let output = joint.output.get(index).map(|value| decimal(*value, OUTPUT_DECIMALS));
    [input.unwrap_or_default(), output.unwrap_or_default()]
}

/// `value` rounded to `decimals`, without zeros at its end or a negative zero.
fn decimal(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DelayLaw, InputSpec, JointSpec, PlantSpec, Simulated, simulate};

    fn made() -> Simulated {
        let input = InputSpec::Steps { steps: vec![(2, 0.5)], initial: 0.0 };
        let delay = DelayLaw::Constant { seconds: 0.29 };
        let joint = JointSpec { start: 1.0 / 3.0, ..JointSpec::new("arm", input, delay) };
        simulate(&PlantSpec::new(0, 0.03, vec![joint])).unwrap()
    }

    fn text(write: impl FnOnce(&mut Vec<u8>) -> Result<(), csv::Error>) -> String {
        let mut bytes = Vec::new();
        write(&mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn a_log_has_native_columns_and_short_numbers() {
        let expected = "time_s,arm.input [V],arm.output [deg]\n\
             0,0,0.333333\n0.01,0.5,0.333333\n0.02,0.5,0.333333\n";
        assert_eq!(text(|out| write_log(&made().joints, out)), expected);
    }

    #[test]
    fn the_truth_has_a_row_per_step() {
        let expected = "joint,trial,i,p,input_before,input_after,hold_samples,delay_samples,\
             delay_s,slope_change,overtaken\narm,1,1,2,0,0.5,2,29,0.29,0.05,false\n";
        assert_eq!(text(|out| write_truth(&made().truth, out)), expected);
    }

    #[test]
    fn decimals_are_rounded_and_short() {
        let cases = [(0.07 + 1e-17, "0.07"), (100.0, "100"), (-1e-9, "0"), (-2.5, "-2.5")];
        for (value, expected) in cases {
            assert_eq!(decimal(value, 6), expected);
        }
    }
}
