//! Pages that one opens: a moving picture of a run ([`View`]) and a [`Report`].
//!
//! A page is one file with its style, its script and its data inside; it asks for nothing from any network. What it shows as text is text: it goes into
//! the file as JSON, or escaped.

mod latex;
mod mesh;
mod report;
mod view;

pub use latex::Latex;
pub use report::{Block, Fact, Figure, LawSection, Printed, Report, Section, Table, TableColumn};
pub use view::{CaseEvent, CaseMetric, View, ViewCase, ViewColumn};

/// Stands near the beginning of every page.
pub const MARK: &str = "<meta name=\"generator\" content=\"Springpot\">";

/// JSON inside `<script>`: the bytes that could end it, or begin a comment, are written as escapes.
fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c").replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029")
}
