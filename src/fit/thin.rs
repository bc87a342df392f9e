//! A part of a record from which it is seen which models are worth a fit.

use super::window::Window;

/// Samples that are kept of a record at least.
const FEWEST: usize = 4000;

/// One sample of so many is kept of a long record.
const ONE_OF: usize = 10;

/// Samples of a block: several windows, so that one level is seen to follow another.
const BLOCK: usize = 500;

/// Some of `windows`, in blocks that are spread evenly over all of them; all of them where
/// they are few, or too long to be chosen from.
pub(super) fn thinned(windows: &[Window]) -> Vec<Window> {
    let all: usize = windows.iter().map(samples).sum();
    let kept = FEWEST.max(all / ONE_OF);
    if 2 * all <= 3 * kept {
        return windows.to_vec();
    }
    let chosen = spread(windows, kept);
    let enough = 2 * chosen.iter().map(samples).sum::<usize>() >= kept;
    if enough { chosen } else { windows.to_vec() }
}

/// Blocks of `windows` that are spread evenly over them, with about so many samples of all.
pub(super) fn spread(windows: &[Window], kept: usize) -> Vec<Window> {
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

    fn windows(trials: usize, each: usize) -> Vec<Window> {
        let window = |trial, k| {
            let (start, end) = (100 * k, 100 * (k + 1));
            Window { trial, start, end, part: Part::Training, restarts: true }
        };
        (0..trials).flat_map(|trial| (0..each).map(move |k| window(trial, k))).collect()
    }

    #[test]
    fn a_short_record_is_kept() {
        assert_eq!(thinned(&windows(3, 14)), windows(3, 14));
    }

    #[test]
    fn a_long_one_is_thinned_evenly() {
        let kept = thinned(&windows(1, 120));
        assert_eq!(kept.len(), 40);
        let starts: Vec<_> = kept.iter().step_by(5).map(|window| window.start).collect();
        assert_eq!(starts, [1000, 2500, 4000, 5500, 7000, 8500, 10_000, 11_500]);
        assert_eq!(thinned(&windows(1, 2000)).len(), 200);
    }

    #[test]
    fn a_window_of_a_free_run_is_kept_whole() {
        let part = Part::Training;
        let run = [Window { trial: 0, start: 0, end: 100_000, part, restarts: true }];
        assert_eq!(thinned(&run), run);
    }

    #[test]
    fn every_trial_of_many_counts() {
        let kept = thinned(&windows(40, 4));
        let trials: Vec<_> = kept.iter().step_by(4).map(|window| window.trial).collect();
        assert_eq!(trials, [3, 7, 11, 15, 19, 23, 27, 31, 35, 39]);
    }
}
