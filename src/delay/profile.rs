//! The delay of every sample: `τ_k`.

use super::dead_time::Window;
use super::decision::Decision;
use super::settings::Interpolation;
use crate::experiment::Trial;

/// The delay of every sample in samples; empty where none was recorded.
#[derive(Clone, Debug)]
pub struct DelayProfile {
    /// Not a number where there is none.
    delays: Vec<f64>,
}

impl DelayProfile {
    /// The profile of a trial of `samples`, from its `decisions` in order.
    ///
    /// At `p_(i+1)` two accepted steps meet; the later one counts.
    pub(super) fn of(decisions: &[Decision], samples: usize, between: Interpolation) -> Self {
        let mut delays = vec![f64::NAN; samples];
        for (index, decision) in decisions.iter().enumerate() {
            let Some(delay) = decision.accepted_delay() else { continue };
            let next = decisions.get(index + 1);
            let end = next.map_or(samples, |next| next.input_step.sample);
            let start = decision.input_step.sample;
            let target = match between {
                Interpolation::Hold => None,
                Interpolation::Linear => next.and_then(Decision::accepted_delay),
            };
            let change = target.map_or(0.0, |target| target - delay) / (end - start).max(1) as f64;
            let own = delays.get_mut(start - 1..end.min(samples)).unwrap_or_default();
            for (k, slot) in own.iter_mut().enumerate() {
                *slot = delay + change * k as f64;
            }
        }
        Self { delays }
    }

    /// The profile of the trial with this `number`, from 0, of a joint whose dead time was
    /// estimated in `windows`: that of the window whose middle is nearest.
    pub(crate) fn of_windows(windows: &[Window], number: usize, trial: &Trial) -> Self {
        let own: Vec<&Window> = windows.iter().filter(|window| window.trial == number).collect();
        let of = |sample: usize| {
            let inside = own.iter().filter(|w| (w.first..=w.last).contains(&sample));
            let nearest = inside.min_by_key(|w| (w.first + w.last).abs_diff(2 * sample));
            let bounds = nearest.and_then(|window| window.estimate);
            bounds.map_or(f64::NAN, |bounds| bounds.value_s / trial.period().seconds())
        };
        Self { delays: (1..=trial.len()).map(of).collect() }
    }

    /// `τ_k` in samples at the sample number `k`, counted from 1.
    pub fn at(&self, k: usize) -> Option<f64> {
        self.delays.get(k.checked_sub(1)?).copied().filter(|delay| !delay.is_nan())
    }

    /// `τ_k` of all samples in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Option<f64>> + '_ {
        self.delays.iter().map(|delay| Some(*delay).filter(|delay| !delay.is_nan()))
    }
}

impl PartialEq for DelayProfile {
    /// Equal where both are empty, too.
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}
