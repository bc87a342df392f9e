//! Where a model fails: planted failures are found, and nothing is found where there is none.

use crate::sample::size;
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use tauscope::diagnosis::failure::{
    Clause, FailsWhere, Feature, Relation, ResidualRecord, Samples, Units, diagnose, fails_where,
    regions, worst_segments,
};

const PERIOD_S: f64 = 0.01;

/// Random numbers: even between 0 and 1, and normal.
struct Random(ChaCha8Rng);

impl Random {
    fn even(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / f64::from(u32::MAX)
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.even().max(1e-12).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.even()).cos()
    }
}

/// A joint that is driven by steps between levels, in several trials, without residual.
struct Made {
    samples: Samples,
    segments: Vec<std::ops::Range<usize>>,
    trials: usize,
    random: Random,
}

impl Made {
    fn new(seed: u64, count: usize, trials: usize, hold_s: [f64; 2]) -> Self {
        let mut random = Random(ChaCha8Rng::seed_from_u64(seed));
        let mut samples = Samples { residual: vec![0.0; count], ..Samples::default() };
        let mut segments = Vec::new();
        let mut output = 0.0;
        while samples.input.len() < count {
            let start = samples.input.len();
            let level = (random.even() * 9.0).floor() - 4.0;
            let hold_s = hold_s[0] + (hold_s[1] - hold_s[0]) * random.even();
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "few")]
            let end = (start + (hold_s / PERIOD_S).round() as usize).min(count);
            // The sign turns the joint back to the middle, as an experimenter would.
            let input = if output * level > 200.0 { -level } else { level };
            for sample in start..end {
                output += 10.0 * input * PERIOD_S;
                samples.input.push(input);
                samples.output.push(output);
                samples.speed.push(10.0 * input + 0.5 * random.normal());
                samples.trial.push(u32::try_from(sample * trials / count).unwrap());
            }
            samples.time_s.extend((start..end).map(|sample| sample as f64 * PERIOD_S));
            let since = (0..end - start).map(|sample| sample as f64 * PERIOD_S);
            samples.since_step_s.extend(since);
            samples.hold_s.extend(std::iter::repeat_n(hold_s, end - start));
            segments.push(start..end);
        }
        Self { samples, segments, trials, random }
    }

    fn usual(seed: u64) -> Self {
        Self::new(seed, 12_000, 4, [0.6, 2.4])
    }

    /// With noise of correlation `rho` whose deviation at a sample is `deviation`.
    fn with_noise(
        mut self,
        rho: f64,
        deviation: impl Fn(&Samples, usize) -> f64,
    ) -> ResidualRecord {
        let mut value = self.random.normal();
        for index in 0..self.samples.residual.len() {
            value = rho * value + (1.0 - rho * rho).sqrt() * self.random.normal();
            self.samples.residual[index] = deviation(&self.samples, index) * value;
        }
        let labels = (0..self.trials).map(|trial| format!("run_{trial}")).collect();
        ResidualRecord::new(self.samples, labels, self.segments).unwrap()
    }
}

/// A deviation of 1 where `inside`, and of 0.2 elsewhere.
fn failing(
    seed: u64,
    inside: impl Fn(&Samples, usize) -> bool + Copy,
) -> (ResidualRecord, impl Fn(&ResidualRecord) -> Vec<u32>) {
    let deviation = move |s: &Samples, k| if inside(s, k) { 1.0 } else { 0.2 };
    let truth = move |record: &ResidualRecord| {
        let rows = 0..u32::try_from(record.len()).unwrap();
        rows.filter(|index| inside(record.samples(), *index as usize)).collect()
    };
    (Made::usual(seed).with_noise(0.8, deviation), truth)
}

/// Common samples as a share of those of either.
fn overlap(a: &[u32], b: &[u32]) -> f64 {
    let common = a.iter().filter(|index| b.binary_search(index).is_ok()).count();
    common as f64 / (a.len() + b.len() - common) as f64
}

/// The first condition, after checking that it is the planted failure and the only one.
fn found(seed: u64, inside: impl Fn(&Samples, usize) -> bool + Copy) -> FailsWhere {
    let (record, truth) = failing(seed, inside);
    let mut found = fails_where(&record);
    let all: Vec<_> = found.iter().map(|one| one.condition.clone()).collect();
    assert_eq!(found.len(), 1, "{all:?}");
    let first = found.remove(0);
    let overlap = overlap(&first.samples, &truth(&record));
    assert!(overlap > 0.85, "{all:?} overlaps {overlap}");
    assert!(first.share_of_squared_error > 0.6 && first.p_value <= 0.01);
    first
}

fn number(clause: &Clause) -> f64 {
    clause.to_string().rsplit(' ').next().unwrap().parse().unwrap()
}

#[test]
fn an_error_inside_a_dead_band_is_found() {
    let first = found(1, |s, k| s.input[k].abs() < 1.4);
    assert_eq!(first.condition, "|input| < 1.5");
    let units = Units { input: Some("V".into()), output: Some("deg".into()) };
    let sentence = first.sentence(&units);
    assert!(sentence.starts_with("when |input| < 1.5 V: "), "{sentence}");
}

#[test]
fn an_error_in_one_direction_is_found() {
    assert_eq!(found(2, |s, k| s.input[k] < 0.0).condition, "input < 0");
}

#[test]
fn an_error_above_an_angle_is_found() {
    let first = found(3, |s, k| s.output[k] > 20.0);
    assert_eq!(first.clauses.len(), 1, "{}", first.condition);
    assert_eq!(first.clauses[0].feature, Feature::Output);
    assert!((number(&first.clauses[0]) - 20.0).abs() < 3.0, "{}", first.condition);
}

#[test]
fn an_error_just_after_a_step_is_found() {
    let first = found(4, |s, k| s.since_step_s[k] < 0.3);
    assert_eq!(first.clauses.len(), 1, "{}", first.condition);
    assert_eq!(first.clauses[0].feature, Feature::SinceStep);
    assert_eq!(first.clauses[0].relation, Relation::Below);
    assert!((number(&first.clauses[0]) - 0.3).abs() < 0.05, "{}", first.condition);
}

#[test]
fn an_error_just_after_steps_of_one_rhythm_is_found() {
    let made = Made::new(5, 12_000, 1, [1.5, 1.5]);
    let record = made.with_noise(0.5, |s, k| if s.since_step_s[k] < 0.3 { 1.0 } else { 0.2 });
    let first = fails_where(&record).remove(0);
    assert_eq!(first.clauses[0].feature, Feature::SinceStep, "{}", first.condition);
}

#[test]
fn an_error_in_one_trial_is_found() {
    assert_eq!(found(6, |s, k| s.trial[k] == 2).condition, "trial = run_2");
}

#[test]
fn an_error_in_a_window_of_time_is_found() {
    let first = found(7, |s, k| (70.0..84.0).contains(&s.time_s[k]));
    let features: Vec<_> = first.clauses.iter().map(|clause| clause.feature).collect();
    assert_eq!(features, [Feature::Time; 2], "{}", first.condition);
    assert!((number(&first.clauses[0]) - 70.0).abs() < 3.0, "{}", first.condition);
    assert!((number(&first.clauses[1]) - 84.0).abs() < 3.0, "{}", first.condition);
}

#[test]
fn an_error_of_two_clauses_is_found() {
    let first = found(8, |s, k| s.input[k].abs() < 2.4 && s.output[k] > 12.0);
    let mut features: Vec<_> = first.clauses.iter().map(|clause| clause.feature).collect();
    features.sort();
    assert_eq!(features, [Feature::AbsInput, Feature::Output], "{}", first.condition);
}

#[test]
fn two_failures_are_told_apart() {
    let inside = |s: &Samples, k: usize| s.trial[k] == 1 || s.since_step_s[k] < 0.15;
    let (record, _) = failing(9, inside);
    let found = fails_where(&record);
    let features: Vec<_> = found.iter().map(|one| one.clauses[0].feature).collect();
    assert_eq!(features, [Feature::Trial, Feature::SinceStep]);
}

#[test]
fn planted_failures_are_found_whatever_the_noise() {
    let planted = |s: &Samples, k: usize| s.input[k].abs() < 1.4;
    let right = (100..size(112, 140)).filter(|seed| {
        let found = fails_where(&failing(*seed, planted).0);
        found.first().is_some_and(|first| first.condition == "|input| < 1.5")
    });
    assert!(right.count() >= size(11, 38));
}

/// Panics where more than 5 % of the records of a model that fails nowhere have a report; more than 8 %
/// of those of the small sample.
fn assert_seldom_reported(name: &str, make: impl Fn(u64) -> ResidualRecord) {
    let records = size(50, 200);
    let reports = (0..records).filter(|seed| !fails_where(&make(*seed)).is_empty()).count();
    assert!(reports <= size(4, 10), "{name}: {reports} of {records}");
}

#[test]
fn noise_of_even_size_gives_no_report() {
    for (name, rho, count) in
        [("white", 0.0, 4000), ("AR(1) 0.95", 0.95, 4000), ("AR(1) 0.95, short", 0.95, 1500)]
    {
        let make = |seed| Made::new(seed, count, 4, [0.6, 2.4]).with_noise(rho, |_, _| 1.0);
        assert_seldom_reported(name, make);
    }
}

#[test]
fn holds_shorter_than_the_correlation_give_no_report() {
    let make = |seed| Made::new(seed, 4000, 2, [0.05, 0.3]).with_noise(0.95, |_, _| 1.0);
    assert_seldom_reported("short holds", make);
}

#[test]
fn steps_that_fail_by_chance_give_no_report() {
    // Each segment has an error of its own size, whatever its level, hold or angle.
    let deviation = |s: &Samples, k: usize| (1.5 * (7919.0 * s.hold_s[k]).sin()).exp();
    let make = |seed| Made::new(seed, 6000, 2, [0.6, 2.4]).with_noise(0.5, deviation);
    assert_seldom_reported("segments of random size", make);
}

#[test]
fn a_perfect_model_fails_nowhere() {
    let record = Made::usual(1).with_noise(0.0, |_, _| 0.0);
    let diagnosis = diagnose(&record, record.samples().residual.iter().copied());
    assert_eq!((diagnosis.fails_where.len(), diagnosis.worst_segments.len()), (0, 0));
    assert!(regions(&record).iter().all(|region| region.rmse < 1e-300));
    let nothing = ResidualRecord::new(Samples::default(), Vec::new(), Vec::new()).unwrap();
    assert_eq!(regions(&nothing), []);
}

#[test]
fn what_is_not_known_is_in_no_region() {
    let mut made = Made::usual(10);
    made.samples.since_step_s[..500].fill(f64::NAN);
    let record = made.with_noise(0.5, |s, k| if s.since_step_s[k] < 0.3 { 1.0 } else { 0.2 });
    let since = regions(&record).into_iter().filter(|region| region.feature == Feature::SinceStep);
    let share: f64 = since.map(|region| region.share_of_time).sum();
    assert!((share - 11_500.0 / 12_000.0).abs() < 1e-12);
    assert!(fails_where(&record)[0].samples[0] >= 500);
}

#[test]
fn the_same_record_gives_the_same_answer() {
    let make = || failing(11, |s, k| s.output[k] > 20.0).0;
    let diagnosed = |of: ResidualRecord| diagnose(&of, of.samples().residual.iter().copied());
    assert_eq!(diagnosed(make()), diagnosed(make()));
}

/// A condition's shares by going through all samples.
fn brute_shares(record: &ResidualRecord, holds: impl Fn(usize) -> bool) -> (f64, f64, f64) {
    let square = |index: usize| record.samples().residual[index].powi(2);
    let inside: Vec<usize> = (0..record.len()).filter(|index| holds(*index)).collect();
    let squares: f64 = inside.iter().map(|index| square(*index)).sum();
    let all: f64 = (0..record.len()).map(square).sum();
    let count = inside.len() as f64;
    (count / record.len() as f64, squares / all, (squares / count).sqrt())
}

fn holds(record: &ResidualRecord, clause: &Clause, index: usize) -> bool {
    let s = record.samples();
    let value = match clause.feature {
        Feature::Direction | Feature::Input => s.input[index],
        Feature::AbsInput => s.input[index].abs(),
        Feature::Output => s.output[index],
        Feature::Speed => s.speed[index],
        Feature::AbsSpeed => s.speed[index].abs(),
        Feature::SinceStep => s.since_step_s[index],
        Feature::Hold => s.hold_s[index],
        Feature::Time => s.time_s[index],
        Feature::Trial => {
            return clause.to_string()
                == format!("trial = {}", record.trials()[s.trial[index] as usize]);
        }
    };
    match clause.relation {
        Relation::Below => value < number(clause),
        Relation::Above => value > number(clause),
        Relation::AtLeast => value >= number(clause),
        Relation::Equal => (value - number(clause)).abs() < 1e-12,
    }
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

#[test]
fn a_condition_says_where_an_error_arises_and_a_segment_where_it_is_seen() {
    // The speed errs where the input is large; the residual that stays is large elsewhere.
    let mut made = Made::new(5, 6000, 1, [0.5, 1.0]);
    let drives: Vec<bool> = made.samples.input.iter().map(|input| *input > 1.5).collect();
    made.samples.residual = drives.iter().map(|drives| if *drives { 0.1 } else { 3.0 }).collect();
    let noise: Vec<f64> = (0..6000).map(|_| 0.1 * made.random.normal()).collect();
    let error = drives.iter().zip(noise).map(|(drives, noise)| f64::from(*drives) + noise);
    made.samples.speed_error = error.collect();
    let segments = made.segments.clone();
    let record = ResidualRecord::new(made.samples, vec!["a".to_owned()], segments).unwrap();
    let diagnosis = diagnose(&record, record.samples().residual.iter().copied());
    let condition = diagnosis.fails_where.first().unwrap();
    assert!(condition.share_of_squared_error > 0.9, "{condition:?}");
    // The error of the output is seen elsewhere than it arises.
    assert!(!diagnosis.worst_segments.is_empty());
    for worst in &diagnosis.worst_segments {
        assert!(worst.samples.clone().any(|sample| !drives[sample]), "{worst:?}");
    }
}

/// The largest residual, whatever its sign, in `samples`.
fn residual_of(record: &ResidualRecord, samples: &std::ops::Range<usize>) -> f64 {
    let own = &record.samples().residual[samples.clone()];
    own.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()))
}

#[test]
fn a_short_spike_is_among_the_worst_segments_though_its_squares_are_few() {
    let record = Made::usual(12).with_noise(0.5, |_, _| 1.0);
    let spike = record.segments()[3].clone();
    let mut residual = vec![0.1; record.len()];
    for (number, span) in record.segments().iter().enumerate().skip(10) {
        residual[span.clone()].fill(1.0 + number as f64 * 1e-3);
    }
    residual[spike.start] = -4.0;
    let worst = worst_segments(&record, residual, 5);
    assert_eq!(worst.len(), 5);
    let last = &worst[4];
    assert_eq!((last.samples.clone(), last.largest_residual), (spike, -4.0));
    assert!(worst[..4].iter().all(|it| it.largest_residual > 0.0));
    assert!(worst.is_sorted_by(|a, b| a.share_of_squared_error >= b.share_of_squared_error));
}

#[test]
fn the_worst_segment_is_that_of_the_residual_that_is_shown() {
    let record = Made::usual(12).with_noise(0.5, |_, _| 1.0);
    let shown = record.segments()[7].clone();
    let residual = (0..record.len()).map(|sample| f64::from(u8::from(shown.contains(&sample))));
    let worst = worst_segments(&record, residual, 5);
    assert_eq!(worst.len(), 1);
    assert_eq!((worst[0].samples.clone(), worst[0].share_of_squared_error), (shown, 1.0));
    // Squares beyond double precision have no shares.
    assert!(worst_segments(&record, vec![1e200; record.len()], 5).is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn shares_are_those_of_the_printed_condition(
        seed in 0_u64..1000,
        level in 0.5..3.5_f64,
        angle in -20.0..20.0_f64,
    ) {
        let inside = move |s: &Samples, k: usize| s.input[k] > level || s.output[k] > angle;
        let deviation = move |s: &Samples, k: usize| if inside(s, k) { 1.0 } else { 0.1 };
        let record = Made::new(seed, 3000, 3, [0.3, 1.0]).with_noise(0.5, deviation);
        for found in fails_where(&record) {
            let all = |index| found.clauses.iter().all(|clause| holds(&record, clause, index));
            let (time, error, rmse) = brute_shares(&record, all);
            prop_assert!(near(found.share_of_time, time), "{}", found.condition);
            prop_assert!(near(found.share_of_squared_error, error) && near(found.rmse, rmse));
        }
    }

    #[test]
    fn regions_of_a_feature_share_everything(seed in 0_u64..1000) {
        let record = Made::new(seed, 2000, 3, [0.3, 1.0]).with_noise(0.5, |s, k| s.input[k].abs());
        let regions = regions(&record);
        for feature in Feature::all() {
            let of: Vec<_> = regions.iter().filter(|region| region.feature == feature).collect();
            let sum = |share: fn(&tauscope::diagnosis::failure::Region) -> f64| {
                of.iter().map(|region| share(region)).sum::<f64>()
            };
            if !of.is_empty() {
                prop_assert!(near(sum(|region| region.share_of_time), 1.0));
                prop_assert!(near(sum(|region| region.share_of_squared_error), 1.0));
            }
        }
        let level = regions.iter().find(|r| r.feature == Feature::Input && r.label == "2");
        let Some(level) = level else { return Ok(()) };
        let (time, error, rmse) = brute_shares(&record, |k| near(record.samples().input[k], 2.0));
        prop_assert!(near(level.share_of_time, time) && near(level.rmse, rmse));
        prop_assert!(near(level.share_of_squared_error, error));
    }

    #[test]
    fn worst_segments_have_more_than_their_share(seed in 0_u64..1000, count in 0_usize..9) {
        let made = Made::new(seed, 2000, 3, [0.3, 1.0]);
        let record = made.with_noise(0.5, |s, k| s.input[k].abs());
        let worst = worst_segments(&record, record.samples().residual.iter().copied(), count);
        prop_assert!(worst.len() <= count);
        for (index, segment) in worst.iter().enumerate() {
            let (time, error, rmse) = brute_shares(&record, |k| segment.samples.contains(&k));
            prop_assert!(near(segment.share_of_squared_error, error) && near(segment.rmse, rmse));
            let largest = residual_of(&record, &segment.samples);
            prop_assert!(near(segment.largest_residual.abs(), largest));
            let is_spike = near(largest, residual_of(&record, &(0..record.len())));
            prop_assert!((error > time || is_spike) && near(segment.start_s, segment.samples.start as f64 * 0.01));
            prop_assert!(index == 0 || error <= worst[index - 1].share_of_squared_error);
        }
    }
}
