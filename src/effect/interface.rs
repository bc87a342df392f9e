//! The trait that every effect implements.

use std::borrow::Cow;
use std::fmt::Debug;

use super::{Definition, InputChange, Moment, RecordRange, Spec, Stage, Start};

/// An effect, and the word in the labels of the trials in which it acts.
#[derive(Clone, Copy, Debug)]
pub struct WithinTrials<'a> {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// The word.
    pub word: &'a str,
}

/// One physical effect.
///
/// The caller passes as many parameters and numbers of memory as the [`Spec`] says;
/// with another number an effect returns the signal unchanged.
pub trait Effect: Debug + Send + Sync {
    /// What it is, where it acts, and its parameters.
    fn spec(&self) -> &'static Spec;

    /// What it does with these parameters, in a few words: the summary of its [`Spec`], less what
    /// parameters at their neutral values leave out.
    fn summary(&self, _parameters: &[f64]) -> Cow<'static, str> {
        self.spec().summary.into()
    }

    /// The signal after this effect; `at.signal` itself at the neutral parameters.
    ///
    /// Fresh memory is all zeros: at rest with no signal. In the stages of the
    /// spool and the dynamics the result is the mean of the effect's output over the interval `at.dt_s`, in which
    /// the signal is constant, and the memory then holds the state at its end. In the
    /// other stages it is the value at this moment.
    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64;

    /// Puts the memory into the state it has when `at.signal` has long been held.
    fn settle(&self, _parameters: &[f64], memory: &mut [f64], at: &Moment) {
        if let [first, others @ ..] = memory
            && self.spec().start == Start::Signal
        {
            *first = at.signal;
            others.fill(0.0);
        }
    }

    /// Seconds by which a change of the input arrives later than the joint's delay.
    ///
    /// May be negative; the caller keeps the whole delay at zero or above.
    fn extra_delay_s(&self, _parameters: &[f64], _change: &InputChange) -> f64 {
        0.0
    }

    /// Parameters with which each step's own delay, as it was measured, takes the place of the
    /// joint's; `None` where it has no such form.
    fn measured_delays(&self) -> Option<Vec<f64>> {
        None
    }

    /// Whether `parameters` are of that form.
    fn takes_measured_delays(&self, _parameters: &[f64]) -> bool {
        false
    }

    /// Whether the effect, over the range of `record`, has the feature after which it is named.
    ///
    /// A flow limit has it where the input passes the knee, a dead band where the input is held within
    /// it. Where that is not seen, the curve is one of several that bend alike, and the record does not
    /// tell which.
    fn shows_its_form(&self, _parameters: &[f64], _record: &RecordRange<'_>) -> bool {
        true
    }

    /// Whether it has neutral parameters, at which it changes nothing.
    ///
    /// If not, a model with it and the same without are not nested: one is not a special
    /// case of the other.
    fn nests(&self) -> bool {
        true
    }

    /// Whether it is [steady](Spec::is_steady).
    fn is_steady(&self) -> bool {
        self.spec().is_steady
    }

    /// Whether a joint with it moves otherwise from another angle.
    ///
    /// A fit need not find the angle at which a record starts where nothing depends on it.
    fn depends_on_angle(&self) -> bool {
        matches!(self.spec().stage, Stage::Load | Stage::Output)
    }

    /// Whether a joint with it moves otherwise while other joints move.
    ///
    /// A record of one joint alone cannot show such an effect.
    fn depends_on_others(&self) -> bool {
        false
    }

    /// The name of the measured signal on which it depends, where it does on one.
    ///
    /// A record without that signal cannot show it; there it does nothing.
    fn measured_signal(&self) -> Option<&str> {
        None
    }

    /// Whether a joint with it moves otherwise when the machine has worked for a while.
    fn depends_on_warmth(&self) -> bool {
        false
    }

    /// Whether what it does is set by the steps of the input.
    ///
    /// A record whose input moves all the time has no steps.
    fn depends_on_steps(&self) -> bool {
        false
    }

    /// The effect that it is in the trials of one condition, where it belongs to such alone. A
    /// simulation of any other trial is one without it.
    fn within_trials(&self) -> Option<WithinTrials<'_>> {
        None
    }

    /// How a model file defines it, where it is not an effect of the program.
    fn definition(&self) -> Option<&Definition> {
        None
    }

    /// What is wrong with parameters each of which is allowed by itself, for messages.
    fn fault(&self, _parameters: &[f64]) -> Option<&'static str> {
        None
    }

    /// Lowest and highest value of each parameter that a fit to `record` should try.
    ///
    /// They lie within those of the [`Spec`]; the neutral value may lie outside, where
    /// a value at the bound has no effect on this record either.
    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        self.spec().parameters.iter().map(|parameter| parameter.bounds(record)).collect()
    }

    /// Parameters from which a fit to `record` may find the best ones.
    ///
    /// Several where the error has several valleys. They need not keep the bounds; a fit
    /// takes [`starts`](Self::starts).
    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        vec![self.spec().parameters.iter().map(|parameter| parameter.start(record)).collect()]
    }

    /// Values of one of its parameters that a fit tries besides a descent, which crosses no jump: one
    /// between each two at which the effect does otherwise at some level of the input, ascending.
    ///
    /// None where it does not jump. A threshold needs none: it jumps at the levels themselves.
    fn jumps(&self, _parameter: usize, _record: &RecordRange<'_>) -> Vec<f64> {
        Vec::new()
    }

    /// Parameters with which it does about what the effect `other` does with `values`, in whose
    /// place a fit then tries it from there, too; `None` where they have nothing in common.
    fn in_place_of(&self, _other: &Spec, _values: &[f64]) -> Option<Vec<f64>> {
        None
    }

    /// Where a fit to `record` should start: the [`guesses`](Self::guesses), each value
    /// moved into its [`bounds`](Self::bounds).
    fn starts(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let bounds = self.bounds(record);
        let mut starts = self.guesses(record);
        for start in &mut starts {
            for (value, (low, high)) in start.iter_mut().zip(&bounds) {
                *value = value.max(*low).min(*high);
            }
        }
        starts
    }
}
