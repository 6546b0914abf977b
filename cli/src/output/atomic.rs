//! Files that are written whole or not at all.

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use flate2::{Compression, GzBuilder, write::GzEncoder};
use tempfile::NamedTempFile;

/// A file under a temporary name in its own folder until [`AtomicFile::commit`] renames it.
///
/// Whoever looks at the path sees the old file or the whole new one. Dropped without commit, nothing is left behind.
/// A name that ends in `.gz` is compressed; `-` is standard output; what is no regular file (`/dev/null`, a pipe) is
/// written to as it is.
pub struct AtomicFile {
    sink: Sink,
}

enum Sink {
    Plain(BufWriter<NamedTempFile>, PathBuf),
    Gzip(GzEncoder<BufWriter<NamedTempFile>>, PathBuf),
    Direct(BufWriter<Box<dyn Write>>),
}

impl AtomicFile {
    /// Begins a file.
    ///
    /// # Errors
    ///
    /// The system's: no such folder, no permission.
    pub fn create(path: &Path) -> io::Result<Self> {
        if path == Path::new("-") {
            return Ok(AtomicFile { sink: Sink::Direct(BufWriter::new(Box::new(io::stdout()))) });
        }
        // Through a symbolic link: the file it points to is replaced, not the link.
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        let existing = fs::metadata(&path).ok();
        if existing.as_ref().is_some_and(fs::Metadata::is_dir) {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "is a folder: expected the name of a file"));
        }
        if existing.as_ref().is_some_and(|metadata| !metadata.is_file()) {
            let file = fs::OpenOptions::new().write(true).open(&path)?;
            return Ok(AtomicFile { sink: Sink::Direct(BufWriter::new(Box::new(file))) });
        }
        let folder = match path.parent() {
            Some(folder) if folder != Path::new("") => folder,
            _ => Path::new("."),
        };
        let mut builder = tempfile::Builder::new();
        builder.prefix(".leafbrdf-").suffix(".tmp");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // As any new file: what the umask leaves of rw-rw-rw-. (Temporary files are for their owner only otherwise.)
            builder.permissions(
                existing.map_or_else(|| fs::Permissions::from_mode(0o666), |metadata| metadata.permissions()),
            );
        }
        let temporary = BufWriter::with_capacity(1 << 16, builder.tempfile_in(folder)?);
        let sink = if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz")) {
            // No time stamp: the same data give the same bytes.
            Sink::Gzip(GzBuilder::new().mtime(0).write(temporary, Compression::default()), path)
        } else {
            Sink::Plain(temporary, path)
        };
        Ok(AtomicFile { sink })
    }

    /// Completes the file under its own name.
    ///
    /// # Errors
    ///
    /// The system's: disk full, broken pipe.
    pub fn commit(self) -> io::Result<()> {
        let (temporary, path) = match self.sink {
            Sink::Direct(mut writer) => return writer.flush(),
            Sink::Plain(writer, path) => (writer, path),
            Sink::Gzip(encoder, path) => (encoder.finish()?, path),
        };
        let temporary = temporary.into_inner().map_err(io::IntoInnerError::into_error)?;
        temporary.persist(path).map_err(|error| error.error)?;
        Ok(())
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.sink {
            Sink::Plain(writer, _) => writer.write(bytes),
            Sink::Gzip(writer, _) => writer.write(bytes),
            Sink::Direct(writer) => writer.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.sink {
            Sink::Plain(writer, _) => writer.flush(),
            Sink::Gzip(writer, _) => writer.flush(),
            Sink::Direct(writer) => writer.flush(),
        }
    }
}

/// A leaf's name as the name of a file or folder: separators and what file systems refuse become `_`.
///
/// ```
/// use leafbrdf::output::file_name;
/// assert_eq!(file_name("laurel 3, upper"), "laurel 3, upper");
/// assert_eq!(file_name("../a:b"), "_.._a_b");
/// ```
pub fn file_name(name: &str) -> String {
    let kept = |c: char| if c.is_control() || "/\\:*?\"<>|".contains(c) { '_' } else { c };
    let mut file_name: String = name.trim().chars().map(kept).collect();
    if file_name.is_empty() || file_name.starts_with('.') {
        file_name.insert(0, '_');
    }
    file_name
}
