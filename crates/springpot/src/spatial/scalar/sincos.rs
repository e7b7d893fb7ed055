//! Sine and cosine without branches.

/// Beyond this the reduction by three parts of π/2 is no longer exact enough.
pub(super) const LARGEST: f64 = 1e6;

const TWO_OVER_PI: f64 = std::f64::consts::FRAC_2_PI;
/// π/2 = HIGH + MIDDLE + LOW, where HIGH and MIDDLE have 33 bits: their multiples by up to 2²⁰ are exact.
const HIGH: f64 = f64::from_bits(0x3ff9_21fb_5440_0000);
const MIDDLE: f64 = f64::from_bits(0x3dd0_b461_1a60_0000);
const LOW: f64 = 2.022_266_248_795_950_6e-21;
/// 1.5 · 2⁵²: adding it rounds to an integer, which is then in the lowest bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// (sin x, cos x) for |x| ≤ [`LARGEST`], to 2e-16 absolutely; NaN for NaN.
///
/// x = k π/2 + r with |r| ≤ π/4, then the Taylor series of both, to r¹⁷/17! and r¹⁶/16!; truncation stays below 1e-17.
#[inline(always)]
pub(super) fn sin_cos(x: f64) -> (f64, f64) {
    let shifted = x * TWO_OVER_PI + ROUND;
    let k = shifted - ROUND;
    let quadrant = shifted.to_bits();
    let r = ((x - k * HIGH) - k * MIDDLE) - k * LOW;
    let z = r * r;
    let (z2, z4) = (z * z, z * z * z * z);
    // Estrin's grouping: short chains of dependent operations.
    let s01 = z * (1.0 / 120.0) - 1.0 / 6.0;
    let s23 = z * (1.0 / 362_880.0) - 1.0 / 5_040.0;
    let s45 = z * (1.0 / 6_227_020_800.0) - 1.0 / 39_916_800.0;
    let s67 = z * (1.0 / 355_687_428_096_000.0) - 1.0 / 1_307_674_368_000.0;
    let sin = r + r * z * ((s01 + z2 * s23) + z4 * (s45 + z2 * s67));
    let c01 = z * (-1.0 / 720.0) + 1.0 / 24.0;
    let c23 = z * (-1.0 / 3_628_800.0) + 1.0 / 40_320.0;
    let c45 = z * (-1.0 / 87_178_291_200.0) + 1.0 / 479_001_600.0;
    let c6 = 1.0 / 20_922_789_888_000.0;
    let half = 0.5 * z;
    let one_less = 1.0 - half;
    // What 1 − z/2 loses by rounding goes back in.
    let cos = one_less + (((1.0 - one_less) - half) + z2 * ((c01 + z2 * c23) + z4 * (c45 + z2 * c6)));
    // Odd quadrants exchange the two; quadrants 2, 3 turn the sine, 1, 2 the cosine.
    let swap = (quadrant & 1).wrapping_neg();
    let (sin_bits, cos_bits) = (sin.to_bits(), cos.to_bits());
    let difference = (sin_bits ^ cos_bits) & swap;
    let sin_sign = (quadrant & 2) << 62;
    let cos_sign = (quadrant.wrapping_add(1) & 2) << 62;
    (f64::from_bits((sin_bits ^ difference) ^ sin_sign), f64::from_bits((cos_bits ^ difference) ^ cos_sign))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_standard_library() {
        let mut worst: f64 = 0.0;
        for k in -400_000..=400_000_i32 {
            let t = f64::from(k) / 400_000.0;
            for x in [4.0 * t, 100.0 * t * t * t, LARGEST * t, f64::from(k) * std::f64::consts::FRAC_PI_4] {
                let ((s, c), (sin, cos)) = (sin_cos(x), x.sin_cos());
                worst = worst.max((s - sin).abs()).max((c - cos).abs());
            }
        }
        assert!(worst <= 2.5e-16, "{worst:e}");
    }

    #[test]
    fn small_angles_keep_their_digits() {
        for k in 0..300 {
            let x = 0.7 * 0.1_f64.powi(k);
            let (s, c) = sin_cos(x);
            assert!((s - x.sin()).abs() <= 2.3e-16 * x && (c - x.cos()).abs() <= 1.2e-16, "{x:e}");
        }
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
    }

    #[test]
    fn no_number_no_result() {
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let (s, c) = sin_cos(x);
            assert!(s.is_nan() && c.is_nan());
        }
    }
}
