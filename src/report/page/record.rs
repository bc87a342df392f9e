//! The whole record of a joint: its output with the breakpoints, and its input.

use super::document::{Figure, WIDTH};
use super::timeline::{Timeline, values_of};
use crate::delay::{Decision, Verdict};
use crate::experiment::Trial;
use crate::figure::{Axis, Mark, Panel, Place, Role, Shape, Span};
use crate::report::EstimatedJoint;
use crate::wording::bracketed;

/// Input and output over time.
pub(super) fn figure(estimated: EstimatedJoint<'_>, file: String) -> Figure {
    let joint = estimated.joint;
    let name = format!("Input and output of {} over time", joint.name);
    let caption =
        "What was measured, and where the output of each step of the input breaks.".to_owned();
    let panels = panels(estimated, &Timeline::of(joint)).into();
    Figure { file, name, width: WIDTH, panels, caption }
}

/// The output with the breakpoints above, the input below.
pub(crate) fn panels(estimated: EstimatedJoint<'_>, timeline: &Timeline<'_>) -> [Panel; 2] {
    let joint = estimated.joint;
    let (accepted, rejected) = breakpoints(estimated, timeline);
    let span = |values: fn(&Trial) -> &[f64]| Span::around(values_of(joint, values), 0.06);
    let output = Panel {
        x: timeline.axis().bare(),
        y: Axis::new(span(Trial::output), bracketed("output", joint.output_unit.as_deref()), 5.0),
        height: 170,
        marks: vec![
            timeline.borders(),
            Mark::lines(Role::Measured, 1.3, timeline.lines(|_, t| t.output())).named("output"),
            Mark::dots(Role::Accepted, accepted).named("breakpoint, accepted"),
            Mark::new(Role::Rejected, Shape::Crosses(rejected)).named("rejected"),
        ],
    };
    let input = Panel {
        x: timeline.axis(),
        y: Axis::new(span(Trial::input), bracketed("input", joint.input_unit.as_deref()), 3.0),
        height: 80,
        marks: vec![
            timeline.borders(),
            Mark::lines(Role::Input, 1.4, timeline.held(|_, t| t.input())),
        ],
    };
    [output, input]
}

/// Where each breakpoint is: of accepted decisions, and of rejected ones.
fn breakpoints(estimated: EstimatedJoint<'_>, timeline: &Timeline<'_>) -> (Vec<Place>, Vec<Place>) {
    let (mut accepted, mut rejected) = (Vec::new(), Vec::new());
    let trials = estimated.joint.trials.iter().zip(&estimated.estimate.trials).enumerate();
    for (index, (trial, result)) in trials {
        for decision in result.iter().flat_map(|estimate| &estimate.decisions) {
            let Some(place) = breakpoint(decision, trial, index, timeline) else { continue };
            match decision.verdict() {
                Verdict::Accepted => accepted.push(place),
                Verdict::Rejected(_) => rejected.push(place),
            }
        }
    }
    (accepted, rejected)
}

fn breakpoint(
    decision: &Decision,
    trial: &Trial,
    index: usize,
    timeline: &Timeline<'_>,
) -> Option<Place> {
    let best = decision.breakpoint()?.candidate;
    let sample = decision.input_step.sample as f64 + decision.delay()?;
    let output = *trial.output().get(best.breakpoint.checked_sub(1)?)?;
    Some((timeline.at(index, sample), output))
}
