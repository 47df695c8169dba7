//! Names of stored files. The server creates them, so that no text of a request becomes a path.

use std::io;

use serde::{Deserialize, Serialize};

use crate::token::{hex, random_hex};

/// SHA-256 of a stored log, which is its file name.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub(crate) struct LogHash(String);

impl TryFrom<String> for LogHash {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        if is_hex(&text, 64) {
            Ok(Self(text))
        } else {
            Err("a log is named by the 64 hexadecimal digits of its hash".to_owned())
        }
    }
}

impl LogHash {
    pub(crate) fn of(digest: &[u8]) -> Self {
        Self(hex(digest))
    }

    pub(crate) fn as_str(&self) -> &str {
        &self.0
    }
}

impl From<LogHash> for String {
    fn from(hash: LogHash) -> Self {
        hash.0
    }
}

/// Random name of 32 hexadecimal digits from the server, and therefore a safe file name.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub(crate) struct ProjectId(String);

impl TryFrom<String> for ProjectId {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        if is_hex(&text, 32) {
            Ok(Self(text))
        } else {
            Err("a project is named by 32 hexadecimal digits".to_owned())
        }
    }
}

impl From<ProjectId> for String {
    fn from(id: ProjectId) -> Self {
        id.0
    }
}

impl ProjectId {
    pub(crate) fn random() -> Result<Self, io::Error> {
        random_hex().map(Self).map_err(io::Error::other)
    }

    pub(crate) fn as_str(&self) -> &str {
        &self.0
    }
}

fn is_hex(text: &str, length: usize) -> bool {
    let is_digit = |byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte);
    text.len() == length && text.bytes().all(is_digit)
}
