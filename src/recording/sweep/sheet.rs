//! All steps of a joint at all settings: their delays, which setting they are sensitive to, and
//! which settings agree.

use std::collections::BTreeMap;

use rerun::datatypes::Vec2D;

use super::map::{Block, blocks, named, picture, rows_of};
use super::swept::{Opinion, Swept};
use crate::delay::sweep::{Factor, SweptStep};
use crate::figure::{Axis, Mark, Panel, Place, Role, Shape};
use crate::numerics::quantile;
use crate::recording::canvas::{LINE, Layers, Plot, SHEET, Span, width};
use crate::recording::chunk::Chunks;
use crate::recording::error::RecordError;
use crate::recording::palette::{self, Rgb, role};
use crate::recording::panels::{self, Placed};
use crate::recording::paths;
use crate::report::sweep::sweep_sentences;

/// Width and height of the sheet.
pub(in crate::recording) const SIZE: (f32, f32) = (SHEET.0, 1130.0);

/// Left and right ends of the plots: names stand on the left, counts on the right.
const SIDES: (f32, f32) = (250.0, SHEET.0 - 70.0);

/// Draws the page below `root`.
pub(super) fn add(chunks: &mut Chunks, swept: &Swept<'_>) -> Result<(), RecordError> {
    let page = Page::of(swept);
    let mut layers = Layers::fixed(chunks, paths::SHEET);
    let placed = [
        Placed::new(page.delays(), SIDES, 100.0..=390.0),
        Placed::new(page.causes(), SIDES, 466.0..=700.0),
        Placed::new(page.map(), SIDES, 804.0..=1066.0),
    ];
    let plots = [0, 1, 2].map(|place: usize| placed[place].plot);
    if let Some((image, place)) = picture(swept, &plots[2]) {
        layers.stays("map", &image)?;
        layers.stays("map", &place)?;
    }
    panels::add(&mut layers, [placed.into()])?;
    let name = &swept.reported.joint.name;
    let answer = sweep_sentences(swept.grid, &swept.reported).into_iter().next();
    // On what the others depend is said beside the drawing.
    let answer = answer.iter().filter_map(|answer| answer.split(". ").next()).map(|answer| {
        let answer = format!("{name}: {}", answer.trim_end_matches('.'));
        (Vec2D::new(SHEET.0 / 2.0, 4.0), answer, palette::BORDER)
    });
    layers.texts("answer", vec![answer.collect()])?;
    page.add_setting(&mut Layers::rows(chunks, paths::SHEET, swept.settings()).in_front(), plots)?;
    let mut rows = Layers::rows(chunks, paths::SHEET, swept.index.clone()).in_front();
    page.add_step(&mut rows, plots)
}

/// The three plots on their sheet, which share the axis of steps.
struct Page<'s> {
    swept: &'s Swept<'s>,
    x: Span,
    /// Rows of the map: a combination each, from the top down.
    rows: Span,
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
        let rows = Span::new(0.0, swept.grid.combinations().len().max(1) as f64);
        Self { swept, x, rows }
    }

    /// Each step with its place on the axis.
    fn steps(&self) -> impl Iterator<Item = (f64, &'s SweptStep)> {
        (1_u32..).map(f64::from).zip(self.swept.steps.iter().map(|(step, _)| *step))
    }

    /// Every delay that is reported, and what is agreed on.
    fn delays(&self) -> Panel {
        let (mut ranges, mut agreed) = (Vec::new(), Vec::new());
        for (x, step) in self.steps() {
            let y = |samples: f64| samples * step.period_s;
            ranges.extend(step.spread.map(|all| vec![(x, y(all.min)), (x, y(all.max))]));
            agreed.extend(
                step.agreement.map(|most| vec![(x - 0.4, y(most.delay)), (x + 0.4, y(most.delay))]),
            );
        }
        // A point for all settings that report one delay of a step.
        let groups = self.steps().flat_map(|(x, step)| {
            Group::all(self.swept, step).into_iter().map(move |group| (x, step, group))
        });
        let groups: Vec<(f64, &SweptStep, Group)> = groups.collect();
        let of_opinion = |(part, name, opinion): (&'static str, &str, Opinion)| {
            let own = groups.iter().filter(|(.., group)| group.opinion == opinion);
            let dots = own.map(|(x, step, group)| {
                ((*x, group.delay * step.period_s), group.radius(step), group.name(step))
            });
            Mark::new(role(opinion.rgb()), Shape::Named(dots.collect())).named(name).part(part)
        };
        let [same, longer, shorter] = [
            ("same", "as most settings say", Opinion::Same),
            ("longer", "longer", Opinion::Longer),
            ("shorter", "shorter", Opinion::Shorter),
        ]
        .map(of_opinion);
        let ranges = Mark::lines(Role::Grid, 1.0, ranges).part("range");
        let agreed = Mark::lines(Role::Accepted, 1.8, agreed).part("agreed");
        let agreed = agreed.named("the delay that most agree on");
        let name = "delay of each step, with every setting [s]";
        let (x, y) = (self.axis().bare(), Axis::new(delay_span(self.swept), name, 6.0));
        Panel { x, y, height: 190, marks: vec![ranges, same, longer, shorter, agreed] }
    }

    fn axis(&self) -> Axis {
        Axis::new(self.x, "", 12.0)
    }

    /// A mark for each step beside what it is sensitive to, and how many they are.
    fn causes(&self) -> Panel {
        let causes = Cause::all(self.swept);
        let names: Vec<String> = causes.iter().map(|(name, _)| name.clone()).collect();
        let slot = f64::from(SIDES.1 - SIDES.0) / (self.x.high - self.x.low);
        let mut counts = Vec::new();
        let rows = (0..).map(|row: u32| -f64::from(row)).zip(&causes);
        let mark = |(y, (_, cause)): (f64, &(String, Cause))| {
            let sensitive = self.steps().filter(|(_, step)| cause.moves(step));
            let places: Vec<Place> = sensitive.map(|(x, _)| (x, y)).collect();
            counts.push(((self.x.high, y), places.len().to_string()));
            let dots = Shape::Dots(places, (0.5 * slot).min(7.0));
            Mark::new(role(cause.rgb()), dots).part("hanging")
        };
        let mut marks: Vec<Mark> = rows.map(mark).collect();
        marks.push(Mark::new(Role::Ink, Shape::Words(counts)).part("counts"));
        let x = Axis { name: "steps sensitive to".to_owned(), ..self.axis().bare() };
        Panel { x, y: Axis::of_names(&names, ""), height: 150, marks }
    }

    /// What is around the picture of all settings and steps: borders between its rows, and their names.
    fn map(&self) -> Panel {
        let (methods, low_passes) = blocks(self.swept.grid);
        let border = |block: &Block| {
            let row = self.row(block.first);
            vec![(self.x.low, row), (self.x.high, row)]
        };
        let lines = |blocks: &[Block]| blocks.iter().map(border).collect();
        let marks = vec![
            Mark::lines(Role::Grid, 0.8, lines(&low_passes)).part("blocks"),
            Mark::lines(Role::Ink, 0.8, lines(&methods)).part("blocks"),
        ];
        let name = |block: Block| {
            (self.rows.high - block.first as f64 - 0.5 * block.count as f64, block.label)
        };
        let ticks = named(self.swept.grid).into_iter().map(name).collect();
        let name = "which settings agree; black: step not accepted".to_owned();
        let y = Axis { ticks, ..Axis::new(self.rows, name, 1.0) };
        Panel { x: Axis { name: "step".to_owned(), ..self.axis() }, y, height: 180, marks }
    }

    /// The upper edge of a row.
    fn row(&self, row: usize) -> f64 {
        self.rows.high - row as f64
    }

    /// The setting under the cursor: its delays, its rows, its name.
    fn add_setting(
        &self,
        layers: &mut Layers<'_>,
        [delays, _, map]: [Plot; 3],
    ) -> Result<(), RecordError> {
        let runs = || 0..self.swept.names.len();
        let row = |run: usize| {
            let place =
                |(x, step): (f64, &SweptStep)| Some((x, Swept::delay(step, run)? * step.period_s));
            let dots = Shape::Dots(self.steps().filter_map(place).collect(), 4.0);
            let frame = |(first, last): (usize, usize)| {
                rectangle((self.x.low, self.row(first)), (self.x.high, self.row(last + 1)))
            };
            let frames = rows_of(self.swept.grid, run).into_iter().map(frame).collect();
            let here = role(palette::HERE);
            vec![
                (Mark::new(here, dots).part("setting/delays"), delays),
                (Mark::lines(here, 1.3, frames).part("setting/frame"), map),
            ]
        };
        panels::add_marks(layers, runs().map(row))?;
        let all = self.swept.names.len();
        let name = |run: usize| {
            let name = self.swept.names.get(run).map_or("", String::as_str);
            let text = format!("framed: {name} ({} of {all})", run + 1);
            let at = Vec2D::new(map.left + 0.5 * width(&text), map.top - 2.0 * LINE);
            vec![(at, text, palette::HERE)]
        };
        layers.texts("setting/name", runs().map(name).collect())
    }

    /// The step under the cursor: a frame through all plots.
    fn add_step(&self, layers: &mut Layers<'_>, plots: [Plot; 3]) -> Result<(), RecordError> {
        let row = |(x, _): (f64, &SweptStep)| {
            let frame = |plot: Plot| {
                let Span { low, high } = plot.y_span;
                let frame = vec![rectangle((x - 0.5, low), (x + 0.5, high))];
                (Mark::lines(role(palette::HERE), 1.3, frame).part("step/frame"), plot)
            };
            plots.map(frame).to_vec()
        };
        panels::add_marks(layers, self.steps().map(row))?;
        let map = plots[2];
        let name = |(_, step): (f64, &SweptStep)| {
            let text = format!("framed: step {} at {:.2} s", step.number, step.time_s);
            let at = Vec2D::new(map.right - 0.5 * width(&text), map.top - 2.0 * LINE);
            vec![(at, text, palette::HERE)]
        };
        layers.texts("step/name", self.steps().map(name).collect())
    }
}

/// The line about an area.
fn rectangle((left, low): Place, (right, high): Place) -> Vec<Place> {
    vec![(left, low), (right, low), (right, high), (left, high), (left, low)]
}

/// Settings that report one delay of a step.
struct Group {
    delay: f64,
    opinion: Opinion,
    votes: usize,
}

impl Group {
    fn all(swept: &Swept<'_>, step: &SweptStep) -> Vec<Self> {
        let mut groups: BTreeMap<(u64, Opinion), Self> = BTreeMap::new();
        for run in 0..step.delays.len() {
            let Some(delay) = Swept::delay(step, run) else { continue };
            let opinion = Swept::cell(step, run).opinion;
            let empty = Self { delay, opinion, votes: 0 };
            let group = groups.entry((delay.to_bits(), opinion)).or_insert(empty);
            group.votes += swept.votes.get(run).copied().unwrap_or(0);
        }
        groups.into_values().collect()
    }

    /// The more settings report it, the larger it is; what disagrees is never small.
    fn radius(&self, step: &SweptStep) -> f64 {
        let share = self.votes as f64 / step.tried.max(1) as f64;
        let least = if self.opinion == Opinion::Same { 1.4 } else { 2.4 };
        least + 3.0 * share.sqrt()
    }

    /// What the pointer shows of it.
    fn name(&self, step: &SweptStep) -> String {
        let (seconds, votes) = (self.delay * step.period_s, self.votes);
        format!("step {}: {seconds:.3} s with {votes} of {} settings", step.number, step.tried)
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
