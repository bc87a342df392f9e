//! What is mended in a log before its rows are put on a grid: one thing a file, in one order.
//!
//! What depends on the period of the clock, as rows that are lost or out of order, is seen where the
//! stamps are read: in [`super::clock`].

mod bursts;
mod midnight;
mod newest_first;
mod repair;
mod rezeroed;
mod same_time;
mod single_rows;
mod slow_sensor;
mod split_stamp;
mod wrap;

use super::error::ReadError;
use super::grid::Repair as Options;
use super::log::Log;
use bursts::Bursts;
use midnight::Midnight;
use newest_first::NewestFirst;
use repair::Repair;
use rezeroed::Rezeroed;
use same_time::SameTime;
use single_rows::SingleRows;
use slow_sensor::SlowSensor;
use split_stamp::SplitStamp;
use wrap::Wrapped;

/// When something is mended, and how.
type Step = (fn(Options) -> bool, fn(&mut Log<'_>) -> Result<(), ReadError>);

/// In this order: the rows before their times, the times before the signals.
const IN_ORDER: [Step; 10] = [
    (always, mend::<SplitStamp>),
    (once_whole, mend::<NewestFirst>),
    (always, |log| log.read_times()),
    (always, mend::<Midnight>),
    (always, mend::<SingleRows>),
    (once_whole, mend::<SameTime>),
    (once_whole, mend::<Bursts>),
    (Options::is_free, mend::<SlowSensor>),
    // A turn is a jump, too: what it leaves over may be a sensor whose zero was set anew.
    (once_whole, mend::<Wrapped>),
    (once_whole, mend::<Rezeroed>),
];

fn always(_: Options) -> bool {
    true
}

/// What depends on rows that a growing log does not have yet is not mended in one.
fn once_whole(options: Options) -> bool {
    !options.as_it_stands
}

/// Mends everything in `log` that may be.
///
/// # Errors
/// [`ReadError`] where its times cannot be read.
pub(super) fn mend_all(log: &mut Log<'_>) -> Result<(), ReadError> {
    let options = log.options;
    let mut steps = IN_ORDER.iter().filter(|(is_done, _)| is_done(options));
    steps.try_for_each(|(_, step)| step(log))
}

#[expect(
    clippy::unnecessary_wraps,
    reason = "the times may not be read, and are a step like the others"
)]
fn mend<R: Repair>(log: &mut Log<'_>) -> Result<(), ReadError> {
    let found: Vec<R> = R::detect(log).into_iter().collect();
    for fault in found {
        let note = fault.apply(log);
        log.notes.extend(note);
    }
    Ok(())
}
