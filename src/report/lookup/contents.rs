//! What every language writes: where the delays are from, and the curves of each joint.

use std::cmp::Ordering;

use crate::delay::{Automatic, DelayCurve, DelayTable, Neutral, Settings};
use crate::experiment::Source;
use crate::report::EstimatedJoint;
use crate::report::text::settings_line;
use crate::wording::number;

/// The delays of all joints, ready to be written.
#[derive(Clone, Debug)]
pub(crate) struct Lookup<'a> {
    /// Where it is from, line by line.
    pub(super) origin: Vec<String>,
    pub(super) joints: Vec<JointLookup<'a>>,
}

#[derive(Clone, Debug)]
pub(super) struct JointLookup<'a> {
    pub(super) name: &'a str,
    pub(super) input_unit: Option<&'a str>,
    pub(super) neutral: Option<Neutral>,
    pub(super) curves: Vec<DelayCurve>,
}

impl<'a> Lookup<'a> {
    /// The delays of `joints`, which were estimated with `settings` from `sources`.
    pub(crate) fn new(
        sources: &[Source],
        joints: &[EstimatedJoint<'a>],
        settings: &Settings,
    ) -> Self {
        let automatic = joints.iter().find_map(|joint| joint.estimate.chosen);
        let automatic = automatic.map_or_else(Automatic::default, |chosen| chosen.automatic);
        let source =
            |source: &Source| format!("log: {} (SHA-256 {})", source.path.display(), source.sha256);
        let tables: Vec<_> =
            joints.iter().map(|joint| (joint.joint, joint.delay_table())).collect();
        let lines = [format!("made by tauscope {} estimate", env!("CARGO_PKG_VERSION"))];
        let method = format!("method: {}", settings_line(settings, automatic));
        let lines = lines.into_iter().chain(sources.iter().map(source)).chain([method]);
        let counted = tables.iter().map(|(joint, table)| joint_line(&joint.name, table));
        let origin = lines.chain(counted).map(|line| line.replace(['\n', '\r'], " ")).collect();
        let joints = tables.into_iter().map(|(joint, table)| JointLookup {
            name: &joint.name,
            input_unit: joint.input_unit.as_deref(),
            neutral: table.neutral,
            curves: table.curves,
        });
        Self { origin, joints: joints.collect() }
    }

    /// The lines on where it is from, each behind `prefix`.
    pub(super) fn commented(&self, prefix: &str) -> String {
        self.origin.iter().flat_map(|line| [prefix, line, "\n"]).collect()
    }
}

/// How many steps of a joint the lookup is from, and where its input is neutral.
fn joint_line(name: &str, table: &DelayTable) -> String {
    let accepted: usize = table.rows.iter().map(|row| row.accepted).sum();
    let steps: usize = table.rows.iter().map(|row| row.steps).sum();
    let neutral = table.neutral.map_or_else(
        || "neutral not known".to_owned(),
        |neutral| format!("neutral from {} to {}", number(neutral.low), number(neutral.high)),
    );
    format!("joint {name}: {accepted} of {steps} steps accepted, {neutral}")
}

/// A side as a number.
pub(super) fn side(side: Ordering) -> i8 {
    match side {
        Ordering::Less => -1,
        Ordering::Equal => 0,
        Ordering::Greater => 1,
    }
}

/// Levels and delays of a curve, each as numbers between commas.
pub(super) fn numbers(curve: &DelayCurve) -> (String, String) {
    let list = |values: Vec<f64>| {
        values.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(", ")
    };
    let levels = curve.points.iter().map(|point| point.level).collect();
    (list(levels), list(curve.points.iter().map(|point| point.delay.median_s).collect()))
}

/// A text between double quotes, as C and Python read it.
pub(super) fn quoted(text: &str) -> String {
    let escaped = text.replace('\\', "\\\\").replace('"', "\\\"");
    format!("\"{}\"", escaped.replace(|c: char| c.is_control(), " "))
}
