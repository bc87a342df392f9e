//! Panels with axes and marks.

use super::role::Role;
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
}

/// A place in a panel.
pub(crate) type Place = (f64, f64);

/// What is drawn.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    /// Lines through places, and their width in pixels.
    Lines(Vec<Vec<Place>>, f64),
    /// Filled circles.
    Dots(Vec<Place>),
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
    /// Words that start beside a place.
    Words(Vec<(Place, String)>),
}

/// Something drawn, what it means, and its name in the legend.
#[derive(Clone, Debug)]
pub(crate) struct Mark {
    pub(crate) role: Role,
    pub(crate) name: Option<String>,
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
        Self { span, name: name.into(), ticks, is_logarithmic: false }
    }

    /// An axis of numbers whose logarithms to base ten are drawn.
    pub(crate) fn logarithmic(span: Span, name: impl Into<String>, ticks: f64) -> Self {
        let named = |tick: f64| (tick, number(power_of_ten(tick)));
        let ticks = span.ticks(ticks).into_iter().map(named).collect();
        Self { span, name: name.into(), ticks, is_logarithmic: true }
    }

    /// An axis of names, one at each whole number from 0, from the top down.
    pub(crate) fn of_names(names: &[String], name: impl Into<String>) -> Self {
        let ticks = (0..).zip(names).map(|(row, name)| (-f64::from(row), name.clone()));
        let span = Span::new(0.6 - names.len() as f64, 0.6);
        Self { span, name: name.into(), ticks: ticks.collect(), is_logarithmic: false }
    }

    /// This axis without numbers and name: those of the panel below hold for it.
    pub(crate) fn bare(&self) -> Self {
        let ticks = self.ticks.iter().map(|(tick, _)| (*tick, String::new())).collect();
        Self { name: String::new(), ticks, ..*self }
    }

    /// The number that is drawn at `place`.
    pub(crate) fn number(&self, place: f64) -> f64 {
        if self.is_logarithmic { power_of_ten(place) } else { place }
    }
}

impl Mark {
    pub(crate) fn new(role: Role, shape: Shape) -> Self {
        Self { role, name: None, shape }
    }

    /// This mark with a name in the legend.
    pub(crate) fn named(self, name: impl Into<String>) -> Self {
        Self { name: Some(name.into()), ..self }
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
}
