//! Output of the self-tests, read and compared: equal bits on both machines, or the first difference.
//!
//! The image prints, for each controller configuration, the digest so far at regular steps and one at the end:
//! ```text
//! config=scheme_2 step=1024 digest=00c0ffee00c0ffee
//! config=scheme_2 steps=1500 digest=0123456789abcdef
//! ```
//! A digest covers all steps before it, so that the first difference bounds the first differing step.

use std::fmt;

/// Prefix of a line that only the ARM machine prints, and that is not a result of the controller: the stack usage.
const STACK: &str = "stack ";

/// Self-test of one machine.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Run {
    configurations: Vec<Configuration>,
}

#[derive(Debug, PartialEq, Eq)]
struct Configuration {
    name: String,
    /// Digests with increasing steps; the last one is at the last step.
    digests: Vec<Digest>,
}

/// Digest over all steps before `step`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Digest {
    step: u64,
    value: u64,
}

/// Reason why the output of a self-test cannot be read.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum Unreadable {
    #[error("line {line} is not `config=NAME step=N digest=HEX`: `{text}`")]
    Line { line: usize, text: String },
    #[error("line {line}: step {step} of configuration `{name}` does not follow step {previous}")]
    Order {
        line: usize,
        name: String,
        step: u64,
        previous: u64,
    },
    #[error("configuration `{name}` has no end; the output breaks off after step {step}")]
    NoEnd { name: String, step: u64 },
    #[error("there is no configuration in it")]
    Empty,
}

/// First difference of two runs.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Difference {
    /// Different configurations, or another order.
    Names { host: Vec<String>, arm: Vec<String> },
    /// Different steps.
    Steps { name: String, host: u64, arm: u64 },
    /// Different bits.
    Bits {
        name: String,
        /// Step before which all digests are equal.
        from: u64,
        /// Step at which the digests differ.
        until: u64,
        host: u64,
        arm: u64,
    },
}

impl Run {
    /// Reads the output of a self-test.
    pub(crate) fn read(text: &str) -> Result<Self, Unreadable> {
        let mut configurations: Vec<Configuration> = Vec::new();
        let mut open = false;
        for (index, text) in text.lines().enumerate() {
            if text.starts_with(STACK) {
                continue;
            }
            let line = index + 1;
            let (name, digest, last) = fields(text).ok_or_else(|| Unreadable::Line {
                line,
                text: text.to_owned(),
            })?;
            let previous = match configurations.last().filter(|_| open) {
                Some(current) if current.name != name => return Err(current.no_end()),
                Some(current) => current.last_step(),
                None => {
                    configurations.push(Configuration {
                        name: name.to_owned(),
                        digests: Vec::new(),
                    });
                    0
                }
            };
            // The end may be at the step of the last regular digest.
            if digest.step < previous || (digest.step == previous && !last) {
                return Err(Unreadable::Order {
                    line,
                    name: name.to_owned(),
                    step: digest.step,
                    previous,
                });
            }
            if let Some(current) = configurations.last_mut() {
                current.digests.push(digest);
            }
            open = !last;
        }
        match configurations.last() {
            None => Err(Unreadable::Empty),
            Some(current) if open => Err(current.no_end()),
            Some(_) => Ok(Self { configurations }),
        }
    }

    /// Returns the first difference of the ARM image's bits from the host's.
    pub(crate) fn compare(host: &Self, arm: &Self) -> Result<(), Difference> {
        if host.names() != arm.names() {
            return Err(Difference::Names {
                host: host.names(),
                arm: arm.names(),
            });
        }
        let pairs = host.configurations.iter().zip(&arm.configurations);
        pairs
            .into_iter()
            .try_for_each(|(host, arm)| compare(host, arm))
    }

    /// Returns the steps of all configurations together.
    pub(crate) fn steps(&self) -> u64 {
        self.configurations
            .iter()
            .map(Configuration::last_step)
            .sum()
    }

    pub(crate) fn names(&self) -> Vec<String> {
        let names = self.configurations.iter();
        names
            .map(|configuration| configuration.name.clone())
            .collect()
    }
}

impl Configuration {
    fn last_step(&self) -> u64 {
        self.digests.last().map_or(0, |digest| digest.step)
    }

    fn no_end(&self) -> Unreadable {
        Unreadable::NoEnd {
            name: self.name.clone(),
            step: self.last_step(),
        }
    }
}

fn compare(host: &Configuration, arm: &Configuration) -> Result<(), Difference> {
    let mut from = 0;
    for (host_digest, arm_digest) in host.digests.iter().zip(&arm.digests) {
        if host_digest.step != arm_digest.step {
            break;
        }
        if host_digest.value != arm_digest.value {
            return Err(Difference::Bits {
                name: host.name.clone(),
                from,
                until: host_digest.step,
                host: host_digest.value,
                arm: arm_digest.value,
            });
        }
        from = host_digest.step;
    }
    if host.last_step() != arm.last_step() || host.digests.len() != arm.digests.len() {
        return Err(Difference::Steps {
            name: host.name.clone(),
            host: host.last_step(),
            arm: arm.last_step(),
        });
    }
    Ok(())
}

/// Returns name, digest, and whether it is the last one of its configuration.
fn fields(line: &str) -> Option<(&str, Digest, bool)> {
    let mut words = line.split(' ');
    let name = words.next()?.strip_prefix("config=")?;
    let (key, step) = words.next()?.split_once('=')?;
    let value = words.next()?.strip_prefix("digest=")?;
    let last = match key {
        "step" => false,
        "steps" => true,
        _ => return None,
    };
    let complete = !name.is_empty() && value.len() == 16 && words.next().is_none();
    let digest = Digest {
        step: step.parse().ok()?,
        value: u64::from_str_radix(value, 16).ok()?,
    };
    complete.then_some((name, digest, last))
}

impl std::error::Error for Difference {}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Names { host, arm } => write!(
                f,
                "in their configurations, host [{}], ARM [{}]",
                host.join(", "),
                arm.join(", ")
            ),
            Self::Steps { name, host, arm } => write!(
                f,
                "in the steps of configuration `{name}`, host {host}, ARM {arm}"
            ),
            Self::Bits {
                name,
                from,
                until,
                host,
                arm,
            } => write!(
                f,
                "first in configuration `{name}`, steps {from} to {}: digest host {host:016x}, ARM {arm:016x}",
                until - 1
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOST: &str = "\
config=thesis step=1024 digest=0000000000000001
config=thesis step=2048 digest=0000000000000002
config=thesis steps=2048 digest=0000000000000002
config=scheme_2 step=1024 digest=00000000000000aa
config=scheme_2 steps=1500 digest=00000000000000bb
";

    fn read(text: &str) -> Run {
        Run::read(text).unwrap()
    }

    fn compare(arm: &str) -> Result<(), Difference> {
        Run::compare(&read(HOST), &read(arm))
    }

    #[test]
    fn a_run_equals_itself_and_counts_the_steps_of_all_configurations() {
        assert_eq!(compare(HOST), Ok(()));
        assert_eq!(read(HOST).steps(), 2048 + 1500);
    }

    #[test]
    fn what_the_arm_machine_says_of_its_stack_is_no_difference() {
        assert_eq!(compare(&format!("{HOST}stack used=312 of=65536\n")), Ok(()));
    }

    #[test]
    fn every_single_changed_digest_is_a_difference() {
        for (index, _) in HOST.match_indices("digest=0") {
            let mut arm = HOST.to_owned();
            arm.replace_range(index + 7..index + 8, "f");
            assert!(compare(&arm).is_err(), "{arm}");
        }
    }

    #[test]
    fn the_first_differing_block_is_named_with_its_configuration() {
        let arm = HOST
            .replace("0000000000000002", "00000000000000ff")
            .replace("00000000000000bb", "00000000000000cc");
        let message = compare(&arm).unwrap_err().to_string();
        let expected = "first in configuration `thesis`, steps 1024 to 2047: \
                        digest host 0000000000000002, ARM 00000000000000ff";
        assert_eq!(message, expected);
    }

    #[test]
    fn a_configuration_that_one_side_lacks_is_a_difference() {
        let (arm, _) = HOST.split_at(HOST.find("config=scheme_2").unwrap());
        let message = compare(arm).unwrap_err().to_string();
        assert_eq!(
            message,
            "in their configurations, host [thesis, scheme_2], ARM [thesis]"
        );
    }

    #[test]
    fn fewer_steps_on_one_side_are_a_difference() {
        let arm = HOST.replace("steps=1500", "steps=1400");
        let message = compare(&arm).unwrap_err().to_string();
        assert_eq!(
            message,
            "in the steps of configuration `scheme_2`, host 1500, ARM 1400"
        );
    }

    #[test]
    fn a_run_that_breaks_off_is_unreadable_and_not_a_short_run() {
        let lines: Vec<&str> = HOST.split_inclusive('\n').collect();
        let at = |kept: usize| Run::read(&lines[..kept].concat()).unwrap_err();
        let no_end = |name: &str, step| Unreadable::NoEnd {
            name: name.to_owned(),
            step,
        };
        assert_eq!(at(0), Unreadable::Empty);
        assert_eq!(at(2), no_end("thesis", 2048));
        assert_eq!(at(4), no_end("scheme_2", 1024));
    }

    #[test]
    fn a_configuration_without_its_end_is_unreadable() {
        let text = HOST.replace("config=thesis steps=2048 digest=0000000000000002\n", "");
        assert!(matches!(Run::read(&text), Err(Unreadable::NoEnd { .. })));
    }

    #[test]
    fn a_step_that_does_not_rise_is_unreadable() {
        let text = HOST.replace("step=2048", "step=1024");
        assert!(matches!(
            Run::read(&text),
            Err(Unreadable::Order { line: 2, .. })
        ));
    }

    #[test]
    fn a_line_in_another_form_is_named_with_its_number() {
        for bad in [
            "panicked at firmware",
            "",
            "config= step=1 digest=0000000000000001",
            "config=a step=-1 digest=0000000000000001",
            "config=a step=1 digest=1",
            "config=a step=1 digest=000000000000000g",
            "config=a step=1 digest=0000000000000001 more",
            "config=a blocks=1 digest=0000000000000001",
        ] {
            let text = format!("{HOST}{bad}\n");
            let expected = Unreadable::Line {
                line: 6,
                text: bad.to_owned(),
            };
            assert_eq!(Run::read(&text), Err(expected));
        }
    }
}
