//! The delay of every sample: `τ_k`.

use super::dead_time::Window;
use super::decision::Decision;
use super::settings::Interpolation;
use crate::experiment::Trial;

/// The delay of every sample in samples; empty where none was recorded.
#[derive(Clone, Debug)]
pub struct DelayProfile {
    samples: usize,
    /// In the order of their samples; where two meet, the later one counts.
    spans: Vec<Span>,
}

/// Samples whose delays are on a line.
#[derive(Clone, Copy, Debug)]
struct Span {
    /// Indices of its samples: from the first to behind the last.
    start: usize,
    end: usize,
    /// The delay at the first, samples.
    delay: f64,
    /// Its change from one sample to the next.
    change: f64,
}

impl Span {
    fn at(&self, index: usize) -> Option<f64> {
        let is_inside = (self.start..self.end).contains(&index);
        let delay = is_inside.then(|| self.delay + self.change * (index - self.start) as f64);
        delay.filter(|delay| !delay.is_nan())
    }
}

impl DelayProfile {
    /// The profile of a trial of `samples`, from its `decisions` in order.
    ///
    /// At `p_(i+1)` two accepted steps meet; the later one counts.
    pub(super) fn of(decisions: &[Decision], samples: usize, between: Interpolation) -> Self {
        let span = |(index, decision): (usize, &Decision)| {
            let delay = decision.accepted_delay()?;
            let next = decisions.get(index + 1);
            let end = next.map_or(samples, |next| next.input_step.sample);
            let start = decision.input_step.sample;
            let target = match between {
                Interpolation::Hold => None,
                Interpolation::Linear => next.and_then(Decision::accepted_delay),
            };
            let change = target.map_or(0.0, |target| target - delay) / (end - start).max(1) as f64;
            Some(Span { start: start - 1, end: end.min(samples), delay, change })
        };
        Self { samples, spans: decisions.iter().enumerate().filter_map(span).collect() }
    }

    /// The profile of the trial with this `number`, from 0, of a joint whose dead time was
    /// estimated in `windows`: that of the window whose middle is nearest.
    pub(crate) fn of_windows(windows: &[Window], number: usize, trial: &Trial) -> Self {
        let own: Vec<&Window> = windows.iter().filter(|window| window.trial == number).collect();
        let period_s = trial.period().seconds();
        let of = |sample: usize| {
            let inside = own.iter().filter(|w| (w.first..=w.last).contains(&sample));
            let nearest = inside.min_by_key(|w| (w.first + w.last).abs_diff(2 * sample));
            let bounds = nearest.and_then(|window| window.estimate);
            bounds.map(|bounds| bounds.value_s / period_s)
        };
        let mut spans: Vec<Span> = Vec::new();
        for (index, delay) in (1..=trial.len()).map(of).enumerate() {
            let Some(delay) = delay.filter(|delay| !delay.is_nan()) else { continue };
            match spans.last_mut().filter(|span| span.end == index) {
                Some(span) if span.delay.to_bits() == delay.to_bits() => span.end += 1,
                _ => spans.push(Span { start: index, end: index + 1, delay, change: 0.0 }),
            }
        }
        Self { samples: trial.len(), spans }
    }

    /// `τ_k` in samples at the sample number `k`, counted from 1.
    pub fn at(&self, k: usize) -> Option<f64> {
        self.at_index(k.checked_sub(1)?)
    }

    fn at_index(&self, index: usize) -> Option<f64> {
        let later = self.spans.partition_point(|span| span.start <= index);
        self.spans.get(later.checked_sub(1)?)?.at(index)
    }

    /// `τ_k` of all samples in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Option<f64>> + '_ {
        (0..self.samples).map(|index| self.at_index(index))
    }
}

impl PartialEq for DelayProfile {
    /// Equal where both are empty, too.
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}
