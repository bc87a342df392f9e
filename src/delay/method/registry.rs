//! The registry of methods.

use super::by_onset::ByOnset;
use super::interface::DelayMethod;
use super::two_line::TwoLine;
use crate::delay::spec::Method;

/// Every method, in the order the documentation lists them.
const REGISTRY: [&dyn DelayMethod; 4] =
    [&ByOnset::AUTO, &TwoLine, &ByOnset::HINGE, &ByOnset::LAG_AWARE];

impl Method {
    /// Every method, in the order the documentation lists them.
    pub fn all() -> impl ExactSizeIterator<Item = Self> {
        REGISTRY.iter().map(|entry| entry.method())
    }

    /// The method with this id.
    pub fn find(id: &str) -> Option<Self> {
        Self::all().find(|method| method.id() == id)
    }
}

/// What does the work of `method`.
pub(in crate::delay) fn implementation(method: Method) -> &'static dyn DelayMethod {
    let found = REGISTRY.into_iter().find(|entry| entry.method() == method);
    // Handles are made in this folder alone, and one that isn't registered has no use for its
    // implementation, which the compiler points out.
    found.unwrap_or_else(|| unreachable!("`{method}` is not in the registry"))
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
            assert_eq!(Settings::of(method).check(), Ok(()), "{method}");
        }
    }

    #[test]
    fn each_is_in_the_documentation() {
        let documented = include_str!("../../../docs/methods.md");
        for method in Method::all() {
            assert!(documented.contains(&format!("\n| `{method}` |")), "{method}");
        }
    }
}
