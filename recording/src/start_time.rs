use std::fmt;

use time::{Duration, OffsetDateTime};

/// Instant at which the time of a recording is 0 s, by the clock of the logger.
///
/// ```
/// use recording::{Clock, StartTime};
///
/// let start = StartTime { since_1970_ns: 1_714_745_527_250_000_000, clock: Clock::Utc { ahead_min: 120 } };
/// assert_eq!(start.to_string(), "2024-05-03 16:12:07 UTC+02:00");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StartTime {
    /// Time since 1970-01-01 00:00:00 of `clock` (ns), without leap seconds; up to the year 2554.
    pub since_1970_ns: u64,
    /// Clock of the time.
    pub clock: Clock,
}

/// Clock of an absolute time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// Universal time. `ahead_min` is the local time at the place of the recording minus the universal time, less than
    /// a day; 0 also if unknown.
    Utc {
        /// Minutes to add for the local time.
        ahead_min: i16,
    },
    /// Local time of the logger, in an unknown zone.
    Local,
}

/// Date and time at the place of the recording, to the second, rounded down, and their clock.
impl fmt::Display for StartTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ahead_min = match self.clock {
            Clock::Utc { ahead_min } => ahead_min,
            Clock::Local => 0,
        };
        let there = OffsetDateTime::UNIX_EPOCH
            + std::time::Duration::from_nanos(self.since_1970_ns)
            + Duration::minutes(ahead_min.into());
        let (year, month, day) = there.to_calendar_date();
        let (hour, minute, second) = there.to_hms();
        let month = u8::from(month);
        write!(
            f,
            "{year}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} "
        )?;
        match self.clock {
            Clock::Local => f.write_str("local time"),
            Clock::Utc { ahead_min: 0 } => f.write_str("UTC"),
            Clock::Utc { ahead_min } => {
                let sign = if ahead_min < 0 { '-' } else { '+' };
                let minutes = ahead_min.unsigned_abs();
                write!(f, "UTC{sign}{:02}:{:02}", minutes / 60, minutes % 60)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_is_named_with_the_date() {
        let text = |seconds: u64, clock| {
            let since_1970_ns = seconds * 1_000_000_000 + 999_999_999;
            StartTime {
                since_1970_ns,
                clock,
            }
            .to_string()
        };
        let utc = |ahead_min| Clock::Utc { ahead_min };
        assert_eq!(text(1_714_745_527, utc(0)), "2024-05-03 14:12:07 UTC");
        let new_year = 1_735_689_599;
        assert_eq!(text(new_year, utc(0)), "2024-12-31 23:59:59 UTC");
        assert_eq!(text(new_year, utc(345)), "2025-01-01 05:44:59 UTC+05:45");
        assert_eq!(text(new_year, utc(-210)), "2024-12-31 20:29:59 UTC-03:30");
        assert_eq!(
            text(new_year, Clock::Local),
            "2024-12-31 23:59:59 local time"
        );
        assert_eq!(text(0, utc(-1439)), "1969-12-31 00:01:00 UTC-23:59");
        let last = StartTime {
            since_1970_ns: u64::MAX,
            clock: utc(1439),
        };
        assert_eq!(last.to_string(), "2554-07-22 23:33:33 UTC+23:59");
    }
}
