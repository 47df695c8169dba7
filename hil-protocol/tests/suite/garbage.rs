//! Robustness: both sides still work after any bytes.

use hil_protocol::{DeviceSession, HostSession, Request};
use proptest::prelude::*;

use crate::properties;
use crate::stepper::Stepper;

proptest! {
    #![proptest_config(ProptestConfig { cases: 2_000, ..ProptestConfig::default() })]

    #[test]
    fn garbage_is_counted_and_forgotten(bytes in prop::collection::vec(any::<u8>(), 0..3_000)) {
        let mut device = Stepper::new();
        let mut device_session = DeviceSession::new(1);
        let mut host_session = HostSession::new(3);
        host_session.open(5, true).unwrap();
        for &byte in &bytes {
            prop_assert_eq!(device_session.receive_byte(byte, &mut device), None);
            prop_assert_eq!(host_session.receive_byte(byte), Ok(None));
        }
        prop_assert_eq!(&device, &Stepper::new());
        // An incomplete end of the garbage damages at most the next frame.
        let hello = host_session.again().unwrap().to_vec();
        device_session.receive_byte(0, &mut device);
        let identity = device_session.receive_frame(&hello, &mut device).unwrap().to_vec();
        host_session.receive_byte(0).unwrap();
        prop_assert!(host_session.receive_frame(&identity).unwrap().is_some());
        prop_assert!(host_session.request(&Request::Discard).is_ok());
    }

    #[test]
    fn any_mix_of_sound_damaged_and_forged_frames_is_survived(script in prop::collection::vec(any::<u8>(), 0..400)) {
        properties::sessions(&script);
    }
}
