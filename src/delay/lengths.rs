//! The settings that are lengths of time: in samples, or in seconds.

use super::settings::{InSeconds, Settings};
use crate::experiment::Trial;
use crate::units::{Length, SamplePeriod};

/// Puts a length where it belongs; the samples of one in seconds stay as they were.
fn put(length: Length, samples: &mut usize, seconds: &mut Option<f64>) {
    match length {
        Length::Samples(number) => (*samples, *seconds) = (number, None),
        Length::Seconds(number) => *seconds = Some(number),
    }
}

fn length(seconds: Option<f64>, samples: usize) -> Length {
    seconds.map_or(Length::Samples(samples), Length::Seconds)
}

impl Settings {
    /// With this α.
    #[must_use]
    pub fn with_alpha(mut self, alpha: Length) -> Self {
        put(alpha, &mut self.alpha, &mut self.in_seconds.alpha);
        self
    }

    /// With this β.
    #[must_use]
    pub fn with_beta(mut self, beta: Length) -> Self {
        put(beta, &mut self.beta, &mut self.in_seconds.beta);
        self
    }

    /// With this `τ_min`.
    #[must_use]
    pub fn with_min_delay(mut self, delay: Length) -> Self {
        put(delay, &mut self.min_delay, &mut self.in_seconds.min_delay);
        self
    }

    /// With this longest delay.
    #[must_use]
    pub fn with_max_delay(mut self, delay: Length) -> Self {
        let (mut samples, mut seconds) = (0, None);
        put(delay, &mut samples, &mut seconds);
        (self.max_delay, self.in_seconds.max_delay) =
            (seconds.is_none().then_some(samples), seconds);
        self
    }

    /// α as it was given.
    pub(crate) fn alpha_length(&self) -> Length {
        length(self.in_seconds.alpha, self.alpha)
    }

    /// β as it was given.
    pub(crate) fn beta_length(&self) -> Length {
        length(self.in_seconds.beta, self.beta)
    }

    /// `τ_min` as it was given.
    pub(crate) fn min_delay_length(&self) -> Length {
        length(self.in_seconds.min_delay, self.min_delay)
    }

    /// The longest delay as it was given.
    pub(crate) fn max_delay_length(&self) -> Option<Length> {
        let given = self.in_seconds.max_delay.map(Length::Seconds);
        given.or(self.max_delay.map(Length::Samples))
    }

    /// These settings for a trial that is sampled every `period`: all lengths in samples.
    #[must_use]
    pub fn at(&self, period: SamplePeriod) -> Self {
        let max_delay = self.max_delay_length().map(|delay| delay.samples(period).max(1));
        Self {
            alpha: self.alpha_length().samples(period).max(self.alpha.min(1)),
            beta: self.beta_length().samples(period).max(self.beta.min(1)),
            min_delay: self.min_delay_length().samples(period),
            max_delay: max_delay.filter(|_| self.in_seconds.max_delay.is_some()).or(self.max_delay),
            in_seconds: InSeconds::default(),
            ..self.clone()
        }
    }

    /// These settings in samples where all of `trials` have one period; else as they are.
    #[must_use]
    pub(crate) fn in_samples<'a>(&self, trials: impl IntoIterator<Item = &'a Trial>) -> Self {
        common_period(trials).map_or_else(|| self.clone(), |period| self.at(period))
    }
}

/// The sample period of all of `trials`, where they have one.
pub(super) fn common_period<'a>(
    trials: impl IntoIterator<Item = &'a Trial>,
) -> Option<SamplePeriod> {
    let mut periods = trials.into_iter().map(Trial::period);
    let period = periods.next()?;
    periods.all(|other| other == period).then_some(period)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::Method;

    fn trial(period: f64) -> Trial {
        let period = SamplePeriod::from_seconds(period).unwrap();
        Trial::new("1", 0.0, period, vec![0.0; 3], vec![0.0; 3]).unwrap()
    }

    #[test]
    fn seconds_are_counted_in_the_samples_of_each_trial() {
        let settings = Settings::of(Method::TWO_LINE)
            .with_alpha(Length::Seconds(0.1))
            .with_beta(Length::Seconds(0.001))
            .with_max_delay(Length::Seconds(0.5));
        let [fast, slow] = [0.01, 0.02].map(|period| settings.at(trial(period).period()));
        assert_eq!((fast.alpha, fast.beta, fast.max_delay), (10, 1, Some(50)));
        assert_eq!((slow.alpha, slow.beta, slow.max_delay), (5, 1, Some(25)));
        assert_eq!(settings.in_samples(&[trial(0.01), trial(0.01)]), fast);
        assert_eq!(settings.in_samples(&[trial(0.01), trial(0.02)]), settings);
    }

    #[test]
    fn what_is_in_samples_stays() {
        let settings =
            Settings { max_delay: Some(30), min_delay: 4, ..Settings::of(Method::TWO_LINE) };
        assert_eq!(settings.at(trial(0.02).period()), settings);
        let seconds = settings.clone().with_min_delay(Length::Seconds(0.1));
        assert_eq!(seconds.with_min_delay(Length::Samples(4)), settings);
    }
}
