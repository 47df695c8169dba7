//! Client that opens the project of a server, reads it, computes, and ends the server.

use std::io;
use std::process::Child;

use rustix::process::{Pid, Signal, kill_process};
use serde_json::json;

use super::case::Case;
use crate::served::{Client, address};

/// Sends requests to a server whose standard output is piped, and ends it like Ctrl-C. Refusals of the server are
/// allowed.
pub(super) fn talk(server: &mut Child, case: &Case) {
    let _ = look_around(server, case);
    // Fails only if the server has already ended.
    let _ = kill_process(Pid::from_child(server), Signal::TERM);
}

fn look_around(server: &mut Child, case: &Case) -> io::Result<()> {
    let out = server.stdout.take().expect("the standard output is piped");
    let Some(address) = address(out)? else {
        return Ok(());
    };
    let client = Client::open(&address)?;
    let session = client.session(project(case))?;
    for page in [
        "project",
        "logs/1/preview",
        "diagnosis",
        "refine",
        "control",
    ] {
        client.get(&format!("{session}/{page}"))?;
    }
    client.work(&session, "logs/1/compare", &json!({}))?;
    client.get(&format!("{session}/logs/1/comparison"))?;
    client.work(&session, "control/run", &json!({}))
}

/// Returns the name of the project: 32 hexadecimal digits.
fn project(case: &Case) -> Option<&str> {
    let mut names = case
        .files
        .iter()
        .filter_map(|file| file.path.file_stem()?.to_str());
    names.find(|name| name.len() == 32)
}
