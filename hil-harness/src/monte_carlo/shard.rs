//! Shard: the part of a batch that one process computes.

use core::fmt;
use core::ops::Range;
use core::str::FromStr;

/// Part `number` of `count` equal parts of a batch, written `2/8`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Number of the part, from 1.
    number: u32,
    /// Number of parts.
    count: u32,
}

/// Reason why a text is no shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected K/N with 1 <= K <= N, such as 2/8 for the second of eight shards")]
pub struct ShardError;

impl Shard {
    /// The whole batch.
    pub const WHOLE: Self = Self {
        number: 1,
        count: 1,
    };

    /// Returns the numbers of its rigs in a batch of `rigs`. The shards of a batch differ by at most one rig.
    pub fn rigs(self, rigs: u32) -> Range<u32> {
        let begin = |number: u32| {
            let begin = u64::from(rigs) * u64::from(number) / u64::from(self.count);
            // At most `rigs`.
            begin as u32
        };
        begin(self.number - 1)..begin(self.number)
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let (number, count) = text.split_once('/').ok_or(ShardError)?;
        let parsed = |text: &str| text.parse().map_err(|_| ShardError);
        let shard = Self {
            number: parsed(number)?,
            count: parsed(count)?,
        };
        let is_in_range = (1..=shard.count).contains(&shard.number);
        is_in_range.then_some(shard).ok_or(ShardError)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_have_each_rig_once_and_nearly_equal_sizes() {
        for (rigs, count) in [(10, 3), (2, 5), (0, 2), (u32::MAX, 7)] {
            let mut next = 0;
            for number in 1..=count {
                let shard: Shard = format!("{number}/{count}").parse().unwrap();
                let part = shard.rigs(rigs);
                assert_eq!(part.start, next);
                let size = part.end - part.start;
                assert!(size == rigs / count || size == rigs / count + 1, "{size}");
                next = part.end;
            }
            assert_eq!(next, rigs);
        }
        assert_eq!(Shard::WHOLE.rigs(7), 0..7);
    }

    #[test]
    fn a_shard_that_is_none_of_its_count_is_refused() {
        for wrong in ["0/3", "4/3", "1/0", "1", "1/", "a/b", "-1/3", "1/3/4", ""] {
            assert_eq!(wrong.parse::<Shard>(), Err(ShardError), "{wrong}");
        }
    }
}
