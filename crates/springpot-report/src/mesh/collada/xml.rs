//! The XML of a file: its limits, and its elements by their ids.

use crate::mesh::Unread;
use roxmltree::{Document, ParsingOptions};
use std::collections::HashMap;

pub(super) type Node<'a> = roxmltree::Node<'a, 'a>;

/// Most tags, and pieces of text between them.
const MOST_TAGS: usize = 500_000;
/// Most attributes of one tag: the parser compares each with each.
const MOST_OF_TAG: usize = 32;
/// Most declarations of namespaces: the parser's memory grows with their square.
const MOST_NAMESPACES: usize = 32;

/// The tree of a text whose size is known to be modest; a document type is refused.
pub(super) fn parse(text: &str) -> Result<Document<'_>, Unread> {
    check(text)?;
    let options = ParsingOptions { allow_dtd: false, nodes_limit: 2 * MOST_TAGS as u32, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| {
        let words: String = error.to_string().chars().take(120).collect();
        Unread::Xml(words)
    })
}

fn check(text: &str) -> Result<(), Unread> {
    let (mut tags, mut namespaces, mut at) = (0, 0, 0);
    while let Some(start) = text[at..].find('<') {
        let rest = &text[at + start..];
        let past = |opening: usize, end: &str| rest[opening..].find(end).map(|k| opening + k + end.len());
        let length = if rest.starts_with("<!--") {
            past(4, "-->")
        } else if rest.starts_with("<![CDATA[") {
            past(9, "]]>")
        } else if rest.starts_with("<?") {
            past(2, "?>")
        } else {
            let (length, attributes) = tag(rest);
            if attributes > MOST_OF_TAG {
                return Err(Unread::Broken("a tag has too many attributes"));
            }
            if rest[..length].contains("xmlns") {
                namespaces += rest[..length].matches("xmlns").count();
            }
            Some(length)
        };
        tags += 1;
        if tags > MOST_TAGS {
            return Err(Unread::Broken("it has too many tags"));
        }
        if namespaces > MOST_NAMESPACES {
            return Err(Unread::Broken("it has too many namespaces"));
        }
        // What has no end is the parser's to refuse.
        let Some(length) = length else { break };
        at += start + length;
    }
    Ok(())
}

/// Length of the tag that a text begins with, and its number of attributes.
fn tag(text: &str) -> (usize, usize) {
    let (mut quote, mut attributes) = (None, 0);
    for (at, byte) in text.bytes().enumerate() {
        match (byte, quote) {
            (b'>', None) => return (at + 1, attributes),
            (b'"' | b'\'', None) => quote = Some(byte),
            (b'=', None) => attributes += 1,
            (byte, Some(open)) if byte == open => quote = None,
            _ => {}
        }
    }
    (text.len(), attributes)
}

/// A document whose elements are found by their ids.
#[derive(Debug)]
pub(super) struct Index<'a> {
    pub(super) root: Node<'a>,
    ids: HashMap<&'a str, Node<'a>>,
}

impl<'a> Index<'a> {
    pub(super) fn of(document: &'a Document<'a>) -> Self {
        let mut ids = HashMap::new();
        for node in document.descendants() {
            if let Some(id) = node.attribute("id") {
                ids.entry(id).or_insert(node);
            }
        }
        Self { root: document.root_element(), ids }
    }

    /// The element of that name to which an attribute leads; nothing outside of the file is looked for.
    pub(super) fn target(&self, node: Node<'a>, attribute: &str, name: &str) -> Option<Node<'a>> {
        let id = node.attribute(attribute)?.strip_prefix('#')?;
        self.ids.get(id).copied().filter(|found| found.tag_name().name() == name)
    }

    /// As [`Self::target`], by an id without `#`, as materials have it too.
    pub(super) fn called(&self, id: &str, name: &str) -> Option<Node<'a>> {
        self.ids.get(id).copied().filter(|found| found.tag_name().name() == name)
    }
}

/// The children of a name.
pub(super) fn children<'a>(node: Node<'a>, name: &'static str) -> impl Iterator<Item = Node<'a>> {
    node.children().filter(move |child| child.is_element() && child.tag_name().name() == name)
}

/// The first child of each name in turn.
pub(super) fn down<'a>(node: Node<'a>, names: &[&'static str]) -> Option<Node<'a>> {
    names.iter().try_fold(node, |node, name| children(node, name).next())
}

/// The text of an element, all its pieces.
pub(super) fn words<'a>(node: Node<'a>) -> impl Iterator<Item = &'a str> {
    node.children()
        .filter(|child| child.is_text())
        .filter_map(|child| child.text())
        .flat_map(str::split_ascii_whitespace)
}
