//! The languages: templates that are filled in with a model.

use std::collections::BTreeSet;

use minijinja::syntax::SyntaxConfig;
use minijinja::{AutoEscape, Environment, Value, context};

use super::ExportError;
use super::description::{Export, Exported, Parameter};
use super::fmu;
use super::notation::{Notation, lines, result};
use crate::effect::Stage;
use crate::effect::expression::Program;

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

/// `template` with the values of `context` filled in; `plain` makes of a text of the user's one that ends
/// no comment.
pub(super) fn filled(
    template: &str,
    plain: fn(&str) -> String,
    context: &Value,
) -> Result<String, ExportError> {
    let problem = |error: minijinja::Error| ExportError::Template { problem: error.to_string() };
    let mut syntax = SyntaxConfig::builder();
    syntax.trim_blocks(true).lstrip_blocks(true).keep_trailing_newline(true);
    let mut environment = Environment::new();
    environment.set_syntax(syntax.build().map_err(problem)?);
    environment.set_auto_escape_callback(|_| AutoEscape::None);
    environment.add_filter("plain", move |text: &str| plain(text));
    environment.render_str(template, context.clone()).map_err(problem)
}

/// What the templates say of a joint.
fn joint(notation: Notation, export: &Export, name: &str) -> Value {
    let Export { joint, origin, units, parameters, effects } = export;
    let program = |effect: &Exported, program: &Program| {
        let lines = lines(notation, effect, program);
        context! { lines => lines, result => result(program) }
    };
    let effect = |effect: &Exported| {
        let Exported { id, summary, equation, .. } = effect;
        let (settle, step) = (program(effect, &effect.settle), program(effect, &effect.step));
        context! { id, summary, equation, settle, step }
    };
    let values = |effects: &mut dyn Iterator<Item = &Exported>| effects.map(effect).collect();
    let of_stage = |stage| -> Vec<Value> { values(&mut export.stage(stage)) };
    let [drive, limits, sensor]: [Vec<Value>; 3] =
        [values(&mut export.drive()), values(&mut export.limits()), values(&mut export.sensor())];
    let memory: Vec<String> = effects.iter().flat_map(|effect| effect.memory.clone()).collect();
    let own = [units.input.as_deref(), units.output.as_deref()].map(Option::unwrap_or_default);
    let [input_unit, output_unit] = own;
    let named = parameters.iter().map(|parameter| parameter.unit.as_str()).chain(own).chain(["s"]);
    let units: BTreeSet<&str> = named.filter(|unit| !unit.is_empty()).collect();
    let units: Vec<String> = units.into_iter().map(str::to_owned).collect();
    let parameter = |parameter: &Parameter| {
        let Parameter { name, meaning, unit, value } = parameter;
        let described = parameter.described();
        context! { name, meaning, unit, described, value => format!("{value:?}") }
    };
    context! {
        name,
        joint,
        origin,
        memory,
        drive,
        limits,
        sensor,
        input_unit,
        output_unit,
        units,
        parameters => parameters.iter().map(parameter).collect::<Vec<_>>(),
        effects => effects.iter().map(effect).collect::<Vec<_>>(),
        load => of_stage(Stage::Load),
        transport => of_stage(Stage::Transport),
        uses_others => export.uses_others(),
        version => env!("CARGO_PKG_VERSION"),
    }
}
