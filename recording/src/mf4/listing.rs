use std::fs::File as StdFile;
use std::io::{Read, Seek};
use std::path::Path;

use super::Limits;
use super::blocks::Blocks;
use super::candidates::Candidates;
use super::choice::Choice;
use super::error::{Located, Mf4Error, of_file};
use super::problem::Problem;
use super::structure::File;
use crate::csv::Mapping;

/// Content of a file without its samples, from which a mapping can be written.
///
/// Texts are unchanged from the file: show them as text, never as markup.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listing {
    /// Version times 100, such as 410.
    pub version: u16,
    /// Program that wrote it.
    pub producer: Option<String>,
    /// Comment on the file.
    pub comment: String,
    /// Whether the logger did not close the file.
    pub is_unfinished: bool,
    /// Groups of channels that were sampled together, in the order of the file. A mapping numbers them from 1.
    pub groups: Vec<Group>,
}

/// Channels that were sampled together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// Name; often empty.
    pub name: String,
    /// Number of samples as given in the file: 0 in many that are unfinished.
    pub samples: u64,
    /// Channels without the time.
    pub channels: Vec<Channel>,
}

/// A channel of a [`Listing`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Name.
    pub name: String,
    /// Unit as given in the file.
    pub unit: String,
    /// Reason why it is no signal, and the mapping that may solve it; `None` if it is one without a mapping.
    pub obstacle: Option<String>,
}

/// Lists the content of an MF4 input.
///
/// # Errors
/// Returns the first problem of its structure; its data is not read.
pub fn list<R: Read + Seek>(
    source_name: &str,
    input: R,
    limits: Limits,
) -> Result<Listing, Mf4Error> {
    list_located(input, limits).map_err(|error| Mf4Error::new(source_name, error))
}

/// Lists the content of an MF4 file.
///
/// # Errors
/// Returns the same errors as [`list`].
pub fn list_file(path: impl AsRef<Path>, limits: Limits) -> Result<Listing, Mf4Error> {
    let path = path.as_ref();
    let name = path.display().to_string();
    let file =
        StdFile::open(path).map_err(|error| Mf4Error::new(&name, of_file(Problem::Io(error))))?;
    list(&name, file, limits)
}

fn list_located<R: Read + Seek>(input: R, limits: Limits) -> Result<Listing, Located> {
    let mut blocks = Blocks::new(input, limits)?;
    let file = File::read(&mut blocks)?;
    let candidates = Candidates::of(&mut blocks, &file)?;
    let choice = Choice::of(&candidates, &Mapping::default())?;
    let mut groups: Vec<Group> = candidates
        .groups
        .iter()
        .map(|group| {
            let group = &file.data_groups[group.data_group].channel_groups[group.channel_group];
            Group {
                name: group.name.clone(),
                samples: group.records,
                channels: Vec::new(),
            }
        })
        .collect();
    let mut left_out = choice.left_out.into_iter().peekable();
    for (index, channel) in candidates.channels.into_iter().enumerate() {
        let obstacle = left_out
            .next_if(|(at, _)| *at == index)
            .map(|(_, left_out)| left_out.reason);
        if !channel.is_master {
            groups[channel.group - 1].channels.push(Channel {
                name: channel.name,
                unit: channel.unit,
                obstacle,
            });
        }
    }
    Ok(Listing {
        version: file.version,
        producer: file.producer,
        comment: file.comment,
        is_unfinished: file.unfinished.is_any,
        groups,
    })
}
