//! Servos whose rate is limited: the output goes where the input says, stays there, and its
//! arrival is no reaction to a step.

use crate::sample::size;
use tauscope::Trial;
use tauscope::delay::{Decision, Method, Settings, Verdict, estimate};
use tauscope::units::SamplePeriod;

/// A reproducible sequence of numbers from 0 to 1.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A whole number below `end`.
    fn below(&mut self, end: usize) -> usize {
        floor(self.next() * end as f64)
    }

    /// About normal, with a standard deviation of 1.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() - 6.0
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small, not below 0")]
fn floor(value: f64) -> usize {
    value as usize
}

/// A servo that is commanded to random levels, sampled at 50 Hz.
struct Servo {
    delay_s: f64,
    /// Output units per second, at most.
    rate: f64,
    hold_s: [f64; 2],
    noise: f64,
}

impl Servo {
    /// A log, from an integration in steps of 1 ms: the speed follows what is left of the way, is
    /// limited, and has a lag of 20 ms.
    fn log(&self, seed: u64, steps: usize) -> Trial {
        const FINE_S: f64 = 0.001;
        const EVERY: usize = 20;
        const LEVELS: [f64; 5] = [-4.0, -2.0, 0.0, 2.0, 4.0];
        let mut chance = Chance(seed);
        let (mut input, mut level) = (Vec::new(), 2);
        for _ in 0..=steps {
            let [short, long] = self.hold_s;
            let samples = floor((short + (long - short) * chance.next()) / FINE_S) / EVERY;
            input.extend(std::iter::repeat_n(LEVELS[level], samples * EVERY));
            level = (level + 1 + chance.below(4)) % LEVELS.len();
        }
        let late = floor(self.delay_s / FINE_S);
        let (mut angle, mut speed) = (0.0, 0.0);
        let output: Vec<f64> = (0..input.len())
            .map(|k| {
                let before = angle;
                let wanted: f64 = 1.5 * input[k.saturating_sub(late)] - angle;
                speed += ((20.0 * wanted).clamp(-self.rate, self.rate) - speed) * FINE_S / 0.02;
                angle += speed * FINE_S;
                before
            })
            .collect();
        let seen = |values: &[f64]| values.iter().step_by(EVERY).copied().collect::<Vec<f64>>();
        let noisy = seen(&output).iter().map(|y| y + self.noise * chance.normal()).collect();
        let period = SamplePeriod::from_seconds(FINE_S * EVERY as f64).unwrap();
        Trial::new("1", 0.0, period, seen(&input), noisy).unwrap()
    }
}

#[test]
fn delays_of_servos_are_those_of_their_departures() {
    let servos = [
        Servo { delay_s: 0.12, rate: 3.0, hold_s: [3.0, 6.0], noise: 0.02 },
        Servo { delay_s: 0.12, rate: 3.0, hold_s: [1.0, 2.5], noise: 0.02 },
        Servo { delay_s: 0.2, rate: 8.0, hold_s: [1.0, 2.0], noise: 0.05 },
    ];
    for (index, servo) in servos.iter().enumerate() {
        for (method, near_s) in [(Method::TWO_LINE, 0.06), (Method::HINGE, 0.04)] {
            let trial = servo.log(77 + index as u64, size(50, 120));
            let found = estimate(&trial, &Settings::of(method)).unwrap();
            let tracking = found.tracking.unwrap();
            assert!(tracking.offset().abs() < 0.05, "servo {index}: {tracking:?}");
            assert!((tracking.gain() - 1.5).abs() < 0.05, "servo {index}: {tracking:?}");
            let accepted = found.decisions.iter().filter(|d| d.verdict() == Verdict::Accepted);
            let delays = accepted.filter_map(Decision::delay);
            let mut errors: Vec<f64> =
                delays.map(|delay| (delay * 0.02 - servo.delay_s).abs()).collect();
            errors.sort_by(f64::total_cmp);
            let far = errors.iter().filter(|error| **error > 0.15).count();
            let (accepted, median) = (errors.len(), errors[errors.len() / 2]);
            println!(
                "servo {index}, {}: {accepted} of {} accepted, median error {median:.3} s, {far} \
                 off by more than 0.15 s",
                method.id(),
                found.decisions.len()
            );
            // A step in the direction in which it moves already shows nothing.
            assert!(accepted as f64 > 0.8 * found.decisions.len() as f64);
            assert!(median <= near_s, "servo {index}: {median}");
            // In a small sample one more than a twenty-fifth may be.
            let allowed = accepted / 25 + size(1, 0);
            assert!(far <= allowed, "servo {index}: {far}");
        }
    }
}
