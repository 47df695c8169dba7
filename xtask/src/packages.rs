//! Programs from the system's package manager, installed only when missing.

use std::env;
use std::io::{self, IsTerminal};
use std::process::Command;
use std::time::Duration;

use crate::failure::Failure;
use crate::process;
use crate::workspace::find_program;

/// Longest wait for the package manager, its downloads included.
const DEADLINE: Duration = Duration::from_secs(600);

/// Installs Debian packages, or fails with the line that a person can paste.
///
/// `what` names the thing that is missing, for that line's sentence.
pub(crate) fn install(what: &str, packages: &[&str]) -> Result<(), Failure> {
    let missing = || Failure::Missing {
        what: what.to_owned(),
        paste: format!(
            "sudo apt-get update && sudo apt-get install -y --no-install-recommends {}",
            packages.join(" ")
        ),
    };
    if find_program("apt-get").is_none() || (!is_root() && find_program("sudo").is_none()) {
        return Err(missing());
    }
    // The lists of a fresh machine are empty and those of an old one name versions that are gone: then ask for new ones.
    let install = || {
        process::run(
            apt_get(&["install", "-y", "--no-install-recommends"]).args(packages),
            DEADLINE,
        )
    };
    install()
        .or_else(|_| process::run(&mut apt_get(&["update"]), DEADLINE).and_then(|()| install()))
        .map_err(|failure| {
            eprintln!("{failure}");
            missing()
        })
}

/// `apt-get`, as root, asking nothing. Only `sudo` may ask for a password, and only where a person can answer.
fn apt_get(arguments: &[&str]) -> Command {
    let mut command = if is_root() {
        Command::new("env")
    } else {
        let mut sudo = Command::new("sudo");
        if env::var_os("CI").is_some() || !io::stdin().is_terminal() {
            sudo.arg("-n");
        }
        sudo.arg("env");
        sudo
    };
    command.args(["DEBIAN_FRONTEND=noninteractive", "apt-get"]);
    // Another package manager may run at this moment, mostly the machine's own upgrade.
    command
        .args(["-o", "DPkg::Lock::Timeout=120"])
        .args(arguments);
    command
}

fn is_root() -> bool {
    let id = Command::new("id").arg("-u").output();
    id.is_ok_and(|id| id.stdout.trim_ascii() == b"0")
}
