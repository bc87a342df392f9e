//! What is said of a result, each thing once: what programs and people call it, its kind, its unit
//! and its value. Files for programs, tables for people, pages and recordings walk the same list.

use serde_json::{Map, Value};

use super::{DataTable, Kind, TextTable};
use crate::experiment::{Joint, Trial};
use crate::wording::{bracketed, number, samples_text, with_unit};

/// Something that is said of a result, whose value the function `V` computes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fact<V> {
    /// The column of a file, the field of a JSON object.
    pub(crate) id: &'static str,
    pub(crate) kind: Kind,
    pub(crate) value: V,
    /// Which files have it.
    pub(super) part: Part,
    /// What people call it: a heading.
    name: &'static str,
    /// What that is, where the name alone does not say it.
    pub(super) meaning: &'static str,
    unit: Unit,
    shown: &'static [Place],
}

/// The files that have a fact, each part with those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Part {
    /// Tables of what the paper defines.
    Paper,
    /// All tables.
    Table,
    /// JSON.
    Json,
    /// None: it says for people what others say for programs.
    People,
}

/// Where a person reads a fact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// The table on the terminal.
    Terminal,
    /// The table of a report.
    Report,
    /// The short table of a report: what deserves a look.
    Doubtful,
    /// The table of a recording.
    Recording,
    /// The page of a recording on one result.
    Verdict,
}

/// What a number is counted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unit {
    None,
    /// The number of a sample, from 1 in its trial.
    Sample,
    /// A length of time in samples.
    Samples,
    Seconds,
    /// The output's, with what stands after it.
    Output(&'static str),
}

/// What people call a fact, what that is, its unit, and where it stands.
pub(super) type Said = (&'static str, &'static str, Unit, &'static [Place]);

/// For programs alone.
pub(super) const UNSAID: Said = ("", "", Unit::None, &[]);

/// A fact of the files of `part`.
pub(super) const fn fact<V: Copy>(
    id: &'static str,
    kind: Kind,
    part: Part,
    (name, meaning, unit, shown): Said,
    value: V,
) -> Fact<V> {
    Fact { id, kind, value, part, name, meaning, unit, shown }
}

impl<V: Copy> Fact<V> {
    /// Whether tables for programs have it.
    pub(crate) fn is_in_tables(&self) -> bool {
        self.part <= Part::Table
    }

    pub(crate) fn is_shown(&self, place: Place) -> bool {
        self.shown.contains(&place)
    }

    /// The name with the unit that it has in `joint`, or of all joints.
    fn heading(&self, joint: Option<&Joint>) -> String {
        let output = joint.and_then(|joint| joint.output_unit.as_deref());
        match self.unit {
            Unit::None | Unit::Sample => self.name.to_owned(),
            Unit::Samples => bracketed(self.name, Some("samples")),
            Unit::Seconds => bracketed(self.name, Some("s")),
            Unit::Output(per) => {
                bracketed(self.name, output.map(|unit| format!("{unit}{per}")).as_deref())
            }
        }
    }

    /// What it is called in a row of its own: `breakpoint q`.
    pub(crate) fn label(&self) -> String {
        [self.meaning, self.name].join(" ").trim().to_owned()
    }

    /// What its name stands for: `q: breakpoint`.
    pub(super) fn explained(&self) -> String {
        format!("{}: {}", self.name, self.meaning)
    }

    /// A value in a cell, whose heading has the unit.
    fn cell(&self, value: &Value) -> String {
        match (self.unit, value) {
            (_, Value::Null) => "-".to_owned(),
            (_, Value::String(text)) => text.clone(),
            (Unit::Sample, value) => sample_text(value),
            (_, value) => value.as_f64().map_or_else(|| value.to_string(), number),
        }
    }

    /// A value in words, with its unit; in seconds as well where it counts samples of `trial`.
    pub(crate) fn in_words(&self, value: &Value, joint: &Joint, trial: &Trial) -> String {
        let Some(of) = value.as_f64() else { return self.cell(value) };
        let is_fine = of.fract() != 0.0;
        let seconds = |seconds: f64| {
            let decimals = if is_fine { 5 } else { 3 };
            format!("{seconds:.decimals$} s")
        };
        let period_s = trial.period().seconds();
        match self.unit {
            Unit::None => self.cell(value),
            Unit::Sample => {
                let at = seconds(trial.time_s(1) + (of - 1.0) * period_s);
                format!("sample {} = {at}", sample_text(value))
            }
            Unit::Samples => format!("{} = {}", samples_text(of), seconds(of * period_s)),
            Unit::Seconds => with_unit(of, Some("s")),
            Unit::Output(per) => {
                let unit = joint.output_unit.as_ref().map(|unit| format!("{unit}{per}"));
                with_unit(of, unit.as_deref())
            }
        }
    }
}

/// The number of a sample: to two digits after the point where it lies between two.
fn sample_text(value: &Value) -> String {
    match value.as_f64() {
        Some(between) if between.fract() != 0.0 => format!("{between:.2}"),
        _ => value.to_string(),
    }
}

/// A number of samples, without a point where it is whole.
pub(super) fn samples(value: Option<f64>) -> Value {
    /// Below it every whole number is one.
    const EXACT: f64 = 9_007_199_254_740_992.0;
    #[expect(clippy::cast_possible_truncation, reason = "it is whole and below 2^53")]
    match value {
        Some(value) if value.fract() == 0.0 && value.abs() < EXACT => (value as i64).into(),
        value => value.into(),
    }
}

/// The columns of a file with the facts up to `part`.
pub(super) fn columns<V>(
    facts: &[Fact<V>],
    part: Part,
) -> impl Iterator<Item = (&'static str, Kind)> {
    facts.iter().filter(move |fact| fact.part <= part).map(|fact| (fact.id, fact.kind))
}

/// What is said of a result `R`.
type Facts<R> = [Fact<fn(&R) -> Value>];

/// The facts of `row` up to `part` by their ids.
pub(super) fn object<R>(facts: &Facts<R>, part: Part, row: &R) -> Map<String, Value> {
    let own = facts.iter().filter(|fact| fact.part <= part);
    own.map(|fact| (fact.id.to_owned(), (fact.value)(row))).collect()
}

/// A table for people at `place`; the units are those of `joint`. A column in which no row has a value
/// is there only where the paper defines it.
pub(super) fn text_table<R>(
    facts: &Facts<R>,
    place: Place,
    joint: Option<&Joint>,
    rows: impl Iterator<Item = R>,
) -> TextTable {
    let rows: Vec<R> = rows.collect();
    let shown = facts.iter().filter(|fact| fact.is_shown(place)).map(|fact| {
        let cells: Vec<Value> = rows.iter().map(fact.value).collect();
        (fact, cells)
    });
    let shown = shown.filter(|(fact, cells)| {
        fact.part == Part::Paper || cells.iter().any(|cell| !cell.is_null())
    });
    let shown: Vec<_> = shown.collect();
    let row = |row: usize| shown.iter().map(|(fact, cells)| fact.cell(&cells[row])).collect();
    let numbers = shown.iter().enumerate().filter(|(_, (fact, _))| fact.kind != Kind::Text);
    TextTable {
        numbers: numbers.map(|(column, _)| column).collect(),
        header: shown.iter().map(|(fact, _)| fact.heading(joint)).collect(),
        rows: (0..rows.len()).map(row).collect(),
    }
}

/// The facts up to `part` of each of `rows`, as a table for programs.
pub(super) fn data_table<R>(
    facts: &Facts<R>,
    part: Part,
    rows: impl Iterator<Item = R>,
) -> DataTable {
    let mut table = DataTable::new(columns(facts, part));
    for row in rows {
        let own = facts.iter().filter(|fact| fact.part <= part);
        table.push_cells(own.map(|fact| (fact.value)(&row)));
    }
    table
}
