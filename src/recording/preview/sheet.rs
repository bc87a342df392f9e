//! The page of a joint: input, expected outputs with their margin, and their difference.

use rerun::datatypes::Vec2D;

use super::expected::{Expectation, Preview};
use crate::design::HoldApart;
use crate::recording::canvas::{CURVE_POINTS, Labels, Plot, SHEET, Span};
use crate::recording::chunk::Chunks;
use crate::recording::error::RecordError;
use crate::recording::layers::{Ink, Layers};
use crate::recording::palette::{self, Rgb, between, color};
use crate::recording::paths;
use crate::recording::sheet::Sheet;
use crate::wording::{bracketed, measure, number};

/// Width and height of the sheet.
pub(in crate::recording) const SIZE: (f32, f32) = (SHEET.0, 1090.0);

/// Left and right ends of the plots: numbers are on the left.
const SIDES: (f32, f32) = (120.0, SHEET.0 - 30.0);

/// How high above its plot a title is put.
const TITLE: f32 = 34.0;

/// What the viewer's ground is drawn in, behind the shade of a band.
const GROUND: Rgb = (13, 16, 17);

/// The plots of a page.
struct Page<'p> {
    preview: &'p Preview<'p>,
    input: Plot,
    output: Option<Plot>,
    apart: Option<Plot>,
}

/// Draws the page below `root`.
pub(super) fn add(chunks: &mut Chunks, preview: &Preview<'_>) -> Result<(), RecordError> {
    let page = Page::of(preview);
    let mut layers = Layers::fixed(chunks, paths::SHEET);
    page.add_bands(&mut layers)?;
    layers.sheets([page.sheet()])?;
    page.add_lines(&mut layers)?;
    layers.texts("legend", Ink::Own, [page.legend()])?;
    page.add_shares(&mut layers)?;
    page.add_here(&mut Layers::rows(chunks, paths::SHEET, preview.hold_rows()))
}

impl<'p> Page<'p> {
    fn of(preview: &'p Preview<'p>) -> Self {
        const MARGIN: f64 = 0.06;
        /// The lowest row of the lowest plot.
        const BOTTOM: f32 = 1010.0;
        let schedule = &preview.joint.schedule;
        let time = Span::new(0.0, schedule.duration_s());
        let plot = |top: f32, bottom: f32, y: Span| Plot::within(SIDES, top..=bottom, time, y);
        let levels = Span::around(schedule.levels().into_iter(), MARGIN);
        if preview.expected.is_empty() {
            return Self { preview, input: plot(90.0, BOTTOM, levels), output: None, apart: None };
        }
        let extents = preview.expected.iter().map(|expected| expected.prediction.extent());
        let own = Span::around(extents.flat_map(|(low, high)| [low, high]), MARGIN);
        // A limit that is far off would flatten the curves.
        let height = own.high - own.low;
        let is_near = |limit: &f64| (own.low - height..own.high + height).contains(limit);
        let range = preview.joint.rig.range.into_iter();
        let limits = range.flat_map(|(low, high)| [low, high]).filter(is_near);
        let angles = Span::around([own.low, own.high].into_iter().chain(limits), MARGIN);
        let input = plot(90.0, 260.0, levels);
        let Some(apart) = &preview.apart else {
            return Self { preview, input, output: Some(plot(330.0, BOTTOM, angles)), apart: None };
        };
        let over_noise = Span::around(apart.over_noise.iter().copied().chain([0.0]), MARGIN);
        let output = Some(plot(330.0, 730.0, angles));
        Self { preview, input, output, apart: Some(plot(800.0, BOTTOM, over_noise)) }
    }

    fn plots(&self) -> impl Iterator<Item = &Plot> {
        std::iter::once(&self.input).chain(&self.output).chain(&self.apart)
    }

    /// Frames, ticks and titles.
    fn sheet(&self) -> Sheet {
        let rig = &self.preview.joint.rig;
        let mut sheet = Sheet::default();
        let mut draw = |plot: &Plot, title: String| {
            sheet.outline(plot, &plot.x_span().ticks(12.0), &plot.y_ticks(4.0));
            sheet.title(plot, TITLE, title);
        };
        draw(&self.input, bracketed("input", rig.input_unit.as_deref()));
        if let Some(plot) = &self.output {
            let unit = bracketed("", rig.output_unit.as_deref());
            draw(plot, format!("expected output{unit}, with its margin"));
        }
        if let Some(plot) = &self.apart {
            let title = "difference over noise, each hold by itself; part of all of it";
            draw(plot, title.to_owned());
        }
        if let Some(lowest) = self.plots().last() {
            for x in lowest.x_span().ticks(12.0) {
                sheet.put(lowest.below(x, 2.0), format!("{} s", number(x)));
            }
        }
        sheet
    }

    /// The margin of each expected output: lines from its lower to its upper end, side by side.
    fn add_bands(&self, layers: &mut Layers<'_>) -> Result<(), RecordError> {
        /// Lines that fill the width of a plot.
        const LINES: usize = 720;
        /// Of the way from the ground to the colour of the line.
        const SHADE: f64 = 0.38;
        let Some(plot) = &self.output else { return Ok(()) };
        let mut lines = Vec::new();
        for Expectation { prediction, rgb, .. } in &self.preview.expected {
            let both: Vec<(f64, f64)> =
                prediction.output.iter().zip(&prediction.margin).map(|(y, m)| (*y, *m)).collect();
            let stride = both.len().div_ceil(LINES).max(1);
            for (place, some) in both.chunks(stride).enumerate() {
                let none = (f64::INFINITY, f64::NEG_INFINITY);
                let wider = |(low, high): (f64, f64), (y, m): &(f64, f64)| {
                    (low.min(y - m), high.max(y + m))
                };
                let (low, high) = some.iter().fold(none, wider);
                let x = self.preview.seconds(place * stride);
                let shade = color(between(GROUND, *rgb, SHADE));
                lines.push((vec![plot.at(x, low), plot.at(x, high)], shade));
            }
        }
        let count = (lines.len() / self.preview.expected.len().max(1)).max(1);
        let radius = 0.5 * (SIDES.1 - SIDES.0) / count as f32 + 0.2;
        layers.order(-10.0).colored("band", radius, [lines])
    }

    /// Input, range, expected outputs and their difference.
    fn add_lines(&self, layers: &mut Layers<'_>) -> Result<(), RecordError> {
        let schedule = &self.preview.joint.schedule;
        let holds = schedule.holds().iter().zip(self.preview.holds());
        let corner = |sample: usize, level: f64| self.input.at(self.preview.seconds(sample), level);
        let input = holds
            .flat_map(|(hold, (start, end))| [corner(start, hold.level), corner(end, hold.level)]);
        let input = vec![input.collect()];
        layers.strips("input", palette::INPUT, 1.4, [input])?;
        let curve = |plot: &Plot, values: &[f64]| {
            plot.curve(values, CURVE_POINTS, |k| self.preview.seconds(k))
        };
        if let Some(plot) = &self.output {
            let range = self.preview.joint.rig.range.into_iter();
            let Span { low, high } = plot.y_span();
            let limits = range.flat_map(|(low, high)| [low, high]);
            let limits = limits
                .filter(|limit| (low..high).contains(limit))
                .map(|limit| plot.level(limit).to_vec())
                .collect();
            layers.strips("range", palette::REJECTED, 1.0, [limits])?;
            let outputs = self.preview.expected.iter();
            let lines = outputs.map(|e| (curve(plot, &e.prediction.output), color(e.rgb)));
            layers.order(40.0).colored("expected", 1.5, [lines.collect()])?;
        }
        let (Some(plot), Some(apart)) = (&self.apart, &self.preview.apart) else { return Ok(()) };
        let line = vec![curve(plot, &apart.over_noise)];
        layers.strips("apart", palette::ERROR, 1.4, [line])
    }

    /// What the colours mean.
    fn legend(&self) -> Labels {
        /// Row of the legend on the sheet, and the distance of its entries.
        const ROW: f32 = 1055.0;
        const DISTANCE: f32 = 320.0;
        let mut entries: Vec<(String, Rgb)> = vec![("– input".to_owned(), palette::INPUT)];
        let expected = self.preview.expected.iter();
        entries.extend(expected.map(|e| match self.preview.joint.discrimination {
            Some(_) => (format!("– if it is {}", e.name), e.rgb),
            None => (format!("– {}", e.name), e.rgb),
        }));
        if let (Some(_), Some((low, high))) = (&self.output, self.preview.joint.rig.range) {
            let unit = self.preview.joint.rig.output_unit.as_deref();
            let text = format!("– range: {} to {}", measure(low, None), measure(high, unit));
            entries.push((text, palette::REJECTED));
        }
        let mut labels = Labels::default();
        let first = 0.5 * (SHEET.0 - DISTANCE * (entries.len() - 1) as f32);
        for (place, (text, rgb)) in entries.into_iter().enumerate() {
            labels.put_in(rgb, Vec2D::new(first + DISTANCE * place as f32, ROW), text);
        }
        labels
    }

    /// The part of all squared differences that lies in each hold, where there is much of it.
    fn add_shares(&self, layers: &mut Layers<'_>) -> Result<(), RecordError> {
        /// Holds that are named.
        const NAMED: usize = 6;
        /// Smaller parts are not named.
        const LEAST: f64 = 0.02;
        let (Some(plot), Some(apart)) = (&self.apart, &self.preview.apart) else { return Ok(()) };
        let mut holds: Vec<&HoldApart> = apart.holds.iter().filter(|h| h.share >= LEAST).collect();
        holds.sort_by(|a, b| b.share.total_cmp(&a.share));
        let mut labels = Labels::default();
        for HoldApart { start, hold, share, .. } in holds.into_iter().take(NAMED) {
            let middle = self.preview.seconds(start + hold.samples / 2);
            labels.put(plot.above(middle, 0.0), format!("{:.0} %", 100.0 * share));
        }
        layers.texts("shares", palette::ERROR, [labels])
    }

    /// The hold under the cursor: a frame through all plots, and its level.
    fn add_here(&self, layers: &mut Layers<'_>) -> Result<(), RecordError> {
        let holds = self.preview.holds();
        let frame = |(start, end): &(usize, usize)| {
            let [from, to] = [*start, *end].map(|sample| self.preview.seconds(sample));
            self.plots().map(|plot| plot.column(from, to)).collect()
        };
        layers.strips("here/frame", palette::HERE, 1.2, holds.iter().map(frame))?;
        let unit = self.preview.joint.rig.input_unit.as_deref();
        let unit = unit.map_or_else(String::new, |unit| format!(" {unit}"));
        let names = holds.iter().zip(self.preview.joint.schedule.holds()).zip(1..);
        let name =
            |(((start, end), hold), place): ((&(usize, usize), &crate::design::Hold), i32)| {
                let mut labels = Labels::default();
                let (level, seconds) = (number(hold.level), self.preview.seconds(end - start));
                let text = format!("hold {place}: {level}{unit} for {} s", number(seconds));
                labels.put_whole(self.input.above(self.preview.seconds(*start), 2.0 * TITLE), text);
                labels
            };
        layers.texts("here/name", palette::HERE, names.map(name))
    }
}
