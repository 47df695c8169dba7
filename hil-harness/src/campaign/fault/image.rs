//! What can happen to the running image.

use super::named;

named! {
    /// A fault of the image on its machine.
    ImageFault {
        /// A bit of the static variables flips.
        FlipVariables = "flip-variables",
        /// A bit of the stack flips, where the ECU's state is as well.
        FlipStack = "flip-stack",
        /// The main loop stands still, until the watchdog bites.
        Hang = "hang",
        /// An instruction that there is not.
        Trap = "trap",
        /// The machine is reset while its memory stays, and is without current for the time of the fault.
        WarmReset = "warm-reset",
    }
}
