//! Sensors whose zero is set anew amid a record.
//!
//! An incremental encoder that is homed again goes on from another value: from one row to the next the
//! output jumps as it never moves. What follows is taken back by the jump.

use crate::experiment::layout::JointLayout;
use crate::experiment::log::{Log, Mended};
use crate::numerics::{median, to_digits};

/// The output of a joint without its jumps where its zero is set anew. Rows after a gap lie as far apart as the joint
/// moved there, and where the clock starts anew so does the record.
pub(super) fn put_back(log: &Log<'_>, joint: &JointLayout) -> Option<Mended> {
    let (inputs, outputs) = (log.parts(joint.input.column)?, log.parts(joint.output.column)?);
    let signals = inputs.into_iter().zip(&outputs).map(|(input, output)| [input, *output]);
    let least = least_jump(&signals.collect::<Vec<_>>())?;
    let mut trials = log.table.trials.iter().zip(outputs);
    if !trials.all(|(rows, output)| are_near(log, rows.start, output, least)) {
        return None;
    }
    let mut values = log.column(joint.output.column)?.values.clone();
    let mut jumps = Vec::new();
    for rows in log.spans() {
        let part = values.get_mut(rows.clone())?;
        jumps.extend(taken_out(part, least).into_iter().map(|(row, by)| (rows.start + row, by)));
    }
    let (row, by) = jumps.first()?;
    let unit =
        joint.output.signal.unit.as_ref().map_or_else(String::new, |unit| format!(" {unit}"));
    let (row, by) = (log.row(*row), to_digits(*by, 3));
    let more = match jumps.len() {
        1 => String::new(),
        count => format!(", and {} times more", count - 1),
    };
    let note = format!(
        "the output jumps by {by}{unit} at row {row}{more}, much farther than between any other \
         rows: the sensor was probably re-zeroed, so later samples are shifted back by this amount"
    );
    Some((values, Some(note)))
}

/// Whether the rows on both sides of each jump in `output`, from the row `start` on, follow one another.
fn are_near(log: &Log<'_>, start: usize, output: &[f64], least: f64) -> bool {
    /// Times the usual distance of rows that two are apart, at most.
    const NEAR: f64 = 1.5;
    let Some(times) = log.times.get(start..start + output.len()) else { return true };
    let apart: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let Some(usual) = median(&apart) else { return true };
    jumps(output, least).into_iter().all(|row| (0.0..=NEAR * usual).contains(&apart[row - 1]))
}

/// Jumps of a joint, at most.
const MOST: usize = 8;

/// Changes of an input that holds its levels for each jump, at least, and jumps where it moves all the
/// time, at most: what answers most steps of the input is how the output moves.
const STEPS: usize = 4;
const FEW: usize = 3;

/// Times the largest change from row to row elsewhere that a jump is, at least (chosen).
const TIMES: f64 = 20.0;

/// Rows between two jumps, at least: a spike of the sensor jumps to and fro.
const APART: usize = 50;

/// The change from row to row, output units, from which on the output of a joint jumps, with the inputs and
/// outputs of its `trials`, not a number where they are missing; none where it does not.
fn least_jump(trials: &[[&[f64]; 2]]) -> Option<f64> {
    let changes = |of: usize| {
        let pairs = trials.iter().flat_map(move |trial| trial[of].windows(2));
        pairs.map(|pair| (pair[1] - pair[0]).abs())
    };
    // The largest first, one more than may be jumps.
    let mut largest = [0.0_f64; MOST + 1];
    for change in changes(1) {
        let place = largest.partition_point(|known| *known >= change);
        if change.is_finite() && place < largest.len() {
            largest[place..].rotate_right(1);
            largest[place] = change;
        }
    }
    let is_far =
        |jumps: &usize| largest[*jumps] > 0.0 && largest[jumps - 1] >= TIMES * largest[*jumps];
    let count = (1..=MOST).find(is_far)?;
    let steps = changes(0).filter(|change| *change > 0.0).count();
    let is_held = STEPS * steps <= changes(0).count();
    let most = if is_held { steps / STEPS } else { FEW };
    let least = largest[count - 1];
    let are_apart = trials.iter().all(|[_, output]| {
        let jumps = jumps(output, least);
        let inside = |row: &usize| *row >= APART && row + APART <= output.len();
        jumps.iter().all(inside) && jumps.windows(2).all(|pair| pair[1] - pair[0] >= APART)
    });
    (count <= most && are_apart).then_some(least)
}

/// The indices after the jumps of an output.
fn jumps(output: &[f64], least: f64) -> Vec<usize> {
    (1..output.len()).filter(|row| (output[*row] - output[row - 1]).abs() >= least).collect()
}

/// Takes the jumps out of `output`: the change of the row before is taken for that of the jump's. The
/// indices after them, with how far they go.
fn taken_out(output: &mut [f64], least: f64) -> Vec<(usize, f64)> {
    let size = |row: usize| {
        let before = if row > 1 { output[row - 1] - output[row - 2] } else { 0.0 };
        let before = if before.is_finite() { before } else { 0.0 };
        (row, output[row] - output[row - 1] - before)
    };
    let jumps: Vec<(usize, f64)> = jumps(output, least).into_iter().map(size).collect();
    for (row, size) in &jumps {
        output[*row..].iter_mut().for_each(|value| *value -= size);
    }
    jumps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::noise;

    fn input() -> Vec<f64> {
        (0..4000).map(|k| [0.0, 1.0, -1.0][k / 150 % 3]).collect()
    }

    /// What moves by 0.05 a row and has some noise.
    fn output(jump: impl Fn(usize) -> f64) -> Vec<f64> {
        let (mut angle, noise) = (3.0, noise(5, 0.0, 4000));
        let row = |(k, level): (usize, f64)| {
            angle += 0.05 * level;
            angle + 0.02 * noise[k] + jump(k)
        };
        input().into_iter().enumerate().map(row).collect()
    }

    #[test]
    fn an_output_is_put_back_by_its_jump() {
        let clean = output(|_| 0.0);
        let often = |k: usize| 40.0 * f64::from(u8::try_from(k / 700).unwrap());
        let mut homed = output(often);
        let least = least_jump(&[[&input(), &homed]]).unwrap();
        assert_eq!(taken_out(&mut homed, least).len(), 5);
        for jump in [30.0, -1000.0] {
            let mut marred = output(|k| if k < 2000 { 0.0 } else { jump });
            let least = least_jump(&[[&input(), &marred]]).unwrap();
            let jumps = taken_out(&mut marred, least);
            assert_eq!(jumps.len(), 1);
            assert_eq!(jumps[0].0, 2000);
            assert!(marred.iter().zip(&clean).all(|(a, b)| (a - b).abs() < 0.3), "{jumps:?}");
        }
    }

    #[test]
    fn motion_and_spikes_are_no_jumps() {
        let of = |output: &[f64]| least_jump(&[[&input(), output]]);
        assert_eq!(of(&output(|_| 0.0)), None);
        assert_eq!(of(&output(|k| if k == 2000 { 30.0 } else { 0.0 })), None, "a spike");
        assert_eq!(of(&output(|k| if k < 2000 { 0.0 } else { 0.5 })), None, "as far as it moves");
        let often = output(|k| f64::from(u8::from(k % 400 < 200)) * 30.0);
        assert_eq!(of(&often), None);
        // What answers each step, of a log that is slow beside the joint.
        let (slow, noise) = (|k: usize| [0.0, 3.0, -2.0][k / 150 % 3], noise(7, 0.0, 1100));
        let input: Vec<f64> = (0..1100).map(slow).collect();
        let follows: Vec<f64> =
            (0..1100).map(|k: usize| slow(k.saturating_sub(2)) + 0.01 * noise[k]).collect();
        assert_eq!(least_jump(&[[&input, &follows]]), None);
        // One step, and the answer to it.
        let step: Vec<f64> = (0..4000).map(|k| f64::from(u8::from(k > 2000))).collect();
        let answer: Vec<f64> = output(|k| if k < 2003 { 0.0 } else { 30.0 });
        assert_eq!(least_jump(&[[&step, &answer]]), None);
    }
}
