//! Image in QEMU, the same that would be flashed, compared with the same ECU in this process: bit for bit.
//!
//! `RETARDER_IMAGE=ELF cargo nextest run -p hil-harness --features image-in-the-loop --test image_in_the_loop -j 1`
//! (`cargo xtask test` builds the image and runs it.) One test at a time: each uses two processors.

mod image;
