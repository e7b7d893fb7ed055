//! The page that says what a run was and what came of it, to be read and printed.

use super::MARK;
use crate::formula::mathml;
use crate::scene::LawText;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use minijinja::syntax::SyntaxConfig;
use minijinja::value::{Serde, Value};
use minijinja::{Environment, context, escape_formatter};
use serde::{Serialize, Serializer};

const TEMPLATE: &str = include_str!("../../assets/report.html");
/// With this ending all that a template writes is escaped.
const NAME: &str = "report.html";

/// A report: a title and sections.
#[derive(Debug, Default, Serialize)]
pub struct Report {
    /// Its title.
    pub title: String,
    /// What it is of, in a line.
    pub subject: String,
    /// done, failed, interrupted, or nothing.
    pub status: String,
    /// The version of Springpot that wrote it.
    pub version: String,
    /// What it holds.
    pub sections: Vec<Section>,
}

/// A section with its heading.
#[derive(Debug, Default, Serialize)]
pub struct Section {
    /// Its heading.
    pub title: String,
    /// What it holds.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Debug, Serialize)]
#[serde(tag = "kind", content = "value", rename_all = "lowercase")]
pub enum Block {
    /// Words.
    Text(String),
    /// What a reader must not miss.
    Warnings(Vec<String>),
    /// Names with values.
    Facts(Vec<Fact>),
    /// Rows.
    Table(Table),
    /// Text that stands as it is.
    Code(String),
    /// Text that stands as it is, and is folded on a screen: what it is, and the text.
    Folded(String, String),
    /// The same, left out where the page is printed.
    Unprinted(String, String),
    /// Pictures.
    Figures(Vec<Figure>),
    /// An element with its law.
    Law(Box<LawSection>),
}

/// A name with its value.
#[derive(Debug, Serialize)]
pub struct Fact {
    /// Name.
    pub name: String,
    /// Value.
    pub value: String,
}

/// A table.
#[derive(Debug, Default, Serialize)]
pub struct Table {
    /// What it holds.
    pub caption: String,
    /// Its columns.
    pub columns: Vec<TableColumn>,
    /// Its rows, as long as the columns are many.
    pub rows: Vec<Vec<String>>,
    /// What is to be known of it.
    pub note: Option<String>,
}

/// The head of a column.
#[derive(Debug, Serialize)]
pub struct TableColumn {
    /// What stands there.
    pub title: String,
    /// Whether it holds numbers.
    pub is_number: bool,
    /// Whether it holds formulas.
    pub is_formula: bool,
}

/// A picture.
#[derive(Debug, Serialize)]
pub struct Figure {
    /// What it shows.
    pub title: String,
    /// Its file among the results, where it is there too.
    pub file: Option<String>,
    /// Its media type, `image/svg+xml` or `image/png`; empty where the page cannot hold it.
    pub media: String,
    /// The picture.
    #[serde(rename = "data", serialize_with = "encoded")]
    pub bytes: Vec<u8>,
    /// The same for paper, where it is there.
    #[serde(skip)]
    pub printed: Option<Printed>,
}

/// A picture in a format that LaTeX takes.
#[derive(Debug, Clone)]
pub struct Printed {
    /// What its file's name ends with: pdf or png.
    pub ending: &'static str,
    /// The picture.
    pub bytes: Vec<u8>,
}

/// An element, its law, where it is, and pictures of it.
#[derive(Debug, Serialize)]
pub struct LawSection {
    /// What is said of the law.
    pub text: LawText,
    /// Where the element is.
    pub place: String,
    /// Values of the parameters, written.
    pub parameters: Table,
    /// Pictures.
    pub figures: Vec<Figure>,
}

impl Table {
    /// A table with these columns: titles of numbers begin with `#`, those of formulas with `$`.
    pub fn new(caption: impl Into<String>, columns: &[&str]) -> Self {
        let column = |title: &&str| TableColumn {
            title: title.strip_prefix(['#', '$']).unwrap_or(title).to_owned(),
            is_number: title.starts_with('#'),
            is_formula: title.starts_with('$'),
        };
        Self { caption: caption.into(), columns: columns.iter().map(column).collect(), ..Self::default() }
    }
}

impl Report {
    /// The page: one file of HTML that needs nothing else, with equations as MathML and figures inside.
    pub fn html(&self) -> String {
        let syntax = SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build();
        let mut environment = Environment::new();
        environment.set_syntax(syntax.expect("the usual delimiters"));
        environment.set_formatter(|out, state, value| {
            // What is safe was written here, of text that was cleaned: its unseen characters are operators of formulas.
            match value.as_str().filter(|text| !value.is_safe() && text.contains(is_unseen)) {
                Some(text) => escape_formatter(out, state, &Value::from(cleaned(text))),
                None => escape_formatter(out, state, value),
            }
        });
        environment.add_filter("math", |line: &str| Value::from_safe_string(mathml(&cleaned(line))));
        environment.add_template(NAME, TEMPLATE).expect("the template is sound");
        let template = environment.get_template(NAME).expect("it was added above");
        let mark = Value::from_safe_string(MARK.to_owned());
        template.render(context! { mark, report => Value::from(Serde(self)) }).expect("the template fits its data")
    }
}

/// The text with what nobody would see made visible.
pub(super) fn cleaned(text: &str) -> String {
    text.replace(is_unseen, "\u{fffd}")
}

/// What nobody would see, or what turns the direction of a text, so that a name looks like another.
fn is_unseen(c: char) -> bool {
    match c {
        '\t' | '\n' | '\r' => false,
        '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{feff}' => true,
        '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' => true,
        '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}' => true,
        c => c.is_control(),
    }
}

fn encoded<S: Serializer>(bytes: &[u8], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&STANDARD.encode(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_text_wherever_it_stands() {
        let bad = "</script><script>alert(1)</script><img src=x onerror=alert(1)>\"'`&\u{202e}\u{200b}\u{7}\u{e0041}";
        let law = LawText {
            name: bad.to_owned(),
            law: bad.to_owned(),
            equation: bad.to_owned(),
            source: bad.to_owned(),
            drawing: Some(bad.to_owned()),
            modulus: Some(bad.to_owned()),
            relaxation: Some(bad.to_owned()),
            parameters: Vec::new(),
            inputs: Vec::new(),
        };
        let table =
            || Table { rows: vec![vec![bad.to_owned()]], note: Some(bad.to_owned()), ..Table::new(bad, &[bad]) };
        let figure = || Figure {
            title: bad.to_owned(),
            file: Some(bad.to_owned()),
            media: "image/svg+xml".to_owned(),
            bytes: bad.as_bytes().to_vec(),
            printed: Some(Printed { ending: "pdf", bytes: Vec::new() }),
        };
        let blocks = vec![
            Block::Text(bad.to_owned()),
            Block::Warnings(vec![bad.to_owned()]),
            Block::Facts(vec![Fact { name: bad.to_owned(), value: bad.to_owned() }]),
            Block::Table(table()),
            Block::Code(bad.to_owned()),
            Block::Folded(bad.to_owned(), bad.to_owned()),
            Block::Unprinted(bad.to_owned(), bad.to_owned()),
            Block::Figures(vec![figure()]),
            Block::Law(Box::new(LawSection {
                text: law,
                place: bad.to_owned(),
                parameters: table(),
                figures: vec![figure()],
            })),
        ];
        let section = Section { title: bad.to_owned(), blocks };
        let report = Report {
            title: bad.to_owned(),
            subject: bad.to_owned(),
            status: bad.to_owned(),
            version: bad.to_owned(),
            sections: vec![section],
        };
        let tex = report.latex("figures").text.replace("\\{", "").replace("\\}", "");
        assert_eq!(tex.matches('{').count(), tex.matches('}').count(), "{tex}");
        assert!(!tex.contains(is_unseen) && tex.contains("figures/figure-2.pdf"), "{tex}");
        let html = report.html();
        assert!(!html.contains("alert(1)<") && !html.contains("<script") && !html.contains("<img src=x"), "{html}");
        assert!(html.contains(MARK));
        assert!(html.contains("`&amp;\u{fffd}\u{fffd}\u{fffd}\u{fffd}") && !html.contains(is_unseen));
    }

    #[test]
    fn signs_that_formulas_need_stay_and_the_same_in_names_do_not() {
        let mut table = Table::new("Laws", &["law", "$equation"]);
        table.rows.push(vec!["springpot".to_owned(), "F = c·D^alpha x + k x(t)".to_owned()]);
        let report = |table| {
            let sections = vec![Section { title: "Laws".to_owned(), blocks: vec![Block::Table(table)] }];
            Report { sections, ..Report::default() }.html()
        };
        let html = report(table);
        assert!(html.contains("<mo>\u{2062}</mo>") && !html.contains('\u{fffd}'), "{html}");
        let mut table = Table::new("Laws", &["law", "$equation"]);
        table.rows.push(vec!["a\u{2062}b".to_owned(), "F = k\u{2062}x".to_owned()]);
        let html = report(table);
        assert!(html.contains("a\u{fffd}b") && html.contains("k\u{fffd}x") && !html.contains('\u{2062}'), "{html}");
    }

    #[test]
    fn what_a_section_holds_is_there() {
        let mut table = Table::new("Metrics", &["metric", "#value"]);
        table.rows.push(vec!["overshoot".to_owned(), "0.12".to_owned()]);
        let blocks = vec![Block::Table(table), Block::Code("a = 1\nb = 2".to_owned())];
        let sections = vec![Section { title: "Results".to_owned(), blocks }];
        let html = Report { title: "A run".to_owned(), sections, ..Report::default() }.html();
        for text in ["<title>A run", "<h2", "Results", "<caption>Metrics", "overshoot", "a = 1\nb = 2"] {
            assert!(html.contains(text), "{text}\n{html}");
        }
    }
}
