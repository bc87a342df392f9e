//! The valve: a spool with mass, and ports that it opens.

use std::f64::consts::TAU;

use super::spec::{CylinderSpec, LITRE_PER_MINUTE, PASCAL_PER_BAR, Part};

/// Drop at which the flow of a port is rated.
const RATED_DROP: f64 = 5.0 * PASCAL_PER_BAR;

/// Drop below which the flow through a port is rather laminar.
const LAMINAR_DROP: f64 = PASCAL_PER_BAR;

/// Spool and ports. The place of the spool is a fraction of its stroke, positive where
/// the cylinder extends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Valve {
    full_input: f64,
    null_offset: f64,
    overlap: f64,
    frequency: f64,
    damping: f64,
    slew: f64,
    at_once: bool,
    /// Flow per root of pressure through a fully open port.
    pub(super) conductance: f64,
}

/// How far the ports are open, from 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ports {
    /// Supply to the piston side, and rod side to tank.
    pub(super) extend: f64,
    /// Supply to the rod side, and piston side to tank.
    pub(super) retract: f64,
}

impl Valve {
    pub(super) fn of(spec: &CylinderSpec) -> Self {
        let overlaps = spec.has(Part::Overlap);
        Self {
            full_input: spec.full_input,
            null_offset: if overlaps { spec.null_offset } else { 0.0 },
            overlap: if overlaps { spec.overlap } else { 0.0 },
            frequency: TAU * spec.spool_hz,
            damping: spec.spool_damping,
            slew: 1.0 / spec.full_stroke_s,
            at_once: !spec.has(Part::SpoolLag),
            conductance: spec.rated_flow_l_min * LITRE_PER_MINUTE / RATED_DROP.sqrt(),
        }
    }

    /// Where the spool is sent by `input`.
    pub(super) fn target(&self, input: f64) -> f64 {
        (input / self.full_input + self.null_offset).clamp(-1.0, 1.0)
    }

    /// Rates of the place and the speed of the spool.
    ///
    /// ```text
    /// x' = v                                |v| at most one stroke in `full_stroke_s`
    /// v' = ω² (target - x) - 2 damping ω v
    /// ```
    pub(super) fn rates(&self, place: f64, speed: f64, target: f64) -> [f64; 2] {
        let pull = self.frequency * self.frequency * (target - place);
        let acceleration = pull - 2.0 * self.damping * self.frequency * speed;
        let faster = speed.abs() >= self.slew && acceleration * speed > 0.0;
        let moved = speed.clamp(-self.slew, self.slew);
        [moved, if faster { 0.0 } else { acceleration }]
    }

    /// The ports with the spool at `place`, or at `target` where it follows at once.
    pub(super) fn ports(&self, place: f64, target: f64) -> Ports {
        let place = if self.at_once { target } else { place };
        let open = |way: f64| (way - self.overlap).clamp(0.0, 1.0);
        Ports { extend: open(place), retract: open(-place) }
    }

    /// Flow through a port that is open by `opening`.
    pub(super) fn flow(&self, opening: f64, drop: f64) -> f64 {
        self.conductance * opening * root(drop)
    }

    /// Flow per pressure through a fully open port without a drop: no port has more.
    pub(super) fn steepest(&self) -> f64 {
        self.conductance / LAMINAR_DROP.sqrt()
    }

    /// The fastest rate of the spool.
    pub(super) fn rate(&self) -> f64 {
        let stiff = self.damping + (self.damping * self.damping - 1.0).max(0.0).sqrt();
        self.frequency * stiff.max(1.0)
    }
}

/// The root of a pressure drop with its sign, straight through zero.
///
/// ```text
/// sign(Δp) √|Δp|   for |Δp| far above the laminar drop δ;    Δp / √δ   far below
/// ```
pub(super) fn root(drop: f64) -> f64 {
    drop / drop.hypot(LAMINAR_DROP).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn valve() -> Valve {
        let spec = CylinderSpec { overlap: 0.1, null_offset: 0.02, ..CylinderSpec::default() };
        Valve::of(&spec)
    }

    #[test]
    fn ports_open_beyond_the_overlap_about_the_offset() {
        let valve = valve();
        let ports = |input: f64| {
            let target = valve.target(input);
            let Ports { extend, retract } = valve.ports(target, target);
            [extend, retract]
        };
        let cases = [
            (0.0, [0.0, 0.0]),
            (0.8, [0.0, 0.0]),
            (-1.2, [0.0, 0.0]),
            (5.0, [0.42, 0.0]),
            (-5.0, [0.0, 0.38]),
            (20.0, [0.9, 0.0]),
        ];
        for (input, expected) in cases {
            let found = ports(input);
            let close = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12);
            assert!(close, "{found:?} at {input}");
        }
    }

    #[test]
    fn a_port_gives_its_rated_flow_at_five_bar() {
        let flow = valve().flow(1.0, 5e5) / LITRE_PER_MINUTE;
        // The laminar part takes 1 % at this drop.
        assert!((flow - 30.0).abs() < 0.4, "{flow} l/min");
        let flow = valve().flow(0.5, -80e5) / LITRE_PER_MINUTE;
        assert!((flow + 0.5 * 4.0 * 30.0).abs() < 0.01, "{flow} l/min");
    }

    #[test]
    fn the_spool_never_exceeds_its_slew() {
        let valve = valve();
        let (mut place, mut speed, mut fastest) = (0.0, 0.0, 0.0_f64);
        for _ in 0..20_000 {
            let [moved, faster] = valve.rates(place, speed, 1.0);
            (place, speed) = (place + moved * 1e-5, speed + faster * 1e-5);
            fastest = fastest.max(moved);
        }
        assert!((fastest - 1.0 / 0.08).abs() < 1e-9, "{fastest} strokes a second");
        assert!((place - 1.0).abs() < 1e-3, "at {place}");
    }
}
