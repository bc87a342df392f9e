//! Where the output starts to react to one step of the input, and where it may.

use crate::delay::motion::StepMotion;
use crate::units::{ceil_to_index, floor_to_index};

/// Positions of each onset that are tried at a time.
const TRIED: usize = 10;

/// An onset in the path; positions are indices of the trial's samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Onset {
    /// Where the step's own input changes: delays count from here.
    pub(crate) origin: usize,
    /// Where it may be.
    pub(crate) earliest: usize,
    pub(crate) latest: usize,
    /// Samples that are looked at, at most.
    pub(super) within: (usize, usize),
    /// Where the next step's input changes.
    pub(super) next: usize,
    /// Where it is, as far as is known.
    pub(crate) position: f64,
    /// Standard error of the position, samples; 0 where it is not known.
    pub(crate) error: f64,
    /// Whether it bounds its neighbours: whether it is more than noise makes.
    pub(crate) counts: bool,
    /// Whether the joint was shown to stand still: nothing bounds its neighbours then.
    pub(crate) at_rest: bool,
    /// Whether its window is its own, whatever its neighbours do.
    pub(crate) alone: bool,
}

impl Onset {
    /// Bounds it by what the output does about its step.
    pub(super) fn narrow(&mut self, motion: &StepMotion) {
        self.within = (self.within.0.max(motion.first), self.within.1.min(motion.end));
        self.latest = self.latest.min(motion.latest);
        self.earliest = self.earliest.min(self.latest);
        self.at_rest = motion.rest.is_some_and(|rest| rest.lasts());
        self.alone = motion.rest.is_some();
        self.counts = !self.at_rest;
        self.position = self.origin.midpoint(self.latest.min(self.next)) as f64;
    }

    /// Whether it has room before the next step of the input.
    pub(super) fn in_time(&self) -> bool {
        /// Samples that a reaction needs before the next one may be.
        const ROOM: f64 = 10.0;
        self.position + ROOM < self.next as f64
    }

    /// Samples about its position in which it may be as well.
    pub(crate) fn guard(&self) -> usize {
        /// Standard errors.
        const STANDARD_ERRORS: f64 = 2.0;
        /// Samples; a position that is known less well is taken for known so well.
        const LARGEST: f64 = 20.0;
        let guard = (STANDARD_ERRORS * self.error).min(LARGEST);
        if self.error.is_finite() { floor_to_index(guard) } else { 0 }
    }

    /// The latest position that is this step's own: what comes after the next change of the
    /// input is, for one that was in time.
    pub(crate) fn last_position(&self) -> usize {
        /// Samples by which it may come later than it was found.
        const SLACK: usize = 3;
        // A reaction that came before the next step is not looked for behind the next one's.
        let own = ceil_to_index(self.position) + SLACK;
        if self.position < self.next as f64 {
            own.max(self.next).min(self.latest)
        } else {
            self.latest
        }
    }

    /// A few positions over all that may be.
    pub(super) fn spread(&self) -> Vec<usize> {
        let range = self.latest.saturating_sub(self.origin);
        let position = |n: usize| self.origin + 1 + range * n / TRIED;
        let mut positions: Vec<usize> = (0..TRIED).map(position).collect();
        positions.dedup();
        positions
    }

    /// Some positions between the neighbours of `at` among those that were `tried`.
    pub(super) fn around(&self, tried: &[usize], at: usize) -> Vec<usize> {
        let index = tried.iter().position(|position| *position == at).unwrap_or(0);
        let low = index.checked_sub(1).and_then(|i| tried.get(i)).unwrap_or(&self.origin);
        let high = tried.get(index + 1).unwrap_or(&self.latest).max(low);
        let position = |n: usize| low + (high - low) * n / TRIED;
        let mut positions: Vec<usize> = (1..TRIED).map(position).chain([at]).collect();
        positions.sort_unstable();
        positions.dedup();
        positions
    }
}
