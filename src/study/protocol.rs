//! By what rules models are judged, and who watches the work.

use crate::experiment::Other;
use crate::explain::Workers;
use crate::fit::{Horizon, Split};

/// What becomes of a model before it is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// A plain integrator that the estimated delays suggest, fitted.
    Integrator,
    /// The given model, fitted from its values.
    Fit,
    /// The given model, fitted from its values; a plain integrator where none is given.
    FitOrIntegrator,
    /// The given model as it is.
    AsItIs,
}

/// Who sees how much work there is, and each time that a piece of it is done.
pub(crate) trait Watch: Sync {
    /// So many pieces of work have come up.
    fn more(&self, pieces: usize);

    /// One of them is done.
    fn done(&self);
}

/// Nobody.
impl Watch for () {
    fn more(&self, _: usize) {}

    fn done(&self) {}
}

/// A protocol, who watches the work, and joints of the log of which no model is wanted: a
/// [`Protocol`] alone is watched by nobody, and all joints are worked on.
#[derive(Clone, Copy)]
pub struct Watched<'a> {
    pub(super) protocol: Protocol,
    pub(super) watch: &'a dyn Watch,
    pub(super) others: &'a [Other<'a>],
}

impl std::fmt::Debug for Watched<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watched").field("protocol", &self.protocol).finish_non_exhaustive()
    }
}

impl<'a> Watched<'a> {
    /// With further joints that share the supply.
    #[must_use]
    pub fn beside(self, others: &'a [Other<'a>]) -> Self {
        Self { others, ..self }
    }

    /// `workers`, whose pieces are watched.
    pub(super) fn workers<W>(self, workers: &'a W) -> WatchedWorkers<'a, W> {
        WatchedWorkers { workers, watch: self.watch }
    }
}

impl From<Protocol> for Watched<'_> {
    fn from(protocol: Protocol) -> Self {
        Self { protocol, watch: &(), others: &[] }
    }
}

impl Protocol {
    /// This protocol, the work being watched. A piece is a fit, or a pair of candidates that
    /// is separated; more pieces come up as the work goes on.
    pub(crate) fn watched(self, watch: &dyn Watch) -> Watched<'_> {
        Watched { protocol: self, watch, others: &[] }
    }
}

/// By what rules models are judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Protocol {
    /// What becomes of a model first.
    pub mode: Mode,
    /// How the record is split into training and validation; as [`Split::of`] says without it.
    pub split: Option<Split>,
    /// How long a simulation runs before it is set right.
    pub horizon: Horizon,
}

/// Workers whose pieces are watched.
pub(super) struct WatchedWorkers<'a, W> {
    workers: &'a W,
    watch: &'a dyn Watch,
}

impl<W: Workers> Workers for WatchedWorkers<'_, W> {
    fn map<T: Sync, R: Send>(&self, pieces: &[T], work: impl Fn(&T) -> R + Sync + Send) -> Vec<R> {
        self.watch.more(pieces.len());
        self.workers.map(pieces, |piece| {
            let result = work(piece);
            self.watch.done();
            result
        })
    }
}
