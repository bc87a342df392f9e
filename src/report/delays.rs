//! The delay of every sample of every joint.

use std::collections::HashSet;
use std::io::Write;

use super::table::Cell;
use super::{DataTable, EstimatedJoint, Kind};
use crate::delay::DelayProfile;
use crate::experiment::Trial;
use crate::numerics::to_nanoseconds;

/// Writes `trial,sample,time_s,<joint>.tau…` as CSV: a row per sample, delays in samples,
/// empty where none was recorded.
///
/// # Errors
/// When `out` cannot be written.
pub fn write_delays(joints: &[EstimatedJoint<'_>], out: impl Write) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    let taus = joints.iter().map(|joint| format!("{}.tau", joint.joint.name));
    let header = ["trial", "sample", "time_s"].into_iter().map(str::to_owned).chain(taus);
    writer.write_record(header)?;
    for run in runs(joints) {
        let columns: Vec<_> = joints.iter().map(|joint| find(*joint, run)).collect();
        let trials = columns.iter().flatten().map(|(trial, _)| *trial);
        let Some(longest) = trials.max_by_key(|trial| trial.len()) else { continue };
        for sample in 1..=longest.len() {
            writer.write_field(run.label())?;
            writer.write_field(sample.to_string())?;
            writer.write_field(to_nanoseconds(longest.logged_time_s(sample)).to_string())?;
            for column in &columns {
                let tau = column.and_then(|(_, profile)| profile.at(sample));
                writer.write_field(tau.map_or_else(String::new, |tau| tau.to_string()))?;
            }
            writer.write_record(None::<&[u8]>)?;
        }
    }
    Ok(writer.flush()?)
}

/// The delays that [`write_delays`] writes, as a table with types.
pub(crate) fn delay_table(joints: &[EstimatedJoint<'_>]) -> DataTable {
    let taus: Vec<_> = joints.iter().map(|joint| format!("{}.tau", joint.joint.name)).collect();
    let first = [("trial", Kind::Text), ("sample", Kind::Whole), ("time_s", Kind::Real)];
    let mut table = DataTable::new(
        first.into_iter().chain(taus.iter().map(|tau| (tau.as_str(), Kind::Samples))),
    );
    for run in runs(joints) {
        let columns: Vec<_> = joints.iter().map(|joint| find(*joint, run)).collect();
        let trials = columns.iter().flatten().map(|(trial, _)| *trial);
        let Some(longest) = trials.max_by_key(|trial| trial.len()) else { continue };
        for sample in 1..=longest.len() {
            let time_s = to_nanoseconds(longest.logged_time_s(sample));
            let delays =
                columns.iter().map(|column| column.and_then(|(_, profile)| profile.at(sample)));
            let mut cells =
                vec![Cell::Text(run.label()), Cell::Whole(sample), Cell::Real(Some(time_s))];
            cells.extend(delays.map(Cell::Real));
            table.push_cells(cells);
        }
    }
    table
}

/// All trials, each once, in the order they first appear. Where joints were split at
/// gaps of their own, parts of one name that start apart are different trials.
fn runs<'a>(joints: &[EstimatedJoint<'a>]) -> Vec<&'a Trial> {
    let mut seen = HashSet::new();
    let all = joints.iter().flat_map(|joint| &joint.joint.trials);
    all.filter(|trial| seen.insert(key(trial))).collect()
}

/// What identifies a run: name, start and sample period.
fn key(trial: &Trial) -> (&str, u64, u64) {
    (trial.label(), trial.time_s(1).to_bits(), trial.period().seconds().to_bits())
}

/// The joint's share of `run`, and its delays.
fn find<'a>(joint: EstimatedJoint<'a>, run: &Trial) -> Option<(&'a Trial, &'a DelayProfile)> {
    let trials = joint.joint.trials.iter().zip(&joint.estimate.trials);
    let mut same = trials.filter(|(trial, _)| key(trial) == key(run));
    let (trial, result) = same.next()?;
    Some((trial, &result.as_ref().ok()?.profile))
}
