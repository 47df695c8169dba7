//! Who may say what next: sessions and sequence numbers.

mod device;
mod host;

pub use device::DeviceSession;
pub use host::{Event, HostError, HostSession};

/// Where the number of a frame stands to the newest one of its session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// The newest again.
    Same,
    /// The one after it.
    Next,
    /// Beyond that: at least one is missing.
    Beyond,
    /// Before it.
    Before,
}

impl Place {
    /// Numbers go round; half of them are ahead.
    const fn of(found: u32, newest: u32) -> Self {
        match found.wrapping_sub(newest) {
            0 => Self::Same,
            1 => Self::Next,
            ahead if ahead < 1 << 31 => Self::Beyond,
            _ => Self::Before,
        }
    }
}

/// A session's number: the host's half, which differs from session to session, and the device's, which differs from boot to
/// boot. So a device that was reset never takes part in the session before.
const fn session_number(nonce: u32, boot: u32) -> u32 {
    nonce.wrapping_add(boot)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_go_round() {
        for newest in [0, 1, 12_345, u32::MAX - 1, u32::MAX] {
            for (ahead, place) in [
                (0, Place::Same),
                (1, Place::Next),
                (2, Place::Beyond),
                ((1 << 31) - 1, Place::Beyond),
                (1 << 31, Place::Before),
                (u32::MAX, Place::Before),
            ] {
                assert_eq!(Place::of(newest.wrapping_add(ahead), newest), place);
            }
        }
    }
}
