//! The views of one joint: its decisions, its record, its table.

use rerun::EntityPath;
use rerun::components::{Range1D, Visible};
use rerun::datatypes::{TimeRange, TimeRangeBoundary, Utf8};
use rerun::external::re_sdk_types::blueprint::archetypes::{
    DataframeQuery, PlotLegend, ScalarAxis, TimeAxis,
};
use rerun::external::re_sdk_types::blueprint::components::{ContainerKind, Corner2D, LinkAxis};
use rerun::external::re_sdk_types::blueprint::datatypes::{
    ComponentColumnSelector, SelectedColumns,
};

use crate::delay::{Condition, Decision, Doubt};
use crate::experiment::Joint;
use crate::recording::blueprint::{Builder, Node, View, bounds, clickable};
use crate::recording::canvas::SHEET;
use crate::recording::error::RecordError;
use crate::recording::overview::{LARGE_HEIGHT, MAP_HEIGHT, MAP_WIDTH};
use crate::recording::palette;
use crate::recording::paths::revision::{record, share, sheet};
use crate::recording::paths::{
    self, against, at, child, correlation, differing, drawing, joint_root, map, of_model,
};
use crate::recording::{
    correlogram, delay_state, difference, error_share, revision, scatter, segment_view,
};
use crate::report::{ComparedJoint, EstimatedJoint, JointSummary, by_doubt};
use crate::wording::number;

/// What the lanes of the model that is judged are called.
const LANES: &str =
    "Where the error of its speed arises; what was not fitted; worst segments (1 first)";

/// What plots along the record are called: they are empty on timelines that have no samples.
const ALONG: &str = "Along sample, time or decision";

/// Numbers of the models that are drawn beside the measurement: of many revisions of one model the
/// first and the last, since what came between is on the page of the revisions.
fn drawn(models: usize, revisions: usize) -> Vec<usize> {
    if revisions > 0 && models > palette::NAMED {
        vec![0, models - 1]
    } else {
        (0..models).collect()
    }
}

/// The tab of `joint`: its decisions, its record, its table; and before them the revisions
/// of its model, and its models, where there are any.
pub(super) fn tab(
    builder: &mut Builder<'_>,
    EstimatedJoint { joint, estimate }: EstimatedJoint<'_>,
    models: &[&ComparedJoint<'_>],
    revisions: usize,
    others: usize,
) -> Result<Node, RecordError> {
    let mut decisions = estimate.estimated().flat_map(|trial| &trial.decisions);
    let fine = decisions.any(|decision| decision.fine.is_some());
    let doubts = by_doubt(EstimatedJoint { joint, estimate });
    let open = doubts.iter().filter(|found| found.decision.reviewer_verdict.is_none());
    let doubtful = open.filter(|found| found.doubt.is_doubtful()).count();
    let limit = number(Doubt::DOUBTFUL_PERCENT);
    let doubtful = format!("{doubtful} of {} doubtful (≥ {limit} %): click", doubts.len());
    let decisions = estimate.estimated().flat_map(|trial| &trial.decisions);
    let longest = decisions.filter_map(Decision::accepted_delay).reduce(f64::max);
    let verdicts = verdicts(&JointSummary::of(EstimatedJoint { joint, estimate }));
    let mut views = Views { builder, joint, fine, longest, doubtful, verdicts, others, revisions };
    let mut pages = Vec::new();
    if revisions > 0 {
        pages.push(views.revisions()?);
    }
    if !models.is_empty() {
        pages.push(views.models(models)?);
    }
    if others > 0 {
        pages.push(views.differences()?);
    }
    if doubts.is_empty() {
        let title = match &estimate.dead_time {
            Some(found) if found.varies() => "The dead time varies",
            Some(_) => "Dead time",
            None => "No steps",
        };
        pages.push(views.without_steps(title)?);
    } else {
        let delay = views.delay_state();
        let delay = views.view(delay)?;
        pages.extend([views.decisions()?, views.record(Steps::Some)?, delay, views.table()?]);
    }
    views.builder.container(ContainerKind::Tabs, &joint.name, &pages, &[])
}

/// Where a plot says what its curves are: a legend covers data.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Legend {
    InTitle,
    Apart,
}

/// Whether the input has steps, or moves all the time.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Steps {
    Some,
    None,
}

impl Steps {
    /// What the plots of output and delay, and the lanes below them, show.
    fn titles(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::Some => (
                "Output: measured grey, smoothed blue; chosen lines orange and green; breakpoints: \
                 dot accepted, cross rejected",
                "Delay [samples], up to the longest accepted: dot accepted, cross rejected",
                "Steps and verdicts",
            ),
            Self::None => (
                "Output: measured grey, smoothed blue",
                "Dead time of each window [samples]",
                "Trials",
            ),
        }
    }
}

/// `28 accepted · 26 rejected: at_rest 25 (joint at rest, before and after), before_input 1 (…)`, the most
/// frequent reasons first.
fn verdicts(summary: &JointSummary) -> String {
    /// Reasons that are named.
    const MOST: usize = 2;
    let mut rejected = summary.rejected.clone();
    rejected.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let reason = |(condition, count): &(Condition, usize)| {
        format!("{condition} {count} ({})", condition.meaning())
    };
    let mut reasons: Vec<String> = rejected.iter().take(MOST).map(reason).collect();
    if rejected.len() > MOST {
        reasons.push("…".to_owned());
    }
    let accepted = format!("{} ✓ accepted", summary.accepted);
    match summary.steps - summary.accepted {
        0 => format!("{accepted} · none rejected"),
        count => format!("{accepted} · {count} ✗ rejected: {}", reasons.join(", ")),
    }
}

/// Lanes start with all of the record in view: viewers from 0.41 on begin in its middle.
fn whole_record() -> TimeAxis {
    let infinite = TimeRangeBoundary::Infinite;
    TimeAxis::new().with_view_range(TimeRange { start: infinite, end: infinite })
}

/// Scalars over the timeline.
fn plotted<'n>(name: &'n str, entities: &[EntityPath], legend: Legend) -> View<'n> {
    let paths: Vec<_> = entities.iter().map(ToString::to_string).collect();
    let shown = Visible::from(legend == Legend::Apart);
    // What a model was not fitted to lies at the right.
    let legend = PlotLegend::new().with_corner(Corner2D::LeftTop).with_visible(shown);
    View::new("TimeSeries", name, &paths)
        .with("TimeAxis", TimeAxis::new().with_link(LinkAxis::LinkToGlobal))
        .with("PlotLegend", legend)
}

struct Views<'b, 'i> {
    builder: &'b mut Builder<'i>,
    joint: &'b Joint,
    /// Whether some delay is known between samples.
    fine: bool,
    /// The longest delay that was accepted, samples.
    longest: Option<f64>,
    /// How many decisions are doubtful, over their list.
    doubtful: String,
    /// How many steps were accepted and why others were rejected, over the lanes that say of which.
    verdicts: String,
    /// Results beside this one.
    others: usize,
    /// Revisions of its model.
    revisions: usize,
}

/// Columns of the table of candidates, in the order in which a viewer shows them.
const CANDIDATE_COLUMNS: [&str; 7] =
    ["breakpoint", "delay_s", "error", "error_rank", "error_times_least", "i", "verdict"];

impl Views<'_, '_> {
    /// The entity at `path` below the joint.
    fn at(&self, path: &str) -> EntityPath {
        at(&joint_root(&self.joint.name), path)
    }

    /// That entity as a query.
    fn path(&self, path: &str) -> String {
        self.at(path).to_string()
    }

    fn view(&mut self, view: View<'_>) -> Result<Node, RecordError> {
        self.builder.view(view)
    }

    /// What a reviewer steps through.
    fn decisions(&mut self) -> Result<Node, RecordError> {
        let headline = [self.path(paths::HEADLINE)];
        let headline = self.view(View::new("TextDocument", "What was found", &headline))?;
        let drawing = self.view(self.drawing())?;
        let map = self.view(self.map())?;
        // The verdict names the trial: a lane for it would hide that of the verdicts in a small window.
        let name = self.verdicts.clone();
        let lanes = self.view(self.lanes(&name, &[paths::VERDICT, paths::SEGMENT]))?;
        let verdict = [self.path(paths::VERDICT)];
        let verdict = self.view(View::new("TextDocument", "Verdict", &verdict))?;
        let lists = self.lists()?;
        let left = [drawing, map, lanes];
        let builder = &mut *self.builder;
        let left =
            builder.container(ContainerKind::Vertical, "Segment", &left, &[6.3, 2.1, 2.3])?;
        let right = [verdict, lists];
        let right = builder.container(ContainerKind::Vertical, "Verdicts", &right, &[7.2, 2.8])?;
        let columns = [left, right];
        let columns =
            builder.container(ContainerKind::Horizontal, "Steps", &columns, &[6.8, 3.2])?;
        let rows = [headline, columns];
        builder.container(ContainerKind::Vertical, "Decisions", &rows, &[1.3, 8.7])
    }

    fn drawing(&self) -> View<'static> {
        let others: Vec<_> = (0..self.others).flat_map(drawing::of_method).collect();
        let first = [drawing::FIRST_ACCEPTED, drawing::FIRST_REJECTED].into_iter();
        let first = first.filter(|_| self.others > 0);
        let interval = self.fine.then_some(drawing::INTERVAL);
        let others = others.iter().map(String::as_str);
        let parts: Vec<_> =
            drawing::PARTS.into_iter().chain(others).chain(first).chain(interval).collect();
        let name = "The segment and its candidates; close-up: samples, Algorithm 1 white with 95 % of the noise";
        View::drawing(name, &self.at(drawing::ROOT), &parts, segment_view::SIZE)
    }

    fn map(&self) -> View<'static> {
        let name = "Whole record: the framed segment is shown above";
        View::drawing(name, &self.at(map::ROOT), &map::PARTS, (MAP_WIDTH, MAP_HEIGHT))
    }

    fn lanes<'n>(&self, name: &'n str, lanes: &[&str]) -> View<'n> {
        let paths: Vec<_> = lanes.iter().map(|lane| self.path(lane)).collect();
        View::new("StateTimeline", name, &paths).with("TimeAxis", whole_record())
    }

    /// The decisions by doubt, in their order, and by doubt with the reasons.
    fn lists(&mut self) -> Result<Node, RecordError> {
        let (title, path) = (self.doubtful.clone(), self.path(paths::DOUBT_LOG));
        let doubtful = self.list(&title, path, "doubt")?;
        let path = self.path(paths::VERDICT_LOG);
        let all = self.list("All: click a number", path, "decision")?;
        let why = [self.path(paths::DOUBT)];
        let why = self.view(View::new("TextDocument", "Doubts", &why))?;
        let tabs = [doubtful, all, why];
        self.builder.container(ContainerKind::Tabs, "Lists", &tabs, &[])
    }

    /// Lines with numbers on `timeline` that lead there.
    fn list(
        &mut self,
        name: &str,
        path: String,
        timeline: &'static str,
    ) -> Result<Node, RecordError> {
        let view = View::new("TextLog", name, &[path]);
        self.view(view.with("TextLogColumns", clickable(timeline)))
    }

    /// Where the decisions differ from those of other results, the most different first.
    fn differences(&mut self) -> Result<Node, RecordError> {
        let root = self.at(differing::ROOT);
        let name = "Delays here and there, and their difference";
        let sheet = self.view(View::drawing(name, &root, &differing::PARTS, difference::SIZE))?;
        let drawing = self.view(self.drawing())?;
        let verdict = [self.path(paths::VERDICT)];
        let verdict = self.view(View::new("TextDocument", "Verdict", &verdict))?;
        let list = [self.path(paths::DIFFERENCE_LOG)];
        let list = View::new("TextLog", "Most different first: click a number", &list);
        let list = self.view(list.with("TextLogColumns", clickable("difference")))?;
        let page = [self.path(paths::DIFFERENCE)];
        let page = self.view(View::new("TextDocument", "In words", &page))?;
        let right = [page, list, verdict];
        let builder = &mut *self.builder;
        let right =
            builder.container(ContainerKind::Vertical, "Lists", &right, &[2.3, 2.7, 5.0])?;
        let left = [sheet, drawing];
        let left = builder.container(ContainerKind::Vertical, "Steps", &left, &[3.6, 6.4])?;
        let columns = [left, right];
        builder.container(ContainerKind::Horizontal, "Differences", &columns, &[6.6, 3.4])
    }

    /// A line that says where the cursor is, or where to click.
    fn place(&mut self) -> Result<Node, RecordError> {
        let place = [self.path(paths::PLACE)];
        self.view(View::new("TextDocument", "Where the cursor is", &place))
    }

    /// The whole record on the time axis.
    fn record(&mut self, steps: Steps) -> Result<Node, RecordError> {
        let (output, delay, lanes) = steps.titles();
        let input = self.plot("Input", &[self.at(paths::INPUT)], Legend::InTitle)?;
        let output = self.plot(
            output,
            &[
                paths::OUTPUT_RAW,
                paths::OUTPUT_SMOOTHED,
                paths::LINE_BEFORE,
                paths::LINE_AFTER,
                paths::BREAKPOINT_ACCEPTED,
                paths::BREAKPOINT_REJECTED,
            ]
            .map(|path| self.at(path)),
            Legend::InTitle,
        )?;
        let delays = [paths::TAU, paths::DELAY_ACCEPTED, paths::DELAY_REJECTED];
        let delay = plotted(delay, &delays.map(|path| self.at(path)), Legend::InTitle);
        // One rejected at the end of a long hold would press the others to the axis.
        let delay = self.view(match self.longest.filter(|longest| *longest > 0.0) {
            Some(longest) => {
                let range = Range1D::new(-0.1 * longest, 1.2 * longest);
                delay.with("ScalarAxis", ScalarAxis::new().with_range(range))
            }
            None => delay,
        })?;
        let mut rows = vec![input, output, delay];
        let mut shares = vec![1.1, 3.1, 1.6];
        if !self.joint.covariates.is_empty() {
            let root = self.at(paths::COVARIATE);
            let all = self.joint.covariates.iter().map(|signal| child(&root, &signal.name));
            rows.push(self.plot("Covariates", &all.collect::<Vec<_>>(), Legend::Apart)?);
            shares.push(1.5);
        }
        let mut shown = vec![paths::VERDICT, paths::SEGMENT];
        if self.joint.trials.len() > 1 {
            shown.push(paths::TRIAL);
        }
        rows.push(self.view(self.lanes(lanes, &shown))?);
        shares.push(if self.joint.trials.len() > 1 { 2.6 } else { 2.1 });
        let plots = self.builder.container(ContainerKind::Vertical, ALONG, &rows, &shares)?;
        let size = (MAP_WIDTH, LARGE_HEIGHT);
        let name = match steps {
            Steps::Some => "Whole record, on every timeline: the framed step is under the cursor",
            Steps::None => "Whole record, on every timeline",
        };
        let map = View::drawing(name, &self.at(map::LARGE), &map::PARTS, size);
        let map = self.view(map)?;
        let tabs = self.builder.container(ContainerKind::Tabs, "Record", &[map, plots], &[])?;
        let rows = [self.place()?, tabs];
        self.builder.container(ContainerKind::Vertical, "Record", &rows, &[1.1, 8.9])
    }

    /// The record of a joint without steps, and in words why there are none, and its dead time.
    fn without_steps(&mut self, title: &'static str) -> Result<Node, RecordError> {
        let record = self.record(Steps::None)?;
        let words = [self.path(paths::VERDICT)];
        let words = self.view(View::new("TextDocument", title, &words))?;
        let columns = [record, words];
        self.builder.container(ContainerKind::Horizontal, title, &columns, &[7.0, 3.0])
    }

    /// The delay against what it may depend on.
    fn delay_state(&self) -> View<'static> {
        let size = (SHEET.0, delay_state::HEIGHT);
        View::drawing("Delay", &self.at(against::ROOT), &against::PARTS, size)
    }

    /// A model as it grows.
    fn revisions(&mut self) -> Result<Node, RecordError> {
        let root = self.at(paths::revision::ROOT);
        let drawing =
            |name, path, parts: &[&str], size| View::drawing(name, &at(&root, path), parts, size);
        let name = "The error falls; what shows it; what was tried";
        let sheet = drawing(name, sheet::ROOT, &sheet::PARTS, revision::SIZE);
        let name =
            "Where the error of the speed arises: its share (bars), share of the time (white)";
        let share = drawing(name, share::ROOT, &share::PARTS, error_share::SIZE);
        let name = "The whole record";
        let record = drawing(name, record::ROOT, &record::PARTS, revision::RECORD_SIZE);
        let words = [at(&root, paths::revision::WORDS).to_string()];
        let words = self.view(View::new("TextDocument", "In words", &words))?;
        let parameters = [at(&root, paths::revision::PARAMETERS).to_string()];
        let parameters = self.view(View::new("TextDocument", "Parameters", &parameters))?;
        let tabs = [self.view(sheet)?, self.view(share)?];
        let record = self.view(record)?;
        let builder = &mut *self.builder;
        let tabs = builder.container(ContainerKind::Tabs, "Ladder", &tabs, &[])?;
        let left = [tabs, record];
        let left = builder.container(ContainerKind::Vertical, "Drawings", &left, &[4.4, 5.6])?;
        let right = builder.container(ContainerKind::Tabs, "Texts", &[words, parameters], &[])?;
        let columns = [left, right];
        builder.container(ContainerKind::Horizontal, "Revisions", &columns, &[7.3, 2.7])
    }

    /// Models beside the measurement, and their residuals.
    fn models(&mut self, models: &[&ComparedJoint<'_>]) -> Result<Node, RecordError> {
        let shown = drawn(models.len(), self.revisions);
        let names: Vec<&str> =
            shown.iter().filter_map(|number| Some(models.get(*number)?.model)).collect();
        let root = self.at(paths::MODEL);
        let of_each = |part| names.iter().map(|name| at(&child(&root, name), part)).collect();
        let horizon = models.first().map(|model| model.comparison.fit.evaluation.horizon);
        let horizon = horizon.unwrap_or_default();
        let simulated: Vec<_> = of_each(paths::SIMULATED);
        let residuals: Vec<_> = of_each(paths::RESIDUAL);
        let outputs = [vec![self.at(paths::OUTPUT_RAW)], simulated].concat();
        // A model keeps its colour where others are not drawn.
        let colors: Vec<&str> = shown.iter().map(|number| palette::name(*number)).collect();
        let (legend, colors) = match colors.len() {
            ..=palette::NAMED => {
                let own = names.iter().zip(colors);
                let own: Vec<_> = own.map(|(name, color)| format!("{name} {color}")).collect();
                (Legend::InTitle, format!(": measured grey, {}", own.join(", ")))
            }
            _ => (Legend::Apart, String::new()),
        };
        let noise = [paths::NOISE_UPPER, paths::NOISE_LOWER].map(|path| self.at(path));
        let residuals = [noise.to_vec(), residuals].concat();
        let plots = [
            self.plot(&format!("Measured and simulated{colors}"), &outputs, legend)?,
            self.plot(
                &format!("Residual ({horizon}); 95 % of the noise lies in the band"),
                &residuals,
                legend,
            )?,
            self.plot("Input", &[self.at(paths::INPUT)], Legend::InTitle)?,
            self.lanes_of_models(models)?,
        ];
        let builder = &mut *self.builder;
        let shares = [2.3, 1.8, 1.5, 2.9];
        let plots = builder.container(ContainerKind::Vertical, ALONG, &plots, &shares)?;
        let map = self.view(self.map_of_model())?;
        // Models side by side are compared in the plots: the map is of the first one alone.
        let tabs =
            if models.len() > 1 && self.revisions == 0 { [plots, map] } else { [map, plots] };
        let rows = [
            self.place()?,
            self.builder.container(ContainerKind::Tabs, "Record", &tabs, &[])?,
            self.residuals(&names, &shown)?,
        ];
        let builder = &mut *self.builder;
        let plots = builder.container(ContainerKind::Vertical, "Plots", &rows, &[1.3, 7.2, 3.5])?;
        let mut pages = Vec::new();
        for (name, path) in [
            ("Models", paths::MODEL_PAGE),
            ("Worst", paths::MODEL_WORST),
            ("Parameters", paths::MODEL_PARAMETERS),
        ] {
            pages.push(self.view(View::new("TextDocument", name, &[self.path(path)]))?);
        }
        let pages = self.builder.container(ContainerKind::Tabs, "Texts", &pages, &[])?;
        let columns = [plots, pages];
        self.builder.container(ContainerKind::Horizontal, "Models", &columns, &[7.2, 2.8])
    }

    /// What is measured, simulated and left, on every timeline.
    fn map_of_model(&self) -> View<'static> {
        let root = if self.revisions > 0 {
            at(&self.at(paths::revision::ROOT), record::ROOT)
        } else {
            self.at(paths::MODEL_MAP)
        };
        let name = "Whole record, on every timeline";
        View::drawing(name, &root, &record::PARTS, revision::RECORD_SIZE)
    }

    /// The worst segments, what was not fitted to, and where the model fails.
    fn lanes_of_models(&mut self, models: &[&ComparedJoint<'_>]) -> Result<Node, RecordError> {
        let mut paths = vec![self.path(paths::WORST)];
        let has = |fits: fn(&ComparedJoint<'_>) -> bool| models.iter().any(|model| fits(model));
        if has(|model| !model.comparison.per_step.is_empty()) {
            paths.push(self.path(paths::PART));
        }
        if has(|model| model.comparison.failure.is_some()) {
            paths.push(self.path(paths::FAILS));
        }
        self.view(View::new("StateTimeline", LANES, &paths).with("TimeAxis", whole_record()))
    }

    /// Which of several models is better, along the record.
    fn model_difference(&mut self, names: &[&str]) -> Result<Node, RecordError> {
        let root = self.at(paths::MODEL_DIFFERENCE);
        let others: Vec<_> = names.iter().skip(1).map(|name| child(&root, name)).collect();
        let first = names.first().copied().unwrap_or_default();
        let name =
            format!("Squared error so far less that of {first}: it rises where {first} is better");
        self.plot(&name, &others, Legend::Apart)
    }

    /// What the residual depends on, in three drawings.
    fn residuals(&mut self, names: &[&str], shown: &[usize]) -> Result<Node, RecordError> {
        let scatter = self.sheet(
            ("Residual against four quantities: points, and their mean", scatter::SIZE),
            (paths::scatter::ROOT, &paths::scatter::PARTS),
            (&[paths::scatter::CURVE], shown),
        );
        let shares = self.sheet(
            ("Share of the error: bars; of the time: white", error_share::SIZE),
            (paths::error_share::ROOT, &paths::error_share::PARTS),
            (&[paths::error_share::BARS], shown),
        );
        let correlation = self.sheet(
            ("Correlation: that of noise stays between the lines (99 %)", correlogram::SIZE),
            (correlation::ROOT, &correlation::PARTS),
            (&[correlation::BAND, correlation::CURVE], shown),
        );
        let mut tabs = Vec::new();
        if names.len() > 1 && self.revisions == 0 {
            tabs.push(self.model_difference(names)?);
        }
        tabs.extend([self.view(scatter)?, self.view(shares)?, self.view(correlation)?]);
        self.builder.container(ContainerKind::Tabs, "Residual", &tabs, &[])
    }

    /// A drawing of `parts`, and of `of_models` for each of the models of these numbers.
    fn sheet(
        &self,
        (name, (width, height)): (&'static str, (f32, f32)),
        (root, parts): (&str, &[&str]),
        (of_models, models): (&[&str], &[usize]),
    ) -> View<'static> {
        let root = self.at(root);
        let mut paths: Vec<_> = parts.iter().map(|part| at(&root, part).to_string()).collect();
        for part in of_models {
            let of_model = |number: &usize| of_model(&root, part, *number).to_string();
            paths.extend(models.iter().map(of_model));
        }
        View::new("2D", name, &paths).with("VisualBounds2D", bounds(width, height))
    }

    /// A plot whose time axis moves with those of the other plots.
    fn plot(
        &mut self,
        name: &str,
        entities: &[EntityPath],
        legend: Legend,
    ) -> Result<Node, RecordError> {
        self.view(plotted(name, entities, legend))
    }

    /// Every number: a row per decision, and a row per candidate.
    fn table(&mut self) -> Result<Node, RecordError> {
        let entity = self.at(paths::DECISION_TABLE);
        let path = entity.to_string();
        let query = |columns: &[&str]| {
            let select = |name: &&str| ComponentColumnSelector::new(&entity, (*name).to_owned());
            let select = SelectedColumns {
                time_columns: vec![Utf8::from("decision")],
                component_columns: columns.iter().map(select).collect(),
            };
            DataframeQuery::new()
                .with_timeline("decision")
                .with_auto_scroll(true)
                .with_select(select)
        };
        let page = [self.path(paths::DECISION_PAGE)];
        let decisions = self.view(View::new("TextDocument", "Decisions", &page))?;
        let candidates = View::new("Dataframe", "Candidates", &[&path]);
        let candidates = candidates.with("DataframeQuery", query(&CANDIDATE_COLUMNS));
        let candidates = self.view(candidates)?;
        let rows = [decisions, candidates];
        self.builder.container(ContainerKind::Horizontal, "Table", &rows, &[1.15, 0.85])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_revisions_the_first_and_the_last_are_drawn() {
        assert_eq!(drawn(9, 9), [0, 8]);
        assert_eq!(drawn(3, 3), [0, 1, 2]);
        // Models side by side are all looked at.
        assert_eq!(drawn(5, 0), [0, 1, 2, 3, 4]);
    }
}
