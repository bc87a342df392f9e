//! Oil column: a resonance whose period follows the angle, and that the open valve damps.
//!
//! ```text
//! x'' + 2 (damping + valve_damping |in|) ω x' + ω² x = ω² in
//! 2π / ω = period · max(1 + slope · (y − reference) + curvature · (y − reference)², 0.05)
//! ```
//!
//! The spring of a cylinder is the oil on both sides of its piston, softest near the middle
//! of the stroke, and it acts on the joint by a lever arm: both change with the angle `y`. A
//! closed valve leaves the swing to friction. An open one damps it, because oil flows out of
//! a chamber the faster the higher its pressure is; that flow goes with the opening, which is
//! the effective input. The parabola stands for the period within the angles of the record.
//! `reference` is a choice and not fitted: the middle of the record, so that the period is
//! known best.
//!
//! It contains [`Resonance`](super::Resonance), as the case in which neither matters, and is
//! looked for only where that is found: by itself a swing says that the oil is a spring, and
//! only the rest of it how the spring changes. Over an interval the swing is exact for
//! the angle in its middle.
//!
//! # References
//! Merritt, H. E., 1967, Hydraulic Control Systems (hydraulic natural frequency over the
//! stroke; damping by the valve's flow-pressure coefficient, which goes with its opening).

use std::f64::consts::TAU;

use super::resonance::{FITTED_DAMPING, PERIODS_S, SHORTEST_S};
use super::swing::{SWING, Swing};
use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct OilColumn;

static SPEC: Spec = Spec::new(
    "oil_column",
    Stage::Dynamics,
    "a resonance whose period follows the angle, damped by the open valve",
)
.equation(
    "d2 out/dt2 + 2 (damping + valve_damping abs(in)) w d out/dt + w^2 out = w^2 in, w = \
               2 pi / (period (1 + slope (y - reference) + curvature (y - reference)^2))",
)
.source("Merritt, 1967, Hydraulic Control Systems")
.parameters(&[
    Parameter::new("period", "period without damping, at `reference`", Dimension::Seconds)
        .between(0.0, UNLIMITED),
    Parameter::new("damping", "damping ratio with the valve closed", Dimension::One)
        .between(0.0, MOST_DAMPING)
        .neutral(1.0),
    Parameter::new(
        "valve_damping",
        "what one input unit of opening adds to it",
        Dimension::PerInput,
    )
    .between(0.0, UNLIMITED),
    Parameter::new("slope", "relative change of the period with the angle", Dimension::PerOutput),
    Parameter::new(
        "curvature",
        "relative change of the period with its square",
        Dimension::PerOutputSquared,
    ),
    Parameter::new("reference", "angle at which the period is `period`", Dimension::Output)
        .not_fitted(),
])
.memory(2)
.starting_at_signal()
.confused_with(&["resonance"])
.absorbing(&["resonance"])
.refining("resonance")
.equations(
    Equations::new(&[
        "away = position + 0.5 * dt * velocity - reference
             factor = 1 + away * (slope + curvature * away)
             here = period * min(max(factor, 0.05), 20)
             at_once = here < 1e-9
             omega = 2 * pi / max(here, 1e-9)
             ratio = min(damping + valve_damping * abs(signal), 10)\n",
        SWING,
    ])
    .remembering(&["state", "rate"], "state = signal\nrate = 0"),
);

/// Largest damping ratio: with more, nothing is left of the swing.
const MOST_DAMPING: f64 = 10.0;

/// Smallest and largest factor of the period, far outside of what a linkage does.
const FACTORS: (f64, f64) = (0.05, 20.0);

impl Effect for OilColumn {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    /// The memory is `x`, `x'` in input units per second.
    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        let (&[period, damping, valve_damping, slope, curvature, reference], [state, rate]) =
            (parameters, memory)
        else {
            return at.signal;
        };
        let middle = at.position + 0.5 * at.dt_s * at.velocity;
        let away = middle - reference;
        let factor = 1.0 + away * (slope + curvature * away);
        let period = period * factor.clamp(FACTORS.0, FACTORS.1);
        if period < SHORTEST_S {
            [*state, *rate] = [at.signal, 0.0];
            return at.signal;
        }
        let damping = (damping + valve_damping * at.signal.abs()).min(MOST_DAMPING);
        Swing::over(TAU / period, damping, at.dt_s).advance(at.signal, state, rate)
    }

    fn depends_on_angle(&self) -> bool {
        true
    }

    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        let mut bounds: Vec<_> = SPEC.parameters.iter().map(|each| each.bounds(record)).collect();
        if let [_, damping, ..] = bounds.as_mut_slice() {
            *damping = FITTED_DAMPING;
        }
        bounds
    }

    /// As those of a resonance, with as much damping by the valve at its widest as without.
    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let shortest = 4.0 * record.sample_period_s;
        let by_valve = 0.2 * record.size(Dimension::PerInput);
        let guess = |period: f64| {
            vec![period.max(shortest), 0.1, by_valve, 0.0, 0.0, record.output_middle()]
        };
        PERIODS_S.map(guess).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, moment};
    use super::super::{Resonance, swing::SWING_MEMORY};
    use super::*;

    const DT_S: f64 = 0.02;

    /// The output, and the state after it.
    fn step_response(parameters: &[f64; 6], signal: f64, position: f64) -> [f64; 3] {
        let mut memory = [0.0; 2];
        let at = Moment { dt_s: DT_S, position, ..moment(signal) };
        let mean = OilColumn.step(parameters, &mut memory, &at);
        [mean, memory[0], memory[1]]
    }

    fn of_resonance(parameters: &[f64; 2], signal: f64) -> [f64; 3] {
        let mut memory = [0.0; 2 + SWING_MEMORY];
        let at = Moment { dt_s: DT_S, ..moment(signal) };
        let mean = Resonance.step(parameters, &mut memory, &at);
        [mean, memory[0], memory[1]]
    }

    #[test]
    fn the_valve_damps_by_its_opening_either_way() {
        let parameters = [0.2, 0.1, 0.05, 0.0, 0.0, 5.0];
        for signal in [4.0, -4.0] {
            let expected = of_resonance(&[0.2, 0.3], signal);
            assert_close(&step_response(&parameters, signal, 40.0), &expected);
        }
    }

    #[test]
    fn the_period_is_a_parabola_over_the_angle_with_a_floor() {
        let parameters = [0.2, 0.1, 0.0, 0.01, -0.0001, 5.0];
        for (position, period) in [(5.0, 0.2), (25.0, 0.232), (-200.0, 0.01)] {
            let expected = of_resonance(&[period, 0.1], 2.0);
            assert_close(&step_response(&parameters, 2.0, position), &expected);
        }
    }
}
