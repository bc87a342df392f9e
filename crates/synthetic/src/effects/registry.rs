//! All effects that a plant can hide, and their names.

use std::collections::BTreeMap;

use super::twin::Twin;
use super::{delay, dynamics, load, sensor, valve};
use crate::error::PlantError;
use Group::{Catalogue, Finer, Outside};

/// Which effects a fitted model may have, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Group {
    /// In the catalogue of models: the family of effects that leave similar traces, of which a
    /// scenario draws one, and its place in the family.
    Catalogue(usize, usize),
    /// Not in the catalogue.
    Outside,
    /// In the catalogue, as a finer form of another one.
    Finer,
}

/// An effect among the others.
#[derive(Debug)]
pub(crate) struct Row {
    /// Which random numbers it is drawn by, and its place among the names: that of no other
    /// effect, and the same for ever.
    pub(crate) number: usize,
    pub(crate) group: Group,
    pub(crate) twin: &'static Twin,
}

const fn row(number: usize, group: Group, twin: &'static Twin) -> Row {
    Row { number, group, twin }
}

/// In the order in which the signal passes them. A new one gets the next number.
pub(crate) static REGISTRY: [Row; 27] = [
    row(7, Catalogue(2, 1), &delay::VARIABLE_DELAY),
    row(26, Finer, &dynamics::SPOOL_LAG),
    row(0, Catalogue(1, 0), &valve::INPUT_OFFSET),
    row(2, Catalogue(0, 1), &dynamics::STICTION),
    row(1, Catalogue(0, 0), &valve::DEAD_BAND),
    row(4, Catalogue(0, 3), &valve::FLOW_CURVE),
    row(5, Catalogue(1, 1), &valve::DIRECTION_GAIN),
    row(18, Outside, &valve::INPUT_NOTCH),
    row(3, Catalogue(0, 2), &valve::INPUT_SATURATION),
    row(25, Finer, &valve::ASYMMETRIC_SATURATION),
    row(6, Catalogue(2, 0), &dynamics::RATE_LIMIT),
    row(8, Catalogue(2, 2), &dynamics::ACTUATOR_LAG),
    row(9, Catalogue(2, 3), &dynamics::RESONANCE),
    row(23, Finer, &dynamics::OIL_COLUMN),
    row(10, Catalogue(0, 4), &dynamics::COULOMB_FRICTION),
    row(24, Finer, &dynamics::ASYMMETRIC_FRICTION),
    row(19, Outside, &dynamics::CREEP_MEMORY),
    row(12, Catalogue(1, 4), &load::POSITION_GAIN),
    row(20, Outside, &load::STICKY_SPOT),
    row(13, Catalogue(3, 0), &load::THERMAL_DRIFT),
    row(14, Catalogue(3, 1), &load::SUPPLY_DROOP),
    row(11, Catalogue(1, 3), &load::GRAVITY_LOAD),
    row(15, Catalogue(1, 2), &load::LEAKAGE),
    row(21, Outside, &load::DISTURBANCE),
    row(16, Catalogue(4, 0), &load::END_STOP),
    row(17, Catalogue(4, 1), &sensor::BACKLASH),
    row(22, Outside, &sensor::SENSOR_NONLINEARITY),
];

/// Names of the effects of the catalogue, but for [`FINER`].
pub const CATALOGUE: [&str; count(Catalogue(0, 0))] = names(Catalogue(0, 0));

/// Names of its effects that are finer forms of others.
pub const FINER: [&str; count(Finer)] = names(Finer);

/// Names of the effects outside it.
pub const OUTSIDE: [&str; count(Outside)] = names(Outside);

impl Group {
    const fn is(self, other: Self) -> bool {
        matches!(
            (self, other),
            (Catalogue(..), Catalogue(..)) | (Outside, Outside) | (Finer, Finer)
        )
    }
}

const fn count(group: Group) -> usize {
    let (mut count, mut index) = (0, 0);
    while index < REGISTRY.len() {
        count += REGISTRY[index].group.is(group) as usize;
        index += 1;
    }
    count
}

/// Names of a group, by their numbers.
const fn names<const COUNT: usize>(group: Group) -> [&'static str; COUNT] {
    let mut names = [""; COUNT];
    let (mut count, mut index) = (0, 0);
    while count < COUNT {
        let Row { number, group: of, twin } = &REGISTRY[index % REGISTRY.len()];
        if *number == index / REGISTRY.len() && of.is(group) {
            names[count] = twin.name;
            count += 1;
        }
        index += 1;
    }
    names
}

/// The names of the catalogue by family, in the order of their places.
pub(crate) fn families() -> Vec<Vec<&'static str>> {
    let placed = REGISTRY.iter().filter_map(|row| match row.group {
        Catalogue(family, place) => Some(((family, place), row.twin.name)),
        Outside | Finer => None,
    });
    let mut families = Vec::new();
    for ((family, _), name) in placed.collect::<BTreeMap<_, _>>() {
        families.resize(families.len().max(family + 1), Vec::new());
        families[family].push(name);
    }
    families
}

/// The effect that `text` names.
///
/// # Errors
/// [`PlantError::Unknown`].
pub(crate) fn find(text: &str) -> Result<&'static Row, PlantError> {
    /// Likeness, from 0 to 1, above which a name is proposed.
    const ALIKE: f64 = 0.8;
    let known = || CATALOGUE.into_iter().chain(OUTSIDE).chain(FINER);
    REGISTRY.iter().find(|row| row.twin.name == text).ok_or_else(|| {
        let likeness = |name: &&str| strsim::jaro_winkler(name, text);
        let nearest = known().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
        PlantError::Unknown {
            name: text.to_owned(),
            nearest: nearest.filter(|name| likeness(name) > ALIKE),
            known: known().collect::<Vec<_>>().join(", "),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_and_each_place_in_a_family_is_that_of_one_effect() {
        let mut numbers: Vec<_> = REGISTRY.iter().map(|row| row.number).collect();
        numbers.sort_unstable();
        assert!(numbers.into_iter().eq(0..REGISTRY.len()));
        for (family, names) in families().iter().enumerate() {
            let place = |name: &str| {
                let row = find(name).unwrap();
                (0..names.len()).find(|place| row.group == Catalogue(family, *place))
            };
            let places: Vec<_> = names.iter().map(|name| place(name)).collect();
            assert!(places.into_iter().eq((0..names.len()).map(Some)), "{names:?}");
        }
    }

    #[test]
    fn names_keep_their_order() {
        assert_eq!(CATALOGUE[..3], ["input_offset", "dead_band", "stiction"]);
        assert_eq!(CATALOGUE[15..], ["leakage", "end_stop", "backlash"]);
        assert_eq!(FINER[0], "oil_column");
        assert_eq!(OUTSIDE[0], "input_notch");
    }
}
