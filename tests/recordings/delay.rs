//! The page on what the delay depends on answers as the report does.
#![cfg(feature = "rrd")]

use crate::read_back::{places, whole};
use crate::recorded::{Recorded, samples};
use rerun::log::Chunk;
use tauscope::delay::{Method, Settings, Verdict};
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
        assert_eq!(titles.len(), found.correlations.len() + 1, "a name and a finding each");
        let mut p_values = Vec::new();
        for pair in titles {
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
    let recorded = Recorded::with(Settings::of(Method::TWO_LINE));
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
        // An empty row at a rejected step takes the mark away; one row is before all others.
        let rows = back.chunks[&page("here")].iter().filter(|chunk| !chunk.is_static());
        assert_eq!(rows.map(Chunk::num_rows).sum::<usize>(), decision_rows(joint).count() + 1);
        for (times, places) in &marked {
            let name = format!("step {0} (segment {0})", times["segment"]);
            let of_step = drawn.iter().zip(&names).filter(|(_, other)| **other == name);
            assert!(of_step.clone().all(|(place, _)| places.contains(place)), "{name}");
            assert_eq!(of_step.count(), places.len());
        }
        let words = back.texts(&page("step"), "Points2D:labels");
        for ((times, words), (decision, _)) in words.iter().zip(decision_rows(joint)) {
            assert_eq!(times["segment"], whole(decision.number));
            match decision.verdict() {
                Verdict::Accepted => {
                    let delay = format!("delay {} samples", decision.delay().unwrap());
                    assert!(words.contains(&delay), "{words}");
                }
                Verdict::Rejected(_) => assert!(words.contains("rejected"), "{words}"),
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
    assert!(!back.chunks.contains_key("/boom/against/up"));
    assert!(back.integers("/boom/delay/state", "delta").is_empty());
}
