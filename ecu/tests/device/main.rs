//! What surrounds the ECU's logic: settings that are read, changed and kept, the black box, and the device that has them all.

mod black_box;
mod calibration;
mod device;
mod flash;
mod power_cut;
mod store;
mod support;
