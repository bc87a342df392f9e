//! The page of the results.

use super::case::{Case, Judged, Outcome, TIMES};

/// A line for each effect that is hidden, and one for all.
pub(crate) fn page(judged: &[Judged]) -> String {
    let mut groups: Vec<(Case, Vec<&Judged>)> = Vec::new();
    for each in judged {
        let is_same = |case: &Case| (case.pair, case.truth) == (each.case.pair, each.case.truth);
        match groups.iter_mut().find(|(case, _)| is_same(case)) {
            Some((_, group)) => group.push(each),
            None => groups.push((each.case, vec![each])),
        }
    }
    let times = TIMES.map(|times| format!(" random ×{times} |")).concat();
    let rule = "---|".repeat(8 + TIMES.len());
    let head = format!(
        "| hidden | other | suspected | told by the log | designed | length | expected | told |{times}\n|{rule}\n"
    );
    let lines = groups.iter().map(|(case, group)| {
        let [one, other] = case.pair;
        let other = if case.truth == 0 { other } else { one };
        line(&format!("`{}` | `{other}`", case.hidden()), group)
    });
    let all: Vec<&Judged> = judged.iter().collect();
    head + &lines.collect::<String>() + &line("all |", &all)
}

fn line(title: &str, group: &[&Judged]) -> String {
    let errors = group.iter().filter_map(|judged| judged.outcome.as_ref().err());
    let unsuspected = errors.filter(|error| error.to_string().contains("suspected")).count();
    let outcomes = group.iter().filter_map(|judged| judged.outcome.as_ref().ok());
    let aimed: Vec<&Outcome> = outcomes.filter(|outcome| outcome.aimed).collect();
    let mut lengths: Vec<f64> = aimed.iter().map(|outcome| outcome.duration_s).collect();
    lengths.sort_by(f64::total_cmp);
    let length = lengths.get(lengths.len() / 2);
    let length = length.map_or_else(|| "-".to_owned(), |length| format!("{length:.1} s"));
    let power = aimed.iter().map(|outcome| outcome.power).sum::<f64>() / aimed.len() as f64;
    let power = if power.is_nan() { "-".to_owned() } else { format!("{power:.3}") };
    let told = share(aimed.iter().map(|outcome| Some(outcome.designed)));
    let known = share(aimed.iter().map(|outcome| Some(outcome.known)));
    let random = (0..TIMES.len()).map(|place| {
        let told = aimed.iter().map(|outcome| outcome.random.get(place).copied().flatten());
        format!(" {} |", share(told))
    });
    format!(
        "| {title} | {} of {} | {known} | {} | {length} | {power} | {told} |{}\n",
        group.len() - unsuspected,
        group.len(),
        aimed.len(),
        random.collect::<String>()
    )
}

/// `19 of 20`, of those that are known.
fn share(told: impl Iterator<Item = Option<bool>>) -> String {
    let known: Vec<bool> = told.flatten().collect();
    match known.len() {
        0 => "-".to_owned(),
        all => format!("{} of {all}", known.iter().filter(|told| **told).count()),
    }
}
