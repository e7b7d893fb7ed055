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

/// T of A T = T Λ, Λ = γ_0 and the block [[Re, Im], [−Im, Re]] of [`PAIR`]: the eigenvector [`RIGHT`], real and imaginary part of one of the pair.
pub(crate) const APART: [[f64; 3]; 3] = [
    [RIGHT[0], -0.141_255_295_020_954_2, -0.030_029_194_105_147_424],
    [RIGHT[1], 0.204_129_352_293_799_93, 0.382_942_112_757_261_9],
    [RIGHT[2], 1.0, 0.0],
];

/// T⁻¹, whose first row is [`LEFT`].
pub(crate) const TOGETHER: [[f64; 3]; 3] = [
    LEFT,
    [-4.178_718_591_551_905, -0.327_682_820_761_062_4, 0.476_623_554_500_550_45],
    [-0.502_872_634_945_786_9, 2.571_926_949_855_605, -0.596_039_204_828_224_9],
];

/// The pair of complex eigenvalues of A: real part, and imaginary part without its sign.
pub(crate) const PAIR: [f64; 2] = [0.162_555_585_202_161_32, 0.184_949_324_407_140_8];

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
        let product = |x: &[[f64; 3]; 3], y: &[[f64; 3]; 3], i: usize, j: usize| -> f64 {
            (0..3).map(|k| x[i][k] * y[k][j]).sum()
        };
        let [re, im] = PAIR;
        let blocks = [[GAMMA, 0.0, 0.0], [0.0, re, im], [0.0, -im, re]];
        for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
            let unit = f64::from(u8::from(i == j));
            assert!((product(&TOGETHER, &APART, i, j) - unit).abs() < 2e-15);
            assert!((product(&A, &APART, i, j) - product(&APART, &blocks, i, j)).abs() < 1e-15);
        }
        // The estimate vanishes where a quadratic through the stages meets the value at the start: constants and lines.
        let constant = GAMMA + ESTIMATE.iter().sum::<f64>();
        let line: f64 = ESTIMATE.iter().zip(RADAU_NODES).map(|(e, c)| e * c).sum();
        assert!(constant.abs() < 1e-15 && line.abs() < 1e-15, "{constant} {line}");
    }
}
