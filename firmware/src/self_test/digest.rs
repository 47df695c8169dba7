//! Digest of all words folded into it, in order.

/// FNV-1a of 64 bits (Fowler, Noll, Vo), with words of 32 bits instead of bytes.
///
/// Each fold is one-to-one in the present value and in the word. Two runs that differ in a single word therefore keep
/// different digests while the following words are equal. Only a second difference could cancel the first, with a
/// probability of 2⁻⁶⁴.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Digest(u64);

impl Digest {
    pub(crate) const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    pub(crate) fn fold(&mut self, word: u32) {
        self.0 = (self.0 ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3);
    }

    pub(crate) const fn value(self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn digest(words: &[u32]) -> u64 {
        let mut digest = Digest::new();
        words.iter().for_each(|&word| digest.fold(word));
        digest.value()
    }

    #[test]
    fn a_word_below_256_folds_as_the_published_byte_does() {
        // Published test vector of FNV-1a 64: the text "foobar".
        let foobar: Vec<u32> = "foobar".bytes().map(u32::from).collect();
        assert_eq!(digest(&foobar), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn one_flipped_bit_changes_the_digest_wherever_it_stands() {
        let words = [0, 1, u32::MAX, 0x1234_5678];
        for place in 0..words.len() {
            for bit in 0..32 {
                let mut flipped = words;
                flipped[place] ^= 1 << bit;
                assert_ne!(digest(&flipped), digest(&words), "word {place}, bit {bit}");
            }
        }
    }

    #[test]
    fn the_order_of_the_words_counts() {
        assert_ne!(digest(&[1, 2]), digest(&[2, 1]));
    }
}
