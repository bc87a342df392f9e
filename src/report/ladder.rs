//! The ladder of errors: a row per revision of a model, those of its history and those made now.

use super::TextTable;
use crate::diagnosis::{Comparison, sensor_noise};
use crate::experiment::Joint;
use crate::explain::{Change, Revision as Step};
use crate::model::{Fitted, JointModel, Revision, RevisionErrors};
use crate::wording::{self, effect_ids, effects_named, effects_text, with_unit};

/// What the file of a model says of how it came about.
#[derive(Clone, Copy, Debug, Default)]
pub struct History<'a> {
    /// Its revisions.
    pub revisions: &'a [Revision],
    /// What its numbers were fitted to.
    pub fitted: Option<&'a Fitted>,
}

/// A model before effects were added to it.
#[derive(Clone, Copy, Debug)]
pub enum Before<'a> {
    /// As it was given.
    Model(&'a Comparison),
    /// As its history began, which led to the first of these revisions.
    History(History<'a>, &'a [Step]),
}

impl Before<'_> {
    /// The error by which it is judged.
    pub(super) fn rmse(&self) -> Option<f64> {
        match self {
            Self::Model(comparison) => comparison.judged().map(|error| error.rmse),
            Self::History(history, _) => history.fitted?.start.as_ref()?.judged(),
        }
    }

    /// Ids of the effects that `model` has and it has not.
    pub(super) fn gained(&self, model: &JointModel) -> Vec<&'static str> {
        let had = match self {
            Self::Model(comparison) => effect_ids(&comparison.fit.model),
            Self::History(history, revisions) => history.first_effects(revisions),
        };
        effect_ids(model).into_iter().filter(|id| !had.contains(id)).collect()
    }
}

/// A revision on the ladder.
#[derive(Clone, Debug)]
pub(super) struct LadderRow {
    pub(super) number: u32,
    /// What it changed; of the first, its effects.
    pub(super) change: String,
    pub(super) errors: RevisionErrors,
}

/// The errors of a model, as the ladder and the history of a model file have them.
pub(crate) fn errors_of(comparison: &Comparison) -> RevisionErrors {
    let Comparison { training, validation, raw, free, lack_of_fit, .. } = comparison;
    let fit = validation.map(|error| error.fit_percent);
    RevisionErrors {
        train_rmse: training.map(|error| error.rmse),
        validation_rmse: validation.map(|error| error.rmse),
        rmse_raw: raw.judged(),
        rmse_free: free.judged(),
        fit_percent: fit.filter(|fit| fit.is_finite()),
        lack_of_fit: lack_of_fit.map(wording::lack_of_fit),
    }
}

/// What the [`figures`] are called.
const FIGURES: [&str; 7] =
    ["training", "validation", "raw", "free run", "fit", "noise", "lack of fit"];

/// Error on both parts, raw and of a free run, fit in percent, noise of the sensor and lack of fit,
/// for a table.
pub(super) fn figures(joint: &Joint, errors: &RevisionErrors) -> [String; 7] {
    let dash = || "-".to_owned();
    let unit = joint.output_unit.as_deref();
    let output = |value: Option<f64>| value.map_or_else(dash, |value| with_unit(value, unit));
    [
        output(errors.train_rmse),
        output(errors.validation_rmse),
        output(errors.rmse_raw),
        output(errors.rmse_free),
        errors.fit_percent.map_or_else(dash, |fit| format!("{fit:.1} %")),
        output(sensor_noise(&joint.trials)),
        errors.lack_of_fit.clone().unwrap_or_else(dash),
    ]
}

/// A table of errors: in each row what two columns called `first` say, and the [`figures`] of a model.
pub(super) fn errors_table(
    first: [&str; 2],
    rows: impl Iterator<Item = ([String; 2], [String; 7])>,
) -> TextTable {
    let header = first.into_iter().chain(FIGURES).map(str::to_owned).collect();
    let rows = rows.map(|(first, figures)| first.into_iter().chain(figures).collect());
    TextTable { header, rows: rows.collect(), numbers: (2..8).collect() }
}

/// What the error is called by which revisions are judged, from whether each has a validation part.
pub(crate) fn judged_error(mut are_validated: impl Iterator<Item = bool>) -> &'static str {
    if are_validated.all(|is_validated| is_validated) { "validation error" } else { "error" }
}

/// What a revision changed: `+ dead_band`; of the first, the effects that it has.
pub(crate) fn change_in_words(revision: &Step) -> String {
    match revision.change {
        Change::Start => effects_text(&revision.comparison.fit.model),
        Change::Added(id) => format!("+ {id}"),
        Change::Removed(id) => format!("− {id}"),
        Change::Replaced { old, new } => format!("+ {new}, − {old}"),
    }
}

impl History<'_> {
    /// The rows of the ladder: those of the history, where they are known, and those of the
    /// revisions of the model that it led to, the first of which has number `first`.
    pub(super) fn rows(&self, first: u32, revisions: &[Step]) -> Vec<LadderRow> {
        let own = (first..).zip(revisions).map(|(number, revision)| LadderRow {
            number,
            change: change_in_words(revision),
            errors: errors_of(&revision.comparison),
        });
        let mut rows = self.earlier(&self.first_effects(revisions));
        let mut own: Vec<_> = own.collect();
        // The model that is given is the last revision of its history.
        let last = rows.pop_if(|row| row.number == first);
        if let Some((given, last)) = own.first_mut().zip(last) {
            given.change = last.change;
        }
        rows.extend(own);
        rows
    }

    /// The rows up to the model that is given, whose history began with these effects.
    fn earlier(&self, effects: &[&str]) -> Vec<LadderRow> {
        let Some(first) = self.revisions.first() else { return Vec::new() };
        let start = self.fitted.and_then(|fitted| fitted.start.clone());
        let start = start.map(|errors| LadderRow {
            number: first.revision.saturating_sub(1),
            change: effects_named(effects),
            errors,
        });
        let row = |revision: &Revision| {
            let added = revision.added.iter().map(|id| format!("+ {id}"));
            let removed = revision.removed.iter().map(|id| format!("− {id}"));
            let change = added.chain(removed).collect::<Vec<_>>().join(", ");
            LadderRow { number: revision.revision, change, errors: revision.errors.clone() }
        };
        start.into_iter().chain(self.revisions.iter().map(row)).collect()
    }

    /// The effects before the first revision: those of the model that is given, the changes of the
    /// history undone from the last to the first.
    fn first_effects<'a>(&'a self, revisions: &'a [Step]) -> Vec<&'a str> {
        let given = revisions.first().map(|first| effect_ids(&first.comparison.fit.model));
        let mut effects: Vec<&str> = given.unwrap_or_default();
        for revision in self.revisions.iter().rev() {
            effects.retain(|id| Some(*id) != revision.added.as_deref());
            effects.extend(revision.removed.as_deref());
        }
        effects
    }
}

/// The ladder of errors as a table.
pub(super) fn ladder_table(joint: &Joint, rows: &[LadderRow]) -> TextTable {
    let row = |row: &LadderRow| {
        ([row.number.to_string(), row.change.clone()], figures(joint, &row.errors))
    };
    errors_table(["revision", "change"], rows.iter().map(row))
}
