//! Random steps for each joint.

use crate::batch::Threads;
use crate::design::{
    Band, RandomSteps, TestRig, Uncertain, default_hold_s, default_largest, default_levels,
    random_steps, response_s, resting_band,
};
use crate::experiment::Joint;
use crate::report::DesignedJoint;
use crate::study::{OfJoints, know_joints};
use anyhow::{anyhow, bail};

use super::args::Args;
use super::known::{Known, PROTOCOL, largest};
use super::values::BandChoice;
use crate::cli::failure::said;

/// Length of the input where none is given.
const DURATION_S: f64 = 120.0;

/// The input of each joint, or why it has none.
pub(crate) fn designed(args: &Args, known: &Known) -> Vec<anyhow::Result<DesignedJoint>> {
    let uncertain = uncertainties(args, known);
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
    let model = uncertain.map(|uncertain| &uncertain.model);
    if args.output_range.is_some() && model.is_none() {
        bail!(
            "--output-range: where the joint goes is known from a model only; give --model or a log"
        );
    }
    let logged = known.joint(&rig.name).map(largest).filter(|largest| *largest > 0.0);
    let given = args.levels.as_ref().map(super::values::Levels::largest);
    let largest = given.or(args.largest).or(logged);
    let largest = largest.unwrap_or_else(|| default_largest(model, &rig));
    let levels = match &args.levels {
        Some(levels) => levels.0.clone(),
        None => default_levels(model, &rig, largest),
    };
    let levels = match args.dead_band {
        Some(choice) => band(choice, uncertain, &rig, largest)?.applied(&levels),
        None => levels,
    };
    if levels.len() < 2 {
        bail!("--levels: fewer than two are left; an input needs two different levels or more");
    }
    let hold_s = args.hold.unwrap_or_else(|| default_hold_s(model, &rig, largest));
    let duration_s = args.duration.unwrap_or(DURATION_S);
    if hold_s.0 > duration_s {
        bail!("--hold {}: longer than the whole input of {duration_s} s", hold_s.0);
    }
    let steps = RandomSteps { levels, hold_s, duration_s, seed: args.seed };
    let schedule = random_steps(&steps, &rig, uncertain, index);
    let prediction = uncertain.map(|uncertain| rig.prediction(uncertain, &schedule));
    let notes = model.and_then(|model| {
        let response = response_s(model, &rig, largest);
        (hold_s.0 < response).then(|| {
            format!(
                "Holds from {} s are shorter than the {response:.2} s in which the model responds: \
                 a level may be over before it shows.",
                hold_s.0
            )
        })
    });
    let notes = notes.into_iter().collect();
    Ok(DesignedJoint { rig, schedule, prediction, discrimination: None, notes })
}

/// What is to become of which dead band.
fn band(
    choice: BandChoice,
    uncertain: Option<&Uncertain>,
    rig: &TestRig,
    largest: f64,
) -> anyhow::Result<Band> {
    let of_model = || {
        let model = uncertain.map(|uncertain| &uncertain.model);
        let band = model.and_then(|model| resting_band(model, rig, largest));
        band.ok_or_else(|| match model {
            Some(_) => anyhow!("--dead-band: the model has none; give its ends, as in -0.4,0.4"),
            None => {
                anyhow!("--dead-band: no model has it; give --model, or its ends, as in -0.4,0.4")
            }
        })
    };
    Ok(match choice {
        BandChoice::Cross => of_model().map(|(lower, upper)| Band::Cross(lower, upper))?,
        BandChoice::Avoid => of_model().map(|(lower, upper)| Band::Avoid(lower, upper))?,
        BandChoice::Given(lower, upper) => Band::Avoid(lower, upper),
    })
}
