//! Models beside the measurement: what they simulate, and the residual.

use std::fmt::Write as _;

use rerun::EntityPath;

use super::chunk::{Chunks, Index, line, list, words};
use super::error::RecordError;
use super::layers::Layers;
use super::layout::JointLayout;
use super::markdown::plain;
use super::model_lanes::samples_of;
use super::palette;
use super::parameter_table::parameter_table;
use super::paths::{self, at, child};
use super::signals::known;
use super::{correlogram, error_share, model_lanes, revision, scatter};
use crate::diagnosis::failure::{Region, WorstSegment};
use crate::diagnosis::{Comparison, ErrorFigures, SIGNIFICANCE, sensor_noise};
use crate::experiment::Joint;
use crate::report::{ComparedJoint, model_differences};
use crate::wording::{
    capitalized, correlation_sentences, fails_or_errs, measure, misfit_units, number, rounded,
};

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
        let (name, comparison) = (compared.model, compared.comparison);
        let model = child(paths::MODEL, name);
        let simulated = layout.series(|trial| known(trial.simulated(comparison)));
        let style = line(format!("{name}: simulated"), rgb, 1.5);
        chunks.series(at(&model, paths::SIMULATED), &style, simulated)?;
        let residual = layout.series(|trial| known(trial.residual(comparison)));
        let style = line(format!("{name}: measured − simulated"), rgb, 1.5);
        chunks.series(at(&model, paths::RESIDUAL), &style, residual)?;
        figures(chunks, &model, comparison)?;
    }
    band(chunks, layout, sensor_noise(&judged.joint.trials))?;
    // Each on a page of its own: below one another the last is off a small window.
    for (path, page) in [
        (paths::MODEL_PAGE, page(models, judged)),
        (paths::MODEL_WORST, worst_segments(layout, judged)),
        (paths::MODEL_PARAMETERS, parameters(judged.joint, &reported(models, judged))),
    ] {
        chunks.page(path, page.unwrap_or_default())?;
    }
    scatter::add(chunks, models, judged)?;
    error_share::add(chunks, models)?;
    correlogram::add(chunks, models)?;
    if is_first(models, judged) {
        differences(chunks, layout, models)?;
    }
    model_lanes::add(chunks, layout, (judged.joint, judged.comparison))
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
    let mut layers = Layers::rows(chunks, paths::MODEL_MAP, index).back_to_front();
    revision::add_record(&mut layers, layout, &[*judged])
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
            let own = trial.residual(first.comparison).iter();
            let pairs = trial.residual(other.comparison).iter().zip(own);
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

/// All figures of all models of the joint.
fn page(
    models: &[&ComparedJoint<'_>],
    judged: &ComparedJoint<'_>,
) -> Result<String, std::fmt::Error> {
    let mut page = String::new();
    let joint = judged.joint;
    let unit = joint.output_unit.as_deref().unwrap_or("");
    let of = if models.len() > 1 { format!(", {}", plain(judged.model)) } else { String::new() };
    writeln!(page, "### {}{of}: {}\n", plain(&joint.name), headline(judged))?;
    errors(&mut page, unit, models)?;
    let horizon = judged.comparison.fit.evaluation.horizon;
    writeln!(
        page,
        "\nErrors are root mean squares of simulations, {horizon}, each run of which starts where its \
         error is least; *raw*: from the smoothed measured output, nothing removed; *free run*: from \
         the start of each trial; *fit* is the part of the motion that is followed, 100 % less the validation \
         error over the standard deviation of the output."
    )?;
    if let Some(noise) = sensor_noise(&joint.trials) {
        let noise = measure(noise, joint.output_unit.as_deref());
        writeln!(page, "Noise of the sensor: {noise}.")?;
    }
    if is_first(models, judged) {
        against(&mut page, models)?;
    }
    let reported = reported(models, judged);
    for compared in &reported {
        let units = misfit_units(compared.joint);
        let found = compared.comparison.failure.iter().flat_map(|failure| &failure.fails_where);
        for found in found {
            let (when, weight) = (plain(&found.condition(&units)), found.weight());
            let errs = capitalized(fails_or_errs(compared.comparison));
            writeln!(page, "\n**{errs} when {when}** ({}): {weight}", compared.model)?;
        }
    }
    for compared in &reported {
        let residual = correlation_sentences(compared.comparison).join("; ");
        if !residual.is_empty() {
            writeln!(page, "\n**Residual** ({}): {}", compared.model, plain(&residual))?;
        }
    }
    reconciled(&mut page, &reported)?;
    Ok(page)
}

/// Why a model may be adequate though its residual is not white.
fn reconciled(page: &mut String, models: &[&ComparedJoint<'_>]) -> std::fmt::Result {
    let is_odd = |compared: &&&ComparedJoint<'_>| {
        let Comparison { lack_of_fit, whiteness, .. } = compared.comparison;
        let white = whiteness.as_ref().is_none_or(|found| found.p_value >= SIGNIFICANCE);
        lack_of_fit.is_some_and(|test| test.adequate) && !white
    };
    let odd: Vec<String> = models.iter().filter(is_odd).map(|it| plain(it.model)).collect();
    if odd.is_empty() {
        return Ok(());
    }
    writeln!(
        page,
        "\n{}: adequate and yet not white, since whiteness asks whether any memory is left in the \
         residual, as noise may have it and the smallest misfit makes it in a long record; the lack \
         of fit asks whether motion of a size that matters is left.",
        odd.join(", ")
    )
}

/// The error figures of each model, and whether a lack of fit is shown.
fn errors(page: &mut String, unit: &str, models: &[&ComparedJoint<'_>]) -> std::fmt::Result {
    writeln!(
        page,
        "| model | training | validation | raw | free run | fit | lack of fit |\n|---|---|---|---|---|---|---|"
    )?;
    for compared in models {
        let Comparison { training, validation, raw, free, lack_of_fit, .. } = compared.comparison;
        let shown = |error: Option<f64>| {
            error.map_or_else(|| "–".to_owned(), |error| format!("{} {unit}", number(error)))
        };
        let rmse = |error: &Option<ErrorFigures>| shown(error.map(|error| error.rmse));
        let percent = validation.and_then(|e| e.fit_text()).unwrap_or_else(|| "–".to_owned());
        let is = lack_of_fit.map_or("unknown", |t| if t.adequate { "not shown" } else { "shown" });
        let (train, valid) = (rmse(training), rmse(validation));
        let (raw, free) = (shown(raw.judged()), shown(free.judged()));
        writeln!(
            page,
            "| {} | {train} | {valid} | {raw} | {free} | {percent} | {is} |",
            compared.model
        )?;
    }
    Ok(())
}

/// Where the judged model is worst.
fn worst_segments(
    layout: &JointLayout<'_>,
    judged: &ComparedJoint<'_>,
) -> Result<String, std::fmt::Error> {
    let mut page = String::new();
    let Some(failure) = &judged.comparison.failure else {
        return Ok("No segment stands out.".to_owned());
    };
    let horizon = judged.comparison.fit.evaluation.horizon;
    writeln!(
        page,
        "Where the output of {} is farthest off, {horizon}: the segments with the largest sums of \
         squares, and the one with the largest residual of all (bold). The output keeps each error \
         of the speed until the next restart, so that this need not be where it arises:",
        judged.model
    )?;
    // A narrow page has no room for what is the same in each row.
    let several = judged.joint.trials.len() > 1;
    let columns = if several { ["trial", "from `time`"] } else { ["from", "`sample`"] };
    let unit = judged.joint.output_unit.as_deref().map_or_else(String::new, plain);
    let [place, on] = columns;
    let height = |worst: &WorstSegment| worst.largest_residual.abs();
    let highest = failure.worst_segments.iter().map(height).reduce(f64::max).unwrap_or_default();
    writeln!(page, "\n| rank | {place} | squares | largest {unit} | {on} |")?;
    writeln!(page, "|---|---|---|---|---|")?;
    for (rank, worst) in (1..).zip(&failure.worst_segments) {
        let place =
            if several { plain(&worst.trial) } else { format!("{} s", number(worst.start_s)) };
        let share = 100.0 * worst.share_of_squared_error;
        let on_timeline = on_timeline(layout, worst);
        let largest = rounded(worst.largest_residual);
        let largest = if height(worst) < highest { largest } else { format!("**{largest}**") };
        writeln!(page, "| {rank} | {place} | {share:.0} % | {largest} | {on_timeline} |")?;
    }
    Ok(page)
}

/// Whether models are compared with the first one; revisions of a model are shown by their ladder.
fn is_first(models: &[&ComparedJoint<'_>], judged: &ComparedJoint<'_>) -> bool {
    models.first().is_some_and(|first| first.model == judged.model)
}

/// Which of several models is better than the first one, and where.
fn against(page: &mut String, models: &[&ComparedJoint<'_>]) -> std::fmt::Result {
    let compared: Vec<ComparedJoint<'_>> = models.iter().map(|model| **model).collect();
    for (number, difference) in model_differences(&compared).iter().enumerate() {
        let (model, other) = (plain(difference.model), plain(difference.other));
        let head = if number == 0 { "\n" } else { "" };
        let sentences = difference.sentences();
        let sentences: Vec<_> = sentences.iter().map(|sentence| plain(sentence)).collect();
        writeln!(page, "{head}**{model} against {other}**\n\n- {}\n", sentences.join("\n- "))?;
    }
    Ok(())
}

/// The parameters of each model.
fn parameters(joint: &Joint, models: &[&ComparedJoint<'_>]) -> Result<String, std::fmt::Error> {
    let mut page = String::new();
    for compared in models {
        writeln!(page, "\n**{}**\n", compared.model)?;
        parameter_table(&mut page, joint, &compared.comparison.fit)?;
    }
    Ok(page)
}

/// Where `worst` begins on the timeline `sample`; of several trials, which have one clock each, on that
/// of the record.
fn on_timeline(layout: &JointLayout<'_>, worst: &WorstSegment) -> String {
    let Some(trial) = layout.trial_of(&worst.trial) else { return String::new() };
    let first = *samples_of(worst, trial).start();
    match layout.trials.len() {
        1 => trial.sample(first).to_string(),
        _ => clock(trial.time_ns(first) / 1_000_000_000),
    }
}

/// Seconds as the viewer writes them on an axis: `1m20s`.
fn clock(seconds: i64) -> String {
    match (seconds / 60, seconds % 60) {
        (0, seconds) => format!("{seconds}s"),
        (minutes, seconds) => format!("{minutes}m{seconds:02}s"),
    }
}

/// Times the noise up to which they are worth a count: ten parts in a hundred at most are noise then.
const COUNTED: f64 = 100.0;

/// What a reviewer should know first.
fn headline(judged: &ComparedJoint<'_>) -> String {
    let comparison = judged.comparison;
    let times = comparison.validation.zip(sensor_noise(&judged.joint.trials));
    let followed = comparison.validation.map(|error| error.fit_percent).filter(|part| *part > 0.0);
    let followed = followed
        .map_or_else(String::new, |part| format!("the model follows {part:.0} % of the motion; "));
    let times = times.map(|(error, noise)| error.rmse / noise.max(f64::MIN_POSITIVE));
    let unit = judged.joint.output_unit.as_deref();
    let error = comparison.validation.map(|error| measure(error.rmse, unit)).unwrap_or_default();
    match (comparison.lack_of_fit, times) {
        (Some(test), _) if test.adequate => {
            "the model is adequate: no lack of fit is shown".to_owned()
        }
        // Many times the noise say no more than the error itself.
        (_, Some(times)) if times < COUNTED => {
            format!("{followed}the error is {error}, {} times the noise", number(times.round()))
        }
        (_, Some(_)) if followed.is_empty() => {
            format!("the model follows nothing of the motion; the error is {error}")
        }
        (_, Some(_)) => format!("{followed}the error is {error}"),
        _ => "there is an error that is no noise".to_owned(),
    }
}
