//! Settings of an ECU, in engineering units.

use controller::Settings;
use controller::fixed::types::I16F16;

/// Settings of an ECU. Nothing is checked here; [`EcuConfig::new`](crate::EcuConfig::new) checks them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct EcuSettings {
    /// Settings of the controller.
    pub controller: Settings,
    /// Position of the vent valve without current.
    pub vent_valve: VentValve,
    /// Data of the rig for the supervision.
    pub supervision: Supervision,
}

/// Position of the vent valve without current.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum VentValve {
    /// Normally closed, as on the bench: a current opens it.
    NormallyClosed,
    /// Normally open, as intended for the retarder: a current closes it. The coil gets 100 % minus the controller's
    /// duty cycle, whose limits then are those of the share of time without current.
    NormallyOpen,
}

/// Data of the rig for the supervision. [`EcuField`](crate::EcuField) has the unit and the range of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Supervision {
    /// Lowest supply pressure with which the fill valve must be able to work (bar gauge).
    pub supply_pressure_min_bar: I16F16,
    /// Highest supply pressure (bar gauge), at least `supply_pressure_min_bar`; no chamber pressure can be above it.
    pub supply_pressure_max_bar: I16F16,
    /// Rate of the open fill valve (1/s): choked flow times gas constant and temperature, divided by the
    /// chamber's volume and the upstream pressure, so that dp/dt is at most this rate times the absolute supply
    /// pressure.
    pub fill_rate_per_s: I16F16,
    /// Rate of the open vent valve (1/s): the same, for the absolute chamber pressure.
    pub vent_rate_per_s: I16F16,
    /// Lowest duty cycle at which the fill valve is certainly open (%).
    pub open_duty_fill_pct: I16F16,
    /// Lowest duty cycle at which the vent valve is certainly open (%).
    pub open_duty_vent_pct: I16F16,
    /// Time from a command until the valve has certainly followed it (ms): command delay, PWM period, coil and
    /// armature; at most 32 samples.
    pub valve_settling_ms: I16F16,
    /// Rate at which the reference is ramped down to zero in a fault, and up again after it (bar/s).
    pub ramp_bar_per_s: I16F16,
    /// Lowest supply voltage of the ECU that can keep a valve open (V).
    pub battery_min_v: I16F16,
    /// Highest allowed supply voltage of the coils (V), at least `battery_min_v`.
    pub battery_max_v: I16F16,
    /// Minimum mean current of a driven coil (mA); a coil that is off takes less.
    pub coil_current_min_ma: I16F16,
    /// Maximum mean current of a healthy coil (mA), at least `coil_current_min_ma`.
    pub coil_current_max_ma: I16F16,
}

impl EcuSettings {
    /// Returns the settings of the recommended controller on the bench of the thesis.
    pub const fn bench() -> Self {
        Self {
            controller: Settings::recommended(),
            vent_valve: VentValve::NormallyClosed,
            supervision: Supervision::nominal(),
        }
    }
}

impl Supervision {
    /// Returns the data of the nominal plant (`data/nominal-plant.toml`): both orifices 1.9 mm, chamber 75 cm³, supply
    /// 8.4 bar gauge, 24 V.
    pub const fn nominal() -> Self {
        // Constants, so that the compiler parses the decimal text and not the target.
        const NOMINAL: Supervision = Supervision {
            supply_pressure_min_bar: I16F16::lit("7.5"),
            supply_pressure_max_bar: I16F16::lit("10"),
            fill_rate_per_s: I16F16::lit("7.13"),
            vent_rate_per_s: I16F16::lit("7.28"),
            open_duty_fill_pct: I16F16::lit("75"),
            open_duty_vent_pct: I16F16::lit("75"),
            valve_settling_ms: I16F16::lit("60"),
            ramp_bar_per_s: I16F16::lit("5"),
            battery_min_v: I16F16::lit("16"),
            battery_max_v: I16F16::lit("36"),
            coil_current_min_ma: I16F16::lit("15"),
            coil_current_max_ma: I16F16::lit("640"),
        };
        NOMINAL
    }
}
