//! The numbers of a cylinder, as a plant file holds them.

use serde::{Deserialize, Serialize};

use crate::error::{NOT_NEGATIVE, POSITIVE, Rule};

/// Pascal in a bar.
pub(super) const PASCAL_PER_BAR: f64 = 1e5;

/// Cubic metres in a litre.
pub(super) const LITRE: f64 = 1e-3;

/// Cubic metres per second in a litre per minute.
pub(super) const LITRE_PER_MINUTE: f64 = LITRE / 60.0;

/// Makes [`CylinderSpec`] of a row for each key: its type, what it is where a file leaves it out,
/// and what it may be, where that depends on no other key.
macro_rules! cylinder {
    ($(#[$of_all:meta])* {
        $($(#[$doc:meta])* $key:ident: $type:ty = $default:expr $(, $rule:ident)?;)*
    }) => {
        $(#[$of_all])*
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct CylinderSpec {
            $($(#[$doc])* pub $key: $type,)*
        }

        impl Default for CylinderSpec {
            fn default() -> Self {
                Self { $($key: $default,)* }
            }
        }

        impl CylinderSpec {
            /// Key, value and rule of each number that has one.
            pub(super) fn numbers(&self) -> Vec<(&'static str, f64, Rule)> {
                vec![$($((concat!("cylinder.", stringify!($key)), self.$key, $rule),)?)*]
            }
        }
    };
}

cylinder! {
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
    {
        /// The parts that act; all of them where it is left out.
        only: Option<Vec<Part>> = None;
        /// Longest step of the integration.
        time_step_s: f64 = 5e-5, POSITIVE;

        /// How much later than by the law of delay a very small step acts.
        pilot_small_s: f64 = 0.02, NOT_NEGATIVE;
        /// Size of step, in input units, that leaves 37 % of it.
        pilot_small_input: f64 = 2.0, POSITIVE;
        /// How much later than by the law of delay a falling step acts.
        pilot_falling_s: f64 = 0.005, NOT_NEGATIVE;

        /// Input that opens the valve fully, in input units.
        full_input: f64 = 10.0, POSITIVE;
        /// Way of the spool until a port opens, as a fraction of its stroke.
        overlap: f64 = 0.06;
        /// Place of the spool without input, as a fraction of its stroke.
        null_offset: f64 = 0.01;
        /// Natural frequency of the spool.
        spool_hz: f64 = 12.0, POSITIVE;
        /// Damping ratio of the spool.
        spool_damping: f64 = 0.8, POSITIVE;
        /// Shortest time from the middle to the full stroke.
        full_stroke_s: f64 = 0.08, POSITIVE;
        /// Flow at a drop of 5 bar through a port that is open by one stroke; the full stroke
        /// opens it by one less the overlap.
        rated_flow_l_min: f64 = 30.0, POSITIVE;

        /// Pressure that the pump keeps while nothing flows.
        supply_bar: f64 = 200.0, POSITIVE;
        /// Largest flow of the pump.
        pump_flow_l_min: f64 = 100.0, POSITIVE;
        /// Fall of the supply pressure at which the pump gives all that it can.
        pump_control_bar: f64 = 15.0, POSITIVE;
        /// Oil between pump and valve.
        supply_volume_l: f64 = 2.0, POSITIVE;
        /// Pressure of the return line.
        tank_bar: f64 = 3.0, NOT_NEGATIVE;

        /// Diameter of the piston.
        bore_mm: f64 = 100.0, POSITIVE;
        /// Diameter of the rod.
        rod_mm: f64 = 63.0, NOT_NEGATIVE;
        /// Bulk modulus of the oil with its air and hoses.
        bulk_modulus_mpa: f64 = 900.0, POSITIVE;
        /// Oil in the line of each chamber.
        hose_volume_l: f64 = 0.8, POSITIVE;
        /// Flow past the piston at a difference of 100 bar.
        leakage_l_min: f64 = 0.1, NOT_NEGATIVE;
        /// Pressure at which a chamber is relieved.
        relief_bar: f64 = 280.0, POSITIVE;

        /// Friction of the seals while they slide.
        coulomb_n: f64 = 2500.0, NOT_NEGATIVE;
        /// Friction of the seals at the start.
        static_n: f64 = 3500.0, NOT_NEGATIVE;
        /// Speed at which the static friction has fallen to 37 % of its excess.
        stribeck_m_s: f64 = 0.01, POSITIVE;
        /// Friction in proportion to the speed.
        viscous_n_s_m: f64 = 40_000.0, NOT_NEGATIVE;

        /// Mass that the joint carries.
        mass_kg: f64 = 1000.0, POSITIVE;
        /// Distance of its centre from the joint.
        centre_m: f64 = 2.2, POSITIVE;
        /// Moment of inertia about the joint.
        inertia_kg_m2: f64 = 7000.0, POSITIVE;

        /// Distance from the joint to the foot of the cylinder.
        foot_m: f64 = 0.6, POSITIVE;
        /// Distance from the joint to the eye of the rod.
        eye_m: f64 = 1.5, POSITIVE;
        /// Angle between the two, seen from the joint, where the joint's angle is zero.
        linkage_deg: f64 = 60.0, POSITIVE;
        /// Angles of the joint where the piston is at its ends.
        angle_limits_deg: [f64; 2] = [-25.0, 70.0];
        /// Way before each end over which the piston is braked.
        cushion_mm: f64 = 20.0, POSITIVE;
    }
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
