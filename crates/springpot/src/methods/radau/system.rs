//! The linear system of a step, three unknowns for each free velocity:
//! J = I⊗M + hA⊗D + h²A²⊗K + Σ on ⊗ (h² G A² by_q + h P A by_v) of all couplings.
//!
//! Where there are more than a few velocities it is taken apart by the eigenvectors of A (J. C. Butcher, BIT 16, 1976, 237): with G = g·I and P = p·I,
//! as memoryless elements have them, D and K take couplings in, and of J remain M + hγ_0 D + h²γ_0² K and the same with a complex eigenvalue, of n
//! unknowns each. The other couplings have rank 3 each and come by the formula of Sherman, Morrison and Woodbury.

use crate::collocation::radau::{A, A_SQUARED, APART, GAMMA, PAIR, TOGETHER};
use crate::collocation::{MAX_NODES, STAGES};
use crate::dynamics::RneaDerivatives;
use crate::equations::{Coupling, Equations, Solve};
use crate::linalg::{Lu, RowLu};

/// The fewest velocities of which a system is taken apart.
const FEWEST: usize = 6;

/// Factors of the system of a step.
#[derive(Debug, Default)]
pub(super) struct StageSystem {
    is_apart: bool,
    whole: Solve,
    apart: Apart,
}

/// Factors of a system that was taken apart.
#[derive(Debug, Default)]
struct Apart {
    count: usize,
    real: RowLu<1>,
    complex: RowLu<2>,
    /// D and K with the couplings that are the same at all stages.
    slopes: [Vec<f64>; 2],
    /// What these answer with to strokes and to rates.
    uniform: Vec<[f64; 2]>,
    others: Vec<Other>,
    /// How many of these count.
    used: usize,
    capacity: Lu,
    /// Room for a right-hand side, apart; for what others feel.
    w: [Vec<f64>; STAGES],
    felt: Vec<f64>,
}

/// A coupling that comes on top.
#[derive(Debug, Default)]
struct Other {
    /// h² G A² and h P A.
    gain: [[[f64; STAGES]; STAGES]; 2],
    /// What it feels of δq and δv, of the free velocities.
    by: [Vec<f64>; 2],
    /// What it acts on, then what that leads to in the real system, and in the complex one.
    led: [Vec<f64>; STAGES],
}

/// M, D and K of all n velocities, and which of these are free.
struct Slopes<'a> {
    n: usize,
    free: &'a [usize],
    all: &'a RneaDerivatives,
}

impl Slopes<'_> {
    /// M, D and K of two of the free.
    fn at(&self, r: usize, c: usize) -> [f64; 3] {
        let at = self.free[r] * self.n + self.free[c];
        [self.all.d_a[at], self.all.d_v[at], self.all.d_q[at]]
    }
}

fn product(x: &[[f64; MAX_NODES]; MAX_NODES], y: &[[f64; STAGES]; STAGES], factor: f64) -> [[f64; STAGES]; STAGES] {
    std::array::from_fn(|i| std::array::from_fn(|j| factor * (0..STAGES).map(|m| x[i][m] * y[m][j]).sum::<f64>()))
}

/// G A² and P A times h² and h.
fn gains(coupling: &Coupling, h: f64) -> [[[f64; STAGES]; STAGES]; 2] {
    let [stroke, rate] = &coupling.gain;
    [product(stroke, &A_SQUARED, h * h), product(rate, &A, h)]
}

impl StageSystem {
    /// Factors the system of a step of size `h`; `false` where it is singular or not finite.
    pub(super) fn factor(&mut self, equations: &Equations, n: usize, h: f64) -> bool {
        let slopes = Slopes { n, free: equations.free(), all: equations.slopes() };
        let couplings = equations.couplings();
        self.is_apart = slopes.free.len() >= FEWEST && {
            let others = couplings.iter().filter(|coupling| !coupling.is_uniform(STAGES)).count();
            is_cheaper(slopes.free.len(), others)
        };
        if self.is_apart {
            self.apart.factor(&slopes, &couplings, h)
        } else {
            self.factor_whole(&slopes, &couplings, h)
        }
    }

    fn factor_whole(&mut self, slopes: &Slopes, couplings: &[Coupling], h: f64) -> bool {
        let count = slopes.free.len();
        let size = STAGES * count;
        self.whole.factor(size, |matrix| {
            for i in 0..STAGES {
                for j in 0..STAGES {
                    let (damping, stiffness) = (h * A[i][j], h * h * A_SQUARED[i][j]);
                    let line = |r: usize| (i * count + r) * size + j * count;
                    for r in 0..count {
                        for (c, entry) in matrix[line(r)..][..count].iter_mut().enumerate() {
                            let [m, d, k] = slopes.at(r, c);
                            *entry = damping * d + stiffness * k;
                            if i == j {
                                *entry += m;
                            }
                        }
                    }
                }
            }
            for coupling in couplings {
                let gains = gains(coupling, h);
                for (i, j) in (0..STAGES * STAGES).map(|k| (k / STAGES, k % STAGES)) {
                    let line = |r: usize| (i * count + r) * size + j * count;
                    coupling.add(gains.map(|gain| gain[i][j]), slopes.free, matrix, line);
                }
            }
        })
    }

    /// Whether M + hγ_0 D + h²γ_0² K, with the couplings as they are now, is a part of what was factored.
    pub(super) fn has_filter(&self, couplings: &[Coupling]) -> bool {
        let same = |(coupling, uniform): (&Coupling, &[f64; 2])| {
            coupling.is_uniform(STAGES) && coupling.gain.each_ref().map(|gain| gain[0][0]) == *uniform
        };
        self.is_apart && self.apart.used == 0 && couplings.iter().zip(&self.apart.uniform).all(same)
    }

    /// Solves that part for `count` right-hand sides, which stand side by side in the rows of `x`.
    pub(super) fn filter(&mut self, x: &mut [f64], count: usize) {
        match count {
            1 => self.apart.real.solve([x]),
            _ => self.apart.real.solve_rows(x, count),
        }
    }

    /// Solves in place: `x` holds the right-hand side before and the solution after, stage by stage.
    pub(super) fn solve(&mut self, x: &mut [f64]) {
        if self.is_apart { self.apart.solve(x) } else { self.whole.solve(x) }
    }
}

/// Whether taking a system of n velocities apart that has `others` other couplings takes fewer multiplications than factoring it whole.
fn is_cheaper(n: usize, others: usize) -> bool {
    let whole = 9 * n.pow(3);
    let apart = 5 * n.pow(3) / 3 + others * 5 * n * n + others.pow(2) * 6 * n + 9 * others.pow(3);
    apart < whole
}

impl Apart {
    fn factor(&mut self, slopes: &Slopes, couplings: &[Coupling], h: f64) -> bool {
        let (free, count) = (slopes.free, slopes.free.len());
        self.count = count;
        self.slopes.iter_mut().for_each(Vec::clear);
        for (r, c) in (0..count * count).map(|k| (k / count, k % count)) {
            let [_, d, k] = slopes.at(r, c);
            self.slopes[0].push(d);
            self.slopes[1].push(k);
        }
        self.used = 0;
        self.uniform.clear();
        let [damping, stiffness] = &mut self.slopes;
        for coupling in couplings {
            if coupling.is_uniform(STAGES) {
                let [stroke, rate] = coupling.gain.each_ref().map(|gain| gain[0][0]);
                self.uniform.push([stroke, rate]);
                let line = |r: usize| r * count;
                if stroke != 0.0 {
                    coupling.add([stroke, 0.0], free, stiffness, line);
                }
                if rate != 0.0 {
                    coupling.add([0.0, rate], free, damping, line);
                }
                continue;
            }
            if self.used == self.others.len() {
                self.others.push(Other::default());
            }
            let Other { gain, by: [by_q, by_v], led: [on, ..] } = &mut self.others[self.used];
            *gain = gains(coupling, h);
            coupling.rows(free, [on, by_q, by_v]);
            self.used += 1;
        }
        let mass = |r: usize, c: usize| slopes.at(r, c)[0];
        let [damping, stiffness] = &self.slopes;
        let (by_d, by_k) = (h * GAMMA, (h * GAMMA).powi(2));
        let real = self.real.factor(count, |r, [row]| {
            for (c, entry) in row.iter_mut().enumerate() {
                *entry = mass(r, c) + by_d * damping[r * count + c] + by_k * stiffness[r * count + c];
            }
        });
        // Components 1 and 2 of what is apart, as real and imaginary part, turn with Re − i Im.
        let [re, im] = PAIR.map(|part| h * part);
        let (square_re, square_im) = (re * re - im * im, -2.0 * re * im);
        let complex = self.complex.factor(count, |r, [real, imaginary]| {
            for (c, (real, imaginary)) in real.iter_mut().zip(imaginary).enumerate() {
                let (d, k) = (damping[r * count + c], stiffness[r * count + c]);
                *real = mass(r, c) + re * d + square_re * k;
                *imaginary = square_im * k - im * d;
            }
        });
        real && complex && self.take_others()
    }

    /// What the other couplings lead to, and the system of the forces that they answer with.
    fn take_others(&mut self) -> bool {
        let Self { real, complex, others, used, capacity, .. } = self;
        let others = &mut others[..*used];
        for Other { led: [first, second, third], .. } in others.iter_mut() {
            second.clone_from(first);
            third.clear();
            third.resize(first.len(), 0.0);
            real.solve([first]);
            complex.solve([second, third]);
        }
        let size = STAGES * others.len();
        capacity.factor(size, |matrix| {
            for (e, on) in others.iter().enumerate() {
                for (f, of) in others.iter().enumerate() {
                    // What f leads to, felt by e: T diag(…) T⁻¹ of each of the two that e feels.
                    let felt = on.by.each_ref().map(|by| {
                        let [real, re, im] = of.led.each_ref().map(|led| by.iter().zip(led).map(|(b, x)| b * x).sum());
                        together(&[[real, 0.0, 0.0], [0.0, re, -im], [0.0, im, re]])
                    });
                    for (i, j) in (0..STAGES * STAGES).map(|k| (k / STAGES, k % STAGES)) {
                        let answer = |d: usize| -> f64 { (0..STAGES).map(|m| on.gain[d][i][m] * felt[d][m][j]).sum() };
                        let unit = f64::from(u8::from(e == f && i == j));
                        matrix[(STAGES * e + i) * size + STAGES * f + j] = unit + answer(0) + answer(1);
                    }
                }
            }
        })
    }

    fn solve(&mut self, x: &mut [f64]) {
        let Self { count, real, complex, others, used, capacity, w, felt, .. } = self;
        let (count, others) = (*count, &others[..*used]);
        for (row, w) in TOGETHER.iter().zip(w.iter_mut()) {
            w.clear();
            w.extend((0..count).map(|k| (0..STAGES).map(|j| row[j] * x[j * count + k]).sum::<f64>()));
        }
        let [first, second, third] = w;
        real.solve([first]);
        complex.solve([second, third]);
        if !others.is_empty() {
            felt.clear();
            for other in others {
                let at_stages = other.by.each_ref().map(|by| {
                    let apart = [&*first, &*second, &*third].map(|w| by.iter().zip(w).map(|(b, x)| b * x).sum::<f64>());
                    APART.map(|row| row.iter().zip(apart).map(|(t, x)| t * x).sum::<f64>())
                });
                felt.extend((0..STAGES).map(|i| -> f64 {
                    let answer = |d: usize| -> f64 { (0..STAGES).map(|m| other.gain[d][i][m] * at_stages[d][m]).sum() };
                    answer(0) + answer(1)
                }));
            }
            capacity.solve(felt);
            for (other, force) in others.iter().zip(felt.chunks_exact(STAGES)) {
                let [real, re, im] = TOGETHER.map(|row| row.iter().zip(force).map(|(t, x)| t * x).sum::<f64>());
                let [led, led_re, led_im] = &other.led;
                for k in 0..count {
                    first[k] -= led[k] * real;
                    second[k] -= led_re[k] * re - led_im[k] * im;
                    third[k] -= led_re[k] * im + led_im[k] * re;
                }
            }
        }
        for (row, x) in APART.iter().zip(x.chunks_exact_mut(count)) {
            for (k, x) in x.iter_mut().enumerate() {
                *x = row[0] * first[k] + row[1] * second[k] + row[2] * third[k];
            }
        }
    }
}

/// T X T⁻¹.
fn together(x: &[[f64; STAGES]; STAGES]) -> [[f64; STAGES]; STAGES] {
    let half: [[f64; STAGES]; STAGES] =
        std::array::from_fn(|i| std::array::from_fn(|j| (0..STAGES).map(|m| APART[i][m] * x[m][j]).sum()));
    std::array::from_fn(|i| std::array::from_fn(|j| (0..STAGES).map(|m| half[i][m] * TOGETHER[m][j]).sum()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn what_is_taken_apart_has_the_same_solution() {
        let mut random = Random::of(5);
        let n = 9;
        let mut draw = |count: usize| -> Vec<f64> { (0..count).map(|_| 2.0 * random.share() - 1.0).collect() };
        let mut all = RneaDerivatives { d_q: draw(n * n), d_v: draw(n * n), d_a: draw(n * n) };
        (0..n).for_each(|k| all.d_a[k * (n + 1)] += 4.0);
        let free = [0, 1, 3, 4, 5, 7, 8];
        let rows: Vec<Vec<f64>> = (0..8).map(|_| draw(n)).collect();
        let mut gain = |entries: &dyn Fn(usize, usize, f64) -> f64| {
            std::array::from_fn(|_| {
                let size = draw(1)[0];
                let mut drawn = draw(MAX_NODES * MAX_NODES).into_iter();
                let mut entry = |i, j| {
                    let drawn = drawn.next().unwrap_or(0.0);
                    if i < STAGES && j < STAGES {
                        entries(i, j, drawn) + f64::from(u8::from(i == j)) * size
                    } else {
                        0.0
                    }
                };
                std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
            })
        };
        let couplings = [
            Coupling::between(&rows[0], [&rows[1]; 2], gain(&|_, _, _| 0.0)),
            Coupling::between(&rows[2], [&rows[3], &rows[4]], gain(&|_, _, _| 0.0)),
            Coupling::between(&rows[5], [&rows[5]; 2], gain(&|_, _, entry| 3.0 * entry)),
            Coupling::between(&rows[2], [&rows[6], &rows[7]], gain(&|i, j, entry| if i == j { entry } else { 0.0 })),
        ];
        assert_eq!(couplings.each_ref().map(|coupling| coupling.is_uniform(STAGES)), [true, true, false, false]);
        let slopes = Slopes { n, free: &free, all: &all };
        let given = draw(STAGES * free.len());
        for h in [1e-3, 0.1, 3.0] {
            let (mut system, mut apart) = (StageSystem::default(), Apart::default());
            assert!(system.factor_whole(&slopes, &couplings, h) && apart.factor(&slopes, &couplings, h));
            let [mut x, mut y] = [given.clone(), given.clone()];
            system.whole.solve(&mut x);
            apart.solve(&mut y);
            let size = x.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-11 * size), "{h}: {x:?} {y:?}");
        }
        assert!(is_cheaper(9, 2) && is_cheaper(20, 8) && !is_cheaper(9, 9));
    }
}
