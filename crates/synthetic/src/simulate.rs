//! From a plant to the logs of its joints.

use crate::clock::Clock;
use crate::driver::{Driver, Moving};
use crate::error::{Place, PlantError};
use crate::motion::Motion;
use crate::random::{Purpose, stream};
use crate::rig::Rig;
use crate::sensor;
use crate::spec::{JointSpec, PlantSpec};
use crate::truth::{StepTruth, truth_of};

/// What was recorded of one joint, from time 0 on: values that are finite, one of the input and
/// one of the output for each sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recorded {
    /// Name of the joint.
    pub name: String,
    /// Unit of the input; empty where it is not known.
    pub input_unit: String,
    /// Unit of the output; empty where it is not known.
    pub output_unit: String,
    /// Seconds between samples, above zero.
    pub period_s: f64,
    /// What drove the joint, in `input_unit`.
    pub input: Vec<f64>,
    /// What its sensor showed, in `output_unit`.
    pub output: Vec<f64>,
}

/// Simulated joints and the truth about them.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulated {
    /// The joints in the order of the plant.
    pub joints: Vec<Recorded>,
    /// The steps of the first joint in the order of time, those of the second, …
    pub truth: Vec<StepTruth>,
}

/// Drives the joints of `spec` and records them.
///
/// Equal specifications give equal numbers. Other platforms agree as far as their `exp`
/// and `ln` do, which serve the law `step_size` and the tails of the noise.
///
/// # Errors
/// Those of [`PlantSpec::check`]; [`PlantError::Range`] when no level keeps a joint in
/// its range; [`PlantError::ListedDelays`] when a drawn input has more steps than
/// delays are listed; [`PlantError::Runaway`] when the equations of a cylinder do not
/// hold together; [`PlantError::NotFinite`] when an angle grows beyond all numbers.
pub fn simulate(spec: &PlantSpec) -> Result<Simulated, PlantError> {
    spec.check()?;
    let clock = spec.clock()?;
    let joints = spec.joints.iter().enumerate();
    let mut rides: Vec<_> =
        joints.map(|(index, joint)| Ride::new(joint, index, spec.seed, clock)).collect();
    // A cylinder has a pump of its own; the other joints share one.
    let (cylinders, mut others): (Vec<_>, Vec<_>) =
        rides.iter_mut().partition(|ride| ride.joint.cylinder.is_some());
    for cylinder in cylinders {
        drive(&mut [cylinder], &clock)?;
    }
    drive(&mut others, &clock)?;
    let (mut joints, mut truth) = (Vec::new(), Vec::new());
    for (index, Ride { joint, driver, moving, input, shown }) in rides.into_iter().enumerate() {
        let drive = driver.drive();
        let speed_changes = moving.speed_changes(drive);
        truth.extend(truth_of(&joint.name, drive.steps(), speed_changes, &clock));
        let mut noise = stream(spec.seed, index, Purpose::Noise);
        let mut output = sensor::measure(joint, shown, &mut noise);
        sensor::spike(joint, &mut output, &mut stream(spec.seed, index, Purpose::Spikes));
        joints.push(recorded(joint, &clock, input, output)?);
    }
    Ok(Simulated { joints, truth })
}

/// A joint, what drives it, and for each sample so far its input and what an ideal sensor shows.
struct Ride<'a> {
    joint: &'a JointSpec,
    driver: Driver<'a>,
    moving: Box<dyn Moving + 'a>,
    input: Vec<f64>,
    shown: Vec<f64>,
}

impl<'a> Ride<'a> {
    fn new(joint: &'a JointSpec, index: usize, seed: u64, clock: Clock) -> Self {
        let moving: Box<dyn Moving + 'a> = match &joint.cylinder {
            Some(cylinder) => Box::new(Rig::new(joint, cylinder, clock)),
            None => Box::new(Motion::new(joint, clock)),
        };
        let driver = Driver::new(joint, index, seed, clock);
        Self { joint, driver, moving, input: Vec::new(), shown: Vec::new() }
    }

    /// Sets the step that is due at `sample`; the joint's demand for oil there.
    fn act(&mut self, sample: usize) -> Result<f64, PlantError> {
        self.driver.act(sample, self.moving.as_ref())?;
        self.input.push(self.driver.drive().level());
        let demand = self.moving.demand(self.driver.drive());
        self.shown.push(self.moving.shown());
        Ok(demand)
    }
}

/// Drives joints that share a pump side by side: each sees the demand of the others, on average,
/// from one sample to the next.
fn drive(rides: &mut [&mut Ride<'_>], clock: &Clock) -> Result<(), PlantError> {
    let others = (rides.len() as f64 - 1.0).max(1.0);
    let mut demands = vec![0.0; rides.len()];
    for sample in 1..=clock.samples {
        let sum: f64 = demands.iter().sum();
        for (ride, demand) in rides.iter_mut().zip(&mut demands) {
            ride.moving.run_to(sample, ride.driver.drive(), (sum - *demand) / others)?;
            *demand = ride.act(sample)?;
        }
    }
    Ok(())
}

/// The log of one joint.
fn recorded(
    spec: &JointSpec,
    clock: &Clock,
    input: Vec<f64>,
    output: Vec<f64>,
) -> Result<Recorded, PlantError> {
    let finite = |(u, y): (&f64, &f64)| u.is_finite() && y.is_finite();
    if let Some(index) = input.iter().zip(&output).position(|pair| !finite(pair)) {
        return Err(PlantError::NotFinite { place: Place::joint(&spec.name), sample: index + 1 });
    }
    let [name, input_unit, output_unit] =
        [&spec.name, &spec.input_unit, &spec.output_unit].map(String::clone);
    Ok(Recorded { name, input_unit, output_unit, period_s: clock.period_s, input, output })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DelayLaw, InputSpec, Ringing};

    const PERIOD_S: f64 = 0.01;

    /// A joint of gain 10 with `steps`, all delayed by `delay_s`.
    fn stepped(steps: &[(usize, f64)], delay_s: f64) -> JointSpec {
        let input = InputSpec::Steps { steps: steps.to_vec(), initial: 0.0 };
        JointSpec::new("a", input, DelayLaw::Constant { seconds: delay_s })
    }

    /// A joint that wanders between whole volts.
    fn wandering(name: &str) -> JointSpec {
        let input = InputSpec::Levels { levels: vec![-1.0, 0.0, 1.0], hold_s: [0.9, 2.0] };
        JointSpec::new(name, input, DelayLaw::Uniform { min: 0.01, max: 0.8 })
    }

    /// What 2 s of `joint` look like.
    fn short(joint: JointSpec) -> Simulated {
        simulate(&PlantSpec::new(1, 2.0, vec![joint])).unwrap()
    }

    /// What 60 s of `joints` look like.
    fn long(seed: u64, joints: &[JointSpec]) -> Simulated {
        simulate(&PlantSpec::new(seed, 60.0, joints.to_vec())).unwrap()
    }

    fn output(made: &Simulated) -> &[f64] {
        &made.joints[0].output
    }

    fn inputs(made: &Simulated) -> Vec<&[f64]> {
        made.joints.iter().map(|joint| &joint.input[..]).collect()
    }

    /// Time at which the lines through two pairs of samples around a kink cross.
    fn kink_s(output: &[f64], before: usize, after: usize) -> f64 {
        let line = |k: usize| {
            let slope = (output[k + 1] - output[k]) / PERIOD_S;
            (slope, output[k] - slope * k as f64 * PERIOD_S)
        };
        let ((slope_1, offset_1), (slope_2, offset_2)) = (line(before), line(after));
        (offset_1 - offset_2) / (slope_2 - slope_1)
    }

    #[test]
    fn the_kink_is_exactly_one_delay_after_the_step() {
        // The second is no whole number of samples or time steps.
        for delay_s in [0.15, 0.123_456_789] {
            let made = short(stepped(&[(40, 1.0), (89, -1.0)], delay_s));
            for p in [40, 89] {
                let expected = (p as f64 - 1.0) * PERIOD_S + delay_s;
                let found = kink_s(output(&made), p, p + 30);
                assert!((found - expected).abs() < 1e-9, "{found} s, not {expected} s");
            }
        }
    }

    #[test]
    fn dead_band_and_saturation_give_the_angle_computed_by_hand() {
        let steps = [(11, 0.1), (61, 1.2), (111, 3.0), (161, -1.0), (181, -3.0)];
        let joint = JointSpec {
            start: 5.0,
            dead_band: Some([-0.3, 0.2]),
            saturation: Some(1.5),
            ..stepped(&steps, 0.1)
        };
        let made = short(joint);
        // Acting at 0.2, 0.7, 1.2, 1.7 and 1.9 s: 0, 1.0, 1.5, -0.7 and -1.5 V after the statics.
        let cases = [(71, 5.0), (121, 10.0), (171, 17.5), (181, 16.8), (200, 14.75)];
        for (sample, angle) in cases {
            let found = output(&made)[sample - 1];
            assert!((found - angle).abs() < 1e-9, "{found} at sample {sample}");
        }
        let changes: Vec<f64> = made.truth.iter().map(|step| step.slope_change).collect();
        for (found, expected) in changes.iter().zip([0.0, 0.1, 0.05, -0.22, -0.08]) {
            assert!((found - expected).abs() < 1e-12, "{changes:?}");
        }
    }

    #[test]
    fn an_overtaken_step_leaves_no_trace_in_the_output() {
        let law = DelayLaw::Listed { seconds: vec![0.1, 0.8, 0.1] };
        let steps = [(11, 1.0), (51, 2.0), (101, -1.0)];
        let with = short(JointSpec { delay: law, ..stepped(&steps, 0.0) });
        let without = short(stepped(&[(11, 1.0), (101, -1.0)], 0.1));
        assert_eq!(output(&with), output(&without));
        let overtaken: Vec<bool> = with.truth.iter().map(|step| step.overtaken).collect();
        assert_eq!(overtaken, [false, true, false]);
        let changes: Vec<f64> = with.truth.iter().map(|step| step.slope_change).collect();
        for (found, expected) in changes.iter().zip([0.1, 0.0, -0.2]) {
            assert!((found - expected).abs() < 1e-12, "{changes:?}");
        }
    }

    #[test]
    fn the_truth_covers_each_step() {
        let made = short(stepped(&[(40, 1.0), (89, -1.0)], 0.15));
        let second = &made.truth[1];
        assert_eq!((second.i, second.p, second.hold_samples), (2, 89, 112));
        assert_eq!((second.joint.as_str(), second.trial.as_str()), ("a", "1"));
        assert_eq!(made.truth[0].hold_samples, 49);
        assert!((second.delay_samples - 15.0).abs() < 1e-9);
        assert!((second.slope_change + 0.2).abs() < 1e-12);
    }

    #[test]
    fn the_same_seed_gives_the_same_data_and_another_one_does_not() {
        let joints = [JointSpec { noise: 0.05, ..wandering("a") }];
        assert_eq!(long(1, &joints), long(1, &joints));
        assert_ne!(long(1, &joints), long(2, &joints));
    }

    #[test]
    fn noise_and_further_joints_change_neither_input_nor_delays() {
        let quiet = long(1, &[wandering("a")]);
        let noisy = long(1, &[JointSpec { noise: 0.1, ..wandering("a") }, wandering("b")]);
        assert_eq!(inputs(&quiet)[0], inputs(&noisy)[0]);
        assert_ne!(inputs(&noisy)[0], inputs(&noisy)[1], "joints are driven apart");
        assert_eq!(quiet.truth, noisy.truth[..quiet.truth.len()]);
    }

    #[test]
    fn another_law_of_delay_leaves_the_input_as_it_was() {
        let law = DelayLaw::Constant { seconds: 0.1 };
        let other = long(1, &[JointSpec { delay: law, ..wandering("a") }]);
        assert_eq!(inputs(&other), inputs(&long(1, &[wandering("a")])));
    }

    #[test]
    fn the_range_is_kept_in_the_log() {
        let joint = JointSpec { range: Some([-30.0, 40.0]), ..wandering("a") };
        for seed in 0..10 {
            let made = long(seed, std::slice::from_ref(&joint));
            // 1e-9: what the sum of the time steps may round.
            let inside = |y: &f64| (-30.0 - 1e-9..=40.0 + 1e-9).contains(y);
            assert!(output(&made).iter().all(inside), "seed {seed}");
        }
    }

    #[test]
    fn an_angle_beyond_all_numbers_is_an_error() {
        let joint = JointSpec { gain: f64::MAX, ..stepped(&[(2, 100.0)], 0.0) };
        let found = simulate(&PlantSpec::new(1, 2.0, vec![joint]));
        assert!(matches!(found, Err(PlantError::NotFinite { .. })));
    }

    #[test]
    fn odd_numbers_give_data_or_an_error_but_no_panic() {
        const ODD: [f64; 9] =
            [0.0, -1.0, 1e300, -1e300, 5e-324, 1e-9, f64::NAN, f64::INFINITY, f64::MAX];
        let changes: [fn(&mut PlantSpec, f64); 12] = [
            |spec, odd| spec.sample_period_s = odd,
            |spec, odd| spec.duration_s = odd,
            |spec, odd| (spec.sample_period_s, spec.duration_s) = (odd / 10.0, odd),
            |spec, odd| spec.joints[0].gain = odd,
            |spec, odd| spec.joints[0].start = odd,
            |spec, odd| spec.joints[0].range = Some([-odd, odd]),
            |spec, odd| spec.joints[0].dead_band = Some([-odd, odd]),
            |spec, odd| spec.joints[0].saturation = Some(odd),
            |spec, odd| spec.joints[0].lag_s = Some(odd),
            |spec, odd| {
                let (period_s, damping) = (odd, 0.1);
                spec.joints[0].ringing = Some(Ringing { period_s, damping });
            },
            |spec, odd| spec.joints[0].delay = DelayLaw::Constant { seconds: odd },
            |spec, odd| {
                let (levels, hold_s) = (vec![odd, -odd, 1.0], [odd, odd]);
                spec.joints[0].input = InputSpec::Levels { levels, hold_s };
            },
        ];
        for (change, odd) in changes.iter().flat_map(|change| ODD.map(|odd| (change, odd))) {
            let mut spec = PlantSpec::new(1, 2.0, vec![wandering("a")]);
            change(&mut spec, odd);
            let finite = |made: Simulated| output(&made).iter().all(|y| y.is_finite());
            assert!(simulate(&spec).map_or(true, finite));
        }
    }

    #[test]
    fn first_numbers_of_a_seed_stay_the_same() {
        let made = long(1, &[JointSpec { noise: 0.1, ..wandering("a") }]);
        let step = &made.truth[0];
        let found = (step.p, format!("{:.9} {:.9}", step.delay_s, output(&made)[0]));
        assert_eq!(found, (133, "0.091791180 -0.010836652".to_owned()));
    }
}
