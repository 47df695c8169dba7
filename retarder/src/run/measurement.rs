//! Signals of a device in every sample, with the device's own timer.

use std::sync::atomic::{AtomicBool, Ordering};

use ecu::calibration::Signal;
use hil_harness::ecu_under_test::carry_out;
use hil_harness::signals;
use hil_protocol::{MEASURED_MAX, Measured, Request, SignalIds};

use super::Answer;
use crate::cli::MeasureArgs;
use crate::dut::{Dut, Session};
use crate::failure::Failure;
use crate::interrupt;

/// Measured signals, complete up to the end of the measurement.
pub(crate) struct Measurement {
    /// Column names with units, then one line for each sample.
    pub(crate) csv: String,
    /// Number of requested samples.
    pub(crate) wanted: u32,
    /// Number of received samples.
    pub(crate) samples: u32,
    /// Number of lost samples between the first and the last received one: they were not read in time.
    pub(crate) lost: u32,
    signals: Vec<(u16, &'static Signal)>,
    /// Numbers of the first and the last sample.
    span: Option<(u32, u32)>,
}

/// Measures signals until all requested samples came, or until Ctrl-C. Calls `begin` after the first one.
pub(crate) fn run(args: &MeasureArgs, begin: &mut dyn FnMut()) -> Result<Measurement, Failure> {
    let mut measurement = Measurement::new(&args.signals, args.samples)?;
    if args.device.dut == Dut::InProcess {
        return Err(Failure::NoTimer);
    }
    let is_interrupted = interrupt::flag()?;
    let ended = args
        .device
        .dut
        .session(args.device.image.as_deref())
        .and_then(|mut session| measurement.take(session.as_mut(), is_interrupted, begin));
    match ended {
        // Ctrl-C also reaches the emulator: an error after it is the requested interruption.
        Err(_) if is_interrupted.load(Ordering::Relaxed) => {
            let some = (measurement.samples > 0).then_some(measurement);
            some.ok_or(Failure::Interrupted)
        }
        other => other.map(|()| measurement),
    }
}

impl Measurement {
    fn new(names: &[String], wanted: u32) -> Result<Self, Failure> {
        let named = |name: &String| {
            signals::named(name).ok_or_else(|| Failure::NoSuchDeviceSignal { name: name.clone() })
        };
        let signals: Vec<_> = names.iter().map(named).collect::<Result<_, _>>()?;
        if signals.len() > MEASURED_MAX {
            return Err(Failure::TooManySignals {
                count: signals.len(),
            });
        }
        Ok(Self {
            csv: header(&signals),
            wanted,
            samples: 0,
            lost: 0,
            signals,
            span: None,
        })
    }

    /// Returns the answer: pass if all samples came, fail if there are gaps, open if the measurement ended early.
    pub(crate) fn answer(&self) -> Answer {
        if self.samples < self.wanted {
            Answer::Open
        } else {
            Answer::of(self.lost == 0)
        }
    }

    fn take(
        &mut self,
        session: &mut (impl Session + ?Sized),
        is_interrupted: &AtomicBool,
        begin: &mut dyn FnMut(),
    ) -> Result<(), Failure> {
        let ids = self.signals.iter().map(|(id, _)| *id).collect();
        carry_out(session, &Request::Measure { ids })?;
        while self.samples < self.wanted && !is_interrupted.load(Ordering::Relaxed) {
            let (sample, values) = session.measured()?;
            self.add(sample, &values);
            if self.samples == 1 {
                begin();
            }
        }
        let ids = SignalIds::new();
        carry_out(session, &Request::Measure { ids })?;
        Ok(())
    }

    fn add(&mut self, sample: u32, values: &Measured) {
        let (first, last) = self.span.unwrap_or((sample, sample.wrapping_sub(1)));
        let missing = sample.wrapping_sub(last).wrapping_sub(1);
        self.lost = self.lost.saturating_add(missing);
        self.span = Some((first, sample));
        self.samples += 1;
        self.csv += &(f64::from(sample.wrapping_sub(first)) / 100.0).to_string();
        for ((_, signal), value) in self.signals.iter().zip(values) {
            self.csv.push(',');
            let value = signals::value(signal, *value);
            self.csv += &value.map_or_else(String::new, |value| value.to_string());
        }
        self.csv.push('\n');
    }
}

/// Returns the column names with units, as in a bench log.
fn header(signals: &[(u16, &Signal)]) -> String {
    let mut header = "time_s".to_owned();
    for (_, Signal { name, unit, .. }) in signals {
        let unit = match *unit {
            "" => String::new(),
            "%" => "_pct".to_owned(),
            unit => format!("_{}", unit.replace(' ', "_")),
        };
        header += &format!(",{name}{unit}");
    }
    header.push('\n');
    header
}

#[cfg(test)]
mod tests {
    use hil_harness::ecu_under_test::ecu_in_process;
    use hil_harness::link::{Link, LinkError};
    use hil_protocol::{Device as _, Identity, Reply};

    use super::*;

    /// Device that sends samples with these numbers, and Ctrl-C with the last of them.
    struct Scripted<'a> {
        numbers: &'a [u32],
        is_interrupted: &'a AtomicBool,
        identity: Identity,
    }

    impl Link for Scripted<'_> {
        fn identity(&self) -> String {
            "scripted".to_owned()
        }

        fn ask(&mut self, _: &Request) -> Result<Reply, LinkError> {
            Ok(Reply::Done)
        }

        fn take_log(&mut self) -> Result<Vec<String>, LinkError> {
            Ok(Vec::new())
        }
    }

    impl Session for Scripted<'_> {
        fn device(&self) -> &Identity {
            &self.identity
        }

        fn measured(&mut self) -> Result<(u32, Measured), LinkError> {
            let (&number, rest) = self.numbers.split_first().expect("one more sample");
            self.numbers = rest;
            self.is_interrupted
                .store(rest.is_empty(), Ordering::Relaxed);
            Ok((number, Measured::from_iter([1 << 16])))
        }
    }

    /// Measures `wanted` samples of a device that sends these numbers.
    fn measured(wanted: u32, numbers: &[u32]) -> Measurement {
        let is_interrupted = AtomicBool::new(false);
        let mut session = Scripted {
            numbers,
            is_interrupted: &is_interrupted,
            identity: ecu_in_process().open(false),
        };
        let mut measurement = Measurement::new(&["p_ref".to_owned()], wanted).unwrap();
        let mut begun = 0;
        let ended = measurement.take(&mut session, &is_interrupted, &mut || begun += 1);
        ended.unwrap();
        assert_eq!(begun, 1);
        measurement
    }

    #[test]
    fn columns_are_named_as_in_a_bench_log() {
        let signals = ["p_ref", "u", "i_fill", "mode"].map(|name| signals::named(name).unwrap());
        assert_eq!(
            header(&signals),
            "time_s,p_ref_bar_gauge,u_pct,i_fill_mA,mode\n"
        );
    }

    #[test]
    fn as_many_samples_as_wanted_hold_each_at_its_time() {
        let measurement = measured(3, &[7, 8, 9, 10]);
        assert_eq!(
            measurement.csv,
            "time_s,p_ref_bar_gauge\n0,1\n0.01,1\n0.02,1\n"
        );
        assert_eq!(measurement.lost, 0);
        assert_eq!(measurement.answer(), Answer::Holds);
    }

    #[test]
    fn samples_that_did_not_come_are_counted_and_leave_a_gap_in_time() {
        let end = u32::MAX;
        let measurement = measured(3, &[end - 1, 1, 3, 4]);
        assert_eq!(
            measurement.csv,
            "time_s,p_ref_bar_gauge\n0,1\n0.03,1\n0.05,1\n"
        );
        assert_eq!(measurement.lost, 2 + 1);
        assert_eq!(measurement.answer(), Answer::DoesNotHold);
    }

    #[test]
    fn ctrl_c_leaves_every_sample_until_then_and_no_answer() {
        let measurement = measured(1000, &[5, 6]);
        assert_eq!(measurement.csv, "time_s,p_ref_bar_gauge\n0,1\n0.01,1\n");
        assert_eq!((measurement.samples, measurement.wanted), (2, 1000));
        assert_eq!(measurement.answer(), Answer::Open);
    }
}
