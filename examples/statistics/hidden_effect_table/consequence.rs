//! How the threshold of consequence is chosen: what effects that are there carry of the error, and
//! what those carry that are not.

use std::fmt::Write as _;

use super::Judged;
use super::cases::{Case, Counts, Group, SOFT_EDGE};
use super::page::{share, stands_for};

/// Shares of the error that could be the threshold; below 1 % no share is given.
const THRESHOLDS: [f64; 7] = [0.0, 0.01, 0.02, 0.03, 0.05, 0.1, 0.2];

/// The share that an effect carries, and whether it is hidden.
struct Carried {
    share: f64,
    is_hidden: bool,
}

/// A section of `docs/accuracy.md`.
pub(crate) fn page(counts: Counts, judged: &[Judged]) -> String {
    let mut text = head(counts, judged.len());
    for (soft, title) in [(false, "Sharp valves"), (true, "Soft valves")] {
        let carried = carried(judged, |case| case.soft == soft);
        if carried.is_empty() {
            continue;
        }
        let _ = writeln!(text, "\n### {title}\n");
        text +=
            "| threshold | hidden effects kept | not there, of all kept |\n| --- | --- | --- |\n";
        for threshold in THRESHOLDS {
            let kept: Vec<&Carried> = carried.iter().filter(|one| one.share >= threshold).collect();
            let hidden = |one: &&&Carried| one.is_hidden;
            let right = kept.iter().filter(hidden).count();
            let all = carried.iter().filter(|one| one.is_hidden).count();
            let _ = writeln!(
                text,
                "| {} % | {} | {} |",
                100.0 * threshold,
                share(right, all),
                share(kept.len() - right, kept.len())
            );
        }
    }
    text
}

fn head(counts: Counts, records: usize) -> String {
    let Counts { two, three, first_seed, .. } = counts;
    format!(
        "## When an effect has a practical consequence

Made by

```sh
cargo run --release --no-default-features --example statistics -- hidden-effect-table --consequence \\
    --two {two} --three {three} --first-seed {first_seed}
```

`improve` removes effects whose share of the error is below a threshold, 3 %. The tables show what
other thresholds would do, from `improve --refine` on {records} simulated records with two or three hidden
effects ([hidden_effect_table.md](hidden_effect_table.md)), half of them with a soft valve, its corners
rounded over {SOFT_EDGE} of the largest level.

The share of an effect is the growth of the error when it is left out of the final model and the rest is
fitted again. A threshold keeps the effects with at least this share. *Hidden effects kept*: kept effects
that are in the plant, or have an alternative that is, of all such effects. *Not there*: the other kept
effects, of all kept ones.
"
    )
}

fn carried(judged: &[Judged], is_wanted: impl Fn(&Case) -> bool) -> Vec<Carried> {
    let mut all = Vec::new();
    for Judged { case, outcome } in judged {
        let is_of_several = matches!(case.group, Group::Two | Group::Three);
        let Ok(outcome) = outcome else { continue };
        if !(is_of_several && is_wanted(case)) {
            continue;
        }
        all.extend(outcome.found.iter().map(|found| Carried {
            share: found.error_share,
            is_hidden: case.hidden.iter().any(|hidden| stands_for(found, hidden)),
        }));
    }
    all
}
