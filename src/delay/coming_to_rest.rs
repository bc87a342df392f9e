//! How the output of a joint comes to rest, as far as the whole of its record shows it.

use super::input_motion::InputKind;
use super::prepared::Prepared;
use super::settings::Settings;
use super::steps::joint_steps;
use super::stops::Stops;
use super::tracking::Tracking;
use crate::experiment::Record;

/// How the output of a joint comes to rest; the first of these that its record shows.
#[derive(Debug)]
pub(super) enum ComingToRest {
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
            Self::NotShown => {}
        }
    }

    pub(super) fn tracking(&self) -> Option<Tracking> {
        if let Self::Tracks(tracking) = self { Some(*tracking) } else { None }
    }
}
