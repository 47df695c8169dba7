//! Black box: recording, trigger, resets, damaged memory.

use ecu::black_box::{BlackBox, SAMPLES_AFTER, words};
use hil_protocol::{BlackBoxRecord, BlackBoxStatus, RECORDS_MAX, Refusal, ResetCause};
use proptest::prelude::*;

const RECORDS: usize = 512;
const WORDS: usize = words(RECORDS);

type Memory = [u32; WORDS];

fn empty() -> BlackBox<Memory> {
    BlackBox::adopt([0; WORDS], ResetCause::PowerOn)
}

fn sample(number: u32, faults: u32) -> BlackBoxRecord {
    BlackBoxRecord {
        number,
        reference: (!number.is_multiple_of(7)).then_some(number.cast_signed() * -3),
        pressure: (!number.is_multiple_of(5)).then_some(number as u16 & 0xFFF),
        duty_fill: number * 11,
        duty_vent: number * 13,
        control_signal: -number.cast_signed(),
        mode: number as u8,
        faults,
    }
}

fn record(
    black_box: &mut BlackBox<impl AsRef<[u32]> + AsMut<[u32]>>,
    numbers: std::ops::Range<u32>,
    faults: u32,
) {
    for number in numbers {
        // The box assigns the number.
        black_box.record(BlackBoxRecord {
            number: 0,
            ..sample(number, faults)
        });
    }
}

/// Returns all records of all pages, and the number of torn ones.
fn contents(black_box: &BlackBox<impl AsRef<[u32]> + AsMut<[u32]>>) -> (Vec<BlackBoxRecord>, u16) {
    let pages = black_box.page(0).unwrap().pages;
    let (mut records, mut torn) = (Vec::new(), 0);
    for page in 0..pages {
        let page = black_box.page(page).unwrap();
        assert_eq!(page.pages, pages);
        records.extend(page.records);
        torn += page.torn;
    }
    let error = black_box.page(pages).unwrap_err();
    assert_eq!(error, Refusal::UnknownPage { page: pages, pages });
    (records, torn)
}

#[test]
fn it_keeps_the_samples_before_the_first_fault_and_some_after_it() {
    let mut black_box = empty();
    record(&mut black_box, 0..2_000, 0);
    assert_eq!(black_box.status(), BlackBoxStatus::Recording);
    record(&mut black_box, 2_000..2_001, 0b10);
    let (number, faults) = (2_000, 0b10);
    assert_eq!(
        black_box.status(),
        BlackBoxStatus::Triggered { number, faults }
    );
    record(&mut black_box, 2_001..2_000 + SAMPLES_AFTER, 0b11);
    assert_eq!(
        black_box.status(),
        BlackBoxStatus::Triggered { number, faults }
    );
    record(
        &mut black_box,
        2_000 + SAMPLES_AFTER..2_001 + SAMPLES_AFTER,
        0b11,
    );
    assert_eq!(
        black_box.status(),
        BlackBoxStatus::Frozen { number, faults }
    );
    // The second fault is mostly a consequence of the first: nothing more is recorded.
    record(&mut black_box, 5_000..9_000, 0b100);
    let last = 2_000 + SAMPLES_AFTER;
    let expected: Vec<_> = (last + 1 - RECORDS as u32..=last)
        .map(|number| match number {
            ..2_000 => sample(number, 0),
            2_000 => sample(number, 0b10),
            _ => sample(number, 0b11),
        })
        .collect();
    assert_eq!(contents(&black_box), (expected, 0));
}

#[test]
fn it_records_again_once_it_was_cleared_and_the_old_records_are_gone() {
    let mut black_box = empty();
    record(&mut black_box, 0..700, 1);
    black_box.clear();
    assert_eq!(black_box.status(), BlackBoxStatus::Recording);
    assert_eq!(contents(&black_box), (vec![], 0));
    record(&mut black_box, 0..3, 0);
    let expected = (0..3).map(|number| sample(number, 0)).collect();
    assert_eq!(contents(&black_box), (expected, 0));
}

#[test]
fn a_page_holds_so_many_records_and_the_last_one_the_rest() {
    let mut black_box = empty();
    record(&mut black_box, 0..2 * RECORDS_MAX as u32 + 1, 0);
    let lengths: Vec<usize> = (0..3)
        .map(|page| black_box.page(page).unwrap().records.len())
        .collect();
    assert_eq!(lengths, [RECORDS_MAX, RECORDS_MAX, 1]);
}

#[test]
fn a_sample_writes_one_record_whatever_the_ring_holds() {
    let mut memory: Memory = [0; WORDS];
    for number in 0..3 * RECORDS as u32 {
        let before = memory;
        let mut black_box = BlackBox::adopt(&mut memory[..], ResetCause::Software);
        record(&mut black_box, number..number + 1, 0);
        let changed: Vec<usize> = (0..WORDS)
            .filter(|&word| memory[word] != before[word])
            .collect();
        if number > 0 {
            assert!(
                changed.last().unwrap() - changed[0] < 8,
                "{number}: {changed:?}"
            );
        }
    }
}

#[test]
fn a_reset_that_nobody_asked_for_freezes_it() {
    for (cause, status) in [
        (ResetCause::Watchdog, BlackBoxStatus::FrozenByReset),
        (ResetCause::Panic, BlackBoxStatus::FrozenByReset),
        (ResetCause::Exception, BlackBoxStatus::FrozenByReset),
        (ResetCause::Brownout, BlackBoxStatus::FrozenByReset),
        (ResetCause::Unknown, BlackBoxStatus::FrozenByReset),
        (ResetCause::Software, BlackBoxStatus::Recording),
        (ResetCause::Pin, BlackBoxStatus::Recording),
        (ResetCause::PowerOn, BlackBoxStatus::Recording),
    ] {
        let mut memory: Memory = [0; WORDS];
        let mut before = BlackBox::adopt(&mut memory[..], ResetCause::PowerOn);
        record(&mut before, 0..600, 0);
        let mut after = BlackBox::adopt(&mut memory[..], cause);
        assert_eq!(after.status(), status, "{cause:?}");
        record(&mut after, 600..601, 0);
        let last = if status == BlackBoxStatus::Recording {
            600
        } else {
            599
        };
        let (records, torn) = contents(&after);
        assert_eq!((records.len(), torn), (RECORDS, 0));
        assert_eq!(records.last(), Some(&sample(last, 0)), "{cause:?}");
    }
}

#[test]
fn a_reset_after_the_fault_keeps_what_there_is() {
    let mut memory: Memory = [0; WORDS];
    let mut before = BlackBox::adopt(&mut memory[..], ResetCause::PowerOn);
    record(&mut before, 0..10, 0);
    record(&mut before, 10..12, 4);
    let mut after = BlackBox::adopt(&mut memory[..], ResetCause::Software);
    let frozen = BlackBoxStatus::Frozen {
        number: 10,
        faults: 4,
    };
    assert_eq!(after.status(), frozen);
    record(&mut after, 12..20, 4);
    assert_eq!(contents(&after).0.len(), 12);
    let again = BlackBox::adopt(&mut memory[..], ResetCause::Watchdog);
    assert_eq!(again.status(), frozen);
}

/// A reset after each of the words of a record: only that record is missing.
#[test]
fn a_record_torn_by_a_reset_is_distinguished_from_a_whole_one() {
    for recorded in [5, RECORDS as u32 + 5] {
        let mut memory: Memory = [0; WORDS];
        let mut black_box = BlackBox::adopt(&mut memory[..], ResetCause::PowerOn);
        record(&mut black_box, 0..recorded, 0);
        let mut next = memory;
        let mut black_box = BlackBox::adopt(&mut next[..], ResetCause::Software);
        record(&mut black_box, recorded..recorded + 1, 0);
        let changed: Vec<usize> = (0..WORDS)
            .filter(|&word| memory[word] != next[word])
            .collect();
        for written in 0..changed.len() {
            let mut torn_memory = memory;
            for &word in &changed[..written] {
                torn_memory[word] = next[word];
            }
            let black_box = BlackBox::adopt(&mut torn_memory[..], ResetCause::Watchdog);
            let (records, torn) = contents(&black_box);
            assert_eq!(
                records.last(),
                Some(&sample(recorded - 1, 0)),
                "{written} words"
            );
            // In a full ring the torn record has replaced the oldest.
            let overwrites = written > 0 && recorded > RECORDS as u32;
            assert_eq!(torn, u16::from(overwrites));
            let kept = recorded.min(RECORDS as u32) as usize;
            assert_eq!(records.len() + usize::from(torn), kept);
        }
    }
}

/// The same for the words of the trigger: no record is lost.
#[test]
fn a_trigger_torn_by_a_reset_costs_no_record() {
    let mut memory: Memory = [0; WORDS];
    let mut black_box = BlackBox::adopt(&mut memory[..], ResetCause::PowerOn);
    record(&mut black_box, 0..50, 0);
    let mut next = memory;
    let mut black_box = BlackBox::adopt(&mut next[..], ResetCause::Software);
    record(&mut black_box, 50..51, 7);
    for written in 0..=8 {
        let mut torn_memory = next;
        torn_memory[written..8].copy_from_slice(&memory[written..8]);
        let black_box = BlackBox::adopt(&mut torn_memory[..], ResetCause::Exception);
        let (records, torn) = contents(&black_box);
        assert_eq!((records.len(), torn), (51, 0), "{written} words");
        assert_ne!(black_box.status(), BlackBoxStatus::Recording);
    }
}

#[test]
fn a_reset_while_it_is_cleared_leaves_an_empty_one_or_the_old_one() {
    let mut memory: Memory = [0; WORDS];
    let mut black_box = BlackBox::adopt(&mut memory[..], ResetCause::PowerOn);
    record(&mut black_box, 0..50, 7);
    let mut next = memory;
    BlackBox::adopt(&mut next[..], ResetCause::Software).clear();
    for written in 0..=8 {
        let mut torn_memory = memory;
        torn_memory[..written].copy_from_slice(&next[..written]);
        let black_box = BlackBox::adopt(&mut torn_memory[..], ResetCause::Watchdog);
        let (records, torn) = contents(&black_box);
        assert!(records.is_empty() || records.len() == 50, "{written} words");
        assert_eq!(torn, 0);
    }
}

/// The image passes a reference, a controller in process passes an array. With too little memory there is no black box.
#[test]
fn any_memory_will_do_and_too_little_keeps_nothing() {
    for length in 0..words(4) {
        let mut memory = vec![0_u32; length];
        let mut black_box = BlackBox::adopt(&mut memory[..], ResetCause::PowerOn);
        record(&mut black_box, 0..20, 0);
        let (records, _) = contents(&black_box);
        let room = length.saturating_sub(words(0)) / 8;
        let kept = if room == 0 { 0 } else { 1 << room.ilog2() };
        assert_eq!(records.len(), kept, "{length} words");
    }
}

proptest! {
    /// Memory content that a cold start may find in RAM.
    #[test]
    fn whatever_the_memory_holds_it_starts_empty(seed: [u32; 8], cause in 0_usize..3) {
        let mut memory: Memory = std::array::from_fn(|word| seed[word % 8].rotate_left(word as u32));
        let cause = [ResetCause::PowerOn, ResetCause::Watchdog, ResetCause::Unknown][cause];
        let mut black_box = BlackBox::adopt(&mut memory[..], cause);
        prop_assert_eq!(black_box.status(), BlackBoxStatus::Recording);
        prop_assert_eq!(contents(&black_box), (vec![], 0));
        record(&mut black_box, 0..1, 0);
        prop_assert_eq!(contents(&black_box), (vec![sample(0, 0)], 0));
    }
}
