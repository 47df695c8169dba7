//! The very image that would be flashed, in QEMU, against the same ECU in this process: bit for bit.
//!
//! `RETARDER_IMAGE=ELF cargo nextest run -p hil-harness --features image-in-the-loop --test image_in_the_loop -j 1`
//! (`cargo xtask test` builds the image and does it). One at a time: each of them keeps two processors busy.

mod image;
