//! An FMU: FMI 3.0 for co-simulation, the C of the model behind the functions of the standard.
//!
//! The archive holds `modelDescription.xml`, the sources with their `buildDescription.xml`, and
//! where a C compiler is there the binary of this platform. A communication step of any length
//! is one interval of the model, in which its input is held.
//!
//! # References
//! Modelica Association, 2022, Functional Mock-up Interface Specification 3.0.

mod archive;
mod binary;
mod xml;

use super::ExportError;
use super::c::{commentable, sources};
use super::description::{Export, Parameter};
use super::language::{File, Language};
use super::template::{filled, indented};
use archive::{Entry, archive};
use binary::compiled;
use sha2::{Digest as _, Sha256};

const FMI: &str = include_str!("../template/fmi3.c");

/// FMI 3.0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fmu;

impl Language for Fmu {
    fn endings(&self) -> &'static [&'static str] {
        &["fmu"]
    }

    fn name(&self) -> &'static str {
        "FMI"
    }

    fn written(&self, export: &Export, name: &str) -> Result<Vec<File>, ExportError> {
        let (source, header) = sources(export, name);
        let token = token(&[&source, &header]);
        let fmi = fmi(export, name, &token);
        let model = format!("sources/{name}");
        let mut entries = vec![
            Entry::text("modelDescription.xml", xml::model_description(export, name, &token)),
            Entry::text("sources/buildDescription.xml", xml::build_description(name)),
            Entry::text("sources/fmi3.c", fmi),
            Entry::text(&format!("{model}.c"), source),
            Entry::text(&format!("{model}.h"), header),
        ];
        let note = match compiled(&entries, name) {
            Ok(binary) => {
                entries.push(binary);
                None
            }
            Err(why) => Some(format!("it holds sources alone, and no binary: {why}")),
        };
        Ok(vec![File { ending: "fmu", content: archive(&entries)?, note }])
    }
}

/// A name that no other model has.
fn token(sources: &[&str]) -> String {
    let mut hash = Sha256::new();
    for source in sources {
        hash.update(source.as_bytes());
    }
    base16ct::lower::encode_string(&hash.finalize())
}

fn fmi(export: &Export, name: &str, token: &str) -> String {
    let case = |(number, parameter): (usize, &Parameter)| {
        format!("case PARAMETER + {number}: return &p->{};", parameter.name)
    };
    let cases = indented(export.parameters.iter().enumerate().map(case), "    ");
    let joint = commentable(&export.joint);
    let places = [("CASES", cases.as_str()), ("TOKEN", token), ("FILE", name), ("JOINT", &joint)];
    filled(&filled(FMI, &places), &[("NAME", name)])
}
