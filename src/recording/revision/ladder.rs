//! The ladder of errors, a rung per revision, and the candidates for what comes next.

use crate::diagnosis::{Comparison, sensor_noise};
use crate::explain::{Candidate, Verdict};
use crate::figure::ladder::{Rung, panel, value};
use crate::figure::{Mark, Role};
use crate::recording::canvas::{LINE, width};
use crate::recording::model::SIZE;
use crate::recording::palette::{self, role};
use crate::recording::panels::Placed;
use crate::report::ImprovedJoint;
use crate::report::ladder::{change_in_words, judged_error};

/// Length of the longest bar.
const LONGEST: f32 = 130.0;

/// Room between a plot and what stands beside it.
const GAP: f32 = 20.0;

/// Highest row, and the lowest in which the names of rows do not cover each other.
const ROW: (f32, f32) = (90.0, 40.0);

/// Top of the plots, and their lower end at most.
const ENDS: (f32, f32) = (44.0, SIZE.1 - 20.0);

/// Rows for which there is room below two lines of name and legend.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few rows")]
const MOST: usize = ((ENDS.1 - ENDS.0 - LINE) / ROW.1) as usize;

/// The error by which a revision is judged: on data that were not fitted, where there are any.
pub(in crate::recording) fn judged(comparison: &Comparison) -> f64 {
    comparison.judged().map_or(0.0, |error| error.rmse)
}

/// The noise of the sensor, from the record alone: one for all revisions.
pub(super) fn noise(improved: &ImprovedJoint<'_>) -> Option<f64> {
    sensor_noise(&improved.finding.compared.joint.trials)
}

/// Bars with their names, of one revision: which one is at hand, or what came of it.
struct Bars {
    title: String,
    part: &'static str,
    rungs: Vec<Rung>,
}

/// Ladder and ranking of every revision, in columns that have room for the longest of their names.
pub(super) struct Ladders<'i> {
    improved: &'i ImprovedJoint<'i>,
    rows: Vec<[Bars; 2]>,
    /// The widest name and the widest value of each column.
    widths: [(f32, f32); 2],
}

impl<'i> Ladders<'i> {
    pub(super) fn new(improved: &'i ImprovedJoint<'i>) -> Self {
        let count = improved.revisions.len();
        let rows: Vec<_> =
            (0..count).map(|at| [ladder(improved, at), ranking(improved, at)]).collect();
        let unit = improved.finding.compared.joint.output_unit.as_deref();
        let widths = [0, 1].map(|column: usize| {
            let rungs = || rows.iter().flat_map(move |row| &row[column].rungs);
            let names = rungs().map(|rung| width(&rung.name));
            let values = rungs().map(|rung| width(&value(rung, unit)));
            (names.fold(0.0, f32::max), values.fold(0.0, f32::max))
        });
        Self { improved, rows, widths }
    }

    /// The ends of what is drawn between the two columns, with labels on its left.
    pub(super) fn between(&self) -> (f32, f32) {
        /// Widest label of an axis.
        const LABEL: f32 = 100.0;
        let [(_, ladder), (ranking, _)] = self.columns();
        (ladder + GAP + LABEL, ranking - self.widths[1].0 - GAP)
    }

    /// Left and right ends of the plots.
    fn columns(&self) -> [(f32, f32); 2] {
        let [(names, values), (_, last)] = self.widths;
        let right = SIZE.0 - GAP;
        [(names, names + LONGEST + values), (right - LONGEST - last, right)]
    }

    /// Both columns, of the revision `at` this place.
    pub(super) fn placed(&self, at: usize) -> Vec<Placed> {
        let row = self.rows.get(at).into_iter().flatten().enumerate();
        row.map(|(column, bars)| {
            let (columns, (_, values)) = (self.columns()[column], self.widths[column]);
            let joint = self.improved.finding.compared.joint;
            let limit = (noise(self.improved), joint.output_unit.as_deref());
            let room = f64::from(1.0 + values / LONGEST);
            let mut panel = panel((bars.title.clone(), bars.part), &bars.rungs, limit, room);
            panel.x.ticks.clear();
            if column == 1 {
                // The line of the noise has its name in the ladder.
                panel.marks.iter_mut().for_each(Mark::unname);
            }
            let bottom = ENDS.0 + LINE + ROW.0 * bars.rungs.len().max(1) as f32;
            Placed::new(panel, columns, ENDS.0..=bottom.min(ENDS.1))
        })
        .collect()
    }
}

/// The rungs, the one at hand being marked: of more than there is room for the first, the last, the one
/// at hand, and those that lower the error most.
fn ladder(improved: &ImprovedJoint<'_>, at: usize) -> Bars {
    let errors: Vec<f64> = improved.revisions.iter().map(|one| judged(&one.comparison)).collect();
    let count = errors.len();
    let fall = |place: usize| match place {
        0 => f64::INFINITY,
        _ if place == at || place + 1 == count => f64::INFINITY,
        _ => errors[place - 1] - errors[place],
    };
    let shown = telling(count, fall);
    let rung = |(place, (number, revision)): (usize, (u32, &_))| {
        let (here, own) = (if place == at { "▶ " } else { "" }, palette::model(place));
        Rung {
            name: format!("{here}{number}: {}", change_in_words(revision)),
            error: Some(judged(&revision.comparison)),
            training: revision.comparison.training.map(|error| error.rmse),
            role: role(if place == at { own } else { palette::dimmed(own) }),
        }
    };
    let all = improved.numbered().enumerate().filter(|(place, _)| shown.contains(place));
    let name =
        judged_error(improved.revisions.iter().map(|one| one.comparison.validation.is_some()));
    let title = match count - shown.len() {
        0 => name.to_owned(),
        _ => format!("{name}, {} of {count} revisions", shown.len()),
    };
    Bars { title, part: "ladder", rungs: all.map(rung).collect() }
}

/// Of so many the places, in their order, of those with the greatest `weight` for which there is room.
fn telling(count: usize, weight: impl Fn(usize) -> f64) -> Vec<usize> {
    let mut places: Vec<usize> = (0..count).collect();
    places.sort_by(|a, b| weight(*b).total_cmp(&weight(*a)));
    places.truncate(MOST);
    places.sort_unstable();
    places
}

/// The model as it is, then each candidate, that with the least error first; above them what they are.
fn ranking(improved: &ImprovedJoint<'_>, at: usize) -> Bars {
    let part = "ranking";
    let Some((number, revision)) = improved.numbered().nth(at) else {
        return Bars { title: String::new(), part, rungs: Vec::new() };
    };
    let (all, refusal) = tried(improved, at);
    let is_last = at + 1 == improved.revisions.len();
    let title = match (all.as_slice(), revision.ranking.as_slice()) {
        ([], _) if revision.comparison.is_adequate() => "no effect is missing".to_owned(),
        ([], _) => "nothing more was looked for".to_owned(),
        (_, []) => "error at the next revision".to_owned(),
        ([best, ..], _) if is_last && improved.finding.verdict == Verdict::Unexplained => {
            let name = best.name.trim_start_matches("+ ");
            let why = refusal.map(|why| format!(" ({name}: {why})"));
            format!("none was added{}", why.unwrap_or_default())
        }
        _ => "error with one effect more".to_owned(),
    };
    let own = Role::of_revision(at);
    let own = rung(format!("revision {number}"), judged(&revision.comparison), own);
    let mut rungs: Vec<Rung> = std::iter::once(own).chain(all).collect();
    // The model as it is and the effect that is added stay where there is no room for all.
    let is_needed = |place: usize| place == 0 || rungs[place].role == role(palette::PROPOSED);
    let weight = |place| if is_needed(place) { f64::INFINITY } else { -(place as f64) };
    let shown = telling(rungs.len(), weight);
    let title = match rungs.len() - shown.len() {
        0 => title,
        more => format!("{title}; {more} more left out"),
    };
    let mut place = 0..;
    rungs.retain(|_| place.next().is_some_and(|place| shown.contains(&place)));
    Bars { title, part, rungs }
}

/// The candidates at a revision; where there was no choice, what came next. What speaks against the first
/// of them, in short.
fn tried(improved: &ImprovedJoint<'_>, at: usize) -> (Vec<Rung>, Option<String>) {
    let ranking = improved.revisions.get(at).map_or(&[][..], |revision| &revision.ranking);
    if let ([], Some(next)) = (ranking, improved.revisions.get(at + 1)) {
        let name = change_in_words(next);
        return (vec![rung(name, judged(&next.comparison), role(palette::PROPOSED))], None);
    }
    let proposed = improved.proposed(at).map(|candidate| &candidate.effects);
    let mut all: Vec<&Candidate> = ranking.iter().collect();
    all.sort_by(|a, b| a.rmse().total_cmp(&b.rmse()));
    let refusal = all.first().and_then(|best| best.judgement.refusal_in_short());
    let bar = |candidate: &Candidate| {
        let is_taken = proposed == Some(&candidate.effects);
        let rgb = if is_taken { palette::PROPOSED } else { palette::RAW };
        rung(format!("+ {}", candidate.name()), candidate.rmse(), role(rgb))
    };
    (all.into_iter().map(bar).collect(), refusal)
}

fn rung(name: String, error: f64, role: Role) -> Rung {
    Rung { name, error: error.is_finite().then_some(error), training: None, role }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_more_revisions_than_there_is_room_for_those_are_drawn_that_matter() {
        let falls = [f64::INFINITY, 0.9, 0.1, 0.8, 0.7, 0.2, 0.6, 0.5, 0.4, 0.3, f64::INFINITY];
        let shown = telling(falls.len(), |place| falls[place]);
        assert_eq!(shown, [0, 1, 3, 4, 6, 7, 8, 9, 10]);
        assert_eq!(telling(3, |_| 0.0), [0, 1, 2]);
    }
}
