//! What shows the effect that comes next: points, and the laws of models through them.

use rerun::datatypes::Vec2D;

use crate::diagnosis::sensor_noise;
use crate::recording::canvas::{Labels, Plot, Span, Strips};
use crate::report::ImprovedJoint;

/// Columns and rows of the plot on the sheet.
const PLACE: ((f32, f32), (f32, f32)) = ((760.0, 1235.0), (48.0, 450.0));

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

/// The noise of the sensor, from the record alone: one for all revisions.
pub(super) fn noise(improved: &ImprovedJoint<'_>) -> Option<f64> {
    sensor_noise(&improved.finding.compared.joint.trials)
}

/// Level of the input, and the speed that a model makes of it.
pub(super) type Law = Vec<(f64, f64)>;

/// What shows the effect that comes next, of one revision.
pub(super) struct Figure {
    pub(super) title: String,
    pub(super) x: Span,
    pub(super) y: Span,
    pub(super) points: Vec<Held>,
    /// What the revision makes of it, the one before, and the candidate that comes next.
    pub(super) laws: [Law; 3],
    /// The names of these, and of the points that came down.
    pub(super) names: [Option<String>; 4],
}

impl Figure {
    pub(super) fn plot(&self) -> Plot {
        let (columns, (top, bottom)) = PLACE;
        Plot::within(columns, top..=bottom, self.x, self.y)
    }

    pub(super) fn curve(&self, which: usize) -> Strips {
        let plot = self.plot();
        let law = self.laws.get(which).map_or(&[][..], Vec::as_slice);
        // What leaves the plot comes back as another piece.
        let is_within = |point: &(f64, f64)| (0.0..=1.0).contains(&self.y.part(point.1));
        let pieces = law.chunk_by(|a, b| is_within(a) == is_within(b));
        let pieces = pieces.filter(|piece| piece.first().is_some_and(is_within));
        pieces.map(|piece| piece.iter().map(|(x, y)| plot.at(*x, *y)).collect()).collect()
    }

    /// The points that are drawn.
    fn drawn(&self) -> impl Iterator<Item = &Held> {
        self.points.iter().step_by(self.points.len().div_ceil(POINTS).max(1))
    }

    pub(super) fn measured(&self) -> Vec<Vec2D> {
        self.places(|held| (!held.fell).then_some(held.speed))
    }

    pub(super) fn fallen(&self) -> Vec<Vec2D> {
        self.places(|held| held.fell.then_some(held.speed))
    }

    pub(super) fn simulated(&self) -> Vec<Vec2D> {
        self.places(|held| held.simulated)
    }

    fn places(&self, speed: fn(&Held) -> Option<f64>) -> Vec<Vec2D> {
        let plot = self.plot();
        self.drawn().filter_map(|held| Some(plot.at(held.level, speed(held)?))).collect()
    }

    pub(super) fn uncertain(&self) -> Strips {
        let plot = self.plot();
        let reach = |held: &Held| {
            [-BAND, BAND].map(|k| plot.at(held.level, held.speed + k * held.std_error)).to_vec()
        };
        self.drawn().map(reach).collect()
    }

    /// The name of a law, in the corner that a rising one leaves free, or in the other one.
    pub(super) fn legend(&self, which: usize) -> Labels {
        let mut labels = Labels::default();
        let line = self.names.iter().take(which).flatten().count();
        if let Some(name) = self.names.get(which).and_then(Option::as_ref) {
            let half = 7.0 * (name.chars().count() + 2) as f32;
            let ((left, right), (top, _)) = PLACE;
            let x = if self.falls() { right - half - 6.0 } else { left + half + 6.0 };
            labels.put(Vec2D::new(x, top + 22.0 + 36.0 * line as f32), name.clone());
        }
        labels
    }

    fn falls(&self) -> bool {
        let law = self.laws.iter().rev().find(|law| !law.is_empty());
        let ends = law.and_then(|law| law.first().zip(law.last()));
        ends.is_some_and(|(first, last)| first.1 > last.1)
    }
}
