//! Tables of text: delimiter, cells, line numbers.

mod comments;
mod gathered;
mod growing;
mod header;
mod lines;
mod milliseconds;

use std::io::{self, Read as _};
use std::path::Path;

use super::spelling::{Spelling, is_over_lines};
use super::text::Bytes;
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::experiment::table::{OpenTable, Rows, Table, Wanted};
use gathered::{Gathered, memory_of};
use header::{check_header_size, check_last_name, check_parted, describes, head};
use lines::{LineEnds, Lines, Place, next, place_just_read, reader};

pub(in crate::experiment) use growing::GrowingRows;

/// What follows the header, still unread.
struct Unread {
    reader: csv::Reader<Lines<Bytes>>,
    delimiter: u8,
    /// Rows of words between the header and the first row.
    above: Vec<(csv::ByteRecord, Place)>,
    /// The first row.
    first: Option<(csv::ByteRecord, Place)>,
    budget: Budget,
}

/// Opens the log and reads its header.
pub(super) fn open(path: &Path, budget: Budget) -> Result<OpenTable, ReadError> {
    let (bytes, start) = Bytes::open(path)?;
    table(path, bytes, &start, None, budget)
}

/// Reads the header of a text that begins with `start`, whose cells are parted by `delimiter` where that
/// is known.
pub(super) fn table(
    path: &Path,
    mut bytes: Bytes,
    start: &[u8],
    delimiter: Option<u8>,
    budget: Budget,
) -> Result<OpenTable, ReadError> {
    let io_error = |source| ReadError::Io { path: path.to_owned(), source };
    let (spelling, is_text) = (Spelling::of(start, delimiter), delimiter.is_none());
    let (delimiter, (before, lines)) = (spelling.mark(), spelling.preamble);
    io::copy(&mut bytes.by_ref().take(before as u64), &mut io::sink()).map_err(io_error)?;
    if spelling.is_of_blanks() {
        bytes = bytes.tabbed(path);
    }
    let lines = LineEnds::after(bytes, lines).within(&budget);
    let mut reader = reader(delimiter, lines);
    let mut record = csv::ByteRecord::new();
    if !next(&mut reader, &mut record, path)? {
        return Err(ReadError::Empty { path: path.to_owned() });
    }
    check_header_size(path, record.len(), &budget)?;
    let mut head = head(path, &record, place_just_read(&mut reader, &record).row)?;
    let (mut above, mut first) = (Vec::new(), None);
    while first.is_none() && next(&mut reader, &mut record, path)? {
        if above.is_empty() {
            check_parted(&head, &record)?;
        }
        budget.take(memory_of(&record)).map_err(|error| error.refuse(path))?;
        let row = (record.clone(), place_just_read(&mut reader, &record));
        if describes(&mut head, &record, delimiter, above.len()) {
            above.push(row);
        } else {
            // Sheets say which cell is of which column.
            if is_text {
                check_last_name(&head, &record, row.1.row)?;
            }
            first = Some(row);
        }
    }
    Ok(OpenTable { head, rows: Box::new(Unread { reader, delimiter, above, first, budget }) })
}

impl Rows for Unread {
    fn read(mut self: Box<Self>, wanted: &Wanted<'_>) -> Result<Table, ReadError> {
        let mut gathered = Gathered::new(wanted, self.delimiter, self.budget.rest());
        gathered.note_above(&self.above, wanted);
        if let Some((record, place)) = self.first.take() {
            gathered.take(&record, &place, wanted)?;
        }
        let mut record = csv::ByteRecord::new();
        while next(&mut self.reader, &mut record, wanted.path())? {
            let place = place_just_read(&mut self.reader, &record);
            if gathered.holds_back(&record, &place, wanted)? {
                continue;
            }
            gathered.release(wanted)?;
            if let Err(error) = gathered.take(&record, &place, wanted) {
                if !self.is_cut_off(&record, wanted)? {
                    return Err(error);
                }
                gathered.table.notes.push(format!(
                    "{}: the last row, {}, is cut off and left out",
                    wanted.path().display(),
                    place.row
                ));
            }
        }
        let comments = self.reader.get_ref().get_ref().0.comments();
        comments.check_labels(wanted)?;
        gathered.table.notes.extend(comments.on_wide(wanted));
        gathered.leave_out(wanted);
        let bytes = self.reader.into_inner().into_inner().0.inner;
        gathered.table_of(bytes.finish(wanted.path())?);
        Ok(gathered.table)
    }
}

impl Unread {
    /// Whether the row just read is the last one, and was not written to its end.
    fn is_cut_off(
        &mut self,
        record: &csv::ByteRecord,
        wanted: &Wanted<'_>,
    ) -> Result<bool, ReadError> {
        let is_short = record.len() < wanted.head.headers.len() && !is_over_lines(record);
        let is_last =
            is_short && !next(&mut self.reader, &mut csv::ByteRecord::new(), wanted.path())?;
        Ok(is_last && self.reader.get_mut().get_mut().0.last != b'\n')
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::MemoryLimit;
    use crate::experiment::table::BadCell;

    #[test]
    fn rows_are_the_lines_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let text = "# made by hand\nt,a\n0,1\n# pause\n\n1,2\n2,x";
        let mixed = text.replacen('\n', "\r\n", 2);
        for text in [text.to_owned(), format!("{text}\n"), text.replace('\n', "\r\n"), mixed] {
            std::fs::write(&path, &text).unwrap();
            let open = open(&path, Budget::new(MemoryLimit::default())).unwrap();
            assert_eq!(open.head.header_row, 2, "{text:?}");
            let table = open.read(&[0, 1], None, Some(0), 0).unwrap();
            let rows = [0, 1, 2].map(|index| table.rows.number(index));
            assert_eq!((table.rows.len(), rows), (3, [3, 6, 7]), "{text:?}");
            assert_eq!(table.columns[1].error, Some((7, BadCell::Text("x".to_owned()))));
        }
    }
}
