//! What was measured or simulated, with which units? Signals with unit, quantity and time base, and CSV.
