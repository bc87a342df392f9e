//! A recording of a sweep: what it is made of, its page on all of it, its joints and its views.

use std::fmt::Write as _;

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
use crate::report::SweepRecording;
use crate::report::recorded::names_of;
use crate::report::settings::settings_table;
use crate::report::sweep::{level_text, sweep_sentences};
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
        page(self).unwrap_or_default()
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
fn page(sweep: &SweepRecording<'_>) -> Result<String, std::fmt::Error> {
    let mut page = String::new();
    writeln!(page, "# Delays of {} joints with every setting\n", sweep.joints.len())?;
    for joint in sweep.joints {
        let sentences = sweep_sentences(sweep.grid, joint).join(" ");
        writeln!(page, "- **{}**: {}", plain(&joint.joint.name), plain(&sentences))?;
    }
    writeln!(page, "\n## What was tried\n\n| setting | values |\n|---|---|")?;
    for factor in Factor::ALL {
        let level = |level| level_text(sweep.grid, factor, level);
        let levels: Vec<_> = (0..sweep.grid.levels(factor)).map(level).collect();
        writeln!(page, "| {factor} | {} |", plain(&levels.join(", ")))?;
    }
    let (combinations, runs) = (sweep.grid.combinations().len(), sweep.grid.runs().len());
    writeln!(
        page,
        "\n{combinations} combinations, of which {runs} differ. Two delays agree if they differ \
         by no more than {} samples beyond the resolution of each: ± β/2, or its interval.\n",
        number(sweep.tolerance)
    )?;
    for base in sweep.grid.bases() {
        writeln!(page, "### {}, where nothing else was tried\n", base.settings.method)?;
        writeln!(page, "{}", settings_table(&base.settings).markdown(plain))?;
    }
    made_from(&mut page, sweep.sources, sweep.reading)?;
    Ok(page)
}
