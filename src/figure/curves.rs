//! The curves of the speed as they were measured, with their bands, beside those of a model.

use super::panel::{Axis, Mark, Panel, Place, Role};
use super::span::Span;
use crate::diagnosis::{Curve, CurveOf};
use crate::experiment::Joint;
use crate::wording::bracketed;

/// The curves over one axis: the input's two branches where these differ, else one curve.
#[derive(Clone, Debug)]
pub(crate) struct Curves<'c> {
    first: &'c Curve,
    all: Vec<&'c Curve>,
}

impl<'c> Curves<'c> {
    /// Over the input, the angle and the time, as far as the record shows them.
    pub(crate) fn all(known: &'c [Curve]) -> impl Iterator<Item = Self> {
        let of = |wanted: &[CurveOf]| -> Vec<&Curve> {
            known.iter().filter(|curve| wanted.contains(&curve.of)).collect()
        };
        let branches = of(&[CurveOf::InputRising, CurveOf::InputFalling]);
        let input = if branches.is_empty() { of(&[CurveOf::Input]) } else { branches };
        let groups = [input, of(&[CurveOf::Angle]), of(&[CurveOf::Time])];
        groups.into_iter().filter_map(|all| Some(Self { first: *all.first()?, all }))
    }

    /// What they are over, as a part of a file's name.
    pub(crate) fn of(&self) -> &'static str {
        match self.first.of {
            CurveOf::Angle => "angle",
            CurveOf::Time => "time",
            CurveOf::Input | CurveOf::InputRising | CurveOf::InputFalling => "input",
        }
    }

    /// What they are over, in words.
    pub(crate) fn against(&self) -> &'static str {
        match (self.of(), self.all.len()) {
            ("angle", _) => "against the output",
            ("time", _) => "against the time",
            (_, 1) => "against the delayed input",
            _ => "against the delayed input, its levels reached from below and from above",
        }
    }

    /// How far the model is off where it is farthest beyond a band, in parts of the largest speed; 0
    /// where it is beyond none.
    pub(crate) fn departure(&self) -> f64 {
        let largest = self.places(|curve| &curve.y).fold(0.0_f64, |most, (_, y)| most.max(y.abs()));
        let off = self.all.iter().filter_map(|curve| farthest(curve));
        off.map(|(_, y, _, model)| (model - y).abs() / largest).fold(0.0, f64::max)
    }

    fn places(&self, values: fn(&Curve) -> &Vec<f64>) -> impl Iterator<Item = Place> {
        let all = self.all.iter();
        all.flat_map(move |curve| curve.x.iter().copied().zip(values(curve).iter().copied()))
    }

    /// What was measured, and what the model has, in the colour of `model`.
    pub(crate) fn panel(&self, joint: &Joint, model: Role) -> Panel {
        let (low, high) = (self.places(|curve| &curve.low), self.places(|curve| &curve.high));
        let bands = low.zip(high).map(|(low, high)| vec![low, high]);
        let ends = self.all.iter().flat_map(|curve| [&curve.low, &curve.high, &curve.model]);
        let y = Span::around(ends.flatten().copied(), 0.06);
        let x = Span::around(self.places(|curve| &curve.y).map(|place| place.0), 0.04);
        let output = joint.output_unit.as_deref();
        let speed = output.map(|unit| format!("{unit}/s"));
        let (across, up) = match self.of() {
            "angle" => (bracketed("output", output), "relative speed".to_owned()),
            "time" => ("time [s]".to_owned(), "relative speed".to_owned()),
            _ => (
                bracketed("delayed input", joint.input_unit.as_deref()),
                bracketed("speed", speed.as_deref()),
            ),
        };
        let lines = self.all.iter().map(|curve| {
            curve.x.iter().copied().zip(curve.model.iter().copied()).collect::<Vec<Place>>()
        });
        Panel {
            x: Axis::new(x, across, 6.0),
            y: Axis::new(y, up, 5.0),
            height: 200,
            marks: vec![
                Mark::lines(model, 1.6, lines.collect()).named("model"),
                Mark::lines(Role::Measured, 1.0, bands.collect()).part("bands"),
                Mark::dots(Role::Measured, self.places(|curve| &curve.y).collect())
                    .named("measured, with 95 % bands"),
            ],
        }
    }
}

/// Where the model is farthest beyond the band of a curve: the place, what was measured, half the
/// width of its band, and the model's value; none where it is within the band everywhere, or off by a
/// part of the curve that nobody sees.
pub(crate) fn farthest(curve: &Curve) -> Option<(f64, f64, f64, f64)> {
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
