//! Random steps that suit a joint and keep it in its range, or why there are none.

use super::levels::{default_hold_s, default_largest, default_levels, settling_hold_s};
use super::logged::Logged;
use super::planned::{Plan, PlanRequest};
use super::predict::{TestRig, Uncertain};
use super::random::{RandomSteps, random_steps};
use super::refusal::PlanError;
use super::response::resting_band;
use super::trend::Travel;
use super::within_range::{Keeper, reach};

/// Length of an input where none is asked for, seconds.
pub(crate) const DURATION_S: f64 = 120.0;

/// Random steps for the joint number `index` of an experiment, of which `known` and `logged` are
/// known.
///
/// Without a range or a model these are [`random_steps`]. Else the joint stays in the part of the
/// range where its log has been, its prediction being off as far as its margin says; for that,
/// holds are made shorter and the largest levels are left out where nothing was asked for, and the
/// input is divided into trials, before each of which the joint is brought back to its start.
///
/// # Errors
/// [`PlanError`].
pub fn plan(
    request: &PlanRequest,
    rig: &TestRig,
    known: Option<&Uncertain>,
    logged: Option<&Logged>,
    index: usize,
) -> Result<Plan, PlanError> {
    let planner = Planner { request, rig, known, logged };
    let levels = planner.levels();
    if levels.len() < 2 {
        return Err(planner.settles_elsewhere().unwrap_or(PlanError::TooFewLevels));
    }
    let duration_s = request.duration_s.unwrap_or(DURATION_S);
    let hold_s = planner.hold_s(&levels);
    if hold_s.0 > duration_s {
        return Err(PlanError::HoldTooLong { hold_s: hold_s.0, duration_s });
    }
    let (Some(range), Some(known)) = (rig.range, known) else {
        let seed = request.seed;
        let steps = RandomSteps { levels, hold_s, duration_s, seed };
        let schedule = random_steps(&steps, rig, known, index);
        if schedule.holds().len() < 2 {
            return Err(PlanError::HoldTooLong { hold_s: hold_s.0, duration_s });
        }
        let prediction = known.map(|known| rig.prediction(known, &schedule));
        return Ok(Plan::new(schedule, prediction, hold_s));
    };
    if logged.is_some() && known.free_run.is_none() {
        return Err(PlanError::ErrorUnknown);
    }
    let within = reach(range, logged)?;
    let start = rig.start;
    if start <= within.0 || start >= within.1 {
        return Err(PlanError::Start { start, range: within });
    }
    let keeper = Keeper { request, rig, known, logged, index, duration_s };
    let tolerance = keeper.start_tolerance(range).unwrap_or(0.0);
    let planned = keeper.plan((within.0 + tolerance, within.1 - tolerance), &levels, hold_s);
    let one_sign = one_sign(&levels).filter(|_| planned.is_err() && request.levels.is_none());
    one_sign.map_or(planned, |is_positive| Err(PlanError::OneSign { range, is_positive }))
}

/// Whether `levels`, all of one sign or zero, are positive.
fn one_sign(levels: &[f64]) -> Option<bool> {
    let has = |sign: f64| levels.iter().any(|level| sign * level > 0.0);
    (has(1.0) != has(-1.0)).then(|| has(1.0))
}

/// What random steps are made from.
#[derive(Clone, Copy)]
struct Planner<'a> {
    request: &'a PlanRequest,
    rig: &'a TestRig,
    known: Option<&'a Uncertain>,
    logged: Option<&'a Logged>,
}

impl Planner<'_> {
    /// The levels that suit the joint, or are asked for.
    fn levels(&self) -> Vec<f64> {
        let PlanRequest { levels, largest, .. } = self.request;
        levels.clone().unwrap_or_else(|| match (largest, self.logged) {
            (None, Some(logged)) => self.logged_levels(logged),
            (Some(_), Some(logged)) => self.levels_of_its_signs(logged),
            _ => default_levels(self.model(), self.rig, self.largest()),
        })
    }

    /// The inputs between which the joint rests, where a model has such a band.
    fn resting_band(&self) -> Option<(f64, f64)> {
        resting_band(self.model()?, self.rig, self.largest())
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
        let mut levels = logged.beyond(self.resting_band().unwrap_or((0.0, 0.0)));
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
        (self.request.levels.is_none() && self.request.largest.is_none())
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
        let PlanRequest { levels, largest, .. } = self.request;
        let logged = self.logged.map(Logged::largest).filter(|largest| *largest > 0.0);
        let given = levels.as_ref().map(magnitude).or(*largest).or(logged);
        given.unwrap_or_else(|| default_largest(self.model(), self.rig))
    }

    fn hold_s(&self, levels: &[f64]) -> (f64, f64) {
        let largest = levels.iter().fold(0.0, |largest: f64, level| largest.max(level.abs()));
        let usual = || default_hold_s(self.model(), self.rig, largest);
        let settling = self.logged.and_then(|logged| logged.settling.as_ref());
        let usual = || settling.map_or_else(usual, |settling| settling_hold_s(settling.time_s));
        self.request.hold_s.unwrap_or_else(usual)
    }

    fn model(&self) -> Option<&crate::model::JointModel> {
        self.known.map(|known| &known.model)
    }
}

#[cfg(test)]
mod tests {
    use super::super::free_run::FreeRunError;
    use super::super::predict::tests::rig;
    use super::super::schedule::Schedule;
    use super::*;
    use crate::model::JointModel;

    /// A joint whose predictions were off by `per_second` after a second.
    fn known(per_second: f64) -> Uncertain {
        let free_run = Some(FreeRunError::growing(per_second));
        Uncertain { free_run, ..Uncertain::by_share(JointModel::integrator(10.0, 0.2), 0.0) }
    }

    fn within(
        range: (f64, f64),
        per_second: f64,
        request: &PlanRequest,
    ) -> Result<Plan, PlanError> {
        plan(request, &rig(Some(range)), Some(&known(per_second)), None, 0)
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
        let request = PlanRequest { duration_s: Some(60.0), seed: 4, ..PlanRequest::default() };
        let made = within((-30.0, 30.0), 0.1, &request).unwrap();
        let prediction = made.prediction.unwrap();
        assert_eq!(prediction.kept_until((-30.0, 30.0)), None);
        assert!(prediction.output.last().unwrap().abs() < 15.0);
        assert!(made.schedule.holds().last().unwrap().level.abs() < 1e-9);
        assert!((made.schedule.duration_s() - 60.0).abs() < 0.011);
        assert_eq!(made.schedule.levels(), [-2.0, -1.0, 0.0, 1.0, 2.0]);
    }

    #[test]
    fn what_one_trial_cannot_promise_several_do_and_each_starts_anew() {
        let asked = PlanRequest { duration_s: Some(120.0), ..PlanRequest::default() };
        let made = within((-13.0, 13.0), 0.05, &asked).unwrap();
        let trials = made.schedule.trials();
        assert!(trials.len() > 1 && (made.schedule.duration_s() - 120.0).abs() < 0.02);
        let prediction = made.prediction.unwrap();
        assert_eq!(prediction.kept_until((-13.0, 13.0)), None);
        assert_eq!(prediction.output.len(), made.schedule.samples());
        let starts = trials.iter().scan(0, |sample, trial| {
            let start = prediction.output[*sample];
            *sample += trial.samples();
            Some(start)
        });
        assert!(starts.fold(0.0_f64, |most, start| most.max(start.abs())) < 1e-9);
        for trial in &trials {
            let last = trial.holds().last().unwrap();
            assert!(trial.steps() >= 2 && last.level.abs() < 1e-9);
        }
        assert!(made.start_tolerance.is_some_and(|tolerance| (tolerance - 0.26).abs() < 1e-9));
    }

    #[test]
    fn no_trial_is_longer_than_the_runs_that_its_margin_is_made_of_allow() {
        // Nothing but the length of its runs, 10 s, speaks against 120 s in one.
        let asked = PlanRequest { duration_s: Some(120.0), ..PlanRequest::default() };
        let made = within((-40.0, 40.0), 0.001, &asked).unwrap();
        let longest = made.schedule.trials().iter().map(Schedule::duration_s).fold(0.0, f64::max);
        let trusted_s = FreeRunError::growing(0.001).trusted_s();
        assert!(longest <= trusted_s && 2.0 * longest > trusted_s, "{longest} of {trusted_s}");
    }

    #[test]
    fn what_cannot_be_kept_is_refused_with_a_remedy_that_does() {
        let asked =
            PlanRequest { duration_s: Some(20.0), trials: Some(1), ..PlanRequest::default() };
        let refused = refusal(within((-9.0, 9.0), 0.2, &asked));
        let PlanError::NotKept { why, .. } = &refused else { panic!("{refused}") };
        assert!((why.margin.unwrap() - 8.0).abs() < 1e-9);
        let shorter = PlanRequest { duration_s: why.shorter_s, ..asked.clone() };
        assert!(why.shorter_s.is_some() && within((-9.0, 9.0), 0.2, &shorter).is_ok());
        assert!(within(why.wider.unwrap(), 0.2, &asked).is_ok());
        assert!(refused.to_string().contains("-9 to 9 cannot be kept for 20 s"), "{refused}");
        let refused = refusal(within((-3.0, 3.0), 0.2, &PlanRequest::default()));
        assert!(refused.to_string().contains("nor in trials of"), "{refused}");
    }

    #[test]
    fn the_length_of_one_trial_is_shortened_where_it_was_left_open() {
        let one = PlanRequest { trials: Some(1), ..PlanRequest::default() };
        let made = within((-13.0, 13.0), 0.2, &one).unwrap();
        assert_eq!((made.shortened_from_s, made.schedule.trial_count()), (Some(120.0), 1));
        assert!(made.schedule.duration_s() < 120.0);
    }

    #[test]
    fn nothing_is_promised_where_the_log_has_not_been() {
        let logged =
            Logged { rest: 0.0, levels: vec![-1.0, 1.0], extent: (0.0, 20.0), settling: None };
        assert_eq!(reach((5.0, 60.0), Some(&logged)), Ok((5.0, 22.0)));
        assert!(matches!(reach((30.0, 60.0), Some(&logged)), Err(PlanError::Elsewhere { .. })));
        let near = TestRig { start: -20.0, ..rig(Some((-20.0, 20.0))) };
        let refused = plan(&PlanRequest::default(), &near, Some(&known(0.1)), None, 0);
        assert!(matches!(refused, Err(PlanError::Start { .. })));
    }
}
