//! The line of a scenario file that a message is about, with its neighbours: no longer than a terminal is wide.

use crate::plain::picture;
use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use springpot_run::table::CUT;
use springpot_scenario::Refusal;
use std::ops::Range;

/// Up to three lines of a file.
#[derive(Debug)]
pub(crate) struct Excerpt {
    text: String,
    /// Bytes of `text` to underline.
    pub(crate) span: Range<usize>,
    /// Line of the file that `text` begins with, from 0.
    first_line: usize,
    /// Column of the mark, from 0.
    column: usize,
}

impl Excerpt {
    /// The lines about a refusal, each cut to `width` characters around what is marked; `None` for an empty source.
    pub(crate) fn new(refusal: &Refusal, width: usize) -> Option<Self> {
        let Refusal { text, span, line, column, .. } = refusal;
        if text.is_empty() {
            return None;
        }
        let mark = line_range(text, span.start);
        let before = mark.start.checked_sub(1).map(|end| line_range(text, end));
        let after =
            (mark.end < text.len()).then(|| line_range(text, mark.end + 1)).filter(|after| after.start < text.len());

        let mut excerpt = String::new();
        for range in before.iter() {
            push_line(&mut excerpt, &text[range.clone()], 0, width);
        }
        // Marks that go on over several lines show on the first.
        let marked = span.start.min(mark.end)..span.end.clamp(span.start, mark.end.max(span.start));
        let line_text = &text[mark.clone()];
        let at = line_text[..marked.start - mark.start].chars().count();
        let from = if line_text.chars().count() <= width { 0 } else { at.saturating_sub(width / 3) };
        let offset = excerpt.len();
        push_line(&mut excerpt, line_text, from, width);
        let shown = &excerpt[offset..excerpt.len() - 1];
        let byte = |chars: usize| shown.char_indices().nth(chars).map_or(shown.len(), |(byte, _)| byte);
        let length = text[marked].chars().count();
        let span = offset + byte(at - from)..offset + byte((at - from).saturating_add(length));
        for range in after.iter() {
            push_line(&mut excerpt, &text[range.clone()], 0, width);
        }
        let first_line = line - 1 - usize::from(before.is_some());
        Some(Self { text: excerpt, span, first_line, column: column - 1 })
    }
}

/// The line that holds byte `at`, without its end.
fn line_range(text: &str, at: usize) -> Range<usize> {
    let bytes = text.as_bytes();
    let start = bytes[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |newline| newline + 1);
    let end = bytes[at..].iter().position(|byte| *byte == b'\n').map_or(text.len(), |length| at + length);
    start..end
}

/// At most `width` characters of a line from character `from` on, without those that would steer the terminal.
fn push_line(excerpt: &mut String, line: &str, from: usize, width: usize) {
    let line = line.strip_suffix('\r').unwrap_or(line);
    let clean = |c: char| if c == '\t' { c } else { picture(c).unwrap_or(c) };
    let mut characters = line.chars().skip(from).map(clean);
    let mut shown: Vec<char> = characters.by_ref().take(width).collect();
    if from > 0
        && let Some(first) = shown.first_mut()
    {
        *first = CUT;
    }
    if characters.next().is_some()
        && let Some(last) = shown.last_mut()
    {
        *last = CUT;
    }
    excerpt.extend(shown);
    excerpt.push('\n');
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let contents = self.text.read_span(span, before, after)?;
        // Without its neighbours the line is asked for its place alone.
        let column = if before == 0 { self.column } else { contents.column() };
        let line = self.first_line + contents.line();
        Ok(Box::new(MietteSpanContents::new(contents.data(), *contents.span(), line, column, contents.line_count())))
    }
}
