//! The parameters that a fit may change, and how far.

use nalgebra::DVector;

use super::bounds::Bounds;
use crate::effect::{Dimension, Parameter, RecordRange, Stage};
use crate::model::{Component, JointModel};

/// The free parameters of a model and their bounds.
pub(super) struct Space {
    /// Index in [`JointModel::values`] of each free parameter.
    pub(super) free: Vec<usize>,
    pub(super) bounds: Vec<Bounds>,
    /// For each of them how the effect jumps with it.
    jumps: Vec<Jumps>,
    /// For each of them the values that the record reaches, where it is a level of the input or
    /// a limit of the output.
    reach: Vec<Bounds>,
}

/// How an effect jumps with one of its parameters.
#[derive(Clone, Debug, Default)]
struct Jumps {
    /// A value between each two jumps; none where there are none.
    between: Vec<f64>,
    /// Whether the error depends on the parameter between two jumps, too.
    is_sloped: bool,
}

impl Space {
    pub(super) fn of(model: &JointModel, range: &RecordRange<'_>) -> Self {
        /// No joint of this kind reacts later than this.
        const LONGEST_DELAY_S: f64 = 5.0;
        /// Nor does a slower process, a tank or a furnace, than so many of the samples that were
        /// thought enough for it.
        const LONGEST_DELAY: f64 = 100.0;
        let longest_s = LONGEST_DELAY_S.max(LONGEST_DELAY * range.sample_period_s);
        let delay = (0.0, longest_s.min(0.5 * range.duration_s));
        // Beside measured delays it would only make up for those that are not known.
        let has_delay = !model.takes_measured_delays();
        let mut bounds = vec![(f64::MIN, f64::MAX, true), (delay.0, delay.1, has_delay)];
        for component in model.components() {
            let effect = component.effect();
            let has_law = !component.takes_measured_delays();
            let parameters = effect.spec().parameters.iter();
            let fitted = parameters.map(|parameter| parameter.fitted && has_law);
            bounds
                .extend(effect.bounds(range).into_iter().zip(fitted).map(|((l, h), f)| (l, h, f)));
        }
        let values = model.values();
        let all = bounds.iter().zip(&values).enumerate();
        let free = all.filter(|(_, ((_, _, fitted), value))| *fitted && !value.fixed);
        let (free, bounds): (Vec<_>, Vec<_>) = free
            .map(|(index, ((low, high, _), value))| {
                let low = value.min.map_or(*low, |min| min.max(*low));
                let high = value.max.map_or(*high, |max| max.min(*high));
                (index, Bounds { low, high })
            })
            .unzip();
        let jumps = free.iter().zip(&bounds).map(|(index, bounds)| {
            let jumps = jumps(model, *index, range);
            Jumps { between: bounds.within(&jumps.between), ..jumps }
        });
        let jumps = jumps.collect();
        let reach = free.iter().map(|index| reach(model, *index, range)).collect();
        Self { free, bounds, jumps, reach }
    }

    /// A value of a free parameter between each two at which the effect jumps; none where it does not.
    pub(super) fn between_jumps(&self, free: usize) -> &[f64] {
        self.jumps.get(free).map_or(&[], |jumps| &jumps.between)
    }

    /// Whether an effect jumps with a free parameter.
    pub(super) fn has_jumps(&self) -> bool {
        self.jumps.iter().any(|jumps| !jumps.between.is_empty())
    }

    /// About how far apart the jumps beside `value` of a free parameter are, where the error depends on it between
    /// them, too.
    pub(super) fn width_between_jumps(&self, free: usize, value: f64) -> Option<f64> {
        let between = self.between_jumps(free);
        let above = between.partition_point(|place| *place < value);
        let (low, high) = (above.checked_sub(1)?, above.min(between.len() - 1));
        let [low, high] = [between.get(low)?, between.get(high)?];
        (self.is_sloped(free) && low < high).then_some(high - low)
    }

    /// Whether the error depends on such a parameter between two jumps, too.
    pub(super) fn is_sloped(&self, free: usize) -> bool {
        self.jumps.get(free).is_some_and(|jumps| jumps.is_sloped)
    }

    /// Whether the record never reaches such a value of a free parameter.
    pub(super) fn is_beyond_reach(&self, free: usize, value: f64) -> bool {
        self.reach[free].clamped(value).total_cmp(&value).is_ne()
    }

    /// This space with the values that lie outside of their bounds held where they are.
    pub(super) fn holding(&self, values: &[f64]) -> Self {
        let pairs = self.free.iter().zip(&self.bounds);
        let bounds = pairs.map(|(index, bounds)| bounds.holding(values[*index]));
        let (free, jumps, reach) = (self.free.clone(), self.jumps.clone(), self.reach.clone());
        Self { free, bounds: bounds.collect(), jumps, reach }
    }

    /// The free ones of all `values`, within their bounds.
    pub(super) fn within(&self, values: &[f64]) -> DVector<f64> {
        let pairs = self.free.iter().zip(&self.bounds);
        DVector::from_vec(pairs.map(|(index, bounds)| bounds.clamped(values[*index])).collect())
    }

    /// All values of the model, with the free ones as in `free`.
    pub(super) fn values(&self, start: &[f64], free: &DVector<f64>) -> Vec<f64> {
        let mut values = start.to_vec();
        for (index, value) in self.free.iter().zip(free.iter()) {
            values[*index] = *value;
        }
        values
    }
}

/// The values of a parameter of `model` that the record reaches: a level beyond all of the input,
/// or a limit of the output where it never comes, changes at most what cannot be distinguished from it.
fn reach(model: &JointModel, index: usize, range: &RecordRange<'_>) -> Bounds {
    /// What noise may have put the output beyond its limit by, in parts of its span.
    const NOISE: f64 = 0.01;
    let all = Bounds { low: f64::NEG_INFINITY, high: f64::INFINITY };
    let Some((component, parameter)) = place(model, index) else { return all };
    let spec = component.effect().spec();
    match parameter.dimension {
        Dimension::Input if spec.stage == Stage::Input => {
            // Levels count from the neutral, and an offset is what takes the input there.
            let (most, neutral) = (range.input_abs_max, range.input_neutral);
            Bounds { low: -most - neutral.max(0.0), high: most - neutral.min(0.0) }
        }
        Dimension::Output if spec.acts_on_state => {
            let noise = NOISE * range.output_span();
            Bounds { low: range.output_min - noise, high: range.output_max + noise }
        }
        _ => all,
    }
}

/// How an effect of `model` jumps with one of its values. A threshold does the same anywhere in the gap
/// between two levels of the input.
fn jumps(model: &JointModel, index: usize, range: &RecordRange<'_>) -> Jumps {
    let Some((component, parameter)) = place(model, index) else { return Jumps::default() };
    let effect = component.effect();
    let spec = effect.spec();
    if parameter.dimension == Dimension::Input && spec.stage != Stage::Spool {
        return Jumps { between: range.thresholds(usize::MAX), is_sloped: false };
    }
    let at = spec.parameters.iter().position(|one| std::ptr::eq(one, parameter));
    let between = at.map_or_else(Vec::new, |at| effect.jumps(at, range));
    Jumps { between, is_sloped: true }
}

/// The effect of which a value of `model` is a parameter, and this.
pub(super) fn place(model: &JointModel, index: usize) -> Option<(&Component, &'static Parameter)> {
    let of = |component| {
        let parameters = Component::effect(component).spec().parameters.iter();
        parameters.map(move |parameter| (component, parameter))
    };
    model.components().iter().flat_map(of).nth(index.checked_sub(2)?)
}
