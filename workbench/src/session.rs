//! Open files and results of one tab. Each tab has its own process: tabs share only the project folder.

use std::sync::{Arc, Mutex, OnceLock};

use model_lab::{LogConditions, find_conditions};
use recording::{Pyramid, Recording};
use serde::{Deserialize, Serialize};

use crate::cache::{Cache, Room, VALUES_MAX, values_of};
use crate::calculated::{self, Calculated};
use crate::job::{Job, Span};
use crate::lock::lock;
use crate::log_reader;
use crate::log_summary::LogSummary;
use crate::names::ProjectId;
use crate::plant_file::PlantFile;
use crate::project::{LogEntry, Project};
use crate::refusal::{Problem, Refusal};
use crate::results::{Batch, Compared, Controlled, ErrorsOfPlants, Findings};
use crate::store::{BeingRead, Store};

/// Maximum number of plants for which a log stores its conditions.
const PLANTS_REMEMBERED: usize = 4;

/// Process of a tab, for its routes.
pub(crate) struct Sessions {
    store: Arc<Store>,
    open: OnceLock<Arc<Session>>,
}

/// Session that a process is to open.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Opening {
    pub(crate) id: ProjectId,
    /// Project to copy if no project of this id is stored.
    pub(crate) copy_of: Option<ProjectId>,
    /// Project whose findings are copied if none of this id are stored.
    pub(crate) findings_of: Option<ProjectId>,
    /// Whether an earlier process of this session ended unexpectedly.
    pub(crate) is_again: bool,
}

/// Open files of one tab.
pub(crate) struct Session {
    pub(crate) id: ProjectId,
    pub(crate) store: Arc<Store>,
    project: Mutex<Project>,
    /// Logs during whose reading an earlier process of this session ended.
    unreadable: Vec<BeingRead>,
    logs: Cache<OpenLog>,
    comparisons: Cache<Compared>,
    findings: Mutex<Findings>,
    /// Errors of recently simulated plants.
    pub(crate) errors: Mutex<ErrorsOfPlants>,
    /// The last run of the closed loop, and the last batch of rigs.
    pub(crate) controlled: Kept<Controlled>,
    pub(crate) batch: Kept<Batch>,
    /// The last report, HTML.
    pub(crate) report: Kept<String>,
    jobs: Mutex<Jobs>,
}

/// Running jobs of a session: one that ends with its page, and one that runs on while other pages are shown.
#[derive(Default)]
struct Jobs {
    of_page: Option<Arc<Job>>,
    of_tab: Option<Arc<Job>>,
}

impl Jobs {
    fn place(&mut self, span: Span) -> &mut Option<Arc<Job>> {
        match span {
            Span::Page => &mut self.of_page,
            Span::Tab => &mut self.of_tab,
        }
    }

    fn cancel(&mut self, span: Span) {
        if let Some(job) = self.place(span).take() {
            job.cancel();
        }
    }
}

/// Result that is kept until the next one.
pub(crate) struct Kept<T>(Mutex<Option<Arc<T>>>);

impl<T> Default for Kept<T> {
    fn default() -> Self {
        Self(Mutex::default())
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

/// Log in memory, or the reason why it is missing.
pub(crate) type OpenLog = Result<LoadedLog, Problem>;

/// Log with the data that a view needs.
pub(crate) struct LoadedLog {
    pub(crate) recording: Recording,
    pub(crate) summary: LogSummary,
    /// Pyramids, one for each signal.
    pub(crate) pyramids: Vec<Pyramid>,
    /// Conditions under which the log was made, for each plant that they were determined with.
    conditions: Mutex<Vec<(PlantFile, LogConditions)>>,
}

impl LoadedLog {
    fn new(recording: Recording) -> Self {
        let pyramid = |signal: &recording::Signal| Pyramid::new(signal.values_or_nan());
        Self {
            pyramids: recording.signals().iter().map(pyramid).collect(),
            summary: LogSummary::of(&recording),
            recording,
            conditions: Mutex::default(),
        }
    }

    /// Returns the conditions under which the log was made, determined once for each `base`. `base` is the plant as
    /// opened, stated or estimated: adding an effect or moving a slider does not change the clock.
    pub(crate) fn conditions(&self, base: &PlantFile) -> Result<LogConditions, Refusal> {
        let mut known = lock(&self.conditions);
        if let Some((_, conditions)) = known.iter().find(|(plant, _)| plant == base) {
            return Ok(conditions.clone());
        }
        let found = find_conditions(&base.parameters()?, &self.recording);
        known.truncate(PLANTS_REMEMBERED - 1);
        known.insert(0, (base.clone(), found.clone()));
        Ok(found)
    }
}

impl Sessions {
    pub(crate) fn new(store: Arc<Store>) -> Self {
        Self {
            store,
            open: OnceLock::new(),
        }
    }

    pub(crate) fn get(&self, id: &ProjectId) -> Result<Arc<Session>, Refusal> {
        let found = self.open.get().filter(|session| session.id == *id);
        found.cloned().ok_or_else(|| Refusal::not_found("session"))
    }

    /// Opens the session of this process.
    pub(crate) fn open(&self, opening: Opening) -> Arc<Session> {
        let open = || Arc::new(Session::open(Arc::clone(&self.store), opening));
        Arc::clone(self.open.get_or_init(open))
    }
}

impl Session {
    fn open(store: Arc<Store>, opening: Opening) -> Self {
        let id = opening.id;
        let stored = store.load(&id);
        let copied = || store.load_findings(opening.findings_of.as_ref()?);
        let findings = store.load_findings(&id).or_else(copied);
        let copied = || store.load(opening.copy_of.as_ref()?);
        let project = stored.or_else(copied).unwrap_or_default();
        let broken_off = store.take_being_read(&id);
        let room = Arc::new(Room::new(VALUES_MAX));
        Self {
            id,
            project: Mutex::new(project),
            unreadable: if opening.is_again {
                broken_off
            } else {
                Vec::new()
            },
            logs: Cache::in_room(&room),
            comparisons: Cache::in_room(&room),
            findings: Mutex::new(findings.unwrap_or_default()),
            errors: Mutex::default(),
            controlled: Kept::default(),
            batch: Kept::default(),
            report: Kept::default(),
            jobs: Mutex::default(),
            store,
        }
    }

    /// Returns the findings about the current project.
    pub(crate) fn findings(&self) -> Findings {
        lock(&self.findings).clone()
    }

    /// Changes the findings and stores them. If they cannot be stored, the change is dropped.
    pub(crate) fn change_findings(
        &self,
        change: impl FnOnce(&mut Findings),
    ) -> Result<(), Refusal> {
        let mut findings = lock(&self.findings);
        let mut changed = findings.clone();
        change(&mut changed);
        self.store.save_findings(&self.id, &changed)?;
        *findings = changed;
        Ok(())
    }

    fn forget_findings(&self) {
        *lock(&self.findings) = Findings::default();
        self.store.remove_findings(&self.id);
    }

    /// Returns the current project.
    pub(crate) fn project(&self) -> Project {
        lock(&self.project).clone()
    }

    /// Changes the project and stores it. A change that is refused, or cannot be stored, has no effect.
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

    /// Returns the log, and reads it at the first request.
    pub(crate) fn log(&self, number: u32) -> Result<Arc<OpenLog>, Refusal> {
        if let Some(log) = self.logs.get(number) {
            return Ok(log);
        }
        let project = self.project();
        let entry = project.log(number)?;
        let log = Arc::new(self.read(entry, &project.calculated));
        let values = log
            .as_ref()
            .as_ref()
            .map_or(0, |log| values_of(&log.recording));
        // During the reading, the number may have been given to another log, or other columns may have been selected.
        let now = lock(&self.project);
        if now.log(number).ok() == Some(entry) && now.calculated == project.calculated {
            self.logs.put(number, values, Arc::clone(&log));
        }
        Ok(log)
    }

    fn read(&self, entry: &LogEntry, channels: &[Calculated]) -> OpenLog {
        let reading = BeingRead::of(entry);
        if self.unreadable.contains(&reading) {
            return Err(Problem::new(
                "E-WEB-MEMORY",
                "reading this log exceeded the memory limit of a tab; correct its columns, scale and offset, or remove \
                 the log",
            ));
        }
        // If the process ends here, the next one finds the note.
        let note = self.store.note_being_read(&self.id, &reading);
        let path = self.store.log_path(&entry.file);
        let read = log_reader::read(&entry.name, &path, entry.mapping.as_deref());
        let read = read.map(|mut recording| {
            calculated::add_to(&mut recording, channels);
            LoadedLog::new(recording)
        });
        if let Ok(note) = note {
            note.remove();
        }
        read
    }

    /// Drops the log and its results.
    pub(crate) fn forget_log(&self, number: u32) {
        self.logs.remove(number);
        self.comparisons.remove(number);
        lock(&self.errors).clear();
        self.forget_findings();
    }

    /// Returns the recordings of the logs `numbers`, or the problem of the first that cannot be read.
    pub(crate) fn recordings(&self, numbers: &[u32]) -> Result<Vec<Recording>, Refusal> {
        let recording = |number: &u32| match &*self.log(*number)? {
            Ok(log) => Ok(log.recording.clone()),
            Err(problem) => Err(problem.clone().into()),
        };
        numbers.iter().map(recording).collect()
    }

    /// Drops all comparisons after a change of the plant or the limits. A diagnosis or a fit runs on: it has its own copy
    /// of the plant, and its result says so.
    pub(crate) fn forget_comparisons(&self) {
        lock(&self.jobs).cancel(Span::Page);
        self.clear_comparisons();
    }

    /// Drops all comparisons without ending the running job: for a job that has changed the plant itself.
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

    /// Returns the job of this number, if it is the last one of its span.
    pub(crate) fn job(&self, number: u64) -> Option<Arc<Job>> {
        let jobs = lock(&self.jobs);
        [&jobs.of_page, &jobs.of_tab]
            .into_iter()
            .flatten()
            .find(|job| job.number == number)
            .map(Arc::clone)
    }

    /// Sets `job` as the job of this session; a running one of the same span ends.
    pub(crate) fn begin(&self, span: Span, job: Arc<Job>) {
        let mut jobs = lock(&self.jobs);
        jobs.cancel(span);
        *jobs.place(span) = Some(job);
    }

    /// Ends the running jobs.
    pub(crate) fn cancel(&self) {
        let mut jobs = lock(&self.jobs);
        jobs.cancel(Span::Page);
        jobs.cancel(Span::Tab);
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use recording::csv;

    use super::*;

    /// Defect seen: an estimated plant was simulated under the conditions of the plant as opened.
    #[test]
    fn each_plant_has_the_conditions_that_it_finds() {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
        let path = data.join("real/leakdown-aluminium.csv");
        let log = LoadedLog::new(csv::read_file(path, &csv::Options::default()).unwrap());
        let plant = |name: &str| PlantFile {
            name: name.to_owned(),
            toml: fs::read_to_string(data.join("plants").join(name)).unwrap(),
        };
        let [opened, fitted] =
            ["leakdown-chamber.toml", "fitted-leakdown-aluminium.toml"].map(plant);
        let found =
            |plant: &PlantFile| find_conditions(&plant.parameters().unwrap(), &log.recording);
        assert_ne!(found(&opened), found(&fitted));
        for plant in [&opened, &fitted, &opened] {
            assert_eq!(log.conditions(plant).unwrap(), found(plant));
        }
    }
}
