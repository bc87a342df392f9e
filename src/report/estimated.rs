//! A joint with its estimate, and what its record says against its delays: a code for programs, a
//! sentence for people.

use serde::Serialize;

use crate::delay::{
    AgainstState, Decision, DelayTable, Neutral, Obstacle, OnsetModel, ResponseOfKind, Tracking,
    TrialEstimate, Verdict,
};
use crate::experiment::{Joint, Trial};
use crate::numerics::{chi_square_tail, median, quantile};
use crate::study::JointEstimate;
use crate::wording::{p_text, percent, rounded};

/// A joint as it was measured, and its delays.
#[derive(Clone, Copy, Debug)]
pub struct EstimatedJoint<'a> {
    /// What was measured.
    pub joint: &'a Joint,
    /// What was estimated from it.
    pub estimate: &'a JointEstimate,
}

impl<'a> EstimatedJoint<'a> {
    /// The trials that have an estimate, in their order.
    pub(crate) fn trials(&self) -> impl Iterator<Item = (&'a Trial, &'a TrialEstimate)> + use<'a> {
        let trials = self.joint.trials.iter().zip(&self.estimate.trials);
        trials.filter_map(|(trial, found)| Some((trial, found.as_ref().ok()?)))
    }

    /// The decisions on all input steps in their order, each with its trial and what was estimated of
    /// that.
    pub(crate) fn decisions(
        &self,
    ) -> impl Iterator<Item = (&'a Trial, &'a TrialEstimate, &'a Decision)> + use<'a> {
        self.trials().flat_map(|(trial, found)| {
            found.decisions.iter().map(move |decision| (trial, found, decision))
        })
    }

    /// The response after its dead times, where the method fits one.
    pub fn onset_model(&self) -> Option<&OnsetModel> {
        self.estimate.estimated().find_map(|trial| trial.onset_model.as_deref())
    }

    /// Where its output comes to rest, where its input says that.
    pub fn tracking(&self) -> Option<Tracking> {
        self.estimate.estimated().find_map(|trial| trial.tracking)
    }

    /// The joint's delays by kind of step and level.
    pub fn delay_table(&self) -> DelayTable {
        let estimates = self.estimate.trials.iter().map(|trial| trial.as_ref().ok());
        DelayTable::of(self.joint, estimates)
    }

    /// The joint's accepted delays against its state.
    pub fn against_state(&self) -> AgainstState {
        self.against_state_about(Neutral::of(&self.joint.trials).as_ref())
    }

    /// The joint's accepted delays against its state about a known neutral input.
    pub(super) fn against_state_about(&self, neutral: Option<&Neutral>) -> AgainstState {
        let estimates = self.estimate.trials.iter().map(|trial| trial.as_ref().ok());
        AgainstState::of(self.joint, neutral, estimates)
    }
}

/// A warning on the delays of a joint.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// `output_leads_input`, `output_unrelated_to_input`, `delay_longer_than_holds`, `shape_misfit`
    /// or `delay_varies`.
    pub code: &'static str,
    /// What it means, by how much, and what to do.
    pub text: String,
    /// What it means, without what to do: the beginning of the text.
    #[serde(skip)]
    pub(crate) short: String,
}

impl Warning {
    fn new(code: &'static str, short: String, rest: &str) -> Self {
        Self { code, text: format!("{short}{rest}"), short }
    }
}

impl EstimatedJoint<'_> {
    /// What the record says against the delays of the joint, where the method fits its response.
    pub fn warnings(&self) -> Vec<Warning> {
        let found = [self.obstacle(), self.misfit(), self.variation()];
        found.into_iter().flatten().collect()
    }

    /// Why no delay of the joint can be believed, where the record shows that.
    pub(crate) fn obstacle(&self) -> Option<Warning> {
        let model = self.onset_model()?;
        let accepted = if self.estimate.settings.accept_anyway {
            "its delays are accepted because of `--accept-anyway`"
        } else {
            "no delay is accepted (`--accept-anyway` overrides this)"
        };
        Some(match model.obstacle()? {
            Obstacle::Unrelated => Warning::new(
                "output_unrelated_to_input",
                format!(
                    "the output does not follow its input: the input steps explain {} of its \
                     changes of speed or level (R²; {} of the test that there is no relation)",
                    percent(model.follows_input_r2()),
                    p_text(model.follows_input_p_value())
                ),
                &format!(
                    ". Check that both columns belong to this joint and that nothing else moves it; \
                     {accepted}"
                ),
            ),
            Obstacle::Leads(lead_s) => Warning::new(
                "output_leads_input",
                format!("the output leads its input by {} s (median)", rounded(lead_s)),
                &format!(
                    ": it reacts before the step, so the clocks of the two columns differ, or the \
                     input is logged late. Shift one of them; {accepted}"
                ),
            ),
            Obstacle::BeyondHolds(delay_s) => Warning::new(
                "delay_longer_than_holds",
                format!(
                    "the delay of {} s (median) is longer than most holds of the input",
                    rounded(delay_s)
                ),
                &format!(
                    ", so each reaction falls into a later hold. Hold levels for longer than the \
                     delay; {accepted}"
                ),
            ),
        })
    }

    fn misfit(&self) -> Option<Warning> {
        // Onsets that are no delays are none whatever the shape.
        let model = self.onset_model();
        let model = model.filter(|model| model.is_misfit() && model.obstacle().is_none())?;
        let responses = model.responses();
        let of_kind = |one: &ResponseOfKind| format!("{}s `{}`", one.transition.id(), one.shape);
        let shapes = responses.iter().map(of_kind).collect::<Vec<_>>().join(", ");
        let short = if model.has_own_shapes() {
            format!("no response shape fits all kinds of steps: {shapes}")
        } else {
            // What steps have in common is no noise, however small it is.
            let is_alike = responses.iter().any(|one| !one.fits);
            format!(
                "no response shape fits: the residual of the best, `{}`, is {} times the sensor noise{}",
                model.shape(),
                rounded(model.misfit()),
                if is_alike { " and similar at all steps of a kind" } else { "" }
            )
        };
        let rest = ", so delays may be off by more than their intervals. Look for the missing \
                    effect with `tauscope improve`";
        Some(Warning::new("shape_misfit", short, rest))
    }

    /// Whether the delays of accepted steps differ by more than their intervals explain.
    fn variation(&self) -> Option<Warning> {
        self.onset_model()?;
        let delays = self.fine_delays();
        let scatter = Scatter::of(&delays).filter(Scatter::is_more_than_noise)?;
        let short = format!(
            "the delay varies from {} to {} s (10 to 90 % of {} steps), more than its intervals explain",
            rounded(scatter.low_s),
            rounded(scatter.high_s),
            delays.len()
        );
        Some(Warning::new("delay_varies", short, &depends_on(&self.against_state())))
    }

    /// The delays of accepted steps between samples, with their standard errors; seconds.
    pub(super) fn fine_delays(&self) -> Vec<(f64, f64)> {
        let accepted = self.decisions().filter(|(.., it)| it.verdict() == Verdict::Accepted);
        let delays = accepted.filter_map(|(trial, _, decision)| {
            let period_s = trial.period().seconds();
            let error = decision.fine?.standard_error();
            Some((decision.delay()? * period_s, error * period_s))
        });
        delays.collect()
    }
}

/// How far delays scatter.
pub(super) struct Scatter {
    low_s: f64,
    high_s: f64,
    /// Half of the range that the middle 95 % span.
    pub(super) within_s: f64,
    /// Of what is left where all are the same but for their errors.
    p_value: f64,
    median_s: f64,
}

impl Scatter {
    /// Of delays with their standard errors; none of a few.
    pub(super) fn of(delays: &[(f64, f64)]) -> Option<Self> {
        const FEWEST: usize = 6;
        if delays.len() < FEWEST {
            return None;
        }
        let weight = |error: f64| error.max(f64::MIN_POSITIVE).powi(2).recip();
        let (sum, total) = delays.iter().fold((0.0, 0.0), |(sum, total), (delay, error)| {
            (sum + weight(*error) * delay, total + weight(*error))
        });
        let mean = sum / total;
        let square = |(delay, error): &(f64, f64)| ((delay - mean) / error).powi(2);
        let p_value = chi_square_tail(delays.iter().map(square).sum(), delays.len() - 1)?;
        let values: Vec<f64> = delays.iter().map(|(delay, _)| *delay).collect();
        let at = |part: f64| quantile(&values, part);
        Some(Self {
            low_s: at(0.1)?,
            high_s: at(0.9)?,
            within_s: (at(0.975)? - at(0.025)?) / 2.0,
            p_value,
            median_s: median(&values)?,
        })
    }

    /// Whether they differ, and by a part of themselves that matters.
    pub(super) fn is_more_than_noise(&self) -> bool {
        /// How seldom equal delays scatter so, and the part of the median that matters (chosen).
        const CHANCE: f64 = 1e-6;
        const PART: f64 = 0.15;
        self.p_value < CHANCE && self.high_s - self.low_s > PART * self.median_s.abs()
    }
}

/// What the delay goes with, in words.
fn depends_on(found: &AgainstState) -> String {
    /// Quantities that are named.
    const NAMED: usize = 2;
    let of_kinds = found.kinds.iter().flat_map(|kind| &kind.correlations);
    let significant = found.correlations.iter().chain(of_kinds).filter(|it| it.significant);
    let mut named: Vec<(String, f64)> = significant
        .filter_map(|it| Some((format!("{} (ρ = {:.2})", it.variable, it.rho?), it.p_holm?)))
        .collect();
    named.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut names: Vec<String> = Vec::new();
    for (name, _) in named {
        let is_known =
            names.iter().any(|known| known.split(" (").next() == name.split(" (").next());
        if !is_known && names.len() < NAMED {
            names.push(name);
        }
    }
    if names.is_empty() {
        "; it correlates with no logged quantity".to_owned()
    } else {
        format!("; it correlates with {}", names.join(" and "))
    }
}
