//! Formulas as LaTeX, for inline mathematics with `amsmath`.

use super::{Clause, Formula, greek, read};
use crate::latex::text;

/// A line as LaTeX: each clause a formula in `$ … $`, which lines break between and, at its signs, within.
pub fn latex(line: &str) -> String {
    let one = |Clause { formula, end, .. }: &Clause<'_>| {
        let mut body = String::new();
        push(formula, &mut body);
        format!("$\\displaystyle {}${end}", body.trim())
    };
    read(line).iter().map(one).collect::<Vec<_>>().join("\\quad ")
}

/// The name of a parameter inside mathematics: `E_kv` is E with an index, `alpha_1` α with one.
pub fn latex_name(text: &str) -> String {
    match text.split_once('_') {
        Some((base, index)) if !base.is_empty() && !index.is_empty() => {
            let parts: Vec<String> = index.split('_').map(letters).collect();
            format!("{}_{{{}}}", letters(base), parts.join(","))
        }
        _ => letters(text),
    }
}

/// One letter is slanted, more are a word.
fn letters(part: &str) -> String {
    let mut all = part.chars();
    match (greek(part), all.next(), all.next()) {
        (Some(_), ..) => format!("\\{part}"),
        (None, Some('δ'), None) => "\\delta".to_owned(),
        (None, Some('ω'), None) => "\\omega".to_owned(),
        (None, Some('ν'), None) => "\\nu".to_owned(),
        (None, Some('Γ'), None) => "\\Gamma".to_owned(),
        (None, Some(c), None) if c.is_ascii_alphanumeric() => c.to_string(),
        _ if !part.is_empty() && part.chars().all(|c| c.is_ascii_digit()) => part.to_owned(),
        _ if part.chars().all(|c| c.is_ascii_alphanumeric()) => format!("\\mathrm{{{part}}}"),
        _ => format!("\\text{{{}}}", text(part)),
    }
}

fn push(formula: &Formula, out: &mut String) {
    fn within(open: &str, part: &Formula, close: &str, out: &mut String) {
        out.push_str(open);
        push(part, out);
        out.push_str(close);
    }
    match formula {
        Formula::Number(number) => out.push_str(number),
        Formula::Name(name) => out.push_str(&latex_name(name)),
        Formula::Sum => out.push_str("\\sum "),
        Formula::Sign('≤') => out.push_str(" \\le "),
        Formula::Sign('≥') => out.push_str(" \\ge "),
        Formula::Sign('−') => out.push_str(" - "),
        Formula::Sign(sign) => out.push_str(&format!(" {sign} ")),
        Formula::Minus => out.push('-'),
        Formula::Comma => out.push_str(", "),
        Formula::Row(parts) => parts.iter().for_each(|part| push(part, out)),
        Formula::Words(words) => out.push_str(&said(words)),
        Formula::Product(both) => {
            push(&both[0], out);
            out.push_str(if matches!(both[1], Formula::Number(_)) { " \\cdot " } else { "\\, " });
            push(&both[1], out);
        }
        Formula::Fraction(both) => {
            within("\\frac{", both[0].unwrapped(), "}", out);
            within("{", both[1].unwrapped(), "}", out);
        }
        Formula::Power(both) => {
            base(&both[0], out);
            within("^{", &both[1], "}", out);
        }
        Formula::Index(both) => {
            within("{", &both[0], "}", out);
            within("_{", &both[1], "}", out);
        }
        Formula::Applied(both) => {
            match &both[0] {
                Formula::Name(name)
                    if name.len() > 1
                        && name.chars().all(char::is_alphanumeric)
                        && letters(name).starts_with("\\mathrm") =>
                {
                    out.push_str(&format!("\\operatorname{{{name}}}"));
                }
                function => push(function, out),
            }
            push(&both[1], out);
        }
        Formula::Operated(both) => {
            within("", &both[0], "\\, ", out);
            push(&both[1], out);
        }
        Formula::Prime(of) => within("{", of, "}'", out),
        Formula::Star(of) => within("{", of, "}^{*}", out),
        // Brackets that grow hold a line together.
        Formula::Brackets(inside) if has_fraction(inside) => within("\\left(", inside, "\\right)", out),
        Formula::Brackets(inside) => within("(", inside, ")", out),
        Formula::Bars(inside) => within("\\lvert ", inside, "\\rvert ", out),
    }
}

/// What is raised: a name stands by itself.
fn base(formula: &Formula, out: &mut String) {
    match formula {
        Formula::Name(_) | Formula::Number(_) | Formula::Brackets(_) | Formula::Bars(_) => push(formula, out),
        other => {
            out.push('{');
            push(other, out);
            out.push('}');
        }
    }
}

fn has_fraction(formula: &Formula) -> bool {
    match formula {
        Formula::Fraction(_) => true,
        Formula::Row(parts) => parts.iter().any(has_fraction),
        Formula::Product(both) | Formula::Applied(both) | Formula::Operated(both) => both.iter().any(has_fraction),
        Formula::Power(both) | Formula::Index(both) => has_fraction(&both[0]),
        Formula::Prime(one) | Formula::Star(one) | Formula::Brackets(one) | Formula::Bars(one) => has_fraction(one),
        _ => false,
    }
}

/// Words, with names of parameters among them as such.
fn said(words: &str) -> String {
    let word = |word: &str| match word.contains('_') || greek(word).is_some() {
        true => latex_name(word),
        false => format!("\\text{{{}}}", text(word)),
    };
    let all: Vec<String> = words.split_whitespace().map(word).collect();
    format!("\\;{}\\;", all.join("\\ "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_of_laws_have_their_places() {
        for (line, expected) in [
            (
                "F = (E_c + E_kv)·x + E_d·D^alpha x − a_kv·E_kv·(T − T_ref)",
                r"$\displaystyle F = (E_{c} + E_{\mathrm{kv}})\, x + E_{d}\, D^{\alpha}\, x - a_{\mathrm{kv}}\, E_{\mathrm{kv}}\, (T - T_{\mathrm{ref}})$",
            ),
            (
                "F + (c/k_m)·F' = c·(1 + k_e/k_m)·x'",
                r"$\displaystyle F + \left(\frac{c}{k_{m}}\right)\, {F}' = c\, \left(1 + \frac{k_{e}}{k_{m}}\right)\, {x}'$",
            ),
            ("K*(ω) = c·(iω)^alpha", r"$\displaystyle {K}^{*}(\omega) = c\, (i\, \omega)^{\alpha}$"),
            ("z' = −|x'|·z²", r"$\displaystyle {z}' = -\lvert {x}'\rvert \, z^{2}$"),
            ("F = F_y·tanh(x'/v_0)", r"$\displaystyle F = F_{y}\, \operatorname{tanh}\left(\frac{{x}'}{v_{0}}\right)$"),
            ("k[1]·e^(−t/tau[1])", r"$\displaystyle {k}_{1}\, e^{-\frac{t}{{\tau}_{1}}}$"),
            (
                "V_min ≤ U; creep x_c",
                r"$\displaystyle V_{\mathrm{min}} \le U$;\quad $\displaystyle \;\text{creep}\ x_{c}\;$",
            ),
        ] {
            assert_eq!(latex(line), expected, "{line}");
        }
    }

    #[test]
    fn what_is_no_equation_stays_balanced_text() {
        for line in ["\\input{x}", "a & b", "((", "F = ", "x ^", "100 % of {", "}", "", "|x", "$x", "~#_^"] {
            let shown = latex(line);
            let plain = shown.replace("\\textbackslash{}", "").replace("\\{", "").replace("\\}", "");
            assert!(!plain.contains("\\input"), "{shown}");
            assert_eq!(plain.matches('{').count(), plain.matches('}').count(), "{line}: {shown}");
            assert_eq!(plain.replace("\\$", "").matches('$').count() % 2, 0, "{line}: {shown}");
        }
    }
}
