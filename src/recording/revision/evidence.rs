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
        let before = at.checked_sub(1).and_then(|before| laws.get(before)).cloned();
        figures.push(Figure {
            names: names(joint, shown),
            x,
            y,
            points: held.clone(),
            laws: [
                Some((still.legend(number, &step.comparison.fit.model, joint), own)),
                before.map(|law| (format!("revision {}", number - 1), law)),
                proposed.map(|candidate| (format!("with {}", candidate.name()), next)),
            ],
        });
    }
    Evidence { held, laws, figures }
}

/// What is shown of a level, and what is over it.
fn names(joint: &Joint, shown: Shown) -> [String; 2] {
    let (what, per) = match shown {
        Shown::Speed => ("measured speed", "/s"),
        Shown::Output => ("measured output", ""),
    };
    let unit = joint.output_unit.as_ref().map(|unit| format!("{unit}{per}"));
    let input = bracketed("held input", joint.input_unit.as_deref());
    [input, bracketed(what, unit.as_deref())]
}
