//! Random steps for each joint.

use crate::batch::Threads;
use crate::design::{Logged, Plan, PlanRequest, TestRig, Uncertain, plan, reach, response_s};
use crate::experiment::Joint;
use crate::report::design::{Basis, DesignedJoint};
use crate::report::design_words::{
    hold_note, left_out_note, no_range_note, shortened_note, trials_note,
};
use crate::study::{OfJoints, know_joints};
use anyhow::bail;

use super::args::{Args, Levels};
use super::known::{Known, PROTOCOL};
use crate::cli::console::Bar;
use crate::cli::failure::said;

/// The input of each joint, or why it has none.
pub(crate) fn designed(
    args: &Args,
    known: &Known,
    bar: &Bar,
) -> Vec<anyhow::Result<DesignedJoint>> {
    bar.say("finding the best model that the log supports".to_owned());
    let uncertain = uncertainties(args, known);
    bar.say("planning".to_owned());
    let one = |(index, name): (usize, &String)| {
        let uncertain = match uncertain.get(index) {
            Some(Some(Ok(found))) => Some(found.clone()),
            Some(Some(Err(error))) => bail!("{}", said(error)),
            _ => {
                let model = known.model(name);
                model.map(|model| Uncertain::by_share(model.clone(), args.uncertainty))
            }
        };
        let rig = known.rig(args, name, args.output_range);
        steps_of(args, known, rig, uncertain.as_ref(), index)
    };
    known.names.iter().enumerate().map(one).collect()
}

/// What the logs say of the joints.
fn uncertainties(args: &Args, known: &Known) -> OfJoints<Uncertain> {
    let Some((joints, estimates)) = known.estimated() else { return Vec::new() };
    let models = |joint: &Joint| known.model(&joint.name).cloned();
    know_joints(joints, &estimates, models, PROTOCOL, args.uncertainty, &Threads)
}

/// The input of one joint.
fn steps_of(
    args: &Args,
    known: &Known,
    rig: TestRig,
    uncertain: Option<&Uncertain>,
    index: usize,
) -> anyhow::Result<DesignedJoint> {
    if args.output_range.is_some() && uncertain.is_none() {
        bail!(
            "--output-range: where the joint goes is known from a model only; give --model or a log"
        );
    }
    let logged = known.logged(&rig.name);
    let rest = known.rest(&rig.name);
    let planned = plan(&request(args, rest), &rig, uncertain, logged, index)?;
    let notes = notes(&planned, &rig, uncertain, rest);
    let basis = uncertain.map(|known| basis(known, &rig, logged, &planned));
    let Plan { schedule, prediction, .. } = planned;
    let schedule = schedule.about(rest);
    Ok(DesignedJoint { rig, schedule, rest, prediction, discrimination: None, basis, notes })
}

/// What is asked for, in differences to `rest`.
fn request(args: &Args, rest: f64) -> PlanRequest {
    let levels = args.levels.as_ref();
    PlanRequest {
        levels: levels.map(|Levels(levels)| levels.iter().map(|u| u - rest).collect()),
        largest: args.largest,
        hold_s: args.hold,
        duration_s: args.duration,
        trials: args.trials,
        seed: args.seed,
    }
}

/// What the expectation rests on.
fn basis(known: &Uncertain, rig: &TestRig, logged: Option<&Logged>, plan: &Plan) -> Basis {
    let effects = known.model.components().iter().map(|component| component.effect().spec().id);
    let within = rig.range.and_then(|range| reach(range, logged).ok());
    let regulates_itself = logged.is_some_and(|logged| logged.settled().is_some());
    let (effects, free_run) = (effects.collect(), known.free_run.clone());
    let start_tolerance = plan.start_tolerance;
    Basis { effects, free_run, within, regulates_itself, start_tolerance }
}

/// What whoever plays it should know.
fn notes(plan: &Plan, rig: &TestRig, uncertain: Option<&Uncertain>, rest: f64) -> Vec<String> {
    let response = uncertain.map(|known| response_s(&known.model, rig, plan.largest));
    let short = response.filter(|response| plan.hold_s.0 < *response);
    let short = short.map(|response| hold_note(plan.hold_s.0, response));
    let unit = rig.input_unit.as_deref();
    let left_out: Vec<f64> = plan.left_out.iter().map(|level| level + rest).collect();
    let left_out = (!left_out.is_empty()).then(|| left_out_note(&left_out, unit));
    let shortened = plan.shortened_from_s;
    let shortened = shortened.map(|from_s| shortened_note(&plan.schedule, from_s));
    let no_range = (rig.range.is_none() && uncertain.is_some()).then(no_range_note);
    let trials = Some(plan.schedule.trial_count()).filter(|count| *count > 1).map(trials_note);
    [trials, short, left_out, shortened, no_range].into_iter().flatten().collect()
}
