//! Defects of a log as a result reports them.

use std::ops::Range;

use plant_sim::parameters::PA_PER_BAR;
use recording::{Pause, Recording};

use crate::commands::Commands;
use crate::measured::{Measured, PRESSURE, Restart};
use crate::result::{LogDefects, LogGap, LogRepeat, LogSpike, MissingCells};

/// Number of gaps that get a sentence each, and of spikes and repeated readings that are listed.
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
        let of_signals = spikes.chunk_by(|a, b| a.signal == b.signal);
        sentences.extend(of_signals.map(LogSpike::sentence));
        let repeats: Vec<LogRepeat> = measured
            .iter()
            .flat_map(|signal| LogRepeat::of(signal, commands))
            .collect();
        let of_signals = repeats.chunk_by(|a, b| a.signal == b.signal);
        sentences.extend(of_signals.map(LogRepeat::sentence));
        Self {
            repeats,
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
            time_s: commands.times_s[spike.rows.start],
            duration_s: commands.times_s[spike.rows.end - 1] - commands.times_s[spike.rows.start],
            height: spike.height,
        })
    }

    /// Returns the sentence about all spikes of one signal.
    fn sentence(spikes: &[Self]) -> String {
        let of_one = |spike: &Self| {
            let height = format!(
                "{:+.3} {} at {:.3} s",
                spike.height, spike.unit, spike.time_s
            );
            match spike.duration_s {
                0.0 => height,
                duration_s => format!("{height} for {duration_s:.3} s"),
            }
        };
        let times = match spikes.len() {
            1 => "once".to_owned(),
            count => format!("{count} times"),
        };
        format!(
            "readings of {} stand out alone {times}, as with a disturbance of the sensor, and count as missing: {}",
            spikes[0].signal,
            listed(spikes, of_one)
        )
    }
}

impl LogRepeat {
    fn of(signal: &Measured, commands: &Commands) -> impl Iterator<Item = Self> {
        signal.repeats.iter().map(|repeat| {
            let [first_s, last_s] =
                [repeat.rows.start, repeat.rows.end - 1].map(|row| commands.times_s[row]);
            Self {
                signal: signal.name.to_owned(),
                unit: signal.error_unit.symbol().to_owned(),
                time_s: first_s,
                duration_s: last_s - first_s,
                value: repeat.value,
            }
        })
    }

    /// Returns the sentence about all repeated readings of one signal.
    fn sentence(repeats: &[Self]) -> String {
        let of_one = |repeat: &Self| {
            format!(
                "{:.3} {} for {:.3} s at {:.3} s",
                repeat.value, repeat.unit, repeat.duration_s, repeat.time_s
            )
        };
        format!(
            "the same reading of {} repeats for longer than the noise lets it, as where a converter is at its end or a logger gets no new \
             value, and counts as missing: {}",
            repeats[0].signal,
            listed(repeats, of_one)
        )
    }
}

/// Returns the first few of `all` in words, and the number of the others.
fn listed<T>(all: &[T], of_one: impl Fn(&T) -> String) -> String {
    let mut listed: Vec<String> = all.iter().take(LISTED_MAX).map(of_one).collect();
    if all.len() > LISTED_MAX {
        listed.push(format!("{} more", all.len() - LISTED_MAX));
    }
    listed.join(", ")
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
