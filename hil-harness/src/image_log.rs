//! Log of an image, decoded from bytes to readable lines.
//!
//! The image sends numbers only (defmt); the texts are in its ELF file.

use defmt_decoder::{Encoding, Table};
use ecu::FaultSet;

/// Decoder of one device's log.
#[derive(Debug, Default)]
pub struct ImageLog {
    /// Texts of the image; `None` without its ELF file.
    table: Option<Table>,
    /// Received part of an incomplete frame.
    begun: Vec<u8>,
    /// Total number of bytes that the device has lost so far.
    lost: u32,
}

/// Reason why the texts of a log cannot be read from an ELF file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ImageLogError {
    /// The file is no ELF file, or was made by another version of the logging framework.
    #[error("its log cannot be read: {reason}")]
    Table {
        /// Error of the decoder.
        reason: String,
    },
    /// The frames would lose synchronisation permanently after a lost byte.
    #[error(
        "its log has no frame ends (defmt encoding `raw`): build it with defmt's feature `encoding-rzcobs`"
    )]
    Raw,
}

impl ImageLog {
    /// Creates a log without texts: lines give the number of bytes.
    pub fn without_texts() -> Self {
        Self::default()
    }

    /// Creates a log with the texts of this ELF file.
    ///
    /// # Errors
    /// Returns an error if the file is no ELF file, or its log cannot be decoded.
    pub fn of_elf(elf: &[u8]) -> Result<Self, ImageLogError> {
        let table = Table::parse(elf).map_err(|error| ImageLogError::Table {
            reason: format!("{error:#}"),
        })?;
        match &table {
            Some(table) if table.encoding() == Encoding::Raw => Err(ImageLogError::Raw),
            _ => Ok(Self {
                table,
                ..Self::default()
            }),
        }
    }

    /// Returns the lines that `bytes` complete. `lost` is the number of bytes that the device has lost since its start.
    pub fn decode(&mut self, bytes: &[u8], lost: u32) -> Vec<String> {
        let mut lines = Vec::new();
        let mut bytes = bytes;
        if lost != self.lost {
            lines.push(format!(
                "... {} bytes of the log are lost ...",
                lost.wrapping_sub(self.lost)
            ));
            self.lost = lost;
            // The begun frame has lost its end, and the next one its beginning.
            self.begun.clear();
            let end = bytes.iter().position(|byte| *byte == 0);
            bytes = end.map_or(&[][..], |end| &bytes[end..]);
        }
        let Some(table) = &self.table else {
            if !bytes.is_empty() {
                lines.push(format!(
                    "{} bytes of log; the image's ELF file has their text",
                    bytes.len()
                ));
            }
            return lines;
        };
        self.begun.extend_from_slice(bytes);
        let Some(end) = self.begun.iter().rposition(|byte| *byte == 0) else {
            return lines;
        };
        let whole: Vec<u8> = self.begun.drain(..=end).collect();
        for frame in whole
            .split(|byte| *byte == 0)
            .filter(|frame| !frame.is_empty())
        {
            lines.push(line(table, frame));
        }
        lines
    }
}

/// Decodes one frame, without its end.
fn line(table: &Table, frame: &[u8]) -> String {
    let mut decoder = table.new_stream_decoder();
    decoder.received(frame);
    decoder.received(&[0]);
    // A complete frame can only fail because it is damaged.
    decoder.decode().map_or_else(
        |_| "... a damaged line ...".to_owned(),
        |frame| {
            let time = frame.display_timestamp().map(|time| format!("{time} "));
            let level = frame.level().map(|level| format!("{:5} ", level.as_str()));
            format!(
                "{}{}{}",
                time.unwrap_or_default(),
                level.unwrap_or_default(),
                with_fault_names(&frame.display_message().to_string())
            )
        },
    )
}

/// Returns a line with the names of faults where the image sent their bits.
fn with_fault_names(line: &str) -> String {
    const SET: &str = "FaultSet(";
    let mut named = String::new();
    let mut rest = line;
    while let Some(start) = rest.find(SET) {
        let (before, set) = rest.split_at(start);
        let bits = &set[SET.len()..];
        let Some((Ok(number), after)) = bits
            .split_once(')')
            .map(|(bits, after)| (bits.parse(), after))
        else {
            break;
        };
        let faults = FaultSet::from_bits(number);
        let names: Vec<String> = faults.iter().map(|fault| format!("{fault:?}")).collect();
        named += &format!(
            "{before}{}",
            if names.is_empty() {
                "none".to_owned()
            } else {
                names.join(" + ")
            }
        );
        rest = after;
    }
    named + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_named_and_what_is_no_set_of_them_stays() {
        for (line, expected) in [
            (
                "mode: Safe, faults: FaultSet(0) }",
                "mode: Safe, faults: none }",
            ),
            (
                "a FaultSet(3) b FaultSet(4)",
                "a SensorOpen + SensorShort b SensorBelowRange",
            ),
            ("FaultSet(x) FaultSet(", "FaultSet(x) FaultSet("),
            ("nothing", "nothing"),
        ] {
            assert_eq!(with_fault_names(line), expected);
        }
    }

    #[test]
    fn what_is_no_elf_file_is_refused_and_bytes_without_texts_are_counted() {
        let error = ImageLog::of_elf(b"no image").unwrap_err().to_string();
        assert!(error.starts_with("its log cannot be read"), "{error}");
        let mut log = ImageLog::without_texts();
        let lines = log.decode(&[1, 2, 0], 5);
        assert_eq!(lines[0], "... 5 bytes of the log are lost ...");
        assert!(
            lines[1..].iter().all(|line| line.contains("bytes of log")),
            "{lines:?}"
        );
    }
}
