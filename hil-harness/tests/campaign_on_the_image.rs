//! Campaign on the image, the same that would be flashed, in QEMU. `RETARDER_IMAGE` names it, as in
//! `image_in_the_loop.rs`:
//!
//! `RETARDER_IMAGE=ELF cargo nextest run -p hil-harness --features image-in-the-loop --test campaign_on_the_image -j 1`

#![cfg(all(unix, feature = "image-in-the-loop"))]

use std::env;
use std::path::PathBuf;

use hil_harness::campaign::{
    EmulatedTarget, FaultClass, ImageFault, Injection, Summary, Target, run,
};

fn started() -> EmulatedTarget {
    let image = env::var_os("RETARDER_IMAGE").map(PathBuf::from);
    EmulatedTarget::start(image.as_deref()).unwrap_or_else(|error| panic!("{error}"))
}

fn campaign(classes: &[FaultClass], runs: u64) -> Summary {
    let mut target = started();
    let classes: Vec<FaultClass> = classes
        .iter()
        .copied()
        .filter(|class| target.breaks(*class))
        .collect();
    let mut summary = Summary::default();
    for index in 0..runs {
        let injection = Injection::drawn(&classes, 2026, index);
        let outcome = run(&injection, &mut target).unwrap_or_else(|error| panic!("{error}"));
        summary.add(outcome);
    }
    println!("{summary}");
    summary
}

#[test]
fn the_image_meets_every_requirement_in_a_hundred_runs_with_a_fault() {
    let classes: Vec<FaultClass> = FaultClass::all()
        .filter(|class| !matches!(class, FaultClass::Image(_)))
        .collect();
    let summary = campaign(&classes, 100);
    assert_eq!(summary.failed(), 0, "\n{summary}");
}

#[test]
fn the_image_survives_what_happens_to_itself() {
    let classes: Vec<FaultClass> = ImageFault::ALL
        .iter()
        .copied()
        .map(FaultClass::Image)
        .collect();
    let summary = campaign(&classes, 20);
    assert_eq!(summary.failed(), 0, "\n{summary}");
}
