//! The candidates for what comes next, that with the least error first, down to the noise.

use rerun::Color;
use rerun::datatypes::Vec2D;

use super::bars::{Bars, Columns};
use super::figure::noise;
use crate::explain::{Candidate, Revision, Verdict};
use crate::recording::canvas::{Labels, Strips};
use crate::recording::error::RecordError;
use crate::recording::error_share::{HATCH, short};
use crate::recording::layers::Layers;
use crate::recording::palette::{self, Rgb, color};
use crate::recording::rungs::judged;
use crate::report::{ImprovedJoint, change_in_words};

const COLUMNS: Columns = Columns { left: 1270.0, names: (1570.0, 1660.0), right: 1890.0 };

/// Adds the bars of all revisions: the model as it is, then each candidate.
pub(super) fn add(rows: &mut Layers<'_>, improved: &ImprovedJoint<'_>) -> Result<(), RecordError> {
    let of_each = improved.revisions.iter().enumerate().map(|(at, revision)| {
        let all = tried(improved, at);
        let bars = bars_of(revision, &all);
        let candidates = all
            .iter()
            .map(|one| (one.error, if one.is_taken { palette::PROPOSED } else { palette::RAW }));
        let own = std::iter::once((judged(&revision.comparison), palette::model(at)));
        // One that diverges has no bar.
        let bar = |(row, (error, rgb)): (usize, (f64, Rgb))| {
            let length = error.is_finite().then_some(error);
            length.map_or_else(Vec::new, |length| bars.bar(row, length, color(rgb)))
        };
        let all: Vec<(Vec<Vec2D>, Color)> =
            own.chain(candidates).enumerate().flat_map(bar).collect();
        all
    });
    rows.colored("ranking", HATCH, of_each.collect::<Vec<_>>().into_iter())
}

/// The line of the noise and the texts of the ranking at a revision.
pub(super) fn around(
    improved: &ImprovedJoint<'_>,
    at: usize,
    labels: &mut Labels,
    floor: &mut Labels,
) -> Strips {
    let Some((number, revision)) = improved.numbered().nth(at) else { return Vec::new() };
    let all = tried(improved, at);
    let bars = bars_of(revision, &all);
    let unit = improved.finding.compared.joint.output_unit.as_deref().unwrap_or("");
    let is_last = at + 1 == improved.revisions.len();
    let title = match (all.as_slice(), revision.ranking.as_slice()) {
        ([], _) if revision.comparison.is_adequate() => "no effect is missing".to_owned(),
        ([], _) => "nothing more was looked for".to_owned(),
        (_, []) => "error at the next revision".to_owned(),
        ([best, ..], _) if is_last && improved.finding.verdict == Verdict::Unexplained => {
            let name = best.name.trim_start_matches("+ ");
            let why = best.refusal.as_ref().map(|why| format!(" ({name}: {why})"));
            format!("none was added{}", why.unwrap_or_default())
        }
        _ => "error with one effect more".to_owned(),
    };
    bars.title(labels, &title);
    let own = (format!("revision {number}"), judged(&revision.comparison));
    let candidates = all.into_iter().map(|one| (one.name, one.error));
    for (row, (name, error)) in std::iter::once(own).chain(candidates).enumerate() {
        bars.name(labels, row, &name);
        if error.is_finite() {
            bars.value(labels, row, error, format!("{} {unit}", short(error)));
        } else {
            bars.value(labels, row, 0.0, "diverges".to_owned());
        }
    }
    let Some(noise) = noise(improved) else { return Vec::new() };
    bars.below(floor, noise, format!("noise {} {unit}", short(noise)));
    vec![bars.line(noise)]
}

/// What may come next, and the error with it.
struct Tried {
    name: String,
    error: f64,
    is_taken: bool,
    /// What speaks against it, in short.
    refusal: Option<String>,
}

/// The candidates at a revision; where there was no choice, what came next.
fn tried(improved: &ImprovedJoint<'_>, at: usize) -> Vec<Tried> {
    let ranking = improved.revisions.get(at).map_or(&[][..], |revision| &revision.ranking);
    if let ([], Some(next)) = (ranking, improved.revisions.get(at + 1)) {
        let (name, error) = (change_in_words(next), judged(&next.comparison));
        return vec![Tried { name, error, is_taken: true, refusal: None }];
    }
    let proposed = improved.proposed(at).map(|candidate| &candidate.effects);
    let one = |candidate: &Candidate| Tried {
        name: format!("+ {}", candidate.name()),
        error: candidate.rmse(),
        is_taken: proposed == Some(&candidate.effects),
        refusal: candidate.judgement.refusal_in_short(),
    };
    let mut all: Vec<Tried> = ranking.iter().map(one).collect();
    all.sort_by(|a, b| a.error.total_cmp(&b.error));
    all
}

fn bars_of(revision: &Revision, all: &[Tried]) -> Bars {
    let errors = all.iter().map(|one| one.error).filter(|error| error.is_finite());
    let most = errors.fold(judged(&revision.comparison), f64::max);
    let longest = all.iter().map(|one| one.name.chars().count()).max().unwrap_or(0);
    Bars::new(COLUMNS, (1 + all.len(), longest), most)
}
