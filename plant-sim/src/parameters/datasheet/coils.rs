//! Parameters of valves with coils that follow from other values of a data sheet, or are assumed where a data sheet has none.
//!
//! Without pressure, the current i₀ that just moves the armature balances the preload F, and the current i₁ that just keeps it at the end
//! of its stroke s balances preload and spring c (E7, E8, with the effective gap g):
//!
//! ```text
//! k i₀² / g² = F        k i₁² / (g - s)² = F + c s        g = s / (1 - (i₁/i₀) / √(1 + c s / F))
//! ```

use std::collections::BTreeMap;
use std::f64::consts::PI;

use crate::description::{Knowledge, PA_PER_BAR, ParameterSpec, PlantParameters};
use crate::plant::{FILL, VENT};
use crate::valve::ValveFunction;

use super::super::error::Problem;
use super::rows::{C_PER_CV, C_PER_KV, CONDUCTANCES, MILLI};
use super::stated::brief;

/// Values from which parameters follow, with the allowed range.
pub(super) static KEYS: [(&str, (f64, f64)); 12] = [
    ("coil_voltage_v", (1.0, 400.0)),
    ("coil_power_w", (0.05, 500.0)),
    ("coil_current_ma", (1.0, 1e5)),
    ("coil_time_constant_ms", (0.05, 1e3)),
    (OPENS_MA[FILL], CURRENT_MA),
    (SHUTS_MA[FILL], CURRENT_MA),
    (OPENS_MA[VENT], CURRENT_MA),
    (SHUTS_MA[VENT], CURRENT_MA),
    (OPENS_V[FILL], VOLTAGE_V),
    (SHUTS_V[FILL], VOLTAGE_V),
    (OPENS_V[VENT], VOLTAGE_V),
    (SHUTS_V[VENT], VOLTAGE_V),
];
pub(super) const OPENS_MA: [&str; 2] = ["fill_valve_opens_at_ma", "vent_valve_opens_at_ma"];
pub(super) const SHUTS_MA: [&str; 2] = ["fill_valve_shuts_at_ma", "vent_valve_shuts_at_ma"];
pub(super) const OPENS_V: [&str; 2] = ["fill_valve_opens_at_v", "vent_valve_opens_at_v"];
pub(super) const SHUTS_V: [&str; 2] = ["fill_valve_shuts_at_v", "vent_valve_shuts_at_v"];
const CURRENT_MA: (f64, f64) = (1.0, 1e5);
const VOLTAGE_V: (f64, f64) = (0.1, 400.0);

/// Uncertainty of a value that states none (%).
const USUAL_PCT: f64 = 10.0;
/// Discharge coefficient of a valve with a seat.
const DISCHARGE: Assumed = Assumed(0.9, 15.0);
/// Stroke over the diameter of the orifice: a quarter opens the whole bore.
const STROKE_SHARE: Assumed = Assumed(0.25, 25.0);
/// Diameter of the face on which the pressure acts, over that of the orifice.
const FACE_SHARE: Assumed = Assumed(1.0, 10.0);
/// Preload over the force of the supply pressure on the face: a valve has to stay shut against it.
const PRELOAD_SHARE: Assumed = Assumed(1.4, 30.0);
/// Force of the spring over the stroke, relative to the preload.
const SPRING_SHARE: Assumed = Assumed(0.4, 50.0);
/// Effective gap over the stroke, where no current of release is known.
const GAP_SHARE: Assumed = Assumed(16.0, 30.0);
/// Time constant of a coil (s): inductance over resistance.
const TIME_CONSTANT_S: Assumed = Assumed(5.4e-3, 40.0);
/// Inductance of the pulled coil over that of the released one.
const PULLED_SHARE: Assumed = Assumed(1.1, 15.0);
const MASS_KG: Assumed = Assumed(5e-3, 50.0);
const VISCOUS_FRICTION_NS_PER_M: Assumed = Assumed(1.0, 50.0);
const DIODE_V: Assumed = Assumed(0.8, 25.0);

/// Value that a data sheet rarely has, and its uncertainty (%).
struct Assumed(f64, f64);

/// Value with its uncertainty (%).
#[derive(Debug, Clone, Copy)]
pub(super) struct Stated {
    pub(super) value: f64,
    pub(super) pct: f64,
}

impl Stated {
    /// Creates the value that a data sheet states, with the uncertainty that it states.
    pub(super) fn new(value: f64, knowledge: Option<Knowledge>) -> Self {
        let pct = match knowledge {
            Some(Knowledge::Exact) => 0.0,
            Some(Knowledge::TolerancePct(pct)) => pct,
            Some(Knowledge::Tolerance(half)) => 100.0 * half / value.abs(),
            Some(Knowledge::Range(least, most)) => 50.0 * (most - least) / value.abs(),
            Some(Knowledge::Unknown) | None => USUAL_PCT,
        };
        Self { value, pct }
    }

    /// Returns the value times `factor`, which is exact.
    fn times(self, factor: f64) -> Self {
        Self {
            value: factor * self.value,
            ..self
        }
    }

    /// Returns this value times `other` to the power `exponent`, with the uncertainty of independent factors.
    fn by(self, other: Self, exponent: i32) -> Self {
        Self {
            value: self.value * other.value.powi(exponent),
            pct: self.pct.hypot(f64::from(exponent) * other.pct),
        }
    }

    fn by_assumed(self, Assumed(value, pct): Assumed) -> Self {
        self.by(Self { value, pct }, 1)
    }
}

/// Values of a data sheet from which parameters follow.
pub(super) type Sheet = BTreeMap<&'static str, Stated>;

/// Sets the parameters of valves with coils that are not `given` and follow from the values of `sheet` or are assumed. Returns those that
/// follow and are out of range.
pub(super) fn derive(
    plant: &mut PlantParameters,
    sheet: &Sheet,
    given: &mut Vec<&'static str>,
) -> Vec<Problem> {
    let mut derivation = Derivation {
        plant,
        sheet,
        given,
        problems: Vec::new(),
    };
    derivation.resistance();
    derivation.openings();
    derivation.forces();
    derivation.inductances();
    derivation.assume("armature.mass_kg", MASS_KG);
    derivation.assume(
        "armature.viscous_friction_ns_per_m",
        VISCOUS_FRICTION_NS_PER_M,
    );
    derivation.assume("ecu.free_wheel_diode_drop_v", DIODE_V);
    derivation.problems
}

struct Derivation<'a> {
    plant: &'a mut PlantParameters,
    sheet: &'a Sheet,
    given: &'a mut Vec<&'static str>,
    problems: Vec<Problem>,
}

/// Origin of a magnet or a preload.
const FROM_MOVING: &str = "from the current that moves the armature";
const RESISTANCE: &str = "coil.resistance_20c_ohm";
const STROKE: &str = "armature.stroke_m";
const FACE: &str = "armature.pressure_force_diameter_m";
const GAP: &str = "magnet.gap_closed_m";
const MAGNET: &str = "magnet.force_constant_n_m2_per_a2";
const SPRING: &str = "armature.spring_n_per_m";
const ORIFICES: [&str; 2] = ["flow.orifice_fill_m", "flow.orifice_vent_m"];
const DISCHARGES: [&str; 2] = ["flow.discharge_fill", "flow.discharge_vent"];
const PRELOADS: [&str; 2] = ["armature.preload_fill_n", "armature.preload_vent_n"];

impl Derivation<'_> {
    /// Returns the value of a parameter that is given or was derived.
    fn known(&self, name: &str) -> Option<Stated> {
        let refused = |problem: &Problem| matches!(problem, Problem::Inconsistent { key, .. } if *key == name);
        let is_given = self.given.contains(&name) && !self.problems.iter().any(refused);
        let value = self.plant.get(name).filter(|_| is_given)?;
        Some(Stated::new(value, self.plant.knowledge.get(name).copied()))
    }

    /// Sets a parameter that the plant has and that is not given. A value that is out of range counts as given, so that no assumption
    /// takes its place.
    fn set(&mut self, name: &'static str, stated: Option<Stated>, origin: &str) {
        let is_open = self.plant.get(name).is_some() && !self.given.contains(&name);
        let Some(Stated { value, pct }) = stated.filter(|_| is_open) else {
            return;
        };
        let Some(spec) = ParameterSpec::by_name(name) else {
            return;
        };
        self.given.push(name);
        if !spec.contains(value) {
            let (least, most) = spec.range;
            let value = brief(value);
            self.problems.push(Problem::Inconsistent {
                key: name,
                rule: format!(
                    "{value:e} {origin}, and not from {least:e} to {most:e}; check these values"
                ),
            });
            return;
        }
        spec.put(self.plant, brief(value));
        let known = Knowledge::TolerancePct((10.0 * pct).round() / 10.0);
        self.plant.knowledge.insert(name.to_owned(), known);
        let origin = origin.to_owned();
        self.plant.provenance.insert(name.to_owned(), origin);
    }

    fn assume(&mut self, name: &'static str, Assumed(value, pct): Assumed) {
        if self.has_coil() {
            self.set(name, Some(Stated { value, pct }), "assumed");
        }
    }

    fn has_coil(&self) -> bool {
        self.plant
            .functions
            .iter()
            .any(|function| function.has_coil())
    }

    /// Sets R = U² / P or U / I.
    fn resistance(&mut self) {
        let supply = self
            .known("ecu.supply_voltage_v")
            .map(|stated| Stated { pct: 0.0, ..stated });
        let Some(rated) = self.sheet.get("coil_voltage_v").copied().or(supply) else {
            return;
        };
        let one = Stated {
            value: 1.0,
            pct: 0.0,
        };
        let by_power = self
            .sheet
            .get("coil_power_w")
            .map(|power| one.by(rated, 2).by(*power, -1));
        self.set(RESISTANCE, by_power, "from voltage and power of the coil");
        let by_current = self.sheet.get("coil_current_ma");
        let by_current = by_current.map(|current| one.by(rated, 1).by(current.times(MILLI), -1));
        self.set(
            RESISTANCE,
            by_current,
            "from voltage and current of the coil",
        );
    }

    /// Sets orifices, discharge coefficients and stroke: choked flow through d² π/4 at the discharge coefficient 6.4 C / d², with C in
    /// dm³/(s bar) and d in mm (docs/your-rig.md).
    fn openings(&mut self) {
        for valve in [FILL, VENT] {
            let factors = [1.0, C_PER_KV, C_PER_CV];
            let mut conductances = CONDUCTANCES[valve].iter().zip(factors);
            let conductance =
                conductances.find_map(|(key, factor)| Some(self.sheet.get(key)?.times(factor)));
            if let (Some(conductance), Some(orifice)) = (conductance, self.known(ORIFICES[valve])) {
                let discharge = conductance.times(6.4).by(orifice.times(1e3), -2);
                self.set(DISCHARGES[valve], Some(discharge), "from the conductance");
            }
            if self.plant.functions[valve].has_coil() {
                let Assumed(value, pct) = DISCHARGE;
                self.set(DISCHARGES[valve], Some(Stated { value, pct }), "assumed");
            }
            if let (Some(conductance), Some(discharge)) =
                (conductance, self.known(DISCHARGES[valve]))
            {
                let square = conductance.times(6.4).by(discharge, -1);
                let orifice = Stated {
                    value: 1e-3 * square.value.sqrt(),
                    pct: 0.5 * conductance.pct,
                };
                self.set(ORIFICES[valve], Some(orifice), "from the conductance");
            }
        }
        let orifices = ORIFICES.map(|name| self.known(name));
        let larger = orifices
            .into_iter()
            .flatten()
            .max_by(|a, b| a.value.total_cmp(&b.value));
        let stroke = larger.map(|orifice| orifice.by_assumed(STROKE_SHARE));
        self.set(STROKE, stroke, "assumed: a quarter of the orifice opens it");
        let face = orifices.into_iter().flatten().next();
        self.set(
            FACE,
            face.map(|orifice| orifice.by_assumed(FACE_SHARE)),
            "assumed: the orifice",
        );
    }

    /// Sets preloads, spring, gap and magnet (E7, E8). Both valves have the same spring and magnet: those of the first one with a coil.
    fn forces(&mut self) {
        self.preloads_from_magnet();
        self.assume_fill_preload();
        let mut valves = [FILL, VENT].into_iter();
        if let Some(first) = valves.find(|&valve| self.plant.functions[valve].has_coil())
            && let (Some(preload), Some(stroke)) = (self.known(PRELOADS[first]), self.known(STROKE))
        {
            self.spring_and_gap(first, preload, stroke);
            self.magnet(first, preload);
        }
        self.preloads_from_magnet();
        self.assume_vent_preload();
    }

    /// Sets each preload whose valve moves at a known current: F = k i₀² / g². Magnet and gap belong together, so the uncertainty of the
    /// gap does not count again.
    fn preloads_from_magnet(&mut self) {
        let (Some(magnet), Some(gap)) = (self.known(MAGNET), self.known(GAP)) else {
            return;
        };
        let gap = Stated { pct: 0.0, ..gap };
        for valve in [FILL, VENT] {
            let current = self.threshold(valve, Threshold::Moves);
            let preload = current.map(|current| magnet.by(current, 2).by(gap, -2));
            self.set(PRELOADS[valve], preload, FROM_MOVING);
        }
    }

    fn assume_fill_preload(&mut self) {
        let supply = self.known("gas.supply_pressure_bar_gauge");
        if let (Some(face), Some(supply)) = (self.known(FACE), supply)
            && self.plant.functions[FILL].has_coil()
        {
            let force = supply.times(0.25 * PI * PA_PER_BAR).by(face, 2);
            let preload = force.by_assumed(PRELOAD_SHARE);
            self.set(
                PRELOADS[FILL],
                Some(preload),
                "assumed: 1.4 times the supply pressure on the face",
            );
        }
    }

    fn spring_and_gap(&mut self, valve: usize, preload: Stated, stroke: Stated) {
        let spring = preload.by_assumed(SPRING_SHARE).by(stroke, -1);
        self.set(
            SPRING,
            Some(spring),
            "assumed: 0.4 of the preload over the stroke",
        );
        let currents = self
            .threshold(valve, Threshold::Keeps)
            .zip(self.threshold(valve, Threshold::Moves));
        let gap = currents
            .zip(self.known(SPRING))
            .map(|((keeping, moving), spring)| {
                let rise = 1.0 + spring.value * stroke.value / preload.value;
                Stated {
                    value: stroke.value / (1.0 - keeping.value / moving.value / rise.sqrt()),
                    pct: stroke.pct + 2.0 * USUAL_PCT,
                }
            });
        self.set(
            GAP,
            gap,
            "from the currents that move and keep the armature",
        );
        self.set(
            GAP,
            Some(stroke.by_assumed(GAP_SHARE)),
            "assumed: 16 strokes",
        );
    }

    fn magnet(&mut self, valve: usize, preload: Stated) {
        let current = self.threshold(valve, Threshold::Moves);
        let magnet = self.known(GAP).zip(current).map(|(gap, current)| {
            let gap = Stated { pct: 0.0, ..gap };
            preload.by(gap, 2).by(current, -2)
        });
        self.set(MAGNET, magnet, FROM_MOVING);
    }

    /// Sets the preload of the vent valve, if no current of it is known, to that of the fill valve, if both are shut without current.
    fn assume_vent_preload(&mut self) {
        let is_alike = self.plant.functions == [ValveFunction::NormallyClosed; 2];
        let like_fill = self.known(PRELOADS[FILL]).filter(|_| is_alike);
        self.set(PRELOADS[VENT], like_fill, "assumed: that of the fill valve");
    }

    /// Sets L = R τ.
    fn inductances(&mut self) {
        let Some(resistance) = self.known(RESISTANCE) else {
            return;
        };
        const RELEASED: &str = "coil.inductance_closed_h";
        let measured = self.sheet.get("coil_time_constant_ms");
        let measured = measured.map(|constant| resistance.by(constant.times(MILLI), 1));
        self.set(RELEASED, measured, "from resistance and time constant");
        self.set(
            RELEASED,
            Some(resistance.by_assumed(TIME_CONSTANT_S)),
            "assumed: 5.4 ms times the resistance",
        );
        let pulled = self
            .known(RELEASED)
            .map(|released| released.by_assumed(PULLED_SHARE));
        self.set(
            "coil.inductance_open_h",
            pulled,
            "assumed: 1.1 times that of the released armature",
        );
    }

    /// Returns a current (A) of `valve` without pressure, measured or from a measured voltage.
    fn threshold(&self, valve: usize, threshold: Threshold) -> Option<Stated> {
        let is_open_at_rest = self.plant.functions[valve] == ValveFunction::NormallyOpen;
        let (ma, volt) = match is_open_at_rest == (threshold == Threshold::Keeps) {
            true => (OPENS_MA[valve], OPENS_V[valve]),
            false => (SHUTS_MA[valve], SHUTS_V[valve]),
        };
        let by_voltage = || {
            let resistance = self.known(RESISTANCE)?;
            Some(self.sheet.get(volt)?.by(resistance, -1))
        };
        let measured = self.sheet.get(ma).map(|current| current.times(MILLI));
        measured.or_else(by_voltage)
    }
}

/// Effect of a current on an armature.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Threshold {
    /// It just moves it from rest.
    Moves,
    /// It just keeps it at the end of its stroke.
    Keeps,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, Simulator};

    const COILS: &str = "
        supply_pressure_bar_gauge = 8.4
        command_frequency_hz = 100
        command_delay_ms = 15
        supply_voltage_v = 24
        chamber_volume_cm3 = 80
        coil_power_w = 7.0
        fill_valve_opens_at_ma = 206.3       # ±5 %
    ";

    /// Reference: E7 and E8, solved for the currents of the thesis' valves.
    #[test]
    fn currents_that_move_and_keep_an_armature_tell_gap_magnet_and_preload() {
        let nominal = PlantParameters::nominal();
        let (magnet, armature) = (&nominal.magnet, &nominal.armature);
        let current_ma =
            |force: f64, gap: f64| 1e3 * (force / magnet.force_constant_n_m2_per_a2).sqrt() * gap;
        let gap = magnet.gap_closed_m;
        let moves =
            [armature.preload_fill_n, armature.preload_vent_n].map(|force| current_ma(force, gap));
        let at_stroke = armature.preload_fill_n + armature.spring_n_per_m * armature.stroke_m;
        let text = format!(
            "{COILS}
            orifice_fill_mm = 1.9
            orifice_vent_mm = 1.9
            stroke_mm = 0.5
            spring_n_per_mm = 2.8
            preload_fill_n = 3.58
            vent_valve_opens_at_ma = {}
            fill_valve_shuts_at_ma = {}",
            moves[1],
            current_ma(at_stroke, gap - armature.stroke_m)
        );
        let text = text.replace("206.3 ", &format!("{} ", moves[0]));
        let plant = PlantParameters::from_datasheet(&text, "rig").unwrap();
        for name in [GAP, MAGNET, PRELOADS[VENT]] {
            let (derived, expected) = (plant.get(name).unwrap(), nominal.get(name).unwrap());
            assert!(
                (derived / expected - 1.0).abs() < 1e-6,
                "{name}: {derived} {expected}"
            );
        }
        assert!((plant.get(RESISTANCE).unwrap() - 24.0 * 24.0 / 7.0).abs() < 1e-6);
    }

    #[test]
    fn the_lines_that_every_data_sheet_has_make_a_rig_that_fills_and_vents() {
        let text = format!("{COILS}\n orifice_fill_mm = 1.9\n orifice_vent_mm = 1.9");
        let plant = PlantParameters::from_datasheet(&text, "rig").unwrap();
        assert_eq!(plant.provenance["armature.mass_kg"], "assumed");
        assert_eq!(
            plant.knowledge["armature.mass_kg"],
            Knowledge::TolerancePct(50.0)
        );
        // 30 % of the assumed preload, with the usual 10 % of supply and orifice, and 5 % of the current.
        assert!(
            matches!(plant.knowledge[MAGNET], Knowledge::TolerancePct(pct) if (40.0..80.0).contains(&pct))
        );
        let mut simulator = Simulator::new(&plant);
        let mut after = |duty_fill_pct: f64, duty_vent_pct: f64, end_ns: u64| {
            simulator.command(Command {
                duty_fill_pct,
                duty_vent_pct,
            });
            simulator.advance_to_ns(end_ns);
            simulator.sample().pressure
        };
        let (filled, vented) = (
            after(100.0, 0.0, 500_000_000),
            after(0.0, 100.0, 1_500_000_000),
        );
        assert!(filled > 9.0e5 && vented < 1.1e5, "{filled} Pa, {vented} Pa");
    }

    #[test]
    fn a_conductance_is_a_discharge_coefficient_or_an_orifice() {
        let with = |lines: &str| {
            let stated = "fill_valve = \"normally_closed\"\n vent_valve = \"normally_closed\"";
            let text = format!("{COILS}\n {stated}\n {lines}");
            PlantParameters::from_datasheet(&text, "rig").unwrap()
        };
        let plant =
            with("orifice_fill_mm = 2\n fill_C_dm3_per_s_bar = 0.5\n vent_Kv_m3_per_h = 0.1266");
        assert!((plant.flow.discharge_fill - 0.8).abs() < 1e-9);
        // 6.4 times 0.5 dm³/(s bar) over 0.9.
        let orifice_m = 1e-3 * f64::sqrt(3.2 / 0.9);
        assert!(
            (plant.flow.orifice_vent_m / orifice_m - 1.0).abs() < 1e-3,
            "{}",
            plant.flow.orifice_vent_m
        );
        // Defect seen: of two conductances of a valve with a coil, one was ignored without a word.
        let stated = "fill_valve = \"normally_closed\"\n vent_valve = \"normally_closed\"";
        let twice = format!("{COILS}\n {stated}\n fill_C_dm3_per_s_bar = 0.5\n fill_Cv = 0.1");
        let said = PlantParameters::from_datasheet(&twice, "rig").unwrap_err();
        let expected = "`fill_Cv` gives a value that another line gives as well";
        assert!(said.to_string().contains(expected), "{said}");
    }

    /// Defect seen: the critical ratio of a valve with a coil was ignored without a word; its orifice has the usual one.
    #[test]
    fn a_critical_ratio_of_a_valve_with_a_coil_is_listed_as_unused() {
        let text =
            format!("{COILS}\n orifice_fill_mm = 1.9\n orifice_vent_mm = 1.9\n fill_b = 0.3");
        let plant = PlantParameters::from_datasheet(&text, "rig").unwrap();
        let line = 1 + text
            .lines()
            .position(|line| line.contains("fill_b"))
            .unwrap();
        assert_eq!(
            plant.unused_in_datasheet(&text),
            [(line, "fill_b".to_owned())]
        );
    }

    /// Defect read: a conductance that no orifice of this size has was dropped without a word, and a usual one assumed.
    #[test]
    fn what_follows_and_is_out_of_range_is_refused() {
        for (lines, expected) in [
            (
                "fill_valve = \"normally_closed\"\n orifice_fill_mm = 1.9\n orifice_vent_mm = 1.9\n fill_C_dm3_per_s_bar = 50",
                "`flow.discharge_fill`: 8.86426593e1 from the conductance, and not from",
            ),
            (
                "orifice_fill_mm = 1.9\n orifice_vent_mm = 1.9\n fill_valve_shuts_at_ma = 400",
                "from the currents that move and keep the armature, and not from",
            ),
        ] {
            let text = format!("{COILS}\n {lines}");
            let error = PlantParameters::from_datasheet(&text, "rig").unwrap_err();
            assert_eq!(error.problems().len(), 1, "{error}");
            assert!(error.to_string().contains(expected), "{error}");
        }
    }

    #[test]
    fn what_may_be_given_instead_is_said() {
        let text = COILS
            .replace("coil_power_w = 7.0", "")
            .replace("fill_valve_opens_at_ma = 206.3", "stroke_mm = 0.5");
        let said = PlantParameters::from_datasheet(&text, "rig")
            .unwrap_err()
            .to_string();
        for part in [
            "`coil_resistance_ohm` is missing",
            "or give `coil_power_w` or `coil_current_ma`, with `coil_voltage_v`",
            "or give `fill_valve_opens_at_ma` or `fill_valve_opens_at_v`, without pressure",
            "or give `fill_C_dm3_per_s_bar`: alone for an on/off valve",
        ] {
            assert!(said.contains(part), "{part} in {said}");
        }
        let text = COILS.replace("coil_power_w = 7.0", "coil_power_w = 7e6");
        let said = PlantParameters::from_datasheet(&text, "rig")
            .unwrap_err()
            .to_string();
        assert!(
            said.contains("rig:7: `coil_power_w` = 7e6 is out of range: allowed 0.05 to 500"),
            "{said}"
        );
    }
}
