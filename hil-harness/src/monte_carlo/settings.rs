//! Settings that decide the rows of a run.

use core::fmt;

/// Settings that decide the rows of a run, each with its name: rows of equal settings belong together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunSettings(Vec<(String, String)>);

/// First setting in which two runs differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Name of the setting.
    pub name: String,
    /// First different line of either run; empty where its text ends.
    pub lines: [String; 2],
}

impl RunSettings {
    /// Creates the settings from names and texts.
    pub fn new(settings: impl IntoIterator<Item = (String, String)>) -> Self {
        Self(settings.into_iter().collect())
    }

    /// Returns the text of a setting; `None` if there is no such setting.
    pub fn get(&self, name: &str) -> Option<&str> {
        let found = self.0.iter().find(|(other, _)| other == name);
        found.map(|(_, text)| text.as_str())
    }

    /// Returns names and texts.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(name, text)| (&**name, &**text))
    }

    /// Returns these settings with one more.
    #[must_use]
    pub(super) fn with(&self, name: &str, text: String) -> Self {
        let mut settings = self.clone();
        settings.0.push((name.to_owned(), text));
        settings
    }

    /// Returns the first setting in which `other` differs; `None` if the settings are equal.
    pub fn difference(&self, other: &Self) -> Option<Difference> {
        let names = self.iter().chain(other.iter()).map(|(name, _)| name);
        names.into_iter().find_map(|name| {
            let texts = [self, other].map(|settings| settings.get(name).unwrap_or_default());
            let line = |text: &str, number| text.lines().nth(number).unwrap_or_default().to_owned();
            let lines = texts.map(|text| text.lines().count()).into_iter().max();
            let number = (0..lines.unwrap_or_default())
                .find(|&number| line(texts[0], number) != line(texts[1], number))?;
            Some(Difference {
                name: name.to_owned(),
                lines: texts.map(|text| line(text, number).trim().to_owned()),
            })
        })
    }

    /// Returns the settings as bytes, which [`RunSettings::from_bytes`] reads.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let parts = self.iter().flat_map(|(name, text)| [name, text]);
        parts
            .flat_map(|part| {
                let length = (part.len() as u64).to_le_bytes();
                length.into_iter().chain(part.bytes())
            })
            .collect()
    }

    /// Reads settings; `None` if the bytes are none.
    pub(super) fn from_bytes(mut bytes: &[u8]) -> Option<Self> {
        let mut part = || {
            let (length, rest) = bytes.split_first_chunk()?;
            let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
            let (text, rest) = rest.split_at_checked(length)?;
            bytes = rest;
            String::from_utf8(text.to_vec()).ok()
        };
        let mut settings = Vec::new();
        while let Some(name) = part() {
            settings.push((name, part()?));
        }
        bytes.is_empty().then_some(Self(settings))
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [one, other] = &self.lines;
        write!(f, "{} `{one}` and `{other}`", self.name)
    }
}
