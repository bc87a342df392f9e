//! `tauscope export`: models in other languages are compiled and run, and move as those of the
//! library do.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use crate::sample::size;
use tauscope::effect::REGISTRY;
use tauscope::experiment::{Experiment, ReadOptions};
use tauscope::export::{Export, ExportError, Units, by_ending};
use tauscope::model::{Component, ModelFile, Surroundings, simulate_input};
use tauscope::{Effect, JointModel};

/// How far an exported model may be from the library's, in output units or parts of the output.
const TOLERANCE: f64 = 1e-9;

/// Effects with parameters away from their neutral ones.
const EFFECTS: [(&str, &str); 32] = [
    ("input_offset", "offset = 0.05"),
    ("dead_band", "lower = -0.3, upper = 0.4"),
    ("stiction", "start = 0.8, stop = 0.45"),
    ("input_saturation", "limit = 1.2, softness = 0.4"),
    ("asymmetric_saturation", "limit = 1.2, softness = 0.4, negative_limit = 0.84"),
    ("flow_curve", "exponent = 1.4"),
    ("direction_gain", "negative_factor = 0.7"),
    ("rate_limit", "seconds_per_input = 0.23, falling = 0.4"),
    (
        "variable_delay",
        "size = -0.03, falling = 0.021, dwell = 0.04, drift = 0.0007, size_scale = 2.0, \
         dwell_scale = 1.5, drift_scale = 60.0",
    ),
    ("actuator_lag", "time_constant = 0.17"),
    ("spool_lag", "time_constant = 0.09"),
    ("resonance", "period = 0.31, damping = 0.2"),
    ("resonance", "period = 0.011, damping = 3.0"),
    (
        "oil_column",
        "period = 0.4, damping = 0.1, valve_damping = 0.2, slope = 0.003, curvature = -1e-5, \
         reference = 12.0",
    ),
    ("coulomb_friction", "positive = 0.2, negative = 0.3, time_constant = 0.15"),
    (
        "asymmetric_friction",
        "positive = 0.2, negative = 0.3, time_constant = 0.15, negative_viscous = 1.6",
    ),
    ("gravity_load", "kappa = 0.4, y0 = 10.0, creep = 0.5"),
    ("position_gain", "slope = 0.004, curvature = -2e-5, cubic = 1e-7, reference = 5.0"),
    ("thermal_drift", "rate = 0.003, time_constant = 40.0"),
    ("supply_droop", "droop = 0.35"),
    ("leakage", "rate = 0.05, y0 = 10.0"),
    ("end_stop", "low = -8.0, high = 9.0"),
    ("end_stop", "low = 3.0, high = 9.0"),
    ("backlash", "width = 0.7"),
    (
        "asymmetric_stiction",
        "positive_start = 0.8, positive_stop = 0.45, negative_start = 0.6, negative_stop = 0.3",
    ),
    ("valve_hysteresis", "width = 0.3"),
    ("input_quantization", "step = 0.35"),
    (
        "valve_curve",
        "share_1 = 0.3, share_2 = 0.6, share_3 = 0.9, share_4 = 0.5, share_5 = 0.8, \
         negative_share_1 = 0.6, negative_share_2 = 0.9, negative_share_3 = 0.5, \
         negative_share_4 = 0.7, negative_share_5 = 0.95, negative_factor = 0.8, reach = 2.0",
    ),
    ("spool_rate_limit", "seconds_per_input = 0.23, falling = -0.3"),
    ("creep", "share = 0.4, time_constant = 0.8"),
    ("position_ripple", "amplitude = 0.2, period = 3.0, phase = 0.5"),
    ("accumulator_droop", "droop = 0.05, recovery_time = 3.0"),
];

const OWN: &str = r#"
[[joint.boom.effect]]
kind = "expression"
id = "knee"
stage = "input"
expression = "if(!(abs(signal) <= lambda) && signal / 0 != 7, sign(signal) * (lambda + (abs(signal) - lambda)^2 / 3), - -signal)"
parameters = { lambda = 0.9 }
[[joint.boom.effect]]
kind = "expression"
id = "step"
stage = "load"
expression = "signal * (1 - a * others) + (b + tanh(time / 50)) * sin(position * radians) / (2 - (a - 1)) + min(velocity * dt, out, 3)"
parameters = { a = 0.2, b = 0.3, out = 0.01 }
[[joint.boom.effect]]
kind = "expression"
id = "slow"
stage = "dynamics"
expression = "for + 0.1 * level"
states = { for = "for + (signal - for) * (1 - exp(-dt / lag))", level = { start = "0", next = "level * exp(-dt) + dt * abs(for)" } }
parameters = { lag = 0.2 }
[[joint.boom.effect]]
kind = "expression"
id = "late"
stage = "transport"
expression = "x * (after < before) + 0.02 * exp(-held) + sqrt(before) * floor(x) - ln(time) * 0"
parameters = { x = 0.033 }
"#;

fn model(effects: &[(&str, &str)], rest: &str) -> JointModel {
    let start = "schema = \"tauscope/model/1\"\n[joint.boom]\nstructure = \"integrator\"\n\
                 parameters = { gain = 7.3, delay = 0.153 }\n";
    let effect = |(kind, parameters): &(&str, &str)| {
        format!("[[joint.boom.effect]]\nkind = \"{kind}\"\nparameters = {{ {parameters} }}\n")
    };
    let effects: Vec<String> = effects.iter().map(effect).collect();
    let text = [start, &effects.concat(), rest].concat();
    let file = ModelFile::parse(&text, Path::new("model.toml")).unwrap();
    file.joint("boom").unwrap().clone()
}

/// Each effect alone, those of a user, and many together.
fn models() -> Vec<(String, JointModel)> {
    let alone = EFFECTS.iter().enumerate();
    let alone = alone.map(|(k, effect)| (format!("m{k}_{}", effect.0), model(&[*effect], "")));
    let without = |ids: &[&str]| -> Vec<_> {
        EFFECTS.iter().filter(|(id, _)| !ids.contains(id)).copied().collect()
    };
    let mut swings = without(&["coulomb_friction", "resonance", "actuator_lag"]);
    swings.reverse();
    let brakes = ["actuator_lag", "spool_lag", "oil_column", "resonance", "asymmetric_friction"];
    let together = [
        ("plain", model(&[], "")),
        ("twice", model(&[EFFECTS[23], ("backlash", "width = 0.3"), EFFECTS[9], EFFECTS[9]], "")),
        ("own", model(&[], OWN)),
        ("brakes", model(&without(&brakes), OWN)),
        ("swings", model(&swings, "")),
    ];
    alone.chain(together.map(|(name, model)| (name.to_owned(), model))).collect()
}

/// What drives a joint.
struct Record {
    period_s: f64,
    start_s: f64,
    output: f64,
    input: Vec<f64>,
    others: Vec<f64>,
}

impl Record {
    /// The whole of it, or its first samples.
    fn cut(&self, samples: usize) -> Self {
        let cut = |values: &[f64]| values.iter().copied().take(samples).collect();
        Self { input: cut(&self.input), others: cut(&self.others), ..*self }
    }

    fn simulated(&self, model: &JointModel) -> Vec<f64> {
        let surroundings = Surroundings {
            others: &self.others,
            radians_per_output_unit: 1_f64.to_radians(),
            start_s: self.start_s,
            ..Surroundings::default()
        };
        simulate_input(model, &self.input, self.period_s, self.output, &surroundings).output
    }

    fn numbers(&self) -> Vec<f64> {
        let head = [self.input.len() as f64, self.period_s, self.start_s, self.output];
        head.iter().chain(&self.input).chain(&self.others).copied().collect()
    }
}

/// The joints of the project's logs.
static RECORDS: LazyLock<Vec<Record>> = LazyLock::new(|| {
    let logs = ["worked_example", "hidden_effect", "manipulator"];
    let paths: Vec<_> = logs.iter().map(|log| PathBuf::from(format!("data/{log}.csv"))).collect();
    let mut records = Vec::new();
    for path in paths {
        let experiment = Experiment::read(&[path], &ReadOptions::default());
        for trial in experiment.joints.iter().flat_map(|joint| &joint.trials) {
            let input = trial.input().to_vec();
            let others = (0..input.len()).map(|k| 0.5 + 0.5 * (k as f64 / 70.0).sin()).collect();
            let (period_s, output) = (trial.period().seconds(), trial.output()[0]);
            records.push(Record { period_s, start_s: 31.5, output, input, others });
        }
    }
    assert_eq!(records.len(), 10);
    records
});

/// Records of so many samples, as many as that.
fn records(most: usize, samples: usize) -> Vec<Record> {
    RECORDS.iter().rev().take(most).map(|record| record.cut(samples)).collect()
}

/// The files of `model` in the language of `ending`, written to `folder`.
fn export(folder: &Path, name: &str, model: &JointModel, ending: &str) {
    let export = Export::new("boom", model, Units::default(), &["a test".to_owned()]).unwrap();
    for file in by_ending(ending).unwrap().files(&export, name).unwrap() {
        assert_eq!(file.note, None);
        fs::write(folder.join(format!("{name}.{}", file.ending)), file.content).unwrap();
    }
}

/// Writes `records` to the file `FOLDER/NAME.in`.
fn write_records(folder: &Path, name: &str, records: &[Record]) {
    let numbers: Vec<u8> =
        records.iter().flat_map(Record::numbers).flat_map(f64::to_le_bytes).collect();
    fs::write(folder.join(format!("{name}.in")), numbers).unwrap();
}

/// Runs a program in `folder`, and panics with what it says if it fails.
fn done(folder: &Path, program: &mut Command) {
    let done = program.current_dir(folder).output().unwrap();
    let said = [done.stderr, done.stdout].concat();
    assert!(done.status.success(), "{program:?}: {}", String::from_utf8_lossy(&said));
}

/// Runs `program` on each of `records`, in the files `FOLDER/NAME.in` and `FOLDER/NAME.out`.
fn run(folder: &Path, name: &str, records: &[Record], program: &mut Command) -> Vec<Vec<f64>> {
    write_records(folder, name, records);
    done(folder, program);
    read_outputs(folder, name, records)
}

/// The outputs in the file `FOLDER/NAME.out`, one of each of `records`.
fn read_outputs(folder: &Path, name: &str, records: &[Record]) -> Vec<Vec<f64>> {
    let bytes = fs::read(folder.join(format!("{name}.out"))).unwrap();
    let found: Vec<f64> =
        bytes.chunks_exact(8).map(|eight| f64::from_le_bytes(eight.try_into().unwrap())).collect();
    let mut found = found.as_slice();
    let mut split = |record: &Record| {
        let (this, rest) = found.split_at(record.input.len());
        found = rest;
        this.to_vec()
    };
    records.iter().map(&mut split).collect()
}

/// Panics unless `found` is what the library simulates.
fn assert_same(name: &str, model: &JointModel, records: &[Record], found: &[Vec<f64>]) {
    for (record, found) in records.iter().zip(found) {
        for (k, (found, expected)) in found.iter().zip(record.simulated(model)).enumerate() {
            let far = (found - expected).abs() > TOLERANCE * expected.abs().max(1.0);
            assert!(!far && found.is_finite(), "{name}: sample {k}: {found}, not {expected}");
        }
    }
}

/// Said on the terminal itself: the test runner keeps what is printed to itself.
fn skipped(why: &str) {
    let mut terminal = std::io::stderr();
    writeln!(terminal, "skipped: {why}").unwrap();
}

fn is_there(program: &str, arguments: &[&str]) -> bool {
    let output = Command::new(program).args(arguments).output();
    output.is_ok_and(|output| output.status.success())
}

/// The Python of the environment, or that of the machine.
fn python() -> String {
    std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned())
}

#[test]
fn every_effect_of_the_catalogue_is_tried() {
    for effect in REGISTRY {
        let id = effect.spec().id;
        assert!(EFFECTS.iter().any(|(tried, _)| *tried == id), "{id}");
    }
}

#[test]
fn each_effect_that_is_tried_moves_the_joint() {
    let plain = model(&[], "");
    for (name, model) in models().iter().filter(|(name, _)| name != "plain") {
        let moves = |record: &Record| {
            let pairs = record.simulated(&plain).into_iter().zip(record.simulated(model));
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) > 1e-3
        };
        assert!(RECORDS.iter().any(moves), "{name}");
    }
}

/// Drives one model.
const RUN_C: &str = r#"
static int MODEL_run(void)
{
    FILE *in = fopen("all.in", "rb");
    FILE *out = fopen("MODEL.out", "wb");
    double head[4];
    static MODEL_state joint;
    while (in && out && fread(head, sizeof *head, 4, in) == 4) {
        const size_t samples = (size_t)head[0];
        double *input = malloc(2 * samples * sizeof *input);
        MODEL_parameters parameters = MODEL_defaults();
        size_t k;
        if (!input || fread(input, sizeof *input, 2 * samples, in) != 2 * samples) {
            return 1;
        }
        parameters.start_s = head[2];
        MODEL_init(&joint, &parameters, head[1], input[0], head[3]);
        for (k = 0; k < samples; k++) {
            double output;
            joint.others = input[samples + k];
            output = MODEL_step(&joint, input[k]);
            fwrite(&output, sizeof output, 1, out);
        }
        if (joint.lost > 0) {
            return 2;
        }
        free(input);
    }
    return fclose(in) != 0 || fclose(out) != 0;
}
"#;

/// A program that drives each of `models`.
fn program_in_c(models: &[(String, JointModel)]) -> String {
    let of_each = |text: &str| -> String {
        models.iter().map(|(name, _)| text.replace("MODEL", name)).collect()
    };
    let (headers, runs) = (of_each("#include \"MODEL.h\"\n"), of_each(RUN_C));
    let calls = of_each(" || MODEL_run()");
    format!(
        "{headers}#include <stdio.h>\n#include <stdlib.h>\n{runs}\nint main(void)\n{{\n    \
         return 0{calls};\n}}\n"
    )
}

#[test]
fn c_moves_as_the_library_does_over_all_data() {
    if !is_there("cc", &["--version"]) {
        return skipped("no `cc` to compile models with");
    }
    let folder = tempfile::tempdir().unwrap();
    let (records, models) = (records(usize::MAX, size(3000, usize::MAX)), models());
    let mut cc = Command::new("cc");
    cc.args(["-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", "-pedantic", "main.c"]);
    fs::write(folder.path().join("main.c"), program_in_c(&models)).unwrap();
    for (name, model) in &models {
        export(folder.path(), name, model, "c");
        cc.arg(format!("{name}.c"));
    }
    done(folder.path(), cc.args(["-o", "all", "-lm"]));
    write_records(folder.path(), "all", &records);
    done(folder.path(), &mut Command::new(folder.path().join("all")));
    for (name, model) in &models {
        assert_same(name, model, &records, &read_outputs(folder.path(), name, &records));
    }
}

const MAIN_PY: &str = "
import importlib, sys
import numpy as np
sys.dont_write_bytecode = True
model = importlib.import_module('MODEL')
numbers = np.fromfile('MODEL.in')
with open('MODEL.out', 'wb') as out:
    while len(numbers):
        n, period_s, start_s, output = int(numbers[0]), *numbers[1:4]
        u, others, numbers = numbers[4:4 + n], numbers[4 + n:4 + 2 * n], numbers[4 + 2 * n:]
        parameters = model.Parameters(start_s=start_s)
        whole = model.simulate(u, period_s, output, others, parameters)
        joint = model.Model(period_s, u[0], output, parameters)
        for k in range(50):
            joint.others = others[k]
            assert joint.step(u[k]) == whole[k]
        whole.tofile(out)
";

#[test]
fn python_moves_as_the_library_does() {
    if !is_there(&python(), &["-c", "import numpy"]) {
        return skipped("no Python with `numpy` (PYTHON names another)");
    }
    let folder = tempfile::tempdir().unwrap();
    let records = records(4, 1200);
    for (name, model) in models() {
        export(folder.path(), &name, &model, "py");
        let script = MAIN_PY.replace("MODEL", &name);
        let mut python = Command::new(python());
        python.args(["-W", "error", "-c", &script]);
        let found = run(folder.path(), &name, &records, &mut python);
        assert_same(&name, &model, &records, &found);
    }
}

const MAIN_M: &str = "
  in = fopen('MODEL.in'); numbers = fread(in, Inf, 'double'); fclose(in);
  out = fopen('MODEL.out', 'w');
  while ~isempty(numbers)
    n = numbers(1);
    u = numbers(5:4 + n);
    others = numbers(5 + n:4 + 2 * n);
    p = MODEL('parameters');
    p.start_s = numbers(3);
    y = MODEL('simulate', u, numbers(2), numbers(4), p, others);
    s = MODEL('init', numbers(2), u(1), numbers(4), p);
    for k = 1:20
      s.others = others(k);
      [now_y, s] = MODEL('step', s, u(k));
      assert(now_y, y(k));
    end
    fwrite(out, y, 'double');
    numbers(1:4 + 2 * n) = [];
  end
  fclose(out);
";

#[test]
fn octave_moves_as_the_library_does() {
    if !is_there("octave-cli", &["--version"]) {
        return skipped("no `octave-cli` to run models with");
    }
    let folder = tempfile::tempdir().unwrap();
    let records = records(2, 500);
    for (name, model) in models() {
        export(folder.path(), &name, &model, "m");
        let mut octave = Command::new("octave-cli");
        octave.args(["--norc", "--eval", &MAIN_M.replace("MODEL", &name)]);
        let found = run(folder.path(), &name, &records, &mut octave);
        assert_same(&name, &model, &records, &found);
    }
}

const MAIN_FMU: &str = "
import shutil
import fmpy, numpy as np
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu
problems = validate_fmu('MODEL.fmu')
assert not problems, problems
description = fmpy.read_model_description('MODEL.fmu', validate=True)
reference = {v.name: v.valueReference for v in description.modelVariables}
folder = fmpy.extract('MODEL.fmu')
fmu = FMU3Slave(guid=description.guid, unzipDirectory=folder, instanceName='boom',
                modelIdentifier=description.coSimulation.modelIdentifier)
numbers = np.fromfile('MODEL.in')
fmu.instantiate()
with open('MODEL.out', 'wb') as out:
    while len(numbers):
        n, period_s, start_s, output = int(numbers[0]), *numbers[1:4]
        u, others, numbers = numbers[4:4 + n], numbers[4 + n:4 + 2 * n], numbers[4 + 2 * n:]
        fmu.setFloat64([reference['start_s'], reference['initial_output']], [start_s, output])
        fmu.enterInitializationMode(startTime=0.0)
        fmu.setFloat64([reference['input']], [u[0]])
        fmu.exitInitializationMode()
        y = np.empty(n)
        for k in range(n):
            y[k], = fmu.getFloat64([reference['output']])
            fmu.setFloat64([reference['input'], reference['others']], [u[k], others[k]])
            if k == n // 2:
                saved = fmu.serializeFMUState(fmu.getFMUState())
                fmu.doStep(k * period_s, period_s)
                fmu.setFMUState(fmu.deserializeFMUState(saved))
            fmu.doStep(k * period_s, period_s)
        fmu.terminate()
        fmu.reset()
        y.tofile(out)
fmu.freeInstance()
shutil.rmtree(folder)
";

#[test]
fn an_fmu_moves_as_the_library_does() {
    if !is_there(&python(), &["-c", "import fmpy"]) {
        return skipped("no Python with `fmpy` (PYTHON names another)");
    }
    if !is_there("cc", &["--version"]) {
        return skipped("no `cc` for the binary of an FMU");
    }
    let folder = tempfile::tempdir().unwrap();
    let records = records(4, 1200);
    for (name, model) in models() {
        export(folder.path(), &name, &model, "fmu");
        let mut python = Command::new(python());
        python.args(["-c", &MAIN_FMU.replace("MODEL", &name)]);
        let found = run(folder.path(), &name, &records, &mut python);
        assert_same(&name, &model, &records, &found);
    }
}

/// An effect that a program made in Rust.
#[derive(Debug)]
struct Foreign;

impl Effect for Foreign {
    fn spec(&self) -> &'static tauscope::effect::Spec {
        use tauscope::effect::{Spec, Stage};
        static SPEC: Spec = Spec::new("foreign", Stage::Input, "nobody knows");
        &SPEC
    }

    fn step(&self, _: &[f64], _: &mut [f64], at: &tauscope::effect::Moment) -> f64 {
        at.signal
    }
}

#[test]
fn an_effect_that_cannot_be_exported_is_refused_by_name() {
    let plain = JointModel::integrator(1.0, 0.1);
    let foreign = plain.with(Component::neutral(&Foreign));
    let refused = Export::new("boom", &foreign, Units::default(), &[]).unwrap_err();
    assert_eq!(refused, ExportError::NoEquations { effect: "foreign" });
    let measured = Component::measured(&tauscope::effect::VariableDelay).unwrap();
    let refused = Export::new("boom", &plain.with(measured), Units::default(), &[]).unwrap_err();
    assert_eq!(refused, ExportError::MeasuredDelays { effect: "variable_delay" });
}

const MODEL: &str = "schema = \"tauscope/model/1\"
[joint.boom]
structure = \"integrator\"
parameters = { gain = 11.9, delay = 0.15 }
[joint.arm]
structure = \"integrator\"
parameters = { gain = 11.9, delay = 0.15 }
[[joint.arm.effect]]
kind = \"variable_delay\"
parameters = { per_step = 1 }
";

fn tauscope(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    fs::write(folder.join("model.toml"), MODEL).unwrap();
    let done = Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .args(["export", "model.toml"])
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    (done.status.code(), String::from_utf8(done.stderr).unwrap())
}

#[test]
fn what_cannot_be_written_is_refused_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, why) in [
        (vec!["--joint", "boom", "boom.txt"], ".c, .h, .py, .m, .fmu"),
        (vec!["--joint", "boom", "my boom.py"], "is not a name in Python"),
        (vec!["--joint", "bom", "boom.c"], "did you mean `boom`?"),
        (vec!["boom.c"], "`--joint` takes one of arm, boom"),
        (vec!["--joint", "arm", "arm.c"], "effect `variable_delay` cannot be exported"),
    ] {
        let (status, said) = tauscope(folder.path(), &arguments);
        assert_eq!(status, Some(2), "{said}");
        assert!(said.contains(why), "{said}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn the_header_is_written_with_the_source_and_says_each_parameter() {
    let folder = tempfile::tempdir().unwrap();
    let units = ["--input-unit", "V", "--output-unit", "deg"];
    let (status, said) =
        tauscope(folder.path(), &[&["--joint", "boom", "boom.h"], &units[..]].concat());
    assert_eq!(status, Some(0), "{said}");
    let header = fs::read_to_string(folder.path().join("boom.h")).unwrap();
    assert!(header.contains("double gain; /* speed of the joint per input [deg/s/V]; 11.9 */"));
    assert!(header.contains("export from model.toml, joint boom, revision 0"));
    assert!(folder.path().join("boom.c").exists());
}

#[test]
fn words_of_a_model_file_stay_in_the_comment_that_quotes_them() {
    const HOSTILE: &str = r#"schema = "tauscope/model/1"
[joint."/ int run(void){return 42;} /"]
structure = "integrator"
parameters = { gain = 7.0, delay = 0.2 }
[[joint."/ int run(void){return 42;} /".effect]]
kind = "expression"
id = "knee"
summary = "*@JOINT@* @ORIGIN@ @EFFECTS@ @NAME@"
stage = "input"
expression = "signal + off"
parameters.off = { value = 0.1 }
"#;
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("hostile.toml"), HOSTILE).unwrap();
    for name in ["words.c", "words.m", "words.py"] {
        let done = Command::new(env!("CARGO_BIN_EXE_tauscope"))
            .args(["export", "hostile.toml", name])
            .current_dir(folder.path())
            .status()
            .unwrap();
        assert!(done.success());
        let text = fs::read_to_string(folder.path().join(name)).unwrap();
        assert!(text.contains("*@JOINT@* @ORIGIN@ @EFFECTS@"), "{text}");
        assert!(!text.contains("*/ int"), "{text}");
    }
}

#[test]
fn an_fmu_without_a_compiler_says_so() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("model.toml"), MODEL).unwrap();
    let done = Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .args(["export", "model.toml", "--joint", "boom", "boom.fmu"])
        .env("CC", "no-such-compiler")
        .current_dir(folder.path())
        .output()
        .unwrap();
    let said = String::from_utf8(done.stderr).unwrap();
    assert!(done.status.success() && said.contains("no C compiler `no-such-compiler`"), "{said}");
    assert!(folder.path().join("boom.fmu").exists());
}
