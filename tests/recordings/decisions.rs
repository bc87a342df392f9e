//! A recording read back holds the numbers of the log and of `--decisions`, exactly.
#![cfg(feature = "rrd")]

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::PathBuf;

use crate::read_back::{ReadBack, whole};
use crate::recorded::{Recorded, samples};
use rerun::external::arrow::array::AsArray as _;
use rerun::external::re_log_encoding::DecoderApp;
use rerun::log::{Chunk, LogMsg};
use tauscope::batch::Threads;
use tauscope::delay::{
    Condition, Decision, Doubt, FineDelay, FirstLast, Method, ReviewerVerdict, Settings, Verdict,
};
use tauscope::experiment::{Experiment, ReadOptions};
use tauscope::recording::{Detail, RecordError, Recording, write_recording};
use tauscope::report::{EstimatedJoint, decision_rows};
use tauscope::study::{JointEstimate, OtherResult, estimate_joints};
use tauscope::wording::number;

#[test]
fn signals_are_those_of_the_log_sample_by_sample() {
    let recorded = Recorded::with(Settings::of(Method::TWO_LINE));
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
    let recorded = Recorded::with(Settings::of(Method::TWO_LINE));
    let back = recorded.read_back(Detail::Full);
    for joint in recorded.joints() {
        let entity = format!("/{}/decision/table", joint.joint.name);
        let rows: Vec<_> = decision_rows(joint).map(|(_, row)| row).collect();
        let verdict_ticks: Vec<i64> =
            back.integers(&entity, "accepted").iter().map(|(times, _)| times["decision"]).collect();
        assert_eq!(verdict_ticks.len(), rows.len());
        let of_verdicts = |all: Vec<(BTreeMap<String, i64>, i64)>| -> Vec<i64> {
            let on_verdict =
                |times: &BTreeMap<String, i64>| verdict_ticks.contains(&times["decision"]);
            all.into_iter().filter(|(times, _)| on_verdict(times)).map(|(_, value)| value).collect()
        };
        let same = ["i", "p", "r", "end", "q", "delta", "candidates"].map(|name| (name, name));
        for (name, column) in same.into_iter().chain([("f", "f_opt")]) {
            let expected: Vec<i64> = rows.iter().filter_map(|row| row[column].as_i64()).collect();
            assert_eq!(of_verdicts(back.integers(&entity, name)), expected, "{name}");
        }
        for name in ["sse", "slope_before", "intercept_before", "slope_after", "intercept_after"] {
            let numbers = back.numbers(&entity, name).into_iter();
            let numbers = numbers.filter(|(times, _)| verdict_ticks.contains(&times["decision"]));
            let expected = rows.iter().map(|row| row[name].as_f64().unwrap());
            assert!(numbers.map(|(_, value)| value).eq(expected), "{name}");
        }
        let candidates: u64 = rows.iter().filter_map(|row| row["candidates"].as_u64()).sum();
        let candidates = usize::try_from(candidates).unwrap();
        assert_eq!(back.integers(&entity, "j").len(), candidates);
    }
}

#[test]
fn a_delay_between_samples_is_recorded_as_finely_as_it_was_found() {
    for method in [Method::HINGE, Method::LAG_AWARE] {
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
                // Two digits of its width, as a reader needs them.
                if let Some(fine) = decision.fine {
                    let low: f64 = text
                        .split_once("| interval of δ | ")
                        .and_then(|(_, rest)| rest.split_once(" … ")?.0.parse().ok())
                        .expect(&text);
                    let off = (low - fine.low).abs();
                    assert!(off <= 0.05 * (fine.high - fine.low), "{low} {}: {text}", fine.low);
                }
                assert!(text.contains("| response after the delay | after the delay"), "{text}");
            }
        }
    }
    let paper = Recorded::with(Settings::of(Method::TWO_LINE)).read_back(Detail::Full);
    assert!(paper.numbers("/boom/decision/table", "fine_delta").is_empty());
    assert!(!paper.chunks.contains_key("/boom/drawing/interval"));
}

#[test]
fn what_another_method_decided_is_drawn_beside_the_first() {
    let recorded = Recorded::with(Settings::of(Method::LAG_AWARE));
    let settings = Settings { first_last: FirstLast::Keep, ..Settings::of(Method::TWO_LINE) };
    let other = estimate_joints(&recorded.experiment.joints, &settings, || (), &Threads);
    let name = "two-line".to_owned();
    let experiment = &recorded.experiment;
    let also = [OtherResult::of(name, "kept".to_owned(), &experiment.joints, &other)];
    let other: Vec<JointEstimate> = other.into_iter().map(Result::unwrap).collect();
    let pairs = recorded.experiment.joints.iter().zip(&other);
    let joints: Vec<_> =
        pairs.map(|(joint, estimate)| EstimatedJoint { joint, estimate }).collect();
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
        let legend = back.rows(&format!("/{name}/drawing/texts"), "Points2D:labels", |cell| {
            let texts = cell.as_string::<i32>();
            let mut own = texts.iter().flatten().filter_map(|text| text.strip_prefix("– two-line"));
            own.next().map(str::to_owned)
        });
        let pages = back.texts(&format!("/{name}/verdict"), "TextDocument:text");
        assert_eq!((legend.len(), pages.len()), (drawn.len(), drawn.len()));
        let shown = legend.iter().zip(&pages);
        for ((first, decision), ((_, legend), (_, page))) in firsts.zip(decisions).zip(shown) {
            let delay = number(decision.delay().unwrap());
            let legend = legend.as_deref().unwrap();
            assert!(legend.starts_with(&format!(": δ = {delay} ")), "{legend}");
            assert!(page.contains(&format!("| two-line | {delay} | ")), "{page}");
            let delay = number(first.delay().unwrap());
            assert!(page.contains(&format!("| lag-aware, here | {delay} (")), "{page}");
        }
    }
    let alone = recorded.read_back(Detail::Full);
    assert!(!alone.chunks.contains_key("/boom/drawing/other_0"));
    assert!(!alone.texts("/boom/verdict", "TextDocument:text")[0].1.contains("| result |"));
}

#[test]
fn every_candidate_has_a_tick_and_no_tick_is_dead() {
    let recorded = Recorded::with(Settings::of(Method::TWO_LINE));
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
    let recorded = Recorded::with(Settings::of(Method::TWO_LINE));
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
    let settings = Settings { min_slope_change: 0.12, ..Settings::of(Method::TWO_LINE) };
    let recorded = Recorded::with(settings);
    let back = recorded.read_back(Detail::Full);
    for joint in recorded.joints() {
        let texts = back.texts(&format!("/{}/verdict", joint.joint.name), "TextDocument:text");
        let decisions: Vec<_> = decision_rows(joint).map(|(decision, _)| decision).collect();
        assert_eq!(texts.len(), decisions.len());
        let by_slope = |it: &&Decision| it.verdict() == Verdict::Rejected(Condition::SlopeChange);
        assert!(decisions.iter().any(by_slope), "the limit rejects some");
        for (decision, (times, text)) in decisions.iter().zip(&texts) {
            assert_eq!(times["segment"], whole(decision.number));
            assert!(text.contains("What the conditions ask"), "{text}");
            assert!(text.contains(Condition::BeforeInput.asks()), "{text}");
            match decision.verdict() {
                Verdict::Accepted => assert!(text.contains("✓ accepted"), "{text}"),
                failed @ Verdict::Rejected(_) => {
                    assert!(text.contains(&format!("**{failed}**")), "{text}");
                }
            }
        }
    }
}

#[test]
fn the_whole_record_is_drawn_whatever_the_timeline() {
    let recorded = Recorded::with(Settings::of(Method::TWO_LINE));
    let back = recorded.read_back(Detail::Full);
    for joint in recorded.joints() {
        let at = |part: &str| format!("/{}/map_of_record/{part}", joint.joint.name);
        assert_eq!(back.cell(&at("output"), "LineStrips2D:strips").len(), 1);
        let steps = decision_rows(joint).count();
        let points = back.cell(&at("breakpoint__accepted"), "Points2D:positions").len();
        // Two lines a cross.
        let lines = back.cell(&at("rejected"), "LineStrips2D:strips").len();
        assert_eq!(points + lines / 2, steps, "a breakpoint each");
        let frames = back.rows(&at("here"), "Boxes2D:half_sizes", |cell| cell.len());
        let by_doubt = frames.iter().filter(|(times, _)| times.contains_key("doubt"));
        assert_eq!(by_doubt.count(), steps);
    }
}

#[test]
fn a_breakpoint_that_a_reviewer_moved_is_drawn_beside_the_programs() {
    let mut recorded = Recorded::with(Settings::of(Method::TWO_LINE));
    let decision = &mut recorded.estimates[0].trials[0].as_mut().unwrap().decisions[2];
    let (p, found) = (decision.input_step.sample, decision.program_delay().unwrap());
    let (note, reviewer) = (String::new(), "Ann".to_owned());
    let said = Some(found + 10.0);
    decision.reviewer_verdict =
        Some(Box::new(ReviewerVerdict { accepted: true, delay: said, note, reviewer }));
    let back = recorded.read_back(Detail::Full);
    let [program, person] = [found, found + 10.0].map(|delay| samples(delay) + whole(p));
    let names = back.rows("/boom/drawing/names", "Points2D:labels", |cell| {
        cell.as_string::<i32>().iter().flatten().map(str::to_owned).collect::<Vec<_>>().join("; ")
    });
    let own = names.iter().find(|(times, _)| times.get("segment") == Some(&3)).unwrap();
    assert!(own.1.contains(&format!("q = {person} by a reviewer")), "{}", own.1);
    assert!(own.1.contains(&format!("program: q = {program}, SSE")), "{}", own.1);
    let lines = |part: &str| {
        let rows =
            back.rows(&format!("/boom/drawing/{part}"), "LineStrips2D:strips", |cell| cell.len());
        rows.iter().find(|(times, _)| times.get("segment") == Some(&3)).unwrap().1
    };
    // The accepted pair is in the close-up, too, with a line at q in each plot but that of the residual.
    assert_eq!((lines("before_review"), lines("chosen")), (3, 7));
    let texts = back.texts("/boom/verdict", "TextDocument:text");
    let text = &texts.iter().find(|(times, _)| times.get("segment") == Some(&3)).unwrap().1;
    assert!(
        text.contains("(by Ann)") && text.contains("**The program:** ✓ accepted: delay"),
        "{text}"
    );
    let sentence = text.split_once("**The program:**").unwrap().1.lines().next().unwrap();
    assert!(sentence.ends_with(" s."), "{sentence}");
    let log = back.texts("/boom/verdict/log", "TextLog:text");
    assert!(
        log.iter()
            .any(|(_, line)| line.contains("by a reviewer δ") && line.contains("the program: ✓"))
    );
}

#[test]
fn the_page_about_it_names_settings_version_and_input() {
    let recorded = Recorded::with(Settings::of(Method::TWO_LINE));
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
fn lean_keeps_rejected_and_doubtful_segments_whole_and_says_so() {
    let settings = Settings { min_slope_change: 0.12, beta: 1, ..Settings::of(Method::TWO_LINE) };
    let recorded = Recorded::with(settings);
    let back = recorded.read_back(Detail::Lean);
    for joint in recorded.joints() {
        let entity = format!("/{}/decision/table", joint.joint.name);
        let numbers = back.integers(&entity, "i");
        let candidates = back.integers(&entity, "j");
        let trial = joint.estimate.estimated().next().unwrap();
        let output = trial.smoothed.as_deref().unwrap();
        let doubtful = |i: usize| trial.decisions[i - 1].doubt(output).is_doubtful();
        for decision in decision_rows(joint).map(|(decision, _)| decision) {
            let (i, all) = (decision.number, decision.candidates.len());
            let kept = numbers.iter().filter(|(_, of)| *of == whole(i)).count() - 1;
            if decision.verdict() == Verdict::Accepted && !doubtful(i) {
                assert!(kept <= 25 && kept < all);
            } else {
                assert_eq!(kept, all);
            }
            let best_f = decision.candidates.best().map(|best| whole(best.f));
            let best = candidates
                .iter()
                .any(|(times, j)| Some(*j) == best_f && times["segment"] == whole(i));
            assert!(best, "the best candidate is always there");
        }
    }
    let about =
        back.chunks["/about"][0].components().get_array("TextDocument:text".into()).unwrap();
    assert!(about.value(0).as_string::<i32>().value(0).contains("--detail full"));
}

#[test]
fn two_runs_give_the_same_bytes() {
    let recorded = Recorded::with(Settings::of(Method::TWO_LINE));
    let written = || {
        let mut bytes = Vec::new();
        recorded.write(Detail::Full, &mut bytes).unwrap();
        bytes
    };
    assert!(written() == written());
}

/// All messages in their order: the store, and the chunk's id with those of its rows.
fn messages(bytes: &[u8]) -> Vec<(rerun::StoreId, Option<String>)> {
    let all = DecoderApp::decode_lazy(io::Cursor::new(bytes)).map(Result::unwrap);
    let named = all.map(|message| {
        let chunk = match &message {
            LogMsg::ArrowMsg(_, message) => Some(message.chunk_id.to_string()),
            _ => None,
        };
        (message.store_id().clone(), chunk)
    });
    named.collect()
}

#[test]
fn the_views_come_first() {
    let recorded = Recorded::with(Settings::of(Method::TWO_LINE));
    let mut bytes = Vec::new();
    recorded.write(Detail::Full, &mut bytes).unwrap();
    let views: Vec<bool> = messages(&bytes).iter().map(|(store, _)| store.is_blueprint()).collect();
    let count = views.iter().take_while(|is_view| **is_view).count();
    assert!(count > 20 && views[count..].iter().all(|is_view| !is_view), "{count}");
}

#[test]
fn two_recordings_share_no_id_and_say_what_they_are() {
    let recorded = Recorded::with(Settings::of(Method::TWO_LINE));
    let written = |command| {
        let joints = recorded.joints();
        let mut bytes = Vec::new();
        let recording = Recording {
            command,
            joints: &joints,
            settings: &recorded.settings,
            sources: &recorded.experiment.sources,
            reading: &recorded.experiment.options,
            detail: Detail::Full,
            models: &[],
            also: &[],
            revisions: &[],
        };
        write_recording(&recording, &mut bytes).unwrap();
        bytes
    };
    let (estimate, compare) = (written("estimate"), written("compare"));
    let ids = |bytes: &[u8]| -> BTreeSet<String> {
        let chunks = messages(bytes).into_iter().filter_map(|(_, chunk)| chunk);
        let entities = blueprint_entities(bytes).into_iter();
        chunks.chain(entities.filter(|path| path.starts_with("/view/"))).collect()
    };
    let shared: Vec<_> = ids(&estimate).intersection(&ids(&compare)).cloned().collect();
    // The axis that linked plots share is the viewer's own.
    assert!(shared.iter().all(|id| id.ends_with("/TimeAxis")), "{shared:?}");
    let application = |bytes: &[u8]| messages(bytes)[0].0.application_id().as_str().to_owned();
    let (one, other) = (application(&estimate), application(&compare));
    assert!(one.starts_with("log estimate two-line alpha 10 beta 5 5 Hz "), "{one}");
    assert_ne!(one, other);
    let back = ReadBack::of(&estimate);
    let name = back.fixed("/__properties", "RecordingInfo:name");
    assert_eq!(name.as_string::<i32>().value(0), "log · estimate · two-line, α 10, β 5, 5 Hz");
}

/// The entities of the views.
fn blueprint_entities(bytes: &[u8]) -> Vec<String> {
    let all = DecoderApp::decode_lazy(io::Cursor::new(bytes)).map(Result::unwrap);
    let entity = |message| match message {
        LogMsg::ArrowMsg(store, message) if store.is_blueprint() => {
            Some(Chunk::from_arrow_msg(&message).unwrap().entity_path().to_string())
        }
        _ => None,
    };
    all.filter_map(entity).collect()
}

#[test]
fn it_opens_on_the_most_doubtful_decision_and_goes_by_doubt() {
    let recorded = Recorded::with(Settings::of(Method::TWO_LINE));
    let back = recorded.read_back(Detail::Full);
    for joint in recorded.joints() {
        let name = &joint.joint.name;
        let trial = joint.estimate.estimated().next().unwrap();
        let output = trial.smoothed.as_deref().unwrap();
        let doubts: Vec<Doubt> =
            trial.decisions.iter().map(|decision| decision.doubt(output)).collect();
        let texts = back.texts(&format!("/{name}/verdict"), "TextDocument:text");
        let order = |doubt: &Doubt| (doubt.is_doubtful(), doubt.value());
        let mut ranks: Vec<(i64, (bool, f64))> = texts
            .iter()
            .zip(&doubts)
            .map(|((times, _), doubt)| (times["doubt"], order(doubt)))
            .collect();
        ranks.sort_by_key(|(rank, _)| *rank);
        assert!(ranks.iter().map(|(rank, _)| *rank).eq(1..=whole(doubts.len())));
        assert!(ranks.is_sorted_by(|a, b| a.1 >= b.1), "{ranks:?}");
        let lines = back.texts(&format!("/{name}/doubt/log"), "TextLog:text");
        let doubtful = doubts.iter().filter(|doubt| doubt.is_doubtful()).count();
        let marked = lines.iter().filter(|(_, line)| line.contains("not doubtful"));
        assert_eq!(marked.count(), lines.len() - doubtful);
        let limits = texts.iter().filter(|(_, text)| text.contains("(≥ p "));
        assert_eq!(limits.count(), texts.len(), "value and limit of a condition are in one cell");
        for entity in ["verdict", "drawing/borders", "place", "map/here"] {
            let ticks = back.ticks(&format!("/{name}/{entity}"), "decision");
            assert_eq!(ticks.iter().filter(|tick| **tick <= 0).count(), 1, "{entity}");
        }
        // The right arrow goes through its candidates before it comes to the first step.
        let most_doubtful =
            doubts.iter().enumerate().rev().max_by(|a, b| a.1.value().total_cmp(&b.1.value()));
        let candidates = trial.decisions[most_doubtful.unwrap().0].candidates.len();
        let ticks = back.ticks(&format!("/{name}/drawing/candidate"), "decision");
        let first = back.ticks(&format!("/{name}/verdict"), "decision")[..].iter().min().copied();
        let replayed: Vec<i64> = ticks.into_iter().filter(|tick| *tick <= 0).collect();
        assert_eq!(replayed.len(), candidates + 2);
        assert!(replayed.iter().copied().eq((first.unwrap()..).take(candidates + 2)));

        // Plots of samples have no timeline on which they would be a comb.
        assert!(back.ticks(&format!("/{name}/output/raw"), "segment").is_empty());
    }
}

#[test]
fn a_recording_without_revisions_opens_on_the_decisions() {
    let back = Recorded::with(Settings::of(Method::TWO_LINE)).read_back(Detail::Full);
    assert_eq!(back.opens_on, "decision");
    assert!(!back.chunks.keys().any(|entity| entity.starts_with("/boom/revision")));
}

#[test]
fn a_joint_without_steps_says_why_and_has_no_empty_pages() {
    let folder = tempfile::tempdir().unwrap();
    let path: PathBuf = folder.path().join("levels.csv");
    let mut text = String::from("trial,time_s,a.input,a.output\n");
    for (trial, level) in [("first", 1.0), ("second", -1.0)] {
        for k in 0..200 {
            let (time, output) = (f64::from(k) / 100.0, level * f64::from(k));
            writeln!(text, "{trial},{time},{level},{output}").unwrap();
        }
    }
    std::fs::write(&path, text).unwrap();
    let experiment = Experiment::read(&[path], &ReadOptions::default());
    let settings = Settings::of(Method::TWO_LINE);
    let estimates: Vec<_> = estimate_joints(&experiment.joints, &settings, || (), &Threads);
    let estimates = estimates.into_iter().map(Result::unwrap).collect();
    let recorded = Recorded { experiment, estimates, settings };
    let back = recorded.read_back(Detail::Full);
    let why = back.fixed("/a/verdict", "TextDocument:text");
    let why = why.as_string::<i32>().value(0);
    assert!(why.contains("the input changes only between trials"), "{why}");
    let blueprint = back.pages.join(", ");
    for page in ["Decisions", "Delay", "Table"] {
        assert!(!back.pages.iter().any(|name| name == page), "{page} in {blueprint}");
    }
    assert!(back.pages.iter().any(|name| name == "No steps"), "{blueprint}");
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
    let recorded = Recorded::with(Settings::of(Method::TWO_LINE));
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
    let settings =
        Settings { first_last: FirstLast::Keep, low_pass: None, ..Settings::of(Method::TWO_LINE) };
    let estimates: Vec<_> = estimate_joints(&experiment.joints, &settings, || (), &Threads);
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
