//! Summary of a table, row by row, in constant memory.

use core::cmp::Ordering;
use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::columns::{COLUMNS, Column, Field};
use super::row::{RigRow, names_in};

/// Summary of the rows of many rigs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Summary {
    /// Number of rigs.
    pub rigs: u32,
    /// Number of rigs on which every binding check passes.
    pub rigs_that_hold: u32,
    /// Number of rigs on which each binding check fails, by its name.
    pub failed_checks: BTreeMap<String, u32>,
    /// Number of rigs on which the ECU confirmed each fault, by its name.
    pub confirmed_faults: BTreeMap<String, u32>,
    /// Operating conditions, by the name of their column.
    pub conditions: BTreeMap<String, Extent>,
    /// Figures, by the name of their column.
    pub figures: BTreeMap<String, FigureSummary>,
    /// Number of rigs whose slowest step settles after each number of samples.
    pub settling_worst_samples: BTreeMap<u32, u32>,
    /// Row of the worst rig: one that fails, with the most late steps, the slowest step, the largest errors.
    pub worst: Option<RigRow>,
}

/// Lowest and highest value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Extent {
    /// Lowest value, in the unit of the column.
    pub low: f64,
    /// Highest value, in the unit of the column.
    pub high: f64,
}

/// Summary of one figure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FigureSummary {
    /// Number of rigs that have the figure.
    pub rigs: u32,
    /// Mean of these rigs, in the unit of the column.
    pub mean: f64,
    /// Largest value, in the unit of the column.
    pub worst: f64,
    /// First rig with the largest value.
    pub worst_rig: u32,
}

impl Summary {
    /// Adds a row.
    pub fn add(&mut self, row: &RigRow) {
        self.rigs += 1;
        self.rigs_that_hold += u32::from(row.holds);
        let count = |counts: &mut BTreeMap<String, u32>, names: &str| {
            names_in(names).for_each(|name| *counts.entry(name.to_owned()).or_default() += 1);
        };
        count(&mut self.failed_checks, &row.failed_checks);
        count(&mut self.confirmed_faults, &row.confirmed_faults);
        let mut values = row.clone();
        for Column { name, field, .. } in &COLUMNS {
            match field {
                Field::Condition(of) => {
                    if let Some(value) = *of(&mut values) {
                        let extent = self.conditions.entry((*name).to_owned());
                        extent
                            .and_modify(|extent| extent.add(value))
                            .or_insert(Extent {
                                low: value,
                                high: value,
                            });
                    }
                }
                Field::Figure(of) => {
                    if let Some(value) = *of(&mut values) {
                        let figure = self.figures.entry((*name).to_owned());
                        figure
                            .and_modify(|figure| figure.add(row.rig, value))
                            .or_insert(FigureSummary {
                                rigs: 1,
                                mean: value,
                                worst: value,
                                worst_rig: row.rig,
                            });
                    }
                }
                Field::Count(_) | Field::Seed(_) | Field::Flag(_) | Field::Names(_) => {}
            }
        }
        if let Some(samples) = row.settling_worst_samples {
            *self
                .settling_worst_samples
                .entry(samples as u32)
                .or_default() += 1;
        }
        let is_worse = |worst: &RigRow| compare(row, worst) == Ordering::Greater;
        if self.worst.as_ref().is_none_or(is_worse) {
            self.worst = Some(row.clone());
        }
    }

    /// Returns whether every binding check passes on every rig.
    pub fn holds(&self) -> bool {
        self.rigs_that_hold == self.rigs
    }

    /// Returns the time within which the slowest step settles on this share of the rigs, 0 to 1 (samples); `None` if it
    /// never does on too many.
    pub fn settling_quantile(&self, share: f64) -> Option<u32> {
        let rank = (share * f64::from(self.rigs)).ceil().max(1.0);
        let mut settled = 0;
        let times = self.settling_worst_samples.iter();
        times
            .map(|(&samples, &rigs)| {
                settled += rigs;
                (samples, settled)
            })
            .find(|&(_, settled)| f64::from(settled) >= rank)
            .map(|(samples, _)| samples)
    }
}

impl Extent {
    fn add(&mut self, value: f64) {
        self.low = self.low.min(value);
        self.high = self.high.max(value);
    }
}

impl FigureSummary {
    fn add(&mut self, rig: u32, value: f64) {
        self.rigs += 1;
        self.mean += (value - self.mean) / f64::from(self.rigs);
        if value > self.worst {
            (self.worst, self.worst_rig) = (value, rig);
        }
    }
}

/// Compares two rigs; the greater one is worse.
fn compare(one: &RigRow, other: &RigRow) -> Ordering {
    let key = |row: &RigRow| {
        // A step that never settles is the slowest one.
        let slowest = row.settling_worst_samples.unwrap_or(f64::INFINITY);
        [
            f64::from(u8::from(!row.holds)),
            f64::from(row.late_steps),
            if row.steps == 0 { 0.0 } else { slowest },
            row.steady_error_bar.unwrap_or_default(),
            row.overshoot_bar.unwrap_or_default(),
        ]
    };
    let pairs = key(one).into_iter().zip(key(other));
    let mut orders = pairs.map(|(one, other)| one.total_cmp(&other));
    orders
        .find(|order| order.is_ne())
        .unwrap_or(Ordering::Equal)
}
