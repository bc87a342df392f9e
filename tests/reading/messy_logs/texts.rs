//! Texts as loggers, spreadsheets and people write them.

use std::fmt::Write as _;
use std::io::Write as _;

use flate2::Compression;
use flate2::write::GzEncoder;

use super::clocks::date;
use super::log::*;

pub(crate) fn utf16(text: &str) -> Vec<u8> {
    text.encode_utf16().flat_map(u16::to_le_bytes).collect()
}

pub(crate) fn gzip(text: &str) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(text.as_bytes()).unwrap();
    packed.finish().unwrap()
}

pub(crate) fn texts() -> Vec<Messy> {
    let rows = clean();
    let comma = |x: f64| format!("{x:.6}").replace('.', ",");
    let semicolon = HEADER.replace(',', ";");
    let mut dated = String::new();
    for (k, row) in rows.iter().enumerate() {
        writeln!(dated, "{},{},{}", date(k), row.input, row.output).unwrap();
    }
    let degrees = format!("time_s;boom.input [%];boom.output [°]\n{}", {
        let text = table("", &rows, ";", |x| format!("{x:.6}"));
        text.trim_start().to_owned()
    });
    let latin1: Vec<u8> = degrees.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
    let all = plain(&rows);
    vec![
        messy("decimal_comma.csv", table(&semicolon, &rows, ";", comma), SAME),
        messy("tabs_and_commas.txt", table(&HEADER.replace(',', "\t"), &rows, "\t", comma), SAME),
        messy("dates.csv", format!("timestamp,boom.input,boom.output\n{dated}"), read(1e-4, "")),
        messy(
            "preamble.csv",
            format!("Logger 4.2\nMachine: boom, with a long name\nDate: 2024-05-01\n\n{all}"),
            SAME,
        ),
        messy("row_of_units.csv", all.replacen('\n', "\ns,V,deg\n", 1), SAME),
        messy("latin1.csv", latin1, SAME),
        messy("utf16.csv", utf16(&format!("\u{feff}{degrees}")), SAME),
        messy("utf16_unmarked.csv", utf16(&degrees), SAME),
        messy("packed.csv.gz", gzip(&all), SAME),
        messy("cut_off.csv", &all[..all.len() - 12], read(0.011, "cut off")),
        messy(
            "padded_preamble.csv",
            format!("\"Run 7\";;\nDate;01.03.2026;\n;;\n{}", all.replace(',', ";")),
            SAME,
        ),
        messy("preamble_as_wide.csv", format!("Operator,by,hand\nRate,100,Hz\n{all}"), SAME),
        messy("blank_lines_above.csv", format!("\n  \n{all}"), SAME),
        messy(
            "names_between_single_marks.csv",
            all.replacen(HEADER, "'time_s','boom.input','boom.output'", 1),
            SAME,
        ),
        messy(
            "more_names_than_columns.csv",
            all.replacen(HEADER, "time_s,boom.input,boom.output,further,signals", 1),
            Expected::Refused(&["row 2", "3 cells", "the header has 5"]),
        ),
        messy(
            "sep_of_a_sheet.csv",
            format!("sep=;\r\n{}", table(&semicolon, &rows, ";", comma)),
            SAME,
        ),
    ]
}

/// Lines below the table, and units at the ends of names.
pub(crate) fn ends() -> Vec<Messy> {
    let all = plain(&clean());
    vec![
        messy(
            "footer.csv",
            format!("{all}End of measurement\n"),
            read(1e-3, "the last row, 1802, is left out: it holds no number"),
        ),
        messy(
            "padded_footer.csv",
            format!("{all}\nEnd of measurement,,\nCounted,by,hand\n"),
            read(1e-3, "the last 2 rows, from 1803 on, are left out: they hold no number"),
        ),
        messy(
            "unit_ends_names.csv",
            all.replacen(HEADER, "t_s,boom.input_pct,boom.output_deg", 1),
            SAME,
        ),
    ]
}

/// Cells without a number, and rows and columns that are none of the table's or of the joint's.
pub(crate) fn cells_and_rows() -> Vec<Messy> {
    let all = plain(&clean());
    vec![
        messy(
            "header_again.csv",
            said_again(&all.replacen('\n', "\ns,V,deg\n", 1), 900),
            Expected::Refused(&["row 901", "`time_s`"]),
        ),
        messy(
            "power_cut.csv",
            format!("{}{}", &all[..all.len() - 12], "\0".repeat(4096)),
            read(0.011, "cut off and left out"),
        ),
        messy(
            "further_signal_of_words.csv",
            with_mode(&all, "boom.mode"),
            read(1e-6, "the signal `mode` is left out"),
        ),
        messy("missing_NA.csv", cell(&all, 617, 2, "#N/A"), read(0.051, "1 cell is empty or NaN")),
        messy(
            "missing_in_windows.csv",
            cell(&all, 617, 2, "-nan(ind)"),
            read(0.051, "1 cell is empty or NaN"),
        ),
        messy(
            "missing_in_sql.csv",
            cell(&all, 617, 2, "\\N"),
            read(0.051, "1 cell is empty or NaN"),
        ),
        messy("missing_dash.csv", cell(&all, 617, 2, "--"), read(0.051, "1 cell is empty or NaN")),
        messy(
            "missing_null.csv",
            cell(&all, 617, 1, "null"),
            read(0.051, "1 cell is empty or NaN"),
        ),
        messy("empty_cell.csv", cell(&all, 617, 2, ""), read(0.051, "1 cell is empty or NaN")),
    ]
}

/// The first two lines once more after so many.
fn said_again(log: &str, behind: usize) -> String {
    let (mut made, head): (String, Vec<&str>) = (String::new(), log.lines().take(2).collect());
    for (index, line) in log.lines().enumerate() {
        if index == behind {
            writeln!(made, "{}\n{}", head[0], head[1]).unwrap();
        }
        writeln!(made, "{line}").unwrap();
    }
    made
}

/// One more column of this name, with a word in each row.
fn with_mode(log: &str, name: &str) -> String {
    let cell = |(index, line)| format!("{line},{}\n", if index == 0 { name } else { "auto" });
    log.lines().enumerate().map(cell).collect()
}

/// The first lines of a log of LabVIEW, and the header of its table.
const LABVIEW: (&str, &str) = (
    "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t.\n***End_of_Header***\t\n\t\n\
     Channels\t2\t\t\nSamples\t1800\t1800\t\nDelta_X\t0.01\t0.01\t\n***End_of_Header***\t\t\t\n",
    "X_Value\tboom.input\tboom.output\tComment",
);

/// A mark between cells at the end of each line.
fn trailing(text: &str) -> String {
    text.replace('\n', ",\n")
}

/// Texts as loggers and programs write them.
pub(crate) fn programs() -> Vec<Messy> {
    let rows = clean();
    let all = plain(&rows);
    let (labview, header) = LABVIEW;
    let table_of_labview = table(header, &rows, "\t", |x| format!("{x:.6}"));
    let (_, next_segment) = labview.split_once("***End_of_Header***\t\n").unwrap();
    let days = |origin: f64| timed(move |k| origin + PERIOD * k as f64 / 86_400.0);
    let dated =
        |rows: &[Row]| table("time,boom.input,boom.output", rows, ",", |x| format!("{x:.11}"));
    vec![
        messy("bars.txt", all.replace(',', "|"), SAME),
        messy("labview.lvm", format!("{labview}{table_of_labview}"), SAME),
        messy(
            "two_segments.lvm",
            format!("{labview}{table_of_labview}{next_segment}{table_of_labview}"),
            Expected::Refused(&["two_segments.lvm, row 1811"]),
        ),
        messy("days_of_a_sheet.csv", dated(&days(45_658.0)), read(1e-3, "as spreadsheets count")),
        messy("datenum.csv", dated(&days(739_618.0)), read(1e-3, "MATLAB's datenum")),
        messy(
            "preamble_of_another_mark.csv",
            format!("Logger 4.2, boom test\n{}", all.replace(',', ";")),
            SAME,
        ),
    ]
}

/// Names as some programs write them, with a blank after each mark.
const QUOTED: &str = "\"time_s\", \"boom.input [V]\", \"boom.output [deg]\"";

/// Marks between cells after the last one, and within numbers.
pub(crate) fn marks() -> Vec<Messy> {
    let rows = clean();
    let all = plain(&rows);
    let (_, below) = all.split_once('\n').unwrap();
    let quoted = |x: f64| format!("\"{}\"", format!("{x:.6}").replace('.', ","));
    vec![
        messy("marks_behind_rows.csv", format!("{HEADER}\n{}", trailing(below)), SAME),
        messy("mark_behind_header.csv", all.replacen('\n', ",\n", 1), SAME),
        messy("marks_behind_all.csv", trailing(&all), SAME),
        messy(
            "lost_cell_between_marks.csv",
            trailing(&all).replacen("\n5.000000,", "\n", 1),
            Expected::Refused(&["row 502", "3 cells"]),
        ),
        messy("quoted_commas.csv", table(HEADER, &rows, ",", quoted), SAME),
        messy("numpy.csv", format!("# {all}"), SAME),
        messy("numpy_behind_a_mark.csv", format!("\u{feff}# {all}"), SAME),
        messy("numpy_below_words.csv", format!("Rig 7\n# by hand\n# {all}"), SAME),
        messy("quoted_behind_blanks.csv", all.replacen(HEADER, QUOTED, 1), SAME),
        messy(
            "cell_without_a_name.csv",
            format!("{HEADER},\n{}", below.replace('\n', ",5\n")),
            Expected::Refused(&["row 1", "4 cells", "3 names"]),
        ),
    ]
}

/// Runs of blanks between cells.
pub(crate) fn blanks() -> Vec<Messy> {
    let rows = clean();
    let all = plain(&rows).replace(',', " ");
    let aligned = table("time_s   boom.input boom.output", &rows, " ", |x| format!("{x:11.6}"));
    let (_, below) = aligned.split_once('\n').unwrap();
    vec![
        messy("numpy.txt", format!("# {all}"), SAME),
        messy("gnuplot.dat", format!("# Rig 7\n# time_s  boom.input  boom.output\n{below}"), SAME),
        messy("aligned.txt", format!("Rig 7, by hand\n\n{aligned}"), SAME),
        messy("units.dat", format!("t [s]  boom.input [V]   boom.output [deg]\n{below}"), SAME),
        messy("units_below.dat", format!("t  boom.input boom.output\n s V   deg\n{below}"), SAME),
        messy("behind_a_mark.txt", format!("\u{feff}  {aligned}"), SAME),
        messy("numpy_behind_a_mark.txt", format!("\u{feff}# {all}"), SAME),
        messy("words_above.dat", format!("Made by hand\n{all}"), SAME),
        messy("comments_of_another_mark.dat", format!("; exported\n; rig 7\n{all}"), SAME),
        messy(
            "short_row.dat",
            cell(&plain(&rows), 617, 1, "").replacen(",,", ",", 1).replace(',', " "),
            Expected::Refused(&["row 617", "2 cells", "has 3"]),
        ),
        messy(
            "short_row_at_the_top.dat",
            cell(&plain(&rows), 17, 1, "").replacen(",,", ",", 1).replace(',', " "),
            Expected::Refused(&["row 17", "2 cells", "has 3"]),
        ),
        messy("decimal_commas.txt", aligned.replace('.', ",").replace("boom,", "boom."), SAME),
    ]
}

/// Marks that may stand between thousands.
pub(crate) fn thousands() -> Vec<Messy> {
    let rows = clean();
    let all = plain(&rows);
    // Counts of an encoder, between semicolons.
    let whole = |output: &dyn Fn(f64) -> String| {
        let row = |(k, row): (usize, &Row)| {
            format!("{};{};{}\n", 10 * k, 100.0 * row.input, output(row.output))
        };
        let rows: String = rows.iter().enumerate().map(row).collect();
        format!("t_ms;boom.input;boom.output\n{rows}")
    };
    let counted = |x: f64, mark: char| {
        let counts = (50.0 * x).round();
        if counts < 1000.0 { counts.to_string() } else { format!("1{mark}{:03}", counts - 1000.0) }
    };
    vec![
        messy(
            "thousands.csv",
            cell(&all, 617, 2, "here").replace("here", "\"1,234\""),
            Expected::Refused(&["row 617", "`boom.output`", "1,234"]),
        ),
        messy(
            "thousands_among_whole_numbers.csv",
            whole(&|x| counted(x, ',')),
            Expected::Refused(&["row 2", "`boom.output`", "1,000", "one in the thousands"]),
        ),
        messy(
            "three_decimals.csv",
            whole(&|x| format!("{x:.3}").replace('.', ",")),
            read(0.002, ""),
        ),
        messy(
            "points_between_thousands.csv",
            whole(&|x| counted(x, '.')),
            Expected::Refused(&["row 2", "`boom.output`", "1.000", "one in the thousands"]),
        ),
        messy(
            "tail_of_thousands.csv",
            format!("{all}\"1,000\",\"2,000\",\"3,000\"\n"),
            Expected::Refused(&["row 1802", "1,000"]),
        ),
    ]
}

/// Rows of words below the header, and what names the time and its unit.
pub(crate) fn words_below() -> Vec<Messy> {
    let all = plain(&clean());
    let in_ms = plain(&timed(|k| 1e3 * PERIOD * k as f64)).replacen("time_s", "t", 1);
    let below = |log: &str, rows: &str| log.replacen('\n', rows, 1);
    let left_out = |row: u32| match row {
        2 => read(1e-6, "row 2, below the header, is left out"),
        _ => read(1e-6, "row 3, below the header, is left out"),
    };
    let named = |time: &str| in_ms.replacen("t,", time, 1);
    let warm = |(k, row): (usize, Row)| {
        let Row { time, input, output } = row;
        format!("{},{time:.6},{input:.6},{output:.6}\n", 20.0 + 1e-3 * k as f64)
    };
    let warm: String = clean().into_iter().enumerate().map(warm).collect();
    vec![
        messy("types.csv", below(&all, "\ns,V,deg\nfloat,float,float\n"), left_out(3)),
        messy("units_below.csv", below(&in_ms, "\nDOUBLE,DOUBLE,DOUBLE\nms,V,deg\n"), left_out(2)),
        messy("unit_in_words.csv", below(&in_ms, "\nMilliseconds,Volts,Degrees\n"), left_out(2)),
        messy("unit_in_german.csv", below(&in_ms, "\nZeit in ms,Ventil,Winkel\n"), left_out(2)),
        messy("one_unit.csv", below(&in_ms, "\nms,digits,Grad\n"), left_out(2)),
        messy(
            "described_below_padding.csv",
            format!("Run 7,,\n{}", below(&named("t [ms],"), "\nclock,valve,angle\n")),
            left_out(3),
        ),
        messy(
            "described_below_a_mark.csv",
            below(&named("t [ms],"), ",\nclock,valve,angle\n"),
            left_out(2),
        ),
        messy("UPPER_MS.csv", named("TIME_MS,"), SAME),
        messy("millis_itself.csv", named("millis,"), SAME),
        messy("temperature.csv", format!("T,timestamp,boom.input,boom.output\n{warm}"), SAME),
        messy(
            "two_clocks.csv",
            trailing(&all).replace(",\n", ",0\n").replacen(",0\n", ",time_s\n", 1),
            Expected::Refused(&["two columns are named `time_s`", "rename one"]),
        ),
    ]
}

/// What no number can be made of.
pub(crate) fn broken() -> Vec<Messy> {
    let all = plain(&clean());
    vec![
        messy(
            "no_number.csv",
            cell(&all, 617, 2, "#x!"),
            Expected::Refused(&["row 617", "`boom.output`", "#x!", "write a number"]),
        ),
        messy(
            "infinite.csv",
            cell(&all, 617, 1, "inf"),
            Expected::Refused(&["row 617", "`boom.input`", "infinite", "remove the row"]),
        ),
        messy(
            "short_row.csv",
            cell(&all, 617, 1, "").replacen(",,", ",", 1),
            Expected::Refused(&["row 617", "2 cells", "has 3"]),
        ),
        messy(
            "a_date_among_numbers.csv",
            cell(&all, 617, 0, "01.03.2026 09:59:50"),
            Expected::Refused(&["row 617", "`time_s`", "ISO 8601"]),
        ),
        messy(
            "a_date_above_numbers.csv",
            cell(&all, 2, 0, "03/01/2026 09:59:50 AM"),
            Expected::Refused(&["row 3", "`time_s`", "ISO 8601"]),
        ),
        messy(
            "names_of_several_words.txt",
            all.replace(',', "  ").replacen("time_s", "time in seconds", 1),
            Expected::Refused(&["names_of_several_words.txt", "no time column"]),
        ),
        messy(
            "no_header.csv",
            all.split_once('\n').unwrap().1,
            Expected::Refused(&["no_header.csv, row 1", "numbers", "write a header"]),
        ),
        messy(
            "words_between.csv",
            all.replacen("\n1.000000,", "\nhere it stopped\n1.000000,", 1),
            Expected::Refused(&["row 102", "1 cells", "has 3"]),
        ),
        messy("packed.gz", &gzip(&all)[..2000], Expected::Refused(&["packed.gz"])),
    ]
}

/// Files of other formats, which say what they are.
pub(crate) fn other_formats() -> Vec<Messy> {
    vec![
        messy(
            "archive.zip",
            b"PK\x03\x04 and more".as_slice(),
            Expected::Refused(&["archive.zip", "ZIP archive", "unpack it first"]),
        ),
        messy(
            "bag.db3",
            b"SQLite format 3\0 and more".as_slice(),
            Expected::Refused(&["bag.db3", "ros2 bag convert", "mcap"]),
        ),
        messy(
            "old.xls",
            b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1".as_slice(),
            Expected::Refused(&["old.xls", ".xlsx"]),
        ),
        messy(
            "log.mcap.zst",
            b"\x28\xb5\x2f\xfd and more".as_slice(),
            Expected::Refused(&["log.mcap.zst", "zstd", "unpack it first"]),
        ),
        messy(
            "log.tdms",
            b"TDSm and more".as_slice(),
            Expected::Refused(&["log.tdms", "LabVIEW", "npTDMS"]),
        ),
        messy(
            "boom.rrd",
            b"RRF2 and more".as_slice(),
            Expected::Refused(&["boom.rrd", "recording of Rerun", "rerun FILE"]),
        ),
        messy(
            "boom.html",
            b"<!DOCTYPE html><html>".as_slice(),
            Expected::Refused(&["boom.html", "web page"]),
        ),
        messy(
            "boom.toml",
            b"\nschema = \"tauscope/model/1\"\n".as_slice(),
            Expected::Refused(&["boom.toml", "it is a model", "--model"]),
        ),
    ]
}
