//! Fault-injection campaign: requirements on the ECU, and checks that the oracle detects violations.

use ecu::{Damage, Ecu, EcuConfig, Fault, Mechanism, Mode};
use hil_harness::campaign::CampaignRequirement::{
    self, EmptyInTime, NeutralFirst, NoBump, NoFillAfterN, NoIncreaseWithoutReference, NoKick,
    NoSuddenLoss, OneCoil, ResumesByItself, SafeInTime, ShutInDoubt, StaysLocked,
};
use hil_harness::campaign::{
    EcuFault, FaultClass, InProcessTarget, Injection, Outcome, Summary, Target, run,
};

/// Damages an ECU's memory; returns whether that changed it.
fn damage(ecu: &mut Ecu, fault: EcuFault) -> bool {
    match fault {
        EcuFault::ConfigDamaged => ecu.damage(Damage::Config),
        // The damage sets the mode to running, which has no effect if it is running already.
        EcuFault::SupervisorDamaged if ecu.mode() == Mode::Running => return false,
        EcuFault::SupervisorDamaged => ecu.damage(Damage::Supervisor),
        EcuFault::ControllerDamaged => ecu.damage(Damage::Controller),
        _ => return false,
    }
    true
}

fn whole() -> InProcessTarget {
    InProcessTarget::whole().damaged_by(damage)
}

fn outcome(injection: &Injection, target: &mut InProcessTarget) -> Outcome {
    run(injection, target).expect("an ECU in this process always answers")
}

/// Every class of fault at random instants, on scattered rigs: safety first, then recovery. The example runs any number
/// of them.
#[test]
fn no_requirement_is_violated_in_two_thousand_runs_with_a_fault() {
    let mut target = whole();
    let classes: Vec<FaultClass> = FaultClass::all()
        .filter(|class| target.breaks(*class))
        .collect();
    let mut summary = Summary::default();
    for index in 0..2000 {
        let injection = Injection::drawn(&classes, 2026, index);
        summary.add(outcome(&injection, &mut target));
    }
    println!("{summary}");
    assert_eq!(summary.failed(), 0, "\n{summary}");
    assert_eq!(summary.classes().count(), classes.len());
}

#[test]
fn a_line_repeats_its_run_bit_for_bit() {
    let line = "sensor/stuck onset=312 duration=80 times=1 severity=0.40 rig=17 seed=0x1234";
    let injection: Injection = line.parse().expect("a line");
    let first = outcome(&injection, &mut whole());
    assert_eq!(outcome(&injection, &mut whole()), first);
    assert_eq!(first.injection.to_string(), line);
}

/// The battery voltage rose again while the pressure still recovered from the previous fault. The effect of 41 V in the
/// nine samples before its confirmation is not a bump of the recovery.
#[test]
fn a_comeback_is_judged_until_the_next_fault_begins() {
    let line = "ecu/battery-high onset=150 duration=30 times=3 severity=0.50 rig=0 seed=0x0";
    let injection: Injection = line.parse().expect("a line");
    assert_eq!(outcome(&injection, &mut whole()).violations, []);
}

/// Defect seen: at 17 V a duty cycle of 83 % is the current of 60 % at 24 V. The oracle took the valve for open, and saw a
/// pressure that did not rise.
#[test]
fn a_duty_cycle_opens_a_valve_by_its_current() {
    for line in [
        "ecu/battery-low onset=81 duration=336 times=1 severity=0.11 rig=878 seed=0x7a4298",
        "ecu/battery-low onset=329 duration=220 times=1 severity=0.26 rig=752 seed=0x57f9b0e7",
    ] {
        let injection: Injection = line.parse().expect("a line");
        assert_eq!(outcome(&injection, &mut whole()).violations, [], "{line}");
    }
}

/// Part of the campaign that needs one mechanism: a fault on several rigs with several drives.
struct Slice<T> {
    /// Required mechanism.
    needs: T,
    /// Requirement that is violated in at least one of its runs without the mechanism.
    requirement: CampaignRequirement,
    /// Fault in the form of a line; missing parts are chosen run by run.
    fault: &'static str,
}

const fn slice<T>(needs: T, requirement: CampaignRequirement, fault: &'static str) -> Slice<T> {
    Slice {
        needs,
        requirement,
        fault,
    }
}

/// Number of runs of a slice.
const RUNS: u32 = 20;

impl<T: core::fmt::Debug> Slice<T> {
    /// Returns the runs with a violated requirement.
    fn failures(&self, target: &mut InProcessTarget) -> Vec<Outcome> {
        (0..RUNS)
            .map(|number| {
                // The first part with a key counts.
                let onset = 150 + 7 * number;
                let rest = format!("onset={onset} times=1 severity=0.5 rig={number} seed={number}");
                let line = format!("{} {rest}", self.fault);
                outcome(&line.parse().expect("a line"), target)
            })
            .filter(|outcome| !outcome.violations.is_empty())
            .collect()
    }

    /// Checks that in this slice the ECU meets every requirement, and without the mechanism violates the one that needs
    /// it.
    fn check(&self, without: impl Fn(EcuConfig) -> EcuConfig + 'static) -> Result<(), String> {
        let needs = &self.needs;
        if let [failure, ..] = self.failures(&mut whole()).as_slice() {
            let (line, violation) = (failure.injection, &failure.violations[0]);
            return Err(format!(
                "{needs:?}: the whole ECU fails: {line}: {violation}"
            ));
        }
        let failures = self.failures(&mut InProcessTarget::altered(without).damaged_by(damage));
        let broken: Vec<CampaignRequirement> = failures
            .iter()
            .flat_map(|outcome| &outcome.violations)
            .map(|violation| violation.requirement)
            .collect();
        let noticed = broken.iter().filter(|one| **one == self.requirement);
        println!(
            "without {:28} {:2} of {RUNS} runs red, {:?} in {}",
            format!("{needs:?}"),
            failures.len(),
            self.requirement,
            noticed.clone().count(),
        );
        if noticed.count() == 0 {
            return Err(format!("{needs:?} is gone and not missed: {broken:?}"));
        }
        Ok(())
    }
}

fn all_or_said(checked: impl Iterator<Item = Result<(), String>>) {
    let failed: Vec<String> = checked.filter_map(Result::err).collect();
    assert!(failed.is_empty(), "\n{}", failed.join("\n"));
}

#[rustfmt::skip]
const MECHANISMS: [Slice<Mechanism>; 13] = [
    slice(Mechanism::Debounce, ResumesByItself, "ecu/task-late duration=2"),
    slice(Mechanism::ShutOnDoubt, ShutInDoubt, "sensor/missing duration=4 times=5"),
    slice(Mechanism::NoIncreaseWithoutReference, NoIncreaseWithoutReference, "link/lost duration=80 times=5"),
    slice(Mechanism::NeutralInterlock, NeutralFirst, "ecu/reset duration=5"),
    slice(Mechanism::HoldLimit, EmptyInTime, "sensor/open duration=1000"),
    slice(Mechanism::ActiveVent, EmptyInTime, "sensor/open duration=1000"),
    slice(Mechanism::VentLimit, SafeInTime, "sensor/missing duration=1000"),
    slice(Mechanism::Ramp, NoSuddenLoss, "link/silent duration=100"),
    slice(Mechanism::RecoveryRamp, NoBump, "link/silent duration=45"),
    slice(Mechanism::BumplessTakeover, NoKick, "sensor/missing duration=20 times=3"),
    slice(Mechanism::RetryLimit, StaysLocked, "sensor/missing duration=8 times=5"),
    slice(Mechanism::Latch, StaysLocked, "ecu/supervisor-damaged onset=5 duration=1"),
    slice(Mechanism::BothValvesInterlock, OneCoil, "ecu/controller-damaged duration=1"),
];

#[test]
fn the_campaign_notices_that_any_one_mechanism_is_gone() {
    assert_eq!(
        MECHANISMS.each_ref().map(|slice| slice.needs),
        Mechanism::ALL
    );
    all_or_said(MECHANISMS.iter().map(|slice| {
        let mechanism = slice.needs;
        slice.check(move |config| config.without(mechanism))
    }));
}

#[rustfmt::skip]
const DETECTORS: [Slice<Fault>; 22] = [
    slice(Fault::SensorOpen, EmptyInTime, "sensor/open duration=1000"),
    slice(Fault::SensorShort, EmptyInTime, "sensor/short duration=1000"),
    slice(Fault::SensorBelowRange, EmptyInTime, "sensor/below-range duration=1000"),
    slice(Fault::SensorAboveRange, EmptyInTime, "sensor/above-range duration=1000"),
    slice(Fault::SensorJump, NoFillAfterN, "sensor/jump duration=100"),
    slice(Fault::SensorMissing, EmptyInTime, "sensor/missing duration=1000"),
    slice(Fault::SensorStuck, NoFillAfterN, "sensor/stuck duration=500"),
    slice(Fault::SensorOffset, NeutralFirst, "sensor/offset onset=150 duration=2000 severity=0.17 rig=27"),
    slice(Fault::NoRise, NoFillAfterN, "plant/fill-stuck-closed duration=400"),
    slice(Fault::NoFall, NeutralFirst, "plant/vent-stuck-closed duration=1000"),
    slice(Fault::UncommandedRise, NeutralFirst, "plant/fill-stuck-open duration=400 severity=0.10"),
    slice(Fault::UncommandedFall, NoFillAfterN, "plant/vent-stuck-open duration=400 severity=0.36"),
    slice(Fault::SupplyLost, NoFillAfterN, "plant/supply-lost duration=500 severity=1"),
    slice(Fault::FillCoilOpen, NoFillAfterN, "plant/fill-coil-open duration=500"),
    slice(Fault::FillCoilShort, NoFillAfterN, "plant/fill-coil-short duration=500"),
    slice(Fault::VentCoilOpen, SafeInTime, "plant/vent-coil-open duration=1000"),
    slice(Fault::VentCoilShort, SafeInTime, "plant/vent-coil-short duration=1000"),
    slice(Fault::BatteryLow, NoFillAfterN, "ecu/battery-low duration=300"),
    slice(Fault::BatteryHigh, NoFillAfterN, "ecu/battery-high duration=300"),
    slice(Fault::SampleTime, NoFillAfterN, "ecu/task-early duration=300"),
    slice(Fault::ReferenceLost, NoFillAfterN, "link/silent duration=300"),
    slice(Fault::MemoryDamaged, StaysLocked, "ecu/supervisor-damaged onset=5 duration=1"),
];

#[test]
fn the_campaign_notices_that_any_one_detector_is_gone() {
    assert_eq!(DETECTORS.each_ref().map(|slice| slice.needs), Fault::ALL);
    all_or_said(DETECTORS.iter().map(|slice| {
        let fault = slice.needs;
        slice.check(move |config| config.without_detector(fault))
    }));
}
