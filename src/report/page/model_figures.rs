//! What is drawn of a model: the ladder of errors, the share of the error by the feature that it goes
//! with most, and the measured curves beside the model's.

use super::document::{Figure, HALF, WIDTH};
use crate::diagnosis::{Curve, CurveOf, sensor_noise};
use crate::experiment::Joint;
use crate::figure::error_share::FeatureShares;
use crate::figure::{Axis, Mark, Panel, Role, Shape, Span};
use crate::report::ladder::LadderRow;
use crate::report::{ComparedJoint, ImprovedJoint};
use crate::units::floor_to_index;
use crate::wording::{bracketed, feature_with_unit, number};

/// A bar for the error of each revision, and the noise as a line.
pub(super) fn ladder(improved: &ImprovedJoint<'_>, file: String) -> Figure {
    let joint = improved.finding.compared.joint;
    let rungs = improved.ladder();
    let name = |row: &LadderRow| format!("{}: {}", row.number, row.change);
    let names: Vec<String> = rungs.iter().map(name).collect();
    let errors: Vec<f64> = rungs.iter().map(|row| row.errors.judged().unwrap_or(0.0)).collect();
    let bar =
        |(row, error): (u32, &f64)| ((0.0, -f64::from(row) - 0.3), (*error, 0.3 - f64::from(row)));
    let words = |(row, error): (u32, &f64)| ((*error, -f64::from(row)), number(*error));
    let largest = errors.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let noise = sensor_noise(&joint.trials);
    let rows = || (0..).zip(&errors);
    // A revision has its colour in all figures, and in the recording.
    let bars = rows().map(|(row, error)| {
        let role = Role::of_revision(floor_to_index(f64::from(row)));
        Mark::new(role, Shape::Bars(vec![bar((row, error))]))
    });
    let mut marks: Vec<Mark> = bars.collect();
    if let Some(first) = marks.first_mut() {
        first.name = Some(judged_on(&rungs).to_owned());
    }
    marks.push(Mark::new(Role::Ink, Shape::Words(rows().map(words).collect())));
    marks.extend(noise.map(|noise| {
        Mark::new(Role::Noise, Shape::Verticals(vec![noise], 1.2)).named("noise of the sensor")
    }));
    let name = bracketed("root-mean-square error", joint.output_unit.as_deref());
    let panel = Panel {
        x: Axis::new(Span::new(0.0, 1.15 * largest.max(noise.unwrap_or(0.0))), name, 6.0),
        y: Axis::of_names(&names, ""),
        height: 24 * u32::try_from(names.len()).unwrap_or(1) + 10,
        marks,
    };
    let name = format!("Errors of the revisions of {}", joint.name);
    let caption = "How the error falls from revision to revision.".to_owned();
    Figure { file, name, width: WIDTH, panels: vec![panel], caption }
}

fn judged_on(rungs: &[LadderRow]) -> &'static str {
    let validated = rungs.iter().all(|row| row.errors.validation_rmse.is_some());
    if validated { "error on data that were not fitted" } else { "error" }
}

/// Shares of the squared error and of the time in each part of the feature whose parts
/// differ most in them.
pub(super) fn share(compared: &ComparedJoint<'_>, file: String) -> Option<Figure> {
    let features = FeatureShares::all(&compared.comparison.regions);
    let found = features.max_by(|a, b| a.unevenness().total_cmp(&b.unevenness()));
    let (shares, feature) = found.and_then(|found| Some((found, found.feature()?)))?;
    let joint = compared.joint;
    let by = feature_with_unit(feature, joint);
    let name = format!("Share of the error of {}", joint.name);
    let caption = format!(
        "Where the error arises, by {by}: the squared error of the speed, {}. A bar beyond its mark is \
         a part with too much of it.",
        compared.comparison.arising
    );
    let panel = shares.panel(joint, &[(Role::Error, compared.comparison)])?;
    Some(Figure { file, name, width: HALF, panels: vec![panel], caption })
}

/// A figure for the input, one for the angle and one for the time, as far as the record shows them.
pub(super) fn curves(compared: &ComparedJoint<'_>, file: &str) -> Vec<Figure> {
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
        .map(|(curves, name)| curve(compared.joint, &curves, format!("{file}-curve-{name}")))
        .collect()
}

fn curve(joint: &Joint, curves: &[&Curve], file: String) -> Figure {
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
    } else {
        let caption = match curves.len() {
            1 => "against the delayed input",
            _ => "against the delayed input, its levels reached from below and from above",
        };
        (bracketed("delayed input", of_input), bracketed("speed", speed.as_deref()), caption)
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
    let name = format!("Speed of {} {caption}", joint.name);
    let caption = format!(
        "The speed in settled parts of the holds, {caption}, behind the delay; each curve is free of \
         what the others explain."
    );
    Figure { file, name, width: HALF, panels: vec![panel], caption }
}
