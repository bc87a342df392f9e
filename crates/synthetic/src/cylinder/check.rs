//! Which numbers a cylinder may have.

use super::machine::Machine;
use super::spec::CylinderSpec;
use crate::clock::Clock;
use crate::error::{Place, PlantError};

/// Steps of time in a record: a minute of work.
const MAX_TIME_STEPS: f64 = 5e7;

/// Largest product of the time step and the fastest rate. The method stays stable up
/// to 2.8; the rest keeps it accurate.
const MAX_STEP_TIMES_RATE: f64 = 1.5;

impl CylinderSpec {
    /// Refuses numbers that no cylinder has, and a time step that is too long for them.
    pub(crate) fn check(&self, clock: &Clock, place: &Place) -> Result<(), PlantError> {
        let mut numbers = self.numbers();
        numbers.sort_unstable_by_key(|(key, ..)| *key);
        for (key, number, rule) in numbers {
            place.number(key, number, rule, clock)?;
        }
        self.check_parts(place)?;
        self.check_time_step(clock, place)
    }

    /// What a number may be beside others.
    fn check_parts(&self, place: &Place) -> Result<(), PlantError> {
        let supply = self.supply_bar > self.tank_bar && self.supply_bar <= self.relief_bar;
        let inertia = self.inertia_kg_m2 >= self.mass_kg * self.centre_m * self.centre_m;
        let [lowest, highest] = self.angle_limits_deg;
        let has_lever = |angle: f64| (5.0..=175.0).contains(&(angle + self.linkage_deg));
        let limits = lowest < highest && has_lever(lowest) && has_lever(highest);
        let overlap = (0.0..0.9).contains(&self.overlap);
        let offset = self.null_offset.abs() <= 0.5;
        let between = "a pressure between those of tank and relief";
        let (rod, thinner) = (self.rod_mm < self.bore_mm, "thinner than the bore");
        let (static_n, more) = (self.static_n >= self.coulomb_n, "the Coulomb friction or more");
        let body = "mass_kg × centre_m² or more: no body has less";
        let lever = "[lowest, highest] with `linkage_deg` added between 5 and 175: beyond, the \
                     cylinder has no lever arm";
        place.require(&[
            ("cylinder.overlap", &self.overlap, overlap, "0 or more, below 0.9"),
            ("cylinder.null_offset", &self.null_offset, offset, "between -0.5 and 0.5"),
            ("cylinder.supply_bar", &self.supply_bar, supply, between),
            ("cylinder.rod_mm", &self.rod_mm, rod, thinner),
            ("cylinder.static_n", &self.static_n, static_n, more),
            ("cylinder.inertia_kg_m2", &self.inertia_kg_m2, inertia, body),
            ("cylinder.angle_limits_deg", &self.angle_limits_deg, limits, lever),
        ])
    }

    fn check_time_step(&self, clock: &Clock, place: &Place) -> Result<(), PlantError> {
        let (key, step_s) = ("cylinder.time_step_s", &self.time_step_s);
        let few = clock.time_s(clock.samples) / step_s <= MAX_TIME_STEPS;
        let short = step_s * Machine::of(self).fastest_rate() <= MAX_STEP_TIMES_RATE;
        let longer = "longer: the record has more than fifty million steps";
        let shorter = "shorter, for oil, seals and spool as fast as these; or larger volumes, less \
                       friction, more inertia";
        place.require(&[(key, step_s, few, longer), (key, step_s, short, shorter)])
    }
}
