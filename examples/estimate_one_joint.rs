//! The delay of every step of one joint, from samples in memory.
#![expect(clippy::print_stdout, reason = "an example prints")]

use anyhow::Context as _;
use tauscope::delay::{Settings, estimate};
use tauscope::experiment::Trial;
use tauscope::units::SamplePeriod;

fn main() -> anyhow::Result<()> {
    // A joint that follows each step of its input 0.12 s late, at 100 Hz.
    let input: Vec<f64> = (0..600).map(|k| f64::from(k / 100 % 3) - 1.0).collect();
    let mut angle = 0.0;
    let turned = |k: usize| {
        angle += 0.2 * input[k.saturating_sub(12)];
        angle
    };
    let output: Vec<f64> = (0..input.len()).map(turned).collect();

    let period = SamplePeriod::from_seconds(0.01).context("a period is above zero")?;
    let trial = Trial::new("swing", 0.0, period, input, output)?;
    for decision in estimate(&trial, &Settings::default())?.decisions {
        let delay = decision.accepted_delay().map(|samples| samples * period.seconds());
        println!("step {} at sample {}: {delay:?}", decision.number, decision.input_step.sample);
    }
    Ok(())
}

#[test]
fn runs() -> anyhow::Result<()> {
    main()
}
