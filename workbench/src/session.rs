//! One session for each tab: its project, and what was computed for it. Sessions share nothing but stored logs.

use std::collections::{HashMap, VecDeque};
use std::sync::{Arc, Mutex};

use model_lab::diagnosis::next_experiment::NextExperiment;
use recording::Recording;
use tokio::sync::Semaphore;

use crate::calculated;
use crate::job::Job;
use crate::lock::lock;
use crate::log_reader;
use crate::names::ProjectId;
use crate::project::Project;
use crate::pyramid::Pyramid;
use crate::refusal::{Problem, Refusal};
use crate::results::{Batch, Compared, Controlled, Diagnosed, ErrorsOfPlants};
use crate::shelf::{Room, Shelf, VALUES_MAX, values_of};
use crate::store::Store;

/// Sessions at one time; beyond them, the one that was opened first is forgotten. Its project is kept.
const SESSIONS_MAX: usize = 24;
/// Sessions that were closed whose findings are kept.
const CLOSED_MAX: usize = 24;

/// All open sessions.
pub(crate) struct Sessions {
    pub(crate) store: Arc<Store>,
    /// Uploads at one time, of all tabs together.
    pub(crate) uploads: Semaphore,
    /// Jobs at one time, of all tabs together; others wait.
    pub(crate) workers: Arc<Semaphore>,
    /// Memory of all tabs together.
    room: Arc<Room>,
    open: Mutex<HashMap<ProjectId, (u64, Arc<Session>)>>,
    /// Of sessions that were closed, the last one first: a page that is loaded again closes its session before.
    closed: Mutex<VecDeque<(ProjectId, Findings)>>,
}

const UPLOADS: usize = 2;
const WORKERS: usize = 2;

/// What one tab has open.
pub(crate) struct Session {
    pub(crate) id: ProjectId,
    /// Whether it began with the logs of another project.
    pub(crate) is_copy: bool,
    pub(crate) store: Arc<Store>,
    project: Mutex<Project>,
    logs: Shelf<OpenLog>,
    comparisons: Shelf<Compared>,
    /// The last diagnosis, and the last experiment that was planned after it.
    pub(crate) diagnosed: Kept<Diagnosed>,
    pub(crate) next: Kept<NextExperiment>,
    /// Errors of plants that were simulated lately.
    pub(crate) errors: Mutex<ErrorsOfPlants>,
    /// The last run of the closed loop, and the last batch of rigs.
    pub(crate) controlled: Kept<Controlled>,
    pub(crate) batch: Kept<Batch>,
    /// The last report, HTML.
    pub(crate) report: Kept<String>,
    job: Mutex<Option<Arc<Job>>>,
}

/// What took a person a minute of waiting and little memory: it goes with a project that is opened again.
#[derive(Clone, Default)]
struct Findings {
    diagnosed: Option<Arc<Diagnosed>>,
    next: Option<Arc<NextExperiment>>,
}

/// A result that stays until there is another one.
pub(crate) struct Kept<T>(Mutex<Option<Arc<T>>>);

impl<T> Default for Kept<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T> From<Option<Arc<T>>> for Kept<T> {
    fn from(result: Option<Arc<T>>) -> Self {
        Self(Mutex::new(result))
    }
}

impl<T> Kept<T> {
    pub(crate) fn get(&self) -> Option<Arc<T>> {
        lock(&self.0).clone()
    }

    pub(crate) fn keep(&self, result: T) {
        *lock(&self.0) = Some(Arc::new(result));
    }

    pub(crate) fn forget(&self) {
        *lock(&self.0) = None;
    }
}

/// A log in memory, or why it is not.
pub(crate) type OpenLog = Result<LoadedLog, Problem>;

/// A log with what a view of it needs.
pub(crate) struct LoadedLog {
    pub(crate) recording: Recording,
    /// Of each signal.
    pub(crate) pyramids: Vec<Pyramid>,
}

impl LoadedLog {
    fn new(recording: Recording) -> Self {
        let pyramid = |signal: &recording::Signal| Pyramid::new(signal.values_or_nan());
        Self {
            pyramids: recording.signals().iter().map(pyramid).collect(),
            recording,
        }
    }
}

impl Sessions {
    pub(crate) fn new(store: Arc<Store>) -> Self {
        Self {
            store,
            uploads: Semaphore::new(UPLOADS),
            workers: Arc::new(Semaphore::new(WORKERS)),
            room: Arc::new(Room::new(VALUES_MAX)),
            open: Mutex::default(),
            closed: Mutex::default(),
        }
    }

    pub(crate) fn get(&self, id: &ProjectId) -> Result<Arc<Session>, Refusal> {
        let open = lock(&self.open);
        let found = open.get(id).map(|(_, session)| Arc::clone(session));
        found.ok_or_else(|| Refusal::not_found("session"))
    }

    /// Opens a session: on the project `wanted`, under its own id if no other tab has it open, else on a copy, with what
    /// this server found out about it; without a wish, on a copy of the project that was changed last.
    pub(crate) fn open(&self, wanted: Option<ProjectId>) -> Result<Arc<Session>, Refusal> {
        // One lock from the question to the answer: of two tabs that ask at once, one gets a copy.
        let mut open = lock(&self.open);
        let live = wanted.as_ref().and_then(|id| open.get(id));
        let live = live.map(|(_, session)| Arc::clone(session));
        let stored = wanted.as_ref().and_then(|id| self.store.load(id));
        let (id, project, findings) = match (live, stored, &wanted) {
            (Some(live), _, _) => (ProjectId::random()?, Some(live.project()), live.findings()),
            (None, Some(project), Some(id)) => {
                let findings = self.findings_of(id);
                (id.clone(), Some(project), findings)
            }
            _ => (
                ProjectId::random()?,
                self.store.newest(),
                Findings::default(),
            ),
        };
        let project = project.unwrap_or_default();
        let session = Arc::new(Session {
            id: id.clone(),
            is_copy: wanted.as_ref() != Some(&id) && !project.logs.is_empty(),
            store: Arc::clone(&self.store),
            project: Mutex::new(project),
            logs: Shelf::in_room(&self.room),
            comparisons: Shelf::in_room(&self.room),
            diagnosed: findings.diagnosed.into(),
            next: findings.next.into(),
            errors: Mutex::default(),
            controlled: Kept::default(),
            batch: Kept::default(),
            report: Kept::default(),
            job: Mutex::default(),
        });
        let order = open.values().map(|(order, _)| order + 1).max().unwrap_or(0);
        if open.len() >= SESSIONS_MAX {
            let oldest = open.iter().min_by_key(|(_, (order, _))| *order);
            if let Some(oldest) = oldest.map(|(id, _)| id.clone()) {
                self.end(open.remove(&oldest));
            }
        }
        open.insert(id, (order, Arc::clone(&session)));
        Ok(session)
    }

    /// Ends the work of a session and forgets it; its project and its findings are kept.
    pub(crate) fn close(&self, id: &ProjectId) {
        self.end(lock(&self.open).remove(id));
    }

    fn end(&self, session: Option<(u64, Arc<Session>)>) {
        if let Some((_, session)) = session {
            session.cancel();
            let mut closed = lock(&self.closed);
            closed.push_front((session.id.clone(), session.findings()));
            closed.truncate(CLOSED_MAX);
        }
    }

    /// What a session found out that was closed; nothing once many others were.
    fn findings_of(&self, id: &ProjectId) -> Findings {
        let mut closed = lock(&self.closed);
        let place = closed.iter().position(|(closed, _)| closed == id);
        let found = place.and_then(|place| closed.remove(place));
        found.map(|(_, findings)| findings).unwrap_or_default()
    }
}

impl Session {
    fn findings(&self) -> Findings {
        Findings {
            diagnosed: self.diagnosed.get(),
            next: self.next.get(),
        }
    }

    /// The project as it is now.
    pub(crate) fn project(&self) -> Project {
        lock(&self.project).clone()
    }

    /// Changes the project and keeps it. A change that is refused, or cannot be kept, changes nothing.
    pub(crate) fn change<T>(
        &self,
        change: impl FnOnce(&mut Project) -> Result<T, Refusal>,
    ) -> Result<T, Refusal> {
        let mut project = lock(&self.project);
        let mut changed = project.clone();
        let result = change(&mut changed)?;
        self.store.save(&self.id, &changed)?;
        *project = changed;
        Ok(result)
    }

    /// The log, read when it is first asked for.
    pub(crate) fn log(&self, number: u32) -> Result<Arc<OpenLog>, Refusal> {
        if let Some(log) = self.logs.get(number) {
            return Ok(log);
        }
        let project = self.project();
        let entry = project.log(number)?;
        let path = self.store.log_path(&entry.file);
        let read = log_reader::read(&entry.name, &path, entry.mapping.as_deref());
        let log = Arc::new(read.map(|mut recording| {
            calculated::add_to(&mut recording, &project.calculated);
            LoadedLog::new(recording)
        }));
        let values = log
            .as_ref()
            .as_ref()
            .map_or(0, |log| values_of(&log.recording));
        // While it was read, the number may have become another log's, or other columns were chosen.
        let now = lock(&self.project);
        if now.log(number).ok() == Some(entry) && now.calculated == project.calculated {
            self.logs.put(number, values, Arc::clone(&log));
        }
        Ok(log)
    }

    /// Forgets what was read and computed of a log.
    pub(crate) fn forget_log(&self, number: u32) {
        self.logs.remove(number);
        self.comparisons.remove(number);
        lock(&self.errors).clear();
        self.diagnosed.forget();
        self.next.forget();
    }

    /// Recordings of the logs `numbers`, or what is wrong with the first that cannot be read.
    pub(crate) fn recordings(&self, numbers: &[u32]) -> Result<Vec<Recording>, Refusal> {
        let recording = |number: &u32| match &*self.log(*number)? {
            Ok(log) => Ok(log.recording.clone()),
            Err(problem) => Err(problem.clone().into()),
        };
        numbers.iter().map(recording).collect()
    }

    /// Forgets all comparisons, because the plant or the strictness is another.
    pub(crate) fn forget_comparisons(&self) {
        self.cancel();
        self.clear_comparisons();
    }

    /// The same for a job that has changed the plant itself.
    pub(crate) fn clear_comparisons(&self) {
        self.comparisons.clear();
    }

    pub(crate) fn comparison(&self, log: u32) -> Option<Arc<Compared>> {
        self.comparisons.get(log)
    }

    pub(crate) fn keep_comparison(&self, log: u32, compared: Compared) {
        let values = compared.values();
        self.comparisons.put(log, values, Arc::new(compared));
    }

    /// The job of this number, if it is the last one.
    pub(crate) fn job(&self, number: u64) -> Option<Arc<Job>> {
        let job = lock(&self.job);
        job.as_ref()
            .filter(|job| job.number == number)
            .map(Arc::clone)
    }

    /// Makes `job` the job of this session; one that is under way ends.
    pub(crate) fn begin(&self, job: Arc<Job>) {
        if let Some(before) = lock(&self.job).replace(job) {
            before.cancel();
        }
    }

    /// Ends the job that is under way.
    pub(crate) fn cancel(&self) {
        if let Some(job) = lock(&self.job).take() {
            job.cancel();
        }
    }
}
