//! Stiction of the valve: it starts above one level and stops below a lower one.
//!
//! ```text
//! out = in   while it moves,   0   while it sticks
//! sticks → moves   when |in| > start
//! moves → sticks   when |in| < stop or the sign of in turns,   0 ≤ stop ≤ start
//! ```
//!
//! ```text
#![doc = include_str!("drawing/stiction.txt")]
//! ```
//!
//! A `stop` above `start` acts as `start`. An input that turns its sign at a level above
//! `start` moves on at once. It is a switch: as a function of its parameters the output
//! jumps, and an input held at few levels only shows between which levels they lie. A
//! fit starts once in each of these gaps, and its result holds for the whole gap.
//!
//! # References
//! Armstrong-Hélouvry, B., Dupont, P., and Canudas de Wit, C., 1994, A survey of models,
//! analysis tools and compensation methods for the control of machines with friction,
//! Automatica 30.

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct Stiction;

static SPEC: Spec = Spec::new(
    "stiction",
    Stage::Input,
    "starts above one level of the input, stops below a lower one",
)
.equation(
    "out = in while moving, else 0; starts at abs(in) > start, stops at abs(in) < stop or where in \
             changes its sign",
)
.source(
    "Armstrong-Hélouvry, Dupont and Canudas de Wit, 1994, A survey of models, analysis \
             tools and compensation methods for the control of machines with friction, \
             Automatica 30",
)
.drawing(include_str!("drawing/stiction.txt"))
.parameters(&[
    Parameter::new("start", "level above which it starts to move", Dimension::Input)
        .between(0.0, UNLIMITED),
    Parameter::new("stop", "level below which it stops, at most `start`", Dimension::Input)
        .between(0.0, UNLIMITED),
])
.memory(1)
.confused_with(&["dead_band", "coulomb_friction"])
.steady()
.equations(
    Equations::new(&["goes_on = signal * direction > 0 && abs(signal) >= min(stop, start)
             moves = goes_on || abs(signal) > start
             direction = if(moves, sign(signal), 0)
             out = if(moves, signal, 0)"])
    .remembering(&["direction"], "direction = if(abs(signal) > start, sign(signal), 0)"),
);

/// Gaps between input levels in which a fit starts.
const GAPS: usize = 4;

impl Effect for Stiction {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    /// The memory is the direction of motion: −1, 0 or 1.
    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        let (&[start, stop], [direction]) = (parameters, memory) else { return at.signal };
        let goes_on = at.signal * *direction > 0.0 && at.signal.abs() >= stop.min(start);
        if goes_on || at.signal.abs() > start {
            *direction = at.signal.signum();
            at.signal
        } else {
            *direction = 0.0;
            0.0
        }
    }

    fn settle(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) {
        memory.fill(0.0);
        self.step(parameters, memory, at);
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let gaps = record.thresholds(GAPS);
        let pair = |start: f64| {
            let stops = gaps.iter().filter(move |stop| **stop <= start);
            stops.map(move |stop| vec![start, *stop])
        };
        gaps.iter().copied().flat_map(pair).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn starts_high_and_stops_low() {
        let inputs = [0.5, 0.7, 0.5, 0.3, 0.2, 0.5, -0.7, -0.3];
        let outputs = [0.0, 0.7, 0.5, 0.3, 0.0, 0.0, -0.7, -0.3];
        assert_close(&run(&Stiction, &[0.6, 0.3], &inputs), &outputs);
    }

    #[test]
    fn a_turn_below_the_start_sticks_and_one_above_it_moves_on() {
        assert_close(&run(&Stiction, &[0.6, 0.3], &[1.0, -0.5, 1.0, -1.0]), &[1.0, 0.0, 1.0, -1.0]);
    }

    #[test]
    fn a_stop_above_the_start_acts_as_the_start() {
        assert_close(&run(&Stiction, &[0.6, 5.0], &[0.7, 0.65, 0.5]), &[0.7, 0.65, 0.0]);
    }

    #[test]
    fn a_fit_starts_at_every_pair_of_gaps() {
        let levels = [1.0, 2.0];
        let record =
            RecordRange { input_levels: &levels, input_abs_max: 2.0, ..RecordRange::default() };
        assert_eq!(Stiction.starts(&record), [[0.5, 0.5], [1.5, 0.5], [1.5, 1.5]]);
    }
}
