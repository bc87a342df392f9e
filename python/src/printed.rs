//! What a command prints, kept until it is asked for: a hundred thousand decisions are 70 MB of
//! JSON, which most callers never look at as text.

use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom, Write as _};
use std::sync::{Mutex, PoisonError};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// What is kept in memory, bytes: the JSON of five thousand decisions. What is longer goes to a
/// file.
const IN_MEMORY: usize = 4 << 20;

/// The text that a command printed.
#[pyclass(frozen, module = "tauscope")]
#[derive(Default)]
pub(crate) struct Printed(Mutex<Kept>);

#[derive(Default)]
struct Kept {
    memory: Vec<u8>,
    /// Has no name, and is gone with this value. None where all is in memory.
    file: Option<File>,
    /// Bytes in the file.
    filed: u64,
}

#[pymethods]
impl Printed {
    /// All of it.
    fn text(&self) -> PyResult<String> {
        let text = self.0.lock().unwrap_or_else(PoisonError::into_inner).text()?;
        String::from_utf8(text).map_err(|error| PyRuntimeError::new_err(error.to_string()))
    }
}

impl Printed {
    /// Takes what comes after.
    pub(crate) fn push(&self, text: &[u8]) -> io::Result<()> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(text)
    }

    /// All of it, which is not here any more then.
    pub(crate) fn take(&self) -> Self {
        Self(Mutex::new(std::mem::take(
            &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner),
        )))
    }
}

impl Kept {
    fn push(&mut self, text: &[u8]) -> io::Result<()> {
        if self.file.is_none() && self.memory.len() + text.len() > IN_MEMORY {
            // Where no file can be made, all stays in memory.
            self.file = tempfile::tempfile().ok();
            if self.file.is_some() {
                let before = std::mem::take(&mut self.memory);
                self.write(&before)?;
            }
        }
        self.write(text)
    }

    /// Puts `text` into the file; into memory, with what is in the file, where that is full.
    fn write(&mut self, text: &[u8]) -> io::Result<()> {
        if let Some(file) = &mut self.file {
            if file.write_all(text).is_ok() {
                self.filed += text.len() as u64;
                return Ok(());
            }
            self.memory = self.text()?;
            (self.file, self.filed) = (None, 0);
        }
        self.memory.extend(text);
        Ok(())
    }

    fn text(&mut self) -> io::Result<Vec<u8>> {
        let Some(file) = &mut self.file else { return Ok(self.memory.clone()) };
        let mut text = Vec::with_capacity(usize::try_from(self.filed).unwrap_or_default());
        file.seek(SeekFrom::Start(0))?;
        file.take(self.filed).read_to_end(&mut text)?;
        Ok(text)
    }
}
