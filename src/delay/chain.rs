//! Where the output reacts to each step, roughly and all at once.
//!
//! Between two reactions the output is about a line. Which reaction belongs to which step
//! is told by the cheapest chain of lines through the whole trial (dynamic programming),
//! first over few places for each reaction, then over some about the best ones. So holds
//! may be shorter than delays. What is found only has to be good enough for windows.

use std::ops::Range;

use super::broken_line::floor;
use super::free_motion::FreeMotion;
use super::response::{Response, Shape};
use super::settings::Settings;
use super::steps::InputStep;
use crate::numerics::moments;

/// Places of each reaction that are tried at a time.
const TRIED: usize = 10;

/// Samples of a piece in which earlier steps may still be felt, at most.
const LONGEST_MOTION: usize = 2000;

/// What the output is between two reactions.
#[derive(Clone, Debug)]
enum Pieces {
    /// About a line.
    Lines,
    /// What is left of earlier reactions behind a lag.
    Motions(FreeMotion),
}

/// A reaction in the chain; places are indices of the trial's samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    /// The step's own place: delays count from here.
    pub(super) origin: usize,
    pub(super) earliest: usize,
    pub(super) latest: usize,
    /// Samples that are looked at, at most.
    within: (usize, usize),
    /// Where the next step's input changes.
    next: usize,
    pub(super) place: f64,
    /// Standard error of the place, samples; 0 where it is not known.
    pub(super) error: f64,
    /// Whether its neighbours are to reckon with it.
    pub(super) counts: bool,
}

/// The links of all steps, and how many samples there are.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    pub(super) links: Vec<Link>,
    samples: usize,
}

impl Chain {
    /// The reactions of `output` to `steps`.
    pub(super) fn of(output: &[f64], steps: &[InputStep], settings: &Settings) -> Self {
        let samples = output.len();
        let mut chain = Self { links: links(samples, steps, settings), samples };
        if settings.max_delay.is_none() {
            chain.connect(output);
        }
        chain
    }

    /// The same reactions where they are cheapest behind a lag.
    pub(super) fn behind(mut self, shape: &Shape, output: &[f64]) -> Self {
        let links = self.links.iter().zip(self.links.iter().skip(2));
        let longest = links.map(|(link, later)| later.latest - link.origin).max();
        let longest = longest.unwrap_or(output.len()).min(LONGEST_MOTION);
        let pieces = Pieces::Motions(FreeMotion::of(shape, longest));
        self.place(output, lateness(output), &pieces);
        self
    }

    /// The same with each reaction so much earlier as this lag makes it late.
    pub(super) fn without(mut self, shape: &Shape) -> Self {
        let late = Response::of(shape).mean;
        for link in &mut self.links {
            link.place = (link.place - late).max(link.earliest as f64);
        }
        self
    }

    /// Whether nine of ten reactions have room before the next step of the input. Some
    /// others are where nothing happened; then neighbours are known well enough at once.
    pub(super) fn in_time(&self) -> bool {
        let in_time = self.links.iter().filter(|link| link.in_time()).count();
        10 * in_time >= 9 * self.links.len()
    }

    /// Whether most places are known so well that neighbours need not be searched again.
    pub(super) fn is_fine(&self) -> bool {
        /// Samples.
        const FINE: f64 = 0.5;
        let fine = self.links.iter().filter(|link| link.error <= FINE).count();
        2 * fine >= self.links.len()
    }

    /// The nearest link before `index` that counts.
    pub(super) fn before(&self, index: usize) -> Option<usize> {
        (0..index).rev().find(|before| self.counts(*before))
    }

    /// The nearest link after `index` that counts.
    pub(super) fn after(&self, index: usize) -> Option<usize> {
        (index + 1..self.links.len()).find(|after| self.counts(*after))
    }

    fn counts(&self, index: usize) -> bool {
        self.links.get(index).is_some_and(|link| link.counts)
    }

    /// The samples between the neighbours of link `index` that count.
    pub(super) fn window(&self, index: usize) -> Range<usize> {
        let after = self.after(index).and_then(|after| self.links.get(after));
        self.window_until(index, after.map_or(self.samples, |after| ceil(after.place)))
    }

    /// The same while the next reaction is known but roughly: it cannot begin before the
    /// input changes.
    pub(super) fn cautious_window(&self, index: usize) -> Range<usize> {
        /// Samples by which the next reaction may be off.
        const GUARD: usize = 4;
        let Some(link) = self.links.get(index) else { return 0..0 };
        let next = self.links.get(index + 1).map(|next| ceil(next.place).saturating_sub(GUARD));
        let end = if link.in_time() { link.next } else { next.unwrap_or(self.samples) };
        self.window_until(index, end)
    }

    fn window_until(&self, index: usize, end: usize) -> Range<usize> {
        let before = self.before(index).and_then(|before| self.links.get(before));
        let start = before.map_or(0, |before| ceil(before.place));
        let (first, last) = self.links.get(index).map_or((0, 0), |link| link.within);
        let start = start.max(first);
        start..end.min(last).max(start)
    }

    /// Puts every link at its place in the cheapest chain of lines.
    ///
    /// At first every reaction is taken to come before the next step; where a hold is not
    /// long beside the delays that gives, it may also come later.
    fn connect(&mut self, output: &[f64]) {
        let late = lateness(output);
        let latest: Vec<usize> = self.links.iter().map(|link| link.latest).collect();
        for link in &mut self.links {
            link.latest = link.latest.min(link.next);
        }
        self.place(output, late, &Pieces::Lines);
        let longest = self.longest_delay();
        let mut any_late = false;
        for (link, latest) in self.links.iter_mut().zip(latest) {
            if link.next - link.origin < longest {
                link.latest = latest.min(link.origin + longest);
                any_late = true;
            }
        }
        if any_late {
            self.place(output, late, &Pieces::Lines);
        }
    }

    /// A delay that few will exceed.
    fn longest_delay(&self) -> usize {
        let delay = |link: &Link| ceil(link.place) - link.origin;
        let mut delays: Vec<usize> = self.links.iter().map(delay).collect();
        let middle = delays.len() / 2;
        delays.sort_unstable();
        delays.get(middle).map_or(0, |median| 2 * median + 10)
    }

    /// Puts every link at its place, with the places that it may have.
    fn place(&mut self, output: &[f64], late: f64, pieces: &Pieces) {
        let coarse: Vec<Vec<usize>> = self.links.iter().map(Link::spread).collect();
        let found = cheapest(output, &self.links, &coarse, late, pieces);
        let fine = self.links.iter().zip(&coarse).zip(&found);
        let fine: Vec<Vec<usize>> =
            fine.map(|((link, tried), at)| link.about(tried, *at)).collect();
        let found = cheapest(output, &self.links, &fine, late, pieces);
        for (link, place) in self.links.iter_mut().zip(found) {
            link.place = place as f64;
        }
    }
}

/// The whole number from `value` up.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in a trial")]
pub(super) fn ceil(value: f64) -> usize {
    value.ceil().max(0.0) as usize
}

fn links(samples: usize, steps: &[InputStep], settings: &Settings) -> Vec<Link> {
    let nexts = steps.iter().skip(1).map(|next| next.sample - 1).chain([samples]);
    let holds = steps.iter().zip(nexts.clone()).map(|(step, next)| next + 1 - step.sample);
    let longest = usual_longest(holds.collect());
    let link = |(step, next): (&InputStep, usize)| {
        let origin = step.sample - 1;
        let reach = settings.max_delay.unwrap_or(longest + longest / 2);
        let latest =
            origin.saturating_add(reach).max(if settings.max_delay.is_some() { 0 } else { next });
        let latest =
            latest.saturating_add(if settings.max_delay.is_some() { 0 } else { settings.alpha });
        let latest = latest.min(samples.saturating_sub(2));
        let within = match settings.max_delay {
            None => (0, samples),
            Some(delay) => {
                let last = origin.saturating_add(delay).saturating_add(settings.alpha + 1);
                (origin.saturating_sub(settings.alpha), last.min(samples))
            }
        };
        let earliest = origin.saturating_sub(settings.alpha);
        let place = origin.midpoint(latest.min(next)) as f64;
        Link { origin, earliest, latest, within, next, place, error: 0.0, counts: true }
    };
    steps.iter().zip(nexts).map(link).collect()
}

/// A hold that is longer than nine of ten.
fn usual_longest(mut holds: Vec<usize>) -> usize {
    holds.sort_unstable();
    holds.get(holds.len() * 9 / 10).copied().unwrap_or(0)
}

/// What a reaction after the next step of the input costs more than one before it.
fn lateness(output: &[f64]) -> f64 {
    2.0 * second_difference_noise(output) * (output.len() as f64).ln()
}

/// Variance of white noise that would make the second differences of `output`.
fn second_difference_noise(output: &[f64]) -> f64 {
    /// The median of a normal variable's magnitude.
    const MEDIAN: f64 = 0.674_49;
    /// Differences that are enough to know it.
    const ENOUGH: usize = 10_000;
    let bend = |w: &[f64]| match w {
        [a, b, c] => (a - 2.0 * b + c).abs(),
        _ => 0.0,
    };
    let every = output.len().div_ceil(ENOUGH).max(1);
    let mut bends: Vec<f64> = output.windows(3).step_by(every).map(bend).collect();
    if bends.is_empty() {
        return 0.0;
    }
    let middle = bends.len() / 2;
    let median = *bends.select_nth_unstable_by(middle, f64::total_cmp).1;
    (median / MEDIAN).powi(2) / 6.0
}

impl Link {
    /// Whether it has room before the next step of the input.
    fn in_time(&self) -> bool {
        /// Samples that a reaction needs before the next one may be.
        const ROOM: f64 = 10.0;
        self.place + ROOM < self.next as f64
    }

    /// Samples about its place in which it may be as well.
    pub(super) fn guard(&self) -> usize {
        /// Standard errors.
        const CHANCE: f64 = 2.0;
        /// What is known less well is taken for known so well.
        const MOST: f64 = 20.0;
        if self.error.is_finite() { floor((CHANCE * self.error).min(MOST)) } else { 0 }
    }

    /// The latest place that is this step's own: what comes after the next change of the
    /// input is, for one that was in time.
    pub(super) fn last_place(&self) -> usize {
        const SLACK: usize = 3;
        let own = ceil(self.place) + SLACK;
        if self.place < self.next as f64 {
            own.max(self.next).min(self.latest)
        } else {
            self.latest
        }
    }

    /// A few places over all that may be.
    fn spread(&self) -> Vec<usize> {
        let range = self.latest.saturating_sub(self.origin);
        let place = |n: usize| self.origin + 1 + range * n / TRIED;
        let mut places: Vec<usize> = (0..TRIED).map(place).collect();
        places.dedup();
        places
    }

    /// Some places between the neighbours of `at` among those that were `tried`.
    fn about(&self, tried: &[usize], at: usize) -> Vec<usize> {
        let index = tried.iter().position(|place| *place == at).unwrap_or(0);
        let low = index.checked_sub(1).and_then(|i| tried.get(i)).unwrap_or(&self.origin);
        let high = tried.get(index + 1).unwrap_or(&self.latest).max(low);
        let place = |n: usize| low + (high - low) * n / TRIED;
        let mut places: Vec<usize> = (1..TRIED).map(place).chain([at]).collect();
        places.sort_unstable();
        places.dedup();
        places
    }
}

/// Sums of the output up to a place, about the first sample of all.
#[derive(Clone, Copy, Debug, Default)]
struct Mark {
    place: usize,
    /// Samples up to here.
    count: f64,
    /// `Σ y, Σ k·y, Σ y²`.
    sums: [f64; 3],
}

impl Mark {
    /// The marks at the places of `from` and of `to`, both of which ascend; those before `first`,
    /// or behind the end, are left empty.
    fn all(output: &[f64], first: usize, from: &[usize], to: &[usize]) -> [Vec<Self>; 2] {
        let offset = output.get(first).copied().unwrap_or_default();
        let mut now = Self { place: first, ..Self::default() };
        let mut up_to = |place: usize| {
            if place < first || place > output.len() {
                return Self::default();
            }
            let values = output.get(now.place..place).unwrap_or_default();
            let (y, ky, yy) = moments(values, offset);
            let [y_sum, moment, square] = now.sums;
            let sums = [y_sum + y, moment + now.count * y + ky, square + yy];
            now = Self { place, count: now.count + values.len() as f64, sums };
            now
        };
        let mut marks = [Vec::with_capacity(from.len()), Vec::with_capacity(to.len())];
        let [starts, ends] = &mut marks;
        let mut later = to.iter().copied().peekable();
        for start in from.iter().copied() {
            while let Some(end) = later.next_if(|end| *end < start) {
                ends.push(up_to(end));
            }
            starts.push(up_to(start));
        }
        ends.extend(later.map(up_to));
        marks
    }

    /// The squared error of the line from here up to `end`.
    fn line(&self, end: &Self) -> f64 {
        let n = end.count - self.count;
        if n < 3.0 {
            return 0.0;
        }
        let part = |index: usize| match (end.sums.get(index), self.sums.get(index)) {
            (Some(high), Some(low)) => high - low,
            _ => 0.0,
        };
        let (y, ky, yy) = (part(0), part(1), part(2));
        let middle = self.count + (n - 1.0) / 2.0;
        let moment = ky - middle * y;
        let spread = n * n - 1.0;
        (yy - (y * y * spread + 12.0 * moment * moment) / (n * spread)).max(0.0)
    }
}

impl Pieces {
    /// The squared errors of the pieces from each place of `from` to each of `to`, both of
    /// which ascend; infinite where the two are too close. All of one start stand together.
    fn errors(&self, output: &[f64], from: &[usize], to: &[usize]) -> Vec<f64> {
        /// Samples between two reactions, at least.
        const APART: usize = 2;
        let first = from.first().copied().unwrap_or(0);
        let starts: Vec<usize> = match self {
            Self::Lines => from.to_vec(),
            Self::Motions(_) => from.iter().map(|start| start + LONGEST_MOTION).collect(),
        };
        let [low, high] = Mark::all(output, first, &starts, to);
        let mut errors = Vec::with_capacity(from.len() * to.len());
        for ((start, unfelt), low) in from.iter().zip(&starts).zip(&low) {
            let far = |end: &usize| start + APART <= *end;
            if matches!(self, Self::Lines) {
                let ends = high.iter().zip(to);
                let error = |(high, end)| if far(end) { low.line(high) } else { f64::INFINITY };
                errors.extend(ends.map(error));
                continue;
            }
            let felt = self.felt(output, *start, to).into_iter();
            let ends = felt.chain(std::iter::repeat(0.0)).zip(&high).zip(to);
            errors.extend(ends.map(|((felt, high), end)| {
                let rest = if unfelt < end { low.line(high) } else { 0.0 };
                if far(end) { felt + rest } else { f64::INFINITY }
            }));
        }
        errors
    }

    /// The squared errors while earlier reactions are felt; none for lines.
    fn felt(&self, output: &[f64], start: usize, ends: &[usize]) -> Vec<f64> {
        let Self::Motions(motion) = self else { return Vec::new() };
        let values = output.get(start..).unwrap_or_default();
        motion.errors(values, ends.iter().map(|end| end.saturating_sub(start)))
    }
}

/// The cheapest chain of `pieces` through one of the `tried` places of each link; a
/// reaction `late`, after the next step of the input, costs that much more.
fn cheapest(
    output: &[f64],
    links: &[Link],
    tried: &[Vec<usize>],
    late: f64,
    pieces: &Pieces,
) -> Vec<usize> {
    let start = vec![0];
    let mut before = (&start, vec![0.0]);
    let mut ways: Vec<Vec<usize>> = Vec::with_capacity(links.len());
    let end = vec![output.len()];
    let all = links.iter().map(|link| link.next).chain([usize::MAX]);
    for (places, next) in tried.iter().chain([&end]).zip(all) {
        let (from, costs) = (before.0, &before.1);
        let mut best = vec![(f64::INFINITY, 0); places.len()];
        let errors = pieces.errors(output, from, places);
        let errors = errors.chunks_exact(places.len().max(1));
        for (way, (errors, cost)) in errors.zip(costs).enumerate() {
            for (best, error) in best.iter_mut().zip(errors) {
                if cost + error < best.0 {
                    *best = (cost + error, way);
                }
            }
        }
        let late = |place: &usize| if *place > next { late } else { 0.0 };
        let late = places.iter().map(late);
        let (mut costs, way): (Vec<f64>, Vec<usize>) =
            best.into_iter().zip(late).map(|((cost, way), late)| (cost + late, way)).unzip();
        // Steps too close for any chain: go on from here as if they had none.
        if costs.iter().all(|cost| cost.is_infinite()) {
            costs.fill(0.0);
        }
        ways.push(way);
        before = (places, costs);
    }
    back(tried, &ways)
}

/// The places on the way back from the end.
fn back(tried: &[Vec<usize>], ways: &[Vec<usize>]) -> Vec<usize> {
    let mut index = 0;
    let mut found: Vec<usize> = Vec::with_capacity(tried.len());
    let last = ways.last().and_then(|way| way.first()).copied();
    if let Some(last) = last {
        index = last;
    }
    for (places, way) in tried.iter().zip(ways).rev() {
        found.push(places.get(index).copied().unwrap_or(0));
        index = way.get(index).copied().unwrap_or(0);
    }
    found.reverse();
    found
}
