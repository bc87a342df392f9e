//! The delay against the state, for the terminal.

use super::TextTable;
use crate::delay::{AgainstOfKind, AgainstState, Correlation};
use crate::wording::{bracketed, p_cell};

/// A row per joint, kind of step and variable; `joints` are names and what was found.
pub fn against_table<'a>(joints: impl IntoIterator<Item = (&'a str, &'a AgainstState)>) -> String {
    let mut table = TextTable::new(AGAINST_HEADER, &[3, 4, 5]);
    let mut confounded = Vec::new();
    for (joint, found) in joints {
        for cells in against_rows(joint, found) {
            table.row(cells);
        }
        confounded
            .extend(confounded_sentences(found).into_iter().map(|one| format!("{joint}: {one}\n")));
    }
    let note = format!("{CORRECTED}; `yes`: p at most 0.05");
    format!("{table}\n{note}\n{}", confounded.concat())
}

/// What the record does not tell apart, a sentence for each pair.
pub(super) fn confounded_sentences(found: &AgainstState) -> Vec<String> {
    let of_kind = |kind: &AgainstOfKind| {
        let transition = kind.transition;
        let sentence = move |[one, other]: &[String; 2]| {
            format!(
                "in steps of the kind `{transition}` {} and {} are correlated, so the record does \
                 not show on which of them the delay depends",
                variable_text(one, None),
                variable_text(other, None)
            )
        };
        kind.confounded.iter().map(sentence).collect::<Vec<_>>()
    };
    found.kinds.iter().flat_map(of_kind).collect()
}

/// What is said once of every p-value of the delay against the state.
pub(super) const CORRECTED: &str = "Spearman's rank correlation ρ of the delay with each quantity, \
                                    and p after Holm's correction for their number";

/// What the cells of [`against_rows`] are.
pub(super) const AGAINST_HEADER: [&str; 7] =
    ["joint", "kind of step", "delay against", "steps", "rank correlation", "p", "depends"];

/// The rows of a joint, for people: those of each kind of step for itself. Of a kind with
/// fewer steps than any comparison needs there is one row.
pub(super) fn against_rows(joint: &str, found: &AgainstState) -> Vec<[String; 7]> {
    found.kinds.iter().flat_map(|kind| kind_rows(joint, kind)).collect()
}

fn kind_rows(joint: &str, kind: &AgainstOfKind) -> Vec<[String; 7]> {
    let is_known = |one: &Correlation| one.p_value.is_some();
    let name = kind.transition.to_string();
    if !kind.correlations.iter().any(is_known) {
        let dash = || "-".to_owned();
        let steps = kind.steps.to_string();
        let why = "too few steps, or no change".to_owned();
        return vec![[joint.to_owned(), name, why, steps, dash(), dash(), answer(None)]];
    }
    let full = |[a, b, c, d, e]: [String; 5]| [joint.to_owned(), name.clone(), a, b, c, d, e];
    kind.correlations.iter().map(correlation_row).map(full).collect()
}

fn correlation_row(found: &Correlation) -> [String; 5] {
    let Correlation { variable, unit, steps, rho, p_value, p_holm, significant } = found;
    let rho = rho.map_or_else(|| "-".to_owned(), |rho| format!("{rho:+.2}"));
    [
        variable_text(variable, unit.as_deref()),
        steps.to_string(),
        rho,
        p_cell(*p_holm),
        answer(p_value.map(|_| *significant)),
    ]
}

/// A variable with its unit, where there is one.
pub(crate) fn variable_text(variable: &str, unit: Option<&str>) -> String {
    bracketed(&variable.replace('_', " "), unit)
}

fn answer(significant: Option<bool>) -> String {
    match significant {
        None => "not known".to_owned(),
        Some(true) => "yes".to_owned(),
        Some(false) => "not shown".to_owned(),
    }
}
