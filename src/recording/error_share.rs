//! Where the error arises: its share in each part of each feature, beside the share of time.

use rerun::Color;
use rerun::datatypes::Vec2D;

use super::canvas::{Plot, Span};
use super::chunk::Chunks;
use super::error::RecordError;
use super::layers::Layers;
use super::palette::{self, Rgb, color};
use super::paths::{self, of_model};
use super::sheet::{Sheet, TITLE};
use crate::diagnosis::failure::{Feature, Region};
use crate::figure::error_share::{FeatureShares, Share, is_level};
use crate::numerics::as_written;
use crate::report::ComparedJoint;
use crate::wording::{feature_with_unit, number};

/// Width and height of the sheet: two rows of plots.
pub(super) const SIZE: (f32, f32) = (1900.0, 480.0);

/// Plots in a row.
const COLUMNS: usize = 4;

/// Part of a slot that its bars fill.
const FILLED: f64 = 0.7;

/// Room that a label takes where the view is a third of a screen of 1280 x 720: its margins, and a
/// character.
const LABEL: (f64, f64) = (45.0, 20.0);

/// Half the width of the lines that fill a bar: their ends are round.
pub(super) const HATCH: f32 = 1.5;

/// What a drawing of regions is made of.
pub(super) struct Drawing {
    pub(super) sheet: Sheet,
    bars: Vec<Bars>,
    /// The share of the time of each part.
    pub(super) marks: Vec<Vec<Vec2D>>,
}

impl Drawing {
    /// A plot per feature, a slot per part, a bar per model. The parts are those of
    /// the first model; a model that has another number of them, as its speeds may, has no
    /// bars there.
    pub(super) fn of(models: &[&ComparedJoint<'_>]) -> Self {
        let mut sheet = Sheet::of_width(SIZE.0);
        let mut bars = vec![Bars::default(); models.len()];
        let mut marks = Vec::new();
        let features = models.iter().take(1).flat_map(|first| {
            FeatureShares::all(&first.comparison.regions).map(|shares| (first.joint, shares))
        });
        for (place, (joint, shares)) in features.enumerate() {
            let (Some(feature), of_first) = (shares.feature(), shares.regions) else { continue };
            let alike = models.iter().map(|model| alike(model, feature, of_first.len()));
            let of_each: Vec<&[Region]> = alike.collect();
            let plot = plot(place, &of_each);
            draw_frame(&mut sheet, &plot, &feature_with_unit(feature, joint), of_first);
            for ((bars, regions), number) in bars.iter_mut().zip(&of_each).zip(0..) {
                bars.add(&plot, regions, (number, models.len()));
            }
            marks.extend(of_first.iter().zip(0..).map(|(region, slot)| mark(&plot, region, slot)));
        }
        Self { sheet, bars, marks }
    }

    /// The lines that fill the bars, in the colour of the model that they are of.
    pub(super) fn filling(&self, rgb: Rgb) -> Vec<(Vec<Vec2D>, Color)> {
        self.bars.iter().flat_map(|bars| bars.filling(rgb)).collect()
    }
}

/// Draws the regions of `models` below `root`.
pub(super) fn add(chunks: &mut Chunks, models: &[&ComparedJoint<'_>]) -> Result<(), RecordError> {
    if models.is_empty() {
        return Ok(());
    }
    let Drawing { sheet, bars, marks } = Drawing::of(models);
    let mut layers = Layers::fixed(chunks, paths::ERROR_SHARE);
    layers.sheets([sheet])?;
    for ((bars, rgb), number) in bars.iter().zip(palette::models()).zip(0..) {
        layers.colored(&of_model("bars", number), HATCH, [bars.filling(rgb)])?;
    }
    layers.order(100.0).strips("time", palette::BORDER, 1.6, [marks])
}

/// The regions of one feature, where there are `parts` of them.
fn alike<'a>(model: &ComparedJoint<'a>, feature: Feature, parts: usize) -> &'a [Region] {
    let mut all = FeatureShares::all(&model.comparison.regions);
    let found = all.find(|shares| shares.feature() == Some(feature));
    found.map(|shares| shares.regions).filter(|regions| regions.len() == parts).unwrap_or(&[])
}

/// One of eight places on the sheet, with a slot for each part.
fn plot(place: usize, of_each: &[&[Region]]) -> Plot {
    let rows = if place < COLUMNS { 36.0..=190.0 } else { 282.0..=436.0 };
    let width = SIZE.0 / COLUMNS as f32;
    let left = (place % COLUMNS) as f32 * width;
    let slots = of_each.iter().map(|regions| regions.len()).max().unwrap_or(1);
    let highest = of_each.iter().map(|regions| FeatureShares { regions }.largest());
    // Room for the title above the highest bar.
    let y = Span::new(0.0, 1.25 * highest.fold(0.0, f64::max));
    Plot::within((left + 95.0, left + width - 20.0), rows, Span::new(0.0, slots as f64), y)
}

/// Frame, percentages, and what the parts are.
fn draw_frame(sheet: &mut Sheet, plot: &Plot, title: &str, regions: &[Region]) {
    // Zero would be where the names of the parts begin.
    let ticks = plot.y_span().ticks(3.0).into_iter().filter(|share| *share > 0.0);
    let ticks: Vec<_> = ticks.map(|share| (share, format!("{} %", number(share)))).collect();
    sheet.outline(plot, &[], &ticks);
    sheet.title(plot, TITLE, title);
    let names = names(regions);
    let longest = names.iter().map(|(_, name)| name.chars().count()).max().unwrap_or(0);
    let slot = f64::from(plot.x(1.0) - plot.x(0.0));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
    let every = ((LABEL.0 + LABEL.1 * longest as f64) / slot).ceil().max(1.0) as usize;
    for (x, name) in names.into_iter().step_by(every) {
        sheet.put(plot.below(x, 2.0), name);
    }
}

/// The name of each slot, or of each border between two, and where it is put.
fn names(regions: &[Region]) -> Vec<(f64, String)> {
    if regions.iter().all(is_level) {
        let named = |(region, slot): (&Region, u32)| (f64::from(slot) + 0.5, name(region));
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
        Feature::Trial if region.label.chars().count() > LONGEST => {
            region.label.chars().take(LONGEST - 1).chain(['…']).collect()
        }
        Feature::Direction | Feature::Trial => region.label.clone(),
        _ => short(region.from),
    }
}

/// A number in three digits.
pub(super) fn short(value: f64) -> String {
    number(as_written(value, 3))
}

/// The lines that fill the bars of one model, and whether each is of a bar with a larger share of the
/// error than of the time.
#[derive(Clone, Debug, Default)]
struct Bars(Vec<([Vec2D; 2], bool)>);

impl Bars {
    /// The lines with their colours: bright where there is too much error.
    fn filling(&self, rgb: Rgb) -> Vec<(Vec<Vec2D>, Color)> {
        let shade = |too_much| color(if too_much { rgb } else { palette::dimmed(rgb) });
        self.0.iter().map(|(line, too_much)| (line.to_vec(), shade(*too_much))).collect()
    }

    /// A bar for each of `regions`, of the model `number` among so many.
    fn add(&mut self, plot: &Plot, regions: &[Region], (number, models): (u32, usize)) {
        let width = FILLED / models as f64;
        for (region, slot) in regions.iter().zip(0_u32..) {
            let left = f64::from(slot) + (1.0 - FILLED) / 2.0 + width * f64::from(number);
            let share = Share::of(region);
            let [low, high] = [0.0, share.error].map(|y| plot.y(y));
            let high = (high + HATCH).min(low - HATCH);
            let places = hatched(plot.x(left), plot.x(left + width));
            let lines = places.map(|x| [Vec2D::new(x, low - HATCH), Vec2D::new(x, high)]);
            self.0.extend(lines.map(|line| (line, share.error > share.time)));
        }
    }
}

/// Places between two others that lines of radius [`HATCH`] cover without a gap.
pub(super) fn hatched(left: f32, right: f32) -> impl Iterator<Item = f32> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
    let count = ((right - left) / (1.2 * HATCH)).ceil().max(1.0) as usize;
    let step = (right - left - 2.0 * HATCH).max(0.0) / count as f32;
    (0..=count).map(move |k| left + HATCH + step * k as f32)
}

/// A line across a slot at its share of the time.
fn mark(plot: &Plot, region: &Region, slot: u32) -> Vec<Vec2D> {
    [0.04, 0.96].map(|x| plot.at(f64::from(slot) + x, Share::of(region).time)).to_vec()
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
            share_that_arises: share_of_squared_error,
            rmse,
            mean_residual,
        }
    }

    #[test]
    fn levels_are_named_in_their_middle_and_ranges_at_their_ends() {
        let levels = [-1.5, 2.0].map(|level| region(Feature::Input, "", level, level));
        let named = names(&levels);
        assert_eq!(named, [(0.5, "-1.5".to_owned()), (1.5, "2".to_owned())]);
        let ranges = [(0.0, 0.123_456), (0.123_456, 7.0)];
        let ranges = ranges.map(|(from, to)| region(Feature::Hold, "", from, to));
        let named = names(&ranges);
        let expected = [(0.0, "0"), (1.0, "0.123"), (2.0, "7")];
        assert_eq!(named, expected.map(|(x, name)| (x, name.to_owned())));
    }

    #[test]
    fn a_bar_is_filled_and_no_wider_than_its_place() {
        let places: Vec<_> = hatched(10.0, 40.0).collect();
        assert!((places[0] - 11.5).abs() < 1e-4 && (places[places.len() - 1] - 38.5).abs() < 1e-4);
        assert!(places.windows(2).all(|pair| pair[1] - pair[0] < 2.0 * HATCH));
    }

    #[test]
    fn a_long_label_is_cut_where_it_can_be_seen() {
        assert_eq!(name(&region(Feature::Trial, "monday/morning", 0.0, 0.0)), "monday/mo…");
        assert_eq!(name(&region(Feature::Direction, "positive", 1.0, 1.0)), "positive");
    }
}
