//! Eigenvalues of real matrices without symmetry: balanced, brought to Hessenberg form, and there by implicit double QR steps
//! (J. G. F. Francis, Comput. J. 4 (1961) 265, 332; B. S. Garbow et al., EISPACK, 1974, `balanc`, `elmhes`, `hqr`).

use num_complex::Complex64;

/// Steps for one eigenvalue after which there is none.
const MOST_STEPS: usize = 300;

/// All eigenvalues of the n × n matrix `a`, row-major; `None` where the steps do not end.
pub(crate) fn eigenvalues(mut a: Vec<f64>, n: usize) -> Option<Vec<Complex64>> {
    if a.iter().any(|entry| !entry.is_finite()) {
        return None;
    }
    balance(&mut a, n);
    reduce(&mut a, n);
    by_steps(&mut a, n)
}

/// Makes rows and columns of like size by powers of two.
fn balance(a: &mut [f64], n: usize) {
    let mut settled = false;
    while !settled {
        settled = true;
        for i in 0..n {
            let others = || (0..n).filter(move |&j| j != i);
            let column: f64 = others().map(|j| a[j * n + i].abs()).sum();
            let row: f64 = others().map(|j| a[i * n + j].abs()).sum();
            if column == 0.0 || row == 0.0 {
                continue;
            }
            let exponent = (0.5 * (row / column).log2()).round().clamp(-1000.0, 1000.0);
            let factor = exponent.exp2();
            if (column * factor + row / factor) < 0.95 * (column + row) && factor != 1.0 {
                settled = false;
                (0..n).for_each(|j| a[i * n + j] /= factor);
                (0..n).for_each(|j| a[j * n + i] *= factor);
            }
        }
    }
}

/// To upper Hessenberg form by eliminations.
fn reduce(a: &mut [f64], n: usize) {
    for m in 1..n.saturating_sub(1) {
        let pivot = (m..n).fold(m, |best, j| if a[j * n + m - 1].abs() > a[best * n + m - 1].abs() { j } else { best });
        if pivot != m {
            (m - 1..n).for_each(|j| a.swap(pivot * n + j, m * n + j));
            (0..n).for_each(|j| a.swap(j * n + pivot, j * n + m));
        }
        let x = a[m * n + m - 1];
        if x == 0.0 {
            continue;
        }
        for i in m + 1..n {
            let y = a[i * n + m - 1] / x;
            if y == 0.0 {
                continue;
            }
            a[i * n + m - 1] = 0.0;
            (m..n).for_each(|j| a[i * n + j] -= y * a[m * n + j]);
            (0..n).for_each(|j| a[j * n + m] += y * a[j * n + i]);
        }
    }
}

/// Eigenvalues of an upper Hessenberg matrix, from its end on.
fn by_steps(a: &mut [f64], n: usize) -> Option<Vec<Complex64>> {
    let mut values = vec![Complex64::ZERO; n];
    let norm: f64 = (0..n).flat_map(|i| (i.saturating_sub(1)..n).map(move |j| i * n + j)).map(|k| a[k].abs()).sum();
    let mut shifted = 0.0;
    let mut end = n;
    let mut steps = 0;
    while end > 0 {
        let last = end - 1;
        let mut low = last;
        while low > 0 {
            let beside = a[(low - 1) * (n + 1)].abs() + a[low * (n + 1)].abs();
            let beside = if beside == 0.0 { norm } else { beside };
            if a[low * n + low - 1].abs() <= f64::EPSILON * beside {
                a[low * n + low - 1] = 0.0;
                break;
            }
            low -= 1;
        }
        let x = a[last * (n + 1)];
        if low == last {
            values[last] = (x + shifted).into();
            (end, steps) = (end - 1, 0);
            continue;
        }
        let y = a[(last - 1) * (n + 1)];
        let w = a[last * n + last - 1] * a[(last - 1) * n + last];
        if low + 1 == last {
            let p = 0.5 * (y - x);
            let q = p * p + w;
            let z = q.abs().sqrt();
            let x = x + shifted;
            if q >= 0.0 {
                let z = p + if p < 0.0 { -z } else { z };
                values[last - 1] = (x + z).into();
                values[last] = if z == 0.0 { (x + z).into() } else { (x - w / z).into() };
            } else {
                values[last - 1] = Complex64::new(x + p, z);
                values[last] = Complex64::new(x + p, -z);
            }
            (end, steps) = (end - 2, 0);
            continue;
        }
        if steps == MOST_STEPS {
            return None;
        }
        let (mut x, mut y, mut w) = (x, y, w);
        if steps % 10 == 9 {
            // Shifts that lead nowhere are left for others.
            shifted += x;
            (0..end).for_each(|i| a[i * (n + 1)] -= x);
            let size = a[last * n + last - 1].abs() + a[(last - 1) * n + last - 2].abs();
            (x, y, w) = (0.75 * size, 0.75 * size, -0.4375 * size * size);
        }
        steps += 1;
        step(a, n, low, last, [x, y, w]);
    }
    Some(values)
}

/// One double step on the rows and columns `low` to `last`.
fn step(a: &mut [f64], n: usize, low: usize, last: usize, [x, y, w]: [f64; 3]) {
    let (mut p, mut q, mut r);
    let mut first = last - 2;
    loop {
        let z = a[first * (n + 1)];
        let (rest_x, rest_y) = (x - z, y - z);
        p = (rest_x * rest_y - w) / a[(first + 1) * n + first] + a[first * n + first + 1];
        q = a[(first + 1) * (n + 1)] - z - rest_x - rest_y;
        r = a[(first + 2) * n + first + 1];
        let size = p.abs() + q.abs() + r.abs();
        (p, q, r) = (p / size, q / size, r / size);
        if first == low {
            break;
        }
        let before = a[first * n + first - 1].abs() * (q.abs() + r.abs());
        let around = a[(first - 1) * (n + 1)].abs() + z.abs() + a[(first + 1) * (n + 1)].abs();
        if before <= f64::EPSILON * p.abs() * around {
            break;
        }
        first -= 1;
    }
    for i in first + 2..=last {
        a[i * n + i - 2] = 0.0;
        if i > first + 2 {
            a[i * n + i - 3] = 0.0;
        }
    }
    for k in first..last {
        let three = k + 1 != last;
        let mut scale = 1.0;
        if k != first {
            p = a[k * n + k - 1];
            q = a[(k + 1) * n + k - 1];
            r = if three { a[(k + 2) * n + k - 1] } else { 0.0 };
            scale = p.abs() + q.abs() + r.abs();
            if scale == 0.0 {
                continue;
            }
            (p, q, r) = (p / scale, q / scale, r / scale);
        }
        let length = (p * p + q * q + r * r).sqrt();
        let s = if p < 0.0 { -length } else { length };
        if s == 0.0 {
            continue;
        }
        if k != first {
            a[k * n + k - 1] = -s * scale;
        } else if low != first {
            a[k * n + k - 1] = -a[k * n + k - 1];
        }
        p += s;
        let (x, y, z) = (p / s, q / s, r / s);
        q /= p;
        r /= p;
        for j in k..n.min(last + 1) {
            let mut sum = a[k * n + j] + q * a[(k + 1) * n + j];
            if three {
                sum += r * a[(k + 2) * n + j];
                a[(k + 2) * n + j] -= sum * z;
            }
            a[(k + 1) * n + j] -= sum * y;
            a[k * n + j] -= sum * x;
        }
        for i in low..=last.min(k + 3) {
            let mut sum = x * a[i * n + k] + y * a[i * n + k + 1];
            if three {
                sum += z * a[i * n + k + 2];
                a[i * n + k + 2] -= sum * r;
            }
            a[i * n + k + 1] -= sum * q;
            a[i * n + k] -= sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// X⁻¹ D X of a block diagonal D has the eigenvalues of D.
    #[test]
    fn eigenvalues_are_those_that_went_in() {
        let n = 12;
        let mut d = vec![0.0; n * n];
        let mut expected = Vec::new();
        for k in 0..4 {
            let (re, im) = (-0.3 * (k as f64).exp2(), 1.7 + 3.0 * k as f64);
            let at = 2 * k;
            for (i, j, value) in [(0, 0, re), (1, 1, re), (0, 1, im), (1, 0, -im)] {
                d[(at + i) * n + at + j] = value;
            }
            expected.extend([Complex64::new(re, im), Complex64::new(re, -im)]);
        }
        for k in 8..n {
            d[k * (n + 1)] = -10.0 * (k as f64 - 6.5);
            expected.push(d[k * (n + 1)].into());
        }
        // Reflections keep eigenvalues; a chain of them fills the matrix.
        for turn in 0..3 {
            let v: Vec<f64> = (0..n).map(|k| ((3 * k + 7 * turn + 1) as f64).sin()).collect();
            let square: f64 = v.iter().map(|v| v * v).sum();
            for _ in 0..2 {
                for column in 0..n {
                    let along: f64 = (0..n).map(|row| v[row] * d[row * n + column]).sum();
                    (0..n).for_each(|row| d[row * n + column] -= 2.0 * along / square * v[row]);
                }
                d = (0..n * n).map(|k| d[k % n * n + k / n]).collect();
            }
        }
        let found = eigenvalues(d, n).unwrap();
        for value in &expected {
            let nearest = found.iter().map(|other| (other - value).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-12 * 100.0, "{value}: {nearest} {found:?}");
        }
        assert_eq!(eigenvalues(vec![f64::NAN], 1), None);
        assert_eq!(eigenvalues(vec![0.0; 9], 3).unwrap(), [Complex64::ZERO; 3]);
    }
}
