//! How well the paper's method finds known delays with its own settings, and with those that
//! are chosen from each record.

use anyhow::Context as _;
use tauscope::delay::{Automatic, FirstLast, Method, Settings, choose, estimate};
use tauscope::experiment::Trial;
use tauscope::synthetic::{
    DelayLaw, InputSpec, JointSpec, PlantSpec, Ringing, StepTruth, Synthetic, simulate,
};

/// Records per plant where no number is given.
const RECORDS: u64 = 20;
const DURATION_S: f64 = 120.0;
const ALL: Automatic = Automatic { alpha: true, beta: true, passband: true };

/// The plants by name: a joint with delays of 5 to 40 samples, and what is different.
fn plants() -> Vec<(&'static str, JointSpec)> {
    let levels: Vec<f64> = (-4..=4).map(|half| 0.5 * f64::from(half)).collect();
    let input = |hold_s| InputSpec::Levels { levels: levels.clone(), hold_s };
    let delay = |min, max| DelayLaw::Uniform { min, max };
    let ideal =
        JointSpec { noise: 0.05, ..JointSpec::new("joint", input([0.9, 2.0]), delay(0.05, 0.4)) };
    let lag_s = Some(0.06);
    let ringing = Some(Ringing { period_s: 0.4, damping: 0.25 });
    let short = JointSpec { input: input([0.2, 0.5]), delay: delay(0.05, 0.3), ..ideal.clone() };
    let long = JointSpec { input: input([3.0, 6.0]), delay: delay(0.3, 0.8), ..ideal.clone() };
    let noisy = |joint: &JointSpec, times: f64| JointSpec { noise: 0.05 * times, ..joint.clone() };
    let coloured = JointSpec { noise_correlation: 0.8, ..ideal.clone() };
    vec![
        ("ideal", ideal.clone()),
        ("lag of 6", JointSpec { lag_s, ..ideal.clone() }),
        ("ringing", JointSpec { ringing, ..ideal.clone() }),
        ("noise x 4", noisy(&ideal, 4.0)),
        ("noise x 16", noisy(&ideal, 16.0)),
        ("coloured noise", coloured.clone()),
        ("coloured noise x 8", noisy(&coloured, 8.0)),
        ("short holds", short.clone()),
        ("short holds, noise x 8", noisy(&short, 8.0)),
        ("short holds, lag", JointSpec { lag_s, ..short }),
        ("long holds", long.clone()),
        ("long holds, noise x 16", noisy(&long, 16.0)),
    ]
}

/// The errors of accepted steps, samples, and how many steps there were.
#[derive(Debug, Default)]
struct Tally {
    errors: Vec<f64>,
    steps: usize,
}

impl Tally {
    fn add(
        &mut self,
        truth: &[StepTruth],
        trial: &Trial,
        settings: &Settings,
    ) -> anyhow::Result<()> {
        let found = estimate(trial, settings)?;
        // The last reaction may be after the record's end.
        let inner = truth.len().saturating_sub(1);
        for (truth, decision) in truth.iter().zip(&found.decisions).take(inner) {
            self.steps += 1;
            let delay = decision.accepted_delay();
            self.errors.extend(delay.map(|delay| delay - truth.delay_samples));
        }
        Ok(())
    }

    /// The mean error with its standard error, and the root mean square.
    fn figures(&self) -> [f64; 3] {
        let count = self.errors.len() as f64;
        let mean = self.errors.iter().map(|error| error.abs()).sum::<f64>() / count;
        let square = self.errors.iter().map(|error| error * error).sum::<f64>() / count;
        [mean, ((square - mean * mean) / count).sqrt(), square.sqrt()]
    }

    fn print(&self) {
        let [mean, error, root] = self.figures();
        let accepted = 100.0 * self.errors.len() as f64 / self.steps as f64;
        print!("{mean:9.3} ±{error:.3}{root:8.3}{accepted:7.1}");
    }
}

/// The paper's settings and those of each record, on `records` records of a plant; and those
/// of the last one.
fn measure(spec: &JointSpec, records: u64) -> anyhow::Result<([Tally; 2], Settings)> {
    let paper = Settings { first_last: FirstLast::Keep, ..Settings::of(Method::TWO_LINE) };
    let (mut tallies, mut last) = ([Tally::default(), Tally::default()], paper.clone());
    for seed in 0..records {
        let plant = PlantSpec::new(2000 + seed, DURATION_S, vec![spec.clone()]);
        let made: Synthetic = simulate(&plant)?;
        let joint = made.joints.first().context("a plant has a joint")?;
        let trial = joint.trials.first().context("a joint has a trial")?;
        let (chosen, _) = choose(&joint.trials, &paper, ALL);
        for (tally, settings) in tallies.iter_mut().zip([&paper, &chosen]) {
            tally.add(&made.truth, trial, settings)?;
        }
        last = chosen;
    }
    Ok((tallies, last))
}

/// Errors of the paper's settings, and of those chosen from each record
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Records of each plant
    #[arg(default_value_t = RECORDS)]
    records: u64,

    /// Only these plants
    #[arg(value_name = "PLANT")]
    plants: Vec<String>,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    let (records, asked) = (args.records, &args.plants);
    println!("{records} records each; errors in samples: mean ± standard error, root mean square;");
    println!("then the part of steps that is accepted, percent");
    println!("plant                   α 10, β 5, 5 Hz                  auto");
    for (name, spec) in plants() {
        if asked.is_empty() || asked.iter().any(|asked| asked == name) {
            let (tallies, last) = measure(&spec, records)?;
            print!("{name:23}");
            tallies.iter().for_each(Tally::print);
            let hz = last.low_pass.map_or(f64::INFINITY, |filter| filter.cutoff_hz);
            println!("   α {}, β {}, {hz} Hz", last.alpha, last.beta);
        }
    }
    Ok(())
}

/// Two records each: the settings of the record are better where the paper's are not good.
#[test]
fn the_settings_of_the_record_are_no_worse() -> anyhow::Result<()> {
    for (name, spec) in plants() {
        let ([paper, chosen], _) = measure(&spec, 2)?;
        let ([paper, own, _], [chosen, error, _]) = (paper.figures(), chosen.figures());
        // After a lag both are wrong by the lag.
        let slack = if spec.lag_s.is_some() { 0.03 * paper } else { 0.0 };
        assert!(chosen < paper + slack + 2.0 * own.hypot(error), "{name}: {chosen} {paper}");
        if ["ideal", "noise x 4", "short holds", "long holds"].contains(&name) {
            assert!(chosen < 0.7 * paper, "{name}: {chosen} {paper}");
        }
    }
    Ok(())
}
