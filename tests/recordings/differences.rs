//! Two results beside each other: settings, logs, methods, models; and many joints in files of a
//! few each.

use crate::desk::{Desk, banded, joint};
use serde_json::Value;

/// A desk with the result of an earlier run, by other settings, in JSON and as a table.
fn desk_with_earlier() -> Desk {
    let desk = Desk::with(vec![joint("boom"), joint("stick")]);
    let earlier = desk
        .json("estimate log.csv --method two-line --alpha 4 --passband 1 --decisions table.csv", 0);
    desk.write("earlier.json", &earlier.to_string());
    desk
}

fn decisions(run: &Value, joint: usize) -> Vec<Value> {
    run["joints"][joint]["decisions"].as_array().unwrap().clone()
}

#[test]
fn differences_are_those_of_both_results_the_largest_first() {
    let desk = desk_with_earlier();
    let now = desk.json("estimate log.csv --method two-line --against earlier.json", 0);
    let earlier: Value = serde_json::from_str(&desk.read("earlier.json")).unwrap();
    let against = &now["against"][0];
    assert_eq!(against["name"], "earlier");
    assert_eq!(against["settings"], "two-line, α 4 samples, β 5 samples, 1 Hz");
    for place in 0..2 {
        let found = &against["joints"][place];
        let (here, there) = (decisions(&now, place), decisions(&earlier, place));
        assert_eq!(count(&found["compared"]), here.len());
        let accepted = |decision: &Value| decision["verdict"] == "accepted";
        let only_here = here.iter().zip(&there).filter(|(a, b)| accepted(a) && !accepted(b));
        assert_eq!(count(&found["accepted_here_only"]), only_here.count());
        let differences = found["differences"].as_array().unwrap();
        assert!(!differences.is_empty());
        let other_verdict =
            |one: &Value| (one["verdict"] == "accepted") != (one["other_verdict"] == "accepted");
        let size = |one: &Value| one["difference_s"].as_f64().map_or(0.0, f64::abs);
        let order: Vec<_> = differences.iter().map(|one| (other_verdict(one), size(one))).collect();
        assert!(order.is_sorted_by(|a, b| a.0 && !b.0 || a.0 == b.0 && a.1 >= b.1), "{order:?}");
        for one in differences {
            let i = count(&one["i"]);
            assert_eq!(one["verdict"], here[i - 1]["verdict"]);
            assert_eq!(one["delay_s"], here[i - 1]["delta_s"]);
            assert_eq!(one["other_delay_s"], there[i - 1]["delta_s"]);
        }
    }
    // The table of decisions says the same.
    let by_table = desk.json("estimate log.csv --method two-line --against table.csv", 0);
    assert_eq!(by_table["against"][0]["joints"], against["joints"]);
    let text = desk.run("estimate log.csv --method two-line --against earlier.json");
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.contains("against earlier (two-line, α 4 samples"), "{text}");
    assert!(text.contains("accepted by both"), "{text}");
}

#[test]
fn the_same_result_differs_nowhere() {
    let desk = Desk::with(vec![joint("boom")]);
    let once = desk.json("estimate log.csv --method two-line", 0);
    desk.write("once.json", &once.to_string());
    let again =
        desk.json("estimate log.csv --method two-line --against once.json --against log.csv", 0);
    for against in again["against"].as_array().unwrap() {
        let found = &against["joints"][0];
        assert_eq!(found["differences"], Value::Array(Vec::new()));
        assert!(found["compared"].as_u64().unwrap() > 10);
        assert_eq!(found["largest_distance_s"], 0.0);
    }
}

#[test]
fn steps_without_a_counterpart_are_said_and_a_log_without_any_is_refused() {
    let desk = Desk::with(vec![joint("boom")]);
    let once = desk.json("estimate log.csv --method two-line --decisions all.csv", 0);
    let table = desk.read("all.csv");
    let lines: Vec<&str> = table.lines().collect();
    desk.write("fewer.csv", &(lines[..lines.len() - 2].join("\n") + "\n"));
    let output = desk.run("estimate log.csv --method two-line --against fewer.csv");
    let steps = decisions(&once, 0).len();
    let text = String::from_utf8(output.stdout).unwrap();
    let missing = format!("2 steps without a counterpart there: step {}; step {steps}", steps - 1);
    assert!(text.contains(&missing), "{text}");
    desk.write("other.csv", &table.replace("boom,", "bucket,"));
    let refused = desk.refusal("estimate log.csv --method two-line --against other.csv");
    assert!(refused.contains("none of its steps is in this log"), "{refused}");
    assert!(refused.contains("joints here: boom; there: bucket"), "{refused}");
    desk.write("sweep.json", "{\"schema\": \"tauscope/sweep/1\"}");
    let refused = desk.refusal("estimate log.csv --method two-line --against sweep.json");
    assert!(
        refused.contains("schema `tauscope/estimate/1`; found `tauscope/sweep/1`"),
        "{refused}"
    );
    desk.write("notes.txt", "nothing of the kind\n");
    let refused = desk.refusal("estimate log.csv --method two-line --against notes.txt");
    assert!(
        refused.contains("`--against` takes the JSON of `estimate --format json`"),
        "{refused}"
    );
    let refused = desk.refusal("estimate log.csv --method two-line --against missing.json");
    assert!(refused.contains("missing.json: cannot be read"), "{refused}");
}

#[test]
fn another_log_is_estimated_with_the_same_settings() {
    let desk = Desk::with(vec![joint("boom")]);
    let other = Desk::with(vec![banded("boom")]);
    desk.write("banded.csv", &other.read("log.csv"));
    let found =
        desk.json("estimate log.csv --method two-line --passband none --against banded.csv", 0);
    let alone = other.json("estimate log.csv --method two-line --passband none", 0);
    let against = &found["against"][0]["joints"][0];
    let there = decisions(&alone, 0);
    for one in against["differences"].as_array().unwrap() {
        let i = count(&one["other_i"]);
        assert_eq!(one["other_delay_s"], there[i - 1]["delta_s"]);
    }
}

fn count(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap()).unwrap()
}

/// The log, and models of its gain: one right, one a tenth too large.
fn desk_with_models() -> Desk {
    let desk = Desk::for_seconds(80.0, vec![joint("boom")]);
    for (name, gain) in [("right.toml", 10.0), ("wrong.toml", 11.0), ("near.toml", 10.001)] {
        let text = format!(
            "schema = \"tauscope/model/1\"\n[joint.boom]\nstructure = \"integrator\"\n\
             parameters = {{ gain = {gain}, delay = 0.12 }}\n"
        );
        desk.write(name, &text);
    }
    desk
}

#[test]
fn the_better_model_is_named_and_a_difference_by_chance_is_none() {
    let desk = desk_with_models();
    let against = |other: &str| {
        let command = format!("compare log.csv -m right.toml --against {other}");
        desk.json(&command, 0)["against"][0].clone()
    };
    let wrong = against("wrong.toml");
    assert_eq!((&wrong["model"], &wrong["other"]), (&Value::from("right"), &Value::from("wrong")));
    assert!(wrong["rmse"].as_f64().unwrap() < 0.8 * wrong["other_rmse"].as_f64().unwrap());
    assert!(wrong["statistic"].as_f64().unwrap() < -3.0, "{wrong}");
    assert_eq!(wrong["significant"], true);
    assert!(!wrong["better_where"].as_array().unwrap().is_empty(), "{wrong}");
    assert_eq!(wrong["worse_where"], Value::Array(Vec::new()));
    assert!(2 * wrong["better_steps"].as_u64().unwrap() > wrong["steps"].as_u64().unwrap());
    assert_eq!(against("near.toml")["significant"], false);
    let text = desk.run("compare log.csv -m right.toml -m wrong.toml");
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.contains("right is better by more than chance (p < 0.0001"), "{text}");
}

#[cfg(feature = "rrd")]
mod recorded {
    use super::*;
    use crate::read_back::ReadBack;
    use rerun::external::arrow::array::AsArray as _;
    use rerun::external::arrow::datatypes::Float32Type;

    /// A page that is there at all times.
    fn page(back: &ReadBack, entity: &str) -> String {
        back.fixed(entity, "TextDocument:text").as_string::<i32>().value(0).to_owned()
    }

    fn recording(desk: &Desk, arguments: &str, file: &str) -> ReadBack {
        let output = desk.run(&format!("{arguments} -o {file}"));
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        ReadBack::of(&std::fs::read(desk.folder.path().join(file)).unwrap())
    }

    #[test]
    fn the_timeline_of_differences_goes_through_them_in_their_order() {
        let desk = desk_with_earlier();
        let json = desk.json("estimate log.csv --method two-line --against earlier.json", 0);
        let back = recording(
            &desk,
            "estimate log.csv --method two-line --against earlier.json",
            "against.rrd",
        );
        let differences = json["against"][0]["joints"][0]["differences"].as_array().unwrap();
        let lines = back.texts("/boom/difference/log", "TextLog:text");
        assert_eq!(lines.len(), differences.len());
        for ((times, line), one) in lines.iter().zip(differences) {
            let rank = usize::try_from(times["difference"]).unwrap();
            assert_eq!(differences[rank - 1]["i"], one["i"]);
            assert!(line.starts_with(&format!("step {}: here ", one["i"])), "{line}");
        }
        let ranks = back.ticks("/boom/drawing/measured", "difference");
        let mut sorted = ranks.clone();
        sorted.sort_unstable();
        let all: Vec<i64> = (1..).take(decisions(&json, 0).len()).collect();
        assert_eq!(sorted, all);
        let page = page(&back, "/boom/difference");
        assert!(page.contains("**boom against earlier** (two-line"), "{page}");
        let all = back.numbers("/boom/decision/table", "sse");
        let shown = back.rows("/boom/decision/table", "error", |cell| {
            cell.as_primitive::<Float32Type>().value(0)
        });
        assert_eq!(shown.len(), all.len());
        for ((_, all), (_, shown)) in all.iter().zip(&shown) {
            assert!((f64::from(*shown) - all).abs() <= 1e-4 * all.abs());
        }
        let alone = recording(&desk, "estimate log.csv --method two-line", "alone.rrd");
        assert!(alone.ticks("/boom/drawing/measured", "difference").is_empty());
    }

    #[test]
    fn two_models_have_their_difference_summed_up_along_the_record() {
        let desk = desk_with_models();
        let command = "compare log.csv -m right.toml --against wrong.toml";
        let back = recording(&desk, command, "models.rrd");
        let values = |entity: &str| -> Vec<f64> {
            back.scalars(entity).into_iter().map(|(_, value)| value).collect()
        };
        let own = values("/boom/model/right/residual");
        let other = values("/boom/model/wrong/residual");
        let mut sum = 0.0;
        let summed = values("/boom/model_difference/wrong");
        assert_eq!(summed.len(), own.len());
        for ((own, other), summed) in own.iter().zip(&other).zip(&summed) {
            sum += other * other - own * own;
            assert!((summed - sum).abs() <= 1e-9 * sum.abs().max(1.0));
        }
        let page = page(&back, "/boom/model_page");
        assert!(page.contains("right is better by more than chance"), "{page}");
        let part = back.texts("/boom/part", "StateChange:state");
        assert!(part.iter().any(|(_, name)| name == "not fitted"), "{part:?}");
    }

    /// 21 joints: more than one recording holds.
    fn many() -> Desk {
        let names: Vec<String> = (1..=21).map(|number| format!("joint_{number:02}")).collect();
        Desk::for_seconds(12.0, names.iter().map(|name| joint(name)).collect())
    }

    #[test]
    fn many_joints_are_in_files_of_a_few() {
        let desk = many();
        let bytes = |name: &str| std::fs::read(desk.folder.path().join(name)).unwrap();
        recording(&desk, "estimate log.csv --method two-line --threads 1", "x.rrd");
        let names = ["x.rrd", "x_2.rrd", "x_3.rrd"];
        let first = names.map(bytes);
        assert!(!desk.has("x_1.rrd") && !desk.has("x_4.rrd"));
        for number in 1..=21 {
            let back = ReadBack::of(&first[(number - 1) / 8]);
            assert!(back.chunks.contains_key(&format!("/joint_{number:02}/output/raw")));
        }
        // The same bytes by any number of threads.
        assert!(
            desk.run("estimate log.csv --method two-line --threads 3 -o x.rrd --quiet")
                .status
                .success()
        );
        assert!(names.map(bytes) == first);
    }

    #[test]
    fn a_file_of_many_never_replaces_a_log() {
        let desk = many();
        desk.write("x_2.rrd", &desk.read("log.csv"));
        let refused = desk.refusal("estimate x_2.rrd -o x.rrd --quiet");
        assert!(refused.contains("x_2.rrd: this is a file that is read"), "{refused}");
        assert!(!desk.has("x_3.rrd") && !desk.has("x.rrd"));
        desk.write("y_2.rrd", "notes");
        let refused = desk.refusal("estimate log.csv --method two-line -o y.rrd --quiet");
        assert!(refused.contains("y_2.rrd: exists already"), "{refused}");
        assert_eq!(desk.read("y_2.rrd"), "notes");
    }
}
