//! The output around one step, and what each setting makes of it.

use rerun::datatypes::Vec2D;

use super::map::{Block, beside, blocks, named};
use super::swept::{Opinion, Swept};
use crate::delay::sweep::SweptStep;
use crate::experiment::{Joint, Trial};
use crate::recording::canvas::{CURVE_POINTS, Labels, Plot, SHEET, Span};
use crate::recording::chunk::{Chunks, Index};
use crate::recording::error::RecordError;
use crate::recording::layers::Layers;
use crate::recording::palette::{self, dimmed};
use crate::recording::paths;
use crate::recording::sheet::{Sheet, TITLE};
use crate::wording::{bracketed, number as shown};

/// Width and height of the sheet.
pub(in crate::recording) const SIZE: (f32, f32) = (SHEET.0, 1090.0);

/// Left and right ends of the plots: names of settings are on the left.
const SIDES: (f32, f32) = (196.0, SHEET.0 - 40.0);

/// Draws each step below `root`. On the timeline of settings, where one step is all that can
/// be seen, it is the one that is most sensitive to a setting.
pub(super) fn add(chunks: &mut Chunks, swept: &Swept<'_>) -> Result<(), RecordError> {
    let (index, order) = worst_last(swept);
    let drawn = order.iter().filter_map(|place| swept.steps.get(*place));
    let drawings: Vec<_> = drawn.map(|(step, trial)| Drawing::of(swept, step, trial)).collect();
    add_row_names(&mut Layers::fixed(chunks, paths::ONE), swept)?;
    let mut layers = Layers::rows(chunks, paths::ONE, index).back_to_front();
    let sheets = drawings.iter().map(|drawing| drawing.sheet(swept.reported.joint).into_parts());
    let (grids, texts): (Vec<_>, Vec<_>) = sheets.unzip();
    layers.strips("grid", palette::GRID, 0.7, grids)?;
    let green = dimmed(palette::ACCEPTED);
    layers.strips("allowed", green, 1.0, drawings.iter().map(Drawing::allowed))?;
    layers.strips("agreed", palette::ACCEPTED, 1.3, drawings.iter().map(Drawing::agreed))?;
    layers.strips("output", palette::RAW, 1.6, drawings.iter().map(Drawing::output))?;
    layers.strips("input_step", palette::INPUT, 1.3, drawings.iter().map(Drawing::input_step))?;
    for (path, opinion) in
        [("same", Opinion::Same), ("longer", Opinion::Longer), ("shorter", Opinion::Shorter)]
    {
        let delays = drawings.iter().map(|drawing| drawing.delays(opinion));
        layers.points(path, opinion.rgb(), radius(swept), delays)?;
    }
    layers.texts("texts", palette::BORDER, texts)
}

/// The steps in their order but for the most sensitive one, which is last; where they lie,
/// at the first tick of the settings, too.
fn worst_last(swept: &Swept<'_>) -> (Index, Vec<usize>) {
    let mut order: Vec<usize> = (0..swept.steps.len()).collect();
    let hanging = swept.reported.sweep.sensitive();
    let worst = hanging
        .first()
        .and_then(|worst| swept.steps.iter().position(|(step, _)| std::ptr::eq(*step, *worst)));
    if let Some(worst) = worst {
        order.remove(worst);
        order.push(worst);
    }
    let index = swept.index.rows(&order).all_at("setting", Some(1));
    (index, order)
}

/// Rows of the lower plot.
fn rows_span(swept: &Swept<'_>) -> Span {
    Span::new(0.0, swept.grid.combinations().len().max(1) as f64)
}

/// Upper and lower end of the lower plot.
const ROWS: (f32, f32) = (620.0, 1030.0);

fn radius(swept: &Swept<'_>) -> f32 {
    let row = (ROWS.1 - ROWS.0) / swept.grid.combinations().len().max(1) as f32;
    (0.7 * row).clamp(3.0, 6.0)
}

/// The names of methods and low-passes beside their rows.
fn add_row_names(layers: &mut Layers<'_>, swept: &Swept<'_>) -> Result<(), RecordError> {
    let plot = Plot::within(SIDES, ROWS.0..=ROWS.1, Span::new(0.0, 1.0), rows_span(swept));
    let mut texts = Labels::default();
    for block in named(swept.grid) {
        texts.put(beside(&plot, &block), block.label);
    }
    let border = |block: &Block| plot.level(plot.y_span().high - block.first as f64).to_vec();
    let borders = blocks(swept.grid).0.iter().map(border).collect();
    layers.strips("blocks", palette::BORDER, 0.7, [borders])?;
    layers.texts("rows", palette::BORDER, [texts])
}

/// One step on its sheet.
struct Drawing<'s> {
    swept: &'s Swept<'s>,
    step: &'s SweptStep,
    trial: &'s Trial,
    /// The samples that are shown, 1-based.
    window: (usize, usize),
    output: Plot,
    delays: Plot,
}

impl<'s> Drawing<'s> {
    fn of(swept: &'s Swept<'s>, step: &'s SweptStep, trial: &'s Trial) -> Self {
        let window = window(step, trial);
        let from = |k: usize| k as f64 - step.sample as f64;
        let x = Span::new(from(window.0), from(window.1));
        let values = trial.output().get(window.0 - 1..window.1).unwrap_or_default();
        let y = Span::around(values.iter().copied(), 0.06);
        let output = Plot::within(SIDES, 100.0..=520.0, x, y);
        let delays = Plot::within(SIDES, ROWS.0..=ROWS.1, x, rows_span(swept));
        Self { swept, step, trial, window, output, delays }
    }

    /// Grid, ticks and titles.
    fn sheet(&self, joint: &Joint) -> Sheet {
        let mut sheet = Sheet::default();
        let unit = bracketed("", joint.output_unit.as_deref());
        let title = format!("{}; the output{unit} as measured", self.in_words(joint));
        let x_ticks = self.delays.x_span().ticks(12.0);
        sheet.outline(&self.output, &x_ticks, &self.output.y_ticks(4.0));
        sheet.outline(&self.delays, &x_ticks, &[]);
        for plot in [&self.output, &self.delays] {
            for x in &x_ticks {
                sheet.put(plot.below(*x, 2.0), shown(*x));
            }
        }
        sheet.title(&self.output, TITLE, title);
        sheet.title(&self.delays, TITLE, "its delay in samples, with every setting");
        sheet
    }

    fn in_words(&self, joint: &Joint) -> String {
        let SweptStep { number, time_s, sample, .. } = self.step;
        let input = self.trial.input();
        let level = |k: usize| input.get(k).copied().unwrap_or_default();
        let (before, after) = (level(sample.saturating_sub(2)), level(sample - 1));
        let (before, after) = (shown(before), shown(after));
        let unit = joint.input_unit.as_ref().map_or(String::new(), |unit| format!(" {unit}"));
        let trial = match joint.trials.len() {
            1 => String::new(),
            _ => format!(" of trial {}", self.step.trial),
        };
        format!("step {number}{trial} at {time_s:.2} s, {before} to {after}{unit}")
    }

    /// The output, sample by sample.
    fn output(&self) -> Vec<Vec<Vec2D>> {
        let (first, last) = self.window;
        let values = self.trial.output().get(first - 1..last).unwrap_or_default();
        let place = |index: usize| (first + index) as f64 - self.step.sample as f64;
        vec![self.output.curve(values, CURVE_POINTS, place)]
    }

    fn input_step(&self) -> Vec<Vec<Vec2D>> {
        vec![self.output.through(&self.delays, 0.0).to_vec()]
    }

    /// The delay that most agree on, through both plots.
    fn agreed(&self) -> Vec<Vec<Vec2D>> {
        let agreed = self.step.agreement.iter();
        agreed.map(|agreed| self.output.through(&self.delays, agreed.delay).to_vec()).collect()
    }

    /// The ends of what all of them allow.
    fn allowed(&self) -> Vec<Vec<Vec2D>> {
        let ends = self.step.agreement.iter().flat_map(|agreed| [agreed.low, agreed.high]);
        ends.map(|end| self.delays.vertical(end).to_vec()).collect()
    }

    /// A point in the row of each combination of this opinion.
    fn delays(&self, opinion: Opinion) -> Vec<Vec2D> {
        let rows = self.swept.grid.combinations().iter().enumerate();
        let own = rows.filter(|(_, one)| Swept::cell(self.step, one.run).opinion == opinion);
        let place = |(row, one): (usize, &crate::delay::sweep::Combination)| {
            let delay = Swept::delay(self.step, one.run)?;
            Some(self.delays.at(delay, self.delays.y_span().high - row as f64 - 0.5))
        };
        own.filter_map(place).collect()
    }
}

/// The samples around a step: a little before it, and so far behind it that all delays are
/// seen.
fn window(step: &SweptStep, trial: &Trial) -> (usize, usize) {
    /// Least samples that are shown behind a step, and how many where no delay is known.
    const REACH: (usize, usize) = (20, 100);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "samples")]
    let longest = step.spread.map(|spread| (1.4 * spread.max.max(0.0)) as usize);
    let reach = longest.map_or(REACH.1, |longest| longest.max(REACH.0));
    let first = step.sample.saturating_sub(reach / 2).max(1);
    (first, (step.sample + reach).min(trial.len()))
}
