//! Supply voltage and coil temperature in operation. The settings of the ECU are those of the nominal conditions.

use plant_sim::parameters::Part;
use plant_sim::{ParameterError, PlantParameters};

use crate::random::{Random, Stream};
use crate::scenario::Scenario;
use crate::voltage_profile::Supply;

/// Parameter of the supply voltage.
const SUPPLY_VOLTAGE: &str = "ecu.supply_voltage_v";
/// Parameter of the coil temperature: copper's resistance follows it (equation 5.7).
const COIL_TEMPERATURE: &str = "effects.coil_ambient_temperature.difference_k";
/// Temperature at which a plant file states the resistance of its coils (°C).
pub const REFERENCE_TEMPERATURE_C: f64 = 20.0;
/// Lowest and highest supply voltage of a vehicle, as shares of its nominal voltage: 18 to 32 V of 24 V (ISO 16750-2,
/// code H).
const SUPPLY_SHARES: [f64; 2] = [18.0 / 24.0, 32.0 / 24.0];
/// Lowest and highest temperature of a coil in a vehicle (°C): a cold start in winter, and a valve on a hot gearbox
/// (assumed).
pub const COIL_TEMPERATURE_RANGE_C: [f64; 2] = [-40.0, 120.0];

/// Operating conditions of a rig; `None` leaves those of its plant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OperatingConditions {
    /// Supply voltage.
    pub supply: Option<Supply>,
    /// Temperature of both coils (°C), equal to that of their surroundings.
    pub coil_temperature_c: Option<f64>,
}

impl OperatingConditions {
    /// Returns `scenario` under these conditions. The settings of its ECU stay those of the kind of rig.
    ///
    /// # Errors
    /// Returns an error if a value is out of range for its parameter of the plant.
    pub fn applied_to(&self, scenario: Scenario) -> Result<Scenario, ParameterError> {
        let mut plant = scenario.plant.clone();
        if let Some(Supply::Constant(volt)) = self.supply {
            plant
                .clone()
                .set(SUPPLY_VOLTAGE, volt, "operating condition")?;
        }
        if let Some(celsius) = self.coil_temperature_c {
            let difference_k = celsius - REFERENCE_TEMPERATURE_C;
            plant.set(COIL_TEMPERATURE, difference_k, "operating condition")?;
        }
        Ok(Scenario {
            supply: self.supply.or(scenario.supply),
            ..scenario.on_rig(plant)
        })
    }
}

/// Scatter of the operating conditions from rig to rig, uniform between two values; `None` leaves the condition of the
/// scenario on every rig.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ConditionScatter {
    /// Lowest and highest constant supply voltage (V).
    pub supply_voltage_v: Option<[f64; 2]>,
    /// Lowest and highest temperature of the coils (°C).
    pub coil_temperature_c: Option<[f64; 2]>,
}

impl ConditionScatter {
    /// Returns the conditions in a vehicle with the nominal supply voltage of `plant`; none without coils.
    pub fn vehicle(plant: &PlantParameters) -> Self {
        if !Part::Coil.is_in(plant) {
            return Self::default();
        }
        Self {
            supply_voltage_v: Some(SUPPLY_SHARES.map(|share| share * plant.ecu.supply_voltage_v)),
            coil_temperature_c: Some(COIL_TEMPERATURE_RANGE_C),
        }
    }

    /// Draws the conditions of one rig: the same seed gives the same conditions.
    pub fn draw(&self, seed: u64) -> OperatingConditions {
        let random = Random::new(seed, Stream::OperatingConditions);
        let within = |range: Option<[f64; 2]>, counter| {
            range.map(|[low, high]| {
                0.5 * (low + high) + 0.5 * (high - low) * random.symmetric(counter)
            })
        };
        OperatingConditions {
            supply: within(self.supply_voltage_v, 0).map(Supply::Constant),
            coil_temperature_c: within(self.coil_temperature_c, 1),
        }
    }
}

/// Returns the temperature of the coils of `plant` at the start (°C); none without coils.
pub fn coil_temperature_c(plant: &PlantParameters) -> Option<f64> {
    let difference_k = || plant.get(COIL_TEMPERATURE).unwrap_or(0.0);
    Part::Coil
        .is_in(plant)
        .then(|| REFERENCE_TEMPERATURE_C + difference_k())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::run_in_process;
    use crate::voltage_profile::VoltageProfile;
    use crate::{ReferenceProfile, wire};

    fn scenario() -> Scenario {
        Scenario::new(
            "one step",
            ReferenceProfile::starting_at(0.0)
                .hold_ms(100)
                .step_to(3.0)
                .hold_ms(2000),
        )
    }

    #[test]
    fn a_condition_changes_the_rig_and_not_the_settings_of_its_ecu() {
        let conditions = OperatingConditions {
            supply: Some(Supply::Constant(18.0)),
            coil_temperature_c: Some(120.0),
        };
        let changed = conditions.applied_to(scenario()).unwrap();
        assert_eq!(changed.supply, Some(Supply::Constant(18.0)));
        assert_eq!(changed.supervision, scenario().supervision);
        assert_eq!(changed.duration_samples, scenario().duration_samples);
        let resistance = changed.plant.plant().valves[0].coil.resistance;
        assert!(
            (resistance - 82.2 * (1.0 + 0.0039 * 100.0)).abs() < 1e-9,
            "{resistance} ohm"
        );
        assert_eq!(coil_temperature_c(&changed.plant), Some(120.0));
    }

    #[test]
    fn a_condition_out_of_range_names_its_parameter() {
        let at = |supply, coil_temperature_c| OperatingConditions {
            supply,
            coil_temperature_c,
        };
        for (conditions, named) in [
            (at(Some(Supply::Constant(4.9)), None), "supply_voltage_v"),
            (at(None, Some(-60.0)), "difference_k"),
        ] {
            let error = conditions.applied_to(scenario()).unwrap_err().to_string();
            assert!(error.contains(named), "{error}");
        }
    }

    /// The ECU measures the voltage of the profile, and the coils get it.
    #[test]
    fn a_voltage_profile_reaches_the_ecu_and_the_coils() {
        let load_dump = VoltageProfile::built_in("load-dump").unwrap();
        let conditions = OperatingConditions {
            supply: Some(Supply::Profile(load_dump)),
            coil_temperature_c: None,
        };
        let scenario = scenario();
        let lead_in = scenario.lead_in().samples() as usize;
        let run = run_in_process(&conditions.applied_to(scenario.clone()).unwrap()).unwrap();
        let measured_v = |sample: usize| {
            f64::from(run.exchanges[lead_in + sample].sensors.battery_mv.unwrap()) / 1e3
        };
        // Noise of 30 mV rms and steps of 16 mV.
        for sample in [0, 100] {
            let measured_v = measured_v(sample);
            assert!((measured_v - 28.0).abs() < 0.2, "{measured_v}");
        }
        assert!((measured_v(151) - 58.0).abs() < 0.2, "{}", measured_v(151));
        let plain = run_in_process(&scenario).unwrap();
        let first_opening_ma = |run: &crate::Run| {
            let currents = run.recording.signal("i_fill").unwrap().values_or_nan();
            currents
                .iter()
                .copied()
                .find(|current| *current > 1.0)
                .unwrap()
        };
        let ratio = first_opening_ma(&run) / first_opening_ma(&plain);
        assert!((ratio - 28.0 / 24.0).abs() < 0.05, "{ratio}");
        assert_eq!(wire::battery_mv(28.0), 28_000);
    }

    /// Both ranges are used up to their ends, independently of each other.
    #[test]
    fn drawn_conditions_fill_their_ranges() {
        let vehicle = ConditionScatter::vehicle(&PlantParameters::nominal());
        assert_eq!(vehicle.supply_voltage_v, Some([18.0, 32.0]));
        let draws: Vec<[f64; 2]> = (0..500)
            .map(|seed| {
                let OperatingConditions {
                    supply,
                    coil_temperature_c,
                } = vehicle.draw(seed);
                let Some(Supply::Constant(volt)) = supply else {
                    unreachable!("a scattered voltage is constant")
                };
                [volt, coil_temperature_c.unwrap()]
            })
            .collect();
        for (index, [low, high]) in [(0, [18.0, 32.0]), (1, [-40.0, 120.0])] {
            let least = draws
                .iter()
                .map(|draw| draw[index])
                .fold(f64::INFINITY, f64::min);
            let most = draws
                .iter()
                .map(|draw| draw[index])
                .fold(f64::NEG_INFINITY, f64::max);
            let margin = 0.02 * (high - low);
            assert!(least >= low && least < low + margin, "{least}");
            assert!(most <= high && most > high - margin, "{most}");
        }
        assert_eq!(
            ConditionScatter::default().draw(7),
            OperatingConditions::default()
        );
    }
}
