//! The numbers of a cylinder, as a plant file holds them.

use serde::{Deserialize, Serialize};

/// A hydraulic cylinder that moves a joint: the table `cylinder` of a plant file.
///
/// What is left out makes the boom of an excavator of some eight tonnes. All keys, with
/// their equations and sources, are in `docs/simulating.md`. Pressures are above that of the
/// air, 1 bar = 100 kPa.
///
/// # Examples
/// ```
/// # use tauscope_synthetic::CylinderSpec;
/// let spec: CylinderSpec = toml::from_str("bore_mm = 80\nonly = ['gravity', 'friction']")?;
/// assert_eq!(spec.rod_mm, CylinderSpec::default().rod_mm);
/// # Ok::<(), toml::de::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CylinderSpec {
    /// The parts that act; all of them where it is left out.
    pub only: Option<Vec<Part>>,
    /// Longest step of the integration.
    pub time_step_s: f64,

    /// How much later than by the law of delay a very small step acts.
    pub pilot_small_s: f64,
    /// Size of step, in input units, that leaves 37 % of it.
    pub pilot_small_input: f64,
    /// How much later than by the law of delay a falling step acts.
    pub pilot_falling_s: f64,

    /// Input that opens the valve fully, in input units.
    pub full_input: f64,
    /// Way of the spool until a port opens, as a fraction of its stroke.
    pub overlap: f64,
    /// Place of the spool without input, as a fraction of its stroke.
    pub null_offset: f64,
    /// Natural frequency of the spool.
    pub spool_hz: f64,
    /// Damping ratio of the spool.
    pub spool_damping: f64,
    /// Shortest time from the middle to the full stroke.
    pub full_stroke_s: f64,
    /// Flow at a drop of 5 bar through a port that is open by one stroke; the full stroke
    /// opens it by one less the overlap.
    pub rated_flow_l_min: f64,

    /// Pressure that the pump keeps while nothing flows.
    pub supply_bar: f64,
    /// Largest flow of the pump.
    pub pump_flow_l_min: f64,
    /// Fall of the supply pressure at which the pump gives all that it can.
    pub pump_control_bar: f64,
    /// Oil between pump and valve.
    pub supply_volume_l: f64,
    /// Pressure of the return line.
    pub tank_bar: f64,

    /// Diameter of the piston.
    pub bore_mm: f64,
    /// Diameter of the rod.
    pub rod_mm: f64,
    /// Bulk modulus of the oil with its air and hoses.
    pub bulk_modulus_mpa: f64,
    /// Oil in the line of each chamber.
    pub hose_volume_l: f64,
    /// Flow past the piston at a difference of 100 bar.
    pub leakage_l_min: f64,
    /// Pressure at which a chamber is relieved.
    pub relief_bar: f64,

    /// Friction of the seals while they slide.
    pub coulomb_n: f64,
    /// Friction of the seals at the start.
    pub static_n: f64,
    /// Speed at which the static friction has fallen to 37 % of its excess.
    pub stribeck_m_s: f64,
    /// Friction in proportion to the speed.
    pub viscous_n_s_m: f64,

    /// Mass that the joint carries.
    pub mass_kg: f64,
    /// Distance of its centre from the joint.
    pub centre_m: f64,
    /// Moment of inertia about the joint.
    pub inertia_kg_m2: f64,

    /// Distance from the joint to the foot of the cylinder.
    pub foot_m: f64,
    /// Distance from the joint to the eye of the rod.
    pub eye_m: f64,
    /// Angle between the two, seen from the joint, where the joint's angle is zero.
    pub linkage_deg: f64,
    /// Angles of the joint where the piston is at its ends.
    pub angle_limits_deg: [f64; 2],
    /// Way before each end over which the piston is braked.
    pub cushion_mm: f64,
}

/// A part that can be switched off by leaving it out of [`CylinderSpec::only`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Part {
    /// The pilot stage, by which the delay varies.
    Pilot,
    /// Overlap and null offset of the spool; without it the ports open from the middle.
    Overlap,
    /// Natural frequency and slew of the spool; without it the spool follows at once.
    SpoolLag,
    /// The pump's limits; without it the supply pressure is constant.
    SupplyDroop,
    /// The rod; without it both sides of the piston are alike.
    Asymmetry,
    /// Flow past the piston.
    Leakage,
    /// Static and Coulomb friction; the viscous friction stays.
    Friction,
    /// The weight of the mass; its inertia stays.
    Gravity,
    /// The geometry; without it the lever arm is everywhere that of the middle angle.
    Linkage,
}

impl Default for CylinderSpec {
    fn default() -> Self {
        Self {
            only: None,
            time_step_s: 5e-5,
            pilot_small_s: 0.02,
            pilot_small_input: 2.0,
            pilot_falling_s: 0.005,
            full_input: 10.0,
            overlap: 0.06,
            null_offset: 0.01,
            spool_hz: 12.0,
            spool_damping: 0.8,
            full_stroke_s: 0.08,
            rated_flow_l_min: 30.0,
            supply_bar: 200.0,
            pump_flow_l_min: 100.0,
            pump_control_bar: 15.0,
            supply_volume_l: 2.0,
            tank_bar: 3.0,
            bore_mm: 100.0,
            rod_mm: 63.0,
            bulk_modulus_mpa: 900.0,
            hose_volume_l: 0.8,
            leakage_l_min: 0.1,
            relief_bar: 280.0,
            coulomb_n: 2500.0,
            static_n: 3500.0,
            stribeck_m_s: 0.01,
            viscous_n_s_m: 40_000.0,
            mass_kg: 1000.0,
            centre_m: 2.2,
            inertia_kg_m2: 7000.0,
            foot_m: 0.6,
            eye_m: 1.5,
            linkage_deg: 60.0,
            angle_limits_deg: [-25.0, 70.0],
            cushion_mm: 20.0,
        }
    }
}

impl CylinderSpec {
    /// Whether `part` acts.
    pub(super) fn has(&self, part: Part) -> bool {
        self.only.as_ref().is_none_or(|parts| parts.contains(&part))
    }

    /// Seconds that the pilot stage adds to the delay of a step.
    ///
    /// ```text
    /// pilot_small_s × exp(-|after - before| / pilot_small_input), and pilot_falling_s
    /// ```
    pub(crate) fn pilot_s(&self, before: f64, after: f64) -> f64 {
        if !self.has(Part::Pilot) {
            return 0.0;
        }
        let small = (-(after - before).abs() / self.pilot_small_input).exp();
        let falling = if after < before { self.pilot_falling_s } else { 0.0 };
        self.pilot_small_s * small + falling
    }

    /// Seconds that it adds at most.
    pub(crate) fn longest_pilot_s(&self) -> f64 {
        if self.has(Part::Pilot) { self.pilot_small_s + self.pilot_falling_s } else { 0.0 }
    }
}
