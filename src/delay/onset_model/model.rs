//! The onset model of a joint, and its onsets in a trial.
//!
//! A shape that fits the whole of a hold uses all of it. Where none does, since the speed changes
//! within holds in a way of its own, the output is looked at less far about each onset, where any
//! motion is nearly a bend: of some reaches the one whose intervals are the shortest is taken,
//! among those whose onsets answer the input as well.

use super::excerpt::{Origin, beginning, holds, reach_of, run_of};
use super::follows::Follows;
use super::kinds::{KINDS, Left, PASSES};
use super::reaction::p_value;
use super::residual::{PLAIN_AGAIN, PLAIN_AT_FIRST, Residual};
use super::search::{FEW, Search};
use super::shape::{Family, Shapes};
use super::uncertainty::Choice;
use super::windows::{Onset, Onsets, Pass, Run, all};
use crate::delay::interval::FineDelay;
use crate::delay::neutral::{Neutral, Transition};
use crate::delay::prepared::Prepared;
use crate::delay::settings::{FirstLast, Settings};
use crate::numerics::{median, student_quantile};
use crate::units::{SamplePeriod, ceil_to_index};

/// Samples from which the shape is found, and those from which its misfit is (chosen: more change
/// nothing but the time).
const ENOUGH_FOR_SHAPE: usize = 4_000;
const ENOUGH_FOR_MISFIT: usize = 10_000;

/// Samples of a hold that are looked at: of longer ones every second, third … sample.
const SAMPLES_OF_HOLD: f64 = 500.0;

/// The part of the reach that is looked at where nothing fits all of it: what the step before left has
/// died away there, and the next one has done nothing.
const NEAR: f64 = 0.25;

/// A part of what is explained below which it matters how much it is, and by how much less it may be.
const PLAIN: f64 = 0.7;
const WORSE: f64 = 0.03;

/// The response that all steps of a joint share after the dead time that each has of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct OnsetModel {
    /// The period of the trials that it was found in.
    period: SamplePeriod,
    /// The responses among which it was chosen.
    families: &'static [Family],
    neutral: Option<Neutral>,
    /// In samples of that period.
    shapes: Shapes,
    /// Samples to each side of an onset.
    reach: usize,
    /// Median delay, samples.
    typical: f64,
    /// Standard deviation of the sensor's noise.
    noise: f64,
    /// Of all steps, and of those of each kind.
    residual: Residual,
    kinds: [OfKind; KINDS],
    /// Of the steps down and up.
    directions: [Residual; 2],
    /// Standard deviations of noise from which a pattern in what is left is one.
    plain: f64,
    follows: Follows,
    /// Median width of the intervals of the clear onsets, samples.
    width: f64,
    /// Parts of the clear onsets whose whole interval is before their step, and of those that are
    /// after the next step.
    early: f64,
    late: f64,
    /// Whether the output comes to rest where its input says, or at stops.
    comes_to_rest: bool,
}

/// What is known of the steps of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
struct OfKind {
    steps: usize,
    residual: Residual,
    /// Standard deviation by which all onsets may be moved together, samples.
    shared: f64,
}

/// Why onsets are no delays of this output to this input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Obstacle {
    /// The sizes of the onsets do not go with the steps of the input.
    Unrelated,
    /// Onsets come before their steps, by so many seconds at the median.
    Leads(f64),
    /// Onsets come after the next step, so many seconds late at the median.
    BeyondHolds(f64),
}

/// The response to the steps of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseOfKind {
    /// The kind.
    pub transition: Transition,
    /// As [`OnsetModel::shape`].
    pub shape: &'static str,
    /// As [`OnsetModel::parameters`].
    pub parameters: Vec<(&'static str, f64)>,
    /// Whether it leaves nothing over that these steps have in common.
    pub fits: bool,
}

/// An onset of one step of a trial.
#[derive(Clone, Debug, PartialEq)]
pub struct StepOnset {
    /// The delay, which may be negative.
    pub fine: FineDelay,
    /// Part of its window's squared error without an onset that it removes.
    pub explained: f64,
    /// How often noise alone looks as much like an onset.
    pub p_value: f64,
    /// Whether the output comes to rest after the onset.
    pub rests: bool,
}

impl OnsetModel {
    /// The model of a joint's trials, those of the first one's period, with one of some responses;
    /// `None` where there is nothing to fit.
    pub(in crate::delay) fn of(
        trials: &[Prepared<'_>],
        neutral: Option<Neutral>,
        settings: &Settings,
        families: &'static [Family],
    ) -> Option<Self> {
        let found = Self::among(trials, neutral, settings, families)?;
        // Strokes from rest gather speed each in a way of its own.
        let is_stroke = |trial: &Prepared<'_>| FirstLast::Auto.are_judged(trial.steps.len());
        let settles = !found.shapes.of(found.usual()).family.may_be_curved();
        let strokes = trials.iter().all(is_stroke) && found.is_misfit() && !settles;
        if !(rests(trials) && (strokes || found.is_unrelated())) {
            return Some(found);
        }
        let bend = Self::among(trials, neutral, settings, &[Family::Bend])?;
        Some(Self { comes_to_rest: true, ..bend })
    }

    /// The best model with one of some responses.
    fn among(
        trials: &[Prepared<'_>],
        neutral: Option<Neutral>,
        settings: &Settings,
        families: &'static [Family],
    ) -> Option<Self> {
        let period = trials.first()?.period;
        let alike = trials.iter().filter(|trial| trial.period == period);
        let origin = Origin { period, neutral, families };
        let runs = alike.map(|trial| run_of(trial, settings.max_delay, &origin));
        let mut runs: Vec<Run> = runs.filter(|run| !run.steps.is_empty()).collect();
        // The result does not depend on the order of the trials.
        runs.sort_by(|a, b| {
            let [one, other] = [a, b].map(|run| run.output.iter().map(|y| y.to_bits()));
            b.output.len().cmp(&a.output.len()).then_with(|| one.cmp(other))
        });
        let whole = Self::within(&runs, &origin, None)?;
        // Of a bump test the whole is looked at.
        let few = runs.iter().map(|run| run.steps.len()).sum::<usize>() <= FEW;
        let fits = few || !whole.is_misfit();
        let near = if fits { None } else { Self::within(&runs, &origin, Some(&whole)) };
        let mut model = match near {
            Some(near) => {
                let [one, other] = [&near, &whole].map(|model| model.follows.r2.min(PLAIN));
                let fits = near.has_own_shapes() || !near.is_misfit() || near.width < whole.width;
                if one > other - WORSE && fits { near } else { whole }
            }
            None => whole,
        };
        // An output that comes to rest where its input says, or at stops, follows it, whatever its speed.
        model.comes_to_rest = trials.iter().any(|trial| trial.is_tested);
        Some(model)
    }

    /// The model of the whole reach, or of a part of it where that of the `whole` does not fit.
    fn within(runs: &[Run], origin: &Origin, whole: Option<&Self>) -> Option<Self> {
        let (part, plain) = whole.map_or((1.0, PLAIN_AT_FIRST), |_| (NEAR, PLAIN_AGAIN));
        let holds: Vec<f64> = runs.iter().flat_map(holds).collect();
        let hold = median(&holds)?;
        let every = ceil_to_index(hold / SAMPLES_OF_HOLD).max(1);
        let families = origin.families;
        let some = |enough: usize, every: usize| {
            Search::of(beginning(runs, enough * every), (every, part), families)
        };
        let search = some(ENOUGH_FOR_SHAPE, every)?;
        let (search, candidates) = match whole {
            None => {
                let candidates = search.select();
                (search, candidates)
            }
            // Which reaction belongs to which step does not depend on the reach.
            Some(whole) => {
                let shape = whole.shapes.of(whole.usual()).scaled((every as f64).recip());
                let typical = whole.typical / every as f64;
                let all = search.evaluate(shape, search.starting(typical), typical, PASSES);
                search.select_within(&all, None)
            }
        };
        let (chosen, common) = (candidates.first()?, Choice::of(&search, &candidates)?);
        let factor = every as f64;
        let typical = chosen.typical * factor;
        // At the rate of the record, what is left over and how the sizes go with the input.
        let mut search = some(ENOUGH_FOR_MISFIT, 1)?;
        search.reach = reach_of(hold, every, part, search.longest_reach());
        let shapes = Shapes::shared(chosen.shape.scaled(factor));
        let mut left = Left::of(&search, shapes, typical);
        let mut choices = [(); KINDS].map(|()| common.clone());
        if whole.is_some() && left.is_misfit(plain) {
            let own = some(ENOUGH_FOR_MISFIT, every)?.by_kind(chosen);
            (left, choices) = left.with_own((own, common), (&search, factor), plain);
        }
        let Left { pass, found, residual, kinds, directions, .. } = left;
        let kinds = Transition::ALL.map(|kind| {
            let residual = kinds[kind as usize];
            let shared = choices[kind as usize].deviation(residual.memory) * factor;
            OfKind { steps: search.steps_of(kind), residual, shared }
        });
        let mut model = Self {
            period: origin.period,
            families,
            neutral: origin.neutral,
            shapes: pass.shapes,
            reach: search.reach,
            typical: pass.typical,
            noise: search.noise,
            residual,
            kinds,
            directions,
            plain,
            follows: Follows::of(&search.runs, &found),
            width: f64::INFINITY,
            early: 0.0,
            late: 0.0,
            comes_to_rest: false,
        };
        model.measure(&search, &pass, &found);
        Some(model)
    }

    /// How wide the intervals are, unless most onsets are not clear, and on which side of their steps
    /// they lie.
    fn measure(&mut self, search: &Search, pass: &Pass, found: &[Onsets]) {
        const CONFIDENCE: f64 = 0.95;
        let (mut widths, mut early, mut late) = (Vec::new(), 0.0, 0.0);
        let clear = all(&search.runs, found).filter(|(.., onset)| onset.is_clear);
        for (run, index, onset) in clear {
            let (low, high) = self.sides(pass, run, (index, onset), CONFIDENCE);
            widths.push(low + high);
            let next = run.steps.get(index + 1).map_or(f64::INFINITY, |next| next.at);
            // A step may have been made any time after the sample before it.
            early += f64::from(u8::from(onset.position + high < run.steps[index].at - 1.0));
            late += f64::from(u8::from(onset.position - low > next));
        }
        let clear = (widths.len() as f64).max(1.0);
        (self.early, self.late) = (early / clear, late / clear);
        if 2 * widths.len() >= search.steps() {
            self.width = median(&widths).unwrap_or(f64::INFINITY);
        }
    }

    /// Why the onsets are no delays, if they are none.
    pub fn obstacle(&self) -> Option<Obstacle> {
        /// The part of onsets that must be out of place (chosen: most).
        const MOST: f64 = 0.5;
        let typical_s = self.typical * self.period.seconds();
        if self.is_unrelated() {
            Some(Obstacle::Unrelated)
        } else if self.early > MOST {
            Some(Obstacle::Leads(-typical_s))
        } else if self.late > MOST {
            Some(Obstacle::BeyondHolds(typical_s))
        } else {
            None
        }
    }

    /// How far the interval of an onset reaches to both sides, samples.
    fn sides(
        &self,
        pass: &Pass,
        run: &Run,
        (index, onset): (usize, &Onset),
        confidence: f64,
    ) -> (f64, f64) {
        /// Samples of all windows that count beside those of one.
        const POOLED: f64 = 20.0;
        let step = &run.steps[index];
        let kind = step.kind;
        let OfKind { residual, shared, .. } = &self.kinds[kind as usize];
        let pattern = residual.pattern.energy.max(self.directions[step.direction()].pattern.energy);
        let parameters = pass.response(kind).parameters() as f64;
        let freedom = (onset.samples() as f64 - parameters).max(1.0);
        let all = residual.deviation.max(self.noise).powi(2);
        let variance = (onset.sse + POOLED * all) / (freedom + POOLED);
        let t = student_quantile(f64::midpoint(1.0, confidence), freedom + POOLED);
        let limit =
            onset.sse + variance.max(f64::MIN_POSITIVE) * residual.memory * (t * t + pattern);
        let (low, high) = pass.extent(run, index, onset, limit);
        (low.hypot(t * shared), high.hypot(t * shared))
    }

    /// The onsets of all steps of a trial, none where a window is too short.
    pub(in crate::delay) fn onsets(
        &self,
        trial: &Prepared<'_>,
        settings: &Settings,
    ) -> Vec<Option<StepOnset>> {
        let confidence = settings.interval;
        let factor = self.period.seconds() / trial.period.seconds();
        let mut scaled = Self { shapes: self.shapes.scaled(factor), ..self.clone() };
        scaled.kinds.iter_mut().for_each(|kind| kind.shared *= factor);
        let origin =
            Origin { period: trial.period, neutral: self.neutral, families: self.families };
        let run = run_of(trial, settings.max_delay, &origin);
        let Some(mut search) = Search::of(vec![run], (1, 1.0), &[]) else {
            return vec![None; trial.steps.len()];
        };
        search.reach = ceil_to_index(self.reach as f64 * factor);
        let typical = self.typical * factor;
        let mut pass = search.pass(scaled.shapes, typical);
        let found = search.found(&mut pass, search.starting(typical), PASSES);
        let onsets = found.iter().flat_map(|of_run| &of_run.found).enumerate();
        onsets
            .map(|(index, onset)| {
                Some(scaled.step_onset(
                    &pass,
                    &search.runs[0],
                    (index, onset.as_ref()?),
                    confidence,
                ))
            })
            .collect()
    }

    fn step_onset(
        &self,
        pass: &Pass,
        run: &Run,
        (index, onset): (usize, &Onset),
        confidence: f64,
    ) -> StepOnset {
        let (low, high) = self.sides(pass, run, (index, onset), confidence);
        let delay = onset.position - run.steps[index].at;
        let explained = 1.0 - onset.sse / onset.sse_without.max(f64::MIN_POSITIVE);
        let samples = onset.samples() as f64;
        let kind = run.steps[index].kind;
        let others = pass.response(kind).parameters() as f64 - 2.0;
        let memory = self.kinds[kind as usize].residual.memory;
        let p_value = p_value(explained, (samples - others) / memory, samples);
        StepOnset {
            fine: FineDelay { delay, low: delay - low, high: delay + high, confidence },
            explained,
            p_value,
            rests: !self.shapes.of(kind).family.may_be_curved(),
        }
    }

    fn is_unrelated(&self) -> bool {
        if self.comes_to_rest { self.follows.is_chance() } else { self.follows.is_unrelated() }
    }

    /// The kind of most of the steps.
    fn usual(&self) -> Transition {
        let kinds = Transition::ALL.into_iter().zip(&self.kinds).rev();
        kinds.max_by_key(|(_, kind)| kind.steps).map_or(Transition::Change, |(kind, _)| kind)
    }

    /// The name of the shape, that of most steps: `bend`, `bend_lag`, `bend_lag2`, `oscillation`,
    /// `settling` or `slew`.
    pub fn shape(&self) -> &'static str {
        self.shapes.of(self.usual()).id()
    }

    /// The parameters of the shape, with the names that they have in files; times in seconds.
    pub fn parameters(&self) -> Vec<(&'static str, f64)> {
        self.shapes.of(self.usual()).parameters(self.period.seconds())
    }

    /// How late a steady motion is after its onset, seconds; none where the speed changes at once or the
    /// output comes to rest.
    pub fn lag_s(&self) -> Option<f64> {
        let lag = self.shapes.of(self.usual()).mean() * self.period.seconds();
        (lag > 0.0).then_some(lag)
    }

    /// Root mean square of what the shape leaves over, in that of the sensor's noise; none of a sensor
    /// that shows no noise.
    pub fn misfit(&self) -> f64 {
        if self.noise > 0.0 { self.residual.deviation / self.noise } else { 1.0 }
    }

    /// The part of the changes of speed, or of level, that goes with the changes of the input: an R²
    /// about zero.
    pub fn follows_input_r2(&self) -> f64 {
        self.follows.r2
    }

    /// How often sizes of onsets that have nothing to do with the input go with it as much.
    pub fn follows_input_p_value(&self) -> f64 {
        self.follows.p_value
    }

    /// Whether the joint answers in another way than any shape: what is left of the steps of some kind
    /// has more in common than noise has.
    pub fn is_misfit(&self) -> bool {
        /// What is left over in parts of the noise that needs nothing in common.
        const LARGE: f64 = 3.0;
        let parts = self.kinds.iter().map(|kind| &kind.residual).chain(&self.directions);
        let is_left = parts.chain([&self.residual]).any(|it| it.pattern.is_plain(self.plain));
        is_left || self.has_own_shapes() || self.misfit() > LARGE
    }

    /// The response to the steps of each kind that there is.
    pub fn responses(&self) -> Vec<ResponseOfKind> {
        let kinds = Transition::ALL.into_iter().zip(&self.kinds).filter(|(_, of)| of.steps > 0);
        kinds
            .map(|(transition, of)| {
                let shape = self.shapes.of(transition);
                ResponseOfKind {
                    transition,
                    shape: shape.id(),
                    parameters: shape.parameters(self.period.seconds()),
                    fits: !of.residual.pattern.is_plain(self.plain),
                }
            })
            .collect()
    }

    /// Whether kinds of steps have shapes of their own.
    pub fn has_own_shapes(&self) -> bool {
        self.shapes.distinct().len() > 1
    }
}

/// Whether most steps find the joint at rest: those of strokes.
fn rests(trials: &[Prepared<'_>]) -> bool {
    let rests = |trial: &Prepared<'_>| {
        let motions = trial.motions.iter().flatten();
        motions.filter(|motion| motion.rest.is_some()).count()
    };
    let steps: usize = trials.iter().map(|trial| trial.steps.len()).sum();
    2 * trials.iter().map(rests).sum::<usize>() > steps
}
