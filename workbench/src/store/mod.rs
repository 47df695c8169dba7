//! Project folder: logs under their hash, one file per project. No file name comes from a request.

mod folder;

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use axum::body::Body;
use axum::http::StatusCode;
use futures_util::StreamExt as _;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use tokio::io::AsyncWriteExt as _;
use tokio::time::timeout;

use crate::names::{LogHash, ProjectId};
use crate::project::{LogEntry, Project};
use crate::refusal::Refusal;
use crate::results::Findings;
pub use folder::FolderError;
pub(crate) use folder::open_regular;
use folder::{Folder, TidyingRight};

/// Largest accepted file (bytes): an hour at 1 kHz in a dozen channels as text.
pub(crate) const UPLOAD_BYTES_MAX: u64 = 1 << 30;
/// Longest pause within an upload.
const SILENCE_MAX: Duration = Duration::from_secs(30);
/// Number of stored projects; the files of older ones are removed when the folder is opened.
const PROJECTS_MAX: usize = 50;

/// Simultaneous jobs of all tabs together; others wait.
const PLACES: usize = 2;
/// Suffix of a file with findings.
const FINDINGS: &str = "findings.json";

/// Project folder.
pub(crate) struct Store {
    folder: PathBuf,
    logs: PathBuf,
    projects: PathBuf,
    /// Folder of files being written; each is renamed when it is complete.
    incoming: PathBuf,
    /// Right of the first server that has the folder open: only that server removes files.
    _tidying: Option<TidyingRight>,
}

impl Store {
    /// Opens or creates the folder, for its owner only, and removes unneeded files of its own unless another server is
    /// using it. The returned texts are about projects that cannot be read; while there are any, no log is removed.
    pub(crate) fn open(folder: &Path) -> Result<(Self, Vec<String>), FolderError> {
        let mut store = Self::join(folder)?;
        store._tidying = Folder::open(folder)?.take_tidying_right()?;
        let unreadable = match store._tidying {
            Some(_) => store.tidy().map_err(|error| FolderError::Io {
                path: folder.to_path_buf(),
                error,
            })?,
            None => Vec::new(),
        };
        Ok((store, unreadable))
    }

    /// Opens the folder beside the server that has it open.
    pub(crate) fn join(folder: &Path) -> Result<Self, FolderError> {
        let ours = Folder::open(folder)?;
        Ok(Self {
            folder: folder.to_path_buf(),
            logs: ours.part("logs")?,
            projects: ours.part("projects")?,
            incoming: ours.part("incoming")?,
            _tidying: None,
        })
    }

    /// Receives an upload, and names it by its hash. Only one chunk of it is in memory.
    pub(crate) async fn receive(&self, body: Body) -> Result<LogHash, Refusal> {
        let name = ProjectId::random()?;
        let path = self.incoming.join(name.as_str());
        let received = self.receive_into(&path, body).await;
        if received.is_err() {
            let _ = tokio::fs::remove_file(&path).await;
        }
        received
    }

    async fn receive_into(&self, path: &Path, body: Body) -> Result<LogHash, Refusal> {
        let mut options = tokio::fs::OpenOptions::new();
        let mut file = options.write(true).create_new(true).open(path).await?;
        let mut chunks = body.into_data_stream();
        let mut hash = Sha256::new();
        let mut size = 0;
        while let Some(chunk) = timeout(SILENCE_MAX, chunks.next())
            .await
            .map_err(|_| too_slow())?
        {
            let chunk = chunk.map_err(|_| Refusal::broken_off())?;
            size += chunk.len() as u64;
            if size > UPLOAD_BYTES_MAX {
                return Err(Refusal::too_large(size, UPLOAD_BYTES_MAX));
            }
            hash.update(&chunk);
            file.write_all(&chunk).await?;
        }
        file.sync_all().await?;
        let hash = LogHash::of(&hash.finalize());
        tokio::fs::rename(path, self.log_path(&hash)).await?;
        Ok(hash)
    }

    /// Stores a bundled log.
    pub(crate) fn keep(&self, bytes: &[u8]) -> io::Result<LogHash> {
        let hash = LogHash::of(&Sha256::digest(bytes));
        let path = self.log_path(&hash);
        if open_regular(&path).is_err() {
            self.write(&path, bytes)?;
        }
        Ok(hash)
    }

    /// Writes a file completely or not at all. A link of that name is replaced, not followed.
    fn write(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let unfinished = self.incoming.join(ProjectId::random()?.as_str());
        let mut options = OpenOptions::new();
        let mut file = options.write(true).create_new(true).open(&unfinished)?;
        let written = file
            .write_all(bytes)
            // File systems have a time resolution of milliseconds: two projects saved within one would have no order.
            .and_then(|()| file.set_modified(SystemTime::now()))
            .and_then(|()| file.sync_all())
            .and_then(|()| fs::rename(&unfinished, path));
        if written.is_err() {
            let _ = fs::remove_file(&unfinished);
        }
        written
    }

    /// Returns the path of a log.
    pub(crate) fn log_path(&self, hash: &LogHash) -> PathBuf {
        self.logs.join(hash.as_str())
    }

    fn project_path(&self, id: &ProjectId) -> PathBuf {
        self.projects.join(format!("{}.json", id.as_str()))
    }

    pub(crate) fn save(&self, id: &ProjectId, project: &Project) -> io::Result<()> {
        let json = serde_json::to_vec_pretty(project)?;
        self.write(&self.project_path(id), &json)
    }

    /// Returns the project of this id; `None` if it is missing or unreadable.
    pub(crate) fn load(&self, id: &ProjectId) -> Option<Project> {
        read_project(&self.project_path(id)).ok()
    }

    /// Returns the project that was changed last.
    pub(crate) fn newest(&self) -> Option<ProjectId> {
        let (_, path) = self.project_files().ok()?.pop()?;
        project_id(path.file_name()?.to_str()?)
    }

    /// Returns whether there is a readable project of this id.
    pub(crate) fn has(&self, id: &ProjectId) -> bool {
        self.load(id).is_some()
    }

    fn findings_path(&self, id: &ProjectId) -> PathBuf {
        self.projects.join(format!("{}.{FINDINGS}", id.as_str()))
    }

    pub(crate) fn save_findings(&self, id: &ProjectId, findings: &Findings) -> io::Result<()> {
        let json = serde_json::to_vec(findings)?;
        self.write(&self.findings_path(id), &json)
    }

    /// Returns the findings about a project; `None` if they are missing or unreadable.
    pub(crate) fn load_findings(&self, id: &ProjectId) -> Option<Findings> {
        read_json(&self.findings_path(id)).ok()
    }

    pub(crate) fn remove_findings(&self, id: &ProjectId) {
        // Most projects have none.
        let _ = fs::remove_file(self.findings_path(id));
    }

    /// Writes a note that a session begins to read a log.
    pub(crate) fn note_being_read(&self, id: &ProjectId, reading: &BeingRead) -> io::Result<Note> {
        let number = ProjectId::random()?;
        let name = format!("{}-{}", id.as_str(), number.as_str());
        let path = self.incoming.join(name);
        let mut options = OpenOptions::new();
        let mut file = options.write(true).create_new(true).open(&path)?;
        file.write_all(&serde_json::to_vec(reading)?)?;
        Ok(Note(path))
    }

    /// Returns the logs that a session was reading when its process ended, and removes the notes.
    pub(crate) fn take_being_read(&self, id: &ProjectId) -> Vec<BeingRead> {
        let is_of_session = |name: &str| note_session(name).as_ref() == Some(id);
        let notes = own_files(&self.incoming, is_of_session).unwrap_or_default();
        let mut found = Vec::new();
        for (_, path) in notes {
            found.extend(read_json(&path).ok());
            Note(path).remove();
        }
        found
    }

    /// Waits for a free place for work, and takes it. The place is free again when the returned file is dropped or the
    /// process ends. `None` if the file system has no locks.
    pub(crate) fn take_place(&self) -> Option<File> {
        let open = |number: usize| folder::open_lock(&self.folder.join(format!("place-{number}")));
        for number in 0..PLACES {
            let place = open(number).ok()?;
            if !matches!(place.try_lock(), Err(TryLockError::WouldBlock)) {
                return Some(place);
            }
        }
        let place = open(std::process::id() as usize % PLACES).ok()?;
        place.lock().ok()?;
        Some(place)
    }

    /// Returns the project files, oldest first.
    fn project_files(&self) -> io::Result<Vec<(SystemTime, PathBuf)>> {
        let is_ours = |name: &str| project_id(name).is_some();
        let mut files = own_files(&self.projects, is_ours)?;
        files.sort();
        Ok(files)
    }

    /// Removes unfinished files of an earlier start, the oldest projects beyond the limit, and logs without a project.
    /// An unreadable project may use any log: then no log is removed, and its problem is returned. Files with names of
    /// another form are not ours, and stay.
    fn tidy(&self) -> io::Result<Vec<String>> {
        let is_unfinished = |name: &str| {
            ProjectId::try_from(name.to_owned()).is_ok() || note_session(name).is_some()
        };
        for (_, path) in own_files(&self.incoming, is_unfinished)? {
            fs::remove_file(path)?;
        }
        let mut files = self.project_files()?;
        let surplus = files.len().saturating_sub(PROJECTS_MAX);
        for (_, path) in files.drain(..surplus) {
            fs::remove_file(path)?;
        }
        let is_of_nobody = |name: &str| {
            let project = |id: ProjectId| self.project_path(&id);
            id_before(name, FINDINGS).is_some_and(|id| open_regular(&project(id)).is_err())
        };
        for (_, path) in own_files(&self.projects, is_of_nobody)? {
            fs::remove_file(path)?;
        }
        let mut projects = Vec::new();
        let mut unreadable = Vec::new();
        for (_, path) in &files {
            match read_project(path) {
                Ok(project) => projects.push(project),
                Err(error) => unreadable.push(format!(
                    "{}: {error}; it stays as it is, and so do all logs. Read it with the version that wrote it, or remove it",
                    path.display()
                )),
            }
        }
        if !unreadable.is_empty() {
            return Ok(unreadable);
        }
        let is_unused = |name: &str| {
            let mut logs = projects.iter().flat_map(|project| &project.logs);
            LogHash::try_from(name.to_owned()).is_ok() && !logs.any(|log| log.file.as_str() == name)
        };
        for (_, path) in own_files(&self.logs, is_unused)? {
            fs::remove_file(path)?;
        }
        Ok(unreadable)
    }
}

/// Returns the regular files of a folder whose names are `wanted`, with the time of their last change. Links are left
/// out.
fn own_files(
    folder: &Path,
    wanted: impl Fn(&str) -> bool,
) -> io::Result<Vec<(SystemTime, PathBuf)>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let metadata = entry.metadata()?;
        if metadata.is_file() && entry.file_name().to_str().is_some_and(&wanted) {
            files.push((metadata.modified()?, entry.path()));
        }
    }
    Ok(files)
}

fn read_project(path: &Path) -> io::Result<Project> {
    read_json(path)
}

fn read_json<T: DeserializeOwned>(path: &Path) -> io::Result<T> {
    let mut bytes = Vec::new();
    open_regular(path)?.read_to_end(&mut bytes)?;
    Ok(serde_json::from_slice(&bytes)?)
}

/// Returns the project in the name of a project file.
fn project_id(name: &str) -> Option<ProjectId> {
    id_before(name, "json")
}

fn id_before(name: &str, end: &str) -> Option<ProjectId> {
    let id = name.strip_suffix(end)?.strip_suffix('.')?;
    ProjectId::try_from(id.to_owned()).ok()
}

/// Returns the session in the name of a note.
fn note_session(name: &str) -> Option<ProjectId> {
    let (session, number) = name.split_once('-')?;
    ProjectId::try_from(number.to_owned()).ok()?;
    ProjectId::try_from(session.to_owned()).ok()
}

/// Log being read, with its mapping.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct BeingRead {
    file: LogHash,
    mapping: Option<String>,
}

impl BeingRead {
    pub(crate) fn of(log: &LogEntry) -> Self {
        Self {
            file: log.file.clone(),
            mapping: log.mapping.clone(),
        }
    }
}

/// Note that a log is being read.
pub(crate) struct Note(PathBuf);

impl Note {
    pub(crate) fn remove(self) {
        // A note that remains is removed at the next start.
        let _ = fs::remove_file(self.0);
    }
}

fn too_slow() -> Refusal {
    Refusal::new(
        StatusCode::REQUEST_TIMEOUT,
        "E-WEB-SLOW",
        format!(
            "the upload sent nothing for {} s; drop the file again",
            SILENCE_MAX.as_secs()
        ),
    )
}

#[cfg(test)]
mod tests {
    use axum::body::Bytes;
    use futures_util::stream;

    use super::*;

    /// Rule 6: an upload may be slow, but a long pause ends it. The clock is the test's.
    #[test]
    fn an_upload_that_falls_silent_is_refused_and_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let (store, _) = Store::open(folder.path()).unwrap();
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_time()
            .start_paused(true)
            .build()
            .unwrap();
        // Ten chunks, each within the deadline, and then nothing.
        let chunks = stream::unfold(0, |sent| async move {
            let pause = if sent < 10 {
                SILENCE_MAX / 2
            } else {
                2 * SILENCE_MAX
            };
            tokio::time::sleep(pause).await;
            Some((Ok::<_, io::Error>(Bytes::from_static(b"1\n")), sent + 1))
        });
        let (refusal, waited) = runtime.block_on(async {
            let begin = tokio::time::Instant::now();
            let received = store.receive(Body::from_stream(chunks)).await;
            (received.unwrap_err(), begin.elapsed())
        });
        assert_eq!(refusal.problems[0].code, "E-WEB-SLOW");
        assert_eq!(waited.as_secs(), (5 * SILENCE_MAX + SILENCE_MAX).as_secs());
        assert_eq!(fs::read_dir(&store.incoming).unwrap().count(), 0);
    }

    /// Rule 6: unfinished files of an earlier start are removed, and other users of the machine have no access.
    #[test]
    fn the_folder_is_for_its_owner_and_begins_without_leavings() {
        let folder = tempfile::tempdir().unwrap();
        let project = folder.path().join("project");
        let (store, _) = Store::open(&project).unwrap();
        let half = ProjectId::random().unwrap();
        fs::write(store.incoming.join(half.as_str()), "x").unwrap();
        drop(store);
        let (store, _) = Store::open(&project).unwrap();
        assert_eq!(fs::read_dir(&store.incoming).unwrap().count(), 0);
        #[cfg(unix)]
        for part in [&project, &store.logs, &store.projects, &store.incoming] {
            let mode =
                std::os::unix::fs::PermissionsExt::mode(&fs::metadata(part).unwrap().permissions());
            assert_eq!(mode & 0o777, 0o700, "{}", part.display());
        }
    }

    /// Defect seen: a log that a user had put there was removed, and so were the oldest of any fifty JSON files.
    #[test]
    fn files_that_we_did_not_name_stay_and_links_are_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let (store, _) = Store::open(folder.path()).unwrap();
        let mut foreign = Vec::new();
        for number in 0..=PROJECTS_MAX {
            foreign.push(store.projects.join(format!("mine-{number}.json")));
        }
        foreign.push(store.logs.join("bench.csv"));
        foreign.push(store.incoming.join("notes.txt"));
        let elsewhere = tempfile::tempdir().unwrap();
        let target = elsewhere.path().join("target.csv");
        fs::write(&target, "precious").unwrap();
        for path in &foreign {
            fs::write(path, "precious").unwrap();
        }
        let hash = LogHash::of(&Sha256::digest("precious"));
        #[cfg(unix)]
        for link in [
            store.log_path(&hash),
            store.project_path(&ProjectId::random().unwrap()),
        ] {
            std::os::unix::fs::symlink(&target, &link).unwrap();
            foreign.push(link);
        }
        let of_nobody = store.keep(b"of nobody").unwrap();
        drop(store);
        let (store, unreadable) = Store::open(folder.path()).unwrap();
        assert_eq!(unreadable, [""; 0]);
        for path in &foreign {
            assert_eq!(fs::read_to_string(path).unwrap(), "precious", "{path:?}");
        }
        assert!(!store.log_path(&of_nobody).exists());
        // A link in the place of a log of ours is replaced by the log.
        store.keep(b"precious").unwrap();
        assert!(
            fs::symlink_metadata(store.log_path(&hash))
                .unwrap()
                .is_file()
        );
        assert_eq!(fs::read_to_string(&target).unwrap(), "precious");
    }

    /// Defect seen: a second server removed a file that the first one was receiving.
    #[test]
    fn a_folder_in_use_is_not_tidied() {
        let folder = tempfile::tempdir().unwrap();
        let (first, _) = Store::open(folder.path()).unwrap();
        fs::write(first.incoming.join("half"), "x").unwrap();
        first.keep(b"in no project yet").unwrap();
        let (_second, _) = Store::open(folder.path()).unwrap();
        assert_eq!(fs::read_dir(&first.incoming).unwrap().count(), 1);
        assert_eq!(fs::read_dir(&first.logs).unwrap().count(), 1);
    }

    /// Defect seen: the logs of an unreadable project (a later version, or damaged) were removed as unused.
    #[test]
    fn logs_stay_as_long_as_a_project_cannot_be_read() {
        let folder = tempfile::tempdir().unwrap();
        let (store, _) = Store::open(folder.path()).unwrap();
        let id = ProjectId::random().unwrap();
        let mut project = Project::default();
        let log = store.keep(b"of a project").unwrap();
        project.add("log.csv".to_owned(), log, None);
        store.save(&id, &project).unwrap();
        let path = store.project_path(&id);
        let readable = fs::read_to_string(&path).unwrap();
        store.keep(b"of nobody").unwrap();
        let logs = store.logs.clone();
        drop(store);
        let count = || fs::read_dir(&logs).unwrap().count();

        fs::write(&path, readable.replacen('{', "{\"later\": 1, ", 1)).unwrap();
        let (store, unreadable) = Store::open(folder.path()).unwrap();
        assert_eq!(count(), 2);
        assert!(
            unreadable.len() == 1 && unreadable[0].contains("`later`"),
            "{unreadable:?}"
        );
        drop(store);
        fs::write(&path, readable).unwrap();
        let (_store, unreadable) = Store::open(folder.path()).unwrap();
        assert_eq!((count(), unreadable.len()), (1, 0));
    }
}
