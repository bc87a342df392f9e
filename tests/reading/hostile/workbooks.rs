//! Workbooks whose parts lie, share, or never end.

use std::io::Write as _;

use tempfile::TempDir;

use super::{assert_says, file, workbook};

#[test]
fn what_is_blank_in_a_workbook_counts_as_well() {
    let folder = TempDir::new().unwrap();
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default();
    archive.start_file("xl/worksheets/sheet1.xml", options).unwrap();
    let blanks = vec![b' '; 1 << 20];
    for _ in 0..60 {
        archive.write_all(&blanks).unwrap();
    }
    let bytes = archive.finish().unwrap().into_inner();
    assert!(bytes.len() < 100_000);
    let path = file(&folder, "blank.xlsx", &bytes);
    assert_says(&path, &["--max-memory", "50MB"], "--max-memory");
}

#[test]
fn a_text_that_many_cells_share_counts_in_each() {
    let folder = TempDir::new().unwrap();
    let bytes = workbook::of_one_text(2000, &"x".repeat(32_000));
    assert!(bytes.len() < 300_000);
    let path = file(&folder, "shared.xlsx", &bytes);
    assert_says(&path, &["--max-memory", "100MB"], "--max-memory");
    let few = file(&folder, "few.xlsx", &workbook::of_one_text(2, "x"));
    assert_says(&few, &["--max-memory", "100MB"], "no time column");
}

#[test]
fn what_a_workbook_says_of_texts_and_styles_counts_before_they_are_read() {
    let folder = TempDir::new().unwrap();
    for count in ["144115188075855872", "1099511627776"] {
        let texts = format!("<?xml version=\"1.0\"?><sst uniqueCount=\"{count}\"><si/></sst>");
        let path =
            file(&folder, "texts.xlsx", &workbook::with_part("xl/sharedStrings.xml", &texts));
        assert_says(&path, &[], "--max-memory");
    }
    let format = "y".repeat(2000);
    let styles = format!(
        "<styleSheet><numFmts><numFmt numFmtId=\"3\" formatCode=\"{format}\"/></numFmts><cellXfs>{}\
         </cellXfs></styleSheet>",
        "<xf numFmtId=\"3\"/>".repeat(200_000)
    );
    let path = file(&folder, "styles.xlsx", &workbook::with_part("xl/styles.xml", &styles));
    assert_says(&path, &["--max-memory", "100MB"], "--max-memory");
}

#[test]
fn what_a_workbook_lists_beside_its_cells_counts_as_well() {
    let folder = TempDir::new().unwrap();
    let part = "<Relationship Id=\"r\" Type=\"x/worksheet\" Target=\"a\"/>";
    let parts = part.repeat(120_000);
    let content = format!("<Relationships>{parts}</Relationships>");
    let bytes = workbook::with_part("xl/_rels/workbook.xml.rels", &content);
    assert_says(&file(&folder, "lists.xlsx", &bytes), &["--max-memory", "50MB"], "--max-memory");
}

#[test]
fn elements_of_a_workbook_that_are_not_ended_count_as_well() {
    let folder = TempDir::new().unwrap();
    for name in ["xl/worksheets/sheet1.xml", "xl/sharedStrings.xml"] {
        let bytes = workbook::with_part(name, &format!("<sheetData>{}", "<a>".repeat(4_000_000)));
        assert_says(&file(&folder, "nest.xlsx", &bytes), &["--max-memory", "50MB"], "--max-memory");
    }
}

#[test]
fn sheets_that_share_a_part_or_are_too_many_are_refused() {
    let folder = TempDir::new().unwrap();
    for (sheets, expected) in [(2, "one part of the file"), (101, "101 sheets")] {
        let path = file(&folder, "shared.xlsx", &workbook::with_empty_sheets(sheets));
        assert_says(&path, &[], expected);
    }
}
