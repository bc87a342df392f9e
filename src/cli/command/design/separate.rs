//! The shortest input that distinguishes two effects, for each joint.

use anyhow::{Context as _, anyhow, bail};

use super::args::Args;
use super::known::{Known, PROTOCOL};
use crate::batch::Threads;
use crate::cli::args::find;
use crate::cli::console::Bar;
use crate::cli::failure::said;
use crate::design::{
    Limits, Logged, RandomSteps, Suspects, TestRig, default_hold_s, default_largest,
    default_levels, shortest,
};
use crate::effect::Effect;
use crate::experiment::Joint;
use crate::model::JointModel;
use crate::report::design::{DesignedJoint, Discrimination};
use crate::study::suspect_joints;

/// Longest input that is tried where no other is given.
const LONGEST_S: f64 = 60.0;

/// Length of the log that a model stands for, where there is none.
const LOG_S: f64 = 60.0;

/// The input of each joint, or why it has none.
pub(crate) fn designed(
    args: &Args,
    known: &Known,
    bar: &Bar,
) -> anyhow::Result<Vec<anyhow::Result<DesignedJoint>>> {
    let effects = effects(args, known)?;
    let suspected = match known.estimated() {
        None => Vec::new(),
        Some((joints, estimates)) => {
            let base = |joint: &Joint| Some(without(known.model(&joint.name)?, effects));
            let known = (args.noise, args.uncertainty);
            suspect_joints(joints, &estimates, base, PROTOCOL, effects, known, &Threads)
        }
    };
    let mut suspected = suspected.into_iter();
    let one = |name: &String| {
        let rig = known.rig(args, name, range(args, known, name));
        let suspects = match suspected.next() {
            Some(Some(Ok(suspects))) => suspects,
            Some(Some(Err(error))) => bail!("{}", said(&error)),
            Some(None) => bail!("it has no model"),
            None => of_model(args, known, &rig, effects)?,
        };
        distinguish(args, known, rig, &suspects, bar)
    };
    Ok(known.names.iter().map(one).collect())
}

/// The two effects that are named.
fn effects(args: &Args, known: &Known) -> anyhow::Result<[&'static dyn Effect; 2]> {
    let [one, other] = args.separate.as_slice() else {
        let count = args.separate.len();
        bail!("--separate: expected two effects, as in dead_band,stiction; there are {count}");
    };
    let known = known.file.candidates();
    let named = |id: &str| find(id.trim(), known).context("--separate");
    let (one, other) = (named(one)?, named(other)?);
    if one.spec().id == other.spec().id {
        bail!("--separate: `{}` is named twice; name two different effects", one.spec().id);
    }
    Ok([one, other])
}

fn without(model: &JointModel, effects: [&'static dyn Effect; 2]) -> JointModel {
    effects.iter().fold(model.clone(), |model, effect| model.without(effect.spec().id))
}

/// Where the joint may go: a tenth beyond where its log has been, unless that is said.
fn range(args: &Args, known: &Known, name: &str) -> Option<(f64, f64)> {
    const BEYOND: f64 = 0.1;
    let logged = known.logged(name).map(|logged| {
        let (low, high) = logged.extent;
        (low - BEYOND * (high - low), high + BEYOND * (high - low))
    });
    args.output_range.or(logged)
}

/// The suspects where only a model is known.
fn of_model(
    args: &Args,
    known: &Known,
    rig: &TestRig,
    effects: [&'static dyn Effect; 2],
) -> anyhow::Result<Suspects> {
    let name = &rig.name;
    let model = known.model(name).ok_or_else(|| {
        anyhow!("--separate: give a log, or --model with a file that has one of the two effects")
    })?;
    let has = |effect: &dyn Effect| {
        let mut own = model.components().iter().map(|component| component.effect().spec().id);
        own.any(|id| id == effect.spec().id)
    };
    let [one, other] = effects;
    let ids = effects.map(|effect| effect.spec().id);
    let effects = match (has(one), has(other)) {
        (true, false) => [one, other],
        (false, true) => [other, one],
        (true, true) => bail!(
            "the model has both {} and {}: take one of them out, or give a log",
            ids[0],
            ids[1]
        ),
        (false, false) => bail!(
            "the model has neither {} nor {}, so their parameters are not known: give a log, or a \
             model that has one of them (`tauscope add {} LOG.csv --model FILE`)",
            ids[0],
            ids[1],
            ids[0]
        ),
    };
    let mut history = known.file.history(name).iter().rev();
    let noise = args.noise.or_else(|| history.find_map(|entry| entry.errors.validation_rmse));
    let noise = noise.filter(|noise| *noise > 0.0).context(
        "--noise: the model file has no history with an error, so the noise is not known; give it",
    )?;
    let largest = args.largest.unwrap_or_else(|| default_largest(Some(model), rig));
    let steps = RandomSteps {
        levels: default_levels(Some(model), rig, largest),
        hold_s: default_hold_s(Some(model), rig, largest),
        duration_s: LOG_S,
        seed: args.seed,
    };
    Ok(Suspects::of_model(model, effects, noise, args.uncertainty, (rig, &steps))?)
}

/// The input that distinguishes the suspects, and what is expected of it.
fn distinguish(
    args: &Args,
    known: &Known,
    rig: TestRig,
    suspects: &Suspects,
    bar: &Bar,
) -> anyhow::Result<DesignedJoint> {
    let [one, other] = &suspects.models;
    let logged = known.logged(&rig.name).map(Logged::largest).filter(|largest| *largest > 0.0);
    let largest = args.largest.or(logged);
    let limits = Limits {
        largest: largest.unwrap_or_else(|| default_largest(Some(&one.model), &rig)),
        hold_s: args.hold,
        longest_s: args.duration.unwrap_or(LONGEST_S),
        power: args.power,
        rehearsals: args.rehearsals,
    };
    let (name, longest_s) = (&rig.name, limits.longest_s);
    let tried = |seconds: f64| {
        bar.say(format!(
            "designing for {name}: inputs of {seconds:.1} s, of {longest_s} s at most"
        ));
    };
    let design = shortest(suspects, &rig, &limits, &Threads, &tried)?;
    let schedule = design.schedule.clone();
    let prediction = Some(rig.prediction(one, &schedule));
    let other = rig.prediction(other, &schedule);
    let (ids, noise, wanted) = (suspects.ids(), suspects.noise, args.power);
    let effects = ids.join(",");
    let (doubt, next) = if design.explores.is_empty() {
        let doubt = (!design.passes(&limits)).then(|| {
            "Fewer rehearsals succeeded than required: the parameters of the two effects are not \
             known well enough to say whether this input distinguishes them. A log that shows the \
             effects more clearly, or larger levels, may help."
                .to_owned()
        });
        let next = format!(
            "Apply it, log the output, then run: tauscope explain LOG.csv --effects {effects}; a \
             model given with --model must have neither effect."
        );
        (doubt, next)
    } else {
        let next = format!(
            "Apply it, log the output, then design again from both logs: tauscope design LOG.csv \
             PLAYED.csv --separate {effects}."
        );
        (None, next)
    };
    let notes = doubt.into_iter().chain([next]).collect();
    let discrimination = Some(Discrimination { ids, design, wanted, noise, other });
    let rest = known.rest(&rig.name);
    let schedule = schedule.about(rest);
    Ok(DesignedJoint { rig, schedule, rest, prediction, discrimination, basis: None, notes })
}
