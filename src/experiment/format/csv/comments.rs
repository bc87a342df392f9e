//! Lines that begin with `#`: comments, values that are none, and rows that are taken for comments.

use std::collections::BTreeMap;

use super::super::cell::NO_VALUES;
use crate::experiment::error::ReadError;
use crate::experiment::table::Wanted;

/// Comments that may be rows.
#[derive(Default)]
pub(super) struct Comments {
    /// Whether a line has come that is none.
    is_behind_others: bool,
    /// The first line that may begin with the label of a trial, and that label.
    label: Option<(u64, String)>,
    /// Of the lines behind others, with a number in the second of so many cells: how many they are, and
    /// the first of them.
    wide: BTreeMap<usize, (u64, u64)>,
}

impl Comments {
    /// Notes the comments among the lines of `bytes`, of which the first one that begins there does so
    /// at `start` and is in this row or, where it does not begin at once, behind it.
    pub(super) fn note(&mut self, bytes: &[u8], (start, row): (Option<usize>, u64), mark: u8) {
        if !bytes.contains(&b'#') {
            self.is_behind_others |= !bytes.is_empty();
            return;
        }
        let (mut start, mut row, mut counted) = (start, row, 0);
        while let Some(at) = start.filter(|at| *at < bytes.len()) {
            row += bytes[counted..at].iter().fold(0, |sum, byte| sum + u64::from(*byte == b'\n'));
            counted = at;
            let end = bytes[at..].iter().position(|byte| is_line_end(*byte));
            let line = &bytes[at..end.map_or(bytes.len(), |end| at + end)];
            if line.first() == Some(&b'#') {
                self.note_line(line, row, mark);
            } else {
                self.is_behind_others |= !line.is_empty();
            }
            start = next_line(bytes, at);
        }
    }

    fn note_line(&mut self, line: &[u8], row: u64, mark: u8) {
        let Some(label) = label_of(line, mark) else { return };
        let cells = || line.split(|byte| *byte == mark);
        let is_number = |cell: &[u8]| {
            cell.trim_ascii()
                .first()
                .is_some_and(|byte| byte.is_ascii_digit() || b"+-.".contains(byte))
        };
        if self.is_behind_others && cells().nth(1).is_some_and(is_number) {
            self.wide.entry(cells().count()).or_insert((0, row)).0 += 1;
        }
        if self.label.is_none() {
            self.label = Some((row, String::from_utf8_lossy(label).into_owned()));
        }
    }

    /// Refuses a line below the header that may begin with a label, of a table whose rows do.
    pub(super) fn check_labels(&self, wanted: &Wanted<'_>) -> Result<(), ReadError> {
        let below = self.label.as_ref().filter(|(row, _)| *row > wanted.head.header_row);
        match below.filter(|_| wanted.label == Some(0)) {
            Some((row, label)) => Err(ReadError::LabelOrComment {
                path: wanted.path().to_owned(),
                row: *row,
                label: label.clone(),
            }),
            None => Ok(()),
        }
    }

    /// Says how many of them are as wide as the rows.
    pub(super) fn on_wide(&self, wanted: &Wanted<'_>) -> Option<String> {
        let (count, row) = self.wide.get(&wanted.head.headers.len())?;
        let path = wanted.path().display();
        let says = match count {
            1 => {
                format!(
                    "row {row} begins with `#` and is left out as a comment, although it has as many \
                 cells as the others"
                )
            }
            _ => format!(
                "{count} rows begin with `#` and are left out as comments, although they have as \
                 many cells as the others (first at row {row})"
            ),
        };
        Some(format!("{path}: {says}"))
    }
}

/// The first cell of a line of several, where it begins with the mark of a comment and no blank behind it.
fn label_of(line: &[u8], mark: u8) -> Option<&[u8]> {
    let label = line.split(|byte| *byte == mark).next()?;
    let is_parted = line.len() > label.len();
    let is_label = label.strip_prefix(b"#")?.first().is_some_and(u8::is_ascii_alphanumeric);
    (is_parted && is_label).then_some(label)
}

/// Whether a line begins with the cell of a value that is none.
fn begins_without_value(line: &[u8]) -> bool {
    let behind = |cell: &&str| line.strip_prefix(b"#")?.strip_prefix(cell.as_bytes());
    let ends = |rest: &[u8]| rest.first().is_none_or(|byte| b",;|\t\r\n".contains(byte));
    NO_VALUES.iter().filter_map(behind).any(ends)
}

/// Puts a blank for the mark of each line that begins with a value that is none, and a line feed for a
/// carriage return that ends a comment alone, which would else go on to the next line feed. How many bytes
/// are known to be right: a comment whose end has not come is not.
pub(super) fn without_marks(bytes: &mut [u8], last: u8, end: End) -> usize {
    // Most texts have no comment at all.
    if !bytes.contains(&b'#') {
        return bytes.len();
    }
    let mut start = first_line(bytes, last);
    while let Some(at) = start {
        let line = bytes.get(at..).unwrap_or_default();
        if line.first() == Some(&b'#') {
            let line_end = line.iter().position(|byte| is_line_end(*byte));
            // Behind a carriage return there may be a line feed.
            let is_known = line_end.is_some_and(|end| end + 1 < line.len());
            if !is_known && end == End::Open {
                return at;
            }
            let is_alone = |end: &usize| {
                line.get(*end) == Some(&b'\r')
                    && line.get(*end + 1).is_some_and(|next| *next != b'\n')
            };
            let alone = line_end.filter(is_alone).map(|end| at + end);
            let mark = begins_without_value(line).then_some((at, b' '));
            for (place, byte) in mark.into_iter().chain(alone.map(|place| (place, b'\n'))) {
                if let Some(old) = bytes.get_mut(place) {
                    *old = byte;
                }
            }
        }
        start = next_line(bytes, at);
    }
    bytes.len()
}

/// Whether more bytes may follow.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    Open,
    Come,
}

/// Where the first line begins of bytes behind the byte `last`.
pub(super) fn first_line(bytes: &[u8], last: u8) -> Option<usize> {
    if is_line_end(last) { Some(0) } else { next_line(bytes, 0) }
}

fn is_line_end(byte: u8) -> bool {
    byte == b'\n' || byte == b'\r'
}

/// Where the next line begins behind the byte `from`.
fn next_line(bytes: &[u8], from: usize) -> Option<usize> {
    let behind = bytes.get(from..)?.iter().position(|byte| is_line_end(*byte))?;
    Some(from + behind + 1).filter(|start| *start < bytes.len())
}
