//! Words in the names of columns, in English and German.

use Meaning as M;

/// Meaning of a word in the name of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meaning {
    // Kinds of a signal.
    Time,
    Pressure,
    Current,
    Duty,
    Voltage,
    Temperature,
    Position,
    // Places.
    Valve,
    Fill,
    Inlet,
    Vent,
    Chamber,
    Supply,
    Ambient,
    Reference,
    Gas,
    Coil,
    Battery,
    Actuator,
    /// A signal that the model does not have.
    Other,
}

/// Words of names in English and German, in lower case and without umlauts. A word of up to three letters is a part of
/// the name by itself; a longer one may also be a part of a compound.
#[rustfmt::skip]
pub(super) const WORDS: &[(&str, Meaning)] = &[
    ("time", M::Time), ("zeit", M::Time), ("t", M::Time), ("timestamp", M::Time), ("zeitstempel", M::Time),
    ("pressure", M::Pressure), ("druck", M::Pressure), ("press", M::Pressure), ("p", M::Pressure),
    ("current", M::Current), ("strom", M::Current), ("i", M::Current),
    ("duty", M::Duty), ("pwm", M::Duty), ("tastverhaeltnis", M::Duty), ("tastgrad", M::Duty), ("tv", M::Duty),
    ("dutycycle", M::Duty), ("dc", M::Duty), ("ansteuerung", M::Duty),
    ("voltage", M::Voltage), ("spannung", M::Voltage), ("u", M::Voltage),
    ("temperature", M::Temperature), ("temperatur", M::Temperature), ("temp", M::Temperature),
    ("position", M::Position), ("stroke", M::Position), ("lift", M::Position), ("hub", M::Position), ("x", M::Position),
    ("travel", M::Position), ("displacement", M::Position), ("weg", M::Position),
    ("valve", M::Valve), ("ventil", M::Valve), ("solenoid", M::Valve), ("mv", M::Valve),
    ("v", M::Valve),
    ("fill", M::Fill), ("filling", M::Fill), ("fuell", M::Fill), ("befuellung", M::Fill), ("belueft", M::Fill),
    ("inlet", M::Inlet), ("einlass", M::Inlet), ("zuluft", M::Inlet), ("in", M::Inlet),
    ("vent", M::Vent), ("venting", M::Vent), ("entlueft", M::Vent), ("exhaust", M::Vent), ("outlet", M::Vent),
    ("auslass", M::Vent), ("ablass", M::Vent), ("abluft", M::Vent), ("release", M::Vent), ("out", M::Vent),
    ("chamber", M::Chamber), ("kammer", M::Chamber), ("ch", M::Chamber), ("vessel", M::Chamber),
    ("supply", M::Supply), ("versorgung", M::Supply), ("vorrat", M::Supply), ("speise", M::Supply),
    ("tank", M::Supply), ("kessel", M::Supply), ("sup", M::Supply),
    ("ambient", M::Ambient), ("umgebung", M::Ambient), ("amb", M::Ambient), ("atm", M::Ambient), ("room", M::Ambient),
    ("reference", M::Reference), ("ref", M::Reference), ("soll", M::Reference), ("setpoint", M::Reference),
    ("target", M::Reference), ("desired", M::Reference),
    ("gas", M::Gas), ("coil", M::Coil), ("spule", M::Coil),
    ("battery", M::Battery), ("batterie", M::Battery), ("bat", M::Battery), ("ubat", M::Battery), ("bord", M::Battery),
    ("actuator", M::Actuator), ("aktor", M::Actuator), ("piston", M::Actuator), ("kolben", M::Actuator),
    ("cylinder", M::Actuator), ("zylinder", M::Actuator),
    ("flow", M::Other), ("durchfluss", M::Other), ("volumenstrom", M::Other), ("massenstrom", M::Other),
    ("oil", M::Other), ("oel", M::Other), ("oeldruck", M::Other), ("torque", M::Other), ("moment", M::Other), ("speed", M::Other),
    ("drehzahl", M::Other), ("frequency", M::Other), ("frequenz", M::Other),
];

pub(super) fn is_kind(meaning: Meaning) -> bool {
    use Meaning::{Current, Duty, Position, Pressure, Temperature, Time, Voltage};
    matches!(
        meaning,
        Time | Pressure | Current | Duty | Voltage | Temperature | Position
    )
}

pub(super) fn kind_name(kind: Meaning) -> &'static str {
    match kind {
        M::Time => "time",
        M::Pressure => "pressure",
        M::Current => "current",
        M::Duty => "duty cycle",
        M::Voltage => "voltage",
        M::Temperature => "temperature",
        _ => "position",
    }
}

/// Returns the known words of a name with their meanings.
pub(super) fn words(name: &str) -> Vec<(&'static str, Meaning)> {
    let mut found = Vec::new();
    for part in parts(name) {
        if let Some(&known) = WORDS.iter().find(|(word, _)| *word == part) {
            found.push(known);
            continue;
        }
        let (mut at, mut is_behind_word) = (0, true);
        while at < part.len() {
            let rest = &part[at..];
            let fitting = WORDS.iter().filter(|(word, _)| {
                let shortest = if is_behind_word { 4 } else { 5 };
                word.len() >= shortest && rest.starts_with(word)
            });
            if let Some(&(word, meaning)) = fitting.max_by_key(|(word, _)| word.len()) {
                found.push((word, meaning));
                (at, is_behind_word) = (at + word.len(), true);
            } else {
                at += rest.chars().next().map_or(1, char::len_utf8);
                is_behind_word = false;
            }
        }
    }
    found
}

/// Splits a name at signs, digits and capital letters, in lower case and without umlauts.
pub(super) fn parts(name: &str) -> Vec<String> {
    let characters: Vec<char> = name.chars().collect();
    let mut parts = vec![String::new()];
    for (index, &character) in characters.iter().enumerate() {
        let before = index.checked_sub(1).map(|at| characters[at]);
        let after = characters.get(index + 1);
        let begins = character.is_uppercase()
            && (before.is_some_and(char::is_lowercase)
                || before.is_some_and(char::is_uppercase)
                    && after.is_some_and(|one| one.is_lowercase()));
        if begins || !character.is_alphabetic() {
            parts.push(String::new());
        }
        let Some(part) = parts.last_mut().filter(|_| character.is_alphabetic()) else {
            continue;
        };
        for lower in character.to_lowercase() {
            match lower {
                'ä' => part.push_str("ae"),
                'ö' => part.push_str("oe"),
                'ü' => part.push_str("ue"),
                'ß' => part.push_str("ss"),
                other => part.push(other),
            }
        }
    }
    parts.retain(|part| !part.is_empty());
    parts
}

/// Returns the reason that the name gives.
pub(super) fn named(
    words: &[(&str, Meaning)],
    name: &str,
    is_meant: impl Fn(Meaning) -> bool,
) -> String {
    let lower = name.to_lowercase();
    let mut found: Vec<String> = Vec::new();
    for (word, _) in words.iter().filter(|(_, meaning)| is_meant(*meaning)) {
        let shown = match lower.contains(word) {
            true => (*word).to_owned(),
            false => word
                .replace("ae", "ä")
                .replace("oe", "ö")
                .replace("ue", "ü"),
        };
        let shown = format!("`{shown}`");
        if !found.contains(&shown) {
            found.push(shown);
        }
    }
    match found.is_empty() {
        true => String::new(),
        false => format!("name contains {}", found.join(" and ")),
    }
}
