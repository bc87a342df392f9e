//! A preview holds what is to be played and what is expected of it, exactly.
#![cfg(feature = "rrd")]

use crate::desk::{Desk, banded, number};
use crate::read_back::{ReadBack, whole};
use serde_json::Value;

const OPTIONS: &str = "design log.csv --separate dead_band,flow_curve --rehearsals 4 --power 0.9";

/// What is designed, and the bytes of its preview.
fn designed(desk: &Desk, options: &str) -> (Value, Vec<u8>) {
    let json = desk.json(&format!("{options} --preview next.rrd -q"), 0);
    (json, std::fs::read(desk.folder.path().join("next.rrd")).unwrap())
}

/// A column of a table that was written beside.
fn column(text: &str, name: &str) -> Vec<f64> {
    let mut lines = text.lines();
    let place = lines.next().unwrap().split(',').position(|cell| cell == name).unwrap();
    lines.map(|line| line.split(',').nth(place).unwrap().parse().unwrap()).collect()
}

fn values(back: &ReadBack, entity: &str) -> Vec<f64> {
    back.scalars(entity).into_iter().map(|(_, value)| value).collect()
}

#[test]
fn every_number_is_that_of_the_table() {
    let desk = Desk::with(vec![banded("boom")]);
    let (json, bytes) = designed(&desk, OPTIONS);
    assert!(desk.run(&format!("{OPTIONS} --preview next.csv -q")).status.success());
    let table = desk.read("next.csv");
    let back = ReadBack::of(&bytes);
    let input = back.scalars("/boom/input");
    for (sample, (times, level)) in input.iter().enumerate() {
        assert_eq!(times["sample"], whole(sample + 1));
        // 50 samples a second.
        assert_eq!(times["time"], 20_000_000 * whole(sample));
        assert!((level - column(&table, "boom.input")[sample]).abs() < 1e-12);
    }
    for (entity, name) in [
        ("/boom/expected/dead_band/output", "boom.dead_band"),
        ("/boom/expected/dead_band/low", "boom.low"),
        ("/boom/expected/dead_band/high", "boom.high"),
        ("/boom/expected/flow_curve/output", "boom.flow_curve"),
    ] {
        assert_eq!(values(&back, entity), column(&table, name), "{entity}");
    }
    let range = &json["joints"][0]["output_range"];
    for end in ["low", "high"] {
        let recorded = values(&back, &format!("/boom/range/{end}"));
        assert_eq!(recorded, vec![number(&range[end]); input.len()]);
    }
}

/// The difference starts anew at each step, as a fit does, and its parts make up the whole.
#[test]
fn the_difference_is_over_the_noise_and_from_each_step_on() {
    let desk = Desk::with(vec![banded("boom")]);
    let (json, bytes) = designed(&desk, OPTIONS);
    let back = ReadBack::of(&bytes);
    let joint = &json["joints"][0];
    let noise = number(&joint["separates"]["noise"]);
    let [one, other] = ["dead_band", "flow_curve"]
        .map(|name| values(&back, &format!("/boom/expected/{name}/output")));
    let apart = values(&back, "/boom/apart");
    let mut start = 0;
    for (place, hold) in joint["holds"].as_array().unwrap().iter().enumerate() {
        let samples = (number(&hold["hold_s"]) / 0.02).round();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "samples")]
        let end = start + samples as usize;
        let difference: Vec<f64> = (start..end).map(|k| (one[k] - other[k]) / noise).collect();
        let mean = difference.iter().sum::<f64>() / samples;
        // Holds of this input are shorter than a window of a fit.
        assert!(end - start <= 200);
        for (k, difference) in (start..end).zip(difference) {
            assert!((apart[k] - difference + mean).abs() < 1e-9, "hold {place}");
        }
        start = end;
    }
    assert_eq!(start, apart.len());
    assert!(apart.iter().any(|by| by.abs() > 3.0));
}

#[test]
fn it_says_what_the_input_tells_and_shows_each_hold() {
    let desk = Desk::with(vec![banded("boom")]);
    let (json, bytes) = designed(&desk, OPTIONS);
    let back = ReadBack::of(&bytes);
    assert_eq!(back.opens_on, "time");
    let holds = json["joints"][0]["holds"].as_array().unwrap();
    let lines = back.texts("/boom/holds", "TextLog:text");
    let pages = back.texts("/boom/here", "TextDocument:text");
    assert_eq!((lines.len(), pages.len()), (holds.len(), holds.len()));
    for (place, ((times, line), hold)) in lines.iter().zip(holds).enumerate() {
        assert_eq!(times["segment"], whole(place + 1));
        let seconds = std::time::Duration::from_secs_f64(number(&hold["start_s"]));
        assert_eq!(u128::try_from(times["time"]).unwrap(), seconds.as_nanos());
        assert!(line.starts_with(&format!("hold {}: ", place + 1)), "{line}");
    }
    let says = back.cell("/boom/says", "TextDocument:text");
    let says = rerun::external::arrow::array::AsArray::as_string::<i32>(&says).value(0).to_owned();
    for expected in ["rehearsed", "λ", "explain", "dead_band"] {
        assert!(says.contains(expected), "{expected}: {says}");
    }
    assert_eq!(back.labels("/boom/sheet/legend").len(), 4);
}

#[test]
fn random_steps_are_shown_with_what_a_model_expects_and_without() {
    let desk = Desk::with(vec![banded("boom")]);
    let (_, bytes) = designed(&desk, "design log.csv --duration 20");
    let back = ReadBack::of(&bytes);
    assert_eq!(values(&back, "/boom/expected/model/output").len(), 1000);
    assert!(!back.chunks.contains_key("/boom/apart"));
    let (_, bytes) = designed(&desk, "design --joint swing --duration 10");
    let back = ReadBack::of(&bytes);
    assert_eq!(values(&back, "/swing/input").len(), 1000);
    assert!(back.chunks.keys().all(|entity| !entity.contains("expected")));
}

#[test]
fn the_same_input_gives_the_same_messages() {
    let desk = Desk::with(vec![banded("boom")]);
    let options = "design log.csv --duration 10";
    assert!(designed(&desk, options).1 == designed(&desk, options).1);
}
