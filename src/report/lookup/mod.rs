//! The delay table as source code that a controller looks its delays up in.
//!
//! ```text
//! side(u) = 1 above the neutral band, −1 below it, 0 within it
//! ```
//!
//! The kind of a step follows from the sides of both levels, as in
//! [`Transition::of`](crate::delay::Transition::of). Within a kind, a side and a direction the
//! delay is a line from point to point over the level (for a stop that before, else that
//! after), and beyond the first and the last point it stays what it is there. What was not
//! measured is not a number.

mod c;
mod json;
mod matlab;
mod python;

use std::cmp::Ordering;
use std::path::Path;

use super::EstimatedJoint;
use super::text::settings_line;
use crate::delay::{Automatic, DelayCurve, DelayTable, Neutral, Settings};
use crate::experiment::Source;
use crate::wording::number;

/// What a lookup is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Language {
    C,
    Matlab,
    Python,
    Json,
}

impl Language {
    /// By the ending of the file's name.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?;
        let known =
            [("c", Self::C), ("m", Self::Matlab), ("py", Self::Python), ("json", Self::Json)];
        known.into_iter().find(|(name, _)| *name == ending).map(|(_, language)| language)
    }
}

/// The delays of all joints, ready to be written.
#[derive(Clone, Debug)]
pub(crate) struct Lookup<'a> {
    /// Where it is from, line by line.
    origin: Vec<String>,
    joints: Vec<JointLookup<'a>>,
}

#[derive(Clone, Debug)]
struct JointLookup<'a> {
    name: &'a str,
    input_unit: Option<&'a str>,
    neutral: Option<Neutral>,
    curves: Vec<DelayCurve>,
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

    /// The source code; `name` is what the file is called, without its ending.
    ///
    /// # Errors
    /// Never: what JSON is made of can be written.
    pub(crate) fn source(&self, language: Language, name: &str) -> serde_json::Result<String> {
        Ok(match language {
            Language::C => c::source(self),
            Language::Matlab => matlab::source(self, name),
            Language::Python => python::source(self),
            Language::Json => json::source(self)?,
        })
    }

    /// The lines on where it is from, each behind `prefix`.
    fn commented(&self, prefix: &str) -> String {
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
fn side(side: Ordering) -> i8 {
    match side {
        Ordering::Less => -1,
        Ordering::Equal => 0,
        Ordering::Greater => 1,
    }
}

/// Levels and delays of a curve, each as numbers between commas.
fn numbers(curve: &DelayCurve) -> (String, String) {
    let list = |values: Vec<f64>| {
        values.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(", ")
    };
    let levels = curve.points.iter().map(|point| point.level).collect();
    (list(levels), list(curve.points.iter().map(|point| point.delay.median_s).collect()))
}

/// A text between double quotes, as C and Python read it.
fn quoted(text: &str) -> String {
    let escaped = text.replace('\\', "\\\\").replace('"', "\\\"");
    format!("\"{}\"", escaped.replace(|c: char| c.is_control(), " "))
}
