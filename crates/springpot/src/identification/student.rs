//! Student's distribution.

/// t with P(T ≤ t) = `share` for `freedom` degrees of freedom, 0 < share < 1.
///
/// Newton's method on the distribution, by the continued fraction of the incomplete beta function (W. H. Press et al., Numerical
/// Recipes, 3rd ed. 2007, 6.4), to rounding. More than 10⁷ degrees of freedom count as 10⁷.
pub fn student_quantile(share: f64, freedom: f64) -> f64 {
    if share.is_nan() || freedom.is_nan() || freedom <= 0.0 || !(0.0..=1.0).contains(&share) {
        return f64::NAN;
    }
    if share == 0.5 {
        return 0.0;
    }
    if share == 0.0 || share == 1.0 {
        return f64::INFINITY.copysign(share - 0.5);
    }
    let freedom = freedom.min(1e7);
    let tail = share.min(1.0 - share);
    // The tail above t falls from 1/2 to 0: bracketed, then halved in ln t and Newton's steps where they stay inside.
    let (mut low, mut high) = (0.0, 1.0);
    while upper_tail(high, freedom) > tail && high < 1e300 {
        (low, high) = (high, 2.0 * high);
    }
    let mut t = 0.5 * (low + high);
    for _ in 0..200 {
        let gap = upper_tail(t, freedom) - tail;
        if gap > 0.0 {
            low = t
        } else {
            high = t
        }
        let newton = t + gap / density(t, freedom);
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - t).abs() <= 1e-15 * t || high - low <= 1e-15 * high {
            break;
        }
        t = next;
    }
    t.copysign(share - 0.5)
}

/// P(T > t), t ≥ 0.
fn upper_tail(t: f64, freedom: f64) -> f64 {
    let square = t * t;
    let x = freedom / (freedom + square);
    let front = (0.5 * freedom * x.ln() + 0.5 * (square / (freedom + square)).ln() - ln_beta(0.5 * freedom)).exp();
    if t == 0.0 {
        return 0.5;
    }
    // I_x(a, ½), by its own fraction where that is the fast one.
    let a = 0.5 * freedom;
    if x < (a + 1.0) / (a + 2.5) {
        0.5 * front * fraction(a, 0.5, x) / a
    } else {
        0.5 - front * fraction(0.5, a, square / (freedom + square))
    }
}

fn density(t: f64, freedom: f64) -> f64 {
    let exponent = -0.5 * (freedom + 1.0) * (t * t / freedom).ln_1p() - 0.5 * freedom.ln() - ln_beta(0.5 * freedom);
    exponent.exp()
}

/// ln B(a, ½).
fn ln_beta(a: f64) -> f64 {
    const LN_ROOT_PI: f64 = 0.572_364_942_924_700_1;
    LN_ROOT_PI - ln_gamma_step(a)
}

/// ln(Γ(a + ½)/Γ(a)), by Stirling's series after steps that raise a.
fn ln_gamma_step(a: f64) -> f64 {
    let (mut a, mut sum) = (a, 0.0);
    while a < 20.0 {
        sum += (a / (a + 0.5)).ln();
        a += 1.0;
    }
    // J. S. Frame, Amer. Math. Monthly 56 (1949): in powers of 1/a.
    let v = 1.0 / a;
    sum + 0.5 * a.ln() + v * (-1.0 / 8.0 + v * v * (1.0 / 192.0 + v * v * (-1.0 / 640.0 + v * v * (17.0 / 14336.0))))
}

/// Lentz's evaluation of the continued fraction of I_x(a, b).
fn fraction(a: f64, b: f64, x: f64) -> f64 {
    const TINY: f64 = 1e-300;
    let kept = |value: f64| if value.abs() < TINY { TINY } else { value };
    let (mut c, mut d) = (1.0, 1.0 / kept(1.0 - (a + b) * x / (a + 1.0)));
    let mut h = d;
    for m in 1..20_000 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / kept(1.0 + even * d);
        c = kept(1.0 + even / c);
        h *= d * c;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / kept(1.0 + odd * d);
        c = kept(1.0 + odd / c);
        let step = d * c;
        h *= step;
        if (step - 1.0).abs() < 1e-16 {
            break;
        }
    }
    h
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn closed_forms_and_tables() {
        for share in [0.6_f64, 0.9, 0.975, 0.999, 1e-6] {
            let cauchy = -1.0 / (PI * share).tan();
            assert!((student_quantile(share, 1.0) / cauchy - 1.0).abs() < 1e-12, "{share}");
            let two = (2.0 * share - 1.0) * (2.0 / (4.0 * share * (1.0 - share))).sqrt();
            assert!((student_quantile(share, 2.0) / two - 1.0).abs() < 1e-12, "{share}");
        }
        // NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.2; the last is the normal one.
        let table = [
            (0.975, 10.0, 2.228),
            (0.95, 5.0, 2.015),
            (0.975, 30.0, 2.042),
            (0.99, 100.0, 2.364),
            (0.975, 1e9, 1.959_964),
        ];
        for (share, freedom, t) in table {
            assert!((student_quantile(share, freedom) - t).abs() < 6e-4, "{share} {freedom}");
            assert_eq!(student_quantile(1.0 - share, freedom).signum(), -1.0);
        }
        assert!((student_quantile(0.975, 1e7) - 1.959_964_2).abs() < 1e-6);
        assert!(student_quantile(0.3, 0.0).is_nan() && student_quantile(0.5, 3.0) == 0.0);
    }
}
