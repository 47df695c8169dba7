//! Every effect at every size, with and without supply: a simulation comes to an end, in a number of steps that is known.

use plant_sim::effects::{Effect, EffectSetting, LIBRARY, Variant};
use plant_sim::{Command, PlantParameters, Simulator};

/// Most work in a simulated second: steps, repeated ones and formulas.
const MOST_WORK_PER_SECOND: u64 = 500_000;
/// Simulated time of a run (ns), and the time for which its duty cycles hold.
const RUN_NS: u64 = 80_000_000;
const HOLD_NS: u64 = 20_000_000;

/// Duty cycles that take turns: at rest, one valve open or pulsed, both, everything.
const PATTERNS: [(&str, &[(f64, f64)]); 5] = [
    ("rest", &[(0.0, 0.0)]),
    ("fill pulsed", &[(75.0, 0.0)]),
    ("vent open", &[(0.0, 100.0)]),
    ("both open", &[(100.0, 100.0)]),
    (
        "in turns",
        &[(100.0, 0.0), (0.0, 100.0), (45.0, 50.0), (0.0, 0.0)],
    ),
];

/// The variant at shares and multiples of its typical size, and each value alone at the ends of its range.
fn sizes(effect: &'static dyn Effect, variant: &'static Variant) -> Vec<EffectSetting> {
    let typical = EffectSetting::typical_variant(effect, variant);
    let scaled = [0.02, 0.3, 1.0, 5.0].map(|factor| {
        let mut setting = typical.clone();
        for (value, spec) in setting.values_mut().iter_mut().zip(variant.parameters) {
            *value = (*value * factor).clamp(spec.range.0, spec.range.1);
        }
        setting
    });
    let at_end = |spec: &&'static plant_sim::parameters::ParameterSpec| {
        let (least, most) = spec.range;
        [least, most].map(|end| typical.clone().with(spec.key, end))
    };
    let ends = variant.parameters.iter().flat_map(at_end);
    scaled.into_iter().chain(ends).collect()
}

/// What is wrong with a run on a grid of `row_ns`; none where it keeps the bound.
fn complaint(plant: &PlantParameters, duties: &[(f64, f64)], row_ns: u64) -> Option<String> {
    let mut simulator = Simulator::new(plant);
    simulator.set_work_limit(MOST_WORK_PER_SECOND * RUN_NS / 1_000_000_000);
    for time_ns in (0..=RUN_NS).step_by(row_ns as usize) {
        simulator.advance_to_ns(time_ns);
        let turn = (time_ns / HOLD_NS) as usize;
        let (duty_fill_pct, duty_vent_pct) = duties[turn % duties.len()];
        simulator.command(Command {
            duty_fill_pct,
            duty_vent_pct,
        });
        let pressure = simulator.sample().measured_pressure;
        if simulator.is_given_up() || !pressure.is_finite() {
            return Some(format!(
                "{pressure} Pa, {:?} until {time_ns} ns",
                simulator.statistics()
            ));
        }
    }
    None
}

/// A leak sized by a supply that is shut off leaked 0/0, and the solver looked for a step without error for ever.
#[test]
fn every_effect_at_every_size_takes_a_bounded_number_of_steps() {
    let mut complaints = Vec::new();
    for supply_pressure_bar_gauge in [0.0, 1e-3, 8.4] {
        let mut plain = PlantParameters::nominal();
        plain.gas.supply_pressure_bar_gauge = supply_pressure_bar_gauge;
        for effect in LIBRARY {
            for variant in effect.about().variants {
                for setting in sizes(effect, variant) {
                    let plant = plain.with_effect(setting);
                    for (pattern, duties) in PATTERNS {
                        for row_ns in [500_000, 10_000_000] {
                            let found = complaint(&plant, duties, row_ns);
                            complaints.extend(found.map(|found| {
                                let setting = &plant.effects[0];
                                format!(
                                    "{supply_pressure_bar_gauge} bar, {} as {} {:?}, {pattern}, rows of {row_ns} ns: {found}",
                                    setting.id(),
                                    variant.name,
                                    setting.values()
                                )
                            }));
                        }
                    }
                }
            }
        }
    }
    assert!(complaints.is_empty(), "{complaints:#?}");
}
