//! Text on stdout and stderr: as wide as the terminal, coloured where that is wanted, and never a panic.

use crate::plain;
use std::io::{self, IsTerminal, Write};
use terminal_size::{Width, terminal_size_of};

/// Narrower terminals are taken for this wide.
const NARROWEST: usize = 40;

/// Widest lines of running text.
const WIDEST: usize = 100;

/// A blank at which [`hanging`] does not break.
pub(crate) const NO_BREAK: &str = "\u{a0}";

/// Prints on stdout. A closed pipe is no error: whoever reads has read enough.
pub(crate) fn print(text: &str) {
    let _ = try_print(text);
}

/// Prints on stdout what is the result of a command. A terminal gets nothing that steers it.
pub(crate) fn try_print(text: &str) -> io::Result<()> {
    let mut stdout = io::stdout().lock();
    let shown = if stdout.is_terminal() { plain::lines(text) } else { text.into() };
    stdout.write_all(shown.as_bytes()).and_then(|()| stdout.flush())
}

/// Prints on stderr.
pub(crate) fn print_error(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Whether stderr takes colours: a terminal does, unless NO_COLOR is set; with CLICOLOR_FORCE everything does.
pub(crate) fn is_coloured() -> bool {
    let value = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
    let is_on = |name: &str| value(name).is_some_and(|value| value != "0");
    let is_dumb = value("TERM").is_some_and(|terminal| terminal == "dumb");
    let is_off = is_dumb || value("CLICOLOR").is_some_and(|value| value == "0");
    value("NO_COLOR").is_none() && (is_on("CLICOLOR_FORCE") || (io::stderr().is_terminal() && !is_off))
}

/// Columns for running text on stdout; `None` where it is no terminal.
pub(crate) fn stdout_width() -> Option<usize> {
    width(io::stdout().is_terminal().then(|| terminal_size_of(io::stdout())))
}

/// Columns of the terminal on stdout; `None` where it is none.
pub(crate) fn stdout_columns() -> Option<usize> {
    let columns = || terminal_size_of(io::stdout()).map_or(80, |(Width(columns), _)| usize::from(columns));
    io::stdout().is_terminal().then(columns).map(|columns| columns.max(NARROWEST))
}

/// Columns for running text on stderr; `None` where it is no terminal.
pub(crate) fn stderr_width() -> Option<usize> {
    width(io::stderr().is_terminal().then(|| terminal_size_of(io::stderr())))
}

fn width(size: Option<Option<(Width, terminal_size::Height)>>) -> Option<usize> {
    size.map(|size| size.map_or(80, |(Width(columns), _)| usize::from(columns)).clamp(NARROWEST, WIDEST))
}

/// `text`, as one line is shown, behind `lead`, broken between words where it passes `width`, later lines indented by as much as `lead` is long.
pub(crate) fn hanging(lead: &str, text: &str, width: Option<usize>) -> String {
    let (indent, text) = (lead.chars().count(), plain::line(text));
    let mut lines = lead.to_owned();
    let mut column = indent;
    for (k, word) in text.split(' ').enumerate() {
        let length = word.chars().count();
        if k > 0 && width.is_some_and(|width| column + 1 + length > width) {
            lines.truncate(lines.trim_end().len());
            lines.push('\n');
            lines.push_str(&" ".repeat(indent));
            column = indent;
        } else if k > 0 {
            lines.push(' ');
            column += 1;
        }
        lines.push_str(&word.replace(NO_BREAK, " "));
        column += length;
    }
    lines.push('\n');
    lines
}

#[cfg(test)]
mod tests {
    use super::hanging;

    #[test]
    fn text_hangs_behind_its_lead() {
        assert_eq!(hanging("ab  ", "one two three", Some(11)), "ab  one two\n    three\n");
        assert_eq!(hanging("ab  ", "one two three", None), "ab  one two three\n");
        assert_eq!(hanging("ab  ", "unbreakable x", Some(8)), "ab  unbreakable\n    x\n");
        assert_eq!(hanging("", "a b\u{a0}=\u{a0}1", Some(6)), "a\nb = 1\n");
        assert_eq!(hanging("", "", Some(8)), "\n");
    }
}
