//! Figures printed in the thesis, as in `measurements.toml`.

use serde::Deserialize;

/// Bundled figures.
const BUNDLED: &str = include_str!("../../data/measurements.toml");

/// All figures.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measurements {
    /// Section 1.4.
    pub requirement: Requirement,
    /// Tables 4.1 and 4.2.
    pub duty_limits_percent: DutyLimits,
    /// Sections 4.2.4 and 5.3.
    pub coil: CoilMeasurements,
    /// Tables 4.3 and 4.4, one entry per rig.
    pub filling_and_venting: Vec<FillingAndVenting>,
}

/// Requirement on the loop (section 1.4), and the unit in which times are counted.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Requirement {
    /// T_req (ECU samples).
    pub t_req_samples: u32,
    /// Longest time to fill from ambient to 0.26 P_sup (T_req).
    pub fill_0_to_026_psup_max_t_req: f64,
    /// Longest time to vent from 0.88 to 0.71 P_sup (T_req).
    pub vent_088_to_071_psup_max_t_req: f64,
    /// Range of references in operation (P_sup).
    pub operating_range_psup: [f64; 2],
    /// Deadband of the controller (bar).
    pub p_tol_bar: f64,
    /// Prediction horizon of the error prediction (samples).
    pub prediction_samples: u32,
    /// Longest time from a command to the valve's response (T_req).
    pub worst_valve_delay_t_req: f64,
    /// Command delay of the thesis' model (s).
    pub model_time_delay_s: f64,
}

/// Duty cycles at which the valves open and stay open (%).
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DutyLimits {
    /// Fill valve opens, supply pressure across it.
    pub fill_open_with_supply_pressure: f64,
    /// Fill valve opens, no pressure.
    pub fill_open_without_pressure: f64,
    /// Fill valve stays open.
    pub fill_hold: f64,
    /// Vent valve opens, supply pressure across it.
    pub vent_open_with_supply_pressure: f64,
    /// Vent valve opens, no pressure.
    pub vent_open_without_pressure: f64,
    /// Vent valve stays open.
    pub vent_hold: f64,
}

/// Coil currents (mA).
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case, reason = "the file's keys end in the unit mA")]
pub struct CoilMeasurements {
    /// Steady current at 100 %, cold (mA).
    pub current_at_100_percent_mA: f64,
    /// Current after 60 s at 100 % (mA).
    pub current_after_60_s_at_100_percent_mA: f64,
    /// Least current of the thesis' model in the steady cycle at 40 % (mA).
    pub modelled_minimum_current_at_40_percent_mA: f64,
}

/// One rig of tables 4.3 and 4.4; times exclude the dead time.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FillingAndVenting {
    /// Prototype 1 or 2.
    pub prototype: u32,
    /// Dead volume (cm³).
    pub volume_cm3: f64,
    /// Diameter of both orifices (mm).
    pub orifice_mm: f64,
    /// Dead time before filling (T_req).
    pub delay_t_req: f64,
    /// Time from ambient to 0.26 P_sup (T_req).
    pub fill_0_to_026_psup_t_req: f64,
    /// Time from 0.88 to 0.71 P_sup (T_req).
    pub vent_088_to_071_psup_t_req: f64,
    /// Time from ambient to P_sup (T_req).
    pub fill_full_t_req: f64,
    /// Time from P_sup to ambient (T_req).
    pub vent_full_t_req: f64,
}

/// Error of a measurement file that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {message}")]
pub struct MeasurementsError {
    file: String,
    message: String,
}

impl Measurements {
    /// Returns the figures printed in the thesis.
    pub fn bundled() -> Self {
        Self::from_toml(BUNDLED, "measurements.toml")
            .expect("the bundled file is checked by a test")
    }

    /// Reads a measurement file of the same form; errors call it `name`.
    pub fn from_toml(text: &str, name: &str) -> Result<Self, MeasurementsError> {
        toml::from_str(text).map_err(|error| MeasurementsError {
            file: name.to_owned(),
            message: error.to_string(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bundled_figures_are_read() {
        let figures = Measurements::bundled();
        assert_eq!(figures.filling_and_venting.len(), 4);
        assert_eq!(figures.duty_limits_percent.fill_hold, 82.0);
    }

    #[test]
    fn an_unknown_key_is_refused_with_its_place() {
        let text = BUNDLED.replace("p_tol_bar", "p_tol_psi");
        let message = Measurements::from_toml(&text, "my.toml")
            .unwrap_err()
            .to_string();
        assert!(
            message.starts_with("my.toml: ") && message.contains("p_tol_psi"),
            "{message}"
        );
    }
}
