//! The delay against the state, for the terminal.

use super::text_table::TextTable;
use crate::delay::{AgainstState, Correlation, Direction};
use crate::wording::{bracketed, p_cell};

/// A row per joint and variable; `joints` are names and what was found.
pub fn against_table<'a>(joints: impl IntoIterator<Item = (&'a str, &'a AgainstState)>) -> String {
    let mut table = TextTable::new(AGAINST_HEADER, &[2, 3, 4]);
    for (joint, found) in joints {
        for cells in against_rows(joint, found) {
            table.row(cells);
        }
    }
    format!("{table}\nSpearman's rank correlation; `yes`: p at most 0.05 after Holm's correction\n")
}

/// What the cells of [`against_rows`] are.
pub(super) const AGAINST_HEADER: [&str; 6] =
    ["joint", "delay against", "steps", "rank correlation", "p", "depends"];

/// The rows of a joint, for people.
pub(super) fn against_rows(joint: &str, found: &AgainstState) -> Vec<[String; 6]> {
    let correlations = found.correlations.iter().map(|one| correlation_row(joint, one));
    correlations.chain([direction_row(joint, &found.direction)]).collect()
}

fn correlation_row(joint: &str, found: &Correlation) -> [String; 6] {
    let Correlation { variable, unit, steps, rho, p_value, significant, .. } = found;
    let rho = rho.map_or_else(|| "-".to_owned(), |rho| format!("{rho:+.2}"));
    [
        joint.to_owned(),
        variable_text(variable, unit.as_deref()),
        steps.to_string(),
        rho,
        p_cell(*p_value),
        answer(p_value.map(|_| *significant)),
    ]
}

/// A variable with its unit, where there is one.
pub(crate) fn variable_text(variable: &str, unit: Option<&str>) -> String {
    bracketed(&variable.replace('_', " "), unit)
}

fn direction_row(joint: &str, found: &Direction) -> [String; 6] {
    let Direction { up, down, median_difference_s, p_value, significant, .. } = found;
    let difference = median_difference_s
        .map_or_else(|| "-".to_owned(), |seconds| format!("up - down {seconds:+.3} s"));
    let steps = format!("{up} up, {down} down");
    let name = "direction".to_owned();
    [
        joint.to_owned(),
        name,
        steps,
        difference,
        p_cell(*p_value),
        answer(p_value.map(|_| *significant)),
    ]
}

fn answer(significant: Option<bool>) -> String {
    match significant {
        None => "not known".to_owned(),
        Some(true) => "yes".to_owned(),
        Some(false) => "not shown".to_owned(),
    }
}
