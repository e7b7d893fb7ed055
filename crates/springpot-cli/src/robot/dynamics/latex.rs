//! The equations of motion at one time as LaTeX.

use super::terms::{MOST_WITH_CHRISTOFFEL, MOST_WITH_MATRIX, ROUNDING, closes, largest};
use springpot::driver::{ElementTerm, Equation};
use springpot::model::Dimension;
use springpot::system::System;
use springpot_report::formula::{latex as formula, latex_name};
use springpot_report::latex::{Cell, Column, document, number, table, text, unit};
use springpot_run::numbers::{brief, rough, short};

/// A document with the equation, and every term of it in numbers.
///
/// With n = 1 for an angle and 0 for a length, a_ab is in kg·m^(n_a + n_b), Γ_ab,c in kg·m^(n_a + n_b + n_c − 1) and Q_c in N·m^n_c.
pub(super) fn latex(title: Option<&str>, case: &str, system: &System, equation: &Equation) -> String {
    let page = Page::new(system, equation);
    let mut body = String::new();
    if !case.is_empty() {
        body.push_str(&format!("{}\n\n", text(case)));
    }
    body.push_str(&page.law());
    body.push_str(&page.state());
    body.push_str(&page.mass());
    body.push_str(&page.symbols());
    body.push_str(&page.elements());
    body.push_str(&page.forces());
    body.push_str(&match closes(equation) {
        Ok(share) => format!("These terms close to ${}$ of the largest of them.\n", number(&rough(share))),
        Err(unknown) => format!("Where -- stands, {}.\n", text(&unknown)),
    });
    document(title.unwrap_or("Equations of motion"), &body)
}

struct Page<'a> {
    system: &'a System,
    equation: &'a Equation,
    /// Names of the velocities.
    names: Vec<String>,
    /// 1 for an angle, 0 for a length.
    powers: Vec<i32>,
}

impl<'a> Page<'a> {
    fn new(system: &'a System, equation: &'a Equation) -> Self {
        let labels = system.model.v_labels();
        let power = |dimension: Dimension| i32::from(dimension == Dimension::Angle);
        Self {
            powers: labels.iter().map(|label| power(label.dimension)).collect(),
            names: labels.into_iter().map(|label| label.name).collect(),
            system,
            equation,
        }
    }

    fn n(&self) -> usize {
        self.names.len()
    }

    fn has_symbols(&self) -> bool {
        self.equation.christoffel.is_some()
    }

    /// The equation as it is written for any robot.
    fn law(&self) -> String {
        let mut forces = vec!["Q^{\\mathrm{g}}_c".to_owned()];
        if !self.equation.elements.is_empty() {
            forces.push("\\sum_e Q^{e}_c".to_owned());
        }
        if self.has_losses() {
            forces.push("Q^{\\mathrm{joints}}_c".to_owned());
        }
        forces.push("\\tau_c".to_owned());
        let sum = forces.join(" + ");
        let words = format!(
            "At $t = {}\\,\\mathrm{{s}}$, summed over indices that stand twice:\n",
            number(&short(self.equation.t))
        );
        let left = match self.has_symbols() {
            true => "a_{ac}(q)\\,\\ddot q_a + \\Gamma_{ab,c}(q)\\,\\dot q_a\\,\\dot q_b",
            false => "a_{ac}(q)\\,\\ddot q_a + C_{ca}(q, \\dot q)\\,\\dot q_a",
        };
        let mut body = format!("{words}\\[\n{left} = {sum}\n\\]\n");
        if self.has_symbols() {
            body.push_str(
                "\\[\n\\Gamma_{ab,c} = \\tfrac{1}{2} \\left( \\frac{\\partial a_{bc}}{\\partial q_a} + \\frac{\\partial a_{ac}}{\\partial q_b} \
                 - \\frac{\\partial a_{ab}}{\\partial q_c} \\right)",
            );
            body.push_str(if self.equation.elements.is_empty() { "\n\\]\n" } else { ", \\qquad " });
        } else if !self.equation.elements.is_empty() {
            body.push_str("\\[\n");
        }
        if !self.equation.elements.is_empty() {
            body.push_str("Q^{e}_c = -F_e\\,\\frac{\\partial y_e}{\\partial q_c}\n\\]\n");
        }
        body.push('\n');
        body
    }

    fn has_losses(&self) -> bool {
        let model = &self.system.model;
        model.damping().iter().chain(model.friction()).any(|x| *x != 0.0)
    }

    fn state(&self) -> String {
        let springpot::equations::State { q, v, a } = &self.equation.state;
        let unit_of = |k: usize| if self.powers[k] == 1 { "rad" } else { "m" };
        if self.system.model.is_one_degree() {
            let columns = heads(&[
                ("", false),
                ("coordinate", false),
                ("$q$", true),
                ("$\\dot q$", true),
                ("$\\ddot q$", true),
                ("unit", false),
            ]);
            let rows: Vec<Vec<Cell>> = (0..self.n())
                .map(|k| {
                    let numbers = [q[k], v[k], a[k]].map(|x| cell(x, 0.0));
                    let unit = format!("{0}, {0}/s, {0}/s²", unit_of(k));
                    index(k, &self.names[k]).into_iter().chain(numbers).chain([Cell::text(&unit)]).collect()
                })
                .collect();
            return table("", &columns, &rows);
        }
        let columns = heads(&[("", false), ("coordinate", false), ("$q$", true)]);
        let labels = self.system.model.q_labels();
        let rows: Vec<Vec<Cell>> = (labels.iter().zip(q).enumerate())
            .map(|(k, (label, q))| index(k, &label.name).into_iter().chain([cell(*q, 0.0)]).collect())
            .collect();
        let first = table("", &columns, &rows);
        let columns =
            heads(&[("", false), ("velocity", false), ("$\\dot q$", true), ("$\\ddot q$", true), ("unit", false)]);
        let rows: Vec<Vec<Cell>> = (0..self.n())
            .map(|k| {
                let unit = format!("{0}/s, {0}/s²", unit_of(k));
                index(k, &self.names[k])
                    .into_iter()
                    .chain([cell(v[k], 0.0), cell(a[k], 0.0), Cell::text(&unit)])
                    .collect()
            })
            .collect();
        [first, table("", &columns, &rows)].concat()
    }

    /// a_ab with its units.
    fn mass(&self) -> String {
        let n = self.n();
        if n > MOST_WITH_MATRIX {
            return format!("{}\n\n", text(&format!("a_ab has {n} rows: --json prints it.")));
        }
        let most = largest(&self.equation.mass);
        let row = |row: &[f64]| row.iter().map(|x| shown(*x, most)).collect::<Vec<_>>().join(" & ");
        let rows: Vec<String> = self.equation.mass.chunks(n).map(row).collect();
        let matrix = format!("\\begin{{bmatrix}}\n{}\n\\end{{bmatrix}}", rows.join(" \\\\\n"));
        let alike = self.powers.iter().all(|power| *power == self.powers[0]);
        let units = if alike {
            format!("\\,{}", unit(&kilograms(2 * self.powers[0])))
        } else {
            let row = |a: &i32| self.powers.iter().map(|b| unit(&kilograms(a + b))).collect::<Vec<_>>().join(" & ");
            let rows: Vec<String> = self.powers.iter().map(row).collect();
            format!(", \\qquad [a] = \\begin{{bmatrix}}\n{}\n\\end{{bmatrix}}", rows.join(" \\\\\n"))
        };
        format!("\\[\n(a_{{ab}}) = {matrix}{units}\n\\]\n\n")
    }

    /// The symbols that are not 0, with a ≤ b.
    fn symbols(&self) -> String {
        let n = self.n();
        let gamma = match &self.equation.christoffel {
            Some(gamma) if n <= MOST_WITH_CHRISTOFFEL => gamma,
            _ => return String::new(),
        };
        let most = largest(gamma);
        let mut found = Vec::new();
        for a in 0..n {
            for b in a..n {
                for c in 0..n {
                    let value = gamma[(a * n + b) * n + c];
                    if value != 0.0 && value.abs() >= ROUNDING * most {
                        let unit = unit(&kilograms(self.powers[a] + self.powers[b] + self.powers[c] - 1));
                        let name = format!("\\Gamma_{{{}{},{}}}", a + 1, b + 1, c + 1);
                        found.push(format!("${name} = {}\\,{unit}$", shown(value, most)));
                    }
                }
            }
        }
        if found.is_empty() {
            return "$\\Gamma_{ab,c} = 0$ for all $a$, $b$, $c$.\n\n".to_owned();
        }
        format!(
            "{{\\raggedright The symbols that are not 0, with $\\Gamma_{{ab,c}} = \\Gamma_{{ba,c}}$:\\quad {}\\par}}\n\n",
            found.join(",\\quad ")
        )
    }

    /// Each element: its law, its stroke and its force.
    fn elements(&self) -> String {
        let mut body = String::new();
        for (term, element) in self.equation.elements.iter().zip(&self.system.elements) {
            let ElementTerm { name, length, stroke, rate, derivative, force, inputs, .. } = term;
            body.push_str(&format!("\\textbf{{{}}}\\quad {}\n\n", text(name), formula(&element.entry.equation)));
            // On an angle m reads rad and N reads N m.
            let [m, newton] = if element.measure.is_rotation() { ["rad", "N*m"] } else { ["m", "N"] };
            let known =
                [("y", *length, m), ("x", *stroke, m), ("x'", *rate, &*format!("{m}/s")), ("F", *force, newton)]
                    .map(|(name, value, unit)| (name.to_owned(), value, unit.to_owned()));
            let inputs = element.entry.inputs.iter().zip(inputs);
            let inputs = inputs.map(|(input, value)| (latex_name(&input.name), *value, String::from(&*input.unit)));
            let derivative =
                (!derivative.is_nan()).then(|| ("D^{\\alpha} x".to_owned(), *derivative, format!("{m}/s^alpha")));
            let all: Vec<String> = (known.into_iter().chain(derivative).chain(inputs))
                .map(|(name, value, written)| format!("${name} = {}\\,{}$", shown(value, 0.0), unit(&written)))
                .collect();
            body.push_str(&format!("{{\\raggedright {}\\par}}\n\n", all.join(",\\quad ")));
        }
        body
    }

    /// Every term of the equation for every coordinate.
    fn forces(&self) -> String {
        let equation = self.equation;
        let velocity =
            if self.has_symbols() { "$\\Gamma_{ab,c}\\,\\dot q_a\\,\\dot q_b$" } else { "$C_{ca}\\,\\dot q_a$" };
        let mut columns = vec![
            ("", false),
            ("coordinate", false),
            ("$a_{ac}\\,\\ddot q_a$", true),
            (velocity, true),
            ("$Q^{\\mathrm{g}}_c$", true),
        ];
        let mut terms = vec![&equation.inertia, &equation.velocity, &equation.gravity];
        let elements = equation.sum_of_elements();
        if !equation.elements.is_empty() {
            columns.push(("$\\sum_e Q^{e}_c$", true));
            terms.push(&elements);
        }
        if self.has_losses() {
            columns.push(("$Q^{\\mathrm{joints}}_c$", true));
            terms.push(&equation.joints);
        }
        columns.extend([("$\\tau_c$", true), ("unit", false)]);
        terms.push(&equation.tau);
        let largest = equation.largest_term();
        let rows: Vec<Vec<Cell>> = (0..self.n())
            .map(|k| {
                let numbers = terms.iter().map(|term| cell(term[k], largest));
                let unit = Cell::text(if self.powers[k] == 1 { "N·m" } else { "N" });
                index(k, &self.names[k]).into_iter().chain(numbers).chain([unit]).collect()
            })
            .collect();
        table("", &heads(&columns), &rows)
    }
}

/// Titles, as LaTeX, and whether numbers stand below them.
fn heads(titles: &[(&str, bool)]) -> Vec<Column> {
    // Mathematics is about half as wide as it is written.
    let head = |(title, is_number): &(&str, bool)| Column {
        title: Cell::latex((*title).to_owned(), &title[..title.len() / 2]),
        is_number: *is_number,
    };
    titles.iter().map(head).collect()
}

/// Number and name of a coordinate.
fn index(k: usize, name: &str) -> [Cell; 2] {
    [Cell::text(&(k + 1).to_string()), Cell::text(name)]
}

fn cell(value: f64, largest: f64) -> Cell {
    Cell::latex(format!("${}$", shown(value, largest)), &brief(value))
}

/// A number, 0 where it is rounding beside `largest`, or a mark where it is not known.
fn shown(value: f64, largest: f64) -> String {
    match value {
        value if !value.is_finite() => "\\text{--}".to_owned(),
        value if value.abs() < ROUNDING * largest => "0".to_owned(),
        value => number(&brief(value)),
    }
}

/// kg·m^power.
fn kilograms(power: i32) -> String {
    match power {
        0 => "kg".to_owned(),
        1 => "kg*m".to_owned(),
        power => format!("kg*m^{power}"),
    }
}
