//! Physics of the plant, compared with closed forms.

use super::orifice::{GAS_CONSTANT, HEAT_CAPACITY_RATIO};
use super::*;

const ANR_DENSITY: f64 = 1.185;
const TEMPERATURE_K: f64 = 293.15;

/// Returns a conductance (dm³/(s bar)) with a critical ratio.
fn conductance(dm3_per_s_bar: f64, critical_ratio: f64) -> Conductance {
    Conductance {
        dm3_per_s_bar,
        critical_ratio,
    }
}

/// Rigid chamber of 500 cm³ at 293.15 K with two on/off valves of 0.6 dm³/(s bar).
fn rig() -> KindRig {
    let times = SwitchingTimes {
        opening_delay_s: 6e-3,
        closing_delay_s: 5e-3,
        opening_ramp_s: 3e-3,
        closing_ramp_s: 2e-3,
    };
    let valve = ValvePart {
        open: conductance(0.6, 0.3),
        drive: Drive::OnOff(times),
    };
    KindRig {
        supply_pa: 8e5,
        ambient_pa: 1e5,
        temperature_k: TEMPERATURE_K,
        start_pa: 1e5,
        command_period_s: 20e-3,
        command_delay_s: 0.0,
        chamber_m3: 500e-6,
        walls: Walls::Rigid,
        second: None,
        valves: [valve; 2],
        actuator: Swing::constant(0.0),
        voltage: Swing::constant(NOMINAL_V),
        hidden: HiddenEffects::default(),
    }
}

/// Returns the choked mass flow (kg/s) at 20 °C from a pressure (Pa abs).
fn choked(dm3_per_s_bar: f64, pressure: f64) -> f64 {
    dm3_per_s_bar * 1e-8 * ANR_DENSITY * pressure
}

/// Runs a plant through periods with these commands (%).
fn run(plant: &mut KindPlant, rig: &KindRig, first: usize, periods: usize, commands: [f64; 2]) {
    for period in first..first + periods {
        plant.run_until(period as f64 * rig.command_period_s);
        plant.begin_period(commands);
    }
    plant.run_until((first + periods) as f64 * rig.command_period_s);
}

/// Returns the pressure (Pa abs) after a fill valve has been open for four and for five periods.
fn filled(rig: &KindRig) -> [f64; 2] {
    let mut plant = KindPlant::new(rig);
    run(&mut plant, rig, 0, 4, [100.0, 0.0]);
    let four = plant.reading().chambers_pa[0];
    run(&mut plant, rig, 4, 1, [100.0, 0.0]);
    [four, plant.reading().chambers_pa[0]]
}

#[test]
fn choked_filling_is_linear_in_time() {
    let rig = rig();
    let [four, five] = filled(&rig);
    let rate = choked(0.6, rig.supply_pa) * GAS_CONSTANT * TEMPERATURE_K / rig.chamber_m3;
    // The valve opens behind its delay, on average after half of its ramp.
    let expected = rig.start_pa + rate * (80e-3 - 6e-3 - 1.5e-3);
    assert!((four - expected).abs() < 0.1, "{four} {expected}");
    assert!((five - four - rate * 20e-3).abs() < 0.1, "{four} {five}");
}

/// Half of the force at the full difference is the pressure's: the armature moves at 0.6 and at 0.6/√2 of the final current.
#[test]
fn a_valve_without_a_pressure_difference_opens_earlier() {
    let pull_in = PullIn {
        current: 0.6,
        pressure_force: 0.5,
    };
    let expected = (1.0 - 0.6 / 2_f64.sqrt()).ln() / 0.4_f64.ln();
    assert!((pull_in.delay(0.0, NOMINAL_V) - expected).abs() < 1e-12);
    let at_18_v = (1.0 - 0.6_f64 * 24.0 / 18.0).ln() / 0.4_f64.ln();
    assert!((pull_in.delay(1.0, 18.0) - at_18_v).abs() < 1e-12);
    let mut rig = rig();
    let [_, plain] = filled(&rig);
    rig.start_pa = 0.5 * (rig.supply_pa + rig.ambient_pa);
    let [_, half_full] = filled(&rig);
    rig.hidden.pull_in = Some(pull_in);
    let [_, earlier] = filled(&rig);
    let rate = choked(0.6, rig.supply_pa) * GAS_CONSTANT * TEMPERATURE_K / rig.chamber_m3;
    let expected = half_full + rate * 6e-3 * (1.0 - pull_in.delay(0.5, NOMINAL_V));
    assert!(
        earlier > half_full && earlier < expected,
        "{earlier} {expected}"
    );
    rig.start_pa = rig.ambient_pa;
    let [_, full_difference] = filled(&rig);
    assert!((full_difference - plain).abs() < 0.1);
}

/// Without heat to the wall, the enthalpy of the inflow makes the pressure rise k times as fast.
#[test]
fn choked_filling_without_heat_is_faster_by_the_ratio_of_heat_capacities() {
    let mut rig = rig();
    let [four, five] = filled(&rig);
    rig.hidden.heat_w_per_k = Some([0.0; 2]);
    let [warm_four, warm_five] = filled(&rig);
    let ratio = (warm_five - warm_four) / (five - four);
    assert!((ratio - HEAT_CAPACITY_RATIO).abs() < 1e-6, "{ratio}");
    rig.hidden.heat_w_per_k = Some([5e3; 2]);
    let [_, isothermal] = filled(&rig);
    assert!((isothermal - five).abs() < 100.0, "{isothermal} {five}");
}

#[test]
fn the_mass_in_a_hose_is_that_of_pressure_and_volume() {
    let mut rig = rig();
    let growth = 60e-11;
    rig.walls = Walls::Hose {
        growth_m3_per_pa: growth,
    };
    let [pressure, _] = filled(&rig);
    let product = |pressure: f64| pressure * (500e-6 + growth * (pressure - rig.ambient_pa));
    let mass = (product(pressure) - product(rig.start_pa)) / (GAS_CONSTANT * TEMPERATURE_K);
    let expected = choked(0.6, rig.supply_pa) * 72.5e-3;
    assert!((mass / expected - 1.0).abs() < 1e-6, "{mass} {expected}");
}

/// The gas works on the hose: k R T ṁ = (V + k p V') dp/dt, integrated over the pressure.
#[test]
fn the_gas_that_widens_a_hose_loses_its_work() {
    let mut rig = rig();
    let growth = 60e-11;
    rig.walls = Walls::Hose {
        growth_m3_per_pa: growth,
    };
    rig.hidden.heat_w_per_k = Some([0.0; 2]);
    let [p, _] = filled(&rig);
    let (k, gauge) = (HEAT_CAPACITY_RATIO, p - rig.ambient_pa);
    let squares = p * p - rig.ambient_pa * rig.ambient_pa;
    let work = 500e-6 * gauge + 0.5 * growth * (gauge * gauge + k * squares);
    let enthalpy = k * GAS_CONSTANT * TEMPERATURE_K * choked(0.6, rig.supply_pa) * 72.5e-3;
    assert!((work / enthalpy - 1.0).abs() < 1e-6, "{work} {enthalpy}");
}

#[test]
fn two_chambers_equalise_and_keep_their_mass() {
    let mut rig = rig();
    rig.second = Some(SecondChamber {
        volume_m3: 300e-6,
        line: conductance(0.2, 0.2),
    });
    let mut plant = KindPlant::new(&rig);
    run(&mut plant, &rig, 0, 20, [100.0, 0.0]);
    run(&mut plant, &rig, 20, 2, [0.0; 2]);
    let mass = |plant: &KindPlant| {
        let [first, second] = plant.reading().chambers_pa;
        first * rig.chamber_m3 + second * 300e-6
    };
    let [first, second] = plant.reading().chambers_pa;
    assert!(first > second + 1e4, "{first} {second}");
    let before = mass(&plant);
    run(&mut plant, &rig, 22, 200, [0.0; 2]);
    let [first, second] = plant.reading().chambers_pa;
    assert!((first - second).abs() < 0.1, "{first} {second}");
    assert!((mass(&plant) / before - 1.0).abs() < 1e-12);
}

#[test]
fn a_choked_leak_decays_with_its_time_constant_at_the_far_end() {
    let mut rig = rig();
    rig.start_pa = 8e5;
    rig.hidden.leak = Some(conductance(0.01, 0.3));
    let mut plant = KindPlant::new(&rig);
    plant.run_until(10.0);
    let time_constant_s = rig.chamber_m3 / (choked(0.01, 1.0) * GAS_CONSTANT * rig.temperature_k);
    let expected = 8e5 * (-10.0 / time_constant_s).exp();
    let pressure = plant.reading().chambers_pa[0];
    assert!((pressure - expected).abs() < 0.1, "{pressure} {expected}");
    rig.second = Some(SecondChamber {
        volume_m3: 300e-6,
        line: conductance(0.2, 0.2),
    });
    let mut plant = KindPlant::new(&rig);
    plant.run_until(1.0);
    let [first, second] = plant.reading().chambers_pa;
    assert!(first > second + 100.0, "{first} {second}");
}

/// Actuator that swings by 75 mm around 100 mm.
const SWING: Swing = Swing {
    mean: 0.1,
    amplitudes: [0.05, 0.025],
    periods_s: [1.7, 0.6],
};

/// Boyle, and Poisson without heat: p V and p V^k are those of the beginning.
#[test]
fn the_gas_of_a_closed_chamber_follows_the_actuator() {
    for (heat_w_per_k, exponent) in [(None, 1.0), (Some([0.0; 2]), HEAT_CAPACITY_RATIO)] {
        let mut rig = rig();
        rig.actuator = SWING;
        rig.hidden.actuator_area_m2 = 2e-3;
        rig.hidden.heat_w_per_k = heat_w_per_k;
        rig.start_pa = 3e5;
        let mut plant = KindPlant::new(&rig);
        for end_s in [0.3, 0.9, 2.0] {
            plant.run_until(end_s);
            let reading = plant.reading();
            let volume = |position_m: f64| 500e-6 + 2e-3 * position_m;
            let ratio: f64 = volume(rig.actuator.at(0.0)) / volume(reading.position_m);
            let expected = 3e5 * ratio.powf(exponent);
            let found = reading.chambers_pa[0];
            assert!(
                (found - expected).abs() < 0.1,
                "{end_s}: {found} {expected}"
            );
        }
    }
}

/// Two choked openings in series pass the same flow at pressures by the inverse of their conductances.
#[test]
fn the_supply_droops_until_its_line_passes_the_flow_of_the_valve() {
    let mut rig = rig();
    rig.valves[0].open = conductance(0.6, 0.5);
    rig.valves[1].open = conductance(2.0, 0.3);
    rig.hidden.supply_line = Some(SupplyLine {
        restriction: conductance(0.2, 0.4),
        volume_m3: 100e-6,
    });
    let mut plant = KindPlant::new(&rig);
    assert_eq!(plant.reading().inlet_pa, rig.supply_pa);
    run(&mut plant, &rig, 0, 200, [100.0; 2]);
    let inlet = plant.reading().inlet_pa;
    assert!((inlet - rig.supply_pa / 3.0).abs() < 0.1, "{inlet}");
}

/// A rig with everything: halving the step changes no reading by 0.1 mbar.
#[test]
fn a_half_as_long_step_changes_the_pressure_by_less_than_a_tenth_of_a_millibar() {
    let mut rig = rig();
    rig.command_delay_s = 4e-3;
    rig.walls = Walls::HoseAtMost {
        growth_at_most_m3: 150e-6,
        growth_pressure_pa: 3e5,
    };
    rig.second = Some(SecondChamber {
        volume_m3: 200e-6,
        line: conductance(0.3, 0.2),
    });
    rig.valves[1].drive = Drive::Proportional(Characteristic {
        opens_at_pct: 15.0,
        quarter_shares: [0.2, 0.45, 0.72],
        time_constant_s: 10e-3,
    });
    rig.actuator = SWING;
    rig.voltage = Swing {
        mean: 23.0,
        ..SWING
    };
    rig.hidden = HiddenEffects {
        leak: Some(conductance(0.005, 0.4)),
        heat_w_per_k: Some([1.0, 0.7]),
        supply_line: Some(SupplyLine {
            restriction: conductance(0.4, 0.3),
            volume_m3: 60e-6,
        }),
        pull_in: Some(PullIn {
            current: 0.6,
            pressure_force: 0.5,
        }),
        actuator_area_m2: 1e-3,
        sensor: SensorErrors {
            offset_pa: 3e3,
            drift_pa: 5e3,
            warm_up_s: 2.0,
            lag_s: 10e-3,
        },
    };
    let mut plants = [1e-4, 5e-5].map(|step_s| KindPlant::with_step(&rig, step_s));
    for period in 0..250 {
        let step = period / 10;
        let fill = [0.0, 47.0, 100.0, 0.0, 83.0][step % 5];
        let vent = [0.0, 0.0, 0.0, 61.0, 29.0, 100.0][step % 6];
        let readings = plants.each_mut().map(|plant| {
            run(plant, &rig, period, 1, [fill, vent]);
            plant.reading()
        });
        for chamber in [0, 1] {
            let [whole, half] = readings.map(|reading| reading.chambers_pa[chamber]);
            assert!((whole - half).abs() < 10.0, "{period}: {whole} {half}");
        }
    }
}
