//! Tables for the terminal.

use super::doubt::doubtful_text;
use super::settings::{own_settings, settings_line};
use super::text_table::TextTable;
use super::warning::Scatter;
use super::{DelayRange, EstimatedJoint, Headline, JointSummary, dead_time_sentences};
use crate::delay::{Chosen, Condition, OnsetModel, Settings};
use crate::numerics::LowPass;
use crate::wording::{measure, percent, rounded};

/// The table of `estimate`: a row per joint, and the settings below it.
pub(crate) fn estimate_table(joints: &[EstimatedJoint<'_>], settings: &Settings) -> String {
    let table = summary_table(joints);
    let mut kinds = String::new();
    for joint in joints {
        let (name, summary) = (&joint.joint.name, JointSummary::of(*joint));
        let sentences = joint.kind_sentences(summary.headline.kinds()).into_iter();
        kinds.extend(sentences.map(|sentence| format!("{name}: {sentence}\n")));
        kinds.extend(summary.reviewed.map(|count| format!("{name}: {}\n", count.sentence())));
    }
    let doubtful = doubtful_text(joints);
    let dead_times: String = joints.iter().flat_map(dead_time_lines).collect();
    let lines = joints.iter().flat_map(|joint| [onset_line(joint), tracking_line(joint)]);
    let lags: String = lines.flatten().collect();
    let chosen: String = joints.iter().filter_map(chosen_line).collect();
    let own = joints.iter().filter_map(|joint| {
        let own = own_settings(joint, settings)?;
        let automatic = joint.estimate.chosen.map(|chosen| chosen.automatic).unwrap_or_default();
        let name = &joint.joint.name;
        Some(format!("{name}, settings of its own: {}\n", settings_line(own, automatic)))
    });
    let own: String = own.collect();
    let automatic = joints.iter().find_map(|joint| joint.estimate.chosen);
    let automatic = automatic.map(|chosen| chosen.automatic).unwrap_or_default();
    let settings = format!("{}\n", settings_line(settings, automatic));
    // Nothing of it is used where all inputs move all the time.
    let is_used = |joint: &EstimatedJoint<'_>| joint.estimate.dead_time.is_none();
    let settings = if joints.iter().any(is_used) { settings } else { String::new() };
    format!("{table}\n{kinds}{doubtful}{dead_times}{lags}{chosen}{own}{settings}")
}

/// What is said of the dead time of a joint, a line each.
fn dead_time_lines<'a>(joint: &EstimatedJoint<'a>) -> impl Iterator<Item = String> + use<'a> {
    let name = joint.joint.name.as_str();
    dead_time_sentences(joint).into_iter().map(move |sentence| format!("{name}: {sentence}\n"))
}

/// The settings that were chosen for a joint, and why, where any were.
pub(crate) fn chosen_line(joint: &EstimatedJoint<'_>) -> Option<String> {
    let Chosen { automatic, statistics } = joint.estimate.chosen?;
    let settings = &joint.estimate.settings;
    let unit = joint.joint.output_unit.as_deref();
    let mut parts = Vec::new();
    if automatic.alpha {
        parts.push(match statistics.short_delay {
            Some(delay) => format!(
                "α = {} (nine delays of ten are above {} samples)",
                settings.alpha,
                rounded(delay)
            ),
            None => format!("α = {} (as usual: no delay is known)", settings.alpha),
        });
    }
    if automatic.beta {
        parts.push(format!("β = {}", settings.beta));
    }
    if automatic.passband {
        let noise = statistics.noise.map_or_else(
            || "nothing known of the noise".to_owned(),
            |noise| format!("noise {}", measure(noise, unit)),
        );
        parts.push(format!("{} ({noise})", low_pass_text(settings)));
    }
    let name = &joint.joint.name;
    (!parts.is_empty()).then(|| format!("{name}: {}\n", parts.join(", ")))
}

fn low_pass_text(settings: &Settings) -> String {
    settings.low_pass.map_or_else(
        || "no low-pass".to_owned(),
        |LowPass { cutoff_hz, order }| format!("zero-phase low-pass {cutoff_hz} Hz, order {order}"),
    )
}

/// The response of a joint behind its dead times in words, where the method fits one and onsets are
/// delays.
pub(super) fn onset_line(joint: &EstimatedJoint<'_>) -> Option<String> {
    let model = joint.onset_model().filter(|model| model.obstacle().is_none())?;
    let response = onset_sentence(model);
    let agree = Scatter::of(&joint.fine_delays())
        .filter(|scatter| !scatter.is_more_than_noise() && !joint.against_state().has_dependence());
    let agree = agree.map_or_else(String::new, |scatter| {
        format!("; its delays are constant within {} s", rounded(scatter.within_s))
    });
    Some(format!("{}: {response}{agree}\n", joint.joint.name))
}

/// The response behind the dead times in words, with what it leaves over.
pub(crate) fn onset_sentence(model: &OnsetModel) -> String {
    let parameters = model.parameters();
    let value = |name: &str| {
        let found = parameters.iter().find(|(known, _)| *known == name);
        found.map_or_else(String::new, |(_, value)| rounded(*value))
    };
    let response = match model.shape() {
        "bend" => "the speed changes at once".to_owned(),
        "bend_lag" => {
            format!(
                "the speed follows through a lag with time constant {} s",
                value("time_constant_s")
            )
        }
        "bend_lag2" => {
            let lags: Vec<String> = parameters.iter().map(|(_, lag)| rounded(*lag)).collect();
            format!("the speed follows through lags with time constants {} s", lags.join(", "))
        }
        "oscillation" => {
            let lag = value("time_constant_s");
            let behind = if lag.is_empty() {
                lag
            } else {
                format!(", behind a lag with time constant {lag} s")
            };
            format!(
                "the speed follows with an oscillation, period {} s and damping {}{behind}",
                value("period_s"),
                value("damping")
            )
        }
        "settling" => {
            format!("the output settles with time constant {} s", value("time_constant_s"))
        }
        _ => "the output goes to a level at a constant rate".to_owned(),
    };
    let others = model.responses().into_iter().filter(|one| one.shape != model.shape());
    let others = others.map(|one| format!(", {}s `{}`", one.transition.id(), one.shape));
    format!(
        "after the delay {response} (`{}`{}); residual {} times the sensor's noise; the input explains \
         {} of the changes of motion",
        model.shape(),
        others.collect::<String>(),
        rounded(model.misfit()),
        percent(model.follows_input_r2())
    )
}

/// Where the output of a joint comes to rest, in words, where its input says that.
pub(super) fn tracking_line(joint: &EstimatedJoint<'_>) -> Option<String> {
    let tracking = joint.tracking()?;
    let sign = if tracking.gain() < 0.0 { '−' } else { '+' };
    Some(format!(
        "{}: the output tracks the input, as a servo's position does (at rest {} {sign} {}·u): its \
         arrival there is not taken for a reaction\n",
        joint.joint.name,
        rounded(tracking.offset()),
        rounded(tracking.gain().abs())
    ))
}

/// What the cells of [`summary_cells`] are.
pub(crate) const SUMMARY_HEADER: [&str; 7] =
    ["joint", "steps", "accepted", "rejected", "delay min", "median", "max"];

/// A row per joint, for people.
pub(crate) fn summary_table(joints: &[EstimatedJoint<'_>]) -> TextTable {
    let row =
        |joint: &EstimatedJoint<'_>| summary_cells(&joint.joint.name, &JointSummary::of(*joint));
    TextTable::of(SUMMARY_HEADER, &[1, 2, 4, 5, 6], joints.iter().map(row))
}

/// A joint in one row, for people.
pub(crate) fn summary_cells(name: &str, summary: &JointSummary) -> [String; 7] {
    let JointSummary { steps, accepted, rejected, delay_s, headline, .. } = summary;
    let accepted = match steps {
        0 => "-".to_owned(),
        _ => format!("{accepted} ({})", percent(*accepted as f64 / *steps as f64)),
    };
    let why = match (steps, rejected.is_empty()) {
        (0, _) => summary.without_steps.clone(),
        (_, true) => "none".to_owned(),
        (_, false) => reasons(rejected),
    };
    let seconds = |value: fn(&DelayRange) -> f64| {
        delay_s.as_ref().map_or_else(|| "-".to_owned(), |range| format!("{:.3} s", value(range)))
    };
    let median = match headline {
        Headline::All => seconds(|range| range.median),
        Headline::Kinds(_) => "by kind".to_owned(),
        Headline::None(_) => "-".to_owned(),
    };
    let [min, max] = [seconds(|range| range.min), seconds(|range| range.max)];
    [name.to_owned(), steps.to_string(), accepted, why, min, median, max]
}

fn reasons(rejected: &[(Condition, usize)]) -> String {
    let parts: Vec<_> = rejected.iter().map(|(why, count)| format!("{why} {count}")).collect();
    parts.join(", ")
}
