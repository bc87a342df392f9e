//! What is said on one question: how large an error is, where it arises, what is explained, which measured
//! curves the model does not follow.

use crate::diagnosis::failure::WorstSegment;
use crate::diagnosis::{Comparison, Curve, CurveOf, sensor_noise};
use crate::experiment::Joint;
use crate::figure::curves::farthest;
use crate::fit::{AssessedModel, follows_input, time_constant_s};
use crate::report::Finding;
use crate::report::finding::in_proportion;
use crate::wording::{
    capitalized, effects_text, failure_sentences, listed, measure, percent, rounded, unit_suffix,
    worst_segment_text,
};

/// What a reader asks of a model: what stands before the sentences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Topic(pub(crate) &'static str);

impl Topic {
    /// How large the error is, and whether it is more than noise.
    pub(crate) const ERROR: Self = Self("Error");
    /// In which part of the record most of the error arises.
    pub(crate) const WHERE_IT_FAILS: Self = Self("Where the error arises");
    /// The parts of the record in which the simulated output is farthest off.
    pub(crate) const WORST_SEGMENTS: Self = Self("Worst segments");
    /// The effect that is missing.
    pub(crate) const MISSING: Self = Self("What is missing");
    /// What comes next in a search.
    pub(crate) const NEXT: Self = Self("What comes next");
    /// What the residual follows.
    pub(crate) const RESIDUAL: Self = Self("What the residual depends on");
    /// The measured curves that the model does not follow.
    pub(crate) const CURVES: Self = Self("Measured curves");
    /// The part of the error that each effect explains.
    pub(crate) const SHARES: Self = Self("What each effect explains");
    /// Why the model has the structure that it has.
    pub(crate) const STRUCTURE: Self = Self("Structure");
    /// The delay of the model beside those that were measured.
    pub(crate) const DELAY: Self = Self("Delay");
    /// In which trials an effect acts.
    pub(crate) const TRIALS: Self = Self("Trials");
    /// Where the conclusion holds.
    pub(crate) const LIMITS: Self = Self("Limits");
}

/// Sentences on one question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Passage {
    pub(crate) topic: Topic,
    pub(crate) sentences: Vec<String>,
}

impl Passage {
    /// `sentences` on `topic`, where there are any.
    pub(crate) fn of(topic: Topic, sentences: impl IntoIterator<Item = String>) -> Option<Self> {
        let sentences: Vec<String> = sentences.into_iter().collect();
        (!sentences.is_empty()).then_some(Self { topic, sentences })
    }

    /// All sentences in one.
    pub(crate) fn text(&self) -> String {
        self.sentences.join(" ")
    }
}

impl Finding<'_> {
    /// How large the error is.
    pub(super) fn size(&self) -> String {
        let error = self.output(self.error());
        match (self.comparison().judged(), self.noise()) {
            (Some(judged), Some(noise)) => {
                format!("The error is {error}, {}.", in_proportion(judged, Some(noise)))
            }
            _ => format!("The error is {error}."),
        }
    }

    /// How large the error is, and where.
    pub(crate) fn fails(&self) -> Vec<Passage> {
        let passages = [
            Passage::of(Topic::ERROR, [self.size()]),
            self.where_it_fails(),
            self.worst_segments(),
        ];
        passages.into_iter().flatten().collect()
    }

    /// Under which conditions most of the error arises.
    pub(super) fn where_it_fails(&self) -> Option<Passage> {
        let conditions = failure_sentences(self.joint(), self.comparison());
        let has_segments = self.segments().next().is_some();
        let none = "No condition was found that holds most of the error.".to_owned();
        let none = Some(none).filter(|_| conditions.is_empty() && has_segments);
        let conditions = conditions.iter().map(|when| format!("{}.", capitalized(when)));
        Passage::of(Topic::WHERE_IT_FAILS, conditions.chain(none))
    }

    /// Times to look at.
    pub(super) fn worst_segments(&self) -> Option<Passage> {
        let several = self.joint().trials.len() > 1;
        let time = |(index, worst): (usize, &WorstSegment)| {
            let trial = if several { format!("trial {}, ", worst.trial) } else { String::new() };
            let of = if index == 0 { " of its squared error" } else { "" };
            let share = percent(worst.share_of_squared_error);
            format!("{trial}{} ({share}{of})", worst_segment_text(worst))
        };
        let times: Vec<String> = self.segments().take(3).enumerate().map(time).collect();
        let look = format!("The residual is largest in {}.", times.join(", "));
        Passage::of(Topic::WORST_SEGMENTS, Some(look).filter(|_| !times.is_empty()))
    }

    fn segments(&self) -> impl Iterator<Item = &WorstSegment> {
        self.comparison().failure.iter().flat_map(|failure| &failure.worst_segments)
    }
}

impl Finding<'_> {
    /// Each measured curve on which the model leaves the band, with the place where it does most.
    pub(super) fn curves(&self) -> Option<Passage> {
        let sentences = self.comparison().curves.iter().filter_map(|curve| self.curve(curve));
        Passage::of(Topic::CURVES, sentences)
    }

    fn curve(&self, curve: &Curve) -> Option<String> {
        let (x, y, band, model) = farthest(curve)?;
        let joint = self.joint();
        let speed = joint.output_unit.as_deref().map(|unit| format!("{unit}/s"));
        let input = unit_suffix(joint.input_unit.as_deref());
        // Not with ±, which is one standard error everywhere else.
        let interval = || format!("95 %: {} to {}", rounded(y - band), rounded(y + band));
        let between = |what: &str| {
            let model = measure(model, speed.as_deref());
            format!(
                "At {what} {}{input} the measured speed is {} ({}), the model's {model}.",
                rounded(x),
                rounded(y),
                interval()
            )
        };
        let gain = |place: String| {
            format!(
                "{place} the measured speed is {} ({}) times that of the whole record, the model's {}.",
                rounded(y),
                interval(),
                rounded(model)
            )
        };
        Some(match curve.of {
            CurveOf::Input => between("a delayed input of"),
            CurveOf::InputRising => between("a delayed input, reached from below, of"),
            CurveOf::InputFalling => between("a delayed input, reached from above, of"),
            CurveOf::Angle => gain(format!("At {}", measure(x, joint.output_unit.as_deref()))),
            CurveOf::Time => gain(format!("{} s after the start", rounded(x))),
        })
    }
}

/// Times the noise above which an error is said to be more than noise.
pub(super) const ABOVE_NOISE: f64 = 1.15;

impl Finding<'_> {
    pub(super) fn joint(&self) -> &Joint {
        self.compared.joint
    }

    pub(super) fn comparison(&self) -> &Comparison {
        self.compared.comparison
    }

    /// A number in output units.
    pub(super) fn output(&self, value: f64) -> String {
        measure(value, self.joint().output_unit.as_deref())
    }

    pub(super) fn error(&self) -> f64 {
        self.comparison().judged().map_or(f64::NAN, |error| error.rmse)
    }

    pub(super) fn noise(&self) -> Option<f64> {
        sensor_noise(&self.joint().trials)
    }

    /// What the effects that were added explain of the error, where any were:
    /// `dead_band and end_stop explain 70 % of the error beyond the noise (2.89 to 0.88 deg)`.
    pub(super) fn explained(&self) -> Option<String> {
        let before = self.before?;
        let mut gained = before.gained(&self.comparison().fit.model);
        let doubtful = self.attribution.map_or(&[][..], |known| &known.doubtful);
        gained.retain(|id| doubtful.iter().all(|one| one.effect != *id));
        let gained: Vec<String> = gained.into_iter().map(str::to_owned).collect();
        let explain = match gained.as_slice() {
            [] => return None,
            [_] => "explains",
            _ => "explain",
        };
        let share = percent(self.consequence().explained()?);
        let (from, to) = (rounded(self.before?.rmse()?), self.output(self.error()));
        let names = listed(&gained, "and");
        Some(format!("{names} {explain} {share} of the error beyond the noise ({from} to {to})"))
    }

    /// What the model explains of the motion: `1 − e/d` with the standard deviation `d` of what
    /// was measured.
    pub(super) fn follows(&self) -> String {
        let model = match effects_text(&self.comparison().fit.model) {
            alone if self.comparison().fit.model.components().is_empty() => format!("the {alone}"),
            effects => format!("a model with {effects}"),
        };
        match self.comparison().judged().map(|error| error.fit_percent) {
            Some(fit) if fit > 0.0 => {
                format!("{model} explains {} of the motion", percent(fit / 100.0))
            }
            _ => format!("{model} does not explain the motion"),
        }
    }
}

/// `The output follows the input itself, not its integral (r² 0.93): the model is a first order
/// with dead time, of time constant 0.16 s.`
pub(super) fn first_order(joint: &Joint, of: &AssessedModel) -> Option<String> {
    let time_constant_s = time_constant_s(&of.model)?;
    let r_squared = follows_input(joint)?;
    Some(format!(
        "The output follows the input itself, not its integral (r² {r_squared:.2}): the model is \
         a first order with dead time, of time constant {} s.",
        rounded(time_constant_s)
    ))
}
