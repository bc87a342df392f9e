//! Quantized command: what reaches the valve is a multiple of a step.
//!
//! ```text
//! out = step · round(in / step)
//! ```
//!
//! A converter of few bits, or a duty cycle in whole percent, between the logged command and the
//! coil. Commands that differ by less than a step may do the same, and the speed is off by half a
//! step of the input at most.
//!
//! # References
//! Widrow, B., and Kollár, I., 2008, Quantization Noise.

use super::{Dimension, Effect, Equations, Moment, Parameter, RecordRange, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct InputQuantization;

static SPEC: Spec = Spec::new(
    "input_quantization",
    Stage::Spool,
    "quantized command: the valve gets multiples of a step",
)
.equation("out = step round(in / step)")
.source("Widrow and Kollár, 2008, Quantization Noise")
.parameters(&[
    Parameter::new("step", "distance of two commands", Dimension::Input).between(0.0, UNLIMITED)
])
.confused_with(&["dead_band", "flow_curve"])
.upstream_of(&["valve_hysteresis", "spool_lag", "spool_rate_limit"])
.steady()
.equations(Equations::new(&["count = floor(abs(signal) / step + 0.5)
             out = if(step > 0 && is_finite(count), sign(signal) * step * count, signal)"]));

/// Multiples of the step within the largest input, at most. Chosen: a finer one moves no command by more
/// than a fortieth of the largest.
const FINEST: f64 = 20.0;

/// Levels whose jumps are distinguished: where more are met, the error hardly jumps at any one.
const TOLD_APART: usize = 100;

/// Neighbouring levels with the same multiple that show a step: one pair may be a flat piece of a
/// curve.
const SHARED: usize = 2;

impl Effect for InputQuantization {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[step] = parameters else { return at.signal };
        let count = (at.signal.abs() / step + 0.5).floor();
        if step > 0.0 && count.is_finite() { (step * count).copysign(at.signal) } else { at.signal }
    }

    /// Whether levels that differ do the same: multiples that are as many as the levels are a curve
    /// through these.
    fn shows_its_form(&self, parameters: &[f64], record: &RecordRange<'_>) -> bool {
        let multiple = |level: &f64| self.step(parameters, &mut [], &Moment::of(*level));
        let multiples: Vec<f64> = record.input_levels.iter().map(multiple).collect();
        let same = multiples.windows(2).filter(|pair| pair[0].total_cmp(&pair[1]).is_eq());
        same.count() >= SHARED
    }

    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        vec![(0.0, record.size(Dimension::Input).min(UNLIMITED))]
    }

    /// A hundredth apart, from the step whose one multiple the largest input is rounded to. Of twenty levels
    /// some is rounded to another multiple wherever the step changes by a few hundredths, so that a start farther
    /// from the right step rounds some of them wrongly.
    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        const APART: f64 = 0.99;
        let largest = record.size(Dimension::Input);
        let steps = std::iter::successors(Some(largest / 1.5), |step| Some(APART * step));
        steps.take_while(|step| *step >= largest / FINEST).map(|step| vec![step]).collect()
    }

    /// At `level / (n + 1/2)` a level comes to another multiple.
    fn jumps(&self, _parameter: usize, record: &RecordRange<'_>) -> Vec<f64> {
        let least = record.size(Dimension::Input) / FINEST;
        let of_level = |level: &f64| {
            let level = *level;
            let counts = (0..).map(|count| f64::from(count) + 0.5);
            counts.map(move |count| level / count).take_while(move |step| *step > least)
        };
        let some = record.input_levels.len().div_ceil(TOLD_APART).max(1);
        let levels = record.input_levels.iter().step_by(some);
        let mut jumps: Vec<f64> = levels.flat_map(of_level).collect();
        jumps.sort_by(f64::total_cmp);
        jumps.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, run};
    use super::*;

    #[test]
    fn a_command_goes_to_the_nearest_multiple() {
        let inputs = [0.0, 0.2, 0.3, -0.7, -0.8, 2.1];
        let outputs = [0.0, 0.0, 0.5, -0.5, -1.0, 2.0];
        assert_close(&run(&InputQuantization, &[0.5], &inputs), &outputs);
    }

    #[test]
    fn between_two_jumps_all_levels_keep_their_multiples() {
        let levels = [0.7, 1.0];
        let record =
            RecordRange { input_levels: &levels, input_abs_max: 1.0, ..RecordRange::default() };
        let between = InputQuantization.jumps(0, &record);
        let multiples = |step: &f64| levels.map(|level| (level / step + 0.5).floor().to_bits());
        let met: Vec<_> = between.iter().map(multiples).collect();
        assert!(met.windows(2).all(|pair| pair[0] != pair[1]), "{met:?}");
        let least = between.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(least > 0.05 && between.contains(&f64::midpoint(2.0, 1.4)));
    }

    #[test]
    fn it_shows_where_levels_that_differ_do_the_same() {
        let levels = [0.0, 0.2, 0.3, 0.6, 0.9, 1.1];
        let record = RecordRange { input_levels: &levels, ..RecordRange::default() };
        assert!(InputQuantization.shows_its_form(&[0.5], &record));
        assert!(!InputQuantization.shows_its_form(&[0.3], &record), "a multiple for each level");
    }
}
