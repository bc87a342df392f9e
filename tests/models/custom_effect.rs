//! An effect of a user's own keeps the contract like the built-in ones, or is told why not.

use tauscope::effect::contract::{self, Fault};
use tauscope::effect::{Dimension, Effect, Moment, Parameter, Spec, Stage};

/// A hose that throttles: the faster the flow, the more of it is lost.
#[derive(Debug)]
pub(super) struct Hose;

static HOSE: Spec = Spec::new("hose", Stage::Load, "pressure lost in a long hose")
    .equation("out = in / (1 + loss abs(in))")
    .source("made up for this test")
    .parameters(&[Parameter::new("loss", "loss per speed", Dimension::One).between(0.0, 1.0)])
    .confused_with(&["input_saturation"]);

impl Effect for Hose {
    fn spec(&self) -> &'static Spec {
        &HOSE
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[loss] = parameters else { return at.signal };
        at.signal / (1.0 + loss * at.signal.abs())
    }
}

/// The hose with its neutral value forgotten.
#[derive(Debug)]
struct Choked;

impl Effect for Choked {
    fn spec(&self) -> &'static Spec {
        &HOSE
    }

    fn step(&self, _parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        at.signal / (1.0 + at.signal.abs())
    }
}

#[test]
fn an_effect_of_ones_own_keeps_the_contract() {
    assert_eq!(contract::check(&Hose), Ok(()));
}

#[test]
fn one_that_is_never_neutral_is_told_so() {
    let breach = contract::check(&Choked).unwrap_err();
    assert!(matches!(breach.fault, Fault::NotNeutral { .. }));
    assert!(breach.to_string().starts_with("effect `hose`: at its neutral parameters"));
}
