//! The delay of every input step of one joint.
//!
//! By default it is the onset of the response that the joint's record supports, the same for all of its
//! steps ([`OnsetModel`]).
//!
//! Algorithm 1 of Albrecht and Taylor: around each input step the output is cut into a
//! segment, every pair of regression lines through it is a candidate, the pair with the
//! least squared error wins, and [conditions](Condition) decide whether its breakpoint counts:
//! the paper's six, one for segments without a candidate, and two for joints at rest.
//!
//! - [`steps`](InputStep): where the input changes
//! - [`Neutral`], [`Transition`]: the level at which a joint rests, and what kind of step
//!   leaves it or leads there
//! - [`InputMotion`]: whether the input is made of steps or moves all the time
//! - [`Segment`]: which samples belong to a step
//! - [`Candidates`]: every pair of lines, with its squared error
//! - [`Check`]: the conditions, with the numbers compared
//! - [`estimate`]: all of it, in the order of the steps
//! - [`FineDelay`]: a delay between samples, with its interval
//! - [`OnsetModel`]: the response of a joint, and [`Obstacle`]: why onsets are no delays
//! - [`dead_time`]: one dead time of a joint whose input moves all the time
//! - [`delay_scan`]: one delay for a whole record
//! - [`RunnerUp`]: how near a verdict was
//! - [`Doubt`]: how doubtful a decision is, from its own evidence
//! - [`ReviewerVerdict`]: what a reviewer says instead
//! - [`step_delays`]: the delays alone, by the best method
//! - [`DelayProfile`]: the delay of every sample
//! - [`DelayTable`]: the delays by kind of step and level
//! - [`AgainstState`]: what the delay may depend on
//! - [`sweep`]: how every delay moves with the settings
//!
//! Sample numbers are the paper's: counted from 1 within the trial.

mod against;
mod condition;
mod dead_time;
mod decision;
mod doubt;
mod estimate;
mod first_order;
mod growing;
mod held_input;
mod hold;
mod input_motion;
mod input_noise;
mod interval;
mod lengths;
mod margin;
mod method;
mod motion;
mod neutral;
mod onset_model;
mod prepared;
mod profile;
mod scan;
mod search;
mod segment;
mod settings;
mod spec;
mod steps;
mod stops;
pub mod sweep;
mod table;
mod tracking;
mod typical;

pub use crate::numerics::Line;
pub use against::{AgainstOfKind, AgainstState, Correlation, StepState};
pub use condition::{Check, Condition, Outcome};
pub use dead_time::{Bounds, DeadTime, ErrorPoint, Feedback, Finding, Unknown, Window, dead_time};
pub use decision::{Breakpoint, Decision, ReviewerVerdict, Verdict};
pub use doubt::{Doubt, Flag, doubts};
pub(crate) use estimate::Estimator;
pub use estimate::{EstimateError, TrialEstimate, estimate, estimate_joint, step_delays};
pub(crate) use first_order::{FirstOrder, followed};
pub use growing::Growing;
pub(crate) use growing::{check_growing, final_part};
pub(crate) use held_input::held_inputs;
pub(crate) use hold::{alike, level_tolerance};
pub use input_motion::{InputKind, InputMotion};
pub use interval::FineDelay;
pub(crate) use margin::Remedy;
pub use margin::RunnerUp;
pub use neutral::{Neutral, Transition};
pub use onset_model::{Obstacle, OnsetModel, ResponseOfKind, StepOnset};
pub use profile::DelayProfile;
pub use scan::delay_scan;
pub use search::{Candidate, Candidates};
pub use segment::Segment;
pub(crate) use settings::CONFIDENCE;
pub use settings::{CandidateLines, FirstLast, InSeconds, Interpolation, Settings};
pub use spec::{Method, MethodSpec};
pub use steps::InputStep;
pub(crate) use steps::{are_strokes, joint_steps};
pub use table::{CurvePoint, DelayCurve, DelayRow, DelayTable, KindDelay};
pub use tracking::Tracking;
pub(crate) use tracking::tracking;
pub use typical::TypicalDelay;
