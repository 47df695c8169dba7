//! Tables of the model-based pulses, from a plant file by simulation (docs/equations.md, model-based pulses).
//!
//! The controller cannot read files, so its tables are Rust source: [`source`] writes it, and a test compares it with the
//! files in `controller/src/pulses/tables/`.

mod flow;
mod measured;
mod source;

pub use flow::{FLOW_CELLS, flow_table};
pub use measured::{TableError, ValveTimes, table_error};
pub use source::{flow_source, source};

use plant_sim::PlantParameters;
use plant_sim::experiment::ValveId;

use crate::scenario::{FIGURE_ORIFICE_M, REQUIRED_ORIFICE_M, with_orifices};

/// Table that is checked in.
#[derive(Debug)]
pub struct Shipped {
    /// Name of the file, without its extension.
    pub name: &'static str,
    /// Diameter of both orifices (m).
    pub orifice_m: f64,
}

/// Tables that are checked in: nominal plants with the orifices of both prototypes.
pub const SHIPPED: [Shipped; 2] = [
    Shipped {
        name: "nominal_1_9_mm",
        orifice_m: REQUIRED_ORIFICE_M,
    },
    Shipped {
        name: "nominal_1_3_mm",
        orifice_m: FIGURE_ORIFICE_M,
    },
];

impl Shipped {
    /// Returns the plant of the table.
    pub fn plant(&self) -> PlantParameters {
        with_orifices(PlantParameters::nominal(), self.orifice_m)
    }
}

/// Both valves, in the order of the tables.
pub const VALVES: [ValveId; 2] = [ValveId::Fill, ValveId::Vent];
