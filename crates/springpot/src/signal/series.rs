//! Taylor coefficients of a function of time, as intervals that hold them at every time of a cell.
//!
//! With f^(k)(t)/k! in `at[k]` for every t of the cell, the usual recurrences of Taylor arithmetic (Moore, Kearfott & Cloud,
//! Introduction to Interval Analysis, 2009, ch. 9) go over to intervals. Together with the coefficients at the cell's
//! middle they give bounds that tighten with the square of its width.

use super::interval::Interval;
use super::jet::Smooth;

/// The highest derivative that is bounded.
pub(super) const ORDER: usize = 5;
const COUNT: usize = ORDER + 1;

type Bounds = [Interval; COUNT];

/// f^(k)/k! over a cell, and its value and slope in the middle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Series {
    pub(super) at: Bounds,
    /// f and f' in the middle of the cell.
    middle: [f64; 2],
    /// Half the width of the cell.
    radius: f64,
}

impl Series {
    /// The time itself, from `a` to `b`.
    pub(super) fn time(a: f64, b: f64) -> Self {
        let mut at = [Interval::ZERO; COUNT];
        at[0] = Interval::new(a, b);
        at[1] = Interval::point(1.0);
        let radius = 0.5 * (b - a);
        Self { at, middle: [a + radius, 1.0], radius }
    }

    /// A number, in the cell of `self`.
    pub(super) fn constant(&self, value: f64) -> Self {
        let mut at = [Interval::ZERO; COUNT];
        at[0] = Interval::point(value);
        Self { at, middle: [value, 0.0], radius: self.radius }
    }

    pub(super) fn value(&self) -> Interval {
        self.at[0]
    }

    /// f and f' in the middle of the cell.
    pub(super) fn middle(&self) -> [f64; 2] {
        self.middle
    }

    /// Whether it rises or falls throughout, or stands still.
    pub(super) fn is_monotone(&self) -> bool {
        self.at[1].lo >= 0.0 || self.at[1].hi <= 0.0
    }

    fn is_constant(&self) -> bool {
        self.at[1..].iter().all(|at| at.is_zero())
    }

    /// A result from its bounds and what it is in the middle: f ∈ f(m) + f'·[−r, r], and the same of f'.
    fn sharpened(&self, mut at: Bounds, middle: [f64; 2]) -> Self {
        let around = |middle: f64, slope: Interval, factor: f64| {
            let reach = factor * slope.magnitude() * self.radius;
            Interval::new(middle - reach, middle + reach)
        };
        if middle[1].is_finite() {
            at[1] = at[1].meet(around(middle[1], at[2], 2.0));
        }
        if middle[0].is_finite() {
            at[0] = at[0].meet(around(middle[0], at[1], 1.0));
        }
        Self { at, middle, radius: self.radius }
    }

    pub(super) fn neg(&self) -> Self {
        Self { at: self.at.map(Interval::neg), middle: self.middle.map(|m| -m), radius: self.radius }
    }

    pub(super) fn add(&self, other: &Self) -> Self {
        let at = std::array::from_fn(|k| self.at[k].add(other.at[k]));
        self.sharpened(at, [0, 1].map(|k| self.middle[k] + other.middle[k]))
    }

    pub(super) fn sub(&self, other: &Self) -> Self {
        self.add(&other.neg())
    }

    pub(super) fn scaled(&self, factor: f64, offset: f64) -> Self {
        let mut at = self.at.map(|at| at.scale(factor));
        at[0] = at[0].add(Interval::point(offset));
        Self { at, middle: [factor * self.middle[0] + offset, factor * self.middle[1]], radius: self.radius }
    }

    pub(super) fn mul(&self, other: &Self) -> Self {
        if other.is_constant() && other.at[0].lo == other.at[0].hi {
            return self.scaled(other.at[0].lo, 0.0);
        }
        if self.is_constant() && self.at[0].lo == self.at[0].hi {
            return other.scaled(self.at[0].lo, 0.0);
        }
        let ([u, du], [v, dv]) = (self.middle, other.middle);
        self.sharpened(product(&self.at, &other.at), [u * v, u * dv + du * v])
    }

    pub(super) fn div(&self, other: &Self) -> Self {
        if other.is_constant() && other.at[0].lo == other.at[0].hi && other.at[0].lo != 0.0 {
            return self.scaled(1.0 / other.at[0].lo, 0.0);
        }
        let ([u, du], [v, dv]) = (self.middle, other.middle);
        self.sharpened(quotient(&self.at, &other.at), [u / v, (du - u / v * dv) / v])
    }

    pub(super) fn pow(&self, exponent: &Self) -> Self {
        if !(exponent.is_constant() && exponent.at[0].lo == exponent.at[0].hi) {
            return Smooth::Exp.bound(&exponent.mul(&Smooth::Log.bound(self)));
        }
        let n = exponent.at[0].lo;
        if self.is_constant() && self.at[0].lo == self.at[0].hi {
            return self.constant(self.at[0].lo.powf(n));
        }
        if n.fract() == 0.0 && n.abs() <= 1024.0 {
            let power = self.whole_power(n.abs() as u32);
            return if n < 0.0 { self.constant(1.0).div(&power) } else { power };
        }
        let base = self.at[0];
        let [u, du] = self.middle;
        let value = Interval::new(base.lo.max(0.0), base.hi.max(0.0));
        let mut at = [Interval::WHOLE; COUNT];
        at[0] = if n > 0.0 || base.lo > 0.0 { monotone(value, |x| x.powf(n)) } else { Interval::WHOLE };
        if base.lo > 0.0 {
            // k u p_k' = Σ_{i=1}^k (i n − (k − i)) u_i p_{k−i}.
            for k in 1..COUNT {
                let sum = (1..=k).fold(Interval::ZERO, |sum, i| {
                    sum.add(self.at[i].mul(at[k - i]).scale(i as f64 * n - (k - i) as f64))
                });
                at[k] = sum.scale(1.0 / k as f64).div(base);
            }
        }
        self.sharpened(at, [u.powf(n), n * u.powf(n - 1.0) * du])
    }

    fn whole_power(&self, n: u32) -> Self {
        let [u, du] = self.middle;
        let mut at = if n == 1 { self.at } else { self.constant(1.0).at };
        let (mut square, mut left) = (self.at, n);
        while n > 1 && left > 0 {
            if left & 1 == 1 {
                at = product(&at, &square);
            }
            left >>= 1;
            if left > 0 {
                let value = square[0].square();
                square = product(&square, &square);
                square[0] = value;
            }
        }
        let power = |x: f64| x.powi(n as i32);
        let value = self.at[0];
        at[0] = match n % 2 {
            1 => value.rising(power),
            _ if value.contains_zero() => Interval::new(0.0, power(value.magnitude())),
            _ => monotone(value, power),
        };
        self.sharpened(at, [power(u), f64::from(n) * u.powi(n as i32 - 1) * du])
    }

    /// The angle of the point (x, self), on one side of the cut.
    pub(super) fn atan2(&self, x: &Self) -> Self {
        let y = self;
        let mut turning = [Interval::ZERO; COUNT];
        let (dx, dy) = (slope(&x.at), slope(&y.at));
        let (a, b) = (product(&x.at, &dy), product(&y.at, &dx));
        let (xx, yy) = (product(&x.at, &x.at), product(&y.at, &y.at));
        let mut square: Bounds = std::array::from_fn(|k| xx[k].add(yy[k]));
        square[0] = x.at[0].square().add(y.at[0].square());
        (0..COUNT).for_each(|k| turning[k] = a[k].sub(b[k]));
        let rate = quotient(&turning, &square);
        let mut at = integral(&rate);
        at[0] = Interval::new(-std::f64::consts::PI, std::f64::consts::PI);
        let ([u, du], [v, dv]) = (y.middle, x.middle);
        self.sharpened(at, [u.atan2(v), (v * du - u * dv) / (u * u + v * v)])
    }

    /// One of two functions, when it is not known which: what holds for both.
    pub(super) fn either(&self, other: &Self) -> Self {
        let at = std::array::from_fn(|k| self.at[k].hull(other.at[k]));
        Self { at, middle: [f64::NAN; 2], radius: self.radius }
    }

    /// With bounds of the value from elsewhere.
    pub(super) fn bounded(mut self, lo: f64, hi: f64) -> Self {
        self.at[0] = self.at[0].meet(Interval::new(lo, hi));
        self
    }

    /// On one flank of a triangle wave between `range`: `slope`·self + constant, `value` being the wave.
    pub(super) fn along_fold(&self, slope: f64, range: [f64; 2], value: impl Fn(f64) -> f64) -> Self {
        let mut at = self.at.map(|at| at.scale(slope));
        at[0] = Interval::new(range[0], range[1]);
        self.sharpened(at, [value(self.middle[0]), slope * self.middle[1]])
    }

    /// All that is known is the value.
    pub(super) fn within(&self, lo: f64, hi: f64) -> Self {
        let mut at = [Interval::WHOLE; COUNT];
        at[0] = Interval::new(lo, hi);
        Self { at, middle: [f64::NAN; 2], radius: self.radius }
    }
}

impl Smooth {
    /// f(u) from the bounds of u.
    pub(super) fn bound(self, u: &Series) -> Series {
        use std::f64::consts::FRAC_PI_2;
        if u.is_constant() && u.at[0].lo == u.at[0].hi {
            return u.constant(self.apply(u.at[0].lo));
        }
        let (a, value) = (&u.at, u.at[0]);
        let rate = slope(a);
        let one = u.constant(1.0).at;
        let at: Bounds = match self {
            Self::Sin => waves(a, value.sin(), value.cos(), -1.0).0,
            Self::Cos => waves(a, value.sin(), value.cos(), -1.0).1,
            Self::Sinh => waves(a, value.rising(f64::sinh), value.cosh(), 1.0).0,
            Self::Cosh => waves(a, value.rising(f64::sinh), value.cosh(), 1.0).1,
            Self::Exp => {
                let mut at = [value.rising(f64::exp); COUNT];
                for k in 1..COUNT {
                    at[k] = weighted(k, a, &at).scale(1.0 / k as f64);
                }
                at
            }
            Self::Tan => {
                let cosine = value.cos();
                let start = if cosine.contains_zero() { Interval::WHOLE } else { value.rising(f64::tan) };
                grown(start, a, |t| sum(&one, &product(t, t)))
            }
            Self::Tanh => grown(value.rising(f64::tanh), a, |t| difference(&one, &product(t, t))),
            Self::Atan => {
                let mut square = sum(&one, &product(a, a));
                square[0] = Interval::point(1.0).add(value.square());
                grown_from(value.rising(f64::atan), &quotient(&rate, &square))
            }
            Self::Asin | Self::Acos => {
                let inside = Interval::new(value.lo.max(-1.0), value.hi.min(1.0));
                let mut square = difference(&one, &product(a, a));
                square[0] = Interval::point(1.0).sub(inside.square());
                let arc = quotient(&rate, &root(&square));
                match self {
                    Self::Asin => grown_from(inside.rising(f64::asin), &arc),
                    _ => grown_from(Interval::point(FRAC_PI_2).sub(inside.rising(f64::asin)), &arc.map(Interval::neg)),
                }
            }
            Self::Log => match value.lo > 0.0 {
                true => grown_from(value.rising(f64::ln), &quotient(&rate, a)),
                false => [Interval::WHOLE; COUNT],
            },
            Self::Sqrt => root(a),
        };
        let (x, dx) = (u.middle[0], u.middle[1]);
        let jet = self.apply(super::Jet { value: x, first: dx, second: 0.0 });
        u.sharpened(at, [jet.value, jet.first])
    }
}

/// Of a function that rises or falls throughout.
fn monotone(value: Interval, function: impl Fn(f64) -> f64) -> Interval {
    Interval::point(function(value.lo)).hull(Interval::point(function(value.hi)))
}

fn sum(a: &Bounds, b: &Bounds) -> Bounds {
    std::array::from_fn(|k| a[k].add(b[k]))
}

fn difference(a: &Bounds, b: &Bounds) -> Bounds {
    std::array::from_fn(|k| a[k].sub(b[k]))
}

fn product(a: &Bounds, b: &Bounds) -> Bounds {
    std::array::from_fn(|k| (0..=k).fold(Interval::ZERO, |sum, i| sum.add(a[i].mul(b[k - i]))))
}

/// c_k = (a_k − Σ_{i≥1} b_i c_{k−i})/b_0.
fn quotient(a: &Bounds, b: &Bounds) -> Bounds {
    let mut c = [Interval::ZERO; COUNT];
    for k in 0..COUNT {
        let known = (1..=k).fold(a[k], |rest, i| rest.sub(b[i].mul(c[k - i])));
        c[k] = known.div(b[0]);
    }
    c
}

/// Coefficients of f'; the highest is not known and not asked for.
fn slope(a: &Bounds) -> Bounds {
    std::array::from_fn(|k| if k + 1 < COUNT { a[k + 1].scale((k + 1) as f64) } else { Interval::ZERO })
}

/// Coefficients of ∫f, but the first.
fn integral(rate: &Bounds) -> Bounds {
    std::array::from_fn(|k| if k == 0 { Interval::ZERO } else { rate[k - 1].scale(1.0 / k as f64) })
}

fn grown_from(value: Interval, rate: &Bounds) -> Bounds {
    let mut at = integral(rate);
    at[0] = value;
    at
}

/// Σ_{i=1}^k i a_i f_{k−i}.
fn weighted(k: usize, a: &Bounds, f: &Bounds) -> Interval {
    (1..=k).fold(Interval::ZERO, |sum, i| sum.add(a[i].mul(f[k - i]).scale(i as f64)))
}

/// f with f' = g(f) a', order by order.
fn grown(value: Interval, a: &Bounds, of: impl Fn(&Bounds) -> Bounds) -> Bounds {
    let mut at = [Interval::ZERO; COUNT];
    at[0] = value;
    for k in 1..COUNT {
        at[k] = weighted(k, a, &of(&at)).scale(1.0 / k as f64);
    }
    at
}

/// sine and cosine (sign −1), or their hyperbolic sisters (sign 1).
fn waves(a: &Bounds, sine: Interval, cosine: Interval, sign: f64) -> (Bounds, Bounds) {
    let (mut s, mut c) = ([sine; COUNT], [cosine; COUNT]);
    for k in 1..COUNT {
        let (ds, dc) = (weighted(k, a, &c), weighted(k, a, &s));
        (s[k], c[k]) = (ds.scale(1.0 / k as f64), dc.scale(sign / k as f64));
    }
    (s, c)
}

/// √a; where a may be 0 only the value is known.
fn root(a: &Bounds) -> Bounds {
    let value = Interval::new(a[0].lo.max(0.0), a[0].hi.max(0.0)).rising(f64::sqrt);
    let mut s = [Interval::WHOLE; COUNT];
    s[0] = value;
    if value.lo > 0.0 {
        for k in 1..COUNT {
            let known = (1..k).fold(a[k], |rest, i| rest.sub(s[i].mul(s[k - i])));
            s[k] = known.div(value.scale(2.0));
        }
    }
    s
}
