//! Running server of the page, and a client for it.

mod http;

use std::fs;
use std::io::{self, BufRead as _, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use rustix::process::{Pid, Signal, kill_process};

pub(crate) use http::Client;

/// Running server; killed by SIGKILL on drop.
pub(crate) struct Server {
    running: Child,
    address: String,
}

impl Server {
    /// Starts a server on a project folder, and waits until it prints its address. Its standard error is discarded.
    pub(crate) fn start(retarder: &Path, project: &Path) -> io::Result<Self> {
        let mut running = Command::new(retarder)
            .args(["serve", "--project"])
            .arg(project)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        let out = running.stdout.take().expect("the standard output is piped");
        match address(out)? {
            Some(address) => Ok(Self { running, address }),
            None => {
                let status = running.wait()?;
                Err(io::Error::other(format!("the server ended with {status}")))
            }
        }
    }

    /// Returns a client that has exchanged the token.
    pub(crate) fn client(&self) -> io::Result<Client> {
        Client::open(&self.address)
    }

    /// Ends the server like Ctrl-C, and waits for its end.
    pub(crate) fn end(mut self) -> io::Result<()> {
        kill_process(Pid::from_child(&self.running), Signal::TERM)?;
        self.running.wait().map(drop)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // Fails only if it has already ended.
        let _ = self.running.kill();
        let _ = self.running.wait();
    }
}

/// Returns the address that a server prints; `None` if it ends before.
pub(crate) fn address(out: impl Read) -> io::Result<Option<String>> {
    let mut line = String::new();
    BufReader::new(out).read_line(&mut line)?;
    let address = line.trim().strip_prefix("Open http://");
    Ok(address.map(str::to_owned))
}

/// Returns the files below a folder, in no order.
pub(crate) fn files_below(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            files.extend(files_below(&path)?);
        } else {
            files.push(path);
        }
    }
    Ok(files)
}
