//! The files of a report: page or Markdown, recording, review page.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};

use super::args::OutputArgs;
use crate::cli::output::{OutputKind, Outputs, write_bytes};
use crate::report::page::Document;

/// Where the report and its recording go.
pub(super) struct Target {
    pub(super) path: PathBuf,
    kind: Kind,
    pub(super) recording: Option<PathBuf>,
    /// The page to review the decisions on.
    pub(super) review: Option<PathBuf>,
    /// The model that was found.
    pub(super) model: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Page,
    Markdown,
}

impl Target {
    /// The files that were asked for; none where the report has no name.
    pub(super) fn of(args: &OutputArgs) -> anyhow::Result<Option<Self>> {
        let Some(path) = args.report.as_deref() else { return Ok(None) };
        let kind = match path.extension().and_then(OsStr::to_str) {
            Some("html" | "htm") => Kind::Page,
            Some("md") => Kind::Markdown,
            _ => bail!("{}: a report is called FILE.html or FILE.md", path.display()),
        };
        let has_recordings = cfg!(feature = "rrd");
        if args.embed && kind == Kind::Markdown {
            bail!("--embed needs a page: Markdown cannot hold a file; use `-o FILE.html`");
        }
        if args.embed && !has_recordings {
            bail!("this program was built without recordings: build it with feature `rrd`");
        }
        let has_recording = has_recordings && !args.no_recording;
        let recording = has_recording.then(|| path.with_extension("rrd"));
        let review = args.interactive.then(|| beside(path, "_review.html"));
        Ok(Some(Self { path: path.to_owned(), kind, recording, review, model: None }))
    }

    /// With the model beside the page.
    pub(super) fn with_model(self) -> Self {
        Self { model: Some(self.path.with_extension("toml")), ..self }
    }

    /// Refuses what cannot be written.
    pub(super) fn check(&self, inputs: &[PathBuf]) -> anyhow::Result<()> {
        let pages = [Some(&self.path), self.review.as_ref()].into_iter().flatten();
        Outputs::default()
            .with(OutputKind::Other, pages)
            .with(OutputKind::Recording, &self.recording)
            .check(inputs)?;
        let folder = self.folder();
        if self.kind == Kind::Markdown && folder.exists() && !folder.is_dir() {
            bail!("{}: the drawings need a folder of this name", folder.display());
        }
        let folder = folder.canonicalize().unwrap_or(folder);
        let inside =
            |input: &&PathBuf| input.canonicalize().is_ok_and(|input| input.starts_with(&folder));
        if let Some(input) = inputs.iter().find(inside) {
            bail!(
                "{}: a file that is read lies in the folder of the drawings; give the report another \
                 name",
                input.display()
            );
        }
        Ok(())
    }

    /// Where the drawings of Markdown go.
    fn folder(&self) -> PathBuf {
        beside(&self.path, "_files")
    }

    pub(super) fn write(&self, document: &Document) -> anyhow::Result<()> {
        let text = match self.kind {
            Kind::Page => document.html()?,
            Kind::Markdown => {
                let folder = self.folder();
                let markdown = document.markdown(&file_name(&folder))?;
                fs::create_dir_all(&folder)
                    .with_context(|| format!("{}: cannot be made", folder.display()))?;
                for (name, drawing) in &markdown.files {
                    let place = folder.join(name);
                    // It may lead to a log.
                    if place.is_symlink() {
                        let place = place.display();
                        bail!("{place}: a link, and drawings are files of their own; remove it");
                    }
                    write_bytes(&place, drawing)?;
                }
                markdown.text
            }
        };
        write_bytes(&self.path, &text)
    }
}

/// The name of `path` with another ending.
fn beside(path: &Path, ending: &str) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}{ending}"))
}

pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
