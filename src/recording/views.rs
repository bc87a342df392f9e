//! Which view shows what of a recording of decisions and models: a tab per joint, and the timeline the
//! viewer opens on.

use rerun::EntityPath;
use rerun::components::{Range1D, Visible};
use rerun::datatypes::Utf8;
use rerun::external::re_sdk_types::blueprint::archetypes::{
    DataframeQuery, PlotLegend, ScalarAxis,
};
use rerun::external::re_sdk_types::blueprint::components::Corner2D;
use rerun::external::re_sdk_types::blueprint::datatypes::{
    ComponentColumnSelector, SelectedColumns,
};

use super::blueprint::{Blueprint, Page};
use super::canvas::{SHEET, TAB};
use super::overview::{LARGE_HEIGHT, MAP_HEIGHT};
use super::paths::{self, at, child, joint_root, of_model};
use super::{delay_state, difference, model, palette, segment_view};
use crate::delay::{Decision, Doubt};
use crate::diagnosis::Comparison;
use crate::experiment::Joint;
use crate::report::decisions::{by_doubt, doubtful_lines};
use crate::report::estimate::summary_cells;
use crate::report::{ComparedJoint, EstimatedJoint, ImprovedJoint, JointSummary, Recording};
use crate::wording::number;

/// What decides which views there are.
pub(super) fn in_words(recording: &Recording<'_>) -> String {
    let name = |joint: &EstimatedJoint<'_>| match joint.estimate.dead_time {
        Some(_) => format!("{} without steps", joint.joint.name),
        None => joint.joint.name.clone(),
    };
    let joints: Vec<_> = recording.joints.iter().map(name).collect();
    let models: Vec<_> = recording.models.iter().map(|m| (&m.joint.name, m.model)).collect();
    let revised: Vec<_> = recording.revisions.iter().map(ImprovedJoint::name).collect();
    format!("{joints:?} {models:?} {revised:?}")
}

/// A tab per joint and one about it all.
pub(super) fn blueprint(recording: &Recording<'_>) -> Blueprint {
    let tab = |joint: &EstimatedJoint<'_>| {
        let name = &joint.joint.name;
        let models = recording.models.iter().filter(|m| m.joint.name == *name).collect();
        let improved = recording.revisions_of(joint.joint);
        let revisions = improved.map_or(0, |improved| improved.revisions.len());
        let is_compared = recording.also.iter().any(|it| it.joint(name).is_some());
        Tab { estimated: *joint, models, revisions, is_compared }.page()
    };
    // One revision alone is there on every timeline.
    let is_ladder = recording.revisions.iter().any(|improved| improved.revisions.len() > 1);
    let has_steps = recording.joints.iter().any(|joint| joint.estimate.dead_time.is_none());
    let timeline = if is_ladder {
        "revision"
    } else if !recording.also.is_empty() {
        "difference"
    } else if !has_steps || !recording.models.is_empty() {
        // A model is seen along its record.
        "time"
    } else {
        "decision"
    };
    let tabs = recording.joints.iter().map(tab).collect();
    Blueprint { tabs, about: about(recording), timeline }
}

/// The name of the page on it all: of one joint how many steps were accepted, of several how many
/// decisions are doubtful, which no page of a joint says.
fn about(recording: &Recording<'_>) -> String {
    match (recording.joints.len(), doubtful_lines(recording.joints).len()) {
        (0 | 1, _) => match recording.joints.first().map(|joint| JointSummary::of(*joint)) {
            Some(JointSummary { steps, accepted, .. }) if steps > 0 => {
                format!("About: {accepted} of {steps} accepted")
            }
            _ => "About".to_owned(),
        },
        (_, 0) if !recording.joints.iter().any(has_decisions) => {
            "All joints: no decisions".to_owned()
        }
        (_, 0) => "All joints: none doubtful".to_owned(),
        (_, doubtful) => format!("All joints: {doubtful} doubtful"),
    }
}

fn has_decisions(joint: &EstimatedJoint<'_>) -> bool {
    joint.estimate.estimated().any(|trial| !trial.decisions.is_empty())
}

/// What the lanes of the model that is judged are called.
const LANES: &str =
    "Where the error of its speed arises; validation part; worst segments (1 first)";

/// What plots along the record are called: they are empty on timelines that have no samples.
const ALONG: &str = "Along sample, time or decision";

/// A drawing: its name, its path, the parts that each model has, and its size.
type Drawing = (&'static str, &'static str, &'static [&'static str], (f32, f32));

/// What the residual of models depends on.
#[rustfmt::skip]
const DRAWINGS: [Drawing; 3] = [
    ("Residual against four quantities: points, and their mean", paths::SCATTER, &["lines"], TAB),
    ("Share of the error: bars; of the time: white", paths::ERROR_SHARE, &["squared_error"], TAB),
    ("Correlation: 99 % of noise lies between the lines", paths::CORRELATION, &["band", "lines"], TAB),
];

/// Where a plot says what its curves are: a legend covers data.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Legend {
    InTitle,
    Apart,
}

/// Scalars over the timeline.
fn plot(name: impl Into<String>, entities: &[EntityPath], legend: Legend) -> Page {
    let shown = Visible::from(legend == Legend::Apart);
    // What a model was not fitted to lies at the right.
    let legend = PlotLegend::new().with_corner(Corner2D::LeftTop).with_visible(shown);
    Page::plot(name, entities).with("PlotLegend", legend)
}

/// The tab of a joint: its decisions, its record, its table; and before them the revisions
/// of its model, and its models, where there are any.
struct Tab<'t> {
    estimated: EstimatedJoint<'t>,
    models: Vec<&'t ComparedJoint<'t>>,
    /// Revisions of its model.
    revisions: usize,
    /// Whether there are results beside this one.
    is_compared: bool,
}

impl Tab<'_> {
    fn page(&self) -> Page {
        let mut pages = Vec::new();
        if self.revisions > 0 {
            pages.push(self.revisions());
        }
        if !self.models.is_empty() {
            pages.push(self.models());
        }
        if self.is_compared {
            pages.push(self.differences());
        }
        if has_decisions(&self.estimated) {
            let delay = self.drawing("Delay", paths::AGAINST, (SHEET.0, delay_state::HEIGHT));
            pages.extend([self.decisions(), self.record(), delay, self.table()]);
        } else {
            // In words why there are no steps, and its dead time.
            let title = match &self.estimated.estimate.dead_time {
                Some(found) if found.varies() => "The dead time varies",
                Some(_) => "Dead time",
                None => "No steps",
            };
            let parts = [(7.0, self.record()), (3.0, self.text(title, paths::VERDICT))];
            pages.push(Page::beside(title, parts));
        }
        Page::tabs(&self.joint().name, pages)
    }

    fn joint(&self) -> &Joint {
        self.estimated.joint
    }

    /// The entity at `path` below the joint.
    fn at(&self, path: &str) -> EntityPath {
        at(&joint_root(&self.joint().name), path)
    }

    fn text(&self, name: &str, path: &str) -> Page {
        Page::text(name, self.at(path))
    }

    fn drawing(&self, name: &str, path: &str, size: (f32, f32)) -> Page {
        Page::drawing(name, &self.at(path), size)
    }

    fn plot(&self, name: &str, paths: &[&str]) -> Page {
        let entities: Vec<_> = paths.iter().map(|path| self.at(path)).collect();
        plot(name, &entities, Legend::InTitle)
    }

    fn lanes(&self, name: &str, paths: &[&str]) -> Page {
        Page::lanes(name, &paths.iter().map(|path| self.at(path)).collect::<Vec<_>>())
    }

    /// What a reviewer steps through.
    fn decisions(&self) -> Page {
        let map = "Whole record: the framed segment is shown above";
        // How many steps were accepted and why others were rejected, over the lanes that say of which.
        let [_, steps, accepted, rejected, ..] =
            summary_cells("", &JointSummary::of(self.estimated));
        let verdicts = format!("{accepted} of {steps} ✓ accepted · ✗ rejected: {rejected}");
        // The verdict names the trial: a lane for it would hide that of the verdicts in a small window.
        let map = self.drawing(map, paths::MAP, (SHEET.0, MAP_HEIGHT));
        let lanes = self.lanes(&verdicts, &[paths::VERDICT, paths::SEGMENT]);
        // Behind one another: below one another neither has its room in a small window.
        let left = [(7.4, self.segment()), (2.6, Page::tabs("Record", [map, lanes]))];
        let right = [(7.2, self.text("Verdict", paths::VERDICT)), (2.8, self.lists())];
        let columns =
            [(6.8, Page::stacked("Segment", left)), (3.2, Page::stacked("Verdicts", right))];
        self.below_headline("Decisions", paths::HEADLINE, Page::beside("Steps", columns))
    }

    /// A page below what was found: four lines in a small window.
    fn below_headline(&self, name: &str, headline: &str, page: Page) -> Page {
        let headline = self.text("What was found", headline);
        Page::stacked(name, [(1.5, headline), (8.5, page)])
    }

    fn segment(&self) -> Page {
        let name = "The segment and its candidates; close-up: samples, Algorithm 1 white with 95 % of the noise";
        self.drawing(name, paths::DRAWING, segment_view::SIZE)
    }

    /// The decisions by doubt, in their order, and by doubt with the reasons.
    fn lists(&self) -> Page {
        let doubts = by_doubt(&[self.estimated]);
        let doubtful = doubts.iter().filter(|found| found.is_open()).count();
        let limit = number(Doubt::DOUBTFUL_PERCENT);
        let doubtful = format!("{doubtful} of {} doubtful (≥ {limit} %): click", doubts.len());
        let lists = [
            Page::list(doubtful, self.at(paths::DOUBT_LOG), "doubt"),
            Page::list("All: click a number", self.at(paths::VERDICT_LOG), "decision"),
        ];
        Page::tabs("Lists", lists)
    }

    /// Where the decisions differ from those of other results, the most different first.
    fn differences(&self) -> Page {
        let name = "Delays here and there, and their difference";
        let sheet = self.drawing(name, paths::DIFFERENCE_SHEET, difference::SIZE);
        let log = self.at(paths::DIFFERENCE_LOG);
        let list = Page::list("Most different first: click a number", log, "difference");
        let right = [
            (2.3, self.text("In words", paths::DIFFERENCE)),
            (2.7, list),
            (5.0, self.text("Verdict", paths::VERDICT)),
        ];
        let left = Page::stacked("Steps", [(3.6, sheet), (6.4, self.segment())]);
        Page::beside("Differences", [(6.8, left), (3.2, Page::stacked("Lists", right))])
    }

    /// A line that says where the cursor is, or where to click.
    fn place(&self) -> Page {
        self.text("Where the cursor is", paths::PLACE)
    }

    fn input(&self) -> Page {
        self.plot("Input", &[paths::INPUT])
    }

    /// The whole record on the time axis.
    fn record(&self) -> Page {
        // What the plots of output and delay, the lanes below them, and the drawing show, of an input
        // that has steps and of one that moves all the time.
        let [output, delay, lanes, map] = if has_decisions(&self.estimated) {
            [
                "Output: measured grey, smoothed blue; chosen lines orange and green; breakpoints: \
                 dot accepted, cross rejected",
                "Delay [samples], up to the longest accepted: dot accepted, cross rejected",
                "Steps and verdicts",
                "Whole record, on every timeline: the framed step is under the cursor",
            ]
        } else {
            [
                "Output: measured grey, smoothed blue",
                "Dead time of each window [samples]",
                "Trials",
                "Whole record, on every timeline",
            ]
        };
        let outputs = [
            paths::OUTPUT_RAW,
            paths::OUTPUT_SMOOTHED,
            paths::LINE_BEFORE,
            paths::LINE_AFTER,
            paths::BREAKPOINT_ACCEPTED,
            paths::BREAKPOINT_REJECTED,
        ];
        let output = self.plot(output, &outputs);
        let mut rows = vec![(1.1, self.input()), (3.1, output), (1.6, self.delays(delay))];
        let joint = self.joint();
        if !joint.covariates.is_empty() {
            let root = self.at(paths::COVARIATE);
            let all = joint.covariates.iter().map(|signal| child(root.clone(), &signal.name));
            rows.push((1.5, plot("Covariates", &all.collect::<Vec<_>>(), Legend::Apart)));
        }
        let (shown, share) = match joint.trials.len() {
            ..=1 => (&[paths::VERDICT, paths::SEGMENT][..], 2.1),
            _ => (&[paths::VERDICT, paths::SEGMENT, paths::TRIAL][..], 2.6),
        };
        rows.push((share, self.lanes(lanes, shown)));
        let map = self.drawing(map, paths::LARGE_MAP, (SHEET.0, LARGE_HEIGHT));
        let tabs = Page::tabs("Record", [map, Page::stacked(ALONG, rows)]);
        Page::stacked("Record", [(1.1, self.place()), (8.9, tabs)])
    }

    /// The delays along the record.
    fn delays(&self, name: &str) -> Page {
        let delays = self.plot(name, &[paths::TAU, paths::DELAY_ACCEPTED, paths::DELAY_REJECTED]);
        let decisions = self.estimated.estimate.estimated().flat_map(|trial| &trial.decisions);
        let longest = decisions.filter_map(Decision::accepted_delay).reduce(f64::max);
        // One rejected at the end of a long hold would press the others to the axis.
        match longest.filter(|longest| *longest > 0.0) {
            Some(longest) => {
                let range = Range1D::new(-0.1 * longest, 1.2 * longest);
                delays.with("ScalarAxis", ScalarAxis::new().with_range(range))
            }
            None => delays,
        }
    }

    /// A model as it grows.
    fn revisions(&self) -> Page {
        let name = "The error falls; what shows it; what was tried";
        let sheet = self.drawing(name, paths::REVISION_SHEET, model::SIZE);
        let name =
            "Where the error of the speed arises: its share (bars), share of the time (white)";
        let share = self.drawing(name, paths::REVISION_SHARE, TAB);
        let record = self.drawing("The whole record", paths::REVISION_RECORD, model::SIZE);
        let words = self.text("In words", paths::REVISION_WORDS);
        let parameters = self.text("Parameters", paths::REVISION_PARAMETERS);
        let left = [(1.0, Page::tabs("Ladder", [sheet, share])), (1.0, record)];
        let right = Page::tabs("Texts", [words, parameters]);
        let columns = [(7.3, Page::stacked("Drawings", left)), (2.7, right)];
        self.below_headline("Revisions", paths::REVISION_HEADLINE, Page::beside("Model", columns))
    }

    /// Numbers of the models that are drawn beside the measurement: of many revisions of one model the
    /// first and the last, since what came between is on the page of the revisions.
    fn drawn(&self) -> Vec<usize> {
        let models = self.models.len();
        if self.revisions > 0 && models > palette::NAMED {
            vec![0, models - 1]
        } else {
            (0..models).collect()
        }
    }

    /// Models beside the measurement, and their residuals.
    fn models(&self) -> Page {
        let shown = self.drawn();
        let names: Vec<&str> =
            shown.iter().filter_map(|number| Some(self.models.get(*number)?.model)).collect();
        let root = self.at(paths::MODEL);
        let with_models = |others: &[&str], part| -> Vec<EntityPath> {
            let models = names.iter().map(|name| at(&child(root.clone(), name), part));
            others.iter().map(|path| self.at(path)).chain(models).collect()
        };
        // A model keeps its colour where others are not drawn.
        let colors = shown.iter().map(|number| palette::name(*number));
        let (legend, colors) = match shown.len() {
            ..=palette::NAMED => {
                let own = names.iter().zip(colors).map(|(name, color)| format!("{name} {color}"));
                let own: Vec<_> = own.collect();
                (Legend::InTitle, format!(": measured grey, {}", own.join(", ")))
            }
            _ => (Legend::Apart, String::new()),
        };
        let horizon = self.models.first().map(|model| model.comparison.fit.evaluation.horizon);
        let residual = format!(
            "Residual ({}); 95 % of the noise lies in the band",
            horizon.unwrap_or_default()
        );
        let outputs = with_models(&[paths::OUTPUT_RAW], paths::SIMULATED);
        let residuals = with_models(&[paths::NOISE_UPPER, paths::NOISE_LOWER], paths::RESIDUAL);
        let plots = [
            (2.3, plot(format!("Measured and simulated{colors}"), &outputs, legend)),
            (1.8, plot(residual, &residuals, legend)),
            (1.5, self.input()),
            (2.9, self.lanes_of_models()),
        ];
        let plots = Page::stacked(ALONG, plots);
        let map = if self.revisions == 0 { paths::MODEL_MAP } else { paths::REVISION_RECORD };
        let map = self.drawing("Whole record, on every timeline", map, model::SIZE);
        // Models side by side are compared in the plots: the map is of the first one alone.
        let tabs = if self.are_side_by_side() { [plots, map] } else { [map, plots] };
        let rows = [
            (1.3, self.place()),
            (6.5, Page::tabs("Record", tabs)),
            (4.2, self.residuals(&names, &shown)),
        ];
        let texts = [
            self.text("Models", paths::MODEL_PAGE),
            self.text("Worst", paths::MODEL_WORST),
            self.text("Parameters", paths::MODEL_PARAMETERS),
        ];
        let columns = [(7.2, Page::stacked("Plots", rows)), (2.8, Page::tabs("Texts", texts))];
        Page::beside("Models", columns)
    }

    fn are_side_by_side(&self) -> bool {
        self.models.len() > 1 && self.revisions == 0
    }

    /// The worst segments, what was not fitted to, and where the model fails.
    fn lanes_of_models(&self) -> Page {
        let any = |has: fn(&Comparison) -> bool| self.models.iter().any(|it| has(it.comparison));
        let lanes = [
            (paths::WORST, true),
            (paths::PART, any(|comparison| !comparison.per_step.is_empty())),
            (paths::FAILS, any(|comparison| comparison.failure.is_some())),
        ];
        let lanes = lanes.into_iter().filter(|(_, is_there)| *is_there).map(|(path, _)| path);
        self.lanes(LANES, &lanes.collect::<Vec<_>>())
    }

    /// What the residual depends on, in three drawings; and which of several models is better, along the
    /// record.
    fn residuals(&self, names: &[&str], shown: &[usize]) -> Page {
        let hidden = || (0..self.models.len()).filter(|number| !shown.contains(number));
        let drawings = DRAWINGS.map(|(name, path, parts, size)| {
            let root = self.at(path);
            let of_models = parts.iter().flat_map(|part| hidden().map(move |n| (part, n)));
            let of_models = of_models.map(|(part, number)| at(&root, &of_model(part, number)));
            self.drawing(name, path, size).without(of_models.collect::<Vec<_>>())
        });
        let difference = names.split_first().filter(|_| self.are_side_by_side());
        let difference = difference.map(|(first, others)| {
            let root = self.at(paths::MODEL_DIFFERENCE);
            let others: Vec<_> = others.iter().map(|name| child(root.clone(), name)).collect();
            let name = format!(
                "Cumulative squared error less that of {first}: it rises where {first} is better"
            );
            plot(name, &others, Legend::Apart)
        });
        Page::tabs("Residual", difference.into_iter().chain(drawings))
    }

    /// Every number: a row per decision, and a row per candidate.
    fn table(&self) -> Page {
        /// Columns of the table of candidates, in the order in which a viewer shows them.
        const COLUMNS: [&str; 7] =
            ["breakpoint", "delay_s", "error", "error_rank", "error_times_least", "i", "verdict"];
        let entity = self.at(paths::DECISION_TABLE);
        let select = |name: &str| ComponentColumnSelector::new(&entity, name.to_owned());
        let select = SelectedColumns {
            time_columns: vec![Utf8::from("decision")],
            component_columns: COLUMNS.into_iter().map(select).collect(),
        };
        let query = DataframeQuery::new().with_timeline("decision").with_auto_scroll(true);
        let candidates = Page::view("Dataframe", "Candidates", [&entity]);
        let candidates = candidates.with("DataframeQuery", query.with_select(select));
        let decisions = self.text("Decisions", paths::DECISION_PAGE);
        Page::beside("Table", [(1.15, decisions), (0.85, candidates)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::Threads;
    use crate::delay::{Method, Settings};
    use crate::experiment::Trial;
    use crate::study::estimate_joints;
    use crate::units::SamplePeriod;

    #[test]
    fn every_drawing_has_room_for_its_texts_in_a_window_of_1280_by_720() {
        /// What is left of the window below its title and the tabs of joints, above the time.
        const ROOM: (f32, f32) = (1280.0, 637.0);
        // Texts have one size on the screen: sheets are made for half of it.
        const LEAST: f32 = 0.49;
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let input = [vec![0.0; 100], vec![1.0; 100]].concat();
        let trial = Trial::new("1", 0.0, period, input.clone(), input).unwrap();
        let name = "boom".to_owned();
        let joint = Joint {
            name,
            input_unit: None,
            output_unit: None,
            covariates: Vec::new(),
            trials: [trial].into(),
        };
        let settings = Settings::of(Method::TWO_LINE);
        let estimate = estimate_joints(std::slice::from_ref(&joint), &settings, || (), &Threads);
        let estimate = estimate.into_iter().next().unwrap().unwrap();
        let estimated = EstimatedJoint { joint: &joint, estimate: &estimate };
        let tab = Tab { estimated, models: Vec::new(), revisions: 2, is_compared: true };
        let models = Page::tabs("", [tab.models()]);
        let scales: Vec<_> = [tab.page(), models].iter().flat_map(|it| it.scales(ROOM)).collect();
        assert!(scales.len() > 8, "{scales:?}");
        let small: Vec<_> = scales.into_iter().filter(|(_, scale)| *scale < LEAST).collect();
        assert!(small.is_empty(), "{small:?}");
    }
}
