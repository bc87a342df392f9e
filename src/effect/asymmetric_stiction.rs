//! Stiction of the valve with thresholds by direction: its two edges stick differently.
//!
//! ```text
//! out = in   while it moves,   0   while it sticks
//! sticks → moves   when in > positive_start or in < −negative_start
//! moves → sticks   when |in| < stop of its direction or the sign of in turns
//! ```
//!
//! With equal thresholds it is [`Stiction`]; a spool with two edges, or a cylinder with seals that
//! are pressed on by the load, has a pair of its own for each direction.
//!
//! # References
//! Armstrong-Hélouvry, B., Dupont, P., and Canudas de Wit, C., 1994, A survey of models,
//! analysis tools and compensation methods for the control of machines with friction,
//! Automatica 30.

use super::{
    Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, Stiction, UNLIMITED,
};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct AsymmetricStiction;

static SPEC: Spec = Spec::new(
    "asymmetric_stiction",
    Stage::Input,
    "stiction whose levels differ by direction",
)
.equation(
    "out = in while moving, else 0; starts at in > positive_start or in < -negative_start, stops \
     at in < positive_stop or in > -negative_stop",
)
.source(
    "Armstrong-Hélouvry, Dupont and Canudas de Wit, 1994, A survey of models, analysis \
             tools and compensation methods for the control of machines with friction, \
             Automatica 30",
)
.parameters(&[
    level("positive_start", "positive level above which it starts to move"),
    level("positive_stop", "positive level below which it stops, at most `positive_start`"),
    level("negative_start", "size of the negative level above which it starts to move"),
    level("negative_stop", "size of that below which it stops, at most `negative_start`"),
])
.memory(1)
.confused_with(&["stiction", "dead_band", "coulomb_friction"])
.absorbing(&["stiction"])
.refining("stiction")
.steady()
.equations(
    Equations::new(&["start = if(signal < 0, negative_start, positive_start)
             stop = if(signal < 0, negative_stop, positive_stop)
             goes_on = signal * direction > 0 && abs(signal) >= min(stop, start)
             moves = goes_on || abs(signal) > start
             direction = if(moves, sign(signal), 0)
             out = if(moves, signal, 0)"])
    .remembering(
        &["direction"],
        "start = if(signal < 0, negative_start, positive_start)
             direction = if(abs(signal) > start, sign(signal), 0)",
    ),
);

const fn level(name: &'static str, meaning: &'static str) -> Parameter {
    Parameter::new(name, meaning, Dimension::Input).between(0.0, UNLIMITED)
}

impl Effect for AsymmetricStiction {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    /// As a [`Stiction`] with the levels of the direction of the signal.
    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        let &[positive_start, positive_stop, negative_start, negative_stop] = parameters else {
            return at.signal;
        };
        let levels = if at.signal < 0.0 {
            [negative_start, negative_stop]
        } else {
            [positive_start, positive_stop]
        };
        Stiction.step(&levels, memory, at)
    }

    fn settle(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) {
        memory.fill(0.0);
        self.step(parameters, memory, at);
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let symmetric = |both: Vec<f64>| [both.as_slice(), &both].concat();
        Stiction.guesses(record).into_iter().map(symmetric).collect()
    }

    /// A stiction is one with the same levels both ways.
    fn in_place_of(&self, other: &Spec, values: &[f64]) -> Option<Vec<f64>> {
        match *values {
            [start, stop] if other.id == Stiction.spec().id => Some(vec![start, stop, start, stop]),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn each_direction_has_its_levels() {
        let inputs = [0.5, 0.7, 0.4, -0.4, -0.9, -0.4, -0.2, 0.5];
        let outputs = [0.0, 0.7, 0.4, 0.0, -0.9, -0.4, 0.0, 0.0];
        assert_close(&run(&AsymmetricStiction, &[0.6, 0.3, 0.8, 0.3], &inputs), &outputs);
    }

    #[test]
    fn with_the_same_levels_both_ways_it_is_a_stiction() {
        let inputs = [0.5, 0.7, 0.5, 0.3, 0.2, 0.5, -0.7, -0.3];
        let both = AsymmetricStiction.in_place_of(Stiction.spec(), &[0.6, 0.3]).unwrap();
        let plain = run(&Stiction, &[0.6, 0.3], &inputs);
        assert_close(&run(&AsymmetricStiction, &both, &inputs), &plain);
    }
}
