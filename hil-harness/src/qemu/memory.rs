//! Memory shared by this process and the emulated machine.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicU32;

use hil_protocol::mailbox;
use vm_memory::{FileOffset, MmapRegion, VolatileMemory as _};

use super::QemuError;

/// Size of the machine's RAM at [`mailbox::ADDRESS`]; the emulator accepts no other.
pub(super) const SIZE: usize = 16 << 20;

/// RAM of the emulated machine, as words shared by both sides.
#[derive(Debug)]
pub struct SharedMemory {
    region: MmapRegion,
}

impl SharedMemory {
    /// Creates the file at `path` and maps it.
    pub(super) fn create(path: &Path) -> Result<Self, QemuError> {
        let failed = |error| QemuError::Io {
            what: "the file of the emulated machine's memory",
            error,
        };
        let file = File::options()
            .read(true)
            .write(true)
            .create_new(true)
            .open(path)
            .map_err(failed)?;
        file.set_len(SIZE as u64).map_err(failed)?;
        let region = MmapRegion::from_file(FileOffset::new(file, 0), SIZE);
        Ok(Self {
            region: region.map_err(|error| QemuError::Memory {
                reason: error.to_string(),
            })?,
        })
    }

    /// Returns the word at an address of the machine; `None` outside of this memory, or if the address is no multiple
    /// of four.
    pub fn word_at(&self, address: usize) -> Option<&AtomicU32> {
        let offset = address.checked_sub(mailbox::ADDRESS)?;
        self.region.get_atomic_ref(offset).ok()
    }
}

/// Folder for the emulator's files, in RAM if the machine supports that; it is removed with this value.
#[derive(Debug)]
pub(super) struct Folder(tempfile::TempDir);

impl Folder {
    pub(super) fn create() -> Result<Self, QemuError> {
        let in_memory = Path::new("/dev/shm");
        let place = match in_memory.is_dir() {
            true => in_memory.to_owned(),
            false => std::env::temp_dir(),
        };
        tempfile::Builder::new()
            .prefix("retarder-")
            .tempdir_in(place)
            .map(Self)
            .map_err(|error| QemuError::Io {
                what: "a folder for the emulator's files",
                error,
            })
    }

    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}
