//! `estimate --follow`: decisions on a log that still grows, as its steps complete.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context as _, anyhow, bail};
use serde::Serialize;
use tauscope::batch::{JointEstimate, estimate_joints, with_threads};
use tauscope::delay::{Settings, check_growing, settled};
use tauscope::experiment::{Experiment, Joint};
use tauscope::report::{DecisionRow, EstimatedJoint, decision_rows, step_line};

use super::args::{Args, FollowArgs};
use crate::cli::fitting::Format;
use crate::cli::interrupt::Interrupt;
use crate::cli::progress::Verbosity;
use crate::cli::record::Contents;
use crate::cli::stream::Stream;
use crate::cli::terminal::{self, message};
use crate::cli::with_causes;

/// Shortest time between two looks at the log.
const PAUSE: Duration = Duration::from_millis(200);

/// Rest after each look, as a multiple of the time it took: so much of the processor is left
/// to others, however long the log is.
const REST: u32 = 4;

/// Follows the log until it rests or somebody presses Ctrl-C; what was told of it.
pub(super) fn follow(args: &Args, runs: &[Settings], stream: &Stream) -> anyhow::Result<Told> {
    let [settings] = runs else { bail!("--method: only one method at a time can be followed") };
    check_growing(settings).context("--follow")?;
    if args.algorithm.automatic().any() {
        bail!("--follow: `auto` looks at the whole record; give a number");
    }
    let path = args.data.only_file().context("--follow")?;
    let mut log = GrowingLog::of(&path)?;
    let interrupt = Interrupt::watch("at the log's end; Ctrl-C again ends at once");
    let mut told = Told::default();
    let work = || watch(args, settings, stream, &mut log, interrupt, &mut told);
    with_threads(args.output.threads, work)
        .map_err(|error| anyhow!("threads cannot be started: {error}"))??;
    Ok(told)
}

fn watch(
    args: &Args,
    settings: &Settings,
    stream: &Stream,
    log: &mut GrowingLog,
    interrupt: Interrupt,
    told: &mut Told,
) -> anyhow::Result<()> {
    let FollowArgs { idle, .. } = args.follow;
    let mut rests_since = Instant::now();
    loop {
        let start = Instant::now();
        if log.catch_up()? {
            rests_since = start;
            told.tell(args, settings, stream, log)?;
        } else if idle.is_some_and(|idle| rests_since.elapsed().as_secs_f64() >= idle) {
            return Ok(());
        }
        if interrupt.sleep(PAUSE.max(REST * start.elapsed())) {
            return Ok(());
        }
    }
}

/// The whole lines of a log that somebody else still writes.
struct GrowingLog {
    path: PathBuf,
    /// Bytes of the log that were read.
    read: u64,
    /// What was read behind the last whole line.
    rest: Vec<u8>,
    /// Holds the whole lines, in a file with the log's name.
    folder: tempfile::TempDir,
}

impl GrowingLog {
    fn of(path: &Path) -> anyhow::Result<Self> {
        let folder = tempfile::tempdir().context("no temporary folder can be made")?;
        Ok(Self { path: path.to_owned(), read: 0, rest: Vec::new(), folder })
    }

    /// The file with the whole lines.
    fn lines(&self) -> PathBuf {
        self.folder.path().join(self.path.file_name().unwrap_or_default())
    }

    /// Takes in what has come since; whether that made a line whole. A log that is not there
    /// yet may come.
    fn catch_up(&mut self) -> anyhow::Result<bool> {
        let name = self.path.display();
        let mut file = match File::open(&self.path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound && self.read == 0 => {
                return Ok(false);
            }
            opened => opened.with_context(|| format!("{name}: cannot be read"))?,
        };
        let length = file.metadata().with_context(|| format!("{name}: cannot be read"))?.len();
        if length < self.read {
            bail!("{name}: it became shorter while it was followed; run the command again");
        }
        let before = self.rest.len();
        file.seek(SeekFrom::Start(self.read))
            .and_then(|_| file.take(length - self.read).read_to_end(&mut self.rest))
            .with_context(|| format!("{name}: cannot be read"))?;
        self.read += (self.rest.len() - before) as u64;
        let whole = self.rest.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        if whole == 0 {
            return Ok(false);
        }
        let mut lines = File::options().create(true).append(true).open(self.lines())?;
        lines.write_all(self.rest.get(..whole).unwrap_or_default())?;
        self.rest.drain(..whole);
        Ok(true)
    }

    /// What its whole lines say; joints that say nothing yet are left out.
    fn experiment(&self, args: &Args) -> anyhow::Result<Experiment> {
        let mut experiment = args.data.read_only(&self.lines())?;
        for source in &mut experiment.sources {
            source.path.clone_from(&self.path);
        }
        Ok(experiment)
    }

    /// An error on its lines, as one on the log.
    fn named(&self, error: &str) -> String {
        error.replace(&self.lines().display().to_string(), &self.path.display().to_string())
    }
}

type DelayAndVerdict = (Option<f64>, String);

/// What was told of a log so far.
#[derive(Default)]
pub(super) struct Told {
    /// Per joint and trial, the delay and the verdict of each step.
    steps: BTreeMap<(String, String), Vec<DelayAndVerdict>>,
    /// What could not be read, last time.
    failures: Vec<String>,
}

/// A decision on a line of its own.
#[derive(Serialize)]
struct StepJson<'a> {
    schema: &'static str,
    #[serde(flatten)]
    row: &'a DecisionRow<'a>,
}

impl Told {
    /// Tells what is new.
    fn tell(
        &mut self,
        args: &Args,
        settings: &Settings,
        stream: &Stream,
        log: &GrowingLog,
    ) -> anyhow::Result<()> {
        let experiment = log.experiment(args)?;
        self.tell_failures(args, &experiment, log);
        let estimates = estimate_joints(&experiment.joints, settings, || ());
        let pairs = experiment.joints.iter().zip(&estimates);
        let pairs = pairs.filter_map(|(joint, estimate)| Some((joint, estimate.as_ref().ok()?)));
        let settled: Vec<(Joint, JointEstimate)> = pairs
            .filter_map(|(joint, estimate)| settled_joint(joint, estimate, settings))
            .collect();
        for (joint, estimate) in &settled {
            self.tell_joint(args.output.format, EstimatedJoint { joint, estimate })?;
        }
        let joints: Vec<_> =
            settled.iter().map(|(joint, estimate)| EstimatedJoint { joint, estimate }).collect();
        if joints.is_empty() {
            return Ok(());
        }
        let contents = Contents {
            also: &[],
            joints: &joints,
            settings,
            sources: &experiment.sources,
            reading: &experiment.options,
            models: &[],
            revisions: &[],
            detail: args.output.detail,
        };
        stream.send(&contents, None)
    }

    fn tell_joint(&mut self, format: Format, estimated: EstimatedJoint<'_>) -> anyhow::Result<()> {
        let EstimatedJoint { joint, estimate } = estimated;
        let trials = joint.trials.iter().zip(estimate.estimated());
        let decisions = trials.flat_map(|(t, found)| found.decisions.iter().map(move |d| (t, d)));
        for ((trial, decision), (_, row)) in decisions.zip(decision_rows(estimated)) {
            let key = (joint.name.clone(), trial.label().to_owned());
            let steps = self.steps.entry(key).or_default();
            if decision.number <= steps.len() {
                continue;
            }
            steps.push((row.delta, row.verdict.clone()));
            match format {
                Format::Text => {
                    terminal::print(&(step_line(joint, trial, decision) + "\n"))?;
                }
                Format::Json => {
                    terminal::print_json(&StepJson { schema: "tauscope/step/1", row: &row })?;
                }
            }
        }
        Ok(())
    }

    /// Says what cannot be read, when that has changed: more of the log may mend it.
    fn tell_failures(&mut self, args: &Args, experiment: &Experiment, log: &GrowingLog) {
        let failures = experiment.failures.iter();
        let failures: Vec<_> = failures.map(|f| log.named(&with_causes(&f.error))).collect();
        if args.output.verbosity() == Verbosity::Normal && failures != self.failures {
            for failure in &failures {
                message("waiting", failure);
            }
        }
        self.failures = failures;
    }

    /// Says which decisions the whole log changes.
    pub(super) fn tell_changes(&self, joints: &[EstimatedJoint<'_>]) {
        for (_, row) in joints.iter().flat_map(|joint| decision_rows(*joint)) {
            let key = (row.joint.to_owned(), row.trial.to_owned());
            let told = self.steps.get(&key).and_then(|steps| steps.get(row.i.checked_sub(1)?));
            let Some((delta, verdict)) = told else { continue };
            if (*delta, verdict) != (row.delta, &row.verdict) {
                let (name, step, now) = (row.joint, row.i, &row.verdict);
                message("note", &format!("{name}, step {step}: the whole log changes it to {now}"));
            }
        }
    }
}

/// What of a joint stays as it is; `None` where nothing does yet.
fn settled_joint(
    joint: &Joint,
    estimate: &JointEstimate,
    settings: &Settings,
) -> Option<(Joint, JointEstimate)> {
    let last = joint.trials.len().checked_sub(1)?;
    let (mut trials, mut estimates) = (Vec::new(), Vec::new());
    for (index, (trial, found)) in joint.trials.iter().zip(&estimate.trials).enumerate() {
        let Ok(found) = found else { continue };
        // A trial that another one follows has come whole.
        let kept = match index {
            _ if index < last => Some((trial.clone(), found.clone())),
            _ => settled(trial, found, settings).ok()?,
        };
        if let Some((trial, found)) = kept {
            trials.push(trial);
            estimates.push(Ok(found));
        }
    }
    let is_there = !trials.is_empty();
    let estimate = JointEstimate { trials: estimates, ..estimate.clone() };
    is_there.then(|| (Joint { trials, ..joint.clone() }, estimate))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_whole_lines_are_taken_from_a_log() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let mut log = GrowingLog::of(&path).unwrap();
        assert!(!log.catch_up().unwrap(), "there is no log yet");
        let mut file = File::create(&path).unwrap();
        let mut written = |text: &str| {
            file.write_all(text.as_bytes()).unwrap();
            (log.catch_up().unwrap(), std::fs::read_to_string(log.lines()).unwrap_or_default())
        };
        assert_eq!(written("a,b"), (false, String::new()));
        assert_eq!(written("\n1,2\n3,"), (true, "a,b\n1,2\n".to_owned()));
        assert_eq!(written("4"), (false, "a,b\n1,2\n".to_owned()));
        assert_eq!(written("5\n"), (true, "a,b\n1,2\n3,45\n".to_owned()));
        std::fs::write(&path, "a").unwrap();
        assert!(log.catch_up().unwrap_err().to_string().contains("became shorter"));
    }
}
