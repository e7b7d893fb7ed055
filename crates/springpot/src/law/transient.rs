//! Relaxation and creep of linear laws, with what a parameter changes of them.
//!
//! Under x = 1 from t = 0 on a law that was at rest answers with G(t) = ℒ⁻¹[K(s)/s], and under F = 1 with J(t) = ℒ⁻¹[1/(s K(s))]. K of springs, dashpots and
//! springpots has its singularities on the negative real axis: the trapezoidal rule on a hyperbola around it converges like 10.1^−N for N pairs of
//! nodes (J. A. C. Weideman, L. N. Trefethen, Math. Comp. 76 (2007) 1341–1356). Derivatives by parameters are taken under the integral.

use super::network::Network;
use super::step::Point;
use num_complex::Complex64;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Pairs of nodes: more would be lost in the rounding of e^{st}.
const PAIRS: usize = 14;

/// s·t and what the value there counts, of every pair.
static CONTOUR: LazyLock<[[Complex64; 2]; PAIRS]> = LazyLock::new(|| {
    let pairs = PAIRS as f64;
    let (step, width, angle) = (1.081_792_140 / pairs, 4.492_075_287 * pairs, 1.172_104_229_f64);
    std::array::from_fn(|k| {
        let theta = Complex64::new(-angle, (k as f64 + 0.5) * step);
        let s = width * (1.0 + theta.sin());
        let tangent = Complex64::I * width * theta.cos();
        [s, s.exp() * tangent * (step / PI)]
    })
});

/// f(t) and its derivative, of which `image` has the Laplace transforms at s.
fn inverse(t: f64, image: impl Fn(Complex64) -> Option<[Complex64; 2]>) -> Option<[f64; 2]> {
    CONTOUR.iter().try_fold([0.0; 2], |[value, slope], [s, weight]| {
        let [own, by] = image(s / t)?;
        Some([value + (own * weight).im / t, slope + (by * weight).im / t])
    })
}

impl Network {
    /// G(t), N/m, of a linear law under the inputs of `at`, t > 0: its force at t under x = 1 from 0 on; and what the parameter that its
    /// numbers carry changes of it where ln of all rates changes by `clock`. `None` where the law is not linear or a leaf does not know.
    pub fn relaxation(&self, at: &Point, t: f64, clock: f64) -> Option<[f64; 2]> {
        let image = |s: Complex64| {
            let [own, by] = self.modulus_slope(at, [s, s * clock])?;
            Some([own / s, by / s])
        };
        self.is_linear().then(|| inverse(t, image))?
    }

    /// J(t), m/N, as [`Self::relaxation`]: its stroke at t under F = 1 from 0 on.
    pub fn creep(&self, at: &Point, t: f64, clock: f64) -> Option<[f64; 2]> {
        let image = |s: Complex64| {
            let [own, by] = self.modulus_slope(at, [s, s * clock])?;
            Some([1.0 / (s * own), -by / (s * own * own)])
        };
        self.is_linear().then(|| inverse(t, image))?
    }
}

#[cfg(test)]
mod tests {
    use crate::dual::Dual;
    use crate::fractional::mittag_leffler::mittag_leffler;
    use crate::law::{Catalog, Derivative, Point};

    const AT: Point = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &[] };

    #[test]
    fn closed_forms_of_a_fractional_zener_element() {
        let catalog = Catalog::standard();
        let zener = catalog.get("fractional-zener").unwrap();
        let [k_e, k_m, c, alpha] = [300.0, 700.0, 50.0, 0.45];
        let law = zener.build(&[k_e, k_m, c, alpha], Derivative::Caputo).unwrap();
        for t in [1e-4_f64, 0.01, 1.0, 300.0] {
            let decay = |rate: f64| mittag_leffler(alpha, 1.0, (-rate * t.powf(alpha)).into()).unwrap().re;
            let relaxed = k_e + k_m * decay(k_m / c);
            let [value, _] = law.relaxation(&AT, t, 0.0).unwrap();
            assert!((value / relaxed - 1.0).abs() < 1e-11, "{t}: {value} {relaxed}");
            let crept = 1.0 / k_e - k_m / (k_e * (k_e + k_m)) * decay(k_e * k_m / (c * (k_e + k_m)));
            let [value, _] = law.creep(&AT, t, 0.0).unwrap();
            assert!((value / crept - 1.0).abs() < 1e-11, "{t}: {value} {crept}");
        }
    }

    /// Every law of springs, dashpots and springpots against fourth-order differences, in modulus, relaxation and creep.
    #[test]
    fn slopes_are_derivatives() {
        let catalog = Catalog::standard();
        let mut count = 0;
        for entry in catalog.entries().iter().filter(|entry| entry.inputs.is_empty() && !entry.has_lists()) {
            let values: Vec<f64> = entry
                .params
                .iter()
                .enumerate()
                .map(|(k, p)| if p.range.high <= 1.0 { 0.4 } else { 3.0 + k as f64 })
                .collect();
            let Ok(law) = entry.build(&values, Derivative::Caputo) else { continue };
            if !law.is_linear() {
                continue;
            }
            for p in 0..values.len() {
                let at = |x: f64, slope: f64| {
                    let own = |k: usize| if k == p { Dual { value: x, slope } } else { values[k].into() };
                    let numbers: Vec<Dual> = (0..values.len()).map(own).collect();
                    (entry.build)(&numbers, Derivative::Caputo).unwrap()
                };
                let s = num_complex::Complex64::new(0.3, 2.0);
                let of = |x: f64, slope: f64| {
                    let law = at(x, slope);
                    let [k, by] = law.modulus_slope(&AT, [s, 0.0.into()]).unwrap();
                    let [g, by_g] = law.relaxation(&AT, 0.7, 0.0).unwrap();
                    let [j, by_j] = law.creep(&AT, 0.7, 0.0).unwrap();
                    ([k.re, k.im, g, j], [by.re, by.im, by_g, by_j])
                };
                let (_, slopes) = of(values[p], 1.0);
                let d = 1e-3;
                for i in 0..4 {
                    let f = |steps: f64| of(values[p] + steps * d, 0.0).0[i];
                    let difference = (8.0 * (f(1.0) - f(-1.0)) - (f(2.0) - f(-2.0))) / (12.0 * d);
                    let error = (slopes[i] - difference).abs();
                    assert!(
                        error < 1e-8 * (1.0 + difference.abs()),
                        "{} {p} {i}: {} {difference}",
                        entry.name,
                        slopes[i]
                    );
                    count += 1;
                }
            }
        }
        assert!(count > 100, "{count}");
    }

    /// A clock that runs faster by a share is a time that is longer by it.
    #[test]
    fn clocks_shift_times() {
        let catalog = Catalog::standard();
        let law = catalog.get("fractional-zener").unwrap().build(&[1.0, 2.0, 3.0, 0.5], Derivative::Caputo).unwrap();
        let (t, d) = (0.8, 1e-3);
        // G of s·a is that at t/a.
        let g = |a: f64| law.relaxation(&AT, t / a, 0.0).unwrap()[0];
        let difference = (8.0 * (g(1.0 + d) - g(1.0 - d)) - (g(1.0 + 2.0 * d) - g(1.0 - 2.0 * d))) / (12.0 * d);
        let [_, slope] = law.relaxation(&AT, t, 1.0).unwrap();
        assert!((slope - difference).abs() < 1e-9, "{slope} {difference}");
    }
}
