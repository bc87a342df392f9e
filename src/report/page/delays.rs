//! The record of a joint, its delays over time and against its state, and its dead time, as drawings.

use super::document::{Block, Figure, HALF, WIDTH};
use super::timeline::{Timeline, values_of};
use crate::delay::{AgainstState, Bounds, DeadTime, Decision, DelayTable, Transition, Verdict};
use crate::experiment::Trial;
use crate::figure::{Axis, Mark, Panel, Place, Role, Shape, Span, delay_levels};
use crate::numerics::quantile;
use crate::report::EstimatedJoint;
use crate::report::answer::dead_time_sentences;
use crate::report::decisions::doubted;
use crate::report::delays::variable_text;
use crate::wording::bracketed;

/// Input and output over time.
pub(super) fn record_figure(estimated: EstimatedJoint<'_>) -> Figure {
    let joint = estimated.joint;
    let name = format!("Input and output of {} over time", joint.name);
    let mut caption =
        "Input and output over time, with the breakpoint of each input step.".to_owned();
    if joint.trials.iter().any(|trial| !trial.unlogged().is_empty()) {
        caption += " Lines are interrupted where nothing was logged.";
    }
    let panels = record_panels(estimated, &Timeline::of(joint)).into();
    Figure { name, width: WIDTH, panels, caption }
}

/// The output with the breakpoints above, the input below.
pub(crate) fn record_panels(estimated: EstimatedJoint<'_>, timeline: &Timeline<'_>) -> [Panel; 2] {
    let joint = estimated.joint;
    let [accepted, rejected] = breakpoints(estimated, timeline);
    let span = |values: fn(&Trial) -> &[f64]| {
        Span::around(values_of(joint, |_, trial| values(trial)), 0.06)
    };
    let measured = Mark::lines(Role::Measured, 1.3, timeline.lines(|_, t| t.output()));
    let mut marks = vec![timeline.borders(), measured.named("output")];
    // An input that moves all the time has no breakpoints.
    if !(accepted.is_empty() && rejected.is_empty()) {
        marks.push(Mark::dots(Role::Accepted, accepted).named("breakpoint, accepted"));
        marks.push(Mark::new(Role::Rejected, Shape::Crosses(rejected)).named("rejected"));
    }
    let output = Panel {
        x: timeline.axis().bare(),
        y: Axis::new(span(Trial::output), bracketed("output", joint.output_unit.as_deref()), 5.0),
        height: 170,
        marks,
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

/// All decisions with their trials and the places of these.
fn placed(
    estimated: EstimatedJoint<'_>,
) -> impl Iterator<Item = (usize, &Trial, &Decision)> + use<'_> {
    let trials = estimated.joint.trials.iter().zip(&estimated.estimate.trials).enumerate();
    trials.flat_map(|(index, (trial, found))| {
        let decisions = found.iter().flat_map(|found| &found.decisions);
        decisions.map(move |decision| (index, trial, decision))
    })
}

/// Where each breakpoint is: of accepted decisions, and of rejected ones.
fn breakpoints(estimated: EstimatedJoint<'_>, timeline: &Timeline<'_>) -> [Vec<Place>; 2] {
    let mut breakpoints = [Vec::new(), Vec::new()];
    let place = |index: usize, trial: &Trial, decision: &Decision| {
        let best = decision.breakpoint()?.candidate;
        let sample = decision.input_step.sample as f64 + decision.delay()?;
        let output = *trial.output().get(best.breakpoint.checked_sub(1)?)?;
        Some((timeline.at(index, sample), output))
    };
    for (index, trial, decision) in placed(estimated) {
        let kind = usize::from(decision.verdict() != Verdict::Accepted);
        breakpoints[kind].extend(place(index, trial, decision));
    }
    breakpoints
}

/// The delay of each step over time; none where none was accepted.
pub(super) fn over_time(estimated: EstimatedJoint<'_>) -> Option<Figure> {
    let panels = vec![delay_panel(estimated, &Timeline::of(estimated.joint))?];
    let name = format!("Delay of {} over time", estimated.joint.name);
    let caption = "Delay of each step against the time of the step; rejected steps are marked at \
                   the bottom."
        .to_owned();
    Some(Figure { name, width: WIDTH, panels, caption })
}

pub(crate) fn delay_panel(estimated: EstimatedJoint<'_>, timeline: &Timeline<'_>) -> Option<Panel> {
    let (mut accepted, mut intervals, mut rejected) = (Vec::new(), Vec::new(), Vec::new());
    for (index, trial, decision) in placed(estimated) {
        let (at, period_s) =
            (timeline.at(index, decision.input_step.sample as f64), trial.period().seconds());
        let Some(delay) = decision.accepted_delay() else {
            rejected.push(at);
            continue;
        };
        accepted.push((at, delay * period_s));
        let ends = decision.fine.map(|fine| [fine.low, fine.high]);
        intervals.extend(ends.map(|ends| ends.map(|end| (at, end * period_s)).to_vec()));
    }
    if accepted.is_empty() {
        return None;
    }
    let values = accepted.iter().chain(intervals.iter().flatten()).map(|place| place.1);
    let y = Span::around(values, 0.14);
    let bottom = y.low + 0.05 * (y.high - y.low);
    let rejected: Vec<Place> = rejected.into_iter().map(|time| (time, bottom)).collect();
    let mut marks = vec![timeline.borders()];
    if !intervals.is_empty() {
        marks.push(Mark::lines(Role::Faint, 1.4, intervals).named("interval"));
    }
    marks.push(Mark::dots(Role::Accepted, accepted).named("accepted step"));
    if !rejected.is_empty() {
        marks.push(Mark::new(Role::Rejected, Shape::Crosses(rejected)).named("rejected step"));
    }
    Some(Panel { x: timeline.axis(), y: Axis::new(y, "delay [s]", 5.0), height: 150, marks })
}

/// The median delay over the level, by kind of step; none where none was accepted.
pub(super) fn over_levels(estimated: EstimatedJoint<'_>, found: &DelayTable) -> Option<Figure> {
    let panel = delay_levels::panel(found, estimated.joint.input_unit.as_deref())?;
    let name = format!("Delay of {} by level", estimated.joint.name);
    let caption = "Median delay against the level after the step (for a stop, the level before \
                   it), with its 95 % interval and the number of accepted steps out of all; a \
                   cross at the bottom marks a level without an accepted step."
        .to_owned();
    Some(Figure { name, width: WIDTH, panels: vec![panel], caption })
}

/// Number of the speed among the variables.
const SPEED: usize = 0;

/// The delay against the speed, and against what it goes with most besides.
pub(super) fn against(joint: &str, found: &AgainstState) -> Vec<Figure> {
    let strongest = by_strength(found).into_iter().find(|variable| *variable != SPEED);
    let shown = std::iter::once(SPEED).chain(strongest);
    shown.filter_map(|variable| scatter(joint, found, variable)).collect()
}

/// All variables, that on which the delay of a kind of step depends most surely first.
pub(crate) fn by_strength(found: &AgainstState) -> Vec<usize> {
    let least_p = |index: &usize| {
        let of_kinds = found.kinds.iter().filter_map(|kind| kind.correlations.get(*index));
        of_kinds.filter_map(|one| one.p_value).fold(f64::INFINITY, f64::min)
    };
    let mut all: Vec<usize> = (0..found.correlations.len()).collect();
    all.sort_by(|a, b| least_p(a).total_cmp(&least_p(b)));
    all
}

fn scatter(joint: &str, found: &AgainstState, variable: usize) -> Option<Figure> {
    let panel = against_panel(found, variable)?;
    let variable_name = &found.correlations.get(variable)?.variable;
    let name = format!("Delay of {joint} against {}", panel.x.name);
    let caption = format!("Delay against {}.", variable_name.replace('_', " "));
    Some(Figure { name, width: HALF, panels: vec![panel], caption })
}

/// The delays against one variable, by kind of step; none where it is not known.
pub(crate) fn against_panel(found: &AgainstState, variable: usize) -> Option<Panel> {
    let correlation = found.correlations.get(variable)?;
    let points = |kind: Transition| {
        let same = found.steps.iter().filter(|step| step.transition == kind);
        let places = same.filter_map(|step| Some((step.value(variable)?, step.delay_s)));
        (kind, places.collect::<Vec<Place>>())
    };
    let kinds = Transition::ALL.map(points).into_iter().filter(|(_, places)| !places.is_empty());
    let kinds: Vec<_> = kinds.collect();
    if kinds.is_empty() {
        return None;
    }
    let all = || kinds.iter().flat_map(|(_, places)| places);
    let x = Span::around(all().map(|place| place.0), 0.05);
    let y = Span::around(all().map(|place| place.1), 0.1);
    let quantity = variable_text(&correlation.variable, correlation.unit.as_deref());
    let mark = |(kind, places): (Transition, Vec<Place>)| {
        Mark::dots(delay_levels::role(kind), places).named(kind.id())
    };
    Some(Panel {
        x: Axis::new(x, quantity, 6.0),
        y: Axis::new(y, "delay [s]", 5.0),
        height: 190,
        marks: kinds.into_iter().map(mark).collect(),
    })
}

/// How the delays of each joint are spread; none of fewer than two joints.
pub(super) fn overview(joints: &[EstimatedJoint<'_>]) -> Option<Figure> {
    let spread = |joint: &EstimatedJoint<'_>| Some((joint.joint.name.clone(), spread(*joint)?));
    let (names, spreads): (Vec<String>, Vec<[f64; 5]>) = joints.iter().filter_map(spread).unzip();
    if names.len() < 2 {
        return None;
    }
    let rows = || (0_u32..).map(|row| -f64::from(row)).zip(&spreads);
    let line = |from: usize, to: usize| {
        rows().map(|(row, at)| vec![(at[from], row), (at[to], row)]).collect::<Vec<_>>()
    };
    let x = Span::around(spreads.iter().flat_map(|at| [at[0], at[4]]).chain([0.0]), 0.03);
    let panel = Panel {
        x: Axis::new(x, "delay [s]", 8.0),
        y: Axis::of_names(&names, ""),
        height: 22 * u32::try_from(names.len()).unwrap_or(1) + 10,
        marks: vec![
            Mark::lines(Role::Faint, 1.2, line(0, 4)).named("least to greatest"),
            Mark::lines(Role::Smoothed, 6.0, line(1, 3)).named("middle half"),
            Mark::dots(Role::Ink, rows().map(|(row, at)| (at[2], row)).collect()).named("median"),
        ],
    };
    let [name, caption] =
        ["Delays of all joints", "The accepted delays of each joint."].map(str::to_owned);
    Some(Figure { name, width: WIDTH, panels: vec![panel], caption })
}

/// The least, the quartiles and the greatest of the accepted delays of a joint, in seconds.
fn spread(estimated: EstimatedJoint<'_>) -> Option<[f64; 5]> {
    let delays = doubted(estimated).filter_map(|it| it.delay_s(it.decision.accepted_delay()));
    let mut delays: Vec<f64> = delays.collect();
    delays.sort_by(f64::total_cmp);
    let at = |share: f64| quantile(&delays, share);
    Some([*delays.first()?, at(0.25)?, at(0.5)?, at(0.75)?, *delays.last()?])
}

/// What is said and drawn of it; nothing for an input that is made of steps.
pub(super) fn dead_time_blocks(estimated: EstimatedJoint<'_>) -> Vec<Block> {
    let Some(found) = &estimated.estimate.dead_time else { return Vec::new() };
    let mut blocks = vec![Block::part("Dead time")];
    let sentences = dead_time_sentences(&estimated);
    blocks.extend(sentences.into_iter().map(|sentence| Block::text(format!("{sentence}."))));
    let drawn = [windows_over_time(estimated, found), curve(estimated, found)];
    let figures: Vec<Figure> = drawn.into_iter().flatten().collect();
    if !figures.is_empty() {
        blocks.push(Block::Figures(figures));
    }
    blocks
}

/// The dead time of each window, with its interval.
fn windows_over_time(estimated: EstimatedJoint<'_>, found: &DeadTime) -> Option<Figure> {
    let panels = vec![dead_time_panel(found, &Timeline::of(estimated.joint))?];
    let name = format!("Dead time of {} over time", estimated.joint.name);
    let caption = "Dead time in windows of the record, with intervals; a window in which the \
                   input moves the output too little has none."
        .to_owned();
    Some(Figure { name, width: WIDTH, panels, caption })
}

pub(crate) fn dead_time_panel(found: &DeadTime, timeline: &Timeline<'_>) -> Option<Panel> {
    let known = found.windows.iter().filter_map(|window| {
        let at = |sample: usize| timeline.at(window.trial, sample as f64);
        Some((at(window.first), at(window.last), window.estimate?))
    });
    let known: Vec<(f64, f64, Bounds)> = known.collect();
    if known.is_empty() {
        return None;
    }
    let middle = |(from, to, _): &(f64, f64, Bounds)| f64::midpoint(*from, *to);
    let interval =
        |one: &(f64, f64, Bounds)| vec![(middle(one), one.2.low_s), (middle(one), one.2.high_s)];
    let reach = |(from, to, b): &(f64, f64, Bounds)| vec![(*from, b.value_s), (*to, b.value_s)];
    let dots: Vec<Place> = known.iter().map(|one| (middle(one), one.2.value_s)).collect();
    let intervals: Vec<Vec<Place>> = known.iter().map(interval).collect();
    let y = Span::around(intervals.iter().flatten().map(|place| place.1), 0.14);
    let mut marks = vec![timeline.borders()];
    if let Some(Bounds { low_s, high_s, .. }) = found.bounds() {
        marks.push(Mark::new(Role::Noise, Shape::Band(low_s, high_s)).named("whole record"));
    }
    let reaches = known.iter().map(reach).collect();
    marks.push(Mark::lines(Role::Smoothed, 1.0, reaches).named("window"));
    marks.push(Mark::lines(Role::Faint, 1.4, intervals).named("interval"));
    marks.push(Mark::dots(Role::Accepted, dots).named("dead time"));
    let axis = Axis::new(y, "dead time [s]", 5.0);
    Some(Panel { x: timeline.axis(), y: axis, height: 150, marks })
}

/// The prediction error of each dead time.
fn curve(estimated: EstimatedJoint<'_>, found: &DeadTime) -> Option<Figure> {
    let points: Vec<Place> = found.curve.iter().map(|p| (p.delay_s, p.error)).collect();
    let (bounds, last) = found.bounds().zip(points.last())?;
    let y = Span::around(points.iter().map(|place| place.1), 0.1);
    let x = Axis::new(Span::new(0.0, last.0), "dead time [s]", 10.0);
    let marks = vec![
        Mark::new(Role::Noise, Shape::Spans(vec![(bounds.low_s, bounds.high_s)], 1.0))
            .named("interval"),
        Mark::new(Role::Accepted, Shape::Verticals(vec![bounds.value_s], 1.4)).named("dead time"),
        Mark::lines(Role::Error, 1.4, vec![points]).named("error"),
    ];
    let panel = Panel { x, y: Axis::new(y, "error over the least", 5.0), height: 150, marks };
    let name = format!("Prediction error of {} by dead time", estimated.joint.name);
    let caption = "Prediction error against dead time; all other parameters are refitted for each \
                   dead time."
        .to_owned();
    Some(Figure { name, width: WIDTH, panels: vec![panel], caption })
}
