//! The answers to what a reviewer asks first, each in a line.

use crate::diagnosis::failure::FailsWhere;
use crate::explain::{Contribution, Verdict};
use crate::report::finding::Finding;
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

    /// What is to be said of the effects where their shares stand beside them.
    pub(crate) fn beside_shares(&self) -> String {
        self.consequence().beside_shares().join(" ")
    }

    /// The effects that were added, with what could stand in the place of each, and what they explain.
    fn found(&self) -> String {
        let found = self.attribution.map_or(&[][..], |known| &known.found);
        let Some(explained) = self.explained_share().filter(|_| !found.is_empty()) else {
            return self.follows();
        };
        let name = |one: &Contribution| match one.alternatives.as_slice() {
            [] => one.effect.to_owned(),
            others => format!("{} (or {})", one.effect, others.join(" or ")),
        };
        let names: Vec<String> = found.iter().map(name).collect();
        format!("{}: {explained}", names.join(", "))
    }

    /// What no effect accounts for.
    fn left(&self) -> String {
        match self.verdict {
            Verdict::Adequate => format!("nothing: {}", self.test()),
            _ if self.is_down_to_noise() => "no more than the sensor's noise".to_owned(),
            Verdict::Unexplained => {
                format!("{}; no effect that was tried gains enough", self.consequence().remains())
            }
            Verdict::MissingEffect => self.consequence().remains(),
        }
    }

    /// The condition that holds most of the error.
    fn strongest_condition(&self) -> String {
        let failure = self.comparison().failure.as_ref();
        let strongest = failure.and_then(|failure| FailsWhere::strongest(&failure.fails_where));
        match (strongest, self.verdict) {
            (Some(condition), _) => condition.sentence(&misfit_units(self.joint())),
            (None, Verdict::Adequate) => "nowhere by more than noise".to_owned(),
            (None, _) => {
                "under no condition more than under others: see the worst segments".to_owned()
            }
        }
    }
}
