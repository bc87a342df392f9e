//! A log of text that somebody else still writes: what has come is parsed once.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use sha2::{Digest as _, Sha256};

use super::error::ReadError;
use super::format::{GrowingRows, is_text};
use super::log::Log;
use super::memory::Budget;
use super::read::{Experiment, Failure, ReadOptions, laid_out};
use super::source::{Source, hashed};
use super::table::Wanted;

/// A log of text that grows at its end.
pub struct GrowingLog {
    path: PathBuf,
    options: ReadOptions,
    /// What has come behind the last whole line.
    rest: Vec<u8>,
    /// Of the whole lines.
    hasher: Sha256,
    bytes: u64,
    rows: GrowingRows,
}

impl std::fmt::Debug for GrowingLog {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("GrowingLog").field("path", &self.path).finish_non_exhaustive()
    }
}

impl GrowingLog {
    /// Whether the log at `path`, which starts with these bytes, is text.
    pub fn is_text(path: &Path, start: &[u8]) -> bool {
        is_text(path, start)
    }

    /// The log at `path`, of which nothing has come yet.
    pub fn new(path: &Path, options: ReadOptions) -> Self {
        let rows = GrowingRows::new(Budget::new(options.memory));
        Self {
            path: path.to_owned(),
            options,
            rest: Vec::new(),
            hasher: Sha256::new(),
            bytes: 0,
            rows,
        }
    }

    /// Takes in what has come; whether that made a line whole.
    pub fn push(&mut self, bytes: &[u8]) -> bool {
        let Some(end) = bytes.iter().rposition(|byte| *byte == b'\n') else {
            self.rest.extend_from_slice(bytes);
            return false;
        };
        let (whole, rest) = bytes.split_at(end + 1);
        self.rest.extend_from_slice(whole);
        self.hasher.update(&self.rest);
        self.bytes += self.rest.len() as u64;
        self.rows.push(&self.rest);
        self.rest.clear();
        self.rest.extend_from_slice(rest);
        true
    }

    /// Bytes of whole lines that were not parsed yet: those since the last look, and a row
    /// that is not whole or that is wrong.
    pub fn waiting(&self) -> usize {
        self.rows.waiting()
    }

    /// What the whole lines say: as [`Experiment::read`] would of a file that ends with them,
    /// but that a quotation which is still open is waited for.
    pub fn experiment(&mut self) -> Experiment {
        let mut experiment = Experiment { options: self.options.clone(), ..Experiment::default() };
        match self.look() {
            Ok(log) => experiment.add(log, &self.path),
            Err(error) => experiment.failures.push(Failure { joint: None, error }),
        }
        experiment
    }

    fn look(&mut self) -> Result<Experiment, ReadError> {
        let source = self.source();
        let path = || self.path.clone();
        let Some(head) = self.rows.head(&self.path)? else {
            return Err(ReadError::Empty { path: path() });
        };
        let head = &head;
        let (layout, mut found) = laid_out(head, &self.options)?;
        if layout.joints.is_empty() {
            found.sources.push(source);
            return Ok(found);
        }
        let numeric = layout.numeric_columns();
        let (label, time, clock) = (layout.trial, layout.time_column(), layout.clock());
        let wanted = Wanted { head, numeric: &numeric, label, time, clock };
        let table = self.rows.read(&wanted, source)?;
        if table.rows.is_empty() {
            return Err(ReadError::HeaderOnly { path: path() });
        }
        let budget = Budget::new(self.options.memory);
        let (table, how) = (Cow::Borrowed(table), (self.options.repair, None));
        found.add_log(Log::new(head, &layout, &numeric, table, &budget, how))?;
        Ok(found)
    }

    fn source(&self) -> Source {
        hashed(&self.path, self.hasher.clone(), self.bytes)
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use super::*;

    /// Everything that a text may have between its numbers.
    fn log(end: &str, before: &str, below: &str) -> Vec<u8> {
        let mut text = format!(
            "\u{feff}{before}# a log; of \"two joints\nt;trial;boom.input [V];boom.output [deg];note;stick.input;stick.output\n{below}"
        );
        for row in 0..60_u32 {
            let trial = if row < 35 { "first" } else { "\"the; second\"" };
            let note = ["", "plain", "\"two\nlines\"", "\"a \"\"b\"\"\""][row as usize % 4];
            let level = (row / 7) % 3;
            let time = 0.01 * f64::from(row);
            writeln!(text, "{time:.2};{trial};{level};{row}.5;{note};1;{row}e-1").unwrap();
            if row % 11 == 0 {
                text += "# a pause\n\n";
            }
        }
        text.replace('\n', end).into_bytes()
    }

    fn read(folder: &Path, whole: &[u8], options: &ReadOptions) -> Experiment {
        let path = folder.join("log.csv");
        std::fs::write(&path, whole).unwrap();
        Experiment::read(&[path], options)
    }

    fn failures(experiment: &Experiment) -> Vec<String> {
        experiment.failures.iter().map(|failure| failure.error.to_string()).collect()
    }

    /// Whether the last line stands in a quotation that is still open.
    fn is_open(whole: &[u8]) -> bool {
        let text = String::from_utf8_lossy(whole);
        let text = text.trim_start_matches('\u{feff}');
        let rows = text.lines().filter(|line| !line.starts_with('#'));
        rows.flat_map(str::chars).filter(|letter| *letter == '"').count() % 2 == 1
    }

    #[test]
    fn what_has_come_is_read_as_the_whole_file_would_be() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let one = ReadOptions { joints: vec!["stick".to_owned()], ..ReadOptions::default() };
        let all = ReadOptions::default;
        let spoken = "Recorded on Monday\nby the second shift\n\n";
        let padded = "Recorded on Monday;;;;;;\n;;;;;;\n";
        let cases = [
            ("\n", "", "", all()),
            ("\r\n", "", "", one),
            ("\n", spoken, "", all()),
            ("\n", padded, "s;;V;deg;;V;deg\n", all()),
        ];
        for (end, before, below, options) in cases {
            let text = log(end, before, below);
            for piece in [1, 3, 7, 40, 1000] {
                let mut growing = GrowingLog::new(&path, options.clone());
                let mut come = 0;
                for part in text.chunks(piece) {
                    come += part.len();
                    if !growing.push(part) {
                        continue;
                    }
                    let whole = &text[..come];
                    let whole = &whole[..=whole.iter().rposition(|byte| *byte == b'\n').unwrap()];
                    let found = growing.experiment();
                    if is_open(whole) {
                        continue;
                    }
                    let expected = read(folder.path(), whole, &options);
                    assert_eq!(failures(&found), failures(&expected), "{piece}");
                    assert_eq!(found.joints, expected.joints, "{piece}");
                    assert_eq!(found.sources, expected.sources);
                    // All of it was parsed, so that none of it is parsed again; but the header,
                    // as long as nothing stands below it.
                    assert!(growing.waiting() == 0 || found.joints.is_empty());
                }
                assert_eq!(growing.experiment().joints.len(), if end == "\n" { 2 } else { 1 });
            }
        }
    }

    #[test]
    fn words_below_the_table_wait_for_what_follows() {
        let folder = tempfile::tempdir().unwrap();
        let mut growing = GrowingLog::new(&folder.path().join("log.csv"), ReadOptions::default());
        let mut whole = "t,a.input,a.output\n0,1,2\n1,1,3\n2,0,3\n".to_owned();
        growing.push(whole.as_bytes());
        for more in ["end of the test,,\n", "\n", "stopped,by,hand\n", "3,0,4\n"] {
            growing.push(more.as_bytes());
            whole += more;
            let found = growing.experiment();
            let expected = read(folder.path(), whole.as_bytes(), &ReadOptions::default());
            assert_eq!(found.joints, expected.joints, "{whole}");
            assert_eq!(failures(&found), failures(&expected), "{whole}");
        }
    }

    #[test]
    fn a_row_that_is_wrong_is_as_wrong_the_next_time() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let start = "t,a.input,a.output\n0,1,2\n1,1,3\n";
        let mut options = ReadOptions::default();
        options.repair.as_it_stands = true;
        for wrong in ["2,1\n", "2,1,x\n", "2,inf,1\n", "0.5,1,1\n"] {
            let mut growing = GrowingLog::new(&path, options.clone());
            growing.push(start.as_bytes());
            assert!(growing.experiment().failures.is_empty());
            growing.push(wrong.as_bytes());
            let first = failures(&growing.experiment());
            growing.push(b"3,1,2\n");
            let text = format!("{start}{wrong}3,1,2\n");
            let expected = read(folder.path(), text.as_bytes(), &options);
            assert_eq!(first.len(), 1, "{wrong}");
            assert_eq!(failures(&growing.experiment()), failures(&expected));
        }
    }

    #[test]
    fn a_text_is_told_from_other_formats() {
        let is_text = |name: &str, start: &[u8]| GrowingLog::is_text(Path::new(name), start);
        assert!(is_text("log.csv", b"t,a") && is_text("log", b"") && is_text("LOG.TXT", b"#"));
        assert!(!is_text("log.mcap", b"t,a") && !is_text("log", b"PAR1"));
    }
}
