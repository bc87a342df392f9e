//! The conditions of one decision, packed: a long log has a hundred thousand decisions.

use super::condition::{Check, Condition, Outcome};

/// How many conditions are checked.
const COUNT: usize = Condition::ALL.len();

/// Every condition of a decision, in the order of [`Condition::ALL`], in less than half of the
/// memory of a list of [`Check`]s.
#[derive(Clone, Debug, PartialEq)]
pub struct Checks {
    /// The value and the limit of each condition, those that there are.
    numbers: Box<[f64]>,
    outcomes: [Outcome; COUNT],
    /// A bit for each condition that has a value; that of the first is the lowest.
    with_value: u16,
    /// A bit for each condition that has a limit; that of the first is the lowest.
    with_limit: u16,
}

impl Checks {
    /// Packs `checks`, which are in the order of [`Condition::ALL`].
    pub(super) fn of(checks: &[Check; COUNT]) -> Self {
        let bits = |has: fn(&Check) -> bool| {
            let ones = checks.iter().enumerate().filter(|(_, check)| has(check));
            ones.fold(0, |bits, (index, _)| bits | 1 << index)
        };
        Self {
            numbers: checks.iter().flat_map(|check| [check.value, check.limit]).flatten().collect(),
            outcomes: checks.each_ref().map(|check| check.outcome),
            with_value: bits(|check| check.value.is_some()),
            with_limit: bits(|check| check.limit.is_some()),
        }
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = Check> + '_ {
        let mut numbers = self.numbers.iter().copied();
        let mut next = move |bits: u16, index: usize| {
            if bits >> index & 1 == 1 { numbers.next() } else { None }
        };
        Condition::ALL.into_iter().enumerate().map(move |(index, condition)| Check {
            condition,
            value: next(self.with_value, index),
            limit: next(self.with_limit, index),
            outcome: self.outcomes[index],
        })
    }

    /// Those that failed.
    pub fn failed(&self) -> impl Iterator<Item = Check> + '_ {
        self.iter().filter(|check| check.outcome == Outcome::Failed)
    }

    /// Puts a check in the place of that of its condition.
    pub(super) fn put(&mut self, found: Check) {
        let mut checks = Condition::ALL.map(|condition| Check { condition, ..found });
        for (check, old) in checks.iter_mut().zip(self.iter()) {
            if old.condition != found.condition {
                *check = old;
            }
        }
        *self = Self::of(&checks);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_packed_is_what_comes_out() {
        let number = |index: usize| (index % 3 != 1).then_some(index as f64 - 4.0);
        let mut index = 0;
        let checks = Condition::ALL.map(|condition| {
            index += 1;
            let outcomes = [Outcome::Passed, Outcome::Failed, Outcome::NotChecked];
            let outcome = outcomes[index % 3];
            Check { condition, value: number(index), limit: number(index + 1), outcome }
        });
        let mut packed = Checks::of(&checks);
        assert!(packed.iter().eq(checks));
        assert_eq!(packed.failed().count(), 3);
        let other = Check { value: None, limit: Some(7.0), ..checks[5] };
        packed.put(other);
        let expected =
            checks.map(|check| if check.condition == Condition::Sse { other } else { check });
        assert!(packed.iter().eq(expected));
    }

    #[test]
    fn they_take_less_than_half_of_a_list() {
        assert!(2 * size_of::<Checks>() < COUNT * size_of::<Check>());
    }
}
