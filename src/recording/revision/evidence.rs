//! What each level of the input made of the joint, and the laws that models draw through it.
//!
//! Where a level is held, the measured output runs along a line: its slope is a speed that
//! owes nothing to a model, but for when the level began to act. Against the level it shows
//! a dead band, a saturation or a curve. An output that follows the input itself runs to a level of
//! its own, which is looked at instead. What does not show there is in [`residual`].

use std::ops::Range;

use super::figure::{Figure, Held, Law};
use super::residual;
use crate::diagnosis::Comparison;
use crate::experiment::{Joint, Trial};
use crate::fit::{FitRecord, Horizon, Split, follows_input};
use crate::model::{Arrivals, JointModel, Restart, Simulated, Surroundings, simulate};
use crate::recording::canvas::Span;
use crate::recording::error::RecordError;
use crate::recording::error_share::short;
use crate::recording::palette;
use crate::recording::paths::revision::sheet;
use crate::recording::rows::Rows;
use crate::recording::sheet::Sheet;
use crate::report::ImprovedJoint;
use crate::units::floor_to_index;
use crate::wording::measure;

/// Fewest samples of a level whose speed is known.
const SHORTEST: usize = 12;

/// Levels at which a law is computed.
const LEVELS: u32 = 120;

/// Speeds and laws of each revision, and what is drawn of them.
pub(super) struct Evidence {
    pub(super) held: Vec<Vec<Held>>,
    pub(super) laws: Vec<Law>,
    figures: Vec<Figure>,
}

/// What is measured, and what the models of `improved` make of it.
pub(super) fn evidence(improved: &ImprovedJoint<'_>) -> Evidence {
    let joint = improved.finding.compared.joint;
    let shown = if follows_input(joint).is_some() { Shown::Output } else { Shown::Speed };
    let still = Still::of(joint, shown);
    let of_each = || improved.revisions.iter().map(|revision| &revision.comparison);
    let held: Vec<Vec<Held>> = of_each().map(|c| all_held(joint, c, shown)).collect();
    let measured = held.iter().flatten().map(|held| held.speed);
    let simulated = held.iter().flatten().filter_map(|held| held.simulated);
    let y = Span::around(measured.chain(simulated), 0.05);
    let laws: Vec<Law> = of_each().map(|comparison| still.law(&comparison.fit.model)).collect();
    let x = Span::around(still.levels().into_iter(), 0.03);
    let mut figures = Vec::new();
    for (at, ((number, step), held)) in improved.numbered().zip(&held).enumerate() {
        let own = laws.get(at).cloned().unwrap_or_default();
        let proposed = improved.proposed(at);
        let next = proposed.map_or_else(Vec::new, |candidate| still.law(&candidate.fit.model));
        if let Some(candidate) = proposed.filter(|_| are_alike(&own, &next)) {
            figures.push(residual::figure(joint, &step.comparison, number, candidate));
            continue;
        }
        let before = at.checked_sub(1).and_then(|before| laws.get(before));
        figures.push(Figure {
            title: title(joint, shown),
            x,
            y,
            points: held.clone(),
            names: [
                Some(still.legend(number, &step.comparison.fit.model, joint)),
                before.map(|_| format!("revision {}", number - 1)),
                proposed.map(|candidate| format!("with {}", candidate.name())),
            ],
            laws: [own, before.cloned().unwrap_or_default(), next],
        });
    }
    Evidence { held, laws, figures }
}

/// Whether two laws are so near that the difference is not seen.
fn are_alike(law: &Law, other: &Law) -> bool {
    /// In parts of the range of both.
    const SEEN: f64 = 0.04;
    let range = Span::around(law.iter().chain(other).map(|point| point.1), 0.0);
    let seen = SEEN * (range.high - range.low);
    law.len() == other.len() && law.iter().zip(other).all(|(a, b)| (a.1 - b.1).abs() <= seen)
}

/// What is looked at while a level is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shown {
    /// Its speed.
    Speed,
    /// The output to which it runs, over the last third of the hold.
    Output,
}

fn title(joint: &Joint, shown: Shown) -> String {
    let unit = |unit: &Option<String>, per: &str| {
        unit.as_ref().map_or(String::new(), |unit| format!(" [{unit}{per}]"))
    };
    let input = unit(&joint.input_unit, "");
    match shown {
        Shown::Speed => format!("speed{} at held input{input}", unit(&joint.output_unit, "/s")),
        Shown::Output => format!("output{} at held input{input}", unit(&joint.output_unit, "")),
    }
}

/// Adds the points, and the laws drawn through them.
pub(super) fn add(rows: &mut Rows<'_>, evidence: &Evidence) -> Result<(), RecordError> {
    let figures = || evidence.figures.iter();
    for (name, which, rgb, radius) in [
        ("before", 1, palette::BEFORE, 2.0),
        ("proposed", 2, palette::PROPOSED, 2.0),
        ("law", 0, palette::REVISION, 3.0),
    ] {
        rows.strips(name, rgb, radius, figures().map(|figure| figure.curve(which)))?;
    }
    rows.strips(sheet::UNCERTAIN, palette::MEASURED, 0.8, figures().map(Figure::uncertain))?;
    rows.points(sheet::SIMULATED, palette::REVISION, 3.5, figures().map(Figure::simulated))?;
    rows.points(sheet::POINTS, palette::MEASURED, 4.0, figures().map(Figure::measured))?;
    for (name, which, rgb) in [
        ("law_name", 0, palette::REVISION),
        ("before_name", 1, palette::BEFORE),
        ("proposed_name", 2, palette::PROPOSED),
    ] {
        rows.texts(name, rgb, figures().map(|figure| figure.legend(which)))?;
    }
    Ok(())
}

impl Evidence {
    /// Grid and title of the plot of the revision at `place`.
    pub(super) fn sheet(&self, place: usize) -> Sheet {
        let mut drawn = Sheet::default();
        if let Some(figure) = self.figures.get(place) {
            let plot = figure.plot();
            let ticks = |ticks: Vec<f64>| ticks.into_iter().map(|tick| (tick, short(tick)));
            let x_ticks = plot.x_span().ticks(5.0);
            let y_ticks: Vec<_> = ticks(plot.y_span().ticks(4.0)).collect();
            drawn.frame(&plot, &x_ticks, &y_ticks, &figure.title);
            for (x, text) in ticks(x_ticks) {
                drawn.put(plot.below(x, 2.0), text);
            }
        }
        drawn
    }
}

/// What is shown of each level that acts; of parts of the record where no level is held.
fn all_held(joint: &Joint, comparison: &Comparison, shown: Shown) -> Vec<Held> {
    let noise = comparison.noise_floor.unwrap_or(0.0);
    let trials = joint.trials.iter().zip(&comparison.fit.evaluation.simulated);
    trials.flat_map(|(trial, simulated)| of_trial(trial, simulated, (noise, shown))).collect()
}

fn of_trial(trial: &Trial, simulated: &Simulated, (noise, shown): (f64, Shown)) -> Vec<Held> {
    /// Part of the largest input of its trial that drives a joint into a stop.
    const DRIVEN: f64 = 0.1;
    let acting = simulated.acting.as_slice();
    #[expect(clippy::float_cmp, reason = "a step is any change")]
    let levels: Vec<&[f64]> = acting.chunk_by(|a, b| a == b).collect();
    let known = levels.iter().map(|part| part.len()).filter(|samples| *samples >= SHORTEST);
    let is_held = 2 * known.sum::<usize>() > acting.len();
    let parts = if is_held { levels } else { acting.chunks(2 * SHORTEST).collect() };
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let range = Span::around(trial.output().iter().copied(), 0.0);
    let largest = trial.input().iter().fold(0.0, |most: f64, level| most.max(level.abs()));
    let mut start = 0;
    let mut all = Vec::new();
    for part in parts {
        let output = trial.output().get(start..start + part.len()).unwrap_or_default();
        let within = match shown {
            Shown::Speed if mean(part).abs() > DRIVEN * largest => moving(output, range),
            Shown::Speed => output.len() / 3..output.len(),
            Shown::Output => output.len() - output.len() / 3..output.len(),
        };
        let rows = start + within.start..start + within.end;
        start += part.len();
        let Some(measured) = output.get(within).filter(|_| part.len() >= SHORTEST) else {
            continue;
        };
        let period_s = trial.period().seconds();
        let (speed, std_error) = match shown {
            Shown::Speed => slope(measured, period_s, noise),
            Shown::Output => (mean(measured), noise / (measured.len() as f64).sqrt()),
        };
        // Of a simulation that is set back to the measurement now and then, the speed.
        let simulated = match shown {
            Shown::Speed => simulated.velocity.get(rows).map(mean),
            Shown::Output => simulated.output.get(rows).map(mean),
        };
        all.push(Held { level: mean(part), speed, std_error, simulated });
    }
    all
}

/// The samples over which a hold shows its speed: the later two thirds, since the joint must come up
/// to speed; of a stroke into an end of `range` those between a quarter and three quarters of its
/// way, since it stands behind.
fn moving(output: &[f64], range: Span) -> Range<usize> {
    const FEWEST: usize = 5;
    /// Part of the range that is its end.
    const END: f64 = 0.02;
    /// Part of its way by which a joint that stands may seem to move.
    const STILL: f64 = 0.02;
    let later = output.len() / 3..output.len();
    let Some((first, last)) = output.first().zip(output.last()) else { return later };
    let end = if last > first { range.high } else { range.low };
    let stands = |y: &f64| (y - end).abs() <= END * (range.high - range.low);
    let is_still = |y: &f64| (y - last).abs() <= STILL * (last - first).abs();
    let is_stroke = output.iter().rev().take(output.len() / 4).all(|y| stands(y) && is_still(y));
    let part = |y: &f64| (y - first) / (last - first);
    let begin = output.iter().position(|y| part(y) >= 0.25);
    let end = output.iter().rposition(|y| part(y) <= 0.75);
    match begin.zip(end) {
        Some((begin, end)) if is_stroke && end >= begin + FEWEST => begin..end + 1,
        _ => later,
    }
}

/// The slope of the regression line per second, and its standard error.
fn slope(values: &[f64], period_s: f64, noise: f64) -> (f64, f64) {
    let n = values.len() as f64;
    let spread = n * (n * n - 1.0) / 12.0;
    let middle = 0.5 * (n - 1.0);
    let moment: f64 = values.iter().zip(0_u32..).map(|(y, k)| (f64::from(k) - middle) * y).sum();
    (moment / spread / period_s, noise / spread.sqrt() / period_s)
}

/// A joint that is kept in the middle of its record while its speed settles.
struct Still {
    angle: f64,
    /// The largest output of the record.
    highest: f64,
    time_s: f64,
    period_s: f64,
    radians_per_output_unit: f64,
    input: Span,
    shown: Shown,
    /// How long a level is held, on average, seconds; none where none is.
    hold_s: Option<f64>,
}

impl Still {
    fn of(joint: &Joint, shown: Shown) -> Self {
        let range = FitRecord::new(joint, Split::Time(1.0), Horizon::FreeRun).range(&[], 1.0);
        let input = joint.trials.iter().flat_map(Trial::input).copied();
        Self {
            angle: f64::midpoint(range.output_min, range.output_max),
            highest: range.output_max,
            time_s: 0.5 * range.duration_s,
            period_s: range.sample_period_s,
            radians_per_output_unit: range.radians_per_output_unit,
            input: Span::around(input, 0.0),
            shown,
            hold_s: mean_hold_s(joint),
        }
    }

    fn levels(&self) -> Vec<f64> {
        let Span { low, high } = self.input;
        (0..=LEVELS).map(|k| low + (high - low) * f64::from(k) / f64::from(LEVELS)).collect()
    }

    /// What `model` makes of levels that have long been held, or of a hold where an output is shown.
    fn law(&self, model: &JointModel) -> Law {
        self.levels().into_iter().map(|level| (level, self.speed(model, level))).collect()
    }

    /// `revision 9 (orange)`; where what `model` makes of a level depends on where the joint is, with
    /// the output of the law: `revision 9 (line: at -45 deg)`.
    fn legend(&self, number: u32, model: &JointModel, joint: &Joint) -> String {
        let aside = Self { angle: self.angle + 0.5 * (self.highest - self.angle), ..*self };
        if are_alike(&self.law(model), &aside.law(model)) {
            return format!("revision {number} (orange)");
        }
        let output = measure(self.angle, joint.output_unit.as_deref());
        format!("revision {number} (line: at {output})")
    }

    fn speed(&self, model: &JointModel, level: f64) -> f64 {
        /// Seconds after which the memories of effects no longer change.
        const SETTLED_S: f64 = 2.0;
        /// Samples of a hold that is simulated.
        const LONGEST: f64 = 2000.0;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "in bounds")]
        let samples = match self.shown {
            Shown::Speed => (SETTLED_S / self.period_s).clamp(2.0, 400.0) as usize,
            Shown::Output => {
                let samples = self.hold_s.map_or(f64::INFINITY, |hold_s| hold_s / self.period_s);
                floor_to_index(samples.min(LONGEST)).max(2)
            }
        };
        let arrivals = Arrivals { initial: level, changes: Vec::new() };
        let back = |sample| Restart { sample, output: self.angle, speed: None };
        let restarts: Vec<Restart> = match self.shown {
            Shown::Speed => (0..samples).map(back).collect(),
            Shown::Output => vec![back(0)],
        };
        let surroundings = Surroundings {
            others: &[],
            radians_per_output_unit: self.radians_per_output_unit,
            start_s: self.time_s,
        };
        let simulated =
            simulate(model, &arrivals, samples, self.period_s, &restarts, &surroundings);
        let last = match self.shown {
            Shown::Speed => simulated.velocity.last(),
            Shown::Output => simulated.output.last(),
        };
        last.copied().unwrap_or_default()
    }
}

/// How long a level is held on average, where the input is held at all.
fn mean_hold_s(joint: &Joint) -> Option<f64> {
    #[expect(clippy::float_cmp, reason = "a step is any change")]
    let of_trial = |trial: &Trial| {
        let held = trial.input().chunk_by(|a, b| a == b).filter(|part| part.len() >= SHORTEST);
        let (holds, samples) =
            held.fold((0, 0), |(holds, all), part| (holds + 1, all + part.len()));
        (holds, samples as f64 * trial.period().seconds())
    };
    let of_trials = joint.trials.iter().map(of_trial);
    let (holds, held_s) =
        of_trials.fold((0, 0.0), |(n, s), (holds, held_s)| (n + holds, s + held_s));
    (holds > 0).then(|| held_s / f64::from(holds))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::DeadBand;
    use crate::model::Component;
    use crate::units::SamplePeriod;

    fn trial(input: Vec<f64>, output: Vec<f64>) -> Trial {
        Trial::new("", 0.0, SamplePeriod::from_seconds(0.1).unwrap(), input, output).unwrap()
    }

    fn of(acting: Vec<f64>) -> Simulated {
        Simulated { output: acting.clone(), velocity: vec![0.25; acting.len()], acting }
    }

    #[test]
    fn the_slope_of_a_line_is_exact_and_its_error_is_that_of_the_noise() {
        let values: Vec<f64> = (0..20).map(|k| 3.0 + 0.4 * f64::from(k)).collect();
        let (speed, error) = slope(&values, 0.1, 0.05);
        assert!((speed - 4.0).abs() < 1e-12);
        // σ / (T √(n (n² − 1) / 12)) with n = 20: √665 = 25.788.
        assert!((error - 0.05 / 25.787_594 / 0.1).abs() < 1e-6);
    }

    #[test]
    fn a_level_has_one_speed_and_a_short_one_none() {
        let acting = [vec![1.0; 30], vec![-2.0; 5], vec![0.5; 25]].concat();
        let mut y = 0.0;
        let outputs = acting.iter().map(|level| {
            y += 0.3 * level;
            y
        });
        let trial = trial(acting.clone(), outputs.collect());
        let held = of_trial(&trial, &of(acting), (0.0, Shown::Speed));
        let found: Vec<_> = held.iter().map(|held| (held.level, held.speed)).collect();
        assert_eq!(found.len(), 2);
        assert!((found[0].1 - 3.0).abs() < 1e-9 && (found[1].1 - 1.5).abs() < 1e-9);
    }

    #[test]
    fn the_speed_of_a_stroke_is_that_of_its_middle() {
        let output: Vec<f64> =
            (0..100).map(|k| (f64::from(k - 20) * 0.5).clamp(0.0, 10.0)).collect();
        let acting = vec![1.0; 100];
        let held = of_trial(&trial(acting.clone(), output), &of(acting), (0.0, Shown::Speed));
        assert_eq!(held.len(), 1);
        // Half a unit each 0.1 s; it begins late, and stands at its stop for more than half.
        assert!((held[0].speed - 5.0).abs() < 1e-9, "{held:?}");
    }

    #[test]
    fn an_output_that_settles_is_shown_where_it_settles() {
        let acting = [vec![1.0; 30], vec![2.0; 30]].concat();
        let settled = |k: usize| if k % 30 < 10 { 0.0 } else { acting[k] };
        let output: Vec<f64> = (0..60).map(settled).collect();
        let held = of_trial(&trial(acting.clone(), output), &of(acting), (0.0, Shown::Output));
        let found: Vec<_> = held.iter().map(|held| (held.level, held.speed)).collect();
        assert_eq!(found, [(1.0, 1.0), (2.0, 2.0)]);
    }

    #[test]
    fn an_input_that_is_never_held_is_cut_into_parts() {
        let acting: Vec<f64> = (0..240).map(|k| f64::from(k) / 240.0).collect();
        let trial = trial(acting.clone(), acting.clone());
        let held = of_trial(&trial, &of(acting), (0.0, Shown::Speed));
        assert_eq!(held.len(), 10);
        assert!(held.iter().all(|held| held.simulated == Some(0.25)));
        assert!(held.iter().all(|held| (held.speed - 10.0 / 240.0).abs() < 1e-9));
    }

    #[test]
    fn the_law_of_a_dead_band_is_its_equation() {
        let joint = Joint {
            name: "boom".to_owned(),
            input_unit: None,
            output_unit: None,
            covariates: Vec::new(),
            trials: vec![trial(vec![-2.0, 2.0, 1.0], vec![0.0, 5.0, 3.0])],
        };
        let band = Component::new(&DeadBand, vec![(-0.5).into(), 0.6.into()]).unwrap();
        let law =
            Still::of(&joint, Shown::Speed).law(&JointModel::integrator(10.0, 0.2).with(band));
        for (level, speed) in law {
            let expected = 10.0 * ((level - 0.6).max(0.0) + (level + 0.5).min(0.0));
            assert!((speed - expected).abs() < 1e-9, "{level}: {speed}");
        }
    }
}
