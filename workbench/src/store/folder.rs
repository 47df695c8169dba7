//! Project folder on the disk: marked as ours, private, without links, cleaned by one server at a time.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Write as _};
use std::path::{Path, PathBuf};

/// File that marks the folder as a project folder.
const MARKER: &str = "retarder-project.txt";
const MARKER_TEXT: &str = "This folder belongs to `retarder serve`. It keeps logs and projects here, and removes those \
     of its own that no project needs. To forget everything, delete the folder.\n";

/// Reason why a folder cannot be the project folder.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// The folder contains files of other programs.
    #[error(
        "{}: the folder is not empty and has no file `{MARKER}`, so its files are not ours to tidy. Choose a new or an \
         empty folder with --project; if an earlier version of `retarder serve` made this one, create an empty file \
         `{MARKER}` in it",
        .0.display()
    )]
    NotOurs(PathBuf),
    /// A link, folder or device has the place of a file or folder of the project.
    #[error(
        "{}: not a regular {expected} (links are not followed). Move it away, or choose another folder with --project",
        path.display()
    )]
    NotRegular {
        /// Path of the obstacle.
        path: PathBuf,
        /// Expected kind: `file` or `folder`.
        expected: &'static str,
    },
    /// Error of the operating system.
    #[error("{}: {error}; choose a folder that you own, with --project", path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// Error of the operating system.
        error: io::Error,
    },
}

/// Project folder with our marker.
pub(super) struct Folder {
    path: PathBuf,
}

/// Right to remove remains. It is exclusive, and ends when it is dropped or its process ends.
pub(super) struct TidyingRight(#[expect(dead_code, reason = "held for its lock")] File);

impl Folder {
    /// Opens the folder, or creates it. A folder with files is ours only if it has our marker.
    pub(super) fn open(path: &Path) -> Result<Self, FolderError> {
        make_private(path)?;
        let folder = Self {
            path: path.to_path_buf(),
        };
        let marker = path.join(MARKER);
        if !is_there(&marker, Kind::File)? {
            let mut entries = fs::read_dir(path).map_err(at(path))?;
            if entries.next().is_some() {
                return Err(FolderError::NotOurs(path.to_path_buf()));
            }
            // Two servers that begin at the same time write the same content.
            let mut file = File::create(&marker).map_err(at(&marker))?;
            file.write_all(MARKER_TEXT.as_bytes())
                .map_err(at(&marker))?;
        }
        tighten(path)?;
        Ok(folder)
    }

    /// Opens or creates a private folder within it.
    pub(super) fn part(&self, name: &str) -> Result<PathBuf, FolderError> {
        let path = self.path.join(name);
        if !is_there(&path, Kind::Folder)? {
            make_private(&path)?;
        }
        tighten(&path)?;
        Ok(path)
    }

    /// Takes the right to clean; `None` while another server has it.
    pub(super) fn take_tidying_right(&self) -> Result<Option<TidyingRight>, FolderError> {
        let file = open_lock(&self.path.join("lock"))?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => Ok(None),
            // On a file system without locks, no other server can have the right either.
            Ok(()) | Err(TryLockError::Error(_)) => Ok(Some(TidyingRight(file))),
        }
    }
}

/// Opens or creates a file to lock; its content stays.
pub(super) fn open_lock(path: &Path) -> Result<File, FolderError> {
    is_there(path, Kind::File)?;
    let mut options = OpenOptions::new();
    options.write(true).create(true).truncate(false);
    options.open(path).map_err(at(path))
}

/// Opens a file of the project folder for reading; a link is refused.
pub(crate) fn open_regular(path: &Path) -> io::Result<File> {
    if fs::symlink_metadata(path)?.is_file() {
        File::open(path)
    } else {
        Err(ErrorKind::InvalidInput.into())
    }
}

#[derive(Clone, Copy)]
enum Kind {
    File,
    Folder,
}

/// Returns whether it exists; fails if something else has its name.
fn is_there(path: &Path, kind: Kind) -> Result<bool, FolderError> {
    let (is_right, expected): (fn(&fs::Metadata) -> bool, _) = match kind {
        Kind::File => (fs::Metadata::is_file, "file"),
        Kind::Folder => (fs::Metadata::is_dir, "folder"),
    };
    match fs::symlink_metadata(path) {
        Ok(metadata) if is_right(&metadata) => Ok(true),
        Ok(_) => Err(FolderError::NotRegular {
            path: path.to_path_buf(),
            expected,
        }),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        Err(error) => Err(at(path)(error)),
    }
}

fn at(path: &Path) -> impl FnOnce(io::Error) -> FolderError {
    let path = path.to_path_buf();
    |error| FolderError::Io { path, error }
}

fn make_private(folder: &Path) -> Result<(), FolderError> {
    let mut builder = fs::DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.recursive(true).create(folder).map_err(at(folder))
}

/// Removes the access rights of other users of the machine, if the folder existed already.
fn tighten(folder: &Path) -> Result<(), FolderError> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        let mode = fs::metadata(folder).map_err(at(folder))?.permissions();
        if mode.mode() & 0o077 != 0 {
            let private = fs::Permissions::from_mode(0o700);
            fs::set_permissions(folder, private).map_err(at(folder))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_with_files_of_somebody_else_is_refused_and_stays_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("logs")).unwrap();
        fs::write(folder.path().join("logs/bench.csv"), "time_s\n").unwrap();
        let Err(error) = Folder::open(folder.path()) else {
            panic!("it was taken");
        };
        assert!(matches!(error, FolderError::NotOurs(_)), "{error}");
        let names = fs::read_dir(folder.path()).unwrap();
        let names: Vec<_> = names.map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(names, ["logs"]);
        // The file that the message names makes the folder ours.
        fs::write(folder.path().join(MARKER), "").unwrap();
        Folder::open(folder.path()).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_refused_wherever_it_stands() {
        use std::os::unix::fs::symlink;
        let elsewhere = tempfile::tempdir().unwrap();
        let target = elsewhere.path().join("target");
        for name in [MARKER, "lock"] {
            let folder = tempfile::tempdir().unwrap();
            if name != MARKER {
                Folder::open(folder.path()).unwrap();
            }
            fs::write(&target, "precious").unwrap();
            symlink(&target, folder.path().join(name)).unwrap();
            let error = Folder::open(folder.path())
                .and_then(|folder| folder.take_tidying_right())
                .err();
            assert!(
                matches!(error, Some(FolderError::NotRegular { .. })),
                "{name}: {error:?}"
            );
            assert_eq!(fs::read_to_string(&target).unwrap(), "precious", "{name}");
        }
        let folder = tempfile::tempdir().unwrap();
        symlink(elsewhere.path(), folder.path().join("logs")).unwrap();
        fs::write(folder.path().join(MARKER), "").unwrap();
        let part = Folder::open(folder.path()).unwrap().part("logs");
        assert!(matches!(part, Err(FolderError::NotRegular { .. })));
    }

    /// Defect seen: opening the lock replaced the content of the file.
    #[test]
    fn the_lock_is_opened_and_not_emptied() {
        let folder = tempfile::tempdir().unwrap();
        let ours = Folder::open(folder.path()).unwrap();
        fs::write(folder.path().join("lock"), "kept").unwrap();
        let first = ours.take_tidying_right().unwrap();
        assert!(first.is_some());
        assert!(ours.take_tidying_right().unwrap().is_none());
        drop(first);
        let text = fs::read_to_string(folder.path().join("lock")).unwrap();
        assert_eq!(text, "kept");
    }

    #[cfg(unix)]
    #[test]
    fn loose_permissions_are_tightened() {
        use std::os::unix::fs::PermissionsExt as _;
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        let folder = tempfile::tempdir().unwrap();
        let [project, logs] = ["project", "project/logs"].map(|name| folder.path().join(name));
        Folder::open(&project).unwrap();
        fs::create_dir(&logs).unwrap();
        for path in [&project, &logs] {
            fs::set_permissions(path, fs::Permissions::from_mode(0o777)).unwrap();
        }
        Folder::open(&project).unwrap().part("logs").unwrap();
        assert_eq!((mode(&project), mode(&logs)), (0o700, 0o700));
    }
}
