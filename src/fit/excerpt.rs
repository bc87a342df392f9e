//! The part of a very long record on which a test is made.

use super::window::Window;

/// Samples on which a test with dozens of columns finds what has any consequence; of more it would
/// take memory only.
const ENOUGH: usize = 100_000;

/// Samples of a piece: longer than what a missing effect takes to show.
const PIECE: usize = 20_000;

/// Windows of a record, or pieces of them that are spread evenly over it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Excerpt {
    windows: Vec<Window>,
    /// Whether they are pieces, each with an offset of its own.
    is_part: bool,
}

impl Excerpt {
    pub(super) fn of(windows: Vec<Window>) -> Self {
        let samples: usize = windows.iter().map(|window| window.end - window.start).sum();
        if samples <= ENOUGH {
            return Self { windows, is_part: false };
        }
        let pieces: Vec<Window> = windows.into_iter().flat_map(pieces).collect();
        Self { windows: spread(&pieces, ENOUGH), is_part: true }
    }

    pub(crate) fn windows(&self) -> &[Window] {
        &self.windows
    }

    /// `values`, one per trial and sample, of each window; of pieces less their mean.
    pub(crate) fn cut(&self, values: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let cut = |window: &Window| {
            let values = values.get(window.trial)?.get(window.start..window.end)?;
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            let offset = if self.is_part { mean } else { 0.0 };
            Some(values.iter().map(|value| value - offset).collect())
        };
        self.windows.iter().filter_map(cut).collect()
    }
}

/// `window` in pieces of about the same length.
fn pieces(window: Window) -> impl Iterator<Item = Window> {
    let samples = window.end - window.start;
    let parts = samples.div_ceil(PIECE).max(1);
    let border = move |part: usize| window.start + samples * part / parts;
    (0..parts).map(move |part| Window { start: border(part), end: border(part + 1), ..window })
}

/// Samples of a block: several windows, so that one level is seen to follow another.
const BLOCK: usize = 500;

/// Blocks of `windows` that are spread evenly over them, with about so many samples of all.
fn spread(windows: &[Window], kept: usize) -> Vec<Window> {
    let all: usize = windows.iter().map(samples).sum();
    let blocks = blocks(windows);
    let is_kept = |index: &usize| (index + 1) * kept / all > index * kept / all;
    let chosen = blocks.iter().enumerate().filter(|(index, _)| is_kept(index));
    chosen.flat_map(|(_, block)| block.iter().copied()).collect()
}

fn samples(window: &Window) -> usize {
    window.end - window.start
}

/// Windows that follow one another in the same trial, each block about as long.
fn blocks(windows: &[Window]) -> Vec<&[Window]> {
    let mut blocks = Vec::new();
    let (mut first, mut length) = (0, 0);
    for (index, window) in windows.iter().enumerate() {
        length += samples(window);
        let follows = windows.get(index + 1).is_some_and(|next| next.trial == window.trial);
        if length >= BLOCK || !follows {
            blocks.extend(windows.get(first..=index));
            (first, length) = (index + 1, 0);
        }
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::super::Part;
    use super::*;

    fn window(trial: usize, start: usize, end: usize) -> Window {
        Window { trial, start, end, part: Part::Training, restarts: true }
    }

    #[test]
    fn a_record_of_usual_length_is_tested_as_it_is() {
        let windows = vec![window(0, 0, 60_000), window(1, 0, 20_000)];
        let excerpt = Excerpt::of(windows.clone());
        assert_eq!(excerpt.windows(), windows);
        let values = [vec![3.0; 60_000], vec![4.0; 30_000]];
        assert_eq!(excerpt.cut(&values), [vec![3.0; 60_000], vec![4.0; 20_000]]);
    }

    #[test]
    fn of_a_long_one_pieces_are_spread_over_all_of_it() {
        let short = (0..10_000).map(|k| window(0, 200 * k, 200 * (k + 1))).collect();
        for windows in [short, vec![window(0, 0, 2_000_000)]] {
            let excerpt = Excerpt::of(windows);
            let samples: usize = excerpt.windows().iter().map(|w| w.end - w.start).sum();
            assert!((80_000..=120_000).contains(&samples), "{samples}");
            let places = excerpt.windows().iter().map(|window| window.start / 400_000);
            assert_eq!(places.collect::<std::collections::BTreeSet<_>>().len(), 5);
            let line = vec![(0..2_000_000).map(f64::from).collect::<Vec<_>>()];
            let cut = excerpt.cut(&line);
            assert!(cut.iter().all(|piece| (piece[0] + piece[piece.len() - 1]).abs() < 1e-6));
        }
    }
}
