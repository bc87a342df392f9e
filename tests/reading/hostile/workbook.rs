//! Workbooks as bytes, part by part.

use std::fmt::Write as _;
use std::io::{Cursor, Write as _};

use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
const OF: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006/relationships";

/// One whose only sheet has 26 cells with one shared text in each of its rows.
pub(crate) fn of_one_text(rows: u32, text: &str) -> Vec<u8> {
    let mut sheet = String::new();
    for row in 1..=rows {
        write!(sheet, "<row r=\"{row}\">").unwrap();
        for column in 'A'..='Z' {
            write!(sheet, "<c r=\"{column}{row}\" t=\"s\"><v>0</v></c>").unwrap();
        }
        sheet += "</row>";
    }
    workbook(1, &sheet, text)
}

/// One with so many names for one sheet without rows.
pub(crate) fn with_empty_sheets(count: usize) -> Vec<u8> {
    workbook(count, "", "")
}

/// One with these sheets, each with the cells of its rows: numbers, `=` for a formula without a value, or
/// texts.
pub(crate) fn of_sheets(sheets: &[&[&[&str]]]) -> Vec<u8> {
    let mut parts = Vec::new();
    let (mut names, mut targets) = (String::new(), String::new());
    for (rows, number) in sheets.iter().zip(1..) {
        let mut cells = String::new();
        for row in *rows {
            cells += "<row>";
            for cell in *row {
                match *cell {
                    "=" => cells += "<c><f>A1*2</f><v></v></c>",
                    cell if cell.parse::<f64>().is_ok() => {
                        write!(cells, "<c><v>{cell}</v></c>").unwrap();
                    }
                    cell => {
                        write!(cells, "<c t=\"inlineStr\"><is><t>{cell}</t></is></c>").unwrap();
                    }
                }
            }
            cells += "</row>";
        }
        let sheet =
            format!("<worksheet xmlns=\"{MAIN}\"><sheetData>{cells}</sheetData></worksheet>");
        parts.push((format!("xl/worksheets/sheet{number}.xml"), sheet));
        write!(names, "<sheet name=\"s{number}\" sheetId=\"{number}\" r:id=\"r{number}\"/>")
            .unwrap();
        write!(
            targets,
            "<Relationship Id=\"r{number}\" Type=\"{OF}/worksheet\" \
             Target=\"worksheets/sheet{number}.xml\"/>"
        )
        .unwrap();
    }
    archive(&names, &targets, parts)
}

/// One with `count` names for the sheet of these rows.
fn workbook(count: usize, rows: &str, text: &str) -> Vec<u8> {
    let mut sheets = String::new();
    for number in 1..=count {
        write!(sheets, "<sheet name=\"s{number}\" sheetId=\"{number}\" r:id=\"r1\"/>").unwrap();
    }
    let targets = format!(
        "<Relationship Id=\"r1\" Type=\"{OF}/worksheet\" Target=\"worksheets/sheet1.xml\"/>\
         <Relationship Id=\"r2\" Type=\"{OF}/sharedStrings\" Target=\"sharedStrings.xml\"/>"
    );
    let texts = format!("<sst xmlns=\"{MAIN}\"><si><t>{text}</t></si></sst>");
    let sheet = format!("<worksheet xmlns=\"{MAIN}\"><sheetData>{rows}</sheetData></worksheet>");
    let parts = [("xl/sharedStrings.xml", texts), ("xl/worksheets/sheet1.xml", sheet)];
    let parts = parts.map(|(name, part)| (name.to_owned(), part)).to_vec();
    archive(&sheets, &targets, parts)
}

/// One whose list of sheets and of their parts these are, with those parts.
fn archive(sheets: &str, targets: &str, parts: Vec<(String, String)>) -> Vec<u8> {
    let heads = [
        (
            "_rels/.rels",
            format!(
                "<Relationships xmlns=\"{PACKAGE}\"><Relationship Id=\"r1\" \
                 Type=\"{OF}/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>"
            ),
        ),
        (
            "xl/workbook.xml",
            format!(
                "<workbook xmlns=\"{MAIN}\" xmlns:r=\"{OF}\"><sheets>{sheets}</sheets></workbook>"
            ),
        ),
        (
            "xl/_rels/workbook.xml.rels",
            format!("<Relationships xmlns=\"{PACKAGE}\">{targets}</Relationships>"),
        ),
    ];
    let heads = heads.map(|(name, part)| (name.to_owned(), part));
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, part) in heads.into_iter().chain(parts) {
        archive.start_file(name, SimpleFileOptions::default()).unwrap();
        archive.write_all(part.as_bytes()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

/// A workbook one part of which says something else.
pub(crate) fn with_part(name: &str, content: &str) -> Vec<u8> {
    let mut whole = ZipArchive::new(Cursor::new(of_one_text(2, "x"))).unwrap();
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for index in 0..whole.len() {
        let part = whole.by_index_raw(index).unwrap();
        if part.name().unwrap() != name {
            archive.raw_copy_file(part).unwrap();
        }
    }
    archive.start_file(name, SimpleFileOptions::default()).unwrap();
    archive.write_all(content.as_bytes()).unwrap();
    archive.finish().unwrap().into_inner()
}
