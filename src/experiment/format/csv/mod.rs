//! Tables of text: delimiter, cells, line numbers.

mod gathered;
mod header;
mod lines;

use std::io::{self, Read as _};
use std::path::Path;

use super::spelling::Spelling;
use super::text::Bytes;
use crate::experiment::error::ReadError;
use crate::experiment::memory::Budget;
use crate::experiment::table::{Opened, Wanted};
use gathered::Gathered;
use header::{check_last_name, describes, head};
use lines::Records;

/// Opens the log and reads its header.
pub(super) fn open(path: &Path, budget: &Budget) -> Result<Opened, ReadError> {
    let (bytes, start) = Bytes::open(path)?;
    table(bytes, &start, None, budget)
}

/// Reads the header of a text that begins with `start`, whose cells are parted by `delimiter` where that
/// is known.
pub(super) fn table(
    mut bytes: Bytes,
    start: &[u8],
    delimiter: Option<u8>,
    budget: &Budget,
) -> Result<Opened, ReadError> {
    if start.contains(&b'\r') && !start.contains(&b'\n') {
        let reason = "its lines end with carriage returns alone";
        return Err(ReadError::format("a table of text", reason, "save it with line feeds"));
    }
    let (spelling, is_text) = (Spelling::of(start, delimiter), delimiter.is_none());
    let (before, _) = spelling.preamble;
    io::copy(&mut bytes.by_ref().take(before as u64), &mut io::sink())?;
    let delimiter = spelling.delimiter;
    let mut records = Records::of(bytes, spelling, budget);
    let place = records.next()?.ok_or_else(ReadError::empty)?;
    let mut head = head(&records.record, place.row)?;
    // Rows of words between the header and the first row.
    let mut above = Vec::new();
    let mut next = records.next()?;
    while let Some(place) = next {
        if !describes(&mut head, &records.record, delimiter, above.len()) {
            // Sheets say which cell is of which column.
            if is_text {
                check_last_name(&head, &records.record, place.row)?;
            }
            break;
        }
        above.push((records.record.clone(), place));
        next = records.next()?;
    }
    let read_rows = move |wanted: &Wanted<'_>| {
        let mut gathered = Gathered::new(wanted, delimiter);
        gathered.note_above(&above);
        while let Some(place) = next.filter(|place| !(place.is_open && wanted.grows)) {
            gathered.add(&records.record, place)?;
            next = records.next()?;
        }
        Ok(gathered.finish(records.into_bytes().finish()?))
    };
    Ok((head, Box::new(read_rows)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::table::{BadCell, OpenTable};
    use crate::experiment::{MemoryLimit, Repair};

    #[test]
    fn rows_are_the_lines_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let text = "# made by hand\nt,a\n0,1\n# pause\n\n1,2\n2,x";
        let mixed = text.replacen('\n', "\r\n", 2);
        for text in [text.to_owned(), format!("{text}\n"), text.replace('\n', "\r\n"), mixed] {
            std::fs::write(&path, &text).unwrap();
            let budget = Budget::new(MemoryLimit::default());
            let open = OpenTable::new(open(&path, &budget).unwrap(), budget);
            assert_eq!(open.head.header_row, 2, "{text:?}");
            let table = open.read(&[0, 1], [None, Some(0)], 0, Repair::default()).unwrap();
            assert_eq!(table.rows, [3, 6, 7], "{text:?}");
            assert_eq!(table.columns[1].error, Some((7, BadCell::Text("x".to_owned()))));
        }
    }
}
