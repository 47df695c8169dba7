//! The budgets, each with its reason, and whether the figures keep them.

use std::fmt::Display;

use super::Unproved;
use super::candidate::{Duty, SATURATING, THESIS_STEP, TRACED_STEP};
use super::figures::Figures;
use super::table::Table;
use super::unbounded::Unbounded;
use crate::failure::Failure;

/// Instructions of the thesis' full step on average: less than the same in C with the FPU takes on this trace.
const MEAN_MAX: f64 = 65.0;
/// Instructions of the thesis' full step at most, for any input: 80 at 100 MHz are about 1 µs of a period of 10 ms.
const PROVED_MAX: u32 = 80;
/// Its code: with its constants, it fits into a quarter of the smallest instruction cache in use (1 KiB, STM32G4).
const CODE_BYTES_MAX: u32 = 280;
/// Its stack: four saved registers, the frame pointer and the return address.
const STACK_BYTES_MAX: u32 = 24;
/// Its share of what C needs that saturates each operation.
const SHARE_OF_SATURATING_MAX: f64 = 0.5;
/// Instructions of the full step with limits by pressure, and telemetry, at most.
const TRACED_PROVED_MAX: u32 = 300;
/// How far the baselines' duty cycles may be from ours [%]: they are to do the same, or the comparison is none.
const DEVIATION_MAX_PCT: f64 = 0.001;

/// One budget and what was found.
#[derive(Debug)]
pub(crate) struct Gate {
    what: String,
    figure: String,
    budget: String,
    holds: bool,
}

impl Gate {
    /// A figure that may reach its budget and not pass it.
    pub(crate) fn at_most<T: PartialOrd + Display>(what: &str, figure: T, budget: T) -> Self {
        Self {
            what: what.to_owned(),
            holds: figure <= budget,
            figure: format!("{figure:.2}"),
            budget: format!("≤ {budget:.2}"),
        }
    }

    /// A bound that may not exist.
    fn bounded(what: &str, figure: &Result<u32, Unbounded>, budget: u32) -> Self {
        match figure {
            Ok(figure) => Self::at_most(what, *figure, budget),
            Err(reason) => Self {
                what: what.to_owned(),
                figure: reason.to_string(),
                budget: format!("≤ {budget}"),
                holds: false,
            },
        }
    }

    /// Nothing of a kind, else the first of them.
    fn none<'a>(what: &str, found: impl IntoIterator<Item = &'a String>) -> Self {
        let first = found.into_iter().next();
        Self {
            what: what.to_owned(),
            figure: first.map_or("none", String::as_str).to_owned(),
            budget: "none".to_owned(),
            holds: first.is_none(),
        }
    }

    fn missing(what: &str) -> Self {
        Self {
            what: what.to_owned(),
            figure: "not measured".to_owned(),
            budget: "measured".to_owned(),
            holds: false,
        }
    }
}

/// All budgets of a sample.
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
            gates.extend(beside_c(step, &SATURATING.map(named)));
        }
        None => gates.push(Gate::missing("full step")),
    }
    match named(TRACED_STEP) {
        Some(step) => gates.push(Gate::bounded(
            "full step with limits by pressure and trace: proved",
            &step.proved,
            TRACED_PROVED_MAX,
        )),
        None => gates.push(Gate::missing("full step with limits by pressure and trace")),
    }
    gates.extend(of_the_method(figures));
    gates
}

fn of_the_step(step: &Figures) -> Vec<Gate> {
    let ours = |name: &&String| name.contains("controller::") || name.contains("budgets::");
    let foreign = step.reach.others.iter().filter(|name| !ours(name));
    vec![
        Gate::at_most(
            "full step: instructions, mean",
            step.counted.mean(),
            MEAN_MAX,
        ),
        Gate::bounded("full step: instructions, proved", &step.proved, PROVED_MAX),
        Gate::at_most("full step: code [bytes]", step.reach.bytes, CODE_BYTES_MAX),
        Gate::bounded("full step: stack [bytes]", &step.stack, STACK_BYTES_MAX),
        Gate::none("full step: divisions", &step.reach.divisions),
        Gate::none("full step: float instructions", &step.reach.floats),
        Gate::none("full step: calls into a runtime library", foreign),
        Gate::none("full step: panics", &step.reach.panics),
    ]
}

/// Against the better one of -O2 and -Os.
fn beside_c(step: &Figures, saturating: &[Option<&Figures>]) -> Vec<Gate> {
    let present = || saturating.iter().flatten();
    let mean = present().map(|c| c.counted.mean()).reduce(f64::min);
    let proved = present().filter_map(|c| c.proved.as_ref().ok()).min();
    let (Some(mean), Some(&proved), Ok(own)) = (mean, proved, &step.proved) else {
        return vec![Gate::missing("full step: share of the saturating C")];
    };
    let share = |what, share: f64| Gate {
        figure: format!("{share:.2}"),
        budget: format!("≤ {SHARE_OF_SATURATING_MAX:.2}"),
        ..Gate::at_most(what, share, SHARE_OF_SATURATING_MAX)
    };
    vec![
        share(
            "full step: share of the saturating C, mean",
            step.counted.mean() / mean,
        ),
        share(
            "full step: share of the saturating C, proved",
            f64::from(*own) / f64::from(proved),
        ),
    ]
}

/// What was seen must not contradict what was proved, and who is compared must do the same.
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

/// Prints the gates; a failure if one is not kept.
pub(crate) fn judge(gates: &[Gate]) -> Result<(), Failure> {
    println!("{}", table(gates));
    let exceeded = exceeded(gates);
    if exceeded.is_empty() {
        Ok(())
    } else {
        Err(Unproved::Exceeded(exceeded).into())
    }
}

/// The gates as a table.
fn table(gates: &[Gate]) -> Table {
    let mut table = Table::new(&["budget", "found", "allowed", ""]);
    for gate in gates {
        let verdict = if gate.holds { "kept" } else { "EXCEEDED" };
        table.row(vec![
            gate.what.clone(),
            gate.figure.clone(),
            gate.budget.clone(),
            verdict.to_owned(),
        ]);
    }
    table
}

/// The budgets that are not kept, as sentences.
pub(crate) fn exceeded(gates: &[Gate]) -> Vec<String> {
    let exceeded = gates.iter().filter(|gate| !gate.holds);
    let sentence = |gate: &Gate| format!("{}: {}, allowed {}", gate.what, gate.figure, gate.budget);
    exceeded.map(sentence).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budgets::candidate::Candidate;
    use crate::budgets::counted::Counted;
    use crate::budgets::reach::Reach;

    /// A candidate that keeps all budgets with nothing to spare.
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

    /// The whole bench on its budgets, but for C, which needs four times as much.
    fn on_the_edge() -> Vec<Figures> {
        let mut all: Vec<Figures> = [THESIS_STEP, TRACED_STEP, SATURATING[0], SATURATING[1]]
            .map(figures)
            .into();
        all[1].proved = Ok(300);
        for c in &mut all[2..] {
            c.counted.sum = 2600;
            c.proved = Ok(320);
        }
        all
    }

    #[test]
    fn a_figure_on_its_budget_keeps_it() {
        assert_eq!(exceeded(&gates(&on_the_edge())), Vec::<String>::new());
    }

    /// Each budget, seen red once: one figure moved one unit too far, and the sentence that tells it.
    #[test]
    fn a_figure_one_unit_beyond_its_budget_is_told_and_no_other() {
        type Spoil = fn(&mut [Figures]);
        let cases: [(Spoil, &str); 16] = [
            (
                |all| all[0].counted.sum = 651,
                "full step: instructions, mean",
            ),
            (
                |all| all[0].proved = Ok(81),
                "full step: instructions, proved",
            ),
            (|all| all[0].reach.bytes = 281, "full step: code"),
            (|all| all[0].stack = Ok(25), "full step: stack"),
            (
                |all| all[0].reach.divisions.push("f+0x2".to_owned()),
                "full step: divisions",
            ),
            (
                |all| all[0].reach.floats.push("f+0x2".to_owned()),
                "full step: float",
            ),
            (
                |all| insert(&mut all[0].reach.others, "__aeabi_ldivmod"),
                "full step: calls into",
            ),
            (
                |all| insert(&mut all[0].reach.panics, "core::panicking::panic"),
                "full step: panics",
            ),
            (
                |all| all[2].counted.sum = 1299,
                "full step: share of the saturating C, mean",
            ),
            (
                |all| all[3].proved = Ok(159),
                "full step: share of the saturating C, proved",
            ),
            (|all| all[1].proved = Ok(301), "full step with limits"),
            (
                |all| all[2].counted.max = 321,
                "all: more instructions seen",
            ),
            (|all| all[2].counted.stack = 25, "all: more stack touched"),
            (
                |all| all[2].counted.decisions = 1,
                "full steps: another valve",
            ),
            (
                |all| all[2].counted.deviation = 66,
                "full steps: duty cycle",
            ),
            (
                |all| {
                    all[1].proved = Err(Unbounded::Loop {
                        at: "f+0x2".to_owned(),
                    })
                },
                "full step with limits",
            ),
        ];
        for (spoil, told) in cases {
            let mut all = on_the_edge();
            spoil(&mut all);
            let exceeded = exceeded(&gates(&all));
            assert_eq!(exceeded.len(), 1, "{told}: {exceeded:?}");
            assert!(exceeded[0].starts_with(told), "{told}: {exceeded:?}");
        }
    }

    #[test]
    fn exactly_half_of_the_better_c_is_within_budget() {
        let mut all = on_the_edge();
        all[2].counted.sum = 1300;
        all[3].proved = Ok(160);
        assert_eq!(exceeded(&gates(&all)), Vec::<String>::new());
    }

    fn insert(names: &mut std::collections::BTreeSet<String>, name: &str) {
        names.insert(name.to_owned());
    }

    #[test]
    fn a_step_without_bound_fails_with_the_reason() {
        let mut all = on_the_edge();
        all[0].proved = Err(Unbounded::Loop {
            at: "step+0x2".to_owned(),
        });
        let exceeded = exceeded(&gates(&all));
        assert!(exceeded[0].contains("loop at step+0x2"), "{exceeded:?}");
    }

    #[test]
    fn who_was_not_measured_does_not_pass() {
        for (missing, told) in [(0, "full step"), (1, "full step with limits")] {
            let mut all = on_the_edge();
            all.remove(missing);
            let exceeded = exceeded(&gates(&all));
            assert!(exceeded[0].starts_with(told), "{exceeded:?}");
        }
        let exceeded = exceeded(&gates(&on_the_edge()[..2]));
        assert_eq!(exceeded.len(), 1, "{exceeded:?}");
        assert!(exceeded[0].starts_with("full step: share of the saturating C"));
    }
}
