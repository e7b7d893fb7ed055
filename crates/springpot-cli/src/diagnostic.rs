//! Errors and warnings as they appear in the terminal: what is wrong, the offending line with a caret, what would be right.

use crate::excerpt::Excerpt;
use crate::{plain, terminal};
use miette::ThemeStyles;
use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, Severity, SourceCode, ThemeCharacters};
use springpot::law::Catalog;
use springpot::model::description::DescriptionError;
use springpot_run::Warning;
use springpot_scenario::{Cases, Place, Refusal, RefusalKind, Refusals, Remark, Scenario, Source};
use std::fmt::{self, Display};
use std::path::Path;
use std::sync::Arc;

/// Length of excerpts where there is no terminal.
const EXCERPT: usize = 200;

const ACCEPT_INERTIA: &str =
    "correct it, or take it as it is: --accept-inertia, in a scenario accept_inertia = true in [robot]";

/// Reads the scenario, applies the overrides and checks everything.
pub(crate) fn open(file: &Path, overrides: &[String], catalog: &Catalog) -> Result<Cases, Refusals> {
    scenario(file, overrides)?.cases(catalog)
}

/// Reads the scenario and applies the overrides.
pub(crate) fn scenario(file: &Path, overrides: &[String]) -> Result<Scenario, Refusals> {
    let mut scenario = Scenario::read(file)?;
    overrides.iter().try_for_each(|assignment| scenario.set(assignment))?;
    Ok(scenario)
}

/// Prints refusals on stderr.
pub(crate) fn refused(refusals: &Refusals) {
    refusals.iter().for_each(|refusal| pointed(Severity::Error, refusal));
}

/// Prints what is wrong at a place.
pub(crate) fn error_at(place: &Place, message: String, help: Option<String>) {
    pointed(Severity::Error, &place.refuse(RefusalKind::Rule, message).help_if(help));
}

/// Prints a warning, with its place where it has one.
pub(crate) fn remark(Remark { message, place, help }: Remark) {
    match place.filter(|place| !place.source.text.is_empty()) {
        Some(place) => pointed(Severity::Warning, &place.refuse(RefusalKind::Rule, message).help_if(help)),
        None => warning(message, help),
    }
}

/// A message with the line that it is about.
fn pointed(severity: Severity, refusal: &Refusal) {
    // The gutter takes the room of a line number and its frame.
    let width = terminal::stderr_width().map_or(EXCERPT, |width| width - 10);
    show(&Shown {
        label: plain::line(&refusal.label),
        excerpt: Excerpt::new(refusal, width),
        ..Shown::plain(severity, headline(refusal), refusal.help.clone())
    });
}

/// Prints what is wrong with a robot's file on stderr, with the tag that it is about.
pub(crate) fn description_refused(description_error: &DescriptionError) {
    let help = description_error.problem.is_of_no_mass().then(|| ACCEPT_INERTIA.to_owned());
    let alone = || show(&Shown::plain(Severity::Error, description_error.to_string(), help.clone()));
    let DescriptionError { file: Some(file), place: Some((line, column)), problem } = description_error else {
        return alone();
    };
    // The reader keeps no text; where the file has changed since, the message stands alone.
    let text = std::fs::read(file).map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap_or_default();
    let Some(start) = byte_at(&text, *line, *column) else { return alone() };
    let rest = text[start..].lines().next().unwrap_or_default();
    let end = start + rest.find('>').map_or(rest.len(), |at| at + 1);
    let source = Source { name: file.display().to_string(), text: text.into() };
    let place = Place { source: Arc::new(source), span: start..end };
    refused(&place.refuse(RefusalKind::Rule, problem.to_string()).help_if(help).into());
}

/// The byte at a line and a column, both from 1, the column in characters.
fn byte_at(text: &str, line: usize, column: usize) -> Option<usize> {
    let mut start = 0;
    for _ in 1..line {
        start += text[start..].find('\n')? + 1;
    }
    let rest = &text[start..];
    // Behind the last character too, where a text ends too early.
    let mut bytes = rest.char_indices().map(|(byte, _)| byte).chain([rest.len()]);
    bytes.nth(column - 1).map(|byte| start + byte)
}

/// Prints an error on stderr.
pub(crate) fn error(message: impl Into<String>) {
    show(&Shown::plain(Severity::Error, message.into(), None));
}

/// Prints an error and what would be right on stderr.
pub(crate) fn error_with_help(message: impl Into<String>, help: String) {
    show(&Shown::plain(Severity::Error, message.into(), Some(help)));
}

/// Prints a warning and what to do about it on stderr.
pub(crate) fn warning(message: impl Into<String>, help: Option<String>) {
    show(&Shown::plain(Severity::Warning, message.into(), help));
}

/// Prints what is good to know on stderr.
pub(crate) fn note(message: impl Into<String>) {
    show(&Shown::plain(Severity::Advice, message.into(), None));
}

/// Prints what the robot's files hold that is not used, or lack and is assumed.
pub(crate) fn robot_warnings(cases: &Cases) {
    springpot_run::robot_warnings(cases).into_iter().for_each(warn);
}

/// Prints a warning of a run on stderr.
pub(crate) fn warn(Warning { message, help }: Warning) {
    warning(message, help);
}

/// A file that cannot be read has no line to point at.
fn headline(refusal: &Refusal) -> String {
    let Refusal { kind, file, line, column, message, text, .. } = refusal;
    if text.is_empty() && matches!(kind, RefusalKind::File | RefusalKind::TooLarge) {
        format!("{file}: {message}")
    } else {
        format!("{file}:{line}:{column}: {message}")
    }
}

fn show(shown: &Shown) {
    let styles = if terminal::is_coloured() { ThemeStyles::ansi() } else { ThemeStyles::none() };
    let characters = ThemeCharacters {
        error: "error:".into(),
        warning: "warning:".into(),
        advice: "note:".into(),
        ..ThemeCharacters::unicode()
    };
    let width = terminal::stderr_width();
    let handler = GraphicalReportHandler::new_themed(GraphicalTheme { characters, styles })
        .with_links(false)
        .with_wrap_lines(width.is_some())
        .with_width(width.unwrap_or(usize::MAX));
    let mut text = String::new();
    match handler.render_report(&mut text, shown) {
        Ok(()) => terminal::print_error(text.strip_prefix("  ").unwrap_or(&text)),
        Err(fmt::Error) => terminal::print_error(&format!("error: {shown}\n")),
    }
}

/// A message as miette shows it.
#[derive(Debug)]
struct Shown {
    severity: Severity,
    message: String,
    help: Option<String>,
    label: String,
    excerpt: Option<Excerpt>,
}

impl Shown {
    fn plain(severity: Severity, message: String, help: Option<String>) -> Self {
        let help = help.map(|help| plain::help(&help));
        Self { severity, message: plain::message(&message), help, label: String::new(), excerpt: None }
    }
}

impl Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Shown {}

impl Diagnostic for Shown {
    fn severity(&self) -> Option<Severity> {
        Some(self.severity)
    }

    fn help<'a>(&'a self) -> Option<Box<dyn Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.excerpt.as_ref().map(|excerpt| excerpt as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let span = self.excerpt.as_ref()?.span.clone();
        let label = LabeledSpan::new(Some(self.label.clone()), span.start, span.len());
        Some(Box::new(std::iter::once(label)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str, at: usize, length: usize) -> Refusal {
        let before = &text[..at];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Refusal {
            kind: RefusalKind::Rule,
            message: "wrong".into(),
            file: "a.toml".into(),
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
            span: at..at + length,
            text: text.into(),
            label: "here".into(),
            help: None,
        }
    }

    fn rendered(refusal: &Refusal, width: usize) -> String {
        let theme = GraphicalTheme::unicode_nocolor();
        let handler = GraphicalReportHandler::new_themed(theme).with_links(false);
        let mut text = String::new();
        let shown = Shown {
            excerpt: Excerpt::new(refusal, width),
            label: "here".into(),
            ..Shown::plain(Severity::Error, headline(refusal), None)
        };
        handler.render_report(&mut text, &shown).unwrap();
        text
    }

    /// The line with the mark, and the text that stands above the caret.
    fn marked(text: &str) -> (String, String) {
        let lines: Vec<&str> = text.lines().collect();
        let caret = lines.iter().position(|line| line.contains('┬')).unwrap();
        let underlined = lines[caret].chars().zip(lines[caret - 1].chars());
        let above = underlined.filter(|(mark, _)| "─┬".contains(*mark)).map(|(_, c)| c).collect();
        (lines[caret - 1].trim().to_owned(), above)
    }

    #[test]
    fn the_mark_stands_under_its_text() {
        for end in ["\n", "\r\n"] {
            let text = ["first = 1", "größe = 'α' # é", "länge = 'β' wrong", "last = 3"].join(end);
            let at = text.find("wrong").unwrap();
            let shown = rendered(&refusal(&text, at, 5), 80);
            assert!(shown.contains("a.toml:3:13: wrong") && shown.contains("[3:13]"), "{shown}");
            assert_eq!(marked(&shown), ("3 │ länge = 'β' wrong".into(), "wrong".into()), "{shown}");
            assert!(shown.contains("2 │ größe") && shown.contains("4 │ last") && !shown.contains("first"), "{shown}");
        }
    }

    #[test]
    fn long_lines_are_cut_about_the_mark() {
        let text = format!("a\n{} wrong {}\nb", "é ".repeat(300_000), "ü ".repeat(300_000));
        let at = text.find("wrong").unwrap();
        let shown = rendered(&refusal(&text, at, 5), 60);
        let (line, above) = marked(&shown);
        assert_eq!(above, "wrong");
        assert!(line.chars().count() < 70 && line.matches('…').count() == 2, "{shown}");
        let whole = rendered(&refusal(&text, at, 300_000), 60);
        assert!(whole.len() < 2_000, "{whole}");
    }

    #[test]
    fn nothing_steers_the_terminal() {
        let text = "a = \"\u{1b}[31m\u{7}\u{9b}\"\nb = \u{0}\r\n";
        for at in 0..text.len() {
            if text.is_char_boundary(at) {
                let shown = rendered(&refusal(text, at, 0), 60);
                assert!(shown.chars().all(|c| c == '\n' || !c.is_control()), "{shown:?}");
            }
        }
    }

    #[test]
    fn messages_do_not_steer_it_either() {
        let shown = Shown::plain(Severity::Error, "joint \u{1b}[31m\u{7}".into(), Some("a\u{9b}\nb".into()));
        assert_eq!(shown.message, "joint ␛[31m␇");
        assert_eq!(shown.help.as_deref(), Some("a\u{fffd}\nb"));
    }

    #[test]
    fn every_place_can_be_shown() {
        for text in ["", "\n", "a", "a\n", "\n\n", "ä\nö\n\n", "a\r\n\r\nb"] {
            let places = (0..=text.len()).filter(|at| text.is_char_boundary(*at));
            for at in places.clone() {
                for end in places.clone().filter(|end| *end >= at) {
                    let shown = rendered(&refusal(text, at, end - at), 40);
                    assert!(shown.contains("wrong"), "{text:?} {at}..{end}: {shown}");
                }
            }
        }
    }

    #[test]
    fn a_missing_file_has_no_line() {
        assert_eq!(headline(&Refusal { kind: RefusalKind::File, ..refusal("", 0, 0) }), "a.toml: wrong");
        assert_eq!(headline(&refusal("", 0, 0)), "a.toml:1:1: wrong");
        assert_eq!(headline(&refusal("x", 0, 1)), "a.toml:1:1: wrong");
    }
}
