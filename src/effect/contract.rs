//! What every effect promises, checked: the built-in ones and those of users.
//!
//! - its [`Spec`] is complete: names in snake case, a source, ranges that hold the
//!   neutral value;
//! - **at the neutral parameters the output is the input**, so that models with and
//!   without it nest, unless it says that it does not [nest](Effect::nests);
//! - what goes in finite comes out finite, over the whole range of the parameters;
//! - the same input from fresh memory gives the same output;
//! - a fit can start: bounds lie within the spec's, starts within the bounds.
//!
//! Signals are taken up to 1e9 in magnitude, in whatever unit.

use std::iter::repeat;

use super::within_trials::parts_of;
use super::{Effect, InputChange, Moment, Parameter, RecordRange, Spec, by_id};

/// A promise that an effect breaks.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("effect `{effect}`: {fault}")]
pub struct Breach {
    /// Id of the effect.
    pub effect: &'static str,
    /// What is wrong with it.
    pub fault: Fault,
}

/// What can be wrong with an effect.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// The spec is not complete.
    #[error("its {part} `{name}` {problem}")]
    Spec {
        /// Which part of it: a name, a text, a range.
        part: &'static str,
        /// The name or text, or that of the parameter.
        name: &'static str,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// The bounds for a record are not as many as the parameters, or not within the
    /// spec's.
    #[error("the bounds {bounds:?} are not within those of its parameters")]
    Bounds {
        /// The bounds.
        bounds: Vec<(f64, f64)>,
    },
    /// There is no start for a record, or one not within its bounds.
    #[error("the start {start:?} is not within {bounds:?}")]
    Start {
        /// The start; empty where there is none.
        start: Vec<f64>,
        /// The bounds.
        bounds: Vec<(f64, f64)>,
    },
    /// The neutral parameters change the signal.
    #[error("at its neutral parameters the output is {found} at {at:?}")]
    NotNeutral {
        /// The moment.
        at: Moment,
        /// The output.
        found: f64,
    },
    /// The neutral parameters change the delay.
    #[error("at its neutral parameters it delays {change:?} by {found} s")]
    DelayNotNeutral {
        /// The change.
        change: InputChange,
        /// The extra delay in seconds.
        found: f64,
    },
    /// Something finite became infinite or no number.
    #[error("at {parameters:?} the output {found} is not finite")]
    NotFinite {
        /// The parameters.
        parameters: Vec<f64>,
        /// The output.
        found: f64,
    },
    /// A second run over equal moments gave other outputs.
    #[error("at {parameters:?} a second run is not equal to the first")]
    NotRepeatable {
        /// The parameters.
        parameters: Vec<f64>,
    },
}

/// How far the output may be from the input at the neutral parameters, in parts of the
/// input or of 1: a few roundings.
const NEUTRAL_TOLERANCE: f64 = 1e-12;

/// Runs of [`check`], each at other parameters.
const RUNS: usize = 64;

/// Moments in a run of [`check`].
const MOMENTS: usize = 24;

/// Numbers between the first of one run and the first of the next: all others are new.
const NUMBERS: usize = 1000;

/// Checks everything, at parameters and moments spread over their ranges.
///
/// # Errors
/// The first [`Breach`] that is found.
///
/// # Examples
/// ```
/// use tauscope::effect::{DeadBand, contract};
/// contract::check(&DeadBand)?;
/// # Ok::<(), contract::Breach>(())
/// ```
pub fn check(effect: &dyn Effect) -> Result<(), Breach> {
    let breach = |fault| Breach { effect: effect.spec().id, fault };
    check_spec(effect.spec()).map_err(breach)?;
    let levels = [0.0, 0.5, 1.0, 2.5];
    for record in records(&levels) {
        check_starts(effect, &record).map_err(breach)?;
    }
    for run in 0..RUNS {
        let mut spread = Spread(run * NUMBERS);
        let parts: Vec<_> = effect.spec().parameters.iter().map(|_| spread.next()).collect();
        let moments: Vec<_> = (0..MOMENTS).map(|_| moment(&mut spread)).collect();
        check_run(effect, &parts, &moments)?;
    }
    Ok(())
}

/// Checks one run over `moments`, from fresh memory and from a settled one: unchanged
/// at the neutral parameters, finite and repeatable at others.
///
/// The others are, for each parameter, `parts` (0 to 1) of the way from its lowest to its
/// highest value; halfway where `parts` ends. Both the widest range and that of a common
/// record are taken.
///
/// # Errors
/// The first [`Breach`] that is found.
pub fn check_run(effect: &dyn Effect, parts: &[f64], moments: &[Moment]) -> Result<(), Breach> {
    let breach = |fault| Breach { effect: effect.spec().id, fault };
    if effect.nests() {
        check_neutral(effect, moments).map_err(breach)?;
    }
    let widest = effect.spec().parameters.iter().map(|each| (each.min, each.max)).collect();
    for bounds in [widest, effect.bounds(&RecordRange::default())] {
        let between = |((low, high), part): (&(f64, f64), &f64)| low * (1.0 - part) + high * part;
        let parts = parts.iter().chain(repeat(&0.5));
        let parameters: Vec<_> = bounds.iter().zip(parts).map(between).collect();
        check_finite(effect, parameters, moments).map_err(breach)?;
    }
    Ok(())
}

fn check_spec(spec: &Spec) -> Result<(), Fault> {
    let fault = |part, name, problem| Err(Fault::Spec { part, name, problem });
    let meanings = spec.parameters.iter().map(|each| ("meaning", each.meaning));
    let texts = [("summary", spec.summary), ("equation", spec.equation), ("source", spec.source)];
    let mut texts = texts.into_iter().chain(meanings);
    if let Some((part, text)) = texts.find(|(_, text)| text.trim().is_empty()) {
        return fault(part, text, "is empty");
    }
    let names = spec.parameters.iter().map(|parameter| parameter.name);
    // After it may stand the condition in which it acts, or the signal that it depends on.
    let id = parts_of(spec.id).map_or(spec.id, |(effect, _)| effect);
    if let Some(name) = names.chain([id]).find(|name| !is_snake_case(name)) {
        return fault("name", name, "is not in snake case");
    }
    let mut others = spec.confused_with.iter().chain(spec.absorbs).copied().chain(spec.refines);
    if let Some(id) = others.find(|id| by_id(id).is_none() || *id == spec.id) {
        return fault("relative", id, "is not in the catalogue");
    }
    let holds = |each: &Parameter| {
        let is_finite = each.min.is_finite() && each.max.is_finite();
        is_finite && (each.min..=each.max).contains(&each.neutral)
    };
    match spec.parameters.iter().find(|each| !holds(each)) {
        Some(each) => fault("range of", each.name, "does not hold its neutral value"),
        None => Ok(()),
    }
}

pub(super) fn is_snake_case(name: &str) -> bool {
    let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    name.starts_with(|c: char| c.is_ascii_lowercase()) && name.chars().all(allowed)
}

fn check_starts(effect: &dyn Effect, record: &RecordRange<'_>) -> Result<(), Fault> {
    let bounds = effect.bounds(record);
    let parameters = effect.spec().parameters;
    let within = |((low, high), parameter): (&(f64, f64), &Parameter)| {
        parameter.min <= *low && low <= high && *high <= parameter.max
    };
    if bounds.len() != parameters.len() || !bounds.iter().zip(parameters).all(within) {
        return Err(Fault::Bounds { bounds });
    }
    let holds = |((low, high), value): (&(f64, f64), &f64)| low <= value && value <= high;
    let starts = effect.starts(record);
    if starts.is_empty() {
        return Err(Fault::Start { start: Vec::new(), bounds });
    }
    for start in starts {
        if start.len() != bounds.len() || !bounds.iter().zip(&start).all(holds) {
            return Err(Fault::Start { start, bounds });
        }
    }
    Ok(())
}

fn check_neutral(effect: &dyn Effect, moments: &[Moment]) -> Result<(), Fault> {
    let neutral = effect.spec().neutral();
    for memory in memories(effect, &neutral, moments) {
        for (at, found) in moments.iter().zip(outputs(effect, &neutral, memory, moments)) {
            let allowed = NEUTRAL_TOLERANCE * at.signal.abs().max(1.0);
            if (found - at.signal).abs() > allowed || found.is_nan() {
                return Err(Fault::NotNeutral { at: *at, found });
            }
        }
    }
    for change in changes(moments) {
        let found = effect.extra_delay_s(&neutral, &change);
        if found.abs() > NEUTRAL_TOLERANCE || found.is_nan() {
            return Err(Fault::DelayNotNeutral { change, found });
        }
    }
    Ok(())
}

fn check_finite(
    effect: &dyn Effect,
    parameters: Vec<f64>,
    moments: &[Moment],
) -> Result<(), Fault> {
    for memory in memories(effect, &parameters, moments) {
        let first = outputs(effect, &parameters, memory.clone(), moments);
        let delays = changes(moments).map(|change| effect.extra_delay_s(&parameters, &change));
        let mut all = first.iter().copied().chain(delays);
        if let Some(found) = all.find(|value| !value.is_finite()) {
            return Err(Fault::NotFinite { parameters, found });
        }
        let second = outputs(effect, &parameters, memory, moments);
        if !first.iter().zip(&second).all(|(a, b)| a.to_bits() == b.to_bits()) {
            return Err(Fault::NotRepeatable { parameters });
        }
    }
    Ok(())
}

/// Memory that is fresh, and memory that is settled at the first of `moments`.
fn memories(effect: &dyn Effect, parameters: &[f64], moments: &[Moment]) -> [Vec<f64>; 2] {
    let fresh = vec![0.0; effect.spec().memory];
    let mut settled = fresh.clone();
    if let Some(first) = moments.first() {
        effect.settle(parameters, &mut settled, first);
    }
    [fresh, settled]
}

/// Outputs over `moments`, starting with `memory`.
fn outputs(
    effect: &dyn Effect,
    parameters: &[f64],
    mut memory: Vec<f64>,
    moments: &[Moment],
) -> Vec<f64> {
    moments.iter().map(|at| effect.step(parameters, &mut memory, at)).collect()
}

/// The changes of the input, were the signals its levels.
fn changes(moments: &[Moment]) -> impl Iterator<Item = InputChange> {
    moments.iter().zip(moments.iter().skip(1)).map(|(before, after)| InputChange {
        before: before.signal,
        after: after.signal,
        held_s: before.dt_s,
        time_s: after.time_s,
    })
}

/// Records of several kinds, one in which nothing happens among them.
fn records(levels: &[f64]) -> [RecordRange<'_>; 3] {
    let common = RecordRange { input_levels: levels, input_abs_max: 2.5, ..RecordRange::default() };
    let still = RecordRange {
        input_abs_max: 0.0,
        output_min: 3.0,
        output_max: 3.0,
        speed_abs_max: 0.0,
        duration_s: 0.01,
        ..RecordRange::default()
    };
    let large = RecordRange { output_min: 1e5, output_max: 2e5, duration_s: 1e5, ..common };
    [common, still, large]
}

/// Numbers spread over 0 to 1: multiples of the golden ratio, without their whole part.
#[derive(Clone, Copy, Debug)]
struct Spread(usize);

impl Spread {
    fn next(&mut self) -> f64 {
        self.0 += 1;
        (self.0 as f64 * 0.618_033_988_749_894_9).fract()
    }

    /// Of either sign, most small and some up to 1e9.
    fn signal(&mut self) -> f64 {
        let size = 10_f64.powf(12.0 * self.next().powi(3) - 3.0);
        if self.next() < 0.5 { -size } else { size }
    }
}

fn moment(spread: &mut Spread) -> Moment {
    Moment {
        signal: if spread.next() < 0.2 { 0.0 } else { spread.signal() },
        position: spread.signal(),
        velocity: spread.signal(),
        time_s: 1e5 * spread.next().powi(4),
        dt_s: 10_f64.powf(5.0 * spread.next() - 5.0),
        others: spread.next(),
        measured: spread.signal(),
        radians_per_output_unit: if spread.next() < 0.5 { 1.0 } else { 1_f64.to_radians() },
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::super::{Dimension, REGISTRY, Stage};
    use super::*;

    #[test]
    fn every_effect_keeps_the_contract() {
        for effect in REGISTRY {
            check(*effect).unwrap();
        }
    }

    #[test]
    fn what_is_steady_does_the_same_again_while_its_signal_is_held() {
        let mut spread = Spread(0);
        for effect in REGISTRY.iter().filter(|effect| effect.is_steady()) {
            let parameters = effect.starts(&RecordRange::default()).remove(0);
            let mut memory = vec![0.0; effect.spec().memory];
            for _ in 0..200 {
                let at = moment(&mut spread);
                let [first, again] = [at, Moment { signal: at.signal, ..moment(&mut spread) }]
                    .map(|at| effect.step(&parameters, &mut memory, &at));
                assert!((first - again).abs() <= 0.0, "{}: {at:?}", effect.spec().id);
            }
        }
    }

    #[test]
    fn ids_are_unique() {
        let ids: BTreeSet<_> = REGISTRY.iter().map(|effect| effect.spec().id).collect();
        assert_eq!(ids.len(), REGISTRY.len());
    }

    fn moments() -> impl Strategy<Value = Vec<Moment>> {
        let signal = || prop_oneof![Just(0.0), -3.0..3.0, -1e9..1e9];
        let time = (0.0..1e6, 1e-6..10.0);
        let one = (signal(), signal(), signal(), time, 0.0..=1.0, 1e-3..1.0);
        let moment =
            one.prop_map(|(signal, position, velocity, (time_s, dt_s), others, radians)| {
                let seen = Moment { position, velocity, time_s, others, ..Moment::of(signal) };
                Moment { dt_s, radians_per_output_unit: radians, ..seen }
            });
        prop::collection::vec(moment, 1..12)
    }

    proptest! {
        #[test]
        fn any_run_of_any_effect_keeps_the_contract(
            parts in prop::collection::vec(prop_oneof![Just(0.0), Just(1.0), 0.0..=1.0], 5),
            moments in moments(),
        ) {
            for effect in REGISTRY {
                prop_assert_eq!(check_run(*effect, &parts, &moments), Ok(()));
            }
        }
    }

    /// An effect with one fault.
    #[derive(Debug)]
    struct Faulty(fn(&[f64], &mut [f64], &Moment) -> f64);

    static FAULTY: Spec = Spec::new("faulty", Stage::Load, "a fault")
        .equation("out = ?")
        .source("none")
        .parameters(&[Parameter::new("size", "a size", Dimension::One).between(-1.0, 1.0)]);

    impl Effect for Faulty {
        fn spec(&self) -> &'static Spec {
            &FAULTY
        }

        fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
            self.0(parameters, memory, at)
        }
    }

    #[test]
    fn faults_are_seen() {
        let fault = |step| check(&Faulty(step)).unwrap_err().fault;
        assert!(matches!(fault(|_, _, at| at.signal + 0.1), Fault::NotNeutral { .. }));
        assert!(matches!(fault(|p, _, at| at.signal + p[0].sqrt()), Fault::NotFinite { .. }));
        assert_eq!(check(&Faulty(|p, _, at| at.signal + p[0])), Ok(()));
    }

    static OUTSIDE: [Parameter; 1] = [Parameter::new("a", "b", Dimension::One).between(1.0, 2.0)];

    #[test]
    fn a_spec_with_a_fault_is_refused() {
        let part = |spec: Spec| match check_spec(&spec) {
            Err(Fault::Spec { part, name, .. }) => (part, name),
            found => panic!("{found:?}"),
        };
        assert_eq!(part(Spec { id: "Faulty", ..FAULTY.clone() }), ("name", "Faulty"));
        let unknown = Spec { confused_with: &["nothing"], ..FAULTY.clone() };
        assert_eq!(part(unknown), ("relative", "nothing"));
        assert_eq!(part(Spec { source: " ", ..FAULTY.clone() }), ("source", " "));
        assert_eq!(part(Spec { parameters: &OUTSIDE, ..FAULTY.clone() }), ("range of", "a"));
    }
}
