//! State vector: the index of each quantity. Quantities of a valve have two entries, fill and vent.

/// Number of state variables.
pub(super) const COUNT: usize = 32;
pub(super) type State = [f64; COUNT];

/// Flux linkage (Vs).
pub(super) const FLUX: usize = 0;
/// Armature position (m), 0 at the rest stop.
pub(super) const POSITION: usize = 2;
/// Armature velocity (m/s).
pub(super) const VELOCITY: usize = 4;
/// Current of the eddy currents in the coil (A).
pub(super) const EDDY: usize = 6;
/// Temperature of the winding above 20 °C by its own heat (K).
pub(super) const WINDING: usize = 8;
/// Temperature of the coil body above 20 °C (K).
pub(super) const BODY: usize = 10;
/// Force of the deflected friction bristles (N).
pub(super) const BRISTLE: usize = 12;
/// Charge through the coil (As).
pub(super) const CHARGE: usize = 14;
/// Mass of the gas in the chamber (kg).
pub(super) const MASS: usize = 16;
/// Internal energy of the gas in the chamber (J).
pub(super) const ENERGY: usize = 17;
/// Temperature of the chamber wall above its initial one (K).
pub(super) const WALL: usize = 18;
/// Mass of the gas in the supply line (kg).
pub(super) const LINE: usize = 19;
/// Mass of the gas between an inserted orifice and the fill valve (kg).
pub(super) const INLET: usize = 20;
/// Mass of the gas in tube and sensor cavity (kg).
pub(super) const CAVITY: usize = 21;
/// Share by which the volume has followed the pressure.
pub(super) const PLUNGER: usize = 22;
/// Pressure by which the hose has stretched (Pa).
pub(super) const HOSE: usize = 23;
/// Pressure loss in the regulator (Pa).
pub(super) const REGULATOR: usize = 24;
/// Pressure of the drain above ambient (Pa).
pub(super) const DRAIN: usize = 25;
/// Voltage loss by polarisation of the battery (V).
pub(super) const POLARISATION: usize = 26;
/// Pressure after the anti-alias filter (Pa abs), then after the sensor's lag.
pub(super) const FILTERED: usize = 27;
pub(super) const LAGGED: usize = 28;
pub(super) const LAGGED_AGAIN: usize = 29;
/// Share of the seat's adhesion that has built up.
pub(super) const ADHESION: usize = 30;

/// Returns `state + h rate`.
pub(super) fn along(state: &State, h: f64, rate: &State) -> State {
    core::array::from_fn(|n| state[n] + h * rate[n])
}
