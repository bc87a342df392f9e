//! A folder with a log of the synthetic plant, which shares no equation with the models,
//! and what a user does there.

use std::process::{Command, Output};

use serde_json::Value;
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate, write_log};
use tempfile::TempDir;

/// Half a minute at 50 Hz.
pub(crate) struct Desk {
    pub(crate) folder: TempDir,
}

/// A joint that is an integrator with noise of 0.05 deg.
pub(crate) fn joint(name: &str) -> JointSpec {
    let levels = vec![-1.5, -1.0, -0.5, 0.5, 1.0, 1.5];
    let input = InputSpec::Levels { levels, hold_s: [0.8, 1.6] };
    let spec = JointSpec::new(name, input, DelayLaw::Constant { seconds: 0.12 });
    JointSpec { noise: 0.05, ..spec }
}

/// A joint with no flow between −0.3 V and 0.3 V.
pub(crate) fn banded(name: &str) -> JointSpec {
    JointSpec { dead_band: Some([-0.3, 0.3]), ..joint(name) }
}

impl Desk {
    pub(crate) fn with(joints: Vec<JointSpec>) -> Self {
        Self::for_seconds(30.0, joints)
    }

    /// A desk with a log of `duration_s` seconds.
    pub(crate) fn for_seconds(duration_s: f64, joints: Vec<JointSpec>) -> Self {
        Self::of(&PlantSpec { sample_period_s: 0.02, ..PlantSpec::new(11, duration_s, joints) })
    }

    /// A desk with the log of this plant.
    pub(crate) fn of(plant: &PlantSpec) -> Self {
        let mut log = Vec::new();
        write_log(&simulate(plant).unwrap(), &mut log).unwrap();
        Self::of_log(&String::from_utf8(log).unwrap())
    }

    /// A desk with this log.
    pub(crate) fn of_log(log: &str) -> Self {
        let desk = Self { folder: tempfile::tempdir().unwrap() };
        desk.write("log.csv", log);
        desk
    }

    /// Gives the log a joint `broken`, an output of which is missing.
    pub(crate) fn with_broken_joint(self) -> Self {
        let mut rows = 0;
        let line = |line: &str| {
            rows += usize::from(!line.starts_with('#'));
            match rows {
                _ if line.starts_with('#') => line.to_owned(),
                1 => format!("{line},broken.input,broken.output"),
                9 => format!("{line},1,x"),
                _ => format!("{line},1,0"),
            }
        };
        let log: Vec<String> = self.read("log.csv").lines().map(line).collect();
        self.write("log.csv", &(log.join("\n") + "\n"));
        self
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        std::fs::write(self.folder.path().join(name), text).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.folder.path().join(name)).unwrap()
    }

    pub(crate) fn has(&self, name: &str) -> bool {
        self.folder.path().join(name).exists()
    }

    /// `tauscope` with these arguments.
    pub(crate) fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_tauscope"));
        command.current_dir(self.folder.path()).args(arguments.split_whitespace());
        command
    }

    pub(crate) fn run(&self, arguments: &str) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// The JSON of a run that ends with `status`.
    pub(crate) fn json(&self, arguments: &str, status: i32) -> Value {
        let output = self.run(&format!("{arguments} --format json"));
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(status), "{arguments}: {stderr}");
        serde_json::from_slice(&output.stdout).unwrap()
    }

    /// The models of `boom` in the recording of a run that went well.
    #[cfg(feature = "rrd")]
    pub(crate) fn recorded_models(&self, arguments: &str) -> Vec<String> {
        let output = self.run(&format!("{arguments} -o models.rrd"));
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let mut models = std::collections::BTreeSet::new();
        for chunk in self.recorded_chunks() {
            let entity = chunk.entity_path().to_string();
            let model =
                entity.strip_prefix("/boom/model/").and_then(|m| m.strip_suffix("/residual"));
            models.extend(model.map(|model| model.replace('\\', "")));
        }
        models.into_iter().collect()
    }

    /// How many revisions of the boom are in that recording.
    #[cfg(feature = "rrd")]
    pub(crate) fn recorded_revisions(&self) -> usize {
        let chunks = self.recorded_chunks().into_iter();
        let errors = |chunk: &rerun::log::Chunk| {
            chunk.entity_path().to_string() == "/boom/revision/training_rmse"
        };
        chunks.filter(errors).map(|chunk| chunk.num_rows()).sum()
    }

    #[cfg(feature = "rrd")]
    fn recorded_chunks(&self) -> Vec<rerun::log::Chunk> {
        use rerun::external::re_log_encoding::DecoderApp;
        use rerun::log::{Chunk, LogMsg};

        let file = std::fs::File::open(self.folder.path().join("models.rrd")).unwrap();
        let messages = DecoderApp::decode_lazy(std::io::BufReader::new(file));
        let chunks = messages.filter_map(|message| match message.unwrap() {
            LogMsg::ArrowMsg(_, chunk) => Some(Chunk::from_arrow_msg(&chunk).unwrap()),
            _ => None,
        });
        chunks.collect()
    }

    /// The message of a run that ends with status 2, without a result.
    pub(crate) fn refusal(&self, arguments: &str) -> String {
        let output = self.run(arguments);
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments}: {stderr}");
        assert!(output.stdout.is_empty());
        assert!(stderr.starts_with("error: ") && !stderr.contains("panicked"), "{stderr}");
        stderr
    }
}

/// Names of the fields of a JSON object.
pub(crate) fn fields(object: &Value) -> Vec<&str> {
    object.as_object().unwrap().keys().map(String::as_str).collect()
}

/// Asserts that `object` has each of `names`, separated by spaces.
pub(crate) fn assert_fields(object: &Value, names: &str) {
    let there = fields(object);
    for name in names.split(' ') {
        assert!(there.contains(&name), "no `{name}` in {there:?}");
    }
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}
