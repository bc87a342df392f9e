//! What was measured: joints, their trials, input and output.
//!
//! A value that exists is valid: equal lengths, finite numbers, one sample period
//! per trial. Reading and repair of files live in the submodules; nothing here
//! knows how a delay is estimated.

mod activity;
mod bounded;
mod clock;
mod columns;
mod conditions;
mod error;
mod format;
mod grid;
mod grids;
mod handed;
mod joint;
mod layout;
mod log;
mod memory;
mod names;
mod origin;
mod read;
mod record;
mod repairs;
mod resolution;
mod saturation;
mod source;
mod spikes;
mod survey;
mod table;
mod time_column;
mod trial;
mod unit;

pub use activity::{Other, Supply};
pub(crate) use bounded::{read_sheet, read_text};
pub(crate) use clock::is_period;
pub(crate) use columns::KEPT;
pub use columns::{ColumnMap, ColumnMapError, JointColumns};
pub(crate) use conditions::are_opposites;
pub use conditions::conditions;
pub(crate) use conditions::has_word;
pub use error::{ReadError, ReadErrorKind};
pub(crate) use format::{format_names, is_named_like_a_log, is_text};
pub use grid::Repair;
pub use handed::{HandedColumn, HandedLog, HandedValues};
pub use joint::{Joint, Signal};
pub use memory::MemoryLimit;
pub(crate) use memory::address_space;
pub(crate) use names::{did_you_mean, is_control, listed, nearest_name};
pub(crate) use read::notes_on_subfolders;
pub use read::{Experiment, Failure, ReadOptions, expand_folders};
pub use record::{Property, Record};
pub(crate) use resolution::coarse_resolution;
pub(crate) use saturation::saturations;
pub use source::Source;
pub(crate) use spikes::{Spikes, spike_count, without_spikes};
pub use survey::{Role, Survey, SurveyedColumn};
pub(crate) use table::LARGEST;
pub(crate) use trial::longest_gap_s;
pub use trial::{Trial, TrialError};
