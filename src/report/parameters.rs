//! The parameters of a model, and the equation of an effect.

use serde_json::{Map, Value, json};

use super::TextTable;
use crate::diagnosis::Comparison;
use crate::effect::Stage;
use crate::experiment::{Joint, Trial};
use crate::fit::{AssessedModel, Parameter, Status, starts_s};
use crate::model::{Commands, Component, JointModel};
use crate::wording::{parameter_units, parameter_value, range_text};

/// A model as lines of a terminal: gain and delay, then a line for each effect. `called` is its name
/// where there are others of the joint.
///
/// ```text
/// model of boom (converged):
///   gain 7.4989 ± 0.0017 deg/s/V, delay 0.12969 ± 0.00017 s
///   dead_band: lower -0.41 ± 0.012 V, upper 0.38 ± 0.011 V
/// ```
pub(super) fn model_text(joint: &Joint, comparison: &Comparison, called: Option<&str>) -> String {
    let Comparison { fit, termination, .. } = comparison;
    let called = called.map_or_else(String::new, |called| format!("{called}; "));
    let mut lines = vec![format!("model of {} ({called}{termination}):", joint.name)];
    let of_steps = delay_of_steps(joint, &fit.model);
    let said = |(parameter, unit): (&Parameter, String)| {
        let value = parameter_value(parameter, &unit);
        match (parameter.name.rsplit_once('.'), &of_steps) {
            (Some((effect, name)), _) => (format!("{effect}: "), format!("{name} {value}")),
            (None, Some(of_steps)) if parameter.name == "delay" => {
                (String::new(), format!("delay of the steps {of_steps} (constant part {value})"))
            }
            (None, _) => (String::new(), format!("{} {value}", parameter.name)),
        }
    };
    let said: Vec<_> = telling_parameters(joint, fit).map(said).collect();
    for of_effect in said.chunk_by(|(one, _), (other, _)| one == other) {
        let effect = of_effect.first().map_or("", |(effect, _)| effect);
        let values: Vec<_> = of_effect.iter().map(|(_, value)| value.as_str()).collect();
        lines.push(format!("  {effect}{}", values.join(", ")));
    }
    lines.join("\n")
}

/// The parameters of a model as a table: a row for each that says something.
pub(crate) fn parameter_table(joint: &Joint, fit: &AssessedModel) -> TextTable {
    let delays = delay_of_steps(joint, &fit.model);
    let mut table = TextTable::new(["parameter", "value ± standard error"], &[]);
    for (parameter, unit) in telling_parameters(joint, fit) {
        let (name, value) = (&parameter.name, parameter_value(parameter, &unit));
        // Beside a law it is that of a step of no size, which may be none of the record.
        let delays = delays.as_ref().filter(|_| name == "delay");
        let of = if delays.is_some() { ", step of size 0" } else { "" };
        if let Some(delays) = delays {
            table.row(["delay of the steps".to_owned(), delays.clone()]);
        }
        table.row([format!("{name}{of}"), value]);
    }
    table
}

/// Parameters by name, with their standard errors and units.
pub(super) fn parameters_json(joint: &Joint, fit: &AssessedModel) -> Map<String, Value> {
    let parameter = |(parameter, unit): (&Parameter, String)| {
        let Parameter { name, value, std_error, status } = parameter;
        let value = json!({
            "value": value, "std_error": std_error, "unit": unit, "status": status,
        });
        (name.clone(), value)
    };
    fit.parameters.iter().zip(parameter_units(joint, &fit.model)).map(parameter).collect()
}

/// Which delays a law gives to the steps of the record: those of its parameters are of a step of
/// no size.
pub(crate) fn delay_of_steps(joint: &Joint, model: &JointModel) -> Option<String> {
    /// An input that changes more often is not made of steps: its changes have no size of their own.
    const SAMPLES_PER_STEP: usize = 5;
    let is_law = |component: &Component| component.effect().spec().stage == Stage::Transport;
    if !model.components().iter().any(is_law) {
        return None;
    }
    if model.takes_measured_delays() {
        return Some("as measured at each".to_owned());
    }
    let mut delays_s = Vec::new();
    for (trial, start_s) in joint.trials.iter().zip(starts_s(&joint.trials)) {
        let model = model.in_trial(trial.label());
        let commands = Commands::new(trial.input(), trial.period().seconds());
        delays_s.extend(commands.changes(start_s).map(|change| model.delay_s(&change)));
    }
    let samples: usize = joint.trials.iter().map(Trial::len).sum();
    if delays_s.is_empty() || delays_s.len() * SAMPLES_PER_STEP > samples {
        return None;
    }
    Some(range_text(delays_s.into_iter(), Some("s")))
}

/// The parameters of a model with their units, without those that say nothing: held where they do
/// nothing.
pub(super) fn telling_parameters<'a>(
    joint: &Joint,
    fit: &'a AssessedModel,
) -> impl Iterator<Item = (&'a Parameter, String)> + use<'a> {
    let units = parameter_units(joint, &fit.model);
    let known = fit.parameters.iter().zip(units).zip(neutrals(&fit.model));
    let says = |((parameter, _), neutral): &((&Parameter, String), Option<f64>)| {
        parameter.status != Status::Fixed || *neutral != Some(parameter.value)
    };
    known.filter(says).map(|(known, _)| known)
}

/// The value of each parameter of `model` at which it does nothing; gain and delay have none.
fn neutrals(model: &JointModel) -> impl Iterator<Item = Option<f64>> + '_ {
    let parameters = model.components().iter().flat_map(|part| part.effect().spec().parameters);
    [None, None].into_iter().chain(parameters.map(|parameter| Some(parameter.neutral)))
}

/// The equation of `component`; in words where it takes measured delays.
pub(super) fn equation(component: &Component) -> &'static str {
    if component.takes_measured_delays() {
        "each step has its measured delay"
    } else {
        component.effect().spec().equation
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::REGISTRY;

    #[test]
    fn every_fitted_parameter_of_the_catalogue_is_in_its_equation() {
        for effect in REGISTRY {
            let spec = effect.spec();
            for parameter in spec.parameters.iter().filter(|parameter| parameter.fitted) {
                let is_in = spec.equation.contains(parameter.name);
                assert!(is_in, "{}.{}", spec.id, parameter.name);
            }
        }
    }
}
