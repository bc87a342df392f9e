//! The effects of a joint, as a plant file holds them.

use std::collections::BTreeMap;

use serde::{Deserialize as _, Deserializer, Serialize, Serializer, de};

use super::registry::{OUTSIDE, REGISTRY};
use super::twin::{At, Numbers, Stage, States, Twin};
use crate::clock::Clock;
use crate::delay_law::Occasion;
use crate::error::{Place, PlantError};

/// An effect with its numbers.
#[derive(Clone, Debug)]
pub(crate) struct Instance {
    pub(crate) twin: &'static Twin,
    numbers: Numbers,
}

/// Effects that a joint hides: `[joint.effect.<name>]` or `[joint.outside.<name>]` in a plant file.
///
/// A model that only knows the catalogue can not explain those outside it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hidden(Vec<Instance>);

impl Instance {
    pub(crate) fn new(twin: &'static Twin, given: &[f64]) -> Self {
        let mut numbers = Numbers::default();
        numbers.iter_mut().zip(given).for_each(|(number, given)| *number = *given);
        Self { twin, numbers }
    }

    /// Its place in the order in which the signal passes all effects.
    pub(crate) fn place(&self) -> Option<usize> {
        REGISTRY.iter().position(|row| row.twin.name == self.twin.name)
    }

    /// The signal after it.
    pub(crate) fn act(&self, signal: f64, at: &At, states: &States, rates: &mut States) -> f64 {
        (self.twin.act)(&self.numbers, signal, at, states, rates)
    }

    /// The signal after it, where it has neither states nor sees the joint.
    pub(crate) fn pass(&self, signal: f64, at: &At) -> f64 {
        self.act(signal, at, &States::default(), &mut States::default())
    }

    /// The signal after it after `signal` has long been held, and the states then.
    pub(crate) fn settle(&self, signal: f64, at: &At, states: &mut States) -> f64 {
        (self.twin.settle)(&self.numbers, signal, at, states)
    }

    /// Direction of motion at a `level` of the valve, where it was `before`; none where this
    /// does not set it.
    pub(crate) fn direction(&self, level: f64, before: f64) -> Option<f64> {
        self.twin.direction.map(|direction| direction(&self.numbers, level, before))
    }

    /// Seconds that it adds to the delay of a step.
    pub(crate) fn delay_s(&self, at: &Occasion) -> f64 {
        (self.twin.delay_s)(&self.numbers, at)
    }

    /// Seconds that it adds at most.
    pub(crate) fn longest_delay_s(&self) -> f64 {
        (self.twin.longest_delay_s)(&self.numbers)
    }

    /// Refuses numbers that mean nothing.
    fn check(&self, group: &str, place: &Place, clock: &Clock) -> Result<(), PlantError> {
        let Self { twin, numbers } = self;
        let key = |index: usize| format!("{group}.{}.{}", twin.name, twin.keys[index]);
        for (index, (number, rule)) in numbers.iter().zip(twin.allowed).enumerate() {
            place.number(&key(index), *number, *rule, clock)?;
        }
        let wrong = (twin.related)(numbers, clock);
        wrong.map_or(Ok(()), |(index, allowed)| {
            Err(place.refuse(&key(index), numbers[index], allowed))
        })
    }
}

impl PartialEq for Instance {
    fn eq(&self, other: &Self) -> bool {
        self.twin.name == other.twin.name && self.numbers == other.numbers
    }
}

impl Serialize for Instance {
    /// A stop that is left out is infinite, and is left out again.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let numbers = self.twin.keys.iter().zip(&self.numbers);
        serializer.collect_map(numbers.filter(|(_, number)| number.is_finite()))
    }
}

impl Hidden {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Names of those that are there.
    pub fn names(&self) -> Vec<&'static str> {
        self.0.iter().map(|instance| instance.twin.name).collect()
    }

    /// The numbers of the effect `name`, in the order of its keys in `docs/simulating.md`.
    pub fn get(&self, name: &str) -> Option<&[f64]> {
        let known = self.0.iter().find(|instance| instance.twin.name == name);
        known.and_then(|one| one.numbers.get(..one.twin.keys.len()))
    }

    /// Puts an effect in the place of what there is of it.
    pub(crate) fn put(&mut self, twin: &'static Twin, numbers: &[f64]) {
        self.0.retain(|instance| instance.twin.name != twin.name);
        self.0.push(Instance::new(twin, numbers));
        self.0.sort_by_key(Instance::place);
    }

    /// Those that act, in the order in which the signal passes them.
    pub(crate) fn acting(&self) -> impl Iterator<Item = &Instance> {
        let is_replaced = |one: &&Instance| {
            self.0.iter().any(|other| other.twin.instead_of == Some(one.twin.name))
        };
        self.0.iter().filter(move |instance| !is_replaced(instance))
    }

    /// Names of those that change the motion, which those of the sensor do not.
    pub(crate) fn hindering(&self) -> Vec<&'static str> {
        let motion = self.0.iter().filter(|instance| instance.twin.stage != Stage::Sensor);
        motion.map(|instance| instance.twin.name).collect()
    }

    /// What the sensor shows of `angle`.
    pub(crate) fn shown(&self, angle: f64) -> f64 {
        let of_sensor = self.0.iter().filter(|instance| instance.twin.stage == Stage::Sensor);
        of_sensor.fold(angle, |angle, one| one.pass(angle, &At::default()))
    }

    /// Refuses numbers that mean nothing; `group` is the key of the table.
    pub(crate) fn check(
        &self,
        group: &str,
        place: &Place,
        clock: &Clock,
    ) -> Result<(), PlantError> {
        self.0.iter().try_for_each(|instance| instance.check(group, place, clock))
    }
}

impl Serialize for Hidden {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|instance| (instance.twin.name, instance)))
    }
}

/// The numbers of `twin` in the order of its keys, where `given` are those it has.
///
/// # Errors
/// For a key that is unknown, or missing.
pub(crate) fn numbers<E: de::Error>(
    twin: &'static Twin,
    given: &BTreeMap<String, f64>,
) -> Result<Vec<f64>, E> {
    if let Some(unknown) = given.keys().find(|key| !twin.keys.contains(&key.as_str())) {
        return Err(E::unknown_field(unknown, twin.keys));
    }
    let required = twin.keys.len() - twin.optional.len();
    let number = |(index, key): (usize, &&'static str)| {
        let default = index.checked_sub(required).map(|index| &twin.optional[index]);
        given.get(*key).or(default).copied().ok_or_else(|| E::missing_field(key))
    };
    twin.keys.iter().enumerate().map(number).collect()
}

/// Effects of the catalogue.
pub(crate) fn catalogue<'de, D: Deserializer<'de>>(from: D) -> Result<Hidden, D::Error> {
    read(from, |name| !OUTSIDE.contains(&name))
}

/// Effects outside it.
pub(crate) fn outside<'de, D: Deserializer<'de>>(from: D) -> Result<Hidden, D::Error> {
    read(from, |name| OUTSIDE.contains(&name))
}

fn read<'de, D: Deserializer<'de>>(from: D, belongs: fn(&str) -> bool) -> Result<Hidden, D::Error> {
    let mut hidden = Hidden::default();
    for (name, given) in BTreeMap::<String, BTreeMap<String, f64>>::deserialize(from)? {
        let known = || REGISTRY.iter().map(|row| row.twin).filter(|twin| belongs(twin.name));
        let twin = known().find(|twin| twin.name == name).ok_or_else(|| {
            let names: Vec<_> = known().map(|twin| format!("`{}`", twin.name)).collect();
            let names = names.join(", ");
            de::Error::custom(format!("unknown field `{name}`, expected one of {names}"))
        })?;
        hidden.put(twin, &numbers(twin, &given)?);
    }
    Ok(hidden)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_hidden_has_a_name() {
        let text = "disturbance = { from_s = 1, to_s = 2, speed = 3 }\n\
                    sensor_nonlinearity = { amplitude = 2, period = 30 }";
        let both = outside(toml::de::Deserializer::parse(text).unwrap()).unwrap();
        assert_eq!(both.names(), ["disturbance", "sensor_nonlinearity"]);
        assert_eq!(both.hindering(), ["disturbance"]);
        assert_eq!(both.get("sensor_nonlinearity"), Some(&[2.0, 30.0, 0.0][..]));
        assert!(catalogue(toml::de::Deserializer::parse(text).unwrap()).is_err());
    }
}
