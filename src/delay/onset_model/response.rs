//! The linear state of each shape.

use std::ops::Range;

use super::dynamics::{Dynamics, Response, Square, State, Steady};
use super::shape::{Family, Shape};

/// What fits a `shape` in windows of fewer than `longest` samples; `unit` samples are the unit of the
/// time within, which keeps its numbers alike in size.
pub(super) fn response_of(shape: &Shape, unit: f64, longest: usize) -> Box<dyn Response> {
    let h = unit.recip();
    let [t, zeta, third] = shape.logs.map(f64::exp);
    match (shape.family, shape.curved) {
        (Family::Bend, false) | (Family::Slew, _) => Box::new(bend(unit, longest)),
        (Family::Settling, _) => {
            let generator = Square::<2>::new(-1.0 / t, 1.0 / t, 0.0, 0.0);
            Box::new(dynamics(generator, 0..1, longest))
        }
        (Family::SettlingPair, _) => {
            let damping = -2.0 * zeta * t;
            let generator = Square::<3>::new(0.0, t, 0.0, -t, damping, t, 0.0, 0.0, 0.0);
            Box::new(dynamics(generator, 0..2, longest))
        }
        (Family::Bend, true) => Box::new(dynamics(chain::<3>(h, &[]), 1..1, longest)),
        (Family::Lag, false) => Box::new(dynamics(chain::<3>(h, &[t]), 1..2, longest)),
        (Family::Lag, true) => Box::new(dynamics(chain::<4>(h, &[t]), 1..2, longest)),
        (Family::Pair, false) => Box::new(dynamics(pair::<4>(h, t, zeta), 1..3, longest)),
        (Family::Pair, true) => Box::new(dynamics(pair::<5>(h, t, zeta), 1..3, longest)),
        (Family::Triple, false) => Box::new(triple::<5>(h, (t, zeta, third), longest)),
        (Family::Triple, true) => Box::new(triple::<6>(h, (t, zeta, third), longest)),
    }
}

/// Two lines that meet; `unit` samples are the unit of the time within.
pub(super) fn bend(unit: f64, longest: usize) -> Dynamics<2> {
    dynamics(Square::<2>::new(0.0, unit.recip(), 0.0, 0.0), 1..1, longest)
}

/// Dynamics whose speed `s` is the state after those that follow it; where there is a state more, holds
/// are curved, and it is the rate of the speed.
fn dynamics<const N: usize>(
    generator: Square<N>,
    followers: Range<usize>,
    longest: usize,
) -> Dynamics<N> {
    let speed = followers.end;
    let unit = |index: usize| State::<N>::from_fn(|i, _| f64::from(u8::from(i == index)));
    let nuisance = (N > speed + 1).then(|| unit(speed + 1));
    // In steady motion the first of those that follow is what it follows, and the rates of the others are
    // zero.
    let mut steady = Square::<N>::identity();
    for follower in followers.clone() {
        steady[(follower, follower)] = 0.0;
    }
    if let Some(first) = followers.clone().next() {
        steady[(first, speed)] = 1.0;
    }
    Dynamics::new(generator, unit(speed), nuisance, Steady(steady), longest)
}

/// An integrator after lags of one pole each.
fn chain<const N: usize>(h: f64, lags: &[f64]) -> Square<N> {
    let mut a = Square::<N>::zeros();
    a[(0, 1)] = h;
    for (lag, row) in lags.iter().zip(1..) {
        (a[(row, row)], a[(row, row + 1)]) = (-lag.recip(), lag.recip());
    }
    if N > lags.len() + 2 {
        a[(N - 2, N - 1)] = h;
    }
    a
}

/// An integrator after a pair of poles and a third one.
fn triple<const N: usize>(
    h: f64,
    (omega, zeta, lag): (f64, f64, f64),
    longest: usize,
) -> Dynamics<N> {
    let mut a = pair::<N>(h, omega, zeta);
    (a[(3, 3)], a[(3, 4)]) = (-lag.recip(), lag.recip());
    if N > 5 {
        a[(4, 5)] = h;
    }
    dynamics(a, 1..4, longest)
}

/// An integrator after a pair of poles.
fn pair<const N: usize>(h: f64, omega: f64, zeta: f64) -> Square<N> {
    let mut a = Square::<N>::zeros();
    (a[(0, 1)], a[(1, 2)]) = (h, omega);
    (a[(2, 1)], a[(2, 2)], a[(2, 3)]) = (-omega, -2.0 * zeta * omega, omega);
    if N > 4 {
        a[(3, 4)] = h;
    }
    a
}
