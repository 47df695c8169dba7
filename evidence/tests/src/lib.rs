//! Tests across crates: shared tools of the tests in `tests/` and the benches.

pub mod bench_log;
pub mod blind;
pub mod chance;
#[cfg(unix)]
pub mod damage;
pub mod failed_rigs;
#[cfg(unix)]
pub mod kills;
pub mod kinds_plant;
pub mod least_squares;
pub mod plain_fit;
pub mod reference_plant;
#[cfg(unix)]
mod served;
#[cfg(unix)]
pub mod stand_in;
pub mod stiff_solver;
