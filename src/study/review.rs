//! What persons say of decisions: a file of their verdicts, and what becomes of it.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use super::estimate::JointEstimate;
use super::sheet::{FileError, table_reader};
use crate::delay::{Decision, EstimateError, ReviewerVerdict};
use crate::experiment::{Joint, Trial, read_sheet};

/// Verdicts on decisions, in the order of their file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Review {
    rows: Vec<Reviewed>,
}

/// A verdict or a delay of one step, and what the reviewer was shown of it.
#[derive(Clone, Debug, PartialEq)]
struct Reviewed {
    joint: String,
    trial: String,
    i: usize,
    /// `None` where a delay is given without a verdict.
    accepted: Option<bool>,
    delay_s: Option<f64>,
    note: String,
    reviewer: String,
    shown: Shown,
}

/// The step as it was when it was reviewed, as far as the file says.
#[derive(Clone, Debug, Default, PartialEq)]
struct Shown {
    p: Option<usize>,
    verdict: Option<String>,
    delay_s: Option<f64>,
}

/// What is said of a file that is no table.
const UNREADABLE: &str = "the review cannot be read";

/// The columns of a review that must be there.
const COLUMNS: [&str; 7] = ["joint", "trial", "i", "verdict", "delay_s", "note", "reviewer"];

/// A row of the file; empty cells are none.
#[derive(Debug, Deserialize)]
struct Row {
    joint: String,
    trial: String,
    i: String,
    verdict: String,
    delay_s: String,
    note: String,
    reviewer: String,
    #[serde(default)]
    p: String,
    #[serde(default)]
    program_verdict: String,
    #[serde(default)]
    program_delay_s: String,
}

impl Review {
    /// Reads a review: a table with the columns `joint,trial,i,verdict,delay_s,note,reviewer`,
    /// and those further ones that a review sheet has, also as a spreadsheet program saves it again: in
    /// its encoding, with its delimiter and its decimal mark. Rows with neither a
    /// verdict nor a delay say nothing yet.
    ///
    /// # Errors
    /// [`FileError::Unreadable`] for a file that is no table or cannot be opened,
    /// [`FileError::Wrong`] for what is missing or makes no sense.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let table = FileError::unreadable(path, UNREADABLE);
        let text = read_sheet(path).map_err(|error| table(csv::Error::from(error)))?;
        Self::parse(text.trim_start_matches('\u{feff}'), path)
    }

    fn parse(text: &str, path: &Path) -> Result<Self, FileError> {
        let table = || FileError::unreadable(path, UNREADABLE);
        let mut reader = table_reader(text, None);
        let found = reader.headers().map_err(table())?.clone();
        if let Some(column) = COLUMNS.into_iter().find(|name| found.iter().all(|it| it != *name)) {
            let found = found.iter().collect::<Vec<_>>().join(", ");
            let problem = format!("a review needs a column `{column}`; found {found}");
            return Err(FileError::wrong(path, String::new(), problem));
        }
        let mut rows = Vec::new();
        for (record, line) in reader.records().zip(2..) {
            let record = record.map_err(table())?;
            let row: Row = record.deserialize(Some(&found)).map_err(table())?;
            rows.extend(row.parsed(path, line)?);
        }
        Ok(Self { rows })
    }

    /// Whether nothing is said.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Overrides the decisions of `estimates`, one per joint; what could not be applied, or is said
    /// of a decision that has changed since. Of two verdicts on one step the later one counts.
    pub fn apply(
        &self,
        joints: &[Joint],
        estimates: &mut [Result<JointEstimate, EstimateError>],
    ) -> Vec<String> {
        let mut notes = Vec::new();
        let mut seen: BTreeMap<(&str, &str, usize), &Reviewed> = BTreeMap::new();
        for row in &self.rows {
            if row.accepted.is_none() {
                let alone = |delay_s| {
                    row.note(&format!(
                        "a delay of {delay_s} s without a verdict: it is ignored; write `accepted` or \
                         `rejected` beside it"
                    ))
                };
                notes.extend(row.delay_s.map(alone));
                continue;
            }
            let key = (row.joint.as_str(), row.trial.as_str(), row.i);
            let before = seen.insert(key, row);
            let differs = |before: &&Reviewed| before.accepted != row.accepted;
            let twice = "there are two reviews that differ; the later one applies";
            notes.extend(before.filter(differs).map(|_| row.note(twice)));
            notes.extend(row.apply(joints, estimates));
        }
        notes
    }
}

/// No delay is longer: a day, in seconds.
const LONGEST_S: f64 = 86_400.0;

impl Row {
    fn parsed(self, path: &Path, line: u64) -> Result<Option<Reviewed>, FileError> {
        let wrong = |column: &str, got: &str, expected: &str| {
            let place = format!(", line {line}, column `{column}`");
            FileError::wrong(path, place, format!("`{got}`, expected {expected}"))
        };
        let number = |column, text: &str| match text {
            "" => Ok(None),
            // Where commas part the cells there is none in a number.
            _ => match text.replace(',', ".").parse::<f64>() {
                Ok(value) if value.abs() <= LONGEST_S => Ok(Some(value)),
                _ => Err(wrong(column, text, "seconds, as in 0.15, or nothing")),
            },
        };
        let count = |column, text: &str| match text.parse::<usize>() {
            Ok(value) if value > 0 => Ok(value),
            _ => Err(wrong(column, text, "a number from 1 up")),
        };
        let accepted = match self.verdict.to_lowercase().as_str() {
            "" if self.delay_s.is_empty() => return Ok(None),
            "" => None,
            "accepted" => Some(true),
            "rejected" => Some(false),
            _ => return Err(wrong("verdict", &self.verdict, "`accepted`, `rejected` or nothing")),
        };
        let shown = Shown {
            p: (!self.p.is_empty()).then(|| count("p", &self.p)).transpose()?,
            verdict: Some(self.program_verdict).filter(|verdict| !verdict.is_empty()),
            delay_s: number("program_delay_s", &self.program_delay_s)?,
        };
        Ok(Some(Reviewed {
            i: count("i", &self.i)?,
            delay_s: number("delay_s", &self.delay_s)?,
            joint: self.joint,
            trial: self.trial,
            accepted,
            note: self.note,
            reviewer: self.reviewer,
            shown,
        }))
    }
}

impl Reviewed {
    /// What a person should know of this verdict.
    fn note(&self, why: &str) -> String {
        let Self { joint, trial, i, .. } = self;
        format!("review of {joint}, trial {trial}, step {i}: {why}")
    }

    fn apply(
        &self,
        joints: &[Joint],
        estimates: &mut [Result<JointEstimate, EstimateError>],
    ) -> Option<String> {
        let of_name = joints.iter().zip(estimates).find(|(joint, _)| joint.name == self.joint);
        // A joint that was left out by choice or failed is said elsewhere.
        let (joint, estimate) = match of_name {
            Some((joint, Ok(estimate))) => (joint, estimate),
            Some((_, Err(_))) => return None,
            None => return Some(self.note("there is no such joint: it is ignored")),
        };
        let accepted = self.accepted?;
        let between = estimate.settings.interpolation;
        let trials = joint.trials.iter().zip(&mut estimate.trials);
        let mut trials = trials.filter_map(|(trial, found)| Some((trial, found.as_mut().ok()?)));
        let Some((trial, found)) = trials.find(|(trial, _)| trial.label() == self.trial) else {
            return Some(self.note("there is no such trial: it is ignored"));
        };
        let Some(decision) = found.decisions.iter().find(|known| known.number == self.i) else {
            let steps = found.decisions.len();
            return Some(self.note(&format!("the trial has {steps} steps only: it is ignored")));
        };
        let is = decision.input_step.sample;
        if let Some(was) = self.shown.p.filter(|was| *was != is) {
            return Some(self.note(&format!(
                "the step was at sample {was} and is at {is} now; the review is ignored, so \
                 review the step again"
            )));
        }
        let left_s = (trial.len() - is) as f64 * trial.period().seconds();
        let is_outside = |delay_s: &f64| !(0.0..=left_s).contains(delay_s);
        if let Some(delay_s) = self.delay_s.filter(is_outside) {
            return Some(self.note(&format!(
                "a delay of {delay_s} s lies outside the {left_s:.2} s from the step to the trial's \
                 end; the review is ignored"
            )));
        }
        let changed = self.changed(decision, trial);
        let verdict = ReviewerVerdict {
            accepted,
            delay: self.delay_s.map(|delay_s| delay_s / trial.period().seconds()),
            note: self.note.clone(),
            reviewer: self.reviewer.clone(),
        };
        found.review(self.i, verdict, between);
        changed.map(|why| self.note(&why))
    }

    /// What the program says otherwise than when the step was reviewed.
    fn changed(&self, decision: &Decision, trial: &Trial) -> Option<String> {
        let is = decision.program_verdict().to_string();
        if let Some(was) = self.shown.verdict.as_ref().filter(|was| **was != is) {
            return Some(format!(
                "the program's verdict was `{was}` and is `{is}` now; the review still applies, \
                 check it again"
            ));
        }
        let is = decision.program_delay().map(|delay| delay * trial.period().seconds());
        // The file has nanoseconds.
        let differs = |was: &f64| is.is_none_or(|is| (was - is).abs() > 1e-9);
        let was = self.shown.delay_s.filter(differs)?;
        let is = is.map_or_else(|| "none".to_owned(), |is| format!("{is:.4} s"));
        Some(format!(
            "the program's delay was {was:.4} s and is {is} now; the review still applies"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::{Condition, Method, Settings, Verdict};
    use crate::explain::Sequential;
    use crate::study::estimate_joints;
    use crate::units::SamplePeriod;

    const HEADER: &str = "joint,trial,i,verdict,delay_s,note,reviewer";

    fn parse(text: &str) -> Result<Review, FileError> {
        Review::parse(text, Path::new("review.csv"))
    }

    /// Three steps, each followed 12 samples later.
    fn joint() -> Joint {
        let input: Vec<f64> = (0..400).map(|k| f64::from(k / 100 % 2)).collect();
        let mut angle = 0.0;
        let late = |k: usize| if k < 12 { 0.0 } else { input[k - 12] };
        let output = (0..400).map(|k| {
            angle += late(k);
            angle
        });
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let output = output.collect();
        let trial = Trial::new("1", 0.0, period, input.clone(), output).unwrap();
        let (name, covariates) = ("boom".to_owned(), Vec::new());
        Joint { name, input_unit: None, output_unit: None, covariates, trials: [trial].into() }
    }

    fn reviewed(rows: &str) -> (Vec<Decision>, Vec<String>, Option<f64>) {
        let joints = [joint()];
        let settings = Settings { low_pass: None, ..Settings::of(Method::TWO_LINE) };
        let mut estimates = estimate_joints(&joints, &settings, || (), &Sequential);
        let notes = parse(rows).unwrap().apply(&joints, &mut estimates);
        let trial = estimates.remove(0).unwrap().trials.remove(0).unwrap();
        let tau = trial.profile.at(150);
        (trial.decisions, notes, tau)
    }

    #[test]
    fn a_sheet_may_be_as_a_spreadsheet_program_saves_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("review.csv");
        let plain = format!("{HEADER}\nboom,1,2,Accepted,0.25,größer,Ann\n");
        let expected = parse(&plain).unwrap();
        let parted = plain.replace(',', ";").replace("0.25", "0,25");
        let latin: Vec<u8> = parted.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
        let tabbed = format!("\u{feff}{}", plain.replace(',', "\t"));
        let wide: Vec<u8> = tabbed.encode_utf16().flat_map(u16::to_le_bytes).collect();
        for bytes in [plain.into_bytes(), parted.into_bytes(), latin, wide, tabbed.into_bytes()] {
            std::fs::write(&path, bytes).unwrap();
            assert_eq!(Review::read(&path).unwrap(), expected);
        }
        std::fs::write(&path, b"\x00\xff\x01\xfe").unwrap();
        assert!(Review::read(&path).is_err());
    }

    #[test]
    fn a_reviewer_overrides_the_conditions_and_the_delays_follow() {
        let (decisions, notes, tau) = reviewed(&format!("{HEADER}\nboom,1,1,rejected,,noise,Ann"));
        assert_eq!(notes, [""; 0]);
        assert_eq!(decisions[0].verdict(), Verdict::Rejected(Condition::Reviewer));
        assert_eq!(decisions[0].program_verdict(), Verdict::Accepted);
        assert_eq!(tau, None);
        let (decisions, _, tau) = reviewed(&format!("{HEADER}\nboom,1,1,accepted,0.15,,Ann"));
        assert!((decisions[0].accepted_delay().unwrap() - 15.0).abs() < 1e-9);
        assert!((tau.unwrap() - 15.0).abs() < 1e-9);
        assert!((decisions[0].program_delay().unwrap() - 15.0).abs() > 1.0);
    }

    #[test]
    fn a_changed_step_is_said_and_one_that_moved_is_not_applied() {
        let wide = format!("{HEADER},p,program_verdict,program_delay_s");
        let why = |row: &str| {
            let (decisions, notes, _) = reviewed(&format!("{wide}\n{row}"));
            let count =
                decisions.iter().filter(|decision| decision.reviewer_verdict.is_some()).count();
            (notes.into_iter().next().unwrap_or_default(), count)
        };
        for (row, said, applied) in [
            ("boom,1,1,rejected,,,Ann,101,accepted,", "", 1),
            ("boom,1,1,rejected,,,Ann,99,accepted,", "at sample 99 and is at 101", 0),
            ("boom,1,1,rejected,,,Ann,101,sse,", "was `sse` and is `accepted` now", 1),
            ("boom,1,1,rejected,,,Ann,101,,0.9", "delay was 0.9000 s and is 0.1", 1),
            ("boom,1,1,accepted,-0.1,,Ann,101,,", "lies outside", 0),
            ("boom,1,1,accepted,500,,Ann,101,,", "lies outside", 0),
            ("arm,1,1,rejected,,,Ann,,,", "no such joint", 0),
            ("boom,2,1,rejected,,,Ann,,,", "no such trial", 0),
            ("boom,1,9,rejected,,,Ann,,,", "has 3 steps only", 0),
            ("boom,1,1,,0.3,,Ann,101,,", "0.3 s without a verdict", 0),
        ] {
            let (why, count) = why(row);
            assert!(why.contains(said) && count == applied, "{row}: {why}");
        }
        let twice = format!("{wide}\nboom,1,1,rejected,,,A,,,\nboom,1,1,accepted,,,B,,,");
        let (decisions, notes, _) = reviewed(&twice);
        assert!(notes[0].contains("two reviews that differ"));
        assert_eq!(decisions[0].verdict(), Verdict::Accepted);
    }

    #[test]
    fn what_is_wrong_names_its_place() {
        let cell = |row: &str| match parse(&format!("{HEADER}\n{row}")) {
            Err(FileError::Wrong { place, .. }) => place,
            other => panic!("{other:?}"),
        };
        assert_eq!(cell("boom,1,x,accepted,,,"), ", line 2, column `i`");
        assert_eq!(cell("boom,1,1,perhaps,,,"), ", line 2, column `verdict`");
        assert_eq!(cell("boom,1,1,accepted,soon,,"), ", line 2, column `delay_s`");
        let missing = parse("joint,trial,i,verdict,delay_s,note\n");
        assert!(missing.is_err_and(|error| error.to_string().contains("a column `reviewer`")));
        let ragged = parse(&format!("{HEADER}\nboom,1\n"));
        assert!(matches!(ragged, Err(FileError::Unreadable { .. })));
        let empty = parse(&format!("{}\nboom;1;1;;;;\n", HEADER.replace(',', ";"))).unwrap();
        assert!(empty.is_empty(), "a row without a verdict says nothing");
    }
}
