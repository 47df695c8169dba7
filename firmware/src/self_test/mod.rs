//! Comparison of the controller on two machines: a long deterministic run, reported as digests.
//!
//! Every configuration of `CONFIGURATIONS` runs `STEPS` steps of the same random walk. Every word of every output and
//! of every state is folded into one digest, which is shown each `BLOCK` steps and at the end:
//! ```text
//! config=thesis step=1024 digest=00c0ffee00c0ffee
//! config=thesis steps=65536 digest=0123456789abcdef
//! ```
//! Equal lines on two machines mean equal bits in every step; the first line that differs names configuration and block.

mod configurations;
mod digest;
mod line;
mod random;
mod walk;

use controller::{Config, State, step};

use configurations::CONFIGURATIONS;
use digest::Digest;
use line::Line;
use walk::Walk;

/// Number of steps between two shown digests.
const BLOCK: u32 = 1024;
/// Number of steps of one configuration.
const STEPS: u32 = 64 * BLOCK;

// The evidence states at least a million steps; this checks it for any list of configurations.
const _: () = assert!(CONFIGURATIONS.len() * STEPS as usize >= 1_000_000);

/// Receiver of the lines of a self-test.
pub trait Watcher {
    /// Shows one line, without its end.
    ///
    /// # Errors
    /// Returns an error if the line could not be shown: nothing receives it, or the channel is closed.
    fn show(&mut self, line: &str) -> Result<(), NotShown>;
}

/// Error: a line could not be shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotShown;

/// Reason why a self-test was incomplete. It is shown if the channel still works.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Incomplete {
    /// A line could not be shown.
    NotShown,
    /// The controller refused one of the configurations.
    Refused,
}

impl From<NotShown> for Incomplete {
    fn from(_: NotShown) -> Self {
        Self::NotShown
    }
}

/// Runs all configurations and shows their digests. No output reaches a coil.
///
/// `flip` gives the bits to flip in the first output word of a configuration's step, zero in normal use. It exists to
/// show that the comparison of two machines detects a difference.
///
/// # Errors
/// Returns [`Incomplete`] if the test has no result.
pub fn run(watcher: &mut impl Watcher, flip: impl Fn(&str, u32) -> u32) -> Result<(), Incomplete> {
    for (name, settings) in &CONFIGURATIONS {
        let Ok(config) = Config::new(settings) else {
            watcher.show(
                Line::new()
                    .text("config=")
                    .text(name)
                    .text(" refused")
                    .as_str(),
            )?;
            return Err(Incomplete::Refused);
        };
        let mut state = State::at_rest();
        let mut walk = Walk::new();
        let mut digest = Digest::new();
        for number in 0..STEPS {
            let output = step(&config, &mut state, walk.input());
            digest.fold(output.duty_fill.to_bits() as u32 ^ flip(name, number));
            digest.fold(output.duty_vent.to_bits() as u32);
            for word in state.to_words() {
                digest.fold(word as u32);
            }
            let done = number + 1;
            if done % BLOCK == 0 {
                watcher.show(digest_line(name, " step=", done, digest).as_str())?;
            }
        }
        watcher.show(digest_line(name, " steps=", STEPS, digest).as_str())?;
    }
    Ok(())
}

/// Shows the stack usage: `stack used=312 of=65536`, in bytes.
///
/// # Errors
/// Returns an error if the line could not be shown.
pub fn show_stack(watcher: &mut impl Watcher, used: u32, reserved: u32) -> Result<(), NotShown> {
    let line = Line::new().text("stack used=").decimal(used);
    watcher.show(line.text(" of=").decimal(reserved).as_str())
}

fn digest_line(name: &str, key: &str, steps: u32, digest: Digest) -> Line {
    Line::new()
        .text("config=")
        .text(name)
        .text(key)
        .decimal(steps)
        .text(" digest=")
        .hex(digest.value())
}

#[cfg(test)]
mod tests {
    use super::*;
    /// Receiver that stores the lines, up to a limit.
    struct Listener {
        lines: Vec<String>,
        room: usize,
    }

    impl Watcher for Listener {
        fn show(&mut self, line: &str) -> Result<(), NotShown> {
            if self.lines.len() == self.room {
                return Err(NotShown);
            }
            self.lines.push(line.to_owned());
            Ok(())
        }
    }

    fn lines(flip: impl Fn(&str, u32) -> u32) -> Vec<String> {
        let mut listener = Listener {
            lines: Vec::new(),
            room: usize::MAX,
        };
        assert_eq!(run(&mut listener, flip), Ok(()));
        listener.lines
    }

    #[test]
    fn each_configuration_shows_every_block_and_its_end() {
        let lines = lines(|_, _| 0);
        let per_configuration = (STEPS / BLOCK) as usize + 1;
        assert_eq!(lines.len(), CONFIGURATIONS.len() * per_configuration);
        for (shown, (name, _)) in lines.chunks(per_configuration).zip(&CONFIGURATIONS) {
            assert!(shown[0].starts_with(&format!("config={name} step=1024 digest=")));
            let end = format!("config={name} steps=65536 digest=");
            assert!(shown[per_configuration - 1].starts_with(&end));
        }
    }

    /// A choice without any effect on the digest would not be compared.
    #[test]
    fn no_two_configurations_end_with_the_same_digest() {
        let lines = lines(|_, _| 0);
        let ends = lines
            .iter()
            .filter_map(|line| line.split_once(" steps=65536 "));
        let mut digests: Vec<&str> = ends.map(|(_, digest)| digest).collect();
        digests.sort_unstable();
        digests.dedup();
        assert_eq!(digests.len(), CONFIGURATIONS.len());
    }

    /// Canary: step 4711 is in the fifth block of its configuration.
    #[test]
    fn one_flipped_bit_shows_from_its_block_to_the_end_of_its_configuration_and_nowhere_else() {
        let honest = lines(|_, _| 0);
        let flipped = lines(|name, step| u32::from((name, step) == ("scheme_2", 4711)));
        let pairs = honest.iter().zip(&flipped);
        let differing: Vec<&String> = pairs.filter(|(a, b)| a != b).map(|(a, _)| a).collect();
        assert!(differing[0].starts_with("config=scheme_2 step=5120 "));
        assert_eq!(differing.len(), 64 - 4 + 1);
        assert!(
            differing
                .iter()
                .all(|line| line.starts_with("config=scheme_2 "))
        );
    }

    #[test]
    fn the_stack_is_shown_in_bytes() {
        let mut listener = Listener {
            lines: Vec::new(),
            room: 1,
        };
        assert_eq!(show_stack(&mut listener, 312, 65_536), Ok(()));
        assert_eq!(listener.lines, ["stack used=312 of=65536"]);
    }

    #[test]
    fn a_watcher_who_cannot_be_shown_a_line_ends_the_test() {
        let mut listener = Listener {
            lines: Vec::new(),
            room: 3,
        };
        assert_eq!(run(&mut listener, |_, _| 0), Err(Incomplete::NotShown));
    }
}
