//! Revisions of a model file: what a user wrote stays, and what is written reads the same.

use std::path::Path;

use crate::sample::size;
use proptest::prelude::*;
use tauscope::effect::expression::define;
use tauscope::effect::{Definition, OwnParameter};
use tauscope::effect::{Effect, REGISTRY, Stage, find};
use tauscope::experiment::Joint;
use tauscope::model::{Component, JointModel, ModelFile, Revision, RevisionErrors, Value};

fn parse(text: &str) -> ModelFile {
    ModelFile::parse(text, Path::new("mine.toml")).unwrap()
}

fn component(id: &str, values: &[f64]) -> Component {
    let values = values.iter().map(|value| (*value).into()).collect();
    Component::new(find(id).unwrap(), values).unwrap()
}

fn added(revision: u32, id: &str) -> Revision {
    let errors = RevisionErrors { validation_rmse: Some(0.25), ..<_>::default() };
    Revision { revision, added: Some(id.to_owned()), errors, ..<_>::default() }
}

/// The lines of `new` that `old` has not, and those of `old` that `new` has not.
fn changes<'a>(old: &'a str, new: &'a str) -> (Vec<&'a str>, Vec<&'a str>) {
    let beyond = |a: &'a str, b: &str| {
        a.lines().filter(|line| !b.lines().any(|other| other == *line)).collect()
    };
    (beyond(new, old), beyond(old, new))
}

const HAND_WRITTEN: &str = r#"# The crane in hall 2.
schema = "tauscope/model/1"

[[candidate]]
kind = "expression"
id = "knee"
stage = "input"
expression = "if(signal > start, start + slope * (signal - start), signal)"
parameters = { start = 1.0, slope = { value = 0.5, neutral = 1 } }

[joint.arm]   # not looked at yet
structure = "integrator"
parameters = { gain = 3, delay = 0.2 }

[joint."boom 2.left"]
structure = "integrator"
[joint."boom 2.left".parameters]
# From the data sheet.
gain = 11.90  # deg/s/V
delay = { max = 1.0, value = 150e-3, min = 0.0 }

# Measured with a feeler gauge.
[[joint."boom 2.left".effect]]
kind = "dead_band"
parameters = { upper = { value = 0.6, fixed = true }, lower = -0.60 }

# A guess.
[[joint."boom 2.left".effect]]
kind = "actuator_lag"
parameters = { time_constant = 0.08 } # s

[[joint."boom 2.left".history]]
revision = 1
added = "actuator_lag"
note = "kept by hand"

# The end.
"#;

#[test]
fn a_model_without_a_revision_leaves_the_history_alone() {
    let file = parse(HAND_WRITTEN);
    let refitted = file.refitted("arm", &JointModel::integrator(3.5, 0.2)).unwrap();
    let changed = changes(HAND_WRITTEN, refitted.text());
    let (new, old) =
        ("parameters = { gain = 3.5, delay = 0.2 }", "parameters = { gain = 3, delay = 0.2 }");
    assert_eq!(changed, (vec![new], vec![old]));
    let plain = JointModel::integrator(2.0, 0.1);
    let fresh = ModelFile::new(Path::new("new.toml")).refitted("jaw", &plain).unwrap();
    assert_eq!((fresh.revision("jaw"), fresh.history("jaw")), (Some(0), &[][..]));
}

#[test]
fn values_are_replaced_in_place_and_all_else_stays() {
    let file = parse(HAND_WRITTEN);
    let model = file.joint("boom 2.left").unwrap();
    assert_eq!(
        model.names()[2..],
        ["dead_band.lower", "dead_band.upper", "actuator_lag.time_constant"]
    );
    let fitted = model.with_values(&[12.25, 0.1 + 0.2, -0.5, 0.6, 0.08]);
    let fitted = fitted.with(component("end_stop", &[-30.0, 1e12]));
    let revised = file.revised("boom 2.left", &fitted, &added(2, "end_stop")).unwrap();
    let (new, old) = changes(HAND_WRITTEN, revised.text());
    let expected = [
        "gain = 12.25  # deg/s/V",
        "delay = { max = 1.0, value = 0.30000000000000004, min = 0.0 }",
        "parameters = { upper = { value = 0.6, fixed = true }, lower = -0.5 }",
        "kind = \"end_stop\"",
        "parameters = { low = -30.0 }",
        "revision = 2",
        "added = \"end_stop\"",
        "validation_rmse = 0.25",
    ];
    assert_eq!(new, expected, "{}", revised.text());
    assert_eq!(old.len(), 3);
    assert!(is_same(revised.joint("boom 2.left").unwrap(), &fitted));
    assert!(is_same(revised.joint("arm").unwrap(), file.joint("arm").unwrap()));
    assert_eq!(revised.revision("boom 2.left"), Some(2));
    let [first, second] = revised.history("boom 2.left") else { panic!() };
    assert_eq!(first.added.as_deref(), Some("actuator_lag"));
    assert_eq!(second, &added(2, "end_stop"));
    assert!(
        revised.text().ends_with("validation_rmse = 0.25\n\n# The end.\n"),
        "{}",
        revised.text()
    );
}

#[test]
fn an_effect_that_is_contained_in_another_goes() {
    let file = parse(HAND_WRITTEN);
    let friction = Component::neutral(find("coulomb_friction").unwrap());
    let model = file.joint("boom 2.left").unwrap().with(friction);
    let revised = file.revised("boom 2.left", &model, &added(2, "coulomb_friction")).unwrap();
    let (new, old) = changes(HAND_WRITTEN, revised.text());
    assert!(new.contains(&"parameters = { time_constant = 0.08 }"), "{new:?}");
    assert!(old.contains(&"# A guess."), "{old:?}");
    assert!(!revised.text().contains("kind = \"actuator_lag\""));
    assert!(is_same(revised.joint("boom 2.left").unwrap(), &model));
}

#[test]
fn an_effect_can_be_removed() {
    let file = parse(HAND_WRITTEN);
    let arm = file.joint("arm").unwrap();
    let one = arm.with(component("dead_band", &[-0.1, 0.1]));
    let with = file.revised("arm", &one, &added(1, "dead_band")).unwrap();
    let removed = Some("dead_band".to_owned());
    let revision = Revision { revision: 2, removed, ..Revision::default() };
    let without = with.revised("arm", arm, &revision).unwrap();
    let (new, old) = changes(HAND_WRITTEN, without.text());
    assert_eq!(old, Vec::<&str>::new());
    let header = "[[joint.arm.history]]";
    assert_eq!(new[..2], [header, "added = \"dead_band\""], "{}", without.text());
    assert_eq!(without.history("arm")[1], revision);
    assert!(is_same(without.joint("arm").unwrap(), arm));
}

#[test]
fn a_candidate_is_named_and_another_definition_written_out() {
    let file = parse(HAND_WRITTEN);
    let knee = Component::neutral(file.candidates()[0]);
    let own = define(Definition {
        id: "bend".to_owned(),
        summary: Some("a \"bend\"".to_owned()),
        stage: Stage::Output,
        expression: "signal + size * sin(signal * radians)".to_owned(),
        states: Vec::new(),
        parameters: vec![OwnParameter {
            start: None,
            min: Some(0.0),
            ..OwnParameter::new("size", 0.0)
        }],
    });
    let bend = Component::new(own.unwrap(), vec![0.5.into()]).unwrap();
    let model = file.joint("arm").unwrap().with(knee).with(bend);
    let revised = file.revised("arm", &model, &added(1, "knee")).unwrap();
    let (new, _) = changes(HAND_WRITTEN, revised.text());
    let expected = [
        "[[joint.arm.effect]]",
        "kind = \"knee\"",
        "[[joint.arm.effect]]",
        "id = \"bend\"",
        "summary = 'a \"bend\"'",
        "stage = \"output\"",
        "expression = \"signal + size * sin(signal * radians)\"",
        "parameters = { size = { value = 0.5, min = 0.0 } }",
    ];
    assert_eq!(new[..expected.len()], expected, "{}", revised.text());
    assert!(is_same(revised.joint("arm").unwrap(), &model));
    let changed = model.with_values(&[3.0, 0.2, 0.7, 1.0, 0.25]);
    let again = revised.revised("arm", &changed, &added(2, "nothing")).unwrap();
    assert!(is_same(again.joint("arm").unwrap(), &changed));
    assert!(again.text().contains("size = { value = 0.25, min = 0.0 }"), "{}", again.text());
}

#[test]
fn a_file_is_made_where_there_is_none() {
    let model = JointModel::integrator(11.9, 0.15).with(component("leakage", &[0.1, 0.0]));
    let file = ModelFile::new(Path::new("new.toml"));
    let made = file.revised("boom", &model, &added(1, "leakage")).unwrap();
    let expected = "\
schema = \"tauscope/model/1\"

[joint.boom]
structure = \"integrator\"
parameters = { gain = 11.9, delay = 0.15 }
[[joint.boom.effect]]
kind = \"leakage\"
parameters = { rate = 0.1 }
[[joint.boom.history]]
revision = 1
added = \"leakage\"
validation_rmse = 0.25
";
    assert_eq!(made.text(), expected);
}

#[test]
fn every_form_of_toml_can_be_revised() {
    let schema = "schema = \"tauscope/model/1\"\n";
    for text in [
        "joint.boom.structure = \"integrator\"\njoint.boom.parameters.gain = 2\n\
         joint.boom.parameters.delay = 0.1\n",
        "joint = { boom = { structure = \"integrator\", parameters = { gain = 2, delay = 0.1 } } }\n",
        "[joint]\nboom = { structure = \"integrator\", parameters = { gain = 2, delay = 0.1 }, \
         effect = [ { kind = \"dead_band\" } ], history = [ { revision = 1 } ] }\n",
        "[joint.boom]\nstructure = \"integrator\"\nparameters = {\n  gain = 2, # V\n  delay = 0.1,\n}\n\
         effect = [\n  # one\n  { kind = \"dead_band\", parameters = { lower = -1 } },\n]\n",
    ] {
        let file = parse(&(schema.to_owned() + text));
        let model = file.joint("boom").unwrap().with(component("leakage", &[0.1, 2.0]));
        let revised = file.revised("boom", &model, &added(2, "leakage")).unwrap();
        assert!(is_same(revised.joint("boom").unwrap(), &model), "{}", revised.text());
        assert_eq!(revised.revision("boom"), Some(2));
        let other = JointModel::integrator(1.0, 0.0);
        let both = revised.revised("arm", &other, &Revision::default()).unwrap();
        assert!(is_same(both.joint("boom").unwrap(), &model), "{}", both.text());
        assert!(is_same(both.joint("arm").unwrap(), &other));
    }
}

#[test]
fn what_could_not_be_read_again_is_not_written() {
    let file = parse(HAND_WRITTEN);
    let arm = file.joint("arm").unwrap();
    for value in [f64::NAN, f64::INFINITY] {
        let error = file.revised("arm", &arm.with_values(&[value]), &Revision::default());
        let message = error.unwrap_err().to_string();
        assert!(message.contains("joint `arm`: `integrator.gain` = "), "{message}");
    }
    let unknown = arm.with(Component::neutral(&crate::custom_effect::Hose));
    let error = file.revised("arm", &unknown, &Revision::default()).unwrap_err();
    assert!(error.to_string().contains("lists the catalogue"), "{error}");
}

#[test]
fn a_limit_that_is_no_number_is_refused() {
    for limit in ["min", "max"] {
        let text = format!(
            "schema = \"tauscope/model/1\"\n[joint.boom]\nstructure = \"integrator\"\n\
             parameters = {{ gain = {{ value = 8.0, {limit} = nan }}, delay = 0.1 }}\n"
        );
        let error = ModelFile::parse(&text, Path::new("boom.toml")).unwrap_err();
        let problem = format!("`integrator.gain`: `{limit}` is not a number");
        assert!(error.to_string().contains(&problem), "{error}");
    }
}

#[test]
fn what_contradicts_itself_is_refused() {
    let of = |effects: &str| {
        let text = format!(
            "schema = \"tauscope/model/1\"\n[joint.boom]\nstructure = \"integrator\"\n\
             parameters = {{ gain = 8.0, delay = 0.1 }}\n{effects}"
        );
        ModelFile::parse(&text, Path::new("boom.toml")).map_err(|error| error.to_string())
    };
    let effect = |kind: &str, parameters: &str| {
        format!("[[joint.boom.effect]]\nkind = \"{kind}\"\nparameters = {{ {parameters} }}\n")
    };
    let stops = of(&effect("end_stop", "low = 10, high = -10")).unwrap_err();
    assert!(stops.contains("`low` above its `high`"), "{stops}");
    assert!(of(&effect("end_stop", "low = -10, high = 10")).is_ok());
    let large = of(&effect("dead_band", "lower = -1e308")).unwrap_err();
    assert!(large.contains("between -1e12 and 1e12"), "{large}");
}

fn is_same(a: &JointModel, b: &JointModel) -> bool {
    let is_same = |(a, b): (&Component, &Component)| {
        std::ptr::eq(a.effect().spec(), b.effect().spec()) && a.parameters() == b.parameters()
    };
    let (a_effects, b_effects) = (a.components(), b.components());
    a.gain == b.gain
        && a.delay == b.delay
        && a_effects.len() == b_effects.len()
        && a_effects.iter().zip(b_effects).all(is_same)
}

/// Two effects of a file's own, with and without bounds.
fn own_effects() -> [&'static dyn Effect; 2] {
    let own = |id: &str, expression: &str, parameter: OwnParameter| {
        define(Definition {
            id: id.to_owned(),
            summary: None,
            stage: Stage::Load,
            expression: expression.to_owned(),
            states: Vec::new(),
            parameters: vec![OwnParameter { start: None, ..parameter }],
        })
    };
    let bounds = (Some(-2.0), Some(3.0), Some(1.0));
    let bounded = OwnParameter {
        min: bounds.0,
        max: bounds.1,
        neutral: bounds.2,
        ..OwnParameter::new("a", 0.0)
    };
    [
        own("scaled", "a * signal", bounded).unwrap(),
        own("shifted", "signal + b", OwnParameter::new("b", 0.0)).unwrap(),
    ]
}

/// A value from `low` to `high`, with or without bounds of its own about it.
fn value(low: f64, high: f64) -> impl Strategy<Value = Value> {
    let number = prop_oneof![
        Just(0.0_f64),
        -10.0..10.0,
        any::<f64>().prop_filter("finite", |value| value.is_finite()),
    ];
    let room = || prop::option::of(0.0..5.0);
    (number, any::<bool>(), room(), room()).prop_map(move |(value, fixed, below, above)| {
        let value: f64 = value.max(low).min(high);
        Value { value, fixed, min: below.map(|b| value - b), max: above.map(|a| value + a) }
    })
}

/// An effect of the catalogue or of a file's own, in a model.
fn any_component() -> impl Strategy<Value = Component> {
    let all = REGISTRY.iter().copied().chain(own_effects()).collect::<Vec<_>>();
    prop::sample::select(all).prop_flat_map(|effect: &'static dyn Effect| {
        let parameters = effect.spec().parameters;
        let values: Vec<_> = parameters.iter().map(|each| value(each.min, each.max)).collect();
        values.prop_map(move |mut values| {
            if effect.definition().is_some() {
                // The bounds of such an effect stand in its definition.
                for value in &mut values {
                    (value.min, value.max) = (None, None);
                }
            }
            Component::new(effect, values).unwrap()
        })
    })
}

fn any_model() -> impl Strategy<Value = JointModel> {
    let components = prop::collection::vec(any_component(), 0..5);
    let own = (value(f64::MIN, f64::MAX), value(0.0, f64::MAX));
    (own, components).prop_map(|((gain, delay), components)| {
        let mut model = JointModel::integrator(0.0, 0.0);
        (model.gain, model.delay) = (gain, delay);
        for component in components {
            let id = component.effect().spec().id;
            let values: Vec<f64> = component.parameters().iter().map(|value| value.value).collect();
            let is_sound = component.effect().fault(&values).is_none();
            if is_sound && model.components().iter().all(|other| other.effect().spec().id != id) {
                model = model.with(component);
            }
        }
        model
    })
}

fn any_revision() -> impl Strategy<Value = Revision> {
    let id = || prop::option::of("[a-z_]{1,9}");
    let rmse = prop::option::of(0.0..1e3);
    (1_u32..99, id(), id(), rmse).prop_map(|(revision, added, removed, validation_rmse)| Revision {
        revision,
        added,
        removed,
        errors: RevisionErrors { validation_rmse, ..<_>::default() },
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size(64, 256)))]

    #[test]
    fn what_is_written_reads_the_same(
        name in prop_oneof!["[a-z_]{1,8}", ".{0,8}", Just("arm".to_owned()), Just("boom 2.left".to_owned())],
        models in prop::collection::vec((any_model(), any_revision()), 1..4),
        is_new in any::<bool>(),
    ) {
        let mut file =
            if is_new { ModelFile::new(Path::new("mine.toml")) } else { parse(HAND_WRITTEN) };
        let before = file.history(&name).len();
        for (number, (model, revision)) in models.iter().enumerate() {
            file = file.revised(&name, model, revision).unwrap();
            prop_assert!(is_same(file.joint(&name).unwrap(), model), "{}", file.text());
            prop_assert_eq!(file.history(&name).len(), before + number + 1);
            prop_assert_eq!(file.history(&name).last(), Some(revision));
        }
        // A second time nothing changes but the history.
        let (model, _) = models.last().unwrap();
        let again = file.revised(&name, model, &Revision::default()).unwrap();
        let kept = again.text().lines().filter(|line| file.text().lines().any(|l| l == *line));
        prop_assert!(kept.count() + 2 >= again.text().lines().count());
        if !is_new {
            let comments = HAND_WRITTEN.lines().filter(|line| line.starts_with("# The"));
            for comment in comments {
                prop_assert!(file.text().contains(comment));
            }
        }
    }
}

#[test]
fn a_model_is_refused_on_a_log_in_other_units() {
    let text = "schema = \"tauscope/model/1\"\n[joint.boom]\nstructure = \"integrator\"\n\
         parameters = { gain = 8.0, delay = 0.1 }\n[joint.boom.fitted]\nlogs = []\n\
         input_unit = \"V\"\noutput_unit = \"deg\"\n";
    let file = parse(text);
    let logged = |units: [Option<&str>; 2]| {
        let [input_unit, output_unit] = units.map(|unit| unit.map(str::to_owned));
        let (name, covariates) = ("boom".to_owned(), Vec::new());
        Joint { name, input_unit, output_unit, covariates, trials: [].into() }
    };
    for units in [[Some("V"), Some("deg")], [None, Some("deg")], [Some("V"), None]] {
        assert!(file.check_units(&logged(units)).is_ok(), "{units:?}");
    }
    let refused = file.check_units(&logged([Some("V"), Some("rad")])).unwrap_err().to_string();
    assert!(
        refused.contains("its output was in deg") && refused.contains("is in rad"),
        "{refused}"
    );
}
