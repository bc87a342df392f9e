//! A preview, joint by joint.

use std::borrow::Cow;
use std::path::Path;

use rerun::ApplicationId;
use rerun::log::LogMsg;

use super::expected::Preview;
use super::recorded::PreviewRecording;
use super::{about, data, sheet, views, words};
use crate::design::Prediction;
use crate::recording::chunk::Chunks;
use crate::recording::content::{Content, Growth, Tab, hashed, name_of};
use crate::recording::error::RecordError;
use crate::recording::paths::joint_root;
use crate::report::DesignedJoint;

impl Content for PreviewRecording<'_> {
    fn name(&self) -> String {
        let from = name_of(self.sources);
        let model = self.model.and_then(Path::file_stem).map(|stem| stem.to_string_lossy());
        let parts = Some(from).filter(|from| !from.is_empty()).into_iter();
        let parts = parts.chain(model.map(Cow::into_owned));
        parts.chain(["design · next experiment".to_owned()]).collect::<Vec<_>>().join(" · ")
    }

    fn id(&self) -> String {
        hashed(self.sources, std::iter::empty(), |part| {
            for DesignedJoint { rig, schedule, prediction, .. } in self.joints {
                part(&format!("preview {rig:?} {:?}", schedule.holds()));
                part(&format!("{:?}", prediction.as_ref().map(Prediction::extent)));
            }
        })
    }

    fn add_about(&self, chunks: &mut Chunks) -> Result<(), RecordError> {
        about::add(chunks, self)
    }

    fn tabs(&self, _: Growth) -> Vec<Tab<'_>> {
        let tab = |joint| {
            let add = move |chunks: &mut Chunks| add(chunks, &Preview::of(joint));
            Tab { joint: &joint.rig.name, add: Box::new(add) }
        };
        self.joints.iter().map(tab).collect()
    }

    fn views(
        &self,
        _: Growth,
        application: &ApplicationId,
        id: &str,
    ) -> Result<Vec<LogMsg>, RecordError> {
        views::messages(self, application, id)
    }

    fn views_in_words(&self, _: Growth) -> String {
        let joints: Vec<_> = self.joints.iter().map(|joint| &joint.rig.name).collect();
        format!("preview {joints:?}")
    }
}

fn add(chunks: &mut Chunks, preview: &Preview<'_>) -> Result<(), RecordError> {
    let root = joint_root(&preview.joint.rig.name);
    data::add(chunks, &root, preview)?;
    sheet::add(chunks, &root, preview)?;
    words::add(chunks, &root, preview)
}
