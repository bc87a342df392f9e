//! The parameters of a model as a table of a page.

use std::fmt::Write as _;

use super::markdown::plain;
use crate::experiment::Joint;
use crate::fit::AssessedModel;
use crate::report::{delay_of_steps, telling_parameters};
use crate::wording::parameter_value;

/// Writes what was fitted to `joint`, a row for each parameter.
pub(super) fn parameter_table(
    page: &mut String,
    joint: &Joint,
    fit: &AssessedModel,
) -> std::fmt::Result {
    writeln!(page, "| parameter | value ± standard error |\n|---|---|")?;
    let delays = delay_of_steps(joint, &fit.model);
    for (parameter, unit) in telling_parameters(joint, fit) {
        let (name, value) = (plain(&parameter.name), parameter_value(parameter, &unit));
        // Beside a law it is that of a step of no size, which may be none of the record. In short
        // words: the values are beside the widest name in a narrow panel.
        let delays = delays.as_ref().filter(|_| name == "delay");
        let of = if delays.is_some() { ", step of size 0" } else { "" };
        if let Some(delays) = delays {
            writeln!(page, "| delay of the steps | {delays} |")?;
        }
        writeln!(page, "| {name}{of} | {} |", plain(&value))?;
    }
    Ok(())
}
