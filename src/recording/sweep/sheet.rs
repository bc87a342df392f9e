//! All steps of a joint at all settings: their delays, which setting they are sensitive to, and
//! which settings agree.

use std::collections::BTreeMap;

use rerun::Points2D;
use rerun::components::DrawOrder;
use rerun::datatypes::Vec2D;

use super::map::{Block, beside, blocks, named, picture, rows_of};
use super::swept::{Opinion, Swept};
use crate::delay::sweep::{Factor, SweptStep};
use crate::numerics::quantile;
use crate::recording::canvas::{Labels, Plot, SHEET, Span};
use crate::recording::chunk::Chunks;
use crate::recording::error::RecordError;
use crate::recording::layers::{Ink, Layers};
use crate::recording::palette::{self, Rgb, color};
use crate::recording::paths;
use crate::recording::sheet::{Sheet, TITLE};
use crate::report::settings_in_words;
use crate::wording::number;

/// Width and height of the sheet.
pub(in crate::recording) const SIZE: (f32, f32) = (SHEET.0, 1130.0);

/// Left and right ends of the plots: names stand on the left, counts on the right.
const SIDES: (f32, f32) = (196.0, SHEET.0 - 70.0);

/// Points times combinations up to which the pointer names settings in words, which takes
/// time; with more it counts them.
const NAMED: usize = 20_000_000;

/// Draws the page below `root`.
pub(super) fn add(chunks: &mut Chunks, swept: &Swept<'_>) -> Result<(), RecordError> {
    let page = Page::of(swept);
    let mut layers = Layers::fixed(chunks, paths::SHEET);
    layers.sheets([page.grid()])?;
    page.add_delays(&mut layers)?;
    page.add_sensitive(&mut layers)?;
    page.add_map(&mut layers)?;
    layers.texts("legend", Ink::Own, [legend(swept)])?;
    page.add_setting(&mut Layers::rows(chunks, paths::SHEET, swept.settings()))?;
    page.add_step(&mut Layers::rows(chunks, paths::SHEET, swept.index.clone()))
}

/// The three plots on their sheet, which share the axis of steps.
struct Page<'s> {
    swept: &'s Swept<'s>,
    delays: Plot,
    sensitive: Plot,
    map: Plot,
    /// What delays may be sensitive to.
    causes: Vec<(String, Cause)>,
}

/// What a step is sensitive to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cause {
    /// Its delay moves with this setting.
    Delay(Factor),
    /// Its delay moves with no setting alone.
    Several,
    /// Some settings accept it, others do not.
    Verdict,
}

impl Cause {
    /// Those that there can be, and their names.
    fn all(swept: &Swept<'_>) -> Vec<(String, Self)> {
        let varied = Factor::ALL.into_iter().filter(|factor| swept.grid.levels(*factor) > 1);
        let mut causes: Vec<_> =
            varied.map(|factor| (factor.to_string(), Self::Delay(factor))).collect();
        causes.push(("several at once".to_owned(), Self::Several));
        causes.push(("accepted or not".to_owned(), Self::Verdict));
        causes
    }

    fn moves(self, step: &SweptStep) -> bool {
        let on = step.delay_depends_on.as_ref().map(|hanging| hanging.factor);
        match self {
            Self::Delay(factor) => on == Some(factor),
            Self::Several => on.is_none() && step.disagreeing() > 0,
            Self::Verdict => step.accepted > 0 && step.accepted < step.tried,
        }
    }

    fn rgb(self) -> Rgb {
        match self {
            Self::Delay(_) | Self::Several => palette::INPUT,
            Self::Verdict => palette::REJECTED,
        }
    }
}

impl<'s> Page<'s> {
    fn of(swept: &'s Swept<'s>) -> Self {
        let x = Span::new(0.5, swept.steps.len().max(1) as f64 + 0.5);
        let causes = Cause::all(swept);
        let rows = Span::new(0.0, causes.len() as f64);
        let combinations = Span::new(0.0, swept.grid.combinations().len().max(1) as f64);
        Self {
            swept,
            delays: Plot::within(SIDES, 100.0..=390.0, x, delay_span(swept)),
            sensitive: Plot::within(SIDES, 466.0..=700.0, x, rows),
            map: Plot::within(SIDES, 772.0..=1042.0, x, combinations),
            causes,
        }
    }

    /// Each step with its place on the axis.
    fn steps(&self) -> impl Iterator<Item = (f64, &'s SweptStep)> {
        (1_u32..).map(f64::from).zip(self.swept.steps.iter().map(|(step, _)| *step))
    }

    /// Frames, ticks and titles.
    fn grid(&self) -> Sheet {
        /// Ticks of the delay, about.
        const TICKS: f64 = 6.0;
        let mut sheet = Sheet::default();
        let ticks: Vec<f64> = self.delays.x_span().ticks(12.0);
        let seconds = self.delays.y_span().ticks(TICKS).into_iter();
        let seconds: Vec<_> = seconds.map(|y| (y, format!("{} s", number(y)))).collect();
        sheet.outline(&self.delays, &ticks, &seconds);
        sheet.outline(&self.sensitive, &ticks, &[]);
        sheet.outline(&self.map, &[], &[]);
        sheet.title(&self.delays, TITLE, "delay of each step, with every setting");
        sheet.title(&self.sensitive, TITLE, "steps sensitive to");
        for x in ticks {
            sheet.put(self.map.below(x, 2.0), number(x));
        }
        let end = Vec2D::new(SIDES.1 + 34.0, self.map.below(1.0, 2.0).y());
        sheet.put(end, "step");
        for ((name, _), row) in self.causes.iter().zip(0_u32..) {
            let y = self.sensitive.y_span().high - f64::from(row) - 0.5;
            sheet.put(self.sensitive.left_of(y, 98.0), name);
        }
        sheet
    }

    /// Every delay that is reported, and what is agreed on.
    fn add_delays(&self, layers: &mut Layers<'_>) -> Result<(), RecordError> {
        let (mut ranges, mut agreed) = (Vec::new(), Vec::new());
        for (x, step) in self.steps() {
            let y = |samples: f64| samples * step.period_s;
            if let Some(spread) = step.spread {
                let ends = [y(spread.min), y(spread.max)];
                ranges.push(ends.map(|y| self.delays.at(x, y)).to_vec());
            }
            if let Some(agreement) = step.agreement {
                let y = y(agreement.delay);
                agreed.push([x - 0.4, x + 0.4].map(|x| self.delays.at(x, y)).to_vec());
            }
        }
        layers.strips("range", palette::GRID, 1.0, [ranges])?;
        layers.order(45.0).strips("agreed", palette::ACCEPTED, 1.8, [agreed])?;
        // A point for all settings that report one delay of a step.
        let mut groups: Vec<(f64, &SweptStep, Group)> = Vec::new();
        for (x, step) in self.steps() {
            groups.extend(Group::all(self.swept, step).into_iter().map(|group| (x, step, group)));
        }
        let is_named = groups.len().saturating_mul(self.swept.grid.combinations().len()) <= NAMED;
        for (path, opinion, order) in [
            ("same", Opinion::Same, 30.0),
            ("longer", Opinion::Longer, 40.0),
            ("shorter", Opinion::Shorter, 40.0),
        ] {
            let own = || groups.iter().filter(|(.., group)| group.opinion == opinion);
            let place = |x: f64, step: &SweptStep, group: &Group| {
                self.delays.at(x, group.delay * step.period_s)
            };
            let name = |step: &SweptStep, group: &Group| {
                let words = is_named.then(|| format!(": {}", group.in_words(self.swept)));
                group.name(step) + &words.unwrap_or_default()
            };
            let points = Points2D::new(own().map(|(x, step, group)| place(*x, step, group)))
                .with_radii(own().map(|(_, step, group)| group.radius(step)))
                .with_labels(own().map(|(_, step, group)| name(step, group)))
                .with_colors([color(opinion.rgb())])
                .with_show_labels(false)
                .with_draw_order(DrawOrder::from(order));
            layers.stays(path, &points)?;
        }
        Ok(())
    }

    /// A mark for each step beside what it is sensitive to, and how many they are.
    fn add_sensitive(&self, layers: &mut Layers<'_>) -> Result<(), RecordError> {
        let (mut counts, mut marks, mut colors) = (Labels::default(), Vec::new(), Vec::new());
        let slot = self.sensitive.x(2.0) - self.sensitive.x(1.0);
        for ((_, cause), row) in self.causes.iter().zip(0_u32..) {
            let y = self.sensitive.y_span().high - f64::from(row) - 0.5;
            let sensitive = self.steps().filter(|(_, step)| cause.moves(step));
            let places: Vec<_> = sensitive.map(|(x, _)| self.sensitive.at(x, y)).collect();
            counts.put(self.sensitive.right_of(y, 30.0), places.len().to_string());
            colors.extend(std::iter::repeat_n(color(cause.rgb()), places.len()));
            marks.extend(places);
        }
        let points = Points2D::new(marks).with_colors(colors).with_radii([(0.5 * slot).min(7.0)]);
        layers.stays("hanging", &points)?;
        layers.texts("counts", palette::BORDER, [counts])
    }

    /// The picture of all settings and steps, and what its rows are.
    fn add_map(&self, layers: &mut Layers<'_>) -> Result<(), RecordError> {
        /// Names nearer than this would cover each other.
        const APART: f32 = 36.0;
        if let Some((image, place)) = picture(self.swept, &self.map) {
            layers.stays("map", &image)?;
            layers.stays("map", &place)?;
        }
        let (methods, low_passes) = blocks(self.swept.grid);
        let border = |block: &Block| self.map.level(self.row(block.first)).to_vec();
        let thin = low_passes.iter().map(|block| (border(block), color(palette::GRID)));
        let thick = methods.iter().map(|block| (border(block), color(palette::BORDER)));
        layers.colored("blocks", 0.8, [thin.chain(thick).collect()])?;
        let mut texts = Labels::default();
        for block in named(self.swept.grid) {
            let place = beside(&self.map, &block);
            if texts.places.last().is_none_or(|last| place.y() - last.y() > APART) {
                texts.put(place, block.label);
            }
        }
        layers.texts("rows", palette::BORDER, [texts])
    }

    /// The upper edge of a row.
    fn row(&self, row: usize) -> f64 {
        self.map.y_span().high - row as f64
    }

    /// The setting under the cursor: its delays, its rows, its name.
    fn add_setting(&self, layers: &mut Layers<'_>) -> Result<(), RecordError> {
        let runs = || 0..self.swept.names.len();
        let delays = |run: usize| {
            let place = |(x, step): (f64, &SweptStep)| {
                Some(self.delays.at(x, Swept::delay(step, run)? * step.period_s))
            };
            self.steps().filter_map(place).collect()
        };
        layers.points("setting/delays", palette::HERE, 4.0, runs().map(delays))?;
        let frame = |run: usize| {
            let frame = |(first, last): (usize, usize)| {
                let ends = [first, last + 1].map(|row| self.map.level(self.row(row)));
                let [[a, b], [d, c]] = ends;
                vec![a, b, c, d, a]
            };
            rows_of(self.swept.grid, run).into_iter().map(frame).collect()
        };
        layers.strips("setting/frame", palette::HERE, 1.3, runs().map(frame))?;
        let all = self.swept.names.len();
        let name = |run: usize| {
            let name = self.swept.names.get(run).map_or("", String::as_str);
            let text = format!("which settings agree; framed: {name} ({} of {all})", run + 1);
            Labels::one(self.map.above(self.map.middle(), TITLE), text)
        };
        layers.texts("setting/name", palette::HERE, runs().map(name))
    }

    /// The step under the cursor: a frame through all plots.
    fn add_step(&self, layers: &mut Layers<'_>) -> Result<(), RecordError> {
        let frame = |(x, _): (f64, &SweptStep)| {
            let side = |plot: &Plot| plot.column(x - 0.5, x + 0.5);
            [&self.delays, &self.sensitive, &self.map].map(side).to_vec()
        };
        layers.strips("step/frame", palette::HERE, 1.3, self.steps().map(frame))?;
        let name = |(x, step): (f64, &SweptStep)| {
            let mut labels = Labels::default();
            let text = format!("step {} at {:.2} s", step.number, step.time_s);
            labels.put_whole(self.map.above(x, TITLE), text);
            labels
        };
        layers.texts("step/name", palette::HERE, self.steps().map(name))
    }
}

/// Settings that report one delay of a step.
struct Group {
    delay: f64,
    opinion: Opinion,
    runs: Vec<usize>,
    votes: usize,
}

impl Group {
    fn all(swept: &Swept<'_>, step: &SweptStep) -> Vec<Self> {
        let mut groups: BTreeMap<(u64, Opinion), Self> = BTreeMap::new();
        for run in 0..step.delays.len() {
            let Some(delay) = Swept::delay(step, run) else { continue };
            let opinion = Swept::cell(step, run).opinion;
            let empty = Self { delay, opinion, runs: Vec::new(), votes: 0 };
            let group = groups.entry((delay.to_bits(), opinion)).or_insert(empty);
            group.runs.push(run);
            group.votes += swept.votes.get(run).copied().unwrap_or(0);
        }
        groups.into_values().collect()
    }

    /// The more settings report it, the larger it is; what disagrees is never small.
    fn radius(&self, step: &SweptStep) -> f32 {
        let share = self.votes as f32 / step.tried.max(1) as f32;
        let least = if self.opinion == Opinion::Same { 1.4 } else { 2.4 };
        least + 3.0 * share.sqrt()
    }

    /// What the pointer shows of it.
    fn name(&self, step: &SweptStep) -> String {
        let (seconds, votes) = (self.delay * step.period_s, self.votes);
        format!("step {}: {seconds:.3} s with {votes} of {} settings", step.number, step.tried)
    }

    /// Its settings.
    fn in_words(&self, swept: &Swept<'_>) -> String {
        let mut chosen = vec![false; swept.names.len()];
        for run in &self.runs {
            chosen.get_mut(*run).into_iter().for_each(|chosen| *chosen = true);
        }
        settings_in_words(swept.grid, &chosen)
    }
}

/// The range of the delays in seconds: all that are agreed on, and all others but for a few
/// that would flatten the plot. Those are drawn on its edge.
fn delay_span(swept: &Swept<'_>) -> Span {
    /// Part of the delays that may lie beyond each end.
    const BEYOND: f64 = 0.005;
    let steps = || swept.steps.iter().map(|(step, _)| *step);
    let of_step = |step: &SweptStep| {
        let known = step.delays.iter().flatten();
        known.map(|known| known.delay * step.period_s).collect::<Vec<_>>()
    };
    let delays: Vec<f64> = steps().flat_map(of_step).collect();
    let ends = [BEYOND, 1.0 - BEYOND].into_iter().filter_map(|part| quantile(&delays, part));
    let agreed = steps().filter_map(|step| Some(step.agreement?.delay * step.period_s));
    Span::around(ends.chain(agreed), 0.06)
}

/// The answer in a line, and what the colours mean.
fn legend(swept: &Swept<'_>) -> Labels {
    /// Row of the legend on the sheet.
    const LEGEND: f32 = 1088.0;
    let entries: [(f32, f32, String, Rgb); 6] = [
        (SHEET.0 / 2.0, 4.0, headline(swept), palette::BORDER),
        (330.0, LEGEND, "● as most settings say".to_owned(), palette::SAME),
        (570.0, LEGEND, "● longer".to_owned(), palette::LONGER),
        (720.0, LEGEND, "● shorter".to_owned(), palette::SHORTER),
        (930.0, LEGEND, "black: step not accepted".to_owned(), palette::BORDER),
        (1240.0, LEGEND, "– the delay that most agree on".to_owned(), palette::ACCEPTED),
    ];
    let mut labels = Labels::default();
    for (x, y, text, rgb) in entries {
        labels.put_in(rgb, Vec2D::new(x, y), text);
    }
    labels
}

fn headline(swept: &Swept<'_>) -> String {
    let name = &swept.reported.joint.name;
    let judged = swept.reported.sweep.judged().count();
    let settled = swept.reported.sweep.judged().filter(|step| step.is_unanimous()).count();
    match (judged, judged - settled) {
        (0, _) => format!("{name}: no step is accepted with any of the settings"),
        (_, 0) => format!("{name}: all {judged} delays are the same whatever the settings"),
        (_, 1) => {
            format!(
                "{name}: {settled} of {judged} delays are the same, 1 is sensitive to a setting"
            )
        }
        (_, sensitive) => format!(
            "{name}: {settled} of {judged} delays are the same, {sensitive} are sensitive to a setting"
        ),
    }
}
