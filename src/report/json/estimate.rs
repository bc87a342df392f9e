//! Schema `tauscope/estimate/1`, numbers in full precision.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};

use super::dead_time::{DeadTimeJson, InputJson};
use super::difference::OtherJson;
use super::header::Header;
use super::settings::SettingsJson;
use crate::delay::{AgainstOfKind, AgainstState, Chosen, Condition, Correlation, Direction};
use crate::delay::{DelayRow, DelayTable, KindDelay, Neutral, OnsetModel, Settings, StepState};
use crate::experiment::{Experiment, ReadOptions, Source};
use crate::report::decisions::detailed_rows;
use crate::report::delay_table::DelayTableRow;
use crate::report::doubt::doubted;
use crate::report::settings::own_settings;
use crate::report::{
    Against, DecisionDetail, DecisionRow, DelayRange, Doubted, EstimatedJoint, JointSummary,
    ReviewCount, Warning,
};

/// The document of `estimate --format json`.
#[derive(Debug, Serialize)]
pub(crate) struct EstimateJson<'a> {
    #[serde(flatten)]
    header: Header,
    sources: Vec<SourceJson<'a>>,
    reading: &'a ReadOptions,
    #[serde(flatten)]
    first: RunJson<'a>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    also: Vec<RunJson<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    against: Vec<OtherJson<'a>>,
    notes: &'a [String],
    failures: &'a [String],
}

#[derive(Debug, Serialize)]
struct SourceJson<'a> {
    path: String,
    sha256: &'a str,
    bytes: u64,
}

/// All joints by one method.
#[derive(Debug, Serialize)]
struct RunJson<'a> {
    settings: SettingsJson,
    joints: Vec<JointJson<'a>>,
}

#[derive(Debug, Serialize)]
struct JointJson<'a> {
    joint: &'a str,
    input_unit: Option<&'a str>,
    output_unit: Option<&'a str>,
    steps: usize,
    accepted: usize,
    rejected: serde_json::Map<String, serde_json::Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reviewed: Option<ReviewCount>,
    delay_samples: Option<DelayRange>,
    delay_s: Option<DelayRange>,
    input: InputJson,
    #[serde(skip_serializing_if = "Option::is_none")]
    dead_time: Option<DeadTimeJson<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    settings: Option<SettingsJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    chosen: Option<ChosenJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    onset_model: Option<OnsetModelJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tracking: Option<TrackingJson>,
    warnings: Vec<Warning>,
    neutral: Option<NeutralJson>,
    delay_table: Vec<DelayRowJson<'a>>,
    delay_by_transition: Vec<KindJson>,
    against_state: AgainstJson,
    decisions: DecisionsJson<'a>,
}

/// The response behind the dead times.
#[derive(Debug, Serialize)]
struct OnsetModelJson {
    shape: &'static str,
    parameters: BTreeMap<&'static str, f64>,
    misfit: f64,
    follows_input_r2: f64,
}

impl OnsetModelJson {
    fn new(model: &OnsetModel) -> Self {
        Self {
            shape: model.shape(),
            parameters: model.parameters().into_iter().collect(),
            misfit: model.misfit(),
            follows_input_r2: model.follows_input_r2(),
        }
    }
}

/// Where the input is neutral, input units.
#[derive(Debug, Serialize)]
struct NeutralJson {
    level: f64,
    low: f64,
    high: f64,
}

/// A row of the delay table, with the limits of its bins.
#[derive(Debug, Serialize)]
struct DelayRowJson<'a> {
    #[serde(flatten)]
    row: DelayTableRow<'a>,
    level_from_limits: (f64, f64),
    level_to_limits: (f64, f64),
}

/// All steps of a kind; a median only where it is typical.
#[derive(Debug, Serialize)]
struct KindJson {
    transition: &'static str,
    steps: usize,
    accepted: usize,
    delay_median_s: Option<f64>,
    delay_low_s: Option<f64>,
    delay_high_s: Option<f64>,
    most_rejected_as: Option<&'static str>,
}

/// Settings that were chosen, and from what.
#[derive(Debug, Serialize)]
struct ChosenJson {
    automatic: AutomaticJson,
    grounds: StatisticsJson,
}

#[derive(Debug, Serialize)]
struct AutomaticJson {
    alpha: bool,
    beta: bool,
    passband: bool,
}

#[derive(Debug, Serialize)]
struct StatisticsJson {
    short_delay: Option<f64>,
    noise: Option<f64>,
    noise_correlation: Option<f64>,
    motion_ends_hz: Option<f64>,
}

/// Where an output comes to rest: at `offset + gain · input`.
#[derive(Debug, Serialize)]
struct TrackingJson {
    offset: f64,
    gain: f64,
}

/// The delay against the state of the joint.
#[derive(Debug, Serialize)]
struct AgainstJson {
    steps: StepStatesJson,
    correlations: Vec<CorrelationJson>,
    direction: DirectionJson,
    by_transition: Vec<AgainstKindJson>,
}

/// The delay of the steps of one kind against the state of the joint.
#[derive(Debug, Serialize)]
struct AgainstKindJson {
    transition: &'static str,
    steps: usize,
    correlations: Vec<CorrelationJson>,
    direction: DirectionJson,
    /// Pairs of variables of which the record does not tell on which one the delay depends.
    confounded: Vec<[String; 2]>,
}

/// All accepted steps, each made as it is written.
#[derive(Debug)]
struct StepStatesJson(Vec<StepState>);

impl Serialize for StepStatesJson {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter().map(StepStateJson::from))
    }
}

#[derive(Debug, Serialize)]
struct StepStateJson<'a> {
    trial: &'a str,
    number: usize,
    transition: &'static str,
    delay_s: f64,
    average_speed: f64,
    input_change: f64,
    dwell_s: Option<f64>,
    angle: f64,
    time_s: f64,
    covariates: &'a [Option<f64>],
}

#[derive(Debug, Serialize)]
struct CorrelationJson {
    variable: String,
    unit: Option<String>,
    steps: usize,
    rho: Option<f64>,
    p_value: Option<f64>,
    p_holm: Option<f64>,
    significant: bool,
}

#[derive(Debug, Serialize)]
struct DirectionJson {
    up: usize,
    down: usize,
    median_difference_s: Option<f64>,
    p_value: Option<f64>,
    p_holm: Option<f64>,
    significant: bool,
}

/// All decisions on a joint, each made as it is written: there may be hundreds of thousands.
#[derive(Debug)]
struct DecisionsJson<'a>(EstimatedJoint<'a>);

impl Serialize for DecisionsJson<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let rows = detailed_rows(self.0).zip(doubted(self.0));
        serializer.collect_seq(rows.map(|((row, detail), Doubted { doubt, .. })| DecisionJson {
            row,
            detail,
            doubt: doubt.value(),
            flags: doubt.flags.iter().map(|flag| flag.id()).collect(),
        }))
    }
}

/// A decision with its details, its doubt from 0 to 1, and what is odd about it.
#[derive(Debug, Serialize)]
struct DecisionJson<'a> {
    #[serde(flatten)]
    row: DecisionRow<'a>,
    #[serde(flatten)]
    detail: DecisionDetail,
    doubt: f64,
    flags: Vec<&'static str>,
}

impl<'a> EstimateJson<'a> {
    /// Collects the results of one or several runs, the first of which is the answer;
    /// `against` compares it with further ones; the last are notes on reading and results, and
    /// messages on joints and files that failed.
    pub(crate) fn new(
        experiment: &'a Experiment,
        runs: &[(&'a Settings, &'a [EstimatedJoint<'a>])],
        against: &'a [Against<'a>],
        (notes, failures): (&'a [String], &'a [String]),
    ) -> Option<Self> {
        let run = |(settings, joints): &(&Settings, &'a [EstimatedJoint<'a>])| RunJson {
            settings: (*settings).into(),
            joints: joints.iter().map(|joint| JointJson::new(*joint, settings)).collect(),
        };
        let (first, others) = runs.split_first()?;
        let source = |source: &'a Source| SourceJson {
            path: source.path.display().to_string(),
            sha256: &source.sha256,
            bytes: source.bytes,
        };
        Some(Self {
            header: Header::of("tauscope/estimate/1"),
            sources: experiment.sources.iter().map(source).collect(),
            reading: &experiment.options,
            first: run(first),
            also: others.iter().map(run).collect(),
            against: against.iter().map(OtherJson::new).collect(),
            notes,
            failures,
        })
    }
}

impl<'a> JointJson<'a> {
    fn new(joint: EstimatedJoint<'a>, asked: &Settings) -> Self {
        let chosen = joint.estimate.chosen;
        let is_own = chosen.is_some() || own_settings(&joint, asked).is_some();
        let DelayTable { neutral, rows, kinds, .. } = joint.delay_table();
        let against_state = joint.against_state_about(neutral.as_ref());
        let JointSummary { steps, accepted, rejected, delay_samples, delay_s, reviewed, .. } =
            JointSummary::with(joint, kinds.clone());
        let count = |(condition, count): (Condition, usize)| (condition.to_string(), count.into());
        Self {
            joint: &joint.joint.name,
            input_unit: joint.joint.input_unit.as_deref(),
            output_unit: joint.joint.output_unit.as_deref(),
            steps,
            accepted,
            rejected: rejected.into_iter().map(count).collect(),
            reviewed,
            delay_samples,
            delay_s,
            input: InputJson::of(joint),
            dead_time: DeadTimeJson::of(joint),
            settings: is_own.then(|| (&joint.estimate.settings).into()),
            chosen: chosen.map(Into::into),
            onset_model: joint.onset_model().map(OnsetModelJson::new),
            tracking: joint
                .tracking()
                .map(|found| TrackingJson { offset: found.offset(), gain: found.gain() }),
            warnings: joint.warnings(),
            neutral: neutral.map(|Neutral { level, low, high }| NeutralJson { level, low, high }),
            delay_table: rows.iter().map(|row| DelayRowJson::new(&joint.joint.name, row)).collect(),
            delay_by_transition: kinds.into_iter().map(Into::into).collect(),
            against_state: against_state.into(),
            decisions: DecisionsJson(joint),
        }
    }
}

impl<'a> DelayRowJson<'a> {
    fn new(joint: &'a str, row: &DelayRow) -> Self {
        let (level_from_limits, level_to_limits) = (row.from_limits, row.to_limits);
        Self { row: DelayTableRow::new(joint, row), level_from_limits, level_to_limits }
    }
}

impl From<KindDelay> for KindJson {
    fn from(kind: KindDelay) -> Self {
        let interval = kind.typical.and_then(|typical| typical.interval_s);
        Self {
            transition: kind.transition.id(),
            steps: kind.steps,
            accepted: kind.accepted,
            delay_median_s: kind.typical.map(|typical| typical.median_s),
            delay_low_s: interval.map(|(low, _)| low),
            delay_high_s: interval.map(|(_, high)| high),
            most_rejected_as: kind.rejected.map(|(condition, _)| condition.id()),
        }
    }
}

impl From<Chosen> for ChosenJson {
    fn from(Chosen { automatic, statistics }: Chosen) -> Self {
        Self {
            automatic: AutomaticJson {
                alpha: automatic.alpha,
                beta: automatic.beta,
                passband: automatic.passband,
            },
            grounds: StatisticsJson {
                short_delay: statistics.short_delay,
                noise: statistics.noise,
                noise_correlation: statistics.noise_correlation,
                motion_ends_hz: statistics.motion_ends_hz,
            },
        }
    }
}

impl From<AgainstState> for AgainstJson {
    fn from(AgainstState { steps, correlations, direction, kinds }: AgainstState) -> Self {
        Self {
            steps: StepStatesJson(steps),
            correlations: correlations.into_iter().map(Into::into).collect(),
            direction: direction.into(),
            by_transition: kinds.into_iter().map(Into::into).collect(),
        }
    }
}

impl From<AgainstOfKind> for AgainstKindJson {
    fn from(found: AgainstOfKind) -> Self {
        Self {
            transition: found.transition.id(),
            steps: found.steps,
            correlations: found.correlations.into_iter().map(Into::into).collect(),
            direction: found.direction.into(),
            confounded: found.confounded,
        }
    }
}

impl<'a> From<&'a StepState> for StepStateJson<'a> {
    fn from(step: &'a StepState) -> Self {
        Self {
            trial: &step.trial,
            number: step.number,
            transition: step.transition.id(),
            delay_s: step.delay_s,
            average_speed: step.average_speed,
            input_change: step.input_change,
            dwell_s: step.dwell_s,
            angle: step.angle,
            time_s: step.logged_time_s,
            covariates: &step.covariates,
        }
    }
}

impl From<Correlation> for CorrelationJson {
    fn from(found: Correlation) -> Self {
        let Correlation { variable, unit, steps, rho, p_value, p_holm, significant } = found;
        Self { variable, unit, steps, rho, p_value, p_holm, significant }
    }
}

impl From<Direction> for DirectionJson {
    fn from(found: Direction) -> Self {
        let Direction { up, down, median_difference_s, p_value, p_holm, significant } = found;
        Self { up, down, median_difference_s, p_value, p_holm, significant }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correlation_is_written_with_all_fields() {
        let correlation = Correlation {
            variable: "average_speed".to_owned(),
            unit: None,
            steps: 0,
            rho: None,
            p_value: None,
            p_holm: None,
            significant: false,
        };
        let json = serde_json::to_value(CorrelationJson::from(correlation)).unwrap();
        let keys: Vec<_> = json.as_object().unwrap().keys().cloned().collect();
        assert_eq!(keys.join(" "), "variable unit steps rho p_value p_holm significant");
    }
}
