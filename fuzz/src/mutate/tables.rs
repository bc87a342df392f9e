//! Tables and texts, by their cells and words.

use super::Mutation;

/// Cells that a table seldom has.
const CELLS: [&str; 16] = [
    "",
    "0",
    "-1",
    "nan",
    "inf",
    "1e308",
    "-1e-320",
    "1e-9",
    "\"",
    "\"a\nb\"",
    "accepted",
    "rejected",
    "18446744073709551616",
    "0x10",
    "1,5",
    "2024-02-30T25:61:00Z",
];

/// Changes the cells of a table, most of which keeps its form.
pub(super) fn cells(mutation: &mut Mutation, bytes: &[u8]) -> Option<Vec<u8>> {
    parts(mutation, bytes, [',', ';', '\t', '\n'])
}

/// Changes the words of a text.
pub(super) fn words(mutation: &mut Mutation, bytes: &[u8]) -> Option<Vec<u8>> {
    parts(mutation, bytes, [' ', '(', ',', '\n'])
}

/// Changes the tags, attributes and texts of an XML file.
pub(super) fn tags(mutation: &mut Mutation, bytes: &[u8]) -> Option<Vec<u8>> {
    parts(mutation, bytes, ['>', '<', ' ', '"'])
}

/// Changes parts that end with one of `ends`.
fn parts(mutation: &mut Mutation, bytes: &[u8], ends: [char; 4]) -> Option<Vec<u8>> {
    let text = std::str::from_utf8(bytes).ok()?;
    let mut parts: Vec<String> = text.split_inclusive(ends).map(str::to_owned).collect();
    let place = mutation.below(parts.len());
    let end = parts.get(place)?.chars().next_back().filter(|end| ends.contains(end));
    let end = end.map_or_else(String::new, String::from);
    match mutation.below(8) {
        0 => mutation.shuffle(&mut parts),
        1 => parts[place] = CELLS[mutation.below(CELLS.len())].to_owned() + &end,
        2 => parts[place] = parts[mutation.below(parts.len())].clone(),
        _ => parts[place] = changed(mutation, parts[place].strip_suffix(&*end)?) + &end,
    }
    Some(parts.concat().into_bytes())
}

/// A part changed: of a number most often another one.
fn changed(mutation: &mut Mutation, part: &str) -> String {
    match part.trim().parse() {
        Ok(number) if !mutation.one_in(8) => mutation.float(number).to_string(),
        _ => mutation.text(part),
    }
}
