//! Which numbers a cylinder may have.

use super::super::clock::Clock;
use super::super::error::{NOT_NEGATIVE, POSITIVE, Place, PlantError};
use super::CylinderSpec;
use super::machine::Machine;

/// Steps of time in a record: a minute of work.
const MAX_TIME_STEPS: f64 = 5e7;

/// Largest product of the time step and the fastest rate. The method stays stable up
/// to 2.8; the rest keeps it accurate.
const MAX_STEP_TIMES_RATE: f64 = 1.5;

impl CylinderSpec {
    /// Refuses numbers that no cylinder has, and a time step that is too long for them.
    pub(crate) fn check(&self, clock: &Clock, place: &Place) -> Result<(), PlantError> {
        self.check_numbers(clock, place)?;
        self.check_valve(place)?;
        self.check_piston(place)?;
        self.check_load(place)?;
        self.check_linkage(place)?;
        self.check_time_step(clock, place)
    }

    /// All numbers are above zero, but for some that may be zero, and those with limits of their own.
    fn check_numbers(&self, clock: &Clock, place: &Place) -> Result<(), PlantError> {
        let numbers = toml::Table::try_from(self)
            .map_err(|source| PlantError::Write { source: Box::new(source) })?;
        for (key, value) in &numbers {
            let allowed = match key.as_str() {
                "overlap" | "null_offset" => continue,
                "pilot_small_s" | "pilot_falling_s" | "tank_bar" | "rod_mm" | "leakage_l_min"
                | "coulomb_n" | "static_n" | "viscous_n_s_m" => NOT_NEGATIVE,
                _ => POSITIVE,
            };
            if let Some(value) = value.as_float() {
                place.number(&format!("cylinder.{key}"), value, &allowed, clock)?;
            }
        }
        Ok(())
    }

    fn check_valve(&self, place: &Place) -> Result<(), PlantError> {
        place.require("cylinder.overlap", self.overlap, "0 or more, below 0.9", |overlap| {
            (0.0..0.9).contains(overlap)
        })?;
        let allowed = "between -0.5 and 0.5";
        place.require("cylinder.null_offset", self.null_offset, allowed, |offset| {
            offset.abs() <= 0.5
        })?;
        let allowed = "a pressure between those of tank and relief";
        place.require("cylinder.supply_bar", self.supply_bar, allowed, |supply| {
            *supply > self.tank_bar && *supply <= self.relief_bar
        })
    }

    fn check_piston(&self, place: &Place) -> Result<(), PlantError> {
        place.require("cylinder.rod_mm", self.rod_mm, "thinner than the bore", |rod| {
            *rod < self.bore_mm
        })?;
        let allowed = "the Coulomb friction or more";
        place.require("cylinder.static_n", self.static_n, allowed, |most| *most >= self.coulomb_n)
    }

    fn check_load(&self, place: &Place) -> Result<(), PlantError> {
        let allowed = "mass_kg × centre_m² or more: no body has less";
        place.require("cylinder.inertia_kg_m2", self.inertia_kg_m2, allowed, |inertia| {
            *inertia >= self.mass_kg * self.centre_m * self.centre_m
        })
    }

    fn check_linkage(&self, place: &Place) -> Result<(), PlantError> {
        let limits = self.angle_limits_deg;
        let allowed = "[lowest, highest] with `linkage_deg` added between 5 and 175: beyond, the \
                       cylinder has no lever arm";
        place.require("cylinder.angle_limits_deg", limits, allowed, |[lowest, highest]| {
            let inside = |angle: f64| (5.0..=175.0).contains(&(angle + self.linkage_deg));
            lowest < highest && inside(*lowest) && inside(*highest)
        })
    }

    fn check_time_step(&self, clock: &Clock, place: &Place) -> Result<(), PlantError> {
        let key = "cylinder.time_step_s";
        let duration_s = clock.time_s(clock.samples());
        let allowed = "longer: the record has more than fifty million steps";
        place.require(key, self.time_step_s, allowed, |step_s| {
            duration_s / step_s <= MAX_TIME_STEPS
        })?;
        let rate = Machine::of(self).fastest_rate();
        let allowed = "shorter, for oil, seals and spool as fast as these; or larger volumes, less \
                       friction, more inertia";
        place.require(key, self.time_step_s, allowed, |step_s| step_s * rate <= MAX_STEP_TIMES_RATE)
    }
}
