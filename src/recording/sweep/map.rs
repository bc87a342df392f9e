//! All settings against all steps: a picture with a row per combination and a column per
//! step, and what its rows are.

use rerun::components::{DrawOrder, MagnificationFilter};
use rerun::{Image, Transform3D};

use super::swept::{Cell, Opinion, Swept};
use crate::delay::sweep::{Factor, Grid};
use crate::recording::canvas::Plot;
use crate::recording::palette::{self, Rgb};
use crate::report::sweep::level_text;

/// Rows and columns that a picture may have; of those that share one, the farthest is seen.
const MOST: usize = 2000;

/// Combinations that follow one another and have the same values of the slowest settings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Block {
    /// What they share.
    pub(super) label: String,
    /// The first of them.
    pub(super) first: usize,
    /// How many they are.
    pub(super) count: usize,
}

/// The combinations by method, and those of each method by low-pass where it has several.
pub(super) fn blocks(grid: &Grid) -> (Vec<Block>, Vec<Block>) {
    let rest: usize =
        [Factor::Alpha, Factor::Beta].into_iter().map(|factor| grid.levels(factor)).product();
    let passbands = grid.levels(Factor::Passband);
    let (mut methods, mut low_passes) = (Vec::new(), Vec::new());
    for (method, base) in grid.bases().iter().enumerate() {
        let first = method * passbands * rest;
        let label = level_text(grid, Factor::Method, method);
        methods.push(Block { label, first, count: passbands * rest });
        if base.keeps_low_pass || passbands == 1 {
            continue;
        }
        low_passes.extend((0..passbands).map(|passband| {
            let label = level_text(grid, Factor::Passband, passband);
            Block { label, first: first + passband * rest, count: rest }
        }));
    }
    (methods, low_passes)
}

/// The blocks that have a name beside them: methods, or their low-passes, of which the first
/// bears the method's name, too.
pub(super) fn named(grid: &Grid) -> Vec<Block> {
    let (methods, low_passes) = blocks(grid);
    let divided = |block: &Block| low_passes.iter().any(|one| one.first == block.first);
    let whole: Vec<Block> = methods.iter().filter(|one| !divided(one)).cloned().collect();
    let with_method = |block: &Block| {
        let method = methods.iter().find(|method| method.first == block.first);
        let label = method.map(|method| format!("{}, {}", method.label, block.label));
        Block { label: label.unwrap_or_else(|| block.label.clone()), ..block.clone() }
    };
    low_passes.iter().map(with_method).chain(whole).collect()
}

/// Rows of combinations that follow one another and are of `run`: the first and the last.
pub(super) fn rows_of(grid: &Grid, run: usize) -> Vec<(usize, usize)> {
    let mut rows: Vec<(usize, usize)> = Vec::new();
    let of_run = grid.combinations().iter().enumerate().filter(|(_, one)| one.run == run);
    for (row, _) in of_run {
        match rows.last_mut() {
            Some((_, last)) if *last + 1 == row => *last = row,
            _ => rows.push((row, row)),
        }
    }
    rows
}

/// The picture, and where it lies on the sheet.
pub(super) fn picture(swept: &Swept<'_>, plot: &Plot) -> Option<(Image, Transform3D)> {
    let combinations = swept.grid.combinations();
    let (rows, columns) = (combinations.len(), swept.steps.len());
    let (down, across) = (rows.div_ceil(MOST), columns.div_ceil(MOST));
    let (height, width) = (rows.div_ceil(down.max(1)), columns.div_ceil(across.max(1)));
    if height * width == 0 {
        return None;
    }
    let mut bytes = Vec::with_capacity(3 * width * height);
    for rows in combinations.chunks(down) {
        for steps in swept.steps.chunks(across) {
            let cells = steps
                .iter()
                .flat_map(|(step, _)| rows.iter().map(move |one| Swept::cell(step, one.run)));
            let farthest = cells.reduce(|a, b| if b.weight() > a.weight() { b } else { a });
            let (red, green, blue) =
                shade(farthest.unwrap_or(Cell { opinion: Opinion::Silent, by: 0.0 }));
            bytes.extend([red, green, blue]);
        }
    }
    let size = [u32::try_from(width).ok()?, u32::try_from(height).ok()?];
    let image = Image::from_rgb24(bytes, size).with_draw_order(DrawOrder::from(-10.0));
    let image = image.with_magnification_filter(MagnificationFilter::Nearest);
    let [left, top] = [plot.left, plot.top];
    let right = plot.x(plot.x_span.low + (width * across) as f64);
    let bottom = plot.y(plot.y_span.high - (height * down) as f64);
    let scale = [(right - left) / width as f32, (bottom - top) / height as f32, 1.0];
    Some((image, Transform3D::from_translation([left, top, 0.0]).with_scale(scale)))
}

/// The stronger, the farther a delay is from what most say.
fn shade(cell: Cell) -> Rgb {
    /// Samples that are half of the way to the strongest shade.
    const HALF: f64 = 4.0;
    let Cell { opinion, by } = cell;
    match opinion {
        Opinion::Silent => opinion.rgb(),
        Opinion::Same => palette::SAME_GROUND,
        Opinion::Longer | Opinion::Shorter => {
            palette::between(palette::SAME_GROUND, opinion.rgb(), 0.4 + 0.6 * by / (by + HALF))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::sweep::Base;
    use crate::delay::{Method, Settings};
    use crate::numerics::LowPass;

    /// `two-line` with two low-passes, and `hinge`, which keeps its own.
    fn grid() -> Grid {
        let base = |method| Base {
            settings: Settings::of(method),
            keeps_low_pass: method == Method::HINGE,
        };
        let slow = Some(LowPass { cutoff_hz: 2.0, order: 4 });
        let bases = [Method::TWO_LINE, Method::HINGE].map(base).to_vec();
        Grid::new(bases, vec![slow, None], vec![5, 10], vec![1, 2])
    }

    #[test]
    fn rows_stand_by_method_and_low_pass() {
        let (methods, low_passes) = blocks(&grid());
        let block = |label: &str, first, count| Block { label: label.to_owned(), first, count };
        assert_eq!(methods, [block("two-line", 0, 8), block("hinge", 8, 8)]);
        assert_eq!(low_passes, [block("2 Hz", 0, 4), block("no low-pass", 4, 4)]);
        let named: Vec<String> = named(&grid()).into_iter().map(|block| block.label).collect();
        assert_eq!(named, ["two-line, 2 Hz", "no low-pass", "hinge"]);
    }

    #[test]
    fn a_run_has_all_rows_that_it_stands_for() {
        let grid = grid();
        assert_eq!(rows_of(&grid, 3), [(3, 3)]);
        // Onsets depend neither on β nor on this low-pass.
        let hinge = grid.combinations()[8].run;
        assert_eq!(rows_of(&grid, hinge), [(8, 9), (12, 13)]);
    }
}
