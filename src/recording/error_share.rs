//! Where the error is: its share in each part of each feature, beside the share of time.

use rerun::datatypes::Vec2D;
use rerun::{EntityPath, LineStrips2D};

use super::canvas::{Plot, SHEET, Span};
use super::chunk::Chunks;
use super::entity::below;
use super::error::RecordError;
use super::palette::{self, color};
use super::sheet::{Sheet, strips};
use crate::diagnosis::failure::{Feature, Region, Units};
use crate::experiment::Joint;
use crate::report::{ComparedJoint, number};

/// Height of the sheet: two rows of plots.
pub(super) const HEIGHT: f32 = 480.0;

/// Plots in a row.
const COLUMNS: usize = 4;

/// Part of a slot that its bars fill.
const FILLED: f64 = 0.7;

/// Room that one character of a label takes at the usual size of the view.
const CHARACTER: f64 = 11.0;

/// Draws the regions of `models` below `root`: a plot per feature, a slot per part, a bar
/// per model. What the parts are is told of the first model.
pub(super) fn add(
    chunks: &mut Chunks,
    root: &EntityPath,
    models: &[&ComparedJoint<'_>],
) -> Result<(), RecordError> {
    let Some(first) = models.first() else { return Ok(()) };
    let mut sheet = Sheet::default();
    let mut bars = vec![Bars::default(); models.len()];
    let mut marks = Vec::new();
    for (place, of_first) in by_feature(first).into_iter().enumerate() {
        let Some(feature) = of_first.first().map(|region| region.feature) else { continue };
        let of_each: Vec<Vec<&Region>> = models.iter().map(|m| of_feature(m, feature)).collect();
        let plot = plot(place, &of_each);
        draw_frame(&mut sheet, &plot, &title(feature, first.joint), &of_first);
        for ((bars, regions), number) in bars.iter_mut().zip(&of_each).zip(0..) {
            bars.add(&plot, regions, (number, models.len()));
        }
        marks.extend(of_first.iter().zip(0..).map(|(region, slot)| mark(&plot, region, slot)));
    }
    sheet.push(chunks, root)?;
    for ((bars, rgb), number) in bars.into_iter().zip(palette::models()).zip(0..) {
        let strips = LineStrips2D::new(bars.strips).with_radii(bars.radii);
        let strips = strips.with_colors(
            bars.too_much
                .into_iter()
                .map(|too_much| color(if too_much { rgb } else { palette::dimmed(rgb) })),
        );
        chunks.push_static(below(root, &["bars", &format!("{number}")]), &strips)?;
    }
    strips(chunks, below(root, &["time"]), palette::BORDER, 1.6, marks)
}

/// The regions of a model, feature by feature.
fn by_feature<'a>(model: &ComparedJoint<'a>) -> Vec<Vec<&'a Region>> {
    let regions: Vec<&Region> = model.comparison.regions.iter().collect();
    regions.chunk_by(|a, b| a.feature == b.feature).map(<[&Region]>::to_vec).collect()
}

fn of_feature<'a>(model: &ComparedJoint<'a>, feature: Feature) -> Vec<&'a Region> {
    model.comparison.regions.iter().filter(|region| region.feature == feature).collect()
}

/// One of eight places on the sheet, with a slot for each part.
fn plot(place: usize, of_each: &[Vec<&Region>]) -> Plot {
    let rows = if place < COLUMNS { 36.0..=190.0 } else { 282.0..=436.0 };
    let width = SHEET.0 / COLUMNS as f32;
    let left = (place % COLUMNS) as f32 * width;
    let slots = of_each.iter().map(Vec::len).max().unwrap_or(1);
    let shares = of_each.iter().flatten();
    let most = shares.flat_map(|r| [r.share_of_squared_error, r.share_of_time]).fold(0.0, f64::max);
    let y = Span::new(0.0, 108.0 * most);
    Plot::within((left + 80.0, left + width - 12.0), rows, Span::new(0.0, slots as f64), y)
}

/// Frame, percentages, and what the parts are.
fn draw_frame(sheet: &mut Sheet, plot: &Plot, title: &str, regions: &[&Region]) {
    let ticks = plot.y_span().ticks(3.0).into_iter();
    let ticks: Vec<_> = ticks.map(|share| (share, format!("{} %", number(share)))).collect();
    sheet.frame(plot, &[], &ticks, title);
    let names = names(regions);
    let longest = names.iter().map(|(_, name)| name.chars().count()).max().unwrap_or(0);
    let slot = f64::from(plot.x(1.0) - plot.x(0.0));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
    let every = ((longest + 1) as f64 * CHARACTER / slot).ceil().max(1.0) as usize;
    for (x, name) in names.into_iter().step_by(every) {
        sheet.put(plot.below(x, 2.0), name);
    }
}

/// The name of each slot, or of each border between two, and where it stands.
fn names(regions: &[&Region]) -> Vec<(f64, String)> {
    #[expect(clippy::float_cmp, reason = "a level is both of its bounds")]
    let are_levels = regions.iter().all(|region| region.from == region.to);
    if are_levels {
        let named = |(region, slot): (&&Region, u32)| (f64::from(slot) + 0.5, name(region));
        return regions.iter().zip(0..).map(named).collect();
    }
    let first = regions.first().map(|region| (0.0, short(region.from)));
    let ends = regions.iter().zip(1..).map(|(r, slot): (_, u32)| (f64::from(slot), short(r.to)));
    first.into_iter().chain(ends).collect()
}

/// What a part is that has no extent.
fn name(region: &Region) -> String {
    /// Characters of a trial's label that have room.
    const LONGEST: usize = 10;
    match region.feature {
        Feature::Direction => region.label.clone(),
        Feature::Trial if region.label.chars().count() > LONGEST => {
            region.label.chars().take(LONGEST - 1).chain(['…']).collect()
        }
        Feature::Trial => region.label.clone(),
        _ => short(region.from),
    }
}

/// A number in three digits.
fn short(value: f64) -> String {
    format!("{value:.2e}").parse().map_or_else(|_| number(value), number)
}

fn title(feature: Feature, joint: &Joint) -> String {
    let units = Units { input: joint.input_unit.clone(), output: joint.output_unit.clone() };
    let unit = feature.unit(&units).map_or(String::new(), |unit| format!(" [{unit}]"));
    let name = match feature {
        Feature::Direction => "direction of the input",
        Feature::Input => "input, as it acts",
        Feature::Hold => "how long the input is held",
        Feature::Time => "time in the record",
        _ => feature.name(),
    };
    format!("{name}{unit}")
}

/// The bars of one model.
#[derive(Clone, Debug, Default)]
struct Bars {
    strips: Vec<[Vec2D; 2]>,
    radii: Vec<f32>,
    /// A larger share of the error than of the time.
    too_much: Vec<bool>,
}

impl Bars {
    /// A bar for each of `regions`, of the model `number` among so many.
    fn add(&mut self, plot: &Plot, regions: &[&Region], (number, models): (u32, usize)) {
        let width = FILLED / models as f64;
        let radius = (plot.x(width) - plot.x(0.0)) / 2.0;
        for (region, slot) in regions.iter().zip(0_u32..) {
            let x = f64::from(slot) + (1.0 - FILLED) / 2.0 + width * (f64::from(number) + 0.5);
            let share = 100.0 * region.share_of_squared_error;
            self.strips.push([plot.at(x, 0.0), plot.at(x, share)]);
            self.radii.push(radius);
            self.too_much.push(region.share_of_squared_error > region.share_of_time);
        }
    }
}

/// A line across a slot at its share of the time.
fn mark(plot: &Plot, region: &Region, slot: u32) -> Vec<Vec2D> {
    let share = 100.0 * region.share_of_time;
    [0.04, 0.96].map(|x| plot.at(f64::from(slot) + x, share)).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn region(feature: Feature, label: &str, from: f64, to: f64) -> Region {
        let label = label.to_owned();
        let (share_of_time, share_of_squared_error, rmse, mean_residual) = (0.5, 0.5, 1.0, 0.0);
        Region {
            feature,
            label,
            from,
            to,
            share_of_time,
            share_of_squared_error,
            rmse,
            mean_residual,
        }
    }

    #[test]
    fn levels_are_named_in_their_middle_and_ranges_at_their_ends() {
        let levels = [-1.5, 2.0].map(|level| region(Feature::Input, "", level, level));
        let named = names(&levels.iter().collect::<Vec<_>>());
        assert_eq!(named, [(0.5, "-1.5".to_owned()), (1.5, "2".to_owned())]);
        let ranges = [(0.0, 0.123_456), (0.123_456, 7.0)];
        let ranges = ranges.map(|(from, to)| region(Feature::Hold, "", from, to));
        let named = names(&ranges.iter().collect::<Vec<_>>());
        let expected = [(0.0, "0"), (1.0, "0.123"), (2.0, "7")];
        assert_eq!(named, expected.map(|(x, name)| (x, name.to_owned())));
    }

    #[test]
    fn a_long_label_is_cut_where_it_can_be_seen() {
        assert_eq!(name(&region(Feature::Trial, "monday/morning", 0.0, 0.0)), "monday/mo…");
        assert_eq!(name(&region(Feature::Direction, "positive", 1.0, 1.0)), "positive");
    }
}
