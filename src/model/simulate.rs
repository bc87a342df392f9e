//! What a model says the output is.

use std::iter::Peekable;
use std::slice::Iter;

use super::motion::{Input, Joint, Restart, Surroundings};
use super::{Arrivals, Commands, JointModel};

/// A simulated trial, one value per sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Simulated {
    /// The output as it would be measured, output units.
    pub output: Vec<f64>,
    /// Mean speed of the joint until the next sample, output units per second.
    pub velocity: Vec<f64>,
    /// The input that acts, its delay taken into account, input units.
    pub acting: Vec<f64>,
}

/// Simulates `samples` samples at `period_s` from the levels that arrive.
///
/// Between two samples the input is constant or changes at arrivals; each part is treated
/// on its own, so that delays need not be multiples of the period.
///
/// The first of `restarts` must be at sample 0, else the output starts at zero; there the
/// input has long been held. At the others the output is set anew, and what the effects
/// remember goes on: how fast the joint moves, and where it is in its play. A restart
/// with a speed sets that too, as of an input that has long been held to make it.
///
/// # Accuracy
/// As parts of the largest output, against an integration in steps 100 times finer, at
/// 100 Hz, of a joint with time constants of 0.1 s and more and holds of 0.05 to 1.2 s:
///
/// - exact but for rounding (1e-10): the plain integrator, each effect of the input and of
///   the transport, an end stop, and backlash;
/// - as exact, though the finer integration is not (1e-6): one effect of the dynamics;
/// - 5e-5: effects of the load that depend on angle or time, by the midpoint rule; an oil
///   column, whose period is that of the middle of each interval;
/// - 1e-4: two effects of the dynamics, of which the second sees the mean of the first over
///   each interval; the load or backlash after a dynamic;
/// - 5e-4: an end stop after a dynamic, which the joint leaves at a sample; a corner of the
///   valve's curve after a lag of the spool, which passes it within an interval.
///
/// The last three fall with the square of the period.
pub fn simulate(
    model: &JointModel,
    arrivals: &Arrivals,
    samples: usize,
    period_s: f64,
    restarts: &[Restart],
    surroundings: &Surroundings<'_>,
) -> Simulated {
    let surroundings = *surroundings;
    let driven = [Driven { model, arrivals, restarts, samples, period_s, surroundings }];
    simulate_together(&driven).pop().unwrap_or_default()
}

/// A model, and what drives it, as [`simulate`] takes them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Driven<'a> {
    pub(crate) model: &'a JointModel,
    pub(crate) arrivals: &'a Arrivals,
    pub(crate) restarts: &'a [Restart],
    pub(crate) samples: usize,
    pub(crate) period_s: f64,
    pub(crate) surroundings: Surroundings<'a>,
}

/// [Simulates](simulate) several models, sample by sample beside one another.
///
/// Each sample waits for the one before; with two or more that do not wait for one another a
/// processor has something to do meanwhile.
pub(crate) fn simulate_together(driven: &[Driven<'_>]) -> Vec<Simulated> {
    run::<true>(driven)
}

/// [Simulates](simulate_together) the outputs alone.
pub(crate) fn outputs_together(driven: &[Driven<'_>]) -> Vec<Simulated> {
    run::<false>(driven)
}

/// Models that are simulated beside one another. With 4 of them the slopes of a model with an oil
/// column take two thirds of the time that they take one by one, and with 8 no less.
pub(crate) const BESIDE: usize = 4;

/// With velocity and input where `WHOLE`, else with the output alone.
fn run<const WHOLE: bool>(driven: &[Driven<'_>]) -> Vec<Simulated> {
    let mut simulated = Vec::with_capacity(driven.len());
    for some in driven.chunks(BESIDE) {
        let mut running: Vec<_> = some.iter().map(|one| Running::<WHOLE>::new(*one)).collect();
        let longest = some.iter().map(|one| one.samples).max().unwrap_or(0);
        for sample in 0..longest {
            for one in running.iter_mut().filter(|one| sample < one.samples) {
                one.pass(sample);
            }
        }
        simulated.extend(running.into_iter().map(|one| one.simulated));
    }
    simulated
}

/// A simulation on its way.
struct Running<'a, const WHOLE: bool> {
    joint: Joint<'a>,
    input: Input<'a>,
    restarts: Peekable<Iter<'a, Restart>>,
    others: &'a [f64],
    /// Whether an effect of the model depends on a measured signal.
    is_signal_driven: bool,
    samples: usize,
    period_s: f64,
    simulated: Simulated,
}

impl<'a, const WHOLE: bool> Running<'a, WHOLE> {
    fn new(driven: Driven<'a>) -> Self {
        let Driven { model, arrivals, restarts, samples, period_s, surroundings } = driven;
        let mut joint = Joint::new(model, surroundings);
        joint.settle(arrivals.initial, period_s);
        Self {
            joint,
            input: Input { level: arrivals.initial, coming: &arrivals.changes },
            restarts: restarts.iter().peekable(),
            others: surroundings.others,
            is_signal_driven: model.measured_signals().next().is_some(),
            samples,
            period_s,
            simulated: Simulated::with_capacity(samples, if WHOLE { samples } else { 0 }),
        }
    }

    /// Notes a sample, and lets the time to the next one pass.
    fn pass(&mut self, sample: usize) {
        let Self { joint, input, period_s, simulated, .. } = self;
        let start = sample as f64 * *period_s;
        while let Some(restart) = self.restarts.next_if(|restart| restart.sample <= sample) {
            joint.restart(restart, start, *period_s);
        }
        joint.others = self.others.get(sample).copied().unwrap_or(0.0);
        if self.is_signal_driven {
            joint.observe(sample);
        }
        input.advance(start);
        simulated.output.push(joint.measured);
        let (before, level) = (joint.angle, input.level);
        joint.interval(input, start, (sample + 1) as f64 * *period_s, *period_s);
        if WHOLE {
            simulated.acting.push(level);
            simulated.velocity.push((joint.angle - before) / *period_s);
        }
    }
}

/// [Simulates](simulate) `input`, sampled every `period_s` seconds, from `output` on.
///
/// The first level has long been held; no step's delay is known but from the model.
pub fn simulate_input(
    model: &JointModel,
    input: &[f64],
    period_s: f64,
    output: f64,
    surroundings: &Surroundings<'_>,
) -> Simulated {
    let arrivals = Commands::new(input, period_s).arriving(model, surroundings.start_s, None);
    let begin = [Restart { sample: 0, output, speed: None }];
    simulate(model, &arrivals, input.len(), period_s, &begin, surroundings)
}

impl Simulated {
    /// Adds what comes from sample `sample` on; up to there it is filled with what is not a number.
    pub(crate) fn append_at(&mut self, sample: usize, next: Self) {
        let Self { output, velocity, acting } = next;
        let own = [&mut self.output, &mut self.velocity, &mut self.acting];
        for (own, mut next) in own.into_iter().zip([output, velocity, acting]) {
            if sample == 0 && own.capacity() < next.len() {
                *own = next;
            } else if !next.is_empty() {
                own.resize(sample, f64::NAN);
                own.append(&mut next);
            }
        }
    }

    /// Nothing yet, with room for the outputs of so many samples.
    pub(crate) fn with_room_for(samples: usize) -> Self {
        Self::with_capacity(samples, 0)
    }

    fn with_capacity(samples: usize, others: usize) -> Self {
        Self {
            output: Vec::with_capacity(samples),
            velocity: Vec::with_capacity(others),
            acting: Vec::with_capacity(others),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{
        AccumulatorDroop, ActuatorLag, Creep, DeadBand, Effect, GravityLoad, Resonance,
    };
    use crate::model::Component;

    #[test]
    fn beside_one_another_models_do_what_each_does_by_itself() {
        let with = |effect: &'static dyn Effect, values: &[f64]| {
            let values = values.iter().map(|value| (*value).into()).collect();
            JointModel::integrator(8.0, 0.23).with(Component::new(effect, values).unwrap())
        };
        let models = [
            with(&DeadBand, &[-0.3, 0.4]),
            with(&ActuatorLag, &[0.1]),
            with(&GravityLoad, &[0.4, 20.0, 1.0]),
            with(&Resonance, &[0.3, 0.1]),
            JointModel::integrator(5.0, 0.1),
            with(&DeadBand, &[-0.1, 0.2]),
        ];
        let input: Vec<f64> = (0..400).map(|k| f64::from((k / 70) % 3) - 1.0).collect();
        let surroundings = Surroundings { radians_per_output_unit: 0.017, ..Default::default() };
        let commands = Commands::new(&input, 0.01);
        let arrivals: Vec<_> =
            models.iter().map(|model| commands.arriving(model, 0.0, None)).collect();
        let restarts = [0, 90, 250].map(|sample| Restart { sample, output: 3.0, speed: None });
        let driven: Vec<_> = models
            .iter()
            .zip(&arrivals)
            .zip([400, 13, 350, 400, 1, 260])
            .map(|((model, arrivals), samples)| Driven {
                model,
                arrivals,
                restarts: &restarts,
                samples,
                period_s: 0.01,
                surroundings,
            })
            .collect();
        let together = simulate_together(&driven);
        let outputs = outputs_together(&driven);
        for ((one, all), output) in driven.iter().zip(together).zip(outputs) {
            let Driven { model, arrivals, samples, .. } = *one;
            let alone = simulate(model, arrivals, samples, 0.01, &restarts, &surroundings);
            assert_eq!(all, alone);
            assert_eq!(output.output, alone.output);
        }
    }

    #[test]
    fn what_is_slower_than_the_speed_goes_on_at_a_restart() {
        let slow: [(&'static dyn Effect, [f64; 2]); 2] =
            [(&Creep, [0.4, 0.8]), (&AccumulatorDroop, [0.03, 2.0])];
        for (effect, values) in slow {
            let part = |effect: &'static dyn Effect, values: &[f64]| {
                Component::new(effect, values.iter().map(|value| (*value).into()).collect())
            };
            let model = JointModel::integrator(8.0, 0.1).with(part(effect, &values).unwrap());
            let model = model.with(part(&ActuatorLag, &[0.1]).unwrap());
            let input: Vec<f64> = (0..300).map(|k| if k < 50 { 0.0 } else { 1.5 }).collect();
            let surroundings = Surroundings::default();
            let whole = simulate_input(&model, &input, 0.01, 0.0, &surroundings);
            let here = 140;
            let speed = f64::midpoint(whole.velocity[here - 1], whole.velocity[here]);
            let speeds = [Restart { sample: here, output: whole.output[here], speed: Some(speed) }];
            let arrivals = Commands::new(&input, 0.01).arriving(&model, 0.0, None);
            let again = simulate(&model, &arrivals, input.len(), 0.01, &speeds, &surroundings);
            let id = effect.spec().id;
            let way = whole.output[299] - whole.output[here];
            let off = again.output[299] - whole.output[299];
            assert!(off.abs() < 2e-3 * way, "{id}: off by {off} on a way of {way}");
            // It is not steady there, or nothing would be shown.
            let steady = speed * 0.01 * (299 - here) as f64;
            assert!((way - steady).abs() > 2e-2 * way, "{id}: {steady} {way}");
        }
    }
}
