//! The onset model of a joint, and its onsets in a trial.
//!
//! A shape that fits the whole of a hold uses all of it. Where none does, since the speed changes
//! within holds in a way of its own, the output is looked at less far about each onset, where any
//! motion is nearly a bend: of some reaches the one whose intervals are the shortest is taken,
//! among those whose onsets answer the input as well.

use super::follows::Follows;
use super::reaction::p_value;
use super::search::{Candidate, FEW, Search};
use super::shape::{Family, Shape};
use super::uncertainty::{Residual, choice, sensor_noise};
use super::windows::{Onset, Pass, Run, Step, all};
use crate::delay::interval::FineDelay;
use crate::delay::motion::StepMotion;
use crate::delay::prepared::Prepared;
use crate::delay::settings::{FirstLast, Settings};
use crate::delay::steps::InputStep;
use crate::numerics::{limits, median, student_quantile};
use crate::units::{SamplePeriod, ceil_to_index, floor_to_index};

/// Samples from which the shape is found, and those from which its misfit is (chosen: more change
/// nothing but the time).
const ENOUGH_FOR_SHAPE: usize = 4_000;
const ENOUGH_FOR_MISFIT: usize = 10_000;

/// Samples of a hold that are looked at: of longer ones every second, third … sample.
const SAMPLES_OF_HOLD: f64 = 500.0;

/// What is looked at to each side of an onset, in holds and in samples. Of a record with few steps,
/// as a bump test, more.
const REACH: f64 = 1.5;
const REACHES: (f64, f64) = (60.0, 750.0);
const REACH_OF_FEW: f64 = 2000.0;
const LEAST_REACH: f64 = 16.0;

/// Parts of the reach that are tried where nothing fits all of it.
const PARTS: [f64; 3] = [0.5, 0.25, 0.125];

/// What a shape leaves over in parts of the noise, from which it does not fit.
const MISFIT: f64 = 1.15;

/// A part of what is explained below which it matters how much it is, and by how much less it may be.
const PLAIN: f64 = 0.7;
const WORSE: f64 = 0.03;

/// Rounding of sums over windows, in parts of an output's range.
const ROUNDING: f64 = 1e-7;

/// Passes over the windows of a record once its shape is known.
const PASSES: usize = 3;

/// The response that all steps of a joint share behind the dead time that each has of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct OnsetModel {
    /// The period of the trials that it was found in.
    period: SamplePeriod,
    /// The responses among which it was chosen.
    families: &'static [Family],
    /// In samples of that period.
    shape: Shape,
    /// Samples to each side of an onset.
    reach: usize,
    /// Median delay, samples.
    typical: f64,
    /// Standard deviation of the sensor's noise.
    noise: f64,
    residual: Residual,
    follows: Follows,
    /// Standard deviation by which all onsets may be moved together, samples.
    shared: f64,
    /// Median width of the intervals of the clear onsets, samples.
    width: f64,
    /// Parts of the clear onsets whose whole interval is before their step, and of those that are
    /// behind the next step.
    early: f64,
    late: f64,
    /// Whether the output comes to rest where its input says, or at stops.
    comes_to_rest: bool,
}

/// Why onsets are no delays of this output behind this input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Obstacle {
    /// The sizes of the onsets do not go with the steps of the input.
    Unrelated,
    /// Onsets come before their steps, by so many seconds at the median.
    Leads(f64),
    /// Onsets come behind the next step, so many seconds late at the median.
    BeyondHolds(f64),
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
    /// Whether the output comes to rest behind the onset.
    pub rests: bool,
}

impl OnsetModel {
    /// The model of a joint's trials, those of the first one's period, with one of some responses;
    /// `None` where there is nothing to fit.
    pub(in crate::delay) fn of(
        trials: &[Prepared<'_>],
        settings: &Settings,
        families: &'static [Family],
    ) -> Option<Self> {
        let found = Self::among(trials, settings, families)?;
        // Strokes from rest gather speed each in a way of its own.
        let is_stroke = |trial: &Prepared<'_>| FirstLast::Auto.are_judged(trial.steps.len());
        let settles = !found.shape.family.may_be_curved();
        let strokes = trials.iter().all(is_stroke) && found.is_misfit() && !settles;
        if !(rests(trials) && (strokes || found.is_unrelated())) {
            return Some(found);
        }
        let bend = Self::among(trials, settings, &[Family::Bend])?;
        Some(Self { comes_to_rest: true, ..bend })
    }

    /// The best model with one of some responses.
    fn among(
        trials: &[Prepared<'_>],
        settings: &Settings,
        families: &'static [Family],
    ) -> Option<Self> {
        let period = trials.first()?.period;
        let alike = trials.iter().filter(|trial| trial.period == period);
        let longest = settings.max_delay;
        let runs = alike.map(|trial| run_of(trial, longest, families));
        let mut runs: Vec<Run> = runs.filter(|run| !run.steps.is_empty()).collect();
        // What is found hangs on no order of the trials.
        runs.sort_by(|a, b| {
            let [one, other] = [a, b].map(|run| run.output.iter().map(|y| y.to_bits()));
            b.output.len().cmp(&a.output.len()).then_with(|| one.cmp(other))
        });
        let mut all = vec![Self::within(&runs, (period, families), 1.0)?];
        // Of a bump test the whole is looked at.
        let few = runs.iter().map(|run| run.steps.len()).sum::<usize>() <= FEW;
        let parts = if few || all[0].0.misfit() < MISFIT { &[][..] } else { &PARTS };
        all.extend(parts.iter().filter_map(|part| Self::within(&runs, (period, families), *part)));
        let as_well = |a: &Self, b: &Self| {
            let [a, b] = [a, b].map(|model| model.follows.r2.min(PLAIN));
            a > b - WORSE
        };
        let mut best = 0;
        for next in 1..all.len() {
            let (model, best_model) = (&all[next].0, &all[best].0);
            let is_narrower = model.width < best_model.width && as_well(model, best_model);
            if is_narrower || !as_well(best_model, model) {
                best = next;
            }
        }
        // What a shorter reach says, or a longer one where there is none.
        let other = if best + 1 < all.len() { best + 1 } else { best.saturating_sub(1) };
        let apart = apart(&all[best].1, &all[other].1);
        let is_as_good = as_well(&all[other].0, &all[best].0);
        let mut model = all.swap_remove(best).0;
        if is_as_good && other != best {
            model.shared = model.shared.hypot(apart);
        }
        // An output that comes to rest where its input says, or at stops, follows it, whatever its speed.
        model.comes_to_rest = trials.iter().any(|trial| trial.is_tested);
        Some(model)
    }

    /// The model that looks at a part of the reach, and its clear onsets.
    fn within(
        runs: &[Run],
        (period, families): (SamplePeriod, &'static [Family]),
        part: f64,
    ) -> Option<(Self, Vec<Option<f64>>)> {
        let holds: Vec<f64> = runs.iter().flat_map(holds).collect();
        let hold = median(&holds)?;
        let every = ceil_to_index(hold / SAMPLES_OF_HOLD).max(1);
        let search =
            Search::of(beginning(runs, ENOUGH_FOR_SHAPE * every), (every, part), families)?;
        let mut candidates = search.select();
        for candidate in &mut candidates {
            candidate.typical *= every as f64;
        }
        let chosen = candidates.first()?;
        let factor = every as f64;
        let shared = search.shared_variance(chosen).sqrt() * factor;
        let (shape, typical) = (chosen.shape.scaled(factor), chosen.typical);
        // At the rate of the record, what is left over and how the sizes go with the input.
        let mut search = Search::of(beginning(runs, ENOUGH_FOR_MISFIT), (1, part), families)?;
        search.reach = reach_of(hold, every, part, search.longest_reach());
        let found = search.evaluate(shape, search.starting(typical), typical, PASSES);
        let residual = Residual::of(&search, &found);
        let follows = Follows::of(&search.runs, &found.onsets);
        let choice = choice(&candidates, residual.memory);
        let shared = (shared * shared * residual.memory + choice * choice).sqrt();
        let (reach, noise) = (search.reach, search.noise);
        let mut model = Self {
            period,
            families,
            shape,
            reach,
            typical: found.typical,
            noise,
            residual,
            follows,
            shared,
            width: f64::INFINITY,
            early: 0.0,
            late: 0.0,
            comes_to_rest: false,
        };
        model.measure(&search, &found);
        let clear = |onset: &Option<Onset>| onset.filter(|it| it.is_clear).map(|it| it.position);
        let onsets = found.onsets.iter().flat_map(|of_run| &of_run.found);
        Some((model, onsets.map(clear).collect()))
    }

    /// How wide the intervals are, unless most onsets are not clear, and on which side of their steps
    /// they lie.
    fn measure(&mut self, search: &Search, found: &Candidate) {
        const CONFIDENCE: f64 = 0.95;
        let pass = search.pass(self.shape, self.typical);
        let (mut widths, mut early, mut late) = (Vec::new(), 0.0, 0.0);
        let clear = all(&search.runs, &found.onsets).filter(|(.., onset)| onset.is_clear);
        for (run, index, onset) in clear {
            let (low, high) = self.sides(&pass, run, (index, onset), CONFIDENCE);
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
        let freedom = (onset.samples() as f64 - pass.response.parameters() as f64).max(1.0);
        let all = self.residual.deviation.max(self.noise).powi(2);
        let variance = (onset.sse + POOLED * all) / (freedom + POOLED);
        let t = student_quantile(f64::midpoint(1.0, confidence), freedom + POOLED);
        let limit = onset.sse + variance.max(f64::MIN_POSITIVE) * self.residual.memory * t * t;
        let (low, high) = pass.extent(run, index, onset, limit);
        (low.hypot(t * self.shared), high.hypot(t * self.shared))
    }

    /// The onsets of all steps of a trial, none where a window is too short.
    pub(in crate::delay) fn onsets(
        &self,
        trial: &Prepared<'_>,
        settings: &Settings,
    ) -> Vec<Option<StepOnset>> {
        let confidence = settings.interval;
        let factor = self.period.seconds() / trial.period.seconds();
        let scaled =
            Self { shape: self.shape.scaled(factor), shared: self.shared * factor, ..self.clone() };
        let run = run_of(trial, settings.max_delay, self.families);
        let Some(mut search) = Search::of(vec![run], (1, 1.0), &[]) else {
            return vec![None; trial.steps.len()];
        };
        search.reach = ceil_to_index(self.reach as f64 * factor);
        let typical = self.typical * factor;
        let found = search.evaluate(scaled.shape, search.starting(typical), typical, PASSES);
        let pass = search.pass(scaled.shape, typical);
        let onsets = found.onsets.iter().flat_map(|of_run| &of_run.found).enumerate();
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
        let others = pass.response.parameters() as f64 - 2.0;
        let p_value = p_value(explained, (samples - others) / self.residual.memory, samples);
        StepOnset {
            fine: FineDelay { delay, low: delay - low, high: delay + high, confidence },
            explained,
            p_value,
            rests: !self.shape.family.may_be_curved(),
        }
    }

    fn is_unrelated(&self) -> bool {
        !self.comes_to_rest && self.follows.is_unrelated()
    }

    /// Its name: `bend`, `bend_lag`, `bend_lag2`, `oscillation`, `settling` or `slew`.
    pub fn shape(&self) -> &'static str {
        self.shape.id()
    }

    /// The parameters of the shape, with the names that they have in files; times in seconds.
    pub fn parameters(&self) -> Vec<(&'static str, f64)> {
        self.shape.parameters(self.period.seconds())
    }

    /// How late a steady motion is behind its onset, seconds; none where the speed changes at once or the
    /// output comes to rest.
    pub fn lag_s(&self) -> Option<f64> {
        let lag = self.shape.mean() * self.period.seconds();
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

    /// Whether the joint answers in another way than any shape: the mean of what is left at some distance
    /// from the onsets of all steps is more than noise.
    pub fn is_misfit(&self) -> bool {
        /// Part of the residuals' deviation, and standard errors, from which a mean counts.
        const PART: f64 = 0.3;
        const PLAIN: f64 = 4.0;
        /// What is left over in parts of the noise that needs no mean.
        const LARGE: f64 = 3.0;
        let (part, errors) = self.residual.systematic;
        let is_left = part > PART && errors > PLAIN && self.misfit() > MISFIT;
        is_left || self.misfit() > LARGE
    }
}

/// How far the onsets of the same steps are apart at the median.
fn apart(one: &[Option<f64>], other: &[Option<f64>]) -> f64 {
    let both = one.iter().zip(other).filter_map(|(one, other)| Some((*other)? - (*one)?));
    median(&both.collect::<Vec<f64>>()).unwrap_or(0.0).abs()
}

impl Search {
    /// Samples to each side of an onset that are looked at at most.
    fn longest_reach(&self) -> f64 {
        if self.has_few_steps() { REACH_OF_FEW } else { REACHES.1 }
    }

    /// Every so many samples of runs, about a part of the reach.
    fn of(
        mut runs: Vec<Run>,
        (every, part): (usize, f64),
        families: &'static [Family],
    ) -> Option<Self> {
        if every > 1 {
            runs = runs.iter().map(|run| thinned(run, every)).collect();
        }
        let hold = median(&runs.iter().flat_map(holds).collect::<Vec<f64>>())?;
        let outputs = runs.iter().map(|run| run.output.as_slice());
        let (low, high) = limits(outputs.clone().flatten().copied());
        // An output that was computed has no noise but its rounding.
        let noise = sensor_noise(&outputs).max(ROUNDING * (high - low));
        let changes = runs.iter().flat_map(|run| &run.steps).map(|step| step.change().abs());
        let change = median(&changes.collect::<Vec<f64>>())?;
        let mut search = Self { runs, reach: 0, noise, hold, change, families };
        search.reach = reach_of(hold, 1, part, search.longest_reach());
        Some(search)
    }
}

/// Samples to each side of an onset that are looked at, where every so many of a hold are.
fn reach_of(hold: f64, every: usize, part: f64, most: f64) -> usize {
    let (least, _) = REACHES;
    let reach = (REACH * hold / every as f64).clamp(least, most) * part;
    ceil_to_index(reach.max(LEAST_REACH)) * every
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

/// Samples from each step to the next.
fn holds(run: &Run) -> Vec<f64> {
    let ends = run.steps.iter().skip(1).map(|step| step.at).chain([run.output.len() as f64]);
    run.steps.iter().zip(ends).map(|(step, end)| end - step.at).collect()
}

/// Every so many samples of a run.
fn thinned(run: &Run, every: usize) -> Run {
    let factor = every as f64;
    let step = |step: &Step| Step {
        at: step.at / factor,
        first: step.first / factor,
        end: step.end / factor,
        latest: step.latest / factor,
        ..*step
    };
    Run {
        output: run.output.iter().step_by(every).copied().collect(),
        steps: run.steps.iter().map(step).collect(),
    }
}

/// The first runs of so many samples together, the last of them up to one of its steps.
fn beginning(runs: &[Run], enough: usize) -> Vec<Run> {
    /// Steps of a run that is cut.
    const FEWEST: usize = 2;
    let mut left = enough as f64;
    let mut taken = Vec::new();
    for run in runs {
        if left <= 0.0 {
            break;
        }
        let within = run.steps.iter().filter(|step| step.at < left).count();
        let steps = within.max(FEWEST).min(run.steps.len());
        let end = run.steps.get(steps).map_or(run.output.len(), |step| floor_to_index(step.at));
        taken.push(Run { output: run.output[..end].to_vec(), steps: run.steps[..steps].to_vec() });
        left -= end as f64;
    }
    taken
}

/// A trial as it is fitted: its output as it was measured, and its steps with what bounds the reaction to
/// each.
fn run_of(trial: &Prepared<'_>, longest: Option<usize>, families: &[Family]) -> Run {
    let samples = trial.raw.len();
    // A bump test of an output that settles is its way to a level.
    let is_bounded = trial.steps.len() > FEW || !families.contains(&Family::Settling);
    let step = |(step, motion): (&InputStep, &Option<Box<StepMotion>>)| {
        let at = step.sample - 1;
        // What was filled in while nothing was logged says nothing.
        let before = trial.unlogged.iter().rev().find(|gap| gap.end <= at);
        let behind = trial.unlogged.iter().find(|gap| gap.start > at);
        let bounds = motion.as_ref().filter(|_| is_bounded);
        let first = before.map_or(0, |gap| gap.end).max(bounds.map_or(0, |it| it.first));
        let end = behind.map_or(samples, |gap| gap.start);
        let end = end.min(bounds.map_or(samples, |it| it.end));
        let asked = longest.map_or(usize::MAX, |longest| at.saturating_add(longest));
        let latest = motion.as_ref().map_or(samples, |motion| motion.latest).min(asked);
        Step {
            at: at as f64,
            before: step.before,
            after: step.after,
            first: first as f64,
            end: end as f64,
            latest: latest as f64,
            rests: motion.as_ref().and_then(|motion| motion.rest).is_some_and(|rest| rest.lasts()),
        }
    };
    let steps = trial.steps.iter().zip(&trial.motions).map(step).collect();
    Run { output: trial.raw.to_vec(), steps }
}
