//! The nearest right name to a wrong one.

/// Longest name that is compared with others; longer ones resemble nothing.
const MAX_COMPARED: usize = 64;

/// The candidate most like `name`, if any is like it at all.
pub(super) fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    if name.len() > MAX_COMPARED {
        return None;
    }
    let folded = name.to_lowercase();
    candidates
        .into_iter()
        .filter(|candidate| candidate.len() <= MAX_COMPARED)
        .map(|candidate| {
            // What is only missing a prefix is meant.
            let is_end = !name.is_empty() && candidate.ends_with(name);
            let likeness = if is_end { 1.0 } else { strsim::jaro_winkler(&folded, &candidate.to_lowercase()) };
            (likeness, candidate)
        })
        .filter(|(likeness, _)| *likeness > 0.78)
        .reduce(|best, next| if next.0 > best.0 { next } else { best })
        .map(|(_, candidate)| candidate.to_owned())
}
