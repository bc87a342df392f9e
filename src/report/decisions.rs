//! What is said of a decision: to add something to all outputs, add it to [`DECISION`].

use serde_json::{Map, Value};

use super::doubt::doubted;
use super::facts::{self, Fact, Part, Place, UNSAID, Unit, fact, samples};
use super::text_table::TextTable;
use super::{DataTable, Doubted, EstimatedJoint, Kind};
use crate::delay::{Candidate, Condition, Decision, Method, ReviewerVerdict, Settings};
use crate::experiment::Joint;
use crate::numerics::to_nanoseconds;
use crate::wording::{doubt_percent, doubt_sentence, interval, number, remedy_text, unit_suffix};
use Kind::{Real, Samples, Text, Whole};
use Part::{Json, Paper, People, Table};
use Place::{Doubtful, Recording, Report, Terminal, Verdict};

/// Something that is said of a decision.
pub(crate) type DecisionFact = Fact<fn(&Doubted<'_>) -> Value>;

const TABLES: &[Place] = &[Terminal, Report, Doubtful, Recording];
const FIGURES: &[Place] = &[Report, Recording, Verdict];
const ENDS: &[Place] = &[Report, Verdict];
const SLOPES: &[Place] = &[Recording, Verdict];
const SAID: &[Place] = &[Verdict];

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
    fact("delta", Samples, Paper, ("δ", "delay", Unit::Samples, &[Terminal, Report, Recording, Verdict]), |of| samples(of.decision.delay())),
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
    fact("near", Text, People, ("how near", "", Unit::None, &[Terminal, Verdict]), |of| of.how_near().into()),
    fact("doubt", Real, Json, UNSAID, |of| of.doubt.value().into()),
    fact("doubt_percent", Text, People, ("doubt", "", Unit::None, &[Doubtful, Recording]), |of| doubt_percent(&of.doubt).into()),
    fact("why", Text, People, ("what speaks against it", "", Unit::None, &[Doubtful]), |of| of.why().into()),
    fact("flags", Text, Json, UNSAID, |of| of.doubt.flags.iter().map(|flag| flag.id()).collect()),
];

/// The facts of `found` up to `part`, by their ids.
fn object(found: &Doubted<'_>, part: Part) -> Map<String, Value> {
    facts::object(DECISION, part, |value| value(found))
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
    facts::data_table(DECISION, part, (rows, |value, found| value(found)))
}

/// The decisions `rows` as a person reads them at `place`, with the units of `joint`.
pub(crate) fn decision_text<'a>(
    place: Place,
    joint: Option<&Joint>,
    rows: impl Iterator<Item = Doubted<'a>>,
) -> TextTable {
    facts::text_table(DECISION, place, joint, (rows, |value, found| value(found)))
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
        if self.decision.verdict() != crate::delay::Verdict::Accepted {
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
