//! The text of a URDF file: its limits, its lines, its XML.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use roxmltree::{Document, Error as XmlError};

use super::error::DescriptionError;
use super::problem::DescriptionProblem;

/// Longest text, bytes. A robot of 10⁵ links takes some 60 MB.
const MAX_BYTES: usize = 256 << 20;
/// Most tags and attributes, which bounds the memory of the parsed tree.
const MAX_TAGS: usize = 16_000_000;
/// Most attributes of one tag: the parser compares each with each.
const MAX_ATTRIBUTES_OF_TAG: usize = 128;
/// Most declarations of namespaces: the parser's time and memory grow faster than their number.
const MAX_NAMESPACES: usize = 2_000;

/// Longest reason of a broken text, characters.
const MAX_REASON: usize = 200;

/// Bytes whose line breaks are counted together.
const BLOCK: usize = 1024;

/// A text that knows its lines.
#[derive(Debug)]
pub(super) struct Source<'a> {
    pub(super) file: Option<&'a Path>,
    pub(super) text: &'a str,
    /// Line breaks before each block.
    breaks: Vec<usize>,
}

impl<'a> Source<'a> {
    pub(super) fn new(text: &'a str, file: Option<&'a Path>) -> Self {
        let counts = text.as_bytes().chunks(BLOCK).map(breaks_in);
        let breaks = std::iter::once(0).chain(counts.scan(0, |sum, count| {
            *sum += count;
            Some(*sum)
        }));
        Self { file, text, breaks: breaks.collect() }
    }

    /// The line of byte `at`, from 1.
    pub(super) fn line(&self, at: usize) -> usize {
        let block = at / BLOCK;
        self.breaks[block] + breaks_in(&self.text.as_bytes()[block * BLOCK..at]) + 1
    }

    /// Line and column of byte `at`, from 1; the column counts characters.
    fn place(&self, at: usize) -> (usize, usize) {
        let before = self.text.get(..at).unwrap_or("");
        let line_start = before.rfind('\n').map_or(0, |k| k + 1);
        (self.line(at), before[line_start..].chars().count() + 1)
    }

    /// An error at byte `at`.
    pub(super) fn fail(&self, at: usize, problem: DescriptionProblem) -> DescriptionError {
        DescriptionError::new(self.file, Some(self.place(at)), problem)
    }

    /// The tree of the XML.
    ///
    /// Entities beyond the five of XML are refused, and so is what would take the parser more than linear time or
    /// memory.
    pub(super) fn parse(&self) -> Result<Document<'a>, DescriptionError> {
        self.check_size()?;
        Document::parse(self.text).map_err(|error| self.not_xml(&error))
    }

    fn check_size(&self) -> Result<(), DescriptionError> {
        let too_large =
            |limit, what| DescriptionError::new(self.file, None, DescriptionProblem::TooLarge { limit, what });
        if self.text.len() > MAX_BYTES {
            return Err(too_large(MAX_BYTES, "bytes"));
        }
        if self.text.bytes().filter(|&byte| byte == b'<' || byte == b'=').count() > MAX_TAGS {
            return Err(too_large(MAX_TAGS, "tags and attributes"));
        }
        let mut namespaces = 0;
        let mut at = 0;
        while let Some(start) = self.text[at..].find('<') {
            at += start;
            let rest = &self.text[at..];
            let past = |opening: usize, end: &str| rest[opening..].find(end).map(|k| opening + k + end.len());
            let length = if rest.starts_with("<!--") {
                past(4, "-->")
            } else if rest.starts_with("<![CDATA[") {
                past(9, "]]>")
            } else if rest.starts_with("<?") {
                past(2, "?>")
            } else {
                let tag = Tag::at_start_of(rest);
                namespaces += tag.namespaces;
                if namespaces > MAX_NAMESPACES {
                    let what = "declarations of namespaces";
                    return Err(self.fail(at, DescriptionProblem::TooLarge { limit: MAX_NAMESPACES, what }));
                }
                if tag.attributes > MAX_ATTRIBUTES_OF_TAG {
                    let what = "attributes in one tag";
                    return Err(self.fail(at, DescriptionProblem::TooLarge { limit: MAX_ATTRIBUTES_OF_TAG, what }));
                }
                Some(tag.length)
            };
            // What has no end is the parser's to refuse.
            let Some(length) = length else { break };
            at += length;
        }
        Ok(())
    }

    /// The first `<` that opens no comment and no processing instruction, or else the end of the text.
    fn first_tag(&self) -> usize {
        let mut at = 0;
        while let Some(start) = self.text[at..].find('<') {
            at += start;
            let rest = &self.text[at..];
            let end = match rest {
                _ if rest.starts_with("<!--") => "-->",
                _ if rest.starts_with("<?") => "?>",
                _ => return at,
            };
            let Some(length) = rest.find(end) else { break };
            at += length;
        }
        self.text.len()
    }

    fn not_xml(&self, error: &XmlError) -> DescriptionError {
        let at = error.pos();
        // The parser knows no place of these.
        let place = match error {
            XmlError::DtdDetected | XmlError::UnclosedRootNode => self.place(self.first_tag()),
            XmlError::UnexpectedEndOfStream | XmlError::NoRootNode => self.place(self.text.trim_end().len()),
            _ => (at.row as usize, at.col as usize),
        };
        let place = Some(place);
        // The parser ends its sentences with the place, which stands at the front here.
        let reason = match error {
            XmlError::DtdDetected => "it has a <!DOCTYPE>, which no robot needs".to_owned(),
            XmlError::UnexpectedEndOfStream => "the text ends too early".to_owned(),
            XmlError::NoRootNode => "there is no element in it".to_owned(),
            XmlError::UnclosedRootNode => {
                let lines = self.text.trim_end().lines().count();
                format!("the outermost element is never closed; the text ends on line {lines}")
            }
            XmlError::UnknownNamespace(prefix, _) if prefix == "xacro" => {
                return DescriptionError::new(
                    self.file,
                    place,
                    DescriptionProblem::Xacro { element: "xacro:…".to_owned() },
                );
            }
            XmlError::UnknownNamespace(prefix, _) => {
                format!("the prefix {prefix:?} is not declared (xmlns:{prefix}=\"…\" in <robot> would do)")
            }
            XmlError::InvalidChar(wanted, found, _) => {
                format!("expected '{}', found {}", *wanted as char, shown(*found))
            }
            XmlError::InvalidChar2(wanted, found, _) => format!("expected {wanted}, found {}", shown(*found)),
            _ => error.to_string().replace(&format!(" at {at}"), "").chars().take(MAX_REASON).collect(),
        };
        DescriptionError::new(self.file, place, DescriptionProblem::NotXml { reason })
    }
}

fn breaks_in(bytes: &[u8]) -> usize {
    bytes.iter().filter(|byte| **byte == b'\n').count()
}

/// A byte as messages write it.
fn shown(byte: u8) -> String {
    if byte.is_ascii() { format!("{:?}", byte as char) } else { "a letter beyond ASCII".to_owned() }
}

/// What matters of one tag before it is parsed.
struct Tag {
    /// Bytes from `<` past `>`.
    length: usize,
    attributes: usize,
    namespaces: usize,
}

impl Tag {
    /// The tag that `text` starts with; it ends at `>` outside quotes, or before the next `<`, which no value may hold.
    fn at_start_of(text: &str) -> Self {
        let bytes = text.as_bytes();
        let mut quote = None;
        let mut tag = Self { length: bytes.len(), attributes: 0, namespaces: 0 };
        for (k, &byte) in bytes.iter().enumerate().skip(1) {
            match (byte, quote) {
                (b'<', _) => {
                    tag.length = k;
                    break;
                }
                (b'>', None) => {
                    tag.length = k + 1;
                    break;
                }
                (b'"' | b'\'', None) => quote = Some(byte),
                (_, Some(open)) if open == byte => quote = None,
                (b'=', None) => tag.attributes += 1,
                (b'x', None) if bytes[k..].starts_with(b"xmlns") => tag.namespaces += 1,
                _ => {}
            }
        }
        tag
    }
}

/// The text of a file.
pub(super) fn read(path: &Path) -> Result<String, DescriptionError> {
    let fail = |problem| DescriptionError::new(Some(path), None, problem);
    let unreadable = |source| fail(DescriptionProblem::Unreadable { source });
    // Looked at before it is opened: opening a pipe would wait for its other end.
    if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
        return Err(fail(DescriptionProblem::NotAFile));
    }
    let file = File::open(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    file.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() > MAX_BYTES {
        return Err(fail(DescriptionProblem::TooLarge { limit: MAX_BYTES, what: "bytes" }));
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let text = String::from_utf8_lossy(&error.as_bytes()[..valid]).into_owned();
        Source::new(&text, Some(path)).fail(valid, DescriptionProblem::NotUtf8)
    })
}

#[cfg(test)]
mod tests {
    use super::{Source, Tag};

    #[test]
    fn lines_and_columns_count_from_one_in_characters() {
        let source = Source::new("ab\nüx\n", None);
        let places = [(0, (1, 1)), (1, (1, 2)), (3, (2, 1)), (5, (2, 2)), (7, (3, 1))];
        for (at, place) in places {
            assert_eq!(source.place(at), place, "byte {at}");
        }
    }

    #[test]
    fn lines_are_counted_across_blocks() {
        let text: String = (0..2_000).map(|k| "x".repeat(k % 7) + "\n").collect();
        let source = Source::new(&text, None);
        let mut line = 1;
        for (at, byte) in text.bytes().enumerate() {
            assert_eq!(source.line(at), line, "byte {at}");
            line += usize::from(byte == b'\n');
        }
        assert_eq!(source.line(text.len()), 2_001);
    }

    #[test]
    fn a_tag_ends_outside_its_quotes() {
        let tag = Tag::at_start_of("<a b='>' xmlns:c=\"=\"> =");
        assert_eq!((tag.length, tag.attributes, tag.namespaces), (21, 2, 1));
        assert_eq!(Tag::at_start_of("<a b='").length, 6);
        assert_eq!(Tag::at_start_of("<a b='<c>").length, 6);
    }
}
