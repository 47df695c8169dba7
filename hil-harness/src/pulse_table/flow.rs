//! Flow coordinate: the pressure, transformed so that an open valve moves it at a constant rate.

use plant_sim::PlantParameters;
use plant_sim::experiment::ValveId;
use plant_sim::orifice::NozzleLaw;

/// Number of cells of a table.
pub const FLOW_CELLS: usize = 64;
/// Number of intervals of the integral in a cell.
const INTERVALS: usize = 2000;
/// Highest pressure of the vent valve's table, in ambient pressures.
const VENT_SPAN: f64 = 16.0;

/// Returns the flow coordinate at the ends of equal cells, in units of one choked second at a rate of 1/s.
///
/// Fill valve: σ(r) = ∫dr/ψ(r) over r = p/p_sup (absolute), 0 to 1. Vent valve: σ(y) = ∫dy/(y ψ(1/y)) over y = p/p_amb, 0
/// to 16; below ambient pressure it is 0. ψ is equation 3.19 divided by its choked value.
pub fn flow_table(plant: &PlantParameters, valve: ValveId) -> [f64; FLOW_CELLS + 1] {
    let gas = &plant.gas;
    let law = NozzleLaw::new(
        gas.heat_capacity_ratio,
        gas.gas_constant_j_per_kg_k,
        gas.temperature_k,
        plant.flow.critical_ratio,
    );
    let psi = |ratio: f64| law.flow_function(ratio) / law.choked_factor();
    let slope = |x: f64| match valve {
        ValveId::Fill => 1.0 / psi(x),
        ValveId::Vent if x <= 1.0 => 0.0,
        ValveId::Vent => 1.0 / (x * psi(1.0 / x)),
    };
    let span = match valve {
        ValveId::Fill => 1.0,
        ValveId::Vent => VENT_SPAN,
    };
    let width = span / (FLOW_CELLS * INTERVALS) as f64;
    let mut table = [0.0; FLOW_CELLS + 1];
    for cell in 0..FLOW_CELLS {
        let middles = (0..INTERVALS).map(|i| ((cell * INTERVALS + i) as f64 + 0.5) * width);
        table[cell + 1] = table[cell] + middles.map(slope).sum::<f64>() * width;
    }
    table
}
