//! A recording of a sweep: what it is made of, its page on all of it, its joints and its views.

use super::swept::Swept;
use super::{sheet, words};
use crate::delay::sweep::Factor;
use crate::recording::about::made_from;
use crate::recording::blueprint::{Blueprint, Page};
use crate::recording::chunk::Chunks;
use crate::recording::content::{Content, Tab, hashed};
use crate::recording::error::RecordError;
use crate::recording::layout::TrialStarts;
use crate::recording::markdown::plain;
use crate::recording::paths::{self, at, joint_root};
use crate::report::recorded::names_of;
use crate::report::settings::settings_table;
use crate::report::sweep::{level_text, sweep_sentences};
use crate::report::{SweepRecording, TextTable};
use crate::wording::number;

impl Content for SweepRecording<'_> {
    fn name(&self) -> String {
        format!("{} · sweep · {} settings", names_of(self.sources), self.grid.runs().len())
    }

    fn id(&self) -> String {
        hashed(self.sources, self.joints.iter().map(|joint| joint.joint), |part| {
            part(&format!("sweep {:?} {}", self.grid, self.tolerance));
        })
    }

    fn about(&self) -> String {
        page(self)
    }

    fn tabs(&self) -> Vec<Tab<'_>> {
        let starts = TrialStarts::of(self.joints.iter().map(|joint| joint.joint));
        let tab = |joint| {
            let swept = Swept::of(self.grid, joint, &starts);
            Tab { joint: &joint.joint.name, add: Box::new(move |chunks| add(chunks, &swept)) }
        };
        self.joints.iter().copied().map(tab).collect()
    }

    fn blueprint(&self) -> Blueprint {
        let tabs = self.joints.iter().map(|joint| tab(&joint.joint.name)).collect();
        let about = "About".to_owned();
        Blueprint { tabs, about, timeline: "setting" }
    }
}

fn add(chunks: &mut Chunks, swept: &Swept<'_>) -> Result<(), RecordError> {
    words::add_numbers(chunks, swept)?;
    sheet::add(chunks, swept)?;
    words::add(chunks, swept)
}

/// All steps; beside them what is found, what is under the cursor, and the
/// steps to look at.
fn tab(joint: &str) -> Page {
    let root = joint_root(joint);
    let path = |path: &str| at(&root, path);
    let all = Page::drawing("All steps", &path(paths::SHEET), sheet::SIZE);
    let list = "Steps sensitive to a setting: click a number on the left";
    let words = [
        (5.0, Page::text("What is found", path(paths::FOUND))),
        (2.6, Page::text("Under the cursor", path(paths::HERE))),
        (2.4, Page::list(list, path(paths::SENSITIVE_LOG), "segment")),
    ];
    let columns = [(7.1, all), (2.9, Page::stacked("Words", words))];
    Page::beside(joint, columns)
}

/// What was tried, and what it was made from.
fn page(sweep: &SweepRecording<'_>) -> String {
    let joints = sweep.joints.iter().map(|joint| {
        let sentences = sweep_sentences(sweep.grid, joint).join(" ");
        format!("- **{}**: {}\n", plain(&joint.joint.name), plain(&sentences))
    });
    let tried = Factor::ALL.map(|factor| {
        let level = |level| level_text(sweep.grid, factor, level);
        let levels: Vec<_> = (0..sweep.grid.levels(factor)).map(level).collect();
        [factor.to_string(), levels.join(", ")]
    });
    let (combinations, runs) = (sweep.grid.combinations().len(), sweep.grid.runs().len());
    let note = format!(
        "{combinations} combinations, of which {runs} differ. Two delays agree if they differ by no \
         more than {} samples beyond the resolution of each: ± β/2, or its interval.",
        number(sweep.tolerance)
    );
    let settings = sweep.grid.bases().iter().map(|base| {
        let table = settings_table(&base.settings).markdown(plain);
        format!("### {}, where nothing else was tried\n\n{table}\n", base.settings.method)
    });
    [
        format!("# Delays of {} joints with every setting", sweep.joints.len()),
        joints.collect(),
        "## What was tried".to_owned(),
        TextTable::of(["setting", "values"], &[], tried).markdown(plain),
        note,
        settings.collect(),
        made_from(sweep.sources, sweep.reading),
    ]
    .join("\n\n")
}
