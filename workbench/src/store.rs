//! The project folder: logs under their hash, one file per project. No name in it comes from a request.

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

/// Largest file that the page takes (bytes): an hour at 1 kHz in a dozen channels as text.
pub(crate) const UPLOAD_BYTES_MAX: u64 = 1 << 30;
/// Longest silence within an upload.
const SILENCE_MAX: Duration = Duration::from_secs(30);
/// Projects that are kept; of older ones, the file is removed when the folder is opened.
const PROJECTS_MAX: usize = 50;

/// Jobs at one time, of all tabs together; others wait.
const PLACES: usize = 2;
/// End of the name of a file with findings.
const FINDINGS: &str = "findings.json";

/// A project folder.
pub(crate) struct Store {
    folder: PathBuf,
    logs: PathBuf,
    projects: PathBuf,
    /// Files that are being written; each is renamed once it is whole.
    incoming: PathBuf,
    /// Of the first server that has the folder open: it alone removes anything.
    _tidying: Option<TidyingRight>,
}

impl Store {
    /// Opens or makes the folder, for its owner alone, and removes those of its own files that nobody needs, unless another
    /// server is using it. The texts that come with it are about projects that cannot be read: as long as there are any, no
    /// log is removed.
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

    /// Takes an upload, and names it by its hash. Never more than a chunk of it is in memory.
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

    /// Keeps a log that comes with the program.
    pub(crate) fn keep(&self, bytes: &[u8]) -> io::Result<LogHash> {
        let hash = LogHash::of(&Sha256::digest(bytes));
        let path = self.log_path(&hash);
        if open_regular(&path).is_err() {
            self.write(&path, bytes)?;
        }
        Ok(hash)
    }

    /// Writes a file whole or not at all. A link of that name is replaced, not followed.
    fn write(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let unfinished = self.incoming.join(ProjectId::random()?.as_str());
        let mut options = OpenOptions::new();
        let mut file = options.write(true).create_new(true).open(&unfinished)?;
        let written = file
            .write_all(bytes)
            // File systems count in ticks of milliseconds: two projects saved within one would have no order.
            .and_then(|()| file.set_modified(SystemTime::now()))
            .and_then(|()| file.sync_all())
            .and_then(|()| fs::rename(&unfinished, path));
        if written.is_err() {
            let _ = fs::remove_file(&unfinished);
        }
        written
    }

    /// Where the bytes of a log lie.
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

    /// The project of this id; none if there is none that can be read.
    pub(crate) fn load(&self, id: &ProjectId) -> Option<Project> {
        read_project(&self.project_path(id)).ok()
    }

    /// The project that was changed last.
    pub(crate) fn newest(&self) -> Option<ProjectId> {
        let (_, path) = self.project_files().ok()?.pop()?;
        project_id(path.file_name()?.to_str()?)
    }

    /// Whether there is a project of this id that can be read.
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

    /// What was found out about a project; none if there is nothing that can be read.
    pub(crate) fn load_findings(&self, id: &ProjectId) -> Option<Findings> {
        read_json(&self.findings_path(id)).ok()
    }

    pub(crate) fn remove_findings(&self, id: &ProjectId) {
        // Most often there are none.
        let _ = fs::remove_file(self.findings_path(id));
    }

    /// Notes that a session begins to read a log.
    pub(crate) fn note_being_read(&self, id: &ProjectId, reading: &BeingRead) -> io::Result<Note> {
        let number = ProjectId::random()?;
        let name = format!("{}-{}", id.as_str(), number.as_str());
        let path = self.incoming.join(name);
        let mut options = OpenOptions::new();
        let mut file = options.write(true).create_new(true).open(&path)?;
        file.write_all(&serde_json::to_vec(reading)?)?;
        Ok(Note(path))
    }

    /// Logs that a session was reading when its process ended. The notes are taken away.
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

    /// Waits until one of the places for work is free, and takes it. It is given back when what comes back is dropped, or its
    /// process ends. None where the file system has no locks.
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

    /// Project files, the oldest first.
    fn project_files(&self) -> io::Result<Vec<(SystemTime, PathBuf)>> {
        let is_ours = |name: &str| project_id(name).is_some();
        let mut files = own_files(&self.projects, is_ours)?;
        files.sort();
        Ok(files)
    }

    /// Removes what an earlier start left unfinished, the oldest projects beyond the number that is kept, and logs that no
    /// project has. A project that cannot be read may have any of them: then no log is removed, and what is wrong with it
    /// comes back. Files that are not named as we name them are not ours, and stay.
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

/// Regular files of a folder whose names are `wanted`, with the time of their last change. Links are left out.
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

/// The project that a project file is named by.
fn project_id(name: &str) -> Option<ProjectId> {
    id_before(name, "json")
}

fn id_before(name: &str, end: &str) -> Option<ProjectId> {
    let id = name.strip_suffix(end)?.strip_suffix('.')?;
    ProjectId::try_from(id.to_owned()).ok()
}

/// The session that a note is of, by the note's name.
fn note_session(name: &str) -> Option<ProjectId> {
    let (session, number) = name.split_once('-')?;
    ProjectId::try_from(number.to_owned()).ok()?;
    ProjectId::try_from(session.to_owned()).ok()
}

/// A log that is being read, and how.
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

/// A note that a log is being read.
pub(crate) struct Note(PathBuf);

impl Note {
    pub(crate) fn remove(self) {
        // What stays is taken away with the next start.
        let _ = fs::remove_file(self.0);
    }
}

fn too_slow() -> Refusal {
    Refusal::new(
        StatusCode::REQUEST_TIMEOUT,
        "E-WEB-SLOW",
        format!(
            "nothing came for {} s; drop the file again",
            SILENCE_MAX.as_secs()
        ),
    )
}

#[cfg(test)]
mod tests {
    use axum::body::Bytes;
    use futures_util::stream;

    use super::*;

    /// Rule 6: an upload may be slow, but not silent. The clock is the test's.
    #[test]
    fn an_upload_that_falls_silent_is_refused_and_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let (store, _) = Store::open(folder.path()).unwrap();
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_time()
            .start_paused(true)
            .build()
            .unwrap();
        // Ten chunks, each within the deadline, and then nothing any more.
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

    /// Rule 6: what an earlier start left half-way is gone, and nobody else on the machine may look.
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

    /// A log that a person had put there was once removed, and so were the oldest of any fifty JSON files.
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
        // A link where a log of ours belongs gives way to the log.
        store.keep(b"precious").unwrap();
        assert!(
            fs::symlink_metadata(store.log_path(&hash))
                .unwrap()
                .is_file()
        );
        assert_eq!(fs::read_to_string(&target).unwrap(), "precious");
    }

    /// A second server once took away what the first one was just receiving.
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

    /// A project of a later version, or a damaged one: its logs once went as those of nobody.
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
