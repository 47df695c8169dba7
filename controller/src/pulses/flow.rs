//! Flow coordinate: the pressure, transformed so that an open valve moves it at a constant rate.
//!
//! An open fill valve gives dp/dt = k p_sup ψ(p/p_sup), an open vent valve dp/dt = -k p ψ(p_amb/p) (equations 3.19 and
//! 3.24; ψ is the flow over the choked flow). With σ = ∫dp/(p_sup ψ) or -∫dp/(p ψ), both become dσ/dt = k. The open time
//! between two pressures is then the difference of their coordinates over k, for any length of pulse.

use crate::pulses::tables::flow;

/// Ambient pressure (bar), 2⁻¹⁶: 1.01325.
const AMBIENT: i32 = 66_404;
/// Number of cells of a table.
const CELLS: usize = 64;
/// Fraction bits of a place in a table.
const PLACE_BITS: u32 = 16;
/// Fraction bits of a coordinate.
pub(super) const FLOW_BITS: u32 = 20;
/// Number of bits by which a coordinate is finer than the tables.
const FINER: u32 = FLOW_BITS - 14;

/// Cells of the vent valve's table per bar, 2⁻¹⁶: four for each ambient pressure.
const VENT_CELLS_PER_BAR: i32 = ((4_i64 << 32) / AMBIENT as i64) as i32;

/// Returns the number of cells of the fill valve's table per bar (2⁻¹⁶) at a supply pressure (bar gauge, 2⁻¹⁶, at least
/// 1 bar).
pub(super) const fn fill_cells_per_bar(supply_pressure: i32) -> i32 {
    let supply = supply_pressure.wrapping_add(AMBIENT) as i64;
    // The lowest bit, which keeps the divisor from zero, changes nothing.
    ((CELLS as i64) << 32).wrapping_div(supply | 1) as i32
}

/// Flow coordinate of a valve.
#[derive(Clone, Copy, Debug)]
pub(super) enum Flow {
    /// Fill valve.
    Fill {
        /// Cells of its table per bar, 2⁻¹⁶.
        cells_per_bar: i32,
    },
    /// Vent valve.
    Vent,
}

impl Flow {
    /// Returns the difference of the coordinate between two pressures (bar gauge, 2⁻¹⁶), positive along the flow.
    #[inline(always)]
    pub(super) fn between(self, from: i32, to: i32) -> i32 {
        match self {
            Self::Fill { cells_per_bar } => coordinate(&flow::FILL, cells_per_bar, to)
                .wrapping_sub(coordinate(&flow::FILL, cells_per_bar, from)),
            Self::Vent => coordinate(&flow::VENT, VENT_CELLS_PER_BAR, from)
                .wrapping_sub(coordinate(&flow::VENT, VENT_CELLS_PER_BAR, to)),
        }
    }
}

/// Returns the coordinate of the table at a pressure (bar gauge, 2⁻¹⁶), clamped to its ends.
#[inline(always)]
fn coordinate(table: &[u16; CELLS + 1], cells_per_bar: i32, pressure: i32) -> i32 {
    let absolute = pressure.wrapping_add(AMBIENT).max(0);
    // At most 2²¹ · 2²², which the shift reduces to 2²⁷.
    let place = (absolute as i64).wrapping_mul(cells_per_bar as i64) >> PLACE_BITS;
    let place = (place as i32).min(((CELLS as i32) << PLACE_BITS) - 1);
    let cell = (place >> PLACE_BITS) as usize & (CELLS - 1);
    let fraction = place & ((1 << PLACE_BITS) - 1);
    let low = i32::from(table[cell]);
    // A cell of a table is below 2¹³ high, so the product fits into a word.
    let within = i32::from(table[cell + 1])
        .wrapping_sub(low)
        .wrapping_mul(fraction);
    (low << FINER).wrapping_add(within >> (PLACE_BITS - FINER))
}

#[cfg(test)]
mod tests {
    use super::*;

    const BAR: i32 = 1 << 16;

    fn fill(supply_pressure: i32) -> Flow {
        Flow::Fill {
            cells_per_bar: fill_cells_per_bar(supply_pressure),
        }
    }

    fn seconds(flow: Flow, from: i32, to: i32) -> f64 {
        f64::from(flow.between(from, to)) / f64::from(1 << FLOW_BITS)
    }

    /// Choked filling is linear: 2 bar of 9.41325 bar absolute.
    #[test]
    fn choked_filling_takes_the_same_open_time_for_each_bar() {
        let flow = fill(8 * BAR + 26_214);
        let expected = 1.0 / 9.41325;
        for from in 0..3 {
            let found = seconds(flow, from * BAR, (from + 1) * BAR);
            assert!((found - expected).abs() < 1e-4, "{from}: {found}");
        }
    }

    /// Choked venting is exponential: ln of the ratio of absolute pressures.
    #[test]
    fn choked_venting_takes_the_logarithm_of_the_pressure_ratio() {
        for (from, to) in [(8, 6), (6, 4), (4, 2)] {
            let expected = ((f64::from(from) + 1.01325) / (f64::from(to) + 1.01325)).ln();
            let found = seconds(Flow::Vent, from * BAR, to * BAR);
            assert!(
                (found - expected).abs() < 2e-3,
                "{from}: {found} {expected}"
            );
        }
    }

    #[test]
    fn the_way_against_the_flow_is_negative_and_of_the_same_length() {
        for flow in [Flow::Vent, fill(8 * BAR)] {
            let [up, down] = [flow.between(BAR, 3 * BAR), flow.between(3 * BAR, BAR)];
            assert_eq!(up, -down);
            assert_eq!(up > 0, matches!(flow, Flow::Fill { .. }));
        }
    }

    #[test]
    fn beyond_the_supply_pressure_and_below_vacuum_there_is_no_flow() {
        let filling = fill(8 * BAR);
        assert_eq!(filling.between(9 * BAR, 15 * BAR), 0);
        assert!(filling.between(7 * BAR, 8 * BAR) > 0);
        assert_eq!(Flow::Vent.between(-BAR, -16 * BAR), 0);
        assert_eq!(filling.between(-2 * BAR, -16 * BAR), 0);
        let end = (16 << 16) - 1;
        assert!(Flow::Vent.between(end, 14 * BAR) > 0);
    }
}
