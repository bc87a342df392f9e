//! Effects that are made while the program runs: of an expression, a signal or a condition.
//!
//! Effects are `'static`, those of the catalogue being constants, and a model may go wherever it
//! likes. Those that are made are never freed either, but each is there once: reading a file
//! again costs nothing.

use std::convert::Infallible;
use std::sync::{Mutex, PoisonError};

/// The effects of one kind that were made so far.
pub(super) struct Interned<T: 'static>(Mutex<Vec<&'static T>>);

impl<T> Interned<T> {
    pub(super) const fn none() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    /// The effect of `key`, which is made where there is none yet.
    pub(super) fn get_or_make<K>(
        &self,
        key: K,
        is_of: impl Fn(&T, &K) -> bool,
        make: impl FnOnce(K) -> T,
    ) -> &'static T {
        let Ok(effect) = self.get_or_try(key, is_of, |key| Ok::<T, Infallible>(make(key)));
        effect
    }

    /// The effect of `key`, which is made where there is none yet, if that succeeds.
    ///
    /// # Errors
    /// That of `make`.
    pub(super) fn get_or_try<K, E>(
        &self,
        key: K,
        is_of: impl Fn(&T, &K) -> bool,
        make: impl FnOnce(K) -> Result<T, E>,
    ) -> Result<&'static T, E> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(same) = known.iter().find(|one| is_of(one, &key)) {
            return Ok(same);
        }
        let new: &'static T = Box::leak(Box::new(make(key)?));
        known.push(new);
        Ok(new)
    }
}

/// A part of an interned effect: as long as that is there, it is.
pub(super) fn part_of_interned<T>(part: T) -> &'static T {
    Box::leak(Box::new(part))
}

/// A text of an interned effect.
pub(super) fn text_of_interned(text: impl Into<Box<str>>) -> &'static str {
    Box::leak(text.into())
}
