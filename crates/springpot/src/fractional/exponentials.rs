//! e^{−X} and its moments ψ_p(X) = ∫₀¹ e^{−X(1−θ)} θ^p dθ: what an exponential with the rate λ makes of a step, X = λh.

/// Modes side by side.
pub(super) const LANES: usize = 8;

/// As many numbers.
pub(super) type Block = [f64; LANES];

/// Number of moments that steps of a time loop ask for: x' is a cubic.
pub(super) const CUBIC: usize = 4;

/// Below it e^x is 0 to double precision.
const SMALLEST: f64 = -708.0;

/// ln 2 in two parts, the first with room for a product with a whole number.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];

/// 1.5·2⁵²: what is added to it is rounded to a whole number.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// 1/k!, k = 0 … 13.
const INVERSE_FACTORIALS: [f64; 14] = {
    let mut values = [1.0; 14];
    let mut k = 1;
    while k < 14 {
        values[k] = values[k - 1] / k as f64;
        k += 1;
    }
    values
};

/// 1/(k + 4), k = 0 … 15.
const INVERSES: [f64; 16] = {
    let mut values = [0.0; 16];
    let mut k = 0;
    while k < 16 {
        values[k] = 1.0 / (k + 4) as f64;
        k += 1;
    }
    values
};

/// e^{−x} for x ≥ 0, to an ulp: e^r 2^n with |r| ≤ ln(2)/2.
pub(super) fn decay(x: &Block) -> Block {
    let mut value = [0.0; LANES];
    for l in 0..LANES {
        let x = (-x[l]).max(SMALLEST);
        let shifted = x * std::f64::consts::LOG2_E + ROUND;
        let n = shifted - ROUND;
        let r = (x - n * LN_2[0]) - n * LN_2[1];
        let mut sum = INVERSE_FACTORIALS[13];
        for k in (0..13).rev() {
            sum = sum * r + INVERSE_FACTORIALS[k];
        }
        value[l] = f64::from_bits(sum.to_bits().wrapping_add(shifted.to_bits() << 52));
    }
    for l in 0..LANES {
        if -x[l] <= SMALLEST {
            value[l] = 0.0;
        }
    }
    value
}

/// ψ_0 … ψ_3 of every x ≥ 0, where `decay` is e^{−x}.
///
/// Upwards by ψ_p = (1 − pψ_{p−1})/x from x = 1 on; below, downwards from the series of ψ_3.
pub(super) fn cubic_moments(x: &Block, decay: &Block) -> [Block; CUBIC] {
    let (small, large) = x.iter().fold((false, false), |(small, large), x| (small || *x < 1.0, large || *x >= 1.0));
    match (small, large) {
        (false, _) => moments_upwards(x, decay),
        (true, false) => moments_downwards(x),
        (true, true) => {
            let (up, down) = (moments_upwards(x, decay), moments_downwards(x));
            std::array::from_fn(|p| std::array::from_fn(|l| if x[l] < 1.0 { down[p][l] } else { up[p][l] }))
        }
    }
}

fn moments_upwards(x: &Block, decay: &Block) -> [Block; CUBIC] {
    let mut psi = [[0.0; LANES]; CUBIC];
    for l in 0..LANES {
        let inverse = 1.0 / x[l].max(1.0);
        psi[0][l] = (1.0 - decay[l]) * inverse;
        psi[1][l] = (1.0 - psi[0][l]) * inverse;
        psi[2][l] = (1.0 - 2.0 * psi[1][l]) * inverse;
        psi[3][l] = (1.0 - 3.0 * psi[2][l]) * inverse;
    }
    psi
}

/// ψ_3 = 1/4 (1 − x/5 (1 − x/6 (…))): 16 factors reach the last bit at x = 1.
fn moments_downwards(x: &Block) -> [Block; CUBIC] {
    let mut psi = [[0.0; LANES]; CUBIC];
    let x: Block = std::array::from_fn(|l| x[l].min(1.0));
    for inverse in INVERSES.iter().rev() {
        for l in 0..LANES {
            psi[3][l] = (1.0 - x[l] * psi[3][l]) * inverse;
        }
    }
    for l in 0..LANES {
        psi[2][l] = (1.0 - x[l] * psi[3][l]) * (1.0 / 3.0);
        psi[1][l] = (1.0 - x[l] * psi[2][l]) * 0.5;
        psi[0][l] = 1.0 - x[l] * psi[1][l];
    }
    psi
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
    use super::*;

    const ARGUMENTS: [f64; 16] =
        [0.0, 1e-9, 0.3, 0.5, 0.999, 1.0, 1.001, 1.5, 2.999, 3.0, 3.001, 6.5, 16.9, 17.1, 60.0, 707.0];

    #[test]
    fn decay_is_the_exponential() {
        for k in 0..20_000 {
            let x: Block =
                std::array::from_fn(|l| 0.0443 * (LANES * k + l) as f64 * if k % 2 == 0 { 1.0 } else { 1e-5 });
            for (x, value) in x.iter().zip(decay(&x)) {
                let exact = (-x).exp();
                let allowed = if *x > 708.0 { 4e-308 } else { 2.3e-16 * exact };
                assert!((value - exact).abs() <= allowed, "e^-{x} = {value}, not {exact}");
            }
        }
        assert_eq!(decay(&[f64::INFINITY; LANES]), [0.0; LANES]);
        assert_eq!(decay(&[0.0; LANES]), [1.0; LANES]);
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
        for shift in 0..ARGUMENTS.len() {
            let x: Block = std::array::from_fn(|l| ARGUMENTS[(l + shift) % ARGUMENTS.len()]);
            let block = cubic_moments(&x, &decay(&x));
            for l in 0..LANES {
                let mut psi = [0.0; CUBIC];
                moments(x[l], &mut psi);
                for p in 0..CUBIC {
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
}
