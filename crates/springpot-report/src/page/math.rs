//! Equations of laws, which are lines of text, as MathML.
//!
//! A line holds clauses with `,` or `;` between them. In a clause, products are written `·`, quotients `/`, powers `^`, derivatives `'`, indices `_` or `[…]`,
//! the fractional derivative `D^alpha x`; Greek letters go by their names. Words beside an equation ("above upper") stay words.

use super::escaped;

/// A line as HTML: each clause a formula that does not break, with commas between them.
pub(super) fn html(line: &str) -> String {
    let clauses: Vec<String> = clauses(line).iter().map(one).collect();
    clauses.join(" ")
}

/// A clause: a formula where it can be read as one.
fn one((clause, end): &(&str, &str)) -> String {
    let body = relation_behind_words(clause).unwrap_or_else(|| words(clause));
    let alt = escaped(clause);
    let end = if end.is_empty() { String::new() } else { format!("<mo separator=\"true\">{end}</mo>") };
    format!("<math displaystyle=\"true\" alttext=\"{alt}\"><mrow>{body}{end}</mrow></math>")
}

/// Clauses and what stands behind each; what is in brackets holds together.
fn clauses(line: &str) -> Vec<(&str, &str)> {
    let (mut found, mut depth, mut from) = (Vec::new(), 0_i32, 0);
    for (at, c) in line.char_indices() {
        match c {
            '(' | '[' => depth += 1,
            ')' | ']' => depth -= 1,
            ',' | ';' if depth == 0 => {
                found.push((line[from..at].trim(), &line[at..=at]));
                from = at + 1;
            }
            _ => {}
        }
    }
    found.push((line[from..].trim(), ""));
    found.retain(|(clause, _)| !clause.is_empty());
    found
}

/// "z of e = q/C": words, then a relation, then words again.
fn relation_behind_words(clause: &str) -> Option<String> {
    let (lead, rest) = match clause.split_once(" = ") {
        Some((left, _)) if !reads_whole(left) => clause.split_at(left.rfind(' ').map_or(0, |at| at + 1)),
        _ => ("", clause),
    };
    let tokens = tokens(rest)?;
    let mut reader = Reader { tokens: &tokens, at: 0 };
    let formula = reader.relation()?;
    let after = match reader.tokens.get(reader.at) {
        None => String::new(),
        // A single name and words behind it are words.
        Some(_) if reader.at <= 1 && !is_number(&tokens[0]) => return None,
        Some(Token { kind: Kind::Name(_), from }) => words(&rest[*from..]),
        Some(_) => return None,
    };
    Some([if lead.is_empty() { String::new() } else { words(lead) }, formula, after].concat())
}

fn reads_whole(text: &str) -> bool {
    let Some(tokens) = tokens(text) else { return false };
    let mut reader = Reader { tokens: &tokens, at: 0 };
    reader.relation().is_some() && reader.at == tokens.len()
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

/// Tokens of a clause that is read as a formula.
const MOST_TOKENS: usize = 600;

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Number(String),
    Name(String),
    Sign(char),
}

#[derive(Debug, Clone, PartialEq)]
struct Token {
    kind: Kind,
    /// Where in the text.
    from: usize,
}

fn is_number(token: &Token) -> bool {
    matches!(token.kind, Kind::Number(_))
}

/// `None` where a character has no meaning.
fn tokens(text: &str) -> Option<Vec<Token>> {
    let mut found = Vec::new();
    let mut rest = text.char_indices().peekable();
    while let Some((from, c)) = rest.next() {
        let mut take = |is_part: &dyn Fn(char) -> bool| {
            let mut taken = c.to_string();
            while let Some((_, next)) = rest.next_if(|(_, next)| is_part(*next)) {
                taken.push(next);
            }
            taken
        };
        let kind = match c {
            ' ' => continue,
            '0'..='9' => Kind::Number(take(&|c| c.is_ascii_digit() || c == '.')),
            'Σ' | 'δ' | 'Γ' | 'ω' | 'ν' => Kind::Name(c.to_string()),
            // i is the imaginary unit where a letter that is not Latin follows.
            c if c.is_ascii_alphabetic() => Kind::Name(take(&|c| c.is_ascii_alphanumeric() || c == '_')),
            '+' | '−' | '-' | '·' | '/' | '^' | '\'' | '(' | ')' | '[' | ']' | '|' | ',' | '=' | '≤' | '≥' | '<'
            | '>' | '²' | '³' | '*' => Kind::Sign(c),
            _ => return None,
        };
        found.push(Token { kind, from });
        // Brackets in brackets are read by calls in calls.
        if found.len() > MOST_TOKENS {
            return None;
        }
    }
    Some(found)
}

/// Reads tokens as a formula, and writes MathML.
struct Reader<'a> {
    tokens: &'a [Token],
    at: usize,
}

/// Part of a formula: its MathML, and what it is without the brackets around it.
struct Read {
    whole: String,
    bare: Option<String>,
}

impl Read {
    fn of(whole: String) -> Self {
        Self { whole, bare: None }
    }

    /// Without brackets: where a fraction's line or a raised place does what they do.
    fn unwrapped(self) -> String {
        self.bare.unwrap_or(self.whole)
    }
}

impl Reader<'_> {
    fn sign(&self) -> Option<char> {
        match self.tokens.get(self.at)?.kind {
            Kind::Sign(c) => Some(c),
            _ => None,
        }
    }

    fn takes(&mut self, signs: &str) -> Option<char> {
        let found = self.sign().filter(|c| signs.contains(*c))?;
        self.at += 1;
        Some(found)
    }

    fn relation(&mut self) -> Option<String> {
        let mut all = self.sum()?;
        while let Some(sign) = self.takes("=≤≥<>") {
            all.push_str(&operator(sign));
            all.push_str(&self.sum()?);
        }
        Some(all)
    }

    fn sum(&mut self) -> Option<String> {
        let mut all = String::new();
        if let Some(sign) = self.takes("−-") {
            all.push_str(&format!("<mo form=\"prefix\">{}</mo>", minus(sign)));
        }
        all.push_str(&self.product()?);
        while let Some(sign) = self.takes("+−-") {
            all.push_str(&operator(minus(sign)));
            all.push_str(&self.product()?);
        }
        Some(all)
    }

    fn product(&mut self) -> Option<String> {
        let mut left = self.factor()?;
        while let Some(sign) = self.takes("·/") {
            let right = self.factor()?;
            left = Read::of(match sign {
                '/' => format!("<mfrac><mrow>{}</mrow><mrow>{}</mrow></mfrac>", left.unwrapped(), right.unwrapped()),
                _ => format!("{}<mo>\u{2062}</mo><mspace width=\"0.12em\"/>{}", left.whole, right.whole),
            });
        }
        Some(left.whole)
    }

    /// A primary with what is behind it: primes, powers, an argument.
    fn factor(&mut self) -> Option<Read> {
        let is_operator =
            matches!(&self.tokens.get(self.at)?.kind, Kind::Name(name) if ["D", "i", "Σ"].contains(&&**name));
        let mut read = self.primary()?;
        while let Some(sign) = self.sign() {
            read = match sign {
                '\'' => {
                    self.at += 1;
                    Read::of(format!("<msup><mrow>{}</mrow><mo>′</mo></msup>", read.whole))
                }
                '²' | '³' => {
                    self.at += 1;
                    let power = if sign == '²' { 2 } else { 3 };
                    Read::of(format!("<msup><mrow>{}</mrow><mn>{power}</mn></msup>", read.whole))
                }
                '^' => {
                    self.at += 1;
                    let sign = self.takes("−-").map_or(String::new(), |sign| format!("<mo>{}</mo>", minus(sign)));
                    let power = self.primary()?.unwrapped();
                    Read::of(format!("<msup><mrow>{}</mrow><mrow>{sign}{power}</mrow></msup>", read.whole))
                }
                // K*(ω), the complex modulus.
                '*' => {
                    self.at += 1;
                    let argument = self.primary()?.whole;
                    Read::of(format!("<msup><mrow>{}</mrow><mo>*</mo></msup>{argument}", read.whole))
                }
                _ => break,
            };
        }
        if is_operator && matches!(self.tokens.get(self.at), Some(Token { kind: Kind::Name(_), .. })) {
            let argument = self.factor()?.whole;
            return Some(Read::of(format!("{}<mspace width=\"0.12em\"/>{argument}", read.whole)));
        }
        Some(read)
    }

    fn primary(&mut self) -> Option<Read> {
        let token = self.tokens.get(self.at)?;
        self.at += 1;
        match &token.kind {
            Kind::Number(number) => Some(Read::of(format!("<mn>{number}</mn>"))),
            Kind::Name(text) if text == "Σ" => Some(Read::of("<mo>∑</mo>".to_owned())),
            Kind::Name(text) => {
                let mut named = name(text);
                if self.takes("[").is_some() {
                    let index = self.sum()?;
                    self.takes("]")?;
                    named = format!("<msub><mrow>{named}</mrow><mrow>{index}</mrow></msub>");
                }
                match self.sign() {
                    Some('(') if is_function(text) => {
                        let arguments = self.primary()?.whole;
                        Some(Read::of(format!("{named}<mo>\u{2061}</mo>{arguments}")))
                    }
                    _ => Some(Read::of(named)),
                }
            }
            Kind::Sign('(') => {
                let mut inside = self.sum()?;
                while self.takes(",").is_some() {
                    inside.push_str(&format!("<mo separator=\"true\">,</mo>{}", self.sum()?));
                }
                self.takes(")")?;
                let whole = format!("<mrow><mo>(</mo>{inside}<mo>)</mo></mrow>");
                Some(Read { whole, bare: Some(inside) })
            }
            Kind::Sign('|') => {
                let inside = self.sum()?;
                self.takes("|")?;
                Some(Read::of(format!("<mrow><mo>|</mo>{inside}<mo>|</mo></mrow>")))
            }
            Kind::Sign(_) => None,
        }
    }
}

/// Products are written with a dot, so that a name before a bracket is that of a function.
fn is_function(name: &str) -> bool {
    name != "i"
}

fn minus(sign: char) -> char {
    if sign == '-' { '−' } else { sign }
}

fn operator(sign: char) -> String {
    match sign {
        '<' => "<mo>&lt;</mo>".to_owned(),
        '>' => "<mo>&gt;</mo>".to_owned(),
        sign => format!("<mo>{sign}</mo>"),
    }
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

fn greek(name: &str) -> Option<&'static str> {
    Some(match name {
        "alpha" => "α",
        "beta" => "β",
        "gamma" => "γ",
        "delta" => "δ",
        "eta" => "η",
        "lambda" => "λ",
        "mu" => "μ",
        "nu" => "ν",
        "omega" => "ω",
        "tau" => "τ",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let zener = html("F + (c/k_m)·D^alpha F = k_e·x + c·(1 + k_e/k_m)·D^alpha x");
        assert!(zener.contains("<mfrac><mrow><mi>c</mi></mrow><mrow><msub><mi>k</mi><mi>m</mi></msub></mrow></mfrac>"));
        assert!(zener.contains("<msup><mrow><mi>D</mi></mrow><mrow><mi>α</mi></mrow></msup>"), "{zener}");
        assert!(!zener.contains("mtext"), "{zener}");
        let modulus = html("K*(ω) = k_e + 1/(1/k_m + 1/(c·(iω)^alpha))");
        // A fraction's line needs no brackets.
        assert_eq!(modulus.matches("<mfrac>").count(), 3, "{modulus}");
        assert_eq!(plain(&modulus), "K*(ω)=ke+11km+1c(iω)α");
        assert_eq!(plain(&html("z' = A·x' − gamma·|x'|·z·|z|^(n−1)")), "z′=Ax′−γ|x′|z|z|n−1");
        assert_eq!(plain(&html("G(t) = k[1]·e^(−k[1]·t/(k[1]·tau[1]))")), "G(t)=k1e−k1tk1τ1");
    }

    #[test]
    fn words_stay_words() {
        let stop = html("F = k·(x − upper) above upper, k·(x − lower) below lower, 0 between");
        assert_eq!(stop.matches("<math ").count(), 3, "{stop}");
        for word in ["above", "below", "between"] {
            assert!(stop.contains(&format!("<mtext>{word}</mtext>")), "{word}: {stop}");
        }
        let stack = html("z of e = q/(C + T²/k), V_min ≤ U ≤ V_max; creep x_c of the order alpha_creep");
        assert!(stack.contains("<mtext>of</mtext>") && stack.contains("<mtext>creep</mtext>"), "{stack}");
        assert!(stack.contains("<msub><mi>V</mi><mi>min</mi></msub>") && stack.contains("<mo>≤</mo>"), "{stack}");
        assert!(stack.contains("<msub><mi>α</mi><mi>creep</mi></msub>"), "{stack}");
    }

    #[test]
    fn what_is_no_equation_is_shown_as_it_is() {
        for text in ["<script>alert(1)</script>", "a & b", "((", "F = ", "x ^", "\"", "", "|x"] {
            let shown = html(text);
            assert!(!shown.contains("<script") && !shown.contains("alert(1)<"), "{text}: {shown}");
            assert_eq!(shown.matches('<').count(), shown.matches('>').count(), "{text}: {shown}");
        }
        // Deep brackets end.
        assert!(html(&"(".repeat(100_000)).len() > 10);
    }
}
