//! The answers to what a reviewer asks first, each in a line.

use super::figures::first_of;
use crate::diagnosis::failure::FailsWhere;
use crate::explain::{Candidate, Contribution, Verdict};
use crate::report::Finding;
use crate::wording::misfit_units;

/// What a reviewer asks of a model first: question and answer.
pub(crate) type Answer = (&'static str, String);

impl Finding<'_> {
    /// What was found, what is still unexplained, and where the model fails.
    pub(crate) fn answers(&self) -> [Answer; 3] {
        [
            ("Found", self.found()),
            ("Unexplained", self.left()),
            ("Fails", self.strongest_condition()),
        ]
    }

    /// The effects that were added, with what could stand in the place of each, and what they explain:
    /// of many those that carry most.
    fn found(&self) -> String {
        let found = self.attribution.map_or(&[][..], |known| &known.found);
        let Some(explained) = self.explained_share().filter(|_| !found.is_empty()) else {
            return self.follows();
        };
        let name = |one: &&Contribution| match one.alternative_names().as_slice() {
            [] => one.effect.to_owned(),
            others => format!("{} (or {})", one.effect, others.join(" or ")),
        };
        let mut found: Vec<&Contribution> = found.iter().collect();
        found.sort_by(|a, b| b.error_share.total_cmp(&a.error_share));
        let names: Vec<String> = found.iter().map(name).collect();
        let names = first_of(&names).unwrap_or_default();
        let has_no_other = found.iter().all(|one| one.alternatives.is_empty());
        let alone = match found.len() {
            _ if !has_no_other => "",
            1 => "; no other effect that was tried fits as well in its place",
            _ => "; no other effect that was tried fits as well in place of any of them",
        };
        format!("{names}: {explained}{alone}")
    }

    /// What no effect accounts for.
    fn left(&self) -> String {
        match self.verdict {
            Verdict::Adequate if self.is_lack_shown() => self.test(),
            Verdict::Adequate => format!("nothing. {}", self.test()),
            _ if self.is_down_to_noise() => "no more than the sensor's noise".to_owned(),
            Verdict::Unexplained => {
                format!("{}; {}", self.consequence().remains(), self.why_no_more())
            }
            Verdict::MissingEffect => self.consequence().remains(),
        }
    }

    /// Why no effect is named for what is left.
    fn why_no_more(&self) -> String {
        match self.before {
            // Effects were added until none did.
            Some(_) if self.ranking.iter().any(Candidate::is_significant) => {
                "no other effect is significant, distinguishable from others, and of practical consequence"
                    .to_owned()
            }
            Some(_) => "no other effect is significant".to_owned(),
            None => "no tried effect reduces the error enough".to_owned(),
        }
    }

    /// The condition that holds most of the error.
    fn strongest_condition(&self) -> String {
        let failure = self.comparison().failure.as_ref();
        let strongest = failure.and_then(|failure| FailsWhere::strongest(&failure.fails_where));
        match (strongest, self.verdict) {
            (Some(condition), _) => condition.sentence(&misfit_units(self.joint())),
            (None, Verdict::Adequate) => "nowhere: no lack of fit is shown".to_owned(),
            (None, _) => "under no particular condition: see the worst segments".to_owned(),
        }
    }
}
