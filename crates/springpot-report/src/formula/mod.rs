//! Equations of laws, which are lines of text, as formulas: in MathML for pages, in LaTeX for papers.
//!
//! A line holds clauses with `,` or `;` between them. In a clause, products are written `·`, quotients `/`, powers `^`, derivatives `'`, indices `_` or `[…]`,
//! the fractional derivative `D^alpha x`; Greek letters go by their names. Words beside an equation ("above upper") stay words.

mod latex;
mod mathml;

pub use latex::{latex, latex_name};
pub(crate) use mathml::mathml;

/// A formula, or a part of one.
#[derive(Debug, Clone, PartialEq)]
enum Formula {
    Number(String),
    /// `E_kv` is E with an index, `alpha_1` α with one.
    Name(String),
    Sum,
    /// Between what stands on its sides.
    Sign(char),
    /// Before what it turns round.
    Minus,
    Comma,
    /// Side by side.
    Row(Vec<Formula>),
    Words(String),
    Product(Pair),
    Fraction(Pair),
    /// Base and exponent.
    Power(Pair),
    /// What is indexed, and its index.
    Index(Pair),
    /// A function and its arguments.
    Applied(Pair),
    /// An operator and what it acts on.
    Operated(Pair),
    Prime(Box<Formula>),
    Star(Box<Formula>),
    Brackets(Box<Formula>),
    Bars(Box<Formula>),
}

type Pair = Box<[Formula; 2]>;

fn pair(left: Formula, right: Formula) -> Pair {
    Box::new([left, right])
}

impl Formula {
    /// Without brackets: where a fraction's line or a raised place does what they do.
    fn unwrapped(&self) -> &Self {
        if let Self::Brackets(inside) = self { inside } else { self }
    }
}

/// A clause as it is written, what it says, and the sign behind it or nothing.
struct Clause<'a> {
    text: &'a str,
    formula: Formula,
    end: &'a str,
}

/// The clauses of a line; each a formula where it can be read as one.
fn read(line: &str) -> Vec<Clause<'_>> {
    let clause = |(text, end)| Clause {
        text,
        formula: relation_behind_words(text).unwrap_or_else(|| Formula::Words(text.to_owned())),
        end,
    };
    clauses(line).into_iter().map(clause).collect()
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
fn relation_behind_words(clause: &str) -> Option<Formula> {
    let (lead, rest) = match clause.split_once(" = ") {
        Some((left, _)) if !reads_whole(left) => clause.split_at(left.rfind(' ').map_or(0, |at| at + 1)),
        _ => ("", clause),
    };
    let tokens = tokens(rest)?;
    let mut reader = Reader { tokens: &tokens, at: 0 };
    let formula = reader.relation()?;
    let after = match reader.tokens.get(reader.at) {
        None => None,
        // A single name and words behind it are words.
        Some(_) if reader.at <= 1 && !is_number(&tokens[0]) => return None,
        Some(Token { kind: Kind::Name(_), from }) => Some(&rest[*from..]),
        Some(_) => return None,
    };
    let words = |text: &str| Formula::Words(text.to_owned());
    let lead = (!lead.is_empty()).then(|| words(lead));
    Some(Formula::Row(lead.into_iter().chain([formula]).chain(after.map(words)).collect()))
}

fn reads_whole(text: &str) -> bool {
    let Some(tokens) = tokens(text) else { return false };
    let mut reader = Reader { tokens: &tokens, at: 0 };
    reader.relation().is_some() && reader.at == tokens.len()
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

/// Reads tokens as a formula.
struct Reader<'a> {
    tokens: &'a [Token],
    at: usize,
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

    fn relation(&mut self) -> Option<Formula> {
        let mut all = vec![self.sum()?];
        while let Some(sign) = self.takes("=≤≥<>") {
            all.extend([Formula::Sign(sign), self.sum()?]);
        }
        Some(Formula::Row(all))
    }

    fn sum(&mut self) -> Option<Formula> {
        let mut all: Vec<Formula> = self.takes("−-").map(|_| Formula::Minus).into_iter().collect();
        all.push(self.product()?);
        while let Some(sign) = self.takes("+−-") {
            all.extend([Formula::Sign(if sign == '+' { '+' } else { '−' }), self.product()?]);
        }
        Some(Formula::Row(all))
    }

    fn product(&mut self) -> Option<Formula> {
        let mut left = self.factor()?;
        while let Some(sign) = self.takes("·/") {
            let both = pair(left, self.factor()?);
            left = if sign == '/' { Formula::Fraction(both) } else { Formula::Product(both) };
        }
        Some(left)
    }

    /// A primary with what is behind it: primes, powers, an argument.
    fn factor(&mut self) -> Option<Formula> {
        let is_operator =
            matches!(&self.tokens.get(self.at)?.kind, Kind::Name(name) if ["D", "i", "Σ"].contains(&&**name));
        let mut read = self.primary()?;
        while let Some(sign) = self.takes("'²³^*") {
            read = match sign {
                '\'' => Formula::Prime(Box::new(read)),
                '²' => Formula::Power(pair(read, Formula::Number("2".to_owned()))),
                '³' => Formula::Power(pair(read, Formula::Number("3".to_owned()))),
                '^' => {
                    let sign = self.takes("−-").map(|_| Formula::Minus);
                    let power = self.primary()?.unwrapped().clone();
                    Formula::Power(pair(read, Formula::Row(sign.into_iter().chain([power]).collect())))
                }
                // K*(ω), the complex modulus.
                _ => Formula::Row(vec![Formula::Star(Box::new(read)), self.primary()?]),
            };
        }
        if is_operator && matches!(self.tokens.get(self.at), Some(Token { kind: Kind::Name(_), .. })) {
            return Some(Formula::Operated(pair(read, self.factor()?)));
        }
        Some(read)
    }

    fn primary(&mut self) -> Option<Formula> {
        let token = self.tokens.get(self.at)?;
        self.at += 1;
        match &token.kind {
            Kind::Number(number) => Some(Formula::Number(number.clone())),
            Kind::Name(text) if text == "Σ" => Some(Formula::Sum),
            Kind::Name(text) => {
                let mut named = Formula::Name(text.clone());
                if self.takes("[").is_some() {
                    let index = self.sum()?;
                    self.takes("]")?;
                    named = Formula::Index(pair(named, index));
                }
                match self.sign() {
                    Some('(') if is_function(text) => Some(Formula::Applied(pair(named, self.primary()?))),
                    _ => Some(named),
                }
            }
            Kind::Sign('(') => {
                let mut inside = vec![self.sum()?];
                while self.takes(",").is_some() {
                    inside.extend([Formula::Comma, self.sum()?]);
                }
                self.takes(")")?;
                Some(Formula::Brackets(Box::new(Formula::Row(inside))))
            }
            Kind::Sign('|') => {
                let inside = self.sum()?;
                self.takes("|")?;
                Some(Formula::Bars(Box::new(inside)))
            }
            Kind::Sign(_) => None,
        }
    }
}

/// Products are written with a dot, so that a name before a bracket is that of a function.
fn is_function(name: &str) -> bool {
    name != "i"
}

/// The letter of that name.
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
