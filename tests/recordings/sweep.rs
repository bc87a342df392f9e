//! A recording of a sweep holds the delays of the sweep, exactly, and shows which of them
//! move.
#![cfg(feature = "rrd")]

use std::process::Command;

use crate::read_back::{ReadBack, places, whole};
use rerun::Loggable as _;
use rerun::components::ImageBuffer;
use rerun::external::arrow::array::{Array, AsArray as _};
use rerun::external::arrow::datatypes::Float64Type;
use tauscope::batch::Threads;
use tauscope::delay::sweep::{Base, Factor, Grid, SweptStep};
use tauscope::delay::{Method, Settings};
use tauscope::experiment::{Experiment, ReadOptions};
use tauscope::numerics::LowPass;
use tauscope::recording::{SweepRecording, write_sweep};
use tauscope::report::ReportedSweep;
use tauscope::study::{SweptJoint, sweep_joints};
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate, write_log};

/// An ideal joint and one after a lag, which `lag-aware` alone tells from delay.
struct Swept {
    experiment: Experiment,
    grid: Grid,
    joints: Vec<SweptJoint>,
    folder: tempfile::TempDir,
}

fn grid() -> Grid {
    let base = |method| {
        let settings = Settings::of(method);
        let keeps_low_pass = settings.method.spec().has_intervals;
        Base { settings, keeps_low_pass }
    };
    let slow = Some(LowPass { cutoff_hz: 5.0, order: 4 });
    let methods = Method::all().filter(|method| *method != Method::AUTO);
    Grid::new(methods.map(base).collect(), vec![slow, None], vec![10], vec![1, 5])
}

impl Swept {
    fn made() -> Self {
        let input = InputSpec::Levels { levels: vec![-1.0, -0.5, 0.5, 1.0], hold_s: [0.9, 2.0] };
        let delay = DelayLaw::Uniform { min: 0.05, max: 0.4 };
        let arm = JointSpec { noise: 0.05, ..JointSpec::new("arm", input, delay) };
        let boom = JointSpec { lag_s: Some(0.06), name: "boom".to_owned(), ..arm.clone() };
        let made = simulate(&PlantSpec::new(3, 40.0, vec![arm, boom])).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        write_log(&made, std::fs::File::create(&path).unwrap()).unwrap();
        let experiment = Experiment::read(&[path], &ReadOptions::default());
        let grid = grid();
        let joints = sweep_joints(&experiment.joints, |_| grid.clone(), 2.0, || (), &Threads);
        let joints = joints.into_iter().map(Result::unwrap).collect();
        Self { experiment, grid, joints, folder }
    }

    fn bytes(&self) -> Vec<u8> {
        let joints = self.experiment.joints.iter().zip(&self.joints);
        let joints: Vec<_> =
            joints.map(|(joint, swept)| ReportedSweep { joint, sweep: &swept.sweep }).collect();
        let mut bytes = Vec::new();
        let recording = SweepRecording {
            joints: &joints,
            grid: &self.grid,
            tolerance: 2.0,
            sources: &self.experiment.sources,
            reading: &self.experiment.options,
        };
        write_sweep(&recording, &mut bytes).unwrap();
        bytes
    }

    fn steps(&self, joint: usize) -> &[SweptStep] {
        &self.joints[joint].sweep.steps
    }

    /// The delay that each run tells of a step.
    fn delays(step: &SweptStep) -> Vec<Option<f64>> {
        step.delays.iter().map(|told| told.map(|told| told.delay)).collect()
    }
}

/// A cell with a number per run or step, or none.
fn optional(cell: &dyn Array) -> Vec<Option<f64>> {
    cell.as_primitive::<Float64Type>().iter().collect()
}

#[test]
fn every_delay_is_there_by_setting_and_by_step() {
    let swept = Swept::made();
    let back = ReadBack::of(&swept.bytes());
    for (joint, name) in ["arm", "boom"].into_iter().enumerate() {
        let steps = swept.steps(joint);
        let by_step = back.rows(&format!("/{name}/sweep/step"), "delays", optional);
        assert_eq!(by_step.len(), steps.len());
        for ((number, (times, delays)), step) in by_step.iter().enumerate().zip(steps) {
            assert_eq!(delays, &Swept::delays(step));
            // One trial, from zero on: samples are those of the log.
            assert_eq!(times["segment"], whole(number + 1));
            assert_eq!(times["sample"], whole(step.sample));
            assert_eq!(times["time"], 10_000_000 * (whole(step.sample) - 1));
        }
        let by_setting = back.rows(&format!("/{name}/sweep/setting"), "delays", optional);
        assert_eq!(by_setting.len(), swept.grid.runs().len());
        for (run, (times, delays)) in by_setting.iter().enumerate() {
            assert_eq!(times["setting"], whole(run + 1));
            let expected: Vec<_> = steps.iter().map(|step| Swept::delays(step)[run]).collect();
            assert_eq!(delays, &expected);
        }
    }
}

#[test]
fn settings_and_what_is_agreed_on_are_those_of_the_sweep() {
    let swept = Swept::made();
    let back = ReadBack::of(&swept.bytes());
    let runs = swept.grid.runs();
    let alpha = back.integers("/boom/sweep/setting", "alpha");
    assert_eq!(alpha.iter().map(|row| row.1).collect::<Vec<_>>(), vec![10; runs.len()]);
    // The broken lines know no β.
    let beta = back.integers("/boom/sweep/setting", "beta");
    assert_eq!(beta.iter().map(|row| row.1).collect::<Vec<_>>(), [1, 5, 1, 5]);
    let votes = back.integers("/boom/sweep/setting", "combinations");
    assert_eq!(votes.iter().map(|row| row.1).sum::<i64>(), whole(swept.grid.combinations().len()));
    let methods = back.texts("/boom/sweep/setting", "method");
    assert!(methods.iter().zip(runs).all(|((_, id), run)| *id == run.method.to_string()));
    let sweep = &swept.joints[1].sweep;
    let agrees = back.numbers("/boom/sweep/setting", "agrees");
    let expected: Vec<f64> = sweep.runs.iter().flatten().filter_map(|run| run.agrees).collect();
    assert_eq!(agrees.iter().map(|row| row.1).collect::<Vec<_>>(), expected);
    let agreed = back.numbers("/boom/sweep/step", "agreed");
    let expected: Vec<f64> =
        sweep.steps.iter().filter_map(|step| Some(step.agreement?.delay)).collect();
    assert_eq!(agreed.iter().map(|row| row.1).collect::<Vec<_>>(), expected);
    let hangs = back.texts("/boom/sweep/step", "delay_hangs_on");
    let on_method = sweep.steps.iter().filter(|step| {
        step.delay_depends_on.as_ref().is_some_and(|hanging| hanging.factor == Factor::Method)
    });
    assert_eq!(hangs.iter().filter(|(_, on)| on == "method").count(), on_method.count());
}

/// Who says otherwise is seen without reading: a colour for longer delays, one for shorter.
#[test]
fn the_picture_has_a_row_per_combination_and_a_column_per_step() {
    let swept = Swept::made();
    let back = ReadBack::of(&swept.bytes());
    let combinations = swept.grid.combinations();
    for (joint, name) in ["arm", "boom"].into_iter().enumerate() {
        let steps = swept.steps(joint);
        let buffer = back.fixed(&format!("/{name}/sheet/map"), "Image:buffer");
        let buffer = ImageBuffer::from_arrow(buffer.as_ref()).unwrap().remove(0);
        let pixels = buffer.0.as_chunks::<3>().0.to_vec();
        assert_eq!(pixels.len(), combinations.len() * steps.len());
        for (row, one) in pixels.chunks(steps.len()).zip(combinations) {
            for (&[red, _, blue], step) in row.iter().zip(steps) {
                let told = step.delays[one.run];
                let agreed = step.agreement.zip(told);
                match agreed {
                    None => assert_eq!((red, blue), (0, 0), "not accepted"),
                    Some((agreed, told)) if agreed.holds(&told) => assert!(red.max(blue) < 80),
                    Some((agreed, told)) if told.delay > agreed.delay => assert!(red > blue),
                    Some(_) => assert!(blue > red && blue > 80),
                }
            }
        }
    }
    // The last third is `lag-aware`, whose delays are shorter after the lag where a straight response
    // fits far from its onset alone.
    let steps = swept.steps(1);
    let shorter = back.points("/boom/sheet/shorter").len();
    let accepted = steps.iter().filter(|step| step.accepted > 0).count();
    assert!(10 * shorter >= 3 * accepted, "{shorter} of {accepted}");
}

#[test]
fn the_cursor_goes_through_settings_and_through_steps() {
    let swept = Swept::made();
    let back = ReadBack::of(&swept.bytes());
    assert_eq!(back.opens_on, "setting");
    let steps = swept.steps(1);
    let delays = back.rows("/boom/sheet/setting/delays", "Points2D:positions", |c| places(c).len());
    for (times, count) in &delays {
        let run = usize::try_from(times["setting"]).unwrap() - 1;
        assert_eq!(*count, steps.iter().filter(|step| step.delays[run].is_some()).count());
    }
    assert_eq!(delays.len(), swept.grid.runs().len());
    let pages = back.texts("/boom/here", "TextDocument:text");
    let (of_settings, of_steps): (Vec<_>, Vec<_>) =
        pages.into_iter().partition(|(times, _)| times.contains_key("setting"));
    assert!(of_settings[0].1.starts_with("## two-line, 5 Hz, α 10, β 1\n"), "{of_settings:?}");
    assert_eq!(of_settings.len(), swept.grid.runs().len());
    assert_eq!(of_steps.len(), steps.len());
    let hanging: Vec<&SweptStep> = steps.iter().filter(|s| s.delay_depends_on.is_some()).collect();
    for step in &hanging {
        let (_, page) = &of_steps[step.number - 1];
        assert!(page.starts_with(&format!("## Step {} of trial 1", step.number)), "{page}");
        assert!(page.contains("median delay | agree with most"), "{page}");
    }
    let list = back.texts("/boom/hanging/log", "TextLog:text");
    assert_eq!(list.len(), swept.joints[1].sweep.sensitive().len());
    assert!(list.iter().all(|(times, _)| times["setting"] == 1), "all of them are always there");
}

#[test]
fn words_are_those_of_the_text_and_tell_what_it_was_made_from() {
    let swept = Swept::made();
    let back = ReadBack::of(&swept.bytes());
    let text = |entity: &str| {
        let cell = back.fixed(entity, "TextDocument:text");
        cell.as_string::<i32>().value(0).to_owned()
    };
    let found = text("/boom/found");
    assert!(found.contains("depend on the method"), "{found}");
    assert!(found.contains("all are too late by about the lag"), "{found}");
    assert!(found.contains("| no low-pass |"), "{found}");
    let about = text("/about");
    assert!(about.contains(&swept.experiment.sources[0].sha256), "{about}");
    assert!(about.contains("| β | β 1, β 5 |") && about.contains("12 combinations"), "{about}");
    assert!(back.blueprint > 10);
}

#[test]
fn two_runs_give_the_same_bytes() {
    let swept = Swept::made();
    assert!(swept.bytes() == swept.bytes());
}

#[test]
fn the_command_writes_what_the_library_does() {
    let swept = Swept::made();
    let options = "sweep log.csv --alpha 10 --beta 1,5 --passband 5,none --method two-line -q";
    let run = |threads: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_tauscope"))
            .current_dir(swept.folder.path())
            .args(options.split(' '))
            .args(["--threads", threads, "-o", "sweep.rrd"])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        std::fs::read(swept.folder.path().join("sweep.rrd")).unwrap()
    };
    let bytes = run("1");
    assert!(bytes == run("3"));
    let back = ReadBack::of(&bytes);
    let delays = back.rows("/arm/sweep/setting", "delays", optional);
    let expected: Vec<Vec<Option<f64>>> = (0..4)
        .map(|run| swept.steps(0).iter().map(|step| Swept::delays(step)[run]).collect())
        .collect();
    assert_eq!(delays.into_iter().map(|row| row.1).collect::<Vec<_>>(), expected);
    let refused = Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .current_dir(swept.folder.path())
        .args(["sweep", "log.csv", "-o", "log.csv"])
        .output()
        .unwrap();
    assert_eq!(refused.status.code(), Some(2), "the log is not overwritten");
}
