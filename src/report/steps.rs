//! Every step in a row, for the terminal.

use crate::delay::{Decision, InputStep, Verdict};
use crate::experiment::{Joint, Trial};
use crate::wording::{number, samples_text, unit_suffix};

/// Where a step is: `boom, trial 2, step 3 at 12.4 s`, the trial where there are several.
pub(super) fn step_place(joint: &Joint, trial: &Trial, decision: &Decision) -> String {
    let several = joint.trials.len() > 1;
    let label = if several { format!(", trial {}", trial.label()) } else { String::new() };
    let time = number(trial.time_s(decision.input_step.sample));
    format!("{}{label}, step {} at {time} s", joint.name, decision.number)
}

/// One step in a line, as it is reported when it has come, with its trial where there are several.
pub(crate) fn step_line(joint: &Joint, trial: &Trial, decision: &Decision) -> String {
    let InputStep { before, after, .. } = decision.input_step;
    let unit = unit_suffix(joint.input_unit.as_deref());
    let (before, after) = (number(before), number(after));
    let step = format!("{}, {before} to {after}{unit}", step_place(joint, trial, decision));
    let Verdict::Rejected(condition) = decision.verdict() else {
        let samples = decision.delay().unwrap_or(0.0);
        let seconds = samples * trial.period().seconds();
        return format!("{step}: delay {seconds:.3} s ({})", samples_text(samples));
    };
    format!("{step}: rejected, {}", condition.id())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::{FirstLast, Method, Settings, estimate};
    use crate::units::SamplePeriod;

    #[test]
    fn a_step_is_one_line() {
        let level = |k: i32| f64::from(i32::from((100..200).contains(&k)));
        let input: Vec<f64> = (0..300).map(level).collect();
        let moved = |k: i32| 0.2 * f64::from((k - 112).clamp(0, 100));
        let output = (0..300).map(moved).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, input, output).unwrap();
        let first_last = FirstLast::Reject;
        let settings =
            Settings { low_pass: None, beta: 2, first_last, ..Settings::of(Method::TWO_LINE) };
        let kept = Settings { first_last: FirstLast::Keep, ..settings.clone() };
        let joint = |trials| Joint {
            name: "swing".to_owned(),
            input_unit: Some("V".to_owned()),
            output_unit: None,
            covariates: Vec::new(),
            trials,
        };
        let line = |settings, trials| {
            let found = estimate(&trial, settings).unwrap();
            step_line(&joint(trials), &trial, &found.decisions[0])
        };
        let accepted = "swing, step 1 at 1 s, 0 to 1 V: delay 0.120 s (12 samples)";
        assert_eq!(line(&kept, [trial.clone()].into()), accepted);
        let rejected = "swing, trial 1, step 1 at 1 s, 0 to 1 V: rejected, first_or_last";
        assert_eq!(line(&settings, [trial.clone(), trial.clone()].into()), rejected);
    }
}
