//! A recording read back holds the numbers of the log and of `--decisions`, exactly.
#![cfg(feature = "rrd")]
#![expect(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{self, Cursor, Write};
use std::path::PathBuf;

use rerun::external::arrow::array::{
    Array, ArrayRef, AsArray as _, Float32Array, Float64Array, Int64Array,
};
use rerun::external::re_log_encoding::DecoderApp;
use rerun::log::{Chunk, LogMsg};
use tauscope::batch::{
    JointEstimate, Mode, Protocol, compare_joints, estimate_joints, improve_joints,
};
use tauscope::delay::{Decision, FineDelay, Method, Settings};
use tauscope::diagnosis::Comparison;
use tauscope::effect::find;
use tauscope::experiment::{Experiment, Joint, ReadOptions};
use tauscope::explain::{Change, Improvement, Options, Verdict};
use tauscope::fit::Horizon;
use tauscope::model::integrators;
use tauscope::recording::{Beside, Detail, RecordError, Recording, write_recording};
use tauscope::report::{
    ComparedJoint, DecisionRow, EstimatedJoint, Finding, ImprovedJoint, decision_rows, number,
};
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate, write_log};

/// Two joints, half a minute, with the estimate of their delays.
struct Recorded {
    experiment: Experiment,
    estimates: Vec<JointEstimate>,
    settings: Settings,
}

impl Recorded {
    fn with(settings: Settings) -> Self {
        let boom = DelayLaw::Constant { seconds: 0.2 };
        let stick = DelayLaw::Uniform { min: 0.02, max: 0.4 };
        Self::of([("boom", boom), ("stick", stick)], 30.0, settings)
    }

    fn of<const N: usize>(laws: [(&str, DelayLaw); N], seconds: f64, settings: Settings) -> Self {
        let joint = |(name, law): (&str, DelayLaw)| {
            let input =
                InputSpec::Levels { levels: vec![-1.0, -0.5, 0.5, 1.0], hold_s: [0.6, 1.5] };
            JointSpec { noise: 0.02, ..JointSpec::new(name, input, law) }
        };
        Self::made(laws.map(joint).to_vec(), seconds, settings)
    }

    fn made(joints: Vec<JointSpec>, seconds: f64, settings: Settings) -> Self {
        let made = simulate(&PlantSpec::new(5, seconds, joints)).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        write_log(&made, std::fs::File::create(&path).unwrap()).unwrap();
        let experiment = Experiment::read(&[path], &ReadOptions::default());
        let estimates = estimate_joints(&experiment.joints, &settings, || ());
        let estimates = estimates.into_iter().map(Result::unwrap).collect();
        Self { experiment, estimates, settings }
    }

    fn joints(&self) -> Vec<EstimatedJoint<'_>> {
        let pairs = self.experiment.joints.iter().zip(&self.estimates);
        pairs.map(|(joint, estimate)| EstimatedJoint { joint, estimate }).collect()
    }

    fn write(&self, detail: Detail, out: impl Write) -> Result<(), RecordError> {
        self.write_with(&[], detail, out)
    }

    fn write_with(
        &self,
        models: &[ComparedJoint<'_>],
        detail: Detail,
        out: impl Write,
    ) -> Result<(), RecordError> {
        self.write_all(models, &[], detail, out)
    }

    fn write_all(
        &self,
        models: &[ComparedJoint<'_>],
        revisions: &[ImprovedJoint<'_>],
        detail: Detail,
        out: impl Write,
    ) -> Result<(), RecordError> {
        self.write_beside(models, &[], revisions, detail, out)
    }

    fn write_beside(
        &self,
        models: &[ComparedJoint<'_>],
        also: &[Beside<'_>],
        revisions: &[ImprovedJoint<'_>],
        detail: Detail,
        out: impl Write,
    ) -> Result<(), RecordError> {
        let joints = self.joints();
        let (settings, sources) = (&self.settings, self.experiment.sources.as_slice());
        let reading = &self.experiment.options;
        write_recording(
            &Recording {
                joints: &joints,
                settings,
                sources,
                reading,
                detail,
                models,
                also,
                revisions,
            },
            out,
        )
    }

    /// Each joint beside the integrator that its delays suggest.
    fn compared(&self) -> Vec<Comparison> {
        let joints = &self.experiment.joints;
        let estimates: Vec<_> = self.estimates.iter().cloned().map(Ok).collect();
        let model = |joint: &Joint| {
            let place = joints.iter().position(|known| known.name == joint.name).unwrap();
            let estimated: Vec<_> = self.estimates[place].estimated().collect();
            integrators(joint, &estimated).into_iter().next()
        };
        let horizon = Horizon::FreeRun;
        let protocol = Protocol { mode: Mode::AsItIs, split: None, horizon };
        let compared = compare_joints(joints, &estimates, model, protocol);
        compared.into_iter().map(|result| result.unwrap().unwrap()).collect()
    }

    /// Each joint as it is improved, with the effects of a short list.
    fn improved(&self) -> Vec<Improvement> {
        let joints = &self.experiment.joints;
        let estimates: Vec<_> = self.estimates.iter().cloned().map(Ok).collect();
        let horizon = Horizon::Steps;
        let protocol = Protocol { mode: Mode::FitOrIntegrator, split: None, horizon };
        let effects = ["dead_band", "actuator_lag", "thermal_drift"].map(|id| find(id).unwrap());
        let options = Options { effects: effects.to_vec(), max_effects: 3 };
        let start = |_: &Joint| None;
        let improved = improve_joints(joints, &estimates, start, protocol, &options, |_, _| true);
        improved.into_iter().map(|result| result.unwrap().unwrap()).collect()
    }

    /// What is read back of a recording of `improvements`.
    fn read_back_grown(&self, improvements: &[Improvement]) -> ReadBack {
        let joints = self.experiment.joints.iter().zip(improvements);
        let grown = joints.map(|(joint, improvement)| grown(joint, improvement));
        let mut bytes = Vec::new();
        self.write_all(&[], &grown.collect::<Vec<_>>(), Detail::Full, &mut bytes).unwrap();
        ReadBack::of(&bytes)
    }

    fn read_back(&self, detail: Detail) -> ReadBack {
        let mut bytes = Vec::new();
        self.write(detail, &mut bytes).unwrap();
        ReadBack::of(&bytes)
    }
}

fn grown<'a>(joint: &'a Joint, improvement: &'a Improvement) -> ImprovedJoint<'a> {
    let Improvement { revisions, verdict } = improvement;
    let last = revisions.last().unwrap();
    let revision = u32::try_from(revisions.len() - 1).unwrap();
    let comparison = &last.comparison;
    let compared = ComparedJoint { joint, model: "model", revision, comparison };
    let ranking = &last.ranking;
    let finding = Finding { compared, verdict: *verdict, ranking, add_arguments: "log.csv" };
    ImprovedJoint::of(finding, revisions)
}

/// The chunks of a recording, by entity; the blueprint apart.
struct ReadBack {
    chunks: BTreeMap<String, Vec<Chunk>>,
    blueprint: usize,
    /// The timeline that is active when the viewer opens.
    opens_on: String,
}

impl ReadBack {
    fn of(bytes: &[u8]) -> Self {
        let mut chunks: BTreeMap<String, Vec<Chunk>> = BTreeMap::new();
        let (mut blueprint, mut opens_on) = (0, String::new());
        for message in DecoderApp::decode_lazy(Cursor::new(bytes)) {
            if let LogMsg::ArrowMsg(store, message) = message.unwrap() {
                if store.is_blueprint() {
                    blueprint += 1;
                }
                let chunk = Chunk::from_arrow_msg(&message).unwrap();
                if store.is_blueprint() {
                    let timeline = "TimePanelBlueprint:timeline".into();
                    if let Some(cell) = chunk.components().get_array(timeline) {
                        cell.value(0).as_string::<i32>().value(0).clone_into(&mut opens_on);
                    }
                    continue;
                }
                chunks.entry(chunk.entity_path().to_string()).or_default().push(chunk);
            }
        }
        Self { chunks, blueprint, opens_on }
    }

    /// Each row of a component that has one value: its times and the value.
    fn rows<T>(
        &self,
        entity: &str,
        component: &'static str,
        value: impl Fn(&dyn Array) -> T,
    ) -> Vec<(BTreeMap<String, i64>, T)> {
        let mut rows = Vec::new();
        for chunk in self.chunks.get(entity).into_iter().flatten() {
            let Some(list) = chunk.components().get_array(component.into()) else { continue };
            if chunk.is_static() {
                continue;
            }
            for row in 0..list.len() {
                if list.is_null(row) || list.value(row).is_empty() {
                    continue;
                }
                let times = chunk.timelines().iter();
                let times = times.map(|(name, column)| (name.to_string(), column.times_raw()[row]));
                rows.push((times.collect(), value(&list.value(row))));
            }
        }
        rows
    }

    fn scalars(&self, entity: &str) -> Vec<(BTreeMap<String, i64>, f64)> {
        self.rows(entity, "Scalars:scalars", |cell| {
            cell.as_any().downcast_ref::<Float64Array>().unwrap().value(0)
        })
    }

    fn integers(&self, entity: &str, name: &'static str) -> Vec<(BTreeMap<String, i64>, i64)> {
        self.rows(entity, name, |cell| cell.as_any().downcast_ref::<Int64Array>().unwrap().value(0))
    }

    fn numbers(&self, entity: &str, name: &'static str) -> Vec<(BTreeMap<String, i64>, f64)> {
        self.rows(entity, name, |cell| {
            cell.as_any().downcast_ref::<Float64Array>().unwrap().value(0)
        })
    }

    /// What is there at all times.
    fn fixed(&self, entity: &str, component: &'static str) -> ArrayRef {
        let chunks = self.chunks[entity].iter().filter(|chunk| chunk.is_static());
        let found = chunks.filter_map(|chunk| chunk.components().get_array(component.into()));
        found.last().unwrap().value(0)
    }

    /// The points of a drawing that stays.
    fn points(&self, entity: &str) -> Vec<[f32; 2]> {
        places(&self.fixed(entity, "Points2D:positions"))
    }

    /// The texts of a drawing that stays.
    fn labels(&self, entity: &str) -> Vec<String> {
        let labels = self.fixed(entity, "Points2D:labels");
        labels.as_string::<i32>().iter().map(|label| label.unwrap().to_owned()).collect()
    }

    /// The one static cell of a component, which must be there.
    fn cell(&self, entity: &str, component: &'static str) -> ArrayRef {
        let cells = self.chunks[entity].iter().filter(|chunk| chunk.is_static());
        let mut cells = cells.filter_map(|c| c.components().get_array(component.into()));
        cells.next().unwrap().value(0)
    }

    fn list(&self, entity: &str, component: &'static str) -> Vec<f64> {
        let cell = self.cell(entity, component);
        cell.as_any().downcast_ref::<Float64Array>().unwrap().values().to_vec()
    }

    fn texts(&self, entity: &str, component: &'static str) -> Vec<(BTreeMap<String, i64>, String)> {
        self.rows(entity, component, |cell| cell.as_string::<i32>().value(0).to_owned())
    }
}

fn places(cell: &dyn Array) -> Vec<[f32; 2]> {
    let numbers = cell.as_fixed_size_list().values();
    let numbers = numbers.as_any().downcast_ref::<Float32Array>().unwrap().values();
    numbers.as_chunks::<2>().0.to_vec()
}

fn whole(number: usize) -> i64 {
    i64::try_from(number).unwrap()
}

/// Samples of the paper's method, which are whole.
#[expect(clippy::cast_possible_truncation, reason = "they are whole")]
fn samples(number: f64) -> i64 {
    number as i64
}

#[test]
fn signals_are_those_of_the_log_sample_by_sample() {
    let recorded = Recorded::with(Settings::default());
    let back = recorded.read_back(Detail::Full);
    for (joint, estimate) in recorded.experiment.joints.iter().zip(&recorded.estimates) {
        let (trial, estimate) = (&joint.trials[0], estimate.trials[0].as_ref().unwrap());
        let smoothed = estimate.smoothed.as_ref().unwrap();
        for (entity, expected) in [
            ("input", trial.input()),
            ("output/raw", trial.output()),
            ("output/smoothed", smoothed),
        ] {
            let rows = back.scalars(&format!("/{}/{entity}", joint.name));
            assert_eq!(rows.len(), expected.len());
            for ((times, value), (sample, expected)) in rows.iter().zip((1..).zip(expected)) {
                assert_eq!(times["sample"], sample);
                assert_eq!(times["time"], (sample - 1) * 10_000_000);
                assert_eq!(value.to_bits(), expected.to_bits());
            }
        }
        let tau = back.scalars(&format!("/{}/delay/tau", joint.name));
        let recorded: Vec<_> = (1..).zip(estimate.profile.iter()).collect();
        let expected = recorded.iter().filter_map(|(sample, tau)| Some((*sample, (*tau)?)));
        assert!(tau.iter().map(|(times, tau)| (times["sample"], *tau)).eq(expected));
    }
}

#[test]
fn the_table_holds_every_decision_and_every_candidate() {
    let recorded = Recorded::with(Settings::default());
    let back = recorded.read_back(Detail::Full);
    for joint in recorded.joints() {
        let entity = format!("/{}/decision/table", joint.joint.name);
        let rows: Vec<DecisionRow<'_>> = decision_rows(joint).map(|(_, row)| row).collect();
        let verdict_ticks: Vec<i64> =
            back.integers(&entity, "accepted").iter().map(|(times, _)| times["decision"]).collect();
        assert_eq!(verdict_ticks.len(), rows.len());
        let of_verdicts = |all: Vec<(BTreeMap<String, i64>, i64)>| -> Vec<i64> {
            let on_verdict =
                |times: &BTreeMap<String, i64>| verdict_ticks.contains(&times["decision"]);
            all.into_iter().filter(|(times, _)| on_verdict(times)).map(|(_, value)| value).collect()
        };
        for (name, expected) in [
            ("i", rows.iter().map(|row| whole(row.i)).collect::<Vec<_>>()),
            ("p", rows.iter().map(|row| whole(row.p)).collect()),
            ("r", rows.iter().map(|row| whole(row.r)).collect()),
            ("end", rows.iter().map(|row| whole(row.end)).collect()),
            ("f", rows.iter().filter_map(|row| row.f_opt).map(whole).collect()),
            ("q", rows.iter().filter_map(|row| row.q).map(samples).collect()),
            ("delta", rows.iter().filter_map(|row| row.delta).map(samples).collect()),
        ] {
            assert_eq!(of_verdicts(back.integers(&entity, name)), expected, "{name}");
        }
        for (name, expected) in [
            ("sse", rows.iter().map(|row| row.sse.unwrap()).collect::<Vec<_>>()),
            ("slope_before", rows.iter().map(|row| row.slope_before.unwrap()).collect()),
            ("slope_after", rows.iter().map(|row| row.slope_after.unwrap()).collect()),
        ] {
            let numbers = back.numbers(&entity, name).into_iter();
            let numbers = numbers.filter(|(times, _)| verdict_ticks.contains(&times["decision"]));
            assert!(numbers.map(|(_, value)| value).eq(expected), "{name}");
        }
        let candidates: usize = rows.iter().map(|row| row.candidates).sum();
        assert_eq!(back.integers(&entity, "j").len(), candidates);
    }
}

#[test]
fn a_delay_between_samples_is_recorded_as_finely_as_it_was_found() {
    for method in [Method::Hinge, Method::LagAware] {
        let recorded = Recorded::with(Settings::of(method));
        let back = recorded.read_back(Detail::Full);
        for joint in recorded.joints() {
            let (name, period_s) = (&joint.joint.name, joint.joint.trials[0].period().seconds());
            let decisions = || joint.estimate.estimated().flat_map(|trial| &trial.decisions);
            let accepted: Vec<f64> = decisions().filter_map(Decision::accepted_delay).collect();
            assert!(accepted.iter().any(|delay| delay.fract() != 0.0), "between samples");
            let values = |rows: Vec<(BTreeMap<String, i64>, f64)>| -> Vec<f64> {
                rows.into_iter().map(|(_, value)| value).collect()
            };
            let column = |entity: &str, column| values(back.numbers(entity, column));
            let fine = |part: fn(FineDelay) -> f64| -> Vec<f64> {
                decisions().filter_map(|decision| decision.fine).map(part).collect()
            };
            let table = format!("/{name}/decision/table");
            assert_eq!(column(&table, "fine_delta"), fine(|fine| fine.delay));
            assert_eq!(column(&table, "delta_low"), fine(|fine| fine.low));
            assert_eq!(column(&table, "delta_high"), fine(|fine| fine.high));
            let state = format!("/{name}/delay/state");
            assert_eq!(column(&state, "fine_delta"), accepted);
            let seconds: Vec<f64> = accepted.iter().map(|delay| delay * period_s).collect();
            assert_eq!(column(&state, "delay_s"), seconds);
            assert_eq!(values(back.scalars(&format!("/{name}/delay/accepted"))), accepted);
            let bars = format!("/{name}/drawing/interval");
            let bars = back.rows(&bars, "LineStrips2D:strips", |_| ());
            assert_eq!(bars.len(), fine(|fine| fine.delay).len());
            let texts = back.texts(&format!("/{name}/verdict"), "TextDocument:text");
            for (decision, (_, text)) in decisions().zip(texts) {
                let shown = decision.fine.map(|fine| number(fine.low)).unwrap_or_default();
                assert!(text.contains(&format!("| 95 % interval of δ | {shown} … ")), "{text}");
                let lag = text.contains("| lag behind the dead time | none |");
                assert_eq!(lag, method == Method::LagAware, "{text}");
            }
        }
    }
    let paper = Recorded::with(Settings::default()).read_back(Detail::Full);
    assert!(paper.numbers("/boom/decision/table", "fine_delta").is_empty());
    assert!(!paper.chunks.contains_key("/boom/drawing/interval"));
}

#[test]
fn what_another_method_decided_is_drawn_beside_the_first() {
    let recorded = Recorded::with(Settings::of(Method::LagAware));
    let settings = Settings { keep_first_last: true, ..Settings::default() };
    let other = estimate_joints(&recorded.experiment.joints, &settings, || ());
    let other: Vec<JointEstimate> = other.into_iter().map(Result::unwrap).collect();
    let pairs = recorded.experiment.joints.iter().zip(&other);
    let joints: Vec<_> =
        pairs.map(|(joint, estimate)| EstimatedJoint { joint, estimate }).collect();
    let also = [Beside { settings: &settings, joints: &joints }];
    let mut bytes = Vec::new();
    recorded.write_beside(&[], &also, &[], Detail::Full, &mut bytes).unwrap();
    let back = ReadBack::of(&bytes);
    for (joint, first) in joints.iter().zip(recorded.joints()) {
        let name = &joint.joint.name;
        let firsts = first.estimate.estimated().flat_map(|trial| &trial.decisions);
        let decisions: Vec<_> =
            joint.estimate.estimated().flat_map(|trial| &trial.decisions).collect();
        let drawn = back.rows(&format!("/{name}/drawing/other_0"), "LineStrips2D:strips", |_| ());
        assert_eq!(drawn.len(), decisions.len());
        let legend = back.texts(&format!("/{name}/drawing/other_0_name"), "Points2D:labels");
        let pages = back.texts(&format!("/{name}/verdict"), "TextDocument:text");
        assert_eq!((legend.len(), pages.len()), (drawn.len(), drawn.len()));
        let shown = legend.iter().zip(&pages);
        for ((first, decision), ((_, legend), (_, page))) in firsts.zip(decisions).zip(shown) {
            let delay = number(decision.delay().unwrap());
            assert!(legend.starts_with(&format!("two-line: δ = {delay} ")), "{legend}");
            assert!(page.contains(&format!("| two-line | {delay} | ")), "{page}");
            let delay = number(first.delay().unwrap());
            assert!(page.contains(&format!("| lag-aware | {delay} (")), "{page}");
        }
    }
    let alone = recorded.read_back(Detail::Full);
    assert!(!alone.chunks.contains_key("/boom/drawing/other_0"));
    assert!(!alone.texts("/boom/verdict", "TextDocument:text")[0].1.contains("| method |"));
}

#[test]
fn every_candidate_has_a_tick_and_no_tick_is_dead() {
    let recorded = Recorded::with(Settings::default());
    let back = recorded.read_back(Detail::Full);
    for (joint, estimate) in recorded.experiment.joints.iter().zip(&recorded.estimates) {
        let decisions = &estimate.trials[0].as_ref().unwrap().decisions;
        let mut tick = 0;
        let mut expected = Vec::new();
        for decision in decisions {
            tick += 1;
            for candidate in decision.candidates.iter() {
                tick += 1;
                expected.push((tick, whole(candidate.breakpoint), candidate.sse));
            }
            tick += 1;
        }
        let rows = back.scalars(&format!("/{}/decision/sse", joint.name));
        let found: Vec<_> =
            rows.iter().map(|(times, sse)| (times["decision"], times["sample"], *sse)).collect();
        assert_eq!(found, expected);
        let lines = format!("/{}/drawing/candidate", joint.name);
        let drawn = back.rows(&lines, "LineStrips2D:strips", |_| ());
        assert!(drawn.iter().map(|(times, ())| times["decision"]).eq(expected.iter().map(|e| e.0)));
    }
}

#[test]
fn a_drawing_never_shows_a_candidate_of_another_segment() {
    let recorded = Recorded::with(Settings::default());
    let back = recorded.read_back(Detail::Full);
    for joint in &recorded.experiment.joints {
        let of = |name: &str, component: &'static str| {
            back.rows(&format!("/{}/drawing/{name}", joint.name), component, |_| ())
        };
        let openings = of("borders", "LineStrips2D:strips");
        let candidates = of("candidate", "LineStrips2D:strips");
        for timeline in ["sample", "time"] {
            for (times, ()) in &candidates {
                // The drawing that is seen at the candidate's moment is the latest before it.
                let before =
                    openings.iter().filter(|(opening, ())| opening[timeline] <= times[timeline]);
                let seen = before.max_by_key(|(opening, ())| opening[timeline]).unwrap();
                assert_eq!(seen.0["segment"], times["segment"], "{timeline}");
            }
        }
    }
}

#[test]
fn each_verdict_says_why() {
    let settings = Settings { min_slope_change: 0.12, ..Settings::default() };
    let recorded = Recorded::with(settings);
    let back = recorded.read_back(Detail::Full);
    for joint in recorded.joints() {
        let texts = back.texts(&format!("/{}/verdict", joint.joint.name), "TextDocument:text");
        let rows: Vec<_> = decision_rows(joint).map(|(_, row)| row).collect();
        assert_eq!(texts.len(), rows.len());
        assert!(rows.iter().any(|row| row.verdict == "slope_change"), "the limit rejects some");
        for (row, (times, text)) in rows.iter().zip(&texts) {
            assert_eq!(times["segment"], whole(row.i));
            match row.verdict.as_str() {
                "accepted" => assert!(text.contains("✓ accepted"), "{text}"),
                failed => assert!(text.contains(&format!("**{failed}**")), "{text}"),
            }
        }
    }
}

#[test]
fn the_page_about_it_names_settings_version_and_input() {
    let recorded = Recorded::with(Settings::default());
    let back = recorded.read_back(Detail::Full);
    let chunk = &back.chunks["/about"][0];
    let text = chunk.components().get_array("TextDocument:text".into()).unwrap().value(0);
    let text = text.as_string::<i32>().value(0).to_owned();
    for wanted in [
        recorded.experiment.sources[0].sha256.as_str(),
        env!("CARGO_PKG_VERSION"),
        "5 samples",
        "Butterworth, 5 Hz",
        "All ",
    ] {
        assert!(text.contains(wanted), "{wanted} is not in {text}");
    }
    assert!(back.blueprint > 20, "the views come with it");
}

#[test]
fn lean_keeps_rejected_segments_whole_and_says_so() {
    let settings = Settings { min_slope_change: 0.12, beta: 1, ..Settings::default() };
    let recorded = Recorded::with(settings);
    let back = recorded.read_back(Detail::Lean);
    for joint in recorded.joints() {
        let entity = format!("/{}/decision/table", joint.joint.name);
        let numbers = back.integers(&entity, "i");
        let candidates = back.integers(&entity, "j");
        for row in decision_rows(joint).map(|(_, row)| row) {
            let ticks: Vec<_> = numbers.iter().filter(|(_, i)| *i == whole(row.i)).collect();
            let kept = ticks.len() - 1;
            match row.verdict.as_str() {
                "accepted" => assert!(kept <= 25 && kept < row.candidates),
                _ => assert_eq!(kept, row.candidates),
            }
            let best = candidates.iter().any(|(times, j)| {
                Some(*j) == row.f_opt.map(whole) && times["segment"] == whole(row.i)
            });
            assert!(best, "the best candidate is always there");
        }
    }
    let about =
        back.chunks["/about"][0].components().get_array("TextDocument:text".into()).unwrap();
    assert!(about.value(0).as_string::<i32>().value(0).contains("--detail lean"));
}

#[test]
fn two_runs_give_the_same_chunks_in_the_same_order() {
    // Not the same bytes: the encoder writes a column's metadata in no fixed order.
    let recorded = Recorded::with(Settings::default());
    let batches = || {
        let mut bytes = Vec::new();
        recorded.write(Detail::Full, &mut bytes).unwrap();
        let messages = DecoderApp::decode_lazy(Cursor::new(bytes)).map(Result::unwrap);
        let batch = |message| match message {
            LogMsg::ArrowMsg(store, message) => {
                Some((store, message.chunk_id, message.batch.clone()))
            }
            _ => None,
        };
        messages.filter_map(batch).collect::<Vec<_>>()
    };
    assert!(batches() == batches());
}

#[test]
fn figures_of_a_model_are_those_of_its_comparison() {
    let recorded = Recorded::with(Settings::default());
    let comparisons = recorded.compared();
    let named =
        |(joint, comparison)| ComparedJoint { joint, model: "plain", revision: 0, comparison };
    let models: Vec<_> = recorded.experiment.joints.iter().zip(&comparisons).map(named).collect();
    let mut bytes = Vec::new();
    recorded.write_with(&models, Detail::Full, &mut bytes).unwrap();
    let back = ReadBack::of(&bytes);
    for ComparedJoint { joint, comparison, .. } in models {
        let of = |part: &str| format!("/{}/model/plain/{part}", joint.name);
        let (regions, count) = (of("regions"), comparison.regions.len());
        let share = comparison.regions.iter().map(|region| region.share_of_squared_error);
        assert!(back.list(&regions, "share_of_squared_error").into_iter().eq(share));
        let upper = comparison.regions.iter().map(|region| region.to);
        assert!(back.list(&regions, "to").into_iter().eq(upper));
        let features = back.cell(&regions, "feature");
        let features: Vec<_> = features.as_string::<i32>().iter().map(Option::unwrap).collect();
        assert!(features.iter().copied().eq(comparison.regions.iter().map(|r| r.feature.id())));
        let white = comparison.whiteness.as_ref().unwrap();
        assert_eq!(back.list(&of("whiteness"), "correlation"), white.correlation);
        assert_eq!(back.list(&of("whiteness"), "band"), [white.band]);
        let input = comparison.input_correlation.as_ref().unwrap();
        assert_eq!(back.list(&of("input_correlation"), "acting"), input.acting.correlation);
        assert_eq!(back.list(&of("input_correlation"), "raw"), input.raw.correlation);
        let lags = back.list(&of("input_correlation"), "lag_s");
        assert!(
            lags.len() == 401 && (lags[0] + 2.0).abs() < 1e-9 && (lags[400] - 2.0).abs() < 1e-9
        );
        let page = back.cell(&format!("/{}/model_page", joint.name), "TextDocument:text");
        let page = page.as_string::<i32>().value(0).to_owned();
        assert!(page.contains("simulations, free run"), "{page}");
        // What is drawn: a mark per part, and a curve in each of three plots.
        let drawn =
            |part: &str| back.cell(&format!("/{}/{part}", joint.name), "LineStrips2D:strips").len();
        assert_eq!(drawn("error_share/time"), count);
        assert!(drawn("error_share/bars/0") > count);
        assert_eq!((drawn("correlation/curve/0"), drawn("correlation/band/0")), (3, 6));
    }
}

/// A joint with a dead band, and a slow spool.
fn lacking() -> Recorded {
    let input = InputSpec::Levels { levels: vec![-2.0, -1.0, -0.5, 0.5, 1.0], hold_s: [0.6, 1.5] };
    let delay = DelayLaw::Constant { seconds: 0.2 };
    let joint = JointSpec {
        noise: 0.02,
        dead_band: Some([-0.3, 0.4]),
        lag_s: Some(0.1),
        ..JointSpec::new("boom", input, delay)
    };
    Recorded::made(vec![joint], 60.0, Settings::default())
}

#[test]
fn the_error_falls_along_the_revisions_as_in_the_report() {
    let recorded = lacking();
    let improvements = recorded.improved();
    let back = recorded.read_back_grown(&improvements);
    let revisions = &improvements[0].revisions;
    assert_eq!(improvements[0].verdict, Verdict::Adequate);
    let of = |name: &str| {
        let rows = back.scalars(&format!("/boom/revision/{name}"));
        let alone = rows.iter().all(|(times, _)| times.len() == 1);
        assert!(alone, "numbers lie on `revision` alone");
        rows.into_iter().map(|(times, value)| (times["revision"], value)).collect::<Vec<_>>()
    };
    let expected = |value: fn(&Comparison) -> f64| {
        let values = revisions.iter().map(|revision| value(&revision.comparison));
        (0..).zip(values).collect::<Vec<_>>()
    };
    let validation = of("validation_rmse");
    assert_eq!(validation, expected(|c| c.validation.unwrap().rmse));
    assert_eq!(of("training_rmse"), expected(|c| c.training.unwrap().rmse));
    assert_eq!(of("noise_floor"), expected(|c| c.noise_floor.unwrap()));
    assert!(validation.windows(2).all(|pair| pair[1].1 < pair[0].1), "{validation:?}");
    let mut added: Vec<_> = back.texts("/boom/revision/added", "TextDocument:text");
    added.sort_by(|a, b| a.1.cmp(&b.1));
    let added: Vec<_> = added.iter().map(|(_, id)| id.as_str()).collect();
    assert_eq!(added, ["actuator_lag", "dead_band"]);
    assert!(back.texts("/boom/revision/removed", "TextDocument:text").is_empty());
    assert_eq!(back.opens_on, "revision");
}

#[test]
fn every_drawing_changes_with_the_revision_and_is_on_every_timeline() {
    let recorded = lacking();
    let improvements = recorded.improved();
    let back = recorded.read_back_grown(&improvements);
    let count = improvements[0].revisions.len();
    let strips = "LineStrips2D:strips";
    // The rungs of the ladder stay; the one at hand is bright.
    for (part, component) in [
        ("record/simulated", strips),
        ("record/residual", strips),
        ("share/bars", strips),
        ("sheet/ladder", "LineStrips2D:colors"),
    ] {
        let rows = back.rows(&format!("/boom/revision/{part}"), component, |cell| cell.to_data());
        assert_eq!(rows.len(), count, "{part}");
        assert!(rows.windows(2).all(|pair| pair[0].1 != pair[1].1), "{part}");
        for ((times, _), revision) in rows.iter().zip(0..) {
            assert_eq!((times["revision"], times["sample"]), (revision, 1));
        }
    }
    // A bar more than there are candidates, each of as many lines as the others.
    let lines = back.rows("/boom/revision/sheet/ranking", strips, |cell| cell.len());
    for ((_, lines), revision) in lines.iter().zip(&improvements[0].revisions) {
        assert_eq!(lines % (1 + revision.ranking.len()), 0);
    }
    // What comes next is drawn through the points, but where nothing does.
    let next = back.rows("/boom/revision/sheet/proposed", strips, |cell| cell.len());
    assert!(next.iter().map(|(times, _)| times["revision"]).eq(0..whole(count) - 1));
    // A dead band shows in the speeds, a lag only in what is left behind a step.
    let titles = back.rows("/boom/revision/sheet/texts", "Points2D:labels", |cell| {
        cell.as_string::<i32>().iter().flatten().collect::<Vec<_>>().join("\n")
    });
    for ((_, titles), revision) in titles.iter().zip(improvements[0].revisions.windows(2)) {
        let title = match revision[1].change {
            Change::Added("actuator_lag") => "against the time since a step",
            _ => "while an input",
        };
        assert!(titles.contains(title), "{titles}");
    }
    let words = back.texts("/boom/revision/words", "TextDocument:text");
    for ((_, text), pair) in words.iter().zip(improvements[0].revisions.windows(2)) {
        let Change::Added(id) = pair[1].change else { panic!("{:?}", pair[1].change) };
        assert!(text.contains(&format!("{} is missing", id.replace('_', "\\_"))), "{text}");
    }
    assert!(words.last().unwrap().1.contains("nothing to add"));
}

#[test]
fn the_law_runs_through_the_speeds_once_nothing_is_missing() {
    let recorded = lacking();
    let improvements = recorded.improved();
    let back = recorded.read_back_grown(&improvements);
    let lists = |name: &'static str| {
        let rows = back.rows("/boom/revision/evidence", name, |cell| {
            cell.as_any().downcast_ref::<Float64Array>().unwrap().values().to_vec()
        });
        rows.into_iter().map(|(_, list)| list).collect::<Vec<_>>()
    };
    let (levels, speeds) = (lists("input"), lists("speed"));
    let (law_levels, law_speeds) = (lists("law_input"), lists("law_speed"));
    let missed = |at: usize| {
        let law = |level: f64| {
            let right = law_levels[at].partition_point(|known| *known < level).max(1);
            let [a, b] = [right - 1, right].map(|k| (law_levels[at][k], law_speeds[at][k]));
            a.1 + (b.1 - a.1) * (level - a.0) / (b.0 - a.0)
        };
        let squares = levels[at].iter().zip(&speeds[at]).map(|(u, v)| (v - law(*u)).powi(2));
        (squares.sum::<f64>() / levels[at].len() as f64).sqrt()
    };
    let last = levels.len() - 1;
    assert!(levels[0].len() > 30);
    assert!(missed(last) < 0.1 * missed(0), "{} of {}", missed(last), missed(0));
}

#[test]
fn a_recording_without_revisions_opens_on_the_decisions() {
    let back = Recorded::with(Settings::default()).read_back(Detail::Full);
    assert_eq!(back.opens_on, "decision");
    assert!(!back.chunks.keys().any(|entity| entity.starts_with("/boom/revision")));
}

#[test]
fn a_disk_that_is_full_is_an_error() {
    struct Full(usize);
    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0 = self.0.checked_sub(bytes.len()).ok_or(io::ErrorKind::StorageFull)?;
            Ok(bytes.len())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let recorded = Recorded::with(Settings::default());
    for room in [0, 1000, 100_000] {
        let result = recorded.write(Detail::Full, Full(room));
        assert!(matches!(result, Err(RecordError::Encode(_))), "{room}");
    }
}

#[test]
fn trials_follow_one_another_with_an_empty_row_between() {
    let folder = tempfile::tempdir().unwrap();
    let path: PathBuf = folder.path().join("two.csv");
    let mut text = String::from("trial,time_s,a.input,a.output\n");
    for trial in ["first", "second"] {
        for k in 0..100 {
            let (u, y) = (i32::from(k >= 40), f64::from((k - 50).max(0)));
            writeln!(text, "{trial},{},{u},{y}", f64::from(k) / 100.0).unwrap();
        }
    }
    std::fs::write(&path, text).unwrap();
    let experiment = Experiment::read(&[path], &ReadOptions::default());
    let settings = Settings { keep_first_last: true, low_pass: None, ..Settings::default() };
    let estimates: Vec<_> = estimate_joints(&experiment.joints, &settings, || ());
    let estimates = estimates.into_iter().map(Result::unwrap).collect();
    let recorded = Recorded { experiment, estimates, settings };
    let back = recorded.read_back(Detail::Full);
    let samples: Vec<_> = back.scalars("/a/output/raw").iter().map(|(t, _)| t["sample"]).collect();
    assert!(samples.iter().copied().eq((1..=100).chain(102..=201)));
    let lanes = back.texts("/a/trial", "StateChange:state");
    let lanes: Vec<_> =
        lanes.iter().map(|(times, name)| (times["sample"], name.as_str())).collect();
    assert_eq!(lanes, [(1, "first"), (102, "second")]);
}

#[test]
fn the_state_at_each_accepted_step_is_that_of_the_report() {
    let recorded = Recorded::with(Settings::default());
    let back = recorded.read_back(Detail::Full);
    for joint in recorded.joints() {
        let entity = format!("/{}/delay/state", joint.joint.name);
        let steps = joint.against_state().steps;
        assert!(steps.len() > 10);
        let column = |name| back.numbers(&entity, name).into_iter().map(|(_, value)| value);
        assert!(column("delay_s").eq(steps.iter().map(|step| step.delay_s)));
        assert!(column("average_speed").eq(steps.iter().map(|step| step.average_speed)));
        assert!(column("input_change").eq(steps.iter().map(|step| step.input_change)));
        assert!(column("dwell_s").eq(steps.iter().filter_map(|step| step.dwell_s)));
        assert!(column("angle").eq(steps.iter().map(|step| step.angle)));
        assert!(column("time_s").eq(steps.iter().map(|step| step.time_s)));
        let rows = decision_rows(joint).map(|(_, row)| row);
        let accepted = rows.filter(|row| row.verdict == "accepted");
        let expected =
            accepted.map(|row| (whole(row.i), whole(row.p), samples(row.delta.unwrap())));
        let deltas = back.integers(&entity, "delta").into_iter();
        let deltas = deltas.map(|(times, delta)| (times["segment"], times["sample"], delta));
        assert!(deltas.eq(expected));
    }
}

#[test]
fn the_delay_page_answers_as_the_report_and_begins_with_the_strongest() {
    let law = DelayLaw::StepSize { min: 0.05, max: 0.4, scale: 0.8 };
    let drawn = DelayLaw::Uniform { min: 0.05, max: 0.4 };
    let recorded = Recorded::of([("by_step", law), ("drawn", drawn)], 90.0, Settings::default());
    let back = recorded.read_back(Detail::Full);
    for joint in recorded.joints() {
        let page = |part: &str| format!("/{}/against/{part}", joint.joint.name);
        let found = joint.against_state();
        let titles = back.labels(&page("titles"));
        assert_eq!(titles.len(), 2 * (found.correlations.len() + 1), "a name and a finding each");
        let mut p_values = Vec::new();
        for pair in titles.chunks(2) {
            let name = pair[0].split(" [").next().unwrap().replace(' ', "_");
            let known = found.correlations.iter().find(|one| one.variable == name);
            let answer = |depends| if depends { ": depends" } else { ": not shown" };
            let (depends, p_value) = known
                .map_or((found.direction.significant, found.direction.p_value), |one| {
                    (one.significant, one.p_value)
                });
            if let Some(one) = known {
                assert!(pair[1].contains(&format!("ρ = {:+.2}", one.rho.unwrap())), "{pair:?}");
            }
            assert!(pair[1].ends_with(answer(depends)), "{pair:?}");
            p_values.push(p_value.unwrap());
        }
        assert!(p_values.is_sorted(), "{p_values:?}");
        let depends = found.correlations.iter().filter(|one| one.significant).count()
            + usize::from(found.direction.significant);
        assert_eq!(back.fixed(&page("depends"), "LineStrips2D:strips").len(), depends);
        let headline = &back.labels(&page("legend"))[0];
        match joint.joint.name.as_str() {
            "by_step" => assert!(headline.contains("depends on step size"), "{headline}"),
            _ => assert!(headline.contains("not shown to depend"), "{headline}"),
        }
    }
}

#[test]
fn the_step_under_the_cursor_is_marked_in_every_plot() {
    let recorded = Recorded::with(Settings::default());
    let back = recorded.read_back(Detail::Full);
    for joint in recorded.joints() {
        let page = |part: &str| format!("/{}/against/{part}", joint.joint.name);
        let steps = joint.against_state().steps;
        let drawn = [back.points(&page("up")), back.points(&page("down"))].concat();
        let names = [back.labels(&page("up")), back.labels(&page("down"))].concat();
        assert_eq!(drawn.len(), 6 * steps.len());
        let marked = back.rows(&page("here"), "Points2D:positions", places);
        assert!(
            marked
                .iter()
                .map(|(times, _)| times["segment"])
                .eq(steps.iter().map(|s| whole(s.number)))
        );
        // An empty row at a rejected step takes the mark away.
        let rows = back.chunks[&page("here")].iter().filter(|chunk| !chunk.is_static());
        assert_eq!(rows.map(Chunk::num_rows).sum::<usize>(), decision_rows(joint).count());
        for (times, places) in &marked {
            let name = format!("step {0} (segment {0})", times["segment"]);
            let of_step = drawn.iter().zip(&names).filter(|(_, other)| **other == name);
            assert!(of_step.clone().all(|(place, _)| places.contains(place)), "{name}");
            assert_eq!(of_step.count(), places.len());
        }
        let words = back.texts(&page("step"), "Points2D:labels");
        for ((times, words), (_, row)) in words.iter().zip(decision_rows(joint)) {
            assert_eq!(times["segment"], whole(row.i));
            match row.verdict.as_str() {
                "accepted" => {
                    let delay = format!("delay {} samples", row.delta.unwrap());
                    assert!(words.contains(&delay), "{words}");
                }
                _ => assert!(words.contains("rejected"), "{words}"),
            }
        }
    }
}

#[test]
fn where_nothing_is_accepted_the_delay_page_says_so() {
    let settings = Settings { max_sse: Some(0.0), ..Settings::default() };
    let recorded = Recorded::with(settings);
    let back = recorded.read_back(Detail::Full);
    let headline = &back.labels("/boom/against/legend")[0];
    assert!(headline.contains("0 accepted steps"), "{headline}");
    assert!(back.points("/boom/against/up").is_empty());
    assert!(back.integers("/boom/delay/state", "delta").is_empty());
}
