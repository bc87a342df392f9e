//! What a log's columns are taken for, as a table.

use super::text_table::TextTable;
use crate::experiment::{Role, Survey, SurveyedColumn};

/// A row per column: what it is taken for and why; what is open; as `options` the mapping, then those that
/// could be meant as well; and what is `mended` in the log.
pub(crate) fn columns_table(survey: &Survey, options: &[String], mended: &[String]) -> String {
    let row = |column: &SurveyedColumn| {
        let unit = column.unit.clone().unwrap_or_default();
        [column.name.clone(), role(column), unit, column.why.clone()]
    };
    let rows = survey.columns.iter().map(row);
    let table = TextTable::of(["column", "taken for", "unit", "why"], &[], rows);
    let mut text = format!("{table}\n");
    let mut lines = survey.open.clone();
    for (place, options) in options.iter().enumerate() {
        lines.push(format!("{}: {options}", if place == 0 { "as options" } else { "or" }));
    }
    lines.extend(mended.iter().map(|what| format!("where it is read: {what}")));
    for line in lines {
        text += &line;
        text.push('\n');
    }
    text
}

/// What a column is taken for, in words.
pub(super) fn role(column: &SurveyedColumn) -> String {
    match &column.role {
        Role::Time => "time".to_owned(),
        Role::Trial => "trial".to_owned(),
        Role::Input(joint) => format!("input of {joint}"),
        Role::Output(joint) => format!("output of {joint}"),
        Role::Other => "other".to_owned(),
    }
}
