//! What is read back of a recording.

use std::collections::BTreeMap;
use std::io::Cursor;

use rerun::external::arrow::array::{
    Array, ArrayRef, AsArray as _, Float32Array, Float64Array, Int64Array,
};
use rerun::external::re_log_encoding::DecoderApp;
use rerun::log::{Chunk, LogMsg};

/// A number as recordings hold it.
pub(crate) fn whole(number: usize) -> i64 {
    i64::try_from(number).unwrap()
}

/// The chunks of a recording, by entity; the blueprint apart.
pub(crate) struct ReadBack {
    pub(crate) chunks: BTreeMap<String, Vec<Chunk>>,
    pub(crate) blueprint: usize,
    /// The timeline that is active when the viewer opens.
    pub(crate) opens_on: String,
    /// What its pages and views are called.
    pub(crate) pages: Vec<String>,
}

impl ReadBack {
    /// The moments of a component, also before the first tick.
    pub(crate) fn ticks(&self, entity: &str, timeline: &'static str) -> Vec<i64> {
        let chunks = self.chunks.get(entity).into_iter().flatten();
        let columns = chunks.filter_map(|chunk| chunk.timelines().get(&timeline.into()).cloned());
        columns.flat_map(|column| column.times_raw().to_vec()).collect()
    }

    pub(crate) fn of(bytes: &[u8]) -> Self {
        let mut chunks: BTreeMap<String, Vec<Chunk>> = BTreeMap::new();
        let (mut blueprint, mut opens_on, mut pages) = (0, String::new(), Vec::new());
        for message in DecoderApp::decode_lazy(Cursor::new(bytes)) {
            if let LogMsg::ArrowMsg(store, message) = message.unwrap() {
                if store.is_blueprint() {
                    blueprint += 1;
                }
                let chunk = Chunk::from_arrow_msg(&message).unwrap();
                if store.is_blueprint() {
                    let names = ["ContainerBlueprint:display_name", "ViewBlueprint:display_name"];
                    let names = names.map(|name| chunk.components().get_array(name.into()));
                    for name in names.into_iter().flatten() {
                        pages.push(name.value(0).as_string::<i32>().value(0).to_owned());
                    }
                    let timeline = "TimePanelBlueprint:timeline".into();
                    if let Some(cell) = chunk.components().get_array(timeline) {
                        cell.value(0).as_string::<i32>().value(0).clone_into(&mut opens_on);
                    }
                    continue;
                }
                chunks.entry(chunk.entity_path().to_string()).or_default().push(chunk);
            }
        }
        Self { chunks, blueprint, opens_on, pages }
    }

    /// Each row of a component that has one value: its times and the value.
    pub(crate) fn rows<T>(
        &self,
        entity: &str,
        component: &'static str,
        value: impl Fn(&dyn Array) -> T,
    ) -> Vec<(BTreeMap<String, i64>, T)> {
        let mut rows = Vec::new();
        for chunk in self.chunks.get(entity).into_iter().flatten() {
            let Some(list) = chunk.components().get_array(component.into()) else { continue };
            if chunk.is_static() {
                continue;
            }
            for row in 0..list.len() {
                if list.is_null(row) || list.value(row).is_empty() {
                    continue;
                }
                let times = chunk.timelines().iter();
                let times = times.map(|(name, column)| (name.to_string(), column.times_raw()[row]));
                let times: BTreeMap<String, i64> = times.collect();
                // What is shown before the first tick is shown again in its place.
                let is_before_all = times.get("decision").is_some_and(|tick| *tick <= 0)
                    && !times.contains_key("sample");
                if !is_before_all {
                    rows.push((times, value(&list.value(row))));
                }
            }
        }
        rows
    }

    pub(crate) fn scalars(&self, entity: &str) -> Vec<(BTreeMap<String, i64>, f64)> {
        self.rows(entity, "Scalars:scalars", |cell| {
            cell.as_any().downcast_ref::<Float64Array>().unwrap().value(0)
        })
    }

    pub(crate) fn integers(
        &self,
        entity: &str,
        name: &'static str,
    ) -> Vec<(BTreeMap<String, i64>, i64)> {
        self.rows(entity, name, |cell| cell.as_any().downcast_ref::<Int64Array>().unwrap().value(0))
    }

    pub(crate) fn numbers(
        &self,
        entity: &str,
        name: &'static str,
    ) -> Vec<(BTreeMap<String, i64>, f64)> {
        self.rows(entity, name, |cell| {
            cell.as_any().downcast_ref::<Float64Array>().unwrap().value(0)
        })
    }

    /// What is there at all times.
    pub(crate) fn fixed(&self, entity: &str, component: &'static str) -> ArrayRef {
        let chunks = self.chunks[entity].iter().filter(|chunk| chunk.is_static());
        let found = chunks.filter_map(|chunk| chunk.components().get_array(component.into()));
        found.last().unwrap().value(0)
    }

    /// The points of a drawing that stays.
    pub(crate) fn points(&self, entity: &str) -> Vec<[f32; 2]> {
        places(&self.fixed(entity, "Points2D:positions"))
    }

    /// The texts of a drawing that stays.
    pub(crate) fn labels(&self, entity: &str) -> Vec<String> {
        let labels = self.fixed(entity, "Points2D:labels");
        labels.as_string::<i32>().iter().map(|label| label.unwrap().to_owned()).collect()
    }

    /// The one static cell of a component, which must be there.
    pub(crate) fn cell(&self, entity: &str, component: &'static str) -> ArrayRef {
        let cells = self.chunks[entity].iter().filter(|chunk| chunk.is_static());
        let mut cells = cells.filter_map(|c| c.components().get_array(component.into()));
        cells.next().unwrap().value(0)
    }

    pub(crate) fn list(&self, entity: &str, component: &'static str) -> Vec<f64> {
        let cell = self.cell(entity, component);
        cell.as_any().downcast_ref::<Float64Array>().unwrap().values().to_vec()
    }

    pub(crate) fn texts(
        &self,
        entity: &str,
        component: &'static str,
    ) -> Vec<(BTreeMap<String, i64>, String)> {
        self.rows(entity, component, |cell| cell.as_string::<i32>().value(0).to_owned())
    }
}

pub(crate) fn places(cell: &dyn Array) -> Vec<[f32; 2]> {
    let numbers = cell.as_fixed_size_list().values();
    let numbers = numbers.as_any().downcast_ref::<Float32Array>().unwrap().values();
    numbers.as_chunks::<2>().0.to_vec()
}
