//! `retarder serve` while it receives logs, stores settings and computes.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::{Value, json};

use super::{Kills, Loss, is_temporary};
use crate::bench_log::repository;
use crate::chance::Chance;
use crate::served::{Client, Server, files_below};

/// Latest moment of a kill after the first request (s).
const LATEST_S: f64 = 1.2;
/// Largest number of logs; a project has room for a few more.
const LOGS: usize = 24;

/// Kills a server `kills` times while it works, each in a folder of its own, and opens the folder again. Kills that
/// come too late are repeated, at most three times as many.
///
/// # Errors
/// Returns the first loss.
pub fn kill(retarder: &Path, seed: u64, kills: u64) -> Result<Kills, Loss> {
    let mut counted = Kills::default();
    for kill in 0..4 * kills {
        if counted.at_work == kills {
            break;
        }
        let at = |source| Loss::Run { kill, source };
        let mut chance = Chance::of(seed, kill);
        let folder = tempfile::tempdir().map_err(at)?;
        let project = folder.path().join("project");
        let logs = logs(&mut chance).map_err(at)?;
        let moment = Duration::from_secs_f64(chance.between(0.0, LATEST_S));

        let server = Server::start(retarder, &project).map_err(at)?;
        let client = server.client().map_err(at)?;
        let session = client.session(None).map_err(at)?;
        let confirmed = std::thread::scope(|scope| {
            let worker = scope.spawn(|| work(&client, &session, &logs));
            std::thread::sleep(moment);
            drop(server);
            worker.join().expect("the worker does not panic")
        })
        .map_err(at)?;
        counted.at_work += u64::from(confirmed.is_broken_off);
        counted.too_late += u64::from(!confirmed.is_broken_off);
        counted.with_leavings += u64::from(!temporaries(&project).map_err(at)?.is_empty());

        let server = Server::start(retarder, &project).map_err(at)?;
        let client = server.client().map_err(at)?;
        let again = client.session(session.rsplit('/').next()).map_err(at)?;
        let found = client
            .get(&format!("{again}/project"))
            .and_then(|answer| answer.json())
            .map_err(at)?;
        counted.with_news += u64::from(confirmed.check(&found, again == session, kill)?);
        stored(&project, &logs, &confirmed, kill)?;
        if let Some(path) = temporaries(&project).map_err(at)?.pop() {
            return Err(Loss::Left { kill, path });
        }
    }
    Ok(counted)
}

/// Returns different logs.
fn logs(chance: &mut Chance) -> io::Result<Vec<String>> {
    let whole = fs::read_to_string(repository().join("data/synthetic/practice-01-id.csv"))?;
    let lines: Vec<_> = whole.lines().collect();
    let mut log = |rows: usize| {
        let from = chance.whole(1, lines.len() - rows - 1);
        let rows = std::iter::once(&lines[0]).chain(&lines[from..from + rows]);
        rows.map(|line| format!("{line}\n")).collect()
    };
    // The first one gives a diagnosis of some seconds.
    Ok((0..LOGS)
        .map(|number| log(if number == 0 { 600 } else { 1000 + 97 * number }))
        .collect())
}

/// Data that the server has confirmed.
#[derive(Default)]
struct Confirmed {
    /// Number of accepted logs, in their order.
    logs: usize,
    /// Offset of the first log (s).
    offset_s: f64,
    /// Whether a request was not answered, and may have been carried out.
    is_broken_off: bool,
}

/// Uploads, changes and computes until the server is gone, or all is done.
fn work(client: &Client, session: &str, logs: &[String]) -> io::Result<Confirmed> {
    let mut confirmed = Confirmed::default();
    let refused = |what: &str, status: u16| {
        Err(io::Error::other(format!(
            "{what} was answered with {status}"
        )))
    };
    for (number, log) in logs.iter().enumerate() {
        match client.upload(session, &format!("{number}.csv"), log.as_bytes()) {
            Ok(answer) if answer.status == 200 => confirmed.logs += 1,
            Ok(answer) => return refused("an upload", answer.status),
            Err(_) => break,
        }
        let (what, request) = match number % 4 {
            0 => ("diagnose", json!({"logs": [1], "check": []})),
            1 => ("logs/1/compare", json!({})),
            2 => ("report", json!({})),
            _ => ("control/run", json!({})),
        };
        // A job gives no guarantee: it may be refused, and nothing of it has to be stored.
        if client.post(&format!("{session}/{what}"), &request).is_err() {
            break;
        }
        let offset_s = 0.25 * (number + 1) as f64;
        match client.put(
            &format!("{session}/logs/1/offset"),
            &json!({ "offset_s": offset_s }),
        ) {
            Ok(answer) if answer.status == 200 => confirmed.offset_s = offset_s,
            Ok(answer) => return refused("an offset", answer.status),
            Err(_) => break,
        }
    }
    // The server may also have been killed after the last request of a completed loop; then it does not answer any
    // more.
    confirmed.is_broken_off = confirmed.logs < logs.len() || client.get("/api/examples").is_err();
    Ok(confirmed)
}

impl Confirmed {
    /// Asserts that all accepted data is there, and at most one more item; returns whether there is one more.
    fn check(&self, found: &Value, is_same: bool, kill: u64) -> Result<bool, Loss> {
        let lost = |what: String| Err(Loss::Forgotten { kill, what });
        if !is_same && self.logs > 0 {
            return lost("the project is not opened under its own name".to_owned());
        }
        let none = Vec::new();
        let logs = found["logs"].as_array().unwrap_or(&none);
        let names: Vec<_> = logs.iter().filter_map(|log| log["name"].as_str()).collect();
        let all: Vec<_> = (0..logs.len())
            .map(|number| format!("{number}.csv"))
            .collect();
        if names != all || logs.len() < self.logs || logs.len() > self.logs + 1 {
            return lost(format!(
                "{} logs were taken, there are {names:?}",
                self.logs
            ));
        }
        if let Some(broken) = logs.iter().find(|log| !log["problem"].is_null()) {
            return lost(format!(
                "a log cannot be read any more: {}",
                broken["problem"]
            ));
        }
        let offset_s = logs
            .first()
            .and_then(|log| log["offset_s"].as_f64())
            .unwrap_or(0.0);
        if offset_s != self.offset_s && offset_s != self.offset_s + 0.25 {
            return lost(format!(
                "an offset of {} s was taken, there is {offset_s} s",
                self.offset_s
            ));
        }
        Ok(logs.len() > self.logs || offset_s != self.offset_s)
    }
}

/// Asserts that the stored logs are the accepted ones, byte for byte, without truncated ones.
fn stored(project: &Path, logs: &[String], confirmed: &Confirmed, kill: u64) -> Result<(), Loss> {
    let at = |source| Loss::Run { kill, source };
    let mut missing: BTreeSet<&str> = logs[..confirmed.logs].iter().map(String::as_str).collect();
    for path in files_below(&project.join("logs")).map_err(at)? {
        let text = fs::read_to_string(&path).map_err(at)?;
        missing.remove(text.as_str());
        if !logs.contains(&text) {
            return Err(Loss::Torn { kill, path });
        }
    }
    if missing.is_empty() {
        Ok(())
    } else {
        let what = format!("{} logs are not stored as they were taken", missing.len());
        Err(Loss::Forgotten { kill, what })
    }
}

fn temporaries(project: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = files_below(project)?;
    files.retain(|path| is_temporary(path));
    Ok(files)
}
