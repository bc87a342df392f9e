//! The delay of every sample of every joint.

use std::collections::HashSet;
use std::io::Write;

use super::EstimatedJoint;
use super::decisions::tidy_seconds;
use crate::delay::DelayProfile;
use crate::experiment::Trial;

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
    for label in labels(joints) {
        let columns: Vec<_> = joints.iter().map(|joint| find(*joint, label)).collect();
        let trials = columns.iter().flatten().map(|(trial, _)| *trial);
        let Some(longest) = trials.max_by_key(|trial| trial.len()) else {
            continue;
        };
        for sample in 1..=longest.len() {
            writer.write_field(label)?;
            writer.write_field(sample.to_string())?;
            writer.write_field(tidy_seconds(longest.time_s(sample)).to_string())?;
            for column in &columns {
                let tau = column.and_then(|(_, profile)| profile.at(sample));
                writer.write_field(tau.map_or_else(String::new, |tau| tau.to_string()))?;
            }
            writer.write_record(None::<&[u8]>)?;
        }
    }
    Ok(writer.flush()?)
}

/// Labels of all trials, each once, in the order they first appear.
fn labels<'a>(joints: &[EstimatedJoint<'a>]) -> Vec<&'a str> {
    let mut seen = HashSet::new();
    let all = joints.iter().flat_map(|joint| &joint.joint.trials).map(Trial::label);
    all.filter(|label| seen.insert(*label)).collect()
}

/// The joint's trial with this label, and its delays.
fn find<'a>(joint: EstimatedJoint<'a>, label: &str) -> Option<(&'a Trial, &'a DelayProfile)> {
    let trials = joint.joint.trials.iter().zip(&joint.estimate.trials);
    let mut named = trials.filter(|(trial, _)| trial.label() == label);
    let (trial, result) = named.next()?;
    Some((trial, &result.as_ref().ok()?.profile))
}
