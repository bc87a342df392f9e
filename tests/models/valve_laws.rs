//! A valve whose spool slews before its overlap, limit and direction: each law shows only beside the
//! others, and a curve of any form is the first that comes near the noise.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use tauscope::batch::Threads;
use tauscope::experiment::{Joint, Trial};
use tauscope::explain::{Options, improve};
use tauscope::fit::{FitRecord, Horizon, Split, fit};
use tauscope::model::JointModel;
use tauscope::units::SamplePeriod;

use crate::sample::size;

/// 160 s at 100 Hz in steps of 1 ms: a delay of 0.06 s, a spool that slews at 6 V/s, an overlap from −0.2
/// to 0.35 V, a limit 1.6 V after it, and a gain of 8 deg/s/V that is 1.4 times as large downward.
fn valve(seed: u64) -> Joint {
    const SAMPLES: usize = 16_000;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut input = vec![0.0; 60];
    while input.len() < SAMPLES {
        let level: f64 = random.random_range(-2.2..2.2);
        let samples = random.random_range(80..250);
        input.extend(std::iter::repeat_n(level, samples));
    }
    input.truncate(SAMPLES);
    let (mut angle, mut spool, mut output) = (0.0, 0.0_f64, Vec::new());
    for k in 0..SAMPLES {
        let noise: f64 = StandardNormal.sample(&mut random);
        output.push(angle + 0.03 * noise);
        for part in 0..10 {
            let command = (10 * k + part).checked_sub(60).map_or(0.0, |at| input[at / 10]);
            spool += (command - spool).clamp(-0.006, 0.006);
            let open = ((spool - 0.35).max(0.0) + (spool + 0.2).min(0.0)).clamp(-1.6, 1.6);
            angle += 0.001 * 8.0 * if open > 0.0 { open } else { 1.4 * open };
        }
    }
    let period = SamplePeriod::from_seconds(0.01).unwrap();
    Joint::new("valve", vec![Trial::new("1", 0.0, period, input, output).unwrap()])
}

#[test]
fn laws_are_named_where_they_do_as_well_as_a_curve_of_any_form() {
    for seed in 1..=size(1, 6) {
        let joint = valve(seed);
        let record = FitRecord::new(&joint, Split::of(&joint), Horizon::Auto);
        let start = JointModel::integrator(8.0, 0.06);
        let base = fit(&record, &start, &record.range_for(&start)).unwrap();
        let improved = improve(&record, base, &Options::default(), &Threads, |_| true);
        let last = improved.revisions.last().unwrap();
        let model = &last.comparison.fit.model;
        let mut effects: Vec<_> = model.components().iter().map(|c| c.effect().spec().id).collect();
        effects.sort_unstable();
        // A limit by direction follows one for both.
        let limits = ["asymmetric_saturation", "input_saturation"];
        let laws = |limit| {
            let mut laws = ["dead_band", "direction_gain", "spool_rate_limit", limit];
            laws.sort_unstable();
            laws
        };
        assert!(limits.iter().any(|limit| effects == laws(limit)), "{seed}: {effects:?}");
        assert!(last.comparison.judged().unwrap().rmse < 1.1 * 0.03);
    }
}
