//! Each checker with hand-made recordings: at its limit, one unit below and one unit above.

use recording::{Provenance, Recording, TimeBase, Unit};

use super::*;

const REQUIREMENT: Requirement = Requirement::THESIS;

/// Signals over 10 ms samples, to be modified and judged.
#[derive(Clone)]
struct Made {
    p_ref: Vec<f64>,
    p_ch: Vec<f64>,
    duty_fill: Vec<f64>,
    duty_vent: Vec<f64>,
    actuations_fill: Vec<f64>,
}

impl Made {
    /// Creates signals with the pressure at its reference `bar`, and the valves at rest.
    fn resting_at(bar: f64, samples: usize) -> Self {
        Self {
            p_ref: vec![bar; samples],
            p_ch: vec![bar; samples],
            duty_fill: vec![0.0; samples],
            duty_vent: vec![0.0; samples],
            actuations_fill: vec![0.0; samples],
        }
    }

    /// Creates a step from 2 bar to `to_bar` at sample 10, constant for `held` samples, then back. The pressure follows
    /// at once.
    fn step_to(to_bar: f64, held: usize) -> Self {
        let mut made = Self::resting_at(2.0, 10 + held + 10);
        made.p_ref[10..10 + held].fill(to_bar);
        // The pressure of a sample follows from the sample before.
        made.p_ch[11..=10 + held].fill(to_bar);
        made
    }

    fn recording(&self) -> Recording {
        let mut recording = Recording::new(Provenance::from_source("made by hand"));
        let base = recording.add_time_base(TimeBase::uniform(0.0, 0.01, self.p_ref.len()).unwrap());
        for (name, unit, samples) in [
            ("p_ref", Unit::BarGauge, &self.p_ref),
            ("p_ch", Unit::BarGauge, &self.p_ch),
            ("duty_fill", Unit::Percent, &self.duty_fill),
            ("duty_vent", Unit::Percent, &self.duty_vent),
            ("actuations_fill", Unit::Count, &self.actuations_fill),
            ("actuations_vent", Unit::Count, &vec![0.0; self.p_ref.len()]),
        ] {
            recording
                .add_signal(name, unit, base, samples.clone())
                .unwrap();
        }
        recording
    }

    fn verdict(&self) -> Verdict {
        judge(&self.recording(), &REQUIREMENT).unwrap()
    }

    fn reached(&self, id: CheckId) -> (Option<f64>, bool) {
        let check = self.verdict().check(id).cloned().unwrap();
        (check.reached, check.holds)
    }
}

#[test]
fn a_reference_may_be_reached_in_sample_50_and_not_later() {
    for (arrival, expected) in [(49, true), (50, true), (51, false)] {
        let mut made = Made::step_to(3.0, 80);
        made.p_ch[10..10 + arrival].fill(2.0);
        assert_eq!(
            made.reached(CheckId::SettlingTime),
            (Some(arrival as f64), expected)
        );
        assert_eq!(made.verdict().holds, expected);
    }
}

#[test]
fn a_reference_left_again_is_not_settled_before_the_return() {
    let mut made = Made::step_to(3.0, 80);
    made.p_ch[10 + 30] = 3.2;
    let step = made.verdict().steps[0];
    assert_eq!(
        (step.reached_samples, step.settled_samples),
        (Some(1), Some(31))
    );
    made.p_ch[10 + 60] = 3.2;
    assert_eq!(made.reached(CheckId::SettlingTime), (Some(61.0), false));
}

#[test]
fn a_reference_never_reached_has_no_settling_time_and_does_not_hold() {
    let mut made = Made::step_to(3.0, 80);
    made.p_ch.fill(2.0);
    assert_eq!(made.reached(CheckId::SettlingTime), (None, false));
    assert_eq!(made.reached(CheckId::SteadyError), (Some(1.0), false));
}

#[test]
fn the_tolerance_includes_its_end_on_both_sides() {
    for (error_bar, expected) in [
        (0.099, true),
        (0.1, true),
        (-0.1, true),
        (0.101, false),
        (-0.101, false),
    ] {
        let mut made = Made::step_to(3.0, 80);
        made.p_ch[11..=90].fill(3.0 + error_bar);
        let (reached, holds) = made.reached(CheckId::SteadyError);
        assert!((reached.unwrap() - f64::abs(error_bar)).abs() < 1e-12);
        assert_eq!(holds, expected, "{error_bar} bar");
        assert_eq!(
            made.reached(CheckId::SettlingTime).1,
            expected,
            "{error_bar} bar"
        );
    }
}

#[test]
fn the_steady_error_counts_from_sample_50() {
    for (sample, expected) in [(49, true), (50, false), (51, false)] {
        let mut made = Made::step_to(3.0, 80);
        made.p_ch[10 + sample] = 3.2;
        assert_eq!(made.reached(CheckId::SteadyError).1, expected, "{sample}");
    }
}

#[test]
fn overshoot_is_what_lies_beyond_the_reference_in_the_direction_of_the_step() {
    for (to_bar, peak_bar, expected_bar, holds) in [
        (3.0, 3.1, 0.1, true),
        (3.0, 3.11, 0.11, false),
        (1.6, 1.49, 0.11, false),
        (3.0, 2.7, 0.0, true),
    ] {
        let mut made = Made::step_to(to_bar, 80);
        made.p_ch[15] = peak_bar;
        let (reached, found) = made.reached(CheckId::Overshoot);
        assert!(
            (reached.unwrap() - expected_bar).abs() < 1e-12,
            "{reached:?}"
        );
        assert_eq!(found, holds, "{peak_bar} bar");
    }
}

#[test]
fn only_steps_held_for_t_req_are_judged() {
    for (held, expected) in [(49, 0), (50, 1), (51, 1)] {
        assert_eq!(
            Made::step_to(3.0, held).verdict().steps.len(),
            expected,
            "{held}"
        );
    }
    let nothing_asked = Made::resting_at(3.0, 100).verdict();
    assert!(
        !nothing_asked.holds,
        "a recording without a step proves nothing"
    );
    assert!(nothing_asked.not_exercised.contains(&CheckId::SettlingTime));
}

#[test]
fn a_reference_outside_the_operating_range_is_shown_and_does_not_decide() {
    let mut made = Made::step_to(7.0, 80);
    made.p_ch.fill(2.0);
    let verdict = made.verdict();
    assert!(verdict.check(CheckId::SettlingTime).is_none());
    assert!(
        !verdict
            .check(CheckId::SettlingTimeBeyondOperatingRange)
            .unwrap()
            .holds
    );
    assert!(verdict.holds);
}

/// Creates a passage that takes `samples` after a rest of two samples, on a straight line from `from_bar` to `to_bar`.
fn passage(from_bar: f64, to_bar: f64, reference_bar: f64, samples: f64) -> Made {
    let mut made = Made::resting_at(from_bar, 100);
    made.p_ref[10..].fill(reference_bar);
    for (index, pressure) in made.p_ch.iter_mut().enumerate().skip(12) {
        let way = (index as f64 - 12.0) / samples;
        *pressure = from_bar + way.min(1.5) * (to_bar - from_bar);
    }
    made
}

#[test]
fn filling_takes_less_than_5_samples_with_and_without_the_dead_time() {
    let level = 0.26 * 8.4;
    for (samples, without, with) in [
        (2.99, true, true),
        (3.01, true, false),
        (4.99, true, false),
        (5.01, false, false),
    ] {
        let made = passage(0.0, level, 4.0, samples);
        let (reached, holds) = made.reached(CheckId::FillTime);
        assert!(
            (reached.unwrap() - samples).abs() < 1e-6,
            "{reached:?} for {samples}"
        );
        assert_eq!(holds, without, "{samples}");
        let (reached, holds) = made.reached(CheckId::FillTimeWithDeadTime);
        assert!(
            (reached.unwrap() - samples - 2.0).abs() < 1e-6,
            "{reached:?} for {samples}"
        );
        assert_eq!(holds, with, "{samples}");
    }
    assert!(!Bound::LessThan.allows(Some(5.0), 5.0) && Bound::AtMost.allows(Some(5.0), 5.0));
}

#[test]
fn venting_takes_less_than_two_and_a_half_samples() {
    let [from, to] = [0.88 * 8.4, 0.71 * 8.4];
    for (samples, expected) in [(2.49, true), (2.51, false)] {
        let made = passage(from, to, 3.0, samples);
        let (reached, holds) = made.reached(CheckId::VentTime);
        assert!(
            (reached.unwrap() - samples).abs() < 1e-6,
            "{reached:?} for {samples}"
        );
        assert_eq!(holds, expected, "{samples}");
        assert!(!made.reached(CheckId::VentTimeWithDeadTime).1);
    }
}

#[test]
fn a_passage_is_timed_from_a_reference_at_its_beginning_only() {
    let level = 0.26 * 8.4;
    for (before, expected) in [(0.1, true), (0.11, false)] {
        let made = passage(before, level + before, 4.0, 4.0);
        assert_eq!(
            made.verdict().check(CheckId::FillTime).is_some(),
            expected,
            "{before} bar"
        );
    }
    let too_short = passage(0.0, level, level - 0.01, 4.0);
    assert!(
        too_short
            .verdict()
            .not_exercised
            .contains(&CheckId::FillTime)
    );
}

#[test]
fn a_passage_to_the_reference_itself_ends_at_its_tolerance() {
    let level = 0.26 * 8.4;
    let mut made = passage(0.0, level - 0.1, level, 4.0);
    made.p_ch
        .iter_mut()
        .for_each(|pressure| *pressure = pressure.min(level - 0.1));
    assert!((made.reached(CheckId::FillTime).0.unwrap() - 4.0).abs() < 1e-6);
    made.p_ch
        .iter_mut()
        .for_each(|pressure| *pressure = pressure.min(level - 0.11));
    assert_eq!(made.reached(CheckId::FillTime), (None, false));
}

#[test]
fn one_sample_with_both_valves_is_one_too_many() {
    let mut made = Made::step_to(3.0, 80);
    made.duty_fill[20] = 30.0;
    made.duty_vent[21] = 30.0;
    assert_eq!(made.reached(CheckId::NeverBothValves), (Some(0.0), true));
    made.duty_vent[20] = 30.0;
    assert_eq!(made.reached(CheckId::NeverBothValves), (Some(1.0), false));
    assert!(!made.verdict().holds);
}

#[test]
fn a_duty_cycle_is_0_or_within_its_own_valves_limits() {
    let cases = [
        (0.0, 0.0, true),
        (25.5, 0.0, true),
        (25.4, 0.0, false),
        (82.0, 0.0, true),
        (82.1, 0.0, false),
        (0.0, 80.0, true),
        (0.0, 80.1, false),
        (0.0, 25.4, false),
    ];
    for (fill, vent, expected) in cases {
        let mut made = Made::step_to(3.0, 80);
        (made.duty_fill[20], made.duty_vent[20]) = (fill, vent);
        assert_eq!(
            made.reached(CheckId::DutyLimits).1,
            expected,
            "{fill} {vent}"
        );
    }
}

#[test]
fn at_rest_the_valves_may_move_three_times_within_a_second() {
    for (moves, expected) in [(2, true), (3, true), (4, false)] {
        let mut made = Made::step_to(3.0, 400);
        // One every 33 samples from T_req on: `moves` of them within a second, and none after.
        for index in 0..made.actuations_fill.len() {
            made.actuations_fill[index] = (index.saturating_sub(70).div_ceil(33).min(moves)) as f64;
        }
        let (reached, holds) = made.reached(CheckId::RestActuations);
        assert_eq!((reached, holds), (Some(moves as f64), expected));
    }
    let mut busy_before_t_req = Made::step_to(3.0, 400);
    for index in 0..busy_before_t_req.actuations_fill.len() {
        busy_before_t_req.actuations_fill[index] = index.min(60) as f64;
    }
    assert_eq!(
        busy_before_t_req.reached(CheckId::RestActuations),
        (Some(0.0), true)
    );
    let total = busy_before_t_req.verdict().actuations.unwrap();
    assert_eq!((total.fill, total.vent), (60, 0));
}

#[test]
fn a_verdict_is_not_given_on_samples_that_were_not_logged() {
    let mut gap = Made::step_to(3.0, 80);
    gap.p_ch[30] = f64::NAN;
    let refused = judge(&gap.recording(), &REQUIREMENT).unwrap_err();
    assert_eq!(
        refused,
        JudgeError::MissingSamples {
            name: "p_ch",
            missing: 1,
            samples: 100
        }
    );
    let mut recording = Recording::new(Provenance::from_source("log"));
    let base = recording.add_time_base(TimeBase::uniform(0.0, 0.01, 2).unwrap());
    recording
        .add_signal("p_ref", Unit::BarGauge, base, vec![1.0, 1.0])
        .unwrap();
    assert!(matches!(
        judge(&recording, &REQUIREMENT),
        Err(JudgeError::Signal(_))
    ));
    let mut uneven = Recording::new(Provenance::from_source("log"));
    let base = uneven.add_time_base(TimeBase::new(vec![0.0, 0.01, 0.03]).unwrap());
    uneven
        .add_signal("p_ref", Unit::BarGauge, base, vec![1.0; 3])
        .unwrap();
    assert_eq!(
        judge(&uneven, &REQUIREMENT).unwrap_err(),
        JudgeError::Uneven
    );
}

#[test]
fn a_verdict_survives_json_and_refuses_what_it_does_not_know() {
    let mut made = Made::step_to(3.0, 80);
    made.p_ch.fill(2.0);
    let verdict = made.verdict();
    let json = serde_json::to_string(&verdict).unwrap();
    assert!(
        json.starts_with(r#"{"schema":"retarder.control/3","source":"made by hand","holds":false"#),
        "{json}"
    );
    assert!(
        json.contains(r#""id":"settling_time""#) && json.contains(r#""reached":null"#),
        "{json}"
    );
    assert_eq!(serde_json::from_str::<Verdict>(&json).unwrap(), verdict);
    let unknown = json.replacen("\"holds\"", "\"colour\":1,\"holds\"", 1);
    assert!(serde_json::from_str::<Verdict>(&unknown).is_err());
    for check in &verdict.checks {
        let name = serde_json::to_string(&check.id).unwrap();
        assert_eq!(name, format!("\"{}\"", check.id.name()));
    }
}

/// Two steps to 3 bar, one from below and one from above; the plunger rests at 4.0 and at 4.5 mm and travels 6 mm. After
/// the second step it sticks once on its way.
#[test]
fn a_plunger_that_sticks_is_counted_and_its_rest_positions_are_compared() {
    let held = 60;
    let made = Made {
        p_ref: [2.0, 3.0, 4.0, 3.0].map(|bar| vec![bar; held]).concat(),
        p_ch: [2.0, 3.0, 4.0, 3.0].map(|bar| vec![bar; held]).concat(),
        duty_fill: vec![0.0; 4 * held],
        duty_vent: vec![0.0; 4 * held],
        actuations_fill: vec![0.0; 4 * held],
    };
    let mut position_mm = [0.0, 4.0, 6.0, 4.5].map(|mm| vec![mm; held]).concat();
    // The motions begin a few samples after the steps.
    for (at, before) in [(held, 0.0), (2 * held, 4.0), (3 * held, 6.0)] {
        position_mm[at..at + 5].fill(before);
    }
    position_mm[2 * held + 5..2 * held + 8].fill(5.0);
    let mut recording = made.recording();
    assert_eq!(judge(&recording, &REQUIREMENT).unwrap().plunger, None);
    let base = recording.signal("p_ref").unwrap().time_base();
    recording
        .add_signal("x_plunger", Unit::Millimetre, base, position_mm)
        .unwrap();
    let plunger = judge(&recording, &REQUIREMENT).unwrap().plunger.unwrap();
    assert!((plunger.rest_spread_mm - 0.5).abs() < 1e-12, "{plunger:?}");
    assert!(
        (plunger.rest_spread_share - 0.5 / 6.0).abs() < 1e-12,
        "{plunger:?}"
    );
    assert!(
        (plunger.starts_per_step - 4.0 / 3.0).abs() < 1e-12,
        "{plunger:?}"
    );
}
