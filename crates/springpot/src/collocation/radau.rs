//! Constants of Radau IIA with three stages (Hairer & Wanner, Solving ODEs II, IV.5 and IV.8).

/// V_i = v_0 + h Σ_j A_ij a_j.
pub(crate) const A: [[f64; 3]; 3] = [
    [0.196_815_477_223_660_43, -0.065_535_425_850_198_39, 0.023_770_974_348_220_15],
    [0.394_424_314_739_087_3, 0.292_073_411_665_228_46, -0.041_548_752_125_997_93],
    [0.376_403_062_700_467_3, 0.512_485_826_188_421_6, 1.0 / 9.0],
];

/// A and its inverse with room for the most nodes.
pub(crate) const PADDED: [[f64; 4]; 4] = padded(&A);
pub(crate) const PADDED_INVERSE: [[f64; 4]; 4] = padded(&super::RADAU_INVERSE);

const fn padded(matrix: &[[f64; 3]; 3]) -> [[f64; 4]; 4] {
    let [[a, b, c], [d, e, f], [g, h, i]] = *matrix;
    [[a, b, c, 0.0], [d, e, f, 0.0], [g, h, i, 0.0], [0.0; 4]]
}

/// A²: Q_i = q_0 + h c_i v_0 + h² Σ_j (A²)_ij a_j.
pub(crate) const A_SQUARED: [[f64; 3]; 3] = [
    [0.021_835_034_190_722_74, -0.019_857_254_098_612_275, 0.010_042_630_196_562_41],
    [0.177_190_587_431_945_6, 0.038_164_965_809_277_26, -0.007_375_963_529_895_744],
    [0.318_041_381_743_977_2, 0.181_958_618_256_022_83, 0.0],
];

/// γ_0 = 1/(real eigenvalue of A⁻¹).
pub(crate) const GAMMA: f64 = 0.274_888_829_595_676_8;

/// eᵀA of the embedded estimate: err = h (γ_0 f_0 + Σ_i (eᵀA)_i f_i) + …
pub(crate) const ESTIMATE: [f64; 3] = [-0.428_298_294_115_368_1, 0.245_039_074_384_916_53, -0.091_629_609_865_225_8];

/// Left and right eigenvectors of A for its real eigenvalue γ_0, with l·r = 1.
pub(crate) const LEFT: [f64; 3] = [4.325_579_890_063_155, 0.339_199_251_815_809_87, 0.541_770_539_935_874_9];
pub(crate) const RIGHT: [f64; 3] = [0.091_232_394_870_892_94, 0.241_717_932_707_107, 0.966_048_182_615_093];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collocation::{RADAU_NODES, RADAU_WEIGHTS};

    #[test]
    fn the_constants_belong_together() {
        for i in 0..3 {
            for p in 0..3 {
                let sum: f64 = (0..3).map(|j| A[i][j] * RADAU_NODES[j].powi(p)).sum();
                assert!((sum - RADAU_NODES[i].powi(p + 1) / f64::from(p + 1)).abs() < 1e-15);
            }
            for j in 0..3 {
                let square: f64 = (0..3).map(|k| A[i][k] * A[k][j]).sum();
                assert!((A_SQUARED[i][j] - square).abs() < 1e-15);
            }
            assert!((A[2][i] - RADAU_WEIGHTS[i]).abs() < 1e-15);
            let right: f64 = (0..3).map(|j| A[i][j] * RIGHT[j]).sum();
            let left: f64 = (0..3).map(|j| LEFT[j] * A[j][i]).sum();
            assert!((right - GAMMA * RIGHT[i]).abs() < 1e-15 && (left - GAMMA * LEFT[i]).abs() < 4e-15);
        }
        assert!(((0..3).map(|i| LEFT[i] * RIGHT[i]).sum::<f64>() - 1.0).abs() < 1e-15);
        // The estimate vanishes where a quadratic through the stages meets the value at the start: constants and lines.
        let constant = GAMMA + ESTIMATE.iter().sum::<f64>();
        let line: f64 = ESTIMATE.iter().zip(RADAU_NODES).map(|(e, c)| e * c).sum();
        assert!(constant.abs() < 1e-15 && line.abs() < 1e-15, "{constant} {line}");
    }
}
