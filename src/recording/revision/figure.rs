//! What shows the effect that comes next: points, and the laws of models through them.

use crate::figure::{Axis, Mark, Panel, Place, Role, Shape, Span};
use crate::recording::palette::{self, role};
use crate::recording::panels::Placed;

/// Points that are drawn; more hide one another.
const POINTS: usize = 1500;

/// Width of an uncertainty in standard errors on each side: 95 %.
const BAND: f64 = 1.96;

/// The measured speed while one level of the input acted, or the output to which it ran.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Held {
    pub(super) level: f64,
    pub(super) speed: f64,
    pub(super) std_error: f64,
    /// Whether an output came down to it, which backlash and friction leave higher than one that
    /// came up; not asked of a speed.
    pub(super) fell: bool,
    /// What the revision makes of the speed, where that is a point of its own.
    pub(super) simulated: Option<f64>,
}

/// Level of the input, and the speed that a model makes of it.
pub(super) type Law = Vec<Place>;

/// A law with its name, where there is one.
pub(super) type NamedLaw = Option<(String, Law)>;

/// What shows the effect that comes next, of one revision.
pub(super) struct Figure {
    /// Names of the axes, with units.
    pub(super) names: [String; 2],
    pub(super) x: Span,
    pub(super) y: Span,
    pub(super) points: Vec<Held>,
    /// What the revision makes of it, the one before, and the candidate that comes next, with names.
    pub(super) laws: [NamedLaw; 3],
}

impl Figure {
    /// Between two `columns` of the sheet, of the revision `at` this place.
    pub(super) fn placed(&self, at: usize, columns: (f32, f32)) -> Placed {
        let own = Role::of_revision(at);
        let roles = [own, Role::of_revision(at.saturating_sub(1)), role(palette::PROPOSED)];
        let laws = self.laws.iter().zip(roles).zip(["law", "before", "proposed"]);
        let law = |((law, role), part): ((&NamedLaw, Role), &'static str)| {
            let (name, law) = law.clone()?;
            let law = if law.is_empty() { Vec::new() } else { vec![law] };
            Some(Mark::lines(role, 2.4, law).named(name).part(part))
        };
        let mut marks: Vec<Mark> = laws.filter_map(law).collect();
        let drawn = || self.points.iter().step_by(self.points.len().div_ceil(POINTS).max(1));
        let places = |speed: fn(&Held) -> Option<f64>| {
            drawn().filter_map(|held| Some((held.level, speed(held)?))).collect::<Vec<Place>>()
        };
        let reach = |held: &Held| {
            let end = |k: f64| (held.level, held.speed + k * held.std_error);
            [-BAND, BAND].map(end).to_vec()
        };
        let measured = places(|held| (!held.fell).then_some(held.speed));
        let fell = places(|held| held.fell.then_some(held.speed));
        let points = |role: Role, places: Vec<Place>, part: &'static str| {
            Mark::new(role, Shape::Dots(places, 4.0)).part(part)
        };
        marks
            .push(Mark::lines(Role::Measured, 0.8, drawn().map(reach).collect()).part("uncertain"));
        marks.push(points(own, places(|held| held.simulated), "simulated"));
        marks.push(points(Role::Measured, measured, "points"));
        if !fell.is_empty() {
            marks.push(points(role(palette::DOWN), fell, "fallen").named("input fell"));
        }
        let [across, up] = self.names.clone();
        let (x, y) = (Axis::new(self.x, across, 5.0), Axis::new(self.y, up, 4.0));
        Placed::new(Panel { x, y, height: 200, marks }, columns, 44.0..=420.0)
    }
}
