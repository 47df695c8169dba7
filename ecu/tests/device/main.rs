//! Parts around the ECU's logic: settings that are read, changed and saved, the black box, and the device that contains
//! them all.

mod black_box;
mod calibration;
mod device;
mod flash;
mod power_cut;
mod store;
mod support;
