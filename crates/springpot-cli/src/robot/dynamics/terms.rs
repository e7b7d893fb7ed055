//! The equations of motion as text.

use crate::grid::{Grid, Set, width_of};
use crate::plain;
use crate::terminal;
use springpot::driver::{ElementTerm, Equation};
use springpot::elements::{Element, Measure};
use springpot::system::System;
use springpot_run::numbers::{brief, rough, short};

/// Most velocities for which a_ab, and Γ_ab,c, are printed.
pub(super) const MOST_WITH_MATRIX: usize = 8;
pub(super) const MOST_WITH_CHRISTOFFEL: usize = 6;
/// Longer names than these stand in the first table only, with a number for the others.
const SHORT_NAME: usize = 6;
/// What is smaller than this share of its table is rounding, and is shown as 0.
pub(super) const ROUNDING: f64 = 1e-14;
/// Stands where a number is not known.
const UNKNOWN: &str = "-";

pub(super) fn text(title: Option<&str>, case: &str, system: &System, equation: &Equation) -> String {
    let running = terminal::stdout_width().or(Some(80));
    let page = Page { width: terminal::stdout_columns().unwrap_or(80) };
    let names: Vec<String> = system.model.v_labels().iter().map(|label| plain::line(&label.name)).collect();
    let n = names.len();
    let numbered = names.iter().any(|name| width_of(name) > SHORT_NAME);
    let labels = if numbered { (1..=n).map(|number| number.to_string()).collect() } else { names.clone() };
    let mut text = String::new();
    let mut line = |lead: &str, words: &str| text.push_str(&terminal::hanging(&format!("{lead:<10}"), words, running));
    if let Some(title) = title {
        line("title", &plain::title(title));
    }
    if !case.is_empty() {
        line("case", case);
    }
    line("t", &format!("{} s", short(equation.t)));
    text.push_str("\nin SI units: rad or m, N·m or N\n\n");
    text.push_str(&state(system, equation, &names, &labels, &page));
    let mut left_out = Vec::new();
    if n <= MOST_WITH_MATRIX {
        text.push('\n');
        text.push_str(&page.table("a_ab", &labels, &labels, &square(&equation.mass, n)));
    } else {
        left_out.push("a_ab");
    }
    match &equation.christoffel {
        Some(gamma) if n <= MOST_WITH_CHRISTOFFEL => {
            text.push('\n');
            text.push_str(&christoffel(gamma, &labels, &page));
        }
        Some(_) => left_out.push("Γ_ab,c"),
        None => left_out.push("the Coriolis matrix C"),
    }
    if !left_out.is_empty() {
        let words = format!("--json prints {} too", left_out.join(" and "));
        text.push('\n');
        text.push_str(&terminal::hanging("", &words, running));
    }
    if !equation.elements.is_empty() {
        text.push('\n');
        text.push_str(&elements(system, equation, &page));
    }
    text.push('\n');
    text.push_str(&sum(system, equation, &labels, &page));
    text.push_str(&terminal::hanging("", &closing(equation), running));
    text
}

/// How wide tables may be.
struct Page {
    width: usize,
}

impl Page {
    /// Numbers under names, as many columns at a time as fit.
    fn table(&self, corner: &str, rows: &[String], columns: &[String], numbers: &[Vec<String>]) -> String {
        let label = rows.iter().map(|row| width_of(row)).fold(width_of(corner), usize::max);
        let widths: Vec<usize> = (0..columns.len())
            .map(|c| numbers.iter().map(|row| width_of(&row[c])).fold(width_of(&columns[c]), usize::max) + 4)
            .collect();
        let mut text = String::new();
        let mut from = 0;
        while from < columns.len() {
            let (mut to, mut width) = (from + 1, label + widths[from]);
            while to < columns.len() && width + widths[to] <= self.width {
                width += widths[to];
                to += 1;
            }
            let head = columns[from..to].iter().map(|name| (name.clone(), Set::Number));
            let mut grid = Grid::new([(corner.to_owned(), Set::Name)].into_iter().chain(head));
            for (row, numbers) in rows.iter().zip(numbers) {
                grid.row([row].into_iter().chain(&numbers[from..to]).cloned().collect());
            }
            if from > 0 {
                text.push('\n');
            }
            text.push_str(&grid.text(Some(self.width)));
            from = to;
        }
        text
    }
}

/// A number, or 0 where it is rounding beside `largest`.
fn shown(value: f64, largest: f64) -> String {
    match value {
        value if !value.is_finite() => UNKNOWN.to_owned(),
        value if value.abs() < ROUNDING * largest => "0".to_owned(),
        value => brief(value),
    }
}

pub(super) fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

fn square(matrix: &[f64], n: usize) -> Vec<Vec<String>> {
    let largest = largest(matrix);
    matrix.chunks(n).map(|row| row.iter().map(|x| shown(*x, largest)).collect()).collect()
}

/// q, q̇ and q̈, with the labels of the other tables; floating joints have more numbers in q than in q̇.
fn state(system: &System, equation: &Equation, names: &[String], labels: &[String], page: &Page) -> String {
    let springpot::equations::State { q, v, a } = &equation.state;
    let number = |x: &f64| shown(*x, 0.0);
    let columns = ["q", "q\u{307}", "q\u{308}"].map(str::to_owned);
    let pad = labels.last().map_or(0, |label| width_of(label));
    let named = |(name, label): (&String, &String)| {
        if name == label { name.clone() } else { format!("{label:>pad$}  {name}") }
    };
    let rows: Vec<String> = names.iter().zip(labels).map(named).collect();
    if system.model.is_one_degree() {
        let numbers: Vec<Vec<String>> = (0..names.len()).map(|k| [&q[k], &v[k], &a[k]].map(number).to_vec()).collect();
        return page.table("joint", &rows, &columns, &numbers);
    }
    let q_names: Vec<String> = system.model.q_labels().iter().map(|label| plain::line(&label.name)).collect();
    let of_q: Vec<Vec<String>> = q.iter().map(|x| vec![number(x)]).collect();
    let of_v: Vec<Vec<String>> = v.iter().zip(a).map(|(v, a)| vec![number(v), number(a)]).collect();
    let first = page.table("joint", &q_names, &columns[..1], &of_q);
    format!("{first}\n{}", page.table("joint", &rows, &columns[1..], &of_v))
}

/// The symbols that are not 0; a ≤ b, since Γ_ab,c = Γ_ba,c.
fn christoffel(gamma: &[f64], labels: &[String], page: &Page) -> String {
    let n = labels.len();
    let largest = largest(gamma);
    let (mut rows, mut numbers) = (Vec::new(), Vec::new());
    for a in 0..n {
        for b in a..n {
            let symbols = &gamma[(a * n + b) * n..][..n];
            if symbols.iter().any(|x| x.abs() >= ROUNDING * largest && *x != 0.0) {
                rows.push(format!("{} {}", labels[a], labels[b]));
                numbers.push(symbols.iter().map(|x| shown(*x, largest)).collect());
            }
        }
    }
    if rows.is_empty() {
        return "Γ_ab,c = 0 for all a, b, c\n".to_owned();
    }
    let columns: Vec<String> = labels.iter().map(|label| format!("c = {label}")).collect();
    page.table("Γ_ab,c", &rows, &columns, &numbers)
}

fn elements(system: &System, equation: &Equation, page: &Page) -> String {
    let mut text = String::new();
    let names: Vec<String> = equation.elements.iter().map(|element| element.name.clone()).collect();
    let is_length = |element: &Element| matches!(element.measure, Measure::Line(_) | Measure::Cable(_));
    let [y, stroke] = if system.elements.iter().all(is_length) { ["l", "x = l - l0"] } else { ["y", "x = y - y0"] };
    let columns = [y, stroke, "x'", "D^α x", "F"].map(str::to_owned);
    let numbers = |element: &ElementTerm| {
        let ElementTerm { length, stroke, rate, derivative, force, .. } = element;
        [length, stroke, rate, derivative, force].map(|x| shown(*x, 0.0)).to_vec()
    };
    let rows: Vec<Vec<String>> = equation.elements.iter().map(numbers).collect();
    text.push_str(&page.table("element", &names, &columns, &rows));
    for (term, element) in equation.elements.iter().zip(&system.elements) {
        let inputs: Vec<String> = (element.entry.inputs.iter().zip(&term.inputs))
            .map(|(input, value)| format!("{} = {} {}", input.name, short(*value), input.unit))
            .collect();
        if !inputs.is_empty() {
            text.push_str(&format!("{}: {}\n", term.name, inputs.join(", ")));
        }
    }
    text
}

/// Every term of the equation under every joint, or the other way round where there are many joints.
fn sum(system: &System, equation: &Equation, joints: &[String], page: &Page) -> String {
    let velocity = if equation.christoffel.is_some() { "Γ_ab,c q\u{307}_a q\u{307}_b" } else { "C q\u{307}" };
    let mut terms: Vec<(String, Vec<f64>)> = vec![
        ("a_ac q\u{308}_a".to_owned(), equation.inertia.clone()),
        (velocity.to_owned(), equation.velocity.clone()),
        ("Q gravity".to_owned(), equation.gravity.clone()),
    ];
    let many = joints.len() > MOST_WITH_MATRIX;
    if many && !equation.elements.is_empty() {
        terms.push(("Q elements".to_owned(), equation.sum_of_elements()));
    } else {
        terms.extend(equation.elements.iter().map(|term| (format!("Q {}", term.name), term.q_force.clone())));
    }
    if system.model.damping().iter().chain(system.model.friction()).any(|x| *x != 0.0) {
        terms.push(("Q joints".to_owned(), equation.joints.clone()));
    }
    terms.push(("tau".to_owned(), equation.tau.clone()));
    let largest = equation.largest_term();
    let mut rows: Vec<Vec<String>> =
        terms.iter().map(|(_, numbers)| numbers.iter().map(|x| shown(*x, largest)).collect()).collect();
    let residual = |x: &f64| if x.is_finite() { rough(*x) } else { UNKNOWN.to_owned() };
    rows.push(equation.residual().iter().map(residual).collect());
    let terms: Vec<String> = terms.into_iter().map(|(label, _)| label).chain(["residual".to_owned()]).collect();
    if many {
        let turned: Vec<Vec<String>> =
            (0..joints.len()).map(|joint| rows.iter().map(|row| row[joint].clone()).collect()).collect();
        return page.table("joint", joints, &terms, &turned);
    }
    page.table("term", &terms, joints, &rows)
}

/// How well the equation closes.
fn closing(equation: &Equation) -> String {
    let velocity = if equation.christoffel.is_some() { "Γ_ab,c q\u{307}_a q\u{307}_b" } else { "C q\u{307}" };
    match closes(equation) {
        Ok(0.0) => format!("a_ac q\u{308}_a + {velocity} - ΣQ - tau = 0 exactly"),
        Ok(share) => {
            format!("a_ac q\u{308}_a + {velocity} - ΣQ - tau = 0 to {} of the largest term", rough(share))
        }
        Err(unknown) => unknown,
    }
}

/// The largest residual as a share of the largest term, or why it is not known.
pub(super) fn closes(equation: &Equation) -> Result<f64, String> {
    let infinite = equation.elements.iter().filter(|element| !element.force.is_finite());
    let names: Vec<&str> = infinite.map(|element| element.name.as_str()).collect();
    if !names.is_empty() {
        return Err(format!(
            "the force of {} is infinite at t = 0, after a Riemann-Liouville start from x(0) other than 0, so that the \
             equation is not known",
            names.join(", ")
        ));
    }
    let residual = largest(&equation.residual());
    Ok(if residual == 0.0 { 0.0 } else { residual / equation.largest_term() })
}
