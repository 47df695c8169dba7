//! Budgets with their reasons, compared with the figures.

use super::candidate::{CHECKED_LOOP, Duty, ECU_SAMPLE, PULSES, SATURATING, THESIS_STEP};
use super::figures::Figures;
use super::gate::Gate;
use super::unbounded::Unbounded;

/// Maximum mean number of instructions of the thesis' full step: fewer than the same step in C with the FPU needs on
/// this trace.
const MEAN_MAX: f64 = 65.0;
/// Maximum number of instructions of the thesis' full step, for any input: 80 at 100 MHz are about 1 µs of a period of
/// 10 ms.
const PROVED_MAX: u32 = 80;
/// Maximum code size of the full step (bytes): with its constants it takes about a quarter of the smallest instruction
/// cache in use (1 KiB, STM32G4).
const CODE_BYTES_MAX: u32 = 280;
/// Maximum stack of the full step (bytes): four saved registers, the frame pointer and the return address.
const STACK_BYTES_MAX: u32 = 24;
/// Maximum number of instructions relative to C code that saturates each operation.
const SHARE_OF_SATURATING_MAX: f64 = 0.5;
/// Maximum number of instructions of the full step with limits by pressure, plausibility and telemetry.
const CHECKED_PROVED_MAX: u32 = 300;
/// Maximum number of instructions of the model-based pulses: 4 µs at 100 MHz.
const PULSES_PROVED_MAX: u32 = 400;
/// Maximum number of instructions of all work of an ECU in a sample: 20 µs at 100 MHz, 0.2 % of the period.
const ECU_PROVED_MAX: u32 = 2000;
/// Allowed difference of the baselines' duty cycles from those of the project's controller (%): a fair comparison needs
/// the same output.
const DEVIATION_MAX_PCT: f64 = 0.001;

/// Returns all budgets of a sample.
pub(crate) fn gates(figures: &[Figures]) -> Vec<Gate> {
    let named = |name: &str| {
        figures
            .iter()
            .find(|figures| figures.candidate.name == name)
    };
    let mut gates = Vec::new();
    match named(THESIS_STEP) {
        Some(step) => {
            gates.extend(of_the_step(step));
            gates.extend(of_the_code("full step", step));
            gates.extend(beside_c(step, &SATURATING.map(named)));
        }
        None => gates.push(Gate::missing("full step")),
    }
    for (name, what, proved_max) in [
        (PULSES, "pulses", PULSES_PROVED_MAX),
        (CHECKED_LOOP, "checked loop", CHECKED_PROVED_MAX),
        (ECU_SAMPLE, "ECU sample", ECU_PROVED_MAX),
    ] {
        match named(name) {
            Some(sample) => {
                let proved = format!("{what}: instructions, proved");
                gates.push(Gate::bounded(&proved, &sample.proved, proved_max));
                gates.extend(of_the_code(what, sample));
            }
            None => gates.push(Gate::missing(what)),
        }
    }
    gates.extend(of_the_method(figures));
    gates
}

fn of_the_step(step: &Figures) -> Vec<Gate> {
    vec![
        Gate::at_most(
            "full step: instructions, mean",
            step.counted.mean(),
            MEAN_MAX,
        ),
        Gate::bounded("full step: instructions, proved", &step.proved, PROVED_MAX),
        Gate::at_most("full step: code [bytes]", step.reach.bytes, CODE_BYTES_MAX),
        Gate::bounded("full step: stack [bytes]", &step.stack, STACK_BYTES_MAX),
    ]
}

/// Returns the gates for constructs that code with a bounded time must not have; a loop is excluded already, since it
/// has no bound.
fn of_the_code(what: &str, sample: &Figures) -> Vec<Gate> {
    let ours = |name: &&String| {
        ["controller::", "ecu::", "budgets::"]
            .iter()
            .any(|of| name.contains(of))
    };
    let reach = &sample.reach;
    let foreign = reach.others.iter().filter(|name| !ours(name));
    let none = |of: &str| format!("{what}: {of}");
    vec![
        Gate::none(&none("divisions"), &reach.divisions),
        Gate::none(&none("float instructions"), &reach.floats),
        Gate::none(&none("calls into a runtime library"), foreign),
        Gate::none(&none("panics"), &reach.panics),
    ]
}

/// Returns the gates that compare with C, compiled with the better one of -O2 and -Os.
fn beside_c(step: &Figures, saturating: &[Option<&Figures>]) -> Vec<Gate> {
    let present = || saturating.iter().flatten();
    let mean = present().map(|c| c.counted.mean()).reduce(f64::min);
    let proved = present().filter_map(|c| c.proved.as_ref().ok()).min();
    let (Some(mean), Some(&proved), Ok(own)) = (mean, proved, &step.proved) else {
        return vec![Gate::missing("full step: share of the saturating C")];
    };
    vec![
        Gate::at_most(
            "full step: share of the saturating C, mean",
            step.counted.mean() / mean,
            SHARE_OF_SATURATING_MAX,
        ),
        Gate::at_most(
            "full step: share of the saturating C, proved",
            f64::from(*own) / f64::from(proved),
            SHARE_OF_SATURATING_MAX,
        ),
    ]
}

/// Returns the gates of the method: counts must not exceed proved bounds, and compared candidates must have the same
/// output.
fn of_the_method(figures: &[Figures]) -> Vec<Gate> {
    let titles = |wrong: fn(&Figures) -> bool| -> Vec<String> {
        let found = figures.iter().filter(|figures| wrong(figures));
        found
            .map(|figures| figures.candidate.title.to_owned())
            .collect()
    };
    vec![
        Gate::none(
            "all: more instructions seen than proved",
            &titles(|f| beyond_bound(f.counted.max, &f.proved)),
        ),
        Gate::none(
            "all: more stack touched than proved",
            &titles(|f| beyond_bound(f.counted.stack, &f.stack)),
        ),
        Gate::none(
            "full steps: another valve driven than ours",
            &titles(|f| f.candidate.duty == Duty::FullStep && f.counted.decisions > 0),
        ),
        Gate::none(
            "full steps: duty cycle more than 0.001 % from ours",
            &titles(|f| f.deviation_pct().is_some_and(|pct| pct > DEVIATION_MAX_PCT)),
        ),
    ]
}

fn beyond_bound(seen: u32, proved: &Result<u32, Unbounded>) -> bool {
    proved.as_ref().is_ok_and(|&proved| seen > proved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budgets::candidate::Candidate;
    use crate::budgets::counted::Counted;
    use crate::budgets::gate::exceeded;
    use crate::budgets::reach::Reach;

    /// Creates figures that meet all budgets exactly.
    fn figures(name: &str) -> Figures {
        Figures {
            candidate: Candidate::named(name).unwrap(),
            counted: Counted {
                name: name.to_owned(),
                entry: 1,
                calls: 10,
                sum: 650,
                min: 20,
                max: 80,
                stack: 24,
                state_bytes: 24,
                config_bytes: 44,
                deviation: 65,
                decisions: 0,
            },
            proved: Ok(80),
            stack: Ok(24),
            reach: Reach {
                bytes: 280,
                others: ["controller::step::step".to_owned()].into(),
                ..Reach::default()
            },
        }
    }

    const FAST_C: usize = 0;
    const SMALL_C: usize = 1;
    const STEP: usize = 2;
    const CHECKED: usize = 3;
    const ECU: usize = 4;
    const PULSED: usize = 5;

    /// Creates the whole bench at its budgets, except for C, which needs four times as much.
    fn on_the_edge() -> Vec<Figures> {
        let mut all: Vec<Figures> = [
            SATURATING[0],
            SATURATING[1],
            THESIS_STEP,
            CHECKED_LOOP,
            ECU_SAMPLE,
            PULSES,
        ]
        .map(figures)
        .into();
        all[PULSED].proved = Ok(400);
        all[CHECKED].proved = Ok(300);
        all[ECU].proved = Ok(2000);
        for c in &mut all[..=SMALL_C] {
            c.counted.sum = 2600;
            c.proved = Ok(320);
        }
        all
    }

    #[test]
    fn a_figure_on_its_budget_keeps_it() {
        assert_eq!(exceeded(&gates(&on_the_edge())), Vec::<String>::new());
    }

    /// Each budget is exceeded once, by one unit, and only its sentence appears.
    #[test]
    fn a_figure_one_unit_beyond_its_budget_is_reported_and_no_other() {
        type Spoil = fn(&mut [Figures]);
        let cases: [(Spoil, &str); 19] = [
            (
                |all| all[PULSED].proved = Ok(401),
                "pulses: instructions, proved",
            ),
            (
                |all| all[STEP].counted.sum = 651,
                "full step: instructions, mean",
            ),
            (
                |all| all[STEP].proved = Ok(81),
                "full step: instructions, proved",
            ),
            (|all| all[STEP].reach.bytes = 281, "full step: code"),
            (|all| all[STEP].stack = Ok(25), "full step: stack"),
            (
                |all| all[STEP].reach.divisions.push("f+0x2".to_owned()),
                "full step: divisions",
            ),
            (
                |all| all[CHECKED].reach.floats.push("f+0x2".to_owned()),
                "checked loop: float",
            ),
            (
                |all| insert(&mut all[ECU].reach.others, "__aeabi_ldivmod"),
                "ECU sample: calls into",
            ),
            (
                |all| insert(&mut all[STEP].reach.panics, "core::panicking::panic"),
                "full step: panics",
            ),
            (
                |all| all[FAST_C].counted.sum = 1299,
                "full step: share of the saturating C, mean",
            ),
            (
                |all| all[SMALL_C].proved = Ok(159),
                "full step: share of the saturating C, proved",
            ),
            (
                |all| all[CHECKED].proved = Ok(301),
                "checked loop: instructions, proved",
            ),
            (
                |all| all[CHECKED].proved = endless(),
                "checked loop: instructions, proved: loop",
            ),
            (
                |all| all[ECU].proved = Ok(2001),
                "ECU sample: instructions, proved",
            ),
            (
                |all| all[ECU].proved = endless(),
                "ECU sample: instructions, proved: loop",
            ),
            (
                |all| all[FAST_C].counted.max = 321,
                "all: more instructions seen",
            ),
            (
                |all| all[FAST_C].counted.stack = 25,
                "all: more stack touched",
            ),
            (
                |all| all[FAST_C].counted.decisions = 1,
                "full steps: another valve",
            ),
            (
                |all| all[FAST_C].counted.deviation = 66,
                "full steps: duty cycle",
            ),
        ];
        for (spoil, start) in cases {
            let mut all = on_the_edge();
            spoil(&mut all);
            let exceeded = exceeded(&gates(&all));
            assert_eq!(exceeded.len(), 1, "{start}: {exceeded:?}");
            assert!(exceeded[0].starts_with(start), "{start}: {exceeded:?}");
        }
    }

    #[test]
    fn exactly_half_of_the_better_c_is_within_budget() {
        let mut all = on_the_edge();
        all[FAST_C].counted.sum = 1300;
        all[SMALL_C].proved = Ok(160);
        assert_eq!(exceeded(&gates(&all)), Vec::<String>::new());
    }

    fn endless() -> Result<u32, Unbounded> {
        Err(Unbounded::Loop {
            at: "step+0x2".to_owned(),
        })
    }

    fn insert(names: &mut std::collections::BTreeSet<String>, name: &str) {
        names.insert(name.to_owned());
    }

    #[test]
    fn a_step_without_bound_fails_with_the_reason_and_the_goal() {
        let mut all = on_the_edge();
        all[STEP].proved = endless();
        let expected = "full step: instructions, proved: loop at step+0x2, at most 80";
        assert!(exceeded(&gates(&all)).contains(&expected.to_owned()));
    }

    #[test]
    fn who_was_not_measured_does_not_pass() {
        for (missing, start) in [
            (STEP, "full step: not measured, has to be: measured"),
            (CHECKED, "checked loop: not measured"),
            (ECU, "ECU sample: not measured"),
            (PULSED, "pulses: not measured"),
        ] {
            let mut all = on_the_edge();
            all.remove(missing);
            let exceeded = exceeded(&gates(&all));
            assert_eq!(exceeded.len(), 1, "{exceeded:?}");
            assert!(exceeded[0].starts_with(start), "{exceeded:?}");
        }
        let exceeded = exceeded(&gates(&on_the_edge()[STEP..]));
        assert_eq!(exceeded.len(), 1, "{exceeded:?}");
        assert!(exceeded[0].starts_with("full step: share of the saturating C"));
    }
}
