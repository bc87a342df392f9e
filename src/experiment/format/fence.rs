//! A fence around the libraries that read formats: where one of them panics over a damaged file,
//! the file is refused like any other that cannot be read.
//!
//! Of the parquet crate (60.1.0) three such places are known: a page of dictionary indices
//! without a dictionary, numbers that are cut short, and a byte stream split of an uneven length.
//! Where overflows are checked, there is a fourth, and three in calamine (0.38.0). A file for each of
//! them is in `fuzz/found`.

use std::any::Any;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

use crate::experiment::error::ReadError;
use crate::experiment::table::Opened;

/// Opens a log by `open`, the reader of `format`, and fences what reads its rows, too.
pub(super) fn open(
    format: &'static str,
    open: impl FnOnce() -> Result<Opened, ReadError>,
) -> Result<Opened, ReadError> {
    let (head, read_rows) = fenced(format, open)?;
    Ok((head, Box::new(move |wanted| fenced(format, || read_rows(wanted)))))
}

/// Does `work`, of which nothing is left where it panics.
fn fenced<T>(format: &str, work: impl FnOnce() -> Result<T, ReadError>) -> Result<T, ReadError> {
    keep_quiet();
    let before = IS_FENCED.replace(true);
    let done = catch_unwind(AssertUnwindSafe(work));
    IS_FENCED.set(before);
    done.unwrap_or_else(|panic| {
        let reason = format!("its reader broke off: {}", message(panic.as_ref()));
        let remedy = "write it again: it is damaged, or of a kind that is not read";
        Err(ReadError::format(format, reason, remedy))
    })
}

thread_local! {
    static IS_FENCED: Cell<bool> = const { Cell::new(false) };
}

/// What panics within the fence is said once, as an error.
fn keep_quiet() {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if !IS_FENCED.get() {
                usual(panic);
            }
        }));
    });
}

/// What a panic said.
fn message(panic: &dyn Any) -> &str {
    let literal = panic.downcast_ref::<&str>().copied();
    let text = panic.downcast_ref::<String>().map(String::as_str);
    literal.or(text).unwrap_or("no reason is given")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reader_that_panics_refuses_its_file() {
        let broken =
            fenced("Parquet", || -> Result<(), ReadError> { panic!("no dictionary for {}", 3) });
        let message = broken.unwrap_err().to_string();
        assert_eq!(
            message,
            ": cannot be read as Parquet: its reader broke off: no dictionary for 3; \
             write it again: it is damaged, or of a kind that is not read"
        );
        assert!(!IS_FENCED.get());
        assert!(fenced("Parquet", || Ok(1)).is_ok_and(|one| one == 1));
    }
}
