//! The accepted delays of a joint against its state: what the delay may depend on.
//!
//! Each accepted step is a point; each variable gets a rank correlation, which asks only
//! whether the delay rises or falls with it. Starts, stops, changes and reversals are compared
//! each among themselves: together they would show how they differ, not what each depends on.

use serde::Serialize;

use super::estimate::TrialEstimate;
use super::neutral::{Neutral, Transition};
use crate::experiment::{Joint, Trial};
use crate::numerics::{holm, spearman};

/// Samples before an input step over which a further signal is averaged.
const COVARIATE_SAMPLES: usize = 5;

/// Chance of any false "depends" among all variables of a joint.
const LEVEL: f64 = 0.05;

/// An accepted step: its delay, and the joint's state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepState {
    /// Label of the trial; all steps of a trial share it.
    pub trial: String,
    /// `i`: number of the step in its trial, from 1.
    pub number: usize,
    /// Which kind of step it is.
    pub transition: Transition,
    /// The delay in seconds.
    pub delay_s: f64,
    /// Magnitude of the slope after the breakpoint, output units per second.
    pub average_speed: f64,
    /// Change of the input, input units; its sign is the direction.
    pub input_change: f64,
    /// Seconds that the level before was held; none for the first step of a trial.
    pub dwell_s: Option<f64>,
    /// Output at the breakpoint, smoothed if the estimate was made so; output units.
    pub angle: f64,
    /// Time of the input step, in seconds since the [origin](Trial::origin_s).
    #[serde(skip)]
    pub time_s: f64,
    /// Time of the input step by the clock of the log, seconds.
    #[serde(rename = "time_s")]
    pub logged_time_s: f64,
    /// Mean of each further signal over the five samples before the input step, in the
    /// order of [`Joint::covariates`]; none where it was not measured.
    pub covariates: Vec<Option<f64>>,
}

/// How the delay goes with one variable.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Correlation {
    /// Its name.
    pub variable: String,
    /// Its unit, where it is known.
    pub unit: Option<String>,
    /// Accepted steps for which it is known.
    pub steps: usize,
    /// Spearman's ρ; none when the variable or the delay is constant, or with fewer than
    /// four steps.
    pub rho: Option<f64>,
    /// Two-sided p-value of ρ alone, see [`spearman`].
    pub p_value: Option<f64>,
    /// The p-value after Holm's correction for all variables of the joint.
    pub p_holm: Option<f64>,
    /// Whether that is at most 0.05.
    pub significant: bool,
}

/// The accepted delays of a joint against its state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AgainstState {
    /// The accepted steps of all trials, in their order.
    pub steps: Vec<StepState>,
    /// Of the steps of all kinds: average speed, step size, direction (1 up, −1 down), dwell, angle,
    /// time, then the further signals.
    pub correlations: Vec<Correlation>,
    /// Correlations for the steps of each kind that there is.
    #[serde(rename = "by_transition")]
    pub kinds: Vec<AgainstOfKind>,
}

/// The accepted delays of one kind of step against the joint's state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AgainstOfKind {
    /// Which kind.
    pub transition: Transition,
    /// Accepted steps.
    pub steps: usize,
    /// As in [`AgainstState::correlations`].
    pub correlations: Vec<Correlation>,
    /// Pairs of variables on each of which the delay depends, and which go with one another: the
    /// record does not show which of them it is.
    pub confounded: Vec<[String; 2]>,
}

impl AgainstState {
    /// Whether the delay of all steps, or of those of one kind, depends significantly on something.
    pub(crate) fn has_dependence(&self) -> bool {
        let of_kinds = self.kinds.iter().flat_map(|kind| &kind.correlations);
        self.correlations.iter().chain(of_kinds).any(|one| one.significant)
    }

    /// Compares the delays of `joint`, by the kinds of steps about its `neutral` input;
    /// `estimates` has one entry per trial of it, in order, none where there is no estimate.
    pub fn of<'a>(
        joint: &'a Joint,
        neutral: Option<&'a Neutral>,
        estimates: impl IntoIterator<Item = Option<&'a TrialEstimate>>,
    ) -> Self {
        let trials = joint.trials.iter().zip(estimates);
        let estimated = trials.filter_map(|(trial, estimate)| Some((trial, estimate?)));
        let steps: Vec<_> =
            estimated.flat_map(|(trial, found)| states(trial, found, neutral)).collect();
        let all: Vec<&StepState> = steps.iter().collect();
        let correlations = compare(joint, &all);
        let kinds = Transition::ALL.into_iter().filter_map(|kind| {
            let same = steps.iter().filter(|step| step.transition == kind);
            let same: Vec<&StepState> = same.collect();
            let correlations = compare(joint, &same);
            (!same.is_empty()).then(|| AgainstOfKind {
                transition: kind,
                steps: same.len(),
                confounded: confounded(&same, &correlations),
                correlations,
            })
        });
        Self { kinds: kinds.collect(), steps, correlations }
    }
}

/// The delays of `steps` against every variable, with Holm's correction for their number.
fn compare(joint: &Joint, steps: &[&StepState]) -> Vec<Correlation> {
    let named = variables(joint).into_iter().enumerate();
    let mut correlations: Vec<_> =
        named.map(|(number, variable)| correlate(steps, number, variable)).collect();
    let tested = correlations.iter_mut().filter_map(|one| Some((one.p_value?, one)));
    let (p_values, tested): (Vec<f64>, Vec<&mut Correlation>) = tested.unzip();
    for (corrected, one) in holm(&p_values).into_iter().zip(tested) {
        one.p_holm = Some(corrected);
        one.significant = corrected <= LEVEL;
    }
    correlations
}

/// The pairs, of what the delay depends on in `steps`, that go with one another.
fn confounded(steps: &[&StepState], correlations: &[Correlation]) -> Vec<[String; 2]> {
    /// Rank correlation of two variables (chosen).
    const TOGETHER: f64 = 0.8;
    let depends: Vec<usize> =
        (0..correlations.len()).filter(|number| correlations[*number].significant).collect();
    let go_together = |one: usize, other: usize| {
        let pair = |step: &&StepState| Some((step.value(one)?, step.value(other)?));
        let (one, other): (Vec<f64>, Vec<f64>) = steps.iter().filter_map(pair).unzip();
        spearman(&one, &other).is_some_and(|test| test.statistic.abs() >= TOGETHER)
    };
    let mut pairs = Vec::new();
    for (index, one) in depends.iter().enumerate() {
        let others = depends.iter().skip(index + 1).filter(|other| go_together(*one, **other));
        pairs
            .extend(others.map(|other| [*one, *other].map(|it| correlations[it].variable.clone())));
    }
    pairs
}

/// The accepted steps of a trial.
fn states<'a>(
    trial: &'a Trial,
    estimate: &'a TrialEstimate,
    neutral: Option<&'a Neutral>,
) -> impl Iterator<Item = StepState> + 'a {
    let output = estimate.smoothed.as_deref().unwrap_or(trial.output());
    let period_s = trial.period().seconds();
    let decisions = estimate.decisions.iter().enumerate();
    decisions.filter_map(move |(index, decision)| {
        let (delay, best) = (decision.accepted_delay()?, decision.breakpoint()?);
        let before = index.checked_sub(1).and_then(|before| estimate.decisions.get(before));
        let step = decision.input_step;
        let dwell = before.map(|before| step.sample - before.input_step.sample);
        let covariate = |signal: &Vec<f64>| mean_before(signal, step.sample);
        Some(StepState {
            trial: trial.label().to_owned(),
            number: decision.number,
            transition: Transition::of(&step, neutral),
            delay_s: delay * period_s,
            average_speed: best.candidate.after.slope.abs() / period_s,
            input_change: step.after - step.before,
            dwell_s: dwell.map(|samples| samples as f64 * period_s),
            angle: *output.get(best.candidate.breakpoint.checked_sub(1)?)?,
            time_s: trial.time_s(step.sample),
            logged_time_s: trial.logged_time_s(step.sample),
            covariates: trial.covariates().iter().map(covariate).collect(),
        })
    })
}

/// Mean of the samples just before number `sample`, counted from 1, that were measured.
fn mean_before(signal: &[f64], sample: usize) -> Option<f64> {
    let end = sample.checked_sub(1)?;
    let before = signal.get(end.saturating_sub(COVARIATE_SAMPLES)..end)?;
    let (count, sum) = before
        .iter()
        .filter(|value| value.is_finite())
        .fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
    (count > 0.0).then(|| sum / count)
}

/// Name and unit of each variable, in the order of [`StepState::value`].
fn variables(joint: &Joint) -> Vec<(&str, Option<String>)> {
    let seconds = || Some("s".to_owned());
    let speed = joint.output_unit.as_ref().map(|unit| format!("{unit}/s"));
    let own = [
        ("average_speed", speed),
        ("step_size", joint.input_unit.clone()),
        ("direction", None),
        ("dwell", seconds()),
        ("angle", joint.output_unit.clone()),
        ("time", seconds()),
    ];
    let further = joint.covariates.iter().map(|signal| (signal.name.as_str(), signal.unit.clone()));
    own.into_iter().chain(further).collect()
}

impl StepState {
    /// The value of a variable, numbered as in [`AgainstState::correlations`]; none where it
    /// is not known.
    pub fn value(&self, variable: usize) -> Option<f64> {
        match variable {
            0 => Some(self.average_speed),
            1 => Some(self.input_change.abs()),
            2 => Some(self.input_change.signum()),
            3 => self.dwell_s,
            4 => Some(self.angle),
            5 => Some(self.time_s),
            further => self.covariates.get(further - 6).copied().flatten(),
        }
    }
}

/// Correlates the delays with a variable, named and numbered.
fn correlate(
    steps: &[&StepState],
    variable: usize,
    (name, unit): (&str, Option<String>),
) -> Correlation {
    let known = steps.iter().filter_map(|step| Some((step.value(variable)?, step.delay_s)));
    let (values, delays): (Vec<f64>, Vec<f64>) = known.unzip();
    let test = spearman(&values, &delays);
    Correlation {
        variable: name.to_owned(),
        unit,
        steps: values.len(),
        rho: test.map(|test| test.statistic),
        p_value: test.map(|test| test.p_value),
        p_holm: None,
        significant: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signal_is_averaged_over_what_was_measured_before_the_step() {
        let signal = [9.0, 1.0, f64::NAN, 2.0, 3.0, 6.0, 100.0];
        assert!(mean_before(&signal, 7).is_some_and(|mean| (mean - 3.0).abs() < 1e-15));
        assert!(mean_before(&signal, 2).is_some_and(|mean| (mean - 9.0).abs() < 1e-15));
        assert_eq!(mean_before(&signal, 1), None);
        assert_eq!(mean_before(&[f64::NAN; 9], 8), None);
    }
}
