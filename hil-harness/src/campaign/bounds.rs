//! What the oracle demands, in figures: the table of faults and ways of `docs/safety.md`, and what follows from it and from the
//! plant's physics. Stated once, and not read from the ECU's code: if the two disagree, one of them is wrong.
//!
//! A limit that an ECU in its own rounding may meet a little earlier or later is widened by what is written beside it, so that
//! what the oracle calls present is present for any ECU that keeps the table.

/// N of a pressure that cannot be believed \[samples\], five kinds of doubt in one count.
pub const DOUBT_N: u32 = 5;
/// N of a lost reference \[samples\].
pub const REFERENCE_N: u32 = 5;
/// N of a battery outside its window \[samples\].
pub const BATTERY_N: u32 = 10;
/// N of a sample time outside of half to twice the nominal one \[samples\].
pub const SAMPLE_TIME_N: u32 = 3;
/// N of a coil's current \[samples\].
pub const COIL_N: u32 = 3;
/// N of a sensor that is stuck \[samples in which a valve was driven\].
pub const STUCK_N: u32 = 50;
/// N of a pressure in an empty chamber \[samples\].
pub const OFFSET_N: u32 = 200;
/// N of a pressure that the commands do not explain \[samples\].
pub const RESPONSE_N: u32 = 3;
/// Sample time that is accepted \[µs\]: half to twice the nominal one.
pub const ELAPSED_MIN_US: u32 = 5_000;
/// The longest one.
pub const ELAPSED_MAX_US: u32 = 20_000;
/// N of damaged memory \[samples\].
pub const MEMORY_N: u32 = 1;

/// Samples with the reference at zero before anything is filled after a reset or after the chamber was given up.
pub const ZERO_N: u32 = 10;
/// The reference is at zero up to here [2⁻¹⁶ bar gauge]: 0.05 bar.
pub const ZERO_MAX: i32 = 3276;
/// Samples without a fault before it counts as gone.
pub const RECOVERY_N: u32 = 10;
/// A fault is forgiven so often.
pub const RETRIES: u32 = 3;

/// Both valves are shut for so long while a fault may pass \[samples\].
pub const HOLD_SAMPLES: u32 = 50;
/// Venting fully takes so long \[samples\].
pub const VENT_SAMPLES: u32 = 200;
/// Venting in pulses takes so long \[samples\].
pub const RELEASE_SAMPLES: u32 = 800;
/// The period of these pulses \[samples\].
pub const PULSE_PERIOD: u32 = 16;
/// A ramp leads the reference down so fast [bar per sample]: 5 bar/s.
pub const RAMP_BAR_PER_SAMPLE: f64 = 0.05;
/// From the highest pressure that a supply of 10 bar can make down such a ramp, and then empty \[samples\].
pub const RAMP_SAMPLES: u32 = 200 + VENT_SAMPLES;
/// A mode begins in the sample after the one that ended the last: one sample for each of at most three changes.
pub const CHANGES: u32 = 3;

/// After so long without any fault the target is certainly on no way any more \[samples\]: the longest, and the recovery.
pub const AWAY_SAMPLES: u32 = HOLD_SAMPLES + RELEASE_SAMPLES + VENT_SAMPLES + RECOVERY_N;

/// An emptied chamber has no more than this [bar gauge]: what the sensor cannot tell from its own offset.
pub const EMPTY_BAR: f64 = 0.2;
/// A chamber cannot be above its supply; the solver's own tolerance \[bar\].
pub const SUPPLY_MARGIN_BAR: f64 = 0.01;
/// On a ramp the pressure may be off its line by the tolerance (0.1 bar) to either side, and by what flows in the sample of a
/// correction (9.4 bar abs, 7.3 %): 0.9 bar over any [`RAMP_WINDOW`] beyond what the ramp takes.
pub const RAMP_MARGIN_BAR: f64 = 0.9;
/// The window in which a ramp is judged \[samples\].
pub const RAMP_WINDOW: u32 = 20;
/// Between two pulses the chamber loses no more than this share of its absolute pressure: four samples with the valve open and two
/// in which it closes, at 7.3 % per sample and 15 % more on a rig that scatters: 1 - exp(-6 · 0.084).
pub const PULSE_SHARE: f64 = 0.40;
/// Rise of the pressure while nothing is filled \[bar\]: the noise-free pressure hardly moves; the tolerance is taken.
pub const RISE_BAR: f64 = 0.1;
/// After the answer the valves still move for so long \[samples\]: the settling time of the rig, 60 ms, and a period.
pub const SETTLING: u32 = 7;
/// After a fault the pressure may be above the line of the ramp by the tolerance (0.1 bar) and by what flows in while the valve
/// closes after it was reached (command delay and one period: 2.5 samples of 0.7 bar at most, half of it at a ramp's error).
pub const BUMP_BAR: f64 = 0.9;
/// The comeback is watched for so long after the ramp is over \[samples\]: T_req.
pub const COMEBACK_SAMPLES: u32 = 50;
/// A pressure that moves by no more than this in a sample rests \[bar\]: a difference of two samples with the bench's noise of 4 mbar
/// rms stays within it in 999 of 1000.
pub const REST_BAR: f64 = 0.02;
/// The first duty cycle after a rest may be so much above the second \[%\]: a sixth of the 30 % from just open to fully open. What
/// may still change, [`REST_BAR`] and a sample of the ramp, makes 1.4 % with a gain of 35 %/bar and a derivative time of 16 ms.
pub const KICK_PCT: f64 = 5.0;
/// No filling so far above the reference \[bar\]: the derivative part brakes a falling pressure, and a derivative time of 16 ms looks
/// ahead 1.3 bar where a rig that scatters loses 80 bar/s.
pub const ABOVE_REFERENCE_BAR: f64 = 1.4;
/// No valve moves the pressure by more in a sample \[bar\]: 7.3 1/s of 11 bar abs.
pub const FASTEST_BAR: f64 = 0.8;
/// Within this of the reference the loop is live \[bar\]: P_tol.
pub const LIVE_BAR: f64 = 0.1;

/// A code below is no pressure: the sensor's lowest code less 80 mbar.
pub const CODE_MIN: u16 = 32;
/// A pressure so far above the highest supply is none \[bar\], and for the oracle 10 mbar more.
pub const ABOVE_SUPPLY_BAR: f64 = 0.2;
/// A jump is more than twice what the fastest valve moves in a sample; 20 mbar more for the oracle.
pub const JUMP_FACTOR: f64 = 2.0;
/// Half of what an open valve of the rig moves has to come at least.
pub const RESPONSE_FACTOR: f64 = 0.5;
/// A shut chamber may do so much by itself [bar per sample].
pub const CREEP_BAR: f64 = 0.005;
/// So much may be unexplained \[bar\]: 0.5, and for the oracle 0.1 more.
pub const UNEXPLAINED_BAR: f64 = 0.6;
/// With less pressure a vent valve has little to move [bar gauge]; 10 mbar more for the oracle.
pub const ROOM_TO_FALL_BAR: f64 = 0.51;
/// A coil is energised from this duty cycle on \[%\].
pub const ENERGISED_PCT: f64 = 20.0;
/// Largest deviation of a duty cycle at the coil from the one that was meant \[%\]: half a step of a 16-bit PWM.
pub const DUTY_STEP_PCT: f64 = 100.0 / 65535.0;
