//! What every language writes: where the delays are from, and the curves of each joint.

use std::cmp::Ordering;

use crate::delay::{
    Automatic, CurvePoint, DelayCurve, DelayTable, Finding, Neutral, Settings, Transition,
    TypicalDelay,
};
use crate::experiment::{Source, is_control};
use crate::report::settings::settings_line;
use crate::report::{EstimatedJoint, dead_time_sentences};
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

impl JointLookup<'_> {
    /// The ends of the neutral band; where it is not known what the language calls `infinity`.
    pub(super) fn neutral_ends(&self, infinity: &str) -> [String; 2] {
        match self.neutral {
            Some(neutral) => [neutral.low, neutral.high].map(|end| format!("{end:?}")),
            None => [format!("-{infinity}"), infinity.to_owned()],
        }
    }
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
        let tables: Vec<_> = joints.iter().map(|joint| (joint.joint, delays_of(joint))).collect();
        let lines = [format!("made by tauscope {} estimate", env!("CARGO_PKG_VERSION"))];
        let method = format!("method: {}", settings_line(settings, automatic));
        let lines = lines.into_iter().chain(sources.iter().map(source)).chain([method]);
        let counted = tables.iter().map(|(joint, table)| joint_line(&joint.name, table));
        let dead_times = joints.iter().flat_map(|joint| {
            let sentences = dead_time_sentences(joint).into_iter().take(2);
            sentences.map(|sentence| format!("joint {}: {sentence}", joint.joint.name))
        });
        let counted = counted.chain(dead_times);
        let origin = lines.chain(counted).map(|line| line.replace(is_control, " ")).collect();
        let joints = tables.into_iter().map(|(joint, table)| JointLookup {
            name: &joint.name,
            input_unit: joint.input_unit.as_deref(),
            neutral: table.neutral,
            curves: table.curves,
        });
        Self { origin, joints: joints.collect() }
    }

    /// Whether there is a delay of any joint.
    pub(crate) fn is_empty(&self) -> bool {
        self.joints.iter().all(|joint| joint.curves.is_empty())
    }

    /// The lines on where it is from, each behind `prefix`.
    pub(super) fn commented(&self, prefix: &str) -> String {
        self.origin.iter().flat_map(|line| [prefix, line, "\n"]).collect()
    }
}

/// The delay table of a joint; where its input moves all the time, every change has the one dead
/// time of the record.
fn delays_of(joint: &EstimatedJoint<'_>) -> DelayTable {
    let table = joint.delay_table();
    let Some(Finding::Known(bounds)) = joint.estimate.dead_time.as_ref().map(|it| it.finding)
    else {
        return table;
    };
    let delay = TypicalDelay {
        median_s: bounds.value_s,
        interval_s: Some((bounds.low_s, bounds.high_s)),
        min_s: bounds.low_s,
        max_s: bounds.high_s,
    };
    let curve = |rises: bool| DelayCurve {
        transition: Transition::Change,
        side: Ordering::Equal,
        rises,
        points: vec![CurvePoint { level: 0.0, accepted: 0, delay }],
    };
    DelayTable { neutral: None, curves: vec![curve(false), curve(true)], ..table }
}

/// How many steps each delay of a curve is from, and the 95 % intervals in seconds.
pub(super) fn support(curve: &DelayCurve) -> String {
    let list = |text: fn(&CurvePoint) -> String| {
        curve.points.iter().map(text).collect::<Vec<_>>().join(", ")
    };
    let intervals = list(|point| match point.delay.interval_s {
        Some((low, high)) => format!("{} to {}", number(low), number(high)),
        None => "not known".to_owned(),
    });
    let counts = list(|point| point.accepted.to_string());
    let is_over_record = curve.points.iter().all(|point| point.accepted == 0);
    let from = if is_over_record {
        "one for the record".to_owned()
    } else {
        format!("from {counts} steps")
    };
    format!("{from}, 95 % intervals in s: {intervals}")
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
    format!("\"{}\"", escaped.replace(is_control, " "))
}
