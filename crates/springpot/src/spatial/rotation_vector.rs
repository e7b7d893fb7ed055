//! Rotation vectors: axis times angle, and how they change with the turn.
//!
//! For R = exp([φ]×) with Ṙ = [ω]× R (ω in the axes that R leads to) φ̇ = J_l⁻¹(φ) ω,
//! J_l⁻¹ = I − ½[φ]× + c(θ)[φ]×², θ = |φ|, c = (1 − (θ/2) cot(θ/2))/θ². It is singular at θ = 2π alone, but φ itself jumps at
//! θ = π. Source: Chirikjian, Stochastic Models, Information Theory, and Lie Groups, vol. 2, 2011, §10.1.

use super::rotation::Rotation;
use super::vector::Vec3;

/// Below this square of the angle the series are exact to rounding.
const SMALL: f64 = 0.04;

impl Rotation<f64> {
    /// The turn of at most π that this rotation is, as axis times angle, rad.
    pub fn rotation_vector(&self) -> Vec3 {
        let r = &self.0;
        let twice_sine = Vec3([r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]]);
        let trace = r[0][0] + r[1][1] + r[2][2];
        if trace > 0.0 {
            // sin θ over an angle up to 2π/3.
            let sine = 0.5 * twice_sine.norm();
            let angle = sine.atan2(0.5 * (trace - 1.0));
            let factor = if sine > 1e-7 { 0.5 * angle / sine } else { 0.5 };
            return twice_sine * factor;
        }
        // The longest column of the quaternion's square, which keeps its digits up to half a turn.
        let k = (0..3).max_by(|&a, &b| r[a][a].total_cmp(&r[b][b])).expect("three axes");
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let mut axis = Vec3::ZERO;
        axis.0[k] = 1.0 + r[k][k] - r[i][i] - r[j][j];
        axis.0[i] = r[i][k] + r[k][i];
        axis.0[j] = r[j][k] + r[k][j];
        // (axis, cosine) is 4 u_k times the quaternion (u, w).
        let (sine, cosine) = (axis.norm(), twice_sine.0[k]);
        let sign = if cosine < 0.0 { -1.0 } else { 1.0 };
        axis * (sign * 2.0 * sine.atan2(cosine.abs()) / sine)
    }
}

/// c(θ) and c'(θ)/θ.
fn factors(turn: Vec3) -> [f64; 2] {
    let square = turn.dot(turn);
    if square < SMALL {
        // Bernoulli numbers: c = Σ_k |B_2k| θ^(2k − 2)/(2k)!.
        const C: [f64; 6] = [
            1.0 / 12.0,
            1.0 / 720.0,
            1.0 / 30_240.0,
            1.0 / 1_209_600.0,
            1.0 / 47_900_160.0,
            691.0 / 1_307_674_368_000.0,
        ];
        let (mut c, mut slope) = (0.0, 0.0);
        for (k, &term) in C.iter().enumerate().rev() {
            c = c * square + term;
            if k > 0 {
                slope = slope * square + 2.0 * k as f64 * term;
            }
        }
        return [c, slope];
    }
    let theta = square.sqrt();
    let (sine, cosine) = (0.5 * theta).sin_cos();
    let cotangent = cosine / sine;
    let c = (1.0 - 0.5 * theta * cotangent) / square;
    let slope = -2.0 / square + 0.5 * cotangent / theta + 0.25 / (sine * sine);
    [c, slope / square]
}

/// J_l⁻¹(φ) ω.
pub(crate) fn left_inverse(turn: Vec3, omega: Vec3) -> Vec3 {
    let [c, _] = factors(turn);
    let once = turn.cross(omega);
    omega - once * 0.5 + turn.cross(once) * c
}

/// J_l⁻ᵀ(φ) f.
pub(crate) fn left_inverse_transposed(turn: Vec3, force: Vec3) -> Vec3 {
    let [c, _] = factors(turn);
    let once = turn.cross(force);
    force + once * 0.5 + turn.cross(once) * c
}

/// The derivative of J_l⁻¹(φ) ω along `by` at fixed ω.
pub(crate) fn left_inverse_slope(turn: Vec3, by: Vec3, omega: Vec3) -> Vec3 {
    let [c, slope] = factors(turn);
    let once = turn.cross(omega);
    let across = by.cross(omega);
    (turn.cross(across) + by.cross(once)) * c - across * 0.5 + turn.cross(once) * (slope * turn.dot(by))
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXIS: Vec3 = Vec3([0.36, -0.48, 0.8]);
    const PI: f64 = std::f64::consts::PI;

    #[test]
    fn inverts_axis_and_angle() {
        for axis in [AXIS, Vec3([0.0, 0.0, -1.0]), Vec3([-0.8, 0.0, 0.6])] {
            for angle in [0.0, 1e-12, 1e-9, 1e-4, 0.3, 2.0, 2.2, 3.0, PI - 1e-3, PI - 1e-6] {
                let vector = Rotation::from_axis_angle(axis, angle).rotation_vector();
                assert!((vector - axis * angle).norm() <= 2e-15 * (1.0 + angle), "{angle}: {vector:?}");
            }
            let half = Rotation::from_axis_angle(axis, PI).rotation_vector();
            assert!((half.norm() - PI).abs() < 1e-12 && (half.dot(axis).abs() - PI).abs() < 1e-12);
        }
    }

    /// Both sides of the switch between series and closed form, and differences elsewhere.
    #[test]
    fn derivatives_are_those_of_the_vector() {
        let (by, omega) = (Vec3([0.3, 0.9, -0.2]), Vec3([-0.5, 0.4, 0.7]));
        let (below, above) = (SMALL.sqrt() * (1.0 - 1e-12), SMALL.sqrt() * (1.0 + 1e-12));
        let [a, b] = [below, above].map(|angle| factors(AXIS * angle));
        assert!((a[0] - b[0]).abs() < 1e-14 && (a[1] - b[1]).abs() < 1e-11, "{a:?} {b:?}");
        for angle in [0.0, 1e-3, 0.19, 0.21, 1.0, 2.5, PI - 1e-3] {
            let turn = AXIS * angle;
            let central = |f: &dyn Fn(f64) -> Vec3| {
                let h = 1e-3;
                ((f(h) - f(-h)) * 8.0 - (f(2.0 * h) - f(-2.0 * h))) * (1.0 / (12.0 * h))
            };
            // Away from the jump at half a turn.
            if angle < 3.0 {
                let size = omega.norm();
                let moved = |h: f64| {
                    let step = Rotation::from_axis_angle(omega * (1.0 / size), h * size);
                    (step * Rotation::from_axis_angle(AXIS, angle)).rotation_vector()
                };
                let off = central(&moved) - left_inverse(turn, omega);
                assert!(off.norm() < 1e-10, "{angle}: {off:?}");
            }
            let slope = central(&|h| left_inverse(turn + by * h, omega));
            let off = slope - left_inverse_slope(turn, by, omega);
            assert!(off.norm() < 1e-9, "{angle}: {off:?}");
            let twice = by.dot(left_inverse(turn, omega)) - omega.dot(left_inverse_transposed(turn, by));
            assert!(twice.abs() < 1e-14);
        }
    }
}
