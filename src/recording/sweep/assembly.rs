//! A recording of a sweep, joint by joint.

use rerun::ApplicationId;
use rerun::log::LogMsg;

use super::recorded::SweepRecording;
use super::swept::Swept;
use super::{about, data, sheet, step, views, words};
use crate::recording::chunk::Chunks;
use crate::recording::content::{Content, Growth, Tab, hashed, name_of};
use crate::recording::error::RecordError;
use crate::recording::layout::TrialStarts;
use crate::recording::paths::joint_root;

impl Content for SweepRecording<'_> {
    fn name(&self) -> String {
        format!("{} · sweep · {} settings", name_of(self.sources), self.grid.runs().len())
    }

    fn id(&self) -> String {
        hashed(self.sources, self.joints.iter().map(|joint| joint.joint), |part| {
            part(&format!("sweep {:?} {}", self.grid, self.tolerance));
        })
    }

    fn add_about(&self, chunks: &mut Chunks) -> Result<(), RecordError> {
        about::add(chunks, self)
    }

    fn tabs(&self, _: Growth) -> Vec<Tab<'_>> {
        let starts = TrialStarts::of(self.joints.iter().map(|joint| joint.joint));
        let tab = |joint| {
            let swept = Swept::of(self, joint, &starts);
            Tab { joint: &joint.joint.name, add: Box::new(move |chunks| add(chunks, &swept)) }
        };
        self.joints.iter().copied().map(tab).collect()
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
        let joints: Vec<_> = self.joints.iter().map(|joint| &joint.joint.name).collect();
        format!("sweep {joints:?}")
    }
}

fn add(chunks: &mut Chunks, swept: &Swept<'_>) -> Result<(), RecordError> {
    let root = joint_root(&swept.reported.joint.name);
    data::add(chunks, &root, swept)?;
    sheet::add(chunks, &root, swept)?;
    step::add(chunks, &root, swept)?;
    words::add(chunks, &root, swept)
}
