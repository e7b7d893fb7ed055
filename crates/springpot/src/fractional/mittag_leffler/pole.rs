//! The poles w = z^{1/a} on the principal sheet and what they add to the sum on the parabola.

use super::contour::Parabola;
use super::{Complex64, MAX_A, MAX_DERIVATIVE};
use std::f64::consts::PI;

/// Most poles: |arg z + 2πk| < πa for one k more than a, at most, and for as many again beyond the cut.
const MOST: usize = 2 * (MAX_A as usize + 1);

/// Largest x with finite e^x, rounded down.
const LARGEST_EXPONENT: f64 = 709.78;

/// e^x is 0 below.
const SMALLEST_EXPONENT: f64 = -750.0;

/// Above, no factor of a derivative keeps e^x finite.
const SURE_OVERFLOW: f64 = 1e5;

/// What a term is that exceeds the range of f64.
const INFINITE: Complex64 = Complex64::new(f64::INFINITY, f64::INFINITY);

/// Coefficients of a power series in ε/z.
type Series = [Complex64; MAX_DERIVATIVE + 1];

/// w with w^a = z and |arg w| < π; of conjugate pairs at real z the upper one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pole {
    a: f64,
    z: Complex64,
    /// |w|, ln |w| and arg w.
    modulus: f64,
    logarithm: f64,
    argument: f64,
    value: Complex64,
}

/// All poles of one z.
#[derive(Debug, Clone, Copy)]
pub(super) struct Poles {
    poles: [Option<Pole>; MOST],
    count: usize,
}

impl Poles {
    const NONE: Self = Self { poles: [None; MOST], count: 0 };

    fn push(&mut self, pole: Pole) {
        self.poles[self.count] = Some(pole);
        self.count += 1;
    }

    /// Those with |arg w| < π·`sheet`, 1 or 3/2, for real z.
    pub(super) fn of_real(a: f64, x: f64, sheet: f64) -> Self {
        // arg w = πj/a with even j for x > 0, odd j for x < 0.
        let first = if x > 0.0 { 0 } else { 1 };
        let mut poles = Self::NONE;
        if x == 0.0 || f64::from(first) >= sheet * a {
            return poles;
        }
        let (modulus, logarithm) = root(a, x.abs(), 0.0);
        for j in (first..).step_by(2).map(f64::from).take_while(|j| *j < sheet * a) {
            // cos(πj/a) from its zero at 2j = a, near which the digits matter.
            let cosine = if j == 0.0 { 1.0 } else { (PI * (a - 2.0 * j) / (2.0 * a)).sin() };
            let argument = PI * j / a;
            let value = Complex64::new(modulus * cosine, if j == 0.0 { 0.0 } else { modulus * argument.sin() });
            poles.push(Pole { a, z: Complex64::new(x, 0.0), modulus, logarithm, argument, value });
        }
        poles
    }

    /// The same for other z.
    pub(super) fn of_complex(a: f64, z: Complex64, sheet: f64) -> Self {
        let (theta, radius) = (z.arg(), z.norm());
        let (modulus, logarithm) = root(a, radius, lost_in_norm(z, radius));
        let turns = (0.5 * (sheet * a + 1.0)).ceil() as i32;
        let mut poles = Self::NONE;
        for argument in (-turns..=turns).map(|k| (theta + 2.0 * PI * f64::from(k)) / a) {
            if argument.abs() < PI * sheet && poles.count < MOST {
                let value = Complex64::new(modulus * argument.cos(), modulus * argument.sin());
                poles.push(Pole { a, z, modulus, logarithm, argument, value });
            }
        }
        poles
    }

    pub(super) fn of(a: f64, z: Complex64, sheet: f64) -> Self {
        if z.im == 0.0 { Self::of_real(a, z.re, sheet) } else { Self::of_complex(a, z, sheet) }
    }

    /// With the lower ones of conjugate pairs.
    pub(super) fn all(&self) -> impl Iterator<Item = Pole> {
        let twin = |pole: &Pole| (pole.z.im == 0.0 && !pole.is_real()).then(|| pole.conj());
        self.iter().flat_map(move |pole| [Some(*pole), twin(pole)]).flatten()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Pole> {
        self.poles[..self.count].iter().flatten()
    }
}

impl Pole {
    /// Whether w > 0; z is then real.
    pub(super) fn is_real(&self) -> bool {
        self.argument == 0.0
    }

    /// Re √(w/μ): above 1 outside the parabola, below 1 inside, 0 on the cut.
    pub(super) fn depth(&self, mu: f64) -> f64 {
        (self.modulus / mu).sqrt() * (0.5 * self.argument).cos()
    }

    /// arg w as seen from the nearer side of the cut: negative in front of the upper side, positive of the lower one.
    pub(super) fn beyond_cut(&self) -> f64 {
        if self.argument < 0.0 { self.argument + PI } else { self.argument - PI }
    }

    /// The pole of the conjugate z.
    pub(super) fn conj(&self) -> Self {
        Self { z: self.z.conj(), argument: -self.argument, value: self.value.conj(), ..*self }
    }

    /// The [`term`](Self::term) on a parabola.
    pub(super) fn on_parabola(&self, b: f64, n: usize, parabola: &Parabola) -> (Complex64, f64) {
        if self.depth(parabola.mu) <= parabola.deepest {
            return (Complex64::ZERO, 0.0);
        }
        self.term(b, n, &self.switch_on(parabola))
    }

    /// On a parabola: −(2π/h)(√(w/μ) − 1).
    fn switch_on(&self, parabola: &Parabola) -> Switch {
        let root = (self.modulus / parabola.mu).sqrt() * Complex64::cis(0.5 * self.argument);
        let slope = -parabola.frequency * root;
        Switch { value: slope + parabola.frequency, slope, power: 0.5 / self.a, order: self.a }
    }

    /// On a ray beside the cut, its `turn` and step: ∓(2πi/h)(ln w ∓ πi − δi) + πi.
    pub(super) fn switch_at_cut(&self, turn: f64, step: f64) -> Switch {
        let frequency = if self.argument < 0.0 { 2.0 * PI / step } else { -2.0 * PI / step };
        let from_ray = Complex64::new(self.logarithm, self.beyond_cut() - turn);
        let value = Complex64::I * (frequency * from_ray + PI);
        Switch { value, slope: Complex64::I * frequency, power: 0.0, order: self.a }
    }

    /// dⁿ/dzⁿ of w^{1−b} e^w/a / (1 + e^switch), and the largest that went into it.
    pub(super) fn term(&self, b: f64, n: usize, switch: &Switch) -> (Complex64, f64) {
        let ln_w = Complex64::new(self.logarithm, self.argument);
        let exponent = self.value + (1.0 - b) * ln_w - self.a.ln();
        // A derivative multiplies by less than e^20 |w| each time.
        if exponent.re + n as f64 * (20.0 + self.logarithm.max(0.0)) < SMALLEST_EXPONENT {
            return (Complex64::ZERO, 0.0);
        }
        if exponent.re > SURE_OVERFLOW {
            return (INFINITE, f64::INFINITY);
        }
        let (factor, largest) = match n {
            0 => ((1.0 + switch.value.exp()).inv(), 1.0),
            n => self.derivative(b, n, switch),
        };
        let size = exponent.re + factor.norm().ln();
        if size >= LARGEST_EXPONENT || size.is_nan() {
            return (if exponent.re.is_nan() { exponent } else { INFINITE }, f64::INFINITY);
        }
        // Two halves, since one alone may overflow where the product does not.
        let half = Complex64::new(0.5 * exponent.re, exponent.im).exp();
        let rest = (0.5 * exponent.re).exp();
        (half * factor * rest, half.norm() * largest * rest)
    }

    /// dⁿ/dzⁿ of the term, over e^exponent, by power series in ε/z.
    fn derivative(&self, b: f64, n: usize, switch: &Switch) -> (Complex64, f64) {
        let (mut inner, mut sign) = ([Complex64::ZERO; MAX_DERIVATIVE + 1], 1.0);
        let mut of_root = 1.0;
        for k in 1..=n {
            let order = k as f64;
            // Binomial coefficients of (1 + ε/z)^{1/a}.
            of_root *= (1.0 / self.a - order + 1.0) / order;
            inner[k] = self.value * of_root + (1.0 - b) / self.a * sign / order;
            sign = -sign;
        }
        let growth = exponential(&inner, n);
        let mut logistic = exponential(&switch.series(n), n).map(|c| c * switch.value.exp());
        logistic[0] += 1.0;
        let logistic = reciprocal(&logistic, n);
        let products = (0..=n).map(|k| growth[k] * logistic[n - k]);
        let (sum, size) = products.fold((Complex64::ZERO, 0.0), |(sum, size), term| (sum + term, size + term.norm()));
        let factorial: f64 = (1..=n).map(|k| k as f64).product();
        let scale = factorial * self.z.inv().powu(n as u32);
        (sum * scale, size * scale.norm())
    }
}

/// What takes a pole in or out of the sum: its term is divided by 1 + e^value.
#[derive(Debug, Clone, Copy)]
pub(super) struct Switch {
    value: Complex64,
    /// The value grows by slope·((1 + ε/z)^power − 1) as z grows by ε, by slope·ln(1 + ε/z)/a where the power is 0.
    slope: Complex64,
    power: f64,
    order: f64,
}

impl Switch {
    /// Coefficients of (ε/z)^k in the value, k = 1 … n.
    fn series(&self, n: usize) -> Series {
        let mut series = [Complex64::ZERO; MAX_DERIVATIVE + 1];
        let mut binomial = if self.power == 0.0 { 1.0 / self.order } else { self.power };
        for k in 1..=n {
            series[k] = self.slope * binomial;
            binomial *= (self.power - k as f64) / (k + 1) as f64;
        }
        series
    }
}

/// The series of e^x, its constant term apart: x_0 counts as 0.
fn exponential(x: &Series, n: usize) -> Series {
    let mut series = [Complex64::ZERO; MAX_DERIVATIVE + 1];
    series[0] = Complex64::ONE;
    for k in 1..=n {
        let sum: Complex64 = (1..=k).map(|j| x[j] * series[k - j] * j as f64).sum();
        series[k] = sum / k as f64;
    }
    series
}

/// The series of 1/x.
fn reciprocal(x: &Series, n: usize) -> Series {
    let mut series = [Complex64::ZERO; MAX_DERIVATIVE + 1];
    series[0] = x[0].inv();
    for k in 1..=n {
        let sum: Complex64 = (1..=k).map(|j| x[j] * series[k - j]).sum();
        series[k] = -series[0] * sum;
    }
    series
}

/// r^{1/a} and its logarithm, for r(1 + lost): the power would multiply the roundings of r and 1/a by up to 1/a.
fn root(a: f64, r: f64, lost: f64) -> (f64, f64) {
    let power = a.recip();
    let logarithm = (r.ln() + lost) / a;
    let correction = power * lost + (-power).mul_add(a, 1.0) / a * r.ln();
    let modulus = if correction.abs() < 1e-3 { r.powf(power) * (1.0 + correction) } else { logarithm.exp() };
    (modulus, logarithm)
}

/// (|z| − r)/r for the rounded modulus r.
fn lost_in_norm(z: Complex64, r: f64) -> f64 {
    if !(1e-100..1e100).contains(&r) {
        return 0.0;
    }
    let (large, small) = if z.re.abs() > z.im.abs() { (z.re, z.im) } else { (z.im, z.re) };
    let square = |x: f64| (x * x, x.mul_add(x, -(x * x)));
    let ((l, l_low), (s, s_low), (r2, r_low)) = (square(large), square(small), square(r));
    (((l - r2) + s) + (l_low + s_low - r_low)) / (2.0 * r2)
}
