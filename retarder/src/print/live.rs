//! Live plot of a running loop.

use std::borrow::Cow;
use std::collections::VecDeque;
use std::io::{IsTerminal as _, Write as _};
use std::thread;
use std::time::{Duration, Instant};

use ecu::{FaultSet, Mode};
use hil_harness::Scenario;
use hil_harness::run::Moment;
use hil_harness::wire;
use recording::Trace;

use super::chart::{Chart, Line};
use super::{Colour, Terminal};

/// Time of the run that the plot shows (s).
const WINDOW_S: f64 = 8.0;
/// Lines of the log below the plot.
const LOG_LINES: usize = 4;
/// Time between two pictures.
const REPAINT_EVERY: Duration = Duration::from_millis(50);

/// Moving plot on the standard error, removed on drop; without a terminal it draws nothing.
pub(crate) struct Live {
    terminal: Terminal,
    is_shown: bool,
    scenario: String,
    end_s: f64,
    /// Sample time of the ECU (s).
    sample_s: f64,
    /// Speed relative to real time; 0: no limit.
    pace: u32,
    start: Option<Instant>,
    painted: Option<Instant>,
    /// Lines of the picture on the screen.
    lines: usize,
    times_s: Vec<f64>,
    references: Vec<f64>,
    pressures: Vec<f64>,
    log: VecDeque<String>,
}

impl Live {
    /// Creates a plot without samples.
    pub(crate) fn new(scenario: &Scenario, pace: u32) -> Self {
        Self {
            terminal: Terminal::standard_error(),
            is_shown: std::io::stderr().is_terminal(),
            scenario: scenario.name.clone(),
            end_s: f64::from(scenario.duration_samples) * scenario.plant.ecu.sample_time_s,
            sample_s: scenario.plant.ecu.sample_time_s,
            pace,
            start: None,
            painted: None,
            lines: 0,
            times_s: Vec::new(),
            references: Vec::new(),
            pressures: Vec::new(),
            log: VecDeque::new(),
        }
    }

    /// Takes a sample of the run, and waits until the pace allows the next one.
    pub(crate) fn see(&mut self, moment: &Moment<'_>) {
        if !self.is_shown {
            return;
        }
        self.times_s.push(moment.time_s);
        let reference = moment.exchange.sensors.reference;
        self.references.push(reference.map_or(f64::NAN, wire::bar));
        self.pressures.push(moment.pressure_bar);
        self.log.extend(moment.log.iter().cloned());
        self.log.drain(..self.log.len().saturating_sub(LOG_LINES));
        let is_due = self
            .painted
            .is_none_or(|painted| painted.elapsed() >= REPAINT_EVERY);
        if is_due {
            self.painted = Some(Instant::now());
            self.show(&self.picture(moment));
        }
        self.wait(moment.time_s);
    }

    fn wait(&mut self, time_s: f64) {
        let start = *self.start.get_or_insert_with(Instant::now);
        if self.pace == 0 {
            return;
        }
        let due_s = (time_s - self.times_s[0]) / f64::from(self.pace);
        let due = start + Duration::from_secs_f64(due_s);
        thread::sleep(due.saturating_duration_since(Instant::now()));
    }

    fn picture<'a>(&'a self, moment: &Moment<'_>) -> String {
        let now_s = moment.time_s;
        let from_s = (now_s - WINDOW_S).max(self.times_s[0]);
        let first = self.times_s.partition_point(|time| *time < from_s);
        let trace = |values: &'a [f64]| {
            Trace::new(
                &self.times_s[first..],
                Cow::from(&values[first..]),
                self.sample_s,
            )
        };
        let chart = Chart {
            title: "pressure [bar gauge]",
            lines: vec![
                Line {
                    name: "reference",
                    colour: Colour::Second,
                    mark: Some('×'),
                    trace: trace(&self.references),
                },
                Line {
                    name: "chamber",
                    colour: Colour::First,
                    mark: None,
                    trace: trace(&self.pressures),
                },
            ],
            band: None,
            height: 12,
            span_s: [from_s, from_s + WINDOW_S],
            at_least: Some([0.0, 1.0]),
        };
        let telemetry = &moment.exchange.answer.telemetry;
        let mode = Mode::ALL.get(usize::from(telemetry.mode));
        let mode = mode.map_or_else(String::new, |mode| format!("{mode:?}"));
        let faults = FaultSet::from_bits(telemetry.faults);
        let faults: String = faults.iter().map(|fault| format!(", {fault:?}")).collect();
        let actuators = &moment.exchange.answer.actuators;
        let mut text = self.terminal.paint(
            Colour::Title,
            &format!("{}  {now_s:6.2} of {:.1} s", self.scenario, self.end_s),
        );
        text += &format!(
            "  {mode}{faults}  fill {:3.0} %  vent {:3.0} %\n",
            wire::duty_pct(actuators.duty_fill),
            wire::duty_pct(actuators.duty_vent)
        );
        text += &chart.draw(&self.terminal);
        for line in &self.log {
            let line: String = line
                .chars()
                .take(self.terminal.width.saturating_sub(2))
                .collect();
            text += &format!("  {}\n", self.terminal.paint(Colour::Faint, &line));
        }
        text
    }

    /// Draws the picture over the previous one.
    fn show(&mut self, picture: &str) {
        let mut error = std::io::stderr().lock();
        // A closed standard error is not a failure.
        let _ = write!(error, "{}{picture}", above(self.lines));
        let _ = error.flush();
        self.lines = picture.lines().count();
    }
}

/// Returns the escape sequence that moves up by `lines` and clears the rest of the screen.
fn above(lines: usize) -> String {
    match lines {
        0 => String::new(),
        lines => format!("\u{1b}[{lines}A\u{1b}[J"),
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        if self.lines > 0 {
            self.show("");
        }
    }
}
