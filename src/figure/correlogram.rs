//! How the residual is correlated with itself and with the input, lag by lag.

use super::panel::{Axis, Mark, Panel, Place, Role, Shape};
use super::span::Span;
use crate::diagnosis::Comparison;

/// What is correlated in the three correlograms.
const NAMES: [&str; 3] = [
    "residual with itself",
    "changes with the acting input's",
    "changes with the measured input's",
];

/// Why there is no correlation.
const NOT_KNOWN: &str = "not computed, since sample periods differ or samples are too few";

/// A panel for each of them: a curve and a band per model.
pub(crate) fn panels(models: &[(Role, &Comparison)]) -> [Panel; 3] {
    [0, 1, 2].map(|place| {
        let known = models.iter().filter_map(|(role, one)| Some((*role, correlogram(one, place)?)));
        let known: Vec<(Role, Correlogram)> = known.collect();
        let curves = || known.iter().map(|(_, one)| one);
        let places = || curves().flat_map(|(curve, _)| curve.iter().copied());
        // Twice the band has room.
        let room = curves().flat_map(|(_, band)| [0.0, 2.0 * band, -2.0 * band]);
        let x = Span::around(places().map(|place| place.0).chain(curves().map(|_| 0.0)), 0.0);
        let y = Span::around(places().map(|place| place.1).chain(room), 0.1);
        let zero = vec![vec![(x.low, 0.0), (x.high, 0.0)], vec![(0.0, y.low), (0.0, y.high)]];
        let mut marks = vec![Mark::lines(Role::Faint, 0.8, zero)];
        for (role, (curve, band)) in &known {
            marks.push(Mark::new(*role, Shape::Band(-band, *band)));
            marks.push(Mark::lines(*role, 1.3, vec![curve.clone()]));
        }
        if known.is_empty() {
            let words = vec![((x.low, f64::midpoint(y.low, y.high)), NOT_KNOWN.to_owned())];
            marks = vec![Mark::new(Role::Ink, Shape::Words(words))];
        }
        let (x, y) = (Axis::new(x, "lag [s]", 4.0), Axis::new(y, NAMES[place], 3.0));
        Panel { x, y, height: 190, marks }
    })
}

/// Lag in seconds and correlation, and what correlations of noise stay between, with its negative.
type Correlogram = (Vec<Place>, f64);

/// That of a model at this place among the [`NAMES`].
fn correlogram(comparison: &Comparison, place: usize) -> Option<Correlogram> {
    let (first_s, step_s, correlation, band) = if place == 0 {
        let itself = comparison.whiteness.as_ref()?;
        (itself.lag_step_s, itself.lag_step_s, &itself.correlation, itself.band)
    } else {
        let all = comparison.input_correlation.as_ref()?;
        let one = if place == 1 { &all.acting } else { &all.raw };
        (all.first_lag_s, all.lag_step_s, &one.correlation, one.band)
    };
    let places = correlation.iter().enumerate().map(|(k, r)| (first_s + k as f64 * step_s, *r));
    Some((places.collect(), band))
}
