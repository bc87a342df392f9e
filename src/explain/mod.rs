//! Which physical effect is missing from a model.
//!
//! The model is fitted, and if its misfit is more than noise, every effect of the catalogue
//! is added to it in turn and fitted with it. The race is judged on the whole record: what
//! was fitted counts with a penalty for its parameters, what was not counts as it is.
//!
//! - [`explain`]: verdict and ranking for one model
//! - [`add()`]: an effect that the user chose
//! - [`improve`]: explain and add until nothing significant is left
//! - [`Separation`]: the experiment that would tell two effects apart
//! - [`Workers`]: who does the fits, one after the other or in parallel
//!
//! A closed world always blames somebody: the nearest effect lowers any error a little. So
//! an effect is only named when the model with it, or with it and a few more, is adequate,
//! or when it alone takes most of the misfit away.
//!
//! # References
//! T. Bohlin, "Practical Grey-box Process Identification", 2006. N. R. Kristensen,
//! H. Madsen and S. B. Jørgensen, "A method for systematic improvement of stochastic
//! grey-box models", Computers & Chemical Engineering 28 (2004). P. Bacher and H. Madsen,
//! "Identifying suitable models for the heat dynamics of buildings", Energy and Buildings
//! 43 (2011), 1511-1522.

mod add;
mod candidate;
mod evidence;
mod grow;
mod improve;
mod pairs;
mod race;
mod separate;
mod verdict;
mod workers;

pub use add::{AddError, Addition, add};
pub use candidate::Candidate;
pub(crate) use candidate::{BEYOND_DOUBT, BEYOND_DOUBT_PERCENT};
pub use grow::Change;
pub use improve::{Improvement, Revision, improve};
pub(crate) use race::ALIKE;
pub use race::{MAX_EFFECTS, Options};
pub use separate::{Pattern, Proposal, Separation, Start};
pub(crate) use separate::{level_sets, thresholds, two_digits};
pub(crate) use verdict::named;
pub use verdict::{Explanation, Verdict, explain};
pub use workers::{Sequential, Workers};
