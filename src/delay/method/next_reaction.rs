//! Whether breakpoints are reactions to the steps after theirs.
//!
//! A segment of Algorithm 1 reaches α samples beyond the next step. Where a joint reacts within α,
//! the reaction to that step lies in it, too, and may bend the output more than the step's own. The
//! next segment then begins after its own reaction, which it cannot find, and so on to the end of
//! the record: every delay is a hold, and the next delay.
//!
//! The change of slope shows to which step a breakpoint belongs, since it is proportional to the
//! change of the input: `c_i = g·Δu_i`, or `c_i = g·Δu_(i+1)`. Of both, the one with the smaller
//! squared error of a line through the origin is taken:
//!
//! ```text
//! R² = (Σ c_i Δu)² / (Σ c_i² · Σ Δu²)
//! ```

use crate::delay::decision::Decision;

/// Breakpoints after the next step from which on the question is asked.
const FEWEST: usize = 3;

/// By how much more of the changes of slope the next steps must explain. Levels that alternate leave
/// both alike. Chosen: records of three levels and more differ by far more.
const MORE: f64 = 0.1;

/// Whether the breakpoints of `decisions` that lie about or after the next step, in rows of `beta`
/// samples, are reactions to it.
pub(super) fn answer_the_next_step(decisions: &[Decision], beta: usize) -> bool {
    let change = |decision: &Decision| decision.input_step.after - decision.input_step.before;
    let late = decisions.windows(2).filter_map(|pair| {
        let candidate = pair[0].breakpoint()?.candidate;
        let is_late = candidate.breakpoint + beta >= pair[1].input_step.sample;
        is_late.then(|| [candidate.slope_change(), change(&pair[0]), change(&pair[1])])
    });
    let late: Vec<[f64; 3]> = late.collect();
    let explained = |step: usize| {
        let sum = |a: usize, b: usize| late.iter().map(|one| one[a] * one[b]).sum::<f64>();
        let squares = sum(0, 0) * sum(step, step);
        if squares > 0.0 { sum(0, step).powi(2) / squares } else { 0.0 }
    };
    late.len() >= FEWEST && explained(2) > explained(1) + MORE
}
