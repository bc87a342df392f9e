//! What every hidden effect has: numbers that can be checked, and a table in the plant file.

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::super::clock::Clock;
use super::super::error::{Place, PlantError};

/// `group` with the effect `name` of these numbers in the place of what it had.
pub(in super::super) fn with_part<T: Serialize + DeserializeOwned>(
    group: &T,
    name: &'static str,
    numbers: &[(String, f64)],
) -> Result<T, PlantError> {
    let mut table = toml::Table::try_from(group)
        .map_err(|source| PlantError::Write { source: Box::new(source) })?;
    let part = numbers.iter().map(|(key, number)| (key.clone(), (*number).into()));
    table.insert(name.to_owned(), toml::Value::Table(part.collect()));
    let group = table.try_into();
    group.map_err(|cause| PlantError::Numbers { name, cause: Box::new(cause) })
}

/// Which of `known` are in `group`.
pub(super) fn names_in(group: &impl Serialize, known: &[&'static str]) -> Vec<&'static str> {
    let table = toml::Table::try_from(group).unwrap_or_default();
    known.iter().copied().filter(|name| table.contains_key(*name)).collect()
}

/// An effect whose numbers can be checked.
pub(super) trait Part {
    /// Refuses numbers that mean nothing.
    fn check(&self, place: &Place, clock: &Clock) -> Result<(), PlantError>;
}

/// `part`, where it is there, as one to check.
pub(super) fn part<T: Part>(part: Option<&T>) -> Option<&dyn Part> {
    part.map(|part| part as &dyn Part)
}
