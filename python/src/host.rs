//! The interpreter as the host of commands: they run in a thread of their own, while the
//! calling thread looks out for Ctrl-C and says how far the work is.

use std::ffi::OsString;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use numpy::PyArray1;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use tauscope::cli::{Hosting, Refused, options_of, read_within, run_within};
use tauscope::effect::Effect;
use tauscope::experiment::{Experiment, ReadOptions};

use crate::TauscopeError;
use crate::arrays::{ArrayJoint, Logs, Table};
use crate::function::Function;
use crate::printed::Printed;

/// How often the calling thread looks up from its waiting.
const TICK: Duration = Duration::from_millis(50);

/// Stack of the thread that a command runs in, bytes: that of a main thread.
const STACK: usize = 8 << 20;

/// What a command and the thread that waits for it share.
#[derive(Default)]
struct Shared {
    logs: Mutex<Option<Logs>>,
    effects: Vec<&'static dyn Effect>,
    results: Printed,
    messages: Mutex<Vec<(String, String)>>,
    what: Mutex<String>,
    done: AtomicU64,
    of: AtomicU64,
    stopping: AtomicBool,
    ending: AtomicBool,
}

/// A lock is never held over anything that panics.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Hosting for Shared {
    fn logs(&self, options: &ReadOptions) -> Option<Experiment> {
        let logs = lock(&self.logs).take();
        logs.map(|logs| logs.experiment(options))
    }

    fn effects(&self) -> Vec<&'static dyn Effect> {
        self.effects.clone()
    }

    fn run_thread(&self, thread: &mut (dyn FnMut() + Send)) {
        if self.effects.is_empty() {
            thread();
        } else {
            // A thread that the interpreter knows takes it twenty times as fast.
            Python::attach(|py| py.detach(thread));
        }
    }

    fn print(&self, results: &[u8]) -> io::Result<()> {
        self.results.push(results)
    }

    fn say(&self, kind: &str, text: &str) {
        lock(&self.messages).push((kind.to_owned(), text.to_owned()));
    }

    fn progress(&self, what: &str, done: u64, of: u64) {
        what.clone_into(&mut lock(&self.what));
        self.done.store(done, Ordering::Relaxed);
        self.of.store(of, Ordering::Relaxed);
    }

    fn is_stopping(&self) -> bool {
        self.stopping.load(Ordering::Relaxed)
    }

    fn is_ending(&self) -> bool {
        self.ending.load(Ordering::Relaxed)
    }
}

/// Logs in memory, as Python passes them.
#[derive(FromPyObject)]
pub(crate) enum Given<'py> {
    #[pyo3(transparent)]
    Joints((Vec<ArrayJoint<'py>>, f64)),
    #[pyo3(transparent)]
    Tables(Vec<Table<'py>>),
}

fn given(logs: Option<Given<'_>>) -> PyResult<Option<Logs>> {
    Ok(match logs {
        None => None,
        Some(Given::Tables(tables)) => Some(Logs::of_tables(tables)),
        Some(Given::Joints((joints, period_s))) => Some(Logs::of_joints(joints, period_s)?),
    })
}

/// What a command gives: whether all was done, its results, its messages, and whether it was
/// stopped before its end.
type Answer = (bool, Printed, Vec<(String, String)>, bool);

/// Runs a command: `arguments` from its name on, `logs` in memory, `progress(what, done, of)`
/// called now and then. With `keeps` an interrupt stops it with what was reached. Models may
/// name the `functions`.
#[pyfunction]
#[pyo3(signature = (arguments, logs=None, progress=None, keeps=false, functions=Vec::new()))]
#[expect(clippy::fn_params_excessive_bools, reason = "a keyword argument of Python")]
pub(crate) fn run(
    py: Python<'_>,
    arguments: Vec<OsString>,
    logs: Option<Given<'_>>,
    progress: Option<Py<PyAny>>,
    keeps: bool,
    functions: Vec<PyRef<'_, Function>>,
) -> PyResult<Answer> {
    let effects = functions.iter().map(|function| function.effect()).collect();
    let shared = Arc::new(Shared { logs: Mutex::new(given(logs)?), effects, ..Shared::default() });
    let work = move |shared: Arc<Shared>| run_within(&arguments, shared);
    let interrupted = if keeps { Interrupted::KeepsResults } else { Interrupted::Ends };
    let done = waited(py, &shared, progress.as_ref(), interrupted, work);
    Function::check(&functions)?;
    let is_whole = done?;
    let messages = std::mem::take(&mut *lock(&shared.messages));
    Ok((is_whole, shared.results.take(), messages, shared.is_stopping()))
}

/// What becomes of work that a person interrupts.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Interrupted {
    /// It ends, and raises the interrupt.
    Ends,
    /// It stops at the next occasion, with what was reached; at a second interrupt it ends.
    KeepsResults,
}

/// Does `work` in a thread, the interpreter being free meanwhile.
fn waited<T: Send + 'static>(
    py: Python<'_>,
    shared: &Arc<Shared>,
    progress: Option<&Py<PyAny>>,
    interrupted: Interrupted,
    work: impl FnOnce(Arc<Shared>) -> Result<T, Refused> + Send + 'static,
) -> PyResult<T> {
    let keeps = interrupted == Interrupted::KeepsResults;
    let (sender, receiver) = sync_channel(1);
    let theirs = Arc::clone(shared);
    let thread = thread::Builder::new().stack_size(STACK).spawn(move || {
        // Nobody waits any more where this fails.
        sender.send(work(theirs)).unwrap_or_default();
    })?;
    let (result, interrupt) = py.detach(move || {
        let mut interrupt = None;
        loop {
            match receiver.recv_timeout(TICK) {
                Ok(result) => break (Some(result), interrupt),
                Err(RecvTimeoutError::Disconnected) => break (None, interrupt),
                Err(RecvTimeoutError::Timeout) => {
                    let looked = Python::attach(|py| look_up(py, shared, progress));
                    if let Err(error) = looked {
                        let is_first = interrupt.is_none();
                        shared.stopping.store(true, Ordering::Relaxed);
                        shared.ending.store(!(keeps && is_first), Ordering::Relaxed);
                        interrupt = Some(error);
                    }
                }
            }
        }
    });
    let result = result.ok_or_else(|| PyRuntimeError::new_err("the thread of the work is gone"))?;
    thread.join().unwrap_or_default();
    match (result, interrupt) {
        (Err(refused), Some(interrupt)) if refused.was_ended => Err(interrupt),
        (Ok(_), Some(interrupt)) if !keeps => Err(interrupt),
        (Err(refused), _) => Err(of_refused(py, refused)),
        (Ok(result), _) => Ok(result),
    }
}

/// Signals that came, and how far the work is.
fn look_up(py: Python<'_>, shared: &Shared, progress: Option<&Py<PyAny>>) -> PyResult<()> {
    py.check_signals()?;
    let Some(progress) = progress else { return Ok(()) };
    let what = lock(&shared.what).clone();
    let (done, of) = (shared.done.load(Ordering::Relaxed), shared.of.load(Ordering::Relaxed));
    progress.call1(py, (what, done, of))?;
    Ok(())
}

fn of_refused(py: Python<'_>, refused: Refused) -> PyErr {
    let message = without_usage(&refused.message).to_owned();
    placed(py, TauscopeError::new_err(message), refused.row, refused.column)
}

/// What is wrong with an option, without what only a terminal needs: its usage follows.
fn without_usage(message: &str) -> &str {
    let wrong = message.strip_prefix("error: ").and_then(|wrong| wrong.split("\n\n").next());
    wrong.unwrap_or(message)
}

/// `error` with the place in the log that it is about.
pub(crate) fn placed(
    py: Python<'_>,
    error: PyErr,
    row: Option<u64>,
    column: Option<String>,
) -> PyErr {
    let value = error.value(py);
    let set = value.setattr("row", row).and_then(|()| value.setattr("column", column));
    set.err().unwrap_or(error)
}

/// The options of a command: name, help, whether a value follows, whether it may be repeated.
#[pyfunction]
pub(crate) fn options(command: &str) -> Option<Vec<(String, String, bool, bool)>> {
    let options = options_of(command)?;
    let option = |option: tauscope::cli::CommandOption| {
        (option.name, option.help, option.takes_value, option.is_repeatable)
    };
    Some(options.into_iter().map(option).collect())
}

/// Reads logs: for each joint a dictionary, and what was said of them.
#[pyfunction]
#[pyo3(signature = (arguments, logs=None))]
pub(crate) fn read<'py>(
    py: Python<'py>,
    arguments: Vec<OsString>,
    logs: Option<Given<'py>>,
) -> PyResult<(Vec<Bound<'py, PyDict>>, Vec<String>)> {
    let shared = Arc::new(Shared { logs: Mutex::new(given(logs)?), ..Shared::default() });
    let work = move |shared: Arc<Shared>| read_within(&arguments, shared);
    let experiment = waited(py, &shared, None, Interrupted::Ends, work)?;
    let mut joints = Vec::new();
    for joint in &experiment.joints {
        let found = PyDict::new(py);
        found.set_item("joint", &joint.name)?;
        found.set_item("input_unit", &joint.input_unit)?;
        found.set_item("output_unit", &joint.output_unit)?;
        let mut trials = Vec::new();
        for trial in &joint.trials {
            let of = PyDict::new(py);
            of.set_item("trial", trial.label())?;
            of.set_item("start_s", trial.logged_time_s(1))?;
            of.set_item("sample_period", trial.period().seconds())?;
            of.set_item("input", PyArray1::from_slice(py, trial.input()))?;
            of.set_item("output", PyArray1::from_slice(py, trial.output()))?;
            for (signal, values) in joint.covariates.iter().zip(trial.covariates()) {
                of.set_item(&signal.name, PyArray1::from_slice(py, values))?;
            }
            trials.push(of);
        }
        found.set_item("trials", trials)?;
        joints.push(found);
    }
    let failures = experiment.failures.iter().map(|failure| failure.error.to_string());
    Ok((joints, experiment.notes.iter().cloned().chain(failures).collect()))
}
