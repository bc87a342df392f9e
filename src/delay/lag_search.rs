//! The lag that all steps of a joint share.
//!
//! Stretches of some reactions each are fitted together: the shape's two or three
//! parameters are common, all else belongs to one stretch and is eliminated there, so that
//! a step of Gauss and Newton costs one pass. Which poles the lag has is chosen by
//! Schwarz's criterion, with noise whose memory the richest lag leaves.

use nalgebra::{Matrix3, Vector3};

use super::basis::Basis;
use super::response::{MOST, Poles, Response, Shape};
use super::stretch::{FINE, Linearised, Stretch};
use crate::numerics::NoiseModel;
use crate::numerics::{median, robust_scale};

/// Squared errors below this part of the output's are rounding.
const ROUNDING: f64 = 1e-14;

/// The stretches of a joint under one shape.
#[derive(Clone, Debug)]
pub(super) struct Joint<'a> {
    pub(super) stretches: Vec<Stretch<'a>>,
    pub(super) noise: NoiseModel,
    pub(super) shape: Shape,
    /// The longest time that can be told from a drift, samples.
    longest: f64,
    /// Sum of squares about the mean of each stretch.
    power: f64,
    found: Vec<Linearised>,
}

impl<'a> Joint<'a> {
    /// `stretches` whose places were found without a lag.
    pub(super) fn new(stretches: Vec<Stretch<'a>>) -> Self {
        let power = stretches.iter().map(|stretch| power(stretch.values)).sum();
        let gaps = stretches.iter().map(|s| s.values.len() / (s.places.len() + 1));
        let longest = gaps.max().unwrap_or(1) as f64;
        let (noise, shape, found) = (NoiseModel::white(), Shape::NONE, Vec::new());
        Self { stretches, noise, shape, longest, power, found }
    }

    fn sse(&self) -> f64 {
        self.found.iter().map(|found| found.sse).sum()
    }

    fn samples(&self) -> f64 {
        self.stretches.iter().map(Stretch::weight).sum()
    }

    /// Moves the reactions of every stretch to where its squared error is least.
    fn regress(&mut self) {
        self.regress_until(FINE);
    }

    /// The same until a step is no longer than `fine` samples.
    fn regress_until(&mut self, fine: f64) {
        let longest = self.stretches.iter().map(|stretch| stretch.values.len()).max();
        let (basis, noise) = (Basis::of(&self.shape, longest.unwrap_or(0)), &self.noise);
        let one = |stretch: &mut Stretch<'_>| {
            let limits = stretch.halfway();
            stretch.settle(&basis, noise, &limits, fine)
        };
        self.found = self.stretches.iter_mut().map(one).collect();
    }

    /// Leaves out stretches with an error far beyond that of most: something else happened
    /// there.
    fn without_strangers(&self) -> Self {
        /// Times the median of the squared error per sample.
        const STRANGE: f64 = 6.0;
        let levels = self.levels();
        let most = STRANGE * median(&levels).unwrap_or(0.0);
        self.of_those(&levels.iter().map(|level| *level <= most).collect::<Vec<_>>())
    }

    /// Which stretches have an error within what chance makes of that of most: where holds
    /// are short, reactions are easily mistaken for others.
    fn plausible(&self) -> Vec<bool> {
        /// Standard deviations.
        const CHANCE: f64 = 3.0;
        let levels = self.levels();
        let middle = median(&levels).unwrap_or(0.0);
        let about: Vec<f64> = levels.iter().map(|level| level - middle).collect();
        let most = middle + CHANCE * robust_scale(&about);
        levels.iter().map(|level| *level <= most).collect()
    }

    /// The squared error of each stretch per degree of freedom.
    fn levels(&self) -> Vec<f64> {
        let pairs = self.stretches.iter().zip(&self.found);
        let level = |(stretch, found): (&Stretch<'_>, &Linearised)| {
            found.sse / (stretch.weight() - found.parameters() as f64).max(1.0)
        };
        pairs.map(level).collect()
    }

    /// The joint with those stretches alone.
    fn of_those(&self, kept: &[bool]) -> Self {
        let mut joint = self.clone();
        let mut keep = kept.iter().copied();
        joint.stretches.retain(|_| keep.next().unwrap_or(true));
        let mut keep = kept.iter().copied();
        joint.found.retain(|_| keep.next().unwrap_or(true));
        joint
    }

    /// The same joint with another lag; its reactions begin earlier by as much as it is
    /// late.
    fn with(&self, shape: Shape) -> Self {
        let mut joint = self.about(shape);
        joint.regress();
        joint
    }

    /// The same with its reactions where they are without looking.
    fn about(&self, shape: Shape) -> Self {
        let mut joint = Self { shape, ..self.clone() };
        let earlier = Response::of(&shape).mean - Response::of(&self.shape).mean;
        for place in joint.stretches.iter_mut().flat_map(|stretch| &mut stretch.places) {
            *place -= earlier;
        }
        joint
    }

    /// Whether reactions are so small beside the noise that it takes many to see a lag.
    pub(super) fn is_faint(&self) -> bool {
        /// Standard deviations of the noise by which the speed changes, per sample.
        const CLEAR: f64 = 1.0;
        let mut changes: Vec<f64> = self.found.iter().map(|found| found.change().abs()).collect();
        changes.sort_by(f64::total_cmp);
        let median = changes.get(changes.len() / 2).copied().unwrap_or(0.0);
        let noise = (self.sse() / self.samples().max(1.0)).sqrt();
        median < CLEAR * noise
    }

    /// The same reactions under another lag and noise.
    pub(super) fn under(self, shape: Shape, noise: NoiseModel) -> Self {
        Self { noise, shape, ..self }
    }

    /// The least squared error near a shape that is almost right, without what is strange; or
    /// a simpler lag, where places that are known better no longer speak for all of its poles.
    pub(super) fn settled_again(self) -> Self {
        let usual = self.settle(1).without_strangers().refined();
        let simpler = usual.shape.simpler().into_iter();
        let rivals: Vec<_> = simpler.map(|shape| usual.with(shape).settle(STEPS)).collect();
        let better = |best: Self, rival: Self| {
            if rival.criterion() < best.criterion() { rival } else { best }
        };
        rivals.into_iter().fold(usual, better)
    }

    /// The least squared error near a shape that is almost right.
    fn refined(self) -> Self {
        const STEPS: usize = 4;
        let settled = self.settle(STEPS);
        let noise = settled.left();
        settled.whitened(noise).settle(STEPS)
    }

    /// The same joint with other noise.
    pub(super) fn whitened(&self, noise: NoiseModel) -> Self {
        let mut joint = Self { noise, ..self.clone() };
        joint.regress();
        joint
    }

    /// One step of places and shape; what the stretches say about the shape.
    fn step(&self) -> (Vec<Vec<f64>>, [f64; MOST], Information) {
        let pairs = self.stretches.iter().zip(&self.found);
        let with_shape = |(stretch, found): (&Stretch<'_>, &Linearised)| {
            stretch.with_shape(&self.shape, &self.noise, &found.parts)
        };
        let found: Vec<_> = pairs.map(with_shape).collect();
        let mut information = Information::default();
        for one in &found {
            one.add_shape(&mut information.products, &mut information.with);
        }
        let change = information.solve(self.shape.order());
        (found.iter().map(|one| one.moves(&change)).collect(), change, information)
    }

    /// Moves places and shape until the squared error is least, in `steps` at most.
    pub(super) fn settle(mut self, steps: usize) -> Self {
        /// Part by which the squared error must fall to go on.
        const WORTH: f64 = 1e-6;
        if self.found.len() != self.stretches.len() {
            self.regress();
        }
        for _ in 0..steps {
            let before = self.sse();
            let Some(better) = self.better() else { break };
            self = better;
            if before - self.sse() < WORTH * before {
                break;
            }
        }
        self
    }

    /// The joint after a step that lowers the squared error; shorter ones are tried.
    fn better(&self) -> Option<Self> {
        const HALVINGS: i32 = 4;
        let (moves, change, _) = self.step();
        for halving in 0..HALVINGS {
            let factor = 0.4_f64.powi(halving);
            let mut there = self.clone();
            there.shape = self.shape.moved(&change.map(|by| factor * by), self.longest);
            for (stretch, moves) in there.stretches.iter_mut().zip(&moves) {
                let last = stretch.values.len() as f64 - 2.0;
                for (place, by) in stretch.places.iter_mut().zip(moves) {
                    *place = (*place + factor * by).clamp(-last, last);
                }
            }
            there.regress();
            if there.sse() < self.sse() {
                return Some(there);
            }
        }
        None
    }

    /// Schwarz's criterion. What belongs to one stretch only takes degrees of freedom: it
    /// is no part of the shape that is chosen.
    fn criterion(&self) -> f64 {
        let samples = self.samples();
        let sse = self.sse().max(ROUNDING * self.power).max(f64::MIN_POSITIVE);
        let own: usize = self.found.iter().map(Linearised::parameters).sum();
        let freedom = (samples - own as f64).max(1.0);
        samples * (sse / freedom).ln() + penalty(self.shape.poles) * samples.ln()
    }

    /// Covariance of the shape's parameters.
    pub(super) fn covariance(&self) -> [[f64; MOST]; MOST] {
        let (_, _, information) = self.step();
        let used: usize = self.found.iter().map(Linearised::parameters).sum();
        let freedom = (self.samples() - (used + self.shape.order()) as f64).max(1.0);
        let inverse = information.inverse(self.shape.order());
        inverse.map(|row| row.map(|value| value * self.sse() / freedom))
    }

    /// The noise that the fits leave.
    pub(super) fn left(&self) -> NoiseModel {
        let leftovers = some(&self.stretches).map(|stretch| stretch.leftover(&self.shape));
        NoiseModel::left_by(&leftovers.collect::<Vec<_>>())
    }

    /// The best lag: no poles, a real one, a pair, or all three.
    pub(super) fn best(self) -> Self {
        let mut white = self.of_each_kind();
        let least = |all: &[Self]| all.iter().min_by(|a, b| a.sse().total_cmp(&b.sse())).cloned();
        let usual = least(&white).map(|richest| richest.without_strangers());
        if let Some(usual) = usual.filter(|usual| usual.stretches.len() < self.stretches.len()) {
            white = usual.with(Shape::NONE).of_each_kind();
        }
        let richest = least(&white);
        let noise = richest.map_or_else(NoiseModel::white, |richest| richest.left());
        let all = if noise.order() > 0 {
            white.iter().map(|joint| joint.whitened(noise.clone()).settle(STEPS)).collect()
        } else {
            white
        };
        let best = all.into_iter().min_by(|a, b| a.criterion().total_cmp(&b.criterion()));
        best.unwrap_or(self)
    }

    /// The best lag of any kind from places that are about right behind the one at hand; a
    /// simpler one if it is worse by no more than the part `caution` of a squared error.
    pub(super) fn reconsidered(self, caution: f64) -> Self {
        let usual = self.settle(1);
        let usual = usual.of_those(&usual.plausible());
        let rivals = usual.whitened(usual.left()).rivals();
        let noise = rivals.iter().min_by(|a, b| a.sse().total_cmp(&b.sse())).map(Self::left);
        let noise = noise.unwrap_or_else(NoiseModel::white);
        let settled = rivals.iter().map(|rival| rival.whitened(noise.clone()).settle(STEPS));
        let all: Vec<_> = settled.collect();
        let least = all.iter().map(Self::criterion).fold(f64::INFINITY, f64::min);
        let enough = least + caution * usual.samples();
        let simplest = all.into_iter().find(|joint| joint.criterion() <= enough);
        simplest.unwrap_or(usual)
    }

    /// The lags of each kind about as late as this one that explain most stretches, with
    /// those that none of them has trouble with: what one lag makes of a mistaken place is no
    /// reason to prefer it.
    fn rivals(&self) -> Vec<Self> {
        /// Times the least squared error.
        const GOOD: f64 = 1.2;
        /// Steps that tell whether a lag is a rival.
        const FEW: usize = 4;
        let starts = self.shape.nearby();
        let started = starts.into_iter().map(|starts| self.started(&starts).settle(FEW));
        let mut rivals: Vec<_> = started.collect();
        let least = rivals.iter().map(Self::sse).fold(f64::INFINITY, f64::min);
        rivals.retain(|joint| joint.sse() <= GOOD * least);
        let mut kept = vec![true; self.stretches.len()];
        for rival in &rivals {
            for (kept, plausible) in kept.iter_mut().zip(rival.plausible()) {
                *kept &= plausible;
            }
        }
        rivals.iter().map(|rival| rival.of_those(&kept)).collect()
    }

    /// The joint under the best lag of each kind.
    fn of_each_kind(&self) -> Vec<Self> {
        let none = self.clone().settle(STEPS);
        let real = none.started(&reals(self.longest)).settle(STEPS);
        let pair = none.started(&pairs(self.longest)).settle(STEPS);
        let again = |joint: &Self| joint.with(Shape::NONE).settle(STEPS);
        let nones = [again(&real), again(&pair), none];
        let Some(none) = nones.into_iter().min_by(|a, b| a.sse().total_cmp(&b.sse())) else {
            return Vec::new();
        };
        let mut all = vec![none, real, pair];
        let shape = |joint: &Self| joint.shape;
        if let Some(pair) = all.last().map(shape).filter(|shape| shape.poles == Poles::Pair) {
            let [omega, ..] = pair.logs;
            let behind =
                |part: f64| pair.behind(part / omega.exp()).moved(&[0.0; MOST], self.longest);
            let starts = [0.1, 0.5, 2.0].map(behind);
            let both = all.first().map(|none| none.started(&starts).settle(STEPS));
            all.extend(both);
        }
        all
    }

    /// The joint under the best of the `shapes`, after a step or two with each.
    fn started(&self, shapes: &[Shape]) -> Self {
        /// Samples that are enough to tell a good start.
        const ENOUGH: usize = 2000;
        /// Samples that a place may still move: only the best start is settled.
        const ROUGHLY: f64 = 1.0;
        let mut few = self.clone();
        let mut samples = 0;
        few.stretches.retain(|stretch| {
            let keep = samples < ENOUGH;
            samples += stretch.values.len();
            keep
        });
        few.found.truncate(few.stretches.len());
        let tried = shapes.iter().map(|shape| {
            let mut there = few.about(*shape);
            there.regress_until(ROUGHLY);
            there
        });
        let best = tried.min_by(|a, b| a.sse().total_cmp(&b.sse()));
        self.with(best.map_or(self.shape, |best| best.shape))
    }
}

/// How often Schwarz's penalty for one parameter is taken. A lag shorter than a sample is at
/// the border of all lags, and a pair that hardly decays looks for one period among many:
/// there noise explains more than its number of parameters.
fn penalty(poles: Poles) -> f64 {
    match poles {
        Poles::None => 0.0,
        Poles::Real => 1.5,
        Poles::Pair => 6.0,
        Poles::RealAndPair => 8.0,
    }
}

/// Steps of Gauss and Newton, at most.
const STEPS: usize = 12;

/// What the stretches say about the shape.
#[derive(Clone, Copy, Debug, Default)]
struct Information {
    products: [[f64; MOST]; MOST],
    with: [f64; MOST],
}

impl Information {
    /// The matrix with 1 where there is no parameter.
    fn matrix(&self, order: usize) -> Matrix3<f64> {
        let products = Matrix3::from(self.products).transpose();
        Matrix3::from_fn(|i, j| match (i < order && j < order, i == j) {
            (true, _) => products.index((i, j)) * if i == j { 1.0 + 1e-9 } else { 1.0 },
            (false, diagonal) => f64::from(u8::from(diagonal)),
        })
    }

    fn solve(&self, order: usize) -> [f64; MOST] {
        let solved = self.matrix(order).lu().solve(&Vector3::from(self.with));
        let finite = solved.filter(|solved| solved.iter().all(|value| value.is_finite()));
        finite.map_or([0.0; MOST], Into::into)
    }

    fn inverse(&self, order: usize) -> [[f64; MOST]; MOST] {
        let inverse = self.matrix(order).try_inverse().unwrap_or_else(Matrix3::zeros);
        let entry =
            |i: usize, j: usize| if i < order && j < order { *inverse.index((i, j)) } else { 0.0 };
        std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
    }
}

/// Enough of the stretches to know the noise.
fn some<'a, 'b>(all: &'b [Stretch<'a>]) -> impl Iterator<Item = &'b Stretch<'a>> {
    const ENOUGH: usize = 50;
    all.iter().step_by(all.len().div_ceil(ENOUGH).max(1))
}

fn reals(longest: f64) -> Vec<Shape> {
    doubling(0.5, longest / 2.0).map(Shape::real).collect()
}

fn pairs(longest: f64) -> Vec<Shape> {
    let periods = doubling(5.0, 2.0 * longest);
    let pair = |period: f64| {
        [0.15, 0.5, 1.2].map(|zeta| Shape::pair_of(std::f64::consts::TAU / period, zeta))
    };
    periods.flat_map(pair).collect()
}

/// `from`, twice as much, and so on up to `to`.
fn doubling(from: f64, to: f64) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(from), |value| Some(2.0 * value))
        .take_while(move |v| *v <= to.max(from))
}

/// Sum of squares about the mean.
fn power(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(|y| (y - mean) * (y - mean)).sum()
}
