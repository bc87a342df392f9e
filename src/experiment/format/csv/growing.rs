//! The rows of a text that still grows.

use std::ops::ControlFlow;
use std::path::Path;

use super::super::blanks::tabbed;
use super::super::spelling::Spelling;
use super::super::text::SNIFFED_BYTES;
use super::gathered::Gathered;
use super::header::{check_header_size, check_last_name, check_parted, describes, head};
use super::lines::{Piece, Place, Taken, each};
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::experiment::source::Source;
use crate::experiment::table::{Head, Table, Wanted};

/// The rows of a text that still grows: each is parsed once, when it has come whole.
pub(in crate::experiment) struct GrowingRows {
    budget: Budget,
    /// What came first, by which the spelling is known: all that came, until it is full.
    start: Vec<u8>,
    spelling: Spelling,
    /// What was not parsed yet.
    text: Vec<u8>,
    /// Lines before it.
    lines: u64,
    /// The header, once a whole row stands below it.
    head: Option<Head>,
    /// Rows of words between the header and that row.
    above: Vec<(csv::ByteRecord, Place)>,
    gathered: Option<Gathered>,
}

impl GrowingRows {
    /// Nothing has come yet.
    pub(in crate::experiment) fn new(budget: Budget) -> Self {
        let (start, text) = (Vec::new(), Vec::new());
        let spelling = Spelling::of(b"", None);
        Self {
            budget,
            start,
            spelling,
            text,
            lines: 0,
            head: None,
            above: Vec::new(),
            gathered: None,
        }
    }

    /// Adds whole lines.
    pub(in crate::experiment) fn push(&mut self, lines: &[u8]) {
        self.take(lines);
        let room = SNIFFED_BYTES - self.start.len();
        if room == 0 {
            return;
        }
        let (sniffed, others) = lines.split_at(lines.len().min(room));
        self.start.extend_from_slice(sniffed);
        let spelling = Spelling::of(&self.start, None);
        if spelling != self.spelling {
            // What was a table so far stands before it, or its cells are parted otherwise.
            let all = [self.start.as_slice(), others].concat();
            let (before, lines) = spelling.preamble;
            let (start, budget) = (std::mem::take(&mut self.start), self.budget.rest());
            *self = Self { start, spelling, lines, ..Self::new(budget) };
            self.take(all.get(before..).unwrap_or_default());
        }
    }

    fn take(&mut self, lines: &[u8]) {
        if self.spelling.is_of_blanks() {
            self.text.extend(tabbed(lines));
        } else {
            self.text.extend_from_slice(lines);
        }
    }

    /// Bytes that were not parsed yet: of a row that is not whole, or that is wrong, and of
    /// words that may stand below the table.
    pub(in crate::experiment) fn waiting(&self) -> usize {
        self.text.len()
    }

    /// The header; `None` as long as it has not come.
    pub(in crate::experiment) fn head(&mut self, path: &Path) -> Result<Option<Head>, ReadError> {
        if self.head.is_some() {
            return Ok(self.head.clone());
        }
        let (mut found, mut below, mut above) = (None, false, Vec::new());
        let delimiter = self.spelling.mark();
        let mut sought = |record: &csv::ByteRecord, place: &Place| {
            let Some(known) = &mut found else {
                check_header_size(path, record.len(), &self.budget)?;
                found = Some(head(path, record, place.row)?);
                return Ok(ControlFlow::Continue(Taken::Done));
            };
            if above.is_empty() {
                check_parted(known, record)?;
            }
            if describes(known, record, delimiter, above.len()) {
                above.push((record.clone(), *place));
                return Ok(ControlFlow::Continue(Taken::Done));
            }
            check_last_name(known, record, place.row)?;
            below = true;
            Ok(ControlFlow::Break(Taken::Held))
        };
        let taken = each(self.piece(), delimiter, (path, None), &mut sought)?;
        if below {
            self.drop_parsed(taken);
            self.head.clone_from(&found);
            self.above = above;
        }
        Ok(found)
    }

    /// All rows that have come whole, of this much of the file.
    pub(in crate::experiment) fn read(
        &mut self,
        wanted: &Wanted<'_>,
        source: Source,
    ) -> Result<&Table, ReadError> {
        let (delimiter, budget) = (self.spelling.mark(), self.budget.rest());
        let gathered = self.gathered.take();
        let mut gathered = gathered.unwrap_or_else(|| {
            let mut gathered = Gathered::new(wanted, delimiter, budget);
            gathered.note_above(&self.above, wanted);
            gathered
        });
        gathered.take_held_back();
        let mut failure = None;
        let mut gather = |record: &csv::ByteRecord, place: &Place| {
            if gathered.holds_back(record, place, wanted)? {
                return Ok(ControlFlow::Continue(Taken::Held));
            }
            let released = gathered.release(wanted);
            Ok(match released.and_then(|()| gathered.take(record, place, wanted)) {
                Ok(()) => ControlFlow::Continue(Taken::Done),
                Err(error) => {
                    failure = Some(error);
                    ControlFlow::Break(Taken::Held)
                }
            })
        };
        // Until a row stands below it, the header is found anew each time.
        if self.head.is_some() {
            let taken = each(self.piece(), delimiter, (wanted.path(), Some(wanted)), &mut gather)?;
            self.drop_parsed(taken);
        }
        let gathered = self.gathered.insert(gathered);
        failure.map_or_else(|| Ok(gathered.table_of(source)), Err)
    }

    /// What was not parsed yet.
    fn piece(&self) -> Piece<'_> {
        Piece { text: &self.text, lines: self.lines, is_begun: self.head.is_some() }
    }

    fn drop_parsed(&mut self, bytes: usize) {
        let lines = self.text.drain(..bytes).filter(|byte| *byte == b'\n');
        self.lines += lines.fold(0, |count, _| count + 1);
    }
}
