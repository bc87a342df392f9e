//! How the output of a joint comes to rest, as far as the whole of its record shows it.

use super::input_motion::InputKind;
use super::prepared::Prepared;
use super::settings::Settings;
use super::settling::Settling;
use super::steps::joint_steps;
use super::stops::Stops;
use super::tracking::Tracking;
use crate::experiment::Record;

/// How the output of a joint comes to rest; the first of these that its record shows.
pub(super) enum ComingToRest {
    /// It settles at a level for each level of the input, by an exponential law.
    Settles(Box<Settling>),
    /// It goes where the input says, and stays.
    Tracks(Tracking),
    /// It runs into stops.
    AtStops(Stops),
    /// Nothing is shown, or not to be asked: by the letter of the paper, and of a record that
    /// still grows or has no steps.
    NotShown,
}

impl ComingToRest {
    /// What the `trials` of a joint show.
    pub(super) fn of(trials: &Record, settings: &Settings) -> Self {
        if settings.paper || settings.grows || settings.input == InputKind::Continuous {
            return Self::NotShown;
        }
        // An onset model has responses that settle among others.
        let is_modelled = settings.method.spec().models_response();
        let settles = (!is_modelled).then(|| settling(trials, settings)).flatten();
        if let Some(settling) = settles {
            return Self::Settles(Box::new(settling));
        }
        let steps = joint_steps(trials, settings);
        let at_stops = || Stops::of(trials, &steps).map(Self::AtStops);
        let tracks = Tracking::of(trials, &steps).map(Self::Tracks);
        tracks.or_else(at_stops).unwrap_or(Self::NotShown)
    }

    /// Bounds what says anything of each step of `trial` by where the output comes to rest.
    pub(super) fn bound(&self, trial: &mut Prepared<'_>, settings: &Settings) {
        match self {
            Self::Tracks(tracking) => tracking.bound(trial, settings),
            Self::AtStops(stops) => stops.bound(trial),
            Self::Settles(_) | Self::NotShown => {}
        }
    }

    pub(super) fn settling(&self) -> Option<&Settling> {
        if let Self::Settles(settling) = self { Some(settling) } else { None }
    }

    pub(super) fn tracking(&self) -> Option<Tracking> {
        if let Self::Tracks(tracking) = self { Some(*tracking) } else { None }
    }
}

fn settling(trials: &Record, settings: &Settings) -> Option<Settling> {
    // Most outputs do not settle, which is seen before anything is prepared.
    let bare: Vec<_> = trials.iter().map(|trial| Prepared::bare(trial, settings)).collect();
    let start = Settling::start(trials, &bare, settings)?;
    let prepared = Prepared::all(trials, settings);
    let period = prepared.first()?.period;
    Settling::of(start, &prepared, &settings.at(period))
}
