//! How all effects of the valve together open it.

use super::groups::{Effects, Outside};
use super::valve::Stiction;

/// The valve of a joint: from the delayed level to its opening, in input units.
///
/// With `e` the edge and `ramp` a rounded `max(x, 0)`, one after the other:
///
/// ```text
/// offset      u + offset
/// dead band   ramp(u - upper) - ramp(lower - u)
/// flow curve  u ((u² + e²) / (1 + e²))^((exponent - 1) / 2)
/// direction   u (1 + (negative_factor - 1) rise(-u))
/// notch       u (1 - (1 - share) window(u))
/// saturation  u (1 + abs(u / limit)^p)^(-1/p),   p: sharpness; a limit for each sign
/// ```
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Valve<'a> {
    effect: &'a Effects,
    outside: &'a Outside,
    edge: f64,
}

impl<'a> Valve<'a> {
    /// The valve with these effects, its corners rounded over `edge`, in input units.
    pub(in super::super) fn new(effect: &'a Effects, outside: &'a Outside, edge: f64) -> Self {
        Self { effect, outside, edge: edge.max(f64::MIN_POSITIVE) }
    }

    /// Width of the rounded corners, in input units.
    pub(in super::super) fn edge(&self) -> f64 {
        self.edge
    }

    /// Opening at a held `level` of a valve that does not stick.
    pub(in super::super) fn opening(&self, level: f64) -> f64 {
        let (effect, edge) = (self.effect, self.edge);
        let mut u = level + effect.input_offset.map_or(0.0, |part| part.offset);
        u = effect.dead_band.map_or(u, |part| part.opening(u, edge));
        u = effect.flow_curve.map_or(u, |part| part.opening(u, edge));
        u = effect.direction_gain.map_or(u, |part| part.opening(u, edge));
        u = self.outside.input_notch.map_or(u, |part| part.opening(u, edge));
        match (effect.asymmetric_saturation, effect.input_saturation) {
            (Some(part), _) => part.opening(u),
            (None, Some(part)) => part.opening(u),
            (None, None) => u,
        }
    }

    /// Direction of motion at `level`, 0 at rest, where it was `before`.
    pub(in super::super) fn direction(&self, level: f64, before: f64) -> f64 {
        let u = level + self.effect.input_offset.map_or(0.0, |part| part.offset);
        let Some(Stiction { start, stop }) = self.effect.stiction else {
            return u.signum();
        };
        let needed = if u * before > 0.0 { stop } else { start };
        if u.abs() > needed { u.signum() } else { 0.0 }
    }
}
