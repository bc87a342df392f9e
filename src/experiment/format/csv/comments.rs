//! Lines that begin with `#`: comments, and rows that are taken for comments.

use crate::experiment::error::{ReadError, ReadErrorKind};
use crate::experiment::table::Wanted;

/// Comments below the header that may be rows.
#[derive(Default)]
pub(super) struct Comments {
    /// Cells of the header, once it has come.
    pub(super) width: usize,
    /// The first line that may begin with the label of a trial, and that label.
    label: Option<(u64, String)>,
    /// Those as wide as the header, with a number in the second cell: how many, and the first of them.
    wide: (u64, u64),
}

impl Comments {
    /// Notes a comment on the line `row`, whose cells would be parted by `mark`.
    pub(super) fn note(&mut self, line: &[u8], row: u64, mark: u8) {
        let mut cells = line.split(|byte| *byte == mark);
        let label = cells.next().unwrap_or_default();
        let (second, others) = (cells.next(), cells.count());
        let is_label = label.get(1).is_some_and(u8::is_ascii_alphanumeric);
        let Some(second) = second.filter(|_| is_label && self.width > 0) else { return };
        let is_number = |byte: &u8| byte.is_ascii_digit() || b"+-.".contains(byte);
        if others + 2 == self.width && second.trim_ascii().first().is_some_and(is_number) {
            let (count, first) = self.wide;
            self.wide = (count + 1, if count == 0 { row } else { first });
        }
        self.label.get_or_insert_with(|| (row, String::from_utf8_lossy(label).into_owned()));
    }

    /// Refuses a line below the header that may begin with a label, of a table whose rows do.
    pub(super) fn check_labels(&self, wanted: &Wanted<'_>) -> Result<(), ReadError> {
        let Some((row, label)) = self.label.clone().filter(|_| wanted.label == Some(0)) else {
            return Ok(());
        };
        let text = format!(
            "it begins with `{label}`, which may be a comment or the label of a trial; write labels \
             without `#`, and a blank behind the mark of a comment"
        );
        Err(ReadError::new(ReadErrorKind::Shape, text).in_row(row))
    }

    /// Says how many of them are as wide as the rows.
    pub(super) fn on_wide(&self) -> Option<String> {
        match self.wide {
            (0, _) => None,
            (1, row) => Some(format!(
                "row {row} begins with `#` and is left out as a comment, although it has as many \
                 cells as the others"
            )),
            (count, row) => Some(format!(
                "{count} rows begin with `#` and are left out as comments, although they have as \
                 many cells as the others (first at row {row})"
            )),
        }
    }
}
