//! Where a function of one number crosses zero, or a condition ends, within a bracket.

/// The bracket between a place where a condition `holds` and one where it does not, halved so many `times`.
pub(crate) fn halved(
    (mut inside, mut outside): (f64, f64),
    times: usize,
    mut holds: impl FnMut(f64) -> bool,
) -> (f64, f64) {
    for _ in 0..times {
        let middle = f64::midpoint(inside, outside);
        *(if holds(middle) { &mut inside } else { &mut outside }) = middle;
    }
    (inside, outside)
}

/// Asks for `above`, which rises with its argument, until last at a place where it is zero, or as near to
/// that as anywhere.
///
/// A secant within a bracket, where the value at an end that stays is halved (Illinois algorithm: M. Dowell
/// and P. Jarratt, "A modified regula falsi method for computing the root of an equation", BIT 11, 1971).
pub(crate) fn settle_at_root(mut above: impl FnMut(f64) -> f64) {
    /// Doublings of the bracket, and secants within it, at most.
    const STEPS: usize = 50;
    /// What is left of the rise over the bracket.
    const LEFT: f64 = 1e-14;
    let mut at = |place: f64| (place, above(place));
    let (mut low, mut high) = (at(-1.0), at(1.0));
    for _ in 0..STEPS {
        if low.1 > 0.0 {
            (low, high) = (at(2.0 * low.0), low);
        } else if high.1 < 0.0 {
            (low, high) = (high, at(2.0 * high.0));
        }
    }
    let rise = high.1 - low.1;
    let mut rose = None;
    for _ in 0..STEPS {
        let secant = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        if !(low.0..=high.0).contains(&secant) {
            break;
        }
        let found = at(secant);
        if found.1.abs() <= LEFT * rise {
            break;
        }
        let is_below = found.1 < 0.0;
        let (moved, stays) = if is_below { (&mut low, &mut high) } else { (&mut high, &mut low) };
        if rose == Some(is_below) {
            stays.1 *= 0.5;
        }
        (*moved, rose) = (found, Some(is_below));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where the search ends, and how often it asked.
    fn root(above: impl Fn(f64) -> f64) -> (f64, usize) {
        let (mut last, mut count) = (f64::NAN, 0);
        settle_at_root(|place| {
            (last, count) = (place, count + 1);
            above(place)
        });
        (last, count)
    }

    #[test]
    fn a_condition_ends_within_the_bracket_on_either_side() {
        assert_eq!(halved((0.0, 1.0), 3, |x| x < 0.3), (0.25, 0.375));
        assert_eq!(halved((0.0, -1.0), 3, |x| x > -0.3), (-0.25, -0.375));
    }

    #[test]
    fn a_root_is_found_in_a_few_steps() {
        let (place, count) = root(|x| 3.0 * x - 1.5);
        assert!((place - 0.5).abs() < 1e-12 && count <= 4, "{place} after {count}");
        let (place, count) = root(|x: f64| x.cbrt() - 4.0);
        assert!((place - 64.0).abs() < 1e-6 && count < 60, "{place} after {count}");
        // Where it jumps over zero, the place of the jump.
        let (place, _) = root(|x| if x < -0.3 { -1.0 } else { 2.0 });
        assert!((place + 0.3).abs() < 1e-6, "{place}");
    }

    #[test]
    fn what_has_no_root_ends_where_it_is_nearest() {
        let (place, _) = root(|x: f64| x.tanh() - 2.0);
        assert!(place > 20.0, "{place}");
        let (place, _) = root(|x: f64| x.tanh() + 2.0);
        assert!(place < -20.0, "{place}");
    }
}
