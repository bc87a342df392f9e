//! The page of the results.

use tauscope::design::DesignError;

use super::case::{Case, Judged, Outcome, TIMES, Unsuspected};

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
    let rule = "---|".repeat(9 + TIMES.len());
    let head = format!(
        "| hidden | other | suspected | told by the log | designed | explored first | length | told | at least |{times}\n|{rule}\n"
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
    // A joint that cannot be made, as when its neighbour leaves the range, is none.
    let made = group.iter().filter_map(|judged| match &judged.outcome {
        Ok(outcome) => Some(Ok(outcome)),
        Err(error) if error.is::<Unsuspected>() || error.is::<DesignError>() => Some(Err(error)),
        Err(_) => None,
    });
    let made: Vec<_> = made.collect();
    let unsuspected = made.iter().filter(|of| of.is_err_and(anyhow::Error::is::<Unsuspected>));
    let suspected = made.len() - unsuspected.count();
    let outcomes = made.iter().filter_map(|outcome| outcome.ok());
    let aimed: Vec<&Outcome> = outcomes.filter(|outcome| outcome.aimed).collect();
    let explored = aimed.iter().filter(|outcome| !outcome.explored_s.is_empty()).count();
    let mut lengths: Vec<f64> = aimed.iter().map(|outcome| outcome.duration_s).collect();
    lengths.sort_by(f64::total_cmp);
    let length = lengths.get(lengths.len() / 2);
    let length = length.map_or_else(|| "-".to_owned(), |length| format!("{length:.1} s"));
    let told = share(aimed.iter().map(|outcome| Some(outcome.designed)));
    let count = aimed.iter().filter(|outcome| outcome.designed).count();
    let least = at_least(count, aimed.len());
    let known = share(aimed.iter().map(|outcome| Some(outcome.known)));
    let random = (0..TIMES.len()).map(|place| {
        let told = aimed.iter().map(|outcome| outcome.random.get(place).copied().flatten());
        format!(" {} |", share(told))
    });
    format!(
        "| {title} | {suspected} of {} | {known} | {} | {explored} | {length} | {told} | {:.0} % |{}\n",
        made.len(),
        aimed.len(),
        100.0 * least,
        random.collect::<String>()
    )
}

/// The lowest chance at which so many of `all` successes still come up in one of twenty trials:
/// with 95 % confidence it is no lower (Clopper and Pearson 1934).
fn at_least(successes: usize, all: usize) -> f64 {
    const DOUBT: f64 = 0.05;
    const HALVINGS: usize = 50;
    let (mut below, mut above) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (below + above);
        let end =
            if so_many_or_more(successes, all, middle) > DOUBT { &mut above } else { &mut below };
        *end = middle;
    }
    below
}

/// The probability of so many successes or more in `all` trials.
fn so_many_or_more(successes: usize, all: usize, chance: f64) -> f64 {
    // Term by term, each from the one before.
    let mut term = (1.0 - chance).powf(all as f64);
    let mut fewer = 0.0;
    for k in 0..successes {
        fewer += term;
        term *= (all - k) as f64 / (k + 1) as f64 * chance / (1.0 - chance);
    }
    1.0 - fewer
}

/// `19 of 20`, of those that are known.
fn share(told: impl Iterator<Item = Option<bool>>) -> String {
    let known: Vec<bool> = told.flatten().collect();
    match known.len() {
        0 => "-".to_owned(),
        all => format!("{} of {all}", known.iter().filter(|told| **told).count()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_at_least_what_the_tables_say() {
        // All of 59 and 19 of 20, one-sided.
        assert!((at_least(59, 59) - 0.05_f64.powf(1.0 / 59.0)).abs() < 1e-9);
        assert!((at_least(19, 20) - 0.7839).abs() < 1e-4 && at_least(0, 5) < 1e-9);
    }
}
