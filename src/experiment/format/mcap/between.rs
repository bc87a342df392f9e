//! Rows between the messages of a slow output, so that the steps of a command keep their times.

use super::restarts::interval;
use super::series::Series;

/// What a step may come late by, and how far rows are apart then, nanoseconds.
const LATE: i64 = 10_000_000;

/// Rows for each message, at most.
const MOST: i64 = 10;

/// Usual intervals beyond which nothing is known between two messages, as in tables.
const LONGEST: f64 = 3.0;

/// Rows between the messages of a topic.
pub(super) struct Between {
    /// Nanoseconds; those of the messages among them.
    pub(super) times: Vec<i64>,
    /// For each, the message at it or before it, and whether it is that message's own.
    places: Vec<(usize, bool)>,
}

impl Between {
    /// Rows between messages at these `times`, where a value that is `held` comes later than by
    /// [`LATE`] without them.
    pub(super) fn of(times: &[i64], held: &[Series]) -> Option<Self> {
        let usual = interval(times)?;
        let needed = |parts: &i64| *parts as f64 * LATE as f64 >= usual;
        let parts = (1..MOST).find(needed).unwrap_or(MOST);
        if parts < 2 || !held.iter().any(|held| comes_late(held, times)) {
            return None;
        }
        let mut rows = Self { times: Vec::new(), places: Vec::new() };
        for (index, pair) in times.windows(2).enumerate() {
            let step = pair[1].saturating_sub(pair[0]);
            let parts = if step as f64 <= LONGEST * usual { parts } else { 1 };
            for part in 0..parts {
                rows.times.push(pair[0].saturating_add(step / parts * part));
                rows.places.push((index, part == 0));
            }
        }
        rows.times.extend(times.last());
        rows.places.push((times.len() - 1, true));
        Some(rows)
    }

    /// The `values` of the messages at their rows, and NaN between them: what is missing there is filled
    /// where it is an output.
    pub(super) fn sparse(&self, values: &[f64]) -> Vec<f64> {
        let value = |(index, is_own): &(usize, bool)| match values.get(*index) {
            Some(value) if *is_own => *value,
            _ => f64::NAN,
        };
        self.places.iter().map(value).collect()
    }

    /// Where the rows stand in the file, the messages of which are at these `places`; one between them behind
    /// all that comes at its time.
    pub(super) fn in_file(&self, places: &[u32]) -> Vec<u32> {
        let place = |(index, is_own): &(usize, bool)| match places.get(*index) {
            Some(place) if *is_own => *place,
            _ => u32::MAX,
        };
        self.places.iter().map(place).collect()
    }

    /// The `values` of the messages at the rows, each held up to the next.
    pub(super) fn held(&self, values: &[f64]) -> Vec<f64> {
        let value = |(index, _): &(usize, bool)| values.get(*index).copied().unwrap_or(f64::NAN);
        self.places.iter().map(value).collect()
    }
}

/// Whether a new value of a topic comes more than [`LATE`] before the first of `times` that has it.
fn comes_late(held: &Series, times: &[i64]) -> bool {
    let mut rows = times.iter().peekable();
    let is_new = |index: usize| {
        held.columns.iter().any(|column| match column.values.get(index - 1..=index) {
            Some([before, value]) => (value - before).abs() > 0.0,
            _ => false,
        })
    };
    held.times.iter().enumerate().skip(1).any(|(index, sent)| {
        while rows.next_if(|row| *row < sent).is_some() {}
        let is_between = sent > &times[0];
        is_between && rows.peek().is_some_and(|row| *row - sent > LATE) && is_new(index)
    })
}
