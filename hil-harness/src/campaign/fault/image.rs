//! Faults of the running image.

use super::named;

named! {
    /// Fault of the image on its machine.
    ImageFault {
        /// A bit of the static variables flips.
        FlipVariables = "flip-variables",
        /// A bit of the stack flips, which also contains the ECU's state.
        FlipStack = "flip-stack",
        /// The main loop stops, until the watchdog resets.
        Hang = "hang",
        /// The processor executes an undefined instruction.
        Trap = "trap",
        /// The machine is reset while its memory stays, and is without current during the fault.
        WarmReset = "warm-reset",
    }
}
