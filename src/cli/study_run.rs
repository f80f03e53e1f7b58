//! `fallwerk study run`: FE runs of many buildings side by side, and their records.

use super::progress::Progress;
use super::study::{described, read};
use super::{Failure, Outcome, print, read_building, thread_pool};
use crate::base::hash::{ContentHash, readable_json};
use crate::base::output::write_atomic;
use crate::building::Building;
use crate::fe::run::{FeOptions, run as run_fe};
use crate::study::{Study, facts};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A building and where its record is, or will be.
pub(super) struct Task {
    file: PathBuf,
    pub(super) building: Building,
    hash: String,
    record: PathBuf,
}

/// Runs what has no record yet.
pub fn run(paths: &[PathBuf], kb: &Path, threads: Option<u16>, again: bool) -> Result<Outcome, Failure> {
    let mut tasks: Vec<Task> = Vec::new();
    for file in files(paths)? {
        let task = Task::of(file, kb)?;
        if let Some(other) = tasks.iter().find(|t| t.record == task.record) {
            return Err(Failure::input(format!(
                "{} and {} both describe a building called `{}`, and a record has the name of its building: rename one of them",
                other.file.display(),
                task.file.display(),
                task.building.name
            )));
        }
        tasks.push(task);
    }
    if !again {
        keep_others(&tasks)?;
    }
    let all = tasks.len();
    tasks.retain(|task| again || !matches!(task.study(), Ok(Some(_))));
    if tasks.len() < all {
        eprintln!("{} of {all} buildings have their records already", all - tasks.len());
    }
    std::fs::create_dir_all(kb)
        .map_err(|e| Failure::input(format!("cannot create {}: {e}", kb.display())))?;
    let workers = threads.map_or_else(rayon::current_num_threads, usize::from);
    // a run on one thread wastes nothing; only the last buildings share the cores
    let each = if tasks.len() < workers { workers / tasks.len().max(1) } else { 1 };
    let (next, progress) = (AtomicUsize::new(0), Progress::on_stderr());
    progress.stage("studies");
    let shares = Mutex::new(vec![0.0; tasks.len()]);
    let outcomes: Mutex<Vec<(usize, Result<Study, Failure>)>> = Mutex::default();
    let work = || {
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(task) = tasks.get(at) else { return };
            let advance = |share: f64| {
                let mut shares = lock(&shares);
                shares[at] = share;
                let done: f64 = shares.iter().sum();
                progress.advance(done / tasks.len() as f64, &task.building.name);
            };
            let outcome = task.run(each as u16, &advance);
            advance(1.0);
            if let Err(error) = &outcome {
                progress.say(&format!("{}: {}", task.building.name, error.message));
            }
            lock(&outcomes).push((at, outcome));
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..workers.min(tasks.len()) {
            scope.spawn(work);
        }
    });
    progress.finish();
    let outcomes = outcomes.into_inner().unwrap_or_default();
    let failed = outcomes.iter().filter(|(_, o)| o.is_err()).count();
    if let [(_, Ok(study))] = &outcomes[..] {
        print(&described(study));
    }
    let count = outcomes.len() - failed;
    let s = if count == 1 { "" } else { "s" };
    print(&format!("wrote {count} record{s} to {}\n", kb.display()));
    Ok(if failed > 0 { Outcome::CheckFailed } else { Outcome::Done })
}

/// That no record of another input would be replaced: it may be that of a building whose file has changed, or of one that has the same name.
fn keep_others(tasks: &[Task]) -> Result<(), Failure> {
    let others: Vec<String> = tasks
        .iter()
        .filter(|task| matches!(task.study(), Ok(None)))
        .map(|task| format!("{} is of another input than {}", task.record.display(), task.file.display()))
        .collect();
    if others.is_empty() {
        return Ok(());
    }
    Err(Failure::input(format!(
        "{}; --again runs these buildings and replaces such records, --kb names another folder for them",
        others.join(", ")
    )))
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Building files, those of folders included, each once, in the order given and by name.
pub(super) fn files(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut found: Vec<PathBuf> = Vec::new();
    for path in paths {
        if !path.is_dir() {
            found.push(path.clone());
            continue;
        }
        let entries = std::fs::read_dir(path)
            .map_err(|e| Failure::input(format!("cannot read {}: {e}", path.display())))?;
        let mut own: Vec<PathBuf> = entries
            .filter_map(|e| e.ok().map(|e| e.path()))
            .filter(|p| p.extension().is_some_and(|x| x == "toml" || x == "json"))
            .collect();
        if own.is_empty() {
            return Err(Failure::input(format!("{} has no building files (*.toml, *.json)", path.display())));
        }
        own.sort();
        found.extend(own);
    }
    let mut seen = std::collections::BTreeSet::new();
    found.retain(|path| seen.insert(path.clone()));
    Ok(found)
}

impl Task {
    pub(super) fn of(file: PathBuf, kb: &Path) -> Result<Self, Failure> {
        let building = read_building(&file, false)?;
        let hash = ContentHash::of_value(&building).map_err(|e| Failure::stopped(e.to_string()))?;
        let record = kb.join(format!("{}.json", building.name));
        Ok(Self { file, building, hash: hash.to_string(), record })
    }

    /// As [`Self::of`] for lists of buildings: a failure has a message also where what is wrong with the file has been said before.
    pub(super) fn told(file: PathBuf, kb: &Path) -> Result<Self, Failure> {
        let shown = file.display().to_string();
        Self::of(file, kb).map_err(|failure| match failure.message.as_str() {
            "" => {
                Failure::input(format!("{shown} is no building that can be read; `fallwerk check` says why"))
            }
            _ => failure,
        })
    }

    pub(super) fn has_record(&self) -> bool {
        self.record.exists()
    }

    /// Its record; none if that is of another input.
    pub(super) fn study(&self) -> Result<Option<Study>, Failure> {
        read(&self.record).map(|study| Some(study).filter(|s| s.building_hash == self.hash))
    }

    fn run(&self, threads: u16, advance: &(dyn Fn(f64) + Sync)) -> Result<Study, Failure> {
        let options = FeOptions { keep_frames: true, ..FeOptions::default() };
        let work = || run_fe(&self.building, &options, &mut |p| advance(p.time_s / p.end_s));
        let run = thread_pool(Some(threads))?.install(work).map_err(|e| Failure::stopped(e.to_string()))?;
        let mesh_size_m = self.building.settings.mesh_size_m;
        let facts = facts(&self.building, &run);
        let study = Study::new(&self.building.name, self.hash.clone(), mesh_size_m, &run, facts);
        let text = readable_json(&study).map_err(|e| Failure::stopped(e.to_string()))?;
        write_atomic(&self.record, text.as_bytes())
            .map_err(|e| Failure::input(format!("cannot write {}: {e}", self.record.display())))?;
        Ok(study)
    }
}
