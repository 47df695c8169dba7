//! Modes of the supervisor.

/// Mode of the supervisor; its number is the one in the telemetry.
///
/// Filling is possible only in [`Mode::Running`]. A fault leads downwards in the diagram; among several faults the
/// strictest reaction counts. `docs/safety.md` describes the reactions.
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
    /// The chamber is not filled until the reference was zero; the vent valve follows the reference downwards.
    Waiting = 0,
    /// The controller drives both valves.
    Running = 1,
    /// Both valves are shut while a fault may pass.
    Holding = 2,
    /// The reference is ramped down to zero; only the vent valve is used.
    Ramping = 3,
    /// The chamber is emptied without the sensor, in pulses or at once, for a limited time.
    Venting = 4,
    /// Both coils are off ([`safe_outputs`](crate::safe_outputs)).
    Safe = 5,
    /// Both coils are off until the lock is released or the ECU is reset.
    Locked = 6,
}

impl Mode {
    /// All modes, in the order of their numbers.
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
