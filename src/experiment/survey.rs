//! What the columns of a foreign log seem to be: the time, the trial, and which of the others
//! drives and measures which joint.

use std::path::{Path, PathBuf};

use super::columns::{ColumnMap, JointColumns};
use super::error::ReadError;
use super::format;
use super::layout::{find_time_column, find_trial};
use super::memory::{Budget, MemoryLimit};
use super::table::{Column, Head, Header};
use super::unit;

/// What a log's columns are taken for, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    /// The log.
    pub path: PathBuf,
    /// Each column, in the order of the file.
    pub columns: Vec<SurveyedColumn>,
    /// The mapping that follows; without joints where none can be told.
    pub map: ColumnMap,
    /// What could not be told.
    pub open: Vec<String>,
}

/// A column and what it is taken for.
#[derive(Clone, Debug, PartialEq)]
pub struct SurveyedColumn {
    /// Its name, as it stands in the file.
    pub name: String,
    /// Its unit, where the name or the header says it.
    pub unit: Option<String>,
    /// What it is taken for.
    pub role: Role,
    /// Why.
    pub why: String,
}

/// What a column is taken for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Role {
    /// The time of each row.
    Time,
    /// The name of each row's trial.
    Trial,
    /// What drives this joint.
    Input(String),
    /// What this joint does.
    Output(String),
    /// None of these.
    Other,
}

impl Survey {
    /// Looks at the log at `path`, with no more than `memory`.
    ///
    /// # Errors
    /// [`ReadError`] when it cannot be read at all.
    pub fn of(path: &Path, memory: MemoryLimit) -> Result<Self, ReadError> {
        let table = format::open(path, Budget::new(memory))?;
        let head = table.head.clone();
        if head.is_of_numbers() {
            return Err(ReadError::NoHeader { path: head.path, row: head.header_row });
        }
        let (time, trial) = (find_time_column(&head), find_trial(&head));
        let numeric: Vec<usize> = (0..head.headers.len()).filter(|i| Some(*i) != trial).collect();
        let clock = head.headers.first().map_or(0, |header| header.clock);
        let read = table.read(&numeric, trial, time, clock)?;
        let mut signals: Vec<Option<Signal>> = vec![None; head.headers.len()];
        for (column, index) in read.columns.iter().zip(&numeric) {
            if let Some(slot) = signals.get_mut(*index).filter(|_| Some(*index) != time) {
                *slot = Signal::of(column);
            }
        }
        let found = Found { head: &head, signals: &signals };
        let joints = found.joints();
        Ok(found.survey(time, trial, &joints))
    }
}

/// A column of numbers.
#[derive(Clone, Debug)]
struct Signal {
    values: Vec<f64>,
    /// Part of the samples at which it changes.
    changing: f64,
}

/// A signal that changes at fewer of its samples holds levels.
const HOLDS: f64 = 0.1;

impl Signal {
    fn of(column: &Column) -> Option<Self> {
        if column.error.is_some() || column.values.len() < 2 {
            return None;
        }
        let values = column.values.clone();
        let pairs = values.windows(2).filter(|pair| pair.iter().all(|value| !value.is_nan()));
        #[expect(clippy::float_cmp, reason = "whether a value is held")]
        let (all, changes) = pairs.fold((0_usize, 0_usize), |(all, changes), pair| {
            (all + 1, changes + usize::from(pair[0] != pair[1]))
        });
        (all > 0).then(|| Self { values, changing: changes as f64 / all as f64 })
    }

    fn is_constant(&self) -> bool {
        self.changing <= 0.0
    }

    fn says(&self) -> String {
        let percent = 100.0 * self.changing;
        match self.changing {
            0.0 => "it never changes".to_owned(),
            0.0..HOLDS => format!("it holds levels (changes at {percent:.1} % of the rows)"),
            _ => format!("it changes at {percent:.0} % of the rows"),
        }
    }
}

/// Words that name what drives a joint; the first ones are the likelier.
const INPUT_WORDS: [&str; 20] = [
    "u", "cmd", "command", "input", "duty", "valve", "pwm", "joystick", "lever", "spool",
    "control", "in", "drive", "current", "volt", "voltage", "stick", "servo", "throttle", "signal",
];
/// Words that name what a joint does.
const OUTPUT_WORDS: [&str; 22] = [
    "y",
    "angle",
    "pos",
    "position",
    "output",
    "q",
    "phi",
    "theta",
    "stroke",
    "displacement",
    "encoder",
    "length",
    "extension",
    "travel",
    "out",
    "speed",
    "velocity",
    "vel",
    "rate",
    "level",
    "height",
    "meas",
];
/// Words of neither, whatever else the name says.
const OTHER_WORDS: [&str; 16] = [
    "ref",
    "reference",
    "setpoint",
    "target",
    "desired",
    "sp",
    "pressure",
    "bar",
    "temp",
    "temperature",
    "error",
    "raw",
    "pilot",
    "torque",
    "force",
    "acc",
];

/// The words of a name in lower case: of `uBoom_duty (pct)` they are `u`, `boom`, `duty`, `pct`.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut lower = false;
    for letter in name.chars() {
        let parts = !letter.is_alphanumeric() || lower && letter.is_uppercase();
        if parts && words.last().is_some_and(|word| !word.is_empty()) {
            words.push(String::new());
        }
        if let Some(word) = words.last_mut().filter(|_| letter.is_alphanumeric()) {
            word.extend(letter.to_lowercase());
        }
        lower = letter.is_lowercase();
    }
    words.retain(|word| !word.is_empty());
    words
}

fn rank(words: &[String], known: &[&str]) -> Option<usize> {
    words.iter().filter_map(|word| known.iter().position(|known| known == word)).min()
}

/// A joint that was found, with the reasons.
struct FoundJoint {
    name: String,
    input: usize,
    output: usize,
    why: [String; 2],
}

struct Found<'a> {
    head: &'a Head,
    signals: &'a [Option<Signal>],
}

impl Found<'_> {
    fn words(&self, column: usize) -> Vec<String> {
        self.head.headers.get(column).map(|header| words(&header.name)).unwrap_or_default()
    }

    fn signal(&self, column: usize) -> Option<&Signal> {
        self.signals.get(column)?.as_ref().filter(|signal| !signal.is_constant())
    }

    /// Columns that move and whose names have one of these words, the likeliest first.
    fn named(&self, known: &[&str]) -> Vec<usize> {
        let ranked = |column: usize| {
            let words = self.words(column);
            self.signal(column)?;
            let other = rank(&words, &OTHER_WORDS).is_some();
            rank(&words, known).filter(|_| !other).map(|rank| (rank, column))
        };
        let mut found: Vec<_> = (0..self.head.headers.len()).filter_map(ranked).collect();
        found.sort_unstable();
        found.into_iter().map(|(_, column)| column).collect()
    }

    fn joints(&self) -> Vec<FoundJoint> {
        let native = self.native();
        if !native.is_empty() {
            return native;
        }
        let outputs = self.named(&OUTPUT_WORDS);
        let inputs: Vec<usize> = self
            .named(&INPUT_WORDS)
            .into_iter()
            .filter(|column| !outputs.contains(column))
            .collect();
        let mut joints: Vec<FoundJoint> = Vec::new();
        for &input in &inputs {
            let own = self.own_words(input);
            let shares = |output: &&usize| {
                let others = self.own_words(**output);
                let free = joints.iter().all(|joint| joint.output != **output);
                free && own.iter().any(|word| others.contains(word))
            };
            if let Some(&output) = outputs.iter().find(shares) {
                let others = self.own_words(output);
                let shared = own.iter().find(|word| others.contains(word));
                joints.push(self.joint(shared.cloned(), input, output));
            }
        }
        if joints.is_empty() && inputs.len() == 1 && !outputs.is_empty() {
            let output = self.follower(inputs[0], &outputs).or(outputs.first().copied());
            joints.extend(output.map(|output| self.joint(None, inputs[0], output)));
        }
        joints.retain(|joint| !self.is_doubtful(joint));
        if joints.is_empty() { self.by_data(&outputs).into_iter().collect() } else { joints }
    }

    /// Whether nothing but the little word `in` says that a joint's input is one: neither another
    /// word of its name, nor an output that follows it.
    fn is_doubtful(&self, joint: &FoundJoint) -> bool {
        let mut words = self.words(joint.input);
        words.retain(|word| word != "in");
        rank(&words, &INPUT_WORDS).is_none() && self.following(joint.input, joint.output).is_none()
    }

    /// Joints whose columns have native names.
    fn native(&self) -> Vec<FoundJoint> {
        let place = |name: &str| self.head.headers.iter().position(|header| header.name == name);
        let joint = |(input, header): (usize, &Header)| {
            let name = header.name.strip_suffix(".input")?;
            let output = place(&format!("{name}.output"))?;
            let why = ["its name ends in .input", "its name ends in .output"].map(str::to_owned);
            Some(FoundJoint { name: name.to_owned(), input, output, why })
        };
        self.head.headers.iter().enumerate().filter_map(joint).collect()
    }

    /// The words of a name that say which joint, and not what of it.
    fn own_words(&self, column: usize) -> Vec<String> {
        let mut words = self.words(column);
        let is_kind = |word: &String| {
            let word = word.as_str();
            INPUT_WORDS.contains(&word) && word != "stick"
                || OUTPUT_WORDS.contains(&word)
                || OTHER_WORDS.contains(&word)
                || unit::is_unit(word)
        };
        words.retain(|word| !is_kind(word));
        words
    }

    fn joint(&self, name: Option<String>, input: usize, output: usize) -> FoundJoint {
        let word = |column: usize, known: &[&str]| {
            let words = self.words(column);
            let found = rank(&words, known).and_then(|rank| known.get(rank).copied());
            found.map_or_else(String::new, |word| format!("`{word}` in its name; "))
        };
        let says = |column: usize| self.signal(column).map_or_else(String::new, Signal::says);
        let own = self.own_words(output).into_iter().chain(self.own_words(input)).next();
        let mut why = [
            format!("{}{}", word(input, &INPUT_WORDS), says(input)),
            format!("{}{}", word(output, &OUTPUT_WORDS), says(output)),
        ];
        if let Some(follows) = self.following(input, output) {
            let [_, output] = &mut why;
            *output = format!("{output}; its rate follows the input (correlation {follows:+.2})");
        }
        FoundJoint { name: name.or(own).unwrap_or_else(|| "joint".to_owned()), input, output, why }
    }

    /// The one of `outputs` whose rate follows `input` best.
    fn follower(&self, input: usize, outputs: &[usize]) -> Option<usize> {
        let follows = |&output: &usize| Some((self.following(input, output)?.abs(), output));
        let best = outputs.iter().filter_map(follows).max_by(|a, b| a.0.total_cmp(&b.0));
        best.map(|(_, output)| output)
    }

    /// Where names say nothing: what holds levels drives, what follows it best is driven.
    fn by_data(&self, outputs: &[usize]) -> Option<FoundJoint> {
        let all = 0..self.head.headers.len();
        let holds =
            |column: &usize| self.signal(*column).is_some_and(|signal| signal.changing < HOLDS);
        let held: Vec<usize> = all.clone().filter(holds).collect();
        let [input] = held.as_slice() else { return None };
        let moving = |column: &usize| column != input && self.signal(*column).is_some();
        let others: Vec<usize> = all.filter(moving).collect();
        let output = self.follower(*input, if outputs.is_empty() { &others } else { outputs })?;
        Some(self.joint(None, *input, output))
    }

    /// The correlation of the output's rate with the input some samples before, where it is
    /// clear.
    fn following(&self, input: usize, output: usize) -> Option<f64> {
        /// Rows over which a rate is taken, rows that a reaction may come late, and rows
        /// that are looked at.
        const OVER: usize = 5;
        const LATE: usize = 50;
        const ROWS: usize = 20_000;
        /// Correlation from which one follows the other.
        const CLEAR: f64 = 0.3;
        let (u, y) = (&self.signal(input)?.values, &self.signal(output)?.values);
        let rows = u.len().min(y.len()).min(ROWS);
        let at = |values: &[f64], k: usize| values.get(k).copied().unwrap_or(f64::NAN);
        let rate = |k: usize| at(y, k + OVER) - at(y, k);
        let correlation = |late: usize| {
            let pairs = (late..rows.saturating_sub(OVER)).map(|k| (at(u, k - late), rate(k)));
            correlation(pairs.filter(|(a, b)| a.is_finite() && b.is_finite()))
        };
        let lags = (0..LATE).step_by(OVER).map(correlation);
        let best = lags.max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        (best.abs() >= CLEAR).then_some(best)
    }

    fn survey(&self, time: Option<usize>, trial: Option<usize>, joints: &[FoundJoint]) -> Survey {
        let name = |column: usize| {
            self.head.headers.get(column).map_or_else(String::new, |header| header.text.clone())
        };
        let mut open = Vec::new();
        if time.is_none() {
            open.push(
                "no column is a time: name it, or give `sample_period` in seconds".to_owned(),
            );
        }
        if joints.is_empty() {
            open.push(
                "which columns drive and measure a joint cannot be told from names or data"
                    .to_owned(),
            );
        }
        let columns = 0..self.head.headers.len();
        let columns = columns.map(|column| self.column(column, time, trial, joints)).collect();
        let joint = |joint: &FoundJoint| {
            JointColumns::new(&joint.name, &name(joint.input), &name(joint.output))
        };
        let map = ColumnMap {
            time: time.map(name),
            trial: trial.map(name),
            sample_period_s: None,
            joints: joints.iter().map(joint).collect(),
            ..ColumnMap::default()
        };
        Survey { path: self.head.path.clone(), columns, map, open }
    }

    fn column(
        &self,
        column: usize,
        time: Option<usize>,
        trial: Option<usize>,
        joints: &[FoundJoint],
    ) -> SurveyedColumn {
        let header = self.head.headers.get(column);
        let (name, stated) = header
            .map_or_else(Default::default, |header| (header.text.clone(), header.unit.clone()));
        let bare = header.map_or("", |header| header.name.as_str());
        let mut unit = stated.or_else(|| unit::of_signal(bare));
        let of = |joint: &FoundJoint| {
            let [input, output] = joint.why.clone();
            match column {
                place if place == joint.input => Some((Role::Input(joint.name.clone()), input)),
                place if place == joint.output => Some((Role::Output(joint.name.clone()), output)),
                _ => None,
            }
        };
        let (role, why) = if Some(column) == time {
            unit = unit.or_else(|| unit::of_time(bare).map(str::to_owned));
            let taken =
                if unit.is_some() { "" } else { ", taken for seconds, or told by its size" };
            (Role::Time, format!("its name{taken}"))
        } else if Some(column) == trial {
            (Role::Trial, "its name".to_owned())
        } else if let Some(found) = joints.iter().find_map(of) {
            found
        } else {
            let says = self.signals.get(column).and_then(Option::as_ref).map(Signal::says);
            (Role::Other, says.unwrap_or_else(|| "it does not hold numbers".to_owned()))
        };
        SurveyedColumn { name, unit, role, why }
    }
}

/// Pearson's correlation; 0 of what does not vary.
fn correlation(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let pairs: Vec<(f64, f64)> = pairs.collect();
    let n = pairs.len().max(1) as f64;
    let (a, b) = pairs.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in pairs {
        xy += (x - a) * (y - b);
        xx += (x - a) * (x - a);
        yy += (y - b) * (y - b);
    }
    let scale: f64 = xx * yy;
    if scale > 0.0 { xy / scale.sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use super::*;

    /// A joint that integrates what its input was 10 rows before.
    fn log(header: &str) -> String {
        let level = |k: i32| [0, 3, 0, -2][(k / 60).rem_euclid(4) as usize];
        let mut angle = 0.0;
        let mut text = format!("{header}\n");
        for k in 0..600 {
            angle += 0.01 * f64::from(level(k - 10));
            let noise = f64::from(k * 7919 % 97) * 1e-4;
            writeln!(text, "{},{},{},{}", k * 10, level(k), angle + noise, 100.0 + noise).unwrap();
        }
        text
    }

    fn survey(header: &str) -> Survey {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        std::fs::write(&path, log(header)).unwrap();
        Survey::of(&path, MemoryLimit::default()).unwrap()
    }

    #[test]
    fn joints_are_told_by_names_or_by_what_follows_what() {
        for (header, name) in [
            ("time_ms,u_boom_duty,y_boom,p_bar", "boom"),
            ("time_ms,boom.input,boom.output,boom.pressure", "boom"),
            ("t_ms,cmdArm,angleArm,x", "arm"),
            ("t_ms,a,b,c", "b"),
        ] {
            let survey = survey(header);
            let names: Vec<&str> = header.split(',').collect();
            let expected = JointColumns::new(name, names[1], names[2]);
            assert_eq!(survey.map.joints, [expected], "{header}: {survey:#?}");
            assert_eq!(survey.map.time.as_deref(), Some(names[0]));
            assert!(survey.open.is_empty());
        }
    }

    #[test]
    fn what_cannot_be_told_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        std::fs::write(&path, "a,b\n1,5\n2,3\n3,9\n4,1\n").unwrap();
        let survey = Survey::of(&path, MemoryLimit::default()).unwrap();
        assert_eq!((survey.map.joints.len(), survey.open.len()), (0, 2), "{survey:#?}");
    }

    #[test]
    fn in_at_the_start_of_a_name_is_no_input_that_nothing_follows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let mut text = "seq,angle_start_cnt,in_traces\n".to_owned();
        for k in 0..200 {
            writeln!(text, "{k},{},{}", k * 7919 % 97, k / 60 % 2).unwrap();
        }
        std::fs::write(&path, text).unwrap();
        let survey = Survey::of(&path, MemoryLimit::default()).unwrap();
        assert_eq!(survey.map.joints, [], "{survey:#?}");
        assert_eq!(survey.open.len(), 2);
    }

    #[test]
    fn the_mapping_is_read_again() {
        let found = survey("time_ms,u_boom_duty,y_boom,p_bar");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.toml");
        std::fs::write(&path, found.map.to_toml()).unwrap();
        assert_eq!(ColumnMap::read(&path).unwrap(), found.map);
    }
}
