//! Texts of the file: plain ones, and the relevant elements of XML texts.

use std::io::{Read, Seek};

use super::blocks::Blocks;
use super::error::Located;
use crate::Note;

/// Maximum size of a text (bytes); the rest is not read.
const TEXT_BYTES_MAX: u64 = 64 << 10;
/// Maximum number of properties of a comment.
const NOTES_MAX: usize = 256;

/// Comment: its text, and its properties by name.
#[derive(Debug, Default)]
pub(super) struct Comment {
    pub(super) text: String,
    pub(super) properties: Vec<Note>,
}

impl<R: Read + Seek> Blocks<R> {
    /// Reads the text at `offset`, plain or the `TX` element of XML; empty for link 0.
    pub(super) fn text(&mut self, offset: u64) -> Result<String, Located> {
        Ok(self.comment(offset)?.text)
    }

    /// Reads the comment at `offset`; an empty one for link 0.
    pub(super) fn comment(&mut self, offset: u64) -> Result<Comment, Located> {
        let (text, is_xml) = self.raw_text(offset)?;
        if !is_xml {
            return Ok(Comment {
                text: text.trim().to_owned(),
                properties: Vec::new(),
            });
        }
        Ok(Comment {
            text: element(&text, "TX").unwrap_or_default(),
            properties: properties(&text),
        })
    }

    /// Reads the unchanged text at `offset`, empty for link 0; also returns whether it is XML.
    pub(super) fn raw_text(&mut self, offset: u64) -> Result<(String, bool), Located> {
        if offset == 0 {
            return Ok((String::new(), false));
        }
        let is_xml = self.head("##TX", offset)?.id == *b"##MD";
        let id = if is_xml { "##MD" } else { "##TX" };
        let block = self.beginning(id, offset, TEXT_BYTES_MAX)?;
        let bytes = block.data().split(|&byte| byte == 0).next();
        let text = String::from_utf8_lossy(bytes.unwrap_or_default());
        Ok((text.into_owned(), is_xml))
    }
}

/// Returns the content of the first element `name`.
pub(super) fn element(xml: &str, name: &str) -> Option<String> {
    let (_, rest) = xml.split_once(&format!("<{name}"))?;
    let (_, rest) = rest.split_once('>')?;
    let (content, _) = rest.split_once(&format!("</{name}>"))?;
    Some(unescaped(content.trim()))
}

/// Returns all `<e name="key">value</e>`, at any place.
fn properties(xml: &str) -> Vec<Note> {
    let elements = xml.split("<e ").skip(1).take(NOTES_MAX);
    elements
        .filter_map(|element| {
            let (attributes, rest) = element.split_once('>')?;
            let (_, name) = attributes.split_once("name=\"")?;
            let (key, _) = name.split_once('"')?;
            let (value, _) = rest.split_once("</e>")?;
            Some(Note {
                key: unescaped(key),
                value: unescaped(value.trim()),
            })
        })
        .collect()
}

fn unescaped(text: &str) -> String {
    if !text.contains('&') {
        return text.to_owned();
    }
    // The ampersand comes last: `&amp;lt;` is the text `&lt;`.
    text.replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&quot;", "\"")
        .replace("&apos;", "'")
        .replace("&amp;", "&")
}

/// Returns text escaped for XML content or an attribute, without characters that XML forbids.
pub(super) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '&' => escaped.push_str("&amp;"),
            character if character.is_control() => escaped.push(' '),
            character => escaped.push(character),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_escaped_comes_back() {
        for text in ["a < b & c", "&lt;", "\"q\" 'a' >", "Ω µ", ""] {
            assert_eq!(unescaped(&escaped(text)), text);
        }
    }

    #[test]
    fn elements_and_properties_are_found_and_broken_ones_left_alone() {
        let xml = "<HDcomment><TX> a &amp; b </TX><common_properties>\
                   <e name=\"source\" ro=\"true\">bench 3</e><e name=\"x\">1</common_properties></HDcomment>";
        assert_eq!(element(xml, "TX").as_deref(), Some("a & b"));
        let found = properties(xml);
        assert_eq!(found.len(), 1);
        assert_eq!(
            (found[0].key.as_str(), found[0].value.as_str()),
            ("source", "bench 3")
        );
        assert_eq!(element("<TX>open", "TX"), None);
    }
}
