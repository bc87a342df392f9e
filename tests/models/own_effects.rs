//! Effects that a user writes into the model file: they act like those of the catalogue,
//! are fitted like them, and say clearly what is wrong with them.

use std::error::Error as _;
use std::path::Path;

use tauscope::effect::{Effect, contract};
use tauscope::experiment::{Joint, Trial};
use tauscope::fit::{FitRecord, Horizon, Split, Status, fit};
use tauscope::model::{Component, JointModel, ModelError, ModelFile, Surroundings, simulate_input};
use tauscope::units::SamplePeriod;

const PERIOD_S: f64 = 0.02;
const SAMPLES: usize = 3000;

fn parse(tables: &str) -> Result<ModelFile, Box<ModelError>> {
    let text = format!("schema = \"tauscope/model/1\"\n{tables}");
    ModelFile::parse(&text, Path::new("mine.toml")).map_err(Box::new)
}

/// The joint `boom` with these effects.
fn joint_text(effects: &str) -> String {
    format!(
        "[joint.boom]\nstructure = \"integrator\"\nparameters = {{ gain = 8, delay = 0.15 }}\n{effects}"
    )
}

fn model(effects: &str) -> JointModel {
    parse(&joint_text(effects)).unwrap().joint("boom").unwrap().clone()
}

/// An effect of a joint, as an expression.
fn own(id: &str, stage: &str, expression: &str, parameters: &str) -> String {
    format!(
        "[[joint.boom.effect]]\nkind = \"expression\"\nid = \"{id}\"\nstage = \"{stage}\"\n\
         expression = \"{expression}\"\nparameters = {{ {parameters} }}\n"
    )
}

fn catalogue(kind: &str, parameters: &str) -> String {
    format!("[[joint.boom.effect]]\nkind = \"{kind}\"\nparameters = {{ {parameters} }}\n")
}

/// Levels between −2.5 and 2.5, each held for 0.4 to 1.6 s.
fn trial() -> Trial {
    let mut input = Vec::new();
    for k in 0_u32.. {
        let level = f64::from(k * 7919 % 11) / 2.0 - 2.5;
        input.extend(std::iter::repeat_n(level, 20 + (k * 104_729 % 61) as usize));
        if input.len() >= SAMPLES {
            break;
        }
    }
    input.truncate(SAMPLES);
    let period = SamplePeriod::from_seconds(PERIOD_S).unwrap();
    Trial::new("made", 0.0, period, input, vec![0.0; SAMPLES]).unwrap()
}

fn simulated(model: &JointModel) -> Vec<f64> {
    let surroundings = Surroundings { radians_per_output_unit: 0.02, ..Surroundings::default() };
    simulate_input(model, trial().input(), PERIOD_S, 4.0, &surroundings).output
}

#[test]
fn an_expression_of_an_effect_of_the_catalogue_is_that_effect() {
    for (stage, expression, values, kind, their) in [
        (
            "input",
            "max(signal - upper, 0) + min(signal - lower, 0)",
            "lower = -0.6, upper = 0.4",
            "dead_band",
            "lower = -0.6, upper = 0.4",
        ),
        (
            "input",
            "sign(signal) * abs(signal) ^ n",
            "n = { value = 1.3, neutral = 1.0 }",
            "flow_curve",
            "exponent = 1.3",
        ),
        (
            "input",
            "if(signal < 0, r * signal, signal)",
            "r = { value = 0.7, neutral = 1.0 }",
            "direction_gain",
            "negative_factor = 0.7",
        ),
        (
            "load",
            "signal - c * (position - y)",
            "c = 0.1, y = 3.0",
            "leakage",
            "rate = 0.1, y0 = 3",
        ),
        (
            "transport",
            "slope * abs(after - before)",
            "slope = 0.02",
            "variable_delay",
            "size = 0.02",
        ),
    ] {
        let theirs = model(&catalogue(kind, their));
        let ours = model(&own("mine", stage, expression, values));
        let plain = simulated(&model(""));
        let (theirs, ours) = (simulated(&theirs), simulated(&ours));
        let apart =
            |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart(&theirs, &plain) > 0.1, "{kind}");
        assert!(apart(&theirs, &ours) < 1e-9, "{kind}: {}", apart(&theirs, &ours));
    }
}

#[test]
fn an_expression_with_states_is_a_dynamic_effect_and_is_fitted() {
    let lag =
        "states = { before = \"now\", now = \"now + (signal - now) * (1 - exp(-dt / lag))\" }\n";
    let mean = "signal + (before - signal) * lag / dt * (1 - exp(-dt / lag))";
    let with = |value: &str| own("slow", "dynamics", mean, value) + lag;
    let theirs = simulated(&model(&catalogue("actuator_lag", "time_constant = 0.12")));
    let ours = simulated(&model(&with("lag = { value = 0.12, min = 0.001 }")));
    assert!(theirs.iter().zip(&ours).all(|(a, b)| (a - b).abs() < 1e-9));

    let made = trial();
    let trial = Trial::new("made", 0.0, made.period(), made.input().to_vec(), theirs).unwrap();
    let joint = Joint::new("boom", vec![trial]);
    let record = FitRecord::new(&joint, Split::Time(0.7), Horizon::FreeRun);
    let start = model(&with("lag = { value = 0.03, min = 0.001 }"));
    let fitted = fit(&record, &start, &record.range(20.0)).unwrap();
    assert!((fitted.parameters[2].value - 0.12).abs() < 1e-6, "{:?}", fitted.parameters);
}

/// A flow that grows less above `start`, with the bounds of its parameters.
const KNEE: &str = "if(signal > start, start + slope * (signal - start), signal)";
const KNEE_PARAMETERS: &str = "start = { value = 1.2, min = 0.0, max = 5.0, dimension = \"input\" }, \
                               slope = { value = 0.6, min = 0.0, max = 2.0, neutral = 1.0 }";

#[test]
fn the_parameters_of_an_expression_are_fitted() {
    let truth =
        model(&own("knee", "input", KNEE, "start = 1.2, slope = { value = 0.6, neutral = 1 }"));
    let made = trial();
    let noise = |k: usize| 0.02 * ((k * 7919 % 1009) as f64 / 504.5 - 1.0);
    let output = simulated(&truth).iter().enumerate().map(|(k, y)| y + noise(k)).collect();
    let trial = Trial::new("made", 0.0, made.period(), made.input().to_vec(), output).unwrap();
    let joint = Joint::new("boom", vec![trial]);
    let start =
        "start = { value = 0.7, min = 0.0, max = 5.0 }, slope = { value = 1.0, neutral = 1.0 }";
    let record = FitRecord::new(&joint, Split::Time(0.7), Horizon::FreeRun);
    let range = record.range(20.0);
    let fitted = |effects: &str| fit(&record, &model(effects), &range).unwrap();
    let (plain, knee) = (fitted(""), fitted(&own("knee", "input", KNEE, start)));
    assert!(knee.cost < 1e-3 * plain.cost);
    for (parameter, truth) in knee.parameters.iter().zip([8.0, 0.15, 0.6, 1.2]) {
        let error = parameter.std_error.unwrap();
        assert!((parameter.value - truth).abs() < 4.0 * error, "{parameter:?}");
        assert_eq!(parameter.status, Status::Fitted);
    }
    assert_eq!(knee.parameters[3].name, "knee.start");
}

#[test]
fn an_effect_on_the_input_may_depend_on_the_angle() {
    let bent = |k: &str| {
        model(&own("bent", "input", "signal * (1 + k * position)", k)).with_values(&[8.0, 0.15])
    };
    let made = trial();
    let truth = bent("k = 0.02");
    let mut output = simulated(&truth);
    output[0] += 0.5;
    let trial = Trial::new("made", 0.0, made.period(), made.input().to_vec(), output).unwrap();
    let output_unit = Some("rad".to_owned());
    let joint = Joint { output_unit, ..Joint::new("boom", vec![trial]) };
    let record = FitRecord::new(&joint, Split::Time(0.7), Horizon::FreeRun);
    let residuals = record.evaluate(&truth).residuals;
    let largest =
        residuals[0].iter().skip(1).fold(0.0_f64, |largest, error| largest.max(error.abs()));
    assert!(largest < 5e-3, "the angle at the start is found: {largest}");
}

#[test]
fn candidates_are_offered_and_may_be_used_by_their_id() {
    let candidate = format!(
        "[[candidate]]\nkind = \"expression\"\nid = \"knee\"\nsummary = \"less above a level\"\n\
         stage = \"input\"\nexpression = \"{KNEE}\"\nparameters = {{ {KNEE_PARAMETERS} }}\n"
    );
    let used = catalogue("knee", "slope = { value = 0.5, fixed = true }");
    let file = parse(&(candidate.clone() + &joint_text(&used))).unwrap();
    let [knee] = file.candidates() else { panic!("{:?}", file.candidates()) };
    let spec = knee.spec();
    assert_eq!((spec.id, spec.summary), ("knee", "less above a level"));
    assert!(knee.nests());
    assert_eq!(contract::check(*knee), Ok(()));
    let component = &file.joint("boom").unwrap().components()[0];
    assert!(std::ptr::eq(component.effect().spec(), spec));
    let values = component.parameters();
    assert!(values[0].fixed && (values[0].value - 0.5).abs() < 1e-12);
    assert!(values[1].value.abs() < 1e-12, "neutral where nothing is given");
    assert!(Component::neutral(*knee).parameters()[0].value > 0.9);
    let twice = parse(&candidate).unwrap();
    assert!(std::ptr::eq(twice.candidates()[0].spec(), spec));
}

#[test]
fn what_does_not_nest_is_known_to() {
    let always = own("hose", "load", "signal / (1 + abs(signal))", "");
    let parsed = model(&always);
    let effect: &dyn Effect = parsed.components()[0].effect();
    assert!(!effect.nests());
    assert!(effect.definition().is_some());
    assert!(model(&catalogue("dead_band", "")).components()[0].effect().nests());
}

/// All messages of an error, from the outermost on.
fn messages(error: &ModelError) -> String {
    let mut said = error.to_string();
    let mut source = error.source();
    while let Some(error) = source {
        said = format!("{said}: {error}");
        source = error.source();
    }
    said
}

/// Each text is refused with its message, which names the file.
fn assert_refused(cases: &[(String, &str)]) {
    for (text, expected) in cases {
        let said = messages(&parse(text).unwrap_err());
        assert!(said.contains(expected), "{text}\n{said}\n{expected}");
        assert!(said.starts_with("mine.toml"), "{said}");
    }
}

#[test]
fn what_is_wrong_with_a_definition_is_said() {
    let k = "k = 0.1";
    assert_refused(&[
        (
            joint_text(&own("mine", "input", "signal + sgnal", k)),
            "mine.toml, joint `boom`: effect `mine`: the expression cannot be computed: column 10 of \
             `signal + sgnal`: `sgnal` is not known (did you mean `signal`?); known: signal, position, \
             velocity, time, dt, others, radians, k, pi",
        ),
        (
            joint_text(&own("mine", "input", "signal + ", k)),
            "column 10 of `signal + `: expected a value",
        ),
        (
            joint_text(&own("mine", "transport", "signal + k", k)),
            "known: before, after, held, time, k, pi",
        ),
        (
            joint_text(&own("dead_band", "input", "signal", k)),
            "effect `dead_band`: `dead_band` is taken",
        ),
        (
            joint_text(&own("mine", "input", "signal", "time = 1.0")),
            "`time` is a name that is taken",
        ),
        (
            joint_text(&own("mine", "input", "signal + k", "k = { value = 2, max = 1 }")),
            "`mine.k` = 2 is not 1 or less",
        ),
        (
            joint_text(&own("mine", "input", "signal + k", "k = { min = 2, max = 1 }")),
            "2 <= 2 <= 1",
        ),
        (
            joint_text(&own("mine", "input", "signal + k", "k = nan")),
            "`mine.k` = NaN is not a finite number",
        ),
        (
            joint_text(&own("mine", "input", "signal + k", "k = { value = 1, neutral = 1 }")),
            "at its neutral values the effect changes 0 to 1",
        ),
        (
            joint_text(
                &(own("mine", "input", "signal + k", k) + &own("mine", "load", "signal + k", k)),
            ),
            "effect `mine` has an id that another one has",
        ),
        (
            joint_text(
                "[[joint.boom.effect]]\nkind = \"expression\"\nid = \"mine\"\nexpression = \"1\"",
            ),
            "effect `mine` has no `stage`: input, transport, dynamics, load or output",
        ),
        (joint_text("[[joint.boom.effect]]\nkind = \"expression\""), "has no `id`"),
        (joint_text(&own("mine", "input", "signal", k)), "`k` is in no expression"),
        (joint_text(&own("mine", "engine", "signal", k)), "unknown variant `engine`"),
    ]);
}

#[test]
fn what_is_wrong_with_the_use_of_one_is_said() {
    let candidate = |keys: &str| format!("[[candidate]]\n{keys}\n");
    let knee = candidate(
        "kind = \"expression\"\nid = \"knee\"\nstage = \"load\"\nexpression = \"signal\"",
    );
    assert_refused(&[
        (
            joint_text("[[joint.boom.effect]]\nkind = \"dead_band\"\nstage = \"input\""),
            "effect `dead_band` has a definition already",
        ),
        (
            joint_text(&catalogue("dead_band", "upper = { value = 1, neutral = 0 }")),
            "`neutral` and",
        ),
        (
            joint_text(&catalogue("dead_band", "upper = { fixed = true }")),
            "no `value` for its parameter `upper`",
        ),
        (
            joint_text(&catalogue("dead_band", "upper = \"1\"")),
            "expected a number, or a table like",
        ),
        (joint_text(&catalogue("kne", "")), "there is no effect `kne`"),
        (knee.clone() + &joint_text(&catalogue("kne", "")), "did you mean `knee`?"),
        (knee.clone() + &knee, "candidate: effect `knee` has an id that another one has"),
        (
            knee.clone() + &joint_text(&own("knee", "input", "signal", "")),
            "effect `knee` is a candidate; write kind = \"knee\"",
        ),
        (candidate("kind = \"dead_band\""), "effect `dead_band` must have kind ="),
    ]);
}
