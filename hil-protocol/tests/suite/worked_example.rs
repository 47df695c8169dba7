//! Documented wire format: the worked example of the README, byte by byte.

use hil_protocol::frame::{Direction, Header, encode};
use hil_protocol::{FRAME_MAX, Request, Sensors};

const README: &str = include_str!("../../README.md");

fn hex(text: &str) -> Vec<u8> {
    text.split_whitespace()
        .map(|byte| u8::from_str_radix(byte, 16).unwrap_or_else(|_| panic!("{byte}: no byte")))
        .collect()
}

#[test]
fn the_worked_example_of_the_readme_is_what_is_sent() {
    let (_, example) = README.split_once("## A worked example").unwrap();
    let rows = example.lines().filter_map(|line| {
        let (bytes, _) = line.strip_prefix("| `")?.split_once('`')?;
        Some(hex(bytes))
    });
    let unstuffed = rows.flatten().collect::<Vec<u8>>();
    let frame = hex(example
        .split("```")
        .nth(1)
        .unwrap()
        .trim_start_matches("text"));

    let header = Header {
        direction: Direction::ToDevice,
        session: 300,
        sequence: 2,
    };
    let request = Request::Sample(Sensors {
        sample: 1,
        elapsed_us: 10_000,
        reference: Some(163_840),
        pressure: Some(700),
        current_fill_ma: None,
        current_vent_ma: None,
        battery_mv: Some(24_000),
    });
    let mut buffer = [0; FRAME_MAX];
    let sent = encode(header, &request, &mut buffer).unwrap();
    assert_eq!(frame, sent, "the frame: {sent:02x?}");
    let stuffed = cobs::decode_vec(&sent[..sent.len() - 1]).unwrap();
    assert_eq!(
        unstuffed, stuffed,
        "header, message, checksum: {stuffed:02x?}"
    );
}
