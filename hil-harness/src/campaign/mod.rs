//! Fault-injection campaign: a fault occurs, and the loop has to stay safe and to recover.
//!
//! ```text
//!               Injection: class, onset, duration, times, severity, rig, seed      one line, and the run again
//!                   │
//!   World ── sense ─┴─► Sensors ──► Target ──► duties at the coils ─┬─ actuate ──► World
//!     │                   │         in process, QEMU     │          broken valves
//!     │ true pressure     │                              │
//!     └───────────────────┴────────► Oracle ◄────────────┘          safety first, then liveness
//! ```
//!
//! The verdict is formed outside the target: the [oracle](Oracle) sees the data on the wire, the duty cycles of the
//! coils and the true pressure. It has its own definition of the rules ([`bounds`]) and does not query the target.
//!
//! A class is one kind of fault; the files of this folder have one family each. An [`Injection`] alone determines a
//! run, and its line repeats it: `cargo run --release -p hil-harness --example campaign -- --reproduce '<line>'`.

pub mod bounds;
mod chance;
mod class;
mod driver;
mod ecu;
#[cfg(unix)]
mod emulated;
mod fault;
mod image;
mod injection;
mod injector;
mod link;
mod oracle;
mod plant;
mod run;
mod sensor;
mod summary;
mod target;

pub use class::{ClassError, FaultClass};
#[cfg(unix)]
pub use emulated::{EmulatedError, EmulatedTarget};
pub use fault::ecu::EcuFault;
pub use fault::image::ImageFault;
pub use fault::link::LinkFault;
pub use fault::plant::PlantFault;
pub use fault::sensor::SensorFault;
pub use injection::{Injection, InjectionError};
pub use oracle::{CampaignRequirement, Observation, Oracle, Violation};
pub use run::{CampaignError, Outcome, run, run_watched};
pub use summary::Summary;
pub use target::{Accident, Damage, InProcessTarget, Reaction, Target};
