//! What is to be played and what is expected of it, before it is played.
//!
//! A page per joint shows the input, what the model or either suspect would make of it with
//! the margin of that, and where the two differ beyond the noise. On `segment` a cursor goes
//! from hold to hold, on `time` and `sample` through all samples.

mod about;
mod data;
mod sheet;
mod words;

use std::borrow::Cow;
use std::path::Path;

use rerun::ApplicationId;
use rerun::log::LogMsg;

use super::blueprint::{self, Ladder};
use super::chunk::{Chunks, Index};
use super::content::{Content, Part, Take, hashed, name_of};
use super::entity::joint_root;
use super::error::RecordError;
use super::palette::{self, Rgb};
use crate::design::{Apart, Prediction, apart};
use crate::experiment::{ReadOptions, Source};
use crate::report::DesignedJoint;

pub(super) use sheet::{PARTS, SIZE};

/// Everything that a preview holds.
#[derive(Clone, Copy, Debug)]
pub struct PreviewRecording<'a> {
    /// The inputs, in the order of their tabs.
    pub joints: &'a [DesignedJoint],
    /// The logs from which the joints are known.
    pub sources: &'a [Source],
    /// How they were read.
    pub reading: &'a ReadOptions,
    /// The model file, where one was given.
    pub model: Option<&'a Path>,
}

impl Content for PreviewRecording<'_> {
    fn name(&self) -> String {
        let from = name_of(self.sources);
        let model = self.model.and_then(Path::file_stem).map(|stem| stem.to_string_lossy());
        let parts = Some(from).filter(|from| !from.is_empty()).into_iter();
        let parts = parts.chain(model.map(Cow::into_owned));
        parts.chain(["next experiment".to_owned()]).collect::<Vec<_>>().join(", ")
    }

    fn id(&self) -> String {
        hashed(self.sources, std::iter::empty(), |part| {
            for DesignedJoint { stand, schedule, prediction, .. } in self.joints {
                part(&format!("preview {stand:?} {:?}", schedule.holds()));
                part(&format!("{:?}", prediction.as_ref().map(Prediction::extent)));
            }
        })
    }

    fn namespaces(&self) -> u64 {
        self.joints.len() as u64 + 1
    }

    fn for_each_chunk(&self, part: Part<'_>, take: Take<'_>) -> Result<(), RecordError> {
        let mut chunks = Chunks::new(part.used + 2);
        about::add(&mut chunks, self)?;
        for (namespace, joint) in (part.used + 3..).zip(self.joints) {
            chunks.into_chunks().iter().try_for_each(&mut *take)?;
            chunks = Chunks::new(namespace);
            Preview::of(joint).add(&mut chunks)?;
        }
        chunks.into_chunks().iter().try_for_each(take)
    }

    fn views(
        &self,
        _: Ladder,
        application: &ApplicationId,
        id: &str,
    ) -> Result<Vec<LogMsg>, RecordError> {
        blueprint::preview_messages(self, application, id)
    }

    fn views_in_words(&self, _: Ladder) -> String {
        let joints: Vec<_> = self.joints.iter().map(|joint| &joint.stand.name).collect();
        format!("preview {joints:?}")
    }
}

/// What is expected of an input: of the model, or where one of the suspects is there.
struct Expectation<'a> {
    /// The id of the suspect, or `model`.
    name: &'a str,
    prediction: &'a Prediction,
    rgb: Rgb,
}

/// The input of a joint, as it is recorded.
struct Preview<'a> {
    joint: &'a DesignedJoint,
    expected: Vec<Expectation<'a>>,
    /// Where two suspects differ.
    apart: Option<Apart>,
}

impl<'a> Preview<'a> {
    fn of(joint: &'a DesignedJoint) -> Self {
        let expected = joint.expected().into_iter().zip(palette::models());
        let expected =
            expected.map(|((name, prediction), rgb)| Expectation { name, prediction, rgb });
        let expected: Vec<_> = expected.collect();
        let noise = joint.told.as_ref().map(|told| told.noise);
        let apart = match (expected.as_slice(), noise) {
            ([one, other], Some(noise)) => {
                let [one, other] = [one, other].map(|expected| &expected.prediction.output);
                Some(apart(&joint.schedule, one, other, noise))
            }
            _ => None,
        };
        Self { joint, expected, apart }
    }

    fn add(&self, chunks: &mut Chunks) -> Result<(), RecordError> {
        let root = joint_root(&self.joint.stand.name);
        data::add(chunks, &root, self)?;
        sheet::add(chunks, &root, self)?;
        words::add(chunks, &root, self)
    }

    /// Seconds from the start to a sample, from 0.
    fn seconds(&self, sample: usize) -> f64 {
        sample as f64 * self.joint.schedule.period().seconds()
    }

    /// Where a sample, from 0, lies on `sample` and `time`.
    fn place(&self, sample: usize) -> (i64, i64) {
        /// Nanoseconds in a second.
        const NANO: f64 = 1e9;
        #[expect(clippy::cast_possible_truncation, reason = "three centuries fit")]
        let time_ns = (NANO * self.seconds(sample)).round() as i64;
        (i64::try_from(sample).unwrap_or(i64::MAX).saturating_add(1), time_ns)
    }

    /// A row for each of the first `samples`.
    fn samples(&self, samples: usize) -> Index {
        let (sample, time_ns) = (0..samples).map(|sample| self.place(sample)).unzip();
        let mut index = Index::default();
        index.sample = sample;
        index.time_ns = time_ns;
        index
    }

    /// The first sample of each hold, from 0, and the one behind its last.
    fn holds(&self) -> Vec<(usize, usize)> {
        let start = |next: &mut usize, samples: usize| {
            let start = *next;
            *next += samples;
            Some((start, *next))
        };
        let holds = self.joint.schedule.holds().iter().map(|hold| hold.samples);
        holds.scan(0, start).collect()
    }

    /// A row for each hold, where it begins.
    fn hold_rows(&self) -> Index {
        let mut index = Index::default();
        for ((start, _), segment) in self.holds().into_iter().zip(1..) {
            let (sample, time_ns) = self.place(start);
            index.segment.push(segment);
            index.sample.push(sample);
            index.time_ns.push(time_ns);
        }
        index
    }
}

/// A unit behind the name of an axis, where there is one.
fn unit_of(unit: Option<&str>) -> String {
    unit.map_or_else(String::new, |unit| format!(" [{unit}]"))
}
