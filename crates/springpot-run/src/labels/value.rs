//! Swept values as a legend shows them.

use springpot::observe::symbol::subscript;

/// Numbers with no more digits than these stay as they are written.
const MOST_DIGITS: usize = 6;
/// Digits that longer numbers are rounded to, where they tell the values apart.
const FEW_DIGITS: usize = 4;

/// Values of a sweep as written, for a legend: long numbers with as few digits as tell them apart, names and units as a reader writes
/// them, no TOML.
pub fn values(written: &[String]) -> Vec<String> {
    let shown = |digits: usize| -> Vec<String> { written.iter().map(|text| value(text, digits)).collect() };
    let distinct = |texts: &[String]| {
        let mut texts: Vec<&String> = texts.iter().collect();
        texts.sort_unstable();
        texts.dedup();
        texts.len()
    };
    let all = distinct(&shown(17));
    (FEW_DIGITS..=MOST_DIGITS).map(shown).find(|texts| distinct(texts) == all).unwrap_or_else(|| shown(17))
}

/// One value; numbers of more than [`MOST_DIGITS`] are rounded to `digits`.
fn value(written: &str, digits: usize) -> String {
    let text = written.trim();
    match text.strip_prefix('{').and_then(|text| text.strip_suffix('}')) {
        Some(inner) => table(&entries(inner), digits),
        None => formula(text, digits),
    }
}

/// Keys and values of an inline table; texts lose their quotes.
fn entries(inner: &str) -> Vec<(&str, &str)> {
    let mut parts = Vec::new();
    let (mut start, mut depth, mut quote) = (0, 0, None);
    for (at, c) in inner.char_indices() {
        match (quote, c) {
            (Some(open), _) if c == open => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(c),
            (None, '{' | '[') => depth += 1,
            (None, '}' | ']') => depth -= 1,
            (None, ',') if depth == 0 => {
                parts.push(&inner[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&inner[start..]);
    let plain = |text| str::trim_matches(str::trim(text), ['"', '\'']);
    parts.into_iter().filter_map(|part| part.split_once('=')).map(|(key, value)| (plain(key), plain(value))).collect()
}

fn table(entries: &[(&str, &str)], digits: usize) -> String {
    let get = |key: &str| entries.iter().find(|(name, _)| *name == key).map(|(_, value)| *value);
    if let Some(expression) = get("expression") {
        let text = formula(expression, digits);
        let Some(unit) = get("unit") else { return text };
        let unit = formula(unit, digits);
        return if is_sum(expression) { format!("({text}) {unit}") } else { format!("{text} {unit}") };
    }
    match (get("csv"), get("column")) {
        (Some(file), Some(column)) => format!("{column} of {file}"),
        (Some(file), None) => file.to_owned(),
        (None, _) => {
            let each = entries.iter().map(|(key, text)| format!("{key} = {}", value(text, digits)));
            each.collect::<Vec<_>>().join(", ")
        }
    }
}

/// Whether a unit behind it would belong to the last summand alone.
fn is_sum(expression: &str) -> bool {
    let mut depth = 0;
    let mut before = None;
    expression.chars().filter(|c| !c.is_whitespace()).any(|c| {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
        let follows = before.is_some_and(|c: char| c.is_alphanumeric() || c == ')');
        before = Some(c);
        depth == 0 && matches!(c, '+' | '-') && follows
    })
}

/// A quantity or an expression with its symbols.
fn formula(text: &str, digits: usize) -> String {
    let mut shown = String::new();
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let length = match c {
            _ if c.is_ascii_digit() || (c == '.' && rest[1..].starts_with(|c: char| c.is_ascii_digit())) => {
                let length = number_length(rest);
                shown.push_str(&rounded(&rest[..length], digits));
                length
            }
            _ if c.is_alphabetic() => {
                let length = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
                let name = symbol(&rest[..length]);
                // 2·π is written 2π.
                if name == "π"
                    && shown
                        .trim_end()
                        .strip_suffix('·')
                        .is_some_and(|before| before.ends_with(|c: char| c.is_ascii_digit()))
                {
                    shown.truncate(shown.trim_end().len() - '·'.len_utf8());
                }
                shown.push_str(&name);
                length
            }
            '*' if rest.starts_with("**") => {
                shown.push('^');
                2
            }
            '*' => {
                shown.truncate(shown.trim_end().len());
                shown.push('·');
                1 + rest[1..].len() - rest[1..].trim_start().len()
            }
            c => {
                shown.push(c);
                c.len_utf8()
            }
        };
        rest = &rest[length..];
    }
    super::raise(&shown).replace(" - ", " − ")
}

/// A name as a symbol, with its index lowered: `pi` becomes π, `mu_0` μ₀, `E_d` E with a d.
pub(super) fn symbol(name: &str) -> String {
    let (root, index) = name.split_once('_').map_or((name, None), |(root, index)| (root, Some(index)));
    let root = match root {
        "alpha" => "α",
        "beta" => "β",
        "gamma" => "γ",
        "delta" => "δ",
        "eta" => "η",
        "lambda" => "λ",
        "mu" => "μ",
        "omega" => "ω",
        "phi" => "φ",
        "pi" => "π",
        "rho" => "ρ",
        "sigma" => "σ",
        "tau" => "τ",
        "theta" => "θ",
        "degC" => "°C",
        "degF" => "°F",
        "deg" => "°",
        other => other,
    };
    match index {
        None => root.into(),
        Some(digits) if !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit()) => {
            format!("{root}{}", subscript(digits))
        }
        // Long names are no symbols.
        Some(index) if root.chars().count() == 1 && !index.is_empty() => format!("{root}_{{{index}}}"),
        Some(index) => format!("{root}_{index}"),
    }
}

fn number_length(text: &str) -> usize {
    let digits = |text: &str| text.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(text.len());
    let mut length = digits(text);
    if let Some(after) = text[length..].strip_prefix(['e', 'E']) {
        let sign = usize::from(after.starts_with(['+', '-']));
        let exponent = after[sign..].find(|c: char| !c.is_ascii_digit()).unwrap_or(after[sign..].len());
        if exponent > 0 {
            length += 1 + sign + exponent;
        }
    }
    length
}

/// A number as written, or rounded where it has more than [`MOST_DIGITS`].
fn rounded(written: &str, digits: usize) -> String {
    let mantissa = written.split(['e', 'E']).next().unwrap_or(written);
    let significant = mantissa.replace('.', "").trim_start_matches('0').trim_end_matches('0').len();
    let Some(value) = written.parse::<f64>().ok().filter(|value| significant > MOST_DIGITS && value.is_finite()) else {
        return written.to_owned();
    };
    let text = format!("{value:.*e}", digits - 1);
    let Some((mantissa, exponent)) = text.split_once('e') else { return written.to_owned() };
    if (-4..=5).contains(&exponent.parse().unwrap_or(0)) {
        return text.parse::<f64>().map_or(text.clone(), |value| value.to_string());
    }
    let mantissa = if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { mantissa };
    let raised = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        c => c.to_digit(10).and_then(|digit| char::from_u32('⁰' as u32 + digit)).unwrap_or(c),
    };
    format!("{mantissa}×10{}", exponent.chars().map(raised).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(written: &[&str]) -> Vec<String> {
        values(&written.iter().map(|text| (*text).to_owned()).collect::<Vec<_>>())
    }

    #[test]
    fn numbers_have_as_few_digits_as_tell_them_apart() {
        assert_eq!(shown(&["0.1", "0.233333333333333", "0.9"]), ["0.1", "0.2333", "0.9"]);
        assert_eq!(
            shown(&["21.1474252688113 N*s^alpha/m", "44.7213595499958 N*s^alpha/m"]),
            ["21.15 N·sᵅ/m", "44.72 N·sᵅ/m"]
        );
        assert_eq!(shown(&["1.000012345", "1.000023456"]), ["1.00001", "1.00002"]);
        assert_eq!(shown(&["1.00000001", "1.00000002"]), ["1.00000001", "1.00000002"]);
        assert_eq!(shown(&["1.23456789e-9", "1e-3", "123456789"]), ["1.235×10⁻⁹", "1e-3", "1.235×10⁸"]);
        assert_eq!(shown(&["0.123456", "1.50"]), ["0.123456", "1.50"]);
    }

    #[test]
    fn expressions_have_their_symbols() {
        let table = "{ expression = \"5*sin(2*pi*f*t)\", unit = \"mm\" }";
        assert_eq!(shown(&[table]), ["5·sin(2π·f·t) mm"]);
        assert_eq!(shown(&["{ expression = '1 + 2 * cos(omega_0*t)', unit = 'N*m' }"]), ["(1 + 2·cos(ω₀·t)) N·m"]);
        assert_eq!(shown(&["{ csv = \"a.csv\", column = \"T\" }", "{csv='b.csv'}"]), ["T of a.csv", "b.csv"]);
        assert_eq!(shown(&["60*sin(2*pi*8*t)", "0.1 + pi", "-t**2"]), ["60·sin(2π·8·t)", "0.1 + π", "-t²"]);
        assert_eq!(shown(&["3*step(t - 1)"]), ["3·step(t − 1)"]);
        assert_eq!(
            shown(&["25 degC", "90 deg", "5 deg/s", "exact", "expansion-2004(7)", "riemann-liouville"]),
            ["25 °C", "90 °", "5 °/s", "exact", "expansion-2004(7)", "riemann-liouville"]
        );
        assert_eq!(
            ["E_d", "mu_0", "alpha_pz", "output_step", "E_"].map(symbol),
            ["E_{d}", "μ₀", "α_{pz}", "output_step", "E_"]
        );
    }
}
