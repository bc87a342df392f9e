//! The messages of the topics that are wanted, and their table: a row at each message of one topic, at
//! which the others are held.

use std::collections::{BTreeMap, HashMap};

use super::stream::refused;
use super::topics::{Clock, Topics};
use crate::experiment::clock::between_restarts;
use crate::experiment::error::ReadError;
use crate::experiment::memory::{Budget, NUMBER_SIZE};
use crate::experiment::table::Wanted;
use crate::numerics::median;

/// Time in nanoseconds by which a step may come late, and by which rows are apart then.
const LATE: i64 = 10_000_000;

/// Rows for each message, at most.
const MOST_ROWS: i64 = 10;

/// Usual intervals beyond which nothing is known between two messages, as in tables.
const LONGEST: f64 = 3.0;

/// What is wanted of a topic.
#[derive(Debug, Default)]
pub(super) struct Topic {
    /// Its fields, and the column of each.
    fields: Vec<usize>,
    columns: Vec<usize>,
    /// Messages that have none of the numbers.
    pub(super) empty: usize,
    /// How long before their recording the messages are timed, at least, nanoseconds.
    pub(super) least_lag: Option<i64>,
}

/// What is wanted of a message.
#[derive(Debug)]
pub(super) struct Message {
    /// Its place in the file.
    pub(super) place: usize,
    /// Nanoseconds.
    pub(super) time: i64,
    pub(super) topic: usize,
    /// NaN where it does not have one.
    pub(super) numbers: Vec<f64>,
}

/// The messages, in the order of the file until their table is made.
#[derive(Debug, Default)]
pub(super) struct Messages {
    pub(super) topics: BTreeMap<usize, Topic>,
    pub(super) list: Vec<Message>,
    /// The header of each column.
    headers: Vec<usize>,
}

/// Columns with a value for each row.
#[derive(Debug, Default)]
pub(super) struct Aligned {
    /// Nanoseconds.
    pub(super) times: Vec<i64>,
    pub(super) columns: Vec<Vec<f64>>,
    /// Messages before the first ones of all other topics.
    pub(super) early: usize,
}

impl Messages {
    /// A field of a topic is wanted, for the header with this index.
    pub(super) fn want(&mut self, topic: usize, field: usize, header: usize) {
        let topic = self.topics.entry(topic).or_default();
        topic.fields.push(field);
        topic.columns.push(self.headers.len());
        self.headers.push(header);
    }

    /// The column for the header with this index.
    pub(super) fn column(&self, header: usize) -> Option<usize> {
        self.headers.iter().position(|of| *of == header)
    }

    /// Takes the messages that have any of the numbers that are wanted, at their times by `clock`.
    pub(super) fn take(
        &mut self,
        topics: &Topics,
        clock: Clock,
        budget: &Budget,
    ) -> Result<(), ReadError> {
        for (number, wanted) in &mut self.topics {
            let topic = &topics.list[*number];
            let name = &topic.name;
            if let Some(fault) = &topic.fault {
                return Err(refused(
                    format!("the message of `{name}` {fault}"),
                    "check that it was recorded with the definition that the file holds",
                ));
            }
            let (count, width) = (topic.messages.len(), wanted.fields.len());
            budget.take_values(count, size_of::<Message>() + width * NUMBER_SIZE)?;
            let mut numbers = vec![Vec::new(); count];
            for (column, field) in wanted.fields.iter().enumerate() {
                for (message, value) in &topic.fields[*field].values {
                    numbers[*message].resize(width, f64::NAN);
                    numbers[*message][column] = *value;
                }
            }
            for ((place, times), numbers) in topic.messages.iter().zip(numbers) {
                let Some(time) = times[clock as usize] else {
                    return Err(refused(
                        format!("the messages of `{name}` have no {}", clock.name()),
                        "choose another time column; `log_time` is the time of recording",
                    ));
                };
                let lag = times[Clock::Log as usize].map(|recorded| recorded.saturating_sub(time));
                wanted.least_lag = [wanted.least_lag, lag].into_iter().flatten().min();
                if numbers.is_empty() {
                    wanted.empty += 1;
                } else {
                    let (topic, place) = (*number, *place);
                    self.list.push(Message { place, time, topic, numbers });
                }
            }
        }
        self.list.sort_by_key(|message| message.place);
        Ok(())
    }

    /// All columns at the messages of the clock's topic, and at times between these where it is slow: each
    /// other topic is held from its latest message, of one time the one that the file has first. What comes
    /// before the first message of all others is left out; what begins later is NaN up to there, so that a
    /// joint whose command comes late takes no rows from those beside it.
    pub(super) fn table(&mut self, wanted: &Wanted<'_>) -> Result<Aligned, ReadError> {
        let times: Vec<i64> = times_of(&self.list, wanted.clock).collect();
        if is_set_back(&times) {
            return Err(refused(
                "its clock starts anew, as where a simulation is reset",
                "choose another one with `--time log_time`, or keep one run",
            ));
        }
        self.list.sort_by_key(|message| message.time);
        let columns = vec![Vec::new(); self.headers.len()];
        let mut table = Aligned { columns, ..Aligned::default() };
        let times: Vec<i64> = times_of(&self.list, wanted.clock).collect();
        let parts = rows_per_message(&times, &self.list, wanted.clock);
        let usual = interval(&times).unwrap_or_default();
        let most = times.len().saturating_mul(usize::try_from(parts).unwrap_or(1));
        wanted.budget.take_values(most.saturating_mul(self.headers.len()), NUMBER_SIZE)?;
        let label = wanted.label.and_then(|label| self.column(label));
        let own = self.topics.get(&wanted.clock).map_or(&[][..], |topic| &topic.columns);
        let held: Vec<usize> = (0..self.headers.len()).filter(|at| !own.contains(at)).collect();
        let mut latest = vec![f64::NAN; self.headers.len()];
        let mut add = |time: i64, latest: &[f64], is_between: bool| {
            // Between two messages, what is missing is filled where it is an output.
            if !held.is_empty() && held.iter().all(|column| latest[*column].is_nan()) {
                table.early += usize::from(!is_between);
                return;
            }
            table.times.push(time);
            for (at, (column, value)) in table.columns.iter_mut().zip(latest).enumerate() {
                let is_unknown = is_between && label != Some(at) && own.contains(&at);
                column.push(if is_unknown { f64::NAN } else { *value });
            }
        };
        let (mut between, mut next) = (Vec::new(), times.iter().skip(1));
        for message in &self.list {
            while let Some(time) = between.pop_if(|time| *time < message.time) {
                add(time, &latest, true);
            }
            let Some(topic) = self.topics.get(&message.topic) else { continue };
            let is_own = message.topic == wanted.clock;
            for (column, number) in topic.columns.iter().zip(&message.numbers) {
                if is_own || !number.is_nan() {
                    latest[*column] = *number;
                }
            }
            if is_own {
                add(message.time, &latest, false);
                let step = next.next().map_or(0, |next| next.saturating_sub(message.time));
                let parts = if step as f64 <= LONGEST * usual { parts } else { 1 };
                let time = |part: i64| message.time.saturating_add(step / parts * part);
                between = (1..parts).rev().map(time).collect();
            }
        }
        Ok(table)
    }
}

/// The times of the messages of a topic.
pub(super) fn times_of(list: &[Message], topic: usize) -> impl Iterator<Item = i64> {
    list.iter().filter(move |message| message.topic == topic).map(|message| message.time)
}

/// Whether a clock with these `times`, in the order of the file, starts anew, as where a simulation is reset or a
/// computer's clock is set back. Runs that do not overlap are parts of one record in another order.
fn is_set_back(times: &[i64]) -> bool {
    let Some(usual) = interval(times) else { return false };
    let since_first = |time: &i64| time.saturating_sub(times[0]) as f64;
    let relative: Vec<f64> = times.iter().map(since_first).collect();
    let runs = between_restarts(&relative, usual).unwrap_or_default();
    let ends = |run: &Vec<usize>| {
        let times = || run.iter().map(|row| times[*row]);
        times().min().zip(times().max())
    };
    let mut covered: Vec<(i64, i64)> = runs.iter().filter_map(ends).collect();
    covered.sort_unstable();
    covered.windows(2).any(|pair| pair[1].0 < pair[0].1)
}

/// Rows for each message of the clock at these `times`: more than one where messages are far apart and a value
/// that is held would come later than by [`LATE`] without them.
fn rows_per_message(times: &[i64], run: &[Message], clock: usize) -> i64 {
    let Some(usual) = interval(times).filter(|_| comes_late(run, clock)) else { return 1 };
    let is_enough = |parts: &i64| (parts * LATE) as f64 >= usual;
    (1..MOST_ROWS).find(is_enough).unwrap_or(MOST_ROWS)
}

/// Whether a new value of another topic comes more than [`LATE`] before the next message of the clock.
fn comes_late(run: &[Message], clock: usize) -> bool {
    let (mut before, mut waits, mut is_begun) = (HashMap::new(), None, false);
    for Message { time, topic, numbers, .. } in run {
        if *topic == clock {
            let is_late = waits.take().is_some_and(|sent| time - sent > LATE);
            if std::mem::replace(&mut is_begun, true) && is_late {
                return true;
            }
        } else if let Some(before) = before.insert(*topic, numbers) {
            let is_new = before.iter().zip(numbers).any(|(old, new)| (new - old).abs() > 0.0);
            waits = waits.or(is_new.then_some(*time));
        }
    }
    false
}

/// The usual interval between `times` that follow one another.
fn interval(times: &[i64]) -> Option<f64> {
    let steps = times.windows(2).map(|pair| pair[1].saturating_sub(pair[0]) as f64);
    median(&steps.filter(|step| *step > 0.0).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::MemoryLimit;
    use crate::experiment::table::Head;

    fn times(count: i64, first: i64) -> Vec<i64> {
        (0..count).map(|k| first + 10 * k).collect()
    }

    #[test]
    fn a_clock_that_is_set_back_starts_anew() {
        assert!(is_set_back(&[times(500, 0), times(300, 0)].concat()));
        assert!(is_set_back(&[times(500, 0), times(300, 4900)].concat()));
    }

    #[test]
    fn messages_out_of_order_do_not_start_it_anew() {
        // Later part first, late messages, two publishers, and any order.
        assert!(!is_set_back(&[times(300, 5000), times(500, 0)].concat()));
        let mut late = times(500, 0);
        late[300..303].iter_mut().for_each(|time| *time -= 900);
        assert!(!is_set_back(&late));
        let two: Vec<i64> = times(500, 0).into_iter().flat_map(|time| [time, time - 200]).collect();
        assert!(!is_set_back(&two));
        let wild: Vec<i64> = (0..1000).map(|k| k * 7919 % 1000).collect();
        assert!(!is_set_back(&wild));
        assert!(!is_set_back(&[]));
    }

    /// The table of messages of the topics 0, which gives the rows, and 1, each with its time and its number,
    /// in the order of the file.
    fn table(messages: &[(usize, i64, f64)]) -> Aligned {
        let budget = Budget::new(MemoryLimit::of_bytes(1 << 20));
        let mut all = Messages::default();
        all.want(0, 0, 3);
        all.want(1, 0, 4);
        for (place, (topic, time, number)) in messages.iter().enumerate() {
            let (topic, time, numbers) = (*topic, *time, vec![*number]);
            all.list.push(Message { place, time, topic, numbers });
        }
        let head = Head::without_lines(Vec::new());
        let (head, numeric, budget, grows) = (&head, &[3, 4], &budget, false);
        let wanted = Wanted { head, numeric, label: None, time: None, clock: 0, budget, grows };
        all.table(&wanted).unwrap()
    }

    #[test]
    fn a_value_is_held_from_its_message_on() {
        let found = table(&[
            (1, 10, 1.0),
            (0, 5, 0.0),
            (0, 10, 0.1),
            (0, 19, 0.2),
            (1, 20, 2.0),
            (0, 20, 0.3),
            (1, 20, 3.0),
            (1, 30, f64::NAN),
            (0, 20, 0.4),
            (0, 40, 0.5),
        ]);
        assert_eq!(found.columns[1], [1.0, 1.0, 2.0, 3.0, 3.0]);
        assert_eq!(found.columns[0], [0.1, 0.2, 0.3, 0.4, 0.5]);
        assert_eq!(found.early, 1);
    }

    #[test]
    fn rows_between_messages_hold_no_number_of_theirs() {
        let of_clock = [0, 20, 40, 200, 220].map(|ms: i64| (0, ms * 1_000_000, ms as f64));
        let commands = [(1, 0, 1.0), (1, 22_000_000, 2.0)];
        let found = table(&[&commands[..], &of_clock].concat());
        let times: Vec<i64> = found.times.iter().map(|time| time / 1_000_000).collect();
        assert_eq!(times, [0, 10, 20, 30, 40, 200, 210, 220], "none in the pause");
        assert_eq!(found.columns[1], [1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 2.0]);
        let is_own: Vec<bool> = found.columns[0].iter().map(|value| !value.is_nan()).collect();
        assert_eq!(is_own, [true, false, true, false, true, true, false, true]);
    }
}
