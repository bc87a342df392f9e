//! All steps of a joint over all settings: what most say, and what a delay hangs on.

use super::agreement::{Agreement, Told, gap};
use super::grid::{Combination, Factor, Grid};
use crate::delay::{Lag, Settings, TrialEstimate, input_steps};
use crate::experiment::Trial;
use crate::numerics::{median, quantile};

/// Part of the combinations that must agree for their delay to be a measure of the others.
const MOST: f64 = 0.5;

/// What one run tells of all steps of a joint.
#[derive(Clone, Debug)]
pub struct RunTold {
    /// A place for each step of all trials, in order.
    pub steps: Vec<Option<Told>>,
    /// The lag that it found.
    pub lag: Option<Lag>,
}

impl RunTold {
    /// Collects what a run tells of `trials`; `None` stands for a trial that failed.
    pub fn of<'a>(
        trials: &[Trial],
        estimates: impl IntoIterator<Item = Option<&'a TrialEstimate>>,
        settings: &Settings,
    ) -> Self {
        let mut told = Self { steps: Vec::new(), lag: None };
        for (trial, estimate) in trials.iter().zip(estimates) {
            if let Some(estimate) = estimate {
                let decisions = estimate.decisions.iter();
                told.steps.extend(decisions.map(|decision| Told::of(decision, settings)));
                told.lag = told.lag.or_else(|| estimate.lag.clone());
            } else {
                let steps = input_steps(trial.input(), settings.min_step).len();
                told.steps.resize(told.steps.len() + steps, None);
            }
        }
        told
    }
}

/// The delays of a joint over all settings.
#[derive(Clone, Debug)]
pub struct JointSweep {
    /// All steps of all trials, in order.
    pub steps: Vec<SweptStep>,
    /// What became of each run of the grid; `None` for one that failed.
    pub runs: Vec<Option<RunSummary>>,
    /// What became of each value of each factor, in the order of [`Factor::ALL`].
    pub levels: Vec<Vec<LevelSummary>>,
}

/// One step over all settings; delays in samples.
#[derive(Clone, Debug)]
pub struct SweptStep {
    /// The trial's label.
    pub trial: String,
    /// `i`: number of the step in its trial, from 1.
    pub number: usize,
    /// `p_i`: first sample with the new level, from 1.
    pub sample: usize,
    /// Its time, seconds of the log.
    pub time_s: f64,
    /// Seconds between samples.
    pub period_s: f64,
    /// What each run of the grid tells, where it accepted the step.
    pub told: Vec<Option<Told>>,
    /// Combinations that accepted it.
    pub accepted: usize,
    /// Combinations that did not fail.
    pub tried: usize,
    /// The delays of all combinations that accepted it.
    pub spread: Option<Spread>,
    /// What most of them can agree on.
    pub agreement: Option<Agreement>,
    /// What its delay hangs on, where not all agree.
    pub delay_hangs_on: Option<Hanging>,
    /// On what it hangs whether it is accepted, where it is by some.
    pub verdict_hangs_on: Option<Factor>,
    /// Mean distance of all delays from what is agreed on, beyond what each allows.
    pub apart: f64,
}

/// How far delays lie from each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The least.
    pub min: f64,
    /// A quarter is below.
    pub lower_quartile: f64,
    /// The middle one.
    pub median: f64,
    /// A quarter is above.
    pub upper_quartile: f64,
    /// The greatest.
    pub max: f64,
}

/// The setting that moves a delay most.
#[derive(Clone, Debug, PartialEq)]
pub struct Hanging {
    /// The setting.
    pub factor: Factor,
    /// By how much the delays miss each other, beyond what each allows, when it alone is
    /// changed; the mean over all other settings, samples.
    pub gap: f64,
    /// For each of its values the median delay, and the part of combinations that agree.
    pub levels: Vec<Option<(f64, f64)>>,
}

/// A run over all steps of a joint.
#[derive(Clone, Debug)]
pub struct RunSummary {
    /// Steps that it accepted.
    pub accepted: usize,
    /// The median of its delays, seconds.
    pub median_s: Option<f64>,
    /// Accepted steps of which it tells another delay than most.
    pub disagreements: usize,
    /// Of the steps that most agree on, the part where it agrees with them.
    pub agrees: Option<f64>,
    /// The lag that it found.
    pub lag: Option<Lag>,
}

/// All combinations with one value of a setting, over all steps of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelSummary {
    /// The part of the steps that is accepted.
    pub accepted: f64,
    /// The median of all delays, seconds.
    pub median_s: Option<f64>,
    /// The median distance from what most say, samples.
    pub shift_samples: Option<f64>,
    /// The part of the delays that disagrees with what most say.
    pub disagrees: Option<f64>,
}

impl SweptStep {
    /// Whether all settings that accept it tell the same, and all or none do.
    pub fn is_settled(&self) -> bool {
        self.disagreeing() == 0 && (self.accepted == self.tried || self.accepted == 0)
    }

    /// Combinations whose delay is another than most say.
    pub fn disagreeing(&self) -> usize {
        self.accepted - self.agreement.map_or(0, |agreement| agreement.combinations)
    }

    /// What most say, where most combinations do.
    pub fn majority(&self) -> Option<Agreement> {
        let most = |agreement: &Agreement| agreement.combinations as f64 > MOST * self.tried as f64;
        self.agreement.filter(most)
    }

    fn told(&self, one: &Combination) -> Option<Told> {
        self.told.get(one.run).copied().flatten()
    }

    /// The same step judged.
    fn judged(mut self, grid: &Grid, ran: &[bool]) -> Self {
        let tried = grid.combinations().iter().filter(|one| ran.get(one.run) == Some(&true));
        self.tried = tried.count();
        let told: Vec<Told> = grid.combinations().iter().filter_map(|one| self.told(one)).collect();
        self.accepted = told.len();
        self.spread = Spread::of(&told);
        self.agreement = Agreement::of(&told);
        if let Some(agreement) = self.agreement {
            let distances = told.iter().map(|one| agreement.distance(one));
            self.apart = distances.sum::<f64>() / told.len() as f64;
        }
        if self.disagreeing() > 0 {
            self.delay_hangs_on = self.delay_hangs_on(grid);
        }
        if self.accepted > 0 && self.accepted < self.tried {
            self.verdict_hangs_on = self.verdict_hangs_on(grid, ran);
        }
        self
    }

    /// The factor that moves the delay most when it alone is changed.
    fn delay_hangs_on(&self, grid: &Grid) -> Option<Hanging> {
        let at = |index: usize| self.told(grid.combinations().get(index)?);
        let of_line = |line: Vec<usize>| {
            let told: Vec<Told> = line.into_iter().filter_map(at).collect();
            (told.len() > 1).then(|| gap(&told))
        };
        let moved = |factor: Factor| (factor, mean(grid.lines(factor).filter_map(of_line)));
        let (factor, gap) = greatest(Factor::ALL.map(moved))?;
        let level = |level: usize| {
            let told = grid.at(factor, level).filter_map(|one| self.told(one));
            let told: Vec<Told> = told.collect();
            let delays: Vec<f64> = told.iter().map(|one| one.delay).collect();
            let agree = told.iter().filter(|one| self.agreement.is_some_and(|a| a.holds(one)));
            Some((median(&delays)?, agree.count() as f64 / told.len() as f64))
        };
        Some(Hanging { factor, gap, levels: (0..grid.levels(factor)).map(level).collect() })
    }

    /// The factor that most often turns the verdict when it alone is changed.
    fn verdict_hangs_on(&self, grid: &Grid, ran: &[bool]) -> Option<Factor> {
        let at = |index: usize| {
            let one = grid.combinations().get(index)?;
            ran.get(one.run).filter(|ran| **ran)?;
            Some(self.told(one).is_some())
        };
        let of_line = |line: Vec<usize>| {
            let accepted: Vec<bool> = line.into_iter().filter_map(at).collect();
            let turns = accepted.contains(&true) && accepted.contains(&false);
            (accepted.len() > 1).then_some(f64::from(u8::from(turns)))
        };
        let turned = |factor: Factor| (factor, mean(grid.lines(factor).filter_map(of_line)));
        greatest(Factor::ALL.map(turned)).map(|(factor, _)| factor)
    }
}

/// The factor with the greatest value above zero; the first of several.
fn greatest(values: [(Factor, Option<f64>); 4]) -> Option<(Factor, f64)> {
    let above = values.into_iter().filter_map(|(factor, value)| Some((factor, value?)));
    let above = above.filter(|(_, value)| *value > 0.0);
    above.reduce(|best, one| if one.1 > best.1 { one } else { best })
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, count), one| (sum + one, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

impl Spread {
    fn of(told: &[Told]) -> Option<Self> {
        let delays: Vec<f64> = told.iter().map(|one| one.delay).collect();
        let part = |part| quantile(&delays, part);
        Some(Self {
            min: part(0.0)?,
            lower_quartile: part(0.25)?,
            median: part(0.5)?,
            upper_quartile: part(0.75)?,
            max: part(1.0)?,
        })
    }
}

impl JointSweep {
    /// Judges every step of `trials` by what each run of `grid` tells of it, `None` where a
    /// run failed. Delays that differ by `tolerance` samples more than each of them allows
    /// still agree.
    pub fn of(grid: &Grid, trials: &[Trial], runs: &[Option<RunTold>], tolerance: f64) -> Self {
        let min_step = grid.runs().first().map_or(0.0, |settings| settings.min_step);
        let ran: Vec<bool> = runs.iter().map(Option::is_some).collect();
        let steps = trials.iter().flat_map(|trial| {
            let steps = input_steps(trial.input(), min_step).into_iter().zip(1..);
            steps.map(move |(step, number)| SweptStep {
                trial: trial.label().to_owned(),
                number,
                sample: step.sample,
                time_s: trial.time_s(step.sample),
                period_s: trial.period().seconds(),
                told: Vec::new(),
                accepted: 0,
                tried: 0,
                spread: None,
                agreement: None,
                delay_hangs_on: None,
                verdict_hangs_on: None,
                apart: 0.0,
            })
        });
        let judged = |(index, step): (usize, SweptStep)| {
            let told = |run: &Option<RunTold>| {
                let told = run.as_ref()?.steps.get(index).copied().flatten()?;
                Some(told.widened(0.5 * tolerance))
            };
            SweptStep { told: runs.iter().map(told).collect(), ..step }.judged(grid, &ran)
        };
        let steps: Vec<SweptStep> = steps.enumerate().map(judged).collect();
        let summary = |(index, run): (usize, &Option<RunTold>)| {
            Some(RunSummary::of(&steps, index, run.as_ref()?.lag.clone()))
        };
        let summaries = runs.iter().enumerate().map(summary).collect();
        let levels = |factor: Factor| {
            let of = |level| LevelSummary::of(&steps, grid.at(factor, level), &ran);
            (0..grid.levels(factor)).map(of).collect()
        };
        let levels = Factor::ALL.into_iter().map(levels).collect();
        Self { steps, runs: summaries, levels }
    }

    /// The steps that any setting accepts.
    pub fn judged(&self) -> impl Iterator<Item = &SweptStep> {
        self.steps.iter().filter(|step| step.accepted > 0)
    }

    /// The steps that hang on a setting; first those that most do.
    pub fn hanging(&self) -> Vec<&SweptStep> {
        let mut hanging: Vec<_> = self.judged().filter(|step| !step.is_settled()).collect();
        let rejected = |step: &SweptStep| step.tried - step.accepted;
        hanging.sort_by(|a, b| {
            b.apart.total_cmp(&a.apart).then_with(|| rejected(b).cmp(&rejected(a)))
        });
        hanging
    }
}

impl RunSummary {
    fn of(steps: &[SweptStep], run: usize, lag: Option<Lag>) -> Self {
        let told = |step: &SweptStep| step.told.get(run).copied().flatten();
        let delays = steps.iter().filter_map(|step| Some(told(step)?.delay * step.period_s));
        let delays: Vec<f64> = delays.collect();
        let disagrees = |step: &&SweptStep| {
            let agreed = step.agreement.zip(told(step));
            agreed.is_some_and(|(agreement, told)| !agreement.holds(&told))
        };
        let agrees = steps.iter().filter_map(|step| {
            let agreement = step.majority()?;
            Some(f64::from(u8::from(told(step).is_some_and(|told| agreement.holds(&told)))))
        });
        Self {
            accepted: delays.len(),
            median_s: median(&delays),
            disagreements: steps.iter().filter(disagrees).count(),
            agrees: mean(agrees),
            lag,
        }
    }
}

impl LevelSummary {
    fn of<'a>(
        steps: &[SweptStep],
        combinations: impl Iterator<Item = &'a Combination>,
        ran: &[bool],
    ) -> Self {
        let (mut tried, mut delays, mut shifts, mut outside) = (0, Vec::new(), Vec::new(), 0);
        for one in combinations.filter(|one| ran.get(one.run) == Some(&true)) {
            tried += steps.iter().filter(|step| step.accepted > 0).count();
            for step in steps {
                let Some((told, agreed)) = step.told(one).zip(step.agreement) else { continue };
                delays.push(told.delay * step.period_s);
                shifts.push(told.delay - agreed.delay);
                outside += usize::from(!agreed.holds(&told));
            }
        }
        let count = delays.len() as f64;
        Self {
            accepted: if tried > 0 { count / tried as f64 } else { 0.0 },
            median_s: median(&delays),
            shift_samples: median(&shifts),
            disagrees: (count > 0.0).then(|| outside as f64 / count),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Base;
    use super::*;
    use crate::delay::Method;
    use crate::numerics::LowPass;
    use crate::units::SamplePeriod;

    /// Two passbands, one α, three β.
    fn grid() -> Grid {
        let base = Base { settings: Settings::of(Method::TWO_LINE), keeps_low_pass: false };
        let slow = Some(LowPass { cutoff_hz: 2.0, order: 4 });
        Grid::new(vec![base], vec![slow, None], vec![10], vec![1, 2, 3])
    }

    /// One step, of which each run tells this delay.
    fn swept(delays: [Option<f64>; 6]) -> SweptStep {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, vec![0.0, 1.0], vec![0.0; 2]).unwrap();
        let told = |delay: f64| Told { delay, low: delay - 0.5, high: delay + 0.5 };
        let run = |delay: Option<f64>| Some(RunTold { steps: vec![delay.map(told)], lag: None });
        let sweep = JointSweep::of(&grid(), &[trial], &delays.map(run), 2.0);
        sweep.steps[0].clone()
    }

    #[test]
    fn delays_within_the_tolerance_are_the_same() {
        let step = swept([10.0, 11.0, 12.0, 12.5, 10.5, 13.0].map(Some));
        assert!(step.is_settled());
        assert_eq!(step.agreement.unwrap().combinations, 6);
        assert!((step.agreement.unwrap().delay - 11.5).abs() < 1e-12);
        assert!(step.delay_hangs_on.is_none());
    }

    #[test]
    fn the_setting_that_moves_a_delay_is_named() {
        let step = swept([30.0, 30.0, 31.0, 10.0, 11.0, 10.0].map(Some));
        let hanging = step.delay_hangs_on.clone().unwrap();
        assert_eq!(hanging.factor, Factor::Passband);
        // Twenty apart on average, less what both sides and the tolerance allow.
        assert!((hanging.gap - (20.0 - 3.0)).abs() < 1e-9, "{hanging:?}");
        let [slow, raw] = [0, 1].map(|level| hanging.levels[level].unwrap());
        // Three against three: the shorter delay counts.
        assert!(slow.1 == 0.0 && raw == (10.0, 1.0));
        let step = swept([10.0, 20.0, 10.0, 11.0, 21.0, 10.0].map(Some));
        assert_eq!(step.delay_hangs_on.unwrap().factor, Factor::Beta);
    }

    #[test]
    fn a_verdict_hangs_on_what_turns_it() {
        let step = swept([None, None, None, Some(10.0), Some(10.0), Some(10.0)]);
        assert!(!step.is_settled() && step.disagreeing() == 0);
        assert_eq!(step.verdict_hangs_on, Some(Factor::Passband));
        let step = swept([None; 6]);
        assert!(step.is_settled() && step.agreement.is_none() && step.verdict_hangs_on.is_none());
    }

    #[test]
    fn runs_that_failed_have_no_vote() {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, vec![0.0, 1.0], vec![0.0; 2]).unwrap();
        let told = Told { delay: 3.0, low: 3.0, high: 3.0 };
        let runs = [true, false, true, false, true, true]
            .map(|ran| ran.then(|| RunTold { steps: vec![Some(told)], lag: None }));
        let sweep = JointSweep::of(&grid(), &[trial], &runs, 0.0);
        assert_eq!((sweep.steps[0].tried, sweep.steps[0].accepted), (4, 4));
        assert!(sweep.steps[0].is_settled() && sweep.runs[1].is_none());
        assert!((sweep.levels[3][0].accepted - 1.0).abs() < 1e-12);
    }
}
