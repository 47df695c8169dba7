//! Sessions and sequence numbers.

mod device;
mod host;

pub use device::DeviceSession;
pub use host::{Event, HostError, HostSession};

/// Position of a frame's number relative to the newest one of its session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// Equal to the newest.
    Same,
    /// One after the newest.
    Next,
    /// Further ahead: at least one frame is missing.
    Beyond,
    /// Before the newest.
    Before,
}

impl Place {
    /// Compares two numbers. They wrap; half of them count as ahead.
    const fn of(found: u32, newest: u32) -> Self {
        match found.wrapping_sub(newest) {
            0 => Self::Same,
            1 => Self::Next,
            ahead if ahead < 1 << 31 => Self::Beyond,
            _ => Self::Before,
        }
    }
}

/// Returns the number of a session: the sum of the host's part, which differs from session to session, and the device's
/// part, which differs from boot to boot. Therefore a device that was reset never continues the previous session.
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
