//! A model beside the measurement: what it simulates, the residual, and where that is largest.

use std::ops::Range;

use super::document::{Figure, HALF, WIDTH};
use super::timeline::{self, Spans, Timeline, validation, values_of};
use crate::diagnosis::failure::WorstSegment;
use crate::diagnosis::sensor_noise;
use crate::experiment::Trial;
use crate::figure::{Axis, Mark, Panel, Place, Role, Shape, Span, thinned_places};
use crate::report::{ComparedJoint, ImprovedJoint};
use crate::wording::{bracketed, percent};

/// Width of the noise band in standard deviations on each side: 95 % of normal noise.
const BAND: f64 = 1.96;

/// Measured and simulated output over time, and the residual.
pub(super) fn figure(improved: &ImprovedJoint<'_>) -> Figure {
    let compared = &improved.finding.compared;
    let role = Role::of_revision(improved.revisions.len().saturating_sub(1));
    let timeline = Timeline::of(compared.joint);
    let panels = simulated_panels(compared, role, &timeline, None);
    let name = format!("Measured and simulated output of {}", compared.joint.name);
    let mut caption = "The measured output beside the simulated one, and the residual.".to_owned();
    if worst_mark(compared, &timeline).is_some() {
        caption += " Worst segments are those with the largest sums of squares, and the one with the \
                    largest residual.";
    }
    Figure { name, width: WIDTH, panels: panels.into(), caption }
}

/// The output above, the residual below, which says where the model `fails` and under which condition.
pub(crate) fn simulated_panels(
    compared: &ComparedJoint<'_>,
    role: Role,
    timeline: &Timeline<'_>,
    fails: Option<(String, Spans)>,
) -> [Panel; 2] {
    let unit = compared.joint.output_unit.as_deref();
    let unfitted = timeline.shaded(Role::Faint, validation(compared.comparison), 0.13);
    let borders = timeline.borders();
    let output = Panel {
        x: timeline.axis().bare(),
        y: Axis::new(outputs(compared), bracketed("output", unit), 5.0),
        height: 170,
        marks: vec![
            unfitted.clone().named("not fitted"),
            borders.clone(),
            Mark::lines(Role::Measured, 3.0, timeline.lines(|_, t| t.output())).named("measured"),
            Mark::lines(role, 1.3, timeline.lines(|index, _| compared.simulated(index)))
                .named("simulated"),
        ],
    };
    let mut marks = vec![unfitted, borders];
    let fails = fails.map(|(when, spans)| timeline.shaded(Role::Rejected, spans, 0.2).named(when));
    marks.extend(fails.into_iter().chain(worst_mark(compared, timeline)));
    marks.extend(noise(compared).map(|mark| mark.named("95 % of the noise")));
    let left = timeline.lines(|index, _| compared.residual(index));
    marks.push(Mark::lines(role, 1.0, left).named("residual"));
    marks.extend(noise_edges(compared, timeline.ends()));
    let y = Axis::new(residuals(compared), bracketed("residual", unit), 6.0);
    [output, Panel { x: timeline.axis(), y, height: 110, marks }]
}

/// The segment with the largest share of the squared error, larger; none where no lack of
/// fit is shown.
pub(super) fn worst(compared: &ComparedJoint<'_>, place: usize) -> Option<Figure> {
    let joint = compared.joint;
    let worst = compared.comparison.failure.as_ref()?.worst_segments.first()?;
    let timeline = Timeline::shifted(joint, vec![0.0; joint.trials.len()]);
    let panel = worst_panel(compared, Role::of_revision(place), &timeline)?;
    let name = format!("The worst segment of {}", joint.name);
    let share = percent(worst.share_of_squared_error);
    let caption = format!(
        "The worst segment: it contains {share} of the squared error, more than any other."
    );
    Some(Figure { name, width: HALF, panels: vec![panel], caption })
}

/// The segment with the largest share of the squared error, and a part of the record around it.
pub(crate) fn worst_panel(
    compared: &ComparedJoint<'_>,
    role: Role,
    timeline: &Timeline<'_>,
) -> Option<Panel> {
    let worst = compared.comparison.failure.as_ref()?.worst_segments.first()?;
    let mut trials = compared.joint.trials.iter().enumerate();
    let (index, trial) = trials.find(|(_, trial)| trial.label() == worst.trial)?;
    let cut = |values: &[f64]| -> Vec<Vec<Place>> {
        let mut lines = around(values, trial, worst);
        lines.iter_mut().flatten().for_each(|place| place.0 = timeline.of_log(index, place.0));
        lines
    };
    let [measured, simulated] = [trial.output(), compared.simulated(index)].map(cut);
    let ends = [worst.start_s, worst.end_s].map(|end| timeline.of_log(index, end));
    let x = Span::around(measured.iter().flatten().map(|place| place.0), 0.0);
    let y = Span::around(measured.iter().chain(&simulated).flatten().map(|place| place.1), 0.08);
    let unit = compared.joint.output_unit.as_deref();
    Some(Panel {
        x: Axis::new(x, "time [s]", 6.0),
        y: Axis::new(y, bracketed("output", unit), 5.0),
        height: 190,
        marks: vec![
            Mark::new(Role::Attention, Shape::Spans(vec![ends.into()], 0.22)),
            Mark::lines(Role::Measured, 3.0, measured).named("measured"),
            Mark::lines(role, 1.4, simulated).named("simulated"),
        ],
    })
}

/// The logged samples of a segment, with a part of it before and after.
fn around(values: &[f64], trial: &Trial, worst: &WorstSegment) -> Vec<Vec<Place>> {
    let room = 0.5 * (worst.end_s - worst.start_s).max(trial.period().seconds());
    let (from, to) = (worst.start_s - room, worst.end_s + room);
    let line = |run: Range<usize>| {
        let places = run.filter_map(|k| Some((trial.time_s(k + 1), *values.get(k)?)));
        let inside: Vec<Place> = places.filter(|place| (from..=to).contains(&place.0)).collect();
        thinned_places(&inside, 900)
    };
    trial.logged().map(line).filter(|line| !line.is_empty()).collect()
}

fn outputs(compared: &ComparedJoint<'_>) -> Span {
    let measured = values_of(compared.joint, |_, trial| trial.output());
    let simulated = values_of(compared.joint, |index, _| compared.simulated(index));
    Span::around(measured.chain(simulated), 0.06)
}

fn residuals(compared: &ComparedJoint<'_>) -> Span {
    let all = values_of(compared.joint, |index, _| compared.residual(index));
    let band = sensor_noise(&compared.joint.trials).unwrap_or(0.0) * BAND;
    Span::around(all.chain([-band, band]), 0.06)
}

/// Between these values 95 % of normal noise would be.
fn noise(compared: &ComparedJoint<'_>) -> Option<Mark> {
    let band = sensor_noise(&compared.joint.trials)? * BAND;
    Some(Mark::new(Role::Noise, Shape::Band(-band, band)))
}

/// The edges of that, which show over the residual.
fn noise_edges(compared: &ComparedJoint<'_>, (from, to): (f64, f64)) -> Option<Mark> {
    let band = sensor_noise(&compared.joint.trials)? * BAND;
    let edges = [-band, band].map(|edge| vec![(from, edge), (to, edge)]);
    Some(Mark::lines(Role::Noise, 1.4, edges.to_vec()))
}

/// Where the worst segments are, where there are any.
fn worst_mark(compared: &ComparedJoint<'_>, timeline: &Timeline<'_>) -> Option<Mark> {
    let worst = timeline::worst(compared.joint, compared.comparison);
    let is_any = !worst.is_empty();
    is_any.then(|| timeline.shaded(Role::Attention, worst, 0.3).named("worst segments"))
}
