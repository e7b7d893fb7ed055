//! Text, numbers and units.

/// Text as LaTeX in roman letters: nothing in it is a command.
pub fn text(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    push(text, false, &mut out);
    out
}

/// Text of several lines as it stands, in letters of one width; long lines are broken at their blanks.
pub fn code(text: &str) -> String {
    let mut out = String::from("{\\raggedright\\ttfamily\\footnotesize\n");
    for line in text.lines() {
        let words = line.trim_start();
        let indent = line.chars().count() - words.chars().count();
        out.push_str("\\mbox{}");
        out.push_str(&"~".repeat(indent));
        push(words, true, &mut out);
        out.push_str("\\\\\n");
    }
    out.push_str("}\n\n");
    out
}

/// Characters after which a long word may be broken.
const BREAKS: &str = "/._,=:-";
/// Characters of a word that needs no place to be broken.
const LONGEST_WORD: usize = 24;

fn push(text: &str, is_code: bool, out: &mut String) {
    let mut rest = text.chars().peekable();
    let mut run = 0;
    let mut length = word_length(text);
    let mut at = 0;
    while let Some(c) = rest.next() {
        if c.is_whitespace() {
            run = 0;
            at += c.len_utf8();
            length = word_length(&text[at..]);
            out.push(if is_code && c == '\t' { '~' } else { ' ' });
            continue;
        }
        at += c.len_utf8();
        run += 1;
        if let Some(accent) = rest.peek().copied().and_then(dots) {
            rest.next();
            at += accent.1;
            out.push_str(&format!("$\\{}{{{c}}}$", accent.0));
            continue;
        }
        match c {
            '\\' => out.push_str("\\textbackslash{}"),
            '{' | '}' | '$' | '&' | '#' | '%' | '_' => out.extend(['\\', c]),
            '^' => out.push_str("\\textasciicircum{}"),
            '~' => out.push_str("\\textasciitilde{}"),
            '<' if !is_code => out.push_str("$<$"),
            '>' if !is_code => out.push_str("$>$"),
            '|' if !is_code => out.push_str("$|$"),
            // Letters of one width have an upright one.
            '\'' if is_code => out.push_str("{\\char13}"),
            '"' if !is_code => out.push_str("''"),
            '`' => out.push_str("\\textasciigrave{}"),
            // No ligatures: two hyphens are two.
            '-' | '\'' | ',' | '?' | '!' => out.extend([c, '{', '}']),
            ' '..='~' => out.push(c),
            c => match symbol(c) {
                Some(symbol) => out.push_str(symbol),
                None if is_letter(c) => out.push(c),
                None => out.push_str(&format!("\\texttt{{U+{:04X}}}", u32::from(c))),
            },
        }
        if length > LONGEST_WORD && run > 2 && BREAKS.contains(c) {
            out.push_str("\\allowbreak{}");
        }
    }
}

fn word_length(text: &str) -> usize {
    text.chars().take_while(|c| !c.is_whitespace()).count()
}

/// The accent of a combining character, and its bytes.
fn dots(c: char) -> Option<(&'static str, usize)> {
    match c {
        '\u{307}' => Some(("dot", c.len_utf8())),
        '\u{308}' => Some(("ddot", c.len_utf8())),
        _ => None,
    }
}

/// Letters that the fonts of TeX have, or make of a letter and an accent.
fn is_letter(c: char) -> bool {
    matches!(c, 'À'..='ÿ' | 'Ā'..='ž')
        && !"ÐðÞþ×÷ĦħĸŊŋŦŧŉſĿŀĐđ".contains(c)
        && !('Ĳ'..='ĳ').contains(&c)
        && !"ĄąĘęĮįŲų".contains(c)
}

fn symbol(c: char) -> Option<&'static str> {
    Some(match c {
        '\u{a0}' | '\u{202f}' | '\u{2009}' => "~",
        'α' => "$\\alpha$",
        'β' => "$\\beta$",
        'γ' => "$\\gamma$",
        'δ' => "$\\delta$",
        'ε' => "$\\varepsilon$",
        'ζ' => "$\\zeta$",
        'η' => "$\\eta$",
        'θ' => "$\\theta$",
        'ι' => "$\\iota$",
        'κ' => "$\\kappa$",
        'λ' => "$\\lambda$",
        'μ' | 'µ' => "$\\mu$",
        'ν' => "$\\nu$",
        'ξ' => "$\\xi$",
        'π' => "$\\pi$",
        'ρ' => "$\\rho$",
        'σ' => "$\\sigma$",
        'τ' => "$\\tau$",
        'υ' => "$\\upsilon$",
        'φ' => "$\\varphi$",
        'χ' => "$\\chi$",
        'ψ' => "$\\psi$",
        'ω' => "$\\omega$",
        'Γ' => "$\\Gamma$",
        'Δ' => "$\\Delta$",
        'Θ' => "$\\Theta$",
        'Λ' => "$\\Lambda$",
        'Ξ' => "$\\Xi$",
        'Π' => "$\\Pi$",
        'Σ' | '∑' => "$\\Sigma$",
        'Φ' => "$\\Phi$",
        'Ψ' => "$\\Psi$",
        'Ω' => "$\\Omega$",
        '·' | '⋅' => "$\\cdot$",
        '×' => "$\\times$",
        '÷' => "$\\div$",
        '±' => "$\\pm$",
        '−' => "$-$",
        '≤' => "$\\le$",
        '≥' => "$\\ge$",
        '≈' => "$\\approx$",
        '≠' => "$\\ne$",
        '→' => "$\\to$",
        '∞' => "$\\infty$",
        '∂' => "$\\partial$",
        '∫' => "$\\int$",
        '√' => "$\\surd$",
        '°' => "$^\\circ$",
        '′' => "$'$",
        '″' => "$''$",
        '¹' => "$^1$",
        '²' => "$^2$",
        '³' => "$^3$",
        '⁰' => "$^0$",
        '⁴' => "$^4$",
        '⁵' => "$^5$",
        '⁶' => "$^6$",
        '⁷' => "$^7$",
        '⁸' => "$^8$",
        '⁹' => "$^9$",
        '⁻' => "$^-$",
        '⁺' => "$^+$",
        'ⁿ' => "$^n$",
        'ᵅ' => "$^\\alpha$",
        '₀' => "$_0$",
        '₁' => "$_1$",
        '₂' => "$_2$",
        '₃' => "$_3$",
        '₄' => "$_4$",
        '₅' => "$_5$",
        '₆' => "$_6$",
        '₇' => "$_7$",
        '₈' => "$_8$",
        '₉' => "$_9$",
        '–' => "--",
        '—' => "---",
        '…' => "\\dots{}",
        '‘' => "`",
        '’' => "'{}",
        '“' => "``",
        '”' => "''",
        '«' => "$\\ll$",
        '»' => "$\\gg$",
        '•' => "$\\bullet$",
        '©' => "\\copyright{}",
        '§' => "\\S{}",
        _ => return None,
    })
}

/// A number, written with digits and an exponent behind `e`, inside mathematics.
pub fn number(written: &str) -> String {
    let written = written.replace('−', "-");
    match written.split_once(['e', 'E']) {
        Some((digits, power)) if power.parse::<i32>().is_ok() => {
            format!("{digits}\\times 10^{{{}}}", power.trim_start_matches('+'))
        }
        _ => written,
    }
}

/// A unit inside mathematics, upright: `N*s^alpha/m`, `kg·m^2`; nothing for a pure number.
pub fn unit(unit: &str) -> String {
    let mut out = String::new();
    let mut rest = unit;
    while let Some(c) = rest.chars().next() {
        let (taken, more) = rest.split_at(c.len_utf8());
        rest = more;
        match c {
            '*' | '·' => out.push_str("\\,"),
            '/' => out.push('/'),
            '^' => {
                let end = rest.find(|c: char| !(c.is_alphanumeric() || "-.".contains(c))).unwrap_or(rest.len());
                let power = match &rest[..end] {
                    "alpha" => "\\alpha",
                    power => power,
                };
                out.push_str(&format!("^{{{power}}}"));
                rest = &rest[end..];
            }
            c if c.is_alphanumeric() => {
                let end = rest.find(|c: char| !c.is_alphanumeric()).unwrap_or(rest.len());
                let symbol = [taken, &rest[..end]].concat();
                rest = &rest[end..];
                out.push_str(&match &*symbol {
                    "degC" => "{}^\\circ\\mathrm{C}".to_owned(),
                    "deg" => "{}^\\circ".to_owned(),
                    "ohm" => "\\Omega".to_owned(),
                    symbol => format!("\\mathrm{{{symbol}}}"),
                });
            }
            '(' | ')' | '.' | '-' => out.push(c),
            _ => out.push_str(&format!("\\text{{{}}}", text(taken))),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_a_text_is_a_command() {
        assert_eq!(
            text("\\input{a} $x$ & 5 % #1 ~^_ <b> \"q\" --"),
            "\\textbackslash{}input\\{a\\} \\$x\\$ \\& 5 \\% \\#1 \\textasciitilde{}\\textasciicircum{}\\_ $<$b$>$ ''q'' -{}-{}"
        );
        assert_eq!(
            text("α = 0.5, 25 °C, N·m, Q₂, q\u{307}"),
            "$\\alpha$ = 0.5,{} 25 $^\\circ$C,{} N$\\cdot$m,{} Q$_2$,{} $\\dot{q}$"
        );
        assert_eq!(text("Atanacković 中"), "Atanacković \\texttt{U+4E2D}");
        assert_eq!(
            code("a = 'b'\n  c"),
            "{\\raggedright\\ttfamily\\footnotesize\n\\mbox{}a = {\\char13}b{\\char13}\\\\\n\\mbox{}~~c\\\\\n}\n\n"
        );
    }

    #[test]
    fn long_words_can_be_broken() {
        assert!(!text("strut.force").contains("allowbreak"));
        assert!(text("element.strut.parameters.alpha_0").contains(".\\allowbreak{}strut"));
    }

    #[test]
    fn quantities_are_mathematics() {
        assert_eq!(number("-1.25e-7"), "-1.25\\times 10^{-7}");
        assert_eq!(number("12"), "12");
        assert_eq!(unit("N*s^alpha/m"), "\\mathrm{N}\\,\\mathrm{s}^{\\alpha}/\\mathrm{m}");
        assert_eq!(unit("kg·m^2"), "\\mathrm{kg}\\,\\mathrm{m}^{2}");
        assert_eq!(unit(""), "");
    }
}
