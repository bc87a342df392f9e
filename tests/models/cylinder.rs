//! Logs of a joint that a hydraulic cylinder moves.

use tauscope::synthetic::{
    CylinderSpec, DelayLaw, InputSpec, JointSpec, Part, PlantError, PlantSpec, Spikes, Synthetic,
    simulate,
};

/// Levels at which a boom is driven, in volts.
const LEVELS: [f64; 11] = [-6.0, -4.5, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.5, 6.0];

fn boom(cylinder: CylinderSpec) -> JointSpec {
    let input = InputSpec::Levels { levels: LEVELS.to_vec(), hold_s: [0.5, 1.5] };
    let delay = DelayLaw::Constant { seconds: 0.08 };
    let (start, range, cylinder) = (20.0, Some([-10.0, 50.0]), Some(cylinder));
    JointSpec { start, range, cylinder, ..JointSpec::new("boom", input, delay) }
}

/// A boom that is given `steps`, whose delays are only those of `law`.
fn stepped(steps: &[(usize, f64)], law: DelayLaw) -> JointSpec {
    let input = InputSpec::Steps { steps: steps.to_vec(), initial: 0.0 };
    let cylinder = CylinderSpec { pilot_small_s: 0.0, ..CylinderSpec::default() };
    let cylinder = Some(CylinderSpec { pilot_falling_s: 0.0, ..cylinder });
    JointSpec { start: 20.0, cylinder, ..JointSpec::new("boom", input, law) }
}

fn record(seed: u64, seconds: f64, joint: JointSpec) -> Result<Synthetic, PlantError> {
    simulate(&PlantSpec::new(seed, seconds, vec![joint]))
}

fn output(made: &Synthetic) -> &[f64] {
    made.joints[0].trials[0].output()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

#[test]
fn half_the_time_step_changes_the_angle_by_less_than_a_ten_thousandth_of_a_degree() {
    let steps = [(20, 6.0), (100, -6.0), (220, 1.0), (280, 0.0), (340, -2.0)];
    let run = |time_step_s: f64| {
        let joint = stepped(&steps, DelayLaw::Constant { seconds: 0.083 });
        let cylinder = joint.cylinder.clone().map(|spec| CylinderSpec { time_step_s, ..spec });
        record(1, 4.0, JointSpec { cylinder, ..joint }).unwrap()
    };
    let difference = largest_difference(output(&run(5e-5)), output(&run(2.5e-5)));
    assert!(difference < 1e-4, "{difference} degrees");
}

#[test]
fn half_the_time_step_keeps_random_steps_within_a_thousandth_of_a_degree() {
    let drawn = record(4, 12.0, boom(CylinderSpec::default())).unwrap();
    let steps: Vec<_> = drawn.truth.iter().map(|step| (step.p, step.input_after)).collect();
    let run = |time_step_s: f64| {
        let seconds = drawn.truth.iter().map(|step| step.delay_s).collect();
        let joint = stepped(&steps, DelayLaw::Listed { seconds });
        let cylinder = joint.cylinder.clone().map(|spec| CylinderSpec { time_step_s, ..spec });
        record(4, 12.0, JointSpec { cylinder, ..joint }).unwrap()
    };
    let usual = run(5e-5);
    assert!(largest_difference(output(&usual), output(&drawn)) < 1e-12);
    let difference = largest_difference(output(&usual), output(&run(2.5e-5)));
    assert!(difference < 1e-3, "{difference} degrees");
}

#[test]
fn the_range_is_kept_and_used() {
    let of_seed = |seed| record(seed, 15.0, boom(CylinderSpec::default())).unwrap();
    let both = [0, 1].map(of_seed);
    assert_ne!(both[0].truth, both[1].truth);
    for (seed, made) in both.into_iter().enumerate() {
        let lowest = output(&made).iter().copied().fold(f64::INFINITY, f64::min);
        let highest = output(&made).iter().copied().fold(f64::NEG_INFINITY, f64::max);
        assert!(lowest > -10.5 && highest < 50.5, "seed {seed}: {lowest} to {highest}");
        assert!(highest - lowest > 20.0, "seed {seed}: {lowest} to {highest}");
        let holds = made.truth.windows(2).map(|pair| pair[0].hold_samples);
        assert!({ holds }.all(|hold| (50..=150).contains(&hold)));
    }
}

#[test]
fn a_longer_delay_only_moves_the_record() {
    let steps = [(50, 5.0), (150, -3.0), (250, 0.0)];
    let run = |seconds| {
        let joint = stepped(&steps, DelayLaw::Constant { seconds });
        // Leakage would let it sink a little longer before the first step acts.
        let tight = |spec| CylinderSpec { leakage_l_min: 0.0, ..spec };
        let cylinder = joint.cylinder.clone().map(tight);
        record(1, 4.0, JointSpec { cylinder, ..joint }).unwrap()
    };
    let (early, late) = (run(0.05), run(0.15));
    let moved = largest_difference(&output(&early)[..390], &output(&late)[10..]);
    // Time steps begin elsewhere.
    assert!(moved < 1e-5, "{moved} degrees");
    assert!(late.truth.iter().all(|step| (step.delay_s - 0.15).abs() < 1e-15));
}

#[test]
fn the_truth_tells_delay_and_change_of_speed() {
    let made =
        record(1, 4.0, stepped(&[(50, 4.0), (200, -4.0)], DelayLaw::Constant { seconds: 0.08 }));
    let made = made.unwrap();
    let slope = |k: usize| (output(&made)[k] - output(&made)[k - 20]) / 20.0;
    let [first, second] = [made.truth[0].slope_change, made.truth[1].slope_change];
    assert!((first - slope(200)).abs() < 0.02 * first, "{first}, measured {}", slope(200));
    assert!((second - slope(398) + slope(200)).abs() < 0.02 * second.abs());
}

#[test]
fn the_pilot_stage_takes_longer_for_a_small_step_and_downward() {
    let joint = JointSpec { range: None, ..boom(CylinderSpec::default()) };
    let made = record(1, 10.0, joint).unwrap();
    for step in &made.truth {
        let size = (step.input_after - step.input_before).abs();
        let falling = if step.input_after < step.input_before { 0.005 } else { 0.0 };
        let expected = 0.08 + 0.02 * (-size / 2.0).exp() + falling;
        assert!((step.delay_s - expected).abs() < 1e-12);
    }
}

#[test]
fn an_overtaken_step_leaves_no_trace() {
    let law = DelayLaw::Listed { seconds: vec![0.1, 0.8, 0.1] };
    let with = record(1, 2.0, stepped(&[(11, 3.0), (51, 5.0), (101, -3.0)], law)).unwrap();
    let law = DelayLaw::Constant { seconds: 0.1 };
    let without = record(1, 2.0, stepped(&[(11, 3.0), (101, -3.0)], law)).unwrap();
    assert_eq!(output(&with), output(&without));
    let overtaken: Vec<bool> = with.truth.iter().map(|step| step.overtaken).collect();
    assert_eq!(overtaken, [false, true, false]);
}

#[test]
fn radians_and_degrees_are_the_same_motion() {
    let steps = [(20, 5.0), (100, -5.0)];
    let law = || DelayLaw::Constant { seconds: 0.05 };
    let degrees = record(1, 2.0, stepped(&steps, law())).unwrap();
    let start = 20_f64.to_radians();
    let joint = JointSpec { start, output_unit: "rad".to_owned(), ..stepped(&steps, law()) };
    let radians = record(1, 2.0, joint).unwrap();
    let turned: Vec<f64> = output(&radians).iter().map(|angle| angle.to_degrees()).collect();
    assert!(largest_difference(output(&degrees), &turned) < 1e-9);
}

#[test]
fn each_part_matters() {
    let run = |only: Option<Vec<Part>>| {
        let spec = CylinderSpec { only, ..CylinderSpec::default() };
        let steps = [(20, 8.0), (80, -8.0), (140, 1.0), (180, -1.5)];
        let input = InputSpec::Steps { steps: steps.to_vec(), initial: 0.0 };
        let law = DelayLaw::Constant { seconds: 0.05 };
        let cylinder = Some(spec);
        let joint = JointSpec { start: 20.0, cylinder, ..JointSpec::new("boom", input, law) };
        record(1, 2.4, joint).unwrap()
    };
    let parts = [
        Part::Pilot,
        Part::Overlap,
        Part::SpoolLag,
        Part::SupplyDroop,
        Part::Asymmetry,
        Part::Leakage,
        Part::Friction,
        Part::Gravity,
        Part::Linkage,
    ];
    let all = run(None);
    assert_eq!(all, run(Some(parts.to_vec())));
    for part in parts {
        let others = parts.iter().copied().filter(|other| *other != part).collect();
        let difference = largest_difference(output(&all), output(&run(Some(others))));
        assert!(difference > 0.002, "{part:?}: {difference} degrees");
    }
}

#[test]
fn a_load_beyond_the_cylinder_is_an_error_and_no_log() {
    let heavy = CylinderSpec { mass_kg: 1e8, inertia_kg_m2: 1e9, ..CylinderSpec::default() };
    let found = record(1, 1.0, boom(heavy));
    let text = found.unwrap_err().to_string();
    assert!(text.starts_with("joint `boom`: its pressures or its angle grow"), "{text}");
}

#[test]
fn odd_numbers_give_data_or_an_error_but_no_panic() {
    const ODD: [f64; 7] = [0.0, -1.0, 1e300, 5e-324, 1e-3, f64::NAN, f64::INFINITY];
    let changes: [fn(&mut CylinderSpec, f64); 16] = [
        |spec, odd| spec.time_step_s = odd,
        |spec, odd| spec.full_input = odd,
        |spec, odd| spec.overlap = odd,
        |spec, odd| spec.spool_hz = odd,
        |spec, odd| spec.full_stroke_s = odd,
        |spec, odd| spec.rated_flow_l_min = odd,
        |spec, odd| spec.supply_bar = odd,
        |spec, odd| spec.pump_flow_l_min = odd,
        |spec, odd| spec.bore_mm = odd,
        |spec, odd| spec.bulk_modulus_mpa = odd,
        |spec, odd| spec.coulomb_n = odd,
        |spec, odd| spec.viscous_n_s_m = odd,
        |spec, odd| (spec.mass_kg, spec.inertia_kg_m2) = (odd, 10.0 * odd),
        |spec, odd| spec.eye_m = odd,
        |spec, odd| spec.angle_limits_deg = [-odd, odd],
        |spec, odd| spec.pilot_small_s = odd,
    ];
    for (change, odd) in changes.iter().flat_map(|change| ODD.map(|odd| (change, odd))) {
        let mut spec = CylinderSpec::default();
        change(&mut spec, odd);
        let finite = |made: Synthetic| output(&made).iter().all(|y| y.is_finite());
        let joint = stepped(&[(2, 5.0)], DelayLaw::Constant { seconds: 0.01 });
        let joint = JointSpec { cylinder: Some(spec), ..joint };
        assert!(record(1, 0.1, joint).map_or(true, finite));
    }
}

#[test]
fn each_bad_number_is_told_with_its_key_and_what_is_allowed() {
    let cases = [
        ("bore_mm = 0", "`cylinder.bore_mm` is 0.0; allowed: finite, above zero"),
        ("rod_mm = 100", "`cylinder.rod_mm` is 100.0; allowed: thinner than the bore"),
        ("overlap = 0.95", "`cylinder.overlap` is 0.95; allowed: 0 or more, below 0.9"),
        ("null_offset = 0.6", "`cylinder.null_offset` is 0.6; allowed: between -0.5 and 0.5"),
        ("leakage_l_min = -1", "`cylinder.leakage_l_min` is -1.0; allowed: finite, not negative"),
        ("supply_bar = 300", "`cylinder.supply_bar` is 300.0; allowed: a pressure between"),
        ("static_n = 100", "`cylinder.static_n` is 100.0; allowed: the Coulomb friction or more"),
        ("inertia_kg_m2 = 100", "`cylinder.inertia_kg_m2` is 100.0; allowed: mass_kg × centre_m²"),
        ("angle_limits_deg = [-60, 70]", "`cylinder.angle_limits_deg` is [-60.0, 70.0]; allowed: "),
        ("time_step_s = 0.001", "`cylinder.time_step_s` is 0.001; allowed: shorter, "),
        ("hose_volume_l = 0.001", "`cylinder.time_step_s` is 5e-5; allowed: shorter, "),
        ("time_step_s = 1e-9", "`cylinder.time_step_s` is 1e-9; allowed: longer: "),
        ("boer_mm = 100", "not a plant file"),
        ("only = ['gravitation']", "not a plant file"),
    ];
    for (line, expected) in cases {
        let text = refusal(&format!("cylinder = {{ {line} }}"));
        assert!(text.contains(expected), "{line}: {text}");
    }
}

#[test]
fn what_the_cylinder_replaces_is_refused_beside_it() {
    for (line, value) in [("gain = 5", "5.0"), ("lag_s = 0.1", "0.1"), ("saturation = 2", "2.0")] {
        let text = refusal(&format!("{line}\ncylinder = {{}}"));
        let key = line.split(' ').next().unwrap();
        let expected = format!(
            "joint `boom`: `{key}` is {value}; allowed: none, as `cylinder` moves the joint: \
             remove one of the two"
        );
        assert_eq!(text, expected);
    }
    let hidden = "effect.leakage.rate = 0.1\neffect.dead_band = { lower = -1, upper = 1 }";
    let text = refusal(&format!("{hidden}\ncylinder = {{}}"));
    assert!(text.contains("`effect` is [\"dead_band\", \"leakage\"]; allowed: none"), "{text}");
    let text = refusal("outside.sticky_spot = { from = 1, to = 2, share = 0.5 }\ncylinder = {}");
    assert!(text.contains("`outside` is [\"sticky_spot\"]; allowed: none"), "{text}");
    let text = refusal("output_unit = 'mm'\ncylinder = {}");
    assert!(text.contains("allowed: `deg` or `rad`"), "{text}");
    let text = refusal("start = 80\ncylinder = {}");
    assert!(text.contains("`start` is 80.0; allowed: an angle within"), "{text}");
    let text = refusal("range = [-30, 50]\nstart = 0\ncylinder = {}");
    assert!(text.contains("`range` is [-30.0, 50.0]; allowed: angles within"), "{text}");
}

#[test]
fn what_the_sensor_does_is_in_the_log_and_not_in_the_motion() {
    let joint = || boom(CylinderSpec::default());
    let true_one = record(1, 3.0, joint()).unwrap();
    let mut bent = joint();
    let key = |key: &str, number| (key.to_owned(), number);
    bent.hide("sensor_nonlinearity", &[key("amplitude", 2.0), key("period", 30.0)]).unwrap();
    let shown = |angle: &f64| angle + 2.0 * (std::f64::consts::TAU * angle / 30.0).sin();
    let expected: Vec<f64> = output(&true_one).iter().map(shown).collect();
    let made = record(1, 3.0, bent).unwrap();
    assert!(largest_difference(output(&made), &expected) < 1e-12);
    assert_eq!(made.truth, true_one.truth);
    let spiky = JointSpec { spikes: Some(Spikes { share: 0.05, size: 5.0 }), ..joint() };
    let off = output(&record(1, 3.0, spiky).unwrap()).to_vec();
    let off = off.iter().zip(output(&true_one)).filter(|(a, b)| (*a - *b).abs() > 4.9).count();
    assert!((5..30).contains(&off), "{off} spikes");
}

#[test]
fn a_cylinder_has_a_pump_of_its_own() {
    let swing = || {
        let input = InputSpec::Steps { steps: vec![(101, 1.0)], initial: 0.0 };
        JointSpec::new("swing", input, DelayLaw::Constant { seconds: 0.1 })
    };
    let mut drooping = JointSpec { name: "bucket".to_owned(), ..swing() };
    drooping.hide("supply_droop", &[("droop".to_owned(), 0.4)]).unwrap();
    let moving = stepped(&[(20, 6.0)], DelayLaw::Constant { seconds: 0.05 });
    let alone = record(1, 3.0, moving.clone()).unwrap();
    let made = simulate(&PlantSpec::new(1, 3.0, vec![moving, drooping.clone(), swing()])).unwrap();
    assert_eq!(made.joints[0], alone.joints[0]);
    let without = simulate(&PlantSpec::new(1, 3.0, vec![drooping, swing()])).unwrap();
    assert_eq!(made.joints[1], without.joints[0]);
    let output = made.joints[1].trials[0].output();
    // 10 deg/s at 1 V, of which the only other joint on its pump takes 40 %.
    assert!(((output[280] - output[180]) - 6.0).abs() < 1e-3);
}

/// Numbers in a cell of a table, without their units.
fn numbers(cell: &str) -> Vec<f64> {
    let plain = cell.replace('−', "-").replace(['°', ','], " ");
    plain.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn the_documents_name_every_key_with_its_default() {
    let default = toml::Table::try_from(CylinderSpec::default()).unwrap();
    let number = |value: &toml::Value| match value {
        toml::Value::Array(both) => both.iter().filter_map(toml::Value::as_float).collect(),
        one => vec![one.as_float().unwrap()],
    };
    let text = std::fs::read_to_string("docs/simulating.md").unwrap();
    let (_, text) = text.split_once("## A joint moved by a hydraulic cylinder\n").unwrap();
    let mut documented = 0;
    for row in text.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = row.split('|').collect();
        let keys: Vec<&str> = cells[1].split('`').skip(1).step_by(2).collect();
        let defaults: Vec<f64> =
            keys.iter().filter_map(|key| default.get(*key)).flat_map(number).collect();
        assert_eq!(numbers(cells[2]), defaults, "{row}");
        documented += keys.len();
    }
    // Without `only`, that has no default.
    assert_eq!(documented, default.len() + 1);
}

/// Why a boom with `lines` is refused.
fn refusal(lines: &str) -> String {
    let text = format!(
        "schema = 'tauscope/plant/1'\nseed = 1\nduration_s = 10\n[[joint]]\nname = 'boom'\n\
         input = {{ levels = [-3, 3], hold_s = [1, 2] }}\n\
         delay = {{ law = 'constant', seconds = 0.1 }}\n{lines}\n"
    );
    PlantSpec::from_toml(&text).unwrap_err().to_string()
}
