//! A law as its parts with the names of their parameters: drawn, and as formulas of complex modulus and relaxation.

use springpot::law::{Derivative, Entry, InputValue, Network, Param, Point};

/// Widest drawing.
const WIDEST: usize = 78;
/// How near a coefficient is to what its parameters make.
const SAME: f64 = 1e-12;

/// A part of a law.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// One of its leaves.
    Leaf(Leaf),
    /// The same stroke, forces add.
    Parallel(Vec<Part>),
    /// The same force, strokes add.
    Series(Vec<Part>),
}

/// A leaf by the names of its parameters.
#[derive(Debug, Clone, PartialEq)]
pub enum Leaf {
    /// Its stiffness.
    Spring(String),
    /// Its coefficient.
    Dashpot(String),
    /// Coefficient and order.
    Springpot(String, String),
    /// An input's force: none of small motions.
    Source,
    /// What is not linear, or has no name of a parameter.
    Other(String),
}

/// A value that stands for a parameter, and the parameter's name.
struct Trial {
    name: String,
    value: f64,
}

impl Part {
    /// The parts of a law; `None` where it is not built of any values that are tried.
    pub fn of(law: &Entry) -> Option<Self> {
        let (mut values, mut trials) = (Vec::new(), Vec::new());
        let terms = if law.params.iter().any(|param| param.is_list) { 2 } else { 1 };
        for (k, param) in law.params.iter().enumerate() {
            for term in 0..if param.is_list { terms } else { 1 } {
                let value = trial(param, k + 7 * term);
                let name = if param.is_list { format!("{}[{}]", param.name, term + 1) } else { param.name.to_string() };
                values.push(value);
                trials.push(Trial { name, value });
            }
        }
        let network = law.build(&values, Derivative::Caputo).ok()?;
        Some(part(&network, law, &trials))
    }

    /// The drawing: parts in series beside one another, parallel ones below one another; `None` where it is too wide, or one leaf.
    pub fn drawing(&self) -> Option<String> {
        if let Self::Leaf(_) = self {
            return None;
        }
        let Block { lines, axis } = self.block();
        let lead = |row: usize| if row == axis { ("o--", "--o") } else { ("   ", "") };
        let whole = lines.iter().enumerate().map(|(row, line)| format!("{}{line}{}", lead(row).0, lead(row).1));
        let whole: Vec<String> = whole.map(|line| line.trim_end().to_owned()).collect();
        let fits = whole.iter().all(|line| line.chars().count() <= WIDEST);
        fits.then(|| whole.iter().map(|line| format!("  {line}\n")).collect())
    }

    fn block(&self) -> Block {
        match self {
            Self::Leaf(leaf) => Block { lines: vec![format!("[{}]", leaf.words())], axis: 0 },
            Self::Series(parts) => {
                let mut parts = parts.iter().map(Self::block);
                let first = parts.next().unwrap_or(Block { lines: vec![String::new()], axis: 0 });
                parts.fold(first, Block::beside)
            }
            Self::Parallel(parts) => Block::above_one_another(parts.iter().map(Self::block).collect()),
        }
    }

    /// K*(ω) as a formula; `None` where it is not linear.
    pub fn modulus(&self) -> Option<String> {
        match self {
            Self::Leaf(Leaf::Spring(k)) => Some(k.clone()),
            Self::Leaf(Leaf::Dashpot(c)) => Some(format!("{}·iω", factor(c))),
            Self::Leaf(Leaf::Springpot(c, alpha)) => Some(format!("{}·(iω)^{alpha}", factor(c))),
            Self::Leaf(Leaf::Source | Leaf::Other(_)) => None,
            Self::Parallel(parts) => {
                let terms = parts.iter().filter(|part| **part != Self::Leaf(Leaf::Source)).map(Self::modulus);
                Some(terms.collect::<Option<Vec<_>>>()?.join(" + "))
            }
            Self::Series(parts) => {
                let inverse = |part: &Self| match part {
                    Self::Leaf(Leaf::Spring(k)) => Some(format!("1/{}", factor(k))),
                    other => other.modulus().map(|modulus| format!("1/({modulus})")),
                };
                let terms: Option<Vec<_>> = parts.iter().map(inverse).collect();
                Some(format!("1/({})", terms?.join(" + ")))
            }
        }
    }

    /// The force that a step of the stroke to 1 leaves, as a formula; `None` where it is not linear, or there is no closed form.
    pub fn relaxation(&self) -> Option<String> {
        match self {
            Self::Leaf(Leaf::Spring(k)) => Some(k.clone()),
            Self::Leaf(Leaf::Dashpot(c)) => Some(format!("{}·δ(t)", factor(c))),
            Self::Leaf(Leaf::Springpot(c, alpha)) => Some(format!("{}·t^−{alpha}/Γ(1 − {alpha})", factor(c))),
            Self::Leaf(Leaf::Source | Leaf::Other(_)) => None,
            Self::Parallel(parts) => {
                let terms = parts.iter().filter(|part| **part != Self::Leaf(Leaf::Source)).map(Self::relaxation);
                Some(terms.collect::<Option<Vec<_>>>()?.join(" + "))
            }
            Self::Series(parts) => match &parts[..] {
                [Self::Leaf(Leaf::Spring(k)), Self::Leaf(damper)] => {
                    Some(format!("{}·{}", factor(k), damper.decay(k)?))
                }
                [Self::Leaf(Leaf::Spring(k)), Self::Parallel(beside)] => match &beside[..] {
                    [Self::Leaf(Leaf::Spring(other)), Self::Leaf(damper)] => {
                        let sum = format!("{k} + {other}");
                        Some(format!("({k}·{other} + {k}²·{})/({sum})", damper.decay(&sum)?))
                    }
                    _ => None,
                },
                [Self::Leaf(Leaf::Dashpot(c)), Self::Parallel(beside)] => match &beside[..] {
                    [Self::Leaf(Leaf::Spring(k)), Self::Leaf(Leaf::Dashpot(other))] => {
                        let sum = format!("({c} + {other})");
                        Some(format!("{c}·{other}/{sum}·δ(t) + {k}·({c}/{sum})²·e^(−{k}·t/{sum})"))
                    }
                    _ => None,
                },
                _ => None,
            },
        }
    }
}

impl Leaf {
    fn words(&self) -> String {
        match self {
            Self::Spring(k) => format!("spring {k}"),
            Self::Dashpot(c) => format!("dashpot {c}"),
            Self::Springpot(c, alpha) => format!("springpot {c}, {alpha}"),
            Self::Source => "source".to_owned(),
            Self::Other(name) => name.clone(),
        }
    }

    /// How the force of a spring `k` behind it falls.
    fn decay(&self, k: &str) -> Option<String> {
        match self {
            Self::Dashpot(c) => Some(format!("e^(−{}·t/{})", factor(k), divisor(c))),
            Self::Springpot(c, alpha) => Some(format!("E_{alpha}(−{}·t^{alpha}/{})", factor(k), divisor(c))),
            _ => None,
        }
    }
}

/// Lines of one width, and the one that goes on to both sides.
struct Block {
    lines: Vec<String>,
    axis: usize,
}

impl Block {
    fn width(&self) -> usize {
        self.lines.first().map_or(0, |line| line.chars().count())
    }

    fn beside(self, other: Self) -> Self {
        let axis = self.axis.max(other.axis);
        let below = (self.lines.len() - self.axis).max(other.lines.len() - other.axis);
        let row = |block: &Self, row: usize| {
            let own = (row + block.axis).checked_sub(axis).and_then(|at| block.lines.get(at));
            own.cloned().unwrap_or_else(|| " ".repeat(block.width()))
        };
        let join = |at: usize| if at == axis { "--" } else { "  " };
        let lines = (0..axis + below).map(|at| format!("{}{}{}", row(&self, at), join(at), row(&other, at)));
        Self { lines: lines.collect(), axis }
    }

    fn above_one_another(blocks: Vec<Self>) -> Self {
        let width = blocks.iter().map(Self::width).max().unwrap_or(0);
        let mut rows: Vec<(String, bool)> = Vec::new();
        for block in blocks {
            let missing = width - block.width();
            for (row, line) in block.lines.iter().enumerate() {
                let is_axis = row == block.axis;
                rows.push((format!("{line}{}", if is_axis { "-" } else { " " }.repeat(missing)), is_axis));
            }
        }
        let ends = || rows.iter().enumerate().filter(|(_, (_, is_axis))| *is_axis).map(|(row, _)| row);
        let (first, last) = (ends().min().unwrap_or(0), ends().max().unwrap_or(0));
        let axis = (first + last) / 2;
        let bordered = |(row, (line, is_axis)): (usize, &(String, bool))| match (*is_axis, first < row && row < last) {
            (true, _) => format!("+--{line}--+"),
            (false, true) if row == axis => format!("+  {line}  +"),
            (false, true) => format!("|  {line}  |"),
            (false, false) => format!("   {line}   "),
        };
        Self { lines: rows.iter().enumerate().map(bordered).collect(), axis }
    }
}

/// A value within the range that no sum of others has.
fn trial(param: &Param, k: usize) -> f64 {
    let spread = (0.618_034 * (k + 1) as f64).fract();
    if param.range.high <= 1.0 {
        return param.range.low.max(0.0) + (0.2 + 0.6 * spread) * (param.range.high - param.range.low.max(0.0));
    }
    (1.0 + spread + 0.01 * k as f64).clamp(param.range.low, param.range.high)
}

fn part(network: &Network, law: &Entry, trials: &[Trial]) -> Part {
    let all = || network.parts().iter().map(|one| part(one, law, trials)).collect();
    match network {
        Network::Parallel(_) => Part::Parallel(all()),
        Network::Series(_) => Part::Series(all()),
        Network::Heated(heated) => part(heated.law(), law, trials),
        Network::Leaf(leaf) => {
            let of = |value: f64| {
                let inputs = vec![InputValue { value, rate: 0.0 }; law.inputs.len()];
                leaf.linearised(&Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &inputs })
            };
            let other = || Part::Leaf(Leaf::Other(leaf.name().to_owned()));
            if leaf.name() == "source" {
                return Part::Leaf(Leaf::Source);
            }
            let (at, order) = (of(0.0).coefficient, of(0.0).order);
            let slope = of(1.0).coefficient - at;
            let varying = law.inputs.first().filter(|_| slope != 0.0);
            let Some(constant) = made_of(at, trials).filter(|_| leaf.is_linear()) else { return other() };
            let coefficient = match varying {
                None => constant,
                Some(input) => match made_of(slope, trials) {
                    Some(slope) => format!("{constant} + {}·{slope}", input.name),
                    None => return other(),
                },
            };
            Part::Leaf(match (leaf.name(), order) {
                ("springpot", _) => match made_of(order, trials) {
                    Some(order) => Leaf::Springpot(coefficient, order),
                    None => return other(),
                },
                (_, 0.0) => Leaf::Spring(coefficient),
                _ => Leaf::Dashpot(coefficient),
            })
        }
    }
}

/// The parameter that has this value, or two whose sum or product it is.
fn made_of(value: f64, trials: &[Trial]) -> Option<String> {
    let same = |other: f64| (value - other).abs() <= SAME * other.abs();
    let one = trials.iter().find(|trial| same(trial.value)).map(|trial| trial.name.clone());
    let pairs = || trials.iter().enumerate().flat_map(|(k, a)| trials[k + 1..].iter().map(move |b| (a, b)));
    let sum = || pairs().find(|(a, b)| same(a.value + b.value)).map(|(a, b)| format!("{} + {}", a.name, b.name));
    let product = || pairs().find(|(a, b)| same(a.value * b.value)).map(|(a, b)| format!("{}·{}", a.name, b.name));
    one.or_else(sum).or_else(product)
}

/// In parentheses where it is a sum.
fn factor(text: &str) -> String {
    if text.contains(" + ") { format!("({text})") } else { text.to_owned() }
}

/// In parentheses where it is no single name.
fn divisor(text: &str) -> String {
    if text.contains(" + ") || text.contains('·') { format!("({text})") } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use springpot::law::Catalog;

    fn parts(name: &str) -> Part {
        Part::of(Catalog::standard().get(name).unwrap()).unwrap()
    }

    #[test]
    fn networks_are_drawn() {
        let drawn = parts("fractional-zener").drawing().unwrap();
        let expected =
            ["  o--+--[spring k_e]------------------------+--o", "     +--[spring k_m]--[springpot c, alpha]--+"];
        assert_eq!(drawn.lines().collect::<Vec<_>>(), expected, "{drawn}");
        for law in Catalog::standard().entries() {
            if let Some(drawn) = Part::of(law).and_then(|part| part.drawing()) {
                assert!(drawn.lines().all(|line| line.chars().count() <= 80), "{}\n{drawn}", law.name);
                assert_eq!(drawn.matches("o--").count(), 1, "{}\n{drawn}", law.name);
            }
        }
    }

    #[test]
    fn formulas_are_those_of_the_parts() {
        let of = |name: &str| (parts(name).modulus().unwrap(), parts(name).relaxation());
        let expect = |name: &str, modulus: &str, relaxation: Option<&str>| {
            assert_eq!(of(name), (modulus.to_owned(), relaxation.map(str::to_owned)), "{name}");
        };
        expect("fractional-zener", "k_e + 1/(1/k_m + 1/(c·(iω)^alpha))", Some("k_e + k_m·E_alpha(−k_m·t^alpha/c)"));
        expect("maxwell", "1/(1/k + 1/(c·iω))", Some("k·e^(−k·t/c)"));
        expect("thermoviscoelastic", "E_c + E_kv + E_d·(iω)^alpha", Some("E_c + E_kv + E_d·t^−alpha/Γ(1 − alpha)"));
        assert!(of("burgers").1.is_none());
        assert!(of("magnetorheological").0.contains("(mu_0 + u·mu)·(iω)^alpha"), "{:?}", of("magnetorheological"));
        assert_eq!(parts("magnetorheological-bouc-wen").modulus(), None);
        // What divides is whole.
        assert!(of("prony").1.unwrap().contains("k[1]·e^(−k[1]·t/(k[1]·tau[1]))"), "{:?}", of("prony"));
    }
}
