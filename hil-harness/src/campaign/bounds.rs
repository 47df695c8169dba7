//! Bounds of the oracle: the table of faults and reactions of `docs/safety.md`, with consequences of it and of the
//! plant's physics. They are defined here and not read from the ECU's code: if the two disagree, one of them is wrong.
//!
//! An ECU may meet a limit slightly earlier or later because of its rounding. Such a limit is widened by the amount
//! given beside it, so that a fault that the oracle calls present is present for any ECU that follows the table.

/// N of an implausible pressure (samples); the six sensor faults with the reaction `Hold` share one count.
pub const DOUBT_N: u32 = 5;
/// N of a lost reference (samples).
pub const REFERENCE_N: u32 = 5;
/// N of a battery voltage outside its window (samples).
pub const BATTERY_N: u32 = 10;
/// N of a sample time outside of half to twice the nominal one (samples).
pub const SAMPLE_TIME_N: u32 = 3;
/// N of a coil's current (samples).
pub const COIL_N: u32 = 3;
/// N of a stuck sensor (samples in which a valve was driven).
pub const STUCK_N: u32 = 50;
/// N of a pressure in an empty chamber (samples).
pub const OFFSET_N: u32 = 200;
/// N of a pressure that the commands do not explain (samples).
pub const RESPONSE_N: u32 = 3;
/// Shortest accepted sample time (µs): half of the nominal one.
pub const ELAPSED_MIN_US: u32 = 5_000;
/// Longest accepted sample time (µs): twice the nominal one.
pub const ELAPSED_MAX_US: u32 = 20_000;
/// N of damaged memory (samples).
pub const MEMORY_N: u32 = 1;

/// Number of samples with the reference at zero before the chamber is filled after a reset or after it was emptied.
pub const ZERO_N: u32 = 10;
/// Highest reference that counts as zero (2⁻¹⁶ bar gauge): 0.05 bar.
pub const ZERO_MAX: i32 = 3276;
/// Number of samples without a fault before it counts as gone.
pub const RECOVERY_N: u32 = 10;
/// Maximum number of faults from which the ECU recovers without a lock.
pub const RETRIES: u32 = 3;

/// Time for which both valves are shut while a fault may pass (samples).
pub const HOLD_SAMPLES: u32 = 50;
/// Duration of full venting (samples).
pub const VENT_SAMPLES: u32 = 200;
/// Duration of venting in pulses (samples).
pub const RELEASE_SAMPLES: u32 = 800;
/// Period of these pulses (samples).
pub const PULSE_PERIOD: u32 = 16;
/// Rate at which a ramp leads the reference down (bar per sample): 5 bar/s.
pub const RAMP_BAR_PER_SAMPLE: f64 = 0.05;
/// Duration of a ramp from the highest pressure of a supply of 10 bar, and of the venting after it (samples).
pub const RAMP_SAMPLES: u32 = 200 + VENT_SAMPLES;
/// Delay by mode changes (samples): a mode begins in the sample after the one that ended the previous mode, at most
/// three times.
pub const CHANGES: u32 = 3;

/// Time without any fault after which the target has certainly finished any reaction (samples): the longest one, and
/// the recovery.
pub const AWAY_SAMPLES: u32 = HOLD_SAMPLES + RELEASE_SAMPLES + VENT_SAMPLES + RECOVERY_N;

/// Highest pressure of an emptied chamber (bar gauge): the sensor cannot distinguish it from its own offset.
pub const EMPTY_BAR: f64 = 0.2;
/// Margin above the supply pressure, from the solver's own tolerance (bar).
pub const SUPPLY_MARGIN_BAR: f64 = 0.01;
/// Margin of the pressure on a ramp: it may deviate by the deadband (0.1 bar) to either side, and by the inflow in the
/// sample of a correction (9.4 bar abs, 7.3 %). This gives 0.9 bar over any [`RAMP_WINDOW`] in addition to the change
/// of the ramp.
pub const RAMP_MARGIN_BAR: f64 = 0.9;
/// Window in which a ramp is checked (samples).
pub const RAMP_WINDOW: u32 = 20;
/// Largest share of its absolute pressure that the chamber loses between two pulses: four samples with the valve open
/// and two in which it closes, at 7.3 % per sample and 15 % more on a scattered rig: 1 - exp(-6 · 0.084).
pub const PULSE_SHARE: f64 = 0.40;
/// Largest rise of the pressure while nothing is filled (bar): the noise-free pressure hardly moves, so the deadband is
/// used.
pub const RISE_BAR: f64 = 0.1;
/// Time for which the valves still move after the reaction (samples): the settling time of the rig, 60 ms, and a
/// period.
pub const SETTLING: u32 = 7;
/// Largest pressure above the line of the ramp after a fault (bar): the deadband (0.1 bar), and the inflow while the
/// valve closes after the line was reached (command delay and one period: 2.5 samples of 0.7 bar at most, half of it at
/// a ramp's error).
pub const BUMP_BAR: f64 = 0.9;
/// Time for which the recovery is checked after the ramp is over (samples): T_req.
pub const COMEBACK_SAMPLES: u32 = 50;
/// Largest change per sample of a pressure at rest (bar): a difference of two samples with the bench's noise of 4 mbar
/// rms stays within it in 999 of 1000 cases.
pub const REST_BAR: f64 = 0.02;
/// Largest excess of the first duty cycle after a rest over the second (%): a sixth of the 30 % from just open to fully
/// open. The changes that remain possible, [`REST_BAR`] and a sample of the ramp, give 1.4 % with a gain of 35 %/bar
/// and a derivative time of 16 ms.
pub const KICK_PCT: f64 = 5.0;
/// Largest pressure above the reference at which filling is allowed (bar). The derivative part brakes a falling
/// pressure, and a derivative time of 16 ms looks ahead 1.3 bar if a scattered rig loses 80 bar/s.
pub const ABOVE_REFERENCE_BAR: f64 = 1.4;
/// Largest pressure change by a valve in a sample (bar): 7.3 1/s of 11 bar abs.
pub const FASTEST_BAR: f64 = 0.8;
/// Distance from the reference within which the loop is live (bar): P_tol.
pub const LIVE_BAR: f64 = 0.1;

/// Lowest code of a pressure: the sensor's lowest code less 80 mbar.
pub const CODE_MIN: u16 = 32;
/// Margin above the highest supply pressure beyond which a pressure is implausible (bar), and for the oracle 10 mbar
/// more.
pub const ABOVE_SUPPLY_BAR: f64 = 0.2;
/// Limit of a jump, as a multiple of the change by the fastest valve in a sample; 20 mbar more for the oracle.
pub const JUMP_FACTOR: f64 = 2.0;
/// Minimum response of an open valve, as a share of the rig's nominal response.
pub const RESPONSE_FACTOR: f64 = 0.5;
/// Largest change of the pressure in a shut chamber (bar per sample).
pub const CREEP_BAR: f64 = 0.005;
/// Largest unexplained pressure (bar): 0.5, and for the oracle 0.1 more.
pub const UNEXPLAINED_BAR: f64 = 0.6;
/// Pressure below which a vent valve hardly changes the pressure (bar gauge); 10 mbar more for the oracle.
pub const ROOM_TO_FALL_BAR: f64 = 0.51;
/// Lowest duty cycle of an energised coil (%).
pub const ENERGISED_PCT: f64 = 20.0;
/// Largest ratio of a resistance that the ECU measured to the true one.
pub const RESISTANCE_ERROR: f64 = 1.04;
/// Nominal supply voltage of the campaign's rigs (V).
pub const NOMINAL_V: f64 = 24.0;
/// Smallest and largest ratio of a coil's resistance to its nominal one that the compensation may use: its bounds, and a
/// thousandth for its table of voltages. A fault of a current sensor leads there.
pub const RESISTANCE_RATIO: [f64; 2] = [0.649, 1.702];
/// Largest deviation of a duty cycle at the coil from the commanded one (%): half a step of a 16-bit PWM.
pub const DUTY_STEP_PCT: f64 = 100.0 / 65535.0;
