//! A model beside the measurement: all figures of it.

use std::ops::Range;

use super::curves::{Curve, curves};
use super::failure::{self, Diagnosis, Region, Samples, diagnose, regions};
use super::input_edges::without_edges;
use super::local_misfit::local_misfit;
use super::residual_size::{BEYOND_NOISE, ResidualSize, clipped};
use super::shapes::shapes;
use super::speed_error::speed_error;
use super::step_error::{StepError, step_errors};
use super::{
    ErrorFigures, InputCorrelation, LackOfFit, RawErrors, TestColumns, TrialSignals, Whiteness,
};
use super::{input_correlation, lack_of_fit, sensor_noise, whiteness};
use crate::fit::{
    Assessment, Evaluation, Excerpt, Fit, FitRecord, Horizon, Part, Termination, follows_input,
};
use crate::model::{JointModel, Simulated};

/// A model beside the measurement.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The model, its parameters and what it simulates.
    pub fit: Assessment,
    /// Why its fit stopped; [`Termination::NothingToFit`] for a model as it was given.
    pub termination: Termination,
    /// The error on the part it was fitted to.
    pub training: Option<ErrorFigures>,
    /// The error on the part it was not fitted to.
    pub validation: Option<ErrorFigures>,
    /// The error with the same restarts, each run from the smoothed measured output, and nothing
    /// removed.
    pub raw: RawErrors,
    /// That of a free run from the start of each trial.
    pub free: RawErrors,
    /// How the measured speed depends on the delayed input, the angle and the time, beside what the
    /// model makes of it.
    pub curves: Vec<Curve>,
    /// Standard deviation of the noise of the sensor, output units; none where the log does not
    /// resolve it.
    pub sensor_noise: Option<f64>,
    /// Whether the residual of the training part is more than noise; `None` where there
    /// are too few samples.
    pub lack_of_fit: Option<LackOfFit>,
    /// How the residual of the training part is correlated with itself; `None` where there
    /// are too few samples, or trials are sampled at different rates.
    pub whiteness: Option<Whiteness>,
    /// How its changes are correlated with those of the input; `None` likewise, and where
    /// the input never changes.
    pub input_correlation: Option<InputCorrelation>,
    /// Where the error is, where a lack of fit is shown: its conditions of the model restarted as
    /// [`arising`](Self::arising) says, its segments of that of the fit.
    pub failure: Option<Diagnosis>,
    /// How the model is restarted whose error is looked at: at every step of the input, so that an
    /// error counts where it is made; as in the fit where the output follows the input itself, so
    /// that no error stays.
    pub arising: Horizon,
    /// The error in each part of each feature, of that model, whether or not a lack of fit is shown.
    pub regions: Vec<Region>,
    /// The error from step to step, of the restarted model.
    pub per_step: Vec<StepError>,
}

impl Comparison {
    /// The error by which the model is judged: on the validation part where there is one.
    pub fn judged(&self) -> Option<ErrorFigures> {
        self.validation.or(self.training)
    }

    /// Whether no lack of fit is shown; where there are too few samples to test for one, whether the
    /// error is not far beyond the noise of the sensor.
    pub(crate) fn is_adequate(&self) -> bool {
        let is_large = self
            .judged()
            .zip(self.sensor_noise)
            .is_some_and(|(error, noise)| error.rmse > BEYOND_NOISE * noise);
        self.lack_of_fit.map_or(!is_large, |test| test.adequate)
    }
}

/// All figures of a fitted model on `record`.
pub fn compare(record: &FitRecord<'_>, fit: Fit) -> Comparison {
    let lack_of_fit = lack_of(record, &fit);
    compare_knowing(record, fit, lack_of_fit)
}

/// All figures of a model that was not fitted.
pub(crate) fn compare_unfitted(record: &FitRecord<'_>, model: Assessment) -> Comparison {
    let lack_of_fit = lack_of(record, &model);
    figures(record, model, Termination::NothingToFit, lack_of_fit)
}

/// All figures of a fitted model whose lack of fit is known already.
pub(crate) fn compare_knowing(
    record: &FitRecord<'_>,
    fit: Fit,
    lack_of_fit: Option<LackOfFit>,
) -> Comparison {
    figures(record, fit.assessment, fit.termination, lack_of_fit)
}

fn figures(
    record: &FitRecord<'_>,
    fit: Assessment,
    termination: Termination,
    lack_of_fit: Option<LackOfFit>,
) -> Comparison {
    let error = |part| ErrorFigures::of(record, &fit.evaluation, part);
    let fails = lack_of_fit.is_some_and(|test| !test.adequate);
    let (whiteness, input_correlation) = correlations(record, &fit.evaluation);
    let by_step = record.with_horizon(Horizon::Steps);
    let evaluation = by_step.evaluate(&fit.model);
    let per_step = step_errors(&by_step, &evaluation);
    let (arising, restarted) = if follows_input(record.joint()).is_some() {
        let evaluation = Evaluation::clone(&fit.evaluation);
        (fit.evaluation.horizon, residual_record(&by_step, evaluation, ErrorOf::Output))
    } else {
        (Horizon::Steps, residual_record(&by_step, evaluation, ErrorOf::Speed))
    };
    let fitted = || fit.evaluation.residuals.iter().flatten().copied();
    Comparison {
        training: error(Part::Training),
        validation: error(Part::Validation),
        curves: curves(record, &fit.model, &fit.evaluation.simulated),
        raw: RawErrors::of(record, &record.raw_residuals(&fit.model)),
        free: RawErrors::of(record, &record.free_residuals(&fit.model)),
        sensor_noise: sensor_noise(&record.measured().trials),
        lack_of_fit,
        whiteness,
        input_correlation,
        failure: restarted.as_ref().filter(|_| fails).map(|record| diagnose(record, fitted())),
        arising,
        regions: restarted.as_ref().map(regions).unwrap_or_default(),
        per_step,
        fit,
        termination,
    }
}

/// How the residual of the training part is correlated with itself, and with the input.
fn correlations(
    record: &FitRecord<'_>,
    evaluation: &Evaluation,
) -> (Option<Whiteness>, Option<InputCorrelation>) {
    let Some(period_s) = common_period_s(record) else { return (None, None) };
    let signals = training_signals(record, evaluation);
    (whiteness(&signals, period_s), input_correlation(&signals, period_s))
}

/// Whether the residual of `fit` is more than noise on the training part of `record`; none where it
/// is no more than rounding.
pub(crate) fn lack_of(record: &FitRecord<'_>, fit: &Assessment) -> Option<LackOfFit> {
    if record.is_exact(&fit.evaluation) {
        return None;
    }
    let floor = sensor_noise(&record.measured().trials);
    let tested = record.excerpt();
    let own = sensitivities(record, fit, &tested);
    let (test, own) = lack_in(record, &fit.evaluation, own, floor, &tested);
    let lacks = test.filter(|test| !test.adequate);
    // Step 6 of `lack_of_fit`.
    let between = lacks.and_then(|_| without_edges(record, &fit.evaluation, floor?));
    let (Some(test), Some((edges, rest))) = (test, between) else { return test };
    let (without, _) = lack_in(record, &rest, own, floor, &tested);
    Some(if without?.adequate { test.but_for(edges) } else { test })
}

/// Whether the residuals of `evaluation` are more than noise where they are `tested`, and the
/// sensitivities that it was given.
fn lack_in(
    record: &FitRecord<'_>,
    evaluation: &Evaluation,
    own: Vec<Vec<Vec<f64>>>,
    floor: Option<f64>,
    tested: &Excerpt,
) -> (Option<LackOfFit>, Vec<Vec<Vec<f64>>>) {
    let local = {
        let residuals = |part| record.cut(&evaluation.residuals, part);
        let mut everywhere = residuals(Part::Training);
        everywhere.extend(residuals(Part::Validation));
        local_misfit(&clipped(&everywhere), floor)
    };
    let columns = TestColumns {
        residuals: tested.cut(&evaluation.residuals),
        own,
        size: ResidualSize::of(record, evaluation, floor),
        local,
    };
    let test = lack_of_fit(&columns, || shapes(record, evaluation, tested.windows()));
    (test, columns.own)
}

/// The training part of each trial.
fn training_signals<'a>(
    record: &'a FitRecord<'_>,
    evaluation: &'a Evaluation,
) -> Vec<TrialSignals<'a>> {
    let trials = record.joint().trials.iter().zip(&evaluation.simulated);
    let residuals = evaluation.residuals.iter().enumerate();
    let signals = trials.zip(residuals).map(|((trial, simulated), (index, residual))| {
        let windows = record.windows_of(index).iter();
        let windows = windows.filter(|window| window.part == Part::Training);
        TrialSignals {
            residual,
            windows: windows.map(|window| window.start..window.end).collect(),
            acting: &simulated.acting,
            raw: trial.input(),
        }
    });
    signals.collect()
}

/// The sample period, where it is the same in all trials to one percent.
fn common_period_s(record: &FitRecord<'_>) -> Option<f64> {
    let mut periods = record.joint().trials.iter().map(|trial| trial.period().seconds());
    let first = periods.next()?;
    periods.all(|period| (period / first - 1.0).abs() < 0.01).then_some(first)
}

/// What is taken for the error of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ErrorOf {
    /// That of the speed: of an integrator an error of the output stays where it was not made.
    Speed,
    Output,
}

/// The residual of a model, with what happened; `record` restarts at every step of the input, whether
/// or not the simulation of `evaluation` does.
fn residual_record(
    record: &FitRecord<'_>,
    evaluation: Evaluation,
    error: ErrorOf,
) -> Option<failure::ResidualRecord> {
    let trials = &record.joint().trials;
    let mut samples = Samples::default();
    let mut segments = Vec::new();
    let simulated = evaluation.simulated.into_iter().zip(evaluation.residuals);
    for (index, (trial, (simulated, mut residual))) in trials.iter().zip(simulated).enumerate() {
        let number = u32::try_from(index).ok()?;
        let Simulated { mut velocity, mut acting, .. } = simulated;
        // What was filled in says nothing of the model.
        for gap in trial.unlogged() {
            residual[gap.clone()].fill(0.0);
        }
        let first = samples.residual.len();
        let period = trial.period().seconds();
        let levels = levels(&acting);
        for level in &levels {
            let times = (0..level.len()).map(|k| k as f64 * period);
            samples.since_step_s.extend(times);
            let held_s = level.len() as f64 * period;
            samples.hold_s.extend(std::iter::repeat_n(held_s, level.len()));
        }
        // An input that is never held has no levels to look at.
        let windows = record.windows_of(index).iter();
        let windows: Vec<_> = windows.map(|window| window.start..window.end).collect();
        if error == ErrorOf::Speed {
            samples.speed_error.extend(speed_error(&residual, &windows, period));
        }
        // An input that moves all the time changes its level with every sample.
        let own = if levels.len() > windows.len().saturating_mul(20) { windows } else { levels };
        segments.extend(own.into_iter().map(|span| first + span.start..first + span.end));
        samples.residual.append(&mut residual);
        samples.input.append(&mut acting);
        samples.speed.append(&mut velocity);
        samples.output.extend(trial.output());
        let start_s = trial.time_s(1);
        samples.time_s.extend((0..trial.len()).map(|k| start_s + k as f64 * period));
        samples.trial.extend(std::iter::repeat_n(number, trial.len()));
    }
    let labels = trials.iter().map(|trial| trial.label().to_owned()).collect();
    failure::ResidualRecord::new(samples, labels, segments).ok()
}

/// Spans of samples with one level.
fn levels(acting: &[f64]) -> Vec<Range<usize>> {
    #[expect(clippy::float_cmp, reason = "a step is any change")]
    let same = |a: &f64, b: &f64| a == b;
    let mut start = 0;
    let span = |level: &[f64]| {
        let span = start..start + level.len();
        start = span.end;
        span
    };
    acting.chunk_by(same).map(span).collect()
}

/// Derivatives of the residual to each parameter where it is `tested`, by central differences.
fn sensitivities(record: &FitRecord<'_>, fit: &Assessment, tested: &Excerpt) -> Vec<Vec<Vec<f64>>> {
    /// Part of a value, or of one unit where the value is small, that is stepped.
    const STEP: f64 = 1e-4;
    let record = record.for_training();
    let values: Vec<f64> = fit.model.values().iter().map(|value| value.value).collect();
    let column = |index: usize| {
        // A value near zero would leave a step that rounding eats.
        let step = STEP * values[index].abs().max(0.1);
        let [above, below] = [step, -step].map(|shift| {
            let mut values = values.clone();
            values[index] += shift;
            let model: JointModel = fit.model.with_values(&values);
            tested.cut(&record.evaluate_residuals(&model).residuals)
        });
        let pairs = above.into_iter().zip(below);
        pairs
            .map(|(a, b)| a.iter().zip(&b).map(|(a, b)| (a - b) / (2.0 * step)).collect())
            .collect()
    };
    (0..values.len()).map(column).collect()
}
