//! Which physical effect is missing from a model.
//!
//! The model is fitted, and if its misfit is more than noise, every effect of the catalogue
//! is added to it in turn and fitted with it. They are ranked on the whole record: what was
//! fitted counts with a penalty for its parameters, what was not counts as it is.
//!
//! - [`explain`]: verdict and ranking for one model
//! - [`add()`]: an effect that the user chose
//! - [`improve`]: explain and add until nothing significant is missing
//! - [`Attribution`]: what each effect carries of the error, and what could stand in its place
//! - [`Separation`]: the experiment that would separate two effects
//! - [`Workers`]: who does the fits, one after the other or in parallel
//!
//! A closed world always blames somebody: the nearest effect lowers any error a little. So
//! an effect is only named when the model with it, or with it and a few more, is adequate,
//! or when it alone explains most of the misfit.
//!
//! # References
//! T. Bohlin, "Practical Grey-box Process Identification", 2006. N. R. Kristensen,
//! H. Madsen and S. B. Jørgensen, "A method for systematic improvement of stochastic
//! grey-box models", Computers & Chemical Engineering 28 (2004). P. Bacher and H. Madsen,
//! "Identifying suitable models for the heat dynamics of buildings", Energy and Buildings
//! 43 (2011), 1511-1522.

mod add;
mod attribution;
mod candidate;
mod comparison;
mod contribution;
mod decide;
mod determined;
mod eligible;
mod evidence;
mod exchange;
mod extension;
mod improve;
mod judge;
mod judgement;
mod likeness;
mod limiting_case;
mod measured_signals;
mod misfit;
mod options;
mod outcome;
mod pairs;
mod ranking;
mod removal;
mod revision;
mod screening;
mod separate;
mod separation;
mod stepwise;
mod structures;
mod verdict;
mod workers;

pub use add::add;
pub use candidate::Candidate;
pub(crate) use candidate::{ALIKE, BEYOND_DOUBT, BEYOND_DOUBT_PERCENT};
pub use contribution::{Attribution, Contribution};
pub use improve::improve;
pub use judge::explain;
pub(crate) use judge::named;
pub use judgement::{Judgement, Refusal};
pub use options::{MAX_EFFECTS, Options, Tried};
pub use outcome::FitOutcome;
pub use revision::{AddError, Addition, Change, Improvement, Revision};
pub(crate) use separate::{level_sets, thresholds, two_digits};
pub use separation::{Pattern, Proposal, Separation, Start};
pub use verdict::{Explanation, Verdict};
pub use workers::{Sequential, Workers};
