//! Rows of one time that say the same, or complete one another: those of a logger that is faster than its
//! bus, and of a table that has a row for each sensor. They are one row.

use crate::experiment::log::{Log, repeats};

/// Part of the rows that repeat a time, at least: of fewer the clock says what they are.
const REPEATED: f64 = 0.1;

/// Joins rows with the one before that has their time, where no two of these contradict each other.
pub(super) fn join(log: &mut Log<'_>) {
    let times = &mut log.times;
    let repeats = repeats(times, &log.table.trials);
    if repeats.len() as f64 <= REPEATED * times.len() as f64 {
        return;
    }
    let mut is_repeat = vec![false; times.len()];
    for row in &repeats {
        is_repeat[*row] = true;
    }
    let table = &mut log.table;
    let columns = table.columns.iter().map(|column| joined(&column.values, &is_repeat));
    let Some(columns) = columns.collect::<Option<Vec<_>>>() else { return };
    let are_copies = columns.iter().all(|(_, are_copies)| *are_copies);
    let is_kept = |row: &usize| repeats.binary_search(row).is_err();
    let place = |row: usize| row - repeats.partition_point(|repeat| *repeat < row);
    let kept: Vec<usize> = (0..table.rows.len()).filter(is_kept).collect();
    *times = kept.iter().filter_map(|row| times.get(*row).copied()).collect();
    for trial in &mut table.trials {
        (trial.start, trial.end) = (place(trial.start), place(trial.end));
    }
    table.rows = kept.iter().filter_map(|row| table.rows.get(*row).copied()).collect();
    for (column, (values, _)) in table.columns.iter_mut().zip(columns) {
        column.values = values;
    }
    let count = repeats.len();
    log.notes.push(if are_copies {
        format!("{count} rows are copies of the row before, and left out")
    } else {
        format!(
            "{count} rows have the time of the row before and only values that it lacks: they \
             are merged with it"
        )
    });
}

/// The numbers of a column with those that repeat a time joined with the one before, and whether these are
/// copies all; `None` where one says something else.
fn joined(values: &[f64], is_repeat: &[bool]) -> Option<(Vec<f64>, bool)> {
    let mut joined: Vec<f64> = Vec::with_capacity(values.len());
    let mut are_copies = true;
    for (value, is_repeat) in values.iter().zip(is_repeat) {
        match joined.last_mut().filter(|_| *is_repeat) {
            None => joined.push(*value),
            Some(last) if last.to_bits() == value.to_bits() => {}
            Some(last) if last.is_nan() || value.is_nan() => {
                are_copies = false;
                *last = if last.is_nan() { *value } else { *last };
            }
            Some(_) => return None,
        }
    }
    Some((joined, are_copies))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_row_lacks_another_of_its_time_has() {
        let nan = f64::NAN;
        let is_repeat = [false, true, false, true, true];
        let (values, are_copies) = joined(&[nan, 1.0, 2.0, nan, 2.0], &is_repeat).unwrap();
        assert_eq!((values.as_slice(), are_copies), (&[1.0, 2.0][..], false));
        assert!(joined(&[1.0, 1.0, nan, nan, nan], &is_repeat).unwrap().1);
        assert_eq!(joined(&[1.0, 2.0, 2.0, 2.0, 2.0], &is_repeat), None);
        assert_eq!(joined(&[1.0, 1.0, 2.0, nan, 3.0], &is_repeat), None);
    }
}
