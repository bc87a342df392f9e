//! Colours: one meaning each, distinct for colour-blind readers too.
//!
//! Taken from Okabe and Ito's set, on the viewer's dark ground.

use rerun::Color;

const fn rgb(r: u8, g: u8, b: u8) -> (u8, u8, u8) {
    (r, g, b)
}

pub(super) type Rgb = (u8, u8, u8);

/// What drove the joint.
pub(super) const INPUT: Rgb = rgb(240, 228, 66);
/// What was measured.
pub(super) const RAW: Rgb = rgb(150, 150, 150);
/// What the lines were fitted to.
pub(super) const SMOOTHED: Rgb = rgb(86, 180, 233);
/// The candidate under the cursor.
pub(super) const CANDIDATE: Rgb = rgb(255, 165, 40);
/// Accepted.
pub(super) const ACCEPTED: Rgb = rgb(0, 190, 140);
/// Rejected.
pub(super) const REJECTED: Rgb = rgb(235, 85, 60);
/// The error curve.
pub(super) const ERROR: Rgb = rgb(204, 121, 167);
/// Borders of a segment.
pub(super) const BORDER: Rgb = rgb(225, 225, 225);
/// The candidate that comes next: no revision has this colour.
pub(super) const PROPOSED: Rgb = rgb(170, 255, 80);
/// What was measured, beside revisions.
pub(super) const MEASURED: Rgb = rgb(200, 205, 210);
/// What noise alone would leave.
pub(super) const NOISE: Rgb = rgb(86, 180, 233);
/// A step of the input up.
pub(super) const UP: Rgb = rgb(95, 160, 255);
/// A step of the input down.
pub(super) const DOWN: Rgb = rgb(240, 150, 195);
/// Half of what was found lies there.
pub(super) const BAND: Rgb = rgb(40, 50, 58);
/// Behind what a model was not fitted to.
pub(super) const UNSEEN_GROUND: Rgb = rgb(34, 38, 44);
/// Behind where a model fails.
pub(super) const FAILS_GROUND: Rgb = rgb(74, 30, 26);
/// Grid lines.
pub(super) const GRID: Rgb = rgb(60, 62, 66);

/// The model or revision of this number among those of a joint: it has this colour everywhere.
pub(super) fn model(number: usize) -> Rgb {
    models().nth(number % NAMES.len()).unwrap_or(BORDER)
}

/// What that colour is called.
pub(super) fn name(number: usize) -> &'static str {
    NAMES.get(number % NAMES.len()).copied().unwrap_or_default()
}

/// Models, one after the other; from the eleventh on they repeat.
pub(super) fn models() -> impl Iterator<Item = Rgb> {
    [
        rgb(230, 159, 0),
        rgb(0, 158, 115),
        rgb(204, 121, 167),
        rgb(213, 94, 0),
        rgb(120, 190, 255),
        rgb(240, 228, 66),
        rgb(160, 120, 240),
        rgb(150, 220, 120),
        rgb(255, 150, 150),
        rgb(0, 200, 210),
    ]
    .into_iter()
    .cycle()
}

/// What the colours of [`models`] are called.
const NAMES: [&str; 10] = [
    "orange",
    "green",
    "pink",
    "vermilion",
    "light blue",
    "yellow",
    "violet",
    "light green",
    "salmon",
    "turquoise",
];

/// Models that a title has room to name with their colours.
pub(super) const NAMED: usize = 3;

/// Another result beside this one.
pub(super) const OTHER: Rgb = rgb(180, 140, 255);

/// Results beside the first one; from the third on they repeat.
pub(super) fn others() -> impl Iterator<Item = Rgb> {
    [OTHER, rgb(255, 190, 150)].into_iter().cycle()
}

/// A darker shade of a colour.
pub(super) fn dimmed((r, g, b): Rgb) -> Rgb {
    let half = |part: u8| part / 2;
    (half(r), half(g), half(b))
}

pub(super) fn color((r, g, b): Rgb) -> Color {
    Color::from_rgb(r, g, b)
}

/// A setting whose delay is that of most.
pub(super) const SAME: Rgb = rgb(105, 112, 120);
/// Such a setting in a picture of all settings, where it is the ground.
pub(super) const SAME_GROUND: Rgb = rgb(58, 64, 71);
/// A setting with a longer delay.
pub(super) const LONGER: Rgb = rgb(240, 140, 30);
/// A setting with a shorter delay.
pub(super) const SHORTER: Rgb = rgb(70, 170, 240);
/// A setting that does not accept a step.
pub(super) const SILENT: Rgb = rgb(0, 0, 0);
/// The setting or the step under the cursor.
pub(super) const HERE: Rgb = rgb(255, 255, 255);

/// So much of the way from one colour to another.
pub(super) fn between(from: Rgb, to: Rgb, part: f64) -> Rgb {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a byte")]
    let mix = |a: u8, b: u8| (f64::from(a) + part * (f64::from(b) - f64::from(a))).round() as u8;
    (mix(from.0, to.0), mix(from.1, to.1), mix(from.2, to.2))
}
