//! What a page shows of an output against what is printed.

/// Why the lines shown are not those printed; `None` if they are. `…` alone stands for any lines, in a line for any text.
pub(crate) fn difference(shown: &[String], printed: &[&str]) -> Option<String> {
    // How much of what is shown is found at best tells where it stops.
    let mut furthest = 0;
    if matches(shown, printed, 0, &mut furthest) {
        return None;
    }
    let wanted = shown.get(furthest).map_or("the end", String::as_str);
    Some(format!(
        "the page shows\n{wanted}\nin its line {} of the output, but printed is\n{}",
        furthest + 1,
        printed.join("\n")
    ))
}

fn matches(shown: &[String], printed: &[&str], at: usize, furthest: &mut usize) -> bool {
    *furthest = at.max(*furthest);
    let Some((first, rest)) = shown.split_first() else { return printed.is_empty() };
    if first == "…" {
        return (0..=printed.len()).any(|skipped| matches(rest, &printed[skipped..], at + 1, furthest));
    }
    printed.split_first().is_some_and(|(line, more)| is_as(first, line) && matches(rest, more, at + 1, furthest))
}

/// Whether a line is as shown. A residual is rounding: its numbers may be any.
fn is_as(shown: &str, printed: &str) -> bool {
    let (shown, printed) = (shown.trim_end(), printed.trim_end());
    if shown.starts_with("residual ") && printed.starts_with("residual ") {
        return true;
    }
    let Some((start, rest)) = shown.split_once('…') else { return shown == printed };
    let Some(mut printed) = printed.strip_prefix(start) else { return false };
    let mut parts: Vec<&str> = rest.split('…').collect();
    let end = parts.pop().unwrap_or_default();
    for part in parts {
        let Some(found) = printed.find(part) else { return false };
        printed = &printed[found + part.len()..];
    }
    printed.ends_with(end)
}

#[test]
fn differences_are_found() {
    let difference = |shown: &str, printed: &str| {
        let shown: Vec<String> = shown.lines().map(str::to_owned).collect();
        super::shown::difference(&shown, &printed.lines().collect::<Vec<_>>())
    };
    let printed = "title  A\nq = -0.14595 rad\nq = 2\nended after 0.3 s\n";
    for same in [
        printed,
        "…",
        "title  A\n…",
        "…\nq = 2\n…",
        "…\nq = 2\nended after … s",
        "…\nended after …",
        "title  A\n…\nq = -0.1…5 rad\n…",
        // The first of two lines alike is not the one that the next line follows.
        "…\nq = …\nended …",
    ] {
        assert_eq!(difference(same, printed), None, "{same}");
    }
    for (other, line) in [
        ("title  B\n…", "title  B"),
        ("title  A", "the end"),
        ("…\nq = 3\n…", "q = 3"),
        ("title  A\nq = -0.14596 rad\n…", "q = -0.14596 rad"),
        ("…\nended after … ms", "ended after … ms"),
        ("…\nq = 2\nq = -0.14595 rad\n…", "q = -0.14595 rad"),
        ("title  A\nq = 2\n…", "q = 2"),
    ] {
        let said = difference(other, printed).unwrap_or_else(|| panic!("{other} is taken"));
        assert!(said.contains(&format!("shows\n{line}\n")), "{said}");
    }
    assert!(is_as("residual  0  -2.7e-15", "residual  0   1.1e-16"));
    assert!(!is_as("tau  0  -2.7e-15", "tau  0   1.1e-16"));
}
