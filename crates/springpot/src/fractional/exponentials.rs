//! e^{−X} and its moments ψ_p(X) = ∫₀¹ e^{−X(1−θ)} θ^p dθ: what an exponential with the rate λ makes of a step, X = λh.

use super::step::{CUBIC, SEXTIC};
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};

/// Below it e^x is 0 to double precision.
const SMALLEST: f64 = -708.0;

/// ln 2 in two parts, the first with room for a product with a whole number.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];

/// 1.5·2⁵²: what is added to it is rounded to a whole number.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// 1/(k + 1)!, k = 0 … 13.
const INVERSE_FACTORIALS: [f64; 14] = {
    let mut values = [1.0; 14];
    let mut k = 1;
    while k < 14 {
        values[k] = values[k - 1] / (k + 1) as f64;
        k += 1;
    }
    values
};

/// 3!/(k + 4)!, k = 0 … 15.
const SERIES: [f64; 16] = {
    let mut values = [0.25; 16];
    let mut k = 1;
    while k < 16 {
        values[k] = values[k - 1] / (k + 4) as f64;
        k += 1;
    }
    values
};

/// Where moments from above and from below meet that are those of a sextic.
const MEETING: f64 = 3.0;

/// 6!/(k + 7)!, k = 0 … 23.
const SERIES_OF_SIX: [f64; 24] = {
    let mut values = [1.0 / 7.0; 24];
    let mut k = 1;
    while k < 24 {
        values[k] = values[k - 1] / (k + 7) as f64;
        k += 1;
    }
    values
};

/// Σ_k f_k x^k with an even number of factors f_k; even and odd powers do not wait for each other.
#[inline(always)]
fn polynomial<S: Simd>(factors: &[f64], x: f64x8<S>) -> f64x8<S> {
    let square = x * x;
    let [mut even, mut odd] = [f64x8::splat(x.simd, 0.0); 2];
    for [a, b] in factors.as_chunks().0.iter().rev() {
        (even, odd) = (even * square + *a, odd * square + *b);
    }
    even + odd * x
}

/// e^{−x} for x ≥ 0, to an ulp: e^r 2^n with |r| ≤ ln(2)/2.
#[inline(always)]
pub(super) fn decay<S: Simd>(x: f64x8<S>) -> f64x8<S> {
    let negative = (-x).max(SMALLEST);
    let shifted = negative * std::f64::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = (negative - n * LN_2[0]) - n * LN_2[1];
    // The last sum alone rounds: the same factor is taken again and again over equal steps.
    let near_one = polynomial(&INVERSE_FACTORIALS, r) * r + 1.0;
    let value = f64x8::from_bits(near_one.to_bits() + (shifted.to_bits() << 52));
    negative.simd_gt(SMALLEST).select(value, f64x8::splat(x.simd, 0.0))
}

/// ψ_0 … ψ_3 of every x ≥ 0, where `decay` is e^{−x}.
///
/// Upwards by ψ_p = (1 − pψ_{p−1})/x from x = 1 on; below, downwards from the series of ψ_3.
#[inline(always)]
fn cubic_moments<S: Simd>(x: f64x8<S>, decay: f64x8<S>) -> [f64x8<S>; CUBIC] {
    let is_small = x.simd_lt(1.0);
    if is_small.all_false() {
        return moments_upwards(x, decay);
    }
    let mut psi = moments_downwards(x);
    if !is_small.all_true() {
        let up = moments_upwards(x, decay);
        for p in 0..CUBIC {
            psi[p] = is_small.select(psi[p], up[p]);
        }
    }
    psi
}

/// As [`cubic_moments`], ψ_0 … ψ_6: upwards from x = 3 on, below it downwards from the series of ψ_6, so that errors grow by five at most.
#[inline(always)]
fn sextic_moments<S: Simd>(x: f64x8<S>, decay: f64x8<S>) -> [f64x8<S>; SEXTIC] {
    let (one, is_small) = (f64x8::splat(x.simd, 1.0), x.simd_lt(MEETING));
    let mut up = [one; SEXTIC];
    if !is_small.all_true() {
        let inverse = one / x.max(MEETING);
        up[0] = (one - decay) * inverse;
        for p in 1..SEXTIC {
            up[p] = (one - up[p - 1] * p as f64) * inverse;
        }
        if is_small.all_false() {
            return up;
        }
    }
    let x = x.min(MEETING);
    let mut psi = [polynomial(&SERIES_OF_SIX, -x); SEXTIC];
    for p in (1..SEXTIC).rev() {
        psi[p - 1] = (one - x * psi[p]) * (1.0 / p as f64);
    }
    for p in 0..SEXTIC {
        psi[p] = is_small.select(psi[p], up[p]);
    }
    psi
}

/// ψ_0 … ψ_{N−1} of a cubic or a sextic.
#[inline(always)]
pub(super) fn lane_moments<S: Simd, const N: usize>(x: f64x8<S>, decay: f64x8<S>) -> [f64x8<S>; N] {
    let mut psi = [f64x8::splat(x.simd, 0.0); N];
    match N {
        CUBIC => psi.copy_from_slice(&cubic_moments(x, decay)),
        _ => psi.copy_from_slice(&sextic_moments(x, decay)),
    }
    psi
}

#[inline(always)]
fn moments_upwards<S: Simd>(x: f64x8<S>, decay: f64x8<S>) -> [f64x8<S>; CUBIC] {
    let one = f64x8::splat(x.simd, 1.0);
    let inverse = one / x.max(1.0);
    let first = (one - decay) * inverse;
    let second = (one - first) * inverse;
    let third = (one - second * 2.0) * inverse;
    [first, second, third, (one - third * 3.0) * inverse]
}

/// ψ_3 = Σ_k 3!/(k + 4)! (−x)^k: 16 terms reach the last bit at x = 1.
#[inline(always)]
fn moments_downwards<S: Simd>(x: f64x8<S>) -> [f64x8<S>; CUBIC] {
    let one = f64x8::splat(x.simd, 1.0);
    let x = x.min(1.0);
    let last = polynomial(&SERIES, -x);
    let third = (one - x * last) * (1.0 / 3.0);
    let second = (one - x * third) * 0.5;
    [one - x * second, second, third, last]
}

/// ψ_p(x) for x ≥ 0 and p = 0 … psi.len() − 1.
///
/// ψ_p = (1 − pψ_{p−1})/x upwards while p ≤ x, ψ_{p−1} = (1 − xψ_p)/p downwards from the series of the last one while p > x: no
/// step enlarges an error.
pub(super) fn moments(x: f64, psi: &mut [f64]) {
    let Some(last) = psi.len().checked_sub(1) else { return };
    // First p that comes from above.
    let meeting = if x >= last as f64 { last + 1 } else { x as usize + 1 };
    if x >= 1.0 {
        psi[0] = -(-x).exp_m1() / x;
        for p in 1..meeting.min(last + 1) {
            psi[p] = (1.0 - p as f64 * psi[p - 1]) / x;
        }
    }
    if meeting > last && x >= 1.0 {
        return;
    }
    // ψ_P = 1/(P+1) (1 − x/(P+2) (1 − x/(P+3) (…))); the factors left out multiply to less than one ulp.
    let mut series = 0.0;
    for m in (0..16 + 3 * x as usize).rev() {
        series = (1.0 - x * series) / (last + 1 + m) as f64;
    }
    psi[last] = series;
    let lowest = if x >= 1.0 { meeting } else { 0 };
    for p in (lowest..last).rev() {
        psi[p] = (1.0 - x * psi[p + 1]) / (p + 1) as f64;
    }
}

#[cfg(test)]
mod tests {
    use super::super::lanes::{Block, LANES, load};
    use super::*;
    use fearless_simd::{Level, dispatch};

    fn decay_of(level: Level, x: &Block) -> Block {
        dispatch!(level, simd => decay(load(simd, x)).to_array())
    }

    fn moments_of<const N: usize>(level: Level, x: &Block) -> [Block; N] {
        dispatch!(level, simd => {
            let x = load(simd, x);
            let psi: [_; N] = lane_moments(x, decay(x));
            psi.map(|psi| psi.to_array())
        })
    }

    const ARGUMENTS: [f64; 16] =
        [0.0, 1e-9, 0.3, 0.5, 0.999, 1.0, 1.001, 1.5, 2.999, 3.0, 3.001, 6.5, 16.9, 17.1, 60.0, 707.0];

    #[test]
    fn decay_is_the_exponential() {
        for k in 0..20_000 {
            let x: Block =
                std::array::from_fn(|l| 0.0443 * (LANES * k + l) as f64 * if k % 2 == 0 { 1.0 } else { 1e-5 });
            for (x, value) in x.iter().zip(decay_of(Level::new(), &x)) {
                let exact = (-x).exp();
                let allowed = if *x > 708.0 { 4e-308 } else { 2.3e-16 * exact };
                assert!((value - exact).abs() <= allowed, "e^-{x} = {value}, not {exact}");
            }
        }
        assert_eq!(decay_of(Level::new(), &[f64::INFINITY; LANES]), [0.0; LANES]);
        assert_eq!(decay_of(Level::new(), &[0.0; LANES]), [1.0; LANES]);
    }

    #[test]
    fn moments_meet_their_integrals() {
        // The composite Simpson rule of the definition.
        let integral = |x: f64, p: i32| {
            let panels = 4000;
            let at = |k: f64| {
                let theta = k / panels as f64;
                (-x * (1.0 - theta)).exp() * theta.powi(p)
            };
            let sum: f64 = (0..panels).map(|k| at(k as f64) + 4.0 * at(k as f64 + 0.5) + at(k as f64 + 1.0)).sum();
            sum / (6 * panels) as f64
        };
        for count in [1, 4, 7, 18] {
            for x in ARGUMENTS.into_iter().filter(|x| *x < 100.0) {
                let mut psi = vec![0.0; count];
                moments(x, &mut psi);
                for (p, psi) in psi.iter().enumerate() {
                    let expected = integral(x, p as i32);
                    assert!((psi / expected - 1.0).abs() < 1e-9, "psi_{p}({x}) = {psi}, not {expected}");
                }
                for p in 1..count {
                    assert!((p as f64 * psi[p - 1] + x * psi[p] - 1.0).abs() < 1e-14, "psi_{p}({x})");
                }
            }
        }
    }

    #[test]
    fn moments_of_a_block_are_those_of_its_numbers() {
        compare_moments::<CUBIC>();
        compare_moments::<SEXTIC>();
    }

    fn compare_moments<const N: usize>() {
        for shift in 0..ARGUMENTS.len() {
            let x: Block = std::array::from_fn(|l| ARGUMENTS[(l + shift) % ARGUMENTS.len()]);
            let block: [Block; N] = moments_of(Level::new(), &x);
            for l in 0..LANES {
                let mut psi = [0.0; N];
                moments(x[l], &mut psi);
                for p in 0..N {
                    assert!(
                        (block[p][l] / psi[p] - 1.0).abs() < 3e-14,
                        "psi_{p}({}): {} {}",
                        x[l],
                        block[p][l],
                        psi[p]
                    );
                }
            }
        }
    }

    #[test]
    fn registers_of_any_width_find_the_same_bits() {
        for k in 0..20_000 {
            let x: Block = std::array::from_fn(|l| 1e-7 * 1.0007f64.powi((k + 4321 * l as i32) % 33_000));
            assert_eq!(decay_of(Level::baseline(), &x), decay_of(Level::new(), &x), "{x:?}");
            let levels = [Level::baseline(), Level::new()];
            let [narrow, wide] = levels.map(|level| moments_of::<CUBIC>(level, &x));
            assert_eq!(narrow, wide, "{x:?}");
            let [narrow, wide] = levels.map(|level| moments_of::<SEXTIC>(level, &x));
            assert_eq!(narrow, wide, "{x:?}");
        }
    }
}
