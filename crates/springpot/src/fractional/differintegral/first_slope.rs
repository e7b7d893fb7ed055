//! x'(0) of a function that polynomials cannot follow at its start, such as t^1.05.

/// Ratio of the times between which mean slopes are compared.
const STRIDE: f64 = 256.0;

/// x' at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FirstSlope {
    pub(super) value: f64,
    /// By how much it may be off; infinite where x' is.
    pub(super) doubt: f64,
}

impl FirstSlope {
    /// The limit of the mean slopes (x(τ) − x(0))/τ = s + C τ^{p−1} as τ → 0, by Aitken's extrapolation from three
    /// times; two such limits differ by what other powers there are.
    ///
    /// `value` is x on [`origin`, `origin` + `span`]; its first chord is `width` long and has this `slope`.
    pub(super) fn of(value: impl Fn(f64) -> f64, [origin, span]: [f64; 2], [width, slope]: [f64; 2]) -> Self {
        let held = value(origin);
        // Mean slopes with their rounding.
        let mut means: Vec<[f64; 2]> = Vec::new();
        let mut tau = width;
        while tau <= span && means.len() < 8 {
            let x = value(origin + tau);
            means.push([(x - held) / tau, 4.0 * f64::EPSILON * x.abs().max(held.abs()) / tau]);
            tau *= STRIDE;
        }
        let own = Self { value: slope, doubt: slope.abs() };
        let mut limits = means.windows(3).filter_map(limit);
        let Some(nearest) = limits.next() else { return own };
        match limits.next() {
            Some(next) => Self { doubt: nearest.doubt.max((nearest.value - next.value).abs()), ..nearest },
            None => nearest,
        }
    }
}

/// From three mean slopes; none where their differences are rounding.
fn limit(means: &[[f64; 2]]) -> Option<FirstSlope> {
    let [[s0, r0], [s1, r1], [s2, _]] = *means else { return None };
    let (first, second) = (s1 - s0, s2 - s1);
    if s0 == s1 && s1 == s2 {
        return Some(FirstSlope { value: s0, doubt: r0 });
    }
    if first.abs() <= 8.0 * (r0 + r1) {
        return None;
    }
    let growth = second / first;
    Some(match growth {
        // C τ^{p−1} with p > 1 fades.
        1.000_001.. => {
            let magnified = (growth + 1.0) / ((growth - 1.0) * (growth - 1.0));
            FirstSlope { value: s0 - first / (growth - 1.0), doubt: (r0 + r1) * (1.0 + magnified) }
        }
        // With p ≤ 1 it grows without bound.
        0.0.. => FirstSlope { value: s0, doubt: f64::INFINITY },
        _ => FirstSlope { value: s0, doubt: first.abs().max(second.abs()) },
    })
}
