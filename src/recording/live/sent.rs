//! What a viewer has already, so that only what is new is sent.

use std::collections::BTreeMap;

use rerun::log::Chunk;

/// An entity, its timelines and components, and a count of the chunks that share them.
type Key = (String, usize);

/// The chunks that were sent last.
#[derive(Default)]
pub(super) struct Sent {
    chunks: BTreeMap<Key, Chunk>,
    /// How often each entity with its columns came up in the sending at hand.
    seen: BTreeMap<String, usize>,
}

impl Sent {
    /// A sending begins.
    pub(super) fn begin(&mut self) {
        self.seen.clear();
    }

    /// The rows of `chunk` from the first one on that was not sent as it is; none where the
    /// viewer has them all.
    pub(super) fn news_of(&mut self, chunk: &Chunk) -> Option<Chunk> {
        let name = columns_in_words(chunk);
        let count = self.seen.entry(name.clone()).or_default();
        *count += 1;
        let before = self.chunks.insert((name, *count), chunk.clone());
        let Some(before) = before else { return Some(chunk.clone()) };
        let same = same_rows(&before, chunk);
        if same == chunk.num_rows() {
            return None;
        }
        // What is static has one row, which is sent whole.
        Some(if same == 0 { chunk.clone() } else { chunk.row_sliced_deep(same, chunk.num_rows()) })
    }
}

fn columns_in_words(chunk: &Chunk) -> String {
    let mut timelines: Vec<_> = chunk.timelines().keys().map(ToString::to_string).collect();
    let mut components: Vec<_> = chunk.components().keys().map(ToString::to_string).collect();
    timelines.sort();
    components.sort();
    format!("{} {timelines:?} {components:?}", chunk.entity_path())
}

/// How many rows from the first one on are the same in both.
fn same_rows(a: &Chunk, b: &Chunk) -> usize {
    let rows = a.num_rows().min(b.num_rows());
    if are_same(a, b, 0, rows) {
        return rows;
    }
    // The first `low` rows are the same, the first `high` are not.
    let (mut low, mut high) = (0, rows);
    while high - low > 1 {
        let middle = usize::midpoint(low, high);
        if are_same(a, b, low, middle - low) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Whether `length` rows from `first` on are the same in both.
fn are_same(a: &Chunk, b: &Chunk, first: usize, length: usize) -> bool {
    let times = a.timelines().iter().all(|(name, times)| {
        let part = first..first + length;
        let others = b.timelines().get(name).and_then(|times| times.times_raw().get(part.clone()));
        times.times_raw().get(part) == others
    });
    times
        && a.components().0.iter().all(|(name, column)| {
            let other = b.components().0.get(name);
            let part = column.list_array.slice(first, length);
            other.is_some_and(|other| part == other.list_array.slice(first, length))
        })
}

#[cfg(test)]
mod tests {
    use rerun::TextDocument;

    use super::*;
    use crate::recording::chunk::{Ids, Index};

    fn chunk(values: &[f64]) -> Chunk {
        let mut chunks = Ids::of("1").chunks(1);
        let revisions = Index::on("revision", (0..).take(values.len()));
        let values: Vec<_> = values.iter().copied().map(Some).collect();
        chunks.scalars("error", revisions, &values).unwrap();
        chunks.into_chunks().pop().unwrap()
    }

    fn document(text: &str) -> Chunk {
        let mut chunks = Ids::of("1").chunks(1);
        chunks.push_static("page", &TextDocument::new(text)).unwrap();
        chunks.into_chunks().pop().unwrap()
    }

    #[test]
    fn rows_are_sent_from_the_first_new_one_on() {
        let mut sent = Sent::default();
        let mut rows = |values: &[f64]| {
            sent.begin();
            sent.news_of(&chunk(values)).map_or(0, |news| news.num_rows())
        };
        assert_eq!(rows(&[5.0, 3.0]), 2);
        assert_eq!(rows(&[5.0, 3.0]), 0, "nothing is new");
        assert_eq!(rows(&[5.0, 3.0, 2.0, 1.0]), 2);
        assert_eq!(rows(&[5.0, 3.0, 2.5, 1.0, 0.5]), 3, "the third one has changed");
        assert_eq!(rows(&[6.0, 3.0, 2.5, 1.0, 0.5]), 5);
    }

    #[test]
    fn a_page_is_sent_when_it_has_changed() {
        let mut sent = Sent::default();
        let mut is_sent = |text| {
            sent.begin();
            sent.news_of(&document(text)).is_some()
        };
        assert_eq!(["a", "a", "b"].map(&mut is_sent), [true, false, true]);
    }
}
