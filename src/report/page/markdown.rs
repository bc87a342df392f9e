//! A report as Markdown, with its drawings as files beside it.

use std::fmt::Write as _;

use super::document::{Block, Document, Entry, Figure};
use super::palette::figure_style;
use super::plot::{PlotError, draw};
use crate::wording::legible;

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
            Block::Text(text) => self.line(&escaped(text)),
            Block::Passage { question, text } => {
                self.line(&format!("**{question}:** {}", escaped(text)));
            }
            Block::Lead(text) => self.line(&format!("**{}**", escaped(text))),
            Block::List(entries) => {
                let lines = entries.iter().map(|entry| format!("- {}", escaped(entry)));
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
    format!("- [{}](#{anchor}) {}", escaped(name), escaped(text))
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
