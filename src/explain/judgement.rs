//! What is thought of a candidate: whether it is worth adding, and why.

use serde::Serialize;

use crate::effect::LimitingCase;

/// The judgement of one candidate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judgement {
    /// Twice the log-likelihood by which the model with it is ahead of the one without, less
    /// Schwarz's penalty for its parameters: above 0 the record favours it.
    pub evidence: f64,
    /// Whether the record determines the effect.
    pub determined: bool,
    /// Whether its parameters are such as physics allows.
    pub plausible: bool,
    /// Whether the part that was not fitted is predicted no worse with it.
    pub generalises: bool,
    /// The part of the misfit of the first model that it takes away, in percent.
    pub consequence_percent: f64,
    /// Why it is refused; none where it is added.
    #[serde(skip)]
    pub refusal: Option<Refusal>,
}

/// Why an effect is not added.
#[derive(Clone, Debug, PartialEq)]
pub enum Refusal {
    /// What it takes of the error may be chance, or is too little of the error.
    NotSignificant,
    /// The record determines none of its parameters, or they lie beyond all that it reaches.
    Undetermined,
    /// A parameter has a value that physics does not allow: its name.
    Implausible(String),
    /// Beside an effect of the model that looks like it, it is not distinguished from doing nothing.
    LikeAnother,
    /// The record shows no more than its simpler limiting case.
    LimitingCase(LimitingCase),
    /// The part that was not fitted is predicted worse.
    DoesNotGeneralise,
    /// It takes away too little of the error.
    NoConsequence,
    /// Another candidate is more likely: its name.
    Behind(String),
    /// What remains with it, and with more effects, is not explained: it is likely the nearest of
    /// the known effects, not the one that is missing.
    NotTheWhole,
    /// Nothing is missing from the model.
    NothingMissing,
}

impl Judgement {
    /// That of a candidate which nobody has judged yet.
    pub(super) fn pending(evidence: f64) -> Self {
        Self {
            evidence,
            determined: false,
            plausible: true,
            generalises: false,
            consequence_percent: 0.0,
            refusal: Some(Refusal::NothingMissing),
        }
    }

    /// Why the effect is added or refused, as words that follow a colon.
    pub fn reason(&self) -> String {
        let share = self.consequence_percent;
        match &self.refusal {
            None => {
                let decimals = usize::from(share < 1.0);
                format!(
                    "significant, determined, and removes {share:.decimals$} % of the initial error"
                )
            }
            Some(Refusal::NotSignificant) => {
                "the reduction is not significant, or too small".to_owned()
            }
            Some(Refusal::Undetermined) => {
                "this record does not determine its parameters".to_owned()
            }
            Some(Refusal::Implausible(name)) => format!("the value of {name} is not plausible"),
            Some(Refusal::LikeAnother) => {
                "not distinguishable from a similar effect of the model".to_owned()
            }
            Some(Refusal::LimitingCase(case)) => {
                format!("the record shows only its limiting case, {}", case.effects.join(" and "))
            }
            Some(Refusal::DoesNotGeneralise) => "it increases the validation error".to_owned(),
            Some(Refusal::NoConsequence) => {
                format!("removes only {share:.1} % of the initial error: negligible")
            }
            Some(Refusal::Behind(name)) => format!("{name} is more likely"),
            Some(Refusal::NotTheWhole) => {
                "the model still fails with it, also with further effects".to_owned()
            }
            Some(Refusal::NothingMissing) => "nothing is missing from the model".to_owned(),
        }
    }

    /// What speaks against the effect, in two or three words; nothing where it is added.
    #[cfg(feature = "rrd")]
    pub(crate) fn refusal_in_short(&self) -> Option<String> {
        Some(match self.refusal.as_ref()? {
            Refusal::NotSignificant => "may be chance".to_owned(),
            Refusal::Undetermined => "not determined".to_owned(),
            Refusal::Implausible(name) => format!("{name} not plausible"),
            Refusal::LikeAnother => "not distinguished".to_owned(),
            Refusal::LimitingCase(case) => format!("no more than {}", case.effects.join(", ")),
            Refusal::DoesNotGeneralise => "does not generalise".to_owned(),
            Refusal::NoConsequence => "no consequence".to_owned(),
            Refusal::Behind(_) => "less likely".to_owned(),
            Refusal::NotTheWhole => "still fails with it".to_owned(),
            Refusal::NothingMissing => "nothing is missing".to_owned(),
        })
    }

    /// Whether the effect is added, or proposed.
    pub fn is_added(&self) -> bool {
        self.refusal.is_none()
    }

    /// Whether all but its consequence speaks for it.
    pub(super) fn is_sound(&self) -> bool {
        matches!(self.refusal, None | Some(Refusal::NoConsequence))
    }
}
