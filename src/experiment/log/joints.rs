//! The joints of a log: cells checked, trials cut and put on a uniform grid.

use super::cells::Log;
use super::missing::Filled;
use crate::experiment::error::{ReadError, ReadErrorKind};
use crate::experiment::grid::{Grid, Piece, Repair, Signals};
use crate::experiment::joint::{Joint, Signal};
use crate::experiment::layout::{JointLayout, SignalColumn};
use crate::experiment::table::TrialRows;
use crate::experiment::trial::{Trial, no_shorter};

/// Memory of a sample of a signal: the number as it was read, on its grid and in its trial, and
/// what is made of it until its delays are known.
const SAMPLE_SIZE: usize = 8 * size_of::<f64>();

impl Log<'_> {
    /// A joint on `grids`, or on its own where more of its output is filled than the clock's gaps; and what
    /// should be known of how it was read.
    pub(in crate::experiment) fn joint(
        &self,
        layout: &JointLayout,
        grids: &[Grid],
    ) -> Result<(Joint, Vec<String>), ReadError> {
        self.check_joint(layout)?;
        let (layout, unread) = self.with_readable_covariates(layout);
        let layout = &layout;
        self.check_one_series(layout.output.column)?;
        let (filled, mut notes) = self.missing(layout, grids)?;
        let own = filled.map(|(_, fill_s)| Repair { fill_s: Some(fill_s), ..self.options });
        let own = own.map(|options| self.grids(options)).transpose()?;
        let grids = own.as_ref().map_or(grids, |(own, _)| own);
        notes.extend(unread);
        let (joint, split) = self.on_grids(layout, grids, filled.map(|(filled, _)| filled))?;
        notes.extend(shown(split));
        Ok((joint, notes))
    }

    /// The joint on `grids`, and a line on each trial that is split.
    fn on_grids(
        &self,
        layout: &JointLayout,
        grids: &[Grid],
        filled: Option<Filled>,
    ) -> Result<(Joint, Vec<String>), ReadError> {
        let origin_s = self.origin_s();
        let covariates: Vec<Signal> = layout.covariates.iter().map(|c| c.signal.clone()).collect();
        let (mut trials, mut split) = (Vec::new(), Vec::new());
        let size = (2 + covariates.len()) * SAMPLE_SIZE;
        for (index, (rows, grid)) in self.table.trials.iter().zip(grids).enumerate() {
            self.budget.take_values(grid.samples(), size)?;
            let pieces = grid.pieces(self.signals(layout, rows));
            if pieces.len() > 1 {
                split.push(self.split_note(rows, &pieces, grid));
            }
            let labels = part_labels(&rows.label, pieces.len(), &self.table.trials);
            for (label, piece) in labels.into_iter().zip(pieces) {
                let between = piece.filled.clone();
                let trial = trial(layout, label, grid, piece)?;
                let trial = match filled {
                    Some(Filled::Readings) => trial.with_interpolated(between),
                    Some(Filled::Pauses) => {
                        let pauses = self.pauses(index, &trial);
                        trial.with_unlogged(pauses)
                    }
                    None => trial,
                };
                trials.push(trial.counted_from(origin_s));
            }
        }
        if trials.is_empty() {
            let text = format!("joint `{}` has no usable sample", layout.name);
            return Err(ReadError::new(ReadErrorKind::Empty, text));
        }
        let joint = Joint {
            name: layout.name.clone(),
            input_unit: layout.input.signal.unit.clone(),
            output_unit: layout.output.signal.unit.clone(),
            covariates,
            trials: trials.into(),
        };
        Ok((joint, split))
    }

    /// A line on a trial that was split in `pieces` at gaps, the longest of which it names.
    fn split_note(&self, trial: &TrialRows, pieces: &[Piece], grid: &Grid) -> String {
        let period = grid.period().seconds();
        let gap = |pair: &[Piece]| {
            let last_s = pair[0].start_s + (pair[0].signals.output.len() - 1) as f64 * period;
            (pair[1].start_s - last_s, self.row(trial.start + pair[1].first_row))
        };
        let longest = pieces.windows(2).map(gap).max_by(|a, b| a.0.total_cmp(&b.0));
        let (label, count) = (&trial.label, pieces.len());
        let one = if count == 2 { "of" } else { "the longest of" };
        // Where the clock starts anew no time passes.
        let gap = longest
            .filter(|(seconds, _)| *seconds > 0.0)
            .map(|(seconds, row)| format!(" ({one} {} s, before row {row})", no_shorter(seconds)));
        let gap = gap.unwrap_or_default();
        format!("trial `{label}` is split in {count} at long gaps{gap}")
    }

    /// The joint without the further signals that have bad cells, and a line on each of these: what drives
    /// and what it does are there without them.
    fn with_readable_covariates(&self, layout: &JointLayout) -> (JointLayout, Vec<String>) {
        let (mut readable, mut notes) = (layout.clone(), Vec::new());
        readable.covariates.retain(|SignalColumn { signal, column, .. }| {
            let error = self.bad_cell(*column);
            notes.extend(
                error.iter().map(|e| format!("the signal `{}` is left out: {e}", signal.name)),
            );
            error.is_none()
        });
        (readable, notes)
    }

    /// Refuses bad cells, and signals without a number that can be reckoned with.
    fn check_joint(&self, layout: &JointLayout) -> Result<(), ReadError> {
        let needed = [layout.input.column, layout.output.column];
        if let Some(error) = needed.into_iter().find_map(|column| self.bad_cell(column)) {
            return Err(error);
        }
        let unusable = |index: usize| {
            let column = self.column(index)?;
            let error = if column.values.iter().all(|value| value.is_nan()) {
                let text = "there is no number in it; choose another column";
                ReadError::new(ReadErrorKind::Empty, text)
            } else {
                let text = format!(
                    "its largest number, {:e}, is too small: its square is below double precision; write it \
                     in a smaller unit",
                    column.too_small()?
                );
                ReadError::content(text)
            };
            Some(error.in_column(self.header(index)))
        };
        needed.into_iter().find_map(unusable).map_or(Ok(()), Err)
    }

    fn signals(&self, layout: &JointLayout, rows: &TrialRows) -> Signals {
        let cut = |column: usize| {
            let values = self.values(column).get(rows.start..rows.end);
            values.unwrap_or_default().to_vec()
        };
        // A logger that notes an input when it changes does not note it anew where a trial begins.
        let mut input = cut(layout.input.column);
        if let Some(first) = input.first_mut().filter(|first| first.is_nan()) {
            let before = self.values(layout.input.column).get(..rows.start).unwrap_or_default();
            *first = before.iter().rfind(|value| !value.is_nan()).copied().unwrap_or(f64::NAN);
        }
        Signals {
            input,
            output: cut(layout.output.column),
            covariates: layout.covariates.iter().map(|c| cut(c.column)).collect(),
        }
    }
}

fn trial(
    layout: &JointLayout,
    label: String,
    grid: &Grid,
    piece: Piece,
) -> Result<Trial, ReadError> {
    let Signals { input, output, covariates } = piece.signals;
    let trial = Trial::new(label, piece.start_s, grid.period(), input, output)
        .and_then(|trial| trial.with_covariates(covariates));
    trial.map_err(|error| ReadError::content(format!("joint `{}`: {error}", layout.name)))
}

/// The first few of notes of one kind.
fn shown(mut split: Vec<String>) -> Vec<String> {
    const SHOWN: usize = 3;
    if let Some(more) = split.len().checked_sub(SHOWN).filter(|more| *more > 0) {
        split.truncate(SHOWN);
        split.push(format!("{more} more trials are split at long gaps"));
    }
    split
}

/// Names of the parts of a trial that was split: `a#1`, `a#2`, with as many marks as it
/// takes to meet no other trial.
fn part_labels(label: &str, parts: usize, trials: &[TrialRows]) -> Vec<String> {
    if parts == 1 {
        return vec![label.to_owned()];
    }
    let mut stem = format!("{label}#");
    while trials.iter().any(|trial| trial.label.starts_with(&stem)) {
        stem.push('#');
    }
    (1..=parts).map(|part| format!("{stem}{part}")).collect()
}
