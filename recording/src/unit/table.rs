use super::{PressureReference, Unit};
use crate::Quantity;

/// Row of the unit table: SI value = value * `times` / `over` + `offset`.
#[derive(Debug)]
pub(super) struct Entry {
    pub(super) unit: Unit,
    pub(super) token: &'static str,
    pub(super) symbol: &'static str,
    pub(super) quantity: Quantity,
    pub(super) times: f64,
    pub(super) over: f64,
    pub(super) offset: f64,
    pub(super) reference: Option<PressureReference>,
    pub(super) aliases: &'static [&'static str],
}

const fn linear(
    unit: Unit,
    token: &'static str,
    symbol: &'static str,
    quantity: Quantity,
    (times, over): (f64, f64),
    aliases: &'static [&'static str],
) -> Entry {
    Entry {
        unit,
        token,
        symbol,
        quantity,
        times,
        over,
        offset: 0.0,
        reference: None,
        aliases,
    }
}

const fn pressure(
    unit: Unit,
    token: &'static str,
    symbol: &'static str,
    reference: PressureReference,
    pascal: f64,
    aliases: &'static [&'static str],
) -> Entry {
    let entry = linear(
        unit,
        token,
        symbol,
        Quantity::Pressure,
        (pascal, 1.0),
        aliases,
    );
    Entry {
        reference: Some(reference),
        ..entry
    }
}

const fn temperature(
    unit: Unit,
    token: &'static str,
    symbol: &'static str,
    scale: (f64, f64),
    offset: f64,
    aliases: &'static [&'static str],
) -> Entry {
    Entry {
        offset,
        ..linear(unit, token, symbol, Quantity::Temperature, scale, aliases)
    }
}

use PressureReference as R;
use Quantity as Q;
use Unit as U;

/// Units in the order of the enum, so that `unit as usize` is the row (checked by a test).
#[rustfmt::skip]
pub(super) const TABLE: &[Entry] = &[
    linear(U::Second, "s", "s", Q::Time, (1.0, 1.0), &["sec", "seconds", "Sekunden", "Sek"]),
    linear(U::Millisecond, "ms", "ms", Q::Time, (1.0, 1e3), &["msec"]),
    linear(U::Microsecond, "us", "µs", Q::Time, (1.0, 1e6), &["µs", "μs"]),
    linear(U::Nanosecond, "ns", "ns", Q::Time, (1.0, 1e9), &[]),
    linear(U::Minute, "min", "min", Q::Time, (60.0, 1.0), &[]),
    linear(U::Hour, "h", "h", Q::Time, (3600.0, 1.0), &[]),
    pressure(U::PascalGauge, "Pa_gauge", "Pa gauge", R::Gauge, 1.0, &["Pa(g)", "Pa gauge"]),
    pressure(U::PascalAbsolute, "Pa_abs", "Pa abs", R::Absolute, 1.0, &["Pa(a)", "Pa abs", "Pa_absolute", "Pa absolute"]),
    pressure(U::KilopascalGauge, "kPa_gauge", "kPa gauge", R::Gauge, 1e3, &["kPa(g)", "kPa gauge", "kPa rel"]),
    pressure(U::KilopascalAbsolute, "kPa_abs", "kPa abs", R::Absolute, 1e3, &["kPa(a)", "kPa abs", "kPa_absolute", "kPa absolute"]),
    pressure(U::MegapascalGauge, "MPa_gauge", "MPa gauge", R::Gauge, 1e6, &["MPa(g)", "MPa gauge"]),
    pressure(U::MegapascalAbsolute, "MPa_abs", "MPa abs", R::Absolute, 1e6, &["MPa(a)", "MPa abs", "MPa_absolute", "MPa absolute"]),
    pressure(U::MillibarGauge, "mbar_gauge", "mbar gauge", R::Gauge, 100.0, &["mbarg", "mbar(g)", "mbar gauge", "hPa(g)", "hPa gauge", "hPa_gauge", "mbarü", "mbar rel"]),
    pressure(U::MillibarAbsolute, "mbar_abs", "mbar abs", R::Absolute, 100.0, &["mbara", "mbar(a)", "mbar abs", "mbar_absolute", "mbar absolute", "hPa(a)", "hPa abs", "hPa_abs", "hPa_absolute", "hPa absolute"]),
    pressure(U::BarGauge, "bar_gauge", "bar gauge", R::Gauge, 1e5, &["barg", "bar(g)", "bar gauge", "barü", "bar ü", "bar(ü)", "bar rel"]),
    pressure(U::BarAbsolute, "bar_abs", "bar abs", R::Absolute, 1e5, &["bara", "bar(a)", "bar abs", "bar_absolute", "bar absolute"]),
    pressure(U::PsiGauge, "psi_gauge", "psi gauge", R::Gauge, 6894.757293168361, &["psig", "psi(g)", "psi gauge"]),
    pressure(U::PsiAbsolute, "psi_abs", "psi abs", R::Absolute, 6894.757293168361, &["psia", "psi(a)", "psi abs", "psi_absolute", "psi absolute"]),
    linear(U::PascalDifference, "Pa_diff", "Pa", Q::PressureDifference, (1.0, 1.0), &[]),
    linear(U::KilopascalDifference, "kPa_diff", "kPa", Q::PressureDifference, (1e3, 1.0), &[]),
    linear(U::MillibarDifference, "mbar_diff", "mbar", Q::PressureDifference, (100.0, 1.0), &[]),
    linear(U::BarDifference, "bar_diff", "bar", Q::PressureDifference, (1e5, 1.0), &[]),
    linear(U::Ampere, "A", "A", Q::Current, (1.0, 1.0), &[]),
    linear(U::Milliampere, "mA", "mA", Q::Current, (1.0, 1e3), &[]),
    linear(U::Microampere, "uA", "µA", Q::Current, (1.0, 1e6), &["µA", "μA"]),
    linear(U::Volt, "V", "V", Q::Voltage, (1.0, 1.0), &[]),
    linear(U::Millivolt, "mV", "mV", Q::Voltage, (1.0, 1e3), &[]),
    linear(U::Percent, "pct", "%", Q::Ratio, (1.0, 100.0), &["%", "percent", "Prozent"]),
    linear(U::PerMille, "permille", "‰", Q::Ratio, (1.0, 1e3), &["‰"]),
    linear(U::Fraction, "frac", "1", Q::Ratio, (1.0, 1.0), &["fraction"]),
    linear(U::Metre, "m", "m", Q::Length, (1.0, 1.0), &[]),
    linear(U::Millimetre, "mm", "mm", Q::Length, (1.0, 1e3), &[]),
    linear(U::Micrometre, "um", "µm", Q::Length, (1.0, 1e6), &["µm", "μm"]),
    linear(U::MetrePerSecond, "m_per_s", "m/s", Q::Velocity, (1.0, 1.0), &["m/s"]),
    linear(U::MillimetrePerSecond, "mm_per_s", "mm/s", Q::Velocity, (1.0, 1e3), &["mm/s"]),
    linear(U::KilometrePerHour, "km_per_h", "km/h", Q::Velocity, (1.0, 3.6), &["km/h", "kmh"]),
    linear(U::MetrePerSecondSquared, "m_per_s2", "m/s²", Q::Acceleration, (1.0, 1.0), &["m/s2", "m/s²", "m/s^2"]),
    linear(U::SquareMetre, "m2", "m²", Q::Area, (1.0, 1.0), &["m²", "m^2"]),
    linear(U::SquareMillimetre, "mm2", "mm²", Q::Area, (1.0, 1e6), &["mm²", "mm^2"]),
    linear(U::CubicMetre, "m3", "m³", Q::Volume, (1.0, 1.0), &["m³", "m^3"]),
    linear(U::Litre, "l", "l", Q::Volume, (1.0, 1e3), &["L"]),
    linear(U::Millilitre, "ml", "ml", Q::Volume, (1.0, 1e6), &["mL", "cm3", "cm³"]),
    temperature(U::Kelvin, "K", "K", (1.0, 1.0), 0.0, &[]),
    temperature(U::DegreeCelsius, "degC", "°C", (1.0, 1.0), 273.15, &["°C", "deg_C", "celsius"]),
    temperature(U::DegreeFahrenheit, "degF", "°F", (5.0, 9.0), 459.67 * 5.0 / 9.0, &["°F", "deg_F"]),
    linear(U::Kilogram, "kg", "kg", Q::Mass, (1.0, 1.0), &[]),
    linear(U::Gram, "g", "g", Q::Mass, (1.0, 1e3), &[]),
    linear(U::Milligram, "mg", "mg", Q::Mass, (1.0, 1e6), &[]),
    linear(U::KilogramPerSecond, "kg_per_s", "kg/s", Q::MassFlow, (1.0, 1.0), &["kg/s"]),
    linear(U::GramPerSecond, "g_per_s", "g/s", Q::MassFlow, (1.0, 1e3), &["g/s"]),
    linear(U::CubicMetrePerSecond, "m3_per_s", "m³/s", Q::VolumeFlow, (1.0, 1.0), &["m3/s", "m³/s"]),
    linear(U::LitrePerMinute, "l_per_min", "l/min", Q::VolumeFlow, (1.0, 60e3), &["l/min", "L/min"]),
    linear(U::Newton, "N", "N", Q::Force, (1.0, 1.0), &[]),
    linear(U::Millinewton, "mN", "mN", Q::Force, (1.0, 1e3), &[]),
    linear(U::Kilonewton, "kN", "kN", Q::Force, (1e3, 1.0), &[]),
    linear(U::NewtonMetre, "Nm", "N m", Q::Torque, (1.0, 1.0), &["N m", "N·m", "N_m"]),
    linear(U::RadianPerSecond, "rad_per_s", "rad/s", Q::RotationalSpeed, (1.0, 1.0), &["rad/s"]),
    linear(U::RevolutionPerMinute, "rpm", "1/min", Q::RotationalSpeed, (std::f64::consts::PI, 30.0), &["1/min", "U/min", "min^-1"]),
    linear(U::Hertz, "Hz", "Hz", Q::Frequency, (1.0, 1.0), &[]),
    linear(U::Kilohertz, "kHz", "kHz", Q::Frequency, (1e3, 1.0), &[]),
    linear(U::Ohm, "ohm", "Ω", Q::Resistance, (1.0, 1.0), &["Ω", "Ohm"]),
    linear(U::Kiloohm, "kohm", "kΩ", Q::Resistance, (1e3, 1.0), &["kΩ", "kOhm"]),
    linear(U::Henry, "H", "H", Q::Inductance, (1.0, 1.0), &[]),
    linear(U::Millihenry, "mH", "mH", Q::Inductance, (1.0, 1e3), &[]),
    linear(U::VoltSecond, "Vs", "V s", Q::FluxLinkage, (1.0, 1.0), &["V s", "Wb"]),
    linear(U::MillivoltSecond, "mVs", "mV s", Q::FluxLinkage, (1.0, 1e3), &["mV s", "mWb"]),
    linear(U::Watt, "W", "W", Q::Power, (1.0, 1.0), &[]),
    linear(U::Kilowatt, "kW", "kW", Q::Power, (1e3, 1.0), &[]),
    linear(U::Joule, "J", "J", Q::Energy, (1.0, 1.0), &[]),
    linear(U::Millijoule, "mJ", "mJ", Q::Energy, (1.0, 1e3), &[]),
    linear(U::Count, "count", "count", Q::Count, (1.0, 1.0), &[]),
];
