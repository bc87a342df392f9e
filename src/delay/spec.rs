//! The methods: what each says of itself, and the handle by which settings name it.

use std::fmt;

/// What a method says of itself: help, defaults, tables and pages follow from it.
#[derive(Debug, PartialEq, Eq, Hash)]
pub struct MethodSpec {
    /// Its name in options and files, in kebab case.
    pub id: &'static str,
    /// What it fits, in few words.
    pub fits: &'static str,
    /// Who described it, and where.
    pub source: Option<&'static str>,
    /// What it does, in a line of help.
    pub summary: &'static str,
    /// Whether it finds the response after the delays, over all trials of a joint, and gives each delay
    /// an interval. The decisions of others depend on no sample after the next step, and come in steps
    /// of β.
    pub has_intervals: bool,
}

/// How a delay is found: one of [`Method::all`].
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Method(&'static MethodSpec);

/// What all onset models have in common.
const ONSET: MethodSpec =
    MethodSpec { id: "", fits: "onset model", source: None, summary: "", has_intervals: true };

impl Method {
    /// The onset model of the response that a joint's record supports.
    pub const AUTO: Self = Self(&MethodSpec {
        id: "auto",
        summary: "The response that the record supports (bend, lag, oscillation, settling, slew), with \
                  intervals; Algorithm 1's candidates beside it",
        ..ONSET
    });

    /// Two regression lines that need not meet: Albrecht and Taylor's Algorithm 1.
    pub const TWO_LINE: Self = Self(&MethodSpec {
        id: "two-line",
        fits: "two-line regression",
        source: Some("Albrecht and Taylor, Algorithm 1"),
        summary: "Two regression lines (Albrecht and Taylor)",
        has_intervals: false,
    });

    /// The onset model of a speed that changes at once.
    pub const HINGE: Self = Self(&MethodSpec {
        id: "hinge",
        fits: "two lines that meet",
        summary: "`auto` with the response `bend` alone: the speed changes at once",
        ..ONSET
    });

    /// The onset model of a speed that changes at once, or after a lag or an oscillation.
    pub const LAG_AWARE: Self = Self(&MethodSpec {
        id: "lag-aware",
        fits: "two lines that meet, seen through a lag or an oscillation",
        summary: "`auto` with responses of an integrating output alone: a bend, a lag, or an \
                  oscillation",
        ..ONSET
    });

    /// Every method, in the order the documentation lists them.
    pub fn all() -> impl ExactSizeIterator<Item = Self> {
        [Self::AUTO, Self::TWO_LINE, Self::HINGE, Self::LAG_AWARE].into_iter()
    }

    /// The method with this id.
    pub fn find(id: &str) -> Option<Self> {
        Self::all().find(|method| method.id() == id)
    }

    /// What it says of itself.
    pub fn spec(self) -> &'static MethodSpec {
        self.0
    }

    /// Its name in options and files.
    pub fn id(self) -> &'static str {
        self.0.id
    }
}

impl fmt::Debug for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.id())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::{FirstLast, Settings, TrialEstimate, estimate};
    use crate::experiment::Trial;
    use crate::units::SamplePeriod;

    /// Samples from the step of the input to the reaction.
    const DELAY: f64 = 12.0;

    /// What a method finds of one step without noise, with candidates `beta` samples apart.
    fn found(method: Method, beta: usize) -> TrialEstimate {
        let input = (0..200).map(|k| if k < 100 { 0.0 } else { 1.0 }).collect();
        let output = (0..200).map(|k| 0.2 * (f64::from(k) - 100.0 - DELAY).max(0.0)).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, input, output).unwrap();
        let usual = Settings::of(method);
        let settings = Settings { first_last: FirstLast::Keep, low_pass: None, beta, ..usual };
        estimate(&trial, &settings).unwrap()
    }

    #[test]
    fn ids_are_unique_and_in_kebab_case() {
        for method in Method::all() {
            let id = method.id();
            assert_eq!(Method::all().filter(|other| other.id() == id).count(), 1, "{id}");
            assert!(id.split('-').all(|word| !word.is_empty()), "{id}");
            assert!(id.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{id}");
            assert_eq!(Method::find(id), Some(method));
        }
        assert_eq!(Method::find("three-line"), None);
    }

    #[test]
    fn each_finds_the_delay_of_one_clean_step() {
        for method in Method::all() {
            let found = found(method, 1);
            let delay = found.decisions[0].accepted_delay();
            assert_eq!(found.decisions.len(), 1, "{method}");
            // Candidates are a sample apart.
            assert!(delay.is_some_and(|delay| (delay - DELAY).abs() <= 1.0), "{method}: {delay:?}");
        }
    }

    #[test]
    fn each_has_intervals_and_a_response_where_it_says_so() {
        for method in Method::all() {
            let spec = method.spec();
            let found = found(method, 1);
            let fine = found.decisions[0].fine;
            assert_eq!(fine.is_some(), spec.has_intervals, "{method}");
            let holds = |low: f64, high: f64| low - 1e-9 <= DELAY && DELAY <= high + 1e-9;
            assert!(fine.is_none_or(|fine| holds(fine.low, fine.high)), "{method}: {fine:?}");
            assert_eq!(found.onset_model.is_some(), spec.has_intervals, "{method}");
        }
    }

    #[test]
    fn each_is_in_the_documentation() {
        let documented = include_str!("../../docs/methods.md");
        for method in Method::all() {
            assert!(documented.contains(&format!("\n| `{method}` |")), "{method}");
        }
    }
}
