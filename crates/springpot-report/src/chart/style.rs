//! Colours and dashes of curves, by label and kind.

use crate::draw::{Color, INK, Stroke};

/// Plasma at 0, 0.1 … 0.9: even in lightness for colour-blind readers and grey prints, and wide in hue, so that neighbours are told
/// apart where curves cross. Its pale end is left out on white paper.
const PLASMA: [Color; 10] = [
    Color(0x0d, 0x08, 0x87),
    Color(0x41, 0x04, 0x9d),
    Color(0x6a, 0x00, 0xa8),
    Color(0x8f, 0x0d, 0xa4),
    Color(0xb1, 0x2a, 0x90),
    Color(0xcc, 0x47, 0x78),
    Color(0xe1, 0x64, 0x62),
    Color(0xf2, 0x84, 0x4b),
    Color(0xfc, 0xa6, 0x36),
    Color(0xfc, 0xce, 0x25),
];
/// Where on the table above the last of an ordered set stands.
const LIGHTEST: f64 = 8.4;

/// Okabe and Ito's colours, told apart by colour-blind readers; black and their yellow, too pale for lines, are left out.
const OKABE_ITO: [Color; 6] = [
    Color(0x00, 0x72, 0xb2),
    Color(0xd5, 0x5e, 0x00),
    Color(0x00, 0x9e, 0x73),
    Color(0xcc, 0x79, 0xa7),
    Color(0xe6, 0x9f, 0x00),
    Color(0x56, 0xb4, 0xe9),
];

/// Solid first, then dashes, so that a curve hidden by another still shows through its gaps.
const DASHES: [&[f64]; 12] = [
    &[],
    &[7.0, 3.0],
    &[7.0, 2.5, 1.6, 2.5],
    &[2.0, 2.2],
    &[12.0, 3.0],
    &[10.0, 2.0, 1.6, 2.0, 1.6, 2.0],
    &[4.0, 2.0],
    &[12.0, 2.5, 4.0, 2.5],
    &[7.0, 2.0, 7.0, 2.0, 1.6, 2.0],
    &[4.0, 6.0],
    &[10.0, 2.0, 1.6, 2.0, 1.6, 2.0, 1.6, 2.0],
    &[16.0, 5.0],
];
/// Kinds beyond the dashes are told apart by how much wider they are, each turn of the dashes by so much.
const WIDER: f64 = 0.7;
/// Of them, those that labels without kinds are told apart by.
const PLAIN: usize = 4;
/// Colours that are told apart without dashes.
const FEW: usize = 6;

/// The stroke of every label of every kind, `[label][kind]`. Labels that differ in one number only, rising or falling, form an
/// ordered set, from dark to light; others get distinct colours. Where there are several kinds, each has a dash; else labels have, where
/// colours alone do not tell them apart.
pub(super) fn strokes(labels: &[&str], kinds: usize) -> Vec<Vec<Stroke>> {
    let count = labels.len();
    let width = if count * kinds > 8 { 1.4 } else { 1.7 };
    let ordered = is_ordered(labels);
    let last = count.saturating_sub(1).max(1) as f64;
    let stroke = |i: usize, kind: usize| {
        // Beside kinds the dash is taken, so that many labels need as many colours.
        let color = if ordered || (kinds > 1 && count > FEW) { plasma(i as f64 / last) } else { OKABE_ITO[i % FEW] };
        let dash = match (kinds > 1, ordered) {
            (true, _) => return of_kind(color, width, kind),
            (false, true) if count > FEW => DASHES[i % PLAIN],
            (false, true) => DASHES[0],
            // Colours and dashes advance together; after a full turn of colours the dashes shift.
            (false, false) => DASHES[(i + i / 12) % PLAIN],
        };
        Stroke::new(color, width).dashed(dash)
    };
    (0..count).map(|i| (0..kinds.max(1)).map(|kind| stroke(i, kind)).collect()).collect()
}

/// What stands for a kind in the legend, whatever the label.
pub(super) fn dash(kind: usize) -> Stroke {
    of_kind(INK, 1.4, kind)
}

fn of_kind(color: Color, width: f64, kind: usize) -> Stroke {
    Stroke::new(color, width + WIDER * (kind / DASHES.len()) as f64).dashed(DASHES[kind % DASHES.len()])
}

/// What points without lines are drawn in.
pub(super) fn points(k: usize) -> Stroke {
    Stroke::new(if k == 0 { INK } else { GREYS[(k - 1) % GREYS.len()] }, 1.4)
}

/// Of further points, told apart by how light they are.
const GREYS: [Color; 3] = [Color(0x8a, 0x8a, 0x8a), Color(0x5c, 0x5c, 0x5c), Color(0xb0, 0xb0, 0xb0)];

/// From dark to light, 0 … 1.
pub(super) fn plasma(place: f64) -> Color {
    let at = place * LIGHTEST;
    let i = (at.floor() as usize).min(PLASMA.len() - 2);
    let (a, b, t) = (PLASMA[i], PLASMA[i + 1], at - i as f64);
    let mix = |a: u8, b: u8| (f64::from(a) + t * (f64::from(b) - f64::from(a))).round() as u8;
    Color(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

fn is_ordered(labels: &[&str]) -> bool {
    let Some(parts) = labels.iter().map(|label| number(label)).collect::<Option<Vec<_>>>() else { return false };
    let same_text = parts.windows(2).all(|pair| pair[0].0 == pair[1].0 && pair[0].2 == pair[1].2);
    let steady = |rises: bool| parts.windows(2).all(|pair| (pair[0].1 < pair[1].1) == rises && pair[0].1 != pair[1].1);
    parts.len() > 2 && same_text && (steady(true) || steady(false))
}

/// Splits a label at its last number: text before, value, text after. A number that ends a word, as in "joint1", is none.
fn number(label: &str) -> Option<(&str, f64, &str)> {
    let end = label.rfind(|c: char| c.is_ascii_digit())? + 1;
    let head = &label[..end];
    let digits = |c: char| c.is_ascii_digit() || matches!(c, '.' | 'e' | 'E' | '-' | '+' | '−');
    let start = head.char_indices().rev().take_while(|(_, c)| digits(*c)).last().map(|(i, _)| i)?;
    // "alpha-0.5" and "e1" hold letters and hyphens that are no part of the number: drop them until it reads.
    head[start..]
        .char_indices()
        .find_map(|(skip, _)| {
            let at = start + skip;
            head[at..].replace('−', "-").parse().ok().map(|value| (&label[..at], value, &label[end..]))
        })
        .filter(|(before, ..)| !before.ends_with(|c: char| c.is_alphanumeric() || "_-".contains(c)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sweeps_are_ordered() {
        assert!(is_ordered(&["α = 0.1", "α = 0.5", "α = 1"]));
        assert!(is_ordered(&["0 degC", "15 degC", "30 degC"]));
        assert!(is_ordered(&["c = 1e-3", "c = 1e-2", "c = 0.1"]));
        assert!(is_ordered(&["U = 60 V", "U = 0 V", "U = −60 V"]));
        assert!(!is_ordered(&["exact", "expansion-2004(7)", "expansion-2004(30)"]));
        assert!(!is_ordered(&["a 1", "b 2", "c 3"]));
        assert!(!is_ordered(&["α = 0.1", "α = 0.5"]));
        assert!(!is_ordered(&["1", "3", "2"]));
        assert!(!is_ordered(&["", "", ""]));
        assert!(!is_ordered(&["q of joint1", "q of joint2", "q of joint3"]));
    }

    #[test]
    fn strokes_differ() {
        for (count, kinds) in [(2, 1), (6, 1), (24, 1), (3, 6), (10, 4), (2, 7), (3, 12), (2, 40)] {
            let names: Vec<String> = (0..count).map(|i| format!("{}", char::from(b'a' + i))).collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let strokes = strokes(&names, kinds).concat();
            for (i, a) in strokes.iter().enumerate() {
                assert!(strokes[..i].iter().all(|b| a != b), "{i} of {count} in {kinds}");
            }
        }
        let sweep: Vec<String> = (0..30).map(|i| format!("T = {i}")).collect();
        let sweep: Vec<&str> = sweep.iter().map(String::as_str).collect();
        let strokes = strokes(&sweep, 1).concat();
        assert!(strokes.windows(2).all(|pair| pair[0].color != pair[1].color && pair[0].dash != pair[1].dash));
    }

    #[test]
    fn colours_are_labels_and_dashes_kinds() {
        let all = strokes(&["α = 0.1", "α = 0.5", "α = 0.9"], 2);
        for label in &all {
            assert!(label[0].color == label[1].color && label[0].dash != label[1].dash);
        }
        assert!(all[0][0].color != all[1][0].color && all[0][1].dash == all[1][1].dash);
        assert_eq!(dash(1).dash, all[0][1].dash);
        let kinds: Vec<Stroke> = (0..40).map(dash).collect();
        assert!(kinds.iter().enumerate().all(|(i, kind)| !kinds[..i].contains(kind)));
    }
}
