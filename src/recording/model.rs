//! Models beside the measurement: what they simulate, and the residual.

use std::ops::{Range, RangeInclusive};

use rerun::{EntityPath, StateConfiguration};

use super::canvas::Layers;
use super::chunk::{Chunks, Index, Moment, line, list, words};
use super::error::RecordError;
use super::layout::JointLayout;
use super::markdown::plain;
use super::palette::{self, color};
use super::panels::{self, Placed};
use super::paths::{self, at, child};
use super::residual;
use crate::diagnosis::failure::Region;
use crate::diagnosis::{Comparison, sensor_noise};
use crate::experiment::Joint;
use crate::figure::Role;
use crate::report::compare::{Section, difference_section, errors_note, model_table, sections};
use crate::report::page::simulated::{simulated_panels, worst_panel};
use crate::report::page::timeline::{named, validation, worst};
use crate::report::parameters::parameter_table;
use crate::report::{ComparedJoint, TextTable};
use crate::wording::{capitalized, measure, number, percent};

/// Width of the noise band in standard deviations on each side: 95 % of normal noise.
const BAND: f64 = 1.96;

/// Adds `/model/<name>/simulated`, `/residual` and the rest of the models' page, on which
/// `judged` has the first word.
pub(super) fn add(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    models: &[&ComparedJoint<'_>],
    judged: &ComparedJoint<'_>,
) -> Result<(), RecordError> {
    for (compared, rgb) in models.iter().zip(palette::models()) {
        let name = compared.model;
        let model = child(paths::MODEL, name);
        let simulated = layout.series(|trial| trial.logged(compared.simulated(trial.index)));
        let style = line(format!("{name}: simulated"), rgb, 1.5);
        chunks.series(at(&model, paths::SIMULATED), &style, simulated)?;
        let residual = layout.series(|trial| trial.logged(compared.residual(trial.index)));
        let style = line(format!("{name}: measured − simulated"), rgb, 1.5);
        chunks.series(at(&model, paths::RESIDUAL), &style, residual)?;
        figures(chunks, &model, compared.comparison)?;
    }
    band(chunks, layout, sensor_noise(&judged.joint.trials))?;
    // Each on a page of its own: below one another the last is off a small window.
    chunks.page(paths::MODEL_PAGE, page(models, judged))?;
    chunks.page(paths::MODEL_WORST, worst_segments(layout, judged))?;
    let of_each = reported(models, judged).into_iter().map(|one| {
        format!(
            "**{}**\n\n{}\n",
            plain(one.model),
            parameter_table(one.joint, &one.comparison.fit).markdown(plain)
        )
    });
    chunks.page(paths::MODEL_PARAMETERS, of_each.collect())?;
    residual::add(chunks, models, judged)?;
    residual::add_shares(chunks, models)?;
    residual::add_correlograms(chunks, models)?;
    if is_first(models, judged) {
        differences(chunks, layout, models)?;
    }
    add_lanes(chunks, layout, (judged.joint, judged.comparison))
}

/// Adds what is seen of the record on every timeline of a model that has no revisions, whose own
/// drawings are.
pub(super) fn add_map(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    judged: &ComparedJoint<'_>,
) -> Result<(), RecordError> {
    let Some(start) = layout.start() else { return Ok(()) };
    let index = Index::everywhere(start, layout.first);
    let mut layers = Layers::rows(chunks, paths::MODEL_MAP, index);
    add_record(&mut layers, layout, &[*judged])
}

/// Regions and correlations as lists of numbers, for programs.
fn figures(
    chunks: &mut Chunks,
    model: &EntityPath,
    comparison: &Comparison,
) -> Result<(), RecordError> {
    let regions = &comparison.regions;
    let column = |name, value: fn(&Region) -> f64| list(name, regions.iter().map(value));
    let lists = vec![
        words("feature", regions.iter().map(|region| region.feature.id())),
        words("label", regions.iter().map(|region| region.label.as_str())),
        column("from", |region| region.from),
        column("to", |region| region.to),
        column("share_of_time", |region| region.share_of_time),
        column("share_of_squared_error", |region| region.share_of_squared_error),
        column("rmse", |region| region.rmse),
        column("mean_residual", |region| region.mean_residual),
    ];
    chunks.push_static(at(model, "regions"), &lists)?;
    if let Some(found) = &comparison.whiteness {
        let lags = (1..=found.correlation.len()).map(|k| k as f64 * found.lag_step_s);
        let lists = vec![
            list("lag_s", lags),
            list("correlation", found.correlation.iter().copied()),
            list("band", std::iter::once(found.band)),
        ];
        chunks.push_static(at(model, "whiteness"), &lists)?;
    }
    if let Some(found) = &comparison.input_correlation {
        let lags = 0..found.acting.correlation.len();
        let lags = lags.map(|k| found.first_lag_s + k as f64 * found.lag_step_s);
        let lists = vec![
            list("lag_s", lags),
            list("acting", found.acting.correlation.iter().copied()),
            list("acting_band", std::iter::once(found.acting.band)),
            list("raw", found.raw.correlation.iter().copied()),
            list("raw_band", std::iter::once(found.raw.band)),
        ];
        chunks.push_static(at(model, "input_correlation"), &lists)?;
    }
    Ok(())
}

/// Two level lines between which noise alone would keep the residual.
fn band(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    noise: Option<f64>,
) -> Result<(), RecordError> {
    let Some(noise) = noise else { return Ok(()) };
    for (path, name, level) in [
        (paths::NOISE_UPPER, "noise, upper", BAND * noise),
        (paths::NOISE_LOWER, "noise, lower", -BAND * noise),
    ] {
        let ends = layout.trials.iter().flat_map(|t| [t.moment_of(1), t.moment_of(t.trial.len())]);
        let index = ends.collect::<Index>().without_segment();
        let levels = vec![Some(level); index.len()];
        chunks.series(path, &line(name, palette::BORDER, 1.0), (index, levels))?;
    }
    Ok(())
}

/// The sum so far of what each further model's squared residual is larger than the first one's: it
/// rises where the first model is better.
fn differences(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    models: &[&ComparedJoint<'_>],
) -> Result<(), RecordError> {
    let Some((first, others)) = models.split_first() else { return Ok(()) };
    for (other, rgb) in others.iter().zip(palette::models().skip(1)) {
        let mut sum = 0.0;
        let sums = layout.series(|trial| {
            let own = first.residual(trial.index).iter();
            let pairs = other.residual(trial.index).iter().zip(own);
            let sums = pairs.map(|(other, own)| {
                sum += other * other - own * own;
                Some(sum)
            });
            sums.collect()
        });
        let name = format!("{} − {}", other.model, first.model);
        let entity = child(paths::MODEL_DIFFERENCE, other.model);
        chunks.series(entity, &line(name, rgb, 1.5), sums)?;
    }
    Ok(())
}

/// The models of which what is wrong is said: of the revisions of one model the last one, of models
/// side by side each.
fn reported<'m, 'c>(
    models: &[&'m ComparedJoint<'c>],
    judged: &'m ComparedJoint<'c>,
) -> Vec<&'m ComparedJoint<'c>> {
    if is_first(models, judged) { models.to_vec() } else { vec![judged] }
}

/// All figures of all models of the joint, and what is said of them.
fn page(models: &[&ComparedJoint<'_>], judged: &ComparedJoint<'_>) -> String {
    let joint = judged.joint;
    let compared: Vec<ComparedJoint<'_>> = models.iter().map(|model| **model).collect();
    let horizon = judged.comparison.fit.evaluation.horizon.to_string();
    let noise = sensor_noise(&joint.trials);
    let noise = noise.map(|noise| measure(noise, joint.output_unit.as_deref()));
    let noise =
        noise.map_or_else(String::new, |noise| format!("Noise of the sensor: {noise}.\n\n"));
    let reported: Vec<_> = reported(models, judged).into_iter().copied().collect();
    let differences = is_first(models, judged).then(|| difference_section(&compared));
    let sections = sections(&reported).into_iter().chain(differences);
    let section = |(heading, lines): Section| {
        let lines: Vec<String> = lines.iter().map(|line| plain(line)).collect();
        format!("**{}**\n\n- {}\n\n", capitalized(&heading), lines.join("\n- "))
    };
    let sections = sections.filter(|(_, lines)| !lines.is_empty()).map(section);
    format!(
        "### {}\n\n{}\n{}.\n\n{noise}{}",
        plain(&joint.name),
        model_table(&compared).markdown(plain),
        capitalized(&errors_note(&horizon)),
        sections.collect::<String>()
    )
}

/// Where the judged model is worst, a row per segment; where it begins on the timeline `sample`, too.
fn worst_segments(layout: &JointLayout<'_>, judged: &ComparedJoint<'_>) -> String {
    let Some(failure) = &judged.comparison.failure else {
        return "No segment stands out.".to_owned();
    };
    let unit = judged.joint.output_unit.as_deref();
    let spans = worst(judged.joint, judged.comparison);
    let rows = failure.worst_segments.iter().zip(&spans).zip(1_u32..);
    let rows = rows.map(|((worst, (index, span)), rank)| {
        let sample = layout.trial(*index).map(|trial| trial.sample(span.start + 1));
        [
            rank.to_string(),
            format!("{}, {} s", worst.trial, number(worst.start_s)),
            percent(worst.share_of_squared_error),
            measure(worst.largest_residual, unit),
            sample.map_or_else(String::new, |sample| sample.to_string()),
        ]
    });
    let header = ["rank", "trial, from", "squares", "largest", "sample"];
    let table = TextTable::of(header, &[], rows).markdown(plain);
    let horizon = judged.comparison.fit.evaluation.horizon;
    format!(
        "Where the output of {} is farthest off, {horizon}: the segments with the largest sums of \
         squares, and the one with the largest residual of all. The simulated output keeps an \
         error of the speed until the next restart, so the cause may lie earlier:\n\n{table}",
        plain(judged.model)
    )
}

/// Whether models are compared with the first one; revisions of a model are shown by their ladder.
fn is_first(models: &[&ComparedJoint<'_>], judged: &ComparedJoint<'_>) -> bool {
    models.first().is_some_and(|first| first.model == judged.model)
}

/// A span of a trial with its name.
type Named = ((usize, Range<usize>), String);

/// Adds `/worst`, `/part` and `/fails`.
fn add_lanes(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    (joint, comparison): (&Joint, &Comparison),
) -> Result<(), RecordError> {
    // A longer name would be cut off: a segment is narrow.
    let ranked = worst(joint, comparison).into_iter().zip(1_u32..);
    let ranked: Vec<Named> = ranked.map(|(span, rank)| (span, rank.to_string())).collect();
    let mut marks = marks(layout, ranked);
    if marks.is_empty() {
        let adequate = "none: the model is adequate".to_owned();
        marks.extend(layout.start().map(|start| (start, adequate)));
    }
    push_marks(chunks, paths::WORST, marks)?;
    let hint = ["on `sample`, `time` or `decision`: choose it at the bottom left"];
    chunks.states(paths::WORST, Index::off_the_record(layout.first), hint)?;
    let unfitted = Some(("not fitted".to_owned(), validation(comparison)));
    let grey = palette::dimmed(palette::SMOOTHED);
    let fails = named(joint, comparison);
    for (path, rgb, lane) in
        [(paths::PART, grey, unfitted), (paths::FAILS, palette::REJECTED, fails)]
    {
        let Some((name, spans)) = lane.filter(|(_, spans)| !spans.is_empty()) else { continue };
        let style = StateConfiguration::new().with_values([name.clone()]);
        chunks.push_static(path, &style.with_colors([color(rgb)]))?;
        let spans = spans.into_iter().map(|span| (span, name.clone())).collect();
        push_marks(chunks, path, self::marks(layout, spans))?;
    }
    Ok(())
}

/// Where each span begins, with its name, and where it ends.
fn marks(layout: &JointLayout<'_>, spans: Vec<Named>) -> Vec<(Moment, String)> {
    let marks = spans.into_iter().filter_map(|((index, span), name)| {
        let trial = layout.trial(index)?;
        let [begin, end] = [span.start, span.end].map(|k| trial.moment_of(k + 1));
        Some([(begin, name), (end, String::new())])
    });
    marks.flatten().collect()
}

fn push_marks(
    chunks: &mut Chunks,
    path: &str,
    mut marks: Vec<(Moment, String)>,
) -> Result<(), RecordError> {
    marks.sort_by_key(|(moment, name)| (moment.sample, !name.is_empty()));
    let (moments, names): (Vec<_>, Vec<_>) = marks.into_iter().unzip();
    chunks.states(path, moments.into_iter().collect::<Index>().without_segment(), names)
}

/// Width and height of the sheet, and of that with ladder, what the model misses and ranking.
pub(super) const SIZE: (f32, f32) = (1860.0, 470.0);

/// Top and bottom of the plots of the output: above them their titles.
const ROWS: RangeInclusive<f32> = 56.0..=198.0;

/// Adds the drawings of models, which follow one another on the timeline of `rows`.
pub(super) fn add_record(
    rows: &mut Layers<'_>,
    layout: &JointLayout<'_>,
    models: &[ComparedJoint<'_>],
) -> Result<(), RecordError> {
    let timeline = layout.timeline();
    let drawn = |(number, compared): (usize, &ComparedJoint<'_>)| {
        let role = Role::of_revision(number);
        let fails = named(compared.joint, compared.comparison);
        let [output, residual] = simulated_panels(compared, role, &timeline, fails);
        let close_up = worst_panel(compared, role, &timeline);
        let end = SIZE.0 - 15.0;
        let right = if close_up.is_some() { 1060.0 } else { end };
        let close_up = close_up.map(|panel| Placed::new(panel, (1180.0, end), ROWS));
        let whole = [
            Placed::new(output, (120.0, right), ROWS),
            Placed::new(residual, (120.0, end), 284.0..=426.0),
        ];
        whole.into_iter().chain(close_up).collect()
    };
    panels::add(rows, models.iter().enumerate().map(drawn))
}
