//! The languages: which files each has, and from which templates.

use super::description::Export;
use super::error::ExportError;
use super::fmu;
use super::notation::Notation;
use super::template::{filled, joint};

/// A language that a model can be written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// C99: source and header, without allocation and without dependencies but `math.h`.
    C,
    /// A module of Python 3 for `NumPy`.
    Python,
    /// A function of MATLAB and GNU Octave.
    Matlab,
    /// FMI 3.0 for co-simulation, around the C.
    Fmu,
}

/// A file of an exported model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// The ending of its name, without a dot.
    pub ending: &'static str,
    /// Its bytes.
    pub content: Vec<u8>,
    /// What is to be said of it: what is missing in it, and why.
    pub note: Option<String>,
}

impl File {
    /// Its text, where it is text.
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.content).into_owned()
    }
}

const ALL: [Language; 4] = [Language::C, Language::Python, Language::Matlab, Language::Fmu];

/// The language of files whose names have this ending.
pub fn by_ending(ending: &str) -> Option<Language> {
    ALL.into_iter().find(|language| language.endings().contains(&ending))
}

/// All endings.
pub fn endings() -> Vec<&'static str> {
    ALL.iter().flat_map(|language| language.endings()).copied().collect()
}

impl Language {
    /// How the names of its files end; the first is that of the file with the step function.
    pub fn endings(self) -> &'static [&'static str] {
        match self {
            Self::C => &["c", "h"],
            Self::Python => &["py"],
            Self::Matlab => &["m"],
            Self::Fmu => &["fmu"],
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::C => "C",
            Self::Python => "Python",
            Self::Matlab => "MATLAB",
            Self::Fmu => "FMI",
        }
    }

    /// The files of `export`; `name` is what they are called, without their endings.
    ///
    /// # Errors
    /// [`ExportError::Name`] where `name` is not one in this language;
    /// [`ExportError::Archive`] and [`ExportError::Template`] where the files cannot be put together.
    pub fn files(self, export: &Export, name: &str) -> Result<Vec<File>, ExportError> {
        if !is_name(name) {
            return Err(ExportError::Name { name: name.to_owned(), language: self.name() });
        }
        let of = |notation| joint(notation, export, name);
        let contents = match self {
            Self::C => fmu::sources(&of(Notation::C))?.map(String::into_bytes).to_vec(),
            Self::Python => {
                let quotable = |text: &str| text.replace('\\', "/").replace('"', "'");
                let template = include_str!("template/model.py");
                vec![filled(template, quotable, &of(Notation::Python))?.into_bytes()]
            }
            Self::Matlab => {
                let template = include_str!("template/model.m");
                vec![filled(template, str::to_owned, &of(Notation::Matlab))?.into_bytes()]
            }
            Self::Fmu => {
                let (content, note) = fmu::packed(&of(Notation::C), name)?;
                return Ok(vec![File { ending: "fmu", content, note }]);
            }
        };
        let files = self.endings().iter().zip(contents);
        Ok(files.map(|(ending, content)| File { ending, content, note: None }).collect())
    }
}

/// Whether `name` is one in the languages that models are written in.
fn is_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}
