//! tauscope for Python: commands run inside the interpreter, on logs in files or in memory.
//!
//! What is here takes numbers from NumPy and hands back text and numbers; the objects that a
//! user sees are made of them in Python, in `python/tauscope`.

mod arrays;
mod frame;
mod function;
mod host;
mod model;
mod printed;

use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

create_exception!(
    tauscope,
    TauscopeError,
    PyValueError,
    "What tauscope cannot use. `row` and `column` say where in the log, or are None."
);

/// The native part of the package.
#[pymodule]
fn _tauscope(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("TauscopeError", module.py().get_type::<TauscopeError>())?;
    module.add_class::<frame::Frame>()?;
    module.add_class::<function::Function>()?;
    module.add_class::<printed::Printed>()?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("HAS_RECORDINGS", cfg!(feature = "recordings"))?;
    module.add_function(wrap_pyfunction!(host::run, module)?)?;
    module.add_function(wrap_pyfunction!(host::options, module)?)?;
    module.add_function(wrap_pyfunction!(host::read, module)?)?;
    module.add_function(wrap_pyfunction!(model::check, module)?)?;
    module.add_function(wrap_pyfunction!(model::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(model::describe, module)?)?;
    module.add_function(wrap_pyfunction!(model::refitted, module)?)
}
