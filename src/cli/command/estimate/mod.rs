//! `tauscope estimate`: read, estimate, write, print.

use files::{Estimated, Run};

use crate::cli::each_log::Each;
use crate::cli::failure::{Completion, nothing_usable};
use crate::cli::run::{Session, compared, estimated, failures, notes, others};
use crate::delay::Settings;
use crate::report::against_table;
use crate::report::decisions::steps_table;
use crate::report::delays::delay_levels_text;
use crate::report::difference::against_text;
use crate::report::estimate::{EstimateJson, estimate_table};

mod args;
mod files;
mod follow;

pub(crate) use args::Args;

/// Estimates the delays of the logs; `program` is what its options are read by.
pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    if args.folder.is_asked_for() {
        return each_log(args);
    }
    let verbosity = args.output.to.run.verbosity();
    let lines = args.output.to.lines();
    let with_lines = |settings| Settings { lines, ..settings };
    let settings: Vec<_> = args.runs().into_iter().map(with_lines).collect();
    let inputs = args.inputs();
    args.output.check(&inputs)?;
    let review = args.review.read()?;
    let stream = args.output.to.stream.open(verbosity)?;
    let followed =
        args.follow.is_on.then(|| follow::follow(args, &settings, &stream)).transpose()?;
    let options = args.data.options()?;
    let session = Session::begin("estimate", &args.data, &options, (&args.output.to.run, stream))?;
    let session = session.reviewed(review);
    let experiment = &session.experiment;
    let settings: Vec<_> = settings.iter().map(|one| session.in_samples(one)).collect();
    let results = session.in_threads(|| session.estimates(&settings))?;
    let others = others(&session, (&args.against, &args.data), &settings, &results)?;
    let mut failures = results.first().map_or_else(Vec::new, |first| failures(experiment, first));
    let joints: Vec<_> = results.iter().map(|results| estimated(experiment, results)).collect();
    let runs: Vec<Run<'_>> =
        settings.iter().zip(&joints).map(|(settings, joints)| (settings, &**joints)).collect();
    let Some((answer, first_joints)) = runs.first().filter(|(_, joints)| !joints.is_empty()) else {
        return Err(nothing_usable(failures.last()));
    };
    if let Some(followed) = followed {
        followed.say_changes(first_joints);
    }
    let against = compared(first_joints, &others)?;
    let result = Estimated {
        experiment,
        joints: first_joints,
        settings: answer,
        runs: &runs,
        others: &others,
        against: &against,
    };
    failures.extend(args.output.left_out(&result));
    let notes = notes(first_joints);
    session.warn(&failures, &notes);
    if args.follow.is_on {
        // The log may have come as a link to what is written.
        args.output.check(&args.inputs())?;
    }
    args.output.write(&result, &session.stream, verbosity)?;
    let all_notes: Vec<_> = experiment.notes.iter().cloned().chain(notes).collect();
    let json = || EstimateJson::new(experiment, &runs, &against, (&all_notes, &failures));
    session.end(Completion::without(&failures), || text(&args.output, &result), json)
}

/// Estimates each log by itself.
fn each_log(args: &Args) -> anyhow::Result<Completion> {
    let output = &args.output;
    args.folder.run(&Each {
        command: "estimate",
        data: &args.data,
        decisions: output.decisions.as_deref(),
        refused: &[
            ("--output", output.to.recording.is_some()),
            ("--connect, --spawn or --serve", output.to.stream.is_asked()),
            ("--follow", args.follow.is_on),
            ("--against", !args.against.against.is_empty()),
            ("--review", args.review.review.is_some()),
            ("--review-sheet", output.review_sheet.is_some()),
            ("--delays", output.delays.is_some()),
            ("--table", output.table.is_some()),
            ("--export", output.export.is_some()),
            ("--steps", output.steps),
            ("--against-state", output.against_state),
        ],
        run: &output.to.run,
    })
}

/// The results for people.
fn text(args: &args::OutputArgs, result: &Estimated<'_>) -> String {
    let mut text = String::new();
    for (settings, joints) in result.runs {
        text += &estimate_table(joints, settings);
        if args.steps {
            text += &steps_table(joints);
        }
    }
    text.extend(result.against.iter().map(against_text));
    if args.table.is_some() {
        text += &delay_levels_text(result.joints);
    }
    if args.against_state {
        let found = result.joints.iter().map(|j| (j.joint.name.as_str(), j.against_state()));
        let found: Vec<_> = found.collect();
        text += "\n";
        text += &against_table(found.iter().map(|(name, found)| (*name, found)));
    }
    text
}
