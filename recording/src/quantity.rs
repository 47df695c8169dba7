use std::fmt;

/// Physical quantity of a signal; units convert only within one quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Quantity {
    /// Instant or duration.
    Time,
    /// Pressure relative to the atmosphere (gauge) or to vacuum (absolute), as defined by the unit.
    Pressure,
    /// Difference of two pressures, such as a residual: neither gauge nor absolute.
    PressureDifference,
    /// Electric current.
    Current,
    /// Electric voltage.
    Voltage,
    /// Share of a PWM period in which a valve is energised, 0 to 100 %.
    DutyCycle,
    /// Any other ratio, such as the control signal u of -100 to 100 %.
    Ratio,
    /// Length or position.
    Length,
    /// Velocity.
    Velocity,
    /// Acceleration.
    Acceleration,
    /// Area.
    Area,
    /// Volume.
    Volume,
    /// Temperature.
    Temperature,
    /// Mass.
    Mass,
    /// Mass per time.
    MassFlow,
    /// Volume per time.
    VolumeFlow,
    /// Force.
    Force,
    /// Torque.
    Torque,
    /// Angular velocity.
    RotationalSpeed,
    /// Frequency.
    Frequency,
    /// Electric resistance.
    Resistance,
    /// Inductance.
    Inductance,
    /// Flux linkage of a coil.
    FluxLinkage,
    /// Power.
    Power,
    /// Energy.
    Energy,
    /// A number of things, such as valve actuations or a state code.
    Count,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Time => "time",
            Self::Pressure => "pressure",
            Self::PressureDifference => "pressure difference",
            Self::Current => "current",
            Self::Voltage => "voltage",
            Self::DutyCycle => "duty cycle",
            Self::Ratio => "ratio",
            Self::Length => "length",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Area => "area",
            Self::Volume => "volume",
            Self::Temperature => "temperature",
            Self::Mass => "mass",
            Self::MassFlow => "mass flow",
            Self::VolumeFlow => "volume flow",
            Self::Force => "force",
            Self::Torque => "torque",
            Self::RotationalSpeed => "rotational speed",
            Self::Frequency => "frequency",
            Self::Resistance => "resistance",
            Self::Inductance => "inductance",
            Self::FluxLinkage => "flux linkage",
            Self::Power => "power",
            Self::Energy => "energy",
            Self::Count => "count",
        })
    }
}
