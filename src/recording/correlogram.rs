//! How the residual is correlated with itself and with the input, lag by lag.

use rerun::datatypes::Vec2D;

use super::canvas::Plot;
use super::chunk::Chunks;
use super::error::RecordError;
use super::layers::Layers;
use super::palette;
use super::paths::{self, of_model};
use super::sheet::Sheet;
use crate::figure::correlogram::{Correlogram, TITLES};
use crate::report::ComparedJoint;

/// Width and height of the sheet.
pub(super) const SIZE: (f32, f32) = (1900.0, 480.0);

/// Top and bottom of the plots.
const TOP: f32 = 36.0;
const BOTTOM: f32 = 430.0;

/// Why there is no correlation.
const NOT_KNOWN: &str = "not computed,\nsince sample periods differ\nor samples are too few";

/// Draws the correlations of `models` below `root`: a curve and a band per model.
pub(super) fn add(chunks: &mut Chunks, models: &[&ComparedJoint<'_>]) -> Result<(), RecordError> {
    let of_each: Vec<_> = models.iter().map(|model| Correlogram::all(model.comparison)).collect();
    let mut sheet = Sheet::of_width(SIZE.0);
    let mut axes = Vec::new();
    let mut curves: Vec<Vec<Vec<Vec2D>>> = vec![Vec::new(); models.len()];
    let mut bands = curves.clone();
    for (place, title) in TITLES.iter().enumerate() {
        let here: Vec<_> = of_each.iter().map(|all| all[place]).collect();
        let known: Vec<_> = here.iter().copied().flatten().collect();
        if known.is_empty() {
            let (left, right) = columns(place);
            let middle = Vec2D::new(f32::midpoint(left, right), f32::midpoint(TOP, BOTTOM));
            sheet.put(middle, format!("{title}: {NOT_KNOWN}"));
            continue;
        }
        let plot = plot(place, &known);
        sheet.draw(&plot, 4.0, title);
        axes.push(plot.level(0.0).to_vec());
        axes.push(plot.vertical(0.0).to_vec());
        for ((curves, bands), found) in curves.iter_mut().zip(&mut bands).zip(here) {
            curves.extend(found.map(|found| plot.places(found.curve())));
            bands.extend(found.into_iter().flat_map(|found| band(&plot, found.band)));
        }
    }
    let mut layers = Layers::fixed(chunks, paths::CORRELATION);
    layers.sheets([sheet])?;
    layers.strips("axes", palette::RAW, 0.8, [axes])?;
    let models = curves.into_iter().zip(bands).zip(palette::models()).zip(0_usize..);
    for (((curves, bands), rgb), number) in models {
        layers.strips(&of_model("band", number), palette::dimmed(rgb), 1.6, [bands])?;
        // The later a model, the smaller its correlations should be.
        layers.order(100.0 + number as f32);
        layers.strips(&of_model("curve", number), rgb, 1.3, [curves])?;
    }
    Ok(())
}

/// One of three places on the sheet, with room for all of `correlograms`.
fn plot(place: usize, correlograms: &[Correlogram<'_>]) -> Plot {
    let (x, y) = Correlogram::spans(correlograms);
    Plot::within(columns(place), TOP..=BOTTOM, x, y)
}

/// The left and the right of a place.
fn columns(place: usize) -> (f32, f32) {
    let left = 110.0 + 635.0 * place as f32;
    (left, left + 510.0)
}

/// The two lines between which correlations of noise stay.
fn band(plot: &Plot, band: f64) -> [Vec<Vec2D>; 2] {
    [band, -band].map(|y| plot.level(y).to_vec())
}
