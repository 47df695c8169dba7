//! What the supervisor is doing.

/// Mode of the supervisor; the number is that of the telemetry.
///
/// Filling is possible in [`Mode::Running`] alone. A fault leads downwards; among several the strictest way counts. The ways are
/// those of `docs/safety.md`.
///
/// ```text
///            reset
///              │
///              ▼       reference at zero, 10 samples
///          ┌─Waiting ──────────────────────────────► Running ◄───────────────┐
///          │   ▲  │                                    │                     │ fault gone, 10 samples;
///          │   │  └──────────────┬─────────────────────┘                     │ to Waiting, if it came from there
///          │   │                 │ fault                                     │
///          │   │     ┌───────────┼──────────┬─────────────────┬──────────┐   │
///          │   │   hold        ramp    release, vent         off       lock  │
///          │   │     ▼           ▼          │                 │          │   │
///          │   │  Holding ──► Ramping ──────┼─────────────────┼──────────┼───┤
///          │   │     │           │          │                 │          │   │
///          │   │     ├───────────┼──────────┼─────────────────┼──────────┼───┘
///          │   │ 50 samples  reference      ▼                 │          │
///          │   │     │        at zero   ┌─► Venting           │          │
///          │   │     └───────────┴──────┘   │ emptied         │          │
///          │   │ fault gone                 ▼                 │          │
///          │   └─────────────────────────  Safe ◄─────────────┘          │
///          │ release by hand                │ instead of Safe,           │
///          │                                │ from the 4th fault on      │
///          └─────────────────────────────  Locked ◄──────────────────────┘
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Mode {
    /// Nothing is filled until the reference was seen at zero; the vent valve follows the reference downwards.
    Waiting = 0,
    /// The controller has both valves.
    Running = 1,
    /// Both valves are shut while a fault may pass.
    Holding = 2,
    /// The reference is led down to zero; only the vent valve is used.
    Ramping = 3,
    /// The chamber is emptied without the sensor, in pulses or at once, for a bounded time.
    Venting = 4,
    /// Both coils off ([`safe_outputs`](crate::safe_outputs)).
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
