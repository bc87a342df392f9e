//! The course of scattered points: medians of bins, with their quartiles.

use crate::numerics::{median, quantile};

/// Bins at most; with few points fewer.
const BINS: usize = 8;

/// Points of a bin at least: quartiles of less say nothing.
const BIN_POINTS: usize = 5;

/// Bins nearer than this part of the whole range are one.
const NEAR: f64 = 0.02;

/// Where there are no points for more than this part of the range, the course is
/// interrupted.
const FAR: f64 = 0.3;

/// Where points lie: the middle of them, and half of them between two bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bin {
    pub(crate) x: f64,
    pub(crate) lower: f64,
    pub(crate) median: f64,
    pub(crate) upper: f64,
}

impl Bin {
    /// The bin of some points; none when there are none.
    pub(crate) fn of(points: &[(f64, f64)]) -> Option<Self> {
        let (x, y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        let (lower, upper) = (quantile(&y, 0.25)?, quantile(&y, 0.75)?);
        Some(Self { x: median(&x)?, lower, median: median(&y)?, upper })
    }

    /// This bin twice: level from `left` to `right`.
    pub(crate) fn level(self, left: f64, right: f64) -> Vec<Self> {
        vec![Self { x: left, ..self }, Self { x: right, ..self }]
    }
}

/// The course of `points`, in pieces: bins of about as many points each, interrupted where
/// there are no points for long. Points of nearly equal x stay together, as those of one
/// level of a noisy signal. A piece of one bin is level.
pub(crate) fn course(mut points: Vec<(f64, f64)>) -> Vec<Vec<Bin>> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Vec::new() };
    let range = last.0 - first.0;
    let mut groups: Vec<Vec<(f64, f64)>> = Vec::new();
    for group in grouped(&points) {
        match groups.last_mut() {
            Some(before) if distance(before, group) <= NEAR * range => before.extend(group),
            _ => groups.push(group.to_vec()),
        }
    }
    let apart = |before: &Vec<(f64, f64)>, next: &Vec<(f64, f64)>| {
        let ends = before.last().zip(next.first());
        ends.is_some_and(|(end, start)| start.0 - end.0 > FAR * range)
    };
    let pieces = groups.chunk_by(|before, next| !apart(before, next));
    pieces.map(|piece| bins(piece, 2.0 * NEAR * range)).collect()
}

/// The bins of a piece, which is at least `width` wide.
fn bins(groups: &[Vec<(f64, f64)>], width: f64) -> Vec<Bin> {
    let bins: Vec<_> = groups.iter().filter_map(|group| Bin::of(group)).collect();
    match (bins.as_slice(), groups) {
        ([only], [group]) => {
            let (first, last) = (group.first(), group.last());
            let left = first.map_or(only.x, |point| point.0.min(only.x - width / 2.0));
            let right = last.map_or(only.x, |point| point.0.max(only.x + width / 2.0));
            only.level(left, right)
        }
        _ => bins,
    }
}

/// From the middle of one group to that of the next.
fn distance(from: &[(f64, f64)], to: &[(f64, f64)]) -> f64 {
    let [from, to] = [from, to].map(|group| Bin::of(group).map_or(0.0, |bin| bin.x));
    to - from
}

/// Points in order of x, cut at the widest gap that makes groups of about the wanted size.
fn grouped(mut points: &[(f64, f64)]) -> Vec<&[(f64, f64)]> {
    let size = (points.len() / BINS).max(BIN_POINTS);
    let mut groups = Vec::with_capacity(BINS + 1);
    while points.len() >= size + size / 2 {
        let last_cut = (size + size / 2).min(points.len() - size / 2);
        let gap = |cut: usize| points[cut].0 - points[cut - 1].0;
        let wider = |a: &usize, b: &usize| {
            gap(*a).total_cmp(&gap(*b)).then(b.abs_diff(size).cmp(&a.abs_diff(size)))
        };
        let cut = (size / 2..=last_cut).max_by(wider).unwrap_or(size);
        let (group, rest) = points.split_at(cut);
        groups.push(group);
        points = rest;
    }
    groups.push(points);
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_course_of_a_line_lies_on_it() {
        let points = (0..80).map(|k| (f64::from(k), 3.0 * f64::from(k)));
        let pieces = course(points.rev().collect());
        assert_eq!(pieces.len(), 1);
        assert!(pieces[0].len().abs_diff(BINS) <= 2, "{}", pieces[0].len());
        for bin in &pieces[0] {
            assert!((bin.median - 3.0 * bin.x).abs() < 1e-12);
            assert!(bin.lower < bin.median && bin.median < bin.upper);
        }
    }

    #[test]
    fn the_levels_of_a_noisy_signal_are_bins() {
        let of_level = |level: i32| (0..17 + level).map(move |k| (level, f64::from(k % 5)));
        let points = (0..6).flat_map(of_level);
        let pieces = course(points.map(|(x, k)| (f64::from(x) + 0.01 * k, f64::from(x))).collect());
        let medians: Vec<_> = pieces.iter().flatten().map(|bin| bin.median).collect();
        assert_eq!(medians, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    }

    #[test]
    fn nothing_is_drawn_where_no_points_are() {
        let points = [1.0, 2.0].into_iter().flat_map(|x| (0..20).map(move |_| (x, 10.0 * x)));
        let pieces = course(points.collect());
        assert_eq!(pieces.len(), 2);
        for (piece, x) in pieces.iter().zip([1.0, 2.0]) {
            let ends: Vec<_> = piece.iter().map(|bin| (bin.x, bin.median)).collect();
            assert_eq!(ends, [(x - 0.02, 10.0 * x), (x + 0.02, 10.0 * x)]);
        }
    }

    #[test]
    fn every_point_is_in_a_group_and_none_is_small() {
        for count in 1..200 {
            let points: Vec<_> = (0..count).map(|k| (f64::from(k * k % 17), 0.0)).collect();
            let groups = grouped(&points);
            assert_eq!(groups.iter().map(|group| group.len()).sum::<usize>(), points.len());
            assert!(groups.iter().all(|group| group.len() >= points.len().min(2)));
        }
    }

    #[test]
    fn few_points_make_a_level_piece() {
        let pieces = course(vec![(1.0, 4.0), (2.0, 6.0), (5.0, 8.0)]);
        let ends: Vec<_> = pieces.iter().flatten().map(|bin| (bin.x, bin.median)).collect();
        assert_eq!(ends, [(1.0, 6.0), (5.0, 6.0)]);
        assert_eq!(course(Vec::new()), Vec::<Vec<Bin>>::new());
    }
}
