//! An FMU: FMI 3.0 for co-simulation, the C of the model behind the functions of the standard.
//!
//! The archive holds `modelDescription.xml`, the sources with their `buildDescription.xml`, and
//! where a C compiler is there the binary of this platform. A communication step of any length
//! is one interval of the model, in which its input is held.
//!
//! # References
//! Modelica Association, 2022, Functional Mock-up Interface Specification 3.0.

use std::env::consts::{ARCH, DLL_SUFFIX, OS};
use std::ffi::OsString;
use std::fs;
use std::io::{self, Cursor, Write as _};
use std::path::Path;
use std::process::Command;

use minijinja::{Value, context};
use sha2::{Digest as _, Sha256};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::error::ExportError;
use super::template::filled;

/// A file in the archive: its path and its bytes.
type Entry = (String, Vec<u8>);

/// Source and header in C of what `joint` says.
pub(super) fn sources(joint: &Value) -> Result<[String; 2], ExportError> {
    let of = |template| filled(template, commentable, joint);
    Ok([of(include_str!("template/model.c"))?, of(include_str!("template/model.h"))?])
}

/// A text that ends no comment, nor joins what stands before the end of a line to what follows it.
fn commentable(text: &str) -> String {
    let unspliced = text.replace("??/", "?? /").replace('\\', "|");
    unspliced.replace("*/", "* /").replace("/*", "/ *")
}

/// A text in XML.
fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    text.replace('"', "&quot;").replace('\n', "&#10;")
}

/// The archive of what `joint` says, and what is missing in it.
pub(super) fn packed(joint: &Value, name: &str) -> Result<(Vec<u8>, Option<String>), ExportError> {
    let [source, header] = sources(joint)?;
    // A name that no other model has.
    let token = Sha256::new().chain_update(&source).chain_update(&header).finalize();
    let joint = context! { token => base16ct::lower::encode_string(&token), ..joint.clone() };
    let model = filled(include_str!("template/modelDescription.xml"), escaped, &joint)?;
    let build = filled(include_str!("template/buildDescription.xml"), escaped, &joint)?;
    let fmi = filled(include_str!("template/fmi3.c"), commentable, &joint)?;
    let entries = [
        ("modelDescription.xml".to_owned(), model),
        ("sources/buildDescription.xml".to_owned(), build),
        ("sources/fmi3.c".to_owned(), fmi),
        (format!("sources/{name}.c"), source),
        (format!("sources/{name}.h"), header),
    ];
    let mut entries: Vec<Entry> =
        entries.into_iter().map(|(path, text)| (path, text.into_bytes())).collect();
    let note = match compiled(&entries, name) {
        Ok(binary) => {
            entries.push(binary);
            None
        }
        Err(why) => Some(format!("it holds sources alone, and no binary: {why}")),
    };
    let archive = archive(&entries);
    let archive = archive.map_err(|error| ExportError::Archive { problem: error.to_string() })?;
    Ok((archive, note))
}

/// The archive of `entries`, the same bytes for the same entries.
fn archive(entries: &[Entry]) -> zip::result::ZipResult<Vec<u8>> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(zip::DateTime::default());
    for (path, content) in entries {
        writer.start_file(path.as_str(), options)?;
        writer.write_all(content)?;
    }
    Ok(writer.finish()?.into_inner())
}

/// The library that the sources of `entries` make, under its name in an FMU.
///
/// # Errors
/// Why there is none, in words.
fn compiled(entries: &[Entry], name: &str) -> Result<Entry, String> {
    let compiler = std::env::var_os("CC").unwrap_or_else(|| OsString::from("cc"));
    let platform = platform().ok_or_else(|| format!("FMI has no name for {ARCH}-{OS}"))?;
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let library = format!("{name}{DLL_SUFFIX}");
    run(&compiler, entries, folder.path(), &library)?;
    let content = fs::read(folder.path().join(&library)).map_err(|error| error.to_string())?;
    Ok((format!("binaries/{platform}/{library}"), content))
}

/// This platform, as FMI calls it.
fn platform() -> Option<String> {
    let system = if OS == "macos" { "darwin" } else { OS };
    let is_known = matches!(system, "linux" | "darwin" | "windows")
        && matches!(ARCH, "x86" | "x86_64" | "aarch64");
    is_known.then(|| format!("{ARCH}-{system}"))
}

fn run(compiler: &OsString, entries: &[Entry], folder: &Path, library: &str) -> Result<(), String> {
    let mut sources = Vec::new();
    for (path, content) in entries {
        let Some(file) = path.strip_prefix("sources/") else { continue };
        fs::write(folder.join(file), content).map_err(|error| error.to_string())?;
        if Path::new(file).extension().is_some_and(|ending| ending == "c") {
            sources.push(file);
        }
    }
    let shown = compiler.to_string_lossy();
    let done = Command::new(compiler)
        .args(["-std=c99", "-O2", "-shared", "-fPIC", "-fvisibility=hidden", "-o", library])
        .args(sources)
        .arg("-lm")
        .current_dir(folder)
        .output();
    let done = done.map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => format!("there is no C compiler `{shown}`; CC names another"),
        _ => format!("`{shown}`: {error}"),
    })?;
    if done.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&done.stderr);
    Err(format!("`{shown}` says: {}", said.lines().next().unwrap_or_default()))
}
