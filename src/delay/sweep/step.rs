//! One step over all settings: what most report, and the setting its delay depends on.

use serde::Serialize;

use super::agreement::{Agreement, ReportedDelay, gap};
use super::grid::{Combination, Factor, Grid};
use crate::delay::{InputStep, Transition};
use crate::experiment::Trial;
use crate::numerics::{median, quantile};

/// Part of the combinations that must agree for their delay to be a measure of the others.
const MOST: f64 = 0.5;

/// One step over all settings; delays in samples.
#[derive(Clone, Debug)]
pub struct SweptStep {
    /// The trial's label.
    pub trial: String,
    /// `i`: number of the step in its trial, from 1.
    pub number: usize,
    /// `p_i`: first sample with the new level, from 1.
    pub sample: usize,
    /// Its time, seconds since the [origin](Trial::origin_s).
    pub time_s: f64,
    /// Its time by the clock of the log, seconds.
    pub logged_time_s: f64,
    /// Seconds between samples.
    pub period_s: f64,
    /// Which kind of step it is.
    pub transition: Transition,
    /// What each run of the grid reports, where it accepted the step.
    pub delays: Vec<Option<ReportedDelay>>,
    /// Combinations that accepted it.
    pub accepted: usize,
    /// Combinations that did not fail.
    pub tried: usize,
    /// The delays of all combinations that accepted it.
    pub spread: Option<Spread>,
    /// What most of them can agree on.
    pub agreement: Option<Agreement>,
    /// The setting that its delay depends on most, where not all agree.
    pub delay_depends_on: Option<Sensitivity>,
    /// The setting that its verdict depends on most, where some accept it and others do not.
    pub verdict_depends_on: Option<Factor>,
    /// Mean distance of all delays from what is agreed on, beyond what each allows.
    pub apart: f64,
}

/// How far delays lie from each other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
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
pub struct Sensitivity {
    /// The setting.
    pub factor: Factor,
    /// By how much the delays miss each other, beyond what each allows, when it alone is
    /// changed; the mean over all other settings, samples.
    pub gap: f64,
    /// For each of its values the median delay, and the part of combinations that agree.
    pub levels: Vec<Option<(f64, f64)>>,
}

impl SweptStep {
    /// The step of a number in its trial, with the delay that each run of `grid` reports of it, and
    /// its votes counted; `ran` says which runs did not fail.
    pub(super) fn of(
        trial: &Trial,
        (step, transition, number): (InputStep, Transition, usize),
        delays: Vec<Option<ReportedDelay>>,
        (grid, ran): (&Grid, &[bool]),
    ) -> Self {
        let tried = grid.combinations().iter().filter(|one| ran.get(one.run) == Some(&true));
        let reported = grid.combinations().iter().map(|one| *delays.get(one.run)?);
        let reported: Vec<ReportedDelay> = reported.flatten().collect();
        let agreement = Agreement::of(&reported);
        let distances = agreement.map(|agreement| {
            reported.iter().map(|one| agreement.distance(one)).sum::<f64>() / reported.len() as f64
        });
        let mut found = Self {
            trial: trial.label().to_owned(),
            number,
            sample: step.sample,
            time_s: trial.time_s(step.sample),
            logged_time_s: trial.logged_time_s(step.sample),
            period_s: trial.period().seconds(),
            transition,
            delays,
            accepted: reported.len(),
            tried: tried.count(),
            spread: Spread::of(&reported),
            agreement,
            delay_depends_on: None,
            verdict_depends_on: None,
            apart: distances.unwrap_or(0.0),
        };
        if found.disagreeing() > 0 {
            found.delay_depends_on = found.delay_depends_on(grid);
        }
        if found.accepted > 0 && found.accepted < found.tried {
            found.verdict_depends_on = found.verdict_depends_on(grid, ran);
        }
        found
    }

    /// Whether all settings that accept it agree, and all or none do.
    pub fn is_unanimous(&self) -> bool {
        self.disagreeing() == 0 && (self.accepted == self.tried || self.accepted == 0)
    }

    /// Combinations whose delay is another than most say.
    pub(crate) fn disagreeing(&self) -> usize {
        self.accepted - self.agreement.map_or(0, |agreement| agreement.combinations)
    }

    /// What most say, where most combinations do.
    pub(crate) fn majority(&self) -> Option<Agreement> {
        let most = |agreement: &Agreement| agreement.combinations as f64 > MOST * self.tried as f64;
        self.agreement.filter(most)
    }

    pub(super) fn reported(&self, one: &Combination) -> Option<ReportedDelay> {
        self.delays.get(one.run).copied().flatten()
    }

    /// The factor that moves the delay most when it alone is changed.
    fn delay_depends_on(&self, grid: &Grid) -> Option<Sensitivity> {
        let at = |index: usize| self.reported(grid.combinations().get(index)?);
        let of_line = |line: Vec<usize>| {
            let reported: Vec<ReportedDelay> = line.into_iter().filter_map(at).collect();
            (reported.len() > 1).then(|| gap(&reported))
        };
        let moved = |factor: Factor| (factor, mean(grid.lines(factor).filter_map(of_line)));
        let (factor, gap) = greatest(Factor::ALL.map(moved))?;
        let level = |level: usize| {
            let reported = grid.at(factor, level).filter_map(|one| self.reported(one));
            let reported: Vec<ReportedDelay> = reported.collect();
            let delays: Vec<f64> = reported.iter().map(|one| one.delay).collect();
            let agree = reported.iter().filter(|one| self.agreement.is_some_and(|a| a.holds(one)));
            Some((median(&delays)?, agree.count() as f64 / reported.len() as f64))
        };
        Some(Sensitivity { factor, gap, levels: (0..grid.levels(factor)).map(level).collect() })
    }

    /// The factor that most often turns the verdict when it alone is changed.
    fn verdict_depends_on(&self, grid: &Grid, ran: &[bool]) -> Option<Factor> {
        let at = |index: usize| {
            let one = grid.combinations().get(index)?;
            ran.get(one.run).filter(|ran| **ran)?;
            Some(self.reported(one).is_some())
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

pub(super) fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, count), one| (sum + one, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

impl Spread {
    fn of(reported: &[ReportedDelay]) -> Option<Self> {
        let delays: Vec<f64> = reported.iter().map(|one| one.delay).collect();
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
