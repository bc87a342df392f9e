//! The drawing of one decision: on the left the segment, both lines, what they leave, the error
//! curve and the cursor; on the right a close-up of the reaction.
//!
//! What belongs to the segment is set at its opening tick and stays until the next one;
//! what belongs to a candidate is set at each of its ticks and cleared before and after,
//! so that nothing leaks into the next segment.

use super::canvas::{Layers, Plot};
use super::chunk::Chunks;
use super::difference::{Other, in_short};
use super::error::RecordError;
use super::layout::{JointLayout, Placed as Step};
use super::palette::{self, role};
use super::panels::{self, Placed};
use super::paths;
use crate::delay::{Candidate, Method};
use crate::diagnosis::sensor_noise;
use crate::figure::segment::{Scale, SegmentFigure};
use crate::figure::{Mark, Panel};
use crate::study::StepResult;

/// Width and height of the sheet.
pub(super) const SIZE: (f32, f32) = (1740.0, 720.0);

/// Left and right end of the plots of the whole segment.
const SIDES: (f32, f32) = (120.0, 1000.0);

/// Left and right end of the close-up, beside which there is room for half of a label of five digits.
const CLOSE: (f32, f32) = (1130.0, 1700.0);

/// Adds the drawings of all segments below `root`/drawing.
pub(super) fn add(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    (method, others): (Method, &[Other<'_>]),
) -> Result<(), RecordError> {
    let drawings: Vec<_> = layout.segments().map(Drawing::new).collect();
    let mut layers = Layers::rows(chunks, paths::DRAWING, layout.openings());
    let mut plots = Vec::new();
    let rows = drawings.iter().map(|drawing| {
        let placed = drawing.placed(method, others);
        let [output, _, errors, close] = &placed;
        plots.push([output, errors, close].map(|placed| placed.plot));
        placed.into()
    });
    panels::add(&mut layers, rows)?;
    add_candidates(chunks, &drawings, &plots)
}

/// One segment on its sheet: the output above, what both lines leave of it, the error curve
/// below; and the close-up beside them.
struct Drawing<'l, 'a> {
    step: Step<'l, 'a>,
    figure: SegmentFigure<'a>,
}

impl<'l, 'a> Drawing<'l, 'a> {
    fn new(step: Step<'l, 'a>) -> Self {
        let (trial, segment) = step;
        let unit = trial.estimated.joint.output_unit.as_deref();
        let smoothed = trial.estimate.smoothed.as_deref();
        let measured = (trial.trial, unit);
        let figure = SegmentFigure::new(measured, smoothed, segment.decision, Scale::SAMPLES);
        Self { step, figure }
    }

    /// All panels; where there are other results, with what they say.
    fn placed(&self, method: Method, others: &[Other<'_>]) -> [Placed; 4] {
        let (trial, segment) = self.step;
        let mut output = self.figure.output();
        let mut close = self.figure.close_up(sensor_noise(&trial.estimated.joint.trials));
        close.y.name = self.figure.delay_text(trial.trial.period().seconds());
        if !others.is_empty() {
            let here = StepResult::of(trial.trial, segment.decision);
            let own = in_short(&here, method.id());
            let own = Mark::lines(self.figure.verdict(), 1.0, Vec::new()).named(own);
            close.marks.push(own.part("chosen"));
            for (index, other) in others.iter().enumerate() {
                if let Some(pair) = other.pair(&here.trial, here.p) {
                    self.add_other((&mut output, &mut close), &pair.there, (index, other));
                }
            }
        }
        [
            Placed::new(output, SIDES, 60.0..=340.0),
            Placed::new(self.figure.residual(), SIDES, 460.0..=514.0),
            Placed::new(self.figure.errors(), SIDES, 562.0..=660.0),
            Placed::new(close, CLOSE, 60.0..=660.0),
        ]
    }

    /// The lines of another result, and its delay or its interval as a bar. Of a step that lies at
    /// another sample there, as in another log, the lines are of that log, and left out.
    fn add_other(
        &self,
        (output, close): (&mut Panel, &mut Panel),
        step: &StepResult,
        (index, other): (usize, &Other<'_>),
    ) {
        let (role, part) = (role(other.rgb), format!("other_{index}"));
        let name = in_short(step, other.name);
        let named = Mark::lines(role, 1.8, Vec::new()).named(name).part(part.clone());
        close.marks.push(named);
        let Some(delay) = step.delay else { return };
        let lines = step.lines.filter(|_| step.p == self.step.1.decision.input_step.sample);
        // Below the bar of this result.
        let depth = -20.0 - 12.0 * index as f64;
        let spread = step.interval.unwrap_or((0.0, delay));
        let of_output = self.figure.other(role, (delay, step.segment), lines);
        let of_output = of_output.into_iter().chain([self.figure.spread(role, spread, depth)]);
        output.marks.extend(of_output.map(|mark| mark.part(part.clone())));
        let of_close = self.figure.other(role, (delay, step.segment), None);
        close.marks.extend(of_close.into_iter().map(|mark| mark.part(part.clone())));
    }

    /// A candidate in the panels that have one.
    fn candidate(&self, plots: [Plot; 3], candidate: &Candidate) -> Vec<(Mark, Plot)> {
        let marks = self.figure.candidate(candidate, role(palette::CANDIDATE));
        let marks = marks.into_iter().zip(plots);
        marks.flat_map(|(marks, plot)| marks.into_iter().map(move |mark| (mark, plot))).collect()
    }
}

/// A row per candidate; empty ones at the opening and the verdict tick.
fn add_candidates(
    chunks: &mut Chunks,
    drawings: &[Drawing<'_, '_>],
    plots: &[[Plot; 3]],
) -> Result<(), RecordError> {
    let ticks = drawings.iter().flat_map(|drawing| {
        let (trial, segment) = drawing.step;
        trial.ticks(segment).map(move |(moment, _)| trial.within(segment, moment))
    });
    let mut layers = Layers::rows(chunks, paths::DRAWING, ticks.collect()).in_front();
    let rows = drawings.iter().zip(plots).flat_map(|(drawing, plots)| {
        let (trial, segment) = drawing.step;
        trial.ticks(segment).map(move |(_, candidate)| {
            candidate.map_or_else(Vec::new, |candidate| drawing.candidate(*plots, &candidate))
        })
    });
    panels::add_marks(&mut layers, rows)
}
