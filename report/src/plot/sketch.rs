//! Sketch of a plant: supply, valves, chamber, outlet and ECU with their values, and each effect where it acts.

use plant_sim::PlantParameters;
use plant_sim::effects::EntryPoint;
use plant_sim::parameters::Part;
use plant_sim::plant::{FILL, VENT};
use plant_sim::valve::ValveFunction;
use plotters::style::RGBColor;

use super::canvas::{Align, Pixel, Sheet, figure};
use super::figure::{Figure, PlotError};
use super::palette;
use crate::number::number;

/// Centres of the columns from the supply to the outlet (px).
const SUPPLY_PX: i32 = 76;
const FILL_PX: i32 = 238;
const CHAMBER_PX: i32 = 400;
const VENT_PX: i32 = 562;
const OUTLET_PX: i32 = 724;
/// Narrower than other figures: the page shows it in a column, and its texts stay readable there.
const SKETCH_PX: i32 = 800;
/// Height of the air's path, and of the ECU (px).
const PATH_PX: i32 = 150;
const ECU_PX: i32 = 58;
const BOX_PX: Pixel = (116, 52);
const LINE_PX: i32 = 17;
const FIRST_LINE_PX: i32 = PATH_PX + 48;

/// Draws the parts of `plant` along the path of the air.
///
/// # Errors
/// Returns an error if the drawing fails.
pub(crate) fn sketch(plant: &PlantParameters) -> Result<Figure, PlotError> {
    let columns = columns(plant);
    let lines = columns.iter().map(Column::lines).max().unwrap_or(0) as i32;
    let height_px = FIRST_LINE_PX + LINE_PX * lines.max(1) + 4;
    let text = format!("The plant: {}", description(plant, &columns));
    figure(SKETCH_PX, height_px, text, |sheet| {
        let first = columns.first().map_or(SUPPLY_PX, |column| column.centre_px);
        let last = columns.last().map_or(OUTLET_PX, |column| column.centre_px);
        sheet.line([(first, PATH_PX), (last, PATH_PX)], palette::AXIS, 3.0)?;
        ecu(sheet, plant)?;
        for column in &columns {
            column.draw(sheet)?;
        }
        Ok(())
    })
}

/// Returns parts, values and effects in words.
fn description(plant: &PlantParameters, columns: &[Column]) -> String {
    let parts = columns.iter().map(|column| {
        let texts = [&column.values[..], &column.effects[..]].concat();
        format!("{}: {}", column.name, texts.join(", "))
    });
    let of_ecu = [
        ecu_values(plant),
        effects(plant, &ELECTRIC),
        effects(plant, &MECHANIC),
    ];
    let ecu = format!("ECU: {}", of_ecu.concat().join(", "));
    parts.chain([ecu]).collect::<Vec<_>>().join("; ")
}

/// Places of effects that stand left and right of the ECU: those of the coils, and those of the armatures and orifices.
const ELECTRIC: [EntryPoint; 3] = [
    EntryPoint::ElectricSupply,
    EntryPoint::Coil,
    EntryPoint::Switching,
];
const MECHANIC: [EntryPoint; 2] = [EntryPoint::Armature, EntryPoint::Flow];

/// Part of the plant with its values and effects.
struct Column {
    centre_px: i32,
    symbol: Symbol,
    name: String,
    values: Vec<String>,
    effects: Vec<String>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Symbol {
    Box,
    /// Two triangles, as in drawings of fluid power; a command comes from the ECU.
    Valve {
        colour: RGBColor,
        is_commanded: bool,
    },
}

impl Column {
    fn lines(&self) -> usize {
        self.values.len() + self.effects.len()
    }

    fn draw(&self, sheet: &Sheet<'_>) -> Result<(), PlotError> {
        let x = self.centre_px;
        match self.symbol {
            Symbol::Box => {
                rectangle(sheet, (x, PATH_PX), BOX_PX)?;
                sheet.bold_text(&self.name, (x, PATH_PX), Align::Centre)?;
            }
            Symbol::Valve {
                colour,
                is_commanded,
            } => {
                if is_commanded {
                    sheet.line([(x, ECU_PX), (x, PATH_PX)], palette::AXIS, 1.0)?;
                }
                valve(sheet, (x, PATH_PX), colour)?;
                sheet.bold_text(&self.name, (x, PATH_PX + 30), Align::Centre)?;
            }
        }
        let values = self.values.iter().map(|text| (text, palette::LABEL));
        let effects = self.effects.iter().map(|text| (text, palette::MODEL));
        for (line, (text, colour)) in (0..).zip(values.chain(effects)) {
            let at = (x, FIRST_LINE_PX + LINE_PX * line);
            sheet.text(text, at, Align::Centre, colour)?;
        }
        Ok(())
    }
}

fn columns(plant: &PlantParameters) -> Vec<Column> {
    let has_air = Part::Flow.is_in(plant);
    let gas = &plant.gas;
    let supply = has_air.then(|| Column {
        centre_px: SUPPLY_PX,
        symbol: Symbol::Box,
        name: "supply".to_owned(),
        values: vec![
            format!("{} bar gauge", number(gas.supply_pressure_bar_gauge)),
            format!("{} K", number(gas.temperature_k)),
        ],
        effects: effects(plant, &[EntryPoint::AirSupply]),
    });
    let chamber = Part::Chamber.is_in(plant).then(|| {
        let mut values = vec![format!("{} cm³", number(plant.chamber.volume_m3 * 1e6))];
        if Part::SecondChamber.is_in(plant) {
            let second_cm3 = plant.second_chamber.volume_m3 * 1e6;
            values.push(format!("second one: {} cm³", number(second_cm3)));
        }
        values.push("pressure sensor".to_owned());
        Column {
            centre_px: CHAMBER_PX,
            symbol: Symbol::Box,
            name: "chamber".to_owned(),
            values,
            effects: effects(
                plant,
                &[
                    EntryPoint::Leak,
                    EntryPoint::GasEnergy,
                    EntryPoint::Volume,
                    EntryPoint::Sensor,
                ],
            ),
        }
    });
    let outlet = has_air.then(|| Column {
        centre_px: OUTLET_PX,
        symbol: Symbol::Box,
        name: "surroundings".to_owned(),
        values: vec![format!("{} mbar", number(gas.ambient_pressure_pa / 100.0))],
        effects: effects(plant, &[EntryPoint::Drain]),
    });
    [
        supply,
        valve_column(plant, FILL),
        chamber,
        valve_column(plant, VENT),
        outlet,
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn valve_column(plant: &PlantParameters, valve: usize) -> Option<Column> {
    let function = plant.functions[valve];
    let kind = match function {
        ValveFunction::NormallyClosed => "normally closed",
        ValveFunction::NormallyOpen => "normally open",
        ValveFunction::OnOff => "on/off",
        ValveFunction::Proportional => "proportional",
        ValveFunction::AlwaysOpen => "always open",
        ValveFunction::Blocked => "coil, armature blocked",
        ValveFunction::Absent => return None,
    };
    let (centre_px, colour, name, orifice_m) = match valve {
        FILL => (
            FILL_PX,
            palette::FILL,
            "fill valve",
            plant.flow.orifice_fill_m,
        ),
        _ => (
            VENT_PX,
            palette::VENT,
            "vent valve",
            plant.flow.orifice_vent_m,
        ),
    };
    let mut values = vec![kind.to_owned()];
    if Part::OrificeOf(valve).is_in(plant) {
        values.push(format!("{} mm", number(orifice_m * 1e3)));
    }
    let conductance = match (function, valve) {
        (ValveFunction::OnOff, FILL) => Some(plant.on_off_fill.conductance_dm3_per_s_bar),
        (ValveFunction::OnOff, _) => Some(plant.on_off_vent.conductance_dm3_per_s_bar),
        (ValveFunction::Proportional, FILL) => {
            Some(plant.proportional_fill.conductance_dm3_per_s_bar)
        }
        (ValveFunction::Proportional, _) => Some(plant.proportional_vent.conductance_dm3_per_s_bar),
        _ => None,
    };
    values.extend(conductance.map(|value| format!("{} dm³/(s bar)", number(value))));
    if function.has_coil() {
        let ohm = plant.coil.resistance_20c_ohm;
        values.push(format!("{} ohm at 20 °C", number(ohm)));
    }
    Some(Column {
        centre_px,
        symbol: Symbol::Valve {
            colour,
            is_commanded: function.is_commanded(),
        },
        name: name.to_owned(),
        values,
        effects: Vec::new(),
    })
}

/// Draws the ECU above the valves; effects of both valves stand beside it.
fn ecu(sheet: &Sheet<'_>, plant: &PlantParameters) -> Result<(), PlotError> {
    if !Part::Commanded.is_in(plant) {
        return Ok(());
    }
    let commanded = |valve: usize, px| plant.functions[valve].is_commanded().then_some(px);
    for px in [commanded(FILL, FILL_PX), commanded(VENT, VENT_PX)]
        .into_iter()
        .flatten()
    {
        sheet.line([(CHAMBER_PX, ECU_PX), (px, ECU_PX)], palette::AXIS, 1.0)?;
    }
    rectangle(sheet, (CHAMBER_PX, ECU_PX), (200, 44))?;
    sheet.bold_text("ECU", (CHAMBER_PX, ECU_PX - 9), Align::Centre)?;
    let at = (CHAMBER_PX, ECU_PX + 9);
    sheet.text(
        &ecu_values(plant).join(", "),
        at,
        Align::Centre,
        palette::LABEL,
    )?;
    for (texts, x, align) in [
        (effects(plant, &ELECTRIC), FILL_PX - 12, Align::Right),
        (effects(plant, &MECHANIC), VENT_PX + 12, Align::Left),
    ] {
        for (line, text) in (0..).zip(&texts) {
            let at = (x, ECU_PX - 22 + LINE_PX * line);
            sheet.text(text, at, align, palette::MODEL)?;
        }
    }
    Ok(())
}

fn ecu_values(plant: &PlantParameters) -> Vec<String> {
    let ecu = &plant.ecu;
    let mut values = Vec::new();
    if Part::Driven.is_in(plant) && ecu.supply_voltage_v > 0.0 {
        values.push(format!("{} V", number(ecu.supply_voltage_v)));
    }
    if Part::Coil.is_in(plant) {
        values.push(format!("PWM {} Hz", number(ecu.pwm_frequency_hz)));
    }
    values.push(format!("{} ms", number(ecu.sample_time_s * 1e3)));
    values
}

/// Returns the names of the plant's effects that act at one of `places`.
fn effects(plant: &PlantParameters, places: &[EntryPoint]) -> Vec<String> {
    let acting = plant
        .effects
        .iter()
        .filter(|setting| places.contains(&setting.effect().about().acts_on));
    acting
        .map(|setting| format!("+ {}", setting.effect().about().title().to_lowercase()))
        .collect()
}

fn rectangle(sheet: &Sheet<'_>, (x, y): Pixel, (width, height): Pixel) -> Result<(), PlotError> {
    let [left, right] = [x - width / 2, x + width / 2];
    let [top, bottom] = [y - height / 2, y + height / 2];
    sheet.rectangle([(left, top), (right, bottom)], palette::AXIS)?;
    let inner = [(left + 1, top + 1), (right - 1, bottom - 1)];
    sheet.rectangle(inner, palette::BAND_OUTER)
}

fn valve(sheet: &Sheet<'_>, (x, y): Pixel, colour: RGBColor) -> Result<(), PlotError> {
    let (half_width, half_height) = (22, 15);
    for side in [-1, 1] {
        let edge = x + side * half_width;
        let outline = [(x, y), (edge, y - half_height), (edge, y + half_height)];
        sheet.polygon(&outline, colour)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use plant_sim::effects::{EffectSetting, LIBRARY};

    use super::*;

    fn svg(plant: &PlantParameters) -> String {
        sketch(plant).unwrap().inline_svg()
    }

    #[test]
    fn a_sketch_has_each_part_with_its_values() {
        let svg = svg(&PlantParameters::nominal());
        for text in [
            "8.40 bar gauge",
            "normally closed",
            "1.90 mm",
            "75 cm³",
            "24 V, PWM 100 Hz, 10 ms",
        ] {
            assert!(svg.contains(text), "{text}: {svg}");
        }
    }

    /// Goal: no effect of the library is missing from the sketch of a plant that has it.
    #[test]
    fn every_effect_stands_where_it_acts() {
        for effect in LIBRARY {
            let setting = EffectSetting::typical(effect);
            let name = format!("+ {}", effect.about().title().to_lowercase());
            let with = PlantParameters::nominal().with_effect(setting);
            assert!(svg(&with).contains(&name), "{name}");
            assert!(!svg(&PlantParameters::nominal()).contains(&name), "{name}");
        }
    }

    #[test]
    fn a_part_that_a_plant_lacks_is_not_drawn() {
        let mut plant = PlantParameters::nominal();
        plant.functions = [ValveFunction::NormallyClosed, ValveFunction::Absent];
        let svg = svg(&plant);
        assert!(
            svg.contains("fill valve") && !svg.contains("vent valve"),
            "{svg}"
        );
    }
}
