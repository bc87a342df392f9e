//! How the rows of a text are written: delimiter, lines before the header, units below it.

mod by_blanks;
mod marks;
mod rows;

use marks::{DELIMITERS, behind_labview, sniff_delimiter};

pub(super) use marks::{Spelling, are_units, bare_unit, is_over_lines, is_remark};

impl Spelling {
    /// How a text is written that starts so, its cells parted by `delimiter` where that is known.
    pub(super) fn of(start: &[u8], delimiter: Option<u8>) -> Self {
        let marks = delimiter.map_or_else(|| DELIMITERS.to_vec(), |known| vec![known]);
        if let Some((behind, lines)) = behind_labview(start) {
            let below = start.get(behind..).unwrap_or_default();
            return Self { delimiter: sniff_delimiter(below, &marks), preamble: (behind, lines) };
        }
        let by_marks = Self::by_marks(start, &marks);
        by_marks.by_blanks(start).filter(|_| delimiter.is_none()).unwrap_or(by_marks)
    }
}

#[cfg(test)]
mod tests {
    use super::marks::BLANK;
    use super::*;

    #[test]
    fn the_delimiter_is_told_from_the_header() {
        assert_eq!(sniff_delimiter(b"# a, b, c\n\nt;a.input;a.output\n1;2;3", &DELIMITERS), b';');
        assert_eq!(sniff_delimiter(b"t\ta,b\tc", &DELIMITERS), b'\t');
        assert_eq!(sniff_delimiter(b"single", &DELIMITERS), b',');
        assert_eq!(sniff_delimiter(b"\xef\xbb\xbf# a, b, c\nt;x;y", &DELIMITERS), b';');
        assert_eq!(sniff_delimiter(b"t,x [a;b;c]", &DELIMITERS), b',');
    }

    #[test]
    fn what_stands_before_the_header_is_told_from_the_table() {
        let table = "t;u;y\n0,0;1,5;2\n0,1;1;2\n0,2;1;2\n";
        let plain = Spelling { delimiter: b';', preamble: (0, 0) };
        assert_eq!(Spelling::of(table.as_bytes(), None), plain);
        let preamble = "Logger 4.2, boom test\nOperator:;somebody\n\n";
        let found = Spelling::of(format!("{preamble}{table}").as_bytes(), None);
        assert_eq!(found, Spelling { delimiter: b';', preamble: (preamble.len(), 3) });
        // One row of another length is a fault of the row, and not of the header.
        assert_eq!(Spelling::of(format!("{table}1;2\n").as_bytes(), None), plain);
    }

    #[test]
    fn a_delimiter_that_is_known_is_not_looked_for() {
        let text = b"t,\"u; V\",\"y; deg\"\n0,1,2\n0.1,1,2\n";
        let known = Spelling { delimiter: b',', preamble: (0, 0) };
        assert_eq!(Spelling::of(text, Some(b',')), known);
        assert_eq!(Spelling::of(b"a;b;c;d,e\n0,1\n", Some(b',')), known);
    }

    #[test]
    fn a_mark_behind_the_last_cell_makes_no_cell() {
        let rows = "0,1,2\n0.1,1,2\n0.2,1,2\n";
        let trailing = rows.replace('\n', ",\n");
        for (header, rows) in [("t,u,y\n", trailing.as_str()), ("t,u,y,\r\n", rows)] {
            let plain = Spelling { delimiter: b',', preamble: (0, 0) };
            assert_eq!(Spelling::of(format!("{header}{rows}").as_bytes(), None), plain);
            let found = Spelling::of(format!("Logger 3\n\n{header}{rows}").as_bytes(), None);
            assert_eq!(found, Spelling { delimiter: b',', preamble: (10, 2) });
        }
    }

    #[test]
    fn the_table_of_labview_begins_behind_two_headers() {
        let before = "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\t\n\
                      Channels\t2\t\nX0\t0\t0\n***End_of_Header***\t\t\n";
        let log = format!("{before}X_Value\tu\ty\tComment\n0\t1\t2\n0.1\t1\t2\n");
        let found = Spelling::of(log.as_bytes(), None);
        assert_eq!(found, Spelling { delimiter: b'\t', preamble: (before.len(), 7) });
    }

    #[test]
    fn runs_of_blanks_part_cells_where_nothing_else_does() {
        let rows = "  0.00   1.5  20\n  0.01   1.5  20.1\n  0.02  -1.5   9\n";
        for (before, header) in [
            ("", "t u  y\n"),
            ("Rig 7, by hand\n\n", "t [s]   u (V)\ty [deg]\n"),
            ("# Rig 7\n  #", " t u y\n"),
            ("", "t u y\n s V deg\n"),
        ] {
            let found = Spelling::of(format!("{before}{header}{rows}").as_bytes(), None);
            let lines = before.bytes().filter(|byte| *byte == b'\n').count() as u64;
            let expected = Spelling { delimiter: BLANK, preamble: (before.len(), lines) };
            assert_eq!(found, expected, "{before:?} {header:?}");
        }
        let marked = format!("\u{feff}  t u y\n{rows}");
        let behind_mark = Spelling { delimiter: BLANK, preamble: (3, 0) };
        assert_eq!(Spelling::of(marked.as_bytes(), None), behind_mark);
        // Names of several words, dates and marks between cells make other tables.
        for text in [
            format!("time in s  u y\n{rows}"),
            "time u y\n2024-05-01 12:00:00 1 2\n2024-05-01 12:00:01 1 2\n".to_owned(),
            "t s;u V\n0 1\n0 2\n".to_owned(),
            "     t  u  y note\n0 0.0  1  2\n1 0.1  1  2\n".to_owned(),
        ] {
            assert!(!Spelling::of(text.as_bytes(), None).is_of_blanks(), "{text:?}");
        }
    }

    #[test]
    fn lines_padded_to_the_width_of_the_table_do_not_hide_the_header() {
        let table = "t;u;y\n0,0;1,5;2\n0,1;1;2\n0,2;1;2\n";
        for preamble in ["\"Run 7\";;\nDate;01.03.2026;\n;;\n", "Rig 3;;\r\nBy:;me;\r\n\r\n"] {
            for units in ["", "s;V;deg\n"] {
                let table = table.replacen('\n', &format!("\n{units}"), 1);
                let found = Spelling::of(format!("{preamble}{table}").as_bytes(), None);
                assert_eq!((found.delimiter, found.preamble), (b';', (preamble.len(), 3)));
            }
        }
        // An index without a name is a column all the same.
        let plain = Spelling { delimiter: b',', preamble: (0, 0) };
        assert_eq!(Spelling::of(b",t,u,y\n0,0,1,2\n1,0.1,1,2\n", None), plain);
    }

    #[test]
    fn units_below_the_header_are_no_samples() {
        let row = |cells: &[&str]| are_units(&csv::ByteRecord::from(cells.to_vec()));
        assert!(row(&["s", "-", "-"]) && row(&["", "-", "deg"]) && !row(&["-", "-"]));
        assert!(row(&["s", "V", "deg"]) && row(&["[ms]", "(%)", ""]));
        assert!(!row(&["0", "V", "deg"]) && !row(&["", ""]) && !row(&["x", "n/a"]));
    }
}
