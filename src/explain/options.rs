//! Which effects are tried as explanations, and how many may be added.

use crate::effect::{Effect, REGISTRY};

/// Which effects are tried, and which may stay.
#[derive(Clone, Debug)]
pub struct Options {
    /// The effects that are tried.
    pub effects: Vec<&'static dyn Effect>,
    /// Effects that may be added one after the other.
    pub max_effects: usize,
    /// Whether effects without practical consequence stay in an improved model.
    pub keeps_refinements: bool,
}

/// Effects that are added one after the other where nothing else is said: a cylinder has so
/// many.
pub const MAX_EFFECTS: usize = 8;

/// The whole catalogue, up to [`MAX_EFFECTS`].
impl Default for Options {
    fn default() -> Self {
        Self { effects: REGISTRY.to_vec(), max_effects: MAX_EFFECTS, keeps_refinements: false }
    }
}
