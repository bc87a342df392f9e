//! Outputs of sensors that begin anew, after a turn or with their zero set anew, made to go on.

use super::cells::Log;
use super::times::Clock;
use crate::experiment::joint::Joint;
use crate::experiment::layout::JointLayout;
use crate::experiment::sampling::Repair;
use crate::experiment::shift::Shifts;
use crate::experiment::table::TrialRows;
use crate::experiment::time_column::TimeSource;
use crate::experiment::wrap::Wrap;
use crate::numerics::{median, to_digits};

/// What is taken out of the outputs of a joint, and what was.
pub(super) struct Continuous {
    wrap: Option<Wrap>,
    shifts: Option<Shifts>,
    turns: usize,
    /// Rows behind jumps, and how far these go.
    shifted: Vec<(usize, f64)>,
}

impl Log<'_> {
    /// What is to be taken out of the outputs of a joint.
    pub(super) fn continuous(
        &self,
        layout: &JointLayout,
        trials: &[TrialRows],
        time: TimeSource,
        repair: Repair,
    ) -> Continuous {
        let wrap = self.wrap(layout, trials, repair);
        let shifts = if wrap.is_none() { self.shifts(layout, trials, time, repair) } else { None };
        Continuous { wrap, shifts, turns: 0, shifted: Vec::new() }
    }

    /// The turn after which the output of a joint wraps. Of a log that still grows it is
    /// not known.
    fn wrap(&self, layout: &JointLayout, trials: &[TrialRows], repair: Repair) -> Option<Wrap> {
        let output = self.column(layout.output.column).filter(|_| !repair.as_it_stands)?;
        let values = |rows: &TrialRows| output.values.get(rows.start..rows.end);
        let trials: Vec<&[f64]> = trials.iter().filter_map(values).collect();
        Wrap::of(&trials, layout.output.signal.unit.as_deref())
    }

    /// How far from row to row the output of a joint jumps whose zero is set anew; rows behind a gap lie
    /// as far apart as it moved there, and where the clock starts anew so does the record. Of what wraps, and of a log that still grows, it is not known.
    fn shifts(
        &self,
        layout: &JointLayout,
        trials: &[TrialRows],
        time: TimeSource,
        repair: Repair,
    ) -> Option<Shifts> {
        /// Times the usual distance of rows that two are apart, at most.
        const NEAR: f64 = 1.5;
        if repair.as_it_stands {
            return None;
        }
        let [input, output] =
            [&layout.input, &layout.output].map(|signal| self.column(signal.column));
        let (input, output) = (&input?.values, &output?.values);
        let of = |rows: &TrialRows| {
            Some([input.get(rows.start..rows.end)?, output.get(rows.start..rows.end)?])
        };
        let signals: Vec<[&[f64]; 2]> = trials.iter().filter_map(of).collect();
        let shifts = Shifts::of(&signals)?;
        let Clock::Stamps(times) = self.times(time).ok()? else { return Some(shifts) };
        let apart = |rows: &TrialRows| {
            let times = times.get(rows.start..rows.end)?;
            let apart: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let most = NEAR * median(&apart)?;
            let mut jumps = shifts.jumps(output.get(rows.start..rows.end)?);
            Some(jumps.all(|row| apart.get(row - 1).is_some_and(|by| (0.0..=most).contains(by))))
        };
        trials.iter().all(|rows| apart(rows) != Some(false)).then_some(shifts)
    }
}

impl Continuous {
    /// Makes the `output` in the `rows` of a trial go on.
    pub(super) fn make(&mut self, rows: &TrialRows, output: &mut [f64]) {
        self.turns += self.wrap.map_or(0, |wrap| wrap.unwrap(output));
        let jumps = self.shifts.map_or_else(Vec::new, |shifts| shifts.put_back(output));
        self.shifted.extend(jumps.into_iter().map(|(row, by)| (rows.start + row, by)));
    }

    /// A line on what was taken out of the outputs of `joint`; `number` is what messages call a row.
    pub(super) fn note(&self, joint: &Joint, number: impl Fn(usize) -> u64) -> Option<String> {
        let (name, unit) = (&joint.name, joint.output_unit.as_deref());
        if let Some(wrap) = self.wrap.filter(|_| self.turns > 0) {
            return Some(format!("joint `{name}`: {}", wrap.note(self.turns, unit)));
        }
        let (row, by) = self.shifted.first()?;
        let unit = unit.map_or_else(String::new, |unit| format!(" {unit}"));
        let (row, by) = (number(*row), to_digits(*by, 3));
        let more = match self.shifted.len() {
            1 => String::new(),
            2 => ", and once more".to_owned(),
            count => format!(", and {} times more", count - 1),
        };
        Some(format!(
            "joint `{name}`: the output jumps by {by}{unit} at row {row}{more}, much farther than it moves \
             between any other rows: taken for a sensor that was re-zeroed, and later samples are shifted \
             back by as much"
        ))
    }
}
