//! Sets of settings in few words.

use super::{level_text, value};
use crate::delay::sweep::{Factor, Grid};

/// Settings that can be said in one breath, and how many combinations they are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Clause {
    pub(super) words: Vec<String>,
    pub(super) combinations: usize,
}

type Levels = [usize; 4];

/// The combinations of the runs that are `chosen`, as clauses: values that go with the
/// same values of all other settings are listed together, and what is free is not said.
pub(super) fn clauses(grid: &Grid, chosen: &[bool]) -> Vec<Clause> {
    let chosen = grid.combinations().iter().filter(|one| chosen.get(one.run) == Some(&true));
    let chosen: Vec<Levels> = chosen.map(|one| one.levels).collect();
    let mut found = if chosen.is_empty() { Vec::new() } else { split(grid, &chosen, 0) };
    found.sort_by_key(|clause| std::cmp::Reverse(clause.combinations));
    found
}

/// Clauses of combinations that agree in all factors before number `depth`, but for those
/// that go together.
fn split(grid: &Grid, chosen: &[Levels], depth: usize) -> Vec<Clause> {
    let Some(&factor) = Factor::ALL.get(depth) else {
        return vec![Clause { words: Vec::new(), combinations: chosen.len() }];
    };
    let mut groups: Vec<(Vec<usize>, Vec<Levels>)> = Vec::new();
    for level in 0..grid.levels(factor) {
        let with = chosen.iter().filter(|levels| levels.get(depth) == Some(&level));
        let mut rest: Vec<Levels> = with.copied().collect();
        if rest.is_empty() {
            continue;
        }
        // What comes after this factor is all that is compared.
        rest.iter_mut().filter_map(|levels| levels.get_mut(depth)).for_each(|slot| *slot = 0);
        match groups.iter_mut().find(|(_, known)| *known == rest) {
            Some((levels, _)) => levels.push(level),
            None => groups.push((vec![level], rest)),
        }
    }
    let of_group = |(levels, rest): (Vec<usize>, Vec<Levels>)| {
        let head = (levels.len() < grid.levels(factor)).then(|| listed(grid, factor, &levels));
        let times = levels.len();
        split(grid, &rest, depth + 1).into_iter().map(move |tail| Clause {
            words: head.iter().cloned().chain(tail.words).collect(),
            combinations: times * tail.combinations,
        })
    };
    groups.into_iter().flat_map(of_group).collect()
}

/// Several values of a setting: `β 1 to 5`, `5 Hz or no low-pass`.
fn listed(grid: &Grid, factor: Factor, levels: &[usize]) -> String {
    let (first, last) = (levels.first().copied(), levels.last().copied());
    let (Some(first), Some(last)) = (first, last) else { return String::new() };
    let is_number = matches!(factor, Factor::Alpha | Factor::Beta);
    let all_between = last - first + 1 == levels.len();
    if is_number && levels.len() > 2 && all_between {
        let (first, last) = (value(grid, factor, first), value(grid, factor, last));
        return format!("{factor} {first} to {last}");
    }
    let mut texts: Vec<String> = if is_number {
        levels.iter().map(|level| value(grid, factor, *level)).collect()
    } else {
        levels.iter().map(|level| level_text(grid, factor, *level)).collect()
    };
    let final_one = texts.pop().unwrap_or_default();
    let text =
        if texts.is_empty() { final_one } else { format!("{} or {final_one}", texts.join(", ")) };
    if is_number { format!("{factor} {text}") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::sweep::Base;
    use crate::delay::{Method, Settings};
    use crate::numerics::LowPass;

    fn grid() -> Grid {
        let bases = [Method::TWO_LINE, Method::HINGE]
            .map(|method| Base { settings: Settings::of(method), keeps_low_pass: false });
        let slow = |cutoff_hz| Some(LowPass { cutoff_hz, order: 4 });
        Grid::new(bases.to_vec(), vec![slow(2.0), slow(5.0), None], vec![10], vec![1, 2, 5, 10])
    }

    fn said(chosen: impl Fn(&Settings) -> bool) -> Vec<String> {
        let grid = grid();
        let chosen: Vec<bool> = grid.runs().iter().map(chosen).collect();
        clauses(&grid, &chosen).into_iter().map(|clause| clause.words.join(", ")).collect()
    }

    #[test]
    fn what_goes_together_is_said_once_and_what_is_free_is_not() {
        assert_eq!(said(|_| true), [""]);
        assert!(said(|_| false).is_empty());
        let coarse = said(|run| run.method == Method::HINGE || run.beta < 10);
        assert_eq!(coarse, ["hinge", "two-line, β 1 to 5"]);
        let slow = said(|run| run.low_pass.is_none_or(|low_pass| low_pass.cutoff_hz > 3.0));
        assert_eq!(slow, ["5 Hz or no low-pass"]);
    }
}
