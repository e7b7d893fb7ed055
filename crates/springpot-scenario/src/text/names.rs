//! Names of files and columns, and what to say of a name that does not exist.

pub(crate) use springpot::names::{is_name, nearest};

use std::borrow::Borrow;

/// Whether `name` is safe as the name of a file on every system.
pub(crate) fn is_file_name(name: &str) -> bool {
    name.len() <= 100
        && name.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '_')
        && !name.ends_with('.')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.'))
}

/// Longest name that is suggested, in bytes.
const LONGEST_SUGGESTED: usize = 40;

/// The name that a text most likely stands for, if it makes one: without accents, and with `_` for blanks and points.
pub(crate) fn as_name(text: &str) -> Option<String> {
    let plain = |c: char| -> Option<&'static str> {
        Some(match c {
            'ä' => "ae",
            'ö' => "oe",
            'ü' => "ue",
            'Ä' => "Ae",
            'Ö' => "Oe",
            'Ü' => "Ue",
            'ß' => "ss",
            'à' | 'á' | 'â' | 'ã' | 'å' => "a",
            'ç' | 'č' | 'ć' => "c",
            'è' | 'é' | 'ê' | 'ë' => "e",
            'ì' | 'í' | 'î' | 'ï' => "i",
            'ñ' => "n",
            'ò' | 'ó' | 'ô' | 'õ' | 'ø' => "o",
            'ù' | 'ú' | 'û' => "u",
            'š' => "s",
            'ž' => "z",
            'đ' => "d",
            ' ' | '.' | '/' => "_",
            _ => return greek(c),
        })
    };
    let mut name = String::new();
    for c in text.trim().chars() {
        match plain(c) {
            Some(letters) => name.push_str(letters),
            None => name.push(c),
        }
    }
    let name = if name.starts_with(|c: char| c.is_ascii_digit()) { format!("_{name}") } else { name };
    (is_name(&name) && name.len() <= LONGEST_SUGGESTED).then_some(name)
}

/// The English name of a Greek letter, as parameters of laws are called.
pub(crate) fn greek(letter: char) -> Option<&'static str> {
    Some(match letter {
        'α' => "alpha",
        'β' => "beta",
        'γ' => "gamma",
        'δ' => "delta",
        'ε' => "epsilon",
        'η' => "eta",
        'λ' => "lambda",
        'μ' | 'µ' => "mu",
        'ν' => "nu",
        'ξ' => "xi",
        'ρ' => "rho",
        'σ' => "sigma",
        'τ' => "tau",
        'φ' | 'ϕ' => "phi",
        'ω' => "omega",
        _ => return None,
    })
}

/// The name among `known` that another word of the field stands for: `alpha` for `order` and α.
pub(crate) fn other_word<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let mut letters = name.chars();
    let letter = letters.next().filter(|_| letters.next().is_none());
    let ours: &[&str] = match (letter.and_then(greek), name.to_lowercase().as_str()) {
        (Some(greek), _) => &[greek],
        (None, "order" | "exponent" | "fractional_order") => &["alpha"],
        (None, "stiffness") => &["k", "E_c"],
        (None, "damping" | "viscosity" | "coefficient") => &["c"],
        (None, "temperature") => &["T"],
        (None, "voltage") => &["u", "U"],
        _ => return None,
    };
    ours.iter().find_map(|ours| known.iter().copied().find(|known| known == ours))
}

/// `a, b and c`, shortened after twelve.
pub fn list<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    const SHOWN: usize = 12;
    let names: Vec<&str> = names.into_iter().collect();
    let shown = names.len().min(SHOWN);
    match (names.len(), names[..shown].split_last()) {
        (n, _) if n > SHOWN => format!("{} and {} more", names[..shown].join(", "), n - SHOWN),
        (_, None) => "none".to_owned(),
        (_, Some((last, []))) => (*last).to_owned(),
        (_, Some((last, others))) => format!("{} and {last}", others.join(", ")),
    }
}

/// `a, b or c`.
pub(crate) fn either<S: Borrow<str>>(choices: impl IntoIterator<Item = S>) -> String {
    let choices: Vec<S> = choices.into_iter().collect();
    match choices.split_last() {
        None => "none".to_owned(),
        Some((last, [])) => last.borrow().to_owned(),
        Some((last, others)) => format!("{} or {}", others.join(", "), last.borrow()),
    }
}

/// What to say of a name that does not exist: the candidate most like it, or else what there is.
pub fn suggest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str> + Clone) -> String {
    match nearest(name, candidates.clone()) {
        Some(right) => format!("did you mean `{right}`?"),
        None if candidates.clone().into_iter().next().is_none() => "nothing can stand here: leave it out".to_owned(),
        None => format!("there is {}", list(candidates)),
    }
}

/// What to write for a name that is that of several, `q.c` where there are `q.c.z` and `q.c.rz`.
pub(crate) fn inside<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<String> {
    let is_inside = |known: &&str| known.strip_prefix(name).is_some_and(|rest| rest.starts_with('.'));
    let parts: Vec<String> = known.filter(is_inside).map(|known| format!("`{known}`")).collect();
    (!parts.is_empty()).then(|| format!("write one of {}", parts.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_stay_in_their_folder() {
        for good in ["order", "figure-1", "a.b", "2_x"] {
            assert!(is_file_name(good), "{good}");
        }
        for bad in ["", "..", ".x", "a/b", "a\\b", "a b", "x.", "a:b"] {
            assert!(!is_file_name(bad), "{bad}");
        }
        assert!(!is_file_name(&"x".repeat(101)));
    }

    #[test]
    fn what_is_suggested() {
        assert_eq!(suggest("rest_lenght", ["law", "rest_length"]), "did you mean `rest_length`?");
        assert_eq!(suggest("zzz", ["a", "b", "c"]), "there is a, b and c");
        assert_eq!(either(["a", "b", "c"]), "a, b or c");
    }
}
