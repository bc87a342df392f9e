//! Marks that mean one thing in some logs and another in others: line ends, `#`, `"`, tabs, `-`, `/`.

use super::log::*;
use super::texts::{gzip, utf16};

/// Ends of lines, and what begins with the mark of a comment.
pub(crate) fn ends_and_comments() -> Vec<Messy> {
    let all = plain(&clean());
    let refused = || Expected::Refused(&["carriage returns alone"]);
    vec![
        messy("carriage_returns.csv", old_line_ends(&all), refused()),
        messy(
            "carriage_returns_at_the_end.csv",
            old_line_ends_behind(&all, "0.500000,"),
            Expected::Refused(&["row 52"]),
        ),
        messy("carriage_returns.csv.gz", gzip(&old_line_ends(&all)), refused()),
        messy("carriage_returns_utf16.csv", utf16(&old_line_ends(&all)), refused()),
        messy("numbered_rows.csv", numbered(&all), SAME),
        messy(
            "output_first_and_missing.csv",
            output_first(&cell(&cell(&all, 617, 2, "#NV"), 1017, 2, "#N/A")),
            read(0.051, "2 cells are empty or NaN"),
        ),
        messy("row_taken_out.csv", cell(&all, 617, 0, "#6.15"), read(0.051, "1 gap of")),
        messy(
            "row_without_a_time.csv",
            cell(&all, 617, 0, "#N/A"),
            Expected::Refused(&["row 617", "`time_s`", "the time is missing"]),
        ),
    ]
}

/// Quotation marks, tabs, and marks in units.
pub(crate) fn cells_and_units() -> Vec<Messy> {
    let rows = clean();
    let all = plain(&rows);
    vec![
        messy("row_with_one_unit.csv", all.replacen('\n', "\ns,-,-\n", 1), SAME),
        messy(
            "quotation_not_closed.csv",
            noted(&all, "\"open"),
            Expected::Refused(&["row 617", "quotation mark", "close it"]),
        ),
        messy("lines_in_a_cell.csv", noted(&all, "\"two\nlines\""), SAME),
        messy("words_between_tabs.tsv", between_words(&rows), read(1e-6, "is not used")),
        messy("time_in_tens_of_ms.csv", all.replacen("time_s", "time [1000 ms]", 1), SAME),
        messy(
            "names_over_units.csv",
            all.replacen(HEADER, "Time / ms,boom.input / %,boom.output / deg", 1)
                .replacen("ms", "s", 1),
            SAME,
        ),
    ]
}

/// Lines that end with a carriage return alone, comments among them.
fn old_line_ends(log: &str) -> String {
    let commented = log.replacen("\n1.000000,", "\n# here the operator changed\n1.000000,", 1);
    format!("# by hand\n{commented}").replace('\n', "\r")
}

/// The log with its last column first.
fn output_first(log: &str) -> String {
    let turned = |line: &str| {
        let (others, last) = line.rsplit_once(',').unwrap();
        format!("{last},{others}\n")
    };
    log.lines().map(turned).collect()
}

/// The log with such line ends from the row that begins so.
fn old_line_ends_behind(log: &str, row: &str) -> String {
    let (before, behind) = log.split_at(log.find(&format!("\n{row}")).unwrap() + 1);
    let behind = behind.replacen("\n1.000000,", "\n# here the operator changed\n1.000000,", 1);
    before.to_owned() + &behind.replace('\n', "\r")
}

/// The log with a column of notes, of which row 617 has one.
fn noted(log: &str, note: &str) -> String {
    let row = |(k, line): (usize, &str)| match k {
        0 => format!("{line},note\n"),
        616 => format!("{line},{note}\n"),
        _ => format!("{line},\n"),
    };
    log.lines().enumerate().map(row).collect()
}

/// The log between columns most of which are words or empty.
fn between_words(rows: &[Row]) -> String {
    let header = "time_s\t\tstate\tboom.input\tboom.output\tmode\tstep\n";
    let row =
        |row: &Row| format!("{}\t\tok\t{}\t{}\tauto\tstep 1\n", row.time, row.input, row.output);
    header.to_owned() + &rows.iter().map(row).collect::<String>()
}

/// The log with a column `#` that numbers its rows.
fn numbered(log: &str) -> String {
    let row = |(k, line): (usize, &str)| match k {
        0 => format!("#,{line}\n"),
        k => format!("{k},{line}\n"),
    };
    log.lines().enumerate().map(row).collect()
}
