//! The registry of languages: one line for each.

use super::Language;
use super::c::C;
use super::fmu::Fmu;
use super::matlab::Matlab;
use super::python::Python;

/// All languages.
const LANGUAGES: [&dyn Language; 4] = [&C, &Python, &Matlab, &Fmu];

/// The language of files whose names have this ending.
pub fn by_ending(ending: &str) -> Option<&'static dyn Language> {
    LANGUAGES.into_iter().find(|language| language.endings().contains(&ending))
}

/// All endings.
pub fn endings() -> Vec<&'static str> {
    LANGUAGES.iter().flat_map(|language| language.endings()).copied().collect()
}
