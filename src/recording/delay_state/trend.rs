//! The course of scattered points on a sheet.

use rerun::datatypes::Vec2D;

use crate::figure::course::Bin;
use crate::recording::canvas::Plot;

/// Distance of the strokes that fill a band, on the sheet.
pub(super) const STROKE: f32 = 2.5;

/// The line through the medians.
pub(super) fn line(plot: &Plot, bins: &[Bin]) -> Vec<Vec2D> {
    bins.iter().map(|bin| plot.at(bin.x, bin.median)).collect()
}

/// The band between the quartiles, as one strip up and down: a sheet has no filled shape.
pub(super) fn band(plot: &Plot, bins: &[Bin]) -> Vec<Vec2D> {
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
