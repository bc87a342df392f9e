//! The page of plots, and the cursor in it.

use std::ops::RangeInclusive;

use rerun::datatypes::Vec2D;

use super::placed::{Placed as Step, add_numbers, placed};
use super::quantity::Quantity;
use crate::delay::{AgainstState, StepState};
use crate::experiment::{Joint, Trial};
use crate::figure::course::Bin;
use crate::figure::delay_levels::Way;
use crate::figure::{Axis, Mark, Panel, Role, Shape};
use crate::recording::canvas::{Plot, SHEET, Span, Text};
use crate::recording::chunk::Chunks;
use crate::recording::error::RecordError;
use crate::recording::layers::Layers;
use crate::recording::layout::JointLayout;
use crate::recording::palette::{self, role};
use crate::recording::panels::{self, Placed};
use crate::recording::paths;
use crate::report::against::variable_text;
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
    let mut fixed = Layers::fixed(chunks, paths::AGAINST);
    let page = Page::drawn(&mut fixed, (layout.joint, &found), &placed)?;
    fixed.texts("legend", vec![page.legend()])?;
    let mut rows = Layers::rows(chunks, paths::AGAINST, layout.openings()).in_front();
    page.add_cursor(&mut rows, &placed)
}

/// All plots on their sheet.
struct Page<'f> {
    joint: &'f Joint,
    found: &'f AgainstState,
    /// Each quantity that is drawn, with its plot.
    plots: Vec<(Quantity, Plot)>,
    /// Quantities there are.
    quantities: usize,
    /// Seconds per sample, where all trials have the same.
    period_s: Option<f64>,
}

impl<'f> Page<'f> {
    /// Draws what stays: grid, points, medians.
    fn drawn(
        layers: &mut Layers<'_>,
        (joint, found): (&'f Joint, &'f AgainstState),
        placed: &[Step<'_, '_>],
    ) -> Result<Self, RecordError> {
        let mut quantities = Quantity::of(found);
        let count = quantities.len();
        quantities.truncate(if found.steps.is_empty() { 0 } else { PLOTS });
        let mut periods = joint.trials.iter().map(Trial::period);
        let first = periods.next();
        let period_s = first.filter(|first| periods.all(|other| other == *first));
        let period_s = period_s.map(SamplePeriod::seconds);
        let names: Vec<String> = placed.iter().filter_map(Step::name).collect();
        let grid = Grid::of(quantities.len());
        let placed = quantities.iter().enumerate().map(|(place, quantity)| {
            let panel = panel(quantity, (&found.steps, &names), grid.scales(place, period_s));
            let (columns, rows) = grid.place(place);
            Placed::new(panel, columns, rows)
        });
        let placed: Vec<Placed> = placed.collect();
        let plots: Vec<Plot> = placed.iter().map(|placed| placed.plot).collect();
        panels::add(layers, [placed])?;
        let plots = quantities.into_iter().zip(plots).collect();
        Ok(Self { joint, found, plots, quantities: count, period_s })
    }

    fn legend(&self) -> Vec<Text> {
        let axis = if self.period_s.is_some() {
            "delay: seconds left, samples right; point at a dot for its step"
        } else {
            "delay in seconds; point at a dot for its step"
        };
        let entries = [
            (SHEET.0 / 2.0, 0.0, self.headline(), palette::BORDER),
            (90.0, LEGEND, "● step up".to_owned(), palette::UP),
            (225.0, LEGEND, "● step down".to_owned(), palette::DOWN),
            (495.0, LEGEND, "line: median; shaded: middle half".to_owned(), palette::BORDER),
            (850.0, LEGEND, axis.to_owned(), palette::RAW),
        ];
        entries.map(|(x, y, text, rgb)| (Vec2D::new(x, y), text, rgb)).to_vec()
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
            format!("; {one} and {other} are correlated and cannot be separated")
        };
        pairs.map(words).next().unwrap_or_default()
    }

    /// The step of each segment, in words and as a bright point in every plot.
    fn add_cursor(
        &self,
        layers: &mut Layers<'_>,
        placed: &[Step<'_, '_>],
    ) -> Result<(), RecordError> {
        let here = placed.iter().map(|placed| {
            let of_step = placed.step.into_iter().flat_map(|(number, step)| {
                let place = move |(quantity, plot): &(Quantity, Plot)| {
                    let place = (quantity.value(number)?, step.delay_s);
                    let here = Shape::Dots(vec![place], 8.0);
                    Some((Mark::new(role(palette::CANDIDATE), here).part("here"), *plot))
                };
                self.plots.iter().filter_map(place)
            });
            of_step.collect()
        });
        panels::add_marks(layers, here)?;
        let at = Vec2D::new(SHEET.0 - 280.0, LEGEND);
        let words = placed.iter().map(|step| vec![(at, step.sentence(), palette::CANDIDATE)]);
        layers.texts("step", words.collect())
    }
}

/// Where the plots lie on the sheet.
#[derive(Clone, Copy)]
struct Grid {
    plots: usize,
    columns: usize,
}

/// What stands at the sides of a plot: seconds at the left of a row of plots, samples of so many seconds
/// at its right.
#[derive(Clone, Copy)]
struct Scales {
    seconds: bool,
    samples: Option<f64>,
}

impl Grid {
    fn of(plots: usize) -> Self {
        let columns = (1..=PLOTS).find(|side| side * side >= plots).unwrap_or(1);
        Self { plots, columns }
    }

    fn scales(self, place: usize, period_s: Option<f64>) -> Scales {
        let is_last = place + 1 == self.plots || (place + 1).is_multiple_of(self.columns);
        let seconds = place.is_multiple_of(self.columns);
        Scales { seconds, samples: period_s.filter(|_| is_last) }
    }

    /// The columns and the rows of a plot; above it is room for its names.
    fn place(self, place: usize) -> ((f32, f32), RangeInclusive<f32>) {
        let part =
            |of: usize, low: f32, high: f32, n: usize| low + (high - low) * n as f32 / of as f32;
        let column = |n| part(self.columns, 110.0, SHEET.0 - 30.0, n);
        let row = |n| part(self.plots.div_ceil(self.columns), 60.0, HEIGHT, n);
        let (across, down) = (place % self.columns, place / self.columns);
        let rows = row(down) + 48.0..=row(down + 1) - 30.0;
        ((column(across), column(across + 1) - 30.0), rows)
    }
}

/// The delays of `steps`, which have these names, against a quantity.
fn panel(quantity: &Quantity, (steps, names): (&[StepState], &[String]), scales: Scales) -> Panel {
    let x_span = quantity.x_span();
    let y_span = Span::around(steps.iter().map(|step| step.delay_s), 0.06);
    let mut y = Axis::new(y_span, "", DELAY_TICKS);
    for (_, text) in &mut y.ticks {
        *text = if scales.seconds { format!("{text} s") } else { String::new() };
    }
    let shade = if quantity.depends { Role::Ink } else { Role::Faint };
    let courses = quantity.courses(steps);
    let band = |bins: &Vec<Bin>| {
        let heights = bins.iter().map(|bin| [bin.x, bin.lower, bin.upper]).collect();
        Mark::new(role(palette::BAND), Shape::Area(heights)).part("band")
    };
    let mut marks: Vec<Mark> = courses.iter().map(band).collect();
    let Span { low: left, high: right } = x_span;
    let Span { low, high } = y_span;
    let frame = vec![(left, low), (right, low), (right, high), (left, high), (left, low)];
    let frame = if quantity.depends { vec![frame] } else { Vec::new() };
    marks.push(Mark::lines(Role::Ink, 1.4, frame).part("depends"));
    for (part, rgb, way) in [("down", palette::DOWN, Way::Down), ("up", palette::UP, Way::Up)] {
        let own = steps.iter().zip(names).enumerate();
        let own = own.filter(|(_, (step, _))| Way::of(step) == way);
        let dots = own.filter_map(|(number, (step, name))| {
            Some(((quantity.value(number)?, step.delay_s), 3.0, name.clone()))
        });
        marks.push(Mark::new(role(rgb), Shape::Named(dots.collect())).part(part));
    }
    let medians = courses.iter().map(|bins| bins.iter().map(|bin| (bin.x, bin.median)).collect());
    let medians = Mark::lines(shade, 2.0, medians.collect()).named(quantity.finding());
    marks.push(medians.part("median"));
    marks.extend(scales.samples.map(|period_s| {
        let samples = Span::new(low / period_s, high / period_s).ticks(DELAY_TICKS).into_iter();
        let words = samples.map(|n| ((right, n * period_s), number(n))).collect();
        Mark::new(Role::Faint, Shape::Words(words)).part("samples")
    }));
    let name = clipped(&quantity.title);
    let x = Axis { ticks: quantity.x_ticks(), ..Axis::new(x_span, name, 1.0) };
    Panel { x, y, height: 160, marks }
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
