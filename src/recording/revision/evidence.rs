//! What each level of the input made of the joint, and the laws that models draw through it.
//!
//! The speed at a [held](super::holds) level shows a dead band, a saturation or a curve, beside the
//! [law](super::law) of the model. What does not show there is in [`residual`].

use super::figure::{Figure, Held, Law};
use super::holds::{Shown, all_held};
use super::law::{Still, are_alike};
use super::residual;
use crate::experiment::Joint;
use crate::recording::canvas::Span;
use crate::recording::error::RecordError;
use crate::recording::layers::{Ink, Layers};
use crate::recording::palette;
use crate::report::ImprovedJoint;
use crate::wording::bracketed;

/// Speeds and laws of each revision, and what is drawn of them.
pub(super) struct Evidence {
    pub(super) held: Vec<Vec<Held>>,
    pub(super) laws: Vec<Law>,
    pub(super) figures: Vec<Figure>,
}

/// What is measured, and what the models of `improved` make of it.
pub(super) fn evidence(improved: &ImprovedJoint<'_>) -> Evidence {
    let joint = improved.finding.compared.joint;
    let shown = Shown::of(joint);
    let still = Still::of(joint, shown);
    let of_each = || improved.revisions.iter().map(|revision| &revision.comparison);
    let held: Vec<Vec<Held>> = of_each().map(|c| all_held(joint, c, shown)).collect();
    let measured = held.iter().flatten().map(|held| held.speed);
    let simulated = held.iter().flatten().filter_map(|held| held.simulated);
    let y = Span::around(measured.chain(simulated), 0.05);
    let laws: Vec<Law> = of_each().map(|comparison| still.law(&comparison.fit.model)).collect();
    let x = Span::around(still.levels().into_iter(), 0.03);
    let mut figures = Vec::new();
    for (at, ((number, step), held)) in improved.numbered().zip(&held).enumerate() {
        let own = laws.get(at).cloned().unwrap_or_default();
        let proposed = improved.proposed(at);
        let next = proposed.map_or_else(Vec::new, |candidate| still.law(&candidate.fit.model));
        let only_moving = proposed.filter(|_| are_alike(&own, &next));
        let simulated =
            only_moving.and_then(|candidate| Some((candidate, candidate.fit.evaluation()?)));
        if let Some(candidate) = simulated {
            figures.push(residual::figure(joint, &step.comparison, number, candidate));
            continue;
        }
        let before = at.checked_sub(1).and_then(|before| laws.get(before));
        figures.push(Figure {
            title: title(joint, shown),
            x,
            y,
            points: held.clone(),
            names: [
                Some(still.legend(number, &step.comparison.fit.model, joint)),
                before.map(|_| format!("revision {}", number - 1)),
                proposed.map(|candidate| format!("with {}", candidate.name())),
                held.iter().any(|held| held.fell).then(|| "input fell".to_owned()),
            ],
            laws: [own, before.cloned().unwrap_or_default(), next],
        });
    }
    Evidence { held, laws, figures }
}

fn title(joint: &Joint, shown: Shown) -> String {
    let (what, per) = match shown {
        Shown::Speed => ("measured speed", "/s"),
        Shown::Output => ("measured output", ""),
    };
    let unit = joint.output_unit.as_ref().map(|unit| format!("{unit}{per}"));
    let input = bracketed("held input", joint.input_unit.as_deref());
    format!("{} at {input}", bracketed(what, unit.as_deref()))
}

/// Adds the points, and the laws drawn through them.
pub(super) fn add(rows: &mut Layers<'_>, evidence: &Evidence) -> Result<(), RecordError> {
    let figures = || evidence.figures.iter();
    let own: Vec<_> = (0..evidence.figures.len()).map(palette::model).collect();
    // The first one has none before it.
    let before: Vec<_> = own.first().into_iter().chain(&own).take(own.len()).copied().collect();
    let proposed = vec![palette::PROPOSED; own.len()];
    let fallen = vec![palette::DOWN; own.len()];
    for (name, which, rgbs, radius) in
        [("before", 1, &before, 2.0), ("proposed", 2, &proposed, 2.0), ("law", 0, &own, 3.0)]
    {
        let laws = figures().map(|figure| figure.curve(which));
        rows.strips(name, Ink::ByRow(rgbs.clone()), radius, laws)?;
    }
    rows.strips("uncertain", palette::MEASURED, 0.8, figures().map(Figure::uncertain))?;
    let simulated = figures().map(Figure::simulated);
    rows.points("simulated", Ink::ByRow(own.clone()), 3.5, simulated)?;
    rows.points("points", palette::MEASURED, 4.0, figures().map(Figure::measured))?;
    rows.points("fallen", palette::DOWN, 4.0, figures().map(Figure::fallen))?;
    for (name, which, rgbs) in [
        ("law_name", 0, own),
        ("before_name", 1, before),
        ("proposed_name", 2, proposed),
        ("fallen_name", 3, fallen),
    ] {
        rows.texts(name, Ink::ByRow(rgbs), figures().map(|figure| figure.legend(which)))?;
    }
    Ok(())
}
