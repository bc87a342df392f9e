//! What is said where no effect that was tried accounts for the error.

use super::figures::ABOVE_NOISE;
use super::{Passage, Topic};
use crate::diagnosis::failure::Region;
use crate::report::finding::Finding;
use crate::wording::{misfit_units, percent, region_text, rounded, unit_suffix};

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
        passages
            .extend(Passage::of(Topic::Residual, self.shape().into_iter().chain(self.likeliest())));
        passages.extend(Passage::of(Topic::Shares, self.consequence().sentences()));
        passages.extend(Passage::of(Topic::Next, self.several_together()));
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
        let head = format!("Measured − simulated ({}) follows", self.comparison().arising);
        if share < NOTHING {
            return Some(format!("{head} none of its features."));
        }
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

    /// The effect that is the likeliest, and what is to be thought of it; nothing where it is named as of
    /// no consequence already, or gains nothing.
    fn likeliest(&self) -> Option<String> {
        /// The share of the misfit from which a significant effect is likely one of several. Chosen: of
        /// 30 simulated misfits from outside the catalogue the likeliest effect explained 77 % at most.
        const ONE_OF_SEVERAL: f64 = 0.8;
        let likeliest = self.ranking.first()?;
        let refinements = self.attribution.map_or(&[][..], |known| &known.refinements);
        let (name, explained) = (likeliest.name(), likeliest.share_of_misfit.clamp(0.0, 1.0));
        let with = likeliest.rmse();
        // One that diverges has no error.
        let gains = with < self.error() && rounded(with) != rounded(self.error());
        if !gains || likeliest.effects.iter().all(|id| refinements.contains(id)) {
            return None;
        }
        Some(if explained >= ONE_OF_SEVERAL && likeliest.is_significant() {
            let share = percent(explained);
            format!(
                "The likeliest effect, {name}, alone would explain {share} of the misfit, and a lack of \
                 fit would remain: several effects are probably missing."
            )
        } else {
            let with = self.output(with);
            let why = if likeliest.is_significant() {
                "too little is gained for it to be named"
            } else {
                "it is not significant"
            };
            format!("The likeliest effect, {name}, would leave {with}: {why}.")
        })
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
