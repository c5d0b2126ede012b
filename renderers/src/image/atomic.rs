//! Files that are complete or not there.

use super::ImageError;
use core::sync::atomic::{AtomicU64, Ordering};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Writes a file so that it is never seen half written: beside its place under another name, then renamed.
///
/// What was at `path` stays until the new file is complete and on disk, and stays for good if `write` fails or panics;
/// the unfinished file is then removed. `path` must be a regular file or not exist yet: devices and directories
/// are not replaced.
///
/// # Errors
/// [`ImageError::Io`], naming `path`, with the error of `write` or of the file system.
pub fn write_atomic(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<(), ImageError> {
    replace(path, write).map_err(|source| ImageError::io(path, source))
}

fn replace(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    if fs::metadata(path).is_ok_and(|data| !data.is_file()) {
        return Err(io::Error::other("not a regular file, so it is not replaced"));
    }
    let (unfinished, file) = Unfinished::create(path)?;
    let mut buffer = BufWriter::new(file);
    write(&mut buffer)?;
    buffer.flush()?;
    buffer.get_ref().sync_all()?;
    // Some systems don't rename open files.
    drop(buffer);
    unfinished.rename(path)
}

/// A file under its temporary name, removed when dropped.
struct Unfinished {
    path: PathBuf,
    renamed: bool,
}

impl Unfinished {
    fn create(target: &Path) -> io::Result<(Self, File)> {
        static COUNTER: AtomicU64 = AtomicU64::new(0);
        let name = target.file_name().ok_or_else(|| io::Error::other("the path has no file name"))?;
        loop {
            let mut temporary = std::ffi::OsString::from(".");
            temporary.push(name);
            temporary.push(format!(".{}-{}.part", std::process::id(), COUNTER.fetch_add(1, Ordering::Relaxed)));
            let path = target.with_file_name(temporary);
            match File::create_new(&path) {
                Ok(file) => return Ok((Self { path, renamed: false }, file)),
                // Left behind by a killed process of the same number.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }

    fn rename(mut self, target: &Path) -> io::Result<()> {
        fs::rename(&self.path, target)?;
        self.renamed = true;
        Ok(())
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if !self.renamed {
            // Nothing better can be done: the first error is the one that is reported.
            let _ = fs::remove_file(&self.path);
        }
    }
}
