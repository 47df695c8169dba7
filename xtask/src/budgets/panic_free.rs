//! Proof by the linker: an image whose panic handler calls an undefined function links only if no panic is left.

use std::process::Command;
use std::time::Duration;

use super::unproved::Unproved;
use crate::failure::Failure;
use crate::process;

/// The undefined function.
const UNDEFINED: &str = "this_image_can_panic";
const DEADLINE: Duration = Duration::from_secs(600);

/// Builds an image that must be free of panics: it has to link.
pub(crate) fn links(build: &mut Command) -> Result<(), Failure> {
    linked(process::capture(build, DEADLINE))
}

/// Builds an image with one panic on purpose: the linker has to refuse it for that reason.
pub(crate) fn canary_is_refused(build: &mut Command) -> Result<(), Failure> {
    refused(process::capture(build, DEADLINE))
}

fn linked(built: Result<String, Failure>) -> Result<(), Failure> {
    match built {
        Err(Failure::Ended { said, .. }) if names_it(&said) => Err(Unproved::CanPanic {
            said: about_it(&said),
        }
        .into()),
        other => other.map(drop),
    }
}

fn refused(built: Result<String, Failure>) -> Result<(), Failure> {
    match built {
        Err(Failure::Ended { said, .. }) if names_it(&said) => Ok(()),
        Ok(_) => Err(Unproved::CanaryLinked.into()),
        other => other.map(drop),
    }
}

/// Returns whether the linker, and not another program, reported the missing function.
fn names_it(said: &str) -> bool {
    said.lines()
        .any(|line| line.contains("undefined") && line.contains(UNDEFINED))
}

/// Returns the linker's message about the missing function, without the compiler's text around it.
fn about_it(said: &str) -> String {
    let lines = said.lines().map(str::trim);
    let lines = lines.filter(|line| names_it(line) || line.starts_with(">>>"));
    lines.collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::process::ExitStatusExt;
    use std::process::ExitStatus;

    fn ended(said: &str) -> Result<String, Failure> {
        Err(Failure::Ended {
            line: "cargo build".to_owned(),
            status: ExitStatus::from_raw(101 << 8),
            said: said.to_owned(),
        })
    }

    const LLD: &str = "rust-lld: error: undefined symbol: this_image_can_panic";
    const GNU: &str = "panic_free.rs:48: undefined reference to `this_image_can_panic'";

    #[test]
    fn only_the_missing_function_proves_a_panic() {
        for said in [LLD, GNU] {
            assert!(matches!(
                linked(ended(said)),
                Err(Failure::Budgets(Unproved::CanPanic { .. }))
            ));
        }
        assert!(linked(Ok(String::new())).is_ok());
        assert!(matches!(
            linked(ended("error[E0425]")),
            Err(Failure::Ended { .. })
        ));
    }

    #[test]
    fn of_all_that_cargo_says_the_linkers_complaint_is_reported() {
        let said = format!(
            "   Compiling firmware\n  = note: {LLD}\n          >>> referenced by f.rs:3\nerror"
        );
        let message = linked(ended(&said)).unwrap_err().to_string();
        assert!(
            message.ends_with(&format!("{LLD}\n>>> referenced by f.rs:3")),
            "{message}"
        );
        assert!(!message.contains("Compiling"), "{message}");
    }

    #[test]
    fn a_canary_that_links_or_fails_for_another_reason_proves_nothing() {
        for said in [LLD, GNU] {
            assert!(refused(ended(said)).is_ok());
        }
        assert!(matches!(
            refused(Ok(String::new())),
            Err(Failure::Budgets(Unproved::CanaryLinked))
        ));
        assert!(matches!(
            refused(ended("error[E0425]")),
            Err(Failure::Ended { .. })
        ));
    }
}
