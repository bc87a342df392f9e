//! Oil under pressure: the pump's line and the two chambers.

use std::f64::consts::FRAC_PI_4;

use super::spec::{CylinderSpec, LITRE, LITRE_PER_MINUTE, PASCAL_PER_BAR, Part};
use super::valve::{Ports, Valve, root};

/// Size of the make-up valves, in fully open ports.
const MAKE_UP: f64 = 4.0;

/// Pressure above the relief pressure at which a relief valve passes 100 l/min.
const RELIEF_BAND: f64 = 10.0 * PASCAL_PER_BAR;
const RELIEF_FLOW: f64 = 100.0 * LITRE_PER_MINUTE;

/// Pressures above that of the air, in pascal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pressures {
    pub(crate) supply: f64,
    /// On the side of the piston.
    pub(crate) piston: f64,
    /// On the side of the rod.
    pub(crate) rod: f64,
}

/// Flows in cubic metres per second.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flows {
    /// From the pump.
    pub(super) pump: f64,
    /// Out of the supply, through the valve.
    pub(super) demand: f64,
    /// Into the piston side.
    pub(super) piston: f64,
    /// Into the rod side.
    pub(super) rod: f64,
}

/// The oil of one cylinder, in SI units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Oil {
    set_pressure: f64,
    pump_flow: f64,
    control_band: f64,
    supply_volume: f64,
    constant_supply: bool,
    tank: f64,
    pub(super) piston_area: f64,
    pub(super) rod_area: f64,
    pub(super) bulk_modulus: f64,
    hose_volume: f64,
    leakage: f64,
    relief: f64,
}

impl Oil {
    pub(super) fn of(spec: &CylinderSpec) -> Self {
        let disc = |diameter_mm: f64| FRAC_PI_4 * (diameter_mm * 1e-3).powi(2);
        let rod = if spec.has(Part::Asymmetry) { disc(spec.rod_mm) } else { 0.0 };
        let leakage = spec.leakage_l_min * LITRE_PER_MINUTE / (100.0 * PASCAL_PER_BAR);
        Self {
            set_pressure: spec.supply_bar * PASCAL_PER_BAR,
            pump_flow: spec.pump_flow_l_min * LITRE_PER_MINUTE,
            control_band: spec.pump_control_bar * PASCAL_PER_BAR,
            supply_volume: spec.supply_volume_l * LITRE,
            constant_supply: !spec.has(Part::SupplyDroop),
            tank: spec.tank_bar * PASCAL_PER_BAR,
            piston_area: disc(spec.bore_mm),
            rod_area: disc(spec.bore_mm) - rod,
            bulk_modulus: spec.bulk_modulus_mpa * 1e6,
            hose_volume: spec.hose_volume_l * LITRE,
            leakage: if spec.has(Part::Leakage) { leakage } else { 0.0 },
            relief: spec.relief_bar * PASCAL_PER_BAR,
        }
    }

    /// Pressures that hold `force` with the valve closed and the other side at 20 bar
    /// above the tank.
    pub(super) fn holding(&self, force: f64) -> Pressures {
        let low = self.tank + 20.0 * PASCAL_PER_BAR;
        let piston = (force + self.rod_area * low) / self.piston_area;
        let supply = self.set_pressure;
        if piston >= low {
            return Pressures { supply, piston, rod: low };
        }
        let rod = (self.piston_area * low - force) / self.rod_area;
        Pressures { supply, piston: low, rod }
    }

    /// Force of the oil on the piston, outward.
    pub(super) fn force(&self, at: &Pressures) -> f64 {
        self.piston_area * at.piston - self.rod_area * at.rod
    }

    /// All flows.
    ///
    /// A load check keeps oil from running back into the supply, a make-up valve lets a
    /// chamber draw oil from the tank, and a relief valve lets it out.
    pub(super) fn flows(&self, valve: &Valve, ports: Ports, at: &Pressures) -> Flows {
        let from_supply =
            |opening, chamber: f64| valve.flow(opening, (at.supply - chamber).max(0.0));
        let to_tank = |opening, chamber| valve.flow(opening, chamber - self.tank);
        let (extend, retract) =
            (from_supply(ports.extend, at.piston), from_supply(ports.retract, at.rod));
        let leak = self.leakage * (at.piston - at.rod);
        let spare = |chamber| self.spare(valve, chamber);
        Flows {
            pump: self.pump(at.supply),
            demand: extend + retract,
            piston: extend - to_tank(ports.retract, at.piston) - leak + spare(at.piston),
            rod: retract - to_tank(ports.extend, at.rod) + leak + spare(at.rod),
        }
    }

    /// What a pump with a pressure control gives: all it can far below the set pressure,
    /// nothing above.
    fn pump(&self, supply: f64) -> f64 {
        ((self.set_pressure - supply) / self.control_band).clamp(0.0, 1.0) * self.pump_flow
    }

    /// What make-up and relief valves let into a chamber.
    fn spare(&self, valve: &Valve, chamber: f64) -> f64 {
        let drawn = valve.conductance * MAKE_UP * root((self.tank - chamber).max(0.0));
        drawn - RELIEF_FLOW * ((chamber - self.relief) / RELIEF_BAND).max(0.0)
    }

    /// Volumes of the chambers with the piston `out` of one end and `left` of the other.
    pub(super) fn volumes(&self, out: f64, left: f64) -> [f64; 2] {
        // A piston pressed into its stops compresses the line, not nothing.
        let volume = |area: f64, way: f64| self.hose_volume + area * way.max(0.0);
        [volume(self.piston_area, out), volume(self.rod_area, left)]
    }

    /// Rates of the pressures with the piston moving out at `speed`.
    ///
    /// ```text
    /// p' = E / V × (flow in - swept)
    /// ```
    pub(super) fn rates(&self, flows: &Flows, volumes: [f64; 2], speed: f64) -> Pressures {
        let rate = |volume: f64, gained: f64| self.bulk_modulus / volume * gained;
        let supply = rate(self.supply_volume, flows.pump - flows.demand);
        Pressures {
            supply: if self.constant_supply { 0.0 } else { supply },
            piston: rate(volumes[0], flows.piston - self.piston_area * speed),
            rod: rate(volumes[1], flows.rod + self.rod_area * speed),
        }
    }

    /// The fastest rate at which pressures settle.
    pub(super) fn rate(&self, valve: &Valve) -> f64 {
        let spare = MAKE_UP * valve.steepest() + RELIEF_FLOW / RELIEF_BAND;
        let chamber = 2.0 * valve.steepest() + self.leakage + spare;
        let supply = 2.0 * valve.steepest() + self.pump_flow / self.control_band;
        let supply = if self.constant_supply { 0.0 } else { supply / self.supply_volume };
        self.bulk_modulus * supply.max(chamber / self.hose_volume)
    }

    /// Stiffness of the oil at its hardest, with one side down to its line, per metre.
    pub(super) fn stiffness(&self) -> f64 {
        let squares = self.piston_area.powi(2) + self.rod_area.powi(2);
        self.bulk_modulus * squares / self.hose_volume
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_areas_are_those_of_disc_and_ring() {
        let oil = Oil::of(&CylinderSpec::default());
        assert!((oil.piston_area * 1e4 - 78.54).abs() < 0.01);
        assert!((oil.rod_area * 1e4 - (78.54 - 31.17)).abs() < 0.01);
    }

    #[test]
    fn the_holding_pressures_hold() {
        let oil = Oil::of(&CylinderSpec::default());
        for force in [50e3, 0.0, -50e3] {
            let at = oil.holding(force);
            assert!((oil.force(&at) - force).abs() < 1e-6);
            assert!(at.piston > 20e5 && at.rod > 20e5);
        }
    }

    #[test]
    fn the_pump_gives_less_the_higher_the_pressure() {
        let oil = Oil::of(&CylinderSpec::default());
        let flows = [250.0, 200.0, 192.5, 185.0, 100.0].map(|bar| oil.pump(bar * 1e5) * 6e4);
        for (found, expected) in flows.iter().zip([0.0, 0.0, 50.0, 100.0, 100.0]) {
            assert!((found - expected).abs() < 1e-9, "{flows:?}");
        }
    }

    #[test]
    fn closed_ports_pass_only_the_leakage() {
        let spec = CylinderSpec::default();
        let (oil, valve) = (Oil::of(&spec), Valve::of(&spec));
        let at = Pressures { supply: 200e5, piston: 120e5, rod: 20e5 };
        let flows = oil.flows(&valve, Ports { extend: 0.0, retract: 0.0 }, &at);
        assert!((flows.piston * 6e4 + 0.1).abs() < 1e-9);
        assert!((flows.rod * 6e4 - 0.1).abs() < 1e-9);
    }

    #[test]
    fn no_oil_runs_back_into_the_supply() {
        let spec = CylinderSpec { leakage_l_min: 0.0, ..CylinderSpec::default() };
        let (oil, valve) = (Oil::of(&spec), Valve::of(&spec));
        let at = Pressures { supply: 100e5, piston: 150e5, rod: 3e5 };
        let flows = oil.flows(&valve, Ports { extend: 0.5, retract: 0.0 }, &at);
        assert!(flows.demand.abs() < 1e-15 && flows.piston.abs() < 1e-15);
    }
}
