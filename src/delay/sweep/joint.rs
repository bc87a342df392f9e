//! All steps of a joint over all settings.

use super::grid::{Factor, Grid};
use super::run::{LevelSummary, RunDelays, RunSummary};
use super::step::SweptStep;
use crate::delay::{InputStep, Neutral, Settings, Transition, joint_steps};
use crate::experiment::{Record, Trial};

/// The delays of a joint over all settings.
#[derive(Clone, Debug)]
pub struct JointSweep {
    /// All steps of all trials, in order.
    pub steps: Vec<SweptStep>,
    /// What became of each run of the grid; `None` for one that failed.
    pub runs: Vec<Option<RunSummary>>,
    /// What became of each value of each factor, in the order of [`Factor::ALL`].
    pub levels: Vec<Vec<LevelSummary>>,
    /// The levels for each kind of step, where most runs find that their medians differ.
    pub kinds: Vec<(Transition, Vec<Vec<LevelSummary>>)>,
}

impl JointSweep {
    /// Judges every step of `trials` by what each run of `grid` reports of it, `None` where a
    /// run failed. Delays that differ by `tolerance` samples more than each of them allows
    /// still agree.
    pub fn of(grid: &Grid, trials: &Record, runs: &[Option<RunDelays>], tolerance: f64) -> Self {
        let settings = grid.runs().first().cloned().unwrap_or_else(Settings::default);
        let ran: Vec<bool> = runs.iter().map(Option::is_some).collect();
        let neutral = Neutral::of(trials);
        let of_trials = trials.iter().zip(joint_steps(trials, &settings));
        let steps = of_trials.flat_map(|(trial, steps)| {
            let steps = steps.into_iter().zip(1..);
            steps.map(move |(step, number)| (trial, step, number))
        });
        let judged = |(index, (trial, step, number)): (usize, (&Trial, InputStep, usize))| {
            let delay = |run: &Option<RunDelays>| {
                let reported = run.as_ref()?.steps.get(index).copied().flatten()?;
                Some(reported.widened(0.5 * tolerance))
            };
            let delays = runs.iter().map(delay).collect();
            let kind = Transition::of(&step, neutral.as_ref());
            SweptStep::of(trial, (step, kind, number), delays, (grid, &ran))
        };
        let steps: Vec<SweptStep> = steps.enumerate().map(judged).collect();
        let summary = |(index, run): (usize, &Option<RunDelays>)| {
            Some(RunSummary::of(&steps, index, run.as_ref()?.lag_s))
        };
        let summaries = runs.iter().enumerate().map(summary).collect();
        let levels = levels_of(grid, &steps.iter().collect::<Vec<_>>(), &ran);
        let differ = runs.iter().flatten().filter(|run| run.kinds_differ).count();
        let by_kind = 2 * differ > runs.iter().flatten().count();
        let of_kind = |kind: Transition| {
            let own: Vec<&SweptStep> =
                steps.iter().filter(|step| step.transition == kind).collect();
            (by_kind && !own.is_empty()).then(|| (kind, levels_of(grid, &own, &ran)))
        };
        let kinds = Transition::ALL.into_iter().filter_map(of_kind).collect();
        Self { steps, runs: summaries, levels, kinds }
    }

    /// The steps that any setting accepts.
    pub fn judged(&self) -> impl Iterator<Item = &SweptStep> {
        self.steps.iter().filter(|step| step.accepted > 0)
    }

    /// The steps that are sensitive to a setting; the most sensitive first.
    pub fn sensitive(&self) -> Vec<&SweptStep> {
        let mut sensitive: Vec<_> = self.judged().filter(|step| !step.is_unanimous()).collect();
        let rejected = |step: &SweptStep| step.tried - step.accepted;
        sensitive.sort_by(|a, b| {
            b.apart.total_cmp(&a.apart).then_with(|| rejected(b).cmp(&rejected(a)))
        });
        sensitive
    }
}

/// What became of each value of each factor, over these steps.
fn levels_of(grid: &Grid, steps: &[&SweptStep], ran: &[bool]) -> Vec<Vec<LevelSummary>> {
    let levels = |factor: Factor| {
        let of = |level| LevelSummary::of(steps, grid.at(factor, level), ran);
        (0..grid.levels(factor)).map(of).collect()
    };
    Factor::ALL.into_iter().map(levels).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Base, ReportedDelay};
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

    /// One step, of which each run reports this delay.
    fn swept(delays: [Option<f64>; 6]) -> SweptStep {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, vec![0.0, 1.0], vec![0.0; 2]).unwrap();
        let reported = |delay: f64| ReportedDelay { delay, low: delay - 0.5, high: delay + 0.5 };
        let run = |delay: Option<f64>| {
            Some(RunDelays { steps: vec![delay.map(reported)], lag_s: None, kinds_differ: false })
        };
        let sweep = JointSweep::of(&grid(), &Record::from([trial]), &delays.map(run), 2.0);
        sweep.steps[0].clone()
    }

    #[test]
    fn delays_within_the_tolerance_are_the_same() {
        let step = swept([10.0, 11.0, 12.0, 12.5, 10.5, 13.0].map(Some));
        assert!(step.is_unanimous());
        assert_eq!(step.agreement.unwrap().combinations, 6);
        assert!((step.agreement.unwrap().delay - 11.5).abs() < 1e-12);
        assert!(step.delay_depends_on.is_none());
    }

    #[test]
    fn the_setting_that_moves_a_delay_is_named() {
        let step = swept([30.0, 30.0, 31.0, 10.0, 11.0, 10.0].map(Some));
        let found = step.delay_depends_on.clone().unwrap();
        assert_eq!(found.factor, Factor::Passband);
        // Twenty apart on average, less what both sides and the tolerance allow.
        assert!((found.gap - (20.0 - 3.0)).abs() < 1e-9, "{found:?}");
        let [slow, raw] = [0, 1].map(|level| found.levels[level].unwrap());
        // Three against three: the shorter delay counts.
        assert!(slow.1 == 0.0 && raw == (10.0, 1.0));
        let step = swept([10.0, 20.0, 10.0, 11.0, 21.0, 10.0].map(Some));
        assert_eq!(step.delay_depends_on.unwrap().factor, Factor::Beta);
    }

    #[test]
    fn a_verdict_depends_on_what_turns_it() {
        let step = swept([None, None, None, Some(10.0), Some(10.0), Some(10.0)]);
        assert!(!step.is_unanimous() && step.disagreeing() == 0);
        assert_eq!(step.verdict_depends_on, Some(Factor::Passband));
        let step = swept([None; 6]);
        assert!(
            step.is_unanimous() && step.agreement.is_none() && step.verdict_depends_on.is_none()
        );
    }

    #[test]
    fn runs_that_failed_have_no_vote() {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, vec![0.0, 1.0], vec![0.0; 2]).unwrap();
        let reported = ReportedDelay { delay: 3.0, low: 3.0, high: 3.0 };
        let runs = [true, false, true, false, true, true].map(|ran| {
            ran.then(|| RunDelays { steps: vec![Some(reported)], lag_s: None, kinds_differ: false })
        });
        let sweep = JointSweep::of(&grid(), &Record::from([trial]), &runs, 0.0);
        assert_eq!((sweep.steps[0].tried, sweep.steps[0].accepted), (4, 4));
        assert!(sweep.steps[0].is_unanimous() && sweep.runs[1].is_none());
        assert!((sweep.levels[3][0].accepted - 1.0).abs() < 1e-12);
    }
}
