//! Names of entities.

use rerun::EntityPath;

/// `/<joint>`, whatever characters the name has.
pub(super) fn joint_root(name: &str) -> EntityPath {
    EntityPath::from(vec![name.into()])
}

/// The entity below `root` with these parts.
pub(super) fn below(root: &EntityPath, parts: &[&str]) -> EntityPath {
    let below = parts.iter().map(|part| (*part).into()).collect::<Vec<_>>();
    root.join(&EntityPath::from(below))
}
