//! Whether an input excites a joint at more than one frequency.

use std::f64::consts::TAU;

use crate::units::ceil_to_index;

/// Part of the input's power beyond one sine below which it is one: noise of 1 % of its amplitude, or a
/// third harmonic of as much.
const ONE_SINE: f64 = 1e-3;

/// The frequency in cycles per sample of inputs that are one sine, the same in all: it has but an
/// amplitude and a phase, which a lag explains as well as a dead time does.
///
/// A sine obeys `u(k) + u(k − 2q) = c·u(k − q) + d`, `c = 2 cos ωq`. With `q` a sixth of its period,
/// by which its harmonics are far off that, what `c` and `d` by least squares leave is what else there is in
/// the input.
///
/// # References
/// L. Ljung, "System Identification" (1999), section 13.2: a sine is persistently exciting of order 2.
pub(super) fn one_frequency(inputs: &[&[f64]]) -> Option<f64> {
    /// A sixth over a quarter of a period.
    const OF_QUARTER: f64 = 2.0 / 3.0;
    let samples: usize = inputs.iter().map(|input| input.len()).sum();
    let mean = inputs.iter().copied().flatten().sum::<f64>() / samples as f64;
    let centred: Vec<Vec<f64>> =
        inputs.iter().map(|input| input.iter().map(|value| value - mean).collect()).collect();
    let longest = centred.iter().map(Vec::len).max()? / 4;
    let quarter = (1..longest).find(|lag| product(&centred, *lag) <= 0.0)?;
    let lag = ceil_to_index((OF_QUARTER * quarter as f64).round().max(1.0));
    let rows = centred.iter().flat_map(|input| input.windows(2 * lag + 1));
    let rows: Vec<[f64; 2]> = rows.map(|row| [row[lag], row[0] + row[2 * lag]]).collect();
    let [mean_middle, mean_ends] =
        [0, 1].map(|of| rows.iter().map(|row| row[of]).sum::<f64>() / rows.len() as f64);
    let centred = || rows.iter().map(|[middle, ends]| (middle - mean_middle, ends - mean_ends));
    let middle: f64 = centred().map(|(middle, _)| middle * middle).sum();
    let c = centred().map(|(middle, ends)| ends * middle).sum::<f64>() / middle;
    let rest: f64 = centred().map(|(middle, ends)| (ends - c * middle).powi(2)).sum();
    let is_one = rest < ONE_SINE * middle && c.abs() < 2.0;
    is_one.then(|| (0.5 * c).acos() / TAU / lag as f64)
}

/// The sum of products of samples that are `lag` apart.
fn product(inputs: &[Vec<f64>], lag: usize) -> f64 {
    let of_one = |input: &Vec<f64>| {
        input.iter().zip(input.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>()
    };
    inputs.iter().map(of_one).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::noise;

    fn sine(period: f64) -> impl Fn(usize) -> f64 {
        move |k| 0.4 + 2.0 * (TAU * k as f64 / period).sin()
    }

    fn input(value: impl Fn(usize) -> f64) -> Vec<f64> {
        (0..6000).map(value).collect()
    }

    #[test]
    fn one_sine_is_one_frequency() {
        for period in [7.0, 31.4, 200.0, 777.0] {
            let found = one_frequency(&[&input(sine(period)), &input(sine(period))]).unwrap();
            assert!((found * period - 1.0).abs() < 1e-3, "{period} {found}");
            let noise = noise(4, 0.0, 6000);
            let measured =
                one_frequency(&[&input(|k| sine(period)(k) + 0.005 * noise[k])]).unwrap();
            assert!((measured * period - 1.0).abs() < 0.01, "{period} {measured}");
        }
    }

    #[test]
    fn what_has_more_than_one_frequency_excites() {
        let two = |k: usize| (k as f64 * 0.07).sin() + 0.1 * (k as f64 * 0.1).sin();
        let triangle = |k: usize| ((k % 200) as f64 - 100.0).abs();
        let square = |k: usize| f64::from(u8::from(k % 200 < 100));
        let sweep = |k: usize| (1e-5 * (k as f64).powi(2)).sin();
        let after_rest = |k: usize| if k < 1000 { 0.4 } else { sine(200.0)(k) };
        for found in [input(two), input(triangle), input(square), input(sweep), input(after_rest)] {
            assert_eq!(one_frequency(&[&found]), None);
        }
        let noise = noise(4, 0.0, 6000);
        assert_eq!(one_frequency(&[&noise]), None);
        assert_eq!(one_frequency(&[&input(sine(200.0)), &input(sine(90.0))]), None);
        assert_eq!(one_frequency(&[&input(|_| 1.0)]), None);
        assert_eq!(one_frequency(&[]), None);
    }
}
