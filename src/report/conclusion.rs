//! A verdict in words that an engineer can act on.

use super::EstimatedJoint;
use super::add::gained;
use super::consequence::noise_of;
use super::equation::filled_in;
use super::finding::{Finding, added, specs};
use super::first_order::first_order;
use super::model_delay::model_delay;
use super::separation::sentence;
use crate::diagnosis::failure::{Region, WorstSegment};
use crate::diagnosis::{Comparison, ShownBy};
use crate::experiment::{Joint, Trial};
use crate::explain::{Candidate, Verdict};
use crate::fit::{Fit, Status};
use crate::wording::{
    effects_text, failure_sentences, measure, misfit_units, p_text, parameter_units,
    parameter_value, percent, region_text, rounded, unit_suffix, worst_segment_text, wrapped,
};

/// What is concluded of a joint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Conclusion {
    /// The verdict in one sentence.
    pub(crate) headline: String,
    /// What is behind it.
    pub(crate) paragraph: String,
    /// Commands that do what it proposes.
    pub(crate) commands: Vec<String>,
}

/// Times the noise above which an error is said to be more than noise.
const ABOVE_NOISE: f64 = 1.15;

impl Finding<'_> {
    /// The verdict in words.
    pub(crate) fn conclusion(&self) -> Conclusion {
        let best = self.proposed();
        let (headline, mut sentences) = match (self.verdict, best) {
            (_, Some(best)) => (self.missing_headline(best), self.missing(best)),
            (Verdict::Adequate, None) => (self.adequate_headline(), self.adequate()),
            (Verdict::MissingEffect, None) => (self.open_headline(), self.fails()),
            (_, None) => (self.unexplained_headline(), self.unexplained()),
        };
        sentences.extend(first_order(self.joint(), self.consequence().fit));
        sentences.extend(self.conditions(best));
        sentences.extend(self.delay());
        let command = |id: &&'static str| {
            // A bracket is a pattern to a shell.
            let id = if id.contains('[') { format!("'{id}'") } else { (*id).to_owned() };
            format!("tauscope add {id} {}", self.add_arguments)
        };
        let commands = best.iter().flat_map(|best| &best.effects).map(command).collect();
        Conclusion { headline, paragraph: sentences.join(" "), commands }
    }

    /// In which trials the effects act that do not act in all.
    fn conditions(&self, best: Option<&Candidate>) -> Option<String> {
        let model = self.consequence().fit.model.components().iter();
        let components = model.chain(best.into_iter().flat_map(added));
        let of = components.filter_map(|component| component.effect().within_trials());
        let mut words: Vec<&str> = of.map(|of| of.word).collect();
        words.sort_unstable();
        words.dedup();
        let acts = |word: &&str| format!("`[{word}]`: in trials with `{word}` in their label.");
        (!words.is_empty()).then(|| words.iter().map(acts).collect::<Vec<_>>().join(" "))
    }

    /// The delay of the model beside those that were measured.
    fn delay(&self) -> Option<String> {
        let estimate = self.delays?;
        let measured = EstimatedJoint { joint: self.joint(), estimate };
        model_delay(self.consequence().fit, measured)
    }

    fn joint(&self) -> &Joint {
        self.compared.joint
    }

    fn comparison(&self) -> &Comparison {
        self.compared.comparison
    }

    /// A number in output units.
    fn output(&self, value: f64) -> String {
        measure(value, self.joint().output_unit.as_deref())
    }

    fn error(&self) -> f64 {
        self.comparison().judged().map_or(f64::NAN, |error| error.rmse)
    }

    fn noise(&self) -> Option<f64> {
        noise_of(self.joint())
    }

    fn missing_headline(&self, best: &Candidate) -> String {
        let falls = format!("{} to {}", self.output(self.error()), self.output(best.rmse()));
        let name = best.name();
        format!("{}: {name} is missing; with it the error falls from {falls}", self.joint().name)
    }

    fn missing(&self, best: &Candidate) -> Vec<String> {
        let mut sentences: Vec<String> = added(best)
            .map(|component| {
                let spec = component.effect().spec();
                let parameters = self.parameters(&best.fit, &format!("{}.", spec.id));
                let law = filled_in(component);
                let with = if parameters.is_empty() { "" } else { ", with " };
                format!("{} ({}): here {law}{with}{parameters}.", spec.id, spec.summary)
            })
            .collect();
        sentences.push(self.improvement(best));
        sentences.extend(self.where_it_fails());
        sentences.push(self.alternatives(best));
        sentences.extend(self.consequence().sentences());
        sentences.extend(self.look_alikes(best));
        sentences
    }

    /// What the error becomes.
    fn improvement(&self, best: &Candidate) -> String {
        let part = if best.validation.is_some() { "not fitted" } else { "fitted" };
        let (before, after) = (self.output(self.error()), self.output(best.rmse()));
        let reduction = rounded(best.error_reduction_percent);
        let p_value = p_text(best.p_value);
        let falls = format!(
            "With it the error on data that were {part} falls from {before} to {after}, by \
             {reduction} % ({p_value})"
        );
        let Some(noise) = self.noise() else { return format!("{falls}.") };
        // Noise with a memory is larger than what windows show of it, but not beside the model.
        let floor = best.noise_floor.unwrap_or(0.0).max(noise);
        if best.rmse() > ABOVE_NOISE * floor {
            let times = rounded(best.rmse() / noise);
            let rest = "more is missing, to be sought with it in the model";
            return format!("{falls}; that is still {times} times the noise, so {rest}.");
        }
        format!("{falls}, down to the noise.")
    }

    /// What in the record shows it, with times to look at.
    fn where_it_fails(&self) -> Option<String> {
        let conditions = failure_sentences(self.joint(), self.comparison());
        let worst = self.comparison().failure.iter().flat_map(|failure| &failure.worst_segments);
        let several = self.joint().trials.len() > 1;
        let time = |worst: &WorstSegment| {
            let trial = if several { format!("trial {}, ", worst.trial) } else { String::new() };
            trial + &worst_segment_text(worst)
        };
        let times: Vec<String> = worst.take(3).map(time).collect();
        let look = format!("look at {}", times.join(", "));
        match (conditions.first(), times.is_empty()) {
            (Some(condition), false) => Some(format!("In the record: {condition}; {look}.")),
            (Some(condition), true) => Some(format!("In the record: {condition}.")),
            (None, false) => Some(format!("In the record, {look}.")),
            (None, true) => None,
        }
    }

    /// What it is indistinguishable from; the second best where there is no such effect.
    fn alternatives(&self, best: &Candidate) -> String {
        let same = &best.indistinguishable_from;
        if !same.is_empty() {
            let same = same.join(", ");
            let alike = format!(
                "On this record it is indistinguishable from {same}: one of them is enough."
            );
            let apart = best.separated_by.iter().map(|s| sentence(self.joint(), s));
            return std::iter::once(alike).chain(apart).collect::<Vec<_>>().join(" ");
        }
        match self.ranking.get(1) {
            Some(next) => {
                format!("Second best is {}, error {}.", next.name(), self.output(next.rmse()))
            }
            None => "No other effect was tried.".to_owned(),
        }
    }

    /// What the catalogue confuses with it, and how that did.
    fn look_alikes(&self, best: &Candidate) -> Option<String> {
        let next = self.ranking.get(1).map(|next| next.effects.as_slice()).unwrap_or_default();
        let mentioned = [&best.effects, &best.indistinguishable_from, next];
        let named = |id: &&str| !mentioned.iter().any(|ids| ids.contains(id));
        let confused = specs(best).flat_map(|spec| spec.confused_with).copied().filter(named);
        let how = |id: &str| {
            let other = self.ranking.iter().find(|other| other.effects == [id]);
            other.map_or_else(
                || format!("{id} (not in the ranking)"),
                |other| format!("{id} (error {})", self.output(other.rmse())),
            )
        };
        let confused: Vec<String> = confused.map(how).collect();
        (!confused.is_empty()).then(|| format!("Often confused with it: {}.", confused.join(", ")))
    }

    fn adequate_headline(&self) -> String {
        let explained =
            self.explained().map_or_else(String::new, |explained| format!("{explained}; "));
        format!("{}: {explained}no missing effect found", self.joint().name)
    }

    /// What the effects that were added explain of the error, where any were:
    /// `dead_band and end_stop explain 70 % of the error beyond the noise (2.89 to 0.88 deg)`.
    fn explained(&self) -> Option<String> {
        let before = self.before?;
        let mut gained = gained(&before.fit.model, &self.comparison().fit.model);
        let last = gained.pop()?;
        let (names, explain) = match gained.as_slice() {
            [] => (last.to_owned(), "explains"),
            others => (format!("{} and {last}", others.join(", ")), "explain"),
        };
        let share = percent(self.consequence().explained()?);
        let (from, to) = (rounded(before.judged()?.rmse), self.output(self.error()));
        Some(format!("{names} {explain} {share} of the error beyond the noise ({from} to {to})"))
    }

    /// What the model explains of the motion: `1 − e/d` with the standard deviation `d` of what
    /// was measured.
    fn follows(&self) -> String {
        let model = effects_text(&self.comparison().fit.model);
        match self.comparison().judged().map(|error| error.fit_percent) {
            Some(fit) if fit > 0.0 => {
                format!("{model} explains {} of the motion", percent(fit / 100.0))
            }
            _ => format!("{model} does not explain the motion"),
        }
    }

    fn adequate(&self) -> Vec<String> {
        let mut sentences = vec![self.test(), self.size()];
        sentences.extend(self.consequence().sentences());
        sentences.extend(self.misses_validation());
        sentences.push(self.limits());
        sentences.extend(self.undetermined());
        sentences
    }

    /// How large the error is.
    fn size(&self) -> String {
        let error = self.output(self.error());
        match self.noise() {
            Some(noise) => {
                let times = rounded(self.error() / noise);
                format!("The error is {error}, {times} times the noise.")
            }
            None => format!("The error is {error}."),
        }
    }

    /// What the test of the lack of fit says of an adequate model.
    fn test(&self) -> String {
        match self.comparison().lack_of_fit {
            Some(test) if test.p_value >= crate::diagnosis::SIGNIFICANCE => {
                format!("No lack of fit is shown ({}).", p_text(test.p_value))
            }
            Some(test) => {
                let share = rounded(100.0 * test.misfit_share);
                format!("What it lacks is {share} % of the squared error: negligible.")
            }
            None => "There are too few samples to test it.".to_owned(),
        }
    }

    /// A warning where the part that was not fitted is worse than noise.
    fn misses_validation(&self) -> Option<String> {
        let times = self.comparison().validation?.rmse / self.noise()?;
        let warning = "The test covers the part that was fitted; on the other part the error exceeds \
                       the noise, so the model does not generalise yet.";
        (times > ABOVE_NOISE).then(|| warning.to_owned())
    }

    /// What the record covers: beyond it nothing was shown.
    fn limits(&self) -> String {
        let input = self.joint().trials.iter().flat_map(Trial::input);
        let output = self.joint().trials.iter().flat_map(Trial::output);
        let input = span(input.copied(), self.joint().input_unit.as_deref());
        let output = span(output.copied(), self.joint().output_unit.as_deref());
        format!("This holds where the record has been: input {input}, output {output}.")
    }

    fn undetermined(&self) -> Option<String> {
        let all = self.comparison().fit.parameters.iter();
        let open = all.filter(|parameter| {
            matches!(parameter.status, Status::Undetermined | Status::BeyondReach)
        });
        let names: Vec<&str> = open.map(|parameter| parameter.name.as_str()).collect();
        (!names.is_empty()).then(|| format!("It does not determine {}.", names.join(", ")))
    }

    fn unexplained_headline(&self) -> String {
        let explained = self.explained().unwrap_or_else(|| self.follows());
        let rest = if self.is_down_to_noise() {
            "what remains is no more than the sensor's noise".to_owned()
        } else {
            let remains = self.consequence().remains();
            format!("{remains}, which no effect that was tried accounts for")
        };
        format!("{}: {explained}; {rest}", self.joint().name)
    }

    fn is_down_to_noise(&self) -> bool {
        self.noise().is_some_and(|noise| self.error() <= ABOVE_NOISE * noise)
    }

    fn unexplained(&self) -> Vec<String> {
        let mut sentences = self.consequence().sentences();
        sentences.extend(self.fails());
        sentences.extend(self.shape());
        sentences.extend(self.nearest());
        sentences
    }

    fn open_headline(&self) -> String {
        let explained = self.explained().unwrap_or_else(|| self.follows());
        format!(
            "{}: {explained}; {}: `tauscope explain` looks for what is still missing",
            self.joint().name,
            self.consequence().remains()
        )
    }

    /// How large the error is, and where.
    pub(super) fn fails(&self) -> Vec<String> {
        let mut sentences = vec![self.size()];
        sentences.extend(self.shown_beside_size());
        sentences.extend(self.where_it_fails());
        sentences
    }

    /// What shows the lack of fit of an error that may be no larger than noise.
    fn shown_beside_size(&self) -> Option<String> {
        let test = self.comparison().lack_of_fit?;
        match test.shown_by? {
            ShownBy::UnseenPart => {
                let times = rounded(test.times_training?);
                Some(format!("On the part that was not fitted it is {times} times as large."))
            }
            ShownBy::FewWindows => {
                let times = rounded(test.local?.times_noise?);
                Some(format!(
                    "It is not spread as noise would be: in one window the motion that is \
                     missed is {times} times the noise."
                ))
            }
            ShownBy::Shapes | ShownBy::Size => None,
        }
    }

    /// How the residual runs with what it follows most.
    fn shape(&self) -> Option<String> {
        /// Share of the squared residual from which it is worth a look.
        const WORTH: f64 = 0.1;
        let (parts, share) = most_followed(&self.comparison().regions)?;
        let by_mean = |a: &&Region, b: &&Region| a.mean_residual.total_cmp(&b.mean_residual);
        let (low, high) = (parts.iter().min_by(by_mean)?, parts.iter().max_by(by_mean)?);
        let (feature, share_said) = (low.feature, percent(share));
        let head = "Restarted at every step, measured − simulated follows";
        if share < WORTH {
            return Some(format!(
                "{head} none of its features much; `{feature}` most, with {share_said} of its \
                 square."
            ));
        }
        let (low, high) = (self.mean_at(low), self.mean_at(high));
        Some(format!(
            "{head} `{feature}` most, with {share_said} of its square: on average {low}, {high}."
        ))
    }

    /// `0.2 deg where it is 20 to 30 deg`.
    fn mean_at(&self, region: &Region) -> String {
        let unit = unit_suffix(region.feature.unit(&misfit_units(self.joint())).as_deref());
        let part = region_text(region);
        format!("{} where it is {part}{unit}", self.output(region.mean_residual))
    }

    /// The effect that comes nearest, and that it is not to be trusted.
    fn nearest(&self) -> Option<String> {
        let nearest = self.ranking.first()?;
        let (name, share) = (nearest.name(), percent(nearest.share_of_misfit.clamp(0.0, 1.0)));
        Some(format!(
            "The nearest effect, {name}, would explain {share} of the misfit and is not to be \
             trusted."
        ))
    }

    /// `upper = 0.612 ± 0.021 V` for each of the parameters that start with `prefix`; those that were
    /// not fitted say nothing of the joint.
    fn parameters(&self, fit: &Fit, prefix: &str) -> String {
        let units = parameter_units(self.joint(), &fit.model);
        let own = fit.parameters.iter().zip(units);
        let own = own.filter(|(parameter, _)| parameter.status != Status::Fixed);
        let own = own.filter_map(|(parameter, unit)| {
            let name = parameter.name.strip_prefix(prefix)?;
            Some(format!("{name} = {}", parameter_value(parameter, &unit)))
        });
        own.collect::<Vec<_>>().join(", ")
    }
}

/// The parts of the feature whose means hold most of the squared residual, and their share.
fn most_followed(regions: &[Region]) -> Option<(&[Region], f64)> {
    let square = |part: &Region, value: f64| part.share_of_time * value * value;
    let share = |parts: &[Region]| {
        let of_means: f64 = parts.iter().map(|part| square(part, part.mean_residual)).sum();
        let all: f64 = parts.iter().map(|part| square(part, part.rmse)).sum();
        if all > 0.0 { of_means / all } else { 0.0 }
    };
    let by_feature = regions.chunk_by(|a, b| a.feature == b.feature);
    let shares = by_feature.map(|parts| (parts, share(parts)));
    shares.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// `-2 to 2 V`.
fn span(values: impl Iterator<Item = f64>, unit: Option<&str>) -> String {
    let ends = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    format!("{} to {}", rounded(low), measure(high, unit))
}

/// The words as they are printed.
pub(super) fn printed(conclusion: &Conclusion) -> String {
    let commands = conclusion.commands.iter().map(|command| format!("    {command}"));
    let blocks = std::iter::once(wrapped(&conclusion.paragraph)).chain(commands);
    blocks.collect::<Vec<_>>().join("\n\n") + "\n"
}
