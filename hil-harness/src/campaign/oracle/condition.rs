//! Which faults of the table are present, by what is on the wire and at the coils.

use ecu::Supervision;

use super::Seen;
use super::memory::Memory;
use super::way::Way;
use crate::campaign::bounds;

/// A row of the table, or several that are seen and answered alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Condition {
    Doubt,
    Stuck,
    Offset,
    /// No rise, uncommanded fall, supply lost.
    TooLittle,
    /// No fall, uncommanded rise.
    TooMuch,
    FillCoilOpen,
    FillCoilShort,
    VentCoilOpen,
    VentCoilShort,
    Battery,
    SampleTime,
    Reference,
    Memory,
}

impl Condition {
    const ALL: [Self; 13] = [
        Self::Doubt,
        Self::Stuck,
        Self::Offset,
        Self::TooLittle,
        Self::TooMuch,
        Self::FillCoilOpen,
        Self::FillCoilShort,
        Self::VentCoilOpen,
        Self::VentCoilShort,
        Self::Battery,
        Self::SampleTime,
        Self::Reference,
        Self::Memory,
    ];

    /// N \[samples\] and the way.
    const fn rule(self) -> (u32, Way) {
        match self {
            Self::Doubt => (bounds::DOUBT_N, Way::Hold),
            // Counted by the condition itself.
            Self::Stuck => (1, Way::Release),
            Self::Offset => (1, Way::Vent),
            Self::TooLittle => (bounds::RESPONSE_N, Way::Ramp),
            Self::TooMuch => (bounds::RESPONSE_N, Way::Vent),
            Self::FillCoilOpen => (bounds::COIL_N, Way::Ramp),
            Self::FillCoilShort => (bounds::COIL_N, Way::Vent),
            Self::VentCoilOpen | Self::VentCoilShort => (bounds::COIL_N, Way::Off),
            Self::Battery => (bounds::BATTERY_N, Way::Hold),
            Self::SampleTime => (bounds::SAMPLE_TIME_N, Way::Release),
            Self::Reference => (bounds::REFERENCE_N, Way::Ramp),
            Self::Memory => (bounds::MEMORY_N, Way::Lock),
        }
    }
}

/// A condition over time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watch {
    pub(super) condition: Condition,
    /// Samples in a row in which it was present.
    present_for: u32,
    /// Samples since it was present last.
    quiet_for: u32,
    is_answered: bool,
    /// Samples since it was gone: absent N times in a row.
    gone_for: u32,
    /// Nothing at all was present for so long before it was \[samples\].
    calm_before: u32,
}

impl Watch {
    const fn new(condition: Condition) -> Self {
        Self {
            condition,
            present_for: 0,
            quiet_for: u32::MAX,
            is_answered: false,
            gone_for: 0,
            calm_before: 0,
        }
    }

    fn look(&mut self, is_present: bool, calm_for: u32) {
        let (n, _) = self.condition.rule();
        if is_present {
            if self.present_for == 0 {
                self.calm_before = calm_for;
            }
            self.present_for += 1;
            self.quiet_for = 0;
        } else {
            self.present_for = 0;
            self.quiet_for = self.quiet_for.saturating_add(1);
        }
        if self.present_for >= n {
            self.is_answered = true;
            self.gone_for = 0;
        } else if self.gone_for > 0 || self.quiet_for >= n {
            self.gone_for = self.gone_for.saturating_add(1);
            self.is_answered &= self.gone_for < bounds::RECOVERY_N;
        }
    }

    pub(super) fn way(&self) -> Way {
        self.condition.rule().1
    }

    /// Whether it had to be answered, and is not gone for long enough.
    pub(super) fn is_answered(&self) -> bool {
        self.is_answered
    }

    /// Whether the target was certainly not on a way already when this began.
    pub(super) fn is_first(&self) -> bool {
        self.calm_before >= bounds::AWAY_SAMPLES
    }

    /// Samples since the one in which it had to be answered, while it is present without a break.
    pub(super) fn answered_for(&self) -> Option<u32> {
        self.present_for
            .checked_sub(self.condition.rule().0)
            .filter(|_| self.is_answered)
    }
}

/// All of them.
#[derive(Debug)]
pub(super) struct Conditions {
    rig: Rig,
    watches: [Watch; 13],
    /// Samples without any.
    calm_for: u32,
    /// The last pressure that nothing spoke against [bar gauge].
    believed_bar: Option<f64>,
    /// The pressure of the sample before, unless it was in doubt [bar gauge].
    before_bar: Option<f64>,
    last_reference_bar: f64,
    /// Samples since the reference stepped.
    rested_for: u32,
    is_in_doubt: bool,
    /// Samples in a row with a jump against the pressure that is believed.
    doubts: u32,
    /// Samples in a row in which nothing spoke against the pressure, jumps from it aside.
    sound_for: u32,
    code: Option<u16>,
    unmoved: u32,
    /// Samples for which the vented chamber has shown a pressure; it is forgotten as slowly.
    offset_evidence: u32,
    is_offset: bool,
    too_little_bar: f64,
    too_much_bar: f64,
}

/// What the supervision knows of the rig, in the oracle's units.
#[derive(Debug)]
struct Rig {
    supply_min_bar: f64,
    supply_max_bar: f64,
    jump_bar: f64,
    /// Change per sample and pressure difference, at least.
    rise: f64,
    fall: f64,
    open_pct: [f64; 2],
    battery_mv: [f64; 2],
    coil_ma: [f64; 2],
}

const SAMPLE_S: f64 = 0.01;
const AMBIENT_BAR: f64 = 1.02;

impl Rig {
    fn new(known: &Supervision) -> Self {
        let rate = |rate: f64| rate * SAMPLE_S;
        let fill = rate(known.fill_rate_per_s.to_num());
        let vent = rate(known.vent_rate_per_s.to_num());
        let supply_max_bar: f64 = known.supply_pressure_max_bar.to_num();
        Self {
            supply_min_bar: known.supply_pressure_min_bar.to_num(),
            supply_max_bar,
            jump_bar: bounds::JUMP_FACTOR * fill.max(vent) * (supply_max_bar + AMBIENT_BAR),
            rise: bounds::RESPONSE_FACTOR * fill,
            fall: bounds::RESPONSE_FACTOR * vent,
            open_pct: [
                known.open_duty_fill_pct.to_num(),
                known.open_duty_vent_pct.to_num(),
            ],
            battery_mv: [known.battery_min_v, known.battery_max_v]
                .map(|volt| 1e3 * volt.to_num::<f64>()),
            coil_ma: [known.coil_current_min_ma, known.coil_current_max_ma].map(|ma| ma.to_num()),
        }
    }
}

impl Conditions {
    pub(super) fn new(supervision: &Supervision) -> Self {
        Self {
            rig: Rig::new(supervision),
            watches: Condition::ALL.map(Watch::new),
            calm_for: u32::MAX,
            believed_bar: None,
            before_bar: None,
            last_reference_bar: 0.0,
            rested_for: 0,
            is_in_doubt: false,
            doubts: 0,
            sound_for: 0,
            code: None,
            unmoved: 0,
            offset_evidence: 0,
            is_offset: false,
            too_little_bar: 0.0,
            too_much_bar: 0.0,
        }
    }

    /// The target has started: it knows nothing of what was before.
    pub(super) fn forget(&mut self) {
        let rig = core::mem::replace(&mut self.rig, Rig::new(&Supervision::nominal()));
        *self = Self {
            rig,
            ..Self::new(&Supervision::nominal())
        };
    }

    pub(super) fn look(&mut self, seen: &Seen, memory: &Memory) {
        let reference_bar = self.reference_bar(seen).unwrap_or(self.last_reference_bar);
        let has_stepped = (reference_bar - self.last_reference_bar).abs() > bounds::STEP_BAR;
        let moved_bar = seen
            .shown_bar()
            .zip(self.believed_bar)
            .map_or(0.0, |(shown, before)| (shown - before).abs());
        // Faster than a valve can.
        let has_stepped = has_stepped || moved_bar > bounds::FASTEST_BAR;
        self.rested_for = if has_stepped {
            0
        } else {
            self.rested_for.saturating_add(1)
        };
        self.last_reference_bar = reference_bar;
        self.is_in_doubt = self.doubt(seen);
        let is_stuck = self.stuck(seen, memory);
        let is_offset = self.offset(seen, memory);
        let [too_little, too_much] = self.response(seen, memory);
        let [fill_open, fill_short] = self.coil(0, seen.sensors.current_fill_ma, memory);
        let [vent_open, vent_short] = self.coil(1, seen.sensors.current_vent_ma, memory);
        let present = [
            self.is_in_doubt,
            is_stuck,
            is_offset,
            too_little,
            too_much,
            fill_open,
            fill_short,
            vent_open,
            vent_short,
            self.battery(seen),
            !(bounds::ELAPSED_MIN_US..=bounds::ELAPSED_MAX_US).contains(&seen.sensors.elapsed_us),
            self.reference_bar(seen).is_none(),
            seen.is_damaged,
        ];
        for (watch, is_present) in self.watches.iter_mut().zip(present) {
            watch.look(is_present, self.calm_for);
        }
        self.calm_for = if present.contains(&true) {
            0
        } else {
            self.calm_for.saturating_add(1)
        };
    }

    /// Whether this sample's pressure cannot be believed.
    pub(super) fn is_in_doubt(&self) -> bool {
        self.is_in_doubt
    }

    /// Those that had to be answered and are not gone.
    pub(super) fn answered(&self) -> impl Iterator<Item = &Watch> {
        self.watches.iter().filter(|watch| watch.is_answered())
    }

    /// The one that had to be answered, if no other one was present lately.
    pub(super) fn only(&self) -> Option<&Watch> {
        let mut lately = self
            .watches
            .iter()
            .filter(|watch| watch.quiet_for < 2 * bounds::RECOVERY_N);
        lately
            .next()
            .filter(|watch| watch.is_answered() && lately.next().is_none())
    }

    /// The reference on the wire, if somebody can mean it [bar gauge].
    pub(super) fn reference_bar(&self, seen: &Seen) -> Option<f64> {
        let bar = f64::from(seen.sensors.reference?) / 65536.0;
        (-1.0..=self.rig.supply_max_bar)
            .contains(&bar)
            .then_some(bar)
    }

    /// The last of those [bar gauge]; zero before the first.
    pub(super) fn last_reference_bar(&self) -> f64 {
        self.last_reference_bar
    }

    /// Whether the reference has not stepped lately: a derivative part answers to its step, and not to the pressure.
    pub(super) fn reference_rests(&self) -> bool {
        self.rested_for >= bounds::SETTLING
    }

    fn doubt(&mut self, seen: &Seen) -> bool {
        let highest_bar = self.rig.supply_max_bar + bounds::ABOVE_SUPPLY_BAR + 0.01;
        let is_code = |bar: f64| {
            seen.sensors
                .pressure
                .is_some_and(|code| code >= bounds::CODE_MIN)
                && bar <= highest_bar
        };
        let Some(shown_bar) = seen.shown_bar().filter(|&bar| is_code(bar)) else {
            self.sound_for = 0;
            return true;
        };
        let moved_bar = self
            .believed_bar
            .map_or(0.0, |believed| (shown_bar - believed).abs());
        // Against which pressure a target judges that was in doubt a moment ago is its own affair.
        let is_sure = self.sound_for >= bounds::HOLD_SAMPLES && self.doubts < bounds::DOUBT_N;
        let has_jumped = is_sure && moved_bar > self.rig.jump_bar + 0.02;
        if has_jumped {
            self.doubts += 1;
        } else {
            let was_doubted = self.doubts > 0 || moved_bar > self.rig.jump_bar - 0.02;
            self.doubts = 0;
            self.sound_for = if was_doubted {
                0
            } else {
                self.sound_for.saturating_add(1)
            };
            self.believed_bar = Some(shown_bar);
        }
        has_jumped
    }

    fn stuck(&mut self, seen: &Seen, memory: &Memory) -> bool {
        let [fill, vent] = memory.coils().unwrap_or_default();
        let is_driven = seen.shown_bar().is_some_and(|shown| {
            fill > 0.0 && shown < self.rig.supply_min_bar - 0.01
                || vent > 0.0 && shown > bounds::ROOM_TO_FALL_BAR
        });
        if seen.sensors.pressure.is_none() || seen.sensors.pressure != self.code {
            self.code = seen.sensors.pressure;
            self.unmoved = 0;
        } else if is_driven {
            self.unmoved += 1;
        }
        self.unmoved >= bounds::STUCK_N
    }

    fn offset(&mut self, seen: &Seen, memory: &Memory) -> bool {
        let is_vented = memory.coil_settled(1, |duty| duty >= self.rig.open_pct[1])
            && memory.coil_settled(0, |duty| duty == 0.0);
        let is_shown = seen
            .shown_bar()
            .is_some_and(|shown| shown > bounds::EMPTY_BAR + 0.01);
        self.offset_evidence = match (is_shown, is_vented) {
            (false, _) => 0,
            (true, true) => (self.offset_evidence + 1).min(bounds::OFFSET_N),
            (true, false) if self.is_offset => self.offset_evidence.saturating_sub(1),
            (true, false) => 0,
        };
        // A few samples less than until nobody remembers.
        let is_remembered = self.is_offset && self.offset_evidence > bounds::SETTLING;
        self.is_offset = self.offset_evidence >= bounds::OFFSET_N || is_remembered;
        self.is_offset
    }

    /// Too little and too much pressure for what the coils got: two cumulative sums, on what the sensor shows.
    fn response(&mut self, seen: &Seen, memory: &Memory) -> [bool; 2] {
        let is_believed = !self.is_in_doubt && self.sound_for >= bounds::RECOVERY_N;
        let shown_bar = seen.shown_bar().filter(|_| is_believed);
        let before_bar = core::mem::replace(&mut self.before_bar, shown_bar);
        let (Some(shown_bar), Some(before_bar)) = (shown_bar, before_bar) else {
            (self.too_little_bar, self.too_much_bar) = (0.0, 0.0);
            return [false; 2];
        };
        let change_bar = shown_bar - before_bar;
        let is_off = |valve| memory.coil_settled(valve, |duty| duty == 0.0);
        let is_open =
            |valve: usize| memory.coil_settled(valve, |duty| duty >= self.rig.open_pct[valve]);
        let rise_bar = self.rig.rise
            * (self.rig.supply_min_bar - shown_bar).max(0.0)
            * f64::from(u8::from(is_open(0)));
        let fall_bar = self.rig.fall * shown_bar.max(0.0) * f64::from(u8::from(is_open(1)));
        let summed = |sum: f64, unexplained: f64, counts: bool| {
            // Held a little above the limit, so that what is over is soon forgotten.
            if counts {
                (sum + unexplained).clamp(0.0, bounds::UNEXPLAINED_BAR + 0.02)
            } else {
                0.0
            }
        };
        let (vent_off, fill_off) = (is_off(1), is_off(0));
        self.too_little_bar = summed(
            self.too_little_bar,
            rise_bar - bounds::CREEP_BAR - change_bar,
            vent_off,
        );
        self.too_much_bar = summed(
            self.too_much_bar,
            change_bar + fall_bar - bounds::CREEP_BAR,
            fill_off,
        );
        [self.too_little_bar, self.too_much_bar].map(|sum| sum > bounds::UNEXPLAINED_BAR)
    }

    /// Open and short.
    fn coil(&self, valve: usize, current_ma: Option<u16>, memory: &Memory) -> [bool; 2] {
        let Some(current_ma) = current_ma.map(f64::from) else {
            return [false; 2];
        };
        let [min_ma, max_ma] = self.rig.coil_ma;
        let is_energised = memory.coil_settled(valve, |duty| duty >= bounds::ENERGISED_PCT);
        let is_off = memory.coil_settled(valve, |duty| duty == 0.0);
        // A milliampere for rounding on the wire.
        [
            is_energised && current_ma < min_ma - 1.0,
            current_ma > max_ma + 1.0 || is_off && current_ma > min_ma + 1.0,
        ]
    }

    fn battery(&self, seen: &Seen) -> bool {
        let [min_mv, max_mv] = self.rig.battery_mv;
        let is_outside = |mv: f64| mv < min_mv - 1.0 || mv > max_mv + 1.0;
        seen.sensors
            .battery_mv
            .map(f64::from)
            .is_some_and(is_outside)
    }
}
