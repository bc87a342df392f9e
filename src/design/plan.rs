//! Random steps that suit a joint and keep it in its range, or why there are none.

use super::levels::{Band, default_hold_s, default_largest, default_levels, settling_hold_s};
use super::logged::Logged;
use super::predict::{Prediction, TestRig, Uncertain};
use super::random::{RandomSteps, differ, random_steps, random_steps_within};
use super::response::resting_band;
use super::schedule::{Schedule, samples_in};
use super::trend::Travel;

/// What is asked of random steps; what is left open suits the joint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wishes {
    /// The levels, as differences to rest.
    pub levels: Option<Vec<f64>>,
    /// The largest magnitude of a level.
    pub largest: Option<f64>,
    /// What becomes of the dead band.
    pub band: Option<Band>,
    /// Shortest and longest hold, seconds.
    pub hold_s: Option<(f64, f64)>,
    /// Length, seconds.
    pub duration_s: Option<f64>,
    /// Where random numbers come from.
    pub seed: u64,
}

/// Random steps, and what is expected of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The input.
    pub schedule: Schedule,
    /// What the joint will do, where a model says so.
    pub prediction: Option<Prediction>,
    /// Shortest and longest hold that were asked for, seconds.
    pub hold_s: (f64, f64),
    /// The largest magnitude of a level.
    pub largest: f64,
    /// Levels that a wider range would allow.
    pub left_out: Vec<f64>,
    /// The length that a surer prediction would allow, seconds, where this one is shorter.
    pub shortened_from_s: Option<f64>,
}

/// Why there are no such steps.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// Fewer than two levels.
    #[error("--levels: fewer than two are left; an input needs two different levels or more")]
    TooFewLevels,
    /// A hold is longer than all.
    #[error("--hold {hold_s}: longer than the whole input of {duration_s} s")]
    HoldTooLong {
        /// The shortest hold, seconds.
        hold_s: f64,
        /// The whole input, seconds.
        duration_s: f64,
    },
    /// Nothing is known of how far predictions are off.
    #[error(
        "--output-range: the log is too short to show how far predictions of the joint are off; \
         give a longer log, or --model alone"
    )]
    ErrorUnknown,
    /// The range lies where the joint has not been.
    #[error(
        "--output-range={},{}: the log shows the joint only from {} to {}, and nothing is known of it \
         elsewhere; give a range there, or a log of this range",
        rounded(.range.0), rounded(.range.1), rounded(.extent.0), rounded(.extent.1)
    )]
    Elsewhere {
        /// The range.
        range: (f64, f64),
        /// Lowest and highest output of the log.
        extent: (f64, f64),
    },
    /// Fewer than two inputs of the log let an output that regulates itself rest in the range.
    #[error(
        "--output-range={},{}: the output regulates itself, and fewer than two inputs of the log \
         let it rest there{}: it rests at {}; give a range about two of these",
        rounded(.range.0), rounded(.range.1), with_margin(*.margin), rounded_list(.outputs)
    )]
    SettlesElsewhere {
        /// The range.
        range: (f64, f64),
        /// How far a prediction may be off, output units.
        margin: f64,
        /// Where it rests at the levels of the log, output units.
        outputs: Vec<f64>,
    },
    /// The log has inputs of one sign only, and no model of it leads back.
    #[error(
        "--output-range={},{}: the log has {} inputs only, and does not show what leads the joint \
         back; give a log with inputs of either sign, or --levels",
        rounded(.range.0), rounded(.range.1), if *.is_positive { "positive" } else { "negative" }
    )]
    OneSign {
        /// The range.
        range: (f64, f64),
        /// Which sign they have, about rest.
        is_positive: bool,
    },
    /// It starts too near to an end of the range, or beyond.
    #[error(
        "--start {start}: too near to the ends of the range, {} to {}, or beyond; start near {}",
        rounded(.range.0), rounded(.range.1), rounded(0.5 * (.range.0 + .range.1))
    )]
    Start {
        /// Where it starts.
        start: f64,
        /// Where the joint may be.
        range: (f64, f64),
    },
    /// The range cannot be kept.
    #[error("--output-range={},{}: {}", rounded(.range.0), rounded(.range.1), .why)]
    NotKept {
        /// The range.
        range: (f64, f64),
        /// What there is to do about it.
        why: NotKept,
    },
}

/// Why a range cannot be kept, and what would do.
#[derive(Clone, Debug, PartialEq)]
pub struct NotKept {
    /// How long it was to be kept, seconds.
    pub duration_s: f64,
    /// How far a prediction may be off then even if the joint rests, output units, where a log
    /// shows that.
    pub margin: Option<f64>,
    /// A length for which the range can be kept, seconds.
    pub shorter_s: Option<f64>,
    /// A range that can be kept for the whole time.
    pub wider: Option<(f64, f64)>,
}

impl std::fmt::Display for NotKept {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { duration_s, margin, shorter_s, wider } = self;
        write!(f, "cannot be kept for {duration_s} s")?;
        if let Some(margin) = margin {
            let margin = rounded(*margin);
            write!(f, ": a prediction of this joint may be off by {margin} after that time")?;
        }
        match (shorter_s, wider) {
            (Some(s), Some((low, high))) => {
                write!(f, "; give --duration {s}, or --output-range={low},{high}")
            }
            (Some(s), None) => write!(f, "; give --duration {s}"),
            (None, Some((low, high))) => write!(f, "; give --output-range={low},{high}"),
            (None, None) => f.write_str(
                "; no shorter input and no wider range will do: give a log in which the joint is \
                 driven for longer without a break, or smaller levels (--largest)",
            ),
        }
    }
}

/// `x` to four digits or so, as it is typed.
fn rounded(x: f64) -> f64 {
    let scale = 10_f64.powf(3.0 - x.abs().max(f64::MIN_POSITIVE).log10().floor().clamp(-9.0, 3.0));
    (x * scale).round() / scale
}

fn with_margin(margin: f64) -> String {
    if margin > 0.0 { format!(" with a margin of {}", rounded(margin)) } else { String::new() }
}

fn rounded_list(values: &[f64]) -> String {
    values.iter().map(|x| rounded(*x).to_string()).collect::<Vec<_>>().join(", ")
}

/// Length of an input where none is asked for, seconds.
const DURATION_S: f64 = 120.0;

/// Shorter inputs that are tried where it is not said how long it is to be, as parts of the
/// longest.
const SHORTER: [f64; 7] = [0.75, 0.5, 0.375, 0.25, 0.1875, 0.125, 0.0833];

/// Wider ranges that are tried to say which one would do.
const WIDER: [f64; 4] = [1.5, 2.0, 3.0, 5.0];

/// Part of what a log has gone through by which the joint may leave that on either side.
const BEYOND: f64 = 0.1;

/// Fewest steps of an input that is worth to be played.
const FEWEST_STEPS: usize = 6;

/// Where a joint may be: in the range that is asked for, and about where its log has been.
///
/// What a joint does elsewhere, near its stops or where its lever is another, no model knows from
/// the log.
///
/// # Errors
/// [`PlanError::Elsewhere`].
pub fn reach(range: (f64, f64), logged: Option<&Logged>) -> Result<(f64, f64), PlanError> {
    let Some(&Logged { extent, .. }) = logged else { return Ok(range) };
    let beyond = BEYOND * (extent.1 - extent.0);
    let reach = (range.0.max(extent.0 - beyond), range.1.min(extent.1 + beyond));
    if reach.0 < reach.1 { Ok(reach) } else { Err(PlanError::Elsewhere { range, extent }) }
}

/// Random steps for the joint number `index` of an experiment, of which `known` and `logged` are
/// known.
///
/// Without a range or a model these are [`random_steps`]. Else the joint stays in the part of the
/// range where its log has been, its prediction being off as far as its margin says; for that,
/// holds are made shorter and the largest levels are left out where nothing was asked for, and the
/// input ends sooner where its length was left open.
///
/// # Errors
/// [`PlanError`].
pub fn plan(
    wishes: &Wishes,
    rig: &TestRig,
    known: Option<&Uncertain>,
    logged: Option<&Logged>,
    index: usize,
) -> Result<Plan, PlanError> {
    let planner = Planner { wishes, rig, known, logged, index };
    let levels = planner.levels();
    if levels.len() < 2 {
        return Err(planner.settles_elsewhere().unwrap_or(PlanError::TooFewLevels));
    }
    let duration_s = wishes.duration_s.unwrap_or(DURATION_S);
    let hold_s = planner.hold_s(&levels);
    if hold_s.0 > duration_s {
        return Err(PlanError::HoldTooLong { hold_s: hold_s.0, duration_s });
    }
    let (Some(range), Some(known)) = (rig.range, known) else {
        let seed = wishes.seed;
        let steps = RandomSteps { levels, hold_s, duration_s, seed };
        let schedule = random_steps(&steps, rig, known, index);
        let prediction = known.map(|known| rig.prediction(known, &schedule));
        return Ok(planner.plan(schedule, prediction, hold_s, &steps.levels));
    };
    if logged.is_some() && known.free_run.is_none() {
        return Err(PlanError::ErrorUnknown);
    }
    let within = reach(range, logged)?;
    let start = rig.start;
    if start <= within.0 || start >= within.1 {
        return Err(PlanError::Start { start, range: within });
    }
    let planned = planner.within(known, within, (&levels, hold_s));
    let one_sign = one_sign(&levels).filter(|_| planned.is_err() && wishes.levels.is_none());
    one_sign.map_or(planned, |is_positive| Err(PlanError::OneSign { range, is_positive }))
}

/// Rest for so many seconds.
fn at_rest(seconds: f64) -> Travel {
    Travel { seconds, ..Travel::default() }
}

/// Whether `levels`, all of one sign or zero, are positive.
fn one_sign(levels: &[f64]) -> Option<bool> {
    let has = |sign: f64| levels.iter().any(|level| sign * level > 0.0);
    (has(1.0) != has(-1.0)).then(|| has(1.0))
}

/// What random steps are made from.
#[derive(Clone, Copy)]
struct Planner<'a> {
    wishes: &'a Wishes,
    rig: &'a TestRig,
    known: Option<&'a Uncertain>,
    logged: Option<&'a Logged>,
    index: usize,
}

impl Planner<'_> {
    /// The levels that suit the joint, or are asked for.
    fn levels(&self) -> Vec<f64> {
        let Wishes { levels, largest, band, .. } = self.wishes;
        let levels = levels.clone().unwrap_or_else(|| match (largest, self.logged) {
            (None, Some(logged)) => self.logged_levels(logged),
            (Some(_), Some(logged)) => self.levels_of_its_signs(logged),
            _ => default_levels(self.model(), self.rig, self.largest()),
        });
        band.map_or(levels.clone(), |band| band.applied(&levels))
    }

    /// Rest, and levels of the log that move the joint.
    fn logged_levels(&self, logged: &Logged) -> Vec<f64> {
        let logged = match self.rig.range {
            Some((low, high)) => {
                let margin = self.bounded_margin();
                logged.settling_within((low + margin, high - margin))
            }
            None => logged.clone(),
        };
        let band = self.model().and_then(|model| resting_band(model, self.rig, self.largest()));
        let mut levels = logged.beyond(band.unwrap_or((0.0, 0.0)));
        levels.push(0.0);
        levels.sort_by(f64::total_cmp);
        levels
    }

    /// How far a prediction may be off of an output that regulates itself; 0 of others.
    fn bounded_margin(&self) -> f64 {
        let free_run = self.known.and_then(|known| known.free_run.as_ref());
        let bounded = free_run.filter(|free_run| free_run.is_bounded());
        bounded.map_or(0.0, |free_run| free_run.margin(Travel::default()))
    }

    /// That no level of the log suits the range of an output that regulates itself.
    fn settles_elsewhere(&self) -> Option<PlanError> {
        let (range, settling) = (self.rig.range?, self.logged?.settling.as_ref()?);
        let outputs = settling.outputs.clone();
        (self.wishes.levels.is_none() && self.wishes.largest.is_none())
            .then(|| PlanError::SettlesElsewhere { range, margin: self.bounded_margin(), outputs })
    }

    /// Levels as of a joint of which no log is known, but none of a sign that `logged` has not.
    fn levels_of_its_signs(&self, logged: &Logged) -> Vec<f64> {
        let mut levels = default_levels(self.model(), self.rig, self.largest());
        let has = |sign: f64| logged.levels.iter().any(|level| sign * level > 0.0);
        levels.retain(|level| *level == 0.0 || has(level.signum()));
        levels
    }

    fn largest(&self) -> f64 {
        let magnitude =
            |levels: &Vec<f64>| levels.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        let Wishes { levels, largest, .. } = self.wishes;
        let logged = self.logged.map(Logged::largest).filter(|largest| *largest > 0.0);
        let given = levels.as_ref().map(magnitude).or(*largest).or(logged);
        given.unwrap_or_else(|| default_largest(self.model(), self.rig))
    }

    fn hold_s(&self, levels: &[f64]) -> (f64, f64) {
        let largest = levels.iter().fold(0.0, |largest: f64, level| largest.max(level.abs()));
        let usual = || default_hold_s(self.model(), self.rig, largest);
        let settling = self.logged.and_then(|logged| logged.settling.as_ref());
        let usual = || settling.map_or_else(usual, |settling| settling_hold_s(settling.time_s));
        self.wishes.hold_s.unwrap_or_else(usual)
    }

    fn model(&self) -> Option<&crate::model::JointModel> {
        self.known.map(|known| &known.model)
    }

    /// The steps within `range`, as they are asked for or as near to that as can be.
    fn within(
        &self,
        known: &Uncertain,
        range: (f64, f64),
        (levels, hold_s): (&[f64], (f64, f64)),
    ) -> Result<Plan, PlanError> {
        let longest_s = self.wishes.duration_s.unwrap_or(DURATION_S);
        let ways = self.ways(levels, hold_s);
        let kept = |duration_s: f64, range| self.kept(known, range, &ways, duration_s);
        if let Some(plan) = kept(longest_s, range) {
            return Ok(plan);
        }
        let shorter = SHORTER.iter().map(|part| (part * longest_s).round());
        let mut shorter = shorter.filter(|seconds| *seconds >= hold_s.0 * FEWEST_STEPS as f64);
        let found = shorter.find_map(|seconds| Some((seconds, kept(seconds, range)?)));
        match found {
            Some((_, plan)) if self.wishes.duration_s.is_none() => {
                Ok(Plan { shortened_from_s: Some(longest_s), ..plan })
            }
            found => {
                let shorter_s = found.map(|(seconds, _)| seconds);
                let asked = self.rig.range.unwrap_or(range);
                let why = NotKept {
                    duration_s: longest_s,
                    margin: known
                        .free_run
                        .as_ref()
                        .map(|free_run| free_run.margin(at_rest(longest_s))),
                    shorter_s,
                    wider: self.wider(asked, |range| kept(longest_s, range).is_some()),
                };
                Err(PlanError::NotKept { range: asked, why })
            }
        }
    }

    /// The narrowest wider range that will do.
    fn wider(&self, asked: (f64, f64), will_do: impl Fn((f64, f64)) -> bool) -> Option<(f64, f64)> {
        let (middle, half) = (0.5 * (asked.0 + asked.1), 0.5 * (asked.1 - asked.0));
        let wider =
            WIDER.map(|times| (rounded(middle - times * half), rounded(middle + times * half)));
        let mut wider = wider.into_iter();
        wider.find(|range| reach(*range, self.logged).is_ok_and(&will_do))
    }

    /// Levels and holds that are tried, best first: with shorter holds, and without the largest
    /// levels, where these were not asked for.
    fn ways(&self, levels: &[f64], hold_s: (f64, f64)) -> Vec<(Vec<f64>, (f64, f64))> {
        /// Longest hold over shortest of the shorter ones.
        const SHORT: f64 = 1.4;
        /// Of shorter holds a fit sees little.
        const SHORTEST_S: f64 = 0.5;
        let mut holds = vec![hold_s];
        if self.wishes.hold_s.is_none() {
            holds.push((hold_s.0, SHORT * hold_s.0));
            // The usual ones are twice as long as the response.
            let half = 0.5 * hold_s.0;
            holds.extend((half >= SHORTEST_S).then_some((half, SHORT * half)));
        }
        let mut sets = vec![levels.to_vec()];
        let smaller: Vec<f64> = match levels {
            [_, inner @ .., _] => inner.to_vec(),
            _ => Vec::new(),
        };
        if self.wishes.levels.is_none() && smaller.len() > 2 {
            sets.push(smaller);
        }
        let ways = sets.iter().flat_map(|levels| holds.iter().map(|hold| (levels.clone(), *hold)));
        ways.collect()
    }

    /// The first of `ways` in which the joint is kept in `range` for the whole time; rather one in
    /// which no level is rare.
    fn kept(
        &self,
        known: &Uncertain,
        range: (f64, f64),
        ways: &[(Vec<f64>, (f64, f64))],
        duration_s: f64,
    ) -> Option<Plan> {
        // At its end it is somewhere in the range, whatever is played.
        let least = known.free_run.as_ref().map_or(0.0, |of| of.margin(at_rest(duration_s)));
        if 2.0 * least > range.1 - range.0 {
            return None;
        }
        let all = ways.first().map_or(&[][..], |(levels, _)| levels.as_slice());
        let mut rare = None;
        for (levels, hold_s) in ways {
            let seed = self.wishes.seed;
            let steps = RandomSteps { levels: levels.clone(), hold_s: *hold_s, duration_s, seed };
            let schedule = random_steps_within(&steps, self.rig, known, range, self.index);
            let is_whole = schedule.samples() == samples_in(duration_s, self.rig.period);
            if !is_whole || schedule.steps() < FEWEST_STEPS || fewest_visits(&schedule, levels) == 0
            {
                continue;
            }
            let prediction = self.rig.prediction(known, &schedule);
            if prediction.kept_until(range).is_some() {
                continue;
            }
            let visits = fewest_visits(&schedule, levels) * levels.len() * RARE;
            let is_even = visits >= schedule.holds().len();
            let plan = self.plan(schedule, Some(prediction), *hold_s, all);
            if is_even {
                return Some(plan);
            }
            rare = rare.or(Some(plan));
        }
        rare
    }

    /// `schedule` as a plan, of which `all` levels would be played in a wide range.
    fn plan(
        &self,
        schedule: Schedule,
        prediction: Option<Prediction>,
        hold_s: (f64, f64),
        all: &[f64],
    ) -> Plan {
        let played = schedule.levels();
        let left_out: Vec<f64> = match self.rig.range {
            Some(_) => all.iter().copied().filter(|level| !played.contains(level)).collect(),
            None => Vec::new(),
        };
        let largest = played.iter().fold(0.0, |largest: f64, level| largest.max(level.abs()));
        Plan { schedule, prediction, hold_s, largest, left_out, shortened_from_s: None }
    }
}

/// A level is rare that is played so many times less often than on average.
const RARE: usize = 3;

/// How often that of `levels` is played which is played least often.
fn fewest_visits(schedule: &Schedule, levels: &[f64]) -> usize {
    let visits =
        |level: &f64| schedule.holds().iter().filter(|hold| !differ(hold.level, *level)).count();
    levels.iter().map(visits).min().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::super::free_run::FreeRunError;
    use super::super::predict::tests::rig;
    use super::*;
    use crate::model::JointModel;

    /// A joint whose predictions were off by `per_second` after a second.
    fn known(per_second: f64) -> Uncertain {
        let free_run = Some(FreeRunError::growing(per_second));
        Uncertain { free_run, ..Uncertain::by_share(JointModel::integrator(10.0, 0.2), 0.0) }
    }

    fn within(range: (f64, f64), per_second: f64, wishes: &Wishes) -> Result<Plan, PlanError> {
        plan(wishes, &rig(Some(range)), Some(&known(per_second)), None, 0)
    }

    /// A line on what came of it: a plan has many numbers.
    fn refusal(result: Result<Plan, PlanError>) -> PlanError {
        match result {
            Ok(plan) => panic!("a plan of {} s", plan.schedule.duration_s()),
            Err(error) => error,
        }
    }

    #[test]
    fn a_plan_stays_in_the_range_goes_back_and_ends_at_rest_near_the_middle() {
        let wishes = Wishes { duration_s: Some(60.0), seed: 4, ..Wishes::default() };
        let made = within((-30.0, 30.0), 0.1, &wishes).unwrap();
        let prediction = made.prediction.unwrap();
        assert_eq!(prediction.kept_until((-30.0, 30.0)), None);
        assert!(prediction.output.last().unwrap().abs() < 15.0);
        assert!(made.schedule.holds().last().unwrap().level.abs() < 1e-9);
        assert!((made.schedule.duration_s() - 60.0).abs() < 0.011);
        assert_eq!(made.schedule.levels(), [-2.0, -1.0, 0.0, 1.0, 2.0]);
    }

    #[test]
    fn what_cannot_be_kept_is_refused_with_a_remedy_that_does() {
        let asked = Wishes { duration_s: Some(120.0), ..Wishes::default() };
        let refused = refusal(within((-13.0, 13.0), 0.05, &asked));
        let PlanError::NotKept { why, .. } = &refused else { panic!("{refused}") };
        assert!((why.margin.unwrap() - 12.0).abs() < 1e-9);
        let shorter = Wishes { duration_s: why.shorter_s, ..Wishes::default() };
        assert!(why.shorter_s.is_some() && within((-13.0, 13.0), 0.05, &shorter).is_ok());
        assert!(within(why.wider.unwrap(), 0.05, &asked).is_ok());
        assert!(refused.to_string().contains("give --duration"), "{refused}");
    }

    #[test]
    fn the_length_is_shortened_where_it_was_left_open() {
        let made = within((-13.0, 13.0), 0.05, &Wishes::default()).unwrap();
        assert_eq!(made.shortened_from_s, Some(120.0));
        assert!(made.schedule.duration_s() < 120.0);
    }

    #[test]
    fn nothing_is_promised_where_the_log_has_not_been() {
        let logged =
            Logged { rest: 0.0, levels: vec![-1.0, 1.0], extent: (0.0, 20.0), settling: None };
        assert_eq!(reach((5.0, 60.0), Some(&logged)), Ok((5.0, 22.0)));
        assert!(matches!(reach((30.0, 60.0), Some(&logged)), Err(PlanError::Elsewhere { .. })));
        let near = TestRig { start: -20.0, ..rig(Some((-20.0, 20.0))) };
        let refused = plan(&Wishes::default(), &near, Some(&known(0.1)), None, 0);
        assert!(matches!(refused, Err(PlanError::Start { .. })));
    }
}
