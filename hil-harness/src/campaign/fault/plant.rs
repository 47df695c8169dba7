//! Faults of valves, coils, chamber and supply.

use super::named;

named! {
    /// Fault of the plant.
    PlantFault {
        /// The fill valve is open for any duty cycle; the severity is the opening, from hardly to fully.
        FillStuckOpen = "fill-stuck-open",
        /// The fill valve stays shut.
        FillStuckClosed = "fill-stuck-closed",
        /// The vent valve is open for any duty cycle; the severity is the opening, from hardly to fully.
        VentStuckOpen = "vent-stuck-open",
        /// The vent valve stays shut.
        VentStuckClosed = "vent-stuck-closed",
        /// The supply pressure falls to (1 - severity) of its value; above that, an open fill valve empties the
        /// chamber.
        SupplyLost = "supply-lost",
        /// The chamber leaks; severity 1 empties three quarters of it in a second.
        Leak = "leak",
        /// No current flows through the fill valve's coil.
        FillCoilOpen = "fill-coil-open",
        /// No current flows through the vent valve's coil.
        VentCoilOpen = "vent-coil-open",
        /// The windings of the fill valve's coil are shorted: no force, 4 to 20 times the current.
        FillCoilShort = "fill-coil-short",
        /// The windings of the vent valve's coil are shorted: no force, 4 to 20 times the current.
        VentCoilShort = "vent-coil-short",
        /// The driver of the fill valve's coil is shorted: always full current.
        FillDriverShort = "fill-driver-short",
        /// The driver of the vent valve's coil is shorted: always full current.
        VentDriverShort = "vent-driver-short",
    }
}

impl PlantFault {
    /// Returns whether the vent valve cannot empty the chamber: a valve stuck hardly open opens no further.
    pub(in crate::campaign) fn hinders_venting(self) -> bool {
        matches!(
            self,
            Self::FillStuckOpen
                | Self::FillDriverShort
                | Self::VentStuckOpen
                | Self::VentStuckClosed
                | Self::VentCoilOpen
                | Self::VentCoilShort
        )
    }

    /// Returns whether the coils behave as commanded, though a valve does not.
    pub(in crate::campaign) fn leaves_coils_alone(self) -> bool {
        matches!(
            self,
            Self::FillStuckOpen
                | Self::FillStuckClosed
                | Self::VentStuckOpen
                | Self::VentStuckClosed
                | Self::SupplyLost
        )
    }
}
