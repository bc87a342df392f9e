//! What shows the effect that comes next: points, and the laws of models through them.

use rerun::datatypes::Vec2D;

use crate::recording::canvas::short;
use crate::recording::canvas::{HALF_LETTER, Labels, Plot, Span, Strips};
use crate::recording::sheet::Sheet;

/// Left, right and lower end of the plot on the sheet.
const PLACE: ((f32, f32), f32) = ((760.0, 1235.0), 450.0);

/// The columns between ladder and ranking, in which names stand above the plot.
const NAMES: (f32, f32) = (660.0, 1270.0);

/// Lower end of the title, and the height of a row of names.
const TITLE: f32 = 42.0;
const NAME: f32 = 42.0;

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
        let (columns, bottom) = PLACE;
        let rows = self.rows().iter().map(|(row, _)| row + 1).max().unwrap_or(0);
        let top = TITLE + 10.0 + NAME * rows as f32;
        Plot::within(columns, top..=bottom, self.x, self.y)
    }

    /// Grid and title.
    pub(super) fn sheet(&self) -> Sheet {
        let (plot, mut sheet) = (self.plot(), Sheet::default());
        let named = |ticks: Vec<f64>| ticks.into_iter().map(|tick| (tick, short(tick)));
        let x_ticks = plot.x_span().ticks(5.0);
        sheet.outline(&plot, &x_ticks, &named(plot.y_span().ticks(4.0)).collect::<Vec<_>>());
        let ((left, right), _) = PLACE;
        sheet.put(Vec2D::new(f32::midpoint(left, right), TITLE - NAME), self.title.clone());
        for (x, text) in named(x_ticks) {
            sheet.put(plot.below(x, 2.0), text);
        }
        sheet
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

    /// Row and middle of each name: above the plot, where they cover no point, as many beside each
    /// other as there is room for.
    fn rows(&self) -> Vec<(usize, f32)> {
        let (left, right) = NAMES;
        let mut rows: Vec<Vec<f32>> = vec![Vec::new()];
        for width in self.names.iter().map(|name| name.as_deref().map_or(0.0, width)) {
            match rows.last_mut() {
                Some(row) if row.iter().sum::<f32>() + width <= right - left => row.push(width),
                _ => rows.push(vec![width]),
            }
        }
        let in_row = |(row, widths): (usize, Vec<f32>)| {
            let start = f32::midpoint(left, right) - 0.5 * widths.iter().sum::<f32>();
            let middles = widths.into_iter().scan(start, move |end, width| {
                *end += width;
                Some((row, *end - 0.5 * width))
            });
            middles.collect::<Vec<_>>()
        };
        rows.into_iter().enumerate().flat_map(in_row).collect()
    }

    /// The name of a law.
    pub(super) fn legend(&self, which: usize) -> Labels {
        let mut labels = Labels::default();
        let name = self.names.get(which).and_then(Option::as_ref);
        if let (Some(name), Some((row, middle))) = (name, self.rows().get(which)) {
            labels.put(Vec2D::new(*middle, TITLE + NAME * *row as f32), name.clone());
        }
        labels
    }
}

/// Width of a name with the room beside it, on the sheet in a window of 1280 points.
fn width(name: &str) -> f32 {
    2.0 * HALF_LETTER * (name.chars().count() + 2) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(names: [Option<&str>; 4]) -> Figure {
        let span = Span::new(0.0, 1.0);
        Figure {
            title: String::new(),
            x: span,
            y: span,
            points: Vec::new(),
            laws: Default::default(),
            names: names.map(|name| name.map(str::to_owned)),
        }
    }

    #[test]
    fn names_stand_above_the_plot_and_none_on_another() {
        let long = figure([
            Some("revision 9 (line: at -95.3 deg)"),
            Some("revision 8"),
            Some("with viscous_friction"),
            Some("input fell"),
        ]);
        let without = figure([Some("revision 0"), None, Some("with dead_band"), None]);
        for figure in [long, without] {
            let of = |which: usize| (figure.names[which].as_deref(), figure.legend(which).places);
            let boxes: Vec<[f32; 3]> = (0..4)
                .filter_map(|which| match of(which) {
                    (Some(name), places) => {
                        let [x, y] = places.first()?.0;
                        Some([x - 0.5 * width(name), x + 0.5 * width(name), y])
                    }
                    (None, places) => {
                        assert!(places.is_empty());
                        None
                    }
                })
                .collect();
            assert_eq!(boxes.len(), figure.names.iter().flatten().count());
            for (place, [left, right, y]) in boxes.iter().enumerate() {
                assert!(*left >= NAMES.0 && *right <= NAMES.1);
                assert!(y + NAME <= figure.plot().top);
                let beside = |[l, r, other]: &[f32; 3]| {
                    right <= &(l + 0.5) || r <= &(left + 0.5) || (other - y).abs() >= NAME
                };
                assert!(boxes.iter().skip(place + 1).all(beside), "{boxes:?}");
            }
        }
    }
}
