//! Names: their rules, and the nearest right one to a wrong one.

/// Longest name that is compared with others; longer ones resemble nothing.
const MAX_COMPARED: usize = 64;

/// Whether `name` matches `[A-Za-z_][A-Za-z0-9_-]*`.
pub(crate) fn is_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
}

/// Whether `name` is safe as the name of a file on every system.
pub(crate) fn is_file_name(name: &str) -> bool {
    name.len() <= 100
        && name.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '_')
        && !name.ends_with('.')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.'))
}

/// The candidate most like `name`, if any is like it at all.
pub(crate) fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if name.len() > MAX_COMPARED {
        return None;
    }
    let folded = name.to_lowercase();
    candidates
        .into_iter()
        .filter(|candidate| candidate.len() <= MAX_COMPARED)
        .map(|candidate| {
            // What only lacks a prefix is meant: `joint1` for `panda_joint1`.
            let is_end = name.len() > 2 && candidate.ends_with(name);
            let likeness = if is_end { 1.0 } else { strsim::jaro_winkler(&folded, &candidate.to_lowercase()) };
            (likeness, candidate)
        })
        .filter(|(likeness, _)| *likeness > 0.78)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// `a, b and c`, shortened after twelve.
pub(crate) fn list<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
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

/// What to say of a name that does not exist: the candidate most like it, or else what there is.
pub fn suggest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str> + Clone) -> String {
    match nearest(name, candidates.clone()) {
        Some(right) => format!("did you mean `{right}`?"),
        None => format!("there is {}", list(candidates)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_follow_the_rule() {
        for good in ["a", "_", "upper_arm", "A-1", "x9"] {
            assert!(is_name(good), "{good}");
        }
        for bad in ["", "1a", "-a", "a b", "a.b", "ä", "a/b"] {
            assert!(!is_name(bad), "{bad}");
        }
    }

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
    fn the_nearest_name_is_like_it() {
        let keys = ["rest_length", "law", "parameters", "from"];
        assert_eq!(nearest("rest_lenght", keys), Some("rest_length"));
        assert_eq!(nearest("Law", keys), Some("law"));
        assert_eq!(nearest("zzz", keys), None);
        assert_eq!(nearest("joint2", ["panda_joint1", "panda_joint2", "joint3x"]), Some("panda_joint2"));
        assert_eq!(suggest("zzz", ["a", "b", "c"]), "there is a, b and c");
    }
}
