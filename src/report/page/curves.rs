//! The measured curves of a joint beside the model's.

use super::document::Figure;
use super::layout::HALF;
use super::plot::{PlotError, draw};
use crate::diagnosis::{Curve, CurveOf};
use crate::experiment::Joint;
use crate::figure::{Axis, Mark, Panel, Role, Shape, Span};
use crate::report::ComparedJoint;
use crate::wording::bracketed;

/// A figure for the input, one for the angle and one for the time, as far as the record shows them.
pub(super) fn figures(compared: &ComparedJoint<'_>, file: &str) -> Result<Vec<Figure>, PlotError> {
    let curves = &compared.comparison.curves;
    let of = |wanted: &[CurveOf]| -> Vec<&Curve> {
        curves.iter().filter(|curve| wanted.contains(&curve.of)).collect()
    };
    let branches = of(&[CurveOf::InputRising, CurveOf::InputFalling]);
    let input = if branches.is_empty() { of(&[CurveOf::Input]) } else { branches };
    let groups =
        [(input, "input"), (of(&[CurveOf::Angle]), "angle"), (of(&[CurveOf::Time]), "time")];
    let shown = groups.into_iter().filter(|(curves, _)| !curves.is_empty());
    shown
        .map(|(curves, name)| figure(compared.joint, &curves, format!("{file}-curve-{name}")))
        .collect()
}

fn figure(joint: &Joint, curves: &[&Curve], file: String) -> Result<Figure, PlotError> {
    let places = |values: fn(&Curve) -> &Vec<f64>| {
        let of = move |curve: &&Curve| {
            let pairs = curve.x.iter().copied().zip(values(curve).iter().copied());
            pairs.collect::<Vec<(f64, f64)>>()
        };
        curves.iter().map(of).collect::<Vec<_>>()
    };
    let bands = curves.iter().flat_map(|curve| {
        let ends = curve.low.iter().zip(&curve.high);
        curve.x.iter().zip(ends).map(|(x, (low, high))| vec![(*x, *low), (*x, *high)])
    });
    let all = curves.iter().flat_map(|curve| [&curve.low, &curve.high, &curve.model]).flatten();
    let y = Span::around(all.copied(), 0.06);
    let x = Span::around(curves.iter().flat_map(|curve| curve.x.iter().copied()), 0.04);
    let (of_input, of_output) = (joint.input_unit.as_deref(), joint.output_unit.as_deref());
    let speed = of_output.map(|unit| format!("{unit}/s"));
    let is_of = |of: CurveOf| curves.iter().all(|curve| curve.of == of);
    let (across, up, caption) = if is_of(CurveOf::Angle) {
        (bracketed("angle", of_output), "relative speed".to_owned(), "against the angle")
    } else if is_of(CurveOf::Time) {
        ("time [s]".to_owned(), "relative speed".to_owned(), "against the time")
    } else if curves.len() > 1 {
        let (across, up) =
            (bracketed("delayed input", of_input), bracketed("speed", speed.as_deref()));
        (across, up, "against the delayed input, its levels reached from below and from above")
    } else {
        let (across, up) =
            (bracketed("delayed input", of_input), bracketed("speed", speed.as_deref()));
        (across, up, "against the delayed input")
    };
    let panel = Panel {
        x: Axis::new(x, across, 6.0),
        y: Axis::new(y, up, 5.0),
        height: 200,
        marks: vec![
            Mark::new(Role::Model, Shape::Lines(places(|curve| &curve.model), 1.6)).named("model"),
            Mark::new(Role::Measured, Shape::Lines(bands.collect(), 1.0)),
            Mark::new(Role::Measured, Shape::Dots(places(|curve| &curve.y).concat()))
                .named("measured, with 95 % bands"),
        ],
    };
    let svg = draw(&[panel], HALF, &format!("Speed of {} {caption}", joint.name))?;
    let caption = format!(
        "The speed in settled parts of the holds, {caption}, behind the delay; each curve is free of \
         what the others explain."
    );
    Ok(Figure { file, svg, caption })
}
