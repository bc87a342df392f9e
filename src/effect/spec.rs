//! What an effect says about itself, as data.

use serde::Serialize;

use super::{Equations, Parameter, Stage};

/// What an effect is, where it acts, and its parameters.
///
/// # Examples
/// ```
/// use tauscope::effect::{Dimension, Parameter, Spec, Stage};
///
/// static LOSS: Spec = Spec::new("hose", Stage::Load, "a hose that swells")
///     .equation("out = in / (1 + loss abs(in))")
///     .source("made up for this example")
///     .parameters(&[Parameter::new("loss", "part lost", Dimension::One).between(0.0, 1.0)]);
/// assert_eq!(LOSS.neutral(), [0.0]);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spec {
    /// Its name in files and on the command line, in snake case.
    pub id: &'static str,
    /// What it is, in one sentence without a full stop.
    pub summary: &'static str,
    /// Its equation in one line, with the names of the parameters.
    pub equation: &'static str,
    /// Where the equation comes from: author, year, title.
    pub source: &'static str,
    /// Where it acts.
    pub stage: Stage,
    /// The shape of a nonlinearity, in plain text.
    pub drawing: Option<&'static str>,
    /// Its parameters, in the order [`step`](super::Effect::step) takes them.
    pub parameters: &'static [Parameter],
    /// How many numbers it remembers.
    pub memory: usize,
    /// What it remembers where the signal was long held.
    #[serde(skip)]
    pub start: Start,
    /// How fast what it remembers changes.
    #[serde(skip)]
    pub pace: Pace,
    /// Ids of effects that look alike in a record.
    pub confused_with: &'static [&'static str],
    /// Ids of effects that it contains: to add it to a model is to put it in their
    /// place, with their values for the parameters of the same name.
    pub absorbs: &'static [&'static str],
    /// Ids of pairs of effects that look like it together: where one fits better, it takes its
    /// place.
    #[serde(skip)]
    pub looks_like_both: &'static [[&'static str; 2]],
    /// Ids of effects of its stage before which it may act, though it was added after them.
    #[serde(skip)]
    pub upstream_of: &'static [&'static str],
    /// Id of an effect of which it is a finer form: where that is looked for, too, this one is
    /// only in models that have that.
    pub refines: Option<&'static str>,
    /// What it is, exactly, where one of its parameters is 0: a record that does not show that parameter
    /// shows no more than this.
    #[serde(skip)]
    pub limiting_case: Option<LimitingCase>,
    /// Whether it follows a curve of any form, so that a search names it only where no effect with a
    /// law explains the record.
    #[serde(skip)]
    pub is_free_form: bool,
    /// Whether its signal depends on [`Moment::signal`](super::Moment::signal) and its memory alone,
    /// and does not change while that is held: a simulation then asks it once for each level of the
    /// input.
    #[serde(skip)]
    pub is_steady: bool,
    /// What it does, as text of which other languages can be made: the same as its
    /// [`settle`](super::Effect::settle), [`step`](super::Effect::step) and
    /// [`extra_delay_s`](super::Effect::extra_delay_s). `None` where it cannot leave the program.
    #[serde(skip)]
    pub equations: Option<Equations>,
    /// Whether an effect on the output changes where the joint is, and not only what
    /// is measured of it.
    pub acts_on_state: bool,
}

/// What an effect remembers where the signal was long held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// What its [`settle`](super::Effect::settle) says.
    Own,
    /// The signal, and then zeros.
    Signal,
}

/// How fast what an effect remembers changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// As fast as the speed of the joint: it is known where that is.
    OfSpeed,
    /// More slowly: of it the speed of now says nothing, and a simulation that goes on from a measured
    /// speed keeps it.
    Slower,
}

/// What an effect is where one of its parameters is 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LimitingCase {
    /// The name of the parameter.
    pub parameter: &'static str,
    /// Ids of the effects that are the same together.
    pub effects: &'static [&'static str],
}

impl Spec {
    /// An effect without parameters, memory or relatives.
    pub const fn new(id: &'static str, stage: Stage, summary: &'static str) -> Self {
        Self {
            id,
            summary,
            equation: "",
            source: "",
            stage,
            drawing: None,
            parameters: &[],
            memory: 0,
            start: Start::Own,
            pace: Pace::OfSpeed,
            confused_with: &[],
            absorbs: &[],
            looks_like_both: &[],
            upstream_of: &[],
            refines: None,
            limiting_case: None,
            is_free_form: false,
            is_steady: false,
            equations: None,
            acts_on_state: false,
        }
    }

    /// With this [`equation`](Self::equation).
    #[must_use]
    pub const fn equation(self, equation: &'static str) -> Self {
        Self { equation, ..self }
    }

    /// With this [`source`](Self::source).
    #[must_use]
    pub const fn source(self, source: &'static str) -> Self {
        Self { source, ..self }
    }

    /// With this [`drawing`](Self::drawing).
    #[must_use]
    pub const fn drawing(self, drawing: &'static str) -> Self {
        Self { drawing: Some(drawing), ..self }
    }

    /// With these [`parameters`](Self::parameters).
    #[must_use]
    pub const fn parameters(self, parameters: &'static [Parameter]) -> Self {
        Self { parameters, ..self }
    }

    /// With this much [`memory`](Self::memory).
    #[must_use]
    pub const fn memory(self, memory: usize) -> Self {
        Self { memory, ..self }
    }

    /// Its memory [starts](Self::start) at the signal.
    #[must_use]
    pub const fn starting_at_signal(self) -> Self {
        Self { start: Start::Signal, ..self }
    }

    /// What it remembers [changes more slowly](Pace::Slower) than the speed.
    #[must_use]
    pub const fn slower_than_speed(self) -> Self {
        Self { pace: Pace::Slower, ..self }
    }

    /// [Confused](Self::confused_with) with these.
    #[must_use]
    pub const fn confused_with(self, confused_with: &'static [&'static str]) -> Self {
        Self { confused_with, ..self }
    }

    /// It [absorbs](Self::absorbs) these.
    #[must_use]
    pub const fn absorbing(self, absorbs: &'static [&'static str]) -> Self {
        Self { absorbs, ..self }
    }

    /// It [looks like](Self::looks_like_both) each of these pairs.
    #[must_use]
    pub const fn looking_like_both(self, pairs: &'static [[&'static str; 2]]) -> Self {
        Self { looks_like_both: pairs, ..self }
    }

    /// It may act [before](Self::upstream_of) these.
    #[must_use]
    pub const fn upstream_of(self, upstream_of: &'static [&'static str]) -> Self {
        Self { upstream_of, ..self }
    }

    /// It [refines](Self::refines) this one.
    #[must_use]
    pub const fn refining(self, coarser: &'static str) -> Self {
        Self { refines: Some(coarser), ..self }
    }

    /// Where `parameter` is 0 it is all of these `effects` [together](Self::limiting_case).
    #[must_use]
    pub const fn limiting_case(
        self,
        parameter: &'static str,
        effects: &'static [&'static str],
    ) -> Self {
        Self { limiting_case: Some(LimitingCase { parameter, effects }), ..self }
    }

    /// It has a [free form](Self::is_free_form).
    #[must_use]
    pub const fn free_form(self) -> Self {
        Self { is_free_form: true, ..self }
    }

    /// It is [steady](Self::is_steady).
    #[must_use]
    pub const fn steady(self) -> Self {
        Self { is_steady: true, ..self }
    }

    /// With these [`equations`](Self::equations).
    #[must_use]
    pub const fn equations(self, equations: Equations) -> Self {
        Self { equations: Some(equations), ..self }
    }

    /// It [acts on the state](Self::acts_on_state).
    #[must_use]
    pub const fn acting_on_state(self) -> Self {
        Self { acts_on_state: true, ..self }
    }

    /// The neutral values of all parameters.
    pub fn neutral(&self) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.neutral).collect()
    }
}
