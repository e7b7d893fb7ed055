//! A report as a LaTeX document with its pictures in files beside it.

use super::report::{Block, Figure, LawSection, Report, Table, cleaned};
use crate::formula::latex as formula;
use crate::latex::{Cell, Column, code, document, table, text};

/// A document, and the files that it includes.
#[derive(Debug)]
pub struct Latex {
    /// The document.
    pub text: String,
    /// Names of files, as the document names them, and what they hold.
    pub files: Vec<(String, Vec<u8>)>,
}

impl Report {
    /// The report as a document for `pdflatex`; its pictures are files in `folder`, beside it.
    ///
    /// Pictures that are there as SVG alone are named in their places.
    pub fn latex(&self, folder: &str) -> Latex {
        let mut writer = Writer { folder, body: String::new(), files: Vec::new() };
        let lead = if self.status.is_empty() { String::new() } else { format!("{} · ", self.status) };
        writer.text(&format!("{lead}{}", self.subject));
        for section in &self.sections {
            writer.body.push_str(&format!("\\subsection*{{{}}}\n\n", text(&cleaned(&section.title))));
            section.blocks.iter().for_each(|block| writer.block(block));
        }
        writer.body.push_str(&format!("\\hrulefill\n\nSpringpot {}\n", text(&self.version)));
        Latex { text: document(&cleaned(&self.title), &writer.body), files: writer.files }
    }
}

struct Writer<'a> {
    folder: &'a str,
    body: String,
    files: Vec<(String, Vec<u8>)>,
}

impl Writer<'_> {
    /// A paragraph.
    fn text(&mut self, words: &str) {
        self.body.push_str(&format!("{}\n\n", text(&cleaned(words))));
    }

    fn block(&mut self, block: &Block) {
        match block {
            Block::Text(words) => self.text(words),
            Block::Warnings(lines) => {
                self.body.push_str("\\begin{itemize}\n");
                for line in lines {
                    self.body.push_str(&format!("\\item {{}}{}\n", text(&cleaned(line))));
                }
                self.body.push_str("\\end{itemize}\n\n");
            }
            Block::Facts(facts) => {
                let mut table = Table::new("", &["", ""]);
                table.rows = facts.iter().map(|fact| vec![fact.name.clone(), fact.value.clone()]).collect();
                self.table(&table);
            }
            Block::Table(table) => self.table(table),
            Block::Code(lines) => self.body.push_str(&code(&cleaned(lines))),
            Block::Folded(what, lines) => {
                self.text(what);
                self.body.push_str(&code(&cleaned(lines)));
            }
            // As on printed pages.
            Block::Unprinted(..) => {}
            Block::Figures(figures) => figures.iter().for_each(|figure| self.figure(figure)),
            Block::Law(law) => self.law(law),
        }
    }

    fn table(&mut self, of: &Table) {
        let column = |column: &super::TableColumn| Column {
            title: Cell::text(&cleaned(&column.title)),
            is_number: column.is_number,
        };
        let columns: Vec<Column> = of.columns.iter().map(column).collect();
        let row = |row: &Vec<String>| {
            let cell = |(k, cell): (usize, &String)| match of.columns.get(k).is_some_and(|column| column.is_formula) {
                true => Cell::latex(formula(&cleaned(cell)), cell),
                false => Cell::text(&cleaned(cell)),
            };
            row.iter().enumerate().map(cell).collect()
        };
        let rows: Vec<Vec<Cell>> = of.rows.iter().map(row).collect();
        self.body.push_str(&table(&cleaned(&of.caption), &columns, &rows));
        if let Some(note) = &of.note {
            self.body.push_str(&format!("{{\\footnotesize {}\\par}}\n\n", text(&cleaned(note))));
        }
    }

    fn figure(&mut self, figure: &Figure) {
        let title = text(&cleaned(&figure.title));
        let Some(printed) = &figure.printed else {
            let file = figure.file.as_deref().unwrap_or_default();
            self.body.push_str(&format!("{title}: {}\n\n", text(&cleaned(file))));
            return;
        };
        let name = format!("{}/figure-{}.{}", self.folder, self.files.len() + 1, printed.ending);
        self.body.push_str(&format!(
            "\\begin{{minipage}}{{\\textwidth}}\\centering\n\
             \\includegraphics[width=.65\\textwidth,height=.4\\textheight,keepaspectratio]{{{name}}}\\par\n\
             \\refstepcounter{{figure}}Figure~\\thefigure: {title}\n\
             \\end{{minipage}}\n\n"
        ));
        self.files.push((name, printed.bytes.clone()));
    }

    fn law(&mut self, LawSection { text: law, place, parameters, figures }: &LawSection) {
        self.body.push_str(&format!("\\subsubsection*{{{}}}\n\n", text(&cleaned(&law.name))));
        self.text(place);
        if law.law == law.equation {
            self.body.push_str(&code(&cleaned(&law.law)));
        } else {
            self.body.push_str(&format!("Law \\textbf{{{}}}\n\n", text(&cleaned(&law.law))));
            self.formula(&law.equation);
        }
        for (lead, formula) in [("K*(ω) = ", &law.modulus), ("G(t) = ", &law.relaxation)] {
            if let Some(formula) = formula {
                self.formula(&format!("{lead}{formula}"));
            }
        }
        if !parameters.rows.is_empty() {
            self.table(parameters);
        }
        self.text(&format!("Source of the law: {}", law.source));
        figures.iter().for_each(|figure| self.figure(figure));
    }

    fn formula(&mut self, line: &str) {
        self.body.push_str(&format!("{{\\raggedright {}\\par}}\n\n", formula(&cleaned(line))));
    }
}
