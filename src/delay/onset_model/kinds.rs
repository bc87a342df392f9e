//! What shapes leave over at the kinds of steps, and a shape for each kind where one for all fails.

use super::residual::Residual;
use super::search::{Candidate, Search};
use super::shape::Shapes;
use super::uncertainty::Choice;
use super::windows::{Onsets, Pass, Step};
use crate::delay::neutral::Transition;

/// Steps of a kind from which its own residuals say something, and may have a shape of their own.
const FEWEST_OF_KIND: usize = 6;

/// Passes over the windows of a record once its shape is known.
pub(super) const PASSES: usize = 3;

pub(super) const KINDS: usize = Transition::ALL.len();

/// What shapes leave over, in all windows, in those of each kind of step, and in those of steps down
/// and up.
pub(super) struct Left {
    /// The delay from which onsets were found.
    pub(super) typical: f64,
    pub(super) pass: Pass,
    pub(super) found: Vec<Onsets>,
    pub(super) residual: Residual,
    pub(super) kinds: [Residual; KINDS],
    pub(super) directions: [Residual; 2],
}

impl Left {
    pub(super) fn of(search: &Search, shapes: Shapes, typical: f64) -> Self {
        let mut pass = search.pass(shapes, typical);
        let found = search.found(&mut pass, search.starting(typical), PASSES);
        let residual = Residual::of(&search.runs, &found, &pass, |_| true);
        let of = |is_one: &dyn Fn(&Step) -> bool| {
            let steps = search.runs.iter().flat_map(|run| &run.steps);
            let is_enough = steps.filter(|step| is_one(step)).count() >= FEWEST_OF_KIND;
            let own = || Residual::of(&search.runs, &found, &pass, is_one);
            if is_enough { own() } else { residual }
        };
        let kinds = Transition::ALL.map(|kind| of(&|step| step.kind == kind));
        let directions = [0, 1].map(|direction| of(&|step| step.direction() == direction));
        Self { typical, pass, found, residual, kinds, directions }
    }

    pub(super) fn is_misfit(&self, plain: f64) -> bool {
        let parts = self.kinds.iter().chain(&self.directions).chain([&self.residual]);
        parts.into_iter().any(|it| it.pattern.is_plain(plain))
    }

    /// These with the shapes that kinds of steps have of their own, found in samples `factor` times as
    /// long, where these fit; and the choice for each kind.
    pub(super) fn with_own(
        self,
        (own, common): ([Option<Choice>; KINDS], Choice),
        (search, factor): (&Search, f64),
        plain: f64,
    ) -> (Self, [Choice; KINDS]) {
        let mut shapes = self.pass.shapes;
        for (kind, choice) in Transition::ALL.into_iter().zip(&own) {
            shapes.set(kind, choice.as_ref().map_or(shapes.of(kind), |it| it.shape.scaled(factor)));
        }
        let all = Self::of(search, shapes, self.typical);
        let fits = |kind: Transition| !all.kinds[kind as usize].pattern.is_plain(plain);
        // A kind that no shape fits keeps that of all.
        let choices = Transition::ALL.map(|kind| {
            let own = own[kind as usize].clone().filter(|_| fits(kind));
            if own.is_none() {
                shapes.set(kind, self.pass.shapes.of(kind));
            }
            own.unwrap_or_else(|| common.clone())
        });
        let left =
            if shapes == all.pass.shapes { all } else { Self::of(search, shapes, self.typical) };
        (left, choices)
    }
}

impl Search {
    pub(super) fn steps_of(&self, kind: Transition) -> usize {
        self.runs.iter().flat_map(|run| &run.steps).filter(|step| step.kind == kind).count()
    }

    /// The choice among shapes for the steps of each kind by themselves, where there are enough. What one
    /// kind needs beyond the simplest of them may be no lag: it is unsure by how much that moves onsets.
    pub(super) fn by_kind(&self, chosen: &Candidate) -> [Option<Choice>; KINDS] {
        let all =
            self.evaluate(chosen.shape, self.starting(chosen.typical), chosen.typical, PASSES);
        let enough = |kind: &Transition| self.steps_of(*kind) >= FEWEST_OF_KIND;
        let own = Transition::ALL
            .map(|kind| Some(kind).filter(enough).map(|_| self.select_within(&all, Some(kind))));
        let shapes = own.iter().flatten().filter_map(|(_, it)| Some(it.first()?.shape));
        let simplest = shapes.min_by_key(|shape| (shape.order(), shape.curved));
        own.map(|own| {
            let (search, candidates) = own?;
            let choice = Choice::of(&search, &candidates)?;
            Some(choice.or_behind(simplest?, &search, candidates.first()?))
        })
    }
}
