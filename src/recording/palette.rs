//! Colours: one meaning each, distinct for colour-blind readers too.
//!
//! Taken from Okabe and Ito's set, on the viewer's dark ground.

use rerun::Color;

use crate::figure::Role;

pub(super) type Rgb = (u8, u8, u8);

/// What drove the joint.
pub(super) const INPUT: Rgb = (240, 228, 66);
/// What was measured.
pub(super) const RAW: Rgb = (150, 150, 150);
/// What the lines were fitted to.
pub(super) const SMOOTHED: Rgb = (86, 180, 233);
/// The candidate under the cursor.
pub(super) const CANDIDATE: Rgb = (255, 165, 40);
/// Accepted.
pub(super) const ACCEPTED: Rgb = (0, 190, 140);
/// Rejected.
pub(super) const REJECTED: Rgb = (235, 85, 60);
/// The error curve.
pub(super) const ERROR: Rgb = (204, 121, 167);
/// Borders of a segment.
pub(super) const BORDER: Rgb = (225, 225, 225);
/// The candidate that comes next: no revision has this colour.
pub(super) const PROPOSED: Rgb = (170, 255, 80);
/// What was measured, beside revisions.
pub(super) const MEASURED: Rgb = (200, 205, 210);
/// What noise alone would leave.
pub(super) const NOISE: Rgb = (86, 180, 233);
/// The viewer's own ground.
pub(super) const GROUND: Rgb = (13, 16, 17);
/// Grid lines.
pub(super) const GRID: Rgb = (60, 62, 66);

/// Models, one after the other, and what their colours are called; from the eleventh on they repeat.
const MODELS: [(Rgb, &str); 10] = [
    ((230, 159, 0), "orange"),
    ((0, 158, 115), "green"),
    ((204, 121, 167), "pink"),
    ((213, 94, 0), "vermilion"),
    ((120, 190, 255), "light blue"),
    ((240, 228, 66), "yellow"),
    ((160, 120, 240), "violet"),
    ((150, 220, 120), "light green"),
    ((255, 150, 150), "salmon"),
    ((0, 200, 210), "turquoise"),
];

/// The colours of models, one after the other.
pub(super) fn models() -> impl Iterator<Item = Rgb> {
    MODELS.into_iter().map(|(rgb, _)| rgb).cycle()
}

/// The model or revision of this number among those of a joint: it has this colour everywhere.
pub(super) fn model(number: usize) -> Rgb {
    MODELS[number % MODELS.len()].0
}

/// What that colour is called.
pub(super) fn name(number: usize) -> &'static str {
    MODELS[number % MODELS.len()].1
}

/// Models that a title has room to name with their colours.
pub(super) const NAMED: usize = 3;

/// Another result beside this one.
pub(super) const OTHER: Rgb = (180, 140, 255);

/// Results beside the first one; from the third on they repeat.
pub(super) fn others() -> impl Iterator<Item = Rgb> {
    [OTHER, (255, 190, 150)].into_iter().cycle()
}

/// A darker shade of a colour.
pub(super) fn dimmed((r, g, b): Rgb) -> Rgb {
    let half = |part: u8| part / 2;
    (half(r), half(g), half(b))
}

/// A colour in a drawing that has no meaning elsewhere.
pub(super) const fn role((r, g, b): Rgb) -> Role {
    Role::Own(r, g, b)
}

pub(super) fn color((r, g, b): Rgb) -> Color {
    Color::from_rgb(r, g, b)
}

/// A setting whose delay is that of most.
pub(super) const SAME: Rgb = (105, 112, 120);
/// Such a setting in a picture of all settings, where it is the ground.
pub(super) const SAME_GROUND: Rgb = (58, 64, 71);
/// A setting with a longer delay.
pub(super) const LONGER: Rgb = (240, 140, 30);
/// A setting with a shorter delay.
pub(super) const SHORTER: Rgb = (70, 170, 240);
/// A setting that does not accept a step.
pub(super) const SILENT: Rgb = (0, 0, 0);
/// The setting or the step under the cursor.
pub(super) const HERE: Rgb = (255, 255, 255);

/// So much of the way from one colour to another.
pub(super) fn between(from: Rgb, to: Rgb, part: f64) -> Rgb {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a byte")]
    let mix = |a: u8, b: u8| (f64::from(a) + part * (f64::from(b) - f64::from(a))).round() as u8;
    (mix(from.0, to.0), mix(from.1, to.1), mix(from.2, to.2))
}
