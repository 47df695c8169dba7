//! Time series of the runs in a view.

use recording::Recording;
use serde::{Deserialize, Serialize};

use crate::pages::points::{Drawn, Points, Range};
use crate::refusal::Refusal;
use crate::results::Controlled;

/// Shown signals, in this order; one that a run lacks is left out.
const SIGNALS: [&str; 10] = [
    "p_ref",
    "p_ch",
    "duty_fill",
    "duty_vent",
    "i_fill",
    "i_vent",
    "x_fill",
    "x_vent",
    "x_plunger",
    "torque_proxy",
];

/// View of the page.
#[derive(Debug, Deserialize)]
pub(super) struct View {
    from_s: Option<f64>,
    to_s: Option<f64>,
    /// Points of each series.
    points: usize,
}

#[derive(Serialize)]
pub(super) struct Traces {
    /// First and last instant of the runs (s).
    whole_s: (f64, f64),
    signals: Vec<SignalTraces>,
}

#[derive(Serialize)]
struct SignalTraces {
    name: &'static str,
    unit: &'static str,
    /// Time series, one for each run.
    runs: Vec<Points>,
}

pub(super) fn traces(controlled: &Controlled, view: &View) -> Result<Traces, Refusal> {
    let drawn = Drawn {
        range: Range {
            from_s: view.from_s,
            to_s: view.to_s,
        },
        points: view.points,
    };
    let recordings = || controlled.runs.iter().map(|judged| &judged.run.recording);
    let is_there = |name: &&&str| recordings().all(|run| run.signal(name).is_some());
    let signals = SIGNALS.iter().filter(is_there).map(|name| {
        let unit = recordings().find_map(|run| run.signal(name).map(|signal| signal.unit()));
        Ok(SignalTraces {
            name,
            unit: unit.map_or("", recording::Unit::symbol),
            runs: recordings()
                .map(|run| points(run, name, drawn))
                .collect::<Result<_, Refusal>>()?,
        })
    });
    let base = recordings().find_map(|run| run.time_base_of("p_ch"));
    Ok(Traces {
        whole_s: base.map_or((0.0, 1.0), |base| (base.start_s(), base.end_s())),
        signals: signals.collect::<Result<_, Refusal>>()?,
    })
}

fn points(run: &Recording, name: &str, drawn: Drawn) -> Result<Points, Refusal> {
    let (Some(signal), Some(base)) = (run.signal(name), run.time_base_of(name)) else {
        return Err(Refusal::not_found("signal"));
    };
    Points::of(base, signal.values_or_nan(), drawn)
}
