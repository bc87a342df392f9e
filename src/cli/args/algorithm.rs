//! How delays are found, and which steps are accepted: the settings that every command takes whose delays
//! are asked for, and those of single joints, out of the file given with `--columns`.

use std::collections::BTreeMap;

use anyhow::anyhow;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Args as ClapArgs};

use super::number::{
    Choices, OrNone, at_least_one, chosen, length, length_or_none, number_where, one_of, or_none,
    probability, threshold,
};
use crate::delay::{FirstLast, InputKind, Interpolation, Method, MethodSpec, Settings};
use crate::experiment::{Experiment, Joint, ReadOptions};
use crate::numerics::LowPass;
use crate::units::Length;

/// The settings of the algorithm.
#[derive(ClapArgs, Debug)]
#[command(next_help_heading = "How delays are found")]
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

/// The settings that are no part of how a breakpoint is searched.
#[derive(Args, Debug)]
#[command(next_help_heading = "Which steps are accepted")]
pub(crate) struct ConditionArgs {
    #[arg(long, help = confidence_help(), value_name = "X|none", value_parser = confidence)]
    confidence: Option<OrNone>,

    /// Confidence level of the interval of a delay
    #[arg(long, value_name = "X", default_value_t = 0.95, value_parser = probability)]
    interval: f64,

    /// Order of the low-pass
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = at_least_one)]
    pub(crate) filter_order: usize,

    /// Reject a step that is held for fewer samples (`τ_min`), or seconds as in `0.2s`
    #[arg(long, value_name = "N|Xs", default_value = "0", value_parser = length_or_none)]
    min_delay: Length,

    /// Longest delay that is searched, in samples or in seconds as in `0.5s`: useful where the
    /// output reaches an end stop within a hold
    #[arg(long, value_name = "N|Xs", value_parser = length)]
    max_delay: Option<Length>,

    /// Reject a step when the output touches a limit
    #[arg(long, value_name = "LO,HI", value_parser = limits, allow_hyphen_values = true)]
    output_limits: Option<(f64, f64)>,

    /// Reject a step when the slope changes by less, in output units per sample
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = threshold)]
    min_slope_change: f64,

    /// Reject a step unless the squared error of its lines is below this
    #[arg(long, value_name = "X", value_parser = threshold)]
    max_sse: Option<f64>,

    /// Whether the first and the last step of a trial are judged
    #[arg(long, default_value = "auto", value_parser = one_of(FIRST_LAST))]
    first_last: FirstLast,

    /// Judge the first and the last step of a trial, as `--first-last keep` does
    #[arg(long, conflicts_with = "first_last")]
    keep_first_last: bool,

    /// Algorithm 1 of Albrecht and Taylor to the letter, on any log: no rest or stop of the joint
    /// is looked for, and the first and the last step are rejected
    #[arg(long, conflicts_with_all = ["first_last", "keep_first_last"])]
    pub(crate) paper: bool,

    /// Accept delays although the output leads its input, does not follow it, or reacts later than the
    /// next step
    #[arg(long)]
    accept_anyway: bool,

    /// Count a change of the input as a step when it is more than this: for an input
    /// that was measured, and that has steps
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = threshold)]
    min_step: f64,

    /// Take the input as steps, each of which has a delay, or as moving all the time, with one
    /// dead time over the record; `auto` decides it for each joint from the record
    #[arg(long, value_name = "KIND", default_value = "auto", value_parser = one_of(INPUT))]
    input: InputKind,
}

/// How inputs are taken.
pub(super) const INPUT: Choices<InputKind> = &[
    ("auto", "", InputKind::Auto),
    ("steps", "", InputKind::Steps),
    ("continuous", "", InputKind::Continuous),
];

/// Whether the first and the last step of a trial are judged.
pub(super) const FIRST_LAST: Choices<FirstLast> = &[
    ("auto", "In trials of three steps or fewer", FirstLast::Auto),
    ("reject", "Never, as in the paper", FirstLast::Reject),
    ("keep", "Always", FirstLast::Keep),
];

/// The methods that say so of themselves.
pub(crate) fn ids_with(says: impl Fn(&MethodSpec) -> bool) -> String {
    let methods = Method::all().filter(|method| says(method.spec()));
    methods.map(Method::id).collect::<Vec<_>>().join(", ")
}

fn confidence_help() -> String {
    let untested = ids_with(|spec| !spec.has_intervals);
    format!(
        "Reject a step as `nothing_happened` unless a reaction is significant at this confidence \
         level; `none`: no test [default: 0.99; `none` for {untested}]"
    )
}

/// Names of methods, with their help.
pub(crate) fn method() -> impl TypedValueParser<Value = Method> {
    let known = |method: Method| PossibleValue::new(method.id()).help(method.spec().summary);
    let ids = PossibleValuesParser::new(Method::all().map(known));
    ids.try_map(|id| Method::find(&id).ok_or("no method has this name"))
}

pub(crate) fn passband(text: &str) -> Result<OrNone, String> {
    let expected = "expected a frequency in Hz, or `none`";
    or_none(text, |text| number_where(text, |hz| hz > 0.0, expected))
}

pub(super) fn confidence(text: &str) -> Result<OrNone, String> {
    or_none(text, |text| probability(text).map_err(|expected| format!("{expected}, or `none`")))
}

pub(super) fn limits(text: &str) -> Result<(f64, f64), String> {
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let pair = text.split_once(',').and_then(|(low, high)| Some((number(low)?, number(high)?)));
    match pair {
        Some((low, high)) if low < high => Ok((low, high)),
        Some(_) => Err("the lower limit comes first".to_owned()),
        None => Err("expected two numbers, as in -40,40".to_owned()),
    }
}

/// The low-pass of `order` that a cutoff stands for.
pub(crate) fn low_pass(passband: OrNone, order: usize) -> Option<LowPass> {
    passband.number().map(|cutoff_hz| LowPass { cutoff_hz, order })
}

impl ConditionArgs {
    fn first_last(&self) -> FirstLast {
        match self.first_last {
            _ if self.paper => FirstLast::Reject,
            _ if self.keep_first_last => FirstLast::Keep,
            given => given,
        }
    }

    /// The settings of `method` with these conditions; all else is as usual.
    pub(crate) fn settings(&self, method: Method) -> Settings {
        let usual = Settings::of(method);
        let order = self.filter_order;
        let confidence = self.confidence.map_or(usual.confidence, OrNone::number);
        let settings = Settings {
            low_pass: usual.low_pass.map(|usual| LowPass { order, ..usual }),
            output_limits: self.output_limits,
            min_slope_change: self.min_slope_change,
            max_sse: self.max_sse,
            first_last: self.first_last(),
            paper: self.paper,
            accept_anyway: self.accept_anyway,
            min_step: self.min_step,
            input: if self.paper { InputKind::Steps } else { self.input },
            confidence,
            interval: self.interval,
            ..usual
        };
        let settings = settings.with_min_delay(self.min_delay);
        match self.max_delay {
            Some(delay) => settings.with_max_delay(delay),
            None => settings,
        }
    }
}

/// Changes settings to what a text says.
type Set = fn(&str, Settings) -> Result<Settings, String>;

/// The settings that a joint may have of its own, named like the options.
const SETTINGS: [(&str, Set); 13] = [
    ("alpha", |text, it| Ok(it.with_alpha(length(text)?))),
    ("beta", |text, it| Ok(it.with_beta(length(text)?))),
    ("passband", |text, it| {
        let order = it.low_pass.map_or(4, |usual| usual.order);
        let low_pass = low_pass(passband(text)?, order);
        Ok(Settings { low_pass, low_pass_required: true, ..it })
    }),
    ("min_delay", |text, it| Ok(it.with_min_delay(length_or_none(text)?))),
    ("max_delay", |text, it| Ok(it.with_max_delay(length(text)?))),
    ("output_limits", |text, it| Ok(Settings { output_limits: Some(limits(text)?), ..it })),
    ("min_slope_change", |text, it| Ok(Settings { min_slope_change: threshold(text)?, ..it })),
    ("max_sse", |text, it| Ok(Settings { max_sse: Some(threshold(text)?), ..it })),
    ("min_step", |text, it| Ok(Settings { min_step: threshold(text)?, ..it })),
    ("confidence", |text, it| Ok(Settings { confidence: confidence(text)?.number(), ..it })),
    ("interval", |text, it| Ok(Settings { interval: probability(text)?, ..it })),
    ("first_last", |text, it| Ok(Settings { first_last: chosen(FIRST_LAST, text)?, ..it })),
    ("input", |text, it| Ok(Settings { input: chosen(INPUT, text)?, ..it })),
];

/// The settings that single joints have of their own; they stand above the options, which are
/// for all joints.
#[derive(Debug, Default)]
pub(crate) struct OwnSettings {
    joints: BTreeMap<String, Vec<(Set, String)>>,
}

impl OwnSettings {
    /// Those of `options`.
    ///
    /// # Errors
    /// When a name or a value cannot be used.
    pub(crate) fn of(options: &ReadOptions) -> anyhow::Result<Self> {
        let mut own = Self::default();
        for (joint, settings) in &options.columns.estimate {
            for (name, text) in settings {
                let wrong =
                    |why: String| anyhow!("--columns: [joint.{joint}.estimate] {name}: {why}");
                let known = SETTINGS.iter().find(|(known, _)| known == name);
                let (_, set) = known.ok_or_else(|| {
                    let names = SETTINGS.map(|(name, _)| name).join(", ");
                    wrong(format!("expected one of {names}"))
                })?;
                set(text, Settings::default()).map_err(wrong)?;
                own.joints.entry(joint.clone()).or_default().push((*set, text.clone()));
            }
        }
        Ok(own)
    }

    /// What is asked for of `joint`, where `asked` is for all of them.
    pub(crate) fn of_joint(&self, joint: &Joint, asked: &Settings) -> Settings {
        let own = self.joints.get(&joint.name).map_or(&[][..], Vec::as_slice);
        let mut settings = asked.clone();
        for (set, text) in own {
            settings = set(text, settings.clone()).unwrap_or(settings);
        }
        settings.in_samples(&joint.trials)
    }

    /// A note on each joint that has settings and is in no log.
    pub(crate) fn notes(&self, experiment: &Experiment) -> Vec<String> {
        let is_there = |name: &String| experiment.joints.iter().any(|joint| &joint.name == name);
        let missing = self.joints.keys().filter(|name| !is_there(name));
        let note =
            |name: &String| format!("[joint.{name}.estimate]: the logs have no joint `{name}`");
        missing.map(note).collect()
    }
}
