//! Texts damaged at random, the same each time.

/// Numbers that look random and are always the same.
pub(crate) struct Dice(u64);

impl Dice {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// Less than `count`.
    pub(crate) fn roll(&mut self, count: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 11) as usize) % count.max(1)
    }

    pub(crate) fn pick<'a, T: ?Sized>(&mut self, list: &[&'a T]) -> &'a T {
        list[self.roll(list.len())]
    }
}

/// What takes the place of numbers.
const NUMBERS: &str = "0¦-0.0¦1¦-1¦2¦0.5¦1e-9¦1e9¦-1e9¦1e17¦1e25¦1e-300¦1e300¦-1e300¦\
5e-324¦1.7e308¦1e400¦nan¦inf¦-inf¦9007199254740993¦99999999999999999999¦4294967296¦0x7f";

/// What no text expects.
const STRANGE: [&str; 12] =
    ["", " ", "\n", "\"", "\\", "\u{0}", "\u{202e}", "é", "€", "\u{1f916}", "ä\u{308}", "((((((((((((((((((((((((("];

/// One to four changes of a text; `pieces` are words of its language, parted by `¦`.
pub(crate) fn mutated(text: &str, pieces: &str, dice: &mut Dice) -> String {
    let [pieces, values] = [pieces, NUMBERS].map(|list| list.split('¦').collect::<Vec<_>>());
    let mut text = text.to_owned();
    for _ in 0..1 + dice.roll(4) {
        let (a, b) = (place(&text, dice), place(&text, dice));
        let (from, to) = (a.min(b), a.max(b));
        let near = boundary(&text, from + 1 + dice.roll(12));
        match dice.roll(10) {
            0 => text.insert_str(from, dice.pick(&STRANGE)),
            1 => text.replace_range(from..near.max(from), ""),
            2 => {
                let copy = text[from..to].to_owned();
                let times = [1, 1, 1, 2, 40][dice.roll(5)];
                if copy.len() * times < 200_000 {
                    text.insert_str(to, &copy.repeat(times));
                }
            }
            3 => text.replace_range(from..near.max(from), dice.pick(&STRANGE)),
            4 | 5 => text.insert_str(from, dice.pick(&pieces)),
            6 => text.replace_range(from..near.max(from), dice.pick(&pieces)),
            _ => {
                let numbers = numbers(&text);
                if let Some(number) = numbers.get(dice.roll(numbers.len())) {
                    text.replace_range(number.clone(), dice.pick(&values));
                }
            }
        }
    }
    text
}

fn place(text: &str, dice: &mut Dice) -> usize {
    boundary(text, dice.roll(text.len() + 1))
}

/// The nearest end of a character before or at a byte.
fn boundary(text: &str, at: usize) -> usize {
    (0..=at.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0)
}

/// Where numbers stand.
fn numbers(text: &str) -> Vec<std::ops::Range<usize>> {
    let bytes = text.as_bytes();
    let (mut found, mut at) = (Vec::new(), 0);
    while at < bytes.len() {
        let count = bytes[at..].iter().take_while(|b| b.is_ascii_digit() || **b == b'.').count();
        if count > 0 && (at == 0 || !bytes[at - 1].is_ascii_alphabetic()) {
            found.push(at..at + count);
        }
        at += count.max(1);
    }
    found
}
