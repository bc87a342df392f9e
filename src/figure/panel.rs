//! Panels with axes and marks, coloured by what they mean: each back end has its own shade for that.

use std::borrow::Cow;

use super::span::{Span, power_of_ten};
use crate::wording::number;

/// An axis: its range, its name with the unit, and its ticks.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    pub(crate) span: Span,
    pub(crate) name: String,
    pub(crate) ticks: Vec<(f64, String)>,
    /// Whether its range is of logarithms to base ten, and its ticks name the numbers.
    pub(crate) is_logarithmic: bool,
    /// Whether names stand at it instead of numbers.
    pub(crate) has_names: bool,
}

/// A place in a panel.
pub(crate) type Place = (f64, f64);

/// What is drawn.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    /// Lines through places, and their width in pixels. They break where they leave the panel.
    Lines(Vec<Vec<Place>>, f64),
    /// Filled circles, and their radius in pixels.
    Dots(Vec<Place>, f64),
    /// Filled circles with a radius in pixels and a name each, which a pointer shows.
    Named(Vec<(Place, f64, String)>),
    /// Crosses.
    Crosses(Vec<Place>),
    /// Lines from the lower to the upper edge, and their width in pixels.
    Verticals(Vec<f64>, f64),
    /// Between two values, from the left to the right edge.
    Band(f64, f64),
    /// Between two values of the horizontal axis, from edge to edge; and how dense.
    Spans(Vec<(f64, f64)>, f64),
    /// Filled between two corners.
    Bars(Vec<(Place, Place)>),
    /// Bars with a tick at each end between two values of the horizontal axis, so many pixels above
    /// the panel.
    Spreads(Vec<(f64, f64)>, f64),
    /// Words that start beside a place.
    Words(Vec<(Place, String)>),
    /// Names of values of the horizontal axis, which stand below it where there is room for them.
    Flags(Vec<(f64, String)>),
}

/// Something drawn, what it means, and its name in the legend.
#[derive(Clone, Debug)]
pub(crate) struct Mark {
    pub(crate) role: Role,
    pub(crate) name: Option<String>,
    /// What programs find it by, where that is not its name.
    pub(crate) part: Option<Cow<'static, str>>,
    pub(crate) shape: Shape,
}

/// One pair of axes.
#[derive(Clone, Debug)]
pub(crate) struct Panel {
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// Height of the part within the axes, in pixels.
    pub(crate) height: u32,
    pub(crate) marks: Vec<Mark>,
}

impl Axis {
    /// An axis with about so many round numbers at it.
    pub(crate) fn new(span: Span, name: impl Into<String>, ticks: f64) -> Self {
        let ticks = span.ticks(ticks).into_iter().map(|tick| (tick, number(tick))).collect();
        Self { span, name: name.into(), ticks, is_logarithmic: false, has_names: false }
    }

    /// An axis of numbers whose logarithms to base ten are drawn.
    pub(crate) fn logarithmic(span: Span, name: impl Into<String>, ticks: f64) -> Self {
        let named = |tick: f64| (tick, number(power_of_ten(tick)));
        let ticks = span.ticks(ticks).into_iter().map(named).collect();
        Self { span, name: name.into(), ticks, is_logarithmic: true, has_names: false }
    }

    /// An axis of names, one at each whole number from 0, from the top down.
    pub(crate) fn of_names(names: &[String], name: impl Into<String>) -> Self {
        let ticks = (0..).zip(names).map(|(row, name)| (-f64::from(row), name.clone()));
        let span = Span::new(0.6 - names.len() as f64, 0.6);
        let ticks = ticks.collect();
        Self { span, name: name.into(), ticks, is_logarithmic: false, has_names: true }
    }

    /// This axis without numbers and name: those of the panel below hold for it.
    pub(crate) fn bare(&self) -> Self {
        let ticks = self.ticks.iter().map(|(tick, _)| (*tick, String::new())).collect();
        Self { name: String::new(), ticks, ..*self }
    }

    /// Whether the panel below says what is at it.
    pub(crate) fn is_bare(&self) -> bool {
        self.ticks.iter().all(|(_, text)| text.is_empty()) && self.name.is_empty()
    }

    /// The number that is drawn at `place`.
    pub(crate) fn number(&self, place: f64) -> f64 {
        if self.is_logarithmic { power_of_ten(place) } else { place }
    }
}

impl Mark {
    pub(crate) fn new(role: Role, shape: Shape) -> Self {
        Self { role, name: None, part: None, shape }
    }

    /// Lines of this width.
    pub(crate) fn lines(role: Role, width: f64, lines: Vec<Vec<Place>>) -> Self {
        Self::new(role, Shape::Lines(lines, width))
    }

    /// Filled circles.
    pub(crate) fn dots(role: Role, places: Vec<Place>) -> Self {
        Self::new(role, Shape::Dots(places, 3.0))
    }

    /// This mark with a name in the legend.
    pub(crate) fn named(self, name: impl Into<String>) -> Self {
        Self { name: Some(name.into()), ..self }
    }

    /// Takes this mark out of the legend; programs find it by the name that it had there.
    pub(crate) fn unname(&mut self) {
        let name = self.name.take().map(Cow::Owned);
        self.part = self.part.take().or(name);
    }

    /// This mark, which programs find by `part`.
    pub(crate) fn part(self, part: impl Into<Cow<'static, str>>) -> Self {
        Self { part: Some(part.into()), ..self }
    }

    /// Whether the grid is drawn over it.
    pub(crate) fn is_ground(&self) -> bool {
        matches!(self.shape, Shape::Band(..) | Shape::Spans(..))
    }
}

impl Panel {
    /// The names of its marks, of curves that leave it with a word on that.
    pub(crate) fn legend(&self) -> impl Iterator<Item = (&Mark, String)> {
        self.marks.iter().filter_map(|mark| {
            let name = mark.name.as_deref()?;
            let off = if self.is_left_by(mark) { ", in part off scale" } else { "" };
            Some((mark, format!("{name}{off}")))
        })
    }

    /// Whether a curve runs above or below the panel.
    fn is_left_by(&self, mark: &Mark) -> bool {
        let is_off = |place: &Place| !(-1e-9..=1.0 + 1e-9).contains(&self.y.span.part(place.1));
        matches!(&mark.shape, Shape::Lines(lines, _) if lines.iter().flatten().any(is_off))
    }
}

/// The parts of a line within a panel of these axes: none of it lies on the frame that is not there.
pub(crate) fn within((x, y): (Span, Span), line: &[Place]) -> Vec<Vec<Place>> {
    let is_inside = |place: &Place| {
        (0.0..=1.0).contains(&x.part(place.0)) && (0.0..=1.0).contains(&y.part(place.1))
    };
    if line.iter().all(is_inside) {
        return vec![line.to_vec()];
    }
    let mut pieces: Vec<Vec<Place>> = Vec::new();
    let pairs = line.iter().zip(line.iter().skip(1));
    for [from, to] in pairs.filter_map(|(from, to)| clipped((x, y), [*from, *to])) {
        match pieces.last_mut() {
            Some(piece) if piece.last() == Some(&from) => piece.push(to),
            _ => pieces.push(vec![from, to]),
        }
    }
    pieces
}

/// The part of a line between two places that is in the panel.
fn clipped((x, y): (Span, Span), [from, to]: [Place; 2]) -> Option<[Place; 2]> {
    let parts = |place: Place| (x.part(place.0), y.part(place.1));
    let ((x0, y0), (x1, y1)) = (parts(from), parts(to));
    let (mut start, mut end) = (0.0_f64, 1.0_f64);
    // Liang and Barsky, "A new concept and method for line clipping", 1984.
    for (way, room) in [(x0 - x1, x0), (x1 - x0, 1.0 - x0), (y0 - y1, y0), (y1 - y0, 1.0 - y0)] {
        if way < 0.0 {
            start = start.max(room / way);
        } else if way > 0.0 {
            end = end.min(room / way);
        } else if room < 0.0 {
            return None;
        }
    }
    // Ends that are within stay what they are, so that the pieces of a curve meet.
    let at = |t: f64| match t {
        ..=0.0 => from,
        1.0.. => to,
        _ => (from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1)),
    };
    (start < end).then(|| [at(start), at(end)])
}

/// What a line, a point or a text means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// Text and axes.
    Ink,
    /// Axes' numbers, remarks.
    Faint,
    /// Grid lines.
    Grid,
    /// What drove the joint.
    Input,
    /// What was measured.
    Measured,
    /// What the lines were fitted to.
    Smoothed,
    /// Accepted.
    Accepted,
    /// Rejected.
    Rejected,
    /// Squared errors.
    Error,
    /// A model.
    Model,
    /// What noise alone would leave.
    Noise,
    /// A part of the record that deserves a look.
    Attention,
    /// The revisions of a model after the first one, which is [`Self::Model`].
    Revision(Revision),
    /// A colour of its own, which a recording has beside these: red, green, blue.
    Own(u8, u8, u8),
}

/// One of the colours of revisions after the first, counted from 1 to [`Revision::COUNT`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Revision(u8);

impl Revision {
    /// Colours; then they begin anew.
    pub(crate) const COUNT: u8 = 9;

    /// Its place among the colours, from 0.
    pub(crate) const fn place(self) -> usize {
        self.0 as usize - 1
    }
}

impl Role {
    /// That of the revision with this number, counted from 0.
    pub(crate) fn of_revision(number: usize) -> Self {
        let place = number % (usize::from(Revision::COUNT) + 1);
        match u8::try_from(place) {
            Ok(place @ 1..) => Self::Revision(Revision(place)),
            _ => Self::Model,
        }
    }

    /// All but colours of their own.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        let usual = [
            Self::Ink,
            Self::Faint,
            Self::Grid,
            Self::Input,
            Self::Measured,
            Self::Smoothed,
            Self::Accepted,
            Self::Rejected,
            Self::Error,
            Self::Model,
            Self::Noise,
            Self::Attention,
        ];
        usual.into_iter().chain((1..=Revision::COUNT).map(|one| Self::Revision(Revision(one))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_at_an_axis_of_logarithms_are_those_themselves() {
        let axis = Axis::logarithmic(Span::new(-2.0, 2.0), "SSE", 4.0);
        let texts: Vec<_> = axis.ticks.iter().map(|(_, text)| text.as_str()).collect();
        assert_eq!(texts, ["0.01", "0.1", "1", "10", "100"]);
    }

    #[test]
    fn a_line_is_drawn_as_far_as_it_is_in_its_panel() {
        let unit = Span::new(0.0, 1.0);
        let drawn = |line: &[Place]| within((unit, unit), line);
        let inside = [(0.2, 0.2), (0.8, 0.4)];
        assert_eq!(drawn(&inside), [inside]);
        assert_eq!(drawn(&[(0.5, -1.0), (0.5, 3.0)]), [[(0.5, 0.0), (0.5, 1.0)]]);
        assert_eq!(drawn(&[(0.5, 0.5), (1.5, 1.5)]), [[(0.5, 0.5), (1.0, 1.0)]]);
        assert_eq!(drawn(&[(0.0, 1.2), (1.0, 1.1)]), Vec::<Vec<Place>>::new());
        assert_eq!(drawn(&[(1.2, 0.0), (1.4, 1.0)]), Vec::<Vec<Place>>::new());
    }

    #[test]
    fn a_curve_that_leaves_its_panel_breaks_there_and_says_so() {
        let axis = || Axis::new(Span::new(0.0, 4.0), "", 4.0);
        let curve = vec![(0.0, 1.0), (1.0, 3.0), (2.0, 7.0), (3.0, 3.0), (4.0, 2.0)];
        let pieces = within((axis().span, axis().span), &curve);
        assert_eq!(
            pieces,
            [[(0.0, 1.0), (1.0, 3.0), (1.25, 4.0)], [(2.75, 4.0), (3.0, 3.0), (4.0, 2.0)]]
        );
        let marks = vec![Mark::lines(Role::Model, 1.0, vec![curve]).named("mean")];
        let panel = Panel { x: axis(), y: axis(), height: 1, marks };
        let names: Vec<String> = panel.legend().map(|(_, name)| name).collect();
        assert_eq!(names, ["mean, in part off scale"]);
    }
}
