//! Missing flow as a function of quantities on which it may depend: a leak shows in pressure, a relaxation in the time since the valves
//! moved, a wrong orifice or delay in duty.

use core::ops::Range;

use super::trace::{Regime, Trace};
use crate::diagnosis::result::{FlowCurve, FlowPoint};
use crate::noise::Noise;
use plant_sim::plant::{FILL, VENT};

/// Length of the pieces of a hold (s).
const PIECE_S: f64 = 0.25;
/// Time within which errors may be correlated (s).
const CLUSTER_S: f64 = 2.0;
/// Edges of the time since the valves moved (s).
const RELAXATION_EDGES_S: [f64; 9] = [0.0, 0.1, 0.2, 0.4, 0.7, 1.2, 2.0, 4.0, 8.0];
/// Largest number of points of a curve, and smallest number of pieces for each.
const POINTS: usize = 8;
const PIECES_PER_POINT: usize = 4;
/// Number of sign flips of the test, and the probability by chance below which a curve is significant.
const FLIPS: usize = 4000;
const CHANCE: f64 = 1e-3;
/// Smallest share of the missing flow that a curve must explain.
const LEAST_SHARE: f64 = 0.2;

/// Missing rate over a few rows.
#[derive(Debug, Clone, Copy)]
struct Piece {
    at: f64,
    /// Time since the start of the log (s).
    time_s: f64,
    bar_per_s: f64,
    /// Variance of the rate, from the sensor's noise.
    variance: f64,
    cluster: usize,
    samples: usize,
}

/// Returns the curves of the missing flow of all logs, the one that explains most first.
pub(super) fn curves(traces: &[Trace]) -> Vec<FlowCurve> {
    let mut curves = Vec::new();
    let mut add =
        |against: &str, unit: &str, condition: &str, pieces: Vec<Piece>, edges: Option<&[f64]>| {
            curves.extend(curve(against, unit, condition, &pieces, edges));
        };
    let shut = Regime::Shut.name();
    add(
        "p_ch",
        "bar",
        shut,
        gather(traces, pressures_while_shut),
        None,
    );
    for (valve, after) in [(FILL, "after filling"), (VENT, "after venting")] {
        let pieces = gather(traces, |trace, cluster| relaxations(trace, valve, cluster));
        let condition = format!("{shut}, {after}");
        add(
            "time since the valves moved",
            "s",
            &condition,
            pieces,
            Some(&RELAXATION_EDGES_S),
        );
    }
    for (valve, regime, duty) in [
        (FILL, Regime::Filling, "duty_fill"),
        (VENT, Regime::Venting, "duty_vent"),
    ] {
        let pieces = gather(traces, |trace, cluster| {
            strokes(trace, valve, regime, cluster)
        });
        let of_time = pieces
            .iter()
            .map(|piece| Piece {
                at: piece.time_s,
                ..*piece
            })
            .collect();
        add(duty, "%", regime.name(), pieces, None);
        add("time", "s", regime.name(), of_time, None);
    }
    curves.sort_by(|a, b| b.explained_share.total_cmp(&a.explained_share));
    curves
}

/// Returns the pieces of all time series; a cluster belongs to one of them.
fn gather(traces: &[Trace], pieces: impl Fn(&Trace, usize) -> Vec<Piece>) -> Vec<Piece> {
    let mut all: Vec<Piece> = Vec::new();
    for trace in traces {
        let first = all.iter().map(|piece| piece.cluster + 1).max().unwrap_or(0);
        all.extend(pieces(trace, first));
    }
    all
}

/// Returns the end of the rows of `hold` up to `span_s` after its row `begin`.
fn until(trace: &Trace, hold: &Range<usize>, begin: usize, span_s: f64) -> usize {
    let times_s = trace.times_s();
    let end_s = times_s[begin] + span_s;
    begin + times_s[begin..hold.end].partition_point(|&time_s| time_s < end_s - 1e-9)
}

fn pressures_while_shut(trace: &Trace, first_cluster: usize) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut cluster = first_cluster;
    for hold in trace.log.commands.holds(0.0) {
        let mut begin = hold.start;
        let mut cluster_s = trace.times_s()[begin];
        while begin < hold.end {
            let end = until(trace, &hold, begin, PIECE_S);
            if trace.times_s()[begin] - cluster_s >= CLUSTER_S {
                cluster += 1;
                cluster_s = trace.times_s()[begin];
            }
            let pressures = trace.channel.values[begin..end]
                .iter()
                .filter(|p| p.is_finite());
            let count = pressures.clone().count();
            let mean = pressures.sum::<f64>() / count as f64;
            pieces.extend(piece(trace, begin..end, mean, cluster));
            begin = end;
        }
        cluster += 1;
    }
    pieces
}

/// Returns the slopes between the edges of the time after `valve` has closed.
fn relaxations(trace: &Trace, valve: usize, first_cluster: usize) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for (cluster, hold) in trace.log.commands.holds(0.0).into_iter().enumerate() {
        let opens = |valve, row: usize| {
            trace.in_force[row].is_some_and(|row| trace.log.commands.opens(valve, row))
        };
        let last = (0..hold.start)
            .rev()
            .find(|&row| opens(FILL, row) || opens(VENT, row));
        if !last.is_some_and(|row| opens(valve, row)) {
            continue;
        }
        let begin_s = trace.times_s()[hold.start];
        for edges in RELAXATION_EDGES_S.windows(2) {
            let row = |edge_s: f64| {
                let times_s = &trace.times_s()[hold.clone()];
                hold.start + times_s.partition_point(|&time_s| time_s < begin_s + edge_s - 1e-9)
            };
            let at = f64::midpoint(edges[0], edges[1]);
            pieces.extend(piece(
                trace,
                row(edges[0])..row(edges[1]),
                at,
                first_cluster + cluster,
            ));
        }
    }
    pieces
}

/// Returns the pieces of constant duty in which only `valve` is energised.
fn strokes(trace: &Trace, valve: usize, regime: Regime, first_cluster: usize) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut row = 0;
    while row < trace.len() {
        let begin = row;
        let duty = trace.duty_pct(valve, begin);
        let is_same =
            |row: usize| trace.regimes[row] == regime && trace.duty_pct(valve, row) == duty;
        row += 1;
        if !is_same(begin) {
            continue;
        }
        let latest_s = trace.times_s()[begin] + PIECE_S;
        while row < trace.len() && is_same(row) && trace.times_s()[row] < latest_s {
            row += 1;
        }
        let cluster = (trace.times_s()[begin] / CLUSTER_S) as usize;
        // The flow begins at the row before the first one.
        pieces.extend(piece(
            trace,
            begin.saturating_sub(1)..row,
            duty,
            first_cluster + cluster,
        ));
    }
    pieces
}

fn piece(trace: &Trace, rows: Range<usize>, at: f64, cluster: usize) -> Option<Piece> {
    let samples = rows.len();
    let time_s = *trace.times_s().get(rows.start)?;
    let (bar_per_s, variance) = trace.rate(rows)?;
    (samples >= 4).then_some(Piece {
        at,
        time_s,
        bar_per_s,
        variance,
        cluster,
        samples,
    })
}

fn curve(
    against: &str,
    unit: &str,
    condition: &str,
    pieces: &[Piece],
    edges: Option<&[f64]>,
) -> Option<FlowCurve> {
    let bins = bins(pieces, edges);
    if bins.len() < 2 {
        return None;
    }
    let noise_free = |square: f64, count: usize| square - count as f64;
    let whole: f64 = bins
        .iter()
        .flatten()
        .map(|piece| piece.bar_per_s.powi(2) / piece.variance)
        .sum();
    let count = bins.iter().map(Vec::len).sum();
    let seen = statistic(&bins, |_| 1.0);
    let share =
        noise_free(seen, bins.len()) / noise_free(whole, count).max(noise_free(seen, bins.len()));
    if share.is_nan() || share < LEAST_SHARE || chance(&bins, seen) >= CHANCE {
        return None;
    }
    Some(FlowCurve {
        against: against.to_owned(),
        unit: unit.to_owned(),
        condition: condition.to_owned(),
        explained_share: share.clamp(0.0, 1.0),
        points: bins.iter().map(|bin| point(bin)).collect(),
    })
}

/// Groups pieces: between the edges, or into equally many of neighbouring values.
fn bins(pieces: &[Piece], edges: Option<&[f64]>) -> Vec<Vec<Piece>> {
    let mut sorted = pieces.to_vec();
    sorted.sort_by(|a, b| a.at.total_cmp(&b.at));
    let fewest = (sorted.len() / POINTS).max(PIECES_PER_POINT);
    let mut bins: Vec<Vec<Piece>> = Vec::new();
    for piece in sorted {
        let opens_next = |bin: &Vec<Piece>| {
            let last = bin.last().map_or(piece.at, |last| last.at);
            edges.map_or(bin.len() >= fewest && piece.at > last, |_| piece.at > last)
        };
        match bins.last_mut() {
            Some(bin) if !opens_next(bin) => bin.push(piece),
            _ => bins.push(vec![piece]),
        }
    }
    if let Some(rest) = bins.pop_if(|bin| edges.is_none() && bin.len() < PIECES_PER_POINT) {
        match bins.last_mut() {
            Some(last) => last.extend(rest),
            None => bins.push(rest),
        }
    }
    bins.retain(|bin| bin.len() >= PIECES_PER_POINT);
    bins
}

/// Returns the sum over the bins of (mean over its standard error)².
fn statistic(bins: &[Vec<Piece>], sign: impl Fn(usize) -> f64) -> f64 {
    bins.iter()
        .map(|bin| {
            let sum: f64 = bin
                .iter()
                .map(|piece| sign(piece.cluster) * piece.bar_per_s / piece.variance)
                .sum();
            let weight: f64 = bin.iter().map(|piece| 1.0 / piece.variance).sum();
            sum * sum / weight
        })
        .sum()
}

/// Returns the frequency with which a missing flow of random sign gives as large a statistic: the signs of all clusters are drawn at
/// random.
fn chance(bins: &[Vec<Piece>], seen: f64) -> f64 {
    let clusters = bins
        .iter()
        .flatten()
        .map(|piece| piece.cluster + 1)
        .max()
        .unwrap_or(0);
    let mut noise = Noise::new(1);
    let mut signs = vec![1.0; clusters];
    let as_good = (0..FLIPS)
        .filter(|_| {
            signs.fill_with(|| if noise.uniform() < 0.5 { -1.0 } else { 1.0 });
            statistic(bins, |cluster| signs[cluster]) >= seen
        })
        .count();
    (1 + as_good) as f64 / (1 + FLIPS) as f64
}

fn point(bin: &[Piece]) -> FlowPoint {
    let weight: f64 = bin.iter().map(|piece| 1.0 / piece.variance).sum();
    let mean = |value: fn(&Piece) -> f64| {
        bin.iter()
            .map(|piece| value(piece) / piece.variance)
            .sum::<f64>()
            / weight
    };
    let bar_per_s = mean(|piece| piece.bar_per_s);
    let scatter: f64 = bin
        .iter()
        .map(|piece| ((piece.bar_per_s - bar_per_s) / piece.variance).powi(2))
        .sum();
    let freedom = bin.len() as f64 / (bin.len() as f64 - 1.0);
    FlowPoint {
        at: mean(|piece| piece.at),
        bar_per_s,
        standard_error: (1.0 / weight)
            .max(scatter * freedom / (weight * weight))
            .sqrt(),
        samples: bin.iter().map(|piece| piece.samples).sum(),
    }
}
