//! `estimate --follow`: decisions on a log that still grows, as its steps complete.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::batch::Threads;
use crate::delay::{InputKind, Settings, Verdict, check_growing, final_part};
use crate::experiment::{Experiment, Joint, ReadOptions, is_text};
use crate::report::decisions::step_line;
use crate::report::{EstimatedJoint, Recording, decision_rows};
use crate::study::{JointEstimate, estimate_each};
use anyhow::{Context as _, bail};
use serde::Serialize;
use serde_json::{Map, Value};

use super::args::{Args, FollowArgs};
use crate::cli::args::{Format, OwnSettings};
use crate::cli::console::{self, Interrupt, message};
use crate::cli::failure::said;
use crate::cli::output::of_delays;
use crate::cli::viewer::Stream;

/// Shortest time between two looks at the log.
const PAUSE: Duration = Duration::from_millis(200);

/// Rest after each look, as a multiple of the time it took: so much of the processor is left
/// to others, however long the log is.
const REST: u32 = 4;

/// Bytes by which a log is known again: a few rows, the times of which no other log has.
const TAIL: usize = 256;

/// Follows the log until it rests or somebody presses Ctrl-C; what was reported of it.
pub(crate) fn follow(args: &Args, runs: &[Settings], stream: &Stream) -> anyhow::Result<Reported> {
    let [settings] = runs else { bail!("--method: only one method at a time can be followed") };
    check_growing(settings).context("--follow")?;
    let settings = &as_it_grows(settings);
    let path = args.data.only_file().context("--follow")?;
    let mut log = Followed::of(&path, args)?;
    let interrupt = Interrupt::watch("at the log's end; Ctrl-C again ends at once");
    let mut reported = Reported::default();
    let work = || watch(args, settings, stream, &mut log, interrupt, &mut reported);
    args.output.run.in_threads(work)??;
    Ok(reported)
}

/// What the whole record decides is not known yet: each change of the input is a step.
fn as_it_grows(settings: &Settings) -> Settings {
    let input = InputKind::Steps;
    Settings { input, grows: true, ..settings.clone() }
}

fn watch(
    args: &Args,
    settings: &Settings,
    stream: &Stream,
    log: &mut Followed,
    interrupt: Interrupt,
    reported: &mut Reported,
) -> anyhow::Result<()> {
    let FollowArgs { idle, .. } = args.follow;
    let mut rests_since = Instant::now();
    loop {
        let start = Instant::now();
        if log.catch_up()? {
            rests_since = start;
            reported.report(args, settings, stream, log)?;
        } else if idle.is_some_and(|idle| rests_since.elapsed().as_secs_f64() >= idle) {
            return Ok(());
        }
        if interrupt.sleep(PAUSE.max(REST * start.elapsed())) {
            return Ok(());
        }
    }
}

/// A log that somebody else still writes.
struct Followed {
    path: PathBuf,
    options: ReadOptions,
    /// Bytes that there were at the last look, and the last of them.
    length: u64,
    tail: Vec<u8>,
}

impl Followed {
    fn of(path: &Path, args: &Args) -> anyhow::Result<Self> {
        Ok(Self {
            path: path.to_owned(),
            options: args.data.options()?,
            length: 0,
            tail: Vec::new(),
        })
    }

    /// Looks at what was appended since the last look, and at the end of what was there before; whether
    /// that may have made a row whole. A log that is not there yet may come.
    fn catch_up(&mut self) -> anyhow::Result<bool> {
        let name = self.path.display();
        let unread = || format!("{name}: cannot be read");
        // To open a pipe would wait for who writes into it.
        if self.length > 0 && self.path.metadata().is_ok_and(|found| !found.is_file()) {
            bail!("{name}: the file is gone; run the command again when it is there");
        }
        let mut file = match File::open(&self.path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound && self.length == 0 => {
                return Ok(false);
            }
            opened => opened.with_context(unread)?,
        };
        let length = file.metadata().with_context(unread)?.len();
        if length < self.length {
            bail!("{name}: it became shorter while it was followed; run the command again");
        }
        let (start, mut seen) = (self.length - self.tail.len() as u64, Vec::new());
        file.seek(SeekFrom::Start(start))
            .and_then(|_| file.take(length - start).read_to_end(&mut seen))
            .with_context(unread)?;
        // Another log under the name would be taken for more of this one.
        let Some(news) = seen.strip_prefix(self.tail.as_slice()) else {
            bail!("{name}: another log took its place while it was followed; run the command again")
        };
        let may_be_whole = news.contains(&b'\n') || !news.is_empty() && !is_text(&self.path);
        self.length = start + seen.len() as u64;
        self.tail = seen.split_off(seen.len().saturating_sub(TAIL));
        Ok(may_be_whole)
    }

    /// What its whole lines say, or all of it where it has none; joints that say nothing yet are left out.
    fn experiment(&self) -> Experiment {
        let mut options = self.options.clone();
        // What is reported of a text stands: nothing may depend on rows that are still to come.
        options.repair.as_it_stands |= is_text(&self.path);
        Experiment::read(std::slice::from_ref(&self.path), &options)
    }
}

type DelayAndVerdict = (Option<f64>, Verdict);

/// What was reported of a log so far.
#[derive(Default)]
pub(crate) struct Reported {
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
    row: &'a Map<String, Value>,
}

impl Reported {
    /// Reports what is new.
    fn report(
        &mut self,
        args: &Args,
        settings: &Settings,
        stream: &Stream,
        log: &Followed,
    ) -> anyhow::Result<()> {
        let experiment = log.experiment();
        self.say_failures(args, &experiment);
        let own = OwnSettings::of(&experiment.options)?;
        let of_joint = |joint: &Joint| own.of_joint(joint, settings);
        let estimates = estimate_each(&experiment.joints, of_joint, || (), &Threads);
        let pairs = experiment.joints.iter().zip(&estimates);
        let pairs = pairs.filter_map(|(joint, estimate)| Some((joint, estimate.as_ref().ok()?)));
        let settled: Vec<(Joint, JointEstimate)> =
            pairs.filter_map(|(joint, estimate)| settled_joint(joint, estimate)).collect();
        for (joint, estimate) in &settled {
            self.report_joint(args.output.run.format, EstimatedJoint { joint, estimate })?;
        }
        let joints: Vec<_> =
            settled.iter().map(|(joint, estimate)| EstimatedJoint { joint, estimate }).collect();
        if joints.is_empty() {
            return Ok(());
        }
        let detail = args.output.detail.of(&joints);
        let recording = of_delays("estimate", &experiment, (&joints, settings));
        stream.send(&Recording { detail, ..recording }, None)
    }

    fn report_joint(
        &mut self,
        format: Format,
        estimated: EstimatedJoint<'_>,
    ) -> anyhow::Result<()> {
        let joint = estimated.joint;
        let decisions = estimated.decisions().zip(decision_rows(estimated));
        for ((trial, _, decision), (_, row)) in decisions {
            let key = (joint.name.clone(), trial.label().to_owned());
            let steps = self.steps.entry(key).or_default();
            if decision.number <= steps.len() {
                continue;
            }
            steps.push((decision.delay(), decision.verdict()));
            match format {
                Format::Text => {
                    console::print(&(step_line(joint, trial, decision) + "\n"))?;
                }
                Format::Json => {
                    console::print_json(&StepJson { schema: "tauscope/step/1", row: &row })?;
                }
            }
        }
        Ok(())
    }

    /// Says what cannot be read, when that has changed: more of the log may mend it.
    fn say_failures(&mut self, args: &Args, experiment: &Experiment) {
        let failures = experiment.failures.iter();
        let failures: Vec<_> = failures.map(|f| said(&f.error)).collect();
        if failures != self.failures {
            for failure in &failures {
                args.output.run.verbosity().say("waiting", failure);
            }
        }
        self.failures = failures;
    }

    /// Says which decisions the whole log changes.
    pub(crate) fn say_changes(&self, joints: &[EstimatedJoint<'_>]) {
        let all = joints.iter().flat_map(|of| of.decisions().map(|found| (&of.joint.name, found)));
        for (name, (trial, _, decision)) in all {
            let key = (name.clone(), trial.label().to_owned());
            let step = decision.number;
            let before = self.steps.get(&key).and_then(|steps| steps.get(step.checked_sub(1)?));
            let Some(before) = before else { continue };
            let now = decision.verdict();
            if *before != (decision.delay(), now) {
                message(
                    "note",
                    &format!(
                        "{name}, step {step}: with the whole log the decision is \
                         {now}"
                    ),
                );
            }
        }
    }
}

/// What of a joint stays as it is; `None` where nothing does yet.
fn settled_joint(joint: &Joint, estimate: &JointEstimate) -> Option<(Joint, JointEstimate)> {
    let last = joint.trials.len().checked_sub(1)?;
    let (mut trials, mut estimates) = (Vec::new(), Vec::new());
    for (index, (trial, found)) in joint.trials.iter().zip(&estimate.trials).enumerate() {
        let Ok(found) = found else { continue };
        // A trial that another one follows has come whole.
        let kept = match index {
            _ if index < last => Some((trial.clone(), found.clone())),
            _ => final_part(trial, found, &estimate.settings).ok()?,
        };
        if let Some((trial, found)) = kept {
            trials.push(trial);
            estimates.push(Ok(found));
        }
    }
    let is_there = !trials.is_empty();
    let estimate = JointEstimate { trials: estimates, ..estimate.clone() };
    is_there.then(|| (Joint { trials: trials.into(), ..joint.clone() }, estimate))
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use super::*;

    /// What `estimate` is asked with this log.
    fn asked(log: &Path) -> Args {
        #[derive(clap::Parser)]
        struct Line {
            #[command(flatten)]
            args: Args,
        }
        let line: Line = clap::Parser::parse_from(["estimate".as_ref(), log.as_os_str()]);
        line.args
    }

    /// Rows of the only trial that the whole lines of a log with these bytes have.
    fn rows_of(bytes: &[u8]) -> usize {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        std::fs::write(&path, bytes).unwrap();
        let log = Followed::of(&path, &asked(&path)).unwrap();
        log.experiment().joints.first().map_or(0, |joint| joint.trials[0].len())
    }

    #[test]
    fn what_was_appended_is_seen_once_and_a_change_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let mut log = Followed::of(&path, &asked(&path)).unwrap();
        assert!(!log.catch_up().unwrap(), "there is no log yet");
        let mut file = File::create(&path).unwrap();
        for (text, is_whole) in [
            ("t,a.inp", false),
            ("ut,a.output\n", true),
            ("", false),
            ("0,1,2\n1,1,", true),
            ("3", false),
            ("\n", true),
        ] {
            file.write_all(text.as_bytes()).unwrap();
            assert_eq!(log.catch_up().unwrap(), is_whole, "{text:?}");
        }
        std::fs::write(&path, "t,a.input,a.output\n0,2,2\n1,1,3\n2,1,3\n").unwrap();
        assert!(log.catch_up().unwrap_err().to_string().contains("another log took its place"));
        std::fs::write(&path, "a").unwrap();
        assert!(log.catch_up().unwrap_err().to_string().contains("became shorter"));
    }

    #[test]
    fn what_is_no_text_grows_without_lines() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.mcap");
        let mut log = Followed::of(&path, &asked(&path)).unwrap();
        for come in ["a", "ab"] {
            std::fs::write(&path, come).unwrap();
            assert!(log.catch_up().unwrap());
        }
        assert!(!log.catch_up().unwrap(), "nothing came");
    }

    #[test]
    fn a_line_of_utf_16_that_is_cut_off_is_waited_for() {
        // The Gurmukhi letter U+0A15 and U+150A have the byte of a line feed.
        let text = "\u{feff}t,a.input,a.output,\u{a15}\u{150a}\n0,1,2,\n1,1,3,\u{150a}\n";
        for to_bytes in [u16::to_le_bytes, u16::to_be_bytes] {
            let bytes: Vec<u8> = text.encode_utf16().flat_map(to_bytes).collect();
            let rows = |left: usize| rows_of(&bytes[..bytes.len() - left]);
            assert_eq!([0, 1, 2, 3, 4, 6].map(rows), [2, 0, 0, 0, 0, 0], "one row makes no trial");
        }
    }

    #[test]
    fn a_row_that_is_not_whole_is_waited_for() {
        let mut log = "t,a.input,a.output,note\n".to_owned();
        for (text, rows) in [
            ("0,1,2,\n1,1,3,\n", 2),
            // Its numbers are whole.
            ("2,1,4,\"two\n", 3),
            ("lines\"\n3,1,", 3),
            ("5,\nend of the test,,,\n", 4),
            ("4,0,6,\n", 0),
        ] {
            log.push_str(text);
            assert_eq!(rows_of(log.as_bytes()), rows, "{text}");
        }
    }
}
