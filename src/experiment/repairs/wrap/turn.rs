//! The turn after which a sensor begins anew: by its unit, or as its jumps show it.

use crate::numerics::{RunningLine, as_written, median};

/// Part of a turn that an output which wraps goes through, at least.
pub(super) const RANGE: f64 = 0.9;

/// The turns of sensors of angles, by the names of their units; where none is said it may be the
/// first two.
const TURNS: [(&[&str], f64); 6] = [
    (&["deg", "°", "degrees"], 360.0),
    (&["rad", "radians"], std::f64::consts::TAU),
    (&["mdeg"], 360e3),
    (&["mrad"], 1e3 * std::f64::consts::TAU),
    (&["gon"], 400.0),
    (&["rev", "turn", "turns"], 1.0),
];

pub(super) fn turns(unit: Option<&str>) -> impl Iterator<Item = f64> {
    let is_it = move |(place, (units, _)): &(usize, (&[&str], f64))| {
        unit.map_or(*place < 2, |unit| units.contains(&unit))
    };
    TURNS.into_iter().enumerate().filter(is_it).map(|(_, (_, turn))| turn)
}

/// Those of sensors that count.
pub(super) fn powers_of_two(unit: Option<&str>) -> impl Iterator<Item = f64> {
    const COUNTS: [&str; 5] = ["cnt", "count", "counts", "inc", "ticks"];
    let is_count = unit.is_none_or(|unit| COUNTS.contains(&unit));
    (8..=32).map(|bits| 2_f64.powi(bits)).filter(move |_| is_count)
}

/// The turn that the jumps of `trials` show, whose output goes through so much of a `range`: none where
/// their unit says it, or where no two of these are jumps to the other end of the range and on in the
/// same direction. Others are noise where a joint rests at the end of a turn.
pub(super) fn seen(trials: &[Vec<f64>], range: f64, unit: Option<&str>) -> Option<f64> {
    /// Jumps, at least: a sensor that is set to zero jumps once.
    const FEWEST: usize = 2;
    /// The part that a turn of a few significant digits may be off by.
    const OFF: f64 = 2e-3;
    let is_said = unit.is_some_and(|unit| TURNS.iter().any(|(units, _)| units.contains(&unit)));
    if is_said {
        return None;
    }
    let turns: Vec<f64> = trials.iter().flat_map(|trial| turns_at_jumps(trial, range)).collect();
    let turn = median(&turns).filter(|_| turns.len() >= FEWEST)?;
    // Makers choose round numbers.
    let binary = 2_f64.powf(turn.log2().round());
    let round = [binary, as_written(turn, 1), as_written(turn, 2), as_written(turn, 3)];
    let is_near = |round: &f64| (round / turn - 1.0).abs() < OFF;
    Some(round.into_iter().find(is_near).unwrap_or(turn))
}

/// The turn of each jump through the `range`: its height and the way gone meanwhile. None of a jump against
/// which the output does not plainly move, before it and behind it.
fn turns_at_jumps(trial: &[f64], range: f64) -> Vec<f64> {
    /// Samples whose motion is looked at, and the part of the range that it goes through, at least.
    const NEAR: usize = 20;
    const LEAST: f64 = 0.005;
    let jumps = (1..trial.len()).filter(|k| (trial[*k] - trial[*k - 1]).abs() >= RANGE * range);
    let ends: Vec<usize> = [0].into_iter().chain(jumps).chain([trial.len()]).collect();
    let turn = |jumps: &[usize]| {
        let &[from, at, to] = jumps else { return None };
        let jump = trial[at] - trial[at - 1];
        let before = &trial[from.max(at.saturating_sub(NEAR))..at];
        let behind = &trial[at..to.min(at + NEAR)];
        let moved = |part: &[f64]| -jump.signum() * (part[part.len() - 1] - part[0]);
        let moves = moved(before).min(moved(behind)) >= LEAST * range;
        // From the middle of what is before to that of what is behind, by the slopes of both.
        let (before, behind) = (line(before), line(behind));
        let way = |(line, samples): &(RunningLine, usize)| 0.5 * line.slope() * *samples as f64;
        let apart = behind.0.mean() - before.0.mean() - way(&before) - way(&behind);
        moves.then(|| apart.abs())
    };
    ends.windows(3).filter_map(turn).collect()
}

/// The line through samples, and how many there are.
fn line(part: &[f64]) -> (RunningLine, usize) {
    let mut line = RunningLine::default();
    for value in part {
        line.push(*value);
    }
    (line, part.len())
}
