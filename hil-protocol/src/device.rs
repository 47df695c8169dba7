//! What a device does with a request.

use crate::message::{Identity, Reply, Request};

/// A device, apart from its link: the same on a board, in an emulator and in process.
pub trait Device {
    /// A host opened a session; from now on samples come from the link (`lock_step`) or from the timer.
    ///
    /// `boot` of the identity is filled in by the session.
    fn open(&mut self, lock_step: bool) -> Identity;

    /// Carries out one request. Called once for each request that was sent, however often its frame arrives.
    fn answer(&mut self, request: &Request) -> Reply;
}
