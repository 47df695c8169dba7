//! Secrets of one start: the token in the printed address, and the cookie that replaces it.

use std::fmt::Write as _;
use std::sync::atomic::{AtomicBool, Ordering};

/// Returns 128 random bits as 32 hexadecimal digits.
///
/// # Errors
/// Returns an error if the operating system provides no random numbers.
pub(crate) fn random_hex() -> Result<String, getrandom::Error> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes)?;
    Ok(hex(&bytes))
}

/// Returns the lower-case hexadecimal digits of `bytes`.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a String cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// Encodes Base64 with padding (RFC 4648), as content policies write hashes.
pub(crate) fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let quartet = |chunk: &[u8]| {
        let byte = |place: usize| u32::from(chunk.get(place).copied().unwrap_or(0));
        let word = (byte(0) << 16) | (byte(1) << 8) | byte(2);
        [18, 12, 6, 0]
            .into_iter()
            .enumerate()
            .map(move |(place, shift)| match place <= chunk.len() {
                true => char::from(DIGITS[((word >> shift) & 63) as usize]),
                false => '=',
            })
            .collect::<String>()
    };
    bytes.chunks(3).map(quartet).collect()
}

/// Secrets of one start.
pub(crate) struct Secrets {
    token: String,
    cookie: String,
    is_exchanged: AtomicBool,
}

impl Secrets {
    pub(crate) fn new() -> Result<Self, getrandom::Error> {
        Ok(Self {
            token: random_hex()?,
            cookie: random_hex()?,
            is_exchanged: AtomicBool::new(false),
        })
    }

    /// Returns the token in the printed address.
    pub(crate) fn token(&self) -> &str {
        &self.token
    }

    /// Returns the cookie for the token, once only, so that an address that another person reads later gives no access.
    pub(crate) fn exchange(&self, token: &str) -> Option<&str> {
        let is_first =
            is_equal(token, &self.token) && !self.is_exchanged.swap(true, Ordering::Relaxed);
        is_first.then_some(&self.cookie)
    }

    /// Returns whether this is the cookie of this start.
    pub(crate) fn is_cookie(&self, value: &str) -> bool {
        is_equal(value, &self.cookie)
    }
}

/// Compares in a time that does not depend on the place of the first difference.
fn is_equal(one: &str, other: &str) -> bool {
    let difference = one
        .bytes()
        .zip(other.bytes())
        .fold(0, |sum, (a, b)| sum | (a ^ b));
    one.len() == other.len() && std::hint::black_box(difference) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Examples of RFC 4648, section 10.
    #[test]
    fn base64_is_that_of_the_standard() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    #[test]
    fn a_token_is_exchanged_once_and_only_the_right_one() {
        let secrets = Secrets::new().unwrap();
        assert_eq!(secrets.token().len(), 32);
        assert!(secrets.exchange("").is_none());
        assert!(secrets.exchange(&"0".repeat(32)).is_none());
        let cookie = secrets.exchange(secrets.token()).unwrap();
        assert!(secrets.is_cookie(cookie) && !secrets.is_cookie(secrets.token()));
        assert!(!secrets.is_cookie(&cookie[..31]));
        assert!(secrets.exchange(secrets.token()).is_none());
    }
}
