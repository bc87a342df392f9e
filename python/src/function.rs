//! Effects that a user writes as functions of Python.
//!
//! A function is called for every interval of a simulation, with the interpreter taken for the
//! call: some hundred times the cost of an effect of the catalogue. One of the signal alone is
//! called once for each level of the input.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use tauscope::effect::{
    Effect, InputChange, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED,
};

use crate::TauscopeError;

/// An effect that is a function of Python. It is never freed, as are all effects: a model may go
/// wherever it likes.
#[pyclass(frozen, module = "tauscope")]
pub(crate) struct Function(&'static Called);

struct Called {
    spec: &'static Spec,
    function: Py<PyAny>,
    /// What it is called with, in the order of its arguments.
    arguments: Vec<Argument>,
    /// Where a fit of each parameter starts.
    starts: Vec<f64>,
    /// The least and the largest value with which it is called, of each parameter.
    limits: Vec<(f64, f64)>,
    /// Where its states start; as the signal where there is no number.
    states: Vec<Option<f64>>,
    nests: bool,
    /// The first exception that it raised; it is not called any more then.
    raised: Mutex<Option<PyErr>>,
    has_raised: AtomicBool,
}

/// What an argument of a function is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Argument {
    Signal(Signal),
    /// The parameter with this index.
    Parameter(usize),
    /// The state with this index.
    State(usize),
}

/// What a function may see.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Signal {
    Incoming,
    Position,
    Velocity,
    Time,
    Interval,
    Others,
    Radians,
    Before,
    After,
    Held,
}

/// What functions see, by the names of their arguments.
const MOMENT: [(&str, Signal); 7] = [
    ("signal", Signal::Incoming),
    ("position", Signal::Position),
    ("velocity", Signal::Velocity),
    ("time", Signal::Time),
    ("dt", Signal::Interval),
    ("others", Signal::Others),
    ("radians", Signal::Radians),
];

/// What functions of the transport stage see, by the names of their arguments.
const CHANGE: [(&str, Signal); 4] = [
    ("before", Signal::Before),
    ("after", Signal::After),
    ("held", Signal::Held),
    ("time", Signal::Time),
];

/// A parameter as it comes from Python: its name, its value, its limits, its neutral value.
type Given = (String, f64, Option<f64>, Option<f64>, f64);

#[pymethods]
impl Function {
    /// The effect `id` of `stage` that calls `function` with the arguments of these names, those
    /// of `parameters` and `states` among them. A state starts as the number after its name, or as
    /// the signal.
    #[new]
    fn new(
        id: &str,
        stage: &str,
        function: Py<PyAny>,
        arguments: Vec<String>,
        parameters: Vec<Given>,
        states: Vec<(String, Option<f64>)>,
    ) -> PyResult<Self> {
        let refused = |why: String| TauscopeError::new_err(format!("effect `{id}`: {why}"));
        let known = Stage::ALL.into_iter().find(|known| known.id() == stage);
        let stage = known.ok_or_else(|| {
            refused(format!("`{stage}` is no stage: input, transport, dynamics, load or output"))
        })?;
        let names: Vec<&str> = arguments.iter().map(String::as_str).collect();
        if tauscope::effect::by_id(id).is_some() {
            return Err(refused("the catalogue has one of this name; choose another".to_owned()));
        }
        if stage == Stage::Transport && !states.is_empty() {
            return Err(refused("in the stage `transport` there are no states".to_owned()));
        }
        let arguments = names.iter().map(|name| argument(name, stage, &parameters, &states));
        let arguments = arguments.collect::<Result<Vec<_>, _>>().map_err(refused)?;
        let starts = parameters.iter().map(|(_, value, ..)| *value).collect();
        let spec = spec(id, stage, &names, &parameters).memory(states.len());
        let spec: &'static Spec = Box::leak(Box::new(spec));
        let limit =
            |(_, _, min, max, _): &Given| (min.unwrap_or(-UNLIMITED), max.unwrap_or(UNLIMITED));
        let limits = parameters.iter().map(limit).collect();
        let states = states.into_iter().map(|(_, start)| start).collect();
        let (raised, has_raised) = (Mutex::new(None), AtomicBool::new(false));
        let mut called = Called {
            spec,
            function,
            arguments,
            starts,
            limits,
            states,
            nests: true,
            raised,
            has_raised,
        };
        called.nests = called.is_neutral_where_it_should_be();
        let called: &'static Called = Box::leak(Box::new(called));
        called.raised().map_or(Ok(Self(called)), Err)
    }

    /// Its name.
    #[getter]
    fn id(&self) -> &'static str {
        self.0.spec.id
    }
}

impl Function {
    pub(crate) fn effect(&self) -> &'static dyn Effect {
        self.0
    }

    /// The first of these that raised an exception raises it.
    pub(crate) fn check(functions: &[PyRef<'_, Self>]) -> PyResult<()> {
        functions.iter().find_map(|function| function.raised()).map_or(Ok(()), Err)
    }

    /// What it raised since it was last asked.
    pub(crate) fn raised(&self) -> Option<PyErr> {
        self.0.raised()
    }
}

/// What the argument `name` is to be.
fn argument(
    name: &str,
    stage: Stage,
    parameters: &[Given],
    states: &[(String, Option<f64>)],
) -> Result<Argument, String> {
    let signals = if stage == Stage::Transport { &CHANGE[..] } else { &MOMENT[..] };
    let signal = signals.iter().find(|(known, _)| *known == name);
    let parameter = parameters.iter().position(|(known, ..)| known == name);
    let remembered = states.iter().position(|(known, _)| known == name);
    match (signal, parameter, remembered) {
        (Some((_, signal)), None, None) => Ok(Argument::Signal(*signal)),
        (None, Some(index), None) => Ok(Argument::Parameter(index)),
        (None, None, Some(index)) => Ok(Argument::State(index)),
        (Some(_), ..) => {
            Err(format!("`{name}` is a signal, and no name for a parameter or a state"))
        }
        (None, Some(_), Some(_)) => Err(format!("`{name}` is a parameter and a state")),
        (None, None, None) => {
            let known: Vec<_> = signals.iter().map(|(known, _)| *known).collect();
            Err(format!(
                "its argument `{name}` is neither one of the signals {} nor a state nor a parameter \
                 with a value",
                known.join(", ")
            ))
        }
    }
}

/// A text that lives as long as the program.
fn leaked(text: &str) -> &'static str {
    Box::leak(text.to_owned().into_boxed_str())
}

fn spec(id: &str, stage: Stage, arguments: &[&str], parameters: &[Given]) -> Spec {
    let parameter = |(name, _, min, max, neutral): &Given| {
        let (min, max) = (min.unwrap_or(-UNLIMITED), max.unwrap_or(UNLIMITED));
        let dimension = tauscope::effect::Dimension::One;
        Parameter::new(leaked(name), "an argument of the function", dimension)
            .between(min.min(*neutral), max.max(*neutral))
            .neutral(*neutral)
    };
    let parameters: Vec<_> = parameters.iter().map(parameter).collect();
    Spec::new(leaked(id), stage, "a function of Python")
        .equation(leaked(&format!("out = {id}({})", arguments.join(", "))))
        .source("the model")
        .parameters(parameters.leak())
}

impl Called {
    /// What the function gives, or `unchanged` where that is no finite number; the states of `memory`
    /// become those that it gives after it.
    fn call(
        &self,
        unchanged: f64,
        (parameters, memory): (&[f64], &mut [f64]),
        signal: impl Fn(Signal) -> f64,
    ) -> f64 {
        if self.has_raised.load(Ordering::Relaxed) {
            return unchanged;
        }
        let value = |argument: &Argument| match argument {
            Argument::Signal(of) => signal(*of),
            Argument::Parameter(index) => {
                let value = parameters.get(*index).copied().unwrap_or_default();
                self.limits.get(*index).map_or(value, |(low, high)| value.clamp(*low, *high))
            }
            Argument::State(index) => memory.get(*index).copied().unwrap_or_default(),
        };
        let called = Python::attach(|py| {
            let arguments = PyTuple::new(py, self.arguments.iter().map(value))?;
            let given = self.function.call1(py, arguments)?;
            if self.states.is_empty() {
                return Ok((given.extract::<f64>(py)?, Vec::new()));
            }
            let mut given: Vec<f64> = given.extract(py)?;
            if given.len() != 1 + self.states.len() {
                let (id, count) = (self.spec.id, self.states.len());
                return Err(PyTypeError::new_err(format!(
                    "effect `{id}`: its function is to return the signal and {count} states, and \
                     returns {} numbers",
                    given.len()
                )));
            }
            let states = given.split_off(1);
            Ok((given.first().copied().unwrap_or(f64::NAN), states))
        });
        match called {
            Ok((value, states)) => {
                for (own, next) in
                    memory.iter_mut().zip(states).filter(|(_, next)| next.is_finite())
                {
                    *own = next;
                }
                if value.is_finite() { value } else { unchanged }
            }
            Err(error) => {
                let mut raised = self.raised.lock().unwrap_or_else(PoisonError::into_inner);
                raised.get_or_insert(error);
                self.has_raised.store(true, Ordering::Relaxed);
                unchanged
            }
        }
    }

    fn raised(&self) -> Option<PyErr> {
        let raised = self.raised.lock().unwrap_or_else(PoisonError::into_inner).take();
        self.has_raised.store(false, Ordering::Relaxed);
        raised
    }

    /// Whether the neutral values change nothing, at a handful of signals and places.
    fn is_neutral_where_it_should_be(&self) -> bool {
        /// Part of the signal, or of 1, that rounding may make.
        const TOLERANCE: f64 = 1e-9;
        let neutral = self.spec.neutral();
        let within = |(value, (low, high)): (&f64, &(f64, f64))| (*low..=*high).contains(value);
        if !neutral.iter().zip(&self.limits).all(within) {
            return false;
        }
        let mut memory = vec![0.0; self.states.len()];
        [0.0, 0.01, -0.7, 3.0, -45.0, 1000.0].into_iter().zip(1..).all(|(signal, k)| {
            let (position, time_s) = (17.0 * f64::from(k) - 50.0, 3.0 * f64::from(k));
            let velocity = 0.5 * signal;
            let at = Moment { position, velocity, time_s, others: 0.2, ..Moment::of(signal) };
            let change = InputChange { before: position, after: signal, held_s: at.dt_s, time_s };
            let (expected, found) = match self.spec.stage {
                Stage::Transport => (0.0, self.extra_delay_s(&neutral, &change)),
                _ => (signal, self.step(&neutral, &mut memory, &at)),
            };
            (found - expected).abs() <= TOLERANCE * expected.abs().max(1.0)
        })
    }

    fn sees(&self, signal: Signal) -> bool {
        self.arguments.contains(&Argument::Signal(signal))
    }
}

impl fmt::Debug for Called {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Called").field("id", &self.spec.id).finish_non_exhaustive()
    }
}

impl Effect for Called {
    fn spec(&self) -> &'static Spec {
        self.spec
    }

    fn settle(&self, _parameters: &[f64], memory: &mut [f64], at: &Moment) {
        for (state, start) in memory.iter_mut().zip(&self.states) {
            *state = start.unwrap_or(at.signal);
        }
    }

    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        if self.spec.stage == Stage::Transport {
            return at.signal;
        }
        self.call(at.signal, (parameters, memory), |signal| match signal {
            Signal::Incoming => at.signal,
            Signal::Position => at.position,
            Signal::Velocity => at.velocity,
            Signal::Time => at.time_s,
            Signal::Interval => at.dt_s,
            Signal::Others => at.others,
            Signal::Radians => at.radians_per_output_unit,
            Signal::Before | Signal::After | Signal::Held => f64::NAN,
        })
    }

    fn extra_delay_s(&self, parameters: &[f64], change: &InputChange) -> f64 {
        if self.spec.stage != Stage::Transport {
            return 0.0;
        }
        self.call(0.0, (parameters, &mut []), |signal| match signal {
            Signal::Before => change.before,
            Signal::After => change.after,
            Signal::Held => change.held_s,
            Signal::Time => change.time_s,
            _ => f64::NAN,
        })
    }

    fn nests(&self) -> bool {
        self.nests
    }

    /// A function of the signal alone is asked once for each level of the input.
    fn is_steady(&self) -> bool {
        let is_steady = |argument: &Argument| {
            matches!(argument, Argument::Signal(Signal::Incoming) | Argument::Parameter(_))
        };
        self.spec.stage != Stage::Transport && self.arguments.iter().all(is_steady)
    }

    fn depends_on_angle(&self) -> bool {
        matches!(self.spec.stage, Stage::Load | Stage::Output) || self.sees(Signal::Position)
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let start = |(start, parameter): (&f64, &Parameter)| {
            let is_away = (start - parameter.neutral).abs() > 0.0;
            if is_away { *start } else { parameter.start(record) }
        };
        vec![self.starts.iter().zip(self.spec.parameters).map(start).collect()]
    }
}
