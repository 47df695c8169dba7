//! Defects of a log as a result reports them.

use std::ops::Range;

use plant_sim::parameters::PA_PER_BAR;
use recording::{Pause, Recording};

use crate::commands::Commands;
use crate::measured::{Measured, PRESSURE, Restart};
use crate::result::{LogDefects, LogGap, LogSpike, MissingCells};

/// Number of gaps that get a sentence each.
const LISTED_MAX: usize = 5;

impl LogDefects {
    /// Returns whether there are no defects.
    pub fn is_empty(&self) -> bool {
        self.sentences.is_empty()
    }

    /// Returns the defects of `log`, whose signals are `measured`.
    pub(crate) fn of(log: &Recording, commands: &Commands, measured: &[Measured]) -> Self {
        let defects = log.defects();
        let pressure = measured.iter().find(|signal| signal.name == PRESSURE);
        let restart_bar = |rows: &Range<usize>| {
            let restarts = pressure.map_or(&[][..], |pressure| &pressure.restarts);
            let restart = Restart::last_in(restarts, rows)?;
            Some((restart.pressure - pressure?.ambient) / PA_PER_BAR)
        };
        let gaps: Vec<LogGap> = commands
            .gaps
            .iter()
            .map(|gap| LogGap {
                start_s: gap.start_s,
                end_s: gap.end_s,
                samples: gap.rows.len(),
                restart_bar_gauge: restart_bar(&gap.rows),
            })
            .collect();
        let mut sentences = defects.sentences();
        for (gap, of) in gaps.iter().zip(commands.gaps.iter()).take(LISTED_MAX) {
            let of_gap = |pause: &&Pause| [pause.start_s, pause.end_s] == [gap.start_s, gap.end_s];
            let pause = defects.gaps.iter().find(of_gap).map(Pause::sentence);
            let there = pause.and_then(|pause| sentences.iter().position(|there| *there == pause));
            match there {
                Some(there) => sentences[there] += &format!("; {}", gap.consequence()),
                None => sentences.push(gap.sentence(of.is_without_commands)),
            }
        }
        if gaps.len() > LISTED_MAX {
            sentences.push(format!(
                "{} more gaps, in no error either",
                gaps.len() - LISTED_MAX
            ));
        }
        let below_vacuum = pressure.map_or(0, |pressure| pressure.below_vacuum);
        if below_vacuum > 0 {
            sentences.push(format!(
                "{below_vacuum} samples of p_ch are below vacuum at the ambient pressure of the plant file: they count as missing"
            ));
        }
        let spikes: Vec<LogSpike> = measured
            .iter()
            .flat_map(|signal| LogSpike::of(signal, commands))
            .collect();
        for signal in measured.iter().filter(|signal| !signal.spikes.is_empty()) {
            let of_signal = spikes.iter().filter(|spike| spike.signal == signal.name);
            sentences.push(LogSpike::sentence(&of_signal.collect::<Vec<_>>()));
        }
        Self {
            spikes,
            missing: defects
                .missing
                .iter()
                .map(|missing| MissingCells {
                    signal: missing.signal.clone(),
                    cells: missing.cells,
                    out_of_bounds: missing
                        .out_of_bounds
                        .as_ref()
                        .map_or(0, |cells| cells.count),
                })
                .collect(),
            gaps,
            sentences,
        }
    }
}

impl LogSpike {
    fn of(signal: &Measured, commands: &Commands) -> impl Iterator<Item = Self> {
        signal.spikes.iter().map(|spike| Self {
            signal: signal.name.to_owned(),
            unit: signal.error_unit.symbol().to_owned(),
            time_s: commands.times_s[spike.row],
            height: spike.height,
        })
    }

    /// Returns the sentence about all spikes of one signal.
    fn sentence(spikes: &[&Self]) -> String {
        let mut listed: Vec<String> = spikes
            .iter()
            .take(LISTED_MAX)
            .map(|spike| {
                format!(
                    "{:+.3} {} at {:.3} s",
                    spike.height, spike.unit, spike.time_s
                )
            })
            .collect();
        if spikes.len() > LISTED_MAX {
            listed.push(format!("{} more", spikes.len() - LISTED_MAX));
        }
        let what = match spikes.len() {
            1 => "a reading that stands out alone, as with a disturbance of the sensor, counts as missing".to_owned(),
            count => format!(
                "{count} readings that stand out alone, as with disturbances of the sensor, count as missing"
            ),
        };
        format!("{}: {what}: {}", spikes[0].signal, listed.join(", "))
    }
}

impl LogGap {
    fn sentence(&self, is_without_commands: bool) -> String {
        let what = if is_without_commands {
            "no duty cycle"
        } else {
            "gap"
        };
        format!(
            "{what} from {:.3} to {:.3} s: {}",
            self.start_s,
            self.end_s,
            self.consequence()
        )
    }

    fn consequence(&self) -> String {
        let restart = match self.restart_bar_gauge {
            Some(bar) => format!("the model begins again at the measured {bar:.3} bar gauge"),
            None => "the model goes on with the last command".to_owned(),
        };
        format!("{restart}, and {} samples are in no error", self.samples)
    }
}
