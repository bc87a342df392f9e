//! What the columns of a foreign log seem to be: the time, the trial, and which of the others
//! drives and measures which joint.

mod joints;
mod signal;
mod words;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::columns::{ColumnMap, JointColumns};
use super::error::ReadError;
use super::format;
use super::grid::Repair;
use super::layout::find_trial;
use super::memory::{Budget, MemoryLimit};
use super::table::{Column, Head, OpenTable};
use super::time_column::find_time_column;
use super::unit;
use joints::{Columns, FoundJoint};
use signal::Signal;

/// What a log's columns are taken for, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    /// The log.
    pub path: PathBuf,
    /// Each column, in the order of the file.
    pub columns: Vec<SurveyedColumn>,
    /// The mapping that follows; without joints where none can be found.
    pub map: ColumnMap,
    /// Whether names say what drives and what measures each of its joints, and leave nothing
    /// else that could be meant.
    pub is_sure: bool,
    /// What could not be found out.
    pub open: Vec<String>,
    /// Joints, and columns that are named like what drives them, too.
    pub further_inputs: Vec<(String, String)>,
    /// Mappings that could be meant as well, where it is not sure.
    pub alternatives: Vec<ColumnMap>,
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
        let table = format::open(path, Budget::new(memory));
        let found = table.and_then(Self::of_table).map_err(|error| error.in_file(path))?;
        Ok(Self { path: path.to_owned(), ..found })
    }

    /// Looks at an open log.
    pub(super) fn of_table(table: OpenTable) -> Result<Self, ReadError> {
        let head = table.head.clone();
        head.check_is_header()?;
        let (time, trial) = (find_time_column(&head), find_trial(&head));
        let numeric: Vec<usize> = (0..head.headers.len()).filter(|i| Some(*i) != trial).collect();
        let clock = head.headers.first().map_or(0, |header| header.clock);
        let read = table.read(&numeric, [None, time], clock, Repair::default())?;
        // Gains and options stand beside the signals in a workspace.
        let rows = time.map_or(0, |_| read.rows.len());
        let is_as_long =
            |column: &Column| rows == 0 || column.error.is_some() || column.values.len() == rows;
        let columns =
            numeric.into_iter().zip(&read.columns).filter(|(_, column)| is_as_long(column));
        Ok(Self::of_columns(&head, columns))
    }

    /// Looks at columns with their indices in `head`.
    fn of_columns<'a>(head: &Head, columns: impl Iterator<Item = (usize, &'a Column)>) -> Self {
        let (time, trial) = (find_time_column(head), find_trial(head));
        let mut signals: Vec<Option<Signal>> = vec![None; head.headers.len()];
        for (index, column) in columns.filter(|(index, _)| ![time, trial].contains(&Some(*index))) {
            if let Some(slot) = signals.get_mut(index) {
                *slot = Signal::of(column);
            }
        }
        let columns = Columns::of(head, &signals);
        let joints = columns.joints();
        let mut open = Vec::new();
        if time.is_none() {
            open.push(
                "no column is a time: name one with `--time COLUMN`, or give `--sample-period SECONDS`",
            );
        }
        if joints.is_empty() {
            open.push(
                "neither names nor data show which columns are the input and the output of a joint: \
                 name them with `--joint NAME=INPUT_COLUMN:OUTPUT_COLUMN`",
            );
        }
        let open = open.into_iter().map(str::to_owned).collect();
        let found: Vec<JointColumns> =
            joints.iter().map(|j| columns.joint_columns([j.input, j.output], &j.name)).collect();
        let map = |joints| ColumnMap {
            time: time.map(|column| head.text(column)),
            trial: trial.map(|column| head.text(column)),
            joints,
            ..ColumnMap::default()
        };
        Self {
            path: PathBuf::new(),
            columns: columns.surveyed([time, trial], &joints),
            is_sure: joints.iter().all(|joint| joint.is_sure),
            open,
            further_inputs: columns.further_inputs(&joints),
            alternatives: columns.alternatives(&joints, &found).into_iter().map(map).collect(),
            map: map(found),
        }
    }

    /// What may be the joints, the likeliest first: of each its name, its input and its output.
    pub(crate) fn named_joints(&self) -> Vec<Vec<[String; 3]>> {
        let maps = std::iter::once(&self.map).chain(&self.alternatives);
        maps.map(ColumnMap::named_joints).filter(|joints| !joints.is_empty()).collect()
    }
}

impl Columns<'_> {
    fn joint_columns(&self, [input, output]: [usize; 2], name: &str) -> JointColumns {
        JointColumns::new(name, &self.head.text(input), &self.head.text(output))
    }

    /// `found` with one of the `joints` having other columns that could be meant as well.
    fn alternatives(
        &self,
        joints: &[FoundJoint],
        found: &[JointColumns],
    ) -> Vec<Vec<JointColumns>> {
        let mut alternatives = Vec::new();
        for (place, joint) in joints.iter().enumerate() {
            for (columns, name) in &joint.instead {
                let mut others = found.to_vec();
                others.splice(place..=place, [self.joint_columns(*columns, name)]);
                alternatives.push(others);
            }
        }
        alternatives
    }

    /// What each column is taken for, and why.
    fn surveyed(
        &self,
        [time, trial]: [Option<usize>; 2],
        joints: &[FoundJoint],
    ) -> Vec<SurveyedColumn> {
        let mut roles: HashMap<usize, (Role, String)> = HashMap::new();
        for FoundJoint { name, input, output, why: [input_why, output_why], .. } in joints {
            roles.entry(*input).or_insert((Role::Input(name.clone()), input_why.clone()));
            roles.entry(*output).or_insert((Role::Output(name.clone()), output_why.clone()));
        }
        let mut columns = Vec::new();
        for (column, header) in self.head.headers.iter().enumerate() {
            let mut unit = header.unit.clone().or_else(|| unit::of_signal(&header.name));
            let (role, why) = if Some(column) == time {
                unit = unit.or_else(|| unit::of_time(&header.name).map(str::to_owned));
                let guess = ", taken for seconds, or judged by its size";
                (Role::Time, format!("its name{}", if unit.is_some() { "" } else { guess }))
            } else if Some(column) == trial {
                (Role::Trial, "its name".to_owned())
            } else {
                let says = self.signals.get(column).and_then(Option::as_ref).map(Signal::says);
                let says = says.unwrap_or_else(|| "it does not hold numbers".to_owned());
                roles.remove(&column).unwrap_or((Role::Other, says))
            };
            columns.push(SurveyedColumn { name: header.text.clone(), unit, role, why });
        }
        columns
    }
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
    fn joints_are_known_by_names_or_by_what_follows_what() {
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
            assert_eq!(survey.is_sure, name != "b", "data alone leave a doubt");
        }
    }

    #[test]
    fn what_is_wanted_is_no_output_and_a_second_coil_is_named() {
        for (header, further) in [
            ("t_ms,boom_pos_cmd,boom_pos,boom_pos_valid", None),
            ("t_ms,boom_cmd,boom_angle,boom_angle_limit", None),
            ("t_ms,boom_valve_extend,boom_angle,boom_valve_retract", Some("boom_valve_retract")),
        ] {
            let survey = survey(header);
            let names: Vec<&str> = header.split(',').collect();
            assert_eq!(survey.map.joints, [JointColumns::new("boom", names[1], names[2])]);
            let found: Vec<&str> =
                survey.further_inputs.iter().map(|(_, column)| column.as_str()).collect();
            assert_eq!(found, further.into_iter().collect::<Vec<_>>(), "{header}");
        }
    }

    #[test]
    fn a_joint_has_the_columns_that_share_most_words_with_each_other() {
        let header =
            "t_s,left_arm_cmd,left_boom_cmd,left_boom_speed,left_boom_angle,left_arm_angle";
        let mut text = format!("{header}\n");
        for k in 0..50 {
            writeln!(text, "{k},{},{},{k},{k},{k}", k / 10, k / 7).unwrap();
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        std::fs::write(&path, text).unwrap();
        let survey = Survey::of(&path, MemoryLimit::default()).unwrap();
        let joint = |name: &str| {
            let column = |what: &str| format!("left_{name}_{what}");
            JointColumns::new(name, &column("cmd"), &column("angle"))
        };
        // What all columns have says of none which it is.
        assert_eq!(survey.map.joints, ["arm", "boom"].map(joint));
        assert!(survey.is_sure);
    }

    #[test]
    fn a_bare_input_beside_one_output_and_nothing_else_is_a_joint() {
        for (header, is_sure) in
            [("t_s,u,y", true), ("time,input,angle", true), ("t_s,u,y,x", false)]
        {
            let columns = header.split(',').count();
            let mut text = format!("{header}\n");
            let mut angle = 0.0;
            for k in 0..400 {
                let input = f64::from(k / 40 * 7 % 5) - 2.0;
                angle += 0.1 * input;
                let row = [f64::from(k) / 100.0, input, angle, angle.sin()];
                let cells: Vec<String> = row[..columns].iter().map(f64::to_string).collect();
                writeln!(text, "{}", cells.join(",")).unwrap();
            }
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("log.csv");
            std::fs::write(&path, text).unwrap();
            let survey = Survey::of(&path, MemoryLimit::default()).unwrap();
            let names: Vec<&str> = header.split(',').collect();
            assert_eq!(survey.map.joints, [JointColumns::new(names[2], names[1], names[2])]);
            assert_eq!(survey.is_sure, is_sure, "{header}");
        }
    }

    #[test]
    fn what_cannot_be_found_is_said() {
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
