//! What the supervisor is doing.

/// Mode of the supervisor; the number is that of the telemetry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Mode {
    /// After a reset: nothing is filled until the reference was seen at zero.
    Waiting = 0,
    /// The controller has both valves.
    Running = 1,
    /// Both valves are shut while a fault may pass.
    Holding = 2,
    /// The reference is led down to zero; only the vent valve is used.
    Ramping = 3,
    /// The chamber is emptied without the sensor, in pulses or at once, for a bounded time.
    Venting = 4,
    /// Both coils off.
    Safe = 5,
    /// Both coils off until somebody releases it, or the power comes back.
    Locked = 6,
}

impl Mode {
    /// Every mode, in the order of its number.
    pub const ALL: [Self; 7] = [
        Self::Waiting,
        Self::Running,
        Self::Holding,
        Self::Ramping,
        Self::Venting,
        Self::Safe,
        Self::Locked,
    ];
}
