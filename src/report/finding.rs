//! What `explain` and `improve` have found of a joint, as a table.

use comfy_table::{Table, presets};

use super::ComparedJoint;
use super::compare::align_right;
use crate::effect::Spec;
use crate::experiment::Joint;
use crate::explain::{Candidate, Verdict};
use crate::model::Component;
use crate::wording::{p_text, with_unit};

/// A joint, the verdict on its model, and the race behind it.
#[derive(Clone, Copy, Debug)]
pub struct Finding<'a> {
    /// The model that the verdict is about.
    pub compared: ComparedJoint<'a>,
    /// The verdict.
    pub verdict: Verdict,
    /// The candidates, best first.
    pub ranking: &'a [Candidate],
    /// What stands behind the effect on the command line that adds it.
    pub add_arguments: &'a str,
}

/// The effects that a candidate added, in its order.
pub(super) fn added(candidate: &Candidate) -> impl Iterator<Item = &Component> {
    let components = candidate.fit.model.components();
    let of_id =
        |id: &&'static str| components.iter().find(|component| component.effect().spec().id == *id);
    candidate.effects.iter().filter_map(of_id)
}

pub(super) fn specs(candidate: &Candidate) -> impl Iterator<Item = &'static Spec> {
    added(candidate).map(|component| component.effect().spec())
}

/// The candidates, best first.
pub(super) fn ranking_table(joint: &Joint, ranking: &[Candidate]) -> String {
    let mut table = Table::new();
    let header = ["effect", "validation", "reduction", "chance", "cannot be told from"];
    table.load_style(presets::UTF8_BORDERS_ONLY).set_header(header);
    for candidate in ranking {
        let same = &candidate.indistinguishable_from;
        table.add_row([
            candidate.name(),
            with_unit(candidate.rmse(), joint.output_unit.as_deref()),
            format!("{:.1} %", candidate.error_reduction_percent),
            p_text(candidate.p_value),
            if same.is_empty() { "-".to_owned() } else { same.join(", ") },
        ]);
    }
    align_right(&mut table, 1..3);
    table.to_string()
}
