//! What is said where no effect is missing, where one is, and where none that was tried accounts for the
//! error.

use super::passage::{ABOVE_NOISE, Passage, Topic, first_order};
use crate::diagnosis::failure::Region;
use crate::diagnosis::{Comparison, LackOfFit, NEGLIGIBLE, SIGNIFICANCE};
use crate::experiment::Trial;
use crate::explain::Candidate;
use crate::fit::{AssessedModel, Status, is_rounding, makes_first_order};
use crate::model::Component;
use crate::report::Finding;
use crate::report::finding::{added, separation_sentence};
use crate::report::parameters::equation;
use crate::wording::{
    measure, misfit_units, p_text, parameter_units, parameter_value, percent, range_text,
    region_text, rounded, unit_suffix,
};

/// The level of the tests of other programs, most often.
const USUAL: f64 = 0.05;

impl Finding<'_> {
    pub(super) fn adequate_headline(&self) -> String {
        let of_consequence = if self.is_lack_shown() { " of consequence" } else { "" };
        match self.explained() {
            None => format!("no missing effect{of_consequence} found"),
            Some(explained) => format!("{explained}; nothing more{of_consequence} is missing"),
        }
    }

    /// Whether the residual is no noise, though no effect is named for it.
    pub(super) fn is_lack_shown(&self) -> bool {
        self.comparison().lack_of_fit.is_some_and(|test| !test.adequate)
    }

    pub(super) fn adequate(&self) -> Vec<Passage> {
        let error = [self.test(), self.size()];
        let limits = std::iter::once(self.limits()).chain(self.undetermined());
        let passages = [
            Passage::of(Topic::ERROR, error),
            Passage::of(Topic::SHARES, self.consequence().sentences()),
            Passage::of(Topic::LIMITS, limits),
        ];
        passages.into_iter().flatten().collect()
    }

    /// What the test of the lack of fit says of an adequate model.
    pub(super) fn test(&self) -> String {
        match self.comparison().lack_of_fit {
            Some(LackOfFit { edges: Some(edges), .. }) => {
                let (spread, share) = (measure(edges.spread_s, Some("s")), percent(edges.share));
                format!(
                    "The input steps lie between the samples of the log. Their times, estimated \
                     from the residual (80 % of them within {spread}), explain {share} of the \
                     squared residual; without that part no lack of fit is shown. With a log made \
                     by the controller itself, or sampled faster, the error of the model would be \
                     smaller."
                )
            }
            Some(test) if test.p_value >= SIGNIFICANCE => {
                let p_value = p_text(test.p_value);
                // What would pass for significant elsewhere is said to be below the level here.
                let level = 100.0 * SIGNIFICANCE;
                let level =
                    if test.p_value < USUAL { format!(" at {level} %") } else { String::new() };
                format!("No lack of fit is shown{level} ({p_value}).")
            }
            Some(test) => {
                let share = rounded(100.0 * test.misfit_share);
                if test.misfit_share < NEGLIGIBLE {
                    return format!(
                        "The lack of fit is {share} % of the squared error: negligible."
                    );
                }
                let p_value = p_text(test.p_value);
                let rest = match test.times_noise.filter(|_| test.adequate) {
                    Some(times) => format!(
                        "but on the training part the error is only {} times the noise",
                        rounded(times)
                    ),
                    None => "and no tried effect explains a relevant part of it".to_owned(),
                };
                format!(
                    "{share} % of the squared residual still follows a pattern ({p_value}), \
                     {rest}."
                )
            }
            None if self.is_exact() => {
                "The residual is only rounding error: there is nothing to test.".to_owned()
            }
            None => "There are too few samples to test it.".to_owned(),
        }
    }

    /// Whether no residual of either part is more than rounding.
    fn is_exact(&self) -> bool {
        let Comparison { training, validation, .. } = self.comparison();
        let largest = training.iter().chain(validation).map(|error| error.max);
        is_rounding(&self.joint().trials, largest.fold(0.0, f64::max))
    }

    /// What the record covers: beyond it nothing was shown.
    fn limits(&self) -> String {
        let input = self.joint().trials.iter().flat_map(Trial::input);
        let output = self.joint().trials.iter().flat_map(Trial::output);
        let input = range_text(input.copied(), self.joint().input_unit.as_deref());
        let output = range_text(output.copied(), self.joint().output_unit.as_deref());
        format!("Valid only in the range of the record: input {input}, output {output}.")
    }

    fn undetermined(&self) -> Option<String> {
        let all = self.comparison().fit.parameters.iter();
        let open = all.filter(|parameter| {
            matches!(parameter.status, Status::Undetermined | Status::BeyondReach)
        });
        let names: Vec<&str> = open.map(|parameter| parameter.name.as_str()).collect();
        (!names.is_empty()).then(|| format!("It does not determine {}.", names.join(", ")))
    }
}

impl Finding<'_> {
    pub(super) fn missing_headline(&self, best: &Candidate) -> String {
        /// Percent by which an error falls at least, to be said to.
        const FALLS: f64 = 0.5;
        let (before, after) = (self.output(self.error()), self.output(best.rmse()));
        let name = best.name();
        if best.error_reduction_percent < FALLS {
            return format!(
                "several effects are missing; the first, {name}, alone leaves the error at \
                 {after}"
            );
        }
        format!("{name} is missing; with it the error falls from {before} to {after}")
    }

    pub(super) fn missing(&self, best: &Candidate) -> Vec<Passage> {
        let described = added(best).map(|component| self.described(best, component));
        let compared = [self.improvement(best), self.alternatives(best)];
        let missing = described.chain(compared);
        let passages = [
            self.where_it_fails(),
            self.worst_segments(),
            Passage::of(Topic::MISSING, missing),
            Passage::of(Topic::SHARES, self.consequence().sentences()),
        ];
        passages.into_iter().flatten().collect()
    }

    /// What an effect does, its law here, and its parameters.
    fn described(&self, best: &Candidate, component: &Component) -> String {
        let spec = component.effect().spec();
        let is_first_order =
            makes_first_order(spec.id) && first_order(self.joint(), &best.fit).is_some();
        let parameters = self.parameters(&best.fit, &format!("{}.", spec.id));
        let law = equation(component);
        let with = if parameters.is_empty() { "" } else { ", with " };
        let summary = if is_first_order {
            "turns the integrator into a first-order lag, which settles at a constant input".into()
        } else {
            component.summary()
        };
        format!("{} ({summary}): {law}{with}{parameters}.", spec.id)
    }

    /// What the error becomes.
    fn improvement(&self, best: &Candidate) -> String {
        let part = if best.validation.is_some() { "validation" } else { "training" };
        let (before, after) = (self.output(self.error()), self.output(best.rmse()));
        let reduction = rounded(best.error_reduction_percent);
        let p_value = p_text(best.p_value);
        let falls = format!(
            "With it the {part} error falls from {before} to {after}, by {reduction} % ({p_value})"
        );
        let Some(noise) = self.noise() else { return format!("{falls}.") };
        if best.rmse() > ABOVE_NOISE * noise {
            let times = rounded(best.rmse() / noise);
            let next = "add it and run `tauscope explain` again";
            return format!("{falls}; that is still {times} times the noise: {next}.");
        }
        format!("{falls}, down to the noise.")
    }

    /// What it is indistinguishable from; the second best where there is no such effect.
    fn alternatives(&self, best: &Candidate) -> String {
        let same = &best.indistinguishable_from;
        if !same.is_empty() {
            let same = same.join(", ");
            let alike = format!(
                "On this record it is indistinguishable from {same}: one of them is enough."
            );
            let apart = best.separated_by.iter().map(|s| separation_sentence(self.joint(), s));
            return std::iter::once(alike).chain(apart).collect::<Vec<_>>().join(" ");
        }
        match self.next_to(best) {
            Some(next) => {
                let (name, error) = (next.name(), self.output(next.rmse()));
                format!("The next best, {name}, leaves {error} ({}).", next.judgement.reason())
            }
            None => "No other effect was tried.".to_owned(),
        }
    }

    /// The candidate beside the `best` that leaves least.
    fn next_to(&self, best: &Candidate) -> Option<&Candidate> {
        self.ranking.iter().find(|other| other.effects != best.effects)
    }

    /// `upper = 0.612 ± 0.021 V` for each of the parameters that start with `prefix`; those that were
    /// not fitted say nothing of the joint.
    fn parameters(&self, fit: &AssessedModel, prefix: &str) -> String {
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

impl Finding<'_> {
    pub(super) fn unexplained_headline(&self) -> String {
        let explained = self.explained().unwrap_or_else(|| self.follows());
        let rest = if self.is_down_to_noise() {
            "what remains is no more than the sensor's noise".to_owned()
        } else {
            let remains = self.consequence().remains();
            format!("{remains}, which no effect that was tried accounts for")
        };
        format!("{explained}; {rest}")
    }

    pub(super) fn is_down_to_noise(&self) -> bool {
        self.noise().is_some_and(|noise| self.error() <= ABOVE_NOISE * noise)
    }

    pub(super) fn unexplained(&self) -> Vec<Passage> {
        let mut passages = self.fails();
        passages.extend(Passage::of(Topic::RESIDUAL, self.shape()));
        passages.extend(Passage::of(Topic::SHARES, self.consequence().sentences()));
        passages.extend(Passage::of(Topic::NEXT, self.several_together()));
        passages
    }

    /// What finds effects that show only together, where one at a time was looked for.
    fn several_together(&self) -> Option<String> {
        let next = "For effects that are significant only together use `tauscope improve`, which adds them \
                    one by one and removes those that become superfluous.";
        let is_one_at_a_time = self.before.is_none() && !self.ranking.is_empty();
        (is_one_at_a_time && !self.is_down_to_noise()).then(|| next.to_owned())
    }

    pub(super) fn open_headline(&self) -> String {
        let explained = self.explained().unwrap_or_else(|| self.follows());
        format!(
            "{explained}; {}: `tauscope explain` looks for what is still missing",
            self.consequence().remains()
        )
    }

    /// How the residual runs with what it follows most.
    fn shape(&self) -> Option<String> {
        /// Share of the squared residual from which it is worth a look.
        const WORTH: f64 = 0.1;
        /// Share that is none.
        const NOTHING: f64 = 0.01;
        let (parts, share) = most_followed(&self.comparison().regions)?;
        let by_mean = |a: &&Region, b: &&Region| a.mean_residual.total_cmp(&b.mean_residual);
        let (low, high) = (parts.iter().min_by(by_mean)?, parts.iter().max_by(by_mean)?);
        let (feature, share_said) = (low.feature, percent(share));
        let head = format!("Measured − simulated ({})", self.comparison().arising);
        if share < NOTHING {
            return Some(format!(
                "{head} depends on none of input, output, speed, time and \
                 trial."
            ));
        }
        if share < WORTH {
            return Some(format!(
                "{head} depends little on input, output, speed, time or trial: at most on \
                 `{feature}`, which explains {share_said} of its square (R²)."
            ));
        }
        let (low, high) = (self.mean_at(low), self.mean_at(high));
        Some(format!(
            "{head} depends most on `{feature}`, which explains {share_said} of its square (R²): \
             its mean is {low}, {high}."
        ))
    }

    /// `0.2 deg where it is 20 to 30 deg`.
    fn mean_at(&self, region: &Region) -> String {
        let unit = unit_suffix(region.feature.unit(&misfit_units(self.joint())).as_deref());
        let part = region_text(region);
        format!("{} where it is {part}{unit}", self.output(region.mean_residual))
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
