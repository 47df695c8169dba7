//! Text of the comparison of model and measurement.

use std::borrow::Cow;

use model_lab::result::{
    Horizon, RegimeBin, RegimeShares, SignalComparison, TimeOffset, Traces, Warning,
};
use recording::{Recording, Trace, Unit};

use super::chart::{Chart, Line};
use super::diagnosis::conditions;
use super::number::{or_dash, percent, signed, significant};
use super::table::{Align, Table, bar, verdict};
use super::{Colour, Terminal, painted_paragraph, paragraph, title};
use crate::run::Answer;
use crate::run::compare::Compared;

/// Returns the whole comparison.
pub(super) fn comparison(compared: &Compared, terminal: &Terminal) -> String {
    let focus = compared.focus();
    let mut text = head(compared, terminal);
    text += "\n";
    text += &signals(compared, terminal);
    text += "\n";
    for signal in &compared.comparison.signals {
        text += &finding(signal, terminal);
    }
    for left_out in &compared.comparison.not_compared {
        text += &paragraph(
            &format!("{} is not compared: {}", left_out.name, left_out.reason),
            terminal,
        );
    }
    text += "\n";
    text += &plots(compared, terminal);
    text += "\n";
    if compared.shows_regimes() {
        text += &title(&format!("Where the error of {} is", focus.name), terminal);
        text += &regimes(focus, &focus.regimes, terminal);
        text += "\n";
    }
    text + &answer(compared, terminal)
}

/// Returns the names of what was compared.
pub(super) fn head(compared: &Compared, terminal: &Terminal) -> String {
    let comparison = &compared.comparison;
    let mut text = title(
        &format!("{} compared with {}", compared.plant.name, comparison.log),
        terminal,
    );
    let mut facts = format!(
        "{} samples, {:.2} s; the model starts {}.",
        comparison.samples, comparison.duration_s, comparison.start.statement
    );
    if comparison.held_commands > 0 {
        facts += &format!(
            " In {} samples a duty cycle is missing and the last one was held.",
            comparison.held_commands
        );
    }
    text += &paragraph(&facts, terminal);
    text += &conditions(&comparison.clock, &comparison.start_gas, terminal);
    for sentence in &comparison.defects.sentences {
        text += &painted_paragraph(Colour::Notice, &format!("Log: {sentence}."), terminal);
    }
    text + &warnings(&comparison.warnings, terminal)
}

/// Returns the warnings about columns that are probably declared wrongly.
pub(super) fn warnings(found: &[Warning], terminal: &Terminal) -> String {
    let sentences = found
        .iter()
        .map(|warning| format!("Warning: {}.", warning.statement));
    sentences
        .map(|sentence| painted_paragraph(Colour::Notice, &sentence, terminal))
        .collect()
}

/// Returns the table of signals.
pub(super) fn signals(compared: &Compared, terminal: &Terminal) -> String {
    let mut table = Table::new(
        [
            ("signal", Align::Left),
            ("noise", Align::Right),
            ("rms", Align::Right),
            ("×noise", Align::Right),
            ("limit", Align::Right),
            ("worst", Align::Right),
            ("at s", Align::Right),
            ("fit %", Align::Right),
            ("one step", Align::Right),
            ("", Align::Left),
        ],
        terminal,
    );
    for signal in &compared.comparison.signals {
        let free = &signal.free_run;
        table.row([
            format!("{} [{}]", signal.name, signal.unit).into(),
            or_dash(signal.noise_floor.value, |value| significant(value, 2)).into(),
            significant(free.rms, 3).into(),
            or_dash(free.rms_in_noise, |value| significant(value, 3)).into(),
            or_dash(signal.limit, |value| significant(value, 2)).into(),
            signed(free.worst, 3).into(),
            format!("{:.2}", free.worst_time_s).into(),
            or_dash(free.fit_pct, |value| format!("{value:.1}")).into(),
            or_dash(signal.one_step_ahead.as_ref(), |short| {
                significant(short.rms, 3)
            })
            .into(),
            verdict(signal.holds),
        ]);
    }
    let mut text = table.to_string();
    let horizon = match &compared.comparison.predictor {
        None => String::new(),
        Some(predictor) => format!(
            " one step: one-step-ahead prediction, the model corrected by the measured {} after each sample.",
            predictor.signal
        ),
    };
    text += &painted_paragraph(
        Colour::Faint,
        &format!(
            "Errors are measured minus modelled. rms: the model driven by the duty cycles alone.{horizon}"
        ),
        terminal,
    );
    text
}

/// Returns the finding of one signal outside its tolerance.
pub(super) fn finding(signal: &SignalComparison, terminal: &Terminal) -> String {
    if signal.holds == Some(true) {
        return String::new();
    }
    let mut sentence = format!("{}: {}.", signal.name, signal.finding.sentence);
    if let Some(offset) = signal
        .time_offset
        .as_ref()
        .filter(|offset| is_clear(offset))
    {
        sentence += &format!(" {}.", offset.statement);
    }
    paragraph(&sentence, terminal)
}

/// Returns whether the time offset is reported: at least half a millisecond, and it explains at least a fifth of the
/// mismatch.
fn is_clear(offset: &TimeOffset) -> bool {
    offset.lag_ms.abs() >= 0.5 && offset.mismatch_explained >= 0.2
}

/// Returns the plots of measured and modelled signal, and of the residual with the noise.
pub(super) fn plots(compared: &Compared, terminal: &Terminal) -> String {
    let signal = compared.focus();
    let traces = &compared.comparison.traces;
    let measured = trace(
        &compared.log,
        &signal.name,
        traces.free_run.signal(&signal.name).map(|s| s.unit()),
    );
    let modelled = trace(&traces.free_run, &signal.name, None);
    let residual = residual(traces, &signal.name);
    let (Some(measured), Some(modelled), Some(residual)) = (measured, modelled, residual) else {
        return String::new();
    };
    let times_s = modelled.trace.times_s();
    let span_s = [times_s[0], times_s[times_s.len() - 1]];
    let overlay_title = format!("{} [{}]", signal.name, modelled.unit.symbol());
    let overlay = Chart {
        title: &overlay_title,
        lines: vec![
            Line {
                name: "measured",
                colour: Colour::First,
                mark: None,
                trace: measured.trace,
            },
            Line {
                name: "modelled",
                colour: Colour::Second,
                mark: Some('×'),
                trace: modelled.trace,
            },
        ],
        band: None,
        height: 12,
        span_s,
        at_least: None,
    };
    let residual_title = format!("measured - modelled [{}]", signal.unit);
    let noise = signal.noise_floor.value.map(|value| {
        (
            value,
            format!("noise ±{} {}", significant(value, 2), signal.unit),
        )
    });
    let residual_chart = Chart {
        title: &residual_title,
        lines: vec![Line {
            name: "residual",
            colour: Colour::First,
            mark: None,
            trace: residual,
        }],
        band: noise.as_ref().map(|(value, name)| (*value, name.as_str())),
        height: 9,
        span_s,
        at_least: None,
    };
    overlay.draw(terminal) + "\n" + &residual_chart.draw(terminal)
}

/// Time series with its unit.
struct ShownTrace<'a> {
    trace: Trace<'a>,
    unit: Unit,
}

/// Returns measured minus modelled of the signal `name`.
fn residual<'a>(traces: &'a Traces, name: &str) -> Option<Trace<'a>> {
    let residual = traces.free_run_residual(name)?;
    Trace::on(&traces.free_run, name, residual.iter().collect())
}

/// Returns the signal `name` in `unit`, or as logged if it cannot be converted.
fn trace<'a>(recording: &'a Recording, name: &str, unit: Option<Unit>) -> Option<ShownTrace<'a>> {
    let signal = recording.signal(name)?;
    let logged = signal.unit();
    let converted = unit.filter(|&unit| unit != logged).and_then(|unit| {
        let values = signal.values_at_ambient(unit, recording::STANDARD_ATMOSPHERE_PA);
        Some((Cow::Owned(values.ok()?), unit))
    });
    let (values, unit) = converted.unwrap_or((Cow::Borrowed(signal.values_or_nan()), logged));
    Some(ShownTrace {
        trace: Trace::on(recording, name, values)?,
        unit,
    })
}

/// Width of the bars of the shares (characters).
const BAR: usize = 10;

/// Returns the table of shares of the excess error.
pub(super) fn regimes(
    signal: &SignalComparison,
    dimensions: &[RegimeShares],
    terminal: &Terminal,
) -> String {
    let bias = format!("bias [{}]", signal.unit);
    let rms = format!("rms [{}]", signal.unit);
    let mut table = Table::new(
        [
            ("regime", Align::Left),
            ("samples", Align::Right),
            ("excess", Align::Right),
            ("", Align::Left),
            (&bias, Align::Right),
            (&rms, Align::Right),
            ("free", Align::Right),
        ],
        terminal,
    );
    for dimension in dimensions {
        table.heading(&dimension.title);
        for bin in &dimension.bins {
            let local = local(bin);
            table.row([
                format!("  {}", bin.label).into(),
                percent(bin.sample_share).into(),
                or_dash(local.excess_share, percent).into(),
                super::table::painted(Colour::Notice, bar(local.excess_share.unwrap_or(0.0), BAR)),
                signed(local.bias, 2).into(),
                significant(local.rms, 3).into(),
                or_dash(bin.free_run.excess_share, percent).into(),
            ]);
        }
    }
    let mut text = table.to_string();
    let which = match signal.finding.horizon {
        Horizon::OneStepAhead => {
            "excess: share of the error beyond the noise, one step ahead, where an error does not accumulate. \
             free: the same in free run, where it does."
        }
        Horizon::FreeRun => "excess: share of the error beyond the noise.",
    };
    text += &painted_paragraph(Colour::Faint, which, terminal);
    text
}

fn local(bin: &RegimeBin) -> &model_lab::result::BinError {
    bin.one_step_ahead.as_ref().unwrap_or(&bin.free_run)
}

/// Returns the verdict as a sentence.
pub(super) fn answer(compared: &Compared, terminal: &Terminal) -> String {
    let verdict = &compared.comparison.verdict;
    let (colour, sentence) = match compared.answer() {
        Answer::Holds => (Colour::Good, format!("Pass: {}.", verdict.rule)),
        Answer::DoesNotHold | Answer::PlantFileWrong => (
            Colour::Bad,
            format!(
                "Outside tolerance: {}. The rule: {}.",
                verdict.failing.join(", "),
                verdict.rule
            ),
        ),
        Answer::Open => (
            Colour::Notice,
            format!(
                "No verdict: the noise of {} is unknown. Say what is small enough: --tolerance {}=RMS.",
                verdict.undecided.join(", "),
                verdict.undecided.first().map_or("p_ch", String::as_str)
            ),
        ),
    };
    painted_paragraph(colour, &sentence, terminal)
}
