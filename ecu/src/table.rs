//! Table of the settings that belong to the ECU itself; those of the controller are in `controller::Field`.
//!
//! Checking, the calibration and the table in `docs/settings.md` follow from it. CONTRIBUTING.md has the steps of a new
//! setting.

use crate::settings::{EcuSettings, Supervision, VentValve};

controller::settings_table! {
    /// Setting of the ECU that is not one of the controller: a row of the table of settings.
    EcuField of EcuSettings, number as x;

    VentValve: choice ("vent_valve" Word,
        "position of the vent valve without current",
        ecu { vent_valve }, vent_valve {
            "normally_closed" = VentValve::NormallyClosed,
            "normally_open" = VentValve::NormallyOpen,
        });
    SupplyPressureMin: number ("supply_pressure_min_bar" ["bar gauge"] "1" ..= "15",
        "the fill valve must work with this supply pressure; no rise above it is expected",
        supervision { supply_pressure_min_bar:
            EcuSettings { supervision: Supervision { supply_pressure_min_bar: x, .. }, .. } });
    SupplyPressureMax: number ("supply_pressure_max_bar" ["bar gauge"] "1" ..= "15",
        "upper bound of pressures and references",
        supervision { supply_pressure_max_bar:
            EcuSettings { supervision: Supervision { supply_pressure_max_bar: x, .. }, .. } });
    FillRate: number ("fill_rate_per_s" ["1/s"] "0.1" ..= "50",
        "dp/dt of the open fill valve over the absolute supply pressure; nominal: 1.9 mm into 75 cm³",
        supervision { fill_rate_per_s: EcuSettings { supervision: Supervision { fill_rate_per_s: x, .. }, .. } });
    VentRate: number ("vent_rate_per_s" ["1/s"] "0.1" ..= "50",
        "dp/dt of the open vent valve over the absolute chamber pressure; nominal: 1.9 mm from 75 cm³",
        supervision { vent_rate_per_s: EcuSettings { supervision: Supervision { vent_rate_per_s: x, .. }, .. } });
    OpenDutyFill: number ("open_duty_fill_pct" ["%"] "1" ..= "100",
        "the fill valve is certainly open from this duty cycle on; nominal: the opening duty cycle of 54.5 %, and a third for the scatter of springs and coils. With compensation, the duty cycle at nominal voltage and resistance",
        supervision { open_duty_fill_pct:
            EcuSettings { supervision: Supervision { open_duty_fill_pct: x, .. }, .. } });
    OpenDutyVent: number ("open_duty_vent_pct" ["%"] "1" ..= "100",
        "the vent valve is certainly open from this duty cycle on; nominal: as for the fill valve",
        supervision { open_duty_vent_pct:
            EcuSettings { supervision: Supervision { open_duty_vent_pct: x, .. }, .. } });
    ValveSettling: number ("valve_settling_ms" ["ms"] "1" ..= "1000",
        "time until a valve has certainly followed a command, at most 32 samples: command delay, PWM period, coil and armature of the slowest rig",
        supervision { valve_settling_ms: EcuSettings { supervision: Supervision { valve_settling_ms: x, .. }, .. } });
    Ramp: number ("ramp_bar_per_s" ["bar/s"] "0.1" ..= "100",
        "rate at which a fault ramps the reference down; nominal: 1.2 s from the top of the operating range, 0.71 of the supply pressure",
        supervision { ramp_bar_per_s: EcuSettings { supervision: Supervision { ramp_bar_per_s: x, .. }, .. } });
    BatteryMin: number ("battery_min_v" ["V"] "5" ..= "60",
        "lowest supply voltage of the coils; nominal: of 24 V equipment (ISO 16750-2, code F). Without compensation choose 20 V: the open duty cycles are valid down to it",
        supervision { battery_min_v: EcuSettings { supervision: Supervision { battery_min_v: x, .. }, .. } });
    BatteryMax: number ("battery_max_v" ["V"] "5" ..= "60",
        "highest supply voltage of the coils; nominal: the long-term overvoltage of 24 V equipment (ISO 16750-2). Without compensation choose 32 V",
        supervision { battery_max_v: EcuSettings { supervision: Supervision { battery_max_v: x, .. }, .. } });
    CoilCurrentMin: number ("coil_current_min_ma" ["mA"] "1" ..= "10000",
        "a driven coil takes at least this mean current; nominal: a quarter of that at 20 % and 24 V, well above the offset of a shunt",
        supervision { coil_current_min_ma:
            EcuSettings { supervision: Supervision { coil_current_min_ma: x, .. }, .. } });
    CoilCurrentMax: number ("coil_current_max_ma" ["mA"] "1" ..= "10000",
        "a healthy coil takes at most this mean current; nominal: a fifth above the 0.53 A of a coil of -40 °C at 32 V",
        supervision { coil_current_max_ma:
            EcuSettings { supervision: Supervision { coil_current_max_ma: x, .. }, .. } });
}
