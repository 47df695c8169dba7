//! Programs of the system's package manager, installed only if missing.

use std::env;
use std::io::{self, IsTerminal};
use std::process::Command;
use std::time::Duration;

use crate::failure::Failure;
use crate::process;
use crate::workspace::find_program;

/// Timeout of the package manager, including downloads.
const DEADLINE: Duration = Duration::from_secs(600);

/// Installs Debian packages, or fails with the command to run.
///
/// `what` names the missing program in the message.
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
    // The lists of a new machine are empty, and old lists name versions that are gone: update them and try again.
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

/// Creates the command `apt-get` as root, without questions. Only `sudo` may ask for a password, and only in a
/// terminal.
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
    // Another package manager may be running, mostly the system's own upgrade.
    command
        .args(["-o", "DPkg::Lock::Timeout=120"])
        .args(arguments);
    command
}

fn is_root() -> bool {
    let id = Command::new("id").arg("-u").output();
    id.is_ok_and(|id| id.stdout.trim_ascii() == b"0")
}
