//! The symbols of units, their prefixes, and what to suggest for a symbol that is none.

use super::dimension::Dimension;
use super::twofold::Twofold;

/// What a symbol means: SI = number·up/down·10^decimal, where `up` and `down` are what ten does not divide out.
#[derive(Debug, Clone, Copy)]
pub(super) struct Meaning {
    pub(super) dimension: Dimension,
    pub(super) up: Twofold,
    pub(super) down: Twofold,
    pub(super) decimal: i32,
    /// Added to the number before it is scaled, where the symbol stands alone.
    pub(super) offset: Option<Twofold>,
}

struct Row {
    name: &'static str,
    /// Exponents of kg, m, s, A, K; the mole has none of them.
    dimension: [i8; 5],
    up: u16,
    down: u16,
    decimal: i8,
    prefixes: bool,
}

const fn si(name: &'static str, dimension: [i8; 5]) -> Row {
    Row { name, dimension, up: 1, down: 1, decimal: 0, prefixes: true }
}

const fn scaled(name: &'static str, dimension: [i8; 5], up: u16, down: u16, decimal: i8) -> Row {
    Row { name, dimension, up, down, decimal, prefixes: false }
}

const ROWS: [Row; 23] = [
    si("m", [0, 1, 0, 0, 0]),
    Row { name: "g", dimension: [1, 0, 0, 0, 0], up: 1, down: 1, decimal: -3, prefixes: true },
    si("s", [0, 0, 1, 0, 0]),
    scaled("min", [0, 0, 1, 0, 0], 6, 1, 1),
    scaled("h", [0, 0, 1, 0, 0], 36, 1, 2),
    si("rad", [0; 5]),
    // π is multiplied in by `lookup`.
    scaled("deg", [0; 5], 1, 18, -1),
    si("N", [1, 1, -2, 0, 0]),
    si("J", [1, 2, -2, 0, 0]),
    si("W", [1, 2, -3, 0, 0]),
    si("Pa", [1, -1, -2, 0, 0]),
    si("Hz", [0, 0, -1, 0, 0]),
    si("V", [1, 2, -3, -1, 0]),
    si("A", [0, 0, 0, 1, 0]),
    si("C", [0, 0, 1, 1, 0]),
    si("F", [-1, -2, 4, 2, 0]),
    si("ohm", [1, 2, -3, -2, 0]),
    si("K", [0, 0, 0, 0, 1]),
    si(MOLE, [0; 5]),
    scaled("degC", [0, 0, 0, 0, 1], 1, 1, 0),
    scaled("degF", [0, 0, 0, 0, 1], 5, 9, 0),
    scaled("%", [0; 5], 1, 1, -2),
    scaled("1", [0; 5], 1, 1, 0),
];

/// The symbol whose dimension is none of those five.
const MOLE: &str = "mol";

const PREFIXES: [(&str, i32); 10] = [
    ("p", -12),
    ("n", -9),
    ("u", -6),
    ("\u{b5}", -6),
    ("\u{3bc}", -6),
    ("m", -3),
    ("c", -2),
    ("k", 3),
    ("M", 6),
    ("G", 9),
];

/// Spellings that people try, and ours.
const OTHER_SPELLINGS: [(&str, &str); 24] = [
    ("sec", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("minute", "min"),
    ("minutes", "min"),
    ("hr", "h"),
    ("hour", "h"),
    ("hours", "h"),
    ("meter", "m"),
    ("meters", "m"),
    ("metre", "m"),
    ("metres", "m"),
    ("newton", "N"),
    ("volt", "V"),
    ("volts", "V"),
    ("kelvin", "K"),
    ("celsius", "degC"),
    ("c", "degC"),
    ("fahrenheit", "degF"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("radian", "rad"),
    ("radians", "rad"),
    ("percent", "%"),
];

/// All symbols, for messages.
pub(super) const LIST: &str = "m g s min h rad deg N J W Pa Hz V A C F ohm K mol degC degF % 1";

/// The meaning of a whole symbol, or else of prefix + symbol.
pub(super) fn lookup(symbol: &str) -> Option<Meaning> {
    let (row, prefix) = match ROWS.iter().find(|row| row.name == symbol) {
        Some(row) => (row, 0),
        None => PREFIXES.iter().find_map(|(prefix, power)| {
            let rest = symbol.strip_prefix(prefix)?;
            Some((ROWS.iter().find(|row| row.prefixes && row.name == rest)?, *power))
        })?,
    };
    let up = Twofold::from_f64(f64::from(row.up));
    let hundredths = |n: u32| Twofold::from_f64(f64::from(n)).scaled_by_ten(-2);
    Some(Meaning {
        dimension: dimension(row),
        up: if row.name == "deg" { up.mul(Twofold::PI) } else { up },
        down: Twofold::from_f64(f64::from(row.down)),
        decimal: i32::from(row.decimal) + prefix,
        offset: match row.name {
            "degC" => Some(hundredths(27_315)),
            "degF" => Some(hundredths(45_967)),
            _ => None,
        },
    })
}

fn dimension(row: &Row) -> Dimension {
    let [kg, m, s, a, k] = row.dimension.map(f64::from);
    Dimension::with_amount([kg, m, s, a, k, if row.name == MOLE { 1.0 } else { 0.0 }])
}

/// What was probably meant by an unknown symbol.
pub(super) fn suggest(symbol: &str) -> Option<String> {
    let spelled = symbol.replace(['\u{3a9}', '\u{2126}'], "ohm").replace(['\u{b0}', '\u{ba}'], "deg");
    if spelled != symbol && lookup(&spelled).is_some() {
        return Some(spelled);
    }
    let lower = symbol.to_lowercase();
    if let Some((_, ours)) = OTHER_SPELLINGS.iter().find(|(other, _)| *other == lower) {
        return Some((*ours).to_owned());
    }
    missing_caret(symbol).or_else(|| nearest(symbol)).or_else(|| missing_product(symbol)).or_else(|| other_case(symbol))
}

fn every_symbol() -> impl Iterator<Item = String> {
    ROWS.iter().flat_map(|row| {
        let prefixed = PREFIXES.iter().filter(|_| row.prefixes).map(|(prefix, _)| format!("{prefix}{}", row.name));
        std::iter::once(row.name.to_owned()).chain(prefixed)
    })
}

fn other_case(symbol: &str) -> Option<String> {
    let changed = |other: &str| symbol.chars().zip(other.chars()).filter(|(a, b)| a != b).count();
    every_symbol().filter(|other| other.eq_ignore_ascii_case(symbol)).min_by_key(|other| changed(other))
}

/// `m2` and `m²` for `m^2`.
fn missing_caret(symbol: &str) -> Option<String> {
    let plain: String = symbol
        .chars()
        .map(|c| match c {
            '\u{b2}' => '2',
            '\u{b3}' => '3',
            c => c,
        })
        .collect();
    let name = plain.trim_end_matches(|c: char| c.is_ascii_digit());
    (name.len() < plain.len() && lookup(name).is_some()).then(|| format!("{name}^{}", &plain[name.len()..]))
}

/// `Nm` for `N*m`; but `Kg` is kg.
fn missing_product(symbol: &str) -> Option<String> {
    let cuts = symbol.char_indices().skip(1).map(|(at, _)| symbol.split_at(at));
    let mut found = cuts.filter(|(a, b)| *a != "K" && lookup(a).is_some() && lookup(b).is_some());
    found.next().map(|(first, second)| format!("{first}*{second}"))
}

fn nearest(symbol: &str) -> Option<String> {
    if symbol.chars().count() < 3 {
        return None;
    }
    let close = |other: &str| strsim::damerau_levenshtein(symbol, other) == 1;
    ROWS.iter().map(|row| row.name).filter(|name| name.len() > 2).find(|name| close(name)).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::{LIST, ROWS, lookup, suggest};

    #[test]
    fn the_list_is_the_table() {
        let names: Vec<_> = ROWS.iter().map(|row| row.name).collect();
        assert_eq!(LIST.split(' ').collect::<Vec<_>>(), names);
    }

    #[test]
    fn suggests_what_was_meant() {
        for (symbol, meant) in [
            ("Nm", "N*m"),
            ("m2", "m^2"),
            ("m\u{b2}", "m^2"),
            ("kn", "kN"),
            ("KG", "kg"),
            ("Kg", "kg"),
            ("Nms", "N*ms"),
            ("mins", "min"),
            ("sec", "s"),
            ("k\u{3a9}", "kohm"),
            ("\u{b0}C", "degC"),
            ("ohms", "ohm"),
            ("HZ", "Hz"),
        ] {
            assert!(lookup(symbol).is_none(), "{symbol}");
            assert_eq!(suggest(symbol).as_deref(), Some(meant), "{symbol}");
        }
        assert_eq!(suggest("furlong"), None);
    }
}
