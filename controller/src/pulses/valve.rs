//! Valve of a run: its table, its flow and what was learnt about it, seen along its flow.

use crate::pulses::adaptation::{Adaptation, Bounds};
use crate::pulses::config::PulseConfig;
use crate::pulses::flow::{FLOW_BITS, Flow};
use crate::pulses::pulse_table::{Place, Slowness, ValveTable};

/// Largest open time between two pressures (µs): with it no sum overflows.
const OPEN_MAX_US: i64 = 1_000_000;

/// Valve that a run drives.
pub(super) struct DrivenValve<'a> {
    table: &'static ValveTable,
    place: Place,
    flow: Flow,
    /// Open time of the nominal valve per unit of the flow coordinate (µs).
    nominal_us: i32,
    learnt: &'a mut Adaptation,
}

impl<'a> DrivenValve<'a> {
    /// Returns the fill valve, for a run that began at `start_pressure` (bar gauge), 2⁻¹⁶.
    #[inline(always)]
    pub(super) fn fill(
        config: &PulseConfig,
        learnt: &'a mut Adaptation,
        slowness: Slowness,
        start_pressure: i32,
    ) -> Self {
        Self {
            table: &config.table().fill,
            place: Place::of(slowness, start_pressure),
            flow: Flow::Fill {
                cells_per_bar: config.fill_cells_per_bar,
            },
            nominal_us: config.fill_us,
            learnt,
        }
    }

    /// Returns the vent valve, for a run that began at `start_pressure` (bar gauge), 2⁻¹⁶.
    #[inline(always)]
    pub(super) fn vent(
        config: &PulseConfig,
        learnt: &'a mut Adaptation,
        slowness: Slowness,
        start_pressure: i32,
    ) -> Self {
        Self {
            table: &config.table().vent,
            place: Place::of(slowness, start_pressure),
            flow: Flow::Vent,
            nominal_us: config.vent_us,
            learnt,
        }
    }

    /// Returns the open time (µs) in which this valve moves the pressure between two pressures (bar gauge, 2⁻¹⁶);
    /// negative against its flow.
    #[inline(always)]
    pub(super) fn open_time(&self, from: i32, to: i32) -> i32 {
        let flow = self.flow.between(from, to);
        let nominal = (flow as i64).wrapping_mul(self.nominal_us as i64) >> FLOW_BITS;
        let nominal = nominal.clamp(-OPEN_MAX_US, OPEN_MAX_US) as i32;
        self.learnt.open_time(nominal)
    }

    /// Returns the time from the first edge of a run to its full flow (µs).
    #[inline(always)]
    pub(super) fn opening(&self) -> i32 {
        let opening = self.place.value(&self.table.opening_us);
        opening.wrapping_add(self.learnt.offset())
    }

    /// Returns the on-time (µs) of a run with this open time.
    #[inline(always)]
    pub(super) fn on_time(&self, open_us: i32) -> i32 {
        let on = self.table.on_time(self.place, open_us.max(0));
        on.wrapping_add(self.learnt.offset())
    }

    /// Returns the open time (µs) of a run of this number of full periods.
    #[inline(always)]
    pub(super) fn open_after(&self, periods: i32) -> i32 {
        let open = self.table.open_time(self.place, periods);
        open.wrapping_sub(self.learnt.offset()).max(0)
    }

    /// Follows the error of a run: its open time by the pressure, `seen_us`, and by the table, `given_us`.
    #[inline(always)]
    pub(super) fn learn(&mut self, bounds: &Bounds, seen_us: i32, given_us: i32) {
        self.learnt.learn(bounds, seen_us, given_us);
    }
}
