//! The whole record: what was measured, what a revision simulates, and the residual.

use std::ops::{Range, RangeInclusive};

use crate::diagnosis::failure::WorstSegment;
use rerun::datatypes::Vec2D;

use super::ladder::judged;
use crate::diagnosis::{Comparison, sensor_noise};
use crate::experiment::Joint;
use crate::recording::canvas::{Plot, SHEET, Span, Strips};
use crate::recording::error::RecordError;
use crate::recording::error_share::{HATCH, short};
use crate::recording::layers::{Ink, Layers};
use crate::recording::layout::{JointLayout, TrialLayout};
use crate::recording::palette;
use crate::recording::shaded::{Spans, areas, condition, validation, where_it_fails};
use crate::recording::sheet::Sheet;
use crate::report::MANY_TIMES_NOISE;
use crate::units::floor_to_index;
use crate::wording::{bracketed, misfit_units, rounded};

/// Width and height of the sheet.
pub(in crate::recording) const SIZE: (f32, f32) = (SHEET.0, 690.0);

/// Top and bottom of the plots of the output: above them their titles.
const ROWS: RangeInclusive<f32> = 56.0..=292.0;

/// How far above the plot the ranks of the worst segments stand: between their bars and the title.
const RANKS: f32 = 40.0;

/// Points of a curve: two for each of 1500 columns of pixels.
const POINTS: usize = 3000;

/// Width of the noise band in standard deviations on each side: 95 % of normal noise.
const BAND: f64 = 1.96;

/// Part of the height of the residual that is left free above where the model fails.
const BELOW_UNSEEN: f32 = 0.2;

/// Adds the drawings of models of `joint`, which follow one another on the timeline of `rows`.
pub(in crate::recording) fn add(
    rows: &mut Layers<'_>,
    layout: &JointLayout<'_>,
    joint: &Joint,
    models: &[&Comparison],
) -> Result<(), RecordError> {
    let drawing = Drawing::of(layout, joint);
    let of_each = || models.iter().copied();
    let residuals: Vec<Plot> = of_each().map(|c| drawing.residual_plot(c)).collect();
    let close_ups: Vec<CloseUp> = of_each().map(|c| CloseUp::of(layout, c)).collect();
    let sheet = |(((comparison, plot), close), number)| {
        drawing.sheet(comparison, plot, close, palette::name(number)).into_parts()
    };
    let sheets = of_each().zip(&residuals).zip(&close_ups).zip(0..).map(sheet);
    let (grids, texts): (Vec<_>, Vec<_>) = sheets.unzip();
    // What was not fitted is seen above where the model fails.
    for (path, rgb, from, spans) in [
        ("validation", palette::UNSEEN_GROUND, 0.0, validation as fn(&Comparison) -> Spans),
        ("fails", palette::FAILS_GROUND, BELOW_UNSEEN, where_it_fails),
    ] {
        let each = of_each().zip(&residuals);
        let shaded = each.map(|(comparison, plot)| areas(layout, plot, from, &spans(comparison)));
        rows.strips(path, rgb, HATCH, shaded)?;
    }
    rows.strips("grid", palette::GRID, 0.7, grids)?;
    rows.texts("texts", palette::BORDER, texts)?;
    let windows = close_ups.iter().map(|close| drawing.window_in_record(close));
    rows.strips("window", palette::BORDER, 0.9, windows)?;
    let measured =
        close_ups.iter().map(|close| drawing.outputs(close, |trial| trial.trial.output()));
    rows.strips("measured", palette::MEASURED, 3.0, measured)?;
    let simulated =
        of_each().zip(&close_ups).map(|(c, close)| drawing.outputs(close, |t| t.simulated(c)));
    let own: Vec<_> = (0..models.len()).map(palette::model).collect();
    rows.strips("simulated", Ink::ByRow(own.clone()), 1.2, simulated)?;
    let of_plots = || of_each().zip(&residuals);
    let curves =
        of_plots().map(|(comparison, plot)| drawing.curves(plot, |t| t.residual(comparison)));
    rows.strips("residual", Ink::ByRow(own), 1.0, curves)?;
    let worst = of_plots().map(|(comparison, plot)| worst(layout, comparison, plot));
    rows.strips("worst", palette::REJECTED, 3.0, worst)?;
    // The noise is the sensor's, whatever the model.
    let noise = drawing.noise;
    rows.strips("noise", palette::NOISE, 1.0, residuals.iter().map(|p| band(p, noise)))
}

/// Where the curves lie on the sheet.
struct Drawing<'l, 'a> {
    layout: &'l JointLayout<'a>,
    joint: &'l Joint,
    /// The noise of the sensor, where there is some.
    noise: Option<f64>,
    output: Plot,
    /// Seconds of the whole record.
    x: Span,
    samples: usize,
}

/// The part of the record in which the residual of a revision is largest.
struct CloseUp {
    window: Window,
    plot: Plot,
    title: String,
}

impl CloseUp {
    fn of(layout: &JointLayout<'_>, comparison: &Comparison) -> Self {
        let worst = comparison.failure.as_ref().and_then(|failure| failure.worst_segments.first());
        let named = worst.and_then(|worst| Window::about(layout, worst));
        let window = named.unwrap_or_else(|| {
            let residuals = layout.trials.iter().map(|trial| trial.residual(comparison));
            Window::worst(&residuals.collect::<Vec<_>>())
        });
        let trial = layout.trials.get(window.place).filter(|_| layout.trials.len() > 1);
        let title = match (worst, trial.map(|trial| trial.trial.label())) {
            (Some(_), None) => "close up: worst segment 1".to_owned(),
            (None, None) => "close up: where the residual is largest".to_owned(),
            (Some(_), Some(trial)) => format!("segment 1: trial {trial}"),
            (None, Some(trial)) => format!("largest residual: trial {trial}"),
        };
        let all = trial_values(layout, &window, |trial| trial.simulated(comparison));
        Self { plot: close_up(layout, &window, all), window, title }
    }
}

/// Samples of a trial, counted from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Window {
    /// Its place among the trials of the layout.
    place: usize,
    samples: Range<usize>,
}

impl Window {
    /// Where the squares of `residuals`, one list per trial, are largest: about a
    /// [`PARTS`]th of all samples, within one trial.
    fn worst(residuals: &[&[f64]]) -> Self {
        let all: usize = residuals.iter().map(|trial| trial.len()).sum();
        let longest = (all / PARTS).max(1);
        let windows = residuals.iter().enumerate().flat_map(|(place, trial)| {
            let length = longest.min(trial.len());
            let starts = (0..=trial.len() - length).step_by((length / 4).max(1));
            starts.map(move |start| (place, start..start + length))
        });
        let square = |(place, samples): &(usize, Range<usize>)| -> f64 {
            let part = residuals.get(*place).and_then(|trial| trial.get(samples.clone()));
            part.unwrap_or_default().iter().map(|residual| residual * residual).sum()
        };
        let worst = windows.max_by(|a, b| square(a).total_cmp(&square(b)));
        worst.map_or(Self { place: 0, samples: 0..0 }, |(place, samples)| Self { place, samples })
    }

    /// As much of the trial about a segment that is named, so that what is named is seen.
    fn about(layout: &JointLayout<'_>, worst: &WorstSegment) -> Option<Self> {
        let all: usize = layout.trials.iter().map(|trial| trial.trial.len()).sum();
        let mut trials = layout.trials.iter().enumerate();
        let (place, trial) = trials.find(|(_, trial)| trial.trial.label() == worst.trial)?;
        let (first_s, period_s) = (trial.trial.time_s(1), trial.trial.period().seconds());
        let index = |time_s: f64| floor_to_index(((time_s - first_s) / period_s).round());
        let (start, end) = (index(worst.start_s), index(worst.end_s) + 1);
        let beside = (all / PARTS).saturating_sub(end - start) / 2;
        let samples = start.saturating_sub(beside)..(end + beside).min(trial.trial.len());
        Some(Self { place, samples })
    }
}

/// Parts of the record of which one is looked at closely: a few steps of the input are in it.
const PARTS: usize = 15;

impl<'l, 'a> Drawing<'l, 'a> {
    fn of(layout: &'l JointLayout<'a>, joint: &'l Joint) -> Self {
        let trials = &layout.trials;
        let ends = trials.iter().flat_map(|t| [t.seconds(1), t.seconds(t.trial.len())]);
        let x = Span::around(ends, 0.005);
        let outputs = trials.iter().flat_map(|trial| trial.trial.output().iter().copied());
        Self {
            layout,
            joint,
            noise: sensor_noise(&joint.trials),
            output: Plot::within((120.0, 900.0), ROWS, x, Span::around(outputs, 0.08)),
            x,
            samples: trials.iter().map(|trial| trial.trial.len()).sum(),
        }
    }

    /// The residual of a revision at its own scale: the last one would be a line at the first
    /// one's.
    fn residual_plot(&self, comparison: &Comparison) -> Plot {
        let residuals = comparison.fit.evaluation.residuals.iter().flatten().copied();
        Plot::new(452.0..=644.0, self.x, Span::around(residuals, 0.05))
    }

    fn sheet(
        &self,
        comparison: &Comparison,
        residual_plot: &Plot,
        close: &CloseUp,
        color: &str,
    ) -> Sheet {
        let unit = bracketed("", self.joint.output_unit.as_deref());
        let mut sheet = Sheet::default();
        let horizon = comparison.fit.evaluation.horizon;
        for (plot, x_ticks, title) in [
            (
                &self.output,
                self.output.x_span().ticks(8.0),
                format!("output{unit}: measured white, simulated {color}"),
            ),
            (&close.plot, Vec::new(), close.title.clone()),
        ] {
            sheet.outline(plot, &x_ticks, &ticks(plot));
            sheet.title(plot, 46.0, title);
        }
        let ends = close.plot.x_span();
        // Moved inward: at the corner it would cover the lowest tick of the output.
        for (end, inward) in [(ends.low, 45.0), (ends.high, -45.0)] {
            let Vec2D([x, y]) = close.plot.below(end, 2.0);
            sheet.put(Vec2D::new(x + inward, y), format!("{} s", short(end)));
        }
        let times = self.noise.map(|noise| judged(comparison) / noise);
        let times = times.filter(|times| *times < MANY_TIMES_NOISE);
        let times = times.map(|times| format!(": {} times the noise", rounded(times)));
        let units = misfit_units(self.joint);
        let fails = condition(comparison).map(|condition| {
            let clauses: Vec<_> = condition.clauses.iter().map(|it| it.with_unit(&units)).collect();
            format!("red: {}", clauses.join(" and "))
        });
        let spans = worst_spans(self.layout, comparison);
        let bars = (!spans.is_empty()).then(|| "bars: worst segments".to_owned());
        let noise = self.noise.map(|_| "blue lines: 95 % of the noise".to_owned());
        let grey = (!comparison.per_step.is_empty()).then(|| "grey: not fitted".to_owned());
        let key: Vec<String> = [noise, bars, grey, fails].into_iter().flatten().collect();
        let residual = format!("residual{unit}, {horizon}{}", times.unwrap_or_default());
        let x_ticks = residual_plot.x_span().ticks(10.0);
        // Its title lies above the bars of the worst segments, not on them.
        sheet.outline(residual_plot, &x_ticks, &ticks(residual_plot));
        // Two rows: one of all of it is wider than a small window.
        sheet.title(residual_plot, 118.0, residual);
        sheet.title(residual_plot, 80.0, key.join(" · "));
        for x in x_ticks {
            sheet.put(residual_plot.below(x, 2.0), short(x));
        }
        let middles = spans.iter().map(|(_, ends)| f64::midpoint(ends[0], ends[1]));
        for (place, ranks) in side_by_side(middles.map(|x| residual_plot.x(x)).zip(1..).collect()) {
            sheet.put(Vec2D::new(place, residual_plot.top - RANKS), ranks);
        }
        sheet
    }

    /// The ends of the window in the plot of the whole record.
    fn window_in_record(&self, close: &CloseUp) -> Strips {
        let Span { low, high } = close.plot.x_span();
        [low, high].map(|x| self.output.vertical(x).to_vec()).to_vec()
    }

    /// Curves of the output: a trial each, and the close-up.
    fn outputs<'v>(
        &self,
        close: &CloseUp,
        values: impl Fn(&TrialLayout<'a>) -> &'v [f64],
    ) -> Strips {
        let mut curves = self.curves(&self.output, &values);
        let trial = self.layout.trials.get(close.window.place);
        let close = trial.map(|trial| {
            let part = values(trial).get(close.window.samples.clone()).unwrap_or_default();
            let first = close.window.samples.start + 1;
            close.plot.curve(part, POINTS, |k| trial.seconds(first + k))
        });
        curves.extend(close);
        curves
    }

    /// A curve per trial.
    fn curves<'v>(&self, plot: &Plot, values: impl Fn(&TrialLayout<'a>) -> &'v [f64]) -> Strips {
        let curve = |trial: &TrialLayout<'a>| {
            let share = POINTS * trial.trial.len() / self.samples.max(1);
            plot.curve(values(trial), share.max(100), |k| trial.seconds(k + 1))
        };
        self.layout.trials.iter().map(curve).collect()
    }
}

/// The worst segments, the first of all first, with their ends in seconds of the plots, which go
/// through all trials.
pub(super) fn worst_spans<'c>(
    layout: &JointLayout<'_>,
    comparison: &'c Comparison,
) -> Vec<(&'c WorstSegment, [f64; 2])> {
    let worst = comparison.failure.iter().flat_map(|failure| &failure.worst_segments);
    let of_plots = |worst: &'c WorstSegment| {
        let trial = layout.trial_of(&worst.trial)?;
        let shift = trial.seconds(1) - trial.trial.time_s(1);
        Some((worst, [worst.start_s, worst.end_s].map(|time_s| time_s + shift)))
    };
    worst.filter_map(of_plots).collect()
}

/// The ranks at these places of the sheet: those that would cover each other in one text.
fn side_by_side(mut ranks: Vec<(f32, usize)>) -> Vec<(f32, String)> {
    /// Width of a rank and of its frame, in a window of 1280 points.
    const DIGIT: f32 = 24.0;
    const FRAME: f32 = 20.0;
    ranks.sort_by(|a, b| a.0.total_cmp(&b.0));
    // The middle of the first and of the last one in a text, and the ranks.
    let mut texts: Vec<(f32, f32, Vec<String>)> = Vec::new();
    for (place, rank) in ranks {
        match texts.last_mut() {
            Some((first, last, before))
                if place - f32::midpoint(*first, *last)
                    < FRAME + DIGIT * 0.5 * (before.len() + 1) as f32 =>
            {
                *last = place;
                before.push(rank.to_string());
            }
            _ => texts.push((place, place, vec![rank.to_string()])),
        }
    }
    let text = |(first, last, ranks): (f32, f32, Vec<String>)| {
        (f32::midpoint(first, last), ranks.join(" "))
    };
    texts.into_iter().map(text).collect()
}

/// A bar above each of the worst segments.
fn worst(layout: &JointLayout<'_>, comparison: &Comparison, plot: &Plot) -> Strips {
    let bar = |ends: [f64; 2]| ends.map(|time_s| plot.above(time_s, -12.0)).to_vec();
    worst_spans(layout, comparison).into_iter().map(|(_, ends)| bar(ends)).collect()
}

/// Two levels between which 95 % of the noise lies.
fn band(plot: &Plot, noise: Option<f64>) -> Strips {
    let levels = noise.map(|noise| [BAND * noise, -BAND * noise]);
    let inside = |y: &f64| (0.0..=1.0).contains(&plot.y_span().part(*y));
    levels.into_iter().flatten().filter(inside).map(|y| plot.level(y).to_vec()).collect()
}

/// The values of the window's trial within it.
fn trial_values<'v>(
    layout: &JointLayout<'v>,
    window: &Window,
    values: impl Fn(&TrialLayout<'v>) -> &'v [f64],
) -> &'v [f64] {
    let all = layout.trials.get(window.place).map_or(&[][..], values);
    all.get(window.samples.clone()).unwrap_or_default()
}

/// The plot of a window, with room for what is `simulated` there as far as it is no farther from the
/// measured output than that goes.
fn close_up(layout: &JointLayout<'_>, window: &Window, simulated: &[f64]) -> Plot {
    let trial = layout.trials.get(window.place);
    let ends = trial.map(|trial| {
        let Range { start, end } = window.samples;
        [trial.seconds(start + 1), trial.seconds(end)]
    });
    let output = trial_values(layout, window, |trial| trial.trial.output()).iter().copied();
    let Span { low, high } = Span::around(output.clone(), 0.0);
    let (lowest, highest) = (2.0 * low - high, 2.0 * high - low);
    let shown = simulated.iter().filter(|y| y.is_finite()).map(|y| y.clamp(lowest, highest));
    let x = Span::around(ends.into_iter().flatten(), 0.0);
    Plot::within((1010.0, SHEET.0 - 15.0), ROWS, x, Span::around(output.chain(shown), 0.08))
}

fn ticks(plot: &Plot) -> Vec<(f64, String)> {
    plot.y_span().ticks(4.0).into_iter().map(|tick| (tick, short(tick))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_that_would_cover_each_other_are_one_text() {
        let found = side_by_side(vec![(900.0, 1), (300.0, 2), (920.0, 3), (310.0, 4), (600.0, 5)]);
        let text = |(place, text): &(f32, &str)| (*place, (*text).to_owned());
        let expected = [(305.0, "2 4"), (600.0, "5"), (910.0, "1 3")];
        assert_eq!(found, expected.iter().map(text).collect::<Vec<_>>());
    }

    #[test]
    fn the_window_is_where_the_residual_is_largest_and_within_a_trial() {
        let quiet = vec![0.1; 600];
        let mut loud = quiet.clone();
        loud[300..330].fill(2.0);
        let window = Window::worst(&[quiet.as_slice(), loud.as_slice(), quiet.as_slice()]);
        assert_eq!(window.place, 1);
        assert_eq!(window.samples.len(), 120);
        assert!(window.samples.start <= 300 && window.samples.end >= 330);
        assert_eq!(Window::worst(&[]), Window { place: 0, samples: 0..0 });
    }
}
