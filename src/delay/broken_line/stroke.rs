//! A stroke from rest to rest: where the output starts, and where it stops although the
//! input stays, as at an end stop.
//!
//! Half of the way is certainly between the two, so that each half has one break and is
//! fitted by its own broken line. What a joint does far from a break says little of it: each
//! line is fitted again to what is near. Where the speed changes by a tenth within that, the
//! break is found up to 0.8 samples early.

use super::window::{BrokenLine, broken_line};
use crate::numerics::Line;
use crate::units::ceil_to_index;

/// Samples to each side of a break that are looked at.
const NEAR: usize = 40;

/// Times that what is near is looked at about the break that was found before.
const ROUNDS: usize = 3;

/// Where a stroke starts and where it ends; positions are indices of its samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// From rest to motion.
    pub onset: BrokenLine,
    /// From motion to rest.
    pub stop: BrokenLine,
}

/// The stroke in `values`, which begin and end at rest; intervals hold the true breaks as
/// often as `confidence` says. `None` where the output does not move or either half is too
/// short.
///
/// # Examples
/// ```
/// use tauscope::delay::stroke;
///
/// let values: Vec<f64> = (0..200).map(|k| (f64::from(k) - 20.5).clamp(0.0, 90.2)).collect();
/// let found = stroke(&values, 0.95).unwrap();
/// assert!((found.onset.position - 20.5).abs() < 1e-9);
/// assert!((found.stop.position - 110.7).abs() < 1e-9);
/// ```
pub fn stroke(values: &[f64], confidence: f64) -> Option<Stroke> {
    let (first, last) = (values.first()?, values.last()?);
    let (half, way) = (f64::midpoint(*first, *last), last - first);
    // Half of the way is behind the onset and before the stop.
    let middle = values.iter().position(|value| (value - half) * way > 0.0)?;
    let near = |low: usize, high: usize| {
        let mut found = placed(values, low, high, confidence)?;
        for _ in 0..ROUNDS {
            let at = ceil_to_index(found.position);
            let from = low.max(at.saturating_sub(NEAR));
            found = placed(values, from, high.min(at + NEAR), confidence)?;
        }
        Some(found)
    };
    Some(Stroke { onset: near(0, middle)?, stop: near(middle, values.len())? })
}

/// The broken line through the values from `low` up to `high`, over indices of all of them.
fn placed(values: &[f64], low: usize, high: usize, confidence: f64) -> Option<BrokenLine> {
    let mut found = broken_line(values.get(low..high)?, confidence)?;
    let by = low as f64;
    let shifted = |line: Line| Line { intercept: line.intercept - line.slope * by, ..line };
    (found.position, found.low, found.high) =
        (found.position + by, found.low + by, found.high + by);
    (found.before, found.after) = (shifted(found.before), shifted(found.after));
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stroke from 30.3 to 220.6 whose speed falls, and how early its breaks are found.
    fn found(slowing: f64) -> (Stroke, [f64; 2]) {
        let speed = |k: f64| 2.0 - k / slowing;
        let way = |k: f64| if k < 30.3 { 0.0 } else { (k.min(220.6) - 30.3) * speed(k.min(220.6)) };
        let noise = |k: i32| f64::from(k * 7919 % 13 - 6) * 0.02;
        let values: Vec<f64> = (0..300).map(|k| 50.0 - way(f64::from(k)) + noise(k)).collect();
        let found = stroke(&values, 0.95).unwrap();
        let early = [30.3 - found.onset.position, 220.6 - found.stop.position];
        (found, early)
    }

    #[test]
    fn a_stroke_that_slows_down_still_stops_where_it_stops() {
        let (found, early) = found(1600.0);
        assert!(early.iter().all(|early| early.abs() < 0.2), "{early:?}");
        let met =
            (found.stop.before.at(found.stop.position), found.stop.after.at(found.stop.position));
        assert!((met.0 - met.1).abs() < 1e-9, "{found:?}");
        let (_, early) = self::found(400.0);
        assert!(early.iter().all(|early| (0.0..0.8).contains(early)), "{early:?}");
    }

    #[test]
    fn rest_is_no_stroke() {
        assert_eq!(stroke(&[1.0; 50], 0.95), None);
        assert_eq!(stroke(&[], 0.95), None);
        assert_eq!(stroke(&[0.0, 1.0], 0.95), None);
    }
}
