//! The delays of a joint: over time, and against its state.

use super::document::{Figure, HALF, WIDTH, slug};
use super::timeline::Timeline;
use crate::delay::{AgainstOfKind, AgainstState, DelayProfile, DelayTable, Transition};
use crate::figure::delay_levels;
use crate::figure::{Axis, Mark, Panel, Place, Role, Shape, Span, thinned_places};
use crate::report::EstimatedJoint;
use crate::report::against::variable_text;
use crate::report::doubt::doubted;
use crate::wording::{capitalized, p_cell};

/// Steps between which the delay is drawn.
const MOST_STEPS: usize = 2000;

/// What a joint's delays are over time.
#[derive(Default)]
struct Delays {
    accepted: Vec<Place>,
    intervals: Vec<Vec<Place>>,
    rejected: Vec<f64>,
    held: Vec<Vec<Place>>,
}

/// The delay of each step over time; none where none was accepted.
pub(super) fn over_time(estimated: EstimatedJoint<'_>, file: String) -> Option<Figure> {
    let panels = vec![panel(estimated, &Timeline::of(estimated.joint))?];
    let name = format!("Delay of {} over time", estimated.joint.name);
    let caption = "The delay of each step, at the time of the step; rejected steps stand at \
                   the bottom."
        .to_owned();
    Some(Figure { file, name, width: WIDTH, panels, caption })
}

pub(crate) fn panel(estimated: EstimatedJoint<'_>, timeline: &Timeline<'_>) -> Option<Panel> {
    let Delays { accepted, intervals, rejected, held } = delays(estimated, timeline);
    if accepted.is_empty() {
        return None;
    }
    let values = accepted.iter().chain(intervals.iter().flatten()).map(|place| place.1);
    let y = Span::around(values, 0.14);
    let bottom = y.low + 0.05 * (y.high - y.low);
    let rejected: Vec<Place> = rejected.into_iter().map(|time| (time, bottom)).collect();
    let mut marks = vec![timeline.borders()];
    // Of more steps than that only a filled area would be seen.
    let are_apart = accepted.len() <= MOST_STEPS;
    if are_apart {
        let held = Mark::lines(Role::Smoothed, 1.0, held);
        marks.push(held.named("delay of every sample"));
    }
    if !intervals.is_empty() && are_apart {
        marks.push(Mark::lines(Role::Faint, 1.4, intervals).named("interval"));
    }
    marks.push(Mark::dots(Role::Accepted, accepted).named("accepted step"));
    if !rejected.is_empty() {
        marks.push(Mark::new(Role::Rejected, Shape::Crosses(rejected)).named("rejected step"));
    }
    Some(Panel { x: timeline.axis(), y: Axis::new(y, "delay [s]", 5.0), height: 150, marks })
}

fn delays(estimated: EstimatedJoint<'_>, timeline: &Timeline<'_>) -> Delays {
    let mut delays = Delays::default();
    let trials = estimated.joint.trials.iter().zip(&estimated.estimate.trials).enumerate();
    for (index, (trial, result)) in trials {
        let Ok(estimate) = result else { continue };
        let period_s = trial.period().seconds();
        for decision in &estimate.decisions {
            let at = timeline.at(index, decision.input_step.sample as f64);
            let Some(delay) = decision.accepted_delay() else {
                delays.rejected.push(at);
                continue;
            };
            delays.accepted.push((at, delay * period_s));
            delays.intervals.extend(
                decision
                    .fine
                    .map(|fine| vec![(at, fine.low * period_s), (at, fine.high * period_s)]),
            );
        }
        let place = |(k, tau): (usize, f64)| (timeline.at(index, (k + 1) as f64), tau * period_s);
        let runs = runs(&estimate.profile).into_iter();
        delays.held.extend(runs.map(|run| run.into_iter().map(place).collect()));
    }
    delays
}

/// Spans of samples with a delay, each as its corners.
fn runs(profile: &DelayProfile) -> Vec<Vec<(usize, f64)>> {
    let known: Vec<_> = profile.iter().enumerate().collect();
    let same = |a: &(usize, Option<f64>), b: &(usize, Option<f64>)| a.1.is_some() == b.1.is_some();
    let runs = known.chunk_by(same).filter(|run| run.iter().all(|(_, tau)| tau.is_some()));
    runs.map(|run| {
        corners(&run.iter().filter_map(|(k, tau)| Some((*k, (*tau)?))).collect::<Vec<_>>())
    })
    .collect()
}

/// A run without samples whose neighbours have the same delay, thinned to what is seen.
fn corners(run: &[(usize, f64)]) -> Vec<(usize, f64)> {
    #[expect(clippy::float_cmp, reason = "a held delay is the same number")]
    let is_inside = |trio: &[(usize, f64)]| match trio {
        [a, b, c] => a.1 == b.1 && b.1 == c.1,
        _ => false,
    };
    let inside = run.windows(3).filter(|trio| !is_inside(trio)).filter_map(|trio| trio.get(1));
    let kept: Vec<_> = run.first().into_iter().chain(inside).chain(run.last()).copied().collect();
    thinned_places(&kept, 4000)
}

/// The median delay over the level, by kind of step; none where none was accepted.
pub(super) fn over_levels(
    estimated: EstimatedJoint<'_>,
    found: &DelayTable,
    file: String,
) -> Option<Figure> {
    let panel = delay_levels::panel(found, estimated.joint.input_unit.as_deref())?;
    let name = format!("Delay of {} by level", estimated.joint.name);
    let caption = "The median delay over the level, for a stop that before it, else that after \
                   it, with its 95 % interval and how many of how many steps were accepted; where \
                   none was, a cross stands at the bottom."
        .to_owned();
    Some(Figure { file, name, width: WIDTH, panels: vec![panel], caption })
}

/// The delay against the speed, and against what it goes with most besides.
pub(super) fn against(joint: &str, found: &AgainstState, file: &str) -> Vec<Figure> {
    /// Number of the speed among the variables.
    const SPEED: usize = 0;
    let strength = |index: &usize| {
        let of_kinds = found.kinds.iter().filter_map(|kind| kind.correlations.get(*index));
        of_kinds.filter_map(|one| one.p_value).fold(f64::INFINITY, f64::min)
    };
    let others = (0..found.correlations.len()).filter(|index| *index != SPEED);
    let strongest = others.min_by(|a, b| strength(a).total_cmp(&strength(b)));
    let shown = std::iter::once(SPEED).chain(strongest);
    shown.filter_map(|variable| scatter(joint, found, variable, file)).collect()
}

/// The delays against one variable, by kind of step; none where it is not known.
fn scatter(joint: &str, found: &AgainstState, variable: usize, file: &str) -> Option<Figure> {
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
    let panel = Panel {
        x: Axis::new(x, quantity.clone(), 6.0),
        y: Axis::new(y, "delay [s]", 5.0),
        height: 190,
        marks: kinds.into_iter().map(mark).collect(),
    };
    let name = format!("Delay of {joint} against {quantity}");
    let file = format!("{file}-against-{}", slug(&correlation.variable));
    let caption = caption(found, variable, &correlation.variable);
    Some(Figure { file, name, width: HALF, panels: vec![panel], caption })
}

/// What is said of each kind of step.
fn caption(found: &AgainstState, variable: usize, name: &str) -> String {
    let of_kind = |kind: &AgainstOfKind| {
        let one = kind.correlations.get(variable)?;
        let Some(rho) = one.rho else {
            return Some(format!("{}: too few steps, or no change, to tell more", kind.transition));
        };
        let p = p_cell(one.p_holm);
        let p = if p.starts_with('<') { format!("p {p}") } else { format!("p = {p}") };
        let said = if one.significant { "the delay depends on it" } else { "no dependence shown" };
        Some(format!("{}: {said} (ρ = {rho:+.2}, {p})", kind.transition))
    };
    let said: Vec<_> = found.kinds.iter().filter_map(of_kind).collect();
    let name = name.replace('_', " ");
    format!("Delay against {name}. {}.", capitalized(&said.join("; ")))
}

/// How the delays of each joint are spread; none of fewer than two joints.
pub(super) fn overview(joints: &[EstimatedJoint<'_>]) -> Option<Figure> {
    let rows: Vec<_> = joints.iter().filter_map(|joint| Spread::of(*joint)).collect();
    if rows.len() < 2 {
        return None;
    }
    let names: Vec<String> = rows.iter().map(|row| row.name.clone()).collect();
    let row = |index: usize| -(index as f64);
    let line = |from: fn(&Spread) -> f64, to: fn(&Spread) -> f64| {
        let ends =
            |(index, one): (usize, &Spread)| vec![(from(one), row(index)), (to(one), row(index))];
        rows.iter().enumerate().map(ends).collect::<Vec<_>>()
    };
    let medians = rows.iter().enumerate().map(|(index, one)| (one.median, row(index))).collect();
    let x = Span::around(rows.iter().flat_map(|one| [one.low, one.high]).chain([0.0]), 0.03);
    let panel = Panel {
        x: Axis::new(x, "delay [s]", 8.0),
        y: Axis::of_names(&names, ""),
        height: 22 * u32::try_from(rows.len()).unwrap_or(1) + 10,
        marks: vec![
            Mark::lines(Role::Faint, 1.2, line(|s| s.low, |s| s.high)).named("least to greatest"),
            Mark::lines(Role::Smoothed, 6.0, line(|s| s.lower, |s| s.upper)).named("middle half"),
            Mark::dots(Role::Ink, medians).named("median"),
        ],
    };
    let [file, name, caption] =
        ["delays", "Delays of all joints", "The accepted delays of each joint."].map(str::to_owned);
    Some(Figure { file, name, width: WIDTH, panels: vec![panel], caption })
}

/// How the accepted delays of a joint are spread, in seconds.
struct Spread {
    name: String,
    low: f64,
    lower: f64,
    median: f64,
    upper: f64,
    high: f64,
}

impl Spread {
    fn of(estimated: EstimatedJoint<'_>) -> Option<Self> {
        let mut delays: Vec<f64> = doubted(estimated)
            .filter_map(|found| found.delay_s(found.decision.accepted_delay()))
            .collect();
        delays.sort_by(f64::total_cmp);
        let at = |share: f64| crate::numerics::quantile(&delays, share);
        let name = estimated.joint.name.clone();
        let (low, high) = (*delays.first()?, *delays.last()?);
        Some(Self { name, low, lower: at(0.25)?, median: at(0.5)?, upper: at(0.75)?, high })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_of_equal_delays_is_drawn_by_its_corners() {
        let run = [(3, 1.0), (4, 1.0), (5, 1.0), (6, 2.0), (7, 2.0), (8, 2.0)];
        assert_eq!(corners(&run), [(3, 1.0), (5, 1.0), (6, 2.0), (8, 2.0)]);
        assert_eq!(corners(&run[..1]).first(), Some(&(3, 1.0)));
    }
}
