//! A device in this process, asked without frames.

use hil_protocol::{Device, Identity, Reply, Request};

use super::{Link, LinkError};

/// A device in this process: the request itself is handed over, in lock step.
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

    /// The device.
    pub fn device(&self) -> &D {
        &self.device
    }

    /// The device, to do to it what no wire could.
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

    /// Nothing: only an image logs.
    fn take_log(&mut self) -> Result<Vec<String>, LinkError> {
        Ok(Vec::new())
    }
}
