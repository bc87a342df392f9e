//! The windows into which trials are cut: where a simulation restarts, and what each is for.

use super::first_order::follows_input;
use crate::experiment::{Joint, Trial};
use crate::units::SamplePeriod;

/// How long a simulation runs before its angle is set to the measured one again.
///
/// An integrator keeps every error it made; a short horizon shows where errors are made,
/// the free run what becomes of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Horizon {
    /// A free run where the output follows its input itself, as a speed, a pressure or a servo's
    /// position does, and forgets where it began; else from step to step of the input.
    Auto,
    /// Never: each trial is one run.
    #[default]
    FreeRun,
    /// At every step of the input, and in between so that no run is longer than 2 s, or 200 samples
    /// of a log slower than 10 Hz; every 2 s where the input is not held between steps.
    Steps,
    /// Every so many seconds.
    Seconds(f64),
}

impl Horizon {
    /// The horizon for `joint`, which is not [`Auto`](Self::Auto).
    pub(super) fn of(self, joint: &Joint) -> Self {
        match self {
            Self::Auto if follows_input(joint).is_some() => Self::FreeRun,
            Self::Auto => Self::Steps,
            chosen => chosen,
        }
    }
}

impl std::fmt::Display for Horizon {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Auto => f.write_str("restarted as the record asks for"),
            Self::FreeRun => f.write_str("free run"),
            Self::Steps => f.write_str("restarted at every step of the input and in long holds"),
            Self::Seconds(seconds) => write!(f, "restarted every {seconds} s"),
        }
    }
}

/// How training and validation are separated; never sample by sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Split {
    /// The first part of each trial is for training: its share, 0 to 1.
    Time(f64),
    /// Every third trial in the order of their labels is for validation: which are does not depend
    /// on the order of the rows.
    Trials,
    /// Every third block of each trial is for validation, a block being four runs from restart to
    /// restart: both parts then visit the same levels, angles and temperatures, and a model is not
    /// judged by what it was never shown. Of a trial of fewer than three blocks the first 70 % are
    /// for training.
    Blocks,
}

impl Split {
    /// By trial where there are enough of them, else by blocks of each; by trial, too, where each is
    /// too short for blocks: the end of a trial alone may hold a level that its beginning never has.
    pub fn of(joint: &Joint) -> Self {
        /// Trials from which a third of them is a fair sample.
        const ENOUGH: usize = 6;
        /// Trials of which a third is one.
        const FEWEST: usize = 3;
        let trials = &joint.trials;
        let are_short = || trials.iter().all(|trial| blocks(trial).is_none());
        let by_trial = trials.len() >= ENOUGH || trials.len() >= FEWEST && are_short();
        if by_trial { Self::Trials } else { Self::Blocks }
    }

    /// The stretches of `trial`, which has this place among the labels: the index after the last
    /// sample of each, and what it is for.
    fn stretches(self, trial: &Trial, place: usize) -> Vec<(usize, Part)> {
        /// The share for training of a trial too short for blocks.
        const UNBLOCKED: f64 = 0.7;
        let samples = trial.len();
        let first = |share: f64| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 1")]
            let border = (samples as f64 * share.clamp(0.0, 1.0)) as usize;
            vec![(border, Part::Training), (samples, Part::Validation)]
        };
        match self {
            Self::Time(share) => first(share),
            Self::Trials if place % 3 == 2 => vec![(samples, Part::Validation)],
            Self::Trials => vec![(samples, Part::Training)],
            Self::Blocks => blocks(trial).unwrap_or_else(|| first(UNBLOCKED)),
        }
    }
}

/// Blocks of runs, the second of every three for validation; none of a trial with fewer than three.
fn blocks(trial: &Trial) -> Option<Vec<(usize, Part)>> {
    /// Runs of a block: some steps of the input together, so that what a restart leaves unknown is
    /// a small part of it.
    const RUNS: usize = 4;
    let ends = window_ends(run_borders(trial), &[trial.len()]);
    if ends.len() < 3 * RUNS {
        return None;
    }
    let part = |block: usize| if block % 3 == 1 { Part::Validation } else { Part::Training };
    let blocks = ends.chunks(RUNS).enumerate();
    Some(blocks.filter_map(|(block, ends)| Some((*ends.last()?, part(block)))).collect())
}

/// The place of each of `trials` in the order of their labels, which is that of numbers where all
/// are numbers; those of one label stay as they are.
pub(super) fn places(trials: &[Trial]) -> Vec<usize> {
    let number = |trial: &Trial| trial.label().parse::<f64>().ok();
    let numbers: Option<Vec<f64>> = trials.iter().map(number).collect();
    let mut order: Vec<usize> = (0..trials.len()).collect();
    match numbers {
        Some(numbers) => order.sort_by(|a, b| numbers[*a].total_cmp(&numbers[*b])),
        None => order.sort_by_key(|index| trials[*index].label()),
    }
    let mut places = vec![0; trials.len()];
    for (place, index) in order.into_iter().enumerate() {
        places[index] = place;
    }
    places
}

/// What a window is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Parameters are fitted to it.
    Training,
    /// The error is judged on it.
    Validation,
}

/// Samples `start .. end` of a trial (from 0), simulated without a restart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Index of the trial.
    pub trial: usize,
    /// Index of its first sample.
    pub start: usize,
    /// Index after its last sample.
    pub end: usize,
    /// What it is for.
    pub part: Part,
    /// Whether the simulation is set to the measured output at its start; else it goes on from the window
    /// before.
    pub restarts: bool,
}

/// Fewest samples of a window: its offset is taken from them.
const SHORTEST_WINDOW: usize = 10;

/// The windows of one trial, which has this place among the labels. What was filled in while nothing was
/// logged is in none of them.
pub(super) fn cut(
    trial: &Trial,
    index: usize,
    (split, place): (Split, usize),
    horizon: Horizon,
) -> Vec<Window> {
    let stretches = merged(split.stretches(trial, place));
    let gaps = trial.unlogged();
    let mut must: Vec<usize> = stretches.iter().map(|(end, _)| *end).collect();
    must.extend(gaps.iter().flat_map(|gap| [gap.start, gap.end]));
    let part = |start: usize| stretches.iter().find(|(end, _)| start < *end).map(|(_, part)| *part);
    let ends = window_ends(borders(trial, horizon), &must);
    let starts = std::iter::once(0).chain(ends.iter().copied());
    let is_logged = |start: &usize| !gaps.iter().any(|gap| gap.contains(start));
    // In a free run parts that are fitted and parts that are not take turns, and the simulation goes on:
    // a start of its own in each would leave only the motion within a part to be explained.
    let restarts = |start| start == 0 || horizon != Horizon::FreeRun;
    let window = |(start, end)| {
        let (trial, restarts) = (index, restarts(start));
        Some(Window { trial, start, end, part: part(start)?, restarts })
    };
    let logged = starts.zip(ends.iter().copied()).filter(|(start, _)| is_logged(start));
    logged.filter_map(window).collect()
}

/// Stretches of which no two neighbours are for the same, without empty ones.
fn merged(stretches: Vec<(usize, Part)>) -> Vec<(usize, Part)> {
    let mut merged: Vec<(usize, Part)> = Vec::new();
    for (end, part) in stretches {
        match merged.last_mut() {
            Some((last, _)) if *last == end => {}
            Some((last, of)) if *of == part => *last = end,
            None if end == 0 => {}
            _ => merged.push((end, part)),
        }
    }
    merged
}

/// Where a simulation of `trial` with this horizon restarts, in any order.
fn borders(trial: &Trial, horizon: Horizon) -> Vec<usize> {
    match horizon {
        Horizon::FreeRun => Vec::new(),
        Horizon::Auto | Horizon::Steps => run_borders(trial),
        Horizon::Seconds(seconds) => {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "≥ 1")]
            let every = (seconds / trial.period().seconds()).round().max(1.0) as usize;
            (0..trial.len()).step_by(every).collect()
        }
    }
}

/// The steps of a held input and borders in long holds; of one that moves all the time borders at
/// even distances.
fn run_borders(trial: &Trial) -> Vec<usize> {
    let (samples, longest) = (trial.len(), longest_run(trial.period()));
    if is_held(trial.input()) {
        let steps = std::iter::once(0).chain(changes(trial.input())).chain([samples]);
        divided(steps.collect(), longest)
    } else {
        (0..samples).step_by(longest).collect()
    }
}

/// Where windows end that lie between `borders`: at each that `must` be one, and at others where the
/// window has enough samples.
fn window_ends(mut borders: Vec<usize>, must: &[usize]) -> Vec<usize> {
    borders.extend(must);
    borders.sort_unstable();
    let (mut ends, mut start) = (Vec::new(), 0);
    for end in borders {
        let is_long = end - start >= SHORTEST_WINDOW;
        if is_long || must.contains(&end) && end > start {
            ends.push(end);
            start = end;
        }
    }
    ends
}

/// Samples of a window between steps of the input, at most: a small error of the speed would
/// else grow with the square of a long hold, and the longest holds alone decide a fit.
///
/// A time and not a number of samples, so that a log says the same at any rate; but of a process
/// that is logged so slowly that few samples are in it, a number of samples.
fn longest_run(period: SamplePeriod) -> usize {
    /// A multiple of what a hydraulic joint takes to start, 0.8 s at most.
    const LONGEST_S: f64 = 2.0;
    /// Enough to see a motion beside its noise.
    const FEWEST: usize = 20;
    /// Of a slow process, a tank's level each 4 s: in 20 samples it does not show where it goes.
    const OF_SLOW: usize = 200;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive")]
    let samples = (LONGEST_S / period.seconds()).round() as usize;
    if samples < FEWEST { OF_SLOW } else { samples }
}

/// `borders`, and between those that are far apart further ones at equal distances, of at most
/// `longest` samples.
fn divided(mut borders: Vec<usize>, longest: usize) -> Vec<usize> {
    borders.sort_unstable();
    let between = borders.windows(2).flat_map(|pair| {
        let &[start, end] = pair else { return Vec::new() };
        let parts = (end - start).div_ceil(longest);
        (1..parts).map(|part| start + (end - start) * part / parts).collect()
    });
    let between: Vec<usize> = between.collect();
    borders.extend(between);
    borders
}

/// Whether the input is held for some samples between its steps.
fn is_held(input: &[f64]) -> bool {
    /// Samples between steps, on average.
    const HELD: usize = 20;
    changes(input).count() * HELD < input.len()
}

/// `window` in parts, in each of which the input changes a few times.
pub(super) fn shorter(window: Window, changes: usize) -> Vec<Window> {
    /// Changes in a part: some information on how they act together.
    const CHANGES: usize = 5;
    /// Fewest samples of a part.
    const SHORTEST: usize = 100;
    let samples = window.end - window.start;
    let parts = (changes / CHANGES).min(samples / SHORTEST).max(1);
    let border = |part: usize| window.start + samples * part / parts;
    let part = |part| Window {
        start: border(part),
        end: border(part + 1),
        restarts: window.restarts || part > 0,
        ..window
    };
    (0..parts).map(part).collect()
}

/// Indices of samples whose input differs from the one before.
pub(super) fn changes(input: &[f64]) -> impl Iterator<Item = usize> {
    #[expect(clippy::float_cmp, reason = "a step is any change")]
    let changed = |pair: &[f64]| matches!(pair, [a, b] if a != b);
    let pairs = input.windows(2).zip(1..);
    pairs.filter(move |(pair, _)| changed(pair)).map(|(_, index)| index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_an_input_that_is_never_held_are_no_windows() {
        let input: Vec<f64> = (0..1000).map(f64::from).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("a", 0.0, period, input, vec![0.0; 1000]).unwrap();
        let windows = cut(&trial, 0, (Split::Time(0.5), 0), Horizon::Steps);
        let borders: Vec<_> = windows.iter().map(|window| window.start).collect();
        assert_eq!(borders, [0, 200, 400, 500, 600, 800]);
    }

    #[test]
    fn the_order_of_the_rows_does_not_say_which_trials_are_unseen() {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = |label: &&str| Trial::new(*label, 0.0, period, vec![0.0], vec![0.0]).unwrap();
        let of = |labels: &[&str]| places(&labels.iter().map(trial).collect::<Vec<_>>());
        assert_eq!(of(&["b-20", "a-100", "b-3", "a-100"]), [2, 0, 3, 1]);
        assert_eq!(of(&["10", "9", "1"]), [2, 1, 0]);
        let trial = Trial::new("a", 0.0, period, vec![0.0; 9], vec![0.0; 9]).unwrap();
        assert_eq!(Split::Trials.stretches(&trial, 2), [(9, Part::Validation)]);
        assert_eq!(Split::Trials.stretches(&trial, 3), [(9, Part::Training)]);
    }

    #[test]
    fn every_third_block_of_four_runs_is_for_validation() {
        let input: Vec<f64> = (0..1800).map(|k| f64::from(k / 100 % 2)).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("a", 0.0, period, input, vec![0.0; 1800]).unwrap();
        let unseen = |horizon| {
            let windows = cut(&trial, 0, (Split::Blocks, 0), horizon).into_iter();
            let unseen = windows.filter(|window| window.part == Part::Validation);
            unseen.map(|window| window.start..window.end).collect::<Vec<_>>()
        };
        assert_eq!(unseen(Horizon::FreeRun), [400..800, 1600..1800]);
        assert_eq!(unseen(Horizon::Steps)[..4], [400..500, 500..600, 600..700, 700..800]);
        assert_eq!(unseen(Horizon::Seconds(3.0)), [400..600, 600..800, 1600..1800]);
        // Eleven runs are no three blocks.
        let short = trial.part(0, 1100).unwrap();
        let windows = cut(&short, 0, (Split::Blocks, 0), Horizon::FreeRun);
        assert_eq!(windows.iter().map(|window| window.end).collect::<Vec<_>>(), [770, 1100]);
    }

    #[test]
    fn what_was_not_logged_is_in_no_window() {
        let input: Vec<f64> = (0..600).map(|k| if k < 400 { 1.0 } else { -1.0 }).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("a", 0.0, period, input, vec![0.0; 600]).unwrap();
        let trial = trial.with_unlogged(std::iter::once(250..400).collect());
        let windows = cut(&trial, 0, (Split::Time(0.8), 0), Horizon::Steps);
        let spans: Vec<_> = windows.iter().map(|window| (window.start, window.end)).collect();
        assert_eq!(spans, [(0, 200), (200, 250), (400, 480), (480, 600)]);
    }

    #[test]
    fn a_run_is_as_long_at_any_rate() {
        let longest = |period_s| longest_run(SamplePeriod::from_seconds(period_s).unwrap());
        assert_eq!([0.001, 0.01, 0.05].map(longest), [2000, 200, 40]);
        assert_eq!(longest(9.0), 200, "of a furnace");
    }

    #[test]
    fn a_long_hold_is_divided_evenly() {
        let input: Vec<f64> = (0..1000).map(|k| if k < 450 { 1.0 } else { 2.0 }).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("a", 0.0, period, input, vec![0.0; 1000]).unwrap();
        let windows = cut(&trial, 0, (Split::Time(1.0), 0), Horizon::Steps);
        let borders: Vec<_> = windows.iter().map(|window| window.start).collect();
        assert_eq!(borders, [0, 150, 300, 450, 633, 816]);
    }
}
