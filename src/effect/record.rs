//! How large things are in a record, for the start values and bounds of a fit.

use super::Dimension;

/// The ranges of the signals of one joint's record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordRange<'a> {
    /// The neutral of a coded input, in input units: levels count from there. Zero where the input is
    /// not coded.
    pub input_neutral: f64,
    /// Largest magnitude of the input, in input units.
    pub input_abs_max: f64,
    /// Highest minus lowest input, in input units.
    pub input_span: f64,
    /// The distinct magnitudes of the input, in input units, ascending.
    pub input_levels: &'a [f64],
    /// Lowest output, in output units.
    pub output_min: f64,
    /// Highest output, in output units.
    pub output_max: f64,
    /// Largest steady speed, in output units per second.
    pub speed_abs_max: f64,
    /// Length of the record in seconds.
    pub duration_s: f64,
    /// Seconds between two samples.
    pub sample_period_s: f64,
    /// The angle in radians of one output unit.
    pub radians_per_output_unit: f64,
    /// The period, in output units, at which the speed ripples most with the angle while the input
    /// is held, where any was found.
    pub ripple_period: Option<f64>,
    /// The further signals that were measured.
    pub signals: &'a [SignalRange<'a>],
}

/// The range of a measured signal, in its own unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalRange<'a> {
    /// Its name, without the joint's.
    pub name: &'a str,
    /// Lowest value.
    pub min: f64,
    /// Highest value.
    pub max: f64,
}

impl SignalRange<'_> {
    /// The value halfway between the lowest and the highest.
    pub fn middle(&self) -> f64 {
        f64::midpoint(self.min, self.max)
    }

    /// Half of highest minus lowest; 1 where it never changes.
    pub fn half(&self) -> f64 {
        positive(0.5 * (self.max - self.min))
    }
}

/// A minute of a joint in degrees at 100 Hz, driven by one unit of input.
impl Default for RecordRange<'_> {
    fn default() -> Self {
        Self {
            input_neutral: 0.0,
            input_abs_max: 1.0,
            input_span: 2.0,
            input_levels: &[],
            output_min: -45.0,
            output_max: 45.0,
            speed_abs_max: 10.0,
            duration_s: 60.0,
            sample_period_s: 0.01,
            radians_per_output_unit: 1_f64.to_radians(),
            ripple_period: None,
            signals: &[],
        }
    }
}

/// How many times the size of the record a quantity may be in a fit.
const REACH: f64 = 10.0;

impl RecordRange<'_> {
    /// Highest minus lowest output; 1 where the output never changes.
    pub fn output_span(&self) -> f64 {
        positive(self.output_max - self.output_min)
    }

    /// The output halfway between the lowest and the highest.
    pub fn output_middle(&self) -> f64 {
        f64::midpoint(self.output_min, self.output_max)
    }

    /// Output units in a full turn of the joint.
    pub fn turn(&self) -> f64 {
        std::f64::consts::TAU / positive(self.radians_per_output_unit)
    }

    /// The range of the measured signal with this name; 0 to 2 where there is none.
    pub fn signal(&self, name: &str) -> SignalRange<'_> {
        let known = self.signals.iter().find(|signal| signal.name == name);
        known.copied().unwrap_or(SignalRange { name: "", min: 0.0, max: 2.0 })
    }

    /// The size in this record of a quantity of this dimension, above zero.
    ///
    /// Times are not measured by the record: their size is one second.
    pub fn size(&self, dimension: Dimension) -> f64 {
        match dimension {
            Dimension::One
            | Dimension::Seconds
            | Dimension::PerSecond
            | Dimension::Signal
            | Dimension::PerSignal => 1.0,
            Dimension::Input => positive(self.input_abs_max),
            Dimension::PerInput | Dimension::SecondsPerInput => 1.0 / positive(self.input_abs_max),
            Dimension::Output => self.output_span(),
            Dimension::OutputPerSecond => positive(self.speed_abs_max),
            Dimension::PerOutput => 1.0 / self.output_span(),
            Dimension::PerOutputSquared => self.output_span().powi(-2),
            Dimension::PerOutputCubed => self.output_span().powi(-3),
        }
    }

    /// Lowest and highest value of this dimension that the record can distinguish from others.
    pub fn extent(&self, dimension: Dimension) -> (f64, f64) {
        let size = self.size(dimension);
        match dimension {
            Dimension::One | Dimension::PerSecond | Dimension::Signal | Dimension::PerSignal => {
                (f64::NEG_INFINITY, f64::INFINITY)
            }
            Dimension::Input | Dimension::OutputPerSecond => (-size, size),
            Dimension::Output => (self.output_min - size, self.output_max + size),
            Dimension::Seconds => {
                let longest = positive(self.duration_s);
                (-longest, longest)
            }
            Dimension::PerInput
            | Dimension::SecondsPerInput
            | Dimension::PerOutput
            | Dimension::PerOutputSquared
            | Dimension::PerOutputCubed => (-REACH * size, REACH * size),
        }
    }

    /// Up to `count` values, ascending, that part the input levels from one another.
    ///
    /// A threshold between the same two levels always has the same effect, so there is
    /// a valley of the error in each gap: the values are the middles of the gaps, the
    /// first one below the smallest level that is not zero.
    pub fn thresholds(&self, count: usize) -> Vec<f64> {
        let levels = || self.input_levels.iter().copied().filter(|level| *level > 0.0);
        let below = std::iter::once(0.0).chain(levels());
        let gaps: Vec<_> = below.zip(levels()).map(|(a, b)| f64::midpoint(a, b)).collect();
        if gaps.is_empty() {
            return vec![0.1 * self.size(Dimension::Input)];
        }
        let last = gaps.len() - 1;
        let steps = count.saturating_sub(1).min(last).max(1);
        let mut chosen: Vec<_> = (0..=steps).map(|i| i * last / steps).collect();
        chosen.dedup();
        chosen.truncate(count);
        chosen.into_iter().map(|gap| gaps[gap]).collect()
    }
}

/// `value`, or 1 where it is not a positive number.
fn positive(value: f64) -> f64 {
    if value.is_finite() && value > 0.0 { value } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_lie_in_the_gaps_between_levels() {
        let levels = [0.0, 1.0, 2.0, 4.0];
        let record = RecordRange { input_levels: &levels, ..RecordRange::default() };
        assert_eq!(record.thresholds(9), [0.5, 1.5, 3.0]);
        assert_eq!(record.thresholds(2), [0.5, 3.0]);
        assert_eq!(record.thresholds(1), [0.5]);
        assert_eq!(RecordRange::default().thresholds(3), [0.1]);
    }

    #[test]
    fn a_record_in_which_nothing_happens_still_has_a_size() {
        let record =
            RecordRange { output_min: 3.0, output_max: 3.0, speed_abs_max: 0.0, ..<_>::default() };
        for dimension in [Dimension::Output, Dimension::OutputPerSecond, Dimension::PerOutput] {
            assert!((record.size(dimension) - 1.0).abs() < 1e-15);
        }
        assert!((record.turn() - 360.0).abs() < 1e-9);
    }
}
