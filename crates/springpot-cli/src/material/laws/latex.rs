//! Laws as LaTeX.

use super::page::interval;
use springpot::law::{Catalog, Entry, Input, Param};
use springpot_report::formula::{latex as formula, latex_name};
use springpot_report::latex::{Cell, Column, document, number, table, text, unit};
use springpot_run::parts::Part;

/// What stands before the laws.
const LEAD: &str = "x is the stroke, length less rest length; F is positive in tension; ′ is d/dt, and D^α the fractional derivative of the order α \
                    from t = 0 on; Γ is the gamma function and E_α that of Mittag-Leffler. Everything is in SI units.";

/// A document of all laws.
pub(super) fn all(catalog: &Catalog) -> String {
    let laws: Vec<String> = catalog.entries().iter().map(|law| section(law)).collect();
    document("Laws", &[lead(), laws.concat()].concat())
}

/// A document of one law.
pub(super) fn one(law: &Entry) -> String {
    document("Law", &[lead(), section(law)].concat())
}

fn lead() -> String {
    format!("{}\n\n", text(LEAD))
}

fn section(law: &Entry) -> String {
    let mut body = format!("\\subsection*{{{}}}\n\n", text(&law.name));
    let mut line = |formulas: &str| body.push_str(&format!("{{\\raggedright {formulas}\\par}}\n\n"));
    line(&formula(&law.equation));
    if let Some(part) = Part::of(law) {
        let linear = [("K*(ω) = ", part.modulus()), ("G(t) = ", part.relaxation())];
        let told = linear.iter().filter_map(|(lead, told)| Some(formula(&format!("{lead}{}", told.as_ref()?))));
        told.for_each(|formulas| line(&formulas));
    }
    let titles =
        ["", "unit", "range", "default", "meaning"].map(|title| Column { title: Cell::text(title), is_number: false });
    let params = law.params.iter().map(|Param { name, unit, meaning, range, default, .. }| {
        let default = default.map_or_else(|| Cell::text("required"), |value| quantity(&format!("{value}")));
        vec![named(name), upright(unit), quantity(&interval(*range)), default, Cell::text(meaning)]
    });
    let inputs = law.inputs.iter().map(|Input { name, unit, meaning, range }| {
        vec![
            named(&format!("{name}(t)")),
            upright(unit),
            quantity(&interval(*range)),
            Cell::text("input"),
            Cell::text(meaning),
        ]
    });
    let rows: Vec<Vec<Cell>> = params.chain(inputs).collect();
    if !rows.is_empty() {
        body.push_str(&table("", &titles, &rows));
    }
    body.push_str(&format!("{{\\footnotesize Source: {}\\par}}\n\n", text(&law.source)));
    body
}

fn named(name: &str) -> Cell {
    let shown = match name.strip_suffix("(t)") {
        Some(input) => format!("{}(t)", latex_name(input)),
        None => latex_name(name),
    };
    Cell::latex(format!("${shown}$"), name)
}

/// The unit, or 1.
fn upright(written: &str) -> Cell {
    Cell::latex(if written.is_empty() { "$1$".to_owned() } else { format!("${}$", unit(written)) }, written)
}

/// A number, or a range of them: signs and numbers with blanks between.
fn quantity(written: &str) -> Cell {
    let word = |word: &str| match word {
        "…" => "\\dots ".to_owned(),
        "≥" => "\\ge ".to_owned(),
        "≤" => "\\le ".to_owned(),
        word if word.parse::<f64>().is_ok() => number(word),
        word => format!("\\text{{{}}}", text(word)),
    };
    let all: Vec<String> = written.split(' ').map(word).collect();
    Cell::latex(format!("${}$", all.join(" ")), written)
}
