//! Short version of the example `false_alarms`, for every run of the tests.

#[path = "../examples/false_alarms/soak.rs"]
#[allow(dead_code, reason = "the example uses more of it")]
mod soak;

/// One rig of each kind, the first with a built-in profile, the last with the thesis' controller, for 800 samples each.
#[test]
fn no_detector_fires_on_a_sound_rig() {
    for from in [0, 18] {
        let alarms = soak::soak(1, from, 12, 800, || {});
        assert_eq!(alarms.total(), 0, "{alarms}");
        assert!(alarms.running > 12 * 780, "{alarms}");
    }
}
