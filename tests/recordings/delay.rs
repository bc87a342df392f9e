//! The page on what the delay depends on answers as the report does.
#![cfg(feature = "rrd")]

use crate::read_back::{places, whole};
use crate::recorded::{Recorded, samples};
use rerun::log::Chunk;
use tauscope::delay::{AgainstOfKind, Correlation, Method, Settings, Verdict};
use tauscope::recording::Detail;
use tauscope::report::decision_rows;
use tauscope::synthetic::DelayLaw;

#[test]
fn the_state_at_each_accepted_step_is_that_of_the_report() {
    let recorded = Recorded::with(Settings::of(Method::TWO_LINE));
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
        let expected = decision_rows(joint).filter_map(|(decision, _)| {
            let delta = samples(decision.accepted_delay()?);
            Some((whole(decision.number), whole(decision.input_step.sample), delta))
        });
        let deltas = back.integers(&entity, "delta").into_iter();
        let deltas = deltas.map(|(times, delta)| (times["segment"], times["sample"], delta));
        assert!(deltas.eq(expected));
    }
}

#[test]
fn the_delay_page_answers_as_the_report_and_begins_with_the_strongest() {
    let law = DelayLaw::StepSize { min: 0.05, max: 0.4, scale: 0.8 };
    let drawn = DelayLaw::Uniform { min: 0.05, max: 0.4 };
    let recorded =
        Recorded::of([("by_step", law), ("drawn", drawn)], 90.0, Settings::of(Method::TWO_LINE));
    let back = recorded.read_back(Detail::Full);
    for joint in recorded.joints() {
        let page = |part: &str| format!("/{}/against/{part}", joint.joint.name);
        let found = joint.against_state();
        let texts = back.labels(&page("texts"));
        let titles: Vec<_> = texts.windows(2).filter(|pair| pair[1].starts_with("– ")).collect();
        assert_eq!(titles.len(), found.correlations.len(), "a name and a finding each");
        let mut p_values = Vec::new();
        for pair in titles {
            let name = pair[0].split(" [").next().unwrap().replace(' ', "_");
            let of_kind = |kind: &AgainstOfKind| {
                let mut all = kind.correlations.clone().into_iter();
                (kind.transition, all.find(|one| one.variable == name).unwrap())
            };
            let known: Vec<_> = found.kinds.iter().map(of_kind).collect();
            let depends = known.iter().filter(|(_, one)| one.significant);
            let depends: Vec<_> = depends.map(|(kind, _)| kind.id()).collect();
            let finding = match depends.as_slice() {
                [] => "– not shown".to_owned(),
                kinds => format!("– depends: {}", kinds.join(", ")),
            };
            assert_eq!(pair[1], finding);
            let p_value = |(_, one): &(_, Correlation)| one.p_value.unwrap_or(f64::INFINITY);
            p_values.push(known.iter().map(p_value).fold(f64::INFINITY, f64::min));
            // What the plant was given is what is found.
            if name == "step_size" {
                assert_eq!(!depends.is_empty(), joint.joint.name == "by_step", "{depends:?}");
            }
        }
        assert!(p_values.is_sorted(), "{p_values:?}");
    }
}

#[test]
fn the_step_under_the_cursor_is_marked_in_every_plot() {
    let recorded = Recorded::with(Settings::of(Method::TWO_LINE));
    let back = recorded.read_back(Detail::Full);
    for joint in recorded.joints() {
        let page = |part: &str| format!("/{}/against/{part}", joint.joint.name);
        let steps = joint.against_state().steps;
        let kinds = ["start", "stop", "change", "reversal"].map(&page);
        let drawn = kinds.iter().filter(|kind| back.chunks.contains_key(*kind));
        let drawn = drawn.map(|kind| back.points(kind)).collect::<Vec<_>>().concat();
        assert_eq!(drawn.len(), 6 * steps.len());
        let marked = back.rows(&page("here"), "Points2D:positions", places);
        assert!(
            marked
                .iter()
                .map(|(times, _)| times["segment"])
                .eq(steps.iter().map(|s| whole(s.number)))
        );
        // An empty row at a rejected step takes the mark away; one row is before all others.
        let rows = back.chunks[&page("here")].iter().filter(|chunk| !chunk.is_static());
        assert_eq!(rows.map(Chunk::num_rows).sum::<usize>(), decision_rows(joint).count() + 1);
        assert!(marked.iter().flat_map(|(_, places)| places).all(|place| drawn.contains(place)));
        assert_eq!(marked.iter().map(|(_, places)| places.len()).sum::<usize>(), drawn.len());
        let words = back.texts(&page("step"), "Points2D:labels");
        for ((times, words), (decision, _)) in words.iter().zip(decision_rows(joint)) {
            assert_eq!(times["segment"], whole(decision.number));
            match decision.verdict() {
                Verdict::Accepted => {
                    assert!(words.contains("✓ δ "), "{words}");
                }
                Verdict::Rejected(_) => assert!(words.contains("✗"), "{words}"),
            }
        }
    }
}

#[test]
fn where_nothing_is_accepted_the_delay_page_says_so() {
    let settings = Settings { max_sse: Some(0.0), ..Settings::of(Method::TWO_LINE) };
    let recorded = Recorded::with(settings);
    let back = recorded.read_back(Detail::Full);
    let headline = &back.labels("/boom/against/legend")[0];
    assert!(headline.contains("0 accepted steps"), "{headline}");
    assert!(!back.chunks.contains_key("/boom/against/change"));
    assert!(back.integers("/boom/delay/state", "delta").is_empty());
}
