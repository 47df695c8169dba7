//! Interface of a device that answers requests.

use crate::message::{Identity, Reply, Request};

/// Device without its link: the same on a board, in an emulator and in process.
pub trait Device {
    /// Opens a session of a host. From now on samples come from the link (`lock_step`) or from the timer.
    ///
    /// The session fills in `boot` of the identity.
    fn open(&mut self, lock_step: bool) -> Identity;

    /// Carries out one request. It is called once for each request that was sent, even if its frame arrives several
    /// times.
    fn answer(&mut self, request: &Request) -> Reply;
}
