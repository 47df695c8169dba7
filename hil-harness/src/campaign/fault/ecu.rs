//! Faults around the ECU's logic.

use super::{Survival, named};
use crate::campaign::bounds;

named! {
    /// Fault of the ECU.
    EcuFault {
        /// The battery gives (1 - severity / 2) of its voltage.
        BatteryLow = "battery-low",
        /// The battery gives 34 to 48 V.
        BatteryHigh = "battery-high",
        /// Samples are 3 to 6 periods apart.
        TaskLate = "task-late",
        /// The task runs again 0 to 4 ms after the last time, by its clock.
        TaskEarly = "task-early",
        /// The time between samples varies by up to a fifth, by the task's clock.
        TaskJitter = "task-jitter",
        /// A reset: no current during the fault, then a start without memory.
        Reset = "reset",
        /// A setting of the controller flips in the target's memory; only where the target can be damaged.
        ConfigDamaged = "config-damaged",
        /// The supervisor's state flips; only where the target can be damaged.
        SupervisorDamaged = "supervisor-damaged",
        /// The controller asks for both valves at once; only where the target can be damaged.
        ControllerDamaged = "controller-damaged",
    }
}

/// Longest fault that is bridged with both valves shut (samples): HOLD_N less the recovery.
const BRIDGED: u32 = 30;

impl EcuFault {
    /// Damages of the target's memory.
    pub const DAMAGES: [Self; 3] = [
        Self::ConfigDamaged,
        Self::SupervisorDamaged,
        Self::ControllerDamaged,
    ];

    /// Returns whether the fault shows as one row of the table. A low battery also shows as valves that do not move.
    pub(in crate::campaign) fn is_plain(self) -> bool {
        matches!(
            self,
            Self::BatteryHigh | Self::TaskLate | Self::TaskEarly | Self::TaskJitter
        )
    }

    pub(in crate::campaign) fn survival(self, duration: u32) -> Survival {
        match self {
            Self::TaskJitter => Survival::Unnoticed,
            Self::BatteryHigh if duration < bounds::BATTERY_N => Survival::Unnoticed,
            Self::BatteryHigh if duration <= BRIDGED => Survival::Held,
            Self::TaskLate | Self::TaskEarly if duration < bounds::SAMPLE_TIME_N => {
                Survival::Unnoticed
            }
            _ => Survival::NotClaimed,
        }
    }
}
