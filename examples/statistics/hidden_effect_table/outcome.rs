//! What explain and improve make of a record.

use anyhow::Context as _;
use tauscope::batch::Threads;
use tauscope::delay::{EstimateError, Settings};
use tauscope::diagnosis::Comparison;
use tauscope::diagnosis::failure::Feature;
use tauscope::experiment::Joint;
use tauscope::explain::{
    Attribution, Change, Contribution, Improvement, Options, Revision, Verdict,
};
use tauscope::fit::{Horizon, Parameter};
use tauscope::study::{
    JointEstimate, Mode, Protocol, estimate_joints, explain_joints, improve_joints,
};
use tauscope::synthetic::{DelayLaw, JointSpec, simulate};

use super::cases::{Case, Group};

/// What explain says of a plain integrator.
#[derive(Clone, Debug)]
pub(crate) struct Named {
    pub(crate) verdict: Verdict,
    /// The first of the ranking: `dead_band`.
    pub(crate) first: String,
    /// What it is indistinguishable from.
    pub(crate) equals: Vec<&'static str>,
}

/// A fitted parameter that the plant has, too.
#[derive(Clone, Debug)]
pub(crate) struct Estimate {
    /// `gain`, or `dead_band.lower`.
    pub(crate) name: String,
    /// How far it is off, in standard errors, where it has one.
    pub(crate) score: Option<f64>,
}

/// An effect that improve added.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Found {
    pub(crate) id: &'static str,
    /// What leaves as little error in its place.
    pub(crate) alternatives: Vec<String>,
    /// What it carries, in parts of the first error; a refinement carries nothing.
    pub(crate) error_share: f64,
}

/// A condition under which a model fails.
#[derive(Clone, Debug)]
pub(crate) struct Fails {
    pub(crate) features: Vec<Feature>,
    pub(crate) condition: String,
}

/// What became of a record.
#[derive(Clone, Debug)]
pub(crate) struct Outcome {
    /// `None` where explain was not asked.
    pub(crate) named: Option<Named>,
    /// Effects of the last revision.
    pub(crate) found: Vec<Found>,
    pub(crate) verdict: Verdict,
    /// Validation error of the integrator, and of the last revision, over the noise.
    pub(crate) errors: [f64; 2],
    pub(crate) estimates: Vec<Estimate>,
    /// Where the integrator fails.
    pub(crate) fails: Vec<Fails>,
    /// The revisions and their errors, in words.
    pub(crate) chain: String,
    /// Whether the joint beside it, which hides nothing, is called adequate.
    pub(crate) other_adequate: Option<bool>,
}

/// The joints of a record, and the delays in them.
struct Log {
    joints: Vec<Joint>,
    estimates: Vec<Result<JointEstimate, EstimateError>>,
}

/// As the commands do it.
const PROTOCOL: Protocol = Protocol { mode: Mode::Integrator, split: None, horizon: Horizon::Auto };

impl Log {
    fn improved(&self, options: &Options) -> anyhow::Result<(Improvement, Option<bool>)> {
        // Of the joint beside it only the verdict counts.
        let goes_on = |index: usize, _: &Revision| index == 0;
        let joints = &self.joints;
        let found =
            improve_joints(joints, &self.estimates, |_| None, PROTOCOL, options, goes_on, &Threads);
        let mut found = found.into_iter().flatten();
        let first = found.next().context("no joint")??;
        let other = found.next().transpose()?;
        Ok((first, other.map(|other| other.verdict == Verdict::Adequate)))
    }

    fn named(&self, options: &Options) -> anyhow::Result<Named> {
        let explained =
            explain_joints(&self.joints, &self.estimates, |_| None, PROTOCOL, options, &Threads);
        let explained = explained.into_iter().flatten().next().context("no joint")??;
        let best = explained.ranking.first();
        Ok(Named {
            verdict: explained.verdict,
            first: best.map_or_else(String::new, tauscope::explain::Candidate::name),
            equals: best.map(|best| best.indistinguishable_from.clone()).unwrap_or_default(),
        })
    }
}

/// Makes the record of `case`, explains and improves it with the effects of `options`.
pub(crate) fn examine(case: &Case, options: &Options) -> anyhow::Result<Outcome> {
    let plant = case.plant()?;
    let joints = simulate(&plant)?.joints;
    let estimates = estimate_joints(&joints, &Settings::default(), || (), &Threads);
    let log = Log { joints, estimates };
    let (improvement, other_adequate) = log.improved(options)?;
    let is_asked = matches!(case.group, Group::One | Group::Soft | Group::Outside | Group::Nothing);
    let named = is_asked.then(|| log.named(options)).transpose()?;
    let spec = plant.joints.first().context("no joint")?;
    outcome(case, spec, &improvement, named, other_adequate)
}

fn outcome(
    case: &Case,
    plant: &JointSpec,
    improvement: &Improvement,
    named: Option<Named>,
    other_adequate: Option<bool>,
) -> anyhow::Result<Outcome> {
    let Improvement { revisions, verdict, attribution } = improvement;
    let first = revisions.first().context("no revision")?;
    let last = revisions.last().context("no revision")?;
    let effects = last.comparison.fit.model.components().iter();
    let estimates = last.comparison.fit.parameters.iter();
    Ok(Outcome {
        named,
        found: effects.map(|part| found(part.effect().spec().id, attribution)).collect(),
        verdict: *verdict,
        errors: [first, last].map(|revision| error(case, &revision.comparison)),
        estimates: estimates.filter_map(|parameter| estimate(plant, parameter)).collect(),
        fails: fails(&first.comparison),
        chain: chain(case, improvement),
        other_adequate,
    })
}

fn found(id: &'static str, attribution: &Attribution) -> Found {
    let known = attribution.found.iter().find(|contribution| contribution.effect == id);
    Found {
        id,
        alternatives: known.map(Contribution::alternative_names).unwrap_or_default(),
        error_share: known.map_or(0.0, |known| known.error_share),
    }
}

/// Validation error over the noise.
fn error(case: &Case, comparison: &Comparison) -> f64 {
    comparison.validation.map_or(f64::NAN, |validation| validation.rmse / case.deviation)
}

fn fails(comparison: &Comparison) -> Vec<Fails> {
    let conditions = comparison.failure.iter().flat_map(|failure| &failure.fails_where);
    let named = conditions.map(|fails| Fails {
        features: fails.clauses.iter().map(|clause| clause.feature).collect(),
        condition: fails.condition.clone(),
    });
    named.collect()
}

/// `integrator 12.1, + dead_band 1.01: adequate (p = 0.31)`
fn chain(case: &Case, improvement: &Improvement) -> String {
    let Improvement { revisions, verdict, attribution } = improvement;
    let told = revisions.iter().map(|revision| {
        let change = match revision.change {
            Change::Start => "integrator".to_owned(),
            Change::Added(id) => format!("+ {id}"),
            Change::Removed(id) => format!("- {id}"),
            Change::Replaced { old, new } => format!("- {old} + {new}"),
        };
        format!("{change} {:.3}", error(case, &revision.comparison))
    });
    let told: Vec<String> = told.collect();
    let test = revisions.last().and_then(|last| last.comparison.lack_of_fit);
    let test = test.map_or_else(String::new, |test| {
        format!(" (p = {:.1e}, misfit {:.1} %)", test.p_value, 100.0 * test.misfit_share)
    });
    let carried = attribution.found.iter().map(|found| {
        let or = found.alternatives.iter().map(|other| format!(" or {}", other.join(" + ")));
        format!("{}{} {:.1} %", found.effect, or.collect::<String>(), 100.0 * found.error_share)
    });
    let carried: Vec<String> = carried.collect();
    let verdict = in_words(*verdict);
    format!("{}: {verdict}{test}; {}", told.join(", "), carried.join(", "))
}

/// The verdict as files have it.
pub(crate) fn in_words(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Adequate => "adequate",
        Verdict::MissingEffect => "missing_effect",
        Verdict::Unexplained => "unexplained",
    }
}

/// How far `parameter` is from the number of the plant that has its name.
fn estimate(plant: &JointSpec, parameter: &Parameter) -> Option<Estimate> {
    let truth = truth(plant, &parameter.name)?;
    let score = parameter.std_error.map(|error| (parameter.value - truth) / error);
    Some(Estimate { name: parameter.name.clone(), score })
}

fn truth(plant: &JointSpec, name: &str) -> Option<f64> {
    if plant.cylinder.is_some() {
        return None;
    }
    match (name.split_once('.'), &plant.delay) {
        (None, DelayLaw::Constant { seconds }) if name == "delay" => Some(*seconds),
        (None, _) => (name == "gain").then_some(plant.gain),
        (Some((effect, key)), _) => {
            let effects = toml::Table::try_from(&plant.effect).ok()?;
            effects.get(effect)?.get(key)?.as_float()
        }
    }
}
