//! A shape with a pole more, begun from the best ones that are without it.
//!
//! A fit that is without a pole gives its part to the dead time and to the other poles, in one of two
//! ways: the poles that there are have the spread of all, or one of them, the slowest, stands for all, as a
//! lag does that hides an oscillation. The descent begins at both.

use super::residual::{PLAIN_AT_FIRST, Residual};
use super::search::{Candidate, NEAR, ROUNDS, Search};
use super::shape::{Family, Shape, Shapes};

impl Search {
    /// The shapes that the record supports, the best one first.
    pub(super) fn select(&self) -> Vec<Candidate> {
        let mut all = self.select_near(&self.first());
        all.extend(self.with_pole_more(&all));
        all.sort_by(|a, b| a.score.total_cmp(&b.score));
        all
    }

    /// The shapes with a pole more than the best of `all`.
    fn with_pole_more(&self, all: &[Candidate]) -> Vec<Candidate> {
        let fewer = if self.has_few_steps() {
            all.iter().find(|it| it.shape.family == Family::Settling)
        } else {
            all.first()
        };
        let Some(fewer) = fewer else { return Vec::new() };
        let straight = self.begun(fewer, &self.beginnings(fewer));
        // Holds that seem curved may be straight ones after a pole more.
        let curved = straight.as_ref().filter(|_| fewer.shape.curved).map(|it| {
            let shape = Shape { curved: true, ..it.shape };
            self.refined(self.evaluate(shape, it.onsets.clone(), it.typical, 2), ROUNDS)
        });
        let found = straight.into_iter().chain(curved);
        found.map(|it| self.by_memory(it, fewer)).collect()
    }

    /// Where the descents begin: for each some shapes, and by how much onsets are later (chosen; from
    /// twice as many others they arrive at the same).
    fn beginnings(&self, fewer: &Candidate) -> Vec<Vec<(Shape, f64)>> {
        let shape = Shape { curved: false, ..fewer.shape };
        let behind_lag = || {
            let pairs =
                [1.5, 3.0].into_iter().flat_map(|ratio| [0.2, 0.6].map(|zeta| (ratio, zeta)));
            pairs.map(|(ratio, zeta)| shape.behind_lag(ratio, zeta)).collect()
        };
        match shape.family {
            Family::Settling => {
                [0.1, 0.4].map(|ratio| shape.settling_pair(ratio).to_vec()).to_vec()
            }
            Family::Pair => {
                vec![[0.3, 1.0].map(|ratio| shape.same_spread(ratio)).to_vec(), behind_lag()]
            }
            Family::Lag if self.leaves_pattern(fewer) => vec![behind_lag()],
            _ => Vec::new(),
        }
    }

    /// Whether a shape leaves over what the steps have in common.
    fn leaves_pattern(&self, candidate: &Candidate) -> bool {
        self.residual(candidate).pattern.is_plain(PLAIN_AT_FIRST)
    }

    fn residual(&self, candidate: &Candidate) -> Residual {
        let pass = self.pass(Shapes::shared(candidate.shape), candidate.typical);
        Residual::of(&self.runs, &candidate.onsets, &pass, |_| true)
    }

    /// The best shape that is found from the best beginning of each descent.
    fn begun(&self, fewer: &Candidate, from: &[Vec<(Shape, f64)>]) -> Option<Candidate> {
        let is_allowed = |(shape, _): &&(Shape, f64)| shape.is_allowed(self.hold, self.change);
        let start = |(shape, later): &(Shape, f64)| {
            let onsets = fewer.onsets.iter().map(|of_run| of_run.later(*later)).collect();
            self.evaluate(*shape, onsets, fewer.typical + later, 2)
        };
        let best = |a: &Candidate, b: &Candidate| a.score.total_cmp(&b.score);
        let starts =
            from.iter().filter_map(|of| of.iter().filter(is_allowed).map(start).min_by(best));
        let near = starts.map(|it| self.refined(it, NEAR)).min_by(best)?;
        Some(self.refined(near, ROUNDS))
    }

    /// One whose gain on another counts as residuals that go together let it: these samples are fewer
    /// than they look, as those of a coarse sensor.
    fn by_memory(&self, mut more: Candidate, fewer: &Candidate) -> Candidate {
        let memory = self.residual(&more).memory;
        let gained = fewer.score - more.score;
        let of = |it: &Candidate| it.of_windows() + self.of_parameters(it);
        let parameters = of(&more) - of(fewer);
        more.score = fewer.score - (gained + parameters) / memory + parameters;
        more
    }
}

impl Shape {
    /// A first-order way to a level with a second pole, which is so large a part of the first: of the same
    /// mean, or after a dead time that is without it.
    fn settling_pair(&self, ratio: f64) -> [(Self, f64); 2] {
        // ω² = 1/(T₁T₂) and 2ζω = (T₁ + T₂)/(T₁T₂).
        let first = self.logs[0].exp() / (1.0 + ratio);
        let omega = (first * first * ratio).sqrt().recip();
        let zeta = (1.0 + ratio) * first * omega / 2.0;
        let logs = [omega.ln(), zeta.ln(), 0.0];
        let pair = Self { family: Family::SettlingPair, logs, ..*self };
        [(pair, 0.0), (pair, -first * ratio)]
    }

    /// A pair with a third pole of the same spread, as far as the pair is damped:
    /// `2/ω² = 2/ω'² + T²` with `T = r/ω'`.
    fn same_spread(&self, ratio: f64) -> (Self, f64) {
        let omega = self.logs[0] + (ratio * ratio / 2.0).ln_1p() / 2.0;
        self.triple([omega, self.logs[1], ratio.ln() - omega])
    }

    /// The mean of this one as that of a lag, and a pair with `ω T = r` after it.
    fn behind_lag(&self, ratio: f64, zeta: f64) -> (Self, f64) {
        let lag = self.mean().ln();
        self.triple([ratio.ln() - lag, zeta.ln(), lag])
    }

    /// The onset is earlier by as much as the mean is later.
    fn triple(&self, logs: [f64; 3]) -> (Self, f64) {
        let triple = Self { family: Family::Triple, logs, ..*self };
        (triple, self.mean() - triple.mean())
    }
}

#[cfg(test)]
mod tests {
    use super::super::windows::{Run, Step};
    use super::*;
    use crate::delay::neutral::Transition;
    use crate::numerics::testing::uniform;

    const DELAY: f64 = 12.6;
    const NOISE: f64 = 0.03;

    /// An integrator after a lag of `lag` samples and an oscillation.
    fn run(omega: f64, zeta: f64, lag: f64) -> Run {
        const PARTS: u32 = 50;
        let h = f64::from(PARTS).recip();
        let mut random = uniform(9);
        let (mut at, mut before, mut steps) = (40.0, 0.0, Vec::new());
        for _ in 0..24 {
            let after = random();
            let (kind, first, end) = (Transition::Change, 0.0, 3000.0);
            steps.push(Step { kind, at, before, after, first, end, latest: end, rests: false });
            before = after;
            at += (100.0 + 60.0 * random()).floor();
        }
        let [mut y, mut v, mut w, mut x] = [0.0; 4];
        let mut output = Vec::new();
        for k in 0..3000 * PARTS {
            let time = f64::from(k) * h;
            if k % PARTS == 0 {
                output.push(y + NOISE * 12.0_f64.sqrt() * random());
            }
            let last = steps.iter().rev().find(|step| step.at + DELAY <= time);
            let speed = last.map_or(0.0, |step| step.after);
            y += h * v;
            v += h * w;
            w += h * (omega * omega * (x - v) - 2.0 * zeta * omega * w);
            x += h * (speed - x) / lag;
        }
        Run { output, steps, is_window: false }
    }

    #[test]
    fn a_lag_that_hides_an_oscillation_is_found() {
        for (omega, zeta, lag) in [(0.26, 0.2, 11.0), (0.23, 0.45, 9.0), (0.25, 0.4, 5.0)] {
            let runs = vec![run(omega, zeta, lag)];
            let search = Search::of(runs, (1, 1.0), &Family::MOVING).unwrap();
            let best = &search.select()[0];
            assert_eq!(best.shape.family, Family::Triple, "{best:?}");
            assert!((best.typical - DELAY).abs() < 0.5, "{lag}: {}", best.typical);
            assert!((best.shape.logs[2].exp() / lag - 1.0).abs() < 0.1, "{:?}", best.shape);
        }
    }

    #[test]
    fn a_beginning_is_as_late_as_what_it_is_begun_from() {
        let pair = Shape { family: Family::Pair, logs: [-1.5, -0.2, 0.0], ..Shape::BEND };
        let of = [pair.same_spread(0.5), pair.behind_lag(2.0, 0.3)];
        for (shape, later) in of {
            assert!((shape.mean() + later - pair.mean()).abs() < 1e-12, "{shape:?}");
        }
        let [omega, zeta, lag] = of[1].0.logs.map(f64::exp);
        assert!((lag - pair.mean()).abs() < 1e-9 && (zeta - 0.3).abs() < 1e-9);
        assert!((omega * lag - 2.0).abs() < 1e-9);
    }
}
