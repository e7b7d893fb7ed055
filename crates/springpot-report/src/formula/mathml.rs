//! Formulas as MathML.

use super::{Clause, Formula, greek, read};

/// A line as HTML: each clause a formula that does not break, with commas between them.
pub(crate) fn mathml(line: &str) -> String {
    let clauses: Vec<String> = read(line).iter().map(one).collect();
    clauses.join(" ")
}

fn one(Clause { text, formula, end }: &Clause<'_>) -> String {
    let (mut body, alt) = (String::new(), escaped(text));
    push(formula, &mut body);
    let end = if end.is_empty() { String::new() } else { format!("<mo separator=\"true\">{end}</mo>") };
    format!("<math displaystyle=\"true\" alttext=\"{alt}\"><mrow>{body}{end}</mrow></math>")
}

/// Text inside an element or an attribute.
fn escaped(text: &str) -> String {
    let mut written = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => written.push_str("&amp;"),
            '<' => written.push_str("&lt;"),
            '>' => written.push_str("&gt;"),
            '"' => written.push_str("&quot;"),
            '\'' => written.push_str("&#39;"),
            c => written.push(c),
        }
    }
    written
}

fn push(formula: &Formula, out: &mut String) {
    /// A part, and the tags around it.
    fn within(open: &str, part: &Formula, close: &str, out: &mut String) {
        out.push_str(open);
        push(part, out);
        out.push_str(close);
    }
    match formula {
        Formula::Number(number) => out.push_str(&format!("<mn>{number}</mn>")),
        Formula::Name(text) => out.push_str(&name(text)),
        Formula::Sum => out.push_str("<mo>∑</mo>"),
        Formula::Sign('<') => out.push_str("<mo>&lt;</mo>"),
        Formula::Sign('>') => out.push_str("<mo>&gt;</mo>"),
        Formula::Sign(sign) => out.push_str(&format!("<mo>{sign}</mo>")),
        Formula::Minus => out.push_str("<mo form=\"prefix\">−</mo>"),
        Formula::Comma => out.push_str("<mo separator=\"true\">,</mo>"),
        Formula::Row(parts) => parts.iter().for_each(|part| push(part, out)),
        Formula::Words(text) => out.push_str(&words(text)),
        Formula::Product(both) => {
            within("", &both[0], "<mo>\u{2062}</mo><mspace width=\"0.12em\"/>", out);
            push(&both[1], out);
        }
        Formula::Fraction(both) => {
            within("<mfrac><mrow>", both[0].unwrapped(), "</mrow>", out);
            within("<mrow>", both[1].unwrapped(), "</mrow></mfrac>", out);
        }
        Formula::Power(both) => {
            within("<msup><mrow>", &both[0], "</mrow>", out);
            match &both[1] {
                number @ Formula::Number(_) => within("", number, "</msup>", out),
                power => within("<mrow>", power, "</mrow></msup>", out),
            }
        }
        Formula::Index(both) => {
            within("<msub><mrow>", &both[0], "</mrow>", out);
            within("<mrow>", &both[1], "</mrow></msub>", out);
        }
        Formula::Applied(both) => {
            within("", &both[0], "<mo>\u{2061}</mo>", out);
            push(&both[1], out);
        }
        Formula::Operated(both) => {
            within("", &both[0], "<mspace width=\"0.12em\"/>", out);
            push(&both[1], out);
        }
        Formula::Prime(base) => within("<msup><mrow>", base, "</mrow><mo>′</mo></msup>", out),
        Formula::Star(base) => within("<msup><mrow>", base, "</mrow><mo>*</mo></msup>", out),
        Formula::Brackets(inside) => within("<mrow><mo>(</mo>", inside, "<mo>)</mo></mrow>", out),
        Formula::Bars(inside) => within("<mrow><mo>|</mo>", inside, "<mo>|</mo></mrow>", out),
    }
}

/// Words, with names of parameters among them as such.
fn words(text: &str) -> String {
    let word = |word: &str| {
        if word.contains('_') || greek(word).is_some() {
            name(word)
        } else {
            format!("<mtext>{}</mtext>", escaped(word))
        }
    };
    let space = "<mspace width=\"0.3em\"/>";
    let all: Vec<String> = text.split_whitespace().map(word).collect();
    format!("{space}{}{space}", all.join(space))
}

/// `E_kv` is E with an index, `alpha_1` α with one.
fn name(text: &str) -> String {
    let letter = |part: &str| {
        let shown = greek(part).map_or_else(|| escaped(part), str::to_owned);
        if !part.is_empty() && part.chars().all(|c| c.is_ascii_digit()) {
            format!("<mn>{shown}</mn>")
        } else {
            format!("<mi>{shown}</mi>")
        }
    };
    match text.split_once('_') {
        Some((base, index)) if !base.is_empty() && !index.is_empty() => {
            format!("<msub>{}{}</msub>", letter(base), letter(&index.replace('_', ",")))
        }
        _ => letter(text),
    }
}

#[cfg(test)]
mod tests {
    use super::mathml;

    /// The text of a page without its tags.
    fn plain(html: &str) -> String {
        let mut inside = false;
        let shown = html.chars().filter(|c| {
            inside = *c == '<' || (inside && *c != '>');
            !inside && *c != '>' && !['\u{2061}', '\u{2062}'].contains(c)
        });
        shown.collect()
    }

    #[test]
    fn powers_fractions_and_derivatives_have_their_places() {
        let zener = mathml("F + (c/k_m)·D^alpha F = k_e·x + c·(1 + k_e/k_m)·D^alpha x");
        assert!(zener.contains("<mfrac><mrow><mi>c</mi></mrow><mrow><msub><mi>k</mi><mi>m</mi></msub></mrow></mfrac>"));
        assert!(zener.contains("<msup><mrow><mi>D</mi></mrow><mrow><mi>α</mi></mrow></msup>"), "{zener}");
        assert!(!zener.contains("mtext"), "{zener}");
        let modulus = mathml("K*(ω) = k_e + 1/(1/k_m + 1/(c·(iω)^alpha))");
        // A fraction's line needs no brackets.
        assert_eq!(modulus.matches("<mfrac>").count(), 3, "{modulus}");
        assert_eq!(plain(&modulus), "K*(ω)=ke+11km+1c(iω)α");
        assert_eq!(plain(&mathml("z' = A·x' − gamma·|x'|·z·|z|^(n−1)")), "z′=Ax′−γ|x′|z|z|n−1");
        assert_eq!(plain(&mathml("G(t) = k[1]·e^(−k[1]·t/(k[1]·tau[1]))")), "G(t)=k1e−k1tk1τ1");
    }

    #[test]
    fn words_stay_words() {
        let stop = mathml("F = k·(x − upper) above upper, k·(x − lower) below lower, 0 between");
        assert_eq!(stop.matches("<math ").count(), 3, "{stop}");
        for word in ["above", "below", "between"] {
            assert!(stop.contains(&format!("<mtext>{word}</mtext>")), "{word}: {stop}");
        }
        let stack = mathml("z of e = q/(C + T²/k), V_min ≤ U ≤ V_max; creep x_c of the order alpha_creep");
        assert!(stack.contains("<mtext>of</mtext>") && stack.contains("<mtext>creep</mtext>"), "{stack}");
        assert!(stack.contains("<msub><mi>V</mi><mi>min</mi></msub>") && stack.contains("<mo>≤</mo>"), "{stack}");
        assert!(stack.contains("<msub><mi>α</mi><mi>creep</mi></msub>"), "{stack}");
    }

    #[test]
    fn what_is_no_equation_is_shown_as_it_is() {
        for text in ["<script>alert(1)</script>", "a & b", "((", "F = ", "x ^", "\"", "", "|x"] {
            let shown = mathml(text);
            assert!(!shown.contains("<script") && !shown.contains("alert(1)<"), "{text}: {shown}");
            assert_eq!(shown.matches('<').count(), shown.matches('>').count(), "{text}: {shown}");
        }
        // Deep brackets end.
        assert!(mathml(&"(".repeat(100_000)).len() > 10);
    }
}
