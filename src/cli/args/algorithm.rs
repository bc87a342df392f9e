//! How delays are found: the options of `estimate` and `report`.

use clap::Args as ClapArgs;

use super::choice::{Choices, one_of};
use super::conditions::{ConditionArgs, low_pass, method, passband};
use super::number::{OrNone, length};
use crate::delay::{Interpolation, Method, Settings};
use crate::units::Length;

/// The settings of the algorithm.
#[derive(ClapArgs, Debug)]
pub(crate) struct AlgorithmArgs {
    /// How a delay is found. May be repeated: the first one is the answer, the others are reported
    /// beside it [default: auto; two-line with `--paper` and `--follow`]
    #[arg(long, value_parser = method())]
    method: Vec<Method>,

    /// How far a segment extends before its input step and after the next one, in samples or in
    /// seconds as in `0.1s` [default: 10]
    #[arg(long, value_name = "N|Xs", value_parser = length)]
    alpha: Option<Length>,

    /// Samples, or seconds, between two candidate breakpoints [default: 5]
    #[arg(long, value_name = "N|Xs", value_parser = length)]
    beta: Option<Length>,

    /// Zero-phase low-pass on the output that Algorithm 1's lines are fitted to: its cutoff, or `none`
    /// [default: 5]
    #[arg(long, value_name = "HZ|none", value_parser = passband)]
    passband: Option<OrNone>,

    #[command(flatten)]
    conditions: ConditionArgs,

    /// The delay between two steps
    #[arg(long, default_value = "hold", value_parser = one_of(BETWEEN))]
    interpolate: Interpolation,
}

/// The delay between two steps.
const BETWEEN: Choices<Interpolation> = &[
    ("hold", "Keep the delay until the next step", Interpolation::Hold),
    ("linear", "Interpolate linearly to the next accepted delay", Interpolation::Linear),
];

impl AlgorithmArgs {
    /// The settings of each method that was asked for, each once.
    pub(crate) fn runs(&self) -> Vec<Settings> {
        self.runs_by(if self.conditions.paper { Method::TWO_LINE } else { Method::AUTO })
    }

    /// The settings of each method that was asked for, each once; those of `usual` where none was.
    pub(crate) fn runs_by(&self, usual: Method) -> Vec<Settings> {
        let mut runs: Vec<Settings> = Vec::new();
        let asked = if self.method.is_empty() { &[usual][..] } else { &self.method };
        for method in asked.iter().copied() {
            if runs.iter().all(|run| run.method != method) {
                runs.push(self.settings(method));
            }
        }
        runs
    }

    /// The settings of the only method.
    ///
    /// # Errors
    /// When several were asked for.
    pub(crate) fn only(&self) -> anyhow::Result<Settings> {
        let mut runs = self.runs();
        match (runs.pop(), runs.is_empty()) {
            (Some(settings), true) => Ok(settings),
            _ => anyhow::bail!("--method: only one method at a time can be used here"),
        }
    }

    fn settings(&self, method: Method) -> Settings {
        let base = self.conditions.settings(method);
        let alpha = self.alpha.unwrap_or_else(|| base.alpha_length());
        let beta = self.beta.unwrap_or_else(|| base.beta_length());
        let low_pass = match self.passband {
            Some(passband) => low_pass(passband, self.conditions.filter_order),
            None => base.low_pass,
        };
        let low_pass_required = self.passband.is_some();
        let settings =
            Settings { low_pass, low_pass_required, interpolation: self.interpolate, ..base };
        settings.with_alpha(alpha).with_beta(beta)
    }
}
