//! What is mended in a log before its rows are put on a grid: one thing a file, in one order.
//!
//! What depends on the period of the clock, as rows that are lost or out of order, is seen where the
//! stamps are read: in [`super::clock`].

mod bursts;
mod copies;
mod midnight;
mod newest_first;
mod rezeroed;
mod single_rows;
mod slow_sensor;
mod split_stamp;
mod wrap;

use super::error::ReadError;
use super::grid::Repair as Options;
use super::log::Log;
use bursts::Bursts;
use copies::Copies;
use midnight::Midnight;
use newest_first::NewestFirst;
use rezeroed::Rezeroed;
use single_rows::SingleRows;
use slow_sensor::SlowSensor;
use split_stamp::SplitStamp;
use wrap::Wrapped;

/// A fault that logs of some kind have, as it was found in one.
trait Repair: Sized {
    /// Whether it may be mended. What depends on rows that a growing log does not have yet may not.
    fn is_allowed(options: Options) -> bool {
        !options.as_it_stands
    }

    /// Where the fault is.
    fn detect(log: &Log<'_>) -> Vec<Self>;

    /// Mends it, and says what was done where a reader of the log should know.
    fn apply(self, log: &mut Log<'_>) -> Option<String>;
}

type Step = fn(&mut Log<'_>) -> Result<(), ReadError>;

/// In this order: the rows before their times, the times before the signals.
const IN_ORDER: [Step; 10] = [
    mend::<SplitStamp>,
    mend::<NewestFirst>,
    |log| log.read_times(),
    mend::<Midnight>,
    mend::<SingleRows>,
    mend::<Copies>,
    mend::<Bursts>,
    mend::<SlowSensor>,
    // A turn is a jump, too: what it leaves over may be a sensor whose zero was set anew.
    mend::<Wrapped>,
    mend::<Rezeroed>,
];

/// Mends everything in `log` that may be.
///
/// # Errors
/// [`ReadError`] where its times cannot be read.
pub(super) fn mend_all(log: &mut Log<'_>) -> Result<(), ReadError> {
    IN_ORDER.iter().try_for_each(|step| step(log))
}

fn mend<R: Repair>(log: &mut Log<'_>) -> Result<(), ReadError> {
    if R::is_allowed(log.options) {
        for found in R::detect(log) {
            let note = found.apply(log);
            log.notes.extend(note);
        }
    }
    Ok(())
}
