//! The ladder of errors, a rung per revision, and the candidates for what comes next: bars that lie, one
//! below another, each with its name and its value, down to the noise.

use rerun::Color;
use rerun::datatypes::Vec2D;

use crate::diagnosis::{Comparison, sensor_noise};
use crate::explain::{Candidate, Change, Revision, Verdict};
use crate::recording::canvas::short;
use crate::recording::canvas::{Labels, Plot, Span, Strips};
use crate::recording::error::RecordError;
use crate::recording::layers::Layers;
use crate::recording::palette::{self, Rgb, color};
use crate::recording::panels::{HATCH, hatched};
use crate::report::{ImprovedJoint, change_in_words};

/// Where on the sheet the names and the bars lie, from left to right.
struct Columns {
    left: f32,
    /// Least and farthest end of the names.
    names: (f32, f32),
    right: f32,
}

const LADDER: Columns = Columns { left: 0.0, names: (300.0, 370.0), right: 630.0 };
const RANKING: Columns = Columns { left: 1270.0, names: (1570.0, 1660.0), right: 1890.0 };

/// Part of a row that its bar fills.
const FILLED: f64 = 0.62;

/// Half of the height of a line of text, on the sheet.
const HALF_LINE: f32 = 14.0;

/// The error by which a revision is judged: on data that were not fitted, where there are any.
pub(in crate::recording) fn judged(comparison: &Comparison) -> f64 {
    comparison.judged().map_or(0.0, |error| error.rmse)
}

/// The noise of the sensor, from the record alone: one for all revisions.
pub(super) fn noise(improved: &ImprovedJoint<'_>) -> Option<f64> {
    sensor_noise(&improved.finding.compared.joint.trials)
}

/// Adds the ladder, the revision at hand being bright, and beside it the candidates.
pub(super) fn add(rows: &mut Layers<'_>, improved: &ImprovedJoint<'_>) -> Result<(), RecordError> {
    let places = || 0..improved.revisions.len();
    let ladders: Vec<Chart> = places().map(|at| ladder(improved, at)).collect();
    rows.colored("ladder", HATCH, ladders.iter().map(Chart::filling))?;
    rows.strips("training", palette::BORDER, 1.6, ladders.iter().map(Chart::marks))?;
    rows.colored("ranking", HATCH, places().map(|at| ranking(improved, at).filling()))
}

/// The lines of the noise and all texts at a revision; those of the noise go to `floor`.
pub(super) fn around(
    improved: &ImprovedJoint<'_>,
    at: usize,
    labels: &mut Labels,
    floor: &mut Labels,
) -> Strips {
    let unit = improved.finding.compared.joint.output_unit.as_deref().unwrap_or("");
    let mut lines = Strips::new();
    for chart in [ladder(improved, at), ranking(improved, at)] {
        chart.put(labels, unit);
        if let Some(noise) = noise(improved) {
            chart.below(floor, noise, format!("noise {} {unit}", short(noise)));
            lines.push(chart.plot.vertical(noise).to_vec());
        }
    }
    lines
}

/// The rungs, the one at hand being marked.
fn ladder(improved: &ImprovedJoint<'_>, at: usize) -> Chart {
    /// Lines of names that there is room for, one below another.
    const MOST_LINES: usize = 14;
    let names: Vec<Vec<String>> = improved.revisions.iter().map(lines).collect();
    // What left the model has a row of its own below what came.
    let apart = names.iter().map(Vec::len).sum::<usize>() <= MOST_LINES;
    // Behind its number.
    let longest = 3 + names.iter().flatten().map(|line| line.chars().count()).max().unwrap_or(0);
    let mut bars = Vec::new();
    for (place, ((number, revision), lines)) in improved.numbered().zip(names).enumerate() {
        let (here, rgb) = (if place == at { "▶ " } else { "" }, palette::model(place));
        let (name, gone) = match (lines.first(), lines.get(1)) {
            (Some(came), Some(gone)) if apart => (came.clone(), Some(gone)),
            _ => (change_in_words(revision), None),
        };
        bars.push(Bar {
            name: format!("{here}{number}: {name}"),
            length: Some(judged(&revision.comparison)),
            instead: "",
            rgb: if place == at { rgb } else { palette::dimmed(rgb) },
            mark: revision.comparison.training.map(|error| error.rmse),
        });
        bars.extend(gone.map(|gone| Bar {
            name: gone.clone(),
            length: None,
            instead: "taken out",
            rgb,
            mark: None,
        }));
    }
    let title = "error of each revision: validation (bar), training (white)".to_owned();
    Chart::new(&LADDER, title, bars, longest)
}

/// The change of a revision, what left the model on a line of its own.
fn lines(revision: &Revision) -> Vec<String> {
    match revision.change {
        Change::Replaced { old, new } => vec![format!("+ {new}"), format!("− {old}")],
        _ => vec![change_in_words(revision)],
    }
}

/// The model as it is, then each candidate, that with the least error first.
fn ranking(improved: &ImprovedJoint<'_>, at: usize) -> Chart {
    let (all, refusal) = tried(improved, at);
    let longest = all.iter().map(|bar| bar.name.chars().count()).max().unwrap_or(0);
    let Some((number, revision)) = improved.numbered().nth(at) else {
        return Chart::new(&RANKING, String::new(), Vec::new(), 0);
    };
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
    let error = judged(&revision.comparison);
    let own = Bar::candidate(format!("revision {number}"), error, palette::model(at));
    Chart::new(&RANKING, title, std::iter::once(own).chain(all).collect(), longest)
}

/// The candidates at a revision; where there was no choice, what came next. What speaks against the first
/// of them, in short.
fn tried(improved: &ImprovedJoint<'_>, at: usize) -> (Vec<Bar>, Option<String>) {
    let ranking = improved.revisions.get(at).map_or(&[][..], |revision| &revision.ranking);
    if let ([], Some(next)) = (ranking, improved.revisions.get(at + 1)) {
        let error = judged(&next.comparison);
        return (vec![Bar::candidate(change_in_words(next), error, palette::PROPOSED)], None);
    }
    let proposed = improved.proposed(at).map(|candidate| &candidate.effects);
    let mut all: Vec<&Candidate> = ranking.iter().collect();
    all.sort_by(|a, b| a.rmse().total_cmp(&b.rmse()));
    let refusal = all.first().and_then(|best| best.judgement.refusal_in_short());
    let bar = |candidate: &Candidate| {
        let is_taken = proposed == Some(&candidate.effects);
        let rgb = if is_taken { palette::PROPOSED } else { palette::RAW };
        Bar::candidate(format!("+ {}", candidate.name()), candidate.rmse(), rgb)
    };
    (all.into_iter().map(bar).collect(), refusal)
}

/// A row with a bar, or words instead of one.
struct Bar {
    name: String,
    length: Option<f64>,
    instead: &'static str,
    rgb: Rgb,
    /// A mark across it.
    mark: Option<f64>,
}

impl Bar {
    fn candidate(name: String, error: f64, rgb: Rgb) -> Self {
        let length = error.is_finite().then_some(error);
        Self { name, length, instead: "diverges", rgb, mark: None }
    }
}

/// Rows of bars with names on the left.
struct Chart {
    title: String,
    bars: Vec<Bar>,
    plot: Plot,
    /// Middle of the column with the names, and of all.
    names: f32,
    middle_of_all: f32,
}

impl Chart {
    /// Bars between two columns of the sheet. The names end where the one of `longest` letters does, but
    /// within the column's limits.
    fn new(columns: &Columns, title: String, bars: Vec<Bar>, longest: usize) -> Self {
        /// Room for a value behind the longest bar.
        const ROOM: f64 = 1.8;
        /// Width of a letter on the sheet in a window of 1280 points.
        const LETTER: f32 = 15.0;
        /// Highest row, on the sheet.
        const HIGHEST: f32 = 90.0;
        /// Top and bottom of the bars on the sheet.
        const ROWS: (f32, f32) = (44.0, 450.0);
        let Columns { left, names: (short, long), right } = *columns;
        let names = (left + LETTER * (longest + 2) as f32).clamp(short, long);
        let rows = bars.len().max(1);
        let bottom = (ROWS.0 + HIGHEST * rows as f32).min(ROWS.1);
        let most = bars.iter().filter_map(|bar| bar.length).fold(0.0, f64::max);
        let (x, y) = (Span::new(0.0, ROOM * most), Span::new(0.0, rows as f64));
        let plot = Plot::within((names, right), ROWS.0..=bottom, x, y);
        let middle_of_all = f32::midpoint(left, right);
        Self { title, bars, plot, names: f32::midpoint(left, names), middle_of_all }
    }

    /// Each bar with the middle of its row.
    fn rows(&self) -> impl Iterator<Item = (f64, &Bar)> {
        let middle = |row: usize| self.bars.len() as f64 - row as f64 - 0.5;
        self.bars.iter().enumerate().map(move |(row, bar)| (middle(row), bar))
    }

    /// The lines that fill the bars.
    fn filling(&self) -> Vec<(Vec<Vec2D>, Color)> {
        let of_row = |(middle, bar): (f64, &Bar)| {
            let length = bar.length?;
            let [top, bottom] = [0.5, -0.5].map(|half| self.plot.y(middle + half * FILLED));
            let (left, right) = (self.plot.x(0.0) + HATCH, self.plot.x(length) - HATCH);
            let shade = color(bar.rgb);
            let line = move |y| (vec![Vec2D::new(left, y), Vec2D::new(right.max(left), y)], shade);
            Some(hatched(top, bottom).map(line))
        };
        self.rows().filter_map(of_row).flatten().collect()
    }

    /// The marks across bars.
    fn marks(&self) -> Strips {
        let of_row = |(middle, bar): (f64, &Bar)| {
            let value = bar.mark?;
            Some([0.5, -0.5].map(|half| self.plot.at(value, middle + half)).to_vec())
        };
        self.rows().filter_map(of_row).collect()
    }

    /// Title, names and values.
    fn put(&self, labels: &mut Labels, unit: &str) {
        labels.put(Vec2D::new(self.middle_of_all, 4.0), self.title.clone());
        for (middle, bar) in self.rows() {
            self.put_name(labels, middle, &bar.name);
            let value = bar.length.map(|length| format!("{} {unit}", short(length)));
            let value = value.unwrap_or_else(|| bar.instead.to_owned());
            // Behind the bar and its mark.
            let end = bar.length.unwrap_or(0.0).max(bar.mark.unwrap_or(0.0));
            let x = self.plot.x(end) + half_width(&value);
            labels.put(Vec2D::new(x, self.plot.y(middle) - HALF_LINE), value);
        }
    }

    fn put_name(&self, labels: &mut Labels, middle: f64, name: &str) {
        // Two lines where it is two changes; what came stands for both where rows are narrow.
        let height = self.plot.y(middle - 1.0) - self.plot.y(middle);
        let (name, drop) = match name.split_once(", ") {
            Some((came, gone)) if height >= 4.0 * HALF_LINE => {
                (format!("{came}\n{gone}"), 2.0 * HALF_LINE)
            }
            Some((came, _)) => (format!("{came}, …"), HALF_LINE),
            None => (name.to_owned(), HALF_LINE),
        };
        labels.put(Vec2D::new(self.names, self.plot.y(middle) - drop), name);
    }

    /// A text below the line at `value`.
    fn below(&self, labels: &mut Labels, value: f64, text: String) {
        let Vec2D([x, y]) = self.plot.below(value, 4.0);
        labels.put(Vec2D::new(x.max(self.names + half_width(&text)), y), text);
    }
}

/// Half of the width of a text with the room beside it, on the sheet.
fn half_width(text: &str) -> f32 {
    7.0 * (text.chars().count() + 2) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_bar_is_the_highest_and_lengths_are_in_proportion() {
        let bar = |error| Bar::candidate("+ dead_band".to_owned(), error, palette::model(0));
        let filling = |errors: [f64; 2]| {
            let chart = Chart::new(&LADDER, String::new(), errors.map(bar).into(), 10);
            chart.filling().into_iter().map(|(line, _)| (line[0].x(), line[1].x(), line[0].y()))
        };
        let lines: Vec<_> = filling([1.0, 0.5]).collect();
        let (whole, half) = (lines[0], lines[lines.len() - 1]);
        assert!(whole.2 < half.2, "above");
        let full = |(left, right, _): (f32, f32, f32)| right - left + 2.0 * HATCH;
        assert!((full(whole) / full(half) - 2.0).abs() < 1e-3);
    }
}
