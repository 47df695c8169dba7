//! Healthy rigs in closed loop with the whole ECU, and the alarms of its detectors.

use std::fmt;

use ecu::controller::{Pressure, Settings};
use ecu::{Ecu, EcuConfig, EcuSettings, Fault, FaultSet, Inputs, Mode, ResetCause};
use hil_harness::random::{Random, Stream};
use hil_harness::scenario::BUILT_IN;
use hil_harness::sensor::code;
use hil_harness::supervision::{supervision, vent_valve};
use hil_harness::wire::{battery_mv, current_ma, reference_bits};
use hil_harness::{ReferenceProfile, scattered};
use plant_sim::{Command, PlantParameters, Simulator};

/// Number of samples on one rig: a minute.
pub(crate) const RIG_SAMPLES: u32 = 6000;
/// Noise of the pressure sensor (data/README.md).
const PRESSURE_NOISE_PA: f64 = 400.0;
/// Noise of the current and the voltage (data/README.md).
const CURRENT_NOISE_A: f64 = 0.7e-3;
const VOLTAGE_NOISE_V: f64 = 20e-3;
/// Kinds of rigs: orifices (m) and chambers (m³) of the thesis' prototypes (sections 2.2 and 6.4.2).
const ORIFICES_M: [f64; 2] = [1.3e-3, 1.9e-3];
const VOLUMES_M3: [f64; 3] = [50e-6, 75e-6, 125e-6];
const KINDS: u32 = 6;
/// Battery voltage of a 24 V truck: from a nearly empty one during starting to a charged one.
const BATTERY_V: [f64; 2] = [22.0, 30.0];

/// Alarms of the detectors on healthy rigs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Alarms {
    pub(crate) rigs: u32,
    pub(crate) samples: u64,
    /// Number of samples in which the loop ran.
    pub(crate) running: u64,
    /// Confirmed faults, by the number of the fault.
    pub(crate) by_fault: [u32; Fault::ALL.len()],
    /// Rig and sample of the first alarm.
    pub(crate) first: Option<(u32, u32, Fault)>,
}

impl Alarms {
    pub(crate) fn total(&self) -> u32 {
        self.by_fault.iter().sum()
    }

    #[must_use]
    pub(crate) fn with(mut self, other: &Self) -> Self {
        self.rigs += other.rigs;
        self.samples += other.samples;
        self.running += other.running;
        for (count, more) in self.by_fault.iter_mut().zip(other.by_fault) {
            *count += more;
        }
        self.first = self.first.or(other.first);
        self
    }
}

impl fmt::Display for Alarms {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            rigs,
            samples,
            running,
            ..
        } = self;
        writeln!(
            f,
            "{samples} samples on {rigs} sound rigs, {running} of them in Running"
        )?;
        for (fault, count) in Fault::ALL.into_iter().zip(self.by_fault) {
            writeln!(f, "{count:6} {fault:?}")?;
        }
        if let Some((rig, sample, fault)) = self.first {
            writeln!(f, "first: {fault:?} on rig {rig} in sample {sample}")?;
        }
        write!(f, "{:6} false alarms", self.total())
    }
}

/// Runs rigs `from..from + count` of a soak, each for `samples`; reports after each.
pub(crate) fn soak(
    seed: u64,
    from: u32,
    count: u32,
    samples: u32,
    mut report: impl FnMut(),
) -> Alarms {
    let mut alarms = Alarms::default();
    for rig in from..from + count {
        alarms = alarms.with(&Rig::new(seed, rig).run(rig, samples));
        report();
    }
    alarms
}

/// One rig with its ECU and its driver.
struct Rig {
    simulator: Simulator,
    ecu: Ecu,
    reference: ReferenceProfile,
    battery_v: f64,
    noise: [Random; 4],
}

impl Rig {
    fn new(seed: u64, rig: u32) -> Self {
        let chance = Random::new(
            Random::new(seed, Stream::RigSeed).bits(rig.into()),
            Stream::RigScatter,
        );
        let kind = kind(rig);
        let plant = scattered(&kind, chance.bits(0)).expect("a scattered rig is one");
        let settings = EcuSettings {
            controller: if (rig / KINDS) % 4 == 3 {
                Settings::thesis()
            } else {
                Settings::recommended()
            },
            vent_valve: vent_valve(&kind),
            supervision: supervision(&kind),
        };
        let config = EcuConfig::new(&settings).expect("settings of a sound rig");
        let mut simulator = Simulator::new(&plant);
        let [low, high] = BATTERY_V;
        let battery_v = low + (high - low) * uniform(&chance, 1);
        simulator.set_supply_voltage(battery_v);
        let stream = |number: u64| Random::new(chance.bits(10 + number), Stream::SensorNoise);
        Self {
            simulator,
            ecu: Ecu::new(config, ResetCause::PowerOn),
            reference: if (rig / KINDS).is_multiple_of(8) {
                let built_in = &BUILT_IN[rig as usize % BUILT_IN.len()];
                built_in.scenario().reference
            } else {
                random_profile(&Random::new(chance.bits(2), Stream::RigScatter))
            },
            battery_v,
            noise: [stream(0), stream(1), stream(2), stream(3)],
        }
    }

    fn run(mut self, rig: u32, samples: u32) -> Alarms {
        let mut alarms = Alarms {
            rigs: 1,
            ..Alarms::default()
        };
        let mut before = FaultSet::NONE;
        for sample in 0..samples {
            let inputs = self.sense(sample);
            let outputs = self.ecu.sample(&inputs);
            self.simulator.command(Command {
                duty_fill_pct: outputs.duty_fill.percent().to_num(),
                duty_vent_pct: outputs.duty_vent.percent().to_num(),
            });
            self.simulator
                .advance_to_ns(u64::from(sample + 1) * SAMPLE_NS);
            alarms.samples += 1;
            alarms.running += u64::from(self.ecu.mode() == Mode::Running);
            for fault in self.ecu.faults().difference(before).iter() {
                alarms.by_fault[fault as usize] += 1;
                alarms.first = alarms.first.or(Some((rig, sample, fault)));
            }
            before = self.ecu.faults();
        }
        alarms
    }

    fn sense(&mut self, sample: u32) -> Inputs {
        let shown = self.simulator.sample();
        let noise = |stream: usize, rms: f64| rms * self.noise[stream].normal(sample.into());
        let reference_bar = match sample.checked_sub(LEAD_IN_SAMPLES) {
            Some(sample) => self.reference.at_ns(u64::from(sample) * SAMPLE_NS),
            None => 0.0,
        };
        let current = |valve: usize| {
            let ampere = shown.mean_current[valve] + noise(1 + valve, CURRENT_NOISE_A);
            Some(current_ma(ampere))
        };
        Inputs {
            elapsed_us: 10_000,
            reference: Some(Pressure::from_bits(reference_bits(reference_bar))),
            pressure: Some(code(shown.pressure + noise(0, PRESSURE_NOISE_PA))),
            current_fill_ma: current(0),
            current_vent_ma: current(1),
            battery_mv: Some(battery_mv(self.battery_v + noise(3, VOLTAGE_NOISE_V))),
        }
    }
}

const SAMPLE_NS: u64 = 10_000_000;
/// Number of samples with a reference of zero, before which the ECU fills nothing.
const LEAD_IN_SAMPLES: u32 = 20;

fn kind(rig: u32) -> PlantParameters {
    let rig = rig as usize;
    let orifice_m = ORIFICES_M[rig % ORIFICES_M.len()];
    let volume_m3 = VOLUMES_M3[(rig / ORIFICES_M.len()) % VOLUMES_M3.len()];
    let mut kind = PlantParameters::nominal();
    for (key, value) in [
        ("flow.orifice_fill_m", orifice_m),
        ("flow.orifice_vent_m", orifice_m),
        ("chamber.volume_m3", volume_m3),
    ] {
        kind.set(key, value, "kind of the rig")
            .expect("a prototype");
    }
    kind
}

/// Returns steps and ramps between 0 and 8 bar, small and large, with rests of a tenth of a second to four seconds.
fn random_profile(chance: &Random) -> ReferenceProfile {
    let mut profile = ReferenceProfile::starting_at(0.0);
    let mut level_bar: f64 = 0.0;
    let mut draw = 0;
    let mut next = || {
        draw += 1;
        uniform(chance, draw)
    };
    while profile.end_ns() < u64::from(RIG_SAMPLES) * SAMPLE_NS {
        level_bar = match (6.0 * next()) as u32 {
            0 => 0.0,
            1 | 2 => 8.0 * next(),
            _ => (level_bar + next() - 0.5).clamp(0.0, 8.0),
        };
        profile = match (3.0 * next()) as u32 {
            0 => profile.ramp_to(level_bar, 1 + (2000.0 * next()) as u32),
            _ => profile.step_to(level_bar),
        };
        profile = profile.hold_ms(100 + (4000.0 * next().powi(2)) as u32);
    }
    profile
}

/// Returns number `counter`, uniform over 0 ..= 1.
fn uniform(chance: &Random, counter: u64) -> f64 {
    0.5 + 0.5 * chance.symmetric(counter)
}
