//! Arguments of `design`: levels, pairs and shares.

use crate::numerics::to_decimals;

/// Levels of an input, each once, ascending.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Levels(pub(crate) Vec<f64>);

/// What becomes of the dead band, and which.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum BandChoice {
    /// A level lies in that of the model.
    Cross,
    /// None does.
    Avoid,
    /// None lies in this one.
    Given(f64, f64),
}

pub(crate) fn levels(text: &str) -> Result<Levels, String> {
    /// More than anybody plays.
    const MOST: usize = 100;
    let expected = || "expected two levels or more, as in -2,-1,0,1,2 or -2..2:0.5".to_owned();
    let mut levels = match text.split_once("..") {
        Some((first, rest)) => range(first, rest, MOST).ok_or_else(expected)?,
        None => text.split(',').map(finite).collect::<Option<Vec<f64>>>().ok_or_else(expected)?,
    };
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    if levels.len() < 2 {
        return Err(expected());
    }
    if levels.len() > MOST {
        return Err(format!("more than {MOST} levels"));
    }
    Ok(Levels(levels))
}

/// `first`, and on in steps, as long as `most` and one more.
fn range(first: &str, rest: &str, most: usize) -> Option<Vec<f64>> {
    let (last, step) = rest.split_once(':')?;
    let (first, last, step) = (finite(first)?, finite(last)?, finite(step)?);
    if step <= 0.0 || last < first {
        return None;
    }
    // The last level belongs to the range, however its multiple is rounded.
    let end = last + 1e-9 * step;
    let level = |k: usize| {
        let level = first + k as f64 * step;
        // Zero is meant where rounding leaves a little.
        if level.abs() < 1e-9 * step { 0.0 } else { to_decimals(level, 9) }
    };
    Some((0..=most).map(level).take_while(|level| *level <= end).collect())
}

/// A number that inputs, outputs and seconds can have: squares of larger ones leave double precision,
/// and so do the inverses of smaller ones.
fn finite(text: &str) -> Option<f64> {
    const RANGE: std::ops::RangeInclusive<f64> = 1e-12..=1e12;
    let number = text.trim().parse().ok();
    number.filter(|number: &f64| *number == 0.0 || RANGE.contains(&number.abs()))
}

pub(crate) fn number(text: &str) -> Result<f64, String> {
    finite(text).ok_or_else(|| "expected a number, as in 12.5".to_owned())
}

pub(crate) fn ascending(text: &str) -> Result<(f64, f64), String> {
    pair(text).ok_or_else(|| "expected two numbers, the lower one first, as in 0.9,2".to_owned())
}

fn pair(text: &str) -> Option<(f64, f64)> {
    let (low, high) = text.split_once(',')?;
    let (low, high) = (finite(low)?, finite(high)?);
    (low <= high).then_some((low, high))
}

pub(crate) fn band(text: &str) -> Result<BandChoice, String> {
    match text {
        "cross" => Ok(BandChoice::Cross),
        "avoid" => Ok(BandChoice::Avoid),
        _ => {
            let given = pair(text).map(|(low, high)| BandChoice::Given(low, high));
            given.ok_or_else(|| "expected cross, avoid, or two ends, as in -0.4,0.4".to_owned())
        }
    }
}

pub(crate) fn above_zero(text: &str) -> Result<f64, String> {
    finite(text).filter(|x| *x > 0.0).ok_or_else(|| "expected a number above zero".to_owned())
}

pub(crate) fn share(text: &str) -> Result<f64, String> {
    let share = finite(text).filter(|share| (0.0..1.0).contains(share));
    share.ok_or_else(|| "expected a share from 0 and below 1".to_owned())
}

pub(crate) fn power(text: &str) -> Result<f64, String> {
    let power = finite(text).filter(|power| *power > 0.0 && *power < 1.0);
    power.ok_or_else(|| "expected a probability above 0 and below 1".to_owned())
}

pub(crate) fn rehearsals(text: &str) -> Result<usize, String> {
    const MOST: usize = 10_000;
    let number = text.parse().ok().filter(|number| *number <= MOST);
    number.ok_or_else(|| format!("expected a whole number from 0 to {MOST}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_a_list_or_a_range() {
        assert_eq!(levels("2, -1,0,-1"), Ok(Levels(vec![-1.0, 0.0, 2.0])));
        assert_eq!(levels("-1..1:0.5"), Ok(Levels(vec![-1.0, -0.5, 0.0, 0.5, 1.0])));
        assert_eq!(levels("-0.3..0.3:0.1").map(|levels| levels.0.len()), Ok(7));
        for wrong in ["", "1", "1,1", "1,x", "1..2", "2..1:0.5", "0..1:0", "0..1:nan"] {
            assert!(levels(wrong).is_err_and(|why| why.starts_with("expected")), "{wrong}");
        }
        assert!(levels("0..1000:0.1").is_err_and(|why| why.contains("more than 100")));
    }

    #[test]
    fn pairs_ascend() {
        assert_eq!(ascending("0.9,2"), Ok((0.9, 2.0)));
        assert!(ascending("2,0.9").is_err() && ascending("2").is_err());
        assert_eq!(band("-0.4,0.4"), Ok(BandChoice::Given(-0.4, 0.4)));
        assert_eq!(band("avoid"), Ok(BandChoice::Avoid));
        assert!(band("across").is_err_and(|why| why.contains("avoid")));
    }
}
