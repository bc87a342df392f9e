//! What a log's columns are taken for, and how much was measured of each joint.

use serde_json::{Value, json};

use super::TextTable;
use super::json::{document, without_empty};
use crate::experiment::{Joint, JointColumns, Role, Survey, SurveyedColumn, Trial};
use crate::wording::{measure, range_text};

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
    lines.extend(mended.iter().map(|what| format!("on reading: {what}")));
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

/// A row per joint: how long it was measured, and in which range.
pub(crate) fn extent<'j>(joints: impl Iterator<Item = &'j Joint>) -> TextTable {
    let header = ["joint", "input", "output", "trials", "samples", "period", "duration"];
    let row = |joint: &Joint| {
        let trials = || joint.trials.iter();
        let samples: usize = trials().map(Trial::len).sum();
        let mut periods: Vec<String> = trials().map(|trial| trial.period().to_string()).collect();
        periods.dedup();
        let period = match periods.as_slice() {
            [one] => one.clone(),
            _ => "several".to_owned(),
        };
        let duration: f64 =
            trials().map(|trial| trial.len() as f64 * trial.period().seconds()).sum();
        [
            joint.name.clone(),
            range_text(trials().flat_map(Trial::input).copied(), joint.input_unit.as_deref()),
            range_text(trials().flat_map(Trial::output).copied(), joint.output_unit.as_deref()),
            joint.trials.len().to_string(),
            samples.to_string(),
            period,
            measure(duration, Some("s")),
        ]
    };
    TextTable::of(header, &[3, 4, 5, 6], joints.map(row))
}

/// The JSON of `survey`, with the mappings as `options` on the command line, the likeliest first, and
/// what is `mended` in the log.
pub(crate) fn columns_json(survey: &Survey, options: &[String], mended: &[String]) -> Value {
    let (options, alternatives) = match options {
        [first, others @ ..] => (first.as_str(), others),
        [] => ("", options),
    };
    let column = |column: &SurveyedColumn| {
        json!({
            "column": column.name,
            "unit": column.unit,
            "taken_for": role(column),
            "why": column.why,
        })
    };
    let joint = |joint: &JointColumns| json!({ "joint": joint.name, "input": joint.input, "output": joint.output });
    let facts = json!({
        "path": survey.path.display().to_string(),
        "columns": survey.columns.iter().map(column).collect::<Value>(),
        "joints": survey.map.joints.iter().map(joint).collect::<Value>(),
        "open": survey.open,
        "options": options,
        "mended": mended,
        "alternatives": alternatives,
    });
    document("tauscope/columns/1", without_empty(facts, &["alternatives"]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::SamplePeriod;

    #[test]
    fn a_joint_has_its_ranges_and_its_time_over_all_trials() {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = |label: &str, top: f64| {
            let input: Vec<f64> = (0..100).map(|k| if k < 50 { -1.0 } else { 2.5 }).collect();
            let output: Vec<f64> = (0..100).map(|k| top * f64::from(k) / 99.0).collect();
            Trial::new(label, 0.0, period, input, output).unwrap()
        };
        let joint = Joint::new("boom", [trial("1", 10.0), trial("2", 30.0)]).with_units("V", "deg");
        let text = extent([joint].iter()).to_string();
        let row = text.lines().find(|line| line.contains("boom")).unwrap();
        let cells: Vec<&str> =
            row.trim_matches('│').split("  ").map(str::trim).filter(|c| !c.is_empty()).collect();
        assert_eq!(cells, ["boom", "-1 to 2.5 V", "0 to 30 deg", "2", "200", "0.01 s", "2 s"]);
    }
}
