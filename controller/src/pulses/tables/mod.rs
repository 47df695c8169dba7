//! Tables of the nominal plants, written by the host tools (`hil-harness/src/pulse_table/`).

#[rustfmt::skip]
pub(super) mod flow;
#[rustfmt::skip]
pub(super) mod nominal_1_3_mm;
#[rustfmt::skip]
pub(super) mod nominal_1_9_mm;
