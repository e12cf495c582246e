//! Writing: files whole or not at all, and text to standard output.

use crate::failure::Failure;
use hemicube::raster::io_error::in_words;
use std::fs;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use tempfile::NamedTempFile;

/// The temporary files that are being written, so that Ctrl-C can remove them.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Removes what a write that is under way has made so far.
pub fn remove_unfinished() {
    for path in UNFINISHED
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .drain(..)
    {
        // Nothing can be done about a file that stays; the program is about to end.
        let _ = fs::remove_file(path);
    }
}

/// Prints to standard output; a reader that has gone away is no error.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Failure::Failed(format!(
            "standard output: {}",
            in_words(&e)
        ))),
        _ => Ok(()),
    }
}

/// Prints a JSON document to standard output.
pub fn print_json(value: &serde_json::Value) -> Result<(), Failure> {
    print(&format!("{value:#}\n"))
}

/// A file to be written, checked before the work begins.
#[derive(Debug, Clone)]
pub struct Target {
    /// As the user named it.
    pub path: PathBuf,
    /// Where it really goes: links are followed.
    real: PathBuf,
}

impl Target {
    /// Checks that a file can be written there, without touching it.
    ///
    /// `endings` are those that the caller can write; empty if any will do.
    pub fn check(path: &Path, endings: &[&str]) -> Result<Self, Failure> {
        let shown = path.display();
        let ending = path
            .extension()
            .map(|e| e.to_string_lossy().to_lowercase())
            .unwrap_or_default();
        if !endings.is_empty() && !endings.contains(&ending.as_str()) {
            let wanted: Vec<String> = endings.iter().map(|e| format!(".{e}")).collect();
            let is = if ending.is_empty() {
                String::from("has no ending")
            } else {
                format!("ends in .{ending}")
            };
            return Err(Failure::Usage(format!(
                "{shown}: its name {is}; use {}",
                wanted.join(" or ")
            )));
        }
        let real = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        let failed = |why: String| Err(Failure::Failed(format!("{shown}: {why}")));
        let target = Self {
            path: path.to_path_buf(),
            real,
        };
        match fs::metadata(&target.real) {
            Ok(facts) if facts.is_dir() => {
                return failed(String::from("is a folder; name a file in it"));
            }
            Ok(facts) if facts.permissions().readonly() => {
                return failed(String::from(
                    "is read-only; make it writable or choose another name",
                ));
            }
            Ok(facts) if !facts.is_file() => return Ok(target),
            _ => {}
        }
        if path.file_name().is_none() {
            return failed(String::from("is not the name of a file"));
        }
        let folder = target.folder();
        match fs::metadata(folder) {
            Ok(facts) if !facts.is_dir() => {
                return failed(format!("{} is not a folder", folder.display()));
            }
            Err(e) if e.kind() == ErrorKind::NotFound => {
                return failed(format!(
                    "the folder {} does not exist; make it first",
                    folder.display()
                ));
            }
            Err(e) => return failed(in_words(&e)),
            Ok(_) => {}
        }
        match tempfile::tempfile_in(folder) {
            Ok(_) => Ok(target),
            Err(e) => failed(format!(
                "the folder {} cannot be written to: {}",
                folder.display(),
                in_words(&e)
            )),
        }
    }

    fn folder(&self) -> &Path {
        match self.real.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        }
    }

    /// Whether a path leads to the same file, through links or not.
    pub fn is(&self, path: &Path) -> bool {
        fs::canonicalize(path).is_ok_and(|real| real == self.real)
    }

    /// Whether the name's ending is this one, in lower or upper case.
    pub fn ends_in(&self, ending: &str) -> bool {
        self.path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case(ending))
    }

    /// Writes the file whole or not at all.
    pub fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        self.write_with(|out| out.write_all(bytes))
    }

    /// Writes the file whole or not at all, piece by piece: for what is too large to be held in one piece.
    pub fn write_with(
        &self,
        fill: impl FnOnce(&mut BufWriter<&fs::File>) -> io::Result<()>,
    ) -> Result<(), Failure> {
        self.write_or_error(fill)
            .map_err(|e| Failure::Failed(format!("{}: {}", self.path.display(), in_words(&e))))
    }

    fn write_or_error(
        &self,
        fill: impl FnOnce(&mut BufWriter<&fs::File>) -> io::Result<()>,
    ) -> io::Result<()> {
        match self.stage(fill)? {
            Some(staged) => self.commit(staged),
            None => Ok(()),
        }
    }

    /// Writes a temporary file beside the one to be; a device or a pipe, which cannot be renamed onto, is written at once.
    fn stage(
        &self,
        fill: impl FnOnce(&mut BufWriter<&fs::File>) -> io::Result<()>,
    ) -> io::Result<Option<NamedTempFile>> {
        let facts = fs::metadata(&self.real);
        if facts.as_ref().is_ok_and(|facts| !facts.is_file()) {
            filled(&fs::File::create(&self.real)?, fill)?;
            return Ok(None);
        }
        let mut builder = tempfile::Builder::new();
        builder.prefix(".hemicube-");
        #[cfg(unix)]
        {
            // Like any new file, not private as temporary files are; the system takes the umask off.
            use std::os::unix::fs::PermissionsExt as _;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let file = builder.tempfile_in(self.folder())?;
        unfinished(|paths| paths.push(file.path().to_path_buf()));
        filled(file.as_file(), fill)?;
        if let Ok(facts) = facts {
            file.as_file().set_permissions(facts.permissions())?;
        }
        file.as_file().sync_all()?;
        Ok(Some(file))
    }

    /// Gives a temporary file its name.
    fn commit(&self, staged: NamedTempFile) -> io::Result<()> {
        let temporary = staged.path().to_path_buf();
        staged.persist(&self.real).map_err(|e| e.error)?;
        unfinished(|paths| paths.retain(|path| *path != temporary));
        Ok(())
    }
}

/// Changes the list of temporary files.
fn unfinished(change: impl FnOnce(&mut Vec<PathBuf>)) {
    change(&mut UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner));
}

/// Writes several files that belong together: none gets its name before all are on the disk.
pub fn write_together(files: &[(Target, Vec<u8>)]) -> Result<(), Failure> {
    let failed = |target: &Target, e: &io::Error| {
        Failure::Failed(format!("{}: {}", target.path.display(), in_words(e)))
    };
    let mut staged = Vec::new();
    for (target, bytes) in files {
        let file = target.stage(|out| out.write_all(bytes));
        staged.push((target, file.map_err(|e| failed(target, &e))?));
    }
    for (target, file) in staged {
        if let Some(file) = file {
            target.commit(file).map_err(|e| failed(target, &e))?;
        }
    }
    Ok(())
}

/// Fills a file through a buffer.
fn filled(
    file: &fs::File,
    fill: impl FnOnce(&mut BufWriter<&fs::File>) -> io::Result<()>,
) -> io::Result<()> {
    let mut out = BufWriter::with_capacity(1 << 16, file);
    fill(&mut out)?;
    out.flush()
}
