//! Where the input changes.

/// A change of the input: sample `p_i` and the levels on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputStep {
    /// First sample with the new level, counted from 1.
    pub sample: usize,
    /// Level before.
    pub before: f64,
    /// Level after.
    pub after: f64,
}

/// All steps of `input`: `p_i` where `u_k ≠ u_(k−1)`.
///
/// With `min_step` above zero (input units) a change counts once the input is more than
/// that away from the level of the last step; it is for inputs that were measured.
pub fn input_steps(input: &[f64], min_step: f64) -> Vec<InputStep> {
    let mut samples = input.iter().zip(1..);
    let Some((&first, _)) = samples.next() else {
        return Vec::new();
    };
    let mut level = first;
    let mut steps = Vec::new();
    for (&value, sample) in samples {
        if (value - level).abs() > min_step {
            steps.push(InputStep { sample, before: level, after: value });
            level = value;
        }
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_the_first_sample_of_a_new_level() {
        let steps = input_steps(&[0.0, 0.0, 1.0, 1.0, -1.0], 0.0);
        let expected = [(3, 0.0, 1.0), (5, 1.0, -1.0)].map(|(sample, before, after)| InputStep {
            sample,
            before,
            after,
        });
        assert_eq!(steps, expected);
    }

    #[test]
    fn a_constant_input_has_no_step() {
        assert_eq!(input_steps(&[0.5; 9], 0.0), []);
        assert_eq!(input_steps(&[], 0.0), []);
    }

    #[test]
    fn noise_below_the_smallest_step_is_none() {
        let steps = input_steps(&[0.0, 0.01, -0.01, 1.0, 1.01, 0.99], 0.1);
        assert_eq!(steps.len(), 1);
        assert_eq!(steps[0].sample, 4);
    }
}
