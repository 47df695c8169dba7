//! Controller on a board without the other crates of this project: two `embedded-hal` PWM outputs and a pressure
//! source.
//!
//! On a target replace [`Bench`] by the HAL's PWM channels and ADC; [`Loop`] stays unchanged. Here it runs on the host
//! with a chamber model of a few lines and asserts the expected behaviour:
//! ```sh
//! cargo run -p retarder-controller --example embedded_hal_pwm
//! ```

use std::cell::Cell;
use std::convert::Infallible;

use controller::fixed::types::I16F16;
use controller::{Config, Duty, Input, Output, Pressure, Settings, State, step};
use embedded_hal::pwm::{ErrorType, SetDutyCycle};

/// Configuration, checked at compile time: settings out of bounds do not build.
const CONFIG: Config = match Config::new(&Settings::recommended()) {
    Ok(config) => config,
    Err(_) => panic!("settings out of bounds"),
};

/// Source of the chamber pressure: an ADC, a CAN message, a test.
trait PressureSource {
    type Error;
    /// Returns the present chamber pressure.
    fn pressure(&mut self) -> Result<Pressure, Self::Error>;
}

/// Error: a sample did not drive the valves as the controller asked.
#[derive(Debug)]
enum LoopError<S, P> {
    /// No pressure; both valves were turned off.
    Sensor(S),
    /// A PWM output refused its duty cycle.
    Pwm(P),
}

/// Wiring of the controller. Its only decision is to switch the valves off when the pressure is missing.
struct Loop<F, V, S> {
    fill: F,
    vent: V,
    sensor: S,
    /// State of the controller; `None` until the first pressure and after a missing one, so that the controller starts
    /// without a derivative kick.
    state: Option<State>,
}

impl<F, V, S> Loop<F, V, S>
where
    F: SetDutyCycle,
    V: SetDutyCycle<Error = F::Error>,
    S: PressureSource,
{
    /// Runs one sample. Call it once per sample time, 10 ms with these settings.
    fn sample(&mut self, reference: Pressure) -> Result<Output, LoopError<S::Error, F::Error>> {
        let pressure = match self.sensor.pressure() {
            Ok(pressure) => pressure,
            Err(error) => {
                self.state = None;
                self.drive(Output::OFF).map_err(LoopError::Pwm)?;
                return Err(LoopError::Sensor(error));
            }
        };
        let input = Input {
            reference,
            pressure,
        };
        let state = self.state.get_or_insert_with(|| State::new(input));
        let output = step(&CONFIG, state, input);
        self.drive(output).map_err(LoopError::Pwm)?;
        Ok(output)
    }

    fn drive(&mut self, output: Output) -> Result<(), F::Error> {
        // The closing valve is written first, so that both valves are never driven between the two writes.
        if output.duty_fill.is_off() {
            set(&mut self.fill, output.duty_fill)?;
            set(&mut self.vent, output.duty_vent)
        } else {
            set(&mut self.vent, output.duty_vent)?;
            set(&mut self.fill, output.duty_fill)
        }
    }
}

/// Sets the duty cycle: exactly 0 for 0 % and exactly full scale for 100 %.
fn set<P: SetDutyCycle>(pwm: &mut P, duty: Duty) -> Result<(), P::Error> {
    let counts = duty.to_counts(pwm.max_duty_cycle());
    pwm.set_duty_cycle(counts)
}

fn main() {
    let bench = Bench::default();
    let mut control = Loop {
        fill: bench.pwm(&bench.fill),
        vent: bench.pwm(&bench.vent),
        sensor: Sensor(&bench),
        state: None,
    };

    // From ambient pressure to 3 bar: only the fill valve works, and it opens fully at first.
    let three_bar = Pressure::from_bar(I16F16::lit("3"));
    let first = control.sample(three_bar).expect("the sensor works");
    assert_eq!(first.duty_fill.percent(), I16F16::lit("82"));
    assert!(
        bench.run(&mut control, three_bar, 100) <= 20,
        "3 bar are reached within 20 samples"
    );
    assert!(
        (bench.bar() - 3.0).abs() < 0.1,
        "and kept within the tolerance: {} bar",
        bench.bar()
    );

    // The sensor's wire breaks: both valves go off, and the sample returns the error.
    bench.broken.set(true);
    assert!(matches!(
        control.sample(three_bar),
        Err(LoopError::Sensor(BrokenWire))
    ));
    assert_eq!((bench.fill.get(), bench.vent.get()), (0, 0));

    // The wire is repaired and the reference is lower: the vent valve works.
    bench.broken.set(false);
    let one_bar = Pressure::from_bar(I16F16::ONE);
    let vented = control.sample(one_bar).expect("the sensor works again");
    assert!(vented.duty_fill.is_off() && !vented.duty_vent.is_off());
    assert!(
        bench.run(&mut control, one_bar, 100) <= 60,
        "the last of a chamber leaves slowly"
    );
    assert!((bench.bar() - 1.0).abs() < 0.1, "{} bar", bench.bar());

    // The compare values at the ends are exact.
    let mut pwm = bench.pwm(&bench.fill);
    let _ = set(&mut pwm, Duty::FULL);
    assert_eq!(bench.fill.get(), Bench::COUNTS_MAX);
    let _ = set(&mut pwm, Duty::OFF);
    assert_eq!(bench.fill.get(), 0);
    println!("3 bar, a broken wire, 1 bar: all as expected");
}

/// Chamber with two valves, driven by the compare values of two timer channels.
#[derive(Default)]
struct Bench {
    fill: Cell<u16>,
    vent: Cell<u16>,
    bar: Cell<f64>,
    broken: Cell<bool>,
}

impl Bench {
    /// A timer of 1 MHz counts 10 000 in a PWM period of 10 ms.
    const COUNTS_MAX: u16 = 10_000;

    fn pwm<'a>(&self, channel: &'a Cell<u16>) -> Channel<'a> {
        Channel(channel)
    }

    fn bar(&self) -> f64 {
        self.bar.get()
    }

    /// Runs a number of samples of 10 ms and returns the number of the last one in which a valve was driven.
    fn run(
        &self,
        control: &mut Loop<Channel<'_>, Channel<'_>, Sensor<'_>>,
        reference: Pressure,
        samples: u32,
    ) -> u32 {
        let mut last_driven = 0;
        for sample in 0..samples {
            if control
                .sample(reference)
                .is_ok_and(|output| output != Output::OFF)
            {
                last_driven = sample;
            }
            self.flow();
        }
        last_driven
    }

    /// Computes the flow of one sample: a valve is open for the part of its duty cycle above the half that the coil
    /// needs.
    fn flow(&self) {
        let open = |counts: &Cell<u16>| {
            (f64::from(counts.get()) / f64::from(Self::COUNTS_MAX) - 0.25).max(0.0)
        };
        let bar = self.bar.get();
        let filled = 0.08 * open(&self.fill) * (8.4 - bar).max(0.0);
        let vented = 0.08 * open(&self.vent) * bar;
        self.bar.set(bar + filled - vented);
    }
}

struct Channel<'a>(&'a Cell<u16>);

impl ErrorType for Channel<'_> {
    type Error = Infallible;
}

impl SetDutyCycle for Channel<'_> {
    fn max_duty_cycle(&self) -> u16 {
        Bench::COUNTS_MAX
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        self.0.set(duty);
        Ok(())
    }
}

#[derive(Debug)]
struct BrokenWire;

struct Sensor<'a>(&'a Bench);

impl PressureSource for Sensor<'_> {
    type Error = BrokenWire;

    fn pressure(&mut self) -> Result<Pressure, BrokenWire> {
        // 10 bits over 10 bar, as an ADC gives them: integers from here on.
        let code = (self.0.bar() / 10.0 * 1023.0).round() as i32;
        if self.0.broken.get() {
            return Err(BrokenWire);
        }
        Ok(Pressure::from_bits(code * 10 * 65_536 / 1023))
    }
}
