//! Joints of the synthetic plant, and recordings of them.

use std::io::Write;

use tauscope::batch::Threads;
use tauscope::delay::Settings;
use tauscope::diagnosis::Comparison;
use tauscope::effect::find;
use tauscope::experiment::{Experiment, Joint, ReadOptions};
use tauscope::explain::{Improvement, Options};
use tauscope::fit::Horizon;
use tauscope::model::integrators;
use tauscope::recording::{Detail, RecordError, Recording, write_recording};
use tauscope::report::{ComparedJoint, EstimatedJoint, Finding, ImprovedJoint};
use tauscope::study::{
    JointEstimate, Mode, OtherResult, Protocol, compare_joints, estimate_joints, improve_joints,
};
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate, write_log};

use crate::read_back::ReadBack;

/// Samples of the paper's method, which are whole.
#[expect(clippy::cast_possible_truncation, reason = "they are whole")]
pub(crate) fn samples(number: f64) -> i64 {
    number as i64
}

/// Two joints, half a minute, with the estimate of their delays.
pub(crate) struct Recorded {
    pub(crate) experiment: Experiment,
    pub(crate) estimates: Vec<JointEstimate>,
    pub(crate) settings: Settings,
}

impl Recorded {
    pub(crate) fn with(settings: Settings) -> Self {
        let boom = DelayLaw::Constant { seconds: 0.2 };
        let stick = DelayLaw::Uniform { min: 0.02, max: 0.4 };
        Self::of([("boom", boom), ("stick", stick)], 30.0, settings)
    }

    pub(crate) fn of<const N: usize>(
        laws: [(&str, DelayLaw); N],
        seconds: f64,
        settings: Settings,
    ) -> Self {
        let joint = |(name, law): (&str, DelayLaw)| {
            let input =
                InputSpec::Levels { levels: vec![-1.0, -0.5, 0.5, 1.0], hold_s: [0.6, 1.5] };
            JointSpec { noise: 0.02, ..JointSpec::new(name, input, law) }
        };
        Self::made(laws.map(joint).to_vec(), seconds, settings)
    }

    pub(crate) fn made(joints: Vec<JointSpec>, seconds: f64, settings: Settings) -> Self {
        let made = simulate(&PlantSpec::new(5, seconds, joints)).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        write_log(&made, std::fs::File::create(&path).unwrap()).unwrap();
        let experiment = Experiment::read(&[path], &ReadOptions::default());
        let estimates = estimate_joints(&experiment.joints, &settings, || (), &Threads);
        let estimates = estimates.into_iter().map(Result::unwrap).collect();
        Self { experiment, estimates, settings }
    }

    pub(crate) fn joints(&self) -> Vec<EstimatedJoint<'_>> {
        let pairs = self.experiment.joints.iter().zip(&self.estimates);
        pairs.map(|(joint, estimate)| EstimatedJoint { joint, estimate }).collect()
    }

    pub(crate) fn write(&self, detail: Detail, out: impl Write) -> Result<(), RecordError> {
        self.write_with(&[], detail, out)
    }

    pub(crate) fn write_with(
        &self,
        models: &[ComparedJoint<'_>],
        detail: Detail,
        out: impl Write,
    ) -> Result<(), RecordError> {
        self.write_all(models, &[], detail, out)
    }

    pub(crate) fn write_all(
        &self,
        models: &[ComparedJoint<'_>],
        revisions: &[ImprovedJoint<'_>],
        detail: Detail,
        out: impl Write,
    ) -> Result<(), RecordError> {
        self.write_beside(models, &[], revisions, detail, out)
    }

    pub(crate) fn write_beside(
        &self,
        models: &[ComparedJoint<'_>],
        also: &[OtherResult],
        revisions: &[ImprovedJoint<'_>],
        detail: Detail,
        out: impl Write,
    ) -> Result<(), RecordError> {
        let joints = self.joints();
        let (settings, sources) = (&self.settings, self.experiment.sources.as_slice());
        let reading = &self.experiment.options;
        write_recording(
            &Recording {
                command: "estimate",
                joints: &joints,
                settings,
                sources,
                reading,
                detail,
                models,
                also,
                revisions,
            },
            out,
        )
    }

    /// Each joint beside the integrator that its delays suggest.
    pub(crate) fn compared(&self) -> Vec<Comparison> {
        let joints = &self.experiment.joints;
        let estimates: Vec<_> = self.estimates.iter().cloned().map(Ok).collect();
        let model = |joint: &Joint| {
            let place = joints.iter().position(|known| known.name == joint.name).unwrap();
            let estimated: Vec<_> = self.estimates[place].estimated().collect();
            integrators(joint, &estimated).into_iter().next()
        };
        let horizon = Horizon::FreeRun;
        let protocol = Protocol { mode: Mode::AsItIs, split: None, horizon };
        let compared = compare_joints(joints, &estimates, model, protocol, &Threads);
        compared.into_iter().map(|result| result.unwrap().unwrap()).collect()
    }

    /// Each joint as it is improved, with the effects of a short list.
    pub(crate) fn improved(&self) -> Vec<Improvement> {
        let joints = &self.experiment.joints;
        let estimates: Vec<_> = self.estimates.iter().cloned().map(Ok).collect();
        let horizon = Horizon::Steps;
        let protocol = Protocol { mode: Mode::FitOrIntegrator, split: None, horizon };
        let effects = ["dead_band", "actuator_lag", "thermal_drift"].map(|id| find(id).unwrap());
        let options = Options { effects: effects.to_vec(), max_effects: 3, ..Options::default() };
        let start = |_: &Joint| None;
        let improved =
            improve_joints(joints, &estimates, start, protocol, &options, |_, _| true, &Threads);
        improved.into_iter().map(|result| result.unwrap().unwrap()).collect()
    }

    /// What is read back of a recording of `improvements`.
    pub(crate) fn read_back_grown(&self, improvements: &[Improvement]) -> ReadBack {
        let joints = self.experiment.joints.iter().zip(improvements);
        let grown = joints.map(|(joint, improvement)| grown(joint, improvement));
        let mut bytes = Vec::new();
        self.write_all(&[], &grown.collect::<Vec<_>>(), Detail::Full, &mut bytes).unwrap();
        ReadBack::of(&bytes)
    }

    pub(crate) fn read_back(&self, detail: Detail) -> ReadBack {
        let mut bytes = Vec::new();
        self.write(detail, &mut bytes).unwrap();
        ReadBack::of(&bytes)
    }
}

pub(crate) fn grown<'a>(joint: &'a Joint, improvement: &'a Improvement) -> ImprovedJoint<'a> {
    let Improvement { revisions, verdict, attribution } = improvement;
    let last = revisions.last().unwrap();
    let revision = u32::try_from(revisions.len() - 1).unwrap();
    let comparison = &last.comparison;
    let compared = ComparedJoint { joint, model: "model", revision, comparison };
    let ranking = &last.ranking;
    let finding = Finding {
        compared,
        verdict: *verdict,
        ranking,
        add_arguments: "log.csv",
        before: None,
        attribution: Some(attribution),
        delays: None,
    };
    ImprovedJoint::of(finding, revisions)
}
