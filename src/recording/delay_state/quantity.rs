//! The quantities that the delay is held against, and what was found of each.

use std::f64::consts::GOLDEN_RATIO;

use crate::delay::{AgainstState, Correlation, Direction, StepState};
use crate::figure::Span;
use crate::figure::course::{Bin, course};
use crate::figure::delay_levels::Way;
use crate::report::against::variable_text;
use crate::wording::{number, p_cell};

/// Something the delay may depend on.
#[derive(Debug)]
pub(super) struct Quantity {
    pub(super) name: String,
    /// The name with its unit.
    pub(super) title: String,
    /// How the delay goes with it, in words.
    effect: Option<String>,
    pub(super) p_value: Option<f64>,
    /// Magnitude of the correlation.
    strength: f64,
    pub(super) depends: bool,
    axis: Axis,
    /// Its value at each accepted step.
    values: Vec<Option<f64>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Axis {
    Number,
    /// Steps down about 0, steps up about 1.
    Direction,
}

/// The place of a direction on an axis.
fn place_of(way: Way) -> f64 {
    match way {
        Way::Down => 0.0,
        Way::Up => 1.0,
    }
}

/// Half the width over which the points of a direction are spread.
const SPREAD: f64 = 0.3;

impl Quantity {
    /// All of them, the smallest p-value first.
    pub(super) fn of(found: &AgainstState) -> Vec<Self> {
        let correlations = found.correlations.iter().enumerate();
        let mut all: Vec<_> = correlations
            .map(|(variable, one)| Self::correlated(one, &found.steps, variable))
            .collect();
        all.push(Self::direction(&found.direction, &found.steps));
        let p = |quantity: &Self| quantity.p_value.unwrap_or(f64::INFINITY);
        all.sort_by(|a, b| p(a).total_cmp(&p(b)).then(b.strength.total_cmp(&a.strength)));
        all
    }

    fn correlated(found: &Correlation, steps: &[StepState], variable: usize) -> Self {
        Self {
            name: variable_text(&found.variable, None),
            title: variable_text(&found.variable, found.unit.as_deref()),
            effect: found.rho.map(|rho| format!("ρ = {rho:+.2}")),
            p_value: found.p_value,
            strength: found.rho.map_or(0.0, f64::abs),
            depends: found.significant,
            axis: Axis::Number,
            values: steps.iter().map(|step| step.value(variable)).collect(),
        }
    }

    fn direction(found: &Direction, steps: &[StepState]) -> Self {
        let medians = found.median_difference_s.map(|s| format!("medians: up − down = {s:+.3} s"));
        // Points of one direction side by side: the golden ratio spreads any number evenly.
        let spread = |number: usize| (0.5 + number as f64 * GOLDEN_RATIO).fract();
        let side = |number| SPREAD * (2.0 * spread(number) - 1.0);
        let place = |(number, step): (usize, &StepState)| place_of(Way::of(step)) + side(number);
        Self {
            name: "direction".to_owned(),
            title: "direction of the step".to_owned(),
            effect: medians,
            p_value: found.p_value,
            strength: 0.0,
            depends: found.significant,
            axis: Axis::Direction,
            values: steps.iter().enumerate().map(place).map(Some).collect(),
        }
    }

    /// Its value at the accepted step of this number, where it is known.
    pub(super) fn value(&self, step: usize) -> Option<f64> {
        *self.values.get(step)?
    }

    /// Where its values lie.
    pub(super) fn x_span(&self) -> Span {
        match self.axis {
            Axis::Number => Span::around(self.values.iter().copied().flatten(), 0.05),
            Axis::Direction => Span::new(-0.5, 1.5),
        }
    }

    /// Values with a grid line, and what is written below it.
    pub(super) fn x_ticks(&self) -> Vec<(f64, String)> {
        match self.axis {
            // An axis without a point would have ticks of nothing.
            Axis::Number if self.values.iter().flatten().next().is_none() => Vec::new(),
            Axis::Number => self.x_span().ticks(5.0).into_iter().map(|x| (x, number(x))).collect(),
            Axis::Direction => Way::BOTH.map(|way| (place_of(way), way.word().to_owned())).to_vec(),
        }
    }

    /// Pieces of the curve through the points.
    pub(super) fn courses(&self, steps: &[StepState]) -> Vec<Vec<Bin>> {
        let known = || self.values.iter().zip(steps).filter_map(|(x, step)| Some(((*x)?, step)));
        match self.axis {
            Axis::Number => course(known().map(|(x, s)| (x, s.delay_s)).collect()),
            Axis::Direction => Way::BOTH
                .into_iter()
                .filter_map(|way| {
                    let same = known().filter(|(_, step)| Way::of(step) == way);
                    let bin = Bin::of(&same.map(|(x, s)| (x, s.delay_s)).collect::<Vec<_>>())?;
                    Some(bin.level(place_of(way) - SPREAD, place_of(way) + SPREAD))
                })
                .collect(),
        }
    }

    /// What the test says, in a line.
    pub(super) fn finding(&self) -> String {
        let p = match (self.p_value, p_cell(self.p_value)) {
            (None, _) => return "not known: constant, or too few steps".to_owned(),
            (_, small) if small.starts_with('<') => format!("p {small}"),
            (_, p) => format!("p = {p}"),
        };
        let answer = if self.depends { "depends" } else { "not shown" };
        format!("{}, {p}: {answer}", self.effect.as_deref().unwrap_or_default())
    }
}
