//! Tests of the image, by subject.

mod equal_bits;
mod life;
mod settings;
mod timing;

use std::env;
use std::path::PathBuf;

use hil_harness::Compared;
use hil_harness::ecu_under_test::EcuUnderTest;
use hil_harness::image::Image;
use hil_harness::link::Framed;
use hil_harness::qemu::{self, QemuLink, Wire};
use hil_harness::{InProcess, ReferenceProfile, Scenario};

type ImageUnderTest = EcuUnderTest<Framed<QemuLink>>;

fn image() -> Image {
    let path = env::var_os("RETARDER_IMAGE").map(PathBuf::from);
    Image::find(path.as_deref()).unwrap_or_else(|error| panic!("{error}"))
}

fn started(wire: Wire) -> ImageUnderTest {
    let link = qemu::start(image(), wire).unwrap_or_else(|error| panic!("{error}"));
    EcuUnderTest::at(link)
}

fn beside_in_process(wire: Wire) -> Compared<InProcess, ImageUnderTest> {
    Compared::new(InProcess::new(), started(wire))
}

fn short_scenario() -> Scenario {
    let steps = ReferenceProfile::starting_at(0.0).hold_ms(100).step_to(3.0);
    Scenario::new("short", steps.hold_ms(1000).step_to(1.0).hold_ms(900))
}
