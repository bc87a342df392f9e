//! A report as one page that needs nothing else, or as Markdown with its drawings as files beside it.

use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::document::{Attachment, Block, Document, Entry, Figure};
use super::plot::{PlotError, draw, figure_style};
use crate::report::TextTable;
use crate::wording::{legible, typed_parts};

/// How the page looks, but for the shades of figures.
const STYLE: &str = include_str!("style.css");

impl Document {
    /// The report as one HTML page: no script, and nothing is fetched.
    ///
    /// # Errors
    /// When a figure cannot be drawn.
    pub(crate) fn html(&self) -> Result<String, PlotError> {
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
                        @for block in &self.blocks { (written(block)?) }
                    }
                }
            }
        };
        Ok(legible(&page.into_string()) + "\n")
    }
}

fn written(block: &Block) -> Result<Markup, PlotError> {
    Ok(match block {
        Block::Heading { depth, text, anchor } => heading(*depth, text, anchor.as_deref()),
        Block::Text(text) => html! { p { (prose(text)) } },
        Block::Passage { question, text } => html! { p { b { (question) ":" } " " (prose(text)) } },
        Block::Lead(text) => html! { p.lead { (text) } },
        Block::List(entries) => html! { ul { @for entry in entries { li { (prose(entry)) } } } },
        Block::Contents(entries) => contents(entries),
        Block::Code(text) => html! { pre { code { (text) } } },
        Block::Figures(figures) => drawn(figures)?,
        Block::Table(rows) => table(rows),
        Block::Details { summary, blocks } => html! {
            details {
                summary { (summary) }
                @for block in blocks { (written(block)?) }
            }
        },
        Block::Attachment(file) => attachment(file),
    })
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

fn drawn(figures: &[Figure]) -> Result<Markup, PlotError> {
    let class = if figures.len() > 1 { "figures several" } else { "figures" };
    Ok(html! {
        div class=(class) {
            @for one in figures {
                figure { (PreEscaped(draw(one)?)) figcaption { (prose(&one.caption)) } }
            }
        }
    })
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

fn attachment(file: &Attachment) -> Markup {
    let link = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&file.bytes));
    html! { p { a download=(file.name) href=(link) { "Save " (file.name) } } }
}

/// A report as Markdown.
#[derive(Clone, Debug)]
pub(crate) struct Markdown {
    /// The text.
    pub(crate) text: String,
    /// Names and contents of the drawings that it shows, which are in the folder that was
    /// asked for.
    pub(crate) files: Vec<(String, String)>,
}

impl Document {
    /// The report as Markdown, whose drawings are in the folder `folder` beside it.
    ///
    /// # Errors
    /// When a figure cannot be drawn.
    pub(crate) fn markdown(&self, folder: &str) -> Result<Markdown, PlotError> {
        let mut markdown = Markdown { text: String::new(), files: Vec::new() };
        let folder = url(folder);
        markdown.line(&format!("# {}", escaped(&self.title)));
        for block in &self.blocks {
            markdown.block(block, &folder)?;
        }
        markdown.text = legible(&markdown.text);
        Ok(markdown)
    }
}

impl Markdown {
    /// A paragraph.
    fn line(&mut self, text: &str) {
        self.text.push_str(text.trim_end());
        self.text.push_str("\n\n");
    }

    fn block(&mut self, block: &Block, folder: &str) -> Result<(), PlotError> {
        match block {
            Block::Heading { depth, text, anchor } => {
                let marks = "#".repeat(usize::from(*depth));
                if let Some(anchor) = anchor {
                    self.line(&format!("<a id=\"{anchor}\"></a>"));
                }
                self.line(&format!("{marks} {}", escaped(text)));
            }
            Block::Text(text) => self.line(&prose_escaped(text)),
            Block::Passage { question, text } => {
                self.line(&format!("**{question}:** {}", prose_escaped(text)));
            }
            Block::Lead(text) => self.line(&format!("**{}**", escaped(text))),
            Block::List(entries) => {
                let lines = entries.iter().map(|entry| format!("- {}", prose_escaped(entry)));
                self.line(&lines.collect::<Vec<_>>().join("\n"));
            }
            Block::Contents(entries) => {
                let lines: Vec<String> = entries.iter().map(entry).collect();
                self.line(&lines.join("\n"));
            }
            Block::Code(text) => {
                let fence = fence(text);
                self.line(&format!("{fence}text\n{text}\n{fence}"));
            }
            Block::Figures(figures) => {
                figures.iter().try_for_each(|one| self.figure(one, folder))?;
            }
            Block::Table(table) => self.line(&table.markdown(escaped)),
            Block::Details { summary, blocks } => {
                self.line(&format!("<details><summary>{}</summary>", escaped(summary)));
                for block in blocks {
                    self.block(block, folder)?;
                }
                self.line("</details>");
            }
            // A file can only be in a page; here it is beside.
            Block::Attachment(file) => self.line(&format!("`{}`", file.name)),
        }
        Ok(())
    }

    fn figure(&mut self, figure: &Figure, folder: &str) -> Result<(), PlotError> {
        let (caption, file) = (escaped(&figure.caption), format!("{}.svg", figure.file));
        self.line(&format!("![{caption}]({folder}/{file})"));
        self.line(&format!("*{caption}*"));
        self.files.push((file, with_style(&draw(figure)?)));
        Ok(())
    }
}

fn entry(Entry { name, anchor, text }: &Entry) -> String {
    format!("- [{}](#{anchor}) {}", escaped(name), prose_escaped(text))
}

/// A sentence as Markdown, in which what is typed stays between backticks.
fn prose_escaped(sentence: &str) -> String {
    let part = |(part, is_typed): (&str, bool)| {
        if is_typed { format!("`{part}`") } else { escaped(part) }
    };
    typed_parts(sentence).into_iter().map(part).collect()
}

/// A drawing with the shades of either ground in it.
fn with_style(svg: &str) -> String {
    let style = figure_style();
    let ground = "svg{background:#fff}@media (prefers-color-scheme:dark){svg{background:#16181b}}";
    svg.replacen("</title>", &format!("</title><style>{style}{ground}</style>"), 1)
}

/// `text` without marks that Markdown or HTML would take for their own, in one line.
fn escaped(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => plain.push_str("&lt;"),
            '>' => plain.push_str("&gt;"),
            '&' => plain.push_str("&amp;"),
            '\n' | '\r' => plain.push(' '),
            '\\' | '`' | '*' | '_' | '[' | ']' | '|' | '#' | '~' | '$' | '!' => {
                plain.push('\\');
                plain.push(c);
            }
            _ => plain.push(c),
        }
    }
    plain
}

/// Backticks that do not end within `text`.
fn fence(text: &str) -> String {
    let longest = text.split(|c| c != '`').map(str::len).max().unwrap_or(0);
    "`".repeat(3.max(longest + 1))
}

/// A name as a part of a link.
fn url(name: &str) -> String {
    let mut link = String::new();
    for byte in name.bytes() {
        if byte.is_ascii_alphanumeric() || b"-_.~".contains(&byte) {
            link.push(char::from(byte));
        } else {
            write!(link, "%{byte:02X}").unwrap_or_default();
        }
    }
    link
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_what_they_are() {
        assert_eq!(escaped("a_b <i>|*x*&\n#1"), r"a\_b &lt;i&gt;\|\*x\*&amp; \#1");
        assert_eq!(url("my report_files"), "my%20report_files");
        assert_eq!(fence("a ```` b"), "`````");
    }
}
