//! The delay table as source code that a controller looks its delays up in: C99, MATLAB or GNU Octave,
//! Python 3, each without dependencies, and JSON.
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
//!
//! The templates are in `lookup/`. That of MATLAB does without `interp1`, which in Octave calls a
//! `lookup` of its own: a file may have that name.

use std::cmp::Ordering;
use std::path::Path;

use minijinja::context;
use serde_json::{Value, json};

use super::EstimatedJoint;
use super::answer::dead_time_sentences;
use super::settings::settings_line;
use crate::delay::{
    CurvePoint, DelayCurve, DelayTable, Finding, Neutral, Settings, Transition, TypicalDelay,
};
use crate::experiment::{Source, is_control};
use crate::export::{ExportError, filled};
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
        match path.extension()?.to_str()? {
            "c" => Some(Self::C),
            "m" => Some(Self::Matlab),
            "py" => Some(Self::Python),
            "json" => Some(Self::Json),
            _ => None,
        }
    }

    /// The source code of `lookup`; `name` is what the file is called, without its ending, and so what
    /// MATLAB calls its function.
    ///
    /// # Errors
    /// Where a template cannot be filled in.
    pub(crate) fn source(self, lookup: &Lookup<'_>, name: &str) -> Result<String, ExportError> {
        let (template, infinity) = match self {
            Self::C => (include_str!("lookup/lookup.c"), "INFINITY"),
            Self::Matlab => (include_str!("lookup/lookup.m"), "Inf"),
            Self::Python => (include_str!("lookup/lookup.py"), "math.inf"),
            Self::Json => return Ok(format!("{:#}\n", lookup.json())),
        };
        let joint = |joint: &JointLookup<'_>| {
            let [low, high] = match joint.neutral {
                Some(neutral) => [neutral.low, neutral.high].map(|end| format!("{end:?}")),
                None => [format!("-{infinity}"), infinity.to_owned()],
            };
            let curves: Vec<_> = joint.curves.iter().map(curve_in_code).collect();
            context! { name => self.text(joint.name), low, high, curves }
        };
        let joints: Vec<_> = lookup.joints.iter().map(joint).collect();
        let upper = name.to_uppercase();
        let facts = context! { name, upper, origin => lookup.origin.clone(), joints };
        // What would end a comment of C, or begin a trigraph.
        filled(template, |text| text.replace("??/", "?? /").replace("*/", "* /"), &facts)
    }

    /// A text as the language reads it.
    fn text(self, text: &str) -> String {
        let escaped = text.replace('\\', "\\\\").replace('"', "\\\"");
        let quoted = format!("\"{}\"", escaped.replace(is_control, " "));
        match self {
            // A trigraph may stand for the backslash before the mark that ends the text.
            Self::C => quoted.replace('?', "\\?"),
            Self::Matlab => text.replace('\'', "''"),
            Self::Python | Self::Json => quoted,
        }
    }
}

/// What templates say of a curve. C and MATLAB find it by three numbers: kind of step, side, whether the
/// input rises.
fn curve_in_code(curve: &DelayCurve) -> minijinja::Value {
    let (kind, side, rises) = (curve.transition, side(curve.side), curve.rises);
    let list = |value: fn(&CurvePoint) -> f64| {
        let values = curve.points.iter().map(|point| format!("{:?}", value(point)));
        values.collect::<Vec<_>>().join(", ")
    };
    context! {
        key => format!("{}, {side}, {}", kind as u8, u8::from(rises)),
        kind => kind.to_string(),
        side,
        rises,
        count => curve.points.len(),
        levels => list(|point| point.level),
        delays => list(|point| point.delay.median_s),
        support => support(curve),
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

const RULE: &str = "side(u) is 1 above the neutral band, -1 below, 0 within; equal sides: change; \
                    from 0: start; to 0: stop; else reversal. Take the curve of this transition, \
                    of the side of level_to (of a stop: level_from) and of the direction; \
                    interpolate delay_s linearly over that level, clamped to its ends";

impl<'a> Lookup<'a> {
    /// The delays of `joints`, which were estimated with `settings` from `sources`.
    pub(crate) fn new(
        sources: &[Source],
        joints: &[EstimatedJoint<'a>],
        settings: &Settings,
    ) -> Self {
        let source =
            |source: &Source| format!("log: {} (SHA-256 {})", source.path.display(), source.sha256);
        let tables: Vec<_> = joints.iter().map(|joint| (joint.joint, delays_of(joint))).collect();
        let lines = [format!("made by tauscope {} estimate", env!("CARGO_PKG_VERSION"))];
        let method = format!("method: {}", settings_line(settings));
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

    /// Schema `tauscope/delay_lookup/1`; `neutral` is `null` where it is not known, and every side is 0.
    fn json(&self) -> Value {
        let joint = |joint: &JointLookup<'_>| {
            json!({
                "joint": joint.name,
                "input_unit": joint.input_unit,
                "neutral": joint.neutral.map(|neutral| (neutral.low, neutral.high)),
                "curves": joint.curves.iter().map(curve_json).collect::<Value>(),
            })
        };
        json!({
            "schema": "tauscope/delay_lookup/1",
            "origin": self.origin,
            "rule": RULE,
            "joints": self.joints.iter().map(joint).collect::<Value>(),
        })
    }
}

fn curve_json(curve: &DelayCurve) -> Value {
    let list = |value: fn(&CurvePoint) -> Value| curve.points.iter().map(value).collect::<Value>();
    json!({
        "transition": curve.transition,
        "side": side(curve.side),
        "rises": curve.rises,
        "level": list(|point| point.level.into()),
        "accepted": list(|point| point.accepted.into()),
        "delay_s": list(|point| point.delay.median_s.into()),
        "delay_low_s": list(|point| point.delay.interval_s.map(|(low, _)| low).into()),
        "delay_high_s": list(|point| point.delay.interval_s.map(|(_, high)| high).into()),
    })
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
fn support(curve: &DelayCurve) -> String {
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
fn side(side: Ordering) -> i8 {
    match side {
        Ordering::Less => -1,
        Ordering::Equal => 0,
        Ordering::Greater => 1,
    }
}
