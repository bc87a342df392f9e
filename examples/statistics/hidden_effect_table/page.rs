//! The page: what was hidden against what was found, in Markdown.

use std::fmt::Write as _;

use tauscope::diagnosis::failure::Feature;
use tauscope::explain::Verdict;
use tauscope::numerics::{median, quantile};
use tauscope::synthetic::effects::{CATALOGUE, OUTSIDE};

use super::Judged;
use super::cases::{Case, Counts, Group, NOISE, SOFT_EDGE};
use super::outcome::{Found, Named, Outcome, in_words};

/// A validation error so many times the noise is down to it.
const DOWN_TO_NOISE: f64 = 1.15;

/// Part of the integrator's error that is to be taken away from the cylinder.
const MOST_OF_IT: f64 = 0.9;

/// Half the width of a 95 % interval, in standard errors.
const QUANTILE_95: f64 = 1.96;

type Pair<'j> = (&'j Case, &'j Outcome);

/// The whole page.
pub(crate) fn page(counts: Counts, judged: &[Judged]) -> String {
    let known: Vec<Pair<'_>> = judged
        .iter()
        .filter_map(|judged| Some((&judged.case, judged.outcome.as_ref().ok()?)))
        .collect();
    let mut text = head(counts, known.len());
    text += &one_hidden(&known);
    text += &confusion(&known);
    text += &nothing_hidden(&known);
    text += &several_hidden(&known);
    text += &outside(&known);
    text += &cylinder(&known);
    text += &coverage(&known);
    text += &went_wrong(judged);
    text
}

fn head(counts: Counts, records: usize) -> String {
    let Counts { one, soft, nothing, two, three, outside, finer, cylinder, first_seed } = counts;
    format!(
        "# How often a hidden effect is found

Made by

```sh
cargo run --release --no-default-features --example statistics -- hidden-effect-table --one {one} \\
    --soft {soft} --nothing {nothing} --two {two} --three {three} --outside {outside} --finer {finer} \\
    --cylinder {cylinder} --first-seed {first_seed} > docs/hidden_effect_table.md
```

{records} simulated records of two minutes at 100 Hz, each from a seed of its own, with white or coloured
noise of {NOISE} deg unless stated. The plant shares no equation with the models
([simulating.md](simulating.md)). A *clear* effect makes the error of the nearest integrator about
12 times the noise, a *weak* one about 3 times. `explain` and `improve` start with a plain
integrator and may use the whole catalogue; both restart at every step of the input.

| column | meaning |
| --- | --- |
| named first | the hidden effect is the first of the ranking, with the verdict `missing_effect`; counted as half where it is only among the effects indistinguishable from the first |
| exactly | after `improve` the model has the hidden effects and no other |
| or an alternative | each hidden effect is in the model, or among the alternatives given for one of its effects; and each effect of the model is hidden, or has a hidden alternative |
| not there | effects of the model that are neither hidden nor have a hidden alternative |
| soft valve | the corners of the valve are rounded over {SOFT_EDGE} of the largest level instead of 0.004 |
| error | validation error after `improve`, divided by the noise: median, 95 % quantile, and how often it is at most 1.15 |
"
    )
}

/// `12 of 14 (85.7 %)`; `-` of none.
pub(crate) fn share(count: usize, of: usize) -> String {
    share_of(count as f64, of)
}

fn share_of(count: f64, of: usize) -> String {
    if of == 0 {
        return "-".to_owned();
    }
    format!("{count} of {of} ({:.1} %)", 100.0 * count / of as f64)
}

/// `| a | b |`
fn row(cells: &[String]) -> String {
    format!("| {} |\n", cells.join(" | "))
}

fn header(cells: &[&str]) -> String {
    let rule: Vec<&str> = cells.iter().map(|_| "---").collect();
    format!("\n| {} |\n| {} |\n", cells.join(" | "), rule.join(" | "))
}

/// Median, 95th percentile and share down to the noise of the final errors.
fn errors<'j>(pairs: impl Iterator<Item = &'j Pair<'j>>) -> [String; 3] {
    let errors: Vec<f64> = pairs.map(|(_, outcome)| outcome.errors[1]).collect();
    let low = errors.iter().filter(|error| **error <= DOWN_TO_NOISE).count();
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.3}"));
    [number(median(&errors)), number(quantile(&errors, 0.95)), share(low, errors.len())]
}

/// 1 where the effect is named first, 1/2 where it is among the equals of the first.
fn credit(case: &Case, named: &Named) -> f64 {
    let [hidden] = case.hidden[..] else { return 0.0 };
    match named.verdict {
        Verdict::MissingEffect if named.first == hidden => 1.0,
        Verdict::MissingEffect if named.equals.contains(&hidden) => 0.5,
        _ => 0.0,
    }
}

/// Whether the last revision has what is hidden, and nothing else.
fn is_exact(case: &Case, outcome: &Outcome) -> bool {
    has_all(case, outcome) && outcome.found.len() == case.hidden.len()
}

fn has_all(case: &Case, outcome: &Outcome) -> bool {
    case.hidden.iter().all(|hidden| outcome.found.iter().any(|found| found.id == *hidden))
}

/// Whether `found` is the effect `hidden`, or one that may as well be it.
pub(crate) fn stands_for(found: &Found, hidden: &str) -> bool {
    let names = |other: &String| other.split(" + ").any(|id| id == hidden);
    found.id == hidden || found.alternatives.iter().any(names)
}

/// Effects of the last revision that stand for nothing that is hidden.
fn not_there(case: &Case, outcome: &Outcome) -> usize {
    let is_there = |found: &&Found| case.hidden.iter().any(|hidden| stands_for(found, hidden));
    outcome.found.len() - outcome.found.iter().filter(is_there).count()
}

/// Whether the last revision has what is hidden or says that it may be that, and nothing else.
fn is_right(case: &Case, outcome: &Outcome) -> bool {
    let is_found = |hidden: &&str| outcome.found.iter().any(|found| stands_for(found, hidden));
    case.hidden.iter().all(is_found) && not_there(case, outcome) == 0
}

/// Strength and noise, those of `pairs` that have them; and each strength with any noise.
fn cells<'j>(pairs: &'j [Pair<'j>]) -> Vec<([String; 2], Vec<Pair<'j>>)> {
    let mut cells: Vec<([String; 2], Vec<Pair<'j>>)> = Vec::new();
    for pair in pairs {
        let (strength, noise) = (pair.0.strength().to_owned(), pair.0.surroundings());
        for key in [[strength.clone(), noise], [strength, "all".to_owned()]] {
            match cells.iter_mut().find(|(known, _)| *known == key) {
                Some((_, members)) => members.push(*pair),
                None => cells.push((key, vec![*pair])),
            }
        }
    }
    cells.sort_by(|a, b| (&a.0[0], a.0[1] == "all").cmp(&(&b.0[0], b.0[1] == "all")));
    cells
}

fn of_group<'j>(pairs: &[Pair<'j>], group: Group) -> Vec<Pair<'j>> {
    pairs.iter().filter(|(case, _)| case.group == group).copied().collect()
}

fn one_hidden(all: &[Pair<'_>]) -> String {
    let mut pairs = of_group(all, Group::One);
    pairs.extend(of_group(all, Group::Soft));
    if pairs.is_empty() {
        return String::new();
    }
    let mut text = "\n## One effect hidden\n".to_owned();
    text += &header(&[
        "strength",
        "noise",
        "named first",
        "exactly",
        "error, median",
        "95 %",
        "error ≤ 1.15",
    ]);
    for ([strength, noise], members) in cells(&pairs) {
        let credits = members.iter().filter_map(|(case, o)| Some(credit(case, o.named.as_ref()?)));
        let exact = members.iter().filter(|(case, outcome)| is_exact(case, outcome)).count();
        let (credits, exact) =
            (share_of(credits.sum(), members.len()), share(exact, members.len()));
        let mut line = vec![strength, noise, credits, exact];
        line.extend(errors(members.iter()));
        text += &row(&line);
    }
    text
}

/// What explain names, in the columns of the matrix; the verdict where it names nothing.
fn answer(named: &Named) -> &str {
    match named.verdict {
        Verdict::MissingEffect => &named.first,
        other => in_words(other),
    }
}

/// What is hidden down, what is named first across.
fn confusion(pairs: &[Pair<'_>]) -> String {
    let asked: Vec<(&str, &str)> = pairs
        .iter()
        .filter_map(|(case, outcome)| {
            let hidden = case.hidden.first().copied().unwrap_or("nothing");
            Some((hidden, answer(outcome.named.as_ref()?)))
        })
        .collect();
    if asked.is_empty() {
        return String::new();
    }
    let verdicts = [Verdict::Adequate, Verdict::Unexplained].map(in_words);
    let columns: Vec<&str> = CATALOGUE.into_iter().chain(verdicts).collect();
    let rows = CATALOGUE.into_iter().chain(["nothing"]).chain(OUTSIDE);
    let mut text = "\n## Hidden (down) and named first (across)\n\n```text\n".to_owned();
    let numbers = (1..=columns.len() + 1).map(|number| format!("{number:4}"));
    let _ = writeln!(text, "{:24}{}", "", numbers.collect::<Vec<_>>().concat());
    for (number, hidden) in (1..).zip(rows) {
        let named = || asked.iter().filter(|pair| pair.0 == hidden).map(|pair| pair.1);
        let count = |column: &&str| named().filter(|name| name == column).count();
        let others = named().filter(|name| !columns.contains(name)).count();
        let counts = columns.iter().map(count).chain([others]).map(|count| match count {
            0 => format!("{:>4}", "."),
            count => format!("{count:4}"),
        });
        let number =
            if number <= CATALOGUE.len() { format!("{number:2}") } else { "  ".to_owned() };
        let _ = writeln!(text, "{number} {hidden:21}{}", counts.collect::<Vec<_>>().concat());
    }
    let [adequate, unexplained, other] = [1, 2, 3].map(|place| CATALOGUE.len() + place);
    let _ = writeln!(
        text,
        "\n{adequate}: `adequate`; {unexplained}: `unexplained`; {other}: an effect without a \
         column, which the list at the end names\n```"
    );
    text
}

fn nothing_hidden(pairs: &[Pair<'_>]) -> String {
    let own = of_group(pairs, Group::Nothing);
    let mut text = "\n## Nothing hidden\n".to_owned();
    text += &header(&["noise", "adequate"]);
    let adequate =
        |outcome: &Outcome| outcome.found.is_empty() && outcome.verdict == Verdict::Adequate;
    let mut noises: Vec<String> = own.iter().map(|(case, _)| case.noise()).collect();
    noises.dedup();
    for noise in noises {
        let members: Vec<_> = own.iter().filter(|(case, _)| case.noise() == noise).collect();
        let right = members.iter().filter(|(_, outcome)| adequate(outcome)).count();
        text += &row(&[noise, share(right, members.len())]);
    }
    let right = own.iter().filter(|(_, outcome)| adequate(outcome)).count();
    text += &row(&["all".to_owned(), share(right, own.len())]);
    let others: Vec<bool> =
        pairs.iter().filter_map(|(_, outcome)| outcome.other_adequate).collect();
    let right = others.iter().filter(|adequate| **adequate).count();
    text += &row(&["the joint beside it, in every record".to_owned(), share(right, others.len())]);
    text
}

fn several_hidden(pairs: &[Pair<'_>]) -> String {
    let mut text = String::new();
    let groups = [
        (Group::Finer, "The finer form of an effect"),
        (Group::Two, "Two effects"),
        (Group::Three, "Three effects"),
    ];
    for (group, title) in groups {
        let pairs = of_group(pairs, group);
        if pairs.is_empty() {
            continue;
        }
        let _ = writeln!(text, "\n## {title} hidden");
        text += &header(&[
            "strength",
            "noise",
            "exactly",
            "or an alternative",
            "not there",
            "error, median",
            "95 %",
            "error ≤ 1.15",
        ]);
        for ([strength, noise], members) in cells(&pairs) {
            let exact = members.iter().filter(|(case, outcome)| is_exact(case, outcome)).count();
            let right = members.iter().filter(|(case, outcome)| is_right(case, outcome)).count();
            let wrong = members.iter().map(|(case, outcome)| not_there(case, outcome)).sum();
            let named = members.iter().map(|(_, outcome)| outcome.found.len()).sum();
            let of = members.len();
            let mut line = vec![strength, noise, share(exact, of), share(right, of)];
            line.push(share(wrong, named));
            line.extend(errors(members.iter()));
            text += &row(&line);
        }
    }
    text
}

/// What a condition must be about to point at an effect outside the catalogue.
fn place(hidden: &str) -> &'static [Feature] {
    match hidden {
        "input_notch" => &[Feature::Input, Feature::AbsInput],
        "creep_memory" => &[Feature::SinceStep, Feature::Hold],
        "sticky_spot" | "sensor_nonlinearity" => &[Feature::Output],
        "disturbance" => &[Feature::Time],
        _ => &[],
    }
}

fn points_at(case: &Case, outcome: &Outcome) -> bool {
    let place = case.hidden.first().map_or(&[][..], |hidden| place(hidden));
    let about = |features: &[Feature]| features.iter().any(|feature| place.contains(feature));
    outcome.fails.iter().any(|fails| about(&fails.features))
}

fn outside(pairs: &[Pair<'_>]) -> String {
    let pairs = of_group(pairs, Group::Outside);
    if pairs.is_empty() {
        return String::new();
    }
    let mut text = "\n## Outside the catalogue\n".to_owned();
    text += "\n*Points at it*: the condition that is named for the error of the integrator is on a quantity on which the hidden effect depends.\n";
    text += &header(&[
        "hidden",
        "strength",
        "explain: unexplained",
        "improve: adequate",
        "points at it",
    ]);
    for hidden in OUTSIDE {
        for strength in ["clear", "weak"] {
            let here =
                |(case, _): &&Pair<'_>| case.hidden == [hidden] && case.strength() == strength;
            let members: Vec<_> = pairs.iter().filter(here).collect();
            let of = members.len();
            let count = |is: &dyn Fn(&Pair<'_>) -> bool| {
                share(members.iter().filter(|pair| is(pair)).count(), of)
            };
            text += &row(&[
                hidden.to_owned(),
                strength.to_owned(),
                count(&|(_, outcome)| says(outcome, Verdict::Unexplained)),
                count(&|(_, outcome)| outcome.verdict == Verdict::Adequate),
                count(&|(case, outcome)| points_at(case, outcome)),
            ]);
        }
    }
    text
}

/// Whether explain comes to this verdict.
fn says(outcome: &Outcome, verdict: Verdict) -> bool {
    outcome.named.as_ref().is_some_and(|named| named.verdict == verdict)
}

/// What of an error in times the noise is not noise.
fn beyond_noise(error: f64) -> f64 {
    (error * error - 1.0).max(0.0).sqrt()
}

fn cylinder(pairs: &[Pair<'_>]) -> String {
    let pairs = of_group(pairs, Group::Cylinder);
    if pairs.is_empty() {
        return String::new();
    }
    let mut text = "\n## The cylinder\n".to_owned();
    text += "\nErrors are divided by the noise. *Removed*: the part of the integrator's error that \
             `improve` removes; *possible*: the largest part that any model could remove, since the \
             noise remains. *Beyond noise*: the removed part of √(error² − noise²).\n";
    let columns = [
        "noise, deg",
        "seed",
        "integrator",
        "after improve",
        "removed",
        "possible",
        "beyond noise",
        "effects",
    ];
    text += &header(&columns);
    for (case, outcome) in pairs {
        let [before, after] = outcome.errors;
        text += &row(&[
            case.deviation.to_string(),
            case.seed.to_string(),
            format!("{before:.2}"),
            format!("{after:.2}"),
            format!("{:.1} %", 100.0 * (1.0 - after / before)),
            format!("{:.1} %", 100.0 * (1.0 - 1.0 / before)),
            format!("{:.1} %", 100.0 * (1.0 - beyond_noise(after) / beyond_noise(before))),
            outcome.found.iter().map(|found| found.id).collect::<Vec<_>>().join(", "),
        ]);
    }
    text
}

/// Of parameters that both plant and model have, where exactly the hidden was found.
fn coverage(pairs: &[Pair<'_>]) -> String {
    let exact = pairs.iter().filter(|(case, outcome)| is_exact(case, outcome));
    let estimates: Vec<_> = exact.flat_map(|(_, outcome)| &outcome.estimates).collect();
    let mut names: Vec<&str> = estimates.iter().map(|estimate| estimate.name.as_str()).collect();
    names.sort_by_key(|name| (name.contains('.'), *name));
    names.dedup();
    let mut text = "\n## Parameters\n\nRecords in which exactly the hidden effects were found, \
                    and parameters that the plant has\nunder the same name, though with other \
                    equations. SE: standard error.\n"
        .to_owned();
    text += &header(&["parameter", "in the 95 % interval", "median error / SE", "no SE"]);
    for name in names {
        let of_name = estimates.iter().filter(|estimate| estimate.name == name);
        let all = of_name.clone().count();
        let scores: Vec<f64> = of_name.filter_map(|estimate| estimate.score).collect();
        let inside = scores.iter().filter(|score| score.abs() <= QUANTILE_95).count();
        let middle = median(&scores).map_or("-".to_owned(), |middle| format!("{middle:+.1}"));
        let without = (all - scores.len()).to_string();
        text += &row(&[name.to_owned(), share(inside, scores.len()), middle, without]);
    }
    text
}

/// Why a record went wrong; nothing where it did not.
fn fault(case: &Case, outcome: &Outcome) -> Option<String> {
    let [before, after] = outcome.errors;
    let named = outcome.named.as_ref();
    let mut faults = Vec::new();
    if matches!(case.group, Group::One | Group::Soft)
        && named.is_some_and(|named| credit(case, named) < 1.0)
    {
        faults.push(format!("explain: {}", named.map_or("", answer)));
    }
    match case.group {
        Group::Cylinder if after > (1.0 - MOST_OF_IT) * before => {
            faults.push("too little removed".to_owned());
        }
        Group::Cylinder => (),
        Group::Outside => {
            if outcome.verdict == Verdict::Adequate {
                faults.push("adequate".to_owned());
            }
            if !says(outcome, Verdict::Unexplained) {
                faults.push(format!("explain: {}", named.map_or("", answer)));
            }
            if !points_at(case, outcome) {
                let conditions = outcome.fails.iter().map(|fails| fails.condition.as_str());
                faults.push(format!("points at [{}]", conditions.collect::<Vec<_>>().join("; ")));
            }
        }
        _ if !is_right(case, outcome) => faults.push("other effects".to_owned()),
        _ if !is_exact(case, outcome) => faults.push("an alternative".to_owned()),
        _ if case.group != Group::Nothing && after > DOWN_TO_NOISE => {
            faults.push("above the noise".to_owned());
        }
        _ if outcome.verdict != Verdict::Adequate => {
            faults.push(in_words(outcome.verdict).to_owned());
        }
        _ => (),
    }
    (!faults.is_empty()).then(|| faults.join(", "))
}

fn went_wrong(judged: &[Judged]) -> String {
    let wrong = judged.iter().filter_map(|Judged { case, outcome }| match outcome {
        Ok(outcome) => {
            Some(format!("- {}: **{}**; {}\n", case.title(), fault(case, outcome)?, outcome.chain))
        }
        Err(error) => Some(format!("- {}: **not made**: {error:#}\n", case.title())),
    });
    let wrong: Vec<String> = wrong.collect();
    let count = share(wrong.len(), judged.len());
    format!(
        "\n## Records that went wrong\n\n{count}; each with its revisions and their validation \
         errors divided by the noise.\n`tauscope simulate --effect NAME --strength STRENGTH --seed \
         SEED` makes a record with one hidden\neffect again, with `--noise-correlation 0.9` for AR(1).\n\n{}",
        wrong.concat()
    )
}

#[cfg(test)]
mod tests {
    use anyhow::anyhow;
    use tauscope::synthetic::scenario::Strength;

    use super::*;

    fn case(group: Group, hidden: &[&'static str]) -> Case {
        let (hidden, strength) = (hidden.to_vec(), Strength::Weak);
        let (deviation, correlation) = (NOISE, 0.0);
        let (spikes, soft) = (false, false);
        Case { group, hidden, strength, deviation, correlation, spikes, soft, seed: 7 }
    }

    fn named(first: &str, equals: &[&'static str]) -> Named {
        let (first, equals) = (first.to_owned(), equals.to_vec());
        Named { verdict: Verdict::MissingEffect, first, equals }
    }

    fn outcome(named: Named, found: &[&'static str], error: f64) -> Outcome {
        let none = Found { id: "", alternatives: Vec::new(), error_share: 1.0 };
        Outcome {
            named: Some(named),
            found: found.iter().map(|id| Found { id, ..none.clone() }).collect(),
            verdict: Verdict::Adequate,
            errors: [3.0, error],
            estimates: Vec::new(),
            fails: Vec::new(),
            chain: "the chain".to_owned(),
            other_adequate: None,
        }
    }

    #[test]
    fn an_equal_of_the_first_counts_half_and_a_verdict_without_a_name_nothing() {
        let case = case(Group::One, &["backlash"]);
        let credit = |named: &Named| credit(&case, named).to_string();
        assert_eq!(credit(&named("backlash", &[])), "1");
        assert_eq!(credit(&named("stiction", &["backlash"])), "0.5");
        assert_eq!(credit(&named("stiction", &["dead_band"])), "0");
        let verdict = Verdict::Unexplained;
        assert_eq!(credit(&Named { verdict, ..named("backlash", &[]) }), "0");
    }

    #[test]
    fn what_went_wrong_is_told() {
        let case = case(Group::One, &["backlash"]);
        let told = |named, found: &[&'static str], error| {
            fault(&case, &outcome(named, found, error)).unwrap_or_default()
        };
        assert_eq!(told(named("backlash", &[]), &["backlash"], 1.0), "");
        assert_eq!(told(named("stiction", &[]), &["backlash"], 1.0), "explain: stiction");
        assert_eq!(told(named("backlash", &[]), &["backlash", "stiction"], 1.0), "other effects");
        assert_eq!(told(named("backlash", &[]), &["backlash"], 1.2), "above the noise");
    }

    #[test]
    fn a_record_that_is_wrong_and_one_that_was_not_made_are_listed() {
        let case = case(Group::One, &["backlash"]);
        let wrong = Ok(outcome(named("stiction", &[]), &["stiction"], 2.5));
        let not_made = Err(anyhow!("out of reach"));
        let judged = [wrong, not_made].map(|outcome| Judged { case: case.clone(), outcome });
        let counts = Counts {
            one: 2,
            soft: 0,
            nothing: 0,
            two: 0,
            three: 0,
            outside: 0,
            finer: 0,
            cylinder: 0,
            first_seed: 7,
        };
        let page = page(counts, &judged);
        for part in [
            "| weak | white | 0 of 1 (0.0 %) | 0 of 1 (0.0 %) | 2.500 | 2.500 | 0 of 1 (0.0 %) |",
            "- weak backlash, white, seed 7: **explain: stiction, other effects**; the chain\n",
            "- weak backlash, white, seed 7: **not made**: out of reach\n",
            "2 of 2 (100.0 %); each",
        ] {
            assert!(page.contains(part), "no `{part}` in {page}");
        }
        let matrix = page.lines().find(|line| line.starts_with("18 backlash")).unwrap_or_default();
        let counted: Vec<&str> = matrix.split_whitespace().collect();
        assert_eq!((counted[4], counted[19]), ("1", "."), "named stiction, which is the third");
    }
}
