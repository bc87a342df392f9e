//! Where everything lies in a recording that one file writes and another one shows.
//!
//! A path's parts are divided by `/`. What lies below the root of a drawing are its parts, which are
//! shown together; they are named where they are drawn.

use rerun::EntityPath;

/// `/<joint>`, whatever characters the name has.
pub(crate) fn joint_root(name: &str) -> EntityPath {
    EntityPath::from(vec![name.into()])
}

/// The entity at `path`, its parts divided by `/`, below `root`.
pub(crate) fn at(root: &EntityPath, path: &str) -> EntityPath {
    let parts: Vec<_> = path.split('/').map(Into::into).collect();
    root.join(&EntityPath::from(parts))
}

/// The entity `name` below `root`, whatever characters the name has.
pub(crate) fn child(root: impl Into<EntityPath>, name: &str) -> EntityPath {
    root.into().join(&EntityPath::from(vec![name.into()]))
}

/// The part `path` of a drawing that the model `number` has.
pub(crate) fn of_model(path: &str, number: usize) -> String {
    format!("{path}/{number}")
}

/// The page on the whole recording; all that follows lies below a joint.
pub(crate) const ABOUT: &str = "about";

pub(crate) const INPUT: &str = "input";
pub(crate) const OUTPUT_RAW: &str = "output/raw";
pub(crate) const OUTPUT_SMOOTHED: &str = "output/smoothed";
/// Further signals, one below it each.
pub(crate) const COVARIATE: &str = "covariate";

pub(crate) const TAU: &str = "delay/tau";
/// Delays of steps.
pub(crate) const DELAY_ACCEPTED: &str = "delay/accepted";
pub(crate) const DELAY_REJECTED: &str = "delay/rejected";

pub(crate) const DECISION_TABLE: &str = "decision/table";
pub(crate) const DECISION_PAGE: &str = "decision/page";

pub(crate) const VERDICT: &str = "verdict";
pub(crate) const VERDICT_LOG: &str = "verdict/log";
pub(crate) const SEGMENT: &str = "segment";
pub(crate) const TRIAL: &str = "trial";
/// What was found of the delays of the joint, and what to do next.
pub(crate) const HEADLINE: &str = "headline";
/// Where the cursor is, in words.
pub(crate) const PLACE: &str = "place";
/// The decisions by doubt, as lines to click.
pub(crate) const DOUBT_LOG: &str = "doubt/log";
/// The decisions by how much they differ from those of other results, likewise and as a drawing.
pub(crate) const DIFFERENCE: &str = "difference";
pub(crate) const DIFFERENCE_LOG: &str = "difference/log";
pub(crate) const DIFFERENCE_SHEET: &str = "difference/sheet";

/// Chosen lines and breakpoints over the record.
pub(crate) const LINE_BEFORE: &str = "line/before";
pub(crate) const LINE_AFTER: &str = "line/after";
pub(crate) const BREAKPOINT_ACCEPTED: &str = "breakpoint/accepted";
pub(crate) const BREAKPOINT_REJECTED: &str = "breakpoint/rejected";

/// The drawing of one decision: the segment, its candidates, their squared error.
pub(crate) const DRAWING: &str = "drawing";
/// The record on one sheet, on which the segment under the cursor is framed; and a large one with the
/// delays, on a page of its own.
pub(crate) const MAP: &str = "map";
pub(crate) const LARGE_MAP: &str = "map_of_record";
/// The delay against what it may depend on.
pub(crate) const AGAINST: &str = "against";

/// Models, one below it each, and the band of the noise around their residuals.
pub(crate) const MODEL: &str = "model";
pub(crate) const SIMULATED: &str = "simulated";
pub(crate) const RESIDUAL: &str = "residual";
pub(crate) const MODEL_PAGE: &str = "model_page";
pub(crate) const MODEL_WORST: &str = "model_worst";
pub(crate) const MODEL_PARAMETERS: &str = "model_parameters";
/// The judged model beside the measurement, on one sheet, as [`REVISION_RECORD`].
pub(crate) const MODEL_MAP: &str = "model_map";
pub(crate) const NOISE_UPPER: &str = "noise/upper";
pub(crate) const NOISE_LOWER: &str = "noise/lower";
pub(crate) const WORST: &str = "worst";
/// What the model was not fitted to, and where it fails.
pub(crate) const PART: &str = "part";
pub(crate) const FAILS: &str = "fails";
/// By how much the squared error of further models is larger, one below it each.
pub(crate) const MODEL_DIFFERENCE: &str = "model_difference";
/// The residual against what it may depend on, its share in each region, how it is correlated.
pub(crate) const SCATTER: &str = "scatter";
pub(crate) const ERROR_SHARE: &str = "error_share";
pub(crate) const CORRELATION: &str = "correlation";

/// The revisions of a model: what was found of it; ladder, what it misses and ranking; the whole record
/// beside what is simulated; the share of the error in each region; pages.
pub(crate) const REVISION_HEADLINE: &str = "revision/headline";
pub(crate) const REVISION_SHEET: &str = "revision/sheet";
pub(crate) const REVISION_RECORD: &str = "revision/record";
pub(crate) const REVISION_SHARE: &str = "revision/share";
pub(crate) const REVISION_WORDS: &str = "revision/words";
pub(crate) const REVISION_PARAMETERS: &str = "revision/parameters";

/// A drawing of the delays over all settings.
pub(crate) const SHEET: &str = "sheet";
/// What is under the cursor, in words.
pub(crate) const HERE: &str = "here";

/// What was found over all settings, and the steps that are sensitive to one.
pub(crate) const FOUND: &str = "found";
pub(crate) const SENSITIVE_LOG: &str = "hanging/log";
