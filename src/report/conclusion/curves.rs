//! How the measured speed depends on input, angle and time, where the model says otherwise.

use super::{Passage, Topic};
use crate::diagnosis::{Curve, CurveOf};
use crate::report::finding::Finding;
use crate::wording::{measure, rounded, unit_suffix};

impl Finding<'_> {
    /// Each measured curve on which the model leaves the band, with the place where it does most.
    pub(super) fn curves(&self) -> Option<Passage> {
        let sentences = self.comparison().curves.iter().filter_map(|curve| self.curve(curve));
        Passage::of(Topic::Curves, sentences)
    }

    fn curve(&self, curve: &Curve) -> Option<String> {
        let (x, y, band, model) = farthest(curve)?;
        let joint = self.joint();
        let speed = joint.output_unit.as_deref().map(|unit| format!("{unit}/s"));
        let input = unit_suffix(joint.input_unit.as_deref());
        let between = |what: &str| {
            let (y, model) = (rounded(y), measure(model, speed.as_deref()));
            format!(
                "At {what} {}{input} the measured speed is {y} ± {}, the model's {model}.",
                rounded(x),
                rounded(band)
            )
        };
        let gain = |place: String| {
            format!(
                "{place} the measured speed is {} ± {} times that of the whole record, the model's {}.",
                rounded(y),
                rounded(band),
                rounded(model)
            )
        };
        Some(match curve.of {
            CurveOf::Input => between("a delayed input of"),
            CurveOf::InputRising => between("a delayed input, reached from below, of"),
            CurveOf::InputFalling => between("a delayed input, reached from above, of"),
            CurveOf::Angle => gain(format!("At {}", measure(x, joint.output_unit.as_deref()))),
            CurveOf::Time => gain(format!("{} s after the start", rounded(x))),
        })
    }
}

/// Where the model is farthest beyond the band of a curve: the place, what was measured, half the
/// width of its band, and the model's value; none where it is within the band everywhere, or off by a
/// part of the curve that nobody sees.
fn farthest(curve: &Curve) -> Option<(f64, f64, f64, f64)> {
    /// Part of the curve's largest value that is seen in a drawing.
    const SEEN: f64 = 0.02;
    /// Half widths of a 95 % band: of the few dozen points of all curves none is out by chance.
    const BEYOND: f64 = 1.8;
    let largest = curve.y.iter().fold(0.0_f64, |largest, y| largest.max(y.abs()));
    let points = curve.x.iter().zip(&curve.y).zip(curve.high.iter().zip(&curve.model));
    let off = points.map(|((x, y), (high, model))| (*x, *y, high - y, *model));
    let times = |(_, y, band, model): &(f64, f64, f64, f64)| {
        (model - y).abs() / band.max(f64::MIN_POSITIVE)
    };
    let seen = off.filter(|point| {
        let (_, y, _, model) = *point;
        times(point) > BEYOND && (model - y).abs() > SEEN * largest
    });
    seen.max_by(|a, b| (a.1 - a.3).abs().total_cmp(&(b.1 - b.3).abs()))
}
