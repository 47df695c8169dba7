//! Numerical tools that are independent of valves.

pub(crate) mod dormand_prince;
pub(crate) mod hermite;
pub(crate) mod root;
pub(crate) mod rosenbrock;
pub(crate) mod table;
