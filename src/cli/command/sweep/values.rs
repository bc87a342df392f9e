//! Several values of a setting in one argument: `1,2,5`, `1..10`, `2..20:2`.

use std::fmt;

use crate::delay::Method;

use crate::cli::args::number::{OrNone, at_least_one, length};
use crate::cli::args::passband;
use crate::experiment::{did_you_mean, nearest_name};
use crate::units::Length;

/// Most values of one range.
const MOST: usize = 1000;

/// The values of an argument, each once, in their order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Values<T>(pub(crate) Vec<T>);

impl Values<Method> {
    /// Every method.
    pub(super) fn all() -> Self {
        // `auto` is one of the others.
        Self(Method::all().filter(|method| *method != Method::AUTO).collect())
    }
}

impl fmt::Display for Values<Method> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ids: Vec<_> = self.0.iter().map(|method| method.id()).collect();
        f.write_str(&ids.join(","))
    }
}

/// Lengths of time: whole numbers of samples from 1 up, or seconds.
pub(crate) fn lengths(text: &str) -> Result<Values<Length>, String> {
    let expected = "expected whole numbers from 1 up, as in 1,2,5 or 1..10 or 2..20:2, or \
                    seconds as in 0.05s,0.1s";
    let whole = |text: &str| at_least_one(text).ok().ok_or_else(|| expected.to_owned());
    listed(text, |part| match Range::of(part) {
        None => Ok(vec![length(part).ok().ok_or_else(|| expected.to_owned())?]),
        Some(range) => {
            let (first, last) = (whole(range.first)?, whole(range.last)?);
            let values = (first..=last).step_by(range.step.map_or(Ok(1), whole)?);
            range.checked(values.map(Length::Samples).take(MOST + 1).collect())
        }
    })
}

/// Cutoffs in Hz, and `none`.
pub(crate) fn passbands(text: &str) -> Result<Values<OrNone>, String> {
    let expected = "expected frequencies in Hz, or `none`, as in 2,5,none or 1..10 or 1..2:0.5";
    let one = |text: &str| passband(text).ok().ok_or_else(|| expected.to_owned());
    let hz = |text: &str| one(text)?.number().ok_or_else(|| expected.to_owned());
    listed(text, |part| match Range::of(part) {
        None => Ok(vec![one(part)?]),
        Some(range) => {
            let (first, last) = (hz(range.first)?, hz(range.last)?);
            let step = range.step.map_or(Ok(1.0), hz)?;
            // The last value belongs to the range, however its multiple is rounded.
            let end = last + 1e-9 * step;
            let values = (0_u32..).map(|n| first + f64::from(n) * step);
            let values = values.take_while(|value| *value <= end).map(OrNone::Number);
            range.checked(values.take(MOST + 1).collect())
        }
    })
}

/// Names of methods.
pub(crate) fn methods(text: &str) -> Result<Values<Method>, String> {
    let one = |name: &str| {
        let ids = || Method::all().map(Method::id);
        let expected = || {
            let names: Vec<_> = ids().collect();
            let near = did_you_mean(nearest_name(name, ids()));
            format!("expected some of {}{near}", names.join(", "))
        };
        Method::find(name).map(|method| vec![method]).ok_or_else(expected)
    };
    listed(text, one)
}

/// What the parts of a list say, each value once.
fn listed<T: PartialEq>(
    text: &str,
    part: impl Fn(&str) -> Result<Vec<T>, String>,
) -> Result<Values<T>, String> {
    let mut found: Vec<T> = Vec::new();
    for text in text.split(',') {
        for value in part(text.trim())? {
            if !found.contains(&value) {
                found.push(value);
            }
        }
    }
    Ok(Values(found))
}

/// `first..last` or `first..last:step`, both ends included.
struct Range<'a> {
    text: &'a str,
    first: &'a str,
    last: &'a str,
    step: Option<&'a str>,
}

impl<'a> Range<'a> {
    fn of(text: &'a str) -> Option<Self> {
        let (first, rest) = text.split_once("..")?;
        let (last, step) = match rest.split_once(':') {
            Some((last, step)) => (last, Some(step)),
            None => (rest, None),
        };
        Some(Self { text, first, last, step })
    }

    /// Its values, unless there are none or too many.
    fn checked<T>(&self, values: Vec<T>) -> Result<Vec<T>, String> {
        match values.len() {
            0 => Err(format!("the range `{}` ends before it begins", self.text)),
            1..=MOST => Ok(values),
            _ => Err(format!("the range `{}` has more than {MOST} values", self.text)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_and_ranges_name_each_value_once() {
        let whole =
            |samples: &[usize]| Ok(Values(samples.iter().copied().map(Length::Samples).collect()));
        assert_eq!(lengths("5,10,20"), whole(&[5, 10, 20]));
        assert_eq!(lengths("1..4, 3,9"), whole(&[1, 2, 3, 4, 9]));
        assert_eq!(lengths("2..9:3"), whole(&[2, 5, 8]));
        let mixed = vec![Length::Seconds(0.05), Length::Seconds(0.1), Length::Samples(3)];
        assert_eq!(lengths("0.05s,0.1s,3"), Ok(Values(mixed)));
        let hz = |values: &[f64]| values.iter().map(|hz| OrNone::Number(*hz)).collect::<Vec<_>>();
        assert_eq!(passbands("1..2:0.5"), Ok(Values(hz(&[1.0, 1.5, 2.0]))));
        let last = passbands("5,none").map(|found| found.0.last().copied());
        assert_eq!(last, Ok(Some(OrNone::None)));
        assert_eq!(methods("hinge,two-line"), Ok(Values(vec![Method::HINGE, Method::TWO_LINE])));
    }

    #[test]
    fn what_is_no_list_says_what_would_be() {
        for wrong in ["", "0", "1,,2", "4..2", "1..1000000000", "1..", "a..b", "1..3:0", "-1..3"] {
            assert!(lengths(wrong).is_err(), "{wrong}");
        }
        for wrong in ["", "0", "none..5", "5..1", "1e-9..5:1e-9", "nan", "1..inf"] {
            assert!(passbands(wrong).is_err(), "{wrong}");
        }
        assert!(methods("hinge,tow-line").is_err_and(|why| why.contains("mean `two-line`")));
    }
}
