//! What is said where an effect is missing.

use super::figures::{ABOVE_NOISE, first_order};
use super::{Passage, Topic};
use crate::explain::Candidate;
use crate::fit::{AssessedModel, Status, makes_first_order};
use crate::model::Component;
use crate::report::equation::filled_in;
use crate::report::finding::{Finding, added, specs};
use crate::report::separation::sentence;
use crate::wording::{p_text, parameter_units, parameter_value, rounded};

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
        let missing = described.chain(compared).chain(self.look_alikes(best));
        let passages = [
            self.where_it_fails(),
            self.worst_segments(),
            Passage::of(Topic::Missing, missing),
            Passage::of(Topic::Shares, self.consequence().sentences()),
        ];
        passages.into_iter().flatten().collect()
    }

    /// What an effect does, its law here, and its parameters.
    fn described(&self, best: &Candidate, component: &Component) -> String {
        let spec = component.effect().spec();
        let is_first_order =
            makes_first_order(spec.id) && first_order(self.joint(), &best.fit).is_some();
        let parameters = self.parameters(&best.fit, &format!("{}.", spec.id));
        let law = filled_in(component);
        let with = if parameters.is_empty() { "" } else { ", with " };
        let summary = if is_first_order {
            "turns the integrator into a first-order lag, which settles at a constant input".into()
        } else {
            component.summary()
        };
        format!("{} ({summary}): here {law}{with}{parameters}.", spec.id)
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
            let apart = best.separated_by.iter().map(|s| sentence(self.joint(), s));
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

    /// What the catalogue confuses with it, and how that did.
    fn look_alikes(&self, best: &Candidate) -> Option<String> {
        let next = self.next_to(best).map(|next| next.effects.as_slice()).unwrap_or_default();
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
