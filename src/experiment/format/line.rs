//! Lines of a table, parted into cells.

/// What stands for runs of blanks and tabs between cells.
pub(super) const BLANK: u8 = b' ';

/// Parts the lines of a row into `cells`, which may stand between quotation marks; whether all of these are
/// closed.
///
/// Blanks at the ends of a line make no cell, those before the bracket of a unit part none, and where blanks
/// part cells a line end closes a quotation.
pub(super) fn part(text: &[u8], mark: u8, cells: &mut csv::ByteRecord) -> bool {
    cells.clear();
    let text = text.strip_suffix(b"\n").unwrap_or(text);
    let text = text.strip_suffix(b"\r").unwrap_or(text);
    if mark != BLANK && !text.contains(&b'"') {
        text.split(|byte| *byte == mark).for_each(|cell| cells.push_field(cell));
        return true;
    }
    let of_blanks = mark == BLANK;
    let is_mark = |byte: &u8| *byte == mark || of_blanks && *byte == b'\t';
    let text = if of_blanks { text.trim_ascii() } else { text };
    let (mut cell, mut is_begun, mut is_quoted) = (Vec::new(), false, false);
    let mut bytes = text.iter().copied().peekable();
    while let Some(byte) = bytes.next() {
        if is_mark(&byte) && !is_quoted {
            while of_blanks && bytes.next_if(is_mark).is_some() {}
            if of_blanks && bytes.peek().is_some_and(|next| b"[(".contains(next)) {
                cell.push(b' ');
            } else {
                cells.push_field(&cell);
                cell.clear();
                is_begun = false;
            }
            continue;
        }
        match byte {
            b'"' if is_quoted && bytes.next_if_eq(&b'"').is_some() => cell.push(b'"'),
            b'"' if is_quoted || !is_begun => is_quoted = !is_quoted,
            _ => cell.push(byte),
        }
        is_begun = true;
    }
    cells.push_field(&cell);
    of_blanks || !is_quoted
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parted(text: &str, mark: u8) -> (Vec<String>, bool) {
        let mut cells = csv::ByteRecord::new();
        let is_whole = part(text.as_bytes(), mark, &mut cells);
        (cells.iter().map(|cell| String::from_utf8_lossy(cell).into_owned()).collect(), is_whole)
    }

    #[test]
    fn runs_of_blanks_part_cells() {
        let made = |text: &str| parted(text, BLANK).0.join("|");
        assert_eq!(made("  # t  u\r\n"), "#|t|u");
        assert_eq!(made(" 1.0   2 \t 3  \n"), "1.0|2|3");
        assert_eq!(made("t [s] \"a  b\" y(deg)"), "t [s]|a  b|y(deg)");
        assert_eq!(parted("\"open  a\n", BLANK), (vec!["open  a".to_owned()], true));
    }

    #[test]
    fn cells_are_those_of_the_crate_csv() {
        for text in [
            "a,b,c\r\n",
            "a,,\n",
            ",\n",
            "\"a,b\",c",
            "\"a\"\"b\",\"\"\n",
            "\"a\"b,c\"d\"\r",
            "a \"b\",c\n",
            "\"over\nlines\",2\n",
            " \"a\",b\n",
        ] {
            let mut reader = csv::ReaderBuilder::new();
            let mut reader = reader.has_headers(false).flexible(true).from_reader(text.as_bytes());
            let mut expected = csv::StringRecord::new();
            reader.read_record(&mut expected).unwrap();
            let expected: Vec<String> = expected.iter().map(str::to_owned).collect();
            assert_eq!(parted(text, b','), (expected, true), "{text:?}");
        }
        assert_eq!(parted("1,\"2\n", b','), (vec!["1".to_owned(), "2".to_owned()], false));
    }
}
