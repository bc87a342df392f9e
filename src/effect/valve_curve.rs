//! Static curve of the valve: the flow as a monotone function of the command, by cubics between
//! knots.
//!
//! ```text
//! out(k reach/6) = share_k · share_(k+1) · … · share_5 · reach for k = 1 … 5,
//! out(0) = 0,   out(reach) = reach
//! ```
//!
//! and with shares of its own, times `negative_factor`, for commands below zero. It has no law:
//! overlap, notches, limits and progression of an unusual valve all show in its knots, and a model with
//! it follows the static curve whatever made it so. A search names it where no named effect explains
//! the curve. `reach` is the largest command of the record, and not fitted; beyond it the curve goes
//! on straight.
//!
//! The curve is a cubic between knots. With the secants `s` and `t` on its sides it has at a knot the
//! slope `2 min(s, t, (s + t)/4)`, and at an end, with the secant `s` of its own interval and `t` of
//! the next, `(3 s − t)/2` within 0 and `2 s`. So it is monotone, and follows a parabola exactly.
//!
//! # References
//! Jelali, M., and Kroll, A., 2003, Hydraulic Servo-systems: Modelling, Identification and Control
//! (measured flow curves of valves); Steffen, M., 1990, A simple method for monotonic interpolation in
//! one dimension, Astronomy and Astrophysics 239, 443-450.

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage};
use crate::units::floor_to_index;

/// Knots within the curve of one direction. Chosen: with two, five simulated valves with fine metering, a
/// notch and a full port left 4 to 49 times the noise, and false laws beside; with five, 3 to 17.
const KNOTS: usize = 5;

/// Intervals between knots.
const INTERVALS: usize = KNOTS + 1;

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct ValveCurve;

static SPEC: Spec = Spec::new(
    "valve_curve",
    Stage::Input,
    "static curve of the valve of any monotone form, by cubics between knots",
)
.equation(
    "out = 0 at in = 0, share_1 share_2 share_3 share_4 share_5 reach at in = reach/6, \
     share_2 share_3 share_4 share_5 reach at 2 reach/6, share_3 share_4 share_5 reach at 3 reach/6, \
     share_4 share_5 reach at 4 reach/6, share_5 reach at 5 reach/6, reach at reach, monotone cubics \
     between; for in < 0 with negative_share_1, negative_share_2, negative_share_3, \
     negative_share_4, negative_share_5, times negative_factor",
)
.source(
    "Jelali and Kroll, 2003, Hydraulic Servo-systems; Steffen, 1990, A simple method for monotonic \
     interpolation in one dimension",
)
.parameters(&[
    share("share_1", "flow at 1/6 of reach over that at 2/6", 1.0 / 2.0),
    share("share_2", "flow at 2/6 of reach over that at 3/6", 2.0 / 3.0),
    share("share_3", "flow at 3/6 of reach over that at 4/6", 3.0 / 4.0),
    share("share_4", "flow at 4/6 of reach over that at 5/6", 4.0 / 5.0),
    share("share_5", "flow at 5/6 of reach over that at 6/6", 5.0 / 6.0),
    share("negative_share_1", "flow at -1/6 of reach over that at -2/6", 1.0 / 2.0),
    share("negative_share_2", "flow at -2/6 of reach over that at -3/6", 2.0 / 3.0),
    share("negative_share_3", "flow at -3/6 of reach over that at -4/6", 3.0 / 4.0),
    share("negative_share_4", "flow at -4/6 of reach over that at -5/6", 4.0 / 5.0),
    share("negative_share_5", "flow at -5/6 of reach over that at -6/6", 5.0 / 6.0),
    Parameter::new("negative_factor", "flow at -reach over that at reach", Dimension::One)
        .between(0.05, 20.0)
        .neutral(1.0),
    Parameter::new("reach", "largest command of the record", Dimension::Input)
        .between(0.0, super::UNLIMITED)
        .not_fitted(),
])
.confused_with(&[
    "dead_band",
    "input_saturation",
    "asymmetric_saturation",
    "flow_curve",
    "direction_gain",
    "stiction",
])
.absorbing(&[
    "dead_band",
    "input_saturation",
    "asymmetric_saturation",
    "flow_curve",
    "direction_gain",
])
.looking_like_both(&[
    ["dead_band", "flow_curve"],
    ["dead_band", "input_saturation"],
    ["dead_band", "asymmetric_saturation"],
    ["flow_curve", "input_saturation"],
    ["flow_curve", "direction_gain"],
    ["input_saturation", "direction_gain"],
    ["input_offset", "flow_curve"],
    ["input_offset", "input_saturation"],
    ["input_offset", "direction_gain"],
])
.free_form()
.steady()
.equations(Equations::new(&["a1 = if(signal < 0, negative_share_1, share_1)
             a2 = if(signal < 0, negative_share_2, share_2)
             a3 = if(signal < 0, negative_share_3, share_3)
             a4 = if(signal < 0, negative_share_4, share_4)
             a5 = if(signal < 0, negative_share_5, share_5)
             factor = if(signal < 0, negative_factor, 1)
             size = if(reach > 0, 6 * abs(signal) / reach, 0)
             v5 = a5
             v4 = a4 * v5
             v3 = a3 * v4
             v2 = a2 * v3
             v1 = a1 * v2
             d1 = v1
             d2 = v2 - v1
             d3 = v3 - v2
             d4 = v4 - v3
             d5 = v5 - v4
             d6 = 1 - v5
             m0 = min(max(1.5 * d1 - 0.5 * d2, 0), 2 * d1)
             m1 = 2 * min(min(d1, d2), 0.25 * (d1 + d2))
             m2 = 2 * min(min(d2, d3), 0.25 * (d2 + d3))
             m3 = 2 * min(min(d3, d4), 0.25 * (d3 + d4))
             m4 = 2 * min(min(d4, d5), 0.25 * (d4 + d5))
             m5 = 2 * min(min(d5, d6), 0.25 * (d5 + d6))
             m6 = min(max(1.5 * d6 - 0.5 * d5, 0), 2 * d6)
             along = if(size < 1, size, if(size < 2, size - 1, if(size < 3, size - 2, \
                 if(size < 4, size - 3, if(size < 5, size - 4, size - 5)))))
             base = if(size < 1, 0, if(size < 2, v1, if(size < 3, v2, if(size < 4, v3, \
                 if(size < 5, v4, v5)))))
             rise = if(size < 1, d1, if(size < 2, d2, if(size < 3, d3, if(size < 4, d4, \
                 if(size < 5, d5, d6)))))
             left = if(size < 1, m0, if(size < 2, m1, if(size < 3, m2, if(size < 4, m3, \
                 if(size < 5, m4, m5)))))
             right = if(size < 1, m1, if(size < 2, m2, if(size < 3, m3, if(size < 4, m4, \
                 if(size < 5, m5, m6)))))
             bend = 3 * rise - 2 * left - right
             twist = left + right - 2 * rise
             cubic = base + along * (left + along * (bend + along * twist))
             part = if(size > 6, 1 + (size - 6) * m6, cubic)
             out = if(reach > 0, sign(signal) * factor * reach * part, signal)"]));

const fn share(name: &'static str, meaning: &'static str, neutral: f64) -> Parameter {
    Parameter::new(name, meaning, Dimension::One).between(0.0, 1.0).neutral(neutral)
}

impl Effect for ValveCurve {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[ref shares @ .., negative_factor, reach] = parameters else { return at.signal };
        let (shares, factor) = if at.signal < 0.0 {
            (shares.last_chunk::<KNOTS>(), negative_factor)
        } else {
            (shares.first_chunk::<KNOTS>(), 1.0)
        };
        let Some(shares) = shares.filter(|_| reach > 0.0) else { return at.signal };
        let part = along(shares, INTERVALS as f64 * at.signal.abs() / reach);
        (factor * reach * part).copysign(at.signal)
    }

    /// A valve with an overlap, and one with a limit.
    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let of = |law: fn(f64) -> f64| {
            let at = |k: usize| law(k as f64 / INTERVALS as f64);
            let shares: Vec<f64> = (1..=KNOTS).map(|k| at(k) / at(k + 1)).collect();
            let rest = [1.0, record.size(Dimension::Input)];
            [&shares[..], &shares, &rest].concat()
        };
        vec![of(|u| u * (0.2 + 0.8 * u)), of(|u| u * (1.8 - 0.8 * u))]
    }
}

/// The monotone cubics through (0, 0) and (k, `shares[k − 1] … shares[KNOTS − 1]`) to (`INTERVALS`, 1),
/// at `size`.
fn along(shares: &[f64; KNOTS], size: f64) -> f64 {
    let mut values = [0.0; INTERVALS + 1];
    values[INTERVALS] = 1.0;
    for k in (1..INTERVALS).rev() {
        values[k] = shares[k - 1] * values[k + 1];
    }
    let secant = |k: usize| values[k + 1] - values[k];
    let end = |s: f64, t: f64| (1.5 * s - 0.5 * t).max(0.0).min(2.0 * s);
    let slope = |k: usize| match k {
        0 => end(secant(0), secant(1)),
        INTERVALS => end(secant(KNOTS), secant(KNOTS - 1)),
        _ => {
            let (s, t) = (secant(k - 1), secant(k));
            2.0 * s.min(t).min(0.25 * (s + t))
        }
    };
    if size > INTERVALS as f64 {
        return 1.0 + (size - INTERVALS as f64) * slope(INTERVALS);
    }
    let index = floor_to_index(size).min(KNOTS);
    let t = size - index as f64;
    let (rise, left, right) = (secant(index), slope(index), slope(index + 1));
    let (bend, twist) = (3.0 * rise - 2.0 * left - right, left + right - 2.0 * rise);
    values[index] + t * (left + t * (bend + t * twist))
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn it_goes_through_its_knots() {
        let parameters = [0.25, 0.8, 0.5, 0.4, 0.5, 0.5, 0.2, 0.4, 0.8, 0.5, 0.5, 6.0];
        let inputs = [0.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0, -6.0, -5.0, -4.0, -3.0];
        let outputs = [0.0, 6.0, 3.0, 1.2, 0.6, 0.48, 0.12, -3.0, -1.5, -1.2, -0.48];
        assert_close(&run(&ValveCurve, &parameters, &inputs), &outputs);
    }

    #[test]
    fn it_follows_a_parabola_and_is_monotone_whatever_its_knots() {
        let law = |u: f64| (u + 0.7 * u * u) / (1.0 + 0.7);
        let at = |k: u32| law(f64::from(k) / 6.0);
        let shares = [1, 2, 3, 4, 5].map(|k| at(k) / at(k + 1));
        for k in 0..=30 {
            let u = f64::from(k) / 30.0;
            assert!((along(&shares, 6.0 * u) - law(u)).abs() < 1e-12, "{u}");
        }
        for shares in [
            [0.0, 0.1, 0.9, 0.5, 1.0],
            [0.05, 1.0, 1.0, 0.0, 0.3],
            [0.5; 5],
            [0.9, 0.95, 0.2, 0.99, 0.4],
        ] {
            let values: Vec<f64> = (0..700).map(|k| along(&shares, 0.01 * f64::from(k))).collect();
            let rises = |pair: &[f64]| pair[1] >= pair[0] - 1e-12;
            assert!(values.windows(2).all(rises), "{shares:?}");
        }
    }
}
