//! Why a log could not be read: the row, the column, what was found and what is expected.

mod place;

use std::path::PathBuf;

use super::names::{did_you_mean, shown};
use super::trial::TrialError;

/// The column of a time, and mappings: of each joint its name, its input and its output.
type Likely = (Option<String>, Vec<Vec<[String; 3]>>);

/// Why a log, or one joint of it, could not be read.
///
/// `row` is the line of the file, counted from 1, as an editor shows it; where a file has no
/// lines, the number of the sample, and 0 stands for its header.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file cannot be opened or read.
    #[error("{}: cannot be read", path.display())]
    Io {
        /// The log.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is not a table of text.
    #[error("{}: not a CSV table", path.display())]
    Csv {
        /// The log.
        path: PathBuf,
        /// What the parser said.
        source: csv::Error,
    },
    /// The file is not what its name or its first bytes say, or it is damaged.
    #[error("{}: cannot be read as {format}: {reason}; {remedy}", path.display())]
    Format {
        /// The log.
        path: PathBuf,
        /// The format that was expected.
        format: &'static str,
        /// What is wrong.
        reason: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// The log would take more memory than it may.
    #[error(
        "{}: it would take {} of memory to read it, and {} are allowed; check that the file is \
         what it should be", path.display(), bytes(*needed), bytes(*limit)
    )]
    TooLarge {
        /// The log.
        path: PathBuf,
        /// Bytes that are needed at least.
        needed: u64,
        /// Bytes that are allowed.
        limit: u64,
    },
    /// This build cannot read the format.
    #[error(
        "{}: {format} is not in this build of tauscope; build it with `--features {feature}`",
        path.display()
    )]
    FormatLeftOut {
        /// The log.
        path: PathBuf,
        /// Its format.
        format: &'static str,
        /// The feature that reads it.
        feature: &'static str,
    },
    /// A column that is needed does not hold numbers.
    #[error(
        "{}, column `{column}`: it holds {found}, not numbers; choose another column, or write \
         it as numbers", path.display()
    )]
    NotNumbers {
        /// The log.
        path: PathBuf,
        /// The column.
        column: String,
        /// What it holds.
        found: String,
    },
    /// A column that is to name trials holds no label per row.
    #[error(
        "{}, column `{column}`: it holds {found}, not a label per row; save it as numbers or as a \
         cell array of texts, or read all as one trial with `--trial none`", path.display()
    )]
    NoLabels {
        /// The log.
        path: PathBuf,
        /// The column.
        column: String,
        /// What it holds.
        found: String,
    },
    /// A line may be a comment, or a row that begins with the label of its trial.
    #[error(
        "{}, row {row}: it begins with `{label}`, which may be a comment or the label of a trial; \
         write labels without `#`, and a blank behind the mark of a comment", path.display()
    )]
    LabelOrComment {
        /// The log.
        path: PathBuf,
        /// Line of the file.
        row: u64,
        /// The first cell.
        label: String,
    },
    /// Two columns that are needed differ in length.
    #[error(
        "{}: column `{column}` has {found} values but `{other}` has {expected}; choose columns \
         of one length", path.display()
    )]
    UnequalColumns {
        /// The log.
        path: PathBuf,
        /// The column.
        column: String,
        /// Its values.
        found: usize,
        /// A column before it.
        other: String,
        /// Values of that one.
        expected: usize,
    },
    /// The file holds nothing.
    #[error("{}: the file is empty; expected a header row and samples", path.display())]
    Empty {
        /// The log.
        path: PathBuf,
    },
    /// There is a header and no sample.
    #[error("{}: there is a header but no sample below it", path.display())]
    HeaderOnly {
        /// The log.
        path: PathBuf,
    },
    /// A folder holds no log.
    #[error("{}: no log in this folder; logs end in {endings}", path.display())]
    EmptyFolder {
        /// The folder.
        path: PathBuf,
        /// How the names of logs end.
        endings: String,
    },
    /// A folder holds no log, but folders within it do.
    #[error(
        "{}: no log in this folder, but in folders within it; name those, as `{}`", path.display(),
        first.display()
    )]
    OnlyFolders {
        /// The folder.
        path: PathBuf,
        /// The first of the folders within it.
        first: PathBuf,
    },
    /// A row has more or fewer cells than the header.
    #[error(
        "{}, row {row}: {found} cells, but the header has {expected}; give every row a cell per \
         column{}", path.display(), quotation_hint(*lines)
    )]
    UnequalRow {
        /// The log.
        path: PathBuf,
        /// Line of the file.
        row: u64,
        /// Cells found.
        found: usize,
        /// Cells of the header.
        expected: usize,
        /// Lines that the row takes up; more than one where a cell is quoted.
        lines: u64,
    },
    /// A quoted cell holds further rows.
    #[error(
        "{}, row {row}: a cell that begins with a quotation mark goes over {lines} lines, which look \
         like rows; close it, or remove the mark", path.display()
    )]
    OpenQuotation {
        /// The log.
        path: PathBuf,
        /// Line of the file.
        row: u64,
        /// Lines that the row takes up.
        lines: u64,
    },
    /// Two columns have the name that is looked for.
    #[error(
        "{}{}: two columns are named `{column}`; rename one of them", path.display(), header(*row)
    )]
    DuplicateColumn {
        /// The log.
        path: PathBuf,
        /// Line of the header.
        row: u64,
        /// The name they share.
        column: String,
    },
    /// The header is not UTF-8.
    #[error(
        "{}, row {row}, column {column}: the name is not UTF-8 text; choose UTF-8 when saving it",
        path.display()
    )]
    NotUtf8 {
        /// The log.
        path: PathBuf,
        /// Line of the header.
        row: u64,
        /// Number of the column, from 1.
        column: usize,
    },
    /// The name of a column or of a trial is longer than any name.
    #[error(
        "{}{}: the name `{start}` is longer than {most} bytes, the most of a name; shorten it",
        path.display(), header(*row)
    )]
    LongName {
        /// The log.
        path: PathBuf,
        /// Line of the name; 0 where the file has no lines.
        row: u64,
        /// How it begins.
        start: String,
        /// The most bytes of a name.
        most: usize,
    },
    /// Time is in a unit that is not known.
    #[error(
        "{}{}, column `{column}`: time in [{unit}] is not known; expected [s], [ms], \
         [us], [ns], [min] or no unit", path.display(), header(*row)
    )]
    TimeUnit {
        /// The log.
        path: PathBuf,
        /// Line of the header.
        row: u64,
        /// The column.
        column: String,
        /// Its unit.
        unit: String,
    },
    /// Two joints have the same name.
    #[error("{}: two joints are named `{joint}`; give each its own name", path.display())]
    DuplicateJoint {
        /// The log.
        path: PathBuf,
        /// The name they share.
        joint: String,
    },
    /// A joint is read with another, with which something is wrong.
    #[error("{}: it cannot be read, as joint `{other}`, whose output has the same clock", path.display())]
    AsOther {
        /// The log.
        path: PathBuf,
        /// The joint of which it is said what is wrong.
        other: String,
    },
    /// A joint has one column for two of its signals.
    #[error(
        "{}: joint `{joint}` has column `{column}` for its input and for its output; give each its own",
        path.display()
    )]
    OneColumn {
        /// The log.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// The column.
        column: String,
    },
    /// A column that is needed is not there.
    #[error(
        "{}{}: column `{column}` is missing{}; the columns are: {available}",
        path.display(), header(*row), did_you_mean(nearest.as_deref())
    )]
    MissingColumn {
        /// The log.
        path: PathBuf,
        /// Line of the header.
        row: u64,
        /// The name that was looked for.
        column: String,
        /// The column whose name is nearest.
        nearest: Option<String>,
        /// The names that are there.
        available: String,
    },
    /// No column belongs to a joint.
    #[error(
        "{}{}: no joint found; a joint needs the columns `<joint>.input` and \
         `<joint>.output`; the columns are: {available}", path.display(), header(*row)
    )]
    NoJoints {
        /// The log.
        path: PathBuf,
        /// Line of the header.
        row: u64,
        /// The names that are there.
        available: String,
        /// What names and data suggest, though not for sure: the column of the time, and the name, the
        /// input and the output of each joint, the likeliest of several mappings first.
        likely: Box<Likely>,
    },
    /// A joint that was asked for is not in the log.
    #[error(
        "{}: no joint `{joint}`{}; the joints are: {available}",
        path.display(), did_you_mean(nearest.as_deref())
    )]
    UnknownJoint {
        /// The log.
        path: PathBuf,
        /// The name that was asked for.
        joint: String,
        /// The joint whose name is nearest.
        nearest: Option<String>,
        /// The joints that are there.
        available: String,
    },
    /// The log has no time, and no sample period was given.
    #[error(
        "{}{}: no time column (`time_s`, `t_s`, `time` or `t`); found {available}",
        path.display(), header(*row)
    )]
    NoTime {
        /// The log.
        path: PathBuf,
        /// Line of the header.
        row: u64,
        /// The columns that are there.
        available: String,
        /// The first column, where it has the name that programs give to an index without one.
        index: Option<String>,
    },
    /// The sample period is none that a log can have.
    #[error("{}: a sample period of {seconds} s is not one from 1e-9 to 1e8 s", path.display())]
    BadPeriod {
        /// The log.
        path: PathBuf,
        /// What was given.
        seconds: f64,
    },
    /// A cell holds text where a number belongs.
    #[error("{}, row {row}, column `{column}`: `{}` is not a number{}", path.display(), shown(text), number_hint(text))]
    NotANumber {
        /// The log.
        path: PathBuf,
        /// Line of the file.
        row: u64,
        /// The column.
        column: String,
        /// What the cell holds.
        text: String,
    },
    /// Some cells have a decimal point, and others a comma.
    #[error(
        "{}, row {row}, column `{column}`: `{}` beside cells with the other decimal mark; write all \
         decimals with a point, and nothing between thousands", path.display(), shown(text)
    )]
    DecimalMarks {
        /// The log.
        path: PathBuf,
        /// Line of the file.
        row: u64,
        /// The column.
        column: String,
        /// What the cell holds.
        text: String,
    },
    /// A number whose comma or point may stand between thousands.
    #[error(
        "{}, row {row}, column `{column}`: `{}` may be a thousand and more, beside whole numbers \
         without such a mark, or have three decimals; write decimals with a point, and nothing between \
         thousands", path.display(), shown(text)
    )]
    Thousands {
        /// The log.
        path: PathBuf,
        /// Line of the file.
        row: u64,
        /// The column.
        column: String,
        /// What the cell holds.
        text: String,
    },
    /// A cell holds text where a time belongs.
    #[error(
        "{}, row {row}, column `{column}`: `{}` is neither a number nor a date and time of ISO \
         8601, as in 2026-03-01T09:59:50.125; write the times so, or leave them out", path.display(), shown(text)
    )]
    NotATime {
        /// The log.
        path: PathBuf,
        /// Line of the file.
        row: u64,
        /// The column.
        column: String,
        /// What the cell holds.
        text: String,
    },
    /// The first row holds numbers where names belong.
    #[error(
        "{}{}: the first row holds numbers, and no names of columns; write a header above it, as \
         in `time_s,boom.input,boom.output`", path.display(), header(*row)
    )]
    NoHeader {
        /// The log.
        path: PathBuf,
        /// Line of the row.
        row: u64,
    },
    /// A cell is infinite.
    #[error("{}, row {row}, column `{column}`: the value is infinite; remove the row or mend the value", path.display())]
    Infinite {
        /// The log.
        path: PathBuf,
        /// Line of the file.
        row: u64,
        /// The column.
        column: String,
    },
    /// A number is so large that its squares cannot be computed with.
    #[error(
        "{}, row {row}, column `{column}`: {value:e} is beyond what double precision can square; \
         write it in a larger unit, or leave the cell empty where it stands for nothing",
        path.display()
    )]
    BeyondPrecision {
        /// The log.
        path: PathBuf,
        /// Line of the file.
        row: u64,
        /// The column.
        column: String,
        /// What the cell holds.
        value: f64,
    },
    /// The numbers of a signal are so small that their squares cannot be computed with.
    #[error(
        "{}, column `{column}`: its largest number, {largest:e}, is below what double precision \
         can square; write it in a smaller unit",
        path.display()
    )]
    BelowPrecision {
        /// The log.
        path: PathBuf,
        /// The column.
        column: String,
        /// The largest magnitude in it.
        largest: f64,
    },
    /// A cell is empty or NaN.
    #[error(
        "{}, row {row}, column `{column}`: the cell is empty or NaN", path.display()
    )]
    Missing {
        /// The log.
        path: PathBuf,
        /// Line of the file.
        row: u64,
        /// The column.
        column: String,
    },
    /// Time does not increase.
    #[error(
        "{}, row {row}: time goes from {previous} s to {time} s, but it must increase; remove \
         the row if it is there twice, or mark a new trial in a `trial` column", path.display()
    )]
    TimeNotIncreasing {
        /// The log.
        path: PathBuf,
        /// Line of the file.
        row: u64,
        /// Time of the row before.
        previous: f64,
        /// Time of this row.
        time: f64,
    },
    /// Times that cannot be in the unit that is named or supposed.
    #[error(
        "{}, column `{column}`: its times would be {period} s apart, so that their unit must be \
         another; name it in the header, as in `{column} [ms]`, `[us]` or `[ns]`", path.display()
    )]
    WrongTimeUnit {
        /// The log.
        path: PathBuf,
        /// The column.
        column: String,
        /// The period in that unit, in seconds.
        period: f64,
    },
    /// Times that are in one unit, and from a row on in another.
    #[error(
        "{}, row {row}, column `{column}`: from here on the times are in another unit: `{time}` behind \
         `{before}`, and the steps between them are as many times as large; write all times in one unit",
        path.display()
    )]
    TimeUnitChanges {
        /// The log.
        path: PathBuf,
        /// Line of the first row in the other unit.
        row: u64,
        /// The column.
        column: String,
        /// The time in the row before.
        before: f64,
        /// The time in this row.
        time: f64,
    },
    /// Times that are so near to one another that they are of no clock.
    #[error(
        "{}, row {row}, column `{column}`: from here on samples come {period:e} s apart, and a \
         sample period is one from 1e-9 to 1e8 s; write the times in seconds, or in the unit that \
         the header names", path.display()
    )]
    NoPeriod {
        /// The log.
        path: PathBuf,
        /// Line of the file of the trial's first row.
        row: u64,
        /// The column.
        column: String,
        /// The period, in seconds.
        period: f64,
    },
    /// A time step differs from the median by more than 1 %.
    #[error(
        "{}, row {row}: this sample comes {step} s after the one before, but the period is \
         {period} s (median)", path.display()
    )]
    NotUniform {
        /// The log.
        path: PathBuf,
        /// Line of the file.
        row: u64,
        /// Time since the row before, in seconds.
        step: f64,
        /// Median time step, in seconds.
        period: f64,
    },
    /// The times are rounded to several periods, between which the samples are not even.
    #[error(
        "{}, row {row}: the times are rounded to {grain_s} s, in which some {:.0} samples come, but not \
         evenly: when each was measured is not known; write times with more digits",
        path.display(), grain_s / period
    )]
    CoarseTimes {
        /// The log.
        path: PathBuf,
        /// Line of the file where it is farthest from even.
        row: u64,
        /// What the times are rounded to, in seconds.
        grain_s: f64,
        /// The mean period, in seconds.
        period: f64,
    },
    /// The times are rounded so coarsely that no sample period follows from them.
    #[error(
        "{}, row {row}: the {rows} rows of this trial have only {stamps} different times, {grain_s} s \
         apart, from which no sample period follows; write times as 64-bit numbers or with more \
         digits", path.display()
    )]
    FewTimes {
        /// The log.
        path: PathBuf,
        /// Line of the file of the trial's first row.
        row: u64,
        /// Rows of the trial.
        rows: usize,
        /// Different times among them.
        stamps: usize,
        /// The least time between two that differ, in seconds.
        grain_s: f64,
    },
    /// The rows of one trial are not together.
    #[error(
        "{}, row {row}: trial `{trial}` starts again here after another one; keep the rows of a \
         trial together", path.display()
    )]
    TrialNotContiguous {
        /// The log.
        path: PathBuf,
        /// Line of the file.
        row: u64,
        /// Its label.
        trial: String,
    },
    /// A trial has a single row, so that it has no sample period.
    #[error(
        "{}, row {row}: trial `{trial}` has one row only, but needs two for a sample period",
        path.display()
    )]
    SingleRow {
        /// The log.
        path: PathBuf,
        /// Line of the file.
        row: u64,
        /// Its label.
        trial: String,
    },
    /// A row has no time.
    #[error("{}, row {row}, column `{column}`: the time is missing; remove the row or write it", path.display())]
    NoTimeInRow {
        /// The log.
        path: PathBuf,
        /// Line of the file.
        row: u64,
        /// The column.
        column: String,
    },
    /// A column that is needed holds no number at all.
    #[error("{}, column `{column}`: there is no number in it; choose another column", path.display())]
    NeverMeasured {
        /// The log.
        path: PathBuf,
        /// The column.
        column: String,
    },
    /// A trial would have more samples than can be handled.
    #[error(
        "{}: trial `{trial}` would have {samples:e} samples on a grid of {period} s; \
         check the times", path.display()
    )]
    TooManySamples {
        /// The log.
        path: PathBuf,
        /// Its label.
        trial: String,
        /// Samples it would have.
        samples: f64,
        /// Seconds between them.
        period: f64,
    },
    /// A joint has no usable sample.
    #[error("{}: joint `{joint}` has no usable sample", path.display())]
    NoSamples {
        /// The log.
        path: PathBuf,
        /// The joint.
        joint: String,
    },
    /// Each time has several values of an output, of several joints.
    #[error(
        "{}: each time stands in {size} rows, whose values in `{column}` lie far apart, as in a table \
         with a row for each joint; give each joint an input and an output column of its own", path.display()
    )]
    SeveralSeries {
        /// The log.
        path: PathBuf,
        /// The column.
        column: String,
        /// Rows of a time.
        size: usize,
    },
    /// Two logs give the same joint different units.
    #[error(
        "{}: joint `{joint}` is in [{found}] here but in [{expected}] in an earlier log",
        path.display()
    )]
    UnitsDiffer {
        /// The log.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// Units of this log.
        found: String,
        /// Units of the logs before.
        expected: String,
    },
    /// The samples do not make a trial.
    #[error("{}: joint `{joint}`", path.display())]
    Trial {
        /// The log.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// What is wrong with them.
        source: TrialError,
    },
}

/// A number of bytes for people: `1.5 GB`.
fn bytes(count: u64) -> String {
    match count as f64 {
        count @ 1e9.. => format!("{:.1} GB", count / 1e9),
        count @ 1e6.. => format!("{:.0} MB", count / 1e6),
        count => format!("{count} bytes"),
    }
}

/// Where a header stands, in a file that has lines.
fn header(row: u64) -> String {
    if row == 0 { String::new() } else { format!(", row {row}") }
}

fn number_hint(text: &str) -> &'static str {
    let decimal_comma = text.contains(',') && text.replace(',', ".").parse::<f64>().is_ok();
    if decimal_comma { "; write decimals with a point" } else { "; write a number, or none at all" }
}

fn quotation_hint(lines: u64) -> &'static str {
    if lines > 1 { "; is a quotation mark never closed?" } else { "" }
}
