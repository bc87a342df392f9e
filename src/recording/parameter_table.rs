//! The parameters of a model as a table of a page.

use std::fmt::Write as _;

use super::markdown::plain;
use crate::experiment::Joint;
use crate::fit::Assessment;
use crate::report::{DELAY_OF_STEPS, delay_of_steps, telling_parameters};
use crate::wording::parameter_value;

/// Writes what was fitted to `joint`, a row for each parameter.
pub(super) fn parameter_table(
    page: &mut String,
    joint: &Joint,
    fit: &Assessment,
) -> std::fmt::Result {
    writeln!(page, "| parameter | value ± standard error |\n|---|---|")?;
    for (parameter, unit) in telling_parameters(joint, fit) {
        let (name, value) = (plain(&parameter.name), parameter_value(parameter, &unit));
        writeln!(page, "| {name} | {} |", plain(&value))?;
    }
    if let Some(delays) = delay_of_steps(joint, &fit.model) {
        writeln!(page, "| {DELAY_OF_STEPS} | {delays} |")?;
    }
    Ok(())
}
