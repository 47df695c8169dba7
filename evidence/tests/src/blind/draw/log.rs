//! Conversion of readings into a bench log: noise, resolution of the converters, columns.

use std::fmt::Write;

use crate::chance::Chance;
use crate::reference_plant::Reading;

/// Logger of the rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Logger {
    /// Noise relative to that of a good log.
    pub(super) noise: f64,
    /// ECU samples per row.
    pub(super) samples_per_row: usize,
    /// Whether the pressure is logged.
    pub(super) pressure: bool,
    /// Whether the currents are logged.
    pub(super) currents: bool,
}

/// Noise of a quantity (rms) and step of its converter.
#[derive(Debug, Clone, Copy)]
pub(in crate::blind) struct Channel {
    pub(in crate::blind) noise: f64,
    pub(in crate::blind) step: f64,
}

/// Pressure as read by the ECU of a good rig.
pub(in crate::blind) const PRESSURE_BAR: Channel = Channel {
    noise: 4e-3,
    step: 5.1e-3,
};
const CURRENT_MA: Channel = Channel {
    noise: 0.7,
    step: 0.5,
};
const BATTERY_V: Channel = Channel {
    noise: 20e-3,
    step: 25e-3,
};
const BATTERY: f64 = 24.0;

impl Channel {
    /// Returns the rms of noise and converter steps together.
    pub(in crate::blind) fn rms(&self) -> f64 {
        self.noise.hypot(self.step / 12_f64.sqrt())
    }

    /// Returns the channel of a sensor with this share of the noise, and of a converter with this share of the step.
    pub(in crate::blind) fn scaled(self, share: f64) -> Self {
        Self {
            noise: share * self.noise,
            step: share * self.step,
        }
    }

    /// Returns the converter's reading of `value` with `noise` times its noise.
    pub(in crate::blind) fn read(&self, value: f64, noise: f64, chance: &mut Chance) -> f64 {
        let noisy = value + noise * self.noise * chance.normal();
        // Adding zero removes the sign of a zero.
        (noisy / self.step).round() * self.step + 0.0
    }
}

/// Returns the noise (bar, mA) that is the unit of an excess.
pub(super) fn noise_of(signal: &str) -> f64 {
    if signal == "p_ch" {
        PRESSURE_BAR.noise
    } else {
        CURRENT_MA.noise
    }
}

/// Returns the signals of the reading (bar gauge, mA), in the order of the columns.
pub(in crate::blind) fn signals(reading: &Reading) -> [(&'static str, f64); 3] {
    [
        ("p_ch", reading.pressure * 1e-5),
        ("i_fill", reading.currents[0] * 1e3),
        ("i_vent", reading.currents[1] * 1e3),
    ]
}

impl Logger {
    /// Returns the pressure that the ECU reads (bar gauge).
    pub(super) fn pressure(&self, reading: &Reading, chance: &mut Chance) -> f64 {
        PRESSURE_BAR.read(reading.pressure * 1e-5, self.noise, chance)
    }

    /// Returns the log as CSV. `pressures` are those that the ECU read, one per sample like all others.
    pub(super) fn csv(
        &self,
        commands: &[[f64; 2]],
        readings: &[Reading],
        pressures: &[f64],
        chance: &mut Chance,
    ) -> String {
        let mut text = String::from("time_s,duty_fill_pct,duty_vent_pct");
        if self.pressure {
            text += ",p_ch_bar_gauge";
        }
        if self.currents {
            text += ",i_fill_mA,i_vent_mA";
        }
        text += ",u_bat_V\n";
        for n in (0..commands.len()).step_by(self.samples_per_row) {
            let [fill, vent] = commands[n];
            let mut row = format!("{:.2},{fill:.1},{vent:.1}", n as f64 * 0.01);
            if self.pressure {
                _ = write!(row, ",{:.4}", pressures[n]);
            }
            if self.currents {
                // Means since the previous row.
                let since = &readings[(n + 1).saturating_sub(self.samples_per_row)..=n];
                for valve in 0..2 {
                    let mean =
                        since.iter().map(|r| r.currents[valve]).sum::<f64>() / since.len() as f64;
                    let current = CURRENT_MA.read(1e3 * mean, self.noise, chance);
                    _ = write!(row, ",{current:.1}");
                }
            }
            _ = writeln!(
                text,
                "{row},{:.3}",
                BATTERY_V.read(BATTERY, self.noise, chance)
            );
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STILL: Reading = Reading {
        pressure: 2e5,
        pressure_rate: 0.0,
        currents: [0.1, 0.0],
    };

    fn logged(logger: Logger) -> String {
        let readings: Vec<Reading> = (0..20)
            .map(|n| Reading {
                currents: [f64::from(n) * 1e-3, 0.0],
                ..STILL
            })
            .collect();
        let mut chance = Chance::new(1);
        logger.csv(&[[50.0, 0.0]; 20], &readings, &[2.0; 20], &mut chance)
    }

    #[test]
    fn a_slow_log_holds_means_since_its_row_before() {
        let text = logged(Logger {
            noise: 0.0,
            samples_per_row: 5,
            pressure: true,
            currents: true,
        });
        let rows: Vec<&str> = text.lines().collect();
        assert_eq!(rows.len(), 1 + 4);
        assert_eq!(rows[2], "0.05,50.0,0.0,2.0000,3.0,0.0,24.000");
    }

    #[test]
    fn a_log_has_the_columns_that_were_measured() {
        let header = |pressure, currents| {
            let text = logged(Logger {
                noise: 1.0,
                samples_per_row: 1,
                pressure,
                currents,
            });
            text.lines().next().unwrap().to_owned()
        };
        let all = "time_s,duty_fill_pct,duty_vent_pct,p_ch_bar_gauge,i_fill_mA,i_vent_mA,u_bat_V";
        assert_eq!(header(true, true), all);
        assert_eq!(header(true, false), all.replace(",i_fill_mA,i_vent_mA", ""));
        assert_eq!(header(false, true), all.replace(",p_ch_bar_gauge", ""));
    }
}
