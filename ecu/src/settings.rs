//! What a person chooses, in engineering units.

use controller::Settings;
use controller::fixed::types::I16F16;

/// Everything that can be chosen about an ECU. Nothing is checked here; [`EcuConfig::new`](crate::EcuConfig::new) does that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct EcuSettings {
    /// The controller.
    pub controller: Settings,
    /// What the vent valve does without current.
    pub vent_valve: VentValve,
    /// What the supervision has to know about the rig.
    pub supervision: Supervision,
}

/// What the vent valve is without current.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum VentValve {
    /// The bench: a current opens it.
    NormallyClosed,
    /// The retarder as it is meant: a current closes it. The coil gets 100 % minus the controller's duty cycle, whose limits are
    /// then those of the share of time without current.
    NormallyOpen,
}

/// What the supervision has to know about the rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Supervision {
    /// Lowest supply pressure with which the fill valve must be able to work [bar gauge], 1 ..= 15.
    pub supply_pressure_min_bar: I16F16,
    /// Highest supply pressure [bar gauge], `supply_pressure_min_bar` ..= 15; no chamber pressure can be above it.
    pub supply_pressure_max_bar: I16F16,
    /// Rate of the open fill valve \[1/s\], 0.1 ..= 50: choked flow times gas constant and temperature, over the chamber's volume
    /// and the pressure before the valve, so that dp/dt is at most this times the absolute supply pressure.
    pub fill_rate_per_s: I16F16,
    /// Rate of the open vent valve \[1/s\], 0.1 ..= 50: the same, for the absolute chamber pressure.
    pub vent_rate_per_s: I16F16,
    /// The fill valve is open for sure from this duty cycle on [%], 1 ..= 100.
    pub open_duty_fill_pct: I16F16,
    /// The vent valve is open for sure from this duty cycle on [%], 1 ..= 100.
    pub open_duty_vent_pct: I16F16,
    /// Time from a command until the valve does it for sure: command delay, PWM period, coil and armature \[ms\], 1 ..= 1000,
    /// and at most 32 samples.
    pub valve_settling_ms: I16F16,
    /// How fast the reference is led down to zero in a fault, and up again after it [bar/s], 0.1 ..= 100.
    pub ramp_bar_per_s: I16F16,
    /// Lowest supply voltage of the ECU that can hold a valve \[V\], 5 ..= 60.
    pub battery_min_v: I16F16,
    /// Highest supply voltage of the ECU that the coils can stand \[V\], `battery_min_v` ..= 60.
    pub battery_max_v: I16F16,
    /// A driven coil takes at least this mean current \[mA\], 1 ..= 10 000; one that is off takes less.
    pub coil_current_min_ma: I16F16,
    /// No sound coil takes more than this mean current \[mA\], `coil_current_min_ma` ..= 10 000.
    pub coil_current_max_ma: I16F16,
}

impl EcuSettings {
    /// The recommended controller on the bench of the thesis.
    pub const fn bench() -> Self {
        Self {
            controller: Settings::recommended(),
            vent_valve: VentValve::NormallyClosed,
            supervision: Supervision::nominal(),
        }
    }
}

impl Supervision {
    /// The nominal plant (`data/nominal-plant.toml`): both orifices 1.9 mm, chamber 75 cm³, supply 8.4 bar gauge, 24 V.
    pub const fn nominal() -> Self {
        // Constants, so that the compiler reads the decimal text and not the target.
        const NOMINAL: Supervision = Supervision {
            supply_pressure_min_bar: I16F16::lit("7.5"),
            supply_pressure_max_bar: I16F16::lit("10"),
            fill_rate_per_s: I16F16::lit("7.13"),
            vent_rate_per_s: I16F16::lit("7.28"),
            open_duty_fill_pct: I16F16::lit("75"),
            open_duty_vent_pct: I16F16::lit("75"),
            valve_settling_ms: I16F16::lit("60"),
            ramp_bar_per_s: I16F16::lit("5"),
            battery_min_v: I16F16::lit("20"),
            battery_max_v: I16F16::lit("32"),
            coil_current_min_ma: I16F16::lit("15"),
            coil_current_max_ma: I16F16::lit("640"),
        };
        NOMINAL
    }
}
