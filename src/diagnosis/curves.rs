//! Curves without a law: how the measured speed depends on the delayed input, the angle and the time,
//! beside what the model makes of the same.
//!
//! After the delay of the model the input is held; of each hold the settled part is cut into pieces,
//! each with the slope `v` of the measured output, but where that was filled in. They are described by a product of free curves,
//!
//! ```text
//! v = a(level) · b(angle) · c(time)
//! ```
//!
//! each a value per level of the input, or per interval of the angle or of time, with `b` and `c` one on
//! average, values weighted as the record determines them: where the joint hardly moved, its factor is
//! anything. With the other two held each is a linear least-squares problem without local minima;
//! they take turns. How many intervals an angle or a time has is cross-validated: every third block
//! of pieces is left out, and the number is taken that predicts it best. Bands are 95 % of the standard
//! error, with the residual's own variance. Where the levels reached from below and from above differ
//! beyond chance, the input has a curve for each: a hysteresis.
//!
//! # References
//! T. Hastie, R. Tibshirani and J. Friedman, "The Elements of Statistical Learning", 2009, sections
//! 5.2 (piecewise bases), 7.10 (cross-validation) and 9.1 (taking turns: backfitting).

use serde::Serialize;

use super::speed_error::slope;
use crate::experiment::Trial;
use crate::fit::FitRecord;
use crate::model::{JointModel, Simulated};
use crate::units::floor_to_index;

/// A curve, with its band, and the model's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// Of what it is.
    pub of: CurveOf,
    /// Where: input units, output units or seconds of the record.
    pub x: Vec<f64>,
    /// Speed in output units per second, or, of angle and time, the speed over that of all.
    pub y: Vec<f64>,
    /// The lower ends of the 95 % bands.
    pub low: Vec<f64>,
    /// The upper ends.
    pub high: Vec<f64>,
    /// The values of the model, from what it simulates, in the same way.
    pub model: Vec<f64>,
}

/// Of what a curve is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CurveOf {
    /// Of the delayed input.
    Input,
    /// Of the delayed input where its level was reached from below.
    InputRising,
    /// Where it was reached from above.
    InputFalling,
    /// Of the angle.
    Angle,
    /// Of the time.
    Time,
}

impl CurveOf {
    /// Its name in files.
    pub fn id(self) -> &'static str {
        match self {
            Self::Input => "input",
            Self::InputRising => "input_rising",
            Self::InputFalling => "input_falling",
            Self::Angle => "angle",
            Self::Time => "time",
        }
    }
}

/// Pieces that are enough for curves, and levels of the input up to which each is a point.
const FEWEST: usize = 24;
const MOST_LEVELS: usize = 60;

/// The measured curves of a joint beside those of `model`; none where the input is not held between
/// few levels, or the record is short.
pub(super) fn curves(
    record: &FitRecord<'_>,
    model: &JointModel,
    simulated: &[Simulated],
) -> Vec<Curve> {
    let pieces = pieces(record, model, simulated);
    let levels = distinct(&pieces);
    if pieces.len() < FEWEST || levels.len() > MOST_LEVELS || 2 * levels.len() > pieces.len() {
        return Vec::new();
    }
    let level_of = |piece: &Piece| levels.partition_point(|level| *level < piece.level);
    let level: Vec<usize> = pieces.iter().map(level_of).collect();
    let of = |value: fn(&Piece) -> f64| pieces.iter().map(value).collect::<Vec<f64>>();
    let (angles, times) = (of(|piece| piece.angle), of(|piece| piece.time_s));
    let product = |values: &[f64]| {
        Product::of(
            values,
            [&level, &binned(&angles, values, &level), &binned(&times, values, &level)],
        )
    };
    let (measured, simulated) = (of(|piece| piece.speed), of(|piece| piece.simulated));
    let found = product(&measured);
    let model = Product::of(&simulated, [&found.places[0], &found.places[1], &found.places[2]]);
    let mut curves = vec![found.curve(CurveOf::Input, 0, levels.clone(), &model)];
    curves.extend(branches(&pieces, &level, &levels, &found, [&measured, &simulated]));
    for (of, index, values) in [(CurveOf::Angle, 1, &angles), (CurveOf::Time, 2, &times)] {
        let x = means_in(values, &found.places[index], found.values[index].len());
        curves.extend((x.len() > 1).then(|| found.curve(of, index, x, &model)));
    }
    curves
}

/// A settled piece of a hold.
#[derive(Clone, Copy, Debug)]
struct Piece {
    level: f64,
    /// Whether the level was reached from below.
    from_below: bool,
    angle: f64,
    time_s: f64,
    /// Slopes of the measured and of the simulated output.
    speed: f64,
    simulated: f64,
}

fn pieces(record: &FitRecord<'_>, model: &JointModel, simulated: &[Simulated]) -> Vec<Piece> {
    let trials = record.joint().trials.iter().zip(simulated).enumerate();
    let of_trial = |(index, (trial, simulated)): (usize, (&Trial, &Simulated))| {
        let arrivals = record.arrivals(model, index);
        let changes = &arrivals.changes;
        let ends = changes.iter().skip(1).map(|change| change.time_s);
        let ends = ends.chain([trial.len() as f64 * trial.period().seconds()]);
        let before = std::iter::once(arrivals.initial).chain(changes.iter().map(|c| c.level));
        let holds = changes.iter().zip(ends).zip(before);
        let start_s = record.start_s(index);
        let hold = move |((change, end_s), before): ((&crate::model::Arrival, f64), f64)| {
            let span = (change.time_s, end_s);
            of_hold(trial, simulated, span, (before, change.level), start_s)
        };
        holds.flat_map(hold).collect::<Vec<_>>()
    };
    trials.flat_map(of_trial).collect()
}

/// The pieces of one hold, which lasts over `span`, after the part in which the joint may settle.
fn of_hold(
    trial: &Trial,
    simulated: &Simulated,
    (from_s, to_s): (f64, f64),
    (before, level): (f64, f64),
    start_s: f64,
) -> Vec<Piece> {
    /// The part of a hold in which a joint may still settle.
    const SETTLING: f64 = 0.4;
    /// The length of a piece: short against what the angle changes in a hold.
    const PIECE_S: f64 = 0.3;
    /// Samples of a piece, at least.
    const SHORTEST: usize = 6;
    let period_s = trial.period().seconds();
    let from = floor_to_index((from_s + SETTLING * (to_s - from_s)) / period_s) + 1;
    let to = floor_to_index(to_s / period_s).min(trial.len());
    let samples = to.saturating_sub(from);
    let length = floor_to_index(PIECE_S / period_s).max(SHORTEST);
    let parts = (samples / length).max(usize::from(samples >= SHORTEST));
    let part = |part: usize| {
        let (start, end) = (from + samples * part / parts, from + samples * (part + 1) / parts);
        if trial.unlogged().iter().any(|gap| gap.start < end && start < gap.end) {
            return None;
        }
        let output = trial.output().get(start..end)?;
        let velocity = simulated.velocity.get(start..end)?;
        Some(Piece {
            level,
            from_below: level > before,
            angle: mean(output),
            time_s: start_s + f64::midpoint(start as f64, end as f64) * period_s,
            speed: slope(output) / period_s,
            simulated: mean(velocity),
        })
    };
    let finite = |piece: &Piece| piece.speed.is_finite() && piece.simulated.is_finite();
    (0..parts).filter_map(part).filter(finite).collect()
}

/// The mean of `values` with these `weights`; one where nothing has a weight.
fn weighted_mean(values: &[f64], weights: &[f64]) -> f64 {
    let sum: f64 = values.iter().zip(weights).map(|(value, weight)| value * weight).sum();
    let mean = sum / weights.iter().sum::<f64>();
    if mean.is_normal() { mean } else { 1.0 }
}

/// The levels of pieces, ascending.
fn distinct(pieces: &[Piece]) -> Vec<f64> {
    let mut levels: Vec<f64> = pieces.iter().map(|piece| piece.level).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    levels
}

/// A product of curves, fitted to values.
struct Product {
    /// For each curve the place of each value on it.
    places: [Vec<usize>; 3],
    values: [Vec<f64>; 3],
    std_errors: [Vec<f64>; 3],
}

impl Product {
    /// Fitted to `values`, of which each has these `places` on the curves.
    fn of(values: &[f64], places: [&[usize]; 3]) -> Self {
        /// Turns: each takes most of what the ones before have left.
        const TURNS: usize = 30;
        let sizes = places.map(|places| places.iter().max().map_or(0, |most| most + 1));
        let mut curves = sizes.map(|size| vec![1.0; size]);
        let mut weights = curves.clone();
        for _ in 0..TURNS {
            for index in 0..curves.len() {
                // Σ v g / Σ g², with the product g of the other curves.
                let [mut with, mut square] = [vec![0.0; sizes[index]], vec![0.0; sizes[index]]];
                for (k, value) in values.iter().enumerate() {
                    let others = (0..curves.len()).filter(|other| *other != index);
                    let g: f64 = others.map(|other| curves[other][places[other][k]]).product();
                    with[places[index][k]] += value * g;
                    square[places[index][k]] += g * g;
                }
                let one = |(with, square): (&f64, &f64)| {
                    if *square > f64::MIN_POSITIVE { with / square } else { 0.0 }
                };
                curves[index] = with.iter().zip(&square).map(one).collect();
                if index > 0 {
                    let average = weighted_mean(&curves[index], &square);
                    curves[index].iter_mut().for_each(|value| *value /= average);
                }
                weights[index] = square;
            }
        }
        let places = places.map(<[usize]>::to_vec);
        let mut found = Self { places, values: curves, std_errors: weights };
        let squares: f64 = values.iter().enumerate().map(|(k, v)| (v - found.at(k)).powi(2)).sum();
        let free = sizes.iter().sum::<usize>().saturating_sub(2);
        let variance = squares / values.len().saturating_sub(free).max(1) as f64;
        for weight in found.std_errors.iter_mut().flatten() {
            *weight = (variance / weight.max(f64::MIN_POSITIVE)).sqrt();
        }
        found
    }

    /// The product at the value of this index.
    fn at(&self, index: usize) -> f64 {
        let factors = self.places.iter().zip(&self.values);
        factors.map(|(places, values)| values[places[index]]).product()
    }

    fn curve(&self, of: CurveOf, index: usize, x: Vec<f64>, model: &Self) -> Curve {
        let y = self.values[index].clone();
        let ends = |sign: f64| {
            let pairs = y.iter().zip(&self.std_errors[index]);
            pairs.map(|(value, error)| value + sign * BAND * error).collect()
        };
        let (low, high) = (ends(-1.0), ends(1.0));
        Curve { of, x, y, low, high, model: model.values[index].clone() }
    }
}

/// Standard errors on either side of 95 % of normal errors.
const BAND: f64 = 1.96;

/// The curves of the input by the side from which its levels were reached, where they differ beyond
/// chance.
fn branches(
    pieces: &[Piece],
    level: &[usize],
    levels: &[f64],
    found: &Product,
    values: [&[f64]; 2],
) -> Vec<Curve> {
    /// Standard deviations of a normal variable beyond which the mean of all differences is no chance:
    /// one in ten thousand.
    const BEYOND_CHANCE: f64 = 3.9;
    // Two places for each level: reached from above, and from below.
    let sides = pieces.iter().zip(level);
    let sides: Vec<usize> =
        sides.map(|(piece, level)| 2 * level + usize::from(piece.from_below)).collect();
    let [measured, model] =
        values.map(|values| Product::of(values, [&sides, &found.places[1], &found.places[2]]));
    let is_known = |place: usize| sides.iter().filter(|own| **own == place).count() > 1;
    let known =
        |side: usize| (0..levels.len()).map(move |it| 2 * it + side).filter(|it| is_known(*it));
    let (mut difference, mut variance) = (0.0, 0.0);
    for above in known(0).filter(|above| is_known(above + 1)) {
        difference += measured.values[0][above] - measured.values[0][above + 1];
        variance +=
            [above, above + 1].map(|it| measured.std_errors[0][it].powi(2)).iter().sum::<f64>();
    }
    if difference.abs() <= BEYOND_CHANCE * variance.sqrt() || variance <= 0.0 {
        return Vec::new();
    }
    let curve = |of: CurveOf, side: usize| {
        let all = measured.curve(of, 0, Vec::new(), &model);
        let pick = |values: &[f64]| known(side).map(|place| values[place]).collect::<Vec<f64>>();
        Curve {
            of,
            x: known(side).map(|place| levels[place / 2]).collect(),
            y: pick(&all.y),
            low: pick(&all.low),
            high: pick(&all.high),
            model: pick(&all.model),
        }
    };
    vec![curve(CurveOf::InputRising, 1), curve(CurveOf::InputFalling, 0)]
}

/// The interval of `x` in which each of its values lies, of as many intervals with equally many values
/// as predict the left-out `values` best.
fn binned(x: &[f64], values: &[f64], level: &[usize]) -> Vec<usize> {
    /// Numbers of intervals that are tried, and values that one has at least.
    const COUNTS: [usize; 6] = [1, 3, 4, 6, 9, 14];
    const FEWEST_IN_ONE: usize = 6;
    let candidates = COUNTS.into_iter().filter(|count| count * FEWEST_IN_ONE <= x.len());
    let binned = candidates.map(|count| in_intervals(x, count));
    let judged = binned.map(|places| (left_out_error(values, level, &places), places));
    judged.min_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(|| vec![0; x.len()], |(_, places)| places)
}

/// The place of each value among `count` intervals with equally many values.
fn in_intervals(x: &[f64], count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..x.len()).collect();
    order.sort_by(|a, b| x[*a].total_cmp(&x[*b]));
    let mut places = vec![0; x.len()];
    for (rank, index) in order.into_iter().enumerate() {
        places[index] = rank * count / x.len();
    }
    places
}

/// The squared error of what a product of the level and these places predicts of values that were left
/// out: every third block of eight.
fn left_out_error(values: &[f64], level: &[usize], places: &[usize]) -> f64 {
    const BLOCK: usize = 8;
    let is_out = |k: usize| k / BLOCK % 3 == 1;
    let kept: Vec<usize> = (0..values.len()).filter(|k| !is_out(*k)).collect();
    let of = |all: &[usize]| kept.iter().map(|k| all[*k]).collect::<Vec<_>>();
    let known: Vec<f64> = kept.iter().map(|k| values[*k]).collect();
    let fitted = Product::of(&known, [&of(level), &of(places), &vec![0; known.len()]]);
    let error = |k: usize| {
        let at = |index: usize, place: usize| fitted.values[index].get(place).copied();
        let predicted = at(0, level[k]).zip(at(1, places[k])).map(|(a, b)| a * b);
        predicted.map_or(0.0, |predicted| (values[k] - predicted).powi(2))
    };
    (0..values.len()).filter(|k| is_out(*k)).map(error).sum()
}

/// The mean of the values at each place.
fn means_in(values: &[f64], places: &[usize], count: usize) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); count];
    for (value, place) in values.iter().zip(places) {
        sums[*place] = (sums[*place].0 + value, sums[*place].1 + 1.0);
    }
    sums.into_iter().map(|(sum, n)| sum / n).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Joint;
    use crate::fit::{Horizon, Split};
    use crate::numerics::testing::noise;
    use crate::units::SamplePeriod;

    /// One of 12, as if at random: each level is reached from above and from below.
    fn drawn(hold: usize) -> usize {
        (hold * 7919 % 1009 * 31 + 7) % 97 % 12
    }

    /// Curves of a joint whose speed is `speed(input, play, angle, time)` beside an integrator of 8.
    fn of(speed: impl Fn(f64, f64, f64, f64) -> f64) -> Vec<Curve> {
        let levels = [1.0, -0.5, 2.0, -1.0, 0.5, -2.0, 1.5, 0.0, -1.5, 1.0, -2.0, 0.5];
        let input: Vec<f64> = (0..14_400).map(|k| levels[drawn(k / 120)]).collect();
        let noise = noise(3, 0.0, input.len());
        let (mut angle, mut play) = (0.0_f64, 0.0_f64);
        let output = input.iter().zip(&noise).enumerate().map(|(k, (u, noise))| {
            play = play.max(u - 0.2).min(u + 0.2);
            angle += 0.01 * speed(*u, play, angle, 0.01 * k as f64);
            angle + 0.01 * noise
        });
        let output = output.collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, input, output).unwrap();
        let joint = Joint::new("boom", vec![trial]);
        let record = FitRecord::new(&joint, Split::of(&joint), Horizon::Auto);
        let model = JointModel::integrator(8.0, 0.0);
        let simulated = record.evaluate(&model).simulated;
        curves(&record, &model, &simulated)
    }

    fn curve(curves: &[Curve], of: CurveOf) -> Option<&Curve> {
        curves.iter().find(|curve| curve.of == of)
    }

    #[test]
    fn a_valve_with_an_overlap_shows_it_beside_the_straight_line_of_the_model() {
        let found = of(|u, _, _, _| 8.0 * (u - u.clamp(-0.3, 0.3)));
        let input = curve(&found, CurveOf::Input).unwrap();
        for ((x, y), model) in input.x.iter().zip(&input.y).zip(&input.model) {
            assert!((y - 8.0 * (x - x.clamp(-0.3, 0.3))).abs() < 0.05, "{x}: {y}");
            assert!((model - 8.0 * x).abs() < 1e-6, "{x}: {model}");
        }
        assert!(curve(&found, CurveOf::InputRising).is_none(), "no hysteresis");
    }

    #[test]
    fn a_factor_that_nothing_determines_changes_no_other() {
        // Only the second level, at which the joint hardly moves, is tried in the second interval.
        let values = [10.0, 10.0, 1e-3, 5e-2];
        let all = [0; 4];
        let found = Product::of(&values, [&[0, 0, 1, 1], &[0, 0, 0, 1], &all]);
        assert!((found.values[0][0] - 10.0).abs() < 0.1, "{:?}", found.values);
    }

    #[test]
    fn a_gain_that_drifts_shows_in_time() {
        let found = of(|u, _, _, t| 8.0 * u * (1.0 + 0.3 * t / 144.0));
        let time = curve(&found, CurveOf::Time).unwrap();
        let (first, last) = (time.y[0], time.y[time.y.len() - 1]);
        assert!((last / first - 1.3).abs() < 0.08, "{first} {last}");
        let inside = |of: &&f64| time.low[0] <= **of && **of <= time.high[0];
        assert!(time.model.iter().take(1).filter(inside).count() == 0, "the model has no drift");
    }

    #[test]
    fn a_play_shows_as_two_branches() {
        let found = of(|_, play, _, _| 8.0 * play);
        let rising = curve(&found, CurveOf::InputRising).unwrap();
        let falling = curve(&found, CurveOf::InputFalling).unwrap();
        let at = |curve: &Curve, level: f64| {
            let index = curve.x.iter().position(|x| (x - level).abs() < 1e-9);
            index.map(|index| curve.y[index])
        };
        let apart = at(falling, 0.5).zip(at(rising, 0.5)).map(|(f, r)| f - r);
        assert!(apart.is_some_and(|apart| (apart - 8.0 * 0.4).abs() < 0.1), "{apart:?}");
    }
}
