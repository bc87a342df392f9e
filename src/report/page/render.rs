//! A report as one page that needs nothing else.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::document::{Block, Document, Entry, Figure};
use super::plot::{draw, figure_style};
use crate::report::TextTable;
use crate::wording::{legible, typed_parts};

/// How the page looks, but for the shades of figures.
const STYLE: &str = include_str!("style.css");

impl Document {
    /// The report as one HTML page: no script, and nothing is fetched.
    pub(crate) fn html(&self) -> String {
        let style = format!("{}{STYLE}", figure_style());
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="color-scheme" content="light dark";
                    meta name="generator" content={ "tauscope " (env!("CARGO_PKG_VERSION")) };
                    // A page without one asks its server for an icon.
                    link rel="icon" href="data:,";
                    title { (self.title) }
                    style { (PreEscaped(style)) }
                }
                body {
                    main {
                        h1 { (self.title) }
                        @for block in &self.blocks { (written(block)) }
                    }
                }
            }
        };
        legible(&page.into_string()) + "\n"
    }
}

fn written(block: &Block) -> Markup {
    match block {
        Block::Heading { depth, text, anchor } => heading(*depth, text, anchor.as_deref()),
        Block::Text(text) => html! { p { (prose(text)) } },
        Block::Passage { question, text } => html! { p { b { (question) ":" } " " (prose(text)) } },
        Block::Lead(text) => html! { p.lead { (text) } },
        Block::List(entries) => html! { ul { @for entry in entries { li { (prose(entry)) } } } },
        Block::Contents(entries) => contents(entries),
        Block::Code(text) => html! { pre { code { (text) } } },
        Block::Figures(figures) => drawn(figures),
        Block::Table(rows) => table(rows),
        Block::Details { summary, blocks } => html! {
            details {
                summary { (summary) }
                @for block in blocks { (written(block)) }
            }
        },
    }
}

/// A sentence in which what is typed looks so.
fn prose(sentence: &str) -> Markup {
    html! {
        @for (part, is_typed) in typed_parts(sentence) {
            @if is_typed { code { (part) } } @else { (part) }
        }
    }
}

fn heading(depth: u8, text: &str, anchor: Option<&str>) -> Markup {
    if depth == 2 {
        html! { h2 id=[anchor] { (text) } }
    } else {
        html! { h3 id=[anchor] { (text) } }
    }
}

fn contents(entries: &[Entry]) -> Markup {
    html! {
        ul.contents {
            @for Entry { name, anchor, text } in entries {
                li { a href={ "#" (anchor) } { (name) } " " (prose(text)) }
            }
        }
    }
}

fn drawn(figures: &[Figure]) -> Markup {
    let class = if figures.len() > 1 { "figures several" } else { "figures" };
    html! {
        div class=(class) {
            @for one in figures {
                figure { (PreEscaped(draw(one))) figcaption { (prose(&one.caption)) } }
            }
        }
    }
}

fn table(table: &TextTable) -> Markup {
    let class = |column: usize| table.is_number(column).then_some("n");
    html! {
        div.table { table {
            thead { tr {
                @for (column, cell) in table.header.iter().enumerate() {
                    th scope="col" class=[class(column)] { (cell) }
                }
            } }
            tbody { @for row in &table.rows { tr {
                @for (column, cell) in row.iter().enumerate() {
                    td class=[class(column)] { (cell) }
                }
            } } }
        } }
    }
}
