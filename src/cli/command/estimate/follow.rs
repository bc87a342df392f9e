//! `estimate --follow`: decisions on a log that still grows, as its steps complete.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::batch::Threads;
use crate::delay::{Automatic, InputKind, Settings, Verdict, check_growing, final_part};
use crate::experiment::{Experiment, Joint, ReadOptions, line_end_of};
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
    if args.algorithm.automatic().any() {
        bail!("--follow: `auto` needs the whole record; give a number");
    }
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
    /// What was read of the log.
    seen: Vec<u8>,
    /// Bytes of it that are in the copy: of a text its whole lines, else all of it.
    whole: usize,
    /// What ends a line of the log: nothing where it is no text.
    line_end: &'static [u8],
    /// Holds the copy, a file with the log's name.
    _folder: tempfile::TempDir,
    copy: PathBuf,
}

impl Followed {
    fn of(path: &Path, args: &Args) -> anyhow::Result<Self> {
        let folder = tempfile::tempdir().context("no temporary folder can be made")?;
        let copy = folder.path().join(path.file_name().unwrap_or_default());
        let (path, options, seen) = (path.to_owned(), args.data.options()?, Vec::new());
        Ok(Self { path, options, seen, whole: 0, line_end: b"", _folder: folder, copy })
    }

    /// Takes in what has come since; whether that made a line of a text whole. A log that is not there
    /// yet may come.
    fn catch_up(&mut self) -> anyhow::Result<bool> {
        if !self.has_grown()? {
            return Ok(false);
        }
        if self.whole == 0 {
            self.line_end = line_end_of(&self.copy, &self.seen);
        }
        let whole = match self.line_end.len() {
            0 => self.seen.len(),
            // A line feed of UTF-16 has two bytes, and begins at an even one.
            width => {
                let end = self.seen.chunks(width).rposition(|letter| letter == self.line_end);
                end.map_or(0, |end| (end + 1) * width)
            }
        };
        let news = self.seen.get(self.whole..whole).filter(|news| !news.is_empty());
        let Some(news) = news else { return Ok(false) };
        File::options().create(true).append(true).open(&self.copy)?.write_all(news)?;
        self.whole = whole;
        Ok(true)
    }

    /// Reads what was appended since the last look, and nothing else but the end of what was there before;
    /// whether there is any.
    fn has_grown(&mut self) -> anyhow::Result<bool> {
        let name = self.path.display();
        let unread = || format!("{name}: cannot be read");
        let read = self.seen.len() as u64;
        // To open a pipe would wait for who writes into it.
        if read > 0 && self.path.metadata().is_ok_and(|found| !found.is_file()) {
            bail!("{name}: the file is gone; run the command again when it is there");
        }
        let mut file = match File::open(&self.path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound && read == 0 => return Ok(false),
            opened => opened.with_context(unread)?,
        };
        let length = file.metadata().with_context(unread)?.len();
        if length < read {
            bail!("{name}: it became shorter while it was followed; run the command again");
        }
        let tail = self.seen.split_off(self.seen.len().saturating_sub(TAIL));
        let start = self.seen.len() as u64;
        file.seek(SeekFrom::Start(start))
            .and_then(|_| file.take(length - start).read_to_end(&mut self.seen))
            .with_context(unread)?;
        // Another log under the name would be read from its middle on.
        let known = usize::try_from(start).ok().and_then(|start| self.seen.get(start..));
        if !known.is_some_and(|known| known.starts_with(&tail)) {
            bail!("{name}: another log took its place while it was followed; run the command again")
        }
        Ok(self.seen.len() as u64 > read)
    }

    /// What its whole lines say, or all of it where it has none; joints that say nothing yet are left out.
    fn experiment(&self) -> Experiment {
        let mut options = self.options.clone();
        // What is reported of a text stands: nothing may depend on rows that are still to come.
        options.repair.as_it_stands |= !self.line_end.is_empty();
        let mut experiment = Experiment::read(std::slice::from_ref(&self.copy), &options);
        for source in &mut experiment.sources {
            source.path.clone_from(&self.path);
        }
        experiment
    }

    /// An error on a copy, as one on the log.
    fn named(&self, error: &str) -> String {
        error.replace(&self.copy.display().to_string(), &self.path.display().to_string())
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
        self.say_failures(args, &experiment, log);
        let own = OwnSettings::of(&experiment.options)?;
        let asked = (settings.clone(), Automatic::default());
        let of_joint = |joint: &Joint| own.of_joint(joint, &asked);
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
    fn say_failures(&mut self, args: &Args, experiment: &Experiment, log: &Followed) {
        let failures = experiment.failures.iter();
        let failures: Vec<_> = failures.map(|f| log.named(&said(&f.error))).collect();
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

    /// A log with its header alone, and who follows it.
    fn begun(name: &str, start: &str) -> (tempfile::TempDir, File, Args, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        let args = asked(&path);
        assert!(!Followed::of(&path, &args).unwrap().catch_up().unwrap(), "there is no log yet");
        let mut file = File::create(&path).unwrap();
        file.write_all(start.as_bytes()).unwrap();
        (folder, file, args, path)
    }

    #[test]
    fn a_look_reads_what_was_appended_and_no_more() {
        let (_folder, mut file, args, path) = begun("log.csv", "t,a.input,a.output\n");
        let mut log = Followed::of(&path, &args).unwrap();
        assert!(log.catch_up().unwrap());
        let mut samples = 0_u32;
        for rows in [20_000, 1, 0, 3] {
            let before = log.seen.len();
            let rows_of = samples..samples + rows;
            let lines: Vec<_> = rows_of.map(|k| format!("{k},{},{k}.5\n", k / 50)).collect();
            let text = lines.concat();
            // The last line is not whole yet.
            let (whole, rest) = text.split_at(text.len().saturating_sub(3));
            file.write_all(whole.as_bytes()).unwrap();
            assert_eq!(log.catch_up().unwrap(), rows > 1);
            assert_eq!(log.seen.len() - before, whole.len());
            file.write_all(rest.as_bytes()).unwrap();
            assert_eq!(log.catch_up().unwrap(), rows > 0);
            assert_eq!(log.seen.len() - before, text.len());
            samples += rows;
            assert_eq!(log.experiment().joints[0].trials[0].len(), samples as usize);
        }
        std::fs::write(&path, "a").unwrap();
        assert!(log.catch_up().unwrap_err().to_string().contains("became shorter"));
    }

    #[test]
    fn what_is_no_text_is_read_from_a_copy() {
        let (_folder, mut file, args, path) = begun("log.mcap", "a");
        let mut log = Followed::of(&path, &args).unwrap();
        assert!(log.catch_up().unwrap());
        file.write_all(b"b\nc").unwrap();
        assert!(log.catch_up().unwrap());
        assert!(!log.catch_up().unwrap(), "nothing came");
        assert_eq!(std::fs::read(&log.copy).unwrap(), b"ab\nc");
        let failures = log.experiment().failures;
        let told = log.named(&failures[0].error.to_string());
        assert!(told.starts_with(&path.display().to_string()), "{told}");
    }

    #[test]
    fn the_lines_of_utf_16_are_whole_at_their_own_line_feeds() {
        // The Gurmukhi letter U+0A15 and U+150A have the byte of a line feed.
        let text = "\u{feff}t,a.input,a.output,\u{a15}\u{150a}\n0,1,2,\n1,1,3,\u{150a}\n";
        for to_bytes in [u16::to_le_bytes, u16::to_be_bytes] {
            let bytes: Vec<u8> = text.encode_utf16().flat_map(to_bytes).collect();
            let (_folder, _, args, path) = begun("log.csv", "");
            let mut log = Followed::of(&path, &args).unwrap();
            let mut whole = 0;
            for come in 2..=bytes.len() {
                std::fs::write(&path, &bytes[..come]).unwrap();
                whole += usize::from(log.catch_up().unwrap());
            }
            assert_eq!(whole, 3);
            let joint = &log.experiment().joints[0];
            assert_eq!(joint.trials[0].output(), [2.0, 3.0]);
        }
    }

    #[test]
    fn a_row_that_is_not_whole_is_waited_for() {
        let (_folder, mut file, args, path) = begun("log.csv", "t,a.input,a.output,note\n");
        let mut log = Followed::of(&path, &args).unwrap();
        for (text, rows) in [
            ("0,1,2,\n1,1,3,\n", 2),
            // Its numbers are whole.
            ("2,1,4,\"two\n", 3),
            ("lines\"\n3,1,", 3),
            ("5,\nend of the test,,,\n", 4),
            ("4,0,6,\n", 0),
        ] {
            file.write_all(text.as_bytes()).unwrap();
            assert!(log.catch_up().unwrap());
            let joints = log.experiment().joints;
            assert_eq!(joints.first().map_or(0, |joint| joint.trials[0].len()), rows, "{text}");
        }
    }
}
