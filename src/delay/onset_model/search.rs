//! The shape of a joint, by evidence over all its steps.
//!
//! Each family of responses starts from a grid of its parameters, which Newton's method refines,
//! the windows held; an onset per step is found anew at each of them, so that the parameters are
//! those of least error over the onsets, too (variable projection). Families are compared by
//! the likelihood over the samples of all windows,
//!
//! ```text
//! Σ_i n_i/2 ln(SSE_i/n_i) + m (N/2 + 2 √(N/2)) + 2 N [curved] + (parameters of the shape)/2 · ln n
//! ```
//!
//! with Schwarz's count of the parameters of the shape. A window that something else disturbed counts
//! by the logarithm of its error alone. Each of the `m` states that follow takes from the errors of the
//! `N` windows half of a chi-square variable of `N` degrees of freedom where it is not needed, `N/2 ± √(N/2)`:
//! what it is at the start of a window is left by the step before and no choice, so that noise is all
//! that it must be distinguished from, by two standard deviations. The two sizes of a curved hold are chosen for
//! each window and count as in Akaike's criterion.
//! Shapes whose onsets go far less with the input than those of others have missed them.
//!
//! # References
//! G. H. Golub and V. Pereyra, "The differentiation of pseudo-inverses and nonlinear least squares
//! problems whose variables separate", SIAM Journal on Numerical Analysis 10 (1973); G. Schwarz,
//! "Estimating the dimension of a model", Annals of Statistics 6 (1978).

use super::alignment::{LONGEST, alignments};
use super::dynamics::Before;
use super::follows::Follows;
use super::response::response_of;
use super::shape::{Family, MOST, Shape, Shapes};
use super::windows::{Onset, Onsets, Pass, Run, Step, all};
use crate::delay::neutral::Transition;
use crate::numerics::{Axes, Differences, median};

/// Steps up to which a record is taken as a whole: a disturbed window is then no small part of it,
/// and a curved hold cannot be distinguished from a response.
pub(super) const FEW: usize = 3;
const FEW_FOR_WEIGHTS: usize = 5;

/// Part by which the sizes of onsets may be explained worse than by another shape.
const WORSE: f64 = 0.1;

/// A joint as it is searched.
pub(super) struct Search {
    pub(super) runs: Vec<Run>,
    /// Samples to each side of an onset that are looked at.
    pub(super) reach: usize,
    /// Standard deviation of the sensor's noise.
    pub(super) noise: f64,
    /// Standard deviation below which nothing is left but rounding.
    pub(super) floor: f64,
    /// Median hold, samples.
    pub(super) hold: f64,
    /// Median size of the steps of the input.
    pub(super) change: f64,
    /// The responses that it may have.
    pub(super) families: &'static [Family],
}

/// A shape with its onsets.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    pub(super) shape: Shape,
    /// Of each run.
    pub(super) onsets: Vec<Onsets>,
    /// Median delay of the clear onsets, samples.
    pub(super) typical: f64,
    /// Schwarz's criterion; less is better.
    pub(super) score: f64,
}

/// A round of Newton's method; errors in variances of what is left.
struct Round {
    shape: Shape,
    /// By how much its error is less than before.
    gained: f64,
    /// By how much the error rises to the ends of the axes at most.
    rises: f64,
    /// Those of the next round.
    axes: Axes<MOST>,
}

impl Candidate {
    pub(super) fn found(&self) -> impl Iterator<Item = &Onset> + Clone {
        self.onsets.iter().flat_map(|of_run| of_run.found.iter().flatten())
    }

    /// What windows have for themselves beyond the onset, its size and the motion before it: states that
    /// follow, and sizes of a curved hold.
    pub(super) fn of_windows(&self) -> f64 {
        const DEVIATIONS: f64 = 2.0;
        let windows = self.found().count() as f64;
        let by_noise = windows / 2.0 + DEVIATIONS * (windows / 2.0).sqrt();
        let curved = if self.shape.curved { 2.0 * windows } else { 0.0 };
        self.shape.followers() as f64 * by_noise + curved
    }
}

impl Search {
    pub(super) fn steps(&self) -> usize {
        self.runs.iter().map(|run| run.steps.len()).sum()
    }

    pub(super) fn has_few_steps(&self) -> bool {
        self.steps() <= FEW
    }

    /// Whether a family is tried: of one step the time that a motion lasts is that of its record.
    fn may_be(&self, family: Family) -> bool {
        self.families.contains(&family) && (family != Family::Slew || !self.has_few_steps())
    }

    pub(super) fn pass(&self, shapes: Shapes, typical: f64) -> Pass {
        let longest = self.runs.iter().map(|run| run.output.len()).max().unwrap_or(0);
        let longest = (2 * self.reach).min(longest) + 2;
        let response = |shape| (shape, response_of(&shape, self.reach as f64 / 2.0, longest));
        let responses = shapes.distinct().into_iter().map(response).collect();
        let before = if self.has_few_steps() { Before::Steady } else { Before::Any };
        Pass { responses, shapes, reach: self.reach, typical, noise: self.noise, before }
    }

    /// All onsets so many samples after their steps.
    pub(super) fn starting(&self, delay: f64) -> Vec<Onsets> {
        self.runs.iter().map(|run| Onsets::behind(run, delay)).collect()
    }

    /// The median delay of the clear onsets.
    fn typical(&self, onsets: &[Onsets]) -> Option<f64> {
        let clear = all(&self.runs, onsets).filter(|(.., onset)| onset.is_clear);
        let delays = clear.map(|(run, index, onset)| onset.position - run.steps[index].at);
        median(&delays.collect::<Vec<f64>>())
    }

    /// The onsets of a shape, found in `passes` from where they are taken to be at first.
    pub(super) fn evaluate(
        &self,
        shape: Shape,
        onsets: Vec<Onsets>,
        typical: f64,
        passes: usize,
    ) -> Candidate {
        let mut pass = self.pass(Shapes::shared(shape), typical);
        let onsets = self.found(&mut pass, onsets, passes);
        let (typical, score) = (pass.typical, f64::INFINITY);
        let mut candidate = Candidate { shape, onsets, typical, score };
        candidate.score =
            self.of_error(&candidate) + candidate.of_windows() + self.of_parameters(&candidate);
        candidate
    }

    /// The onsets found in so many passes, and the typical delay in the last of them.
    pub(super) fn found(
        &self,
        pass: &mut Pass,
        mut onsets: Vec<Onsets>,
        passes: usize,
    ) -> Vec<Onsets> {
        for _ in 0..passes {
            for (run, onsets) in self.runs.iter().zip(&mut onsets) {
                onsets.sweep(run, 0..run.steps.len(), pass);
            }
            pass.typical = self.typical(&onsets).unwrap_or(pass.typical);
        }
        if passes > 1 {
            for (run, onsets) in self.runs.iter().zip(&mut onsets) {
                onsets.reassign(run, pass);
            }
        }
        onsets
    }

    /// The shapes that the windows of a candidate support, those of one kind of steps or of all, with what
    /// they were searched in; its own alone where none is more likely. All have the same samples.
    pub(super) fn select_within(
        &self,
        candidate: &Candidate,
        kind: Option<Transition>,
    ) -> (Self, Vec<Candidate>) {
        let same = all(&self.runs, &candidate.onsets)
            .filter(|(run, index, _)| kind.is_none_or(|kind| run.steps[*index].kind == kind));
        let (runs, onsets): (Vec<Run>, Vec<Onsets>) = same.map(alone).unzip();
        let Candidate { shape, typical, .. } = candidate;
        // An output that goes on moving does so in all parts of its windows.
        let moves = shape.family.may_be_curved() && self.families.contains(&Family::Pair);
        let families = if moves { &Family::MOVING } else { self.families };
        let search = Self { runs, families, ..*self };
        let later = onsets.iter().map(|of_run| of_run.later(shape.mean())).collect();
        let bend = search.evaluate(Shape::BEND, later, typical + shape.mean(), 2);
        let shared = search.evaluate(*shape, onsets, *typical, 2);
        let of_shared = shared.score - search.of_parameters(&shared);
        let mut candidates = search.select_near(&bend);
        if candidates.first().is_none_or(|best| best.score >= of_shared) {
            candidates = vec![shared];
        }
        (search, candidates)
    }

    /// The onsets of a candidate with the windows where they are.
    fn held(&self, candidate: &Candidate) -> Vec<Onsets> {
        let pass = self.pass(Shapes::shared(candidate.shape), candidate.typical);
        let pairs = self.runs.iter().zip(&candidate.onsets);
        pairs.map(|(run, onsets)| onsets.held(run, &pass)).collect()
    }

    /// Each onset of `held` as it was, and as it is with `shape`.
    fn moved(&self, held: &[Onsets], shape: Shape, typical: f64) -> Vec<(Onset, Onset)> {
        let pass = self.pass(Shapes::shared(shape), typical);
        let of_run = |(run, was): (&Run, &Onsets)| {
            let mut now = was.clone();
            now.sweep(run, 0..run.steps.len(), &pass);
            was.found.iter().zip(now.found).filter_map(|(was, now)| Some(((*was)?, now?))).collect()
        };
        self.runs.iter().zip(held).flat_map::<Vec<_>, _>(of_run).collect()
    }

    /// What is left over in all windows, in units of the noise: the negative logarithm of its likelihood.
    fn of_error(&self, candidate: &Candidate) -> f64 {
        let [variance, floor] = [self.noise.max(self.floor), self.floor].map(|it| it * it);
        let log = |mean_square: f64| (mean_square.max(floor) / variance).ln();
        let found = || candidate.found();
        let samples = found().map(|onset| onset.samples() as f64).sum::<f64>();
        let windows = found().count();
        if windows == 0 {
            return f64::INFINITY;
        }
        let error = if windows <= FEW_FOR_WEIGHTS {
            samples * log(found().map(|onset| onset.sse).sum::<f64>() / samples)
        } else {
            found().map(|onset| onset.samples() as f64 * log(onset.mean_square())).sum()
        };
        error / 2.0
    }

    /// What Schwarz's criterion adds for the parameters of a shape.
    pub(super) fn of_parameters(&self, candidate: &Candidate) -> f64 {
        let (times, distinct) = self.samples_of(candidate);
        candidate.shape.order() as f64 / 2.0 * times * distinct.ln()
    }

    /// In how many windows a sample of a candidate stands at the mean, since between two onsets each is
    /// in both, and how many samples there are.
    fn samples_of(&self, candidate: &Candidate) -> (f64, f64) {
        let samples: f64 = candidate.found().map(|onset| onset.samples() as f64).sum();
        let distinct: f64 = self.runs.iter().map(|run| run.output.len() as f64).sum();
        let distinct = distinct.min(samples).max(1.0);
        (samples / distinct, distinct)
    }

    /// Half of Akaike's criterion of a candidate, each sample counted once, and what windows have for
    /// themselves as in its score.
    pub(super) fn akaike(&self, candidate: &Candidate) -> f64 {
        let (times, _) = self.samples_of(candidate);
        let order = candidate.shape.order() as f64;
        (candidate.score - self.of_parameters(candidate)) / times.max(1.0) + order
    }

    /// The candidate with the parameters of least error near its own, its windows held and weighted
    /// by what is left in each; at most so many rounds of Newton's method.
    pub(super) fn refined(&self, candidate: Candidate, rounds: usize) -> Candidate {
        /// Less of the error than this is no gain: a small part of a parameter's standard error.
        const LITTLE: f64 = 0.01;
        /// Axes along which it rises by less show where its least is (chosen).
        const SEEN: f64 = 10.0;
        let mut candidate = candidate;
        if candidate.shape.order() == 0 {
            return candidate;
        }
        let (mut axes, mut before) = (Axes::identity() * DISTANCES.1, f64::INFINITY);
        for _ in 0..rounds {
            let round = self.newton_step(&candidate, &axes);
            let Candidate { onsets, typical, .. } = candidate;
            candidate = self.evaluate(round.shape, onsets, typical, 1);
            if round.gained < LITTLE && (round.rises < SEEN || before < LITTLE) {
                break;
            }
            (axes, before) = (round.axes, round.gained);
        }
        candidate
    }

    /// The best of the points at the ends of axes in the parameters and of Newton's.
    fn newton_step(&self, candidate: &Candidate, axes: &Axes<MOST>) -> Round {
        let Candidate { shape, typical, .. } = candidate;
        let held = self.held(candidate);
        let middle = candidate.found().map(Onset::mean_square).collect::<Vec<f64>>();
        let middle = median(&middle).unwrap_or(0.0).max(f64::MIN_POSITIVE);
        let weighted = |(was, now): (Onset, Onset)| now.sse * was.mean_square().max(middle).recip();
        let value = |shape: Shape| -> f64 {
            self.moved(&held, shape, *typical).into_iter().map(weighted).sum()
        };
        let here = value(*shape);
        let mut best = (here, *shape, 0.0);
        let mut at = |by: [f64; MOST]| {
            let moved = shape.moved(by);
            if !moved.is_allowed(self.hold, self.change) {
                return f64::INFINITY;
            }
            let value = value(moved);
            if value < best.0 {
                best = (value, moved, by.into_iter().map(f64::abs).fold(0.0, f64::max));
            }
            value
        };
        let order = shape.order();
        let near: Vec<f64> = Differences::places(order, axes).into_iter().map(&mut at).collect();
        let mut next = *axes;
        if near.iter().all(|value| value.is_finite()) {
            let differences = Differences::<MOST>::of(order, here, &near);
            for farthest in FARTHEST {
                at(differences.step(axes, farthest));
            }
            // Far from the least, what is next to a point says little.
            let (least, most) = DISTANCES;
            next = differences.axes(axes, (least.max(best.2 / 3.0).min(most), most));
        } else {
            next /= 3.0;
        }
        let rises = near.into_iter().fold(0.0, |most, value| f64::max(most, value - here));
        Round { shape: best.1, gained: here - best.0, rises, axes: next }
    }

    /// The shapes that it supports about the onsets of broken lines, the best one first.
    pub(super) fn select_near(&self, bend: &Candidate) -> Vec<Candidate> {
        let mut all = vec![bend.clone()];
        let others = Family::ALL.into_iter().skip(1).filter(|it| self.may_be(*it));
        for family in others {
            let grid = Shape::grid(family, self.hold, self.change).into_iter();
            let found =
                grid.filter(|shape| shape.is_allowed(self.hold, self.change)).flat_map(|shape| {
                    let starts = self.starts(shape, bend);
                    starts.into_iter().map(move |(positions, typical)| (shape, positions, typical))
                });
            let found = found
                .map(|(shape, positions, typical)| self.evaluate(shape, positions, typical, 2));
            all.extend(found.min_by(|a, b| a.score.total_cmp(&b.score)));
        }
        let mut all = self.narrowed(all);
        if !self.has_few_steps() {
            let plain = all.iter().filter(|it| it.shape.family.may_be_curved());
            let curved: Vec<Candidate> = plain
                .map(|it| {
                    let shape = Shape { curved: true, ..it.shape };
                    self.refined(self.evaluate(shape, it.onsets.clone(), it.typical, 2), ROUNDS)
                })
                .collect();
            all.extend(curved);
            self.keep_those_that_follow(&mut all);
        }
        all.sort_by(|a, b| a.score.total_cmp(&b.score));
        self.restarted_at_best(all)
    }

    /// Each candidate started again from the onsets of the best: which reaction belongs to which
    /// step does not depend on the shape.
    fn restarted_at_best(&self, mut all: Vec<Candidate>) -> Vec<Candidate> {
        let Some(best) = all.first().cloned() else { return all };
        for other in &mut all[1..] {
            let later = best.shape.mean() - other.shape.mean();
            let onsets = best.onsets.iter().map(|of_run| of_run.later(later)).collect();
            let again = self.evaluate(other.shape, onsets, best.typical + later, 2);
            if again.score < other.score {
                *other = self.refined(again, ROUNDS);
            }
        }
        all.sort_by(|a, b| a.score.total_cmp(&b.score));
        all
    }

    /// Refines the candidates that are not plainly worse than the best once they are near their least.
    fn narrowed(&self, all: Vec<Candidate>) -> Vec<Candidate> {
        /// A criterion that is larger by this for each sample is plainly worse: an error 2.7 times
        /// as large.
        const WORSE: f64 = 1.0;
        let near: Vec<Candidate> = all.into_iter().map(|it| self.refined(it, NEAR)).collect();
        let samples = |it: &Candidate| it.found().map(|onset| onset.samples() as f64).sum::<f64>();
        let most = near.iter().map(samples).fold(0.0, f64::max);
        let best = near.iter().map(|it| it.score).fold(f64::INFINITY, f64::min);
        let limit = best + WORSE * most / 2.0;
        let kept = near.into_iter().filter(|it| it.score <= limit);
        kept.map(|it| self.refined(it, ROUNDS)).collect()
    }

    /// How far the onsets of a candidate go with the input.
    fn r2(&self, candidate: &Candidate) -> f64 {
        Follows::of(&self.runs, &candidate.onsets).r2
    }

    fn keep_those_that_follow(&self, all: &mut Vec<Candidate>) {
        let most = all.iter().map(|it| self.r2(it)).fold(0.0, f64::max);
        all.retain(|it| self.r2(it) > most - WORSE);
    }

    /// Broken lines about the common delay that shows best, or whose onsets go best with the input
    /// where several show.
    pub(super) fn first(&self) -> Candidate {
        /// Tops that are tried, and how well they must show beside the best.
        const TOPS: usize = 6;
        const SHOWS: f64 = 0.2;
        /// What is explained well enough, and by how much another must explain more.
        const WELL: f64 = 0.9;
        const MORE: f64 = 0.05;
        let few = self.has_few_steps();
        let longest = if few { 1.0 } else { LONGEST };
        let tops = alignments(
            &self.runs,
            self.hold,
            longest,
            &self.pass(Shapes::shared(Shape::BEND), 0.0),
        );
        let bend = |delay: f64| self.evaluate(Shape::BEND, self.starting(delay), delay, 2);
        let Some((delay, most)) = tops.first().copied() else { return bend(0.0) };
        let mut best = bend(delay);
        if few {
            let other = bend(0.0);
            return if other.score < best.score { other } else { best };
        }
        let mut explained = self.r2(&best);
        for (delay, gain) in tops.into_iter().take(TOPS).skip(1) {
            if gain < SHOWS * most || explained > WELL {
                break;
            }
            let other = bend(delay);
            let its = self.r2(&other);
            if its > explained + MORE {
                (best, explained) = (other, its);
            }
        }
        best
    }

    /// Where onsets of a shape are taken to be at first, with their typical delay.
    fn starts(&self, shape: Shape, bend: &Candidate) -> Vec<(Vec<Onsets>, f64)> {
        /// Delays that are compared in a hold, and the longest lead among them.
        const PER_HOLD: i32 = 12;
        const LEAD: i32 = 6;
        let few = self.has_few_steps();
        let rests = !shape.family.may_be_curved();
        if !rests && !few {
            let mean = shape.mean();
            let earlier = bend.onsets.iter().map(|of_run| of_run.later(-mean));
            return vec![(earlier.collect(), bend.typical - mean)];
        }
        // Corners say little of outputs that come to rest.
        let mut pass = self.pass(Shapes::shared(shape), 0.0);
        let by = (self.hold / f64::from(PER_HOLD)).max(1.0);
        let delays = (if few { 0 } else { -LEAD }..=PER_HOLD).map(|k| f64::from(k) * by);
        let errors = delays.map(|delay| {
            pass.typical = delay;
            (delay, pass.mean_square(&self.runs, &self.starting(delay)))
        });
        let best = errors.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0.0, |(delay, _)| delay);
        let mut starts = vec![(self.starting(best), best)];
        if few {
            starts.push((bend.onsets.clone(), bend.typical));
            starts.push((self.starting(0.0), 0.0));
        }
        starts
    }

    /// How much the variance of all onsets of a candidate grows because its parameters are not known:
    /// by the delta method, `gᵀ H⁻¹ g`, with `g` how far the onsets move and `H` the curvature of
    /// the error in units of its variance; samples squared.
    pub(super) fn shared_variance(&self, candidate: &Candidate) -> f64 {
        /// Rounds in which the axes of the differences are found.
        const ROUNDS: usize = 3;
        let Candidate { shape, typical, .. } = candidate;
        let order = shape.order();
        if order == 0 {
            return 0.0;
        }
        let held = self.held(candidate);
        let samples: f64 = candidate.found().map(|onset| onset.samples() as f64).sum();
        let variance = candidate.found().map(|onset| onset.sse).sum::<f64>() / samples.max(1.0);
        let at = |by: [f64; MOST]| {
            let pairs = self.moved(&held, shape.moved(by), *typical);
            let moves: Vec<f64> =
                pairs.iter().map(|(was, now)| now.position - was.position).collect();
            let sse: f64 = pairs.iter().map(|(_, now)| now.sse).sum();
            // Each sample stands in two windows.
            (sse / (4.0 * variance), median(&moves).unwrap_or(0.0))
        };
        let here = at([0.0; MOST]).0;
        let (mut axes, mut found) = (Axes::identity() * DISTANCES.1 / 3.0, 0.0);
        for _ in 0..ROUNDS {
            let places = Differences::places(order, &axes).into_iter();
            let (errors, moves): (Vec<f64>, Vec<f64>) = places.map(at).unzip();
            let gradient = Differences::<MOST>::of(order, 0.0, &moves).gradient;
            let differences = Differences::of(order, here, &errors);
            let solved = differences.solved(&gradient);
            found = solved.map_or(found, |solved| solved.dot(&gradient).max(0.0));
            axes = differences.axes(&axes, DISTANCES);
        }
        found
    }
}

/// The window of an onset with nothing else, and the onset in it.
fn alone((run, index, onset): (&Run, usize, &Onset)) -> (Run, Onsets) {
    let (step, start) = (run.steps[index], onset.start as f64);
    let step = Step {
        at: step.at - start,
        first: 0.0,
        end: onset.samples() as f64,
        latest: step.latest - start,
        ..step
    };
    let output = run.output[onset.start..onset.end].to_vec();
    (Run { output, steps: vec![step], is_window: true }, Onsets::at(vec![onset.position - start]))
}

/// The least and the first distance of differences in a parameter.
const DISTANCES: (f64, f64) = (1e-3, 0.15);

/// How far Newton's method goes in one round: where the function is as its differences say, and where
/// it is so only near them.
const FARTHEST: [f64; 2] = [0.45, 0.05];

/// Rounds of Newton's method at most, and those after which a candidate is near its least.
pub(super) const ROUNDS: usize = 12;
pub(super) const NEAR: usize = 5;
