//! Writer of a controller file that reads back to the same bits.

use controller::fixed::types::I16F16;
use controller::{
    AntiWindup, Distributor, IntegralAtReference, LowerLimit, OpeningDuty, Prediction,
    PredictionBasis, Settings, SwitchOff,
};

use super::keys::Key;

pub(super) fn write(settings: &Settings) -> String {
    let mut file = File {
        text: "# Controller. The unit is the end of each key; numbers are kept in steps of 2^-16 of it.\n".to_owned(),
        table: "",
    };
    file.number("sample", "sample_time_ms", settings.sample_time_ms);
    pid(&mut file, settings);
    file.number("tolerance", "tolerance_bar", settings.tolerance_bar);
    prediction(&mut file, settings);
    if let Some(boost) = &settings.boost {
        file.number("boost", "rate_pct_per_bar_s", boost.rate_pct_per_bar_s);
        file.number("boost", "max_pct", boost.max_pct);
        file.number("boost", "response_bar", boost.response_bar);
    }
    distributor(&mut file, settings);
    duty_min(&mut file, settings);
    file.text
}

fn pid(file: &mut File, settings: &Settings) {
    file.number("pid", "gain_pct_per_bar", settings.gain_pct_per_bar);
    file.number_or_off("pid", "integral_time_ms", settings.integral_time_ms);
    file.number_or_off("pid", "derivative_time_ms", settings.derivative_time_ms);
    file.number("pid", "integral_max_pct", settings.integral_max_pct);
    let at_reference = match settings.integral_at_reference {
        IntegralAtReference::Hold => "hold",
        IntegralAtReference::Clear => "clear",
    };
    file.word("pid", "integral_at_reference", at_reference);
    match settings.anti_windup {
        AntiWindup::Off => file.word("pid", "anti_windup", "off"),
        AntiWindup::ConditionalIntegration => {
            file.word("pid", "anti_windup", "conditional_integration")
        }
        AntiWindup::BackCalculation { tracking_time_ms } => {
            file.word("pid", "anti_windup", "back_calculation");
            file.number("pid", "tracking_time_ms", tracking_time_ms);
        }
    }
}

fn prediction(file: &mut File, settings: &Settings) {
    let horizon = match settings.prediction {
        Prediction::Off => 0,
        Prediction::OneStep => 1,
        Prediction::TwoStep => 2,
    };
    file.value("prediction", "horizon_samples", &horizon.to_string());
    let basis = match settings.prediction_basis {
        PredictionBasis::Error => "error",
        PredictionBasis::Pressure => "pressure",
    };
    file.word("prediction", "basis", basis);
    let switch_off = match settings.switch_off {
        SwitchOff::InsideTolerance => "inside_tolerance",
        SwitchOff::InsideOrBeyond => "inside_or_beyond",
    };
    file.word("prediction", "switch_off", switch_off);
}

fn distributor(file: &mut File, settings: &Settings) {
    match settings.distributor {
        Distributor::Traditional => file.word("distributor", "scheme", "traditional"),
        Distributor::Scheme1 => file.word("distributor", "scheme", "scheme_1"),
        Distributor::Scheme2 {
            middle_fill_pct,
            middle_vent_pct,
        } => {
            file.word("distributor", "scheme", "scheme_2");
            file.number("distributor", "middle_fill_pct", middle_fill_pct);
            file.number("distributor", "middle_vent_pct", middle_vent_pct);
        }
    }
    file.number(
        "distributor",
        "duty_max_fill_pct",
        settings.duty_max_fill_pct,
    );
    file.number(
        "distributor",
        "duty_max_vent_pct",
        settings.duty_max_vent_pct,
    );
    file.number(
        "distributor",
        "supply_pressure_bar",
        settings.supply_pressure_bar,
    );
}

fn duty_min(file: &mut File, settings: &Settings) {
    match &settings.duty_min {
        LowerLimit::Constant { fill_pct, vent_pct } => {
            file.word("duty_min", "law", "constant");
            file.number("duty_min", "fill_pct", *fill_pct);
            file.number("duty_min", "vent_pct", *vent_pct);
        }
        LowerLimit::PressureDependent { fill, vent } => {
            file.word("duty_min", "law", "pressure_dependent");
            let mut opening = |keys: [&'static str; 3], opening: &OpeningDuty| {
                file.number("duty_min", keys[0], opening.without_pressure_pct);
                file.number("duty_min", keys[1], opening.at_half_pct);
                file.number("duty_min", keys[2], opening.with_supply_pressure_pct);
            };
            opening(
                [
                    "fill_without_pressure_pct",
                    "fill_at_half_supply_pressure_pct",
                    "fill_with_supply_pressure_pct",
                ],
                fill,
            );
            opening(
                [
                    "vent_without_pressure_pct",
                    "vent_at_half_supply_pressure_pct",
                    "vent_with_supply_pressure_pct",
                ],
                vent,
            );
        }
    }
}

struct File {
    text: String,
    table: &'static str,
}

impl File {
    fn number(&mut self, table: &'static str, name: &str, number: I16F16) {
        // `fixed` prints a decimal within half a step. At a tie (6553 units of 2^-16 print as 0.1, which is 6554) it
        // reads back as the neighbour. Six exact decimals distinguish all steps; f64 can represent them all.
        let short = number.to_string();
        let reads_back = short.parse::<I16F16>() == Ok(number);
        let text = if reads_back {
            short
        } else {
            format!("{:.6}", number.to_num::<f64>())
        };
        self.value(table, name, &text);
    }

    fn number_or_off(&mut self, table: &'static str, name: &str, number: Option<I16F16>) {
        match number {
            Some(number) => self.number(table, name, number),
            None => self.word(table, name, "off"),
        }
    }

    fn word(&mut self, table: &'static str, name: &str, word: &str) {
        self.value(table, name, &format!("\"{word}\""));
    }

    fn value(&mut self, table: &'static str, name: &str, value: &str) {
        if self.table != table {
            self.table = table;
            self.text.push_str(&format!("\n[{table}]\n"));
        }
        let about = Key::find(table, name).map_or("", |key| key.about);
        self.text
            .push_str(&format!("{name} = {value}   # {about}\n"));
    }
}
