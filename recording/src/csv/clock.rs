//! Time column with dates or times of day: `23.11.2026 14:05:06,125`, ISO 8601, `14:05:06.125`.

use time::{Date, Month};

use crate::{Clock as ClockKind, StartTime};

const DAY_NS: i64 = 86_400_000_000_000;
const MINUTE_NS: i64 = 60_000_000_000;
/// Backward step of a time of day that is midnight.
const MIDNIGHT_NS: i64 = DAY_NS / 2;

/// Reader of a time column; its time is 0 s at the first row.
#[derive(Clone, Debug, Default)]
pub(super) struct Clock {
    first: Option<Instant>,
    last_ns: i64,
    /// Days since the first row, of times without a date.
    days: i64,
}

/// Instant of one cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Instant {
    /// Time since 1970 in universal time, or in local time without a zone; since midnight without a date.
    ns: i64,
    has_date: bool,
    /// Local time minus universal time, if stated (minutes).
    ahead_min: Option<i16>,
}

impl Clock {
    /// Returns the time since the first row (s); `None` if the cell is no date and no time of day, or not of the kind of
    /// the first one.
    pub(super) fn read(&mut self, cell: &str) -> Option<f64> {
        let instant = parse(cell)?;
        let first = *self.first.get_or_insert(instant);
        let has_zone = |one: Instant| one.ahead_min.is_some();
        if (first.has_date, has_zone(first)) != (instant.has_date, has_zone(instant)) {
            return None;
        }
        if !instant.has_date && instant.ns < self.last_ns - MIDNIGHT_NS {
            self.days += 1;
        }
        self.last_ns = instant.ns;
        let since_first_ns = instant.ns - first.ns + self.days * DAY_NS;
        Some(since_first_ns as f64 / 1e9)
    }

    /// Returns the instant of the first row, if it has a date.
    pub(super) fn start(&self) -> Option<StartTime> {
        let first = self.first.filter(|first| first.has_date)?;
        Some(StartTime {
            since_1970_ns: u64::try_from(first.ns).ok()?,
            clock: match first.ahead_min {
                Some(ahead_min) => ClockKind::Utc { ahead_min },
                None => ClockKind::Local,
            },
        })
    }
}

fn parse(cell: &str) -> Option<Instant> {
    let (date, time) = match cell.split_once([' ', 'T']) {
        Some((date, time)) => (Some(date), time.trim_start()),
        None => (None, cell),
    };
    let (time, ahead_min) = zone(time)?;
    let of_day_ns = time_of_day_ns(time)?;
    let days = match date {
        Some(date) => days_since_1970(date)?,
        None if ahead_min.is_some() => return None,
        None => 0,
    };
    let ahead_ns = i64::from(ahead_min.unwrap_or(0)) * MINUTE_NS;
    Some(Instant {
        ns: days.checked_mul(DAY_NS)? + of_day_ns - ahead_ns,
        has_date: date.is_some(),
        ahead_min,
    })
}

/// Splits the zone of ISO 8601 from a time: `Z`, `+02:00`, `-0330`.
fn zone(time: &str) -> Option<(&str, Option<i16>)> {
    if let Some(time) = time.strip_suffix('Z') {
        return Some((time, Some(0)));
    }
    let Some(at) = time.find(['+', '-']) else {
        return Some((time, None));
    };
    let (time, zone) = time.split_at(at);
    let digits = zone[1..].replace(':', "");
    if digits.len() != 4 {
        return None;
    }
    let (hours, minutes) = (digits.get(..2)?, digits.get(2..)?);
    let minutes = number(hours, 14)? * 60 + number(minutes, 59)?;
    let minutes = i16::try_from(minutes).ok()?;
    Some((
        time,
        Some(if zone.starts_with('-') {
            -minutes
        } else {
            minutes
        }),
    ))
}

/// Returns the time of day of `14:05`, `14:05:06` or `14:05:06,125` (ns).
fn time_of_day_ns(time: &str) -> Option<i64> {
    let mut parts = time.split(':');
    let (hours, minutes) = (number(parts.next()?, 23)?, number(parts.next()?, 59)?);
    let (seconds, fraction_ns) = match parts.next() {
        None => (0, 0),
        Some(text) => match text.split_once(['.', ',']) {
            None => (number(text, 60)?, 0),
            Some((seconds, fraction)) => (number(seconds, 60)?, fraction_ns(fraction)?),
        },
    };
    let whole = (hours * 60 + minutes) * 60 + seconds;
    parts
        .next()
        .is_none()
        .then_some(whole * 1_000_000_000 + fraction_ns)
}

fn fraction_ns(digits: &str) -> Option<i64> {
    let is_number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then(|| {
        let digits = digits.bytes().chain(std::iter::repeat(b'0')).take(9);
        digits.fold(0, |sum, digit| 10 * sum + i64::from(digit - b'0'))
    })
}

/// Returns the days from 1970-01-01 to `23.11.2026`, `2026-11-23` or `2026/11/23`. A date that begins with the day or
/// with the month, such as `11/12/2026`, has no single meaning.
fn days_since_1970(date: &str) -> Option<i64> {
    let parts = |sign: char| {
        let mut parts = date.split(sign);
        let three = [parts.next()?, parts.next()?, parts.next()?];
        parts.next().is_none().then_some(three)
    };
    let [year, month, day] = if date.contains('.') {
        let [day, month, year] = parts('.')?;
        [year, month, day]
    } else {
        parts('-').or_else(|| parts('/'))?
    };
    if year.len() != 4 {
        return None;
    }
    let year = i32::try_from(number(year, 9999)?).ok()?;
    let month = Month::try_from(u8::try_from(number(month, 12)?).ok()?).ok()?;
    let date = Date::from_calendar_date(year, month, u8::try_from(number(day, 31)?).ok()?).ok()?;
    let epoch = Date::from_ordinal_date(1970, 1).ok()?;
    // A nanosecond count of 64 bits ends in the year 2262.
    let days = (date - epoch).whole_days();
    (0..=106_000).contains(&days).then_some(days)
}

/// Returns a number of at most four digits.
fn number(text: &str, most: i64) -> Option<i64> {
    let is_number = (1..=4).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_digit());
    let value = text.parse().ok().filter(|_| is_number)?;
    (value <= most).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_all(cells: &[&str]) -> Vec<Option<f64>> {
        let mut clock = Clock::default();
        cells.iter().map(|cell| clock.read(cell)).collect()
    }

    #[test]
    fn the_usual_forms_count_from_the_first_row() {
        for cells in [
            ["23.11.2026 14:05:06,125", "23.11.2026 14:05:06,375"],
            ["2026-11-23T14:05:06.125Z", "2026-11-23T14:05:06.375Z"],
            [
                "2026-11-23 14:05:06.125+01:00",
                "2026-11-23 15:05:06.375+0200",
            ],
            ["2026/11/23 14:05:59.9", "2026/11/23 14:06:00.15"],
            ["14:05:06,125", "14:05:06,375"],
        ] {
            assert_eq!(read_all(&cells), [Some(0.0), Some(0.25)], "{cells:?}");
        }
    }

    #[test]
    fn a_time_of_day_runs_over_midnight_and_a_date_over_leap_days() {
        assert_eq!(
            read_all(&["23:59:59", "0:00:01", "23:59:59"]),
            [Some(0.0), Some(2.0), Some(86_400.0)]
        );
        assert_eq!(
            read_all(&["28.2.2028 12:00", "1.3.2028 12:00"]),
            [Some(0.0), Some(172_800.0)]
        );
    }

    #[test]
    fn what_is_no_clock_or_has_two_meanings_is_refused() {
        for cell in [
            "",
            "12",
            "1.5",
            "11/12/2026 10:00",
            "31.2.2026 10:00",
            "24:00:00",
            "10:61",
            "10:00:00:00",
            "23.11.26 10:00",
            "2026-11-23",
            "10:00:0x",
            "10:00:00,",
            "10:00Z",
            "2026-11-23T10:00+1",
            "9999-01-01 10:00",
            "ü:00",
            "2026-11-23T10:00+ü1",
        ] {
            assert_eq!(parse(cell), None, "{cell}");
        }
        // The kind of the first row is kept.
        assert_eq!(read_all(&["10:00", "2026-11-23 10:00"])[1], None);
        assert_eq!(
            read_all(&["2026-11-23 10:00", "2026-11-23 10:01Z"])[1],
            None
        );
    }

    #[test]
    fn a_date_gives_the_start_of_the_log() {
        let start = |cell: &str| {
            let mut clock = Clock::default();
            clock.read(cell).unwrap();
            clock.start().map(|start| start.to_string())
        };
        assert_eq!(
            start("23.11.2026 14:05:06,125").unwrap(),
            "2026-11-23 14:05:06 local time"
        );
        assert_eq!(
            start("2026-11-23T14:05:06+02:00").unwrap(),
            "2026-11-23 14:05:06 UTC+02:00"
        );
        assert_eq!(start("14:05:06"), None);
    }
}
