//! Where everything lies in a recording: what one file writes, another one shows.
//!
//! A path's parts are divided by `/`. Drawings list their parts from back to front: a pattern
//! would not do, since `*` inside an entity query does not match.

use rerun::EntityPath;

/// `/<joint>`, whatever characters the name has.
pub(crate) fn joint_root(name: &str) -> EntityPath {
    EntityPath::from(vec![name.into()])
}

/// The entity at `path`, one of the constants of this file, below `root`.
pub(crate) fn at(root: &EntityPath, path: &str) -> EntityPath {
    let parts: Vec<_> = path.split('/').map(Into::into).collect();
    root.join(&EntityPath::from(parts))
}

/// The entity `name` below `root`, whatever characters the name has.
pub(crate) fn child(root: &EntityPath, name: &str) -> EntityPath {
    root.join(&EntityPath::from(vec![name.into()]))
}

/// The entity of the model `number` of those drawn at `path` below `root`.
pub(crate) fn of_model(root: &EntityPath, path: &str, number: usize) -> EntityPath {
    child(&at(root, path), &number.to_string())
}

/// The page on the whole recording; all that follows lies below a joint.
pub(crate) const ABOUT: &str = "about";

pub(crate) const INPUT: &str = "input";
pub(crate) const OUTPUT_RAW: &str = "output/raw";
pub(crate) const OUTPUT_SMOOTHED: &str = "output/smoothed";
/// Further signals, one below it each.
pub(crate) const COVARIATE: &str = "covariate";

pub(crate) const TAU: &str = "delay/tau";
/// Delays of steps, and the state of the joint at each.
pub(crate) const DELAY_ACCEPTED: &str = "delay/accepted";
pub(crate) const DELAY_REJECTED: &str = "delay/rejected";
pub(crate) const DELAY_STATE: &str = "delay/state";

pub(crate) const SSE: &str = "decision/sse";
pub(crate) const DECISION_TABLE: &str = "decision/table";

pub(crate) const VERDICT: &str = "verdict";
pub(crate) const VERDICT_LOG: &str = "verdict/log";
pub(crate) const SEGMENT: &str = "segment";
pub(crate) const TRIAL: &str = "trial";
/// What was found of the joint, and what to do next.
pub(crate) const HEADLINE: &str = "headline";
/// Where the cursor is, in words.
pub(crate) const PLACE: &str = "place";
/// The decisions by doubt, in words and as lines to click.
pub(crate) const DOUBT: &str = "doubt";
pub(crate) const DOUBT_LOG: &str = "doubt/log";
/// The decisions by how much they differ from those of other results, likewise.
pub(crate) const DIFFERENCE: &str = "difference";
pub(crate) const DIFFERENCE_LOG: &str = "difference/log";
pub(crate) const DECISION_PAGE: &str = "decision/page";

/// Chosen lines and breakpoints over the record.
pub(crate) const LINE_BEFORE: &str = "line/before";
pub(crate) const LINE_AFTER: &str = "line/after";
pub(crate) const BREAKPOINT_ACCEPTED: &str = "breakpoint/accepted";
pub(crate) const BREAKPOINT_REJECTED: &str = "breakpoint/rejected";

/// Models, one below it each, and the band of the noise around their residuals.
pub(crate) const MODEL: &str = "model";
pub(crate) const SIMULATED: &str = "simulated";
pub(crate) const RESIDUAL: &str = "residual";
pub(crate) const REGIONS: &str = "regions";
pub(crate) const WHITENESS: &str = "whiteness";
pub(crate) const INPUT_CORRELATION: &str = "input_correlation";
pub(crate) const MODEL_PAGE: &str = "model_page";
pub(crate) const MODEL_WORST: &str = "model_worst";
pub(crate) const MODEL_PARAMETERS: &str = "model_parameters";
/// The judged model beside the measurement, on one sheet: the parts of [`revision::record`].
pub(crate) const MODEL_MAP: &str = "model_map";
pub(crate) const NOISE_UPPER: &str = "noise/upper";
pub(crate) const NOISE_LOWER: &str = "noise/lower";
pub(crate) const WORST: &str = "worst";
/// What the model was not fitted to, and where it fails.
pub(crate) const PART: &str = "part";
pub(crate) const FAILS: &str = "fails";
/// By how much the squared error of further models is larger, one below it each.
pub(crate) const MODEL_DIFFERENCE: &str = "model_difference";

/// The recording that stands before many.
pub(crate) mod index {
    pub(crate) const ROOT: &str = "doubtful";
    pub(crate) const JOINTS: &str = "joints";
    pub(crate) const VERDICT: &str = "verdict";
    pub(crate) const LOG: &str = "log";
}

/// Grid, ticks and titles of a sheet of plots.
pub(crate) const GRID: &str = "grid";
pub(crate) const TEXTS: &str = "texts";

/// Delays beside those of other results.
pub(crate) mod differing {
    pub(crate) const ROOT: &str = "difference/sheet";
    use crate::recording::paths::{GRID, TEXTS};
    pub(crate) const LINKS: &str = "links";
    pub(crate) const BARS: &str = "bars";
    pub(crate) const HERE_DELAYS: &str = "delays/here";
    pub(crate) const THERE_DELAYS: &str = "delays/there";
    pub(crate) const OTHER_VERDICT: &str = "other_verdict";
    pub(crate) const HERE: &str = "here";
    pub(crate) const PARTS: [&str; 8] =
        [GRID, HERE, LINKS, BARS, OTHER_VERDICT, THERE_DELAYS, HERE_DELAYS, TEXTS];
}

/// One decision: the segment, its candidates, their squared error.
pub(crate) mod drawing {
    pub(crate) const ROOT: &str = "drawing";
    pub(crate) use crate::recording::paths::GRID;
    pub(crate) const TICKS: &str = "ticks";
    pub(crate) const BORDERS: &str = "borders";
    pub(crate) const INPUT_STEP: &str = "input_step";
    pub(crate) const MEASURED: &str = "measured";
    pub(crate) const SMOOTHED: &str = "smoothed";
    /// What the chosen lines leave.
    pub(crate) const RESIDUAL: &str = "residual";
    pub(crate) const SSE: &str = "sse";
    /// The samples of the close-up.
    pub(crate) const CLOSE: &str = "close";
    /// Algorithm 1's lines in the close-up, where the answer is another one's.
    pub(crate) const ALGORITHM_1: &str = "algorithm_1";
    /// What the program found where a reviewer moved the breakpoint.
    pub(crate) const BEFORE_REVIEW: &str = "before_review";
    pub(crate) const ACCEPTED: &str = "accepted";
    pub(crate) const REJECTED: &str = "rejected";
    pub(crate) const NAMES: &str = "names";
    pub(crate) const CANDIDATE: &str = "candidate";
    pub(crate) const CANDIDATE_MARK: &str = "candidate/mark";
    pub(crate) const PARTS: [&str; 16] = [
        GRID,
        TICKS,
        BORDERS,
        BEFORE_REVIEW,
        INPUT_STEP,
        MEASURED,
        SMOOTHED,
        CLOSE,
        RESIDUAL,
        SSE,
        ALGORITHM_1,
        ACCEPTED,
        REJECTED,
        NAMES,
        CANDIDATE,
        CANDIDATE_MARK,
    ];
    /// Where the delay may end, where it is known between samples.
    pub(crate) const INTERVAL: &str = "interval";
    /// The legend of the first method where others are drawn: by its verdict.
    pub(crate) const FIRST_ACCEPTED: &str = "first_accepted";
    pub(crate) const FIRST_REJECTED: &str = "first_rejected";

    /// The drawing of a further method, and its line of the legend.
    pub(crate) fn of_method(index: usize) -> [String; 2] {
        [format!("other_{index}"), format!("other_{index}_name")]
    }
}

/// The record on one sheet, on which the segment under the cursor is framed.
pub(crate) mod map {
    pub(crate) const ROOT: &str = "map";
    /// A large one with the delays, on a page of its own.
    pub(crate) const LARGE: &str = "map_of_record";
    pub(crate) use crate::recording::paths::GRID;
    pub(crate) const TICKS: &str = "ticks";
    pub(crate) const INPUT: &str = "input";
    pub(crate) const OUTPUT: &str = "output";
    pub(crate) const ACCEPTED: &str = "accepted";
    pub(crate) const REJECTED: &str = "rejected";
    pub(crate) const HERE: &str = "here";
    pub(crate) const PARTS: [&str; 7] = [GRID, TICKS, INPUT, OUTPUT, ACCEPTED, REJECTED, HERE];
}

/// The delay against what it may depend on.
pub(crate) mod against {
    pub(crate) const ROOT: &str = "against";
    pub(crate) const BAND: &str = "band";
    pub(crate) use crate::recording::paths::GRID;
    pub(crate) const DEPENDS: &str = "depends";
    pub(crate) const DOWN: &str = "down";
    pub(crate) const UP: &str = "up";
    pub(crate) const MEDIAN: &str = "median";
    pub(crate) const HERE: &str = "here";
    pub(crate) const TICKS: &str = "ticks";
    pub(crate) const TITLES: &str = "titles";
    pub(crate) const LEGEND: &str = "legend";
    pub(crate) const STEP: &str = "step";
    pub(crate) const PARTS: [&str; 11] =
        [BAND, GRID, DEPENDS, DOWN, UP, MEDIAN, HERE, TICKS, TITLES, LEGEND, STEP];
}

/// The residual against what it may depend on: points, and a curve per model.
pub(crate) mod scatter {
    pub(crate) const ROOT: &str = "scatter";
    pub(crate) use crate::recording::paths::{GRID, TEXTS};
    pub(crate) const POINTS: &str = "points";
    pub(crate) const PARTS: [&str; 3] = [GRID, POINTS, TEXTS];
    pub(crate) const CURVE: &str = "curve";
}

/// The share of the error in each region: bars per model, and the share of the time.
pub(crate) mod error_share {
    pub(crate) const ROOT: &str = "error_share";
    pub(crate) use crate::recording::paths::{GRID, TEXTS};
    pub(crate) const TIME: &str = "time";
    pub(crate) const PARTS: [&str; 3] = [GRID, TIME, TEXTS];
    pub(crate) const BARS: &str = "bars";
}

/// How residuals are correlated: a band and a curve per model.
pub(crate) mod correlation {
    pub(crate) const ROOT: &str = "correlation";
    pub(crate) use crate::recording::paths::{GRID, TEXTS};
    pub(crate) const AXES: &str = "axes";
    pub(crate) const PARTS: [&str; 3] = [GRID, AXES, TEXTS];
    pub(crate) const BAND: &str = "band";
    pub(crate) const CURVE: &str = "curve";
}

/// The revisions of a model, and what a program reads of them.
pub(crate) mod revision {
    pub(crate) const ROOT: &str = "revision";
    pub(crate) const VALIDATION_RMSE: &str = "validation_rmse";
    pub(crate) const TRAINING_RMSE: &str = "training_rmse";
    pub(crate) const NOISE_FLOOR: &str = "noise_floor";
    pub(crate) const ADDED: &str = "added";
    pub(crate) const REMOVED: &str = "removed";
    pub(crate) const EVIDENCE: &str = "evidence";
    pub(crate) const WORDS: &str = "words";
    pub(crate) const PARAMETERS: &str = "parameters";

    /// Ladder, evidence and ranking.
    pub(crate) mod sheet {
        pub(crate) const ROOT: &str = "sheet";
        pub(crate) const LADDER: &str = "ladder";
        pub(crate) const TRAINING: &str = "training";
        pub(crate) const RANKING: &str = "ranking";
        pub(crate) const UNCERTAIN: &str = "uncertain";
        pub(crate) const POINTS: &str = "points";
        pub(crate) const FALLEN: &str = "fallen";
        pub(crate) const SIMULATED: &str = "simulated";
        pub(crate) const BEFORE: &str = "before";
        pub(crate) const PROPOSED: &str = "proposed";
        pub(crate) const LAW: &str = "law";
        pub(crate) const BEFORE_NAME: &str = "before_name";
        pub(crate) const PROPOSED_NAME: &str = "proposed_name";
        pub(crate) const LAW_NAME: &str = "law_name";
        pub(crate) const FALLEN_NAME: &str = "fallen_name";
        pub(crate) use crate::recording::paths::{GRID, TEXTS};
        pub(crate) const NOISE: &str = "noise";
        pub(crate) const NOISE_NAME: &str = "noise_name";
        pub(crate) const PARTS: [&str; 18] = [
            LADDER,
            TRAINING,
            RANKING,
            UNCERTAIN,
            SIMULATED,
            POINTS,
            FALLEN,
            BEFORE,
            PROPOSED,
            LAW,
            BEFORE_NAME,
            PROPOSED_NAME,
            LAW_NAME,
            FALLEN_NAME,
            GRID,
            NOISE,
            TEXTS,
            NOISE_NAME,
        ];
    }

    /// The whole record beside what a revision simulates.
    pub(crate) mod record {
        pub(crate) const ROOT: &str = "record";
        pub(crate) use crate::recording::paths::{GRID, TEXTS};
        pub(crate) const WINDOW: &str = "window";
        pub(crate) const MEASURED: &str = "measured";
        pub(crate) const NOISE: &str = "noise";
        pub(crate) const SIMULATED: &str = "simulated";
        pub(crate) const RESIDUAL: &str = "residual";
        pub(crate) const WORST: &str = "worst";
        pub(crate) const VALIDATION: &str = "validation";
        pub(crate) const FAILS: &str = "fails";
        pub(crate) const PARTS: [&str; 10] =
            [VALIDATION, FAILS, GRID, TEXTS, WINDOW, MEASURED, NOISE, WORST, SIMULATED, RESIDUAL];
    }

    /// The share of the error of a revision in each region.
    pub(crate) mod share {
        pub(crate) const ROOT: &str = "share";
        pub(crate) use crate::recording::paths::error_share::{BARS, GRID, TEXTS, TIME};
        pub(crate) const PARTS: [&str; 4] = [GRID, BARS, TIME, TEXTS];
    }
}

/// What is to be played, before it is.
pub(crate) mod preview {
    pub(crate) use crate::recording::paths::INPUT;
    /// Expected outputs, one below it each, with the ends of their margin.
    pub(crate) const EXPECTED: &str = "expected";
    pub(crate) const OUTPUT: &str = "output";
    pub(crate) const LOW: &str = "low";
    pub(crate) const HIGH: &str = "high";
    pub(crate) const RANGE: &str = "range";
    pub(crate) const APART: &str = "apart";
    pub(crate) const SAYS: &str = "says";
    pub(crate) const HERE: &str = "here";
    pub(crate) const HOLDS: &str = "holds";

    /// Input, expected outputs and their difference on one sheet.
    pub(crate) mod sheet {
        pub(crate) const ROOT: &str = "sheet";
        pub(crate) const BAND: &str = "band";
        pub(crate) const RANGE: &str = "range";
        pub(crate) const INPUT: &str = "input";
        pub(crate) const EXPECTED: &str = "expected";
        pub(crate) const APART: &str = "apart";
        pub(crate) const LEGEND: &str = "legend";
        pub(crate) const SHARES: &str = "shares";
        pub(crate) const HERE_FRAME: &str = "here/frame";
        pub(crate) const HERE_NAME: &str = "here/name";
        use crate::recording::paths::{GRID, TEXTS};
        pub(crate) const PARTS: [&str; 11] = [
            BAND, GRID, RANGE, INPUT, EXPECTED, APART, TEXTS, LEGEND, SHARES, HERE_FRAME, HERE_NAME,
        ];
    }
}

/// Delays over all settings.
pub(crate) mod sweep {
    pub(crate) const SETTING: &str = "sweep/setting";
    pub(crate) const STEP: &str = "sweep/step";
    pub(crate) const FOUND: &str = "found";
    pub(crate) const HERE: &str = "here";
    pub(crate) const SENSITIVE_LOG: &str = "hanging/log";

    /// All steps at all settings.
    pub(crate) mod sheet {
        pub(crate) const ROOT: &str = "sheet";
        pub(crate) const MAP: &str = "map";
        pub(crate) const RANGE: &str = "range";
        pub(crate) const AGREED: &str = "agreed";
        pub(crate) const SAME: &str = "same";
        pub(crate) const LONGER: &str = "longer";
        pub(crate) const SHORTER: &str = "shorter";
        pub(crate) const SENSITIVE: &str = "hanging";
        pub(crate) const BLOCKS: &str = "blocks";
        pub(crate) const COUNTS: &str = "counts";
        pub(crate) const ROWS: &str = "rows";
        pub(crate) const LEGEND: &str = "legend";
        pub(crate) const SETTING_DELAYS: &str = "setting/delays";
        pub(crate) const SETTING_FRAME: &str = "setting/frame";
        pub(crate) const SETTING_NAME: &str = "setting/name";
        pub(crate) const STEP_FRAME: &str = "step/frame";
        pub(crate) const STEP_NAME: &str = "step/name";
        use crate::recording::paths::{GRID, TEXTS};
        pub(crate) const PARTS: [&str; 18] = [
            MAP,
            GRID,
            RANGE,
            AGREED,
            SAME,
            LONGER,
            SHORTER,
            SENSITIVE,
            BLOCKS,
            TEXTS,
            COUNTS,
            ROWS,
            LEGEND,
            SETTING_DELAYS,
            SETTING_FRAME,
            SETTING_NAME,
            STEP_FRAME,
            STEP_NAME,
        ];
    }

    /// The output around one step, with the delay of each setting.
    pub(crate) mod one {
        pub(crate) const ROOT: &str = "one";
        pub(crate) use crate::recording::paths::sweep::sheet::{
            AGREED, BLOCKS, LONGER, ROWS, SAME, SHORTER,
        };
        pub(crate) use crate::recording::paths::{GRID, TEXTS};
        pub(crate) const ALLOWED: &str = "allowed";
        pub(crate) const OUTPUT: &str = "output";
        pub(crate) const INPUT_STEP: &str = "input_step";
        pub(crate) const PARTS: [&str; 11] =
            [GRID, BLOCKS, ALLOWED, AGREED, OUTPUT, INPUT_STEP, SAME, LONGER, SHORTER, TEXTS, ROWS];
    }
}
