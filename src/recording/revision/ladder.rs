//! The ladder of errors, a rung per revision, and the candidates for what comes next.

use crate::diagnosis::{Comparison, sensor_noise};
use crate::explain::{Candidate, Verdict};
use crate::figure::Role;
use crate::figure::ladder::{Rung, panel};
use crate::recording::palette::{self, role};
use crate::recording::panels::Placed;
use crate::report::ImprovedJoint;
use crate::report::ladder::change_in_words;

/// Left end of the bars of the ladder and of the ranking, and their right end: on the left are names.
const LADDER: (f32, f32) = (370.0, 640.0);
const RANKING: (f32, f32) = (1640.0, 1890.0);

/// Room for the value behind the longest bar, in its length.
const ROOM: f64 = 1.8;

/// The error by which a revision is judged: on data that were not fitted, where there are any.
pub(in crate::recording) fn judged(comparison: &Comparison) -> f64 {
    comparison.judged().map_or(0.0, |error| error.rmse)
}

/// The noise of the sensor, from the record alone: one for all revisions.
pub(super) fn noise(improved: &ImprovedJoint<'_>) -> Option<f64> {
    sensor_noise(&improved.finding.compared.joint.trials)
}

/// The ladder, the revision `at` hand being bright, and the candidates for what comes next.
pub(super) fn placed(improved: &ImprovedJoint<'_>, at: usize) -> [Placed; 2] {
    let name = "errors".to_owned();
    let ladder = bars(improved, (name, "ladder"), &rungs(improved, at), LADDER);
    let (title, candidates) = ranking(improved, at);
    [ladder, bars(improved, (title, "ranking"), &candidates, RANKING)]
}

fn bars(
    improved: &ImprovedJoint<'_>,
    name: (String, &'static str),
    rungs: &[Rung],
    columns: (f32, f32),
) -> Placed {
    /// Highest row, on the sheet.
    const HIGHEST: f32 = 90.0;
    let unit = improved.finding.compared.joint.output_unit.as_deref();
    let mut panel = panel(name, rungs, (noise(improved), unit), ROOM);
    panel.x.ticks.clear();
    let bottom = (88.0 + HIGHEST * rungs.len().max(1) as f32).min(450.0);
    Placed::new(panel, columns, 44.0..=bottom)
}

/// The rungs, the one at hand being marked.
fn rungs(improved: &ImprovedJoint<'_>, at: usize) -> Vec<Rung> {
    let rung = |(place, (number, revision)): (usize, (u32, &_))| {
        let (here, own) = (if place == at { "▶ " } else { "" }, palette::model(place));
        Rung {
            name: in_lines(&format!("{here}{number}: {}", change_in_words(revision))),
            error: Some(judged(&revision.comparison)),
            training: revision.comparison.training.map(|error| error.rmse),
            role: role(if place == at { own } else { palette::dimmed(own) }),
        }
    };
    improved.numbered().enumerate().map(rung).collect()
}

/// Two changes one below the other.
fn in_lines(name: &str) -> String {
    name.replace(", ", ",\n")
}

/// The model as it is, then each candidate, that with the least error first; above them what they are.
fn ranking(improved: &ImprovedJoint<'_>, at: usize) -> (String, Vec<Rung>) {
    let Some((number, revision)) = improved.numbered().nth(at) else { return Default::default() };
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
    (title, std::iter::once(own).chain(all).collect())
}

/// The candidates at a revision; where there was no choice, what came next. What speaks against the first
/// of them, in short.
fn tried(improved: &ImprovedJoint<'_>, at: usize) -> (Vec<Rung>, Option<String>) {
    let ranking = improved.revisions.get(at).map_or(&[][..], |revision| &revision.ranking);
    if let ([], Some(next)) = (ranking, improved.revisions.get(at + 1)) {
        let name = in_lines(&change_in_words(next));
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
