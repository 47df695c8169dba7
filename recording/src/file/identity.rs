use std::ffi::OsString;
use std::fs::{self, File, Metadata};
use std::io;
use std::path::{Path, PathBuf};

/// Identity of a file, independent of the spelling of its path.
///
/// Links are resolved. Two names of one file are equal, and so are two paths to one place without a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileIdentity(Identity);

#[derive(Debug, Clone, PartialEq, Eq)]
enum Identity {
    Existing(Key),
    Absent {
        folder: Key,
        name: OsString,
    },
    /// Neither the file nor its folder exists.
    Nowhere(PathBuf),
}

/// Device and inode.
#[cfg(unix)]
type Key = (u64, u64);
/// Path without links.
#[cfg(not(unix))]
type Key = PathBuf;

impl FileIdentity {
    /// Returns the identity of the file at `path`, or of the one that would be there.
    ///
    /// No file is opened: an input may be a pipe, which would wait for its writer.
    #[must_use]
    pub fn of(path: impl AsRef<Path>) -> Self {
        let path = path.as_ref();
        Self(existing(path).unwrap_or_else(|| absent(path)))
    }

    /// Returns the identity of an open regular file, such as a redirected standard output; `None` for pipes and
    /// terminals, and where the system does not give it.
    #[must_use]
    pub fn of_open(file: &File) -> Option<Self> {
        let metadata = file.metadata().ok().filter(Metadata::is_file)?;
        open_key(&metadata).map(|key| Self(Identity::Existing(key)))
    }
}

fn existing(path: &Path) -> Option<Identity> {
    key(path).map(Identity::Existing)
}

fn absent(path: &Path) -> Identity {
    let place = destination(path).unwrap_or_else(|_| path.to_path_buf());
    let folder = match place.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    match (key(folder), place.file_name()) {
        (Some(folder), Some(name)) => Identity::Absent {
            folder,
            name: in_one_case(name.to_owned()),
        },
        _ => Identity::Nowhere(place),
    }
}

/// Returns the name in lower case on systems that usually treat `a.csv` and `A.csv` as one name.
fn in_one_case(name: OsString) -> OsString {
    if cfg!(any(windows, target_vendor = "apple")) {
        name.to_string_lossy().to_lowercase().into()
    } else {
        name
    }
}

#[cfg(unix)]
fn key(path: &Path) -> Option<Key> {
    open_key(&fs::metadata(path).ok()?)
}

#[cfg(not(unix))]
fn key(path: &Path) -> Option<Key> {
    fs::canonicalize(path).ok()
}

#[cfg(unix)]
#[expect(clippy::unnecessary_wraps, reason = "other systems do not say")]
fn open_key(metadata: &Metadata) -> Option<Key> {
    use std::os::unix::fs::MetadataExt as _;
    Some((metadata.dev(), metadata.ino()))
}

#[cfg(not(unix))]
fn open_key(_: &Metadata) -> Option<Key> {
    None
}

/// Maximum number of links in a chain; a longer chain is a circle.
const LINKS_MAX: usize = 40;

/// Returns the place that a path leads to when the file does not exist: the end of a chain of links.
pub(super) fn destination(path: &Path) -> io::Result<PathBuf> {
    let mut place = path.to_path_buf();
    for _ in 0..LINKS_MAX {
        match fs::read_link(&place) {
            Ok(next) => place = place.parent().unwrap_or(Path::new("")).join(next),
            Err(_) => return Ok(place),
        }
    }
    let message = format!("{} leads around in a circle of links", path.display());
    Err(io::Error::new(io::ErrorKind::InvalidInput, message))
}
