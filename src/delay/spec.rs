//! What a method says of itself, and the handle by which settings name it.

use std::fmt;
use std::hash::{Hash, Hasher};

use crate::numerics::LowPass;

/// What a method says of itself: help, defaults, tables and pages follow from it.
#[derive(Debug)]
pub struct MethodSpec {
    /// Its name in options and files, in kebab case.
    pub id: &'static str,
    /// What it fits, in few words.
    pub fits: &'static str,
    /// Who described it, and where.
    pub source: Option<&'static str>,
    /// What it does, in a line of help.
    pub summary: &'static str,
    /// Whether it finds the response behind the delays, over all trials of a joint, and gives each delay
    /// an interval. The decisions of others depend on no sample behind the next step, and come in steps
    /// of β.
    pub has_intervals: bool,
    /// Its low-pass where no other is asked for; none where it looks at the output as it
    /// was measured, since smoothing removes from noise what intervals are made of.
    pub low_pass: Option<LowPass>,
    /// How sure a reaction must be where nothing else is asked for: see
    /// [`Settings::confidence`](super::Settings::confidence).
    pub confidence: Option<f64>,
}

/// How a delay is found: one of [`Method::all`].
#[derive(Clone, Copy)]
pub struct Method(&'static MethodSpec);

impl Method {
    /// The handle of the method that says so of itself.
    pub(super) const fn of(spec: &'static MethodSpec) -> Self {
        Self(spec)
    }

    /// What it says of itself.
    pub fn spec(self) -> &'static MethodSpec {
        self.0
    }

    /// Its name in options and files.
    pub fn id(self) -> &'static str {
        self.0.id
    }
}

impl PartialEq for Method {
    /// Ids are unique.
    fn eq(&self, other: &Self) -> bool {
        self.id() == other.id()
    }
}

impl Eq for Method {}

impl Hash for Method {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.id().hash(state);
    }
}

impl fmt::Debug for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.id())
    }
}
