//! Files that bear their final name only when they are whole, and tables as CSV or Parquet by the name.

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use tempfile::NamedTempFile;

use crate::report::DataTable;

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
    // A pipe that a shell names, as `/dev/fd/63`, has no other name.
    if !is_file(path) {
        return path.to_owned();
    }
    // The target of a link may not be there yet.
    let path = path.read_link().map_or_else(|_| path.to_owned(), |to| folder_of(path).join(to));
    let parent = folder_of(&path).canonicalize().ok();
    let place = parent.zip(path.file_name()).map(|(folder, name)| folder.join(name));
    path.canonicalize().ok().or(place).unwrap_or(path)
}

/// Whether `path` is, or would be, a file that can be replaced: not a pipe, a device, or a file that
/// whoever called the program has opened.
pub(super) fn is_file(path: &Path) -> bool {
    let is_known = path.metadata().is_ok_and(|found| !found.is_file() && !found.is_dir());
    !is_known && number_of(path).is_none()
}

/// The number of a file that was opened before the program began, by what a shell calls it.
fn number_of(path: &Path) -> Option<u32> {
    let folders = ["/dev/fd", "/proc/self/fd"];
    let within = || folders.iter().find_map(|folder| path.strip_prefix(folder).ok());
    match path.to_str()? {
        "/dev/stdout" => Some(1),
        "/dev/stderr" => Some(2),
        // A way on from there, as `/dev/fd/../x`, is that of a file.
        _ => within()?.to_str()?.parse().ok(),
    }
}

/// The file of this number, at the place where it is written to: what stands in it before stays.
fn open_again(number: u32, path: &Path) -> io::Result<File> {
    #[cfg(unix)]
    {
        use std::os::fd::AsFd as _;
        match number {
            1 => return io::stdout().as_fd().try_clone_to_owned().map(File::from),
            2 => return io::stderr().as_fd().try_clone_to_owned().map(File::from),
            _ => {}
        }
    }
    OpenOptions::new().append(true).open(path)
}

fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or_else(|| Path::new("."))
}

impl OutputFile {
    /// Whether `path` can be written to, found out by trying: a folder that is missing is
    /// reported before the work is done.
    ///
    /// A pipe is left alone: to open and close it would tell who reads it that this was all.
    pub(crate) fn probe(path: &Path) -> anyhow::Result<()> {
        if !is_file(path) {
            return Ok(());
        }
        Self::create(path).map(drop)
    }

    /// Opens a file for `path`.
    pub(crate) fn create(path: &Path) -> anyhow::Result<Self> {
        if path.as_os_str() == "-" {
            bail!("-: give the output a name: /dev/stdout, or ./- for a file that is called so");
        }
        let target = target_of(path);
        let opened = Self::open(&target);
        let opened = opened.with_context(|| format!("{}: cannot be written", path.display()))?;
        Ok(Self { path: target, target: opened })
    }

    fn open(path: &Path) -> io::Result<Target> {
        if path.is_dir() {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        let folder = folder_of(path);
        if !folder.exists() {
            let text = format!("there is no folder `{}`", folder.display());
            return Err(io::Error::new(io::ErrorKind::NotFound, text));
        }
        if let Some(number) = number_of(path) {
            return Ok(Target::Direct(BufWriter::new(open_again(number, path)?)));
        }
        if !is_file(path) {
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
        // The name of the part says nothing to who named the output.
        let file = builder.tempfile_in(folder_of(path)).map_err(|error| error.kind())?;
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
                    // The content is on the disk before its name is.
                    file.as_file().sync_all()?;
                    file.persist(&self.path).map_err(|error| error.error)?;
                    Ok(())
                }
            }
        };
        finish(self.target).with_context(|| format!("{}: cannot be written", self.path.display()))
    }
}

/// Where an output ends up, also one that is written to a file that is open.
pub(super) fn place_of(path: &Path) -> PathBuf {
    let opened = number_of(path).and_then(|_| path.canonicalize().ok());
    opened.unwrap_or_else(|| target_of(path))
}

/// Writes `content` to a file whole.
pub(crate) fn write_bytes(path: &Path, content: impl AsRef<[u8]>) -> anyhow::Result<()> {
    write_file(path, |file| Ok(file.write_all(content.as_ref())?))
}

/// Lets `write` fill a file and gives it its name when that went well.
pub(crate) fn write_file(
    path: &Path,
    write: impl FnOnce(&mut OutputFile) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    filled_file(path, write)?.commit()
}

/// A file that `write` has filled, and that has not got its name yet.
pub(crate) fn filled_file(
    path: &Path,
    write: impl FnOnce(&mut OutputFile) -> anyhow::Result<()>,
) -> anyhow::Result<OutputFile> {
    let mut file = OutputFile::create(path)?;
    write(&mut file).with_context(|| format!("{}: cannot be written", path.display()))?;
    Ok(file)
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

/// Makes a file that may not grow further (`ulimit -f`) an error of whoever writes it. As the system
/// has it the program would end at once, without a message, and leave a part behind.
pub(crate) fn meet_file_limits() {
    #[cfg(unix)]
    {
        use std::sync::Arc;
        use std::sync::atomic::AtomicBool;

        use signal_hook::consts::SIGXFSZ;
        use signal_hook::flag::register;

        // Where it cannot be done the program ends as ever.
        register(SIGXFSZ, Arc::new(AtomicBool::new(false))).map(drop).unwrap_or_default();
    }
}

/// What a table is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FileKind {
    Csv,
    Parquet,
}

impl FileKind {
    /// Parquet where the name ends so, else CSV.
    pub(crate) fn of(path: &Path) -> Self {
        let ending = path.extension().unwrap_or_default();
        let parquet = ["parquet", "pq"].iter().any(|name| ending.eq_ignore_ascii_case(name));
        if parquet { Self::Parquet } else { Self::Csv }
    }
}

/// Writes a table as Parquet.
#[cfg(feature = "parquet")]
pub(crate) fn write_parquet(table: &DataTable, file: &mut OutputFile) -> anyhow::Result<()> {
    Ok(table.write_parquet(file)?)
}

#[cfg(not(feature = "parquet"))]
pub(crate) fn write_parquet(_: &DataTable, _: &mut OutputFile) -> anyhow::Result<()> {
    anyhow::bail!("Parquet is not in this build of tauscope")
}

/// Writes a table as what its name says.
pub(crate) fn write_table(table: &DataTable, path: &Path) -> anyhow::Result<()> {
    write_file(path, |file| match FileKind::of(path) {
        FileKind::Csv => Ok(table.write_csv(file)?),
        FileKind::Parquet => write_parquet(table, file),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_number_names_a_file_that_is_open() {
        let named = |path: &str| number_of(Path::new(path));
        assert_eq!(named("/dev/stdout"), Some(1));
        assert_eq!(named("/proc/self/fd/2"), Some(2));
        assert_eq!(named("/dev/fd/63"), Some(63));
        assert_eq!(["/dev/fd", "/dev/fd/../x.csv", "/dev/fd/x", "fd/1"].map(named), [None; 4]);
    }
}
