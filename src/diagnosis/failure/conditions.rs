//! The shortest conditions that hold most of the squared error in least of the time.

use std::fmt;

use super::axis::Axis;
use super::feature::Feature;
use super::grid::{Choice, Grid, Selection};
use super::record::{ResidualRecord, Row, Units};
use super::regions::trial_label;
use super::search::{DIGITS_COST, MIN_GAIN, Search};
use crate::numerics::to_digits;

/// Conditions that are named.
const MOST: usize = 3;

/// Common samples, as a share of those of either, above which two conditions say the same.
const SAME: f64 = 0.5;

/// How a feature is held against a bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// `<`
    Below,
    /// `>`
    Above,
    /// `>=`, where samples are at the bound.
    AtLeast,
    /// `=`
    Equal,
}

/// What a feature is held against.
#[derive(Clone, Debug, PartialEq)]
pub enum Bound {
    /// A number in the feature's unit.
    Number(f64),
    /// The label of a trial.
    Label(String),
}

/// One clause of a condition, such as `|input| < 1.2`.
#[derive(Clone, Debug, PartialEq)]
pub struct Clause {
    /// The feature.
    pub feature: Feature,
    /// The relation.
    pub relation: Relation,
    /// The bound.
    pub bound: Bound,
}

impl fmt::Display for Relation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Below => "<",
            Self::Above => ">",
            Self::AtLeast => ">=",
            Self::Equal => "=",
        })
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Label(label) => f.write_str(label),
        }
    }
}

impl fmt::Display for Clause {
    /// Without unit, as in files.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {}", self.feature, self.relation, self.bound)
    }
}

impl Clause {
    /// Whether it holds where its feature is `value`.
    fn holds(&self, record: &ResidualRecord, value: f64) -> bool {
        match (&self.bound, self.relation) {
            (Bound::Label(label), _) => trial_label(record, value) == label,
            (Bound::Number(bound), Relation::Below) => value < *bound,
            (Bound::Number(bound), Relation::Above) => value > *bound,
            (Bound::Number(bound), Relation::AtLeast) => value >= *bound,
            #[expect(clippy::float_cmp, reason = "a sign is a number that is set")]
            (Bound::Number(bound), Relation::Equal) => value == *bound,
        }
    }

    /// With the unit, as people read it.
    pub(crate) fn with_unit(&self, units: &Units) -> String {
        let unit = self.feature.unit(units).map_or_else(String::new, |unit| format!(" {unit}"));
        let Self { feature, relation, bound } = self;
        format!("{} {relation} {bound}{unit}", feature.in_words())
    }
}

/// A condition that holds more of the squared error than of the time.
#[derive(Clone, Debug, PartialEq)]
pub struct FailsWhere {
    /// One clause, or two joined by `and`; numbers in the units of the log, seconds.
    pub condition: String,
    /// Share of the samples for which it holds.
    pub share_of_time: f64,
    /// Share of the squared error that arises in them: of the error of the speed, where that
    /// is known, else of the residual.
    pub share_of_squared_error: f64,
    /// Whether it is of the error of the speed.
    pub of_speed: bool,
    /// Whether it was looked for in the error beside the speed, `e / v`: another one holds more of
    /// the error, which says no more than where the joint is fast.
    pub beside_speed: bool,
    /// Root mean square of their residuals, output units.
    pub rmse: f64,
    /// How often chance gives a condition as good, at most 0.01; see [`fails_where`].
    pub p_value: f64,
    /// The condition's clauses.
    pub clauses: Vec<Clause>,
    /// The samples for which it holds, counted from 0.
    pub samples: Vec<u32>,
}

impl FailsWhere {
    /// For people: `when |input| < 1.2 V: 88 % of the squared error of the speed, in 31 % of the
    /// time`.
    pub fn sentence(&self, units: &Units) -> String {
        format!("when {}: {}", self.condition(units), self.weight())
    }

    /// The one of several that holds the largest share of the squared error.
    pub(crate) fn strongest(all: &[Self]) -> Option<&Self> {
        all.iter().max_by(|a, b| a.share_of_squared_error.total_cmp(&b.share_of_squared_error))
    }

    /// The condition alone: `|input| < 1.2 V`.
    pub(crate) fn condition(&self, units: &Units) -> String {
        let clauses: Vec<_> = self.clauses.iter().map(|clause| clause.with_unit(units)).collect();
        clauses.join(" and ")
    }

    /// What it holds: `88 % of the squared error of the speed, in 31 % of the time`.
    pub(crate) fn weight(&self) -> String {
        let of = if self.of_speed { " of the speed" } else { "" };
        let (error, time) = (percent(self.share_of_squared_error), percent(self.share_of_time));
        let beside = if self.beside_speed {
            "; relative to the speed the error is largest there"
        } else {
            ""
        };
        format!("{error} of the squared error{of}, in {time} of the time{beside}")
    }
}

/// A share as a whole number of percent; with a decimal where that would be 0 or 100.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if (1.0..=99.0).contains(&percent) || percent <= 0.0 || percent >= 100.0 {
        format!("{percent:.0} %")
    } else {
        format!("{percent:.1} %")
    }
}

/// The conditions that hold most of the squared error in least of the time, the best first.
///
/// An error of an integrating joint stays for the rest of a hold, wherever it was made. What
/// is looked at is therefore the error `e` of the speed, where it is known; the residual
/// stands for it where not. A condition `S` is scored by its gain, of `n` samples:
///
/// ```text
/// J(S) = Σ_S e² / Σ e² - |S| / n = share of the squared error - share of the time
/// ```
///
/// It is the squared error in `S` beyond an even spread, as a share of all; so it grows
/// with every sample whose expected square is above the mean square, and `S` ends where
/// the error falls to its mean. Covering more and being sharper count alike (weighted
/// relative accuracy in subgroup discovery). A second clause must add 0.05, and a gain
/// below 0.1 is not reported.
///
/// All conditions of one clause, of an interval, and of one clause each on two features
/// are scored. Thresholds part the levels of a feature, or are near 32 quantiles; those
/// of the best are then moved between the next ones, if that adds 0.01. The best one is
/// compared with shuffled records, which keep the residual's correlation; its second clause is so
/// among the samples of the first. A condition that chance would
/// match in more than 1 % of them is dropped: of a white or a correlated residual of
/// even size no condition is found. The next condition is looked for in the samples
/// that those before it do not hold, so that each shows another failure; one that
/// shares more than half of its samples with one before is dropped.
///
/// A gain that is wrong everywhere makes the larger error where the joint is faster. Where
/// the first condition has no larger a share of the squared error than of the squared speed,
/// it says no more than that; then the condition on one feature on which the relative error
/// `e / v` depends most, among the samples of the first, is put before it.
///
/// The shuffles keep correlation over up to a fortieth of the record. A residual that wanders
/// more slowly, as that of a free run without restarts does, may be reported by chance.
///
/// # References
/// N. Lavrač, P. Flach, B. Zupan, "Rule evaluation measures: a unifying view", ILP-99
/// (the gain); J. H. Friedman, N. I. Fisher, "Bump hunting in high-dimensional data",
/// Statistics and Computing 9 (1999), 123-143 (covering one after the other).
pub fn fails_where(record: &ResidualRecord) -> Vec<FailsWhere> {
    let Some(shares) = record.shares_of_what_arises() else { return Vec::new() };
    let search = Search::new(record, shares);
    let mut rows: Vec<Row> = record.rows().collect();
    let mut found: Vec<FailsWhere> = Vec::new();
    for _ in 0..MOST {
        let Some((choice, p_value)) = search.best(&rows) else { break };
        let sharp = search.sharpened(record, &choice, &rows);
        let (grid, choice) = sharp.as_ref().map_or((search.grid(), &choice), |(g, c)| (g, c));
        let new = grid.members(&choice.selections, rows.iter().copied());
        if search.gain(&new) < MIN_GAIN {
            break;
        }
        let exact = grid.members(&choice.selections, record.rows());
        // Covering: the next one is looked for in the remaining samples.
        rows.retain(|row| new.binary_search(row).is_err());
        let (clauses, samples) = in_few_digits(record, &search, grid, choice, &exact);
        if found.iter().all(|other| overlap(&other.samples, &samples) <= SAME) {
            found.push(report(record, &search, clauses, samples, p_value));
        }
    }
    match found.first().filter(|first| search.only_moves(record, &first.samples)) {
        Some(first) => beside_motion(record, &search, first).into_iter().chain(found).collect(),
        None => found,
    }
}

/// The condition on which the relative error depends most where the joint moves, which is
/// all that `moving` says.
fn beside_motion(
    record: &ResidualRecord,
    search: &Search,
    moving: &FailsWhere,
) -> Option<FailsWhere> {
    let relative = search.relative(record, &moving.samples)?;
    let (choice, p_value) = relative.best_on_one_feature(&moving.samples)?;
    let inside = relative.grid().members(&choice.selections, moving.samples.iter().copied());
    if relative.gain_among(&moving.samples, &inside) < MIN_GAIN {
        return None;
    }
    let exact = relative.grid().members(&choice.selections, record.rows());
    let (clauses, samples) = in_few_digits(record, search, relative.grid(), &choice, &exact);
    let is_new = overlap(&moving.samples, &samples) <= SAME;
    let found = || report(record, search, clauses, samples, p_value);
    is_new.then(|| FailsWhere { beside_speed: true, ..found() })
}

/// The clauses of `choice` with bounds of three digits, or up to six where fewer would be
/// another condition, and the samples for which these hold. Where even six do not do, as
/// within values that are all but equal, those of them that gain most.
fn in_few_digits(
    record: &ResidualRecord,
    search: &Search,
    grid: &Grid,
    choice: &Choice,
    exact: &[Row],
) -> (Vec<Clause>, Vec<Row>) {
    let said = |digits: &dyn Fn(f64) -> f64| -> Vec<Clause> {
        let selections = choice.selections.iter();
        selections.flat_map(|one| clauses(record, &grid.axes[one.axis], *one, digits)).collect()
    };
    // Rounded bounds are another condition; one with as much gain says the same.
    let wanted = search.gain(exact);
    // One set of samples at a time: each may be as long as the log.
    let mut most: Option<(Vec<Clause>, Vec<Row>, f64)> = None;
    for digits in 3..=6 {
        let clauses = said(&|cut| to_digits(cut, digits));
        let samples = holding(record, &clauses);
        let gain = search.gain(&samples);
        let is_near = (gain - wanted).abs() < DIGITS_COST;
        if is_near || most.as_ref().is_none_or(|(.., most)| gain >= *most) {
            most = Some((clauses, samples, gain));
        }
        if is_near {
            break;
        }
    }
    most.map_or_else(Default::default, |(clauses, samples, _)| (clauses, samples))
}

fn report(
    record: &ResidualRecord,
    search: &Search,
    clauses: Vec<Clause>,
    samples: Vec<Row>,
    p_value: f64,
) -> FailsWhere {
    let texts: Vec<_> = clauses.iter().map(Clause::to_string).collect();
    FailsWhere {
        condition: texts.join(" and "),
        share_of_time: samples.len() as f64 / record.len() as f64,
        share_of_squared_error: search.share(&samples),
        of_speed: !record.samples().speed_error.is_empty(),
        beside_speed: false,
        rmse: record.rmse_of(samples.iter().copied()),
        p_value,
        clauses,
        samples,
    }
}

/// Common samples, as a share of those of either (Jaccard); both ascending.
fn overlap(a: &[Row], b: &[Row]) -> f64 {
    let common = a.iter().filter(|row| b.binary_search(row).is_ok()).count();
    common as f64 / (a.len() + b.len() - common).max(1) as f64
}

/// The samples for which all of `clauses` hold.
fn holding(record: &ResidualRecord, clauses: &[Clause]) -> Vec<Row> {
    let holds = |row: Row, clause: &Clause| {
        let value = clause.feature.value(record.samples(), row as usize);
        value.is_some_and(|value| clause.holds(record, value))
    };
    record.rows().filter(|row| clauses.iter().all(|clause| holds(*row, clause))).collect()
}

/// A selection in words, its bounds as `digits` makes them.
fn clauses(
    record: &ResidualRecord,
    axis: &Axis,
    Selection { span, .. }: Selection,
    digits: &dyn Fn(f64) -> f64,
) -> Vec<Clause> {
    let feature = axis.feature;
    let (from, to) = (usize::from(span.from), usize::from(span.to));
    if feature.has_kinds() {
        let level = axis.levels.as_ref().and_then(|levels| levels.get(from)).copied();
        return level.map(|level| kind(record, feature, level)).into_iter().collect();
    }
    let lower = from.checked_sub(1).and_then(|cut| axis.cuts.get(cut)).map(|&cut| {
        let cut = digits(cut);
        let touched =
            feature.values(record.samples()).any(|value| value.partial_cmp(&cut) == Some(EQUAL));
        let relation = if touched { Relation::AtLeast } else { Relation::Above };
        Clause { feature, relation, bound: Bound::Number(cut) }
    });
    let upper = axis.cuts.get(to - 1).map(|&cut| Clause {
        feature,
        relation: Relation::Below,
        bound: Bound::Number(digits(cut)),
    });
    lower.into_iter().chain(upper).collect()
}

const EQUAL: std::cmp::Ordering = std::cmp::Ordering::Equal;

/// A trial, or a direction.
fn kind(record: &ResidualRecord, feature: Feature, level: f64) -> Clause {
    let relation = match feature {
        Feature::Direction if level < 0.0 => Relation::Below,
        Feature::Direction if level > 0.0 => Relation::Above,
        _ => Relation::Equal,
    };
    let bound = match feature {
        Feature::Trial => Bound::Label(trial_label(record, level).to_owned()),
        _ => Bound::Number(0.0),
    };
    Clause { feature, relation, bound }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_has_units_and_whole_percents() {
        let clause =
            |feature, relation, number| Clause { feature, relation, bound: Bound::Number(number) };
        let found = FailsWhere {
            condition: String::new(),
            share_of_time: 0.314,
            share_of_squared_error: 0.879,
            of_speed: true,
            beside_speed: false,
            rmse: 1.3,
            p_value: 0.005,
            clauses: vec![
                clause(Feature::AbsInput, Relation::Below, 1.2),
                clause(Feature::Speed, Relation::AtLeast, -3.0),
            ],
            samples: Vec::new(),
        };
        let units = Units { input: Some("V".into()), output: Some("deg".into()) };
        let expected = "when |input| < 1.2 V and speed >= -3 deg/s: 88 % of the squared error of the \
                        speed, in 31 % of the time";
        assert_eq!(found.sentence(&units), expected);
        assert_eq!([0.004, 0.996, 0.0, 1.0].map(percent), ["0.4 %", "99.6 %", "0 %", "100 %"]);
    }

    /// A residual that is large for the first part of `output`.
    fn failing(output: Vec<f64>, part: usize) -> ResidualRecord {
        let samples = output.len();
        let size = |k: usize| if k < part { 5.0 } else { 0.1 };
        let sign = |k: usize| if k * 7919 % 13 < 6 { -1.0 } else { 1.0 };
        let samples = super::super::Samples {
            residual: (0..samples).map(|k| size(k) * sign(k)).collect(),
            input: vec![1.0; samples],
            output,
            speed: vec![1.0; samples],
            since_step_s: vec![0.0; samples],
            hold_s: vec![1.0; samples],
            time_s: vec![0.0; samples],
            trial: vec![0; samples],
            speed_error: Vec::new(),
        };
        let all = 0..samples.residual.len();
        ResidualRecord::new(samples, vec!["1".to_owned()], vec![all]).unwrap()
    }

    #[test]
    fn the_shares_are_those_of_the_condition_as_it_is_said() {
        // A quantile near the end of the failure lies where samples are dense.
        let dense = |k: usize| 12.345 + 1e-6 * k as f64;
        let at = |k: usize| if (1100..1300).contains(&k) { dense(k) } else { k as f64 / 100.0 };
        let record = failing((0..4000).map(at).collect(), 1230);
        let found = fails_where(&record);
        let bound: f64 = found[0].condition.strip_prefix("output < ").unwrap().parse().unwrap();
        let below = record.samples().output.iter().filter(|output| **output < bound).count();
        assert_eq!(found[0].samples.len(), below);
        assert!((found[0].share_of_time - below as f64 / 4000.0).abs() < 1e-12);
    }

    #[test]
    fn bounds_have_no_more_digits_than_matter() {
        let record = failing((0..4000).map(|k| f64::from(k) / 100.0).collect(), 1230);
        let search = Search::new(&record, record.shares_of_what_arises().unwrap());
        // The grid's own thresholds have all digits.
        let choice = search.best_on_one_feature(&record.rows().collect::<Vec<_>>()).unwrap().0;
        let exact = search.grid().members(&choice.selections, record.rows());
        let (clauses, samples) = in_few_digits(&record, &search, search.grid(), &choice, &exact);
        assert_eq!(samples, holding(&record, &clauses));
        assert!(clauses[0].to_string().len() <= "output < 12.3".len(), "{}", clauses[0]);
        assert!((search.gain(&samples) - search.gain(&exact)).abs() < DIGITS_COST);
        // Levels that only the fifth digit parts.
        let near = |k| if k < 2000 { 12.3451 } else { 12.3459 };
        let found = fails_where(&failing((0..4000).map(near).collect(), 2000));
        assert_eq!(found[0].condition, "output < 12.3455");
    }

    #[test]
    fn overlap_is_what_is_common_to_what_is_in_either() {
        assert!((overlap(&[1, 2, 3], &[2, 3, 4]) - 0.5).abs() < 1e-15);
        assert!(overlap(&[], &[]).abs() < 1e-15);
    }
}
