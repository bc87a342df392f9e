//! The results that `--against` names.

use std::path::Path;

use anyhow::{Context as _, bail};

use super::estimates::Estimates;
use super::session::Session;
use crate::cli::args::{AgainstArgs, DataArgs, read};
use crate::delay::Settings;
use crate::report::EstimatedJoint;
use crate::report::difference::Against;
use crate::report::settings::settings_in_short;
use crate::study::OtherResult;

/// What is said of a file that is none of these.
const TAKES: &str = "`--against` takes the JSON of `estimate --format json`, a table of \
                     `estimate --decisions` as CSV, or a log";

/// What other methods found in the logs of `session`, and then what `args` names.
pub(crate) fn others(
    session: &Session<'_>,
    (args, data): (&AgainstArgs, &DataArgs),
    asked: &[Settings],
    results: &[Estimates],
) -> anyhow::Result<Vec<OtherResult>> {
    let joints = &session.experiment.joints;
    let methods = asked.iter().zip(results).skip(1).map(|(settings, estimates)| {
        let (name, words) = (settings.method.to_string(), settings_in_short(settings));
        Ok(OtherResult::of(name, words, joints, estimates))
    });
    let Some(first) = asked.first() else { return Ok(Vec::new()) };
    let files = args.against.iter().map(|path| {
        let read = other(session, data, first, path);
        read.with_context(|| format!("{}: {TAKES}", path.display()))
    });
    methods.chain(files).collect()
}

/// What is in `path`: an earlier result, or a log that is estimated as those of `session` were.
fn other(
    session: &Session<'_>,
    data: &DataArgs,
    settings: &Settings,
    path: &Path,
) -> anyhow::Result<OtherResult> {
    if path.is_dir() {
        bail!("this is a folder");
    }
    if let Some(result) = OtherResult::read(path)? {
        return Ok(result);
    }
    // A log is read again from its beginning.
    if path.metadata().is_ok_and(|found| !found.is_file()) {
        bail!(
            "a pipe can be read only once, and was read already to see what it is; write the log \
             to a file first"
        );
    }
    let experiment = read(&[path.to_owned()], &data.options()?)?;
    let settings_of_one = std::slice::from_ref(settings);
    let work = || session.estimates_of(&experiment.joints, settings_of_one).pop();
    let estimates = session.in_threads(work)?.unwrap_or_default();
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(OtherResult::of(name, settings_in_short(settings), &experiment.joints, &estimates))
}

/// How the decisions on `joints` differ from those of `others`.
///
/// # Errors
/// When a file has no step that is here, too.
pub(crate) fn compared<'a>(
    joints: &[EstimatedJoint<'a>],
    others: &'a [OtherResult],
) -> anyhow::Result<Vec<Against<'a>>> {
    let compared: Vec<_> = others.iter().map(|other| Against::of(joints, other)).collect();
    let has_steps =
        joints.iter().any(|joint| joint.estimate.estimated().any(|t| !t.decisions.is_empty()));
    if let Some(empty) = compared.iter().find(|against| has_steps && against.is_empty()) {
        let names = |names: &mut dyn Iterator<Item = &str>| names.collect::<Vec<_>>().join(", ");
        let here = names(&mut joints.iter().map(|joint| joint.joint.name.as_str()));
        let there = names(&mut empty.other.joints.iter().map(|joint| joint.joint.as_str()));
        bail!(
            "{}: none of its steps is in this log; compare results of one experiment (joints \
             here: {here}; there: {there})",
            empty.other.name
        );
    }
    Ok(compared)
}

/// What has no counterpart, in sentences. Joints of another result that are not here are only named
/// where all joints of the log are used.
pub(crate) fn left_over(against: &[Against<'_>], data: &DataArgs) -> Vec<String> {
    let has_all = data.has_all_joints();
    let of_one = |other: &Against<'_>| {
        let joints = other.note_on_joints().filter(|_| has_all);
        other.notes().into_iter().chain(joints).collect::<Vec<_>>()
    };
    against.iter().flat_map(of_one).collect()
}
