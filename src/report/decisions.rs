//! What is said of a decision, and decisions in the order of their doubt: to add something to all
//! outputs, add it to [`DECISION`].

use serde_json::{Map, Value};

use super::facts::{self, Fact, Part, Place, UNSAID, Unit, fact, samples};
use super::{DataTable, EstimatedJoint, Kind, TextTable};
use crate::delay::{
    Candidate, Condition, Decision, Doubt, InputStep, Method, ReviewerVerdict, Settings, Verdict,
    doubts,
};
use crate::experiment::{Joint, Trial};
use crate::numerics::to_nanoseconds;
use crate::wording::{
    counted, doubt_percent, doubt_sentence, interval, number, remedy_text, samples_text,
    unit_suffix,
};
use Kind::{Real, Samples, Text, Whole};
use Part::{Json, Paper, People, Table};
use Place::{Doubtful, Recording, Report, Terminal};

/// Something that is said of a decision.
pub(crate) type DecisionFact = Fact<fn(&Doubted<'_>) -> Value>;

const TABLES: &[Place] = &[Terminal, Report, Doubtful, Recording];
const FIGURES: &[Place] = &[Report, Recording, Place::Verdict];
const ENDS: &[Place] = &[Report, Place::Verdict];
const SLOPES: &[Place] = &[Recording, Place::Verdict];
const SAID: &[Place] = &[Place::Verdict];

/// All of it, in the order of the columns. Sample numbers count from 1 within the trial.
#[rustfmt::skip]
pub(crate) const DECISION: &[DecisionFact] = &[
    fact("joint", Text, Paper, ("joint", "", Unit::None, &[Terminal]), |of| of.joint.joint.name.as_str().into()),
    fact("trial", Text, Paper, ("trial", "", Unit::None, TABLES), |of| of.trial.label().into()),
    fact("i", Whole, Paper, ("i", "step", Unit::None, TABLES), |of| of.decision.number.into()),
    fact("time", Real, People, ("time", "", Unit::Seconds, &[Doubtful]), |of| of.time_s().into()),
    fact("p", Whole, Paper, ("p", "input step", Unit::Sample, FIGURES), |of| of.p().into()),
    fact("input", Text, People, ("input", "", Unit::None, SAID), |of| of.input().into()),
    fact("hold", Whole, People, ("input keeps this level for", "", Unit::Samples, SAID), |of| of.decision.hold.into()),
    fact("r", Whole, Paper, ("r", "segment's first", Unit::Sample, ENDS), |of| of.decision.segment.first.into()),
    fact("end", Whole, Paper, ("end", "segment's last", Unit::Sample, ENDS), |of| of.decision.segment.last.into()),
    fact("candidates", Whole, Paper, ("candidates", "", Unit::None, SAID), |of| of.decision.candidates.len().into()),
    fact("f_opt", Whole, Paper, ("f", "best candidate", Unit::None, SAID), |of| of.best(|best| best.f)),
    fact("program_delta", Samples, People, ("program's δ", "", Unit::Samples, SAID), |of| samples(of.decision.delay_before_review())),
    fact("q", Samples, Paper, ("q", "breakpoint", Unit::Sample, FIGURES), |of| samples(of.decision.delay().map(|delay| of.p() as f64 + delay))),
    fact("delta", Samples, Paper, ("δ", "delay", Unit::Samples, &[Terminal, Report, Recording, Place::Verdict]), |of| samples(of.decision.delay())),
    fact("delta_s", Real, Paper, ("δ", "", Unit::Seconds, &[Report, Doubtful, Recording]), |of| of.delay_s(of.decision.delay()).into()),
    fact("sse", Real, Paper, ("SSE", "squared error of both lines", Unit::Output("²"), FIGURES), |of| of.best(|best| best.sse)),
    fact("slope_before", Real, Paper, ("slope before", "", Unit::Output("/sample"), SLOPES), |of| of.best(|best| best.before.slope)),
    fact("intercept_before", Real, Paper, UNSAID, |of| of.best(|best| best.before.intercept)),
    fact("slope_after", Real, Paper, ("slope after", "", Unit::Output("/sample"), SLOPES), |of| of.best(|best| best.after.slope)),
    fact("intercept_after", Real, Paper, UNSAID, |of| of.best(|best| best.after.intercept)),
    fact("interval", Text, People, ("interval", "", Unit::Samples, &[Terminal, Report]), |of| of.interval().into()),
    fact("bounds", Text, People, ("interval of δ", "", Unit::None, SAID), |of| of.bounds().into()),
    fact("verdict", Text, Paper, ("verdict", "", Unit::None, TABLES), |of| of.decision.verdict().to_string().into()),
    fact("failed", Text, Paper, UNSAID, |of| of.decision.failed().map(Condition::id).collect::<Vec<_>>().join(" ").into()),
    fact("method", Text, Table, UNSAID, |of| of.joint.estimate.settings.method.id().into()),
    fact("delta_low", Real, Table, UNSAID, |of| of.decision.fine.map(|fine| fine.low).into()),
    fact("delta_high", Real, Table, UNSAID, |of| of.decision.fine.map(|fine| fine.high).into()),
    fact("algorithm_1", Samples, People, ("Algorithm 1's δ", "", Unit::Samples, SAID), |of| of.of_algorithm_1().into()),
    fact("p_value", Real, Table, UNSAID, |of| of.p_value().into()),
    fact("runner_up_q", Whole, Table, UNSAID, |of| of.decision.runner_up().map(|second| second.breakpoint).into()),
    fact("runner_up_margin", Real, Table, UNSAID, |of| of.margin().into()),
    fact("accepted_with", Text, Table, ("accepted with", "", Unit::None, &[Report]), |of| of.remedies().into()),
    fact("near", Text, People, ("how near", "", Unit::None, &[Terminal, Place::Verdict]), |of| of.how_near().into()),
    fact("doubt", Real, Json, UNSAID, |of| of.doubt.value().into()),
    fact("doubt_percent", Text, People, ("doubt", "", Unit::None, &[Doubtful, Recording]), |of| doubt_percent(&of.doubt).into()),
    fact("why", Text, People, ("what speaks against it", "", Unit::None, &[Doubtful]), |of| of.why().into()),
    fact("flags", Text, Json, UNSAID, |of| of.doubt.flags.iter().map(|flag| flag.id()).collect()),
];

/// The facts of `found` up to `part`, by their ids.
fn object(found: &Doubted<'_>, part: Part) -> Map<String, Value> {
    facts::object(DECISION, part, found)
}

/// What is said of a decision in JSON.
pub(crate) fn decision_json(found: &Doubted<'_>) -> Map<String, Value> {
    object(found, Json)
}

/// The columns of `--decisions` that the paper defines, by their names, for each decision of a
/// joint, trial by trial; sample numbers count from 1 within the trial.
pub fn decision_rows(
    joint: EstimatedJoint<'_>,
) -> impl Iterator<Item = (&Decision, Map<String, Value>)> + '_ {
    doubted(joint).map(|found| (found.decision, object(&found, Paper)))
}

/// The columns of [`decision_table`] for decisions of the methods with these ids.
pub(crate) fn decision_columns<'a>(
    methods: impl Iterator<Item = &'a str>,
) -> impl Iterator<Item = (&'static str, Kind)> {
    facts::columns(DECISION, part_of(methods))
}

/// The paper defines all of the table where its method alone was run.
fn part_of<'a>(mut methods: impl Iterator<Item = &'a str>) -> Part {
    if methods.all(|id| id == Method::TWO_LINE.id()) { Paper } else { Table }
}

/// The decisions of all joints, those of one run of settings below those of another.
pub(crate) fn decision_table(runs: &[(&Settings, &[EstimatedJoint<'_>])]) -> DataTable {
    let part = part_of(runs.iter().map(|(settings, _)| settings.method.id()));
    let rows = runs.iter().flat_map(|(_, joints)| *joints).flat_map(|joint| doubted(*joint));
    facts::data_table(DECISION, part, rows)
}

/// The decisions `rows` as a person reads them at `place`, with the units of `joint`.
pub(crate) fn decision_text<'a>(
    place: Place,
    joint: Option<&Joint>,
    rows: impl Iterator<Item = Doubted<'a>>,
) -> TextTable {
    facts::text_table(DECISION, place, joint, rows)
}

/// A row per step, for the terminal.
pub(crate) fn steps_table(joints: &[EstimatedJoint<'_>]) -> String {
    let rows = joints.iter().flat_map(|joint| doubted(*joint));
    format!("{}\n", decision_text(Terminal, None, rows))
}

/// What the names in the table at `place` mean: `p: input step; q: breakpoint`.
pub(crate) fn decision_names(place: Place) -> String {
    let shown = DECISION.iter().filter(|fact| fact.is_shown(place) && !fact.meaning.is_empty());
    shown.map(Fact::explained).collect::<Vec<_>>().join("; ")
}

impl Doubted<'_> {
    /// What a person said of it.
    pub(super) fn said(&self) -> Option<&ReviewerVerdict> {
        self.decision.reviewer_verdict.as_deref()
    }

    /// The sample of the input step.
    fn p(&self) -> usize {
        self.decision.input_step.sample
    }

    /// The time of the input step, seconds.
    fn time_s(&self) -> f64 {
        self.trial.time_s(self.p())
    }

    /// The delay of Algorithm 1, where the answer is another one.
    fn of_algorithm_1(&self) -> Option<i64> {
        self.decision.breakpoint().filter(|_| self.decision.onset.is_some()).map(|best| best.delay)
    }

    /// What its conditions were checked with.
    fn output(&self) -> &[f64] {
        self.smoothed.unwrap_or(self.trial.output())
    }

    /// The levels of the input.
    fn input(&self) -> String {
        let (before, after) = (self.decision.input_step.before, self.decision.input_step.after);
        let unit = unit_suffix(self.joint.joint.input_unit.as_deref());
        format!("{}{unit} → {}{unit}", number(before), number(after))
    }

    /// Something of the best candidate.
    fn best<T: Into<Value>>(&self, of: impl Fn(Candidate) -> T) -> Value {
        self.decision.candidates.best().map(of).into()
    }

    /// A number of samples in seconds.
    pub(crate) fn delay_s(&self, samples: Option<f64>) -> Option<f64> {
        Some(to_nanoseconds(samples? * self.trial.period().seconds()))
    }

    /// The delay's interval: `11.2 … 12.9`, samples.
    fn interval(&self) -> Option<String> {
        self.decision.fine.map(|fine| interval((fine.low, fine.high)))
    }

    /// The interval in samples and in seconds, with its confidence.
    fn bounds(&self) -> Option<String> {
        let (fine, period_s) = (self.decision.fine?, self.trial.period().seconds());
        let seconds = interval((fine.low * period_s, fine.high * period_s));
        let percent = number(100.0 * fine.confidence);
        let samples = self.interval()?;
        Some(format!("{samples} samples = {seconds} s, at {percent} %"))
    }

    /// How often noise alone looks as much like a reaction; where tested.
    fn p_value(&self) -> Option<f64> {
        let mut checks = self.decision.checks.into_iter();
        checks.find(|check| check.condition == Condition::NothingHappened)?.value
    }

    /// By how much the squared error of the second-best breakpoint is larger, as a part of the best
    /// one's.
    fn margin(&self) -> Option<f64> {
        self.decision.runner_up().map(|second| second.margin).filter(|margin| margin.is_finite())
    }

    /// What would have accepted the step, all else being as it was.
    fn remedies(&self) -> String {
        let remedies = self.decision.remedies(&self.joint.estimate.settings, self.output());
        let remedies = remedies.into_iter().map(|remedy| remedy_text(remedy, ""));
        remedies.collect::<Vec<_>>().join("; ")
    }

    /// What would have accepted the step, or by how much the second-best breakpoint is worse.
    fn how_near(&self) -> Option<String> {
        if self.decision.verdict() != Verdict::Accepted {
            return Some(self.remedies());
        }
        let (margin, second) = self.margin().zip(self.decision.runner_up())?;
        Some(format!("SSE {} % above at q = {}", number(100.0 * margin), second.breakpoint))
    }

    /// What speaks against the decision.
    pub(super) fn why(&self) -> String {
        let verdict = self.decision.program_verdict();
        doubt_sentence(&self.doubt, verdict, self.trial.period().seconds())
    }
}

/// A decision with its doubt.
#[derive(Clone, Debug)]
pub(crate) struct Doubted<'a> {
    pub(crate) joint: EstimatedJoint<'a>,
    pub(crate) trial: &'a Trial,
    /// The output that the lines were fitted to; none where it is the measured one.
    pub(crate) smoothed: Option<&'a [f64]>,
    pub(crate) decision: &'a Decision,
    pub(crate) doubt: Doubt,
}

impl Doubted<'_> {
    /// Whether it is doubtful, and no person has judged it.
    pub(crate) fn is_open(&self) -> bool {
        self.doubt.is_doubtful() && self.decision.reviewer_verdict.is_none()
    }
}

/// All decisions on `joint` in their order, each with its doubt.
pub(super) fn doubted(joint: EstimatedJoint<'_>) -> impl Iterator<Item = Doubted<'_>> {
    joint.trials().flat_map(move |(trial, found)| {
        let smoothed = found.smoothed.as_deref();
        let all = doubts(&found.decisions, smoothed.unwrap_or(trial.output()));
        all.map(move |(decision, doubt)| Doubted { joint, trial, smoothed, decision, doubt })
    })
}

/// All decisions on `joints`, the most doubtful first; equally doubtful ones in their order.
pub(crate) fn by_doubt<'a>(joints: &[EstimatedJoint<'a>]) -> Vec<Doubted<'a>> {
    let mut all: Vec<_> = joints.iter().flat_map(|joint| doubted(*joint)).collect();
    all.sort_by(|a, b| b.doubt.value().total_cmp(&a.doubt.value()));
    all
}

/// The doubtful decisions of all joints in lines, the most doubtful first.
pub(crate) fn doubtful_lines(joints: &[EstimatedJoint<'_>]) -> Vec<String> {
    lines(&by_doubt(joints))
}

/// A line for each decision that is doubtful and on which no reviewer has judged, of all by doubt.
fn lines(all: &[Doubted<'_>]) -> Vec<String> {
    all.iter().filter(|found| found.is_open()).map(line).collect()
}

/// How many decisions are doubtful, and the most doubtful ones, a line each; nothing where none is.
pub(super) fn doubtful_text(joints: &[EstimatedJoint<'_>]) -> String {
    /// Decisions that are named.
    const MOST: usize = 3;
    let all = by_doubt(joints);
    let (steps, doubtful) = (all.len(), lines(&all));
    let are = match doubtful.len() {
        0 => return String::new(),
        1 => "is",
        _ => "are",
    };
    let said: String = doubtful.iter().take(MOST).flat_map(|line| ["  ", line, "\n"]).collect();
    let first = if doubtful.len() > MOST { "look first at" } else { "look at" };
    let is_reviewed = all.iter().any(|found| found.decision.reviewer_verdict.is_some());
    let open = if is_reviewed { " and not reviewed" } else { "" };
    let (count, all) = (doubtful.len(), counted(steps, "decision"));
    format!("{count} of {all} {are} doubtful{open}; {first}\n{said}")
}

/// Where a decision is, and what speaks against it.
fn line(found: &Doubted<'_>) -> String {
    let place = step_place(found.joint.joint, found.trial, found.decision);
    let (verdict, percent) = (found.decision.program_verdict(), doubt_percent(&found.doubt));
    format!("{place}: {verdict}, doubt {percent}: {}", found.why())
}

/// Where a step is: `boom, trial 2, step 3 at 12.4 s`, the trial where there are several.
pub(super) fn step_place(joint: &Joint, trial: &Trial, decision: &Decision) -> String {
    let several = joint.trials.len() > 1;
    let label = if several { format!(", trial {}", trial.label()) } else { String::new() };
    let time = number(trial.time_s(decision.input_step.sample));
    format!("{}{label}, step {} at {time} s", joint.name, decision.number)
}

/// One step in a line, as it is reported when it has come, with its trial where there are several.
pub(crate) fn step_line(joint: &Joint, trial: &Trial, decision: &Decision) -> String {
    let InputStep { before, after, .. } = decision.input_step;
    let unit = unit_suffix(joint.input_unit.as_deref());
    let (before, after) = (number(before), number(after));
    let step = format!("{}, {before} to {after}{unit}", step_place(joint, trial, decision));
    let Verdict::Rejected(condition) = decision.verdict() else {
        let samples = decision.delay().unwrap_or(0.0);
        let seconds = samples * trial.period().seconds();
        return format!("{step}: delay {seconds:.3} s ({})", samples_text(samples));
    };
    format!("{step}: rejected, {}", condition.id())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::{FirstLast, Method, Settings, estimate};
    use crate::units::SamplePeriod;

    #[test]
    fn a_step_is_one_line() {
        let level = |k: i32| f64::from(i32::from((100..200).contains(&k)));
        let input: Vec<f64> = (0..300).map(level).collect();
        let moved = |k: i32| 0.2 * f64::from((k - 112).clamp(0, 100));
        let output = (0..300).map(moved).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, input, output).unwrap();
        let first_last = FirstLast::Reject;
        let settings =
            Settings { low_pass: None, beta: 2, first_last, ..Settings::of(Method::TWO_LINE) };
        let kept = Settings { first_last: FirstLast::Keep, ..settings.clone() };
        let joint = |trials| Joint {
            name: "swing".to_owned(),
            input_unit: Some("V".to_owned()),
            output_unit: None,
            covariates: Vec::new(),
            trials,
        };
        let line = |settings, trials| {
            let found = estimate(&trial, settings).unwrap();
            step_line(&joint(trials), &trial, &found.decisions[0])
        };
        let accepted = "swing, step 1 at 1 s, 0 to 1 V: delay 0.120 s (12 samples)";
        assert_eq!(line(&kept, [trial.clone()].into()), accepted);
        let rejected = "swing, trial 1, step 1 at 1 s, 0 to 1 V: rejected, first_or_last";
        assert_eq!(line(&settings, [trial.clone(), trial.clone()].into()), rejected);
    }
}
