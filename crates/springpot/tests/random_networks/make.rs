//! Random networks, motions and pasts.

use springpot::law::leaf::{Polynomial, Stop};
use springpot::law::{Derivative, Network};
use std::sync::Arc;

/// Uniform numbers from a seed (xorshift with a multiplication).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        for _ in 0..8 {
            random.unit();
        }
        random
    }

    /// In [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Alike in every decade.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }
}

/// A network as the references see it.
#[derive(Debug, Clone)]
pub(crate) enum Tree {
    Spring(f64),
    Dashpot(f64),
    Springpot(f64, f64),
    /// k, and the stroke below and above which it presses.
    Stop(f64, f64, f64),
    Tension(f64),
    Compression(f64),
    /// k·x + c·x³.
    Hardening(f64, f64),
    Parallel(Vec<Tree>),
    Series(Vec<Tree>),
}

impl Tree {
    pub(crate) fn network(&self, derivative: Derivative) -> Network {
        let all = |parts: &[Self]| parts.iter().map(|part| part.network(derivative)).collect::<Vec<_>>();
        match self {
            Self::Spring(k) => Network::spring(*k),
            Self::Dashpot(c) => Network::dashpot(*c),
            Self::Springpot(c, alpha) => Network::springpot(*c, *alpha, derivative),
            Self::Stop(stiffness, lower, upper) => Network::leaf(Stop::new(*stiffness, *lower, *upper).unwrap()),
            Self::Tension(k) => Network::leaf(Stop::tension(*k)),
            Self::Compression(k) => Network::leaf(Stop::compression(*k)),
            Self::Hardening(k, c) => Network::leaf(Polynomial::new([*k, 0.0, *c])),
            Self::Parallel(parts) => Network::parallel(all(parts)),
            Self::Series(parts) => Network::series(all(parts)),
        }
    }
}

/// A linear network: springs, dashpots and springpots in any order.
pub(crate) fn linear(random: &mut Random, depth: usize) -> Tree {
    let branches = |random: &mut Random| {
        let count = 2 + random.below(3);
        (0..count).map(|_| linear(random, depth - 1)).collect()
    };
    match random.below(if depth == 0 { 3 } else { 11 }) {
        0 => Tree::Spring(random.decades(0.1, 100.0)),
        1 => Tree::Dashpot(random.decades(0.1, 100.0)),
        2 => Tree::Springpot(random.decades(0.1, 100.0), order(random)),
        3..=6 => Tree::Parallel(branches(random)),
        _ => Tree::Series(branches(random)),
    }
}

/// Orders anywhere, every tenth of them near a limit.
fn order(random: &mut Random) -> f64 {
    match random.below(20) {
        0 => random.within(0.01, 0.05),
        1 => random.within(0.95, 0.999),
        _ => random.within(0.05, 0.95),
    }
}

/// Elastic at once: nothing but functions of strokes, each with a spring beside it, so that every force has its stroke.
pub(crate) fn elastic(random: &mut Random, depth: usize) -> Tree {
    let spring = Tree::Spring(random.decades(0.5, 20.0));
    let branches = |random: &mut Random| {
        let count = 2 + random.below(2);
        (0..count).map(|_| elastic(random, depth - 1)).collect::<Vec<_>>()
    };
    match random.below(if depth == 0 { 5 } else { 8 }) {
        0 => spring,
        1 => {
            let (low, high) = (-random.within(0.02, 0.3), random.within(0.02, 0.3));
            Tree::Parallel(vec![spring, Tree::Stop(random.decades(1.0, 100.0), low, high)])
        }
        2 => Tree::Parallel(vec![spring, Tree::Tension(random.decades(1.0, 100.0))]),
        3 => Tree::Parallel(vec![spring, Tree::Compression(random.decades(1.0, 100.0))]),
        4 => Tree::Hardening(random.decades(0.5, 20.0), random.decades(1.0, 100.0)),
        5 => Tree::Parallel(branches(random)),
        _ => Tree::Series(branches(random)),
    }
}

/// A stroke that begins at 0, per unit of its size.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Shape {
    /// sin ωt.
    Sine(f64),
    /// 1 − cos ωt.
    Cosine(f64),
    /// t.
    Ramp,
    /// t².
    Parabola,
}

/// x = start + Σ size·shape(t − from).
#[derive(Debug, Clone)]
pub(crate) struct Motion {
    pub(crate) start: f64,
    pub(crate) shapes: Vec<(f64, Shape, f64)>,
}

impl Motion {
    /// One or two shapes over a run of this length.
    pub(crate) fn random(random: &mut Random, start: f64, end: f64) -> Self {
        let one = |random: &mut Random| {
            let from = if random.below(3) == 0 { end * random.within(0.1, 0.6) } else { 0.0 };
            let size = random.within(-0.3, 0.3);
            let shape = match random.below(4) {
                0 => Shape::Sine(random.within(0.5, 5.0) / end),
                1 => Shape::Cosine(random.within(0.5, 5.0) / end),
                2 => return (size / end, Shape::Ramp, from),
                _ => return (size / (end * end), Shape::Parabola, from),
            };
            (size, shape, from)
        };
        let count = 1 + random.below(2);
        Self { start, shapes: (0..count).map(|_| one(random)).collect() }
    }

    /// The same as users write it.
    pub(crate) fn text(&self) -> String {
        let mut text = format!("{:e}", self.start);
        for (size, shape, from) in &self.shapes {
            let t = if *from == 0.0 { "t".to_owned() } else { format!("max(0, t - {from:e})") };
            let own = match shape {
                Shape::Sine(w) => format!("sin({w:e}*{t})"),
                Shape::Cosine(w) => format!("(1 - cos({w:e}*{t}))"),
                Shape::Ramp => t,
                Shape::Parabola => format!("({t})^2"),
            };
            text += &format!(" + ({size:e})*{own}");
        }
        text
    }

    pub(crate) fn stroke(&self, t: f64) -> f64 {
        let own = |(size, shape, from): &(f64, Shape, f64)| {
            let t = (t - from).max(0.0);
            size * match shape {
                Shape::Sine(w) => (w * t).sin(),
                Shape::Cosine(w) => 1.0 - (w * t).cos(),
                Shape::Ramp => t,
                Shape::Parabola => t * t,
            }
        };
        self.start + self.shapes.iter().map(own).sum::<f64>()
    }
}

/// What happened before t = 0.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Past {
    /// Held at x(0) since ever.
    Since,
    /// Unloaded, and stretched to x(0) at t = 0.
    Unloaded,
    /// Stretched to x(0) so long before, and held.
    Held(f64),
    /// The same sine since ever about x(0).
    Steady { period: f64, size: f64 },
}

impl Past {
    pub(crate) fn random(random: &mut Random, kind: u64, end: f64) -> Self {
        match kind {
            0 => Self::Since,
            1 => Self::Unloaded,
            2 => Self::Held(end * random.decades(0.01, 10.0)),
            _ => Self::Steady { period: end * random.within(0.2, 1.0), size: random.within(0.05, 0.3) },
        }
    }

    pub(crate) fn derivative(self) -> Derivative {
        match self {
            Self::Since | Self::Steady { .. } => Derivative::Caputo,
            Self::Unloaded | Self::Held(_) => Derivative::RiemannLiouville,
        }
    }
}

/// An entry of a catalog for one network.
pub(crate) fn entry(law: Network) -> Arc<springpot::law::Entry> {
    Arc::new(springpot::law::Entry {
        name: "random".into(),
        equation: "F".into(),
        params: Vec::new(),
        inputs: Vec::new(),
        source: "test".into(),
        build: Arc::new(move |_, _| Ok(law.clone())),
    })
}
