//! Names: their rule, and the nearest right one to a wrong one.

/// Whether `name` matches `[A-Za-z_][A-Za-z0-9_-]*`.
pub fn is_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
}

/// The candidate most like `name`, the last of equals, if any is like it at all.
#[cfg(feature = "urdf")]
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // Longer names resemble nothing.
    const MAX_COMPARED: usize = 64;
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
            let other = candidate.to_lowercase();
            // Or its end: `pd` for `pd-gravity`.
            let rest = other.strip_prefix(&folded).filter(|_| folded.len() > 1);
            let is_start = rest.is_some_and(|rest| rest.starts_with(['-', '_']));
            // A letter too few or too many, of which the measure thinks ill in short names.
            let is_slip = folded.len().min(other.len()) > 1
                && folded.len() != other.len()
                && strsim::levenshtein(&folded, &other) == 1;
            let likeness = match candidate.strip_suffix(name) {
                // The coordinate of a joint before all else that is told of it.
                Some("q.") => 1.1,
                Some(_) if is_end => 1.0,
                _ => strsim::jaro_winkler(&folded, &other),
            };
            let likeness = if is_slip { likeness.max(0.9) } else { likeness };
            let likeness = if is_start { 0.95 + 0.05 * likeness } else { likeness };
            (likeness, candidate)
        })
        .filter(|(likeness, _)| *likeness > 0.78)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
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

    #[cfg(feature = "urdf")]
    #[test]
    fn the_nearest_name_is_like_it() {
        let keys = ["rest_length", "law", "parameters", "from"];
        assert_eq!(nearest("rest_lenght", keys), Some("rest_length"));
        assert_eq!(nearest("Law", keys), Some("law"));
        assert_eq!(nearest("zzz", keys), None);
        assert_eq!(nearest("rn", ["check", "run"]), Some("run"));
        assert_eq!(nearest("q1", ["q2", "x1"]), None);
        assert_eq!(nearest("joint2", ["panda_joint1", "panda_joint2", "joint3x"]), Some("panda_joint2"));
        assert_eq!(nearest("pd", ["pid", "pd-gravity", "pd-gravity-2", "pid"]), Some("pd-gravity"));
        assert_eq!(nearest("joint2", ["left_joint2", "right_joint2"]), Some("right_joint2"));
        let columns = ["q.shoulder", "v.shoulder", "tau.shoulder", "strut.Q.shoulder"];
        assert_eq!(nearest("shoulder", columns), Some("q.shoulder"));
        assert_eq!(nearest("q1", ["q.q1", "v.q1", "q.q2"]), Some("q.q1"));
    }
}
