//! The delay of every sample of every joint.

use std::collections::HashSet;
use std::io::Write;

use serde_json::Value;

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
    let header = ["trial", "sample", "time_s"].into_iter().map(str::to_owned);
    writer.write_record(header.chain(joints.iter().map(tau)))?;
    for Row { trial, sample, time_s, delays } in rows(joints) {
        writer.write_field(trial)?;
        writer.write_field(sample.to_string())?;
        writer.write_field(time_s.to_string())?;
        for delay in delays {
            writer.write_field(delay.map_or_else(String::new, |tau| tau.to_string()))?;
        }
        writer.write_record(None::<&[u8]>)?;
    }
    Ok(writer.flush()?)
}

/// The delays that [`write_delays`] writes, as a table with types.
pub(crate) fn delay_table(joints: &[EstimatedJoint<'_>]) -> DataTable {
    let taus: Vec<_> = joints.iter().map(tau).collect();
    let first = [("trial", Kind::Text), ("sample", Kind::Whole), ("time_s", Kind::Real)];
    let taus = taus.iter().map(|tau| (tau.as_str(), Kind::Samples));
    let mut table = DataTable::new(first.into_iter().chain(taus));
    for Row { trial, sample, time_s, delays } in rows(joints) {
        let first = [Value::from(trial), sample.into(), time_s.into()];
        table.push_cells(first.into_iter().chain(delays.into_iter().map(Value::from)));
    }
    table
}

/// The column of a joint.
fn tau(joint: &EstimatedJoint<'_>) -> String {
    format!("{}.tau", joint.joint.name)
}

/// A sample of a trial, and the delay of each joint there.
struct Row<'a> {
    trial: &'a str,
    sample: usize,
    time_s: f64,
    delays: Vec<Option<f64>>,
}

/// All samples of all trials.
fn rows<'a>(joints: &[EstimatedJoint<'a>]) -> impl Iterator<Item = Row<'a>> {
    runs(joints).into_iter().flat_map(|run| {
        let columns: Vec<_> = joints.iter().map(|joint| find(*joint, run)).collect();
        let trials = columns.iter().flatten().map(|(trial, _)| *trial);
        let longest = trials.max_by_key(|trial| trial.len());
        let samples = longest.into_iter().flat_map(|longest| {
            (1..=longest.len()).map(|sample| (sample, longest.logged_time_s(sample)))
        });
        samples.map(move |(sample, time_s)| Row {
            trial: run.label(),
            sample,
            time_s: to_nanoseconds(time_s),
            delays: columns.iter().map(|found| found.and_then(|(_, of)| of.at(sample))).collect(),
        })
    })
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
