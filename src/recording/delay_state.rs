//! What the delay depends on: the drawings of a report, the surest dependence first.
//!
//! Each accepted step is a point in every plot, and the step under the cursor is marked in
//! all of them. Its numbers are logged beside.

use std::ops::RangeInclusive;

use rerun::datatypes::Vec2D;
use serde_json::Value;

use super::canvas::{Layers, Plot, SHEET, Text};
use super::chunk::{Chunks, columns};
use super::error::RecordError;
use super::layout::{JointLayout, Placed as Segment};
use super::palette::{self, role};
use super::panels::{self, Placed, rgb};
use super::paths::{self, child};
use super::verdict;
use crate::delay::{AgainstState, Decision, StepState};
use crate::experiment::Joint;
use crate::figure::{Mark, Panel, Role, Shape, delay_levels};
use crate::report::Kind::{self, Real, Whole};
use crate::report::page::delays::{against_panel, by_strength};
use crate::wording::counted;

/// Height of the sheet.
pub(super) const HEIGHT: f32 = 800.0;
/// Plots that fit on the sheet; the weakest are not drawn.
const PLOTS: usize = 12;
/// Row of the legend on the sheet.
const LEGEND: f32 = 28.0;

/// A segment, and the state of its step where that was accepted.
type Step<'l, 'a> = (Segment<'l, 'a>, Option<&'l StepState>);

/// Adds the page below `/against`, and its numbers at `/delay/state`.
pub(super) fn add(chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
    let found = layout.estimated.against_state();
    let mut coming = found.steps.iter().peekable();
    let steps: Vec<Step<'_, '_>> = layout
        .segments()
        .map(|placed| {
            let (label, number) = (placed.0.trial.label(), placed.1.decision.number);
            let is_this = |step: &&StepState| step.number == number && step.trial == label;
            (placed, coming.next_if(is_this))
        })
        .collect();
    add_numbers(chunks, layout.joint, &steps)?;
    let known = by_strength(&found).into_iter();
    let known = known.filter_map(|variable| Some((variable, panel(&found, variable)?)));
    let (variables, panels): (Vec<usize>, Vec<Panel>) = known.take(PLOTS).unzip();
    let grid = Grid::of(panels.len());
    let panels = panels.into_iter().enumerate().map(|(place, panel)| {
        let (columns, rows) = grid.place(place);
        Placed::new(panel, columns, rows)
    });
    let panels: Vec<Placed> = panels.collect();
    let plots: Vec<Plot> = panels.iter().map(|placed| placed.plot).collect();
    let mut fixed = Layers::fixed(chunks, paths::AGAINST);
    panels::add(&mut fixed, [panels])?;
    fixed.texts("legend", vec![legend(&layout.joint.name, &found)])?;
    let mut rows = Layers::rows(chunks, paths::AGAINST, layout.openings()).in_front();
    let here = steps.iter().map(|(_, state)| {
        let of_step = state.iter().flat_map(|step| {
            variables.iter().zip(&plots).filter_map(move |(variable, plot)| {
                let here = Shape::Dots(vec![(step.value(*variable)?, step.delay_s)], 8.0);
                Some((Mark::new(role(palette::CANDIDATE), here).part("here"), *plot))
            })
        });
        of_step.collect()
    });
    panels::add_marks(&mut rows, here)?;
    let at = Vec2D::new(SHEET.0 - 280.0, LEGEND);
    let words = steps.iter().map(|((trial, segment), _)| {
        vec![(at, verdict::in_short(trial, segment), palette::CANDIDATE)]
    });
    rows.texts("step", words.collect())
}

/// The delays against a variable, and of which kinds of steps they depend on it.
fn panel(found: &AgainstState, variable: usize) -> Option<Panel> {
    let mut panel = against_panel(found, variable)?;
    panel.y.name.clear();
    panel.marks.iter_mut().for_each(Mark::unname);
    let depends = found.kinds.iter().filter(|kind| {
        kind.correlations.get(variable).is_some_and(|correlation| correlation.significant)
    });
    let depends: Vec<&str> = depends.map(|kind| kind.transition.id()).collect();
    let finding = match depends.as_slice() {
        [] => "not shown".to_owned(),
        kinds => format!("depends: {}", kinds.join(", ")),
    };
    panel.marks.push(Mark::lines(Role::Ink, 1.0, Vec::new()).named(finding).part("finding"));
    Some(panel)
}

/// How many steps there are, and the colours of their kinds.
fn legend(joint: &str, found: &AgainstState) -> Vec<Text> {
    let steps = counted(found.steps.len(), "accepted step");
    let headline = format!(
        "{joint}: {steps}; delay in seconds; it depends on a quantity where p ≤ 0.05 after Holm's \
         correction"
    );
    let headline = (Vec2D::new(SHEET.0 / 2.0, 0.0), headline, palette::BORDER);
    let kinds = found.kinds.iter().zip(0_u8..).map(|(kind, place)| {
        let at = Vec2D::new(110.0 + 160.0 * f32::from(place), LEGEND);
        (at, format!("● {}", kind.transition), rgb(delay_levels::role(kind.transition)))
    });
    std::iter::once(headline).chain(kinds).collect()
}

/// Where so many plots lie on the sheet.
#[derive(Clone, Copy)]
struct Grid {
    plots: usize,
    columns: usize,
}

impl Grid {
    fn of(plots: usize) -> Self {
        let columns = (1..=PLOTS).find(|side| side * side >= plots).unwrap_or(1);
        Self { plots, columns }
    }

    /// The columns and the rows of a plot; above it is room for its names.
    fn place(self, place: usize) -> ((f32, f32), RangeInclusive<f32>) {
        let part =
            |of: usize, low: f32, high: f32, n: usize| low + (high - low) * n as f32 / of as f32;
        let column = |n| part(self.columns, 110.0, SHEET.0 - 30.0, n);
        let row = |n| part(self.plots.div_ceil(self.columns), 60.0, HEIGHT, n);
        let (across, down) = (place % self.columns, place / self.columns);
        let rows = row(down) + 48.0..=row(down + 1) - 30.0;
        ((column(across), column(across + 1) - 90.0), rows)
    }
}

/// A decision, with the state of its step.
type Accepted<'s> = (&'s Decision, &'s StepState);

type OfStep = fn(&Accepted<'_>) -> Value;

/// What a program reads of an accepted step.
#[rustfmt::skip]
const STATE: [(&str, Kind, OfStep); 10] = [
    ("delta", Whole, |(decision, _)| decision.breakpoint().map(|best| best.delay).into()),
    ("delay_s", Real, |(_, step)| step.delay_s.into()),
    ("average_speed", Real, |(_, step)| step.average_speed.into()),
    ("input_change", Real, |(_, step)| step.input_change.into()),
    ("dwell_s", Real, |(_, step)| step.dwell_s.into()),
    ("angle", Real, |(_, step)| step.angle.into()),
    ("time_s", Real, |(_, step)| step.time_s.into()),
    ("fine_delta", Real, |(decision, _)| decision.fine.map(|fine| fine.delay).into()),
    ("delta_low", Real, |(decision, _)| decision.fine.map(|fine| fine.low).into()),
    ("delta_high", Real, |(decision, _)| decision.fine.map(|fine| fine.high).into()),
];

/// A row per accepted step, at its input step.
fn add_numbers(
    chunks: &mut Chunks,
    joint: &Joint,
    steps: &[Step<'_, '_>],
) -> Result<(), RecordError> {
    let accepted = steps.iter().filter_map(|((trial, segment), state)| {
        Some((trial.opening(segment), (segment.decision, (*state)?)))
    });
    let (moments, steps): (Vec<_>, Vec<Accepted<'_>>) = accepted.unzip();
    // The last three are of delays between samples.
    let is_fine = steps.iter().any(|(decision, _)| decision.fine.is_some());
    let known = if is_fine { &STATE[..] } else { &STATE[..7] };
    chunks.push("delay/state", moments.iter().copied().collect(), columns(&steps, known))?;
    for (number, signal) in joint.covariates.iter().enumerate() {
        let measured = moments.iter().zip(&steps).filter_map(|(moment, (_, step))| {
            Some((*moment, Some((*step.covariates.get(number)?)?)))
        });
        let (moments, values): (Vec<_>, Vec<_>) = measured.unzip();
        let entity = child("delay/state/covariate", &signal.name);
        chunks.scalars(entity, moments.into_iter().collect(), &values)?;
    }
    Ok(())
}
