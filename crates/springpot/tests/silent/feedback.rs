//! Random feedback laws with kinks in t and in the state against another integrator: the classical method of order 4 in short steps that end on every
//! kink of t, whose times are known in closed form, and on every kink of the state, found by halving.

use super::random::Random;
use super::support::try_run;

/// A law as a tree.
#[derive(Debug)]
enum Law {
    Number(f64),
    T,
    X,
    V,
    Sin(Box<Law>),
    Add(Box<Law>, Box<Law>),
    Times(Box<Law>, Box<Law>),
    Kink(Kink, Box<Law>),
    Max(Box<Law>, Box<Law>),
    Min(Box<Law>, Box<Law>),
}

#[derive(Debug, Clone, Copy)]
enum Kink {
    Abs,
    Sign,
    Step,
}

/// The sides of the kinks in the order in which they are met; those that are not held are taken from the arguments.
#[derive(Debug, Default)]
struct Sides {
    held: Option<Vec<bool>>,
    arguments: Vec<f64>,
}

impl Sides {
    fn below(&mut self, argument: f64) -> bool {
        let k = self.arguments.len();
        self.arguments.push(argument);
        self.held.as_ref().map_or(argument < 0.0, |held| held[k])
    }
}

fn boxed(law: Law) -> Box<Law> {
    Box::new(law)
}

impl Law {
    fn times(factor: f64, law: Self) -> Self {
        Self::Times(boxed(Self::Number(factor)), boxed(law))
    }

    fn value(&self, [t, x, v]: [f64; 3], sides: &mut Sides) -> f64 {
        let at = [t, x, v];
        match self {
            Self::Number(value) => *value,
            Self::T => t,
            Self::X => x,
            Self::V => v,
            Self::Sin(law) => law.value(at, sides).sin(),
            Self::Add(a, b) => a.value(at, sides) + b.value(at, sides),
            Self::Times(a, b) => a.value(at, sides) * b.value(at, sides),
            Self::Max(a, b) | Self::Min(a, b) => {
                let (a, b) = (a.value(at, sides), b.value(at, sides));
                if sides.below(a - b) == matches!(self, Self::Min(..)) { a } else { b }
            }
            Self::Kink(kind, law) => {
                let u = law.value(at, sides);
                match (kind, sides.below(u)) {
                    (Kink::Abs, below) => {
                        if below {
                            -u
                        } else {
                            u
                        }
                    }
                    (Kink::Sign, below) => {
                        if below {
                            -1.0
                        } else {
                            1.0
                        }
                    }
                    (Kink::Step, below) => {
                        if below {
                            0.0
                        } else {
                            1.0
                        }
                    }
                }
            }
        }
    }

    fn text(&self) -> String {
        match self {
            Self::Number(value) => format!("({value:?})"),
            Self::T => "t".into(),
            Self::X => "q.q".into(),
            Self::V => "v.q".into(),
            Self::Sin(law) => format!("sin({})", law.text()),
            Self::Add(a, b) => format!("({} + {})", a.text(), b.text()),
            Self::Times(a, b) => format!("{}*{}", a.text(), b.text()),
            Self::Max(a, b) => format!("max({}, {})", a.text(), b.text()),
            Self::Min(a, b) => format!("min({}, {})", a.text(), b.text()),
            Self::Kink(kind, law) => {
                let name = match kind {
                    Kink::Abs => "abs",
                    Kink::Sign => "sign",
                    Kink::Step => "step",
                };
                format!("{name}({})", law.text())
            }
        }
    }
}

const END: f64 = 6.0;

/// A function of t alone with kinks, whose times are added to `breaks`.
fn of_time(random: &mut Random, breaks: &mut Vec<f64>) -> Law {
    let at = random.within(0.3, END - 0.3);
    let since = |at: f64| Law::Add(boxed(Law::T), boxed(Law::Number(-at)));
    match *random.of(&[0, 1, 2, 3, 4, 5]) {
        0 => {
            breaks.push(at);
            Law::Kink(Kink::Step, boxed(since(at)))
        }
        // A rectangle, or a triangle, of 1 µs to 0.1 s, of an area that is felt.
        1 => {
            let width = random.log(1e-6, 0.1);
            breaks.extend([at, at + width]);
            let fall = Law::times(-1.0, Law::Kink(Kink::Step, boxed(since(at + width))));
            Law::times(0.3 / width.max(1e-3), Law::Add(boxed(Law::Kink(Kink::Step, boxed(since(at)))), boxed(fall)))
        }
        2 => {
            let width = random.log(1e-6, 0.1);
            breaks.extend([at - width, at, at + width]);
            let rise = Law::times(-1.0 / width, Law::Kink(Kink::Abs, boxed(since(at))));
            let roof = Law::Add(boxed(Law::Number(1.0)), boxed(rise));
            Law::times(0.3 / width.max(1e-3), Law::Max(boxed(Law::Number(0.0)), boxed(roof)))
        }
        3 => {
            breaks.push(at);
            Law::Min(boxed(Law::Number(1.0)), boxed(Law::times(1.0 / at, Law::T)))
        }
        kind => {
            let omega = random.within(0.5, 9.0);
            breaks.extend((1..100).map(|k| f64::from(k) * std::f64::consts::PI / omega));
            let wave = boxed(Law::Sin(boxed(Law::times(omega, Law::T))));
            if kind == 4 {
                Law::Kink(*random.of(&[Kink::Abs, Kink::Sign]), wave)
            } else {
                Law::Max(boxed(Law::Number(0.0)), wave)
            }
        }
    }
}

/// A function of the state, with kinks or without.
fn of_state(random: &mut Random) -> Law {
    let line = |random: &mut Random| {
        let place = Law::Add(boxed(Law::X), boxed(Law::Number(random.within(-0.4, 0.4))));
        if random.unit() < 0.3 { Law::times(0.5, Law::V) } else { place }
    };
    match *random.of(&[0, 1, 2, 3, 4]) {
        0 => Law::X,
        1 => Law::Kink(Kink::Abs, boxed(line(random))),
        2 => Law::Max(boxed(Law::Number(random.within(-0.5, 0.5))), boxed(Law::X)),
        3 => {
            let place = Law::Add(boxed(Law::X), boxed(Law::Number(random.within(-0.4, 0.4))));
            Law::times(0.3, Law::Kink(Kink::Step, boxed(place)))
        }
        _ => Law::Sin(boxed(line(random))),
    }
}

/// Both in one: sums, products, and one inside the other.
fn law(random: &mut Random, breaks: &mut Vec<f64>) -> Law {
    let (time, state) = (boxed(of_time(random, breaks)), boxed(of_state(random)));
    let mixed = match *random.of(&[0, 1, 2, 3]) {
        0 => Law::Add(time, state),
        1 => Law::Times(time, state),
        2 => Law::Max(boxed(Law::times(0.5, *time)), state),
        _ => Law::Sin(boxed(Law::Add(time, state))),
    };
    let more = of_time(random, breaks);
    Law::Add(boxed(Law::times(random.within(-2.0, 2.0), mixed)), boxed(Law::times(random.within(-1.0, 1.0), more)))
}

/// m x'' = −k x − c x' + f, or with (c + f)·x' where f is the command of a damper: rows of x.
struct Reference<'l> {
    law: &'l Law,
    is_input: bool,
    breaks: Vec<f64>,
}

const STIFFNESS: f64 = 4.0;
const DAMPING: f64 = 0.6;

impl Reference<'_> {
    fn rates(&self, at: [f64; 3], held: &[bool]) -> [f64; 2] {
        let [_, x, v] = at;
        let said = self.law.value(at, &mut Sides { held: Some(held.to_vec()), arguments: Vec::new() });
        [
            v,
            if self.is_input {
                -STIFFNESS * x - (DAMPING + 1.0 + said) * v
            } else {
                -STIFFNESS * x - DAMPING * v + said
            },
        ]
    }

    fn step(&self, [t, x, v]: [f64; 3], h: f64, held: &[bool]) -> [f64; 3] {
        let mut k = [[0.0; 2]; 4];
        for (i, c) in [0.0, 0.5, 0.5, 1.0].into_iter().enumerate() {
            let [dx, dv] = if i == 0 { [0.0; 2] } else { k[i - 1] };
            k[i] = self.rates([t + c * h, x + c * h * dx, v + c * h * dv], held);
        }
        let mean = |j: usize| (k[0][j] + 2.0 * k[1][j] + 2.0 * k[2][j] + k[3][j]) / 6.0;
        [t + h, x + h * mean(0), v + h * mean(1)]
    }

    fn arguments(&self, at: [f64; 3], held: &[bool]) -> Vec<f64> {
        let mut sides = Sides { held: Some(held.to_vec()), arguments: Vec::new() };
        self.law.value(at, &mut sides);
        sides.arguments
    }

    /// Sides in the middle of the stretch to the next break, where those of t are sure, and at the state.
    fn sides(&self, [t, x, v]: [f64; 3], next: f64) -> Vec<bool> {
        let mut free = Sides::default();
        self.law.value([t + (0.5 * (next - t)).min(1e-7), x, v], &mut free);
        free.arguments.iter().map(|argument| *argument < 0.0).collect()
    }

    /// x at `rows` even times in steps of at most `longest`; `None` where a kink of the state switches to and fro.
    fn rows(&self, start: [f64; 2], rows: usize, longest: f64) -> Option<Vec<f64>> {
        let mut stops: Vec<f64> = self.breaks.iter().copied().filter(|t| 0.0 < *t && *t < END).collect();
        stops.extend((1..=rows).map(|k| END * k as f64 / rows as f64));
        stops.sort_by(f64::total_cmp);
        stops.dedup_by(|a, b| (*a - *b).abs() < 1e-13);
        let (mut at, mut told, mut switches) = ([0.0, start[0], start[1]], Vec::new(), 0);
        for stop in stops {
            let mut held = self.sides(at, stop);
            // A narrow pulse inside a sine turns it many times.
            let longest = longest.min(10.0 * longest * (stop - at[0]));
            while at[0] < stop {
                let h = longest.min(stop - at[0]);
                let next = self.step(at, h, &held);
                let left = |at: [f64; 3]| {
                    let arguments = self.arguments(at, &held);
                    arguments
                        .iter()
                        .zip(&held)
                        .position(|(argument, below)| if *below { *argument > 0.0 } else { *argument < 0.0 })
                };
                if left(next).is_none() {
                    at = if h < longest { [stop, next[1], next[2]] } else { next };
                    continue;
                }
                let (mut low, mut high) = (0.0, h);
                while high - low > 1e-15 * (1.0 + at[0]) {
                    let middle = 0.5 * (low + high);
                    if left(self.step(at, middle, &held)).is_some() { high = middle } else { low = middle }
                }
                let behind = self.step(at, high, &held);
                let kink = left(behind)?;
                held[kink] ^= true;
                at = behind;
                switches += 1;
                if switches > 2000 {
                    return None;
                }
            }
            let is_row = (0..=rows).any(|k| (at[0] - END * k as f64 / rows as f64).abs() < 1e-12);
            if is_row {
                told.push(at[1]);
            }
        }
        Some(told)
    }
}

/// Runs `count` laws; each either ends with a reason or is right.
fn hold(seed: u64, count: usize) {
    const ROWS: usize = 12;
    let mut random = Random(seed);
    let (mut right, mut loud, mut unsure) = (0, 0, 0);
    for number in 0..count {
        let mut breaks = Vec::new();
        let is_input = random.unit() < 0.3;
        let law = law(&mut random, &mut breaks);
        let is_at_rest = random.unit() < 0.3;
        let start = if is_at_rest { [0.0; 2] } else { [random.within(-0.5, 0.5), random.within(-1.0, 1.0)] };
        // A command of a damper stays above −1, so that it damps.
        let law = if is_input {
            Law::Max(boxed(Law::Number(-1.0)), boxed(Law::Min(boxed(Law::Number(5.0)), boxed(law))))
        } else {
            law
        };
        let reference = Reference { law: &law, is_input, breaks };
        let Some([coarse, fine]) = [2e-3, 1e-3]
            .map(|h| reference.rows(start, ROWS, h))
            .into_iter()
            .collect::<Option<Vec<_>>>()
            .map(|both| [both[0].clone(), both[1].clone()])
        else {
            unsure += 1;
            continue;
        };
        let scale = fine.iter().fold(start[0].abs().max(0.1), |m, x| m.max(x.abs()));
        let off = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / scale;
        if off(&coarse, &fine) > 1e-7 {
            unsure += 1;
            continue;
        }
        let text = law.text();
        let (parameters, motion) = if is_input {
            (
                format!(
                    "law = \"magnetorheological\"\nparameters = {{ E_c = {STIFFNESS}, mu_0 = {}, mu = 1, alpha = 1 }}\ninputs = {{ u = \"{text}\" }}",
                    DAMPING + 1.0
                ),
                String::new(),
            )
        } else {
            (
                format!("law = \"kelvin-voigt\"\nparameters = {{ k = {STIFFNESS}, c = {DAMPING} }}"),
                format!("torque = {{ q = \"{text}\" }}"),
            )
        };
        let scenario = format!(
            "[robot]\ngravity = [0, 0, 0]\n[[robot.body]]\nname = \"b\"\njoint = {{ name = \"q\", kind = \"prismatic\", axis = [1, 0, 0] }}\nmass = 1\n\
             [[element]]\nname = \"e\"\njoint = \"q\"\n{parameters}\n[motion]\nkind = \"forward\"\nstart = {{ q = {{ q = {:?} }}, v = {{ q = {:?} }} }}\n{motion}\n\
             [time]\nend = {END}\noutput_step = {}\n",
            start[0],
            start[1],
            END / ROWS as f64
        );
        let run = try_run(&scenario);
        if let Some(error) = run.error {
            println!("{number} is loud: {error}\n{text}");
            loud += 1;
            continue;
        }
        let found = run.column("q.q");
        let error = off(&found[1..], &fine);
        assert!(
            error < 1e-6,
            "law {number} is off by {error:e}: {text} (input: {is_input}) from {start:?}\n{found:?}\n{fine:?}"
        );
        right += 1;
    }
    println!("{right} right, {loud} loud, {unsure} without a sure reference");
    assert!(10 * (loud + unsure) <= 3 * count, "{right} right, {loud} loud, {unsure} unsure of {count}");
}

#[test]
fn random_laws_with_kinks_are_right() {
    hold(0x5eed_f00d_0001, 25);
}

#[test]
#[ignore = "some minutes"]
fn three_hundred_random_laws_with_kinks_are_right() {
    hold(0x5eed_f00d_0002, 300);
}
