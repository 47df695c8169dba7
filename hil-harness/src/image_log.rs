//! The log of an image, from the bytes that it sends to lines that a person reads.
//!
//! The image sends numbers only (defmt); the texts stand in its ELF file.

use defmt_decoder::{Encoding, Table};

/// Decodes the log of one device.
#[derive(Debug, Default)]
pub struct ImageLog {
    /// Texts of the image; none where its ELF file is not at hand.
    table: Option<Table>,
    /// What has come of a frame that is not complete.
    begun: Vec<u8>,
    /// Bytes that the device has lost in all, so far.
    lost: u32,
}

/// Why the texts of a log cannot be read from an ELF file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ImageLogError {
    /// Not an ELF file, or made by another version of the logging framework.
    #[error("its log cannot be read: {reason}")]
    Table {
        /// What the decoder says.
        reason: String,
    },
    /// Frames that a lost byte would put out of step for ever.
    #[error(
        "its log has no frame ends (defmt encoding `raw`): build it with defmt's feature `encoding-rzcobs`"
    )]
    Raw,
}

impl ImageLog {
    /// A log whose texts are not at hand: lines say how many bytes came.
    pub fn without_texts() -> Self {
        Self::default()
    }

    /// A log whose texts stand in this ELF file.
    ///
    /// # Errors
    /// The file is none, or its log cannot be decoded.
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

    /// The lines that `bytes` complete. `lost` is what the device has lost since its start.
    pub fn decode(&mut self, bytes: &[u8], lost: u32) -> Vec<String> {
        let mut lines = Vec::new();
        let mut bytes = bytes;
        if lost != self.lost {
            lines.push(format!(
                "... {} bytes of the log are lost ...",
                lost.wrapping_sub(self.lost)
            ));
            self.lost = lost;
            // What was begun has lost its end, and what comes next its beginning.
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

/// One frame, without its end.
fn line(table: &Table, frame: &[u8]) -> String {
    let mut decoder = table.new_stream_decoder();
    decoder.received(frame);
    decoder.received(&[0]);
    // What else can go wrong with a whole frame is that it is damaged.
    decoder.decode().map_or_else(
        |_| "... a damaged line ...".to_owned(),
        |frame| {
            let time = frame.display_timestamp().map(|time| format!("{time} "));
            let level = frame.level().map(|level| format!("{:5} ", level.as_str()));
            format!(
                "{}{}{}",
                time.unwrap_or_default(),
                level.unwrap_or_default(),
                frame.display_message()
            )
        },
    )
}
