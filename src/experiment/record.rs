//! The trials of a joint and what they show, each property found once.
//!
//! Whether the input is made of steps, at which level the joint stands still, how large the
//! noise is: estimation, fits, diagnosis, notes, recording and report ask for the same
//! properties. Each is defined in the room to which it belongs, by [`Property`], and found when
//! somebody first asks for it.

use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::ops::Deref;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::trial::Trial;

/// What can be found from the trials of a joint alone, whatever the settings.
pub trait Property: Sized + Send + Sync + 'static {
    /// Finds it. Ask for it by [`Record::property`], which does this once.
    fn find(record: &Record) -> Self;
}

/// The trials of a joint, in the order of the log, and what they show.
///
/// Reads like a slice of [`Trial`]s and doesn't change: other trials are another record. A clone is
/// the same record, and takes no memory.
#[derive(Clone, Default)]
pub struct Record {
    trials: Arc<Vec<Trial>>,
    /// A property by its type. Clones share them.
    found: Arc<Mutex<HashMap<TypeId, Found>>>,
}

/// A property, or the place where it will be.
type Found = Arc<OnceLock<Arc<dyn Any + Send + Sync>>>;

impl Record {
    /// A property of these trials: computed by the first thread that asks, while others wait for it.
    pub fn property<T: Property>(&self) -> Arc<T> {
        let place = {
            let mut found = self.found.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(found.entry(TypeId::of::<T>()).or_default())
        };
        // Not under the lock: properties are found by way of others.
        let found = place.get_or_init(|| Arc::new(T::find(self)));
        Arc::clone(found).downcast().unwrap_or_else(|_| Arc::new(T::find(self)))
    }
}

impl Deref for Record {
    type Target = [Trial];

    fn deref(&self) -> &[Trial] {
        &self.trials
    }
}

impl From<Vec<Trial>> for Record {
    fn from(trials: Vec<Trial>) -> Self {
        Self { trials: Arc::new(trials), found: Arc::default() }
    }
}

impl<const COUNT: usize> From<[Trial; COUNT]> for Record {
    fn from(trials: [Trial; COUNT]) -> Self {
        trials.into_iter().collect()
    }
}

impl FromIterator<Trial> for Record {
    fn from_iter<I: IntoIterator<Item = Trial>>(trials: I) -> Self {
        trials.into_iter().collect::<Vec<_>>().into()
    }
}

impl IntoIterator for Record {
    type Item = Trial;
    type IntoIter = std::vec::IntoIter<Trial>;

    fn into_iter(self) -> Self::IntoIter {
        Arc::unwrap_or_clone(self.trials).into_iter()
    }
}

impl<'a> IntoIterator for &'a Record {
    type Item = &'a Trial;
    type IntoIter = std::slice::Iter<'a, Trial>;

    fn into_iter(self) -> Self::IntoIter {
        self.trials.iter()
    }
}

impl PartialEq for Record {
    fn eq(&self, other: &Self) -> bool {
        self.trials == other.trials
    }
}

impl std::fmt::Debug for Record {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use crate::units::SamplePeriod;

    fn record(output: f64) -> Record {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        [Trial::new("1", 0.0, period, vec![0.0; 3], vec![output; 3]).unwrap()].into()
    }

    /// How often each of them was found.
    static FOUND: AtomicUsize = AtomicUsize::new(0);

    #[derive(Debug, PartialEq)]
    struct Largest(f64);

    impl Property for Largest {
        fn find(record: &Record) -> Self {
            FOUND.fetch_add(1, Ordering::Relaxed);
            Self(record.iter().flat_map(Trial::output).copied().fold(f64::MIN, f64::max))
        }
    }

    struct Samples(usize);

    impl Property for Samples {
        fn find(record: &Record) -> Self {
            Self(record.iter().map(Trial::len).sum())
        }
    }

    struct Double(f64);

    impl Property for Double {
        fn find(record: &Record) -> Self {
            Self(2.0 * record.property::<Largest>().0)
        }
    }

    #[test]
    fn a_property_is_found_once_for_all_who_ask() {
        let record = record(3.0);
        let same = record.clone();
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| assert_eq!(*record.property::<Largest>(), Largest(3.0)));
            }
        });
        assert!((same.property::<Double>().0 - 6.0).abs() <= 0.0);
        assert_eq!(FOUND.load(Ordering::Relaxed), 1);
    }

    #[test]
    fn other_trials_have_properties_of_their_own() {
        let one = record(1.0);
        let period = one[0].period();
        let other: Record = [Trial::new("1", 0.0, period, vec![0.0], vec![1.0]).unwrap()].into();
        assert_eq!((one.property::<Samples>().0, other.property::<Samples>().0), (3, 1));
        assert_ne!(one, other);
    }
}
