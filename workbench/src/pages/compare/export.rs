//! Export of the visible range, as a log that all readers of the project accept.

use std::fmt::Display;

use recording::csv::Decimals;
use recording::{Note, Provenance, Recording, Signal, TimeBase, TimeBaseId, Unit};

use crate::pages::points::Range;
use crate::refusal::Refusal;
use crate::session::Session;

pub(super) fn csv(session: &Session, number: u32, range: Range) -> Result<Vec<u8>, Refusal> {
    let (recording, time_base) = visible(session, number, range)?;
    recording::csv::write(Vec::new(), &recording, time_base, &Decimals::shortest())
        .map_err(not_written)
}

pub(super) fn mf4(session: &Session, number: u32, range: Range) -> Result<Vec<u8>, Refusal> {
    let (recording, _) = visible(session, number, range)?;
    recording::mf4::write(Vec::new(), &recording).map_err(not_written)
}

fn not_written(error: impl Display) -> Refusal {
    Refusal::value(error.to_string())
}

/// Returns measured, modelled and residual of every signal on the log's first time base, in `range`.
fn visible(
    session: &Session,
    number: u32,
    range: Range,
) -> Result<(Recording, TimeBaseId), Refusal> {
    let log = session.log(number)?;
    let log = log.as_ref().as_ref().map_err(Clone::clone)?;
    let recording = &log.recording;
    let Some((id, base)) = recording.time_bases().next() else {
        return Err(Refusal::not_found("time base"));
    };
    let (within, _) = range.of(base)?;
    if within.is_empty() {
        return Err(Refusal::value("there is no sample in this range; zoom out"));
    }
    let provenance = Provenance::from_source(recording.provenance().source.clone())
        .with_note("producer", concat!("retarder ", env!("CARGO_PKG_VERSION")));
    let mut out = Recording::new(Provenance {
        start: recording.provenance().start,
        ..provenance
    });
    let times_s = base.times_s()[within.clone()].to_vec();
    let out_id = out.add_time_base(TimeBase::new(times_s).map_err(not_written)?);
    let mut add = |name: &str, unit: Unit, samples: Vec<f64>| {
        out.add_signal(name, unit, out_id, samples)
            .map(drop)
            .map_err(not_written)
    };
    let compared = session.comparison(number);
    let on_base = |signal: &&Signal| signal.time_base() == id;
    let mut renamed = Vec::new();
    for signal in recording.signals().iter().filter(on_base) {
        let visible = |signal: &Signal| {
            (
                signal.unit(),
                signal.values_or_nan()[within.clone()].to_vec(),
            )
        };
        let (unit, measured) = visible(signal);
        add(signal.name(), unit, measured)?;
        let Some(compared) = &compared else { continue };
        let traces = &compared.comparison.traces;
        let errors = traces.free_run_residual(signal.name());
        let model = errors.and_then(|_| traces.free_run.signal(signal.name()));
        let errors = errors.zip(traces.residual_unit(signal.name()));
        let errors =
            errors.map(|(errors, unit)| (unit, errors.part(within.clone()).iter().collect()));
        let model = model.map(visible);
        for (kind, trace) in [("model", model), ("residual", errors)] {
            let Some((unit, samples)) = trace else {
                continue;
            };
            let wanted = format!("{}_{kind}", signal.name());
            let name = free_name(recording, &wanted);
            add(&name, unit, samples)?;
            if name != wanted {
                renamed.push((
                    name,
                    format!(
                        "{kind} of {}; the log has a channel {wanted}",
                        signal.name()
                    ),
                ));
            }
        }
    }
    for (key, value) in renamed {
        out.provenance_mut().notes.push(Note { key, value });
    }
    Ok((out, out_id))
}

/// Returns `wanted`, or `wanted` with the first number that makes it unique if the log has such a channel.
fn free_name(log: &Recording, wanted: &str) -> String {
    let numbered = (2..).map(|number| format!("{wanted}_{number}"));
    std::iter::once(wanted.to_owned())
        .chain(numbered)
        .find(|name| log.signal(name).is_none())
        .unwrap_or_else(|| unreachable!("a log has fewer signals than there are numbers"))
}
