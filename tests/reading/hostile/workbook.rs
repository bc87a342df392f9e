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

/// One with `count` names for the sheet of these rows.
fn workbook(count: usize, rows: &str, text: &str) -> Vec<u8> {
    let mut sheets = String::new();
    for number in 1..=count {
        write!(sheets, "<sheet name=\"s{number}\" sheetId=\"{number}\" r:id=\"r1\"/>").unwrap();
    }
    let parts = [
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
            format!(
                "<Relationships xmlns=\"{PACKAGE}\"><Relationship Id=\"r1\" \
                 Type=\"{OF}/worksheet\" Target=\"worksheets/sheet1.xml\"/><Relationship \
                 Id=\"r2\" Type=\"{OF}/sharedStrings\" Target=\"sharedStrings.xml\"/>\
                 </Relationships>"
            ),
        ),
        ("xl/sharedStrings.xml", format!("<sst xmlns=\"{MAIN}\"><si><t>{text}</t></si></sst>")),
        (
            "xl/worksheets/sheet1.xml",
            format!("<worksheet xmlns=\"{MAIN}\"><sheetData>{rows}</sheetData></worksheet>"),
        ),
    ];
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, part) in parts {
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
