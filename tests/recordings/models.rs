//! A recording of models holds what their comparison says, revision by revision.
#![cfg(feature = "rrd")]

use crate::read_back::ReadBack;
use crate::recorded::Recorded;
use rerun::external::arrow::array::AsArray as _;
use tauscope::delay::{Method, Settings};
use tauscope::diagnosis::Comparison;
use tauscope::explain::{Change, Verdict};
use tauscope::recording::Detail;
use tauscope::report::ComparedJoint;
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec};

#[test]
fn figures_of_a_model_are_those_of_its_comparison() {
    let recorded = Recorded::with(Settings::of(Method::TWO_LINE));
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
        assert!(page.contains("errors, free run"), "{page}");
        // What is drawn: a mark per part, and a curve in each of three plots.
        let drawn =
            |part: &str| back.cell(&format!("/{}/{part}", joint.name), "LineStrips2D:strips").len();
        assert_eq!(drawn("error_share/time"), count);
        // The record is drawn on every timeline that the page may be opened on.
        let map = format!("/{}/model_map/residual", joint.name);
        let rows = back.rows(&map, "LineStrips2D:strips", |strips| strips.len());
        let timelines = ["decision", "doubt", "sample", "segment", "time"];
        assert!(matches!(rows.as_slice(), [(_, 1)]), "{rows:?}");
        assert!(timelines.iter().all(|timeline| rows[0].0.contains_key(*timeline)), "{rows:?}");
        assert!(drawn("error_share/squared_error/0") == count);
        assert_eq!((drawn("correlation/lines/0"), drawn("correlation/band/0")), (3, 6));
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
    Recorded::made(vec![joint], 60.0, Settings::of(Method::TWO_LINE))
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
    assert_eq!(of("noise_floor"), expected(|c| c.sensor_noise.unwrap()));
    assert!(validation.windows(2).all(|pair| pair[1].1 < pair[0].1), "{validation:?}");
    let mut added: Vec<_> = back.texts("/boom/revision/added", "TextDocument:text");
    added.sort_by(|a, b| a.1.cmp(&b.1));
    let added: Vec<_> = added.iter().map(|(_, id)| id.as_str()).collect();
    assert_eq!(added, ["actuator_lag", "dead_band"]);
    assert!(back.texts("/boom/revision/removed", "TextDocument:text").is_empty());
    assert_eq!(back.opens_on, "revision");
    // The answer is on every page, and each but the last says what comes next.
    let pages = back.texts("/boom/revision/words", "TextDocument:text");
    let parts: Vec<_> =
        pages.iter().filter_map(|(_, page)| page.split_once("## Revision")).collect();
    // The one that it opens on is the last, and before the first.
    assert_eq!(parts.len(), revisions.len() + 1);
    assert_eq!(parts.first(), parts.last());
    let parts = &parts[1..];
    assert!(parts[0].0.contains("no missing effect found"), "{}", parts[0].0);
    assert!(parts.iter().all(|(answer, _)| *answer == parts[0].0));
    let next = parts.iter().filter(|(_, page)| page.contains("**Next:** + "));
    assert_eq!(next.count(), revisions.len() - 1);
    // Above them stands what was found, what is doubtful, and what is next: first of what the page is on.
    let doubtful = "1 decision is doubtful";
    let on_model = ["**boom: no missing effect found.**", "Delay ", doubtful, "`tauscope compare "];
    let on_delays = ["**boom: Delay ", "**", doubtful, "`tauscope estimate "];
    for (page, parts) in [("revision/headline", on_model), ("headline", on_delays)] {
        let strip = back.fixed(&format!("/boom/{page}"), "TextDocument:text");
        let mut rest = strip.as_string::<i32>().value(0);
        for part in parts {
            let found = rest.split_once(part).unwrap_or_else(|| panic!("no `{part}` in {rest}"));
            rest = found.1;
        }
    }
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
        ("share/squared_error", strips),
        ("sheet/ladder", "LineStrips2D:colors"),
    ] {
        let rows = back.rows(&format!("/boom/revision/{part}"), component, |cell| cell.to_data());
        // The first tick shows the last revision: the right arrow begins with the first.
        assert_eq!(rows.len(), count + 1, "{part}");
        assert_eq!((rows[0].0["revision"], &rows[0].1), (-1, &rows[count].1), "{part}");
        let rows = &rows[1..];
        assert!(rows.windows(2).all(|pair| pair[0].1 != pair[1].1), "{part}");
        for ((times, _), revision) in rows.iter().zip(0..) {
            assert_eq!((times["revision"], times["sample"]), (revision, 1));
        }
    }
    // A bar more than there are candidates, each of as many lines as the others.
    let lines = back.rows("/boom/revision/sheet/ranking", strips, |cell| cell.len());
    for ((_, lines), revision) in lines.iter().skip(1).zip(&improvements[0].revisions) {
        assert_eq!(lines % (1 + revision.ranking.len()), 0);
    }
    // A dead band shows in the measured curve; where the model follows it, the residual is drawn.
    let titles = back.rows("/boom/revision/sheet/texts", "Points2D:labels", |cell| {
        cell.as_string::<i32>().iter().flatten().collect::<Vec<_>>().join("\n")
    });
    for ((_, titles), revision) in titles.iter().skip(1).zip(improvements[0].revisions.windows(2)) {
        let title = match revision[1].change {
            Change::Added("dead_band") => "over delayed input",
            _ => "residual",
        };
        assert!(titles.contains(title), "{titles}");
    }
    let words = back.texts("/boom/revision/words", "TextDocument:text");
    for ((_, text), pair) in words.iter().skip(1).zip(improvements[0].revisions.windows(2)) {
        let Change::Added(id) = pair[1].change else { panic!("{:?}", pair[1].change) };
        assert!(text.contains(&format!("**Next:** + {id}")), "{text}");
    }
    assert!(words.last().unwrap().1.contains("missing"));
}
