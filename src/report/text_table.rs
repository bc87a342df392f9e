//! A table of texts: for the terminal as it is displayed, for pages as a part of a document.

use std::fmt;

use comfy_table::{CellAlignment, presets};

/// Rows of texts below a header; columns of numbers are aligned to the right.
#[derive(Clone, Debug, Default)]
pub(crate) struct TextTable {
    pub(super) header: Vec<String>,
    pub(super) rows: Vec<Vec<String>>,
    /// Columns of numbers.
    pub(super) numbers: Vec<usize>,
}

impl TextTable {
    pub(super) fn new<const N: usize>(header: [&str; N], numbers: &[usize]) -> Self {
        let header = header.map(str::to_owned).to_vec();
        Self { header, rows: Vec::new(), numbers: numbers.to_vec() }
    }

    pub(super) fn row<const N: usize>(&mut self, cells: [String; N]) {
        self.rows.push(cells.into());
    }

    /// A table with a row for each of `rows`.
    pub(crate) fn of<const N: usize>(
        header: [&str; N],
        numbers: &[usize],
        rows: impl IntoIterator<Item = [String; N]>,
    ) -> Self {
        let rows = rows.into_iter().map(Vec::from).collect();
        Self { rows, ..Self::new(header, numbers) }
    }

    /// Its rows as columns; the first of them is the header.
    pub(super) fn turned(self) -> Self {
        let cell = |row: &Vec<String>, column: usize| row.get(column).cloned().unwrap_or_default();
        let turned = |column: usize| {
            std::iter::once(&self.header).chain(&self.rows).map(|row| cell(row, column)).collect()
        };
        let mut rows = (0..self.header.len()).map(turned);
        Self { header: rows.next().unwrap_or_default(), rows: rows.collect(), numbers: Vec::new() }
    }

    /// Whether a column holds numbers.
    pub(super) fn is_number(&self, column: usize) -> bool {
        self.numbers.contains(&column)
    }
}

impl TextTable {
    /// As Markdown, whose cells are `escaped`.
    pub(crate) fn markdown(&self, escaped: impl Fn(&str) -> String) -> String {
        let row = |cells: &Vec<String>| {
            let cells = cells.iter().map(|cell| escaped(cell));
            format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "))
        };
        let rules = (0..self.header.len()).map(|c| if self.is_number(c) { "--:" } else { "---" });
        let rules = format!("|{}|\n", rules.collect::<Vec<_>>().join("|"));
        row(&self.header) + &rules + &self.rows.iter().map(row).collect::<String>()
    }
}

impl fmt::Display for TextTable {
    /// With borders, as wide as its cells.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut table = comfy_table::Table::new();
        table.load_style(presets::UTF8_BORDERS_ONLY).set_header(&self.header).add_rows(&self.rows);
        for (number, column) in table.column_iter_mut().enumerate() {
            if self.is_number(number) {
                column.set_cell_alignment(CellAlignment::Right);
            }
        }
        table.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_aligned_to_the_right() {
        let mut table = TextTable::new(["joint", "steps"], &[1]);
        table.row(["boom".to_owned(), "7".to_owned()]);
        let lines: Vec<String> = table.to_string().lines().map(str::to_owned).collect();
        assert_eq!(lines[1..4], ["│ joint   steps │", "╞═══════════════╡", "│ boom        7 │"]);
    }

    #[test]
    fn rows_are_turned_into_columns() {
        let table = TextTable::of(
            ["model", "raw"],
            &[1],
            [["a", "1"], ["b", "2"]].map(|row| row.map(str::to_owned)),
        );
        let turned = table.turned();
        assert_eq!(turned.header, ["model", "a", "b"]);
        assert_eq!(turned.rows, [["raw", "1", "2"]]);
    }
}
