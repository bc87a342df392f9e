//! The figures of all joints, as Markdown.

use std::fmt::Write as _;

use super::case::{Judged, Played};
use super::plants::KINDS;

/// The table, and what it says in sentences.
pub(crate) fn page(judged: &[Judged]) -> String {
    let mut page = String::from(
        "| joints | designed | kept the range | left it | farthest | trials | length | steps | range used | \
         time | integrator leaves it |\n|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for kind in KINDS {
        let own: Vec<&Judged> = judged.iter().filter(|judged| judged.kind == kind).collect();
        if own.is_empty() {
            continue;
        }
        page += &row(kind, &own);
    }
    page += &row("all", &judged.iter().collect::<Vec<_>>());
    page
}

/// Figures of some joints.
fn row(name: &str, judged: &[&Judged]) -> String {
    let played = judged.iter().filter_map(|judged| judged.outcome.as_ref().ok());
    let played: Vec<&Played> = played.collect();
    let kept = played.iter().filter(|played| played.is_kept()).count();
    let farthest = played.iter().map(|played| played.beyond).fold(0.0, f64::max);
    let leaves = judged.iter().filter(|judged| judged.integrator_leaves == Some(true)).count();
    let mut row = String::new();
    let _ = writeln!(
        row,
        "| {name} | {} of {} | {kept} | {} | {:.1} % | {:.0} | {:.0} s | {:.0} | {:.0} % | {:.1} s | {leaves} |",
        played.len(),
        judged.len(),
        played.len() - kept,
        100.0 * farthest,
        median(played.iter().map(|played| played.trials as f64)),
        median(played.iter().map(|played| played.duration_s)),
        median(played.iter().map(|played| played.steps as f64)),
        100.0 * median(played.iter().map(|played| played.used)),
        median(judged.iter().map(|judged| judged.design_s)),
    );
    row
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
