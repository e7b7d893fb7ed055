//! A page of Markdown as far as the tests look at it: blocks, headings, links.

use std::collections::HashMap;
use std::fs;

pub(crate) const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// A page, named by its path from the root of the repository.
pub(crate) struct Page {
    pub(crate) name: String,
    pub(crate) blocks: Vec<Block>,
    /// Headings as written, with their lines.
    pub(crate) headings: Vec<(usize, String)>,
    pub(crate) links: Vec<Link>,
}

/// A fenced block of code.
pub(crate) struct Block {
    /// Line of its fence.
    pub(crate) line: usize,
    /// What stands behind the fence.
    pub(crate) info: String,
    pub(crate) lines: Vec<String>,
}

/// A link or an image.
pub(crate) struct Link {
    pub(crate) line: usize,
    pub(crate) target: String,
}

impl Page {
    pub(crate) fn open(name: &str) -> Self {
        let text = fs::read_to_string(format!("{ROOT}/{name}")).unwrap_or_else(|error| panic!("{name}: {error}"));
        Self::read(name, &text)
    }

    /// # Panics
    ///
    /// If a block has no end, or a link no target that can be told here.
    pub(crate) fn read(name: &str, text: &str) -> Self {
        let mut page = Self { name: name.to_owned(), blocks: vec![], headings: vec![], links: vec![] };
        let mut lines = text.lines().enumerate().map(|(k, line)| (k + 1, line));
        while let Some((number, line)) = lines.next() {
            if let Some(info) = line.strip_prefix("```") {
                let mut block = Block { line: number, info: info.to_owned(), lines: vec![] };
                loop {
                    match lines.next() {
                        Some((_, "```")) => break,
                        Some((_, line)) => block.lines.push(line.to_owned()),
                        None => panic!("{name}:{number}: a block without an end"),
                    }
                }
                page.blocks.push(block);
                continue;
            }
            assert!(!line.trim_start().starts_with("```"), "{name}:{number}: an indented block is followed by no test");
            let level = line.bytes().take_while(|byte| *byte == b'#').count();
            if (1..=6).contains(&level) && line[level..].starts_with(' ') {
                page.headings.push((number, line[level..].trim().to_owned()));
            }
            let said = without_code(line);
            let reference = said.starts_with('[') && said.contains("]: ");
            assert!(!reference, "{name}:{number}: a link by reference is followed by no test");
            let targets = ["](", "src=\"", "href=\""].into_iter().zip([')', '"', '"']);
            for (opening, closing) in targets {
                for rest in said.split(opening).skip(1) {
                    let target = rest.split(closing).next().unwrap_or_default();
                    let target = target.split(' ').next().unwrap_or_default();
                    page.links.push(Link { line: number, target: target.to_owned() });
                }
            }
        }
        page
    }

    /// What may stand behind `#` in a link to this page.
    pub(crate) fn anchors(&self) -> Vec<String> {
        let mut seen: HashMap<String, usize> = HashMap::new();
        let anchor = |(_, heading): &(usize, String)| {
            let name = anchor(heading);
            let before = seen.entry(name.clone()).or_default();
            *before += 1;
            if *before == 1 { name } else { format!("{name}-{}", *before - 1) }
        };
        self.headings.iter().map(anchor).collect()
    }
}

/// The name that mdBook and GitHub give to a heading.
fn anchor(heading: &str) -> String {
    let mut text = heading.to_owned();
    // Of a link its words count.
    while let Some((start, rest)) = text.split_once("](") {
        let rest = rest.split_once(')').map_or("", |(_, rest)| rest);
        text = format!("{start}{rest}");
    }
    let kept = text.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c }).flat_map(char::to_lowercase).collect()
}

/// A line without its spans of code.
fn without_code(line: &str) -> String {
    let mut rest = line;
    let mut said = String::new();
    while let Some(start) = rest.find('`') {
        let ticks = rest[start..].bytes().take_while(|byte| *byte == b'`').count();
        let (fence, inner) = (&rest[start..start + ticks], &rest[start + ticks..]);
        said.push_str(&rest[..start]);
        match inner.find(fence) {
            Some(end) => rest = &inner[end + ticks..],
            None => rest = inner,
        }
    }
    said + rest
}

/// The pages of the book in its order, with the paths that they have in the summary.
pub(crate) fn summary() -> Vec<String> {
    Page::open("docs/SUMMARY.md").links.into_iter().map(|link| link.target).collect()
}

#[test]
fn pages_are_read() {
    let text = "# A `b` [c](d.md)\n\ntext `[no](x)` [yes](y.md#z) ![i](i.png \"words\")\n\n```text\n# no\n[no](no)\n```\n\n# Two, 2.\n# Two, 2.\n";
    let page = Page::read("page", text);
    let links: Vec<(usize, &str)> = page.links.iter().map(|link| (link.line, link.target.as_str())).collect();
    assert_eq!(links, [(1, "d.md"), (3, "y.md#z"), (3, "i.png")]);
    assert_eq!(page.anchors(), ["a-b-c", "two-2", "two-2-1"]);
    assert_eq!((page.blocks[0].line, page.blocks[0].lines.len()), (5, 2));
    assert_eq!(anchor("[[element]]"), "element");
    assert_eq!(anchor("`springpot dynamics SCENARIO --at TIME`"), "springpot-dynamics-scenario---at-time");
}
