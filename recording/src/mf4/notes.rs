//! Notes of a recording about the file from which it was read.

use super::choice::Column;
use super::structure::File;
use crate::csv::Excerpt;
use crate::provenance::READER_NOTE;
use crate::{Note, Provenance, Recording};

/// Maximum number of left-out channels named in an error.
const NAMED_MAX: usize = 3;

/// Returns source, producer, and the notes of the file itself.
pub(super) fn provenance(source_name: &str, file: &File) -> Provenance {
    let mut provenance = Provenance::from_source(source_name);
    provenance.producer = file.producer.clone();
    provenance.start = file.start;
    // Files of this crate have the source as comment, for display in other programs.
    let is_repeated = |note: &Note| note.value == file.comment;
    if !file.comment.is_empty() && !file.properties.iter().any(is_repeated) {
        provenance.notes.push(Note {
            key: "comment".to_owned(),
            value: file.comment.clone(),
        });
    }
    provenance.notes.extend(file.properties.iter().cloned());
    if file.unfinished.is_any {
        let text = "the logger did not close the file: its samples were counted from the data, and the last ones may be lost";
        add(&mut provenance, text.to_owned());
    }
    provenance
}

/// Adds a note about data that is no whole record.
pub(super) fn add_rest(provenance: &mut Provenance, bytes: u64) {
    let text = format!("{bytes} bytes after the last whole record of a group were not read");
    add(provenance, text);
}

/// Adds a note about the treatment of a channel's numbers.
pub(super) fn add_column(provenance: &mut Provenance, column: &Column, not_a_number: u64) {
    let name = Excerpt::of(&column.name);
    if let Some(outcome) = column.source.conversion.of_texts() {
        let text = format!("{name} has texts for some of its numbers: {outcome}");
        add(provenance, text);
    }
    if not_a_number > 0 {
        let text = format!("{name} has {not_a_number} samples that are NaN: they count as missing");
        add(provenance, text);
    }
}

/// Adds a note that signals of other rates were taken at the instants of `name`.
pub(super) fn add_instants(provenance: &mut Provenance, name: &str) {
    let name = Excerpt::of(name);
    let text = format!("all signals are as they were known at the instants of {name}");
    add(provenance, text);
}

fn add(provenance: &mut Provenance, value: String) {
    provenance.notes.push(Note {
        key: READER_NOTE.to_owned(),
        value,
    });
}

/// Returns the first left-out channels, as the end of a sentence.
pub(super) fn first_left_out(recording: &Recording) -> String {
    let left_out = recording.left_out();
    let named = left_out.iter().take(NAMED_MAX);
    let mut text: String = named
        .map(|one| format!("; {}: {}", Excerpt::of(&one.name), one.reason))
        .collect();
    if left_out.len() > NAMED_MAX {
        text.push_str(&format!("; and {} more", left_out.len() - NAMED_MAX));
    }
    text
}
