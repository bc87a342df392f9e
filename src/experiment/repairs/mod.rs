//! What is mended in a log before its rows are put on a grid, in one order.
//!
//! What depends on the period of the clock, as rows that are lost or out of order, is seen where the
//! stamps are read: in [`super::clock`].

mod bursts;
mod rezeroed;
mod same_time;
mod slow_sensor;
mod wrap;

use super::error::ReadError;
use super::log::Log;
use super::table::TrialRows;

/// Mends everything in `log` that may be: the rows before their times, the times before the signals. What
/// depends on rows that a growing log does not have yet is not mended in one.
///
/// # Errors
/// [`ReadError`] where its times cannot be read.
pub(super) fn mend_all(log: &mut Log<'_>) -> Result<(), ReadError> {
    let is_whole = !log.options.as_it_stands;
    join_stamps(log);
    if is_whole {
        turn_newest_first(log);
    }
    log.read_times()?;
    leave_out_single_rows(log);
    if is_whole {
        same_time::join(log);
        bursts::spread_out(log);
    }
    if log.options.is_free() {
        log.mend_outputs(slow_sensor::first_readings);
    }
    if is_whole {
        // A turn is a jump, too: of what wraps it is not known where its zero is set anew.
        log.mend_outputs(|log, joint| {
            wrap::unwrap(log, joint).or_else(|| rezeroed::put_back(log, joint))
        });
    }
    Ok(())
}

/// Stamps in two columns, whole seconds and what they leave over, as those of ROS are, become one. Where
/// the second column holds more than parts of a second, each says the time by itself.
fn join_stamps(log: &mut Log<'_>) {
    let columns = log.layout.time.column().zip(log.layout.time_rest);
    let Some((whole, (rest, unit_s))) = columns else { return };
    let Some((seconds, parts)) = log.column(whole).zip(log.column(rest)) else { return };
    let is_part = |part: &f64| part.is_nan() || (0.0..1.0).contains(&(unit_s * part));
    let is_whole = |value: &f64| value.is_nan() || value.fract() == 0.0;
    let are_two = parts.values.len() == seconds.values.len()
        && parts.values.iter().all(is_part)
        && seconds.values.iter().all(is_whole);
    let parts = parts.values.clone();
    if let Some(seconds) = log.column_mut(whole).filter(|_| are_two) {
        seconds.values.iter_mut().zip(parts).for_each(|(value, part)| *value += unit_s * part);
    }
    let (whole, rest) = (log.head.text(whole), log.head.text(rest));
    let and = if are_two { format!(" and `{rest}`") } else { format!("; `{rest}` is not used") };
    log.notes.push(format!("the times are those in `{whole}`{and}"));
}

/// Turns a table whose newest row is the first, as some data bases write them.
fn turn_newest_first(log: &mut Log<'_>) {
    let times = log.layout.time_column().and_then(|column| log.column(column));
    if times.is_some_and(|times| falls(&times.values)) {
        log.table.turn();
        let note = "the newest row is first: the rows are read from the last to the first";
        log.notes.push(note.to_owned());
    }
}

/// Whether each of `times` but a few is smaller than the one before it.
fn falls(times: &[f64]) -> bool {
    /// Part of the rows that may be out of order, and how many show an order (chosen).
    const OUT_OF_ORDER: f64 = 0.1;
    const FEWEST: usize = 3;
    let falling = times.windows(2).filter(|pair| pair[1] < pair[0]).count();
    let rising = times.windows(2).filter(|pair| pair[1] > pair[0]).count();
    falling >= FEWEST && rising as f64 <= OUT_OF_ORDER * falling as f64
}

/// Leaves out trials of one row, from which no period follows, as where a counter of trials is late by a
/// row. Where all are of one row, that is an error of the log.
fn leave_out_single_rows(log: &mut Log<'_>) {
    let is_long = |trial: &TrialRows| trial.end > trial.start + 1;
    if !log.table.trials.iter().any(is_long) {
        return;
    }
    let (long, alone): (_, Vec<_>) =
        std::mem::take(&mut log.table.trials).into_iter().partition(is_long);
    log.table.trials = long;
    let Some(TrialRows { label, .. }) = alone.first() else { return };
    let count = alone.len();
    log.notes.push(if count == 1 {
        format!("trial `{label}` has one row only and is left out")
    } else {
        format!("{count} trials have one row only and are left out, the first is `{label}`")
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_that_fall_are_told_from_a_clock_that_restarts_or_stands_still() {
        assert!(falls(&[3.0, 2.0, 1.0, 0.0]));
        for times in [[0.0, 1.0, 0.0, 1.0], [0.0; 4], [0.0, 1.0, 2.0, 1.5]] {
            assert!(!falls(&times), "{times:?}");
        }
    }
}
