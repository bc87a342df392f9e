//! How the residual is correlated with itself and with the input, lag by lag.

use rerun::datatypes::Vec2D;
use rerun::{EntityPath, LineStrips2D};

use super::canvas::{Plot, Span};
use super::chunk::Chunks;
use super::error::RecordError;
use super::palette::{self, color};
use super::paths::{at, correlation, of_model};
use super::sheet::{Sheet, strips};
use crate::diagnosis::Comparison;
use crate::report::ComparedJoint;

/// Width and height of the sheet.
pub(super) const SIZE: (f32, f32) = (1900.0, 480.0);

/// Titles of the plots.
const TITLES: [&str; 3] = [
    "residual with itself: lag [s]",
    "changes with the acting input's: lag [s]",
    "changes with the measured input's: lag [s]",
];

/// Correlations at equal steps of the lag.
struct Correlogram<'a> {
    first_lag_s: f64,
    lag_step_s: f64,
    correlation: &'a [f64],
    band: f64,
}

impl Correlogram<'_> {
    fn last_lag_s(&self) -> f64 {
        self.first_lag_s + self.lag_step_s * self.correlation.len().saturating_sub(1) as f64
    }

    fn curve(&self, plot: &Plot) -> Vec<Vec2D> {
        let lags =
            (0..self.correlation.len()).map(|k| self.first_lag_s + k as f64 * self.lag_step_s);
        lags.zip(self.correlation).map(|(lag, r)| plot.at(lag, *r)).collect()
    }

    /// The two lines between which chance keeps the correlations.
    fn band(&self, plot: &Plot) -> [Vec<Vec2D>; 2] {
        [self.band, -self.band].map(|y| plot.level(y).to_vec())
    }
}

/// Draws the correlations of `models` below `root`: a curve and a band per model.
pub(super) fn add(
    chunks: &mut Chunks,
    root: &EntityPath,
    models: &[&ComparedJoint<'_>],
) -> Result<(), RecordError> {
    let of_each: Vec<_> = models.iter().map(|model| correlograms(model.comparison)).collect();
    let mut sheet = Sheet::default();
    let mut axes = Vec::new();
    let mut curves: Vec<Vec<Vec<Vec2D>>> = vec![Vec::new(); models.len()];
    let mut bands = curves.clone();
    for (place, title) in TITLES.iter().enumerate() {
        let here: Vec<_> =
            of_each.iter().map(|all| all.get(place).and_then(Option::as_ref)).collect();
        if here.iter().all(Option::is_none) {
            continue;
        }
        let plot = plot(place, here.iter().copied().flatten());
        sheet.draw(&plot, 4.0, title);
        axes.push(plot.level(0.0).to_vec());
        axes.push(plot.vertical(0.0).to_vec());
        for ((curves, bands), found) in curves.iter_mut().zip(&mut bands).zip(here) {
            curves.extend(found.map(|found| found.curve(&plot)));
            bands.extend(found.into_iter().flat_map(|found| found.band(&plot)));
        }
    }
    sheet.push(chunks, root)?;
    strips(chunks, at(root, correlation::AXES), palette::RAW, 0.8, axes)?;
    let models = curves.into_iter().zip(bands).zip(palette::models()).zip(0_usize..);
    for (((curves, bands), rgb), number) in models {
        let order = 100.0 + number as f32;
        strips(
            chunks,
            of_model(root, correlation::BAND, number),
            palette::dimmed(rgb),
            1.6,
            bands,
        )?;
        // The later a model, the smaller its correlations should be.
        let curves = LineStrips2D::new(curves).with_colors([color(rgb)]).with_radii([1.3]);
        chunks.push_static(
            of_model(root, correlation::CURVE, number),
            &curves.with_draw_order(order),
        )?;
    }
    Ok(())
}

/// One of three places on the sheet, with room for all of `correlograms`.
fn plot<'a>(place: usize, correlograms: impl Iterator<Item = &'a Correlogram<'a>> + Clone) -> Plot {
    let left = 110.0 + 635.0 * place as f32;
    let lags = correlograms.clone().flat_map(|c| [0.0, c.first_lag_s, c.last_lag_s()]);
    let values = correlograms
        .flat_map(|c| c.correlation.iter().copied().chain([0.0, 2.0 * c.band, -2.0 * c.band]));
    let (x, y) = (Span::around(lags, 0.0), Span::around(values, 0.1));
    Plot::within((left, left + 510.0), 36.0..=430.0, x, y)
}

/// In the order of [`TITLES`].
fn correlograms(comparison: &Comparison) -> [Option<Correlogram<'_>>; 3] {
    let itself = comparison.whiteness.as_ref().map(|whiteness| Correlogram {
        first_lag_s: whiteness.lag_step_s,
        lag_step_s: whiteness.lag_step_s,
        correlation: &whiteness.correlation,
        band: whiteness.band,
    });
    let of_input = comparison.input_correlation.as_ref().map(|all| {
        [&all.acting, &all.raw].map(|one| Correlogram {
            first_lag_s: all.first_lag_s,
            lag_step_s: all.lag_step_s,
            correlation: &one.correlation,
            band: one.band,
        })
    });
    let [acting, raw] = of_input.map_or([None, None], |both| both.map(Some));
    [itself, acting, raw]
}
