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

/// Factor to the unit in which values are compared: a product and a quotient, so that both are exact.
#[derive(Clone, Copy)]
struct Factor {
    times: f64,
    over: f64,
}

const ONE: Factor = ratio(1.0, 1.0);

const fn times(times: f64) -> Factor {
    ratio(times, 1.0)
}

const fn over(over: f64) -> Factor {
    ratio(1.0, over)
}

const fn ratio(times: f64, over: f64) -> Factor {
    Factor { times, over }
}

const fn linear(
    unit: Unit,
    token: &'static str,
    symbol: &'static str,
    quantity: Quantity,
    factor: Factor,
    aliases: &'static [&'static str],
) -> Entry {
    Entry {
        unit,
        token,
        symbol,
        quantity,
        times: factor.times,
        over: factor.over,
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
        times(pascal),
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
    factor: Factor,
    offset: f64,
    aliases: &'static [&'static str],
) -> Entry {
    Entry {
        offset,
        ..linear(unit, token, symbol, Quantity::Temperature, factor, aliases)
    }
}

use PressureReference as R;
use Quantity as Q;
use Unit as U;

/// Units in the order of the enum, so that `unit as usize` is the row (checked by a test).
#[rustfmt::skip]
pub(super) const TABLE: &[Entry] = &[
    linear(U::Second, "s", "s", Q::Time, ONE, &["sec", "seconds", "Sekunden", "Sek"]),
    linear(U::Millisecond, "ms", "ms", Q::Time, over(1e3), &["msec"]),
    linear(U::Microsecond, "us", "µs", Q::Time, over(1e6), &["µs", "μs"]),
    linear(U::Nanosecond, "ns", "ns", Q::Time, over(1e9), &[]),
    linear(U::Minute, "min", "min", Q::Time, times(60.0), &[]),
    linear(U::Hour, "h", "h", Q::Time, times(3600.0), &[]),
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
    linear(U::PascalDifference, "Pa_diff", "Pa", Q::PressureDifference, ONE, &[]),
    linear(U::KilopascalDifference, "kPa_diff", "kPa", Q::PressureDifference, times(1e3), &[]),
    linear(U::MillibarDifference, "mbar_diff", "mbar", Q::PressureDifference, times(100.0), &[]),
    linear(U::BarDifference, "bar_diff", "bar", Q::PressureDifference, times(1e5), &[]),
    linear(U::Ampere, "A", "A", Q::Current, ONE, &[]),
    linear(U::Milliampere, "mA", "mA", Q::Current, over(1e3), &[]),
    linear(U::Microampere, "uA", "µA", Q::Current, over(1e6), &["µA", "μA"]),
    linear(U::Volt, "V", "V", Q::Voltage, ONE, &[]),
    linear(U::Millivolt, "mV", "mV", Q::Voltage, over(1e3), &[]),
    linear(U::Percent, "pct", "%", Q::Ratio, over(100.0), &["%", "percent", "Prozent"]),
    linear(U::PerMille, "permille", "‰", Q::Ratio, over(1e3), &["‰"]),
    linear(U::Fraction, "frac", "1", Q::Ratio, ONE, &["fraction"]),
    linear(U::Metre, "m", "m", Q::Length, ONE, &[]),
    linear(U::Millimetre, "mm", "mm", Q::Length, over(1e3), &[]),
    linear(U::Micrometre, "um", "µm", Q::Length, over(1e6), &["µm", "μm"]),
    linear(U::MetrePerSecond, "m_per_s", "m/s", Q::Velocity, ONE, &["m/s"]),
    linear(U::MillimetrePerSecond, "mm_per_s", "mm/s", Q::Velocity, over(1e3), &["mm/s"]),
    linear(U::KilometrePerHour, "km_per_h", "km/h", Q::Velocity, over(3.6), &["km/h", "kmh"]),
    linear(U::MetrePerSecondSquared, "m_per_s2", "m/s²", Q::Acceleration, ONE, &["m/s2", "m/s²", "m/s^2"]),
    linear(U::SquareMetre, "m2", "m²", Q::Area, ONE, &["m²", "m^2"]),
    linear(U::SquareMillimetre, "mm2", "mm²", Q::Area, over(1e6), &["mm²", "mm^2"]),
    linear(U::CubicMetre, "m3", "m³", Q::Volume, ONE, &["m³", "m^3"]),
    linear(U::Litre, "l", "l", Q::Volume, over(1e3), &["L"]),
    linear(U::Millilitre, "ml", "ml", Q::Volume, over(1e6), &["mL", "cm3", "cm³"]),
    temperature(U::Kelvin, "K", "K", ONE, 0.0, &[]),
    temperature(U::DegreeCelsius, "degC", "°C", ONE, 273.15, &["°C", "deg_C", "celsius"]),
    temperature(U::DegreeFahrenheit, "degF", "°F", ratio(5.0, 9.0), 459.67 * 5.0 / 9.0, &["°F", "deg_F"]),
    linear(U::Kilogram, "kg", "kg", Q::Mass, ONE, &[]),
    linear(U::Gram, "g", "g", Q::Mass, over(1e3), &[]),
    linear(U::Milligram, "mg", "mg", Q::Mass, over(1e6), &[]),
    linear(U::KilogramPerSecond, "kg_per_s", "kg/s", Q::MassFlow, ONE, &["kg/s"]),
    linear(U::GramPerSecond, "g_per_s", "g/s", Q::MassFlow, over(1e3), &["g/s"]),
    linear(U::CubicMetrePerSecond, "m3_per_s", "m³/s", Q::VolumeFlow, ONE, &["m3/s", "m³/s"]),
    linear(U::LitrePerMinute, "l_per_min", "l/min", Q::VolumeFlow, over(60e3), &["l/min", "L/min"]),
    linear(U::Newton, "N", "N", Q::Force, ONE, &[]),
    linear(U::Millinewton, "mN", "mN", Q::Force, over(1e3), &[]),
    linear(U::Kilonewton, "kN", "kN", Q::Force, times(1e3), &[]),
    linear(U::NewtonMetre, "Nm", "N m", Q::Torque, ONE, &["N m", "N·m", "N_m"]),
    linear(U::RadianPerSecond, "rad_per_s", "rad/s", Q::RotationalSpeed, ONE, &["rad/s"]),
    linear(U::RevolutionPerMinute, "rpm", "1/min", Q::RotationalSpeed, ratio(std::f64::consts::PI, 30.0), &["1/min", "U/min", "min^-1"]),
    linear(U::Hertz, "Hz", "Hz", Q::Frequency, ONE, &[]),
    linear(U::Kilohertz, "kHz", "kHz", Q::Frequency, times(1e3), &[]),
    linear(U::Ohm, "ohm", "Ω", Q::Resistance, ONE, &["Ω", "Ohm"]),
    linear(U::Kiloohm, "kohm", "kΩ", Q::Resistance, times(1e3), &["kΩ", "kOhm"]),
    linear(U::Henry, "H", "H", Q::Inductance, ONE, &[]),
    linear(U::Millihenry, "mH", "mH", Q::Inductance, over(1e3), &[]),
    linear(U::VoltSecond, "Vs", "V s", Q::FluxLinkage, ONE, &["V s", "Wb"]),
    linear(U::MillivoltSecond, "mVs", "mV s", Q::FluxLinkage, over(1e3), &["mV s", "mWb"]),
    linear(U::Watt, "W", "W", Q::Power, ONE, &[]),
    linear(U::Kilowatt, "kW", "kW", Q::Power, times(1e3), &[]),
    linear(U::Joule, "J", "J", Q::Energy, ONE, &[]),
    linear(U::Millijoule, "mJ", "mJ", Q::Energy, over(1e3), &[]),
    linear(U::Count, "count", "count", Q::Count, ONE, &[]),
];
