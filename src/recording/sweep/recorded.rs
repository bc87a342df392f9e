//! What a recording of a sweep is made of.

use crate::delay::sweep::Grid;
use crate::experiment::{ReadOptions, Source};
use crate::report::ReportedSweep;

/// Everything that a recording of a sweep holds.
#[derive(Clone, Copy, Debug)]
pub struct SweepRecording<'a> {
    /// The joints, in the order of their tabs.
    pub joints: &'a [ReportedSweep<'a>],
    /// The settings that were tried.
    pub grid: &'a Grid,
    /// Delays that differ by so many samples more than each allows still agree.
    pub tolerance: f64,
    /// The files that were read.
    pub sources: &'a [Source],
    /// How they were read.
    pub reading: &'a ReadOptions,
}
