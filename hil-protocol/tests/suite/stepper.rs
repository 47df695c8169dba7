//! Device whose answers depend on every sample that it took, once and in order.

use hil_protocol::{
    Actuators, Answer, Device, Identity, ImageIdentity, Measured, Reply, Request, ResetCause,
    Sensors, SettingsSource, Telemetry, VERSION, name,
};

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Stepper {
    state: u32,
    pub(crate) opened: u32,
    pub(crate) steps: u32,
}

impl Stepper {
    pub(crate) fn new() -> Self {
        Self {
            state: 0x1234_5678,
            opened: 0,
            steps: 0,
        }
    }

    pub(crate) fn step(&mut self, sensors: &Sensors) -> Answer {
        let pressure = u32::from(sensors.pressure.unwrap_or(0));
        self.state = (self.state ^ sensors.sample ^ (pressure << 16))
            .wrapping_mul(0x9E37_79B1)
            .rotate_left(13);
        self.steps += 1;
        Answer {
            sample: sensors.sample,
            actuators: Actuators {
                duty_fill: self.state >> 10,
                duty_vent: 0,
            },
            telemetry: Telemetry {
                control_signal: self.state.cast_signed(),
                controller_state: [0; 6],
                mode: 0,
                faults: 0,
                ecu_digest: self.state,
            },
        }
    }
}

impl Device for Stepper {
    fn open(&mut self, _lock_step: bool) -> Identity {
        self.opened += 1;
        Identity {
            version: VERSION,
            boot: 0,
            image: ImageIdentity {
                board: name("stepper"),
                version: name("1"),
                build: 0,
                signals: 0,
                settings: 0,
            },
            reset_cause: ResetCause::PowerOn,
            settings_source: SettingsSource::DefaultsNeverSaved,
            settings_digest: 0,
        }
    }

    fn answer(&mut self, request: &Request) -> Reply {
        match request {
            Request::Sample(sensors) => Reply::Sample {
                answer: self.step(sensors),
                measured: Measured::new(),
            },
            Request::Restart { .. } => {
                self.state = Self::new().state;
                Reply::Done
            }
            _ => Reply::Done,
        }
    }
}
