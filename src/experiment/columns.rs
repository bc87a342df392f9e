//! Which column of a foreign file means what.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::bounded::read_text;
use super::names::on_one_line;

/// The file beside a log that holds the mapping of its columns, where none is given.
pub(crate) const KEPT: &str = "columns.toml";

/// The columns of a log that do not bear the native names.
///
/// An empty map reads the native names: `time_s`, `trial`, `<joint>.input`,
/// `<joint>.output`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ColumnMap {
    /// Column of the time in seconds.
    pub time: Option<String>,
    /// Column whose value names the trial of a row; `none` when there is no such column,
    /// whatever the names.
    pub trial: Option<String>,
    /// Seconds between samples, where the log has no time.
    pub sample_period_s: Option<f64>,
    /// Columns of each joint. None: every joint with native names.
    pub joints: Vec<JointColumns>,
    /// Settings of its own that a joint has, as a person writes them: by the joint's name, each
    /// with its value.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub estimate: BTreeMap<String, BTreeMap<String, String>>,
}

/// The columns of one joint.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct JointColumns {
    /// Name that the joint gets.
    pub name: String,
    /// Column of its input.
    pub input: String,
    /// Column of its output.
    pub output: String,
    /// Unit of the input; else the bracketed one of the column's header.
    pub input_unit: Option<String>,
    /// Unit of the output; else the bracketed one of the column's header.
    pub output_unit: Option<String>,
    /// Further signals: their name and their column.
    pub covariates: Vec<(String, String)>,
}

/// Why a column mapping cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ColumnMapError {
    /// The mapping file cannot be opened or read.
    #[error("{}: cannot read the column mapping", path.display())]
    Read {
        /// The mapping file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The mapping file is not the TOML that is expected.
    #[error(
        "{}: not a column mapping; it holds `time`, `trial`, `sample_period` and a table \
         [joint.NAME] with `input` and `output` for each joint, whose own settings are in \
         [joint.NAME.estimate]", path.display()
    )]
    Parse {
        /// The mapping file.
        path: PathBuf,
        /// Line, column and cause.
        source: Box<toml::de::Error>,
    },
    /// A joint on the command line is not `NAME=INPUT:OUTPUT`.
    #[error("`{text}` is not NAME=INPUT_COLUMN:OUTPUT_COLUMN")]
    Joint {
        /// What was given.
        text: String,
    },
}

impl FromStr for JointColumns {
    type Err = ColumnMapError;

    /// Reads `NAME=INPUT_COLUMN:OUTPUT_COLUMN`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parts = text
            .split_once('=')
            .and_then(|(name, columns)| Some((name, columns.split_once(':')?)))
            .map(|(name, (input, output))| [name, input, output].map(on_one_line));
        match &parts {
            Some([name, input, output]) if parts.iter().flatten().all(|part| !part.is_empty()) => {
                Ok(Self::new(name, input, output))
            }
            _ => Err(ColumnMapError::Joint { text: text.to_owned() }),
        }
    }
}

impl JointColumns {
    /// Joint `name`, driven by column `input`, measured in column `output`.
    pub fn new(name: &str, input: &str, output: &str) -> Self {
        Self {
            name: name.to_owned(),
            input: input.to_owned(),
            output: output.to_owned(),
            input_unit: None,
            output_unit: None,
            covariates: Vec::new(),
        }
    }
}

impl ColumnMap {
    /// The name, the input and the output of each joint.
    pub(crate) fn named_joints(&self) -> Vec<[String; 3]> {
        let joint =
            |joint: &JointColumns| [&joint.name, &joint.input, &joint.output].map(Clone::clone);
        self.joints.iter().map(joint).collect()
    }

    /// The mapping that `tauscope columns -w` has left beside this log, with its file; none where there is no
    /// such file, or one without joints.
    ///
    /// # Errors
    /// As [`ColumnMap::read`], for a file that another program wrote or a person has edited.
    pub(super) fn kept_beside(log: &Path) -> Result<Option<(PathBuf, Self)>, ColumnMapError> {
        let path = log.with_file_name(KEPT);
        if !path.is_file() {
            return Ok(None);
        }
        let map = Self::read(&path)?;
        Ok((!map.joints.is_empty()).then_some((path, map)))
    }

    /// Reads a mapping from a TOML file.
    ///
    /// ```toml
    /// time = "t_s"
    /// trial = "test"
    /// # sample_period = 0.01       # where there is no time column
    /// [joint.arm]
    /// input = "u_duty_pct"
    /// output = "angle_deg"
    /// input_unit = "%"
    /// output_unit = "deg"
    /// covariates = { pilot = "pilot_pos_bar" }
    /// [joint.arm.estimate]         # settings of its own
    /// max_delay = "0.5s"
    /// ```
    ///
    /// A joint whose columns have native names needs neither `input` nor `output`.
    ///
    /// # Errors
    /// [`ColumnMapError::Read`] and [`ColumnMapError::Parse`], with the file's name.
    pub fn read(path: &Path) -> Result<Self, ColumnMapError> {
        let text = read_text(path)
            .map_err(|source| ColumnMapError::Read { path: path.to_owned(), source })?;
        let file: MapFile = toml::from_str(&text).map_err(|source| ColumnMapError::Parse {
            path: path.to_owned(),
            source: Box::new(source),
        })?;
        Ok(file.into())
    }

    /// The columns that it names.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        let joints = self.joints.iter().flat_map(|joint| [&joint.input, &joint.output]);
        self.time.iter().chain(&self.trial).chain(joints).map(String::as_str)
    }

    /// The mapping as the text of a file, which [`Self::read`] reads.
    pub fn to_toml(&self) -> String {
        let mut joints: BTreeMap<String, MapJoint> = BTreeMap::new();
        for joint in self.joints.iter().cloned() {
            let columns = MapJoint {
                input: Some(joint.input),
                output: Some(joint.output),
                input_unit: joint.input_unit,
                output_unit: joint.output_unit,
                covariates: joint.covariates.into_iter().collect(),
                estimate: BTreeMap::new(),
            };
            joints.insert(joint.name, columns);
        }
        for (name, settings) in &self.estimate {
            let settings = settings.iter().map(|(name, text)| (name.clone(), text.clone().into()));
            joints.entry(name.clone()).or_default().estimate = settings.collect();
        }
        let file = MapFile {
            time: self.time.clone(),
            trial: self.trial.clone(),
            sample_period: self.sample_period_s,
            joint: joints,
        };
        // A structure of texts and numbers is always written.
        toml::to_string(&file).unwrap_or_default()
    }
}

#[derive(Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
struct MapFile {
    time: Option<String>,
    trial: Option<String>,
    sample_period: Option<f64>,
    joint: BTreeMap<String, MapJoint>,
}

#[derive(Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
struct MapJoint {
    input: Option<String>,
    output: Option<String>,
    input_unit: Option<String>,
    output_unit: Option<String>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    covariates: BTreeMap<String, String>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    estimate: BTreeMap<String, toml::Value>,
}

impl MapJoint {
    /// Whether it says nothing of columns, which then have native names.
    fn is_native(&self) -> bool {
        let named = [&self.input, &self.output, &self.input_unit, &self.output_unit];
        self.covariates.is_empty() && named.into_iter().all(Option::is_none)
    }
}

/// A value of a setting as it is typed: `-40,40` of `[-40, 40]`.
fn typed(value: toml::Value) -> String {
    match value {
        toml::Value::String(text) => text,
        toml::Value::Array(values) => values.into_iter().map(typed).collect::<Vec<_>>().join(","),
        other => other.to_string(),
    }
}

impl From<MapFile> for ColumnMap {
    fn from(file: MapFile) -> Self {
        let mut map = Self {
            time: file.time,
            trial: file.trial,
            sample_period_s: file.sample_period,
            ..Self::default()
        };
        let only_settings = file.joint.values().all(MapJoint::is_native);
        for (name, mut joint) in file.joint {
            let settings = std::mem::take(&mut joint.estimate);
            if !settings.is_empty() {
                let settings = settings.into_iter().map(|(name, value)| (name, typed(value)));
                map.estimate.insert(name.clone(), settings.collect());
            }
            if only_settings {
                continue;
            }
            let native = |kind: &str| format!("{name}.{kind}");
            map.joints.push(JointColumns {
                input: joint.input.unwrap_or_else(|| native("input")),
                output: joint.output.unwrap_or_else(|| native("output")),
                name,
                input_unit: joint.input_unit,
                output_unit: joint.output_unit,
                covariates: joint.covariates.into_iter().collect(),
            });
        }
        map
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_a_joint_from_the_command_line() {
        let joint: JointColumns = "arm = u_duty : angle_deg".parse().unwrap();
        assert_eq!(joint, JointColumns::new("arm", "u_duty", "angle_deg"));
        for bad in ["arm", "arm=u", "arm=:y", "=u:y", "arm=u:"] {
            assert!(bad.parse::<JointColumns>().is_err(), "{bad}");
        }
    }

    #[test]
    fn joints_may_have_settings_of_their_own() {
        let text = "[joint.arm.estimate]\nmax_delay = '0.5s'\noutput_limits = [-40, 40.5]\n";
        let map = ColumnMap::from(toml::from_str::<MapFile>(text).unwrap());
        let texts: Vec<_> = map.estimate["arm"].values().map(String::as_str).collect();
        assert_eq!((map.joints.len(), texts), (0, vec!["0.5s", "-40,40.5"]));
        let again = ColumnMap::from(toml::from_str::<MapFile>(&map.to_toml()).unwrap());
        assert_eq!(again, map);
        // Beside columns of one joint, the others are known by their native names.
        let text = format!("[joint.boom]\ninput = 'u'\noutput = 'y'\n{text}");
        let map = ColumnMap::from(toml::from_str::<MapFile>(&text).unwrap());
        let expected = [
            JointColumns::new("arm", "arm.input", "arm.output"),
            JointColumns::new("boom", "u", "y"),
        ];
        assert_eq!(map.joints, expected);
    }
}
