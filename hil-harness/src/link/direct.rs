//! Link to a device in this process, without frames.

use hil_protocol::{Device, Identity, Reply, Request};

use super::{Link, LinkError};

/// Device in this process: requests are passed directly, in lock step.
#[derive(Clone, Debug)]
pub struct Direct<D> {
    device: D,
    identity: Identity,
}

impl<D: Device> Direct<D> {
    /// Opens a session.
    pub fn open(mut device: D) -> Self {
        let identity = device.open(true);
        Self { device, identity }
    }

    /// Returns the device.
    pub fn device(&self) -> &D {
        &self.device
    }

    /// Returns the device, for changes that no wire allows.
    pub fn device_mut(&mut self) -> &mut D {
        &mut self.device
    }
}

impl<D: Device> Link for Direct<D> {
    fn identity(&self) -> String {
        format!("ecu {} in process", self.identity.image.version)
    }

    fn ask(&mut self, request: &Request) -> Result<Reply, LinkError> {
        match self.device.answer(request) {
            Reply::Refused(refusal) => Err(LinkError::refused(request, refusal)),
            reply => Ok(reply),
        }
    }

    /// Returns an empty log: only an image logs.
    fn take_log(&mut self) -> Result<Vec<String>, LinkError> {
        Ok(Vec::new())
    }
}
