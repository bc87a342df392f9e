//! A log that is spoilt, the folder it is in, and what the program says of it.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

/// Words of which a message needs one to say what to do.
const REMEDIES: [&str; 12] = [
    "`--", "remove", "rename", "mend", "correct", "give", "mark", "choose", "check", "write",
    "expected", "needs",
];

/// A log at 100 Hz whose joints step every 60 samples and follow 15 samples later.
///
/// Lines are counted as an editor does: the header is line 1.
#[derive(Clone)]
pub(crate) struct Log {
    pub(crate) lines: Vec<Vec<String>>,
}

impl Log {
    pub(crate) fn of(joints: &[&str]) -> Self {
        let mut header = vec!["time_s".to_owned()];
        header.extend(joints.iter().flat_map(|j| [format!("{j}.input"), format!("{j}.output")]));
        let mut lines = vec![header];
        let mut angles = vec![0.0; joints.len()];
        for k in 0..300_u32 {
            let mut cells = vec![seconds(f64::from(k) * 0.01)];
            for (angle, gain) in angles.iter_mut().zip(1_u32..) {
                *angle += 0.1 * f64::from(gain) * level(k.saturating_sub(15));
                cells.extend([level(k).to_string(), format!("{angle:.3}")]);
            }
            lines.push(cells);
        }
        Self { lines }
    }

    pub(crate) fn samples(mut self, count: usize) -> Self {
        self.lines.truncate(count + 1);
        self
    }

    pub(crate) fn cell(mut self, line: usize, column: &str, text: &str) -> Self {
        let place = self.place(column);
        text.clone_into(&mut self.lines[line - 1][place]);
        self
    }

    pub(crate) fn column(mut self, column: &str, value: impl Fn(usize) -> String) -> Self {
        let place = self.place(column);
        for (k, cells) in self.lines.iter_mut().skip(1).enumerate() {
            cells[place] = value(k);
        }
        self
    }

    pub(crate) fn without(mut self, column: &str) -> Self {
        let place = self.place(column);
        for cells in &mut self.lines {
            cells.remove(place);
        }
        self
    }

    pub(crate) fn renamed(self, from: &str, to: &str) -> Self {
        self.cell(1, from, to)
    }

    pub(crate) fn cells(mut self, line: usize, count: usize) -> Self {
        self.lines[line - 1].resize(count, "0".to_owned());
        self
    }

    pub(crate) fn place(&self, column: &str) -> usize {
        self.lines[0].iter().position(|name| name == column).unwrap()
    }

    pub(crate) fn text(&self) -> String {
        self.lines.iter().map(|cells| cells.join(",") + "\n").collect()
    }
}

fn level(sample: u32) -> f64 {
    [0.0, 1.0, -1.0, 0.5][(sample + 30) as usize / 60 % 4]
}

pub(crate) fn seconds(time: f64) -> String {
    format!("{time:.4}")
}

/// A folder of its own, in which the program runs.
pub(crate) struct Workspace {
    folder: TempDir,
}

impl Workspace {
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn with(self, name: &str, text: impl AsRef<[u8]>) -> Self {
        fs::write(self.path(name), text).unwrap();
        self
    }

    pub(crate) fn with_log(self, log: &Log) -> Self {
        self.with("log.csv", log.text())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// Every file with its bytes.
    pub(crate) fn files(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let paths = fs::read_dir(self.folder.path()).unwrap().map(|entry| entry.unwrap().path());
        paths.filter(|path| path.is_file()).map(|p| (p.clone(), fs::read(p).unwrap())).collect()
    }

    /// Runs `tauscope estimate` with `arguments`, split at spaces.
    pub(crate) fn estimate(&self, arguments: &str) -> Outcome {
        let before = self.files();
        let ran = Command::new(env!("CARGO_BIN_EXE_tauscope"))
            .arg("estimate")
            .args(arguments.split_whitespace())
            .current_dir(self.folder.path())
            .output()
            .unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        let outcome = Outcome {
            status: ran.status.code(),
            stdout: text(ran.stdout),
            stderr: text(ran.stderr),
            unchanged: self.files() == before,
        };
        assert!(!outcome.stderr.contains("panicked"), "{}", outcome.stderr);
        let left_over = |path: &PathBuf| path.to_string_lossy().contains(".part");
        assert!(!self.files().keys().any(left_over), "a temporary file is left over");
        outcome
    }
}

/// What a run of the program gave.
#[derive(Debug)]
pub(crate) struct Outcome {
    pub(crate) status: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
    /// No file came, went or changed.
    pub(crate) unchanged: bool,
}

impl Outcome {
    /// Nothing usable: status 2, one error, no result, no file.
    pub(crate) fn is_refused(&self) -> &Self {
        assert_eq!((self.status, self.lines("error: ")), (Some(2), 1), "{self:#?}");
        assert_eq!(self.stdout, "");
        assert!(self.unchanged, "{self:#?}");
        self
    }

    /// Something failed, the rest is there: status 1, `count` warnings, no error.
    pub(crate) fn is_partial(&self, count: usize) -> &Self {
        let found = (self.status, self.lines("error: "), self.lines("warning: "));
        assert_eq!(found, (Some(1), 0, count), "{self:#?}");
        self
    }

    pub(crate) fn is_whole(&self) -> &Self {
        let found = (self.status, self.lines("error: "), self.lines("warning: "));
        assert_eq!(found, (Some(0), 0, 0), "{self:#?}");
        self
    }

    pub(crate) fn says(&self, parts: &[&str]) -> &Self {
        for part in parts {
            assert!(self.stderr.contains(part), "no `{part}` in: {}", self.stderr);
        }
        self
    }

    pub(crate) fn says_what_to_do(&self) {
        let says = REMEDIES.iter().any(|word| self.stderr.contains(word));
        assert!(says, "no remedy in: {}", self.stderr);
    }

    pub(crate) fn lines(&self, start: &str) -> usize {
        self.stderr.lines().filter(|line| line.starts_with(start)).count()
    }

    pub(crate) fn joints(&self) -> Vec<Value> {
        let json: Value = serde_json::from_str(&self.stdout).unwrap();
        json["joints"].as_array().unwrap().clone()
    }
}

pub(crate) fn boom() -> Log {
    Log::of(&["boom"])
}
