//! List of all keys.

use controller::Field;

/// Key of a controller file.
#[derive(Debug)]
pub struct Key {
    /// TOML table.
    pub table: &'static str,
    /// TOML key, which ends in its unit.
    pub name: &'static str,
    /// Description for the user.
    pub about: &'static str,
    /// Field of the controller, if the key is a number.
    pub(super) field: Option<Field>,
}

impl Key {
    /// Returns `table.key`.
    pub fn path(&self) -> String {
        format!("{}.{}", self.table, self.name)
    }

    /// Returns the key of this path.
    pub(super) fn find(table: &str, name: &str) -> Option<&'static Self> {
        KEYS.iter()
            .find(|key| key.table == table && key.name == name)
    }
}

macro_rules! keys {
    ($($table:ident.$name:ident $(($field:ident))?, $about:literal;)*) => {
        &[$(Key {
            table: stringify!($table),
            name: stringify!($name),
            about: $about,
            field: keys!(@ $($field)?),
        }),*]
    };
    (@ $field:ident) => { Some(Field::$field) };
    (@) => { None };
}

/// All keys, in the order of a file.
pub const KEYS: &[Key] = keys! {
    sample.sample_time_ms (SampleTime), "sample time T_s, the ECU's period (equation 6.2)";

    pid.gain_pct_per_bar (Gain), "gain K: control signal per bar of error (equation 6.2)";
    pid.integral_time_ms (IntegralTime), "integral action time T_i (equation 6.2), or \"off\"";
    pid.derivative_time_ms (DerivativeTime), "derivative action time T_d (equation 6.2), or \"off\"";
    pid.integral_max_pct (IntegralMax), "bound of the integral part, also without anti-windup";
    pid.integral_at_reference, "\"hold\": the integral part is remembered when the reference is reached; \"clear\": it starts again from 0";
    pid.anti_windup, "\"off\", \"conditional_integration\" or \"back_calculation\" (section 6.5.1)";
    pid.tracking_time_ms (TrackingTime), "time constant T_t of the back-calculation";

    tolerance.tolerance_bar (Tolerance), "P_tol: both valves are off while the error is smaller (section 6.3.1)";

    prediction.horizon_samples, "how far the error is predicted: 0 is off, 1 is equation 6.8, 2 is equation 6.10";
    prediction.basis, "\"error\": its change is extrapolated (equation 6.7); \"pressure\": that of the pressure, blind to jumps of the reference";
    prediction.switch_off, "predicted errors that turn both valves off: \"inside_tolerance\" (figure 6.9) or \"inside_or_beyond\"";

    boost.rate_pct_per_bar_s (BoostRate), "rate of the extra integrator (section 6.5.3); without the table [boost] it is off";
    boost.max_pct (BoostMax), "bound of the boost";
    boost.response_bar (BoostResponse), "the pressure responds when it moves this much towards the reference in a sample";

    distributor.scheme, "\"traditional\" (6.3 to 6.5), \"scheme_1\" (section 6.3.1) or \"scheme_2\" (both valves, section 6.3.2)";
    distributor.middle_fill_pct (DutyMiddleFill), "duty cycle of the fill valve at u = 0 (Scheme 2)";
    distributor.middle_vent_pct (DutyMiddleVent), "duty cycle of the vent valve at u = 0 (Scheme 2)";
    distributor.duty_max_fill_pct (DutyMaxFill), "upper limit DC_max of the fill valve: full lift without over-magnetising (table 4.1)";
    distributor.duty_max_vent_pct (DutyMaxVent), "upper limit DC_max of the vent valve (table 4.1)";
    distributor.supply_pressure_bar (SupplyPressure), "supply pressure p_sup, gauge";

    duty_min.law, "lower limit DC_min: \"constant\" (section 6.3.1) or \"pressure_dependent\" (section 7.2)";
    duty_min.fill_pct (DutyMinFill), "lower limit of the fill valve at every pressure";
    duty_min.vent_pct (DutyMinVent), "lower limit of the vent valve at every pressure";
    duty_min.fill_without_pressure_pct (DutyMinFill), "what opens the fill valve without pressure difference (table 4.2)";
    duty_min.fill_at_half_supply_pressure_pct (DutyHalfFill), "the same at half the supply pressure; \"force_balance\" and \"linear\" compute it from the ends";
    duty_min.fill_with_supply_pressure_pct (DutyMinFillWithSupplyPressure), "the same at the full supply pressure (table 4.1)";
    duty_min.vent_without_pressure_pct (DutyMinVent), "what opens the vent valve without pressure difference (table 4.2)";
    duty_min.vent_at_half_supply_pressure_pct (DutyHalfVent), "the same at half the supply pressure, or \"force_balance\" or \"linear\"";
    duty_min.vent_with_supply_pressure_pct (DutyMinVentWithSupplyPressure), "the same at the full supply pressure (table 4.1)";
};

/// Returns all tables, in the order of a file.
pub(super) fn tables() -> Vec<&'static str> {
    let mut tables: Vec<&str> = KEYS.iter().map(|key| key.table).collect();
    tables.dedup();
    tables
}
