//! What is said and drawn of a joint's model: verdict, equations, parameters, errors, ranking.

use super::document::{Block, Figure, HALF, WIDTH};
use super::simulated;
use crate::diagnosis::sensor_noise;
use crate::effect::Stage;
use crate::explain::Revision;
use crate::figure::curves::Curves;
use crate::figure::error_share::{by_feature, unevenness};
use crate::figure::ladder::{Rung, panel};
use crate::figure::{Role, error_share};
use crate::fit::Termination;
use crate::model::Component;
use crate::report::compare::errors_note;
use crate::report::conclusion::Topic;
use crate::report::finding::ranking_table;
use crate::report::ladder::{LadderRow, judged_error, ladder_table};
use crate::report::parameters::{delay_of_steps, equation, parameter_table};
use crate::report::{ComparedJoint, ImprovedJoint};
use crate::wording::{
    bracketed, capitalized, correlation_sentences, failure_sentences, feature_with_unit,
    parameter_units, parameter_value,
};

/// All that is said of the model of a joint.
pub(super) fn blocks(improved: &ImprovedJoint<'_>) -> Vec<Block> {
    let compared = &improved.finding.compared;
    let conclusion = improved.conclusion();
    let mut blocks = vec![Block::part("Model")];
    // Where the error arises has a part of its own.
    let passages = conclusion.passages.into_iter();
    let passages = passages.filter(|passage| passage.topic != Topic::WHERE_IT_FAILS);
    blocks.extend(
        passages.map(|passage| Block::Passage { question: passage.topic.0, text: passage.text() }),
    );
    blocks.extend(conclusion.commands.into_iter().map(Block::Code));
    blocks.extend(errors(improved));
    blocks.extend(beside_the_measurement(improved));
    blocks.extend(failures(improved));
    blocks.push(Block::part("Equations and parameters"));
    blocks.push(Block::Code(equations(compared)));
    blocks.push(Block::Table(parameter_table(compared.joint, &compared.comparison.fit)));
    blocks.push(Block::text(match compared.comparison.termination {
        Termination::NothingToFit => {
            "The model as it is in its file; nothing was fitted.".to_owned()
        }
        termination => format!("The fit: {termination}."),
    }));
    blocks.extend(rankings(improved));
    blocks
}

/// What is said of the model, and whether the search was ended.
pub(super) fn sentence(improved: &ImprovedJoint<'_>) -> String {
    let stopped = if improved.interrupted { " The search was stopped before its end." } else { "" };
    format!("Model: {}.{stopped}", improved.finding.headline())
}

/// The model in equations, in the order in which a signal runs through it.
fn equations(compared: &ComparedJoint<'_>) -> String {
    let fit = &compared.comparison.fit;
    let units = parameter_units(compared.joint, &fit.model);
    let own = |index: usize| {
        let known = fit.parameters.get(index).zip(units.get(index));
        known.map_or_else(String::new, |(parameter, unit)| parameter_value(parameter, unit))
    };
    let laws = |from: Stage, to: Stage| {
        let components = fit.model.components().iter();
        let of_stages = move |one: &&Component| (from..=to).contains(&one.effect().spec().stage);
        components.filter(of_stages).map(law)
    };
    let of_steps = delay_of_steps(compared.joint, &fit.model);
    let delay = match of_steps {
        Some(of_steps) => format!("delay of the steps {of_steps}: {} + extra", own(1)),
        None => format!("delay = {}", own(1)),
    };
    let mut lines = vec![format!("in = input(t − delay), {delay}")];
    lines.extend(laws(Stage::Transport, Stage::Dynamics));
    let acting = behind("in", laws(Stage::Spool, Stage::Dynamics).count());
    lines.push(format!("speed = gain · {acting}, gain = {}", own(0)));
    lines.extend(laws(Stage::Load, Stage::Load));
    let speed = behind("speed", laws(Stage::Load, Stage::Load).count());
    lines.push(format!("d output/dt = {speed}"));
    lines.extend(laws(Stage::Output, Stage::Output));
    lines.join("\n")
}

/// What a signal is called after so many effects.
fn behind(name: &str, effects: usize) -> &str {
    if effects == 0 { name } else { "out" }
}

/// `    dead_band, on the delayed input: out = …`.
fn law(component: &Component) -> String {
    let spec = component.effect().spec();
    let acts = match spec.stage {
        Stage::Transport => "on the delay",
        Stage::Spool => "on the delayed input, before the valve",
        Stage::Input => "on the delayed input",
        Stage::Dynamics => "on the input as it acts",
        Stage::Load => "on the speed",
        Stage::Output => "on the output",
    };
    format!("    {}, {acts}: {}", spec.id, equation(component))
}

/// The ladder of errors; without several revisions, the error alone.
fn errors(improved: &ImprovedJoint<'_>) -> Vec<Block> {
    let mut blocks = vec![Block::part("Errors")];
    if improved.ladder().len() > 1 {
        blocks.push(Block::Figures(vec![ladder(improved)]));
    }
    blocks.push(Block::Table(ladder_table(improved.finding.compared.joint, &improved.ladder())));
    let horizon = improved.finding.compared.comparison.fit.evaluation.horizon;
    blocks.push(Block::text(format!("{}.", capitalized(&errors_note(&horizon.to_string())))));
    blocks
}

/// What the model simulates, and the residual.
fn beside_the_measurement(improved: &ImprovedJoint<'_>) -> Vec<Block> {
    let compared = &improved.finding.compared;
    let figure = simulated::figure(improved);
    let mut blocks = vec![Block::part("Measured and simulated"), Block::Figures(vec![figure])];
    let curves = curves(compared);
    if !curves.is_empty() {
        blocks.push(Block::part("Measured curves"));
        blocks.push(Block::Figures(curves));
    }
    let residual = correlation_sentences(compared.comparison).join("; ");
    if !residual.is_empty() {
        blocks.push(Block::text(format!("Residual of the training part: {residual}.")));
    }
    blocks
}

/// Where the last revision that fails does so; nothing where none fails.
fn failures(improved: &ImprovedJoint<'_>) -> Vec<Block> {
    let models = improved.compared().enumerate();
    let failing = models.filter(|(_, compared)| compared.comparison.failure.is_some()).last();
    let Some((place, compared)) = failing else { return Vec::new() };
    let heading = if compared.revision == improved.finding.compared.revision {
        "Where the error arises".to_owned()
    } else {
        format!("Where the error of revision {} arose", compared.revision)
    };
    let said = failure_sentences(compared.joint, compared.comparison)
        .into_iter()
        .map(|sentence| format!("{}.", capitalized(&sentence)));
    let said: Vec<String> = said.collect();
    let mut blocks = vec![Block::part(heading)];
    if said.is_empty() {
        let none = "No condition contains much more of the error than of the time.";
        blocks.push(Block::text(none));
    } else {
        blocks.push(Block::List(said));
    }
    let share = share(&compared);
    let worst = simulated::worst(&compared, place);
    blocks.push(Block::Figures(share.into_iter().chain(worst).collect()));
    blocks
}

/// What was tried: the best of the last race, and all of each.
fn rankings(improved: &ImprovedJoint<'_>) -> Vec<Block> {
    /// Rows that are not folded away.
    const BEST: usize = 5;
    let tried = improved.numbered().filter(|(_, revision)| !revision.ranking.is_empty());
    let tried: Vec<_> = tried.collect();
    let Some((number, last)) = tried.last() else { return Vec::new() };
    let best = last.ranking.get(..BEST).unwrap_or(&last.ranking);
    let joint = improved.finding.compared.joint;
    let mut blocks = vec![
        Block::part(format!("Effects that were tried on revision {number}, best first")),
        Block::Table(ranking_table(joint, best)),
    ];
    let is_shown =
        |revision: &Revision| std::ptr::eq(revision, *last) && best.len() == revision.ranking.len();
    for (number, revision) in tried.iter().filter(|(_, revision)| !is_shown(revision)) {
        let table = Block::Table(ranking_table(joint, &revision.ranking));
        let count = revision.ranking.len();
        let summary = format!("All {count} that were tried on revision {number}");
        blocks.push(Block::details(summary, vec![table]));
    }
    blocks
}

/// A bar for the error of each revision, and the noise as a line.
pub(super) fn ladder(improved: &ImprovedJoint<'_>) -> Figure {
    let joint = improved.finding.compared.joint;
    let rows = improved.ladder();
    // A revision has its colour in all figures, and in the recording.
    let rung = |(place, row): (usize, &LadderRow)| Rung {
        name: format!("{}: {}", row.number, row.change),
        error: row.errors.judged(),
        training: row.errors.train_rmse.filter(|_| row.errors.validation_rmse.is_some()),
        role: Role::of_revision(place),
    };
    let rungs: Vec<Rung> = rows.iter().enumerate().map(rung).collect();
    let unit = joint.output_unit.as_deref();
    let name = (bracketed("root-mean-square error", unit), "ladder");
    let mut panel = panel(name, &rungs, (sensor_noise(&joint.trials), unit), 1.2);
    if let Some(first) = panel.marks.first_mut() {
        let are_validated = rows.iter().map(|row| row.errors.validation_rmse.is_some());
        first.name = Some(judged_error(are_validated).to_owned());
    }
    let name = format!("Errors of the revisions of {}", joint.name);
    let caption = "How the error falls from revision to revision.".to_owned();
    Figure { name, width: WIDTH, panels: vec![panel], caption }
}

/// Shares of the squared error and of the time in each part of the feature whose parts
/// differ most in them.
pub(super) fn share(compared: &ComparedJoint<'_>) -> Option<Figure> {
    let features = by_feature(&compared.comparison.regions);
    let parts = features.max_by(|a, b| unevenness(a).total_cmp(&unevenness(b)))?;
    let feature = parts.first()?.feature;
    let joint = compared.joint;
    let by = feature_with_unit(feature, joint);
    let name = format!("Share of the error of {}", joint.name);
    let caption = format!(
        "Where the error arises, by {by}: the squared error of the speed, {}. A bar beyond its \
         mark (the share of time) is a range with more than its share of the error.",
        compared.comparison.arising
    );
    let panel = error_share::panel(joint, parts, &[(Role::Error, compared.comparison)])?;
    Some(Figure { name, width: HALF, panels: vec![panel], caption })
}

/// A figure for the input, one for the angle and one for the time, as far as the record shows them.
pub(super) fn curves(compared: &ComparedJoint<'_>) -> Vec<Figure> {
    let joint = compared.joint;
    let figure = |curves: Curves<'_>| {
        let against = curves.against();
        let caption = format!(
            "Speed in the settled parts of the holds, {against}, after the delay; the influence of \
             the quantities of the other curves is removed."
        );
        let name = format!("Speed of {} {against}", joint.name);
        Figure { name, width: HALF, panels: vec![curves.panel(joint, Role::Model)], caption }
    };
    Curves::all(&compared.comparison.curves).map(figure).collect()
}
