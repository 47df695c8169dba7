//! Speed of the devices in lock step, including the plant: in process, and the image in QEMU over its two wires.
//!
//! `cargo run --release -p hil-harness --example image_speed [ELF]`; without an image only in process.

use std::env;
use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

use hil_harness::ecu_under_test::EcuUnderTest;
use hil_harness::image::Image;
use hil_harness::qemu::{self, Wire};
use hil_harness::{DeviceUnderTest, InProcess, Scenario, run};

fn main() -> Result<(), Box<dyn Error>> {
    let named = env::args_os().nth(1).map(PathBuf::from);
    measure(&mut InProcess::new(), 8)?;
    if let (None, Err(missing)) = (&named, Image::find(None)) {
        println!("in process only: {missing}");
        return Ok(());
    }
    for (wire, repetitions) in [(Wire::Mailbox, 8), (Wire::Uart, 1)] {
        let emulated = qemu::start(Image::find(named.as_deref())?, wire)?;
        measure(&mut EcuUnderTest::at(emulated), repetitions)?;
    }
    Ok(())
}

fn measure(device: &mut dyn DeviceUnderTest, repetitions: u32) -> Result<(), Box<dyn Error>> {
    let scenario = Scenario::built_in("vent-requirement").ok_or("no such scenario")?;
    let start = Instant::now();
    let mut samples = 0;
    for seed in 0..repetitions {
        samples += run(&scenario.clone().seeded(seed.into()), device)?
            .exchanges
            .len();
    }
    let elapsed_s = start.elapsed().as_secs_f64();
    let simulated_s = samples as f64 * scenario.plant.ecu.sample_time_s;
    println!("{}", device.identity());
    println!(
        "  {samples} samples, {:.1} us per sample: {:.0} times faster than real time",
        1e6 * elapsed_s / samples as f64,
        simulated_s / elapsed_s
    );
    Ok(())
}
