//! What do the two valves get in this ECU sample? Fixed-point PID pressure control for a fill and a vent valve, no_std.
