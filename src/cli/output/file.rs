//! Files that bear their final name only when they are whole.

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use tempfile::NamedTempFile;

/// A file that is being written. Dropped before [`commit`](Self::commit), it leaves
/// nothing behind and what stood under the name before stays.
#[derive(Debug)]
pub(crate) struct OutputFile {
    path: PathBuf,
    target: Target,
}

#[derive(Debug)]
enum Target {
    /// Written beside the final name and renamed.
    Temporary(BufWriter<NamedTempFile>),
    /// A pipe or a device: it cannot be replaced, only written to.
    Direct(BufWriter<File>),
}

/// The file that `path` leads to: a link is written through, not replaced.
pub(crate) fn target_of(path: &Path) -> PathBuf {
    // The target of a link may not be there yet.
    let path = path.read_link().map_or_else(|_| path.to_owned(), |to| folder_of(path).join(to));
    let parent = folder_of(&path).canonicalize().ok();
    let place = parent.zip(path.file_name()).map(|(folder, name)| folder.join(name));
    path.canonicalize().ok().or(place).unwrap_or(path)
}

fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or_else(|| Path::new("."))
}

impl OutputFile {
    /// Whether `path` can be written to, found out by trying: a folder that is missing is
    /// reported before the work is done.
    pub(crate) fn probe(path: &Path) -> anyhow::Result<()> {
        Self::create(path).map(drop)
    }

    /// Opens a file for `path`.
    pub(crate) fn create(path: &Path) -> anyhow::Result<Self> {
        let target = target_of(path);
        let opened = Self::open(&target);
        let opened = opened.with_context(|| format!("{}: cannot be written", path.display()))?;
        Ok(Self { path: target, target: opened })
    }

    fn open(path: &Path) -> io::Result<Target> {
        if path.is_dir() {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        if path.exists() && !path.is_file() {
            let device = OpenOptions::new().write(true).open(path)?;
            return Ok(Target::Direct(BufWriter::new(device)));
        }
        let mut builder = tempfile::Builder::new();
        builder.prefix(".tauscope-").suffix(".part");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            // As for any new file: the user's mask takes its share off.
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        let file = builder.tempfile_in(folder_of(path))?;
        if let Ok(existing) = path.metadata() {
            file.as_file().set_permissions(existing.permissions())?;
        }
        Ok(Target::Temporary(BufWriter::new(file)))
    }

    /// The file under its final name, whole.
    pub(crate) fn commit(self) -> anyhow::Result<()> {
        let finish = |target: Target| -> io::Result<()> {
            match target {
                Target::Direct(mut device) => device.flush(),
                Target::Temporary(file) => {
                    let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
                    file.persist(&self.path).map_err(|error| error.error)?;
                    Ok(())
                }
            }
        };
        finish(self.target).with_context(|| format!("{}: cannot be written", self.path.display()))
    }
}

/// Refuses outputs that cannot be written, or would replace an input or one another.
pub(crate) fn check_outputs(outputs: &[&Path], inputs: &[PathBuf]) -> anyhow::Result<()> {
    let mut taken: Vec<PathBuf> = Vec::new();
    for path in outputs {
        let target = target_of(path);
        let name = path.display();
        // A device, such as /dev/null, may take any number of outputs.
        let is_file = !target.exists() || target.is_file();
        if inputs.contains(&target) {
            bail!("{name}: this is a file that is read; give the output another name");
        }
        if is_file && taken.contains(&target) {
            bail!("{name}: two outputs have this name; give each its own");
        }
        OutputFile::probe(path)?;
        taken.push(target);
    }
    Ok(())
}

/// Lets `write` fill a file and gives it its name when that went well.
pub(crate) fn write_file(
    path: &Path,
    write: impl FnOnce(&mut OutputFile) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let mut file = OutputFile::create(path)?;
    write(&mut file).with_context(|| format!("{}: cannot be written", path.display()))?;
    file.commit()
}

impl Write for OutputFile {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        match &mut self.target {
            Target::Temporary(file) => file.write(buffer),
            Target::Direct(file) => file.write(buffer),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.target {
            Target::Temporary(file) => file.flush(),
            Target::Direct(file) => file.flush(),
        }
    }
}
