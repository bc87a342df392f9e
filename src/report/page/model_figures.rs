//! What is drawn of a model: the ladder of errors, the share of the error by the feature that it goes
//! with most, and the measured curves beside the model's.

use super::document::{Figure, HALF, WIDTH};
use crate::diagnosis::{Curve, CurveOf, sensor_noise};
use crate::experiment::Joint;
use crate::figure::error_share::FeatureShares;
use crate::figure::ladder::{Rung, panel};
use crate::figure::{Axis, Mark, Panel, Role, Span};
use crate::report::ladder::LadderRow;
use crate::report::{ComparedJoint, ImprovedJoint};
use crate::wording::{bracketed, feature_with_unit};

/// A bar for the error of each revision, and the noise as a line.
pub(super) fn ladder(improved: &ImprovedJoint<'_>, file: String) -> Figure {
    let joint = improved.finding.compared.joint;
    let rows = improved.ladder();
    // A revision has its colour in all figures, and in the recording.
    let rung = |(place, row): (usize, &LadderRow)| Rung {
        name: format!("{}: {}", row.number, row.change),
        error: row.errors.judged(),
        training: row.errors.train_rmse.filter(|_| row.errors.validation_rmse.is_some()),
        role: Role::of_revision(place),
    };
    let rungs: Vec<Rung> = rows.iter().enumerate().map(rung).collect();
    let unit = joint.output_unit.as_deref();
    let name = (bracketed("root-mean-square error", unit), "ladder");
    let mut panel = panel(name, &rungs, (sensor_noise(&joint.trials), unit), 1.2);
    if let Some(first) = panel.marks.first_mut() {
        first.name = Some(judged_on(&rows).to_owned());
    }
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
            Mark::lines(Role::Model, 1.6, places(|curve| &curve.model)).named("model"),
            Mark::lines(Role::Measured, 1.0, bands.collect()),
            Mark::dots(Role::Measured, places(|curve| &curve.y).concat())
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
