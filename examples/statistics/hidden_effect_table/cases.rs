//! The records of the table: what each hides, and in which noise.

use tauscope::synthetic::effects::{CATALOGUE, FINER, OUTSIDE};
use tauscope::synthetic::scenario::{self, Noise, Scenario, Strength, ideal};
use tauscope::synthetic::{CylinderSpec, DelayLaw, InputSpec, JointSpec, PlantSpec, Spikes};

/// Standard deviation of the noise, degrees.
pub(crate) const NOISE: f64 = 0.05;

/// Those of the records of the cylinder, whose noise a good encoder has, too.
const NOISES_OF_CYLINDER: [f64; 2] = [NOISE, 0.015];

/// Correlations of neighbouring samples of the noise where something is hidden.
const CORRELATIONS: [f64; 2] = [0.0, 0.9];

/// Those where nothing is.
const CORRELATIONS_ALONE: [f64; 5] = [0.0, 0.5, 0.8, 0.9, 0.95];

const STRENGTHS: [Strength; 2] = [Strength::Clear, Strength::Weak];

/// Over which part of the largest level the corners of a soft valve are rounded.
pub(crate) const SOFT_EDGE: f64 = 0.03;

/// Length of a record of the cylinder in seconds, as long as the others.
const CYLINDER_S: f64 = 120.0;

/// What a record is there for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Group {
    /// One effect of the catalogue is hidden.
    One,
    /// One is, and the corners of the valve are rounded.
    Soft,
    /// Nothing is.
    Nothing,
    /// The finer form of one is.
    Finer,
    /// Two effects of the catalogue are.
    Two,
    /// Three are.
    Three,
    /// One effect that the catalogue does not have.
    Outside,
    /// A cylinder moves the joint: physics in the place of effects.
    Cylinder,
}

/// How many records there are of each kind.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct Counts {
    /// One effect hidden: records per effect, strength and noise
    #[arg(long, default_value_t = 3)]
    pub(crate) one: u64,
    /// One effect hidden, the valve with rounded corners: records per effect and strength
    #[arg(long, default_value_t = 1)]
    pub(crate) soft: u64,
    /// Nothing hidden: records per noise
    #[arg(long, default_value_t = 20)]
    pub(crate) nothing: u64,
    /// A finer form hidden: records per strength and noise
    #[arg(long, default_value_t = 3)]
    pub(crate) finer: u64,
    /// Two effects hidden: records per strength, noise and valve
    #[arg(long, default_value_t = 8)]
    pub(crate) two: u64,
    /// Three effects hidden: records per strength, noise and valve
    #[arg(long, default_value_t = 4)]
    pub(crate) three: u64,
    /// Outside the catalogue: records per effect and strength
    #[arg(long, default_value_t = 3)]
    pub(crate) outside: u64,
    /// The cylinder: records per noise
    #[arg(long, default_value_t = 5)]
    pub(crate) cylinder: u64,
    /// Seed of the first record; each has its own
    #[arg(long, default_value_t = 1)]
    pub(crate) first_seed: u64,
}

/// A record that is to be made.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) group: Group,
    pub(crate) hidden: Vec<&'static str>,
    pub(crate) strength: Strength,
    /// Standard deviation of the noise, degrees.
    pub(crate) deviation: f64,
    /// Correlation of neighbouring samples of the noise.
    pub(crate) correlation: f64,
    /// Whether 0.2 % of the samples are far off.
    pub(crate) spikes: bool,
    /// Whether the corners of the valve are rounded.
    pub(crate) soft: bool,
    pub(crate) seed: u64,
}

impl Case {
    fn new(group: Group, hidden: &[&'static str]) -> Self {
        Self {
            group,
            hidden: hidden.to_vec(),
            strength: Strength::Clear,
            deviation: NOISE,
            correlation: 0.0,
            spikes: false,
            soft: group == Group::Soft,
            seed: 0,
        }
    }

    /// The plant that makes the record.
    pub(crate) fn plant(&self) -> anyhow::Result<PlantSpec> {
        let noise = Noise::correlated(self.deviation, self.correlation);
        let mut plant = match self.group {
            Group::Cylinder => cylinder(self.deviation, self.seed),
            Group::Nothing => with_noise(ideal(self.seed), noise),
            _ => Scenario::within(&self.bare(), &self.hidden, self.strength, noise)?.plant,
        };
        if self.spikes {
            for joint in &mut plant.joints {
                joint.spikes = Some(Spikes { share: 0.002, size: 5.0 });
            }
        }
        Ok(plant)
    }

    /// The plant before anything is hidden in it.
    fn bare(&self) -> PlantSpec {
        let mut bare = ideal(self.seed);
        if self.soft {
            for joint in &mut bare.joints {
                joint.valve_edge = SOFT_EDGE;
            }
        }
        bare
    }

    /// `weak`, or `clear`.
    pub(crate) fn strength(&self) -> &'static str {
        match self.strength {
            Strength::Weak => "weak",
            Strength::Clear => "clear",
        }
    }

    /// The noise, in words.
    pub(crate) fn noise(&self) -> String {
        let spikes = if self.spikes { ", 0.2 % spikes" } else { "" };
        if self.correlation > 0.0 {
            return format!("AR(1) {}{spikes}", self.correlation);
        }
        format!("white{spikes}")
    }

    /// Noise and valve, in words.
    pub(crate) fn surroundings(&self) -> String {
        self.noise() + if self.soft { ", soft valve" } else { "" }
    }

    /// What it is, in one line.
    pub(crate) fn title(&self) -> String {
        let what = match self.group {
            Group::Nothing => "nothing".to_owned(),
            Group::Cylinder => format!("cylinder with noise of {} deg", self.deviation),
            _ => format!("{} {}", self.strength(), self.hidden.join(" + ")),
        };
        format!("{what}, {}, seed {}", self.surroundings(), self.seed)
    }
}

/// A joint that a cylinder moves, its valve driven to both ends.
fn cylinder(noise: f64, seed: u64) -> PlantSpec {
    let levels = vec![-6.0, -4.5, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.5, 6.0];
    let input = InputSpec::Levels { levels, hold_s: [0.5, 3.0] };
    let delay = DelayLaw::Constant { seconds: 0.08 };
    let joint = JointSpec {
        start: 20.0,
        range: Some([-10.0, 50.0]),
        cylinder: Some(CylinderSpec::default()),
        noise,
        ..JointSpec::new("joint", input, delay)
    };
    PlantSpec::new(seed, CYLINDER_S, vec![joint])
}

fn with_noise(mut plant: PlantSpec, noise: Noise) -> PlantSpec {
    for joint in &mut plant.joints {
        (joint.noise, joint.noise_correlation) = (noise.deviation, noise.correlation);
    }
    plant
}

/// All records, each with a seed of its own.
pub(crate) fn cases(counts: Counts) -> Vec<Case> {
    let mut cases = each_of(&CATALOGUE, Group::One, counts.one);
    cases.extend(soft(counts.soft));
    cases.extend(nothing(counts.nothing));
    for (group, count) in [(Group::Two, counts.two), (Group::Three, counts.three)] {
        let sharp = Case::new(group, &[]);
        cases.extend(in_all_noises(&sharp, count));
        cases.extend(in_all_noises(&Case { soft: true, ..sharp }, count));
    }
    cases.extend(outside(counts.outside));
    cases.extend(each_of(&FINER, Group::Finer, counts.finer));
    cases.extend(of_cylinder(counts.cylinder));
    for (case, seed) in cases.iter_mut().zip(counts.first_seed..) {
        case.seed = seed;
        match case.group {
            Group::Two => case.hidden = scenario::draw(2, seed),
            Group::Three => case.hidden = scenario::draw(3, seed),
            // Without an overlap a lag of the spool is one of the actuator.
            Group::Finer if case.hidden == ["spool_lag"] => case.hidden.insert(0, "dead_band"),
            _ => (),
        }
    }
    cases
}

/// `case` with each strength and noise.
fn varied(case: &Case) -> impl Iterator<Item = Case> + '_ {
    STRENGTHS.into_iter().flat_map(move |strength| {
        let noisy = move |correlation| Case { strength, correlation, ..case.clone() };
        CORRELATIONS.into_iter().map(noisy)
    })
}

fn repeated(case: Case, count: u64) -> impl Iterator<Item = Case> {
    (0..count).map(move |_| case.clone())
}

/// One of `names` hidden in each.
fn each_of(names: &[&'static str], group: Group, count: u64) -> Vec<Case> {
    names.iter().flat_map(|name| in_all_noises(&Case::new(group, &[name]), count)).collect()
}

/// `case` with each strength and noise, so many times.
fn in_all_noises(case: &Case, count: u64) -> Vec<Case> {
    varied(case).flat_map(|case| repeated(case, count)).collect()
}

fn soft(count: u64) -> Vec<Case> {
    let each = CATALOGUE.into_iter().map(|name| Case::new(Group::Soft, &[name]));
    let strong = each.flat_map(|case| STRENGTHS.map(|strength| Case { strength, ..case.clone() }));
    strong.flat_map(|case| repeated(case, count)).collect()
}

fn of_cylinder(count: u64) -> Vec<Case> {
    let plain = Case::new(Group::Cylinder, &[]);
    let each = NOISES_OF_CYLINDER.map(|deviation| Case { deviation, ..plain.clone() });
    each.into_iter().flat_map(|case| repeated(case, count)).collect()
}

fn nothing(count: u64) -> Vec<Case> {
    let white = Case::new(Group::Nothing, &[]);
    let noisy = |correlation| Case { correlation, ..white.clone() };
    let mut each: Vec<Case> = CORRELATIONS_ALONE.into_iter().map(noisy).collect();
    each.push(Case { spikes: true, ..white.clone() });
    each.into_iter().flat_map(|case| repeated(case, count)).collect()
}

fn outside(count: u64) -> Vec<Case> {
    let each = OUTSIDE.into_iter().map(|name| Case::new(Group::Outside, &[name]));
    let strong = each.flat_map(|case| STRENGTHS.map(|strength| Case { strength, ..case.clone() }));
    strong.flat_map(|case| repeated(case, count)).collect()
}
