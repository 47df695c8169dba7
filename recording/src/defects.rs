//! Defects of a recording: rows that the logger did not write, and cells without a value.

use crate::united::OwnRate;
use crate::{OutOfBounds, Recording, Sampling, Signal};

/// Gaps and missing cells of a recording; [`Defects::sentences`] has one sentence for each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Defects {
    /// Pauses of the logger in every time base, in order of time; the first [`Defects::LISTED_MAX`].
    pub gaps: Vec<Pause>,
    /// Number of all pauses.
    pub gap_count: usize,
    /// Signals with missing cells.
    pub missing: Vec<MissingCells>,
    /// Rows that were skipped because the reader could not accept them.
    pub skipped: Vec<SkippedRow>,
}

/// Row that the reader skipped.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SkippedRow {
    /// Line in the file, from 1.
    pub line: u64,
    /// Found and expected text.
    pub reason: String,
}

impl SkippedRow {
    /// Returns a sentence with line and reason.
    pub fn sentence(&self) -> String {
        format!("line {} is skipped: {}", self.line, self.reason)
    }
}

/// Interval without rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pause {
    /// Instant of the last row before the pause (s).
    pub start_s: f64,
    /// Instant of the first row after the pause (s).
    pub end_s: f64,
    /// Number of missing rows, from the median distance of two rows.
    pub rows: f64,
}

/// Cells of a signal without a value.
#[derive(Clone, Debug, PartialEq)]
pub struct MissingCells {
    /// Name of the signal.
    pub signal: String,
    /// Number of these cells, including those out of bounds.
    pub cells: usize,
    /// Number of all cells.
    pub of: usize,
    /// Instant of the first of these cells (s).
    pub first_s: f64,
    /// Whether the signal counts as sampled at the other rows only, at a lower rate.
    pub has_own_rate: bool,
    /// Cells that had a value out of bounds.
    pub out_of_bounds: Option<OutOfBounds>,
}

impl Recording {
    /// Returns gaps and missing cells.
    pub fn defects(&self) -> Defects {
        let mut defects = Defects {
            skipped: self.skipped_rows().to_vec(),
            ..Defects::default()
        };
        for (_, base) in self.time_bases() {
            let sampling = base.sampling();
            let step_s = sampling.median_step_s.unwrap_or(f64::INFINITY);
            defects.gap_count += sampling.gaps.len();
            defects.gaps.extend(sampling.gaps.iter().map(|gap| Pause {
                start_s: gap.start_s,
                end_s: gap.end_s,
                rows: (gap.end_s - gap.start_s) / step_s - 1.0,
            }));
        }
        defects.gaps.truncate(Defects::LISTED_MAX);
        for signal in self.signals() {
            let cells = signal.missing_count();
            let first = signal
                .values_or_nan()
                .iter()
                .position(|value| value.is_nan());
            let base = self.time_base(signal.time_base());
            if let (Some(first), Some(base)) = (first, base) {
                let outside = self.out_of_bounds().iter();
                defects.missing.push(MissingCells {
                    signal: signal.name().to_owned(),
                    cells,
                    of: signal.len(),
                    first_s: base.times_s()[first],
                    has_own_rate: signal.own_rows().is_some(),
                    out_of_bounds: outside
                        .clone()
                        .find(|cells| cells.signal == signal.name())
                        .cloned(),
                });
            }
        }
        defects
    }
}

/// Counter of the defects of a log that is read in pieces; its memory does not grow with the log.
#[derive(Clone, Debug, Default)]
pub struct DefectCounter {
    /// Median distance of two rows of the first piece (s).
    step_s: Option<f64>,
    last_s: Option<f64>,
    gaps: Vec<Pause>,
    gap_count: usize,
    signals: Vec<Cells>,
}

/// Cells of a signal counted so far.
#[derive(Clone, Debug)]
struct Cells {
    signal: String,
    missing: usize,
    of: usize,
    first_s: Option<f64>,
    rate: OwnRate,
}

impl DefectCounter {
    /// Adds the next rows. Each piece has the same signals on one time base; the first piece gives the distance of the
    /// rows.
    pub fn add(&mut self, piece: &Recording) {
        let Some((_, base)) = piece.time_bases().next() else {
            return;
        };
        let step_s = *self
            .step_s
            .get_or_insert_with(|| base.sampling().median_step_s.unwrap_or(f64::INFINITY));
        for &time_s in base.times_s() {
            let last_s = self.last_s.replace(time_s).unwrap_or(time_s);
            if time_s - last_s > Sampling::GAP_IN_MEDIAN_STEPS * step_s {
                self.gap_count += 1;
                if self.gaps.len() < Defects::LISTED_MAX {
                    self.gaps.push(Pause {
                        start_s: last_s,
                        end_s: time_s,
                        rows: (time_s - last_s) / step_s - 1.0,
                    });
                }
            }
        }
        if self.signals.is_empty() {
            self.signals = piece.signals().iter().map(Cells::none_of).collect();
        }
        for (cells, signal) in self.signals.iter_mut().zip(piece.signals()) {
            cells.of += signal.len();
            let values = signal.values_or_nan().iter().zip(base.times_s());
            for (value, &time_s) in values {
                cells.rate.add(!value.is_nan());
                if value.is_nan() {
                    cells.missing += 1;
                    cells.first_s.get_or_insert(time_s);
                }
            }
        }
    }

    /// Returns the counted defects; `out_of_bounds` contains the cells that the reader refused.
    pub fn finish<'a>(
        self,
        out_of_bounds: impl Iterator<Item = &'a OutOfBounds> + Clone,
    ) -> Defects {
        let missing = self.signals.into_iter().filter_map(|cells| {
            Some(MissingCells {
                first_s: cells.first_s?,
                has_own_rate: cells.rate.is_own(),
                cells: cells.missing,
                of: cells.of,
                out_of_bounds: out_of_bounds
                    .clone()
                    .find(|outside| outside.signal == cells.signal)
                    .cloned(),
                signal: cells.signal,
            })
        });
        Defects {
            missing: missing.collect(),
            gaps: self.gaps,
            gap_count: self.gap_count,
            skipped: Vec::new(),
        }
    }
}

impl Cells {
    fn none_of(signal: &Signal) -> Self {
        Self {
            signal: signal.name().to_owned(),
            missing: 0,
            of: 0,
            first_s: None,
            rate: OwnRate::default(),
        }
    }
}

impl Defects {
    /// Maximum number of listed pauses.
    pub const LISTED_MAX: usize = 100;

    /// Returns whether there are no defects.
    pub fn is_empty(&self) -> bool {
        self.gap_count == 0 && self.missing.is_empty() && self.skipped.is_empty()
    }

    /// Returns one sentence for each defect, without a full stop; of many pauses only the first ones.
    pub fn sentences(&self) -> Vec<String> {
        /// Maximum number of pauses with a sentence each.
        const SENTENCES_MAX: usize = 5;
        let mut sentences: Vec<String> = self
            .gaps
            .iter()
            .take(SENTENCES_MAX)
            .map(Pause::sentence)
            .collect();
        if self.gap_count > SENTENCES_MAX {
            sentences.push(format!(
                "{} more pauses without rows",
                self.gap_count - SENTENCES_MAX
            ));
        }
        sentences.extend(self.missing.iter().map(MissingCells::sentence));
        sentences.extend(self.skipped.iter().map(SkippedRow::sentence));
        sentences
    }
}

impl Pause {
    /// Returns a sentence with the missing rows and their times.
    pub fn sentence(&self) -> String {
        format!(
            "no rows from {:.3} to {:.3} s ({:.3} s, about {:.0} samples)",
            self.start_s,
            self.end_s,
            self.end_s - self.start_s,
            self.rows
        )
    }
}

impl MissingCells {
    /// Returns a sentence with the number of missing cells and those out of bounds.
    pub fn sentence(&self) -> String {
        let begin = format!(
            "{} of {} cells of {} are missing, the first at {:.3} s{}",
            self.cells,
            self.of,
            self.signal,
            self.first_s,
            match self.has_own_rate {
                true => "; it counts as sampled at the other rows only",
                false => "",
            }
        );
        match &self.out_of_bounds {
            Some(cells) => format!("{begin}; {cells}"),
            None => begin,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::DefectCounter;
    use crate::csv::{Options, read};

    #[test]
    fn pauses_and_missing_cells_are_reported_and_nothing_else() {
        let whole = (0..50).map(|row| format!("{:.2},1.5,280\n", f64::from(row) * 0.01));
        let header = "time_s,p_ch_bar_gauge,i_fill_mA\n";
        let of = |rows: Vec<String>| {
            let log = format!("{header}{}", rows.concat());
            read("log.csv", log.as_bytes(), &Options::default())
                .unwrap()
                .defects()
        };
        let rows: Vec<String> = whole.collect();
        assert!(of(rows.clone()).is_empty());
        let mut wrong = rows;
        wrong[30] = "0.30,,1e200\n".to_owned();
        wrong[31] = "0.31,,280\n".to_owned();
        wrong.drain(10..20);
        let defects = of(wrong);
        assert_eq!(
            defects.sentences(),
            [
                "no rows from 0.090 to 0.200 s (0.110 s, about 10 samples)",
                "2 of 40 cells of p_ch are missing, the first at 0.300 s",
                "1 of 40 cells of i_fill are missing, the first at 0.300 s; 1 cell of i_fill out of bounds \
                 (allowed: -1000000 to 1000000 mA), counted as missing: line 22, column 3: \
                 1e200 mA"
            ]
        );
    }

    #[test]
    fn a_slow_signal_is_reported_to_have_its_own_rows() {
        let cell = |row: u32| if row.is_multiple_of(5) { "1.5" } else { "" };
        let rows = (0..60).map(|row| format!("{:.2},{},280\n", f64::from(row) * 0.01, cell(row)));
        let log = format!(
            "time_s,p_ch_bar_gauge,i_fill_mA\n{}",
            rows.collect::<String>()
        );
        let log = read("log.csv", log.as_bytes(), &Options::default()).unwrap();
        assert_eq!(
            log.defects().sentences(),
            [
                "48 of 60 cells of p_ch are missing, the first at 0.010 s; it counts as sampled at the other rows only"
            ]
        );
    }

    /// For any division into pieces, the defects are those of the whole.
    #[test]
    fn defects_that_are_counted_in_pieces_are_those_of_the_whole() {
        let cell = |row: u32| match row {
            7 | 8 | 40 => String::new(),
            12 => "1e200".to_owned(),
            _ => "1.5".to_owned(),
        };
        let line = |row: u32| format!("{:.2},{},280\n", f64::from(row) * 0.01, cell(row));
        let log = |rows: &mut dyn Iterator<Item = u32>| {
            let lines: String = rows.map(line).collect();
            let log = format!("time_s,p_ch_bar_gauge,i_fill_mA\n{lines}");
            read("log.csv", log.as_bytes(), &Options::default()).unwrap()
        };
        let is_there = |row: &u32| !(20..30).contains(row);
        let whole = log(&mut (0..60).filter(is_there));
        for piece in [3, 10, 20, 25, 60] {
            let mut counter = DefectCounter::default();
            for begin in (0..60).step_by(piece) {
                let end = begin + piece as u32;
                let mut rows = (begin..end.min(60)).filter(is_there).peekable();
                if rows.peek().is_some() {
                    counter.add(&log(&mut rows));
                }
            }
            assert_eq!(
                counter.finish(whole.out_of_bounds().iter()).sentences(),
                whole.defects().sentences(),
                "{piece}"
            );
        }
        assert_eq!(whole.defects().sentences().len(), 2);
    }
}
