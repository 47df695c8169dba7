//! Names of modes and faults, sets of faults, error messages.

use ecu::controller::fixed::types::I16F16;
use ecu::{EcuConfig, EcuConfigError, EcuField, EcuSettings, Fault, FaultSet, Mode};

#[test]
fn a_set_of_faults_says_which() {
    let none = FaultSet::NONE;
    assert!(none.is_empty());
    assert_eq!(none.to_string(), "none");
    let two = FaultSet::of(Fault::SensorOpen).union(FaultSet::of(Fault::MemoryDamaged));
    assert_eq!(two.to_string(), "SensorOpen, MemoryDamaged");
    assert_eq!(two.bits(), 1 | 1 << 21);
    assert!(two.has_any_of(FaultSet::of(Fault::SensorOpen)));
    assert!(!two.has_any_of(FaultSet::of(Fault::SensorShort)));
    assert_eq!(
        two.difference(FaultSet::of(Fault::SensorOpen)),
        FaultSet::of(Fault::MemoryDamaged)
    );
    assert_eq!(two.union(FaultSet::of(Fault::SensorOpen)), two);
    assert!(two.iter().eq([Fault::SensorOpen, Fault::MemoryDamaged]));
}

#[test]
fn each_fault_and_each_mode_has_its_number() {
    for (number, fault) in Fault::ALL.into_iter().enumerate() {
        assert_eq!(fault as usize, number);
        assert_eq!(FaultSet::of(fault).bits(), 1 << number);
        assert_eq!(FaultSet::from_bits(1 << number), FaultSet::of(fault));
    }
    assert_eq!(
        FaultSet::from_bits(u32::MAX).iter().count(),
        Fault::ALL.len()
    );
    for (number, mode) in Mode::ALL.into_iter().enumerate() {
        assert_eq!(mode as usize, number);
    }
}

#[test]
fn what_is_out_of_range_is_refused_with_field_value_unit_and_bounds() {
    let mut settings = EcuSettings::bench();
    settings.supervision.battery_max_v = I16F16::from_num(10);
    let error = EcuConfig::new(&settings).unwrap_err();
    assert_eq!(
        error,
        EcuConfigError::OutOfRange {
            field: EcuField::BatteryMax,
            value: I16F16::from_num(10),
            min: settings.supervision.battery_min_v,
            max: I16F16::from_num(60),
        }
    );
    assert_eq!(
        error.to_string(),
        "battery_max_v = 10 V is out of range: must be 16 ..= 60 V"
    );
}
