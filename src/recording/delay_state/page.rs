//! The page of plots, and the cursor in it.

use rerun::Points2D;
use rerun::datatypes::Vec2D;

use super::placed::{Placed, add_numbers, placed};
use super::quantity::Quantity;
use crate::delay::{AgainstState, StepState};
use crate::experiment::{Joint, Trial};
use crate::figure::course::Bin;
use crate::figure::delay_against::Way;
use crate::recording::canvas::{Labels, Plot, SHEET, Span};
use crate::recording::chunk::Chunks;
use crate::recording::error::RecordError;
use crate::recording::layers::{HIDDEN, Ink, Layers};
use crate::recording::layout::JointLayout;
use crate::recording::palette::{self, Rgb, color};
use crate::recording::paths;
use crate::recording::sheet::Sheet;
use crate::report::variable_text;
use crate::units::SamplePeriod;
use crate::wording::number;

/// Height of the sheet.
pub(in crate::recording) const HEIGHT: f32 = 800.0;

/// Plots that fit on the sheet; the weakest are not drawn.
const PLOTS: usize = 12;

/// Adds the page below `/against`, and its numbers at `/delay/state`.
pub(in crate::recording) fn add(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
) -> Result<(), RecordError> {
    let found = layout.estimated.against_state();
    let placed = placed(layout, &found.steps);
    add_numbers(chunks, layout.joint, &placed)?;
    let page = Page::of(layout.joint, &found, &placed);
    page.add_plots(chunks)?;
    page.add_texts(chunks)?;
    page.add_cursor(chunks, layout, &placed)
}

/// All plots on their sheet.
struct Page<'f> {
    joint: &'f Joint,
    found: &'f AgainstState,
    /// Each quantity that is drawn, with its plot.
    plots: Vec<(Quantity, Plot)>,
    /// Each accepted step in words, for the pointer.
    names: Vec<String>,
    /// Quantities there are.
    quantities: usize,
    /// Columns of plots.
    columns: usize,
    /// Seconds per sample, where all trials have the same.
    period_s: Option<f64>,
}

impl<'f> Page<'f> {
    fn of(joint: &'f Joint, found: &'f AgainstState, placed: &[Placed<'_, '_>]) -> Self {
        let mut quantities = Quantity::of(found);
        let count = quantities.len();
        quantities.truncate(if found.steps.is_empty() { 0 } else { PLOTS });
        let columns = (1..=PLOTS).find(|side| side * side >= quantities.len()).unwrap_or(1);
        let y = Span::around(found.steps.iter().map(|step| step.delay_s), 0.06);
        let grid = (columns, quantities.len().div_ceil(columns));
        let place = |(place, quantity): (usize, Quantity)| {
            let plot = plot(place, grid, quantity.x_span(), y);
            (quantity, plot)
        };
        let mut periods = joint.trials.iter().map(Trial::period);
        let first = periods.next();
        let period_s = first.filter(|first| periods.all(|other| other == *first));
        Self {
            joint,
            found,
            plots: quantities.into_iter().enumerate().map(place).collect(),
            names: placed.iter().filter_map(Placed::name).collect(),
            quantities: count,
            columns,
            period_s: period_s.map(SamplePeriod::seconds),
        }
    }

    /// What stays: grid, points, medians.
    fn add_plots(&self, chunks: &mut Chunks) -> Result<(), RecordError> {
        let (mut sheet, mut depends) = (Sheet::default(), Vec::new());
        let (mut bands, mut medians) = (Vec::new(), Vec::new());
        for (quantity, plot) in &self.plots {
            let x_ticks: Vec<_> = quantity.x_ticks().into_iter().map(|(x, _)| x).collect();
            let y_ticks = plot.y_span().ticks(DELAY_TICKS).into_iter();
            let y_ticks: Vec<_> = y_ticks.map(|y| (y, String::new())).collect();
            sheet.outline(plot, &x_ticks, &y_ticks);
            if quantity.depends {
                depends.push(plot.frame());
            }
            for bins in quantity.courses(&self.found.steps) {
                bands.push(band(plot, &bins));
                medians.push(plot.places(bins.iter().map(|bin| (bin.x, bin.median))));
            }
        }
        let mut layers = Layers::fixed(chunks, paths::AGAINST);
        for (path, rgb, radius, order, strips) in [
            ("band", palette::BAND, 0.6 * STROKE, 5.0, bands),
            ("grid", palette::GRID, 0.7, 10.0, sheet.grid),
            ("depends", palette::BORDER, 1.4, 15.0, depends),
            ("median", palette::BORDER, 2.0, 40.0, medians),
        ] {
            layers.order(order).strips(path, rgb, radius, [strips])?;
        }
        for (path, rgb, way) in [("down", palette::DOWN, Way::Down), ("up", palette::UP, Way::Up)] {
            let Labels { places, texts, .. } = self.points(way);
            let points = Points2D::new(places).with_colors([color(rgb)]).with_radii([3.0]);
            layers.stays(path, &points.with_labels(texts).with_show_labels(false))?;
        }
        Ok(())
    }

    /// The points of all steps in one direction, plot by plot, and what they are.
    fn points(&self, way: Way) -> Labels {
        let mut points = Labels::default();
        for (quantity, plot) in &self.plots {
            let steps = self.found.steps.iter().zip(&self.names).enumerate();
            for (number, (step, name)) in steps.filter(|(_, (step, _))| Way::of(step) == way) {
                if let Some(place) = place_of(quantity, plot, number, step) {
                    points.put(place, name.clone());
                }
            }
        }
        points
    }

    fn add_texts(&self, chunks: &mut Chunks) -> Result<(), RecordError> {
        let (mut ticks, mut titles) = (Labels::default(), Labels::default());
        for (place, (quantity, plot)) in self.plots.iter().enumerate() {
            for (x, text) in quantity.x_ticks() {
                ticks.put(plot.below(x, 2.0), text);
            }
            self.delay_ticks(place, plot, &mut ticks);
            let shade = if quantity.depends { palette::BORDER } else { palette::RAW };
            titles.put_in(shade, plot.above(plot.middle(), 56.0), clipped(&quantity.title));
            titles.put_in(shade, plot.above(plot.middle(), 28.0), quantity.finding());
        }
        let mut layers = Layers::fixed(chunks, paths::AGAINST);
        layers.texts("ticks", palette::RAW, [ticks])?;
        layers.texts("titles", Ink::Own, [titles])?;
        layers.texts("legend", Ink::Own, [self.legend()])
    }

    /// Seconds at the left of a row of plots, samples at its right.
    fn delay_ticks(&self, place: usize, plot: &Plot, ticks: &mut Labels) {
        let is_last = place + 1 == self.plots.len();
        if place.is_multiple_of(self.columns) {
            for y in plot.y_span().ticks(DELAY_TICKS) {
                ticks.put(plot.left_of(y, 34.0), format!("{} s", number(y)));
            }
        }
        if let Some(period_s) = self.period_s
            && ((place + 1).is_multiple_of(self.columns) || is_last)
        {
            let Span { low, high } = plot.y_span();
            for samples in Span::new(low / period_s, high / period_s).ticks(DELAY_TICKS) {
                ticks.put(plot.right_of(samples * period_s, 26.0), number(samples));
            }
        }
    }

    fn legend(&self) -> Labels {
        let axis = if self.period_s.is_some() {
            "delay: seconds left, samples right; point at a dot for its step"
        } else {
            "delay in seconds; point at a dot for its step"
        };
        let entries: [(f32, f32, String, Rgb); 5] = [
            (SHEET.0 / 2.0, 0.0, self.headline(), palette::BORDER),
            (90.0, LEGEND, "● step up".to_owned(), palette::UP),
            (225.0, LEGEND, "● step down".to_owned(), palette::DOWN),
            (495.0, LEGEND, "line: median; shaded: middle half".to_owned(), palette::BORDER),
            (850.0, LEGEND, axis.to_owned(), palette::RAW),
        ];
        let mut labels = Labels::default();
        for (x, y, text, rgb) in entries {
            labels.put_in(rgb, Vec2D::new(x, y), text);
        }
        labels
    }

    /// The answer in a sentence.
    fn headline(&self) -> String {
        let name = &self.joint.name;
        let steps = match self.found.steps.len() {
            1 => "1 accepted step".to_owned(),
            count => format!("{count} accepted steps"),
        };
        let quantities = || self.plots.iter().map(|(quantity, _)| quantity);
        if quantities().all(|quantity| quantity.p_value.is_none()) {
            return format!("{name}: {steps}, too few to test what the delay depends on");
        }
        let rest = match self.quantities - self.plots.len() {
            0 => String::new(),
            weakest => format!("; the weakest {weakest} are not drawn"),
        };
        let basis = format!("{steps}, p ≤ 0.05 after Holm's correction{rest}");
        let names: Vec<_> = quantities().filter(|q| q.depends).map(|q| q.name.as_str()).collect();
        if names.is_empty() {
            return format!("{name}: the delay is not shown to depend on any of these ({basis})");
        }
        let more = match names.len().saturating_sub(NAMED) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let named = names.into_iter().take(NAMED).collect::<Vec<_>>().join(", ");
        let apart = self.confounded_words();
        format!("{name}: the delay depends on {named}{more}{apart} ({basis})")
    }

    /// Two variables that go together, if any do.
    fn confounded_words(&self) -> String {
        let pairs = self.found.kinds.iter().flat_map(|kind| &kind.confounded);
        let words = |[one, other]: &[String; 2]| {
            let (one, other) = (variable_text(one, None), variable_text(other, None));
            format!("; {one} and {other} go together and cannot be separated")
        };
        pairs.map(words).next().unwrap_or_default()
    }

    /// The step of each segment, in words and as a bright point in every plot.
    fn add_cursor(
        &self,
        chunks: &mut Chunks,
        layout: &JointLayout<'_>,
        placed: &[Placed<'_, '_>],
    ) -> Result<(), RecordError> {
        let here = placed.iter().map(|placed| {
            let step = placed.step.into_iter();
            let of_step = step.flat_map(|(number, step)| {
                self.plots.iter().filter_map(move |(q, plot)| place_of(q, plot, number, step))
            });
            of_step.collect()
        });
        let mut layers = Layers::rows(chunks, paths::AGAINST, layout.openings());
        layers.order(50.0).points("here", palette::CANDIDATE, 8.0, here)?;
        let style = Points2D::new([Vec2D::new(SHEET.0 - 280.0, LEGEND)]).with_show_labels(true);
        let style = style.with_colors([color(palette::CANDIDATE)]).with_radii([HIDDEN]);
        layers.stays("step", &style)?;
        let words: Vec<_> = placed.iter().map(Placed::sentence).collect();
        let lengths = vec![1; words.len()];
        layers.push("step", &Points2D::update_fields().with_labels(words), &lengths)
    }
}

/// Row of the legend on the sheet.
const LEGEND: f32 = 28.0;

/// Ticks of the delay, about.
const DELAY_TICKS: f64 = 6.0;

/// Quantities that the headline names.
const NAMED: usize = 4;

/// Letters of a quantity's name that fit over its plot.
const NAME: usize = 40;

fn clipped(name: &str) -> String {
    if name.chars().count() <= NAME {
        return name.to_owned();
    }
    name.chars().take(NAME - 1).chain(['…']).collect()
}

/// Where a step lies in a plot, where its value is known.
fn place_of(quantity: &Quantity, plot: &Plot, number: usize, step: &StepState) -> Option<Vec2D> {
    Some(plot.at((*quantity.values.get(number)?)?, step.delay_s))
}

/// The place of a plot in a grid of `columns` and `rows`; room for a title above each.
fn plot(place: usize, (columns, rows): (usize, usize), x: Span, y: Span) -> Plot {
    let part = |of: usize, low: f32, high: f32, n: usize| low + (high - low) * n as f32 / of as f32;
    let column = |n| part(columns, 80.0, SHEET.0 - 30.0, n);
    let row = |n| part(rows, 60.0, HEIGHT, n);
    let (across, down) = (place % columns, place / columns);
    let rows = row(down) + 58.0..=row(down + 1) - 30.0;
    Plot::within((column(across), column(across + 1) - 30.0), rows, x, y)
}

/// Distance of the strokes that fill a band, on the sheet.
const STROKE: f32 = 2.5;

/// The band between the quartiles, as one strip up and down: a sheet has no filled shape.
fn band(plot: &Plot, bins: &[Bin]) -> Vec<Vec2D> {
    let mut strip = Vec::new();
    for pair in bins.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let width = plot.x(to.x) - plot.x(from.x);
        let strokes = f64::from((width / STROKE).ceil().max(1.0));
        let between = |a: f64, b: f64, part: f64| a + part * (b - a);
        let stroke = |number: i32| {
            let part = f64::from(number) / strokes;
            let x = between(from.x, to.x, part);
            let lower = plot.at(x, between(from.lower, to.lower, part));
            let upper = plot.at(x, between(from.upper, to.upper, part));
            if number % 2 == 0 { [lower, upper] } else { [upper, lower] }
        };
        #[expect(clippy::cast_possible_truncation, reason = "as many as fit on the sheet")]
        strip.extend((0..=strokes as i32).flat_map(stroke));
    }
    strip
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Span;

    #[test]
    fn a_band_reaches_from_quartile_to_quartile() {
        let plot = Plot::new(0.0..=100.0, Span::new(0.0, 1.0), Span::new(0.0, 10.0));
        let bin = Bin { x: 0.0, lower: 2.0, median: 3.0, upper: 6.0 };
        let strip = band(&plot, &bin.level(0.0, 1.0));
        let rows = strip.iter().map(Vec2D::y);
        let (low, high) = (rows.clone().fold(0.0, f32::max), rows.fold(100.0, f32::min));
        assert!((low - 80.0).abs() < 1e-3 && (high - 40.0).abs() < 1e-3, "{low} {high}");
        assert!(strip.windows(2).all(|pair| (pair[1].x() - pair[0].x()).abs() <= STROKE + 1e-3));
    }
}
