//! Integrals of functions that bend.

use crate::dual::Real;

/// Most uses of the rules over one interval.
const MOST: usize = 200;

/// Nodes of Kronrod's rule of 15 points on (−1, 1), from the middle outwards, its weights, and those of Gauss's rule of 7, which takes every other one.
///
/// Source: A. S. Kronrod, Nodes and Weights of Quadrature Formulas, Consultants Bureau 1965.
const KRONROD: [[f64; 3]; 8] = [
    [0.0, 0.209_482_141_084_727_82, 0.417_959_183_673_469_4],
    [0.207_784_955_007_898_48, 0.204_432_940_075_298_89, 0.0],
    [0.405_845_151_377_397_2, 0.190_350_578_064_785_42, 0.381_830_050_505_118_9],
    [0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0],
    [0.741_531_185_599_394_5, 0.140_653_259_715_525_92, 0.279_705_391_489_276_64],
    [0.864_864_423_359_769_1, 0.104_790_010_322_250_19, 0.0],
    [0.949_107_912_342_758_5, 0.063_092_092_629_978_56, 0.129_484_966_168_869_7],
    [0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0],
];

/// The same of 5 points and of Gauss's 2.
const SHORT: [[f64; 3]; 3] = [
    [0.0, 0.622_222_222_222_222_2, 0.0],
    [0.577_350_269_189_625_7, 0.490_909_090_909_090_9, 1.0],
    [0.925_820_099_772_551_5, 0.197_979_797_979_797_98, 0.0],
];

/// ∫ f over an interval, to rounding where f is smooth between the places at which `branch` changes: these are found to their last bits. NaN where there
/// is none.
/// A place is found from the `argument` of the bit that changes, which passes zero there, where one is known.
pub(crate) fn between_kinks<T: Real>(
    [start, end]: [f64; 2],
    f: &dyn Fn(f64) -> T,
    branch: &dyn Fn(f64) -> u64,
    argument: &dyn Fn(u32, f64) -> Option<f64>,
) -> T {
    let (mut sum, mut from) = (T::from(0.0), start);
    while let Some([before, behind]) = first_kink([from, end], branch, argument) {
        sum += smooth([from, before], f);
        from = behind;
    }
    sum + smooth([from, end], f)
}

/// The points of a rule in an interval, each with its row, in order.
fn places(rule: &[[f64; 3]], [start, end]: [f64; 2]) -> impl Iterator<Item = (f64, [f64; 3])> {
    let at = move |place: f64| 0.5 * (start + end) + 0.5 * (end - start) * place;
    let below = rule.iter().rev().map(move |row| (at(-row[0]), *row));
    below.chain(rule.iter().skip(1).map(move |row| (at(row[0]), *row)))
}

/// What both rules say of ∫ f over an interval, and ∫|f| and the same of its slope.
fn sums<T: Real>(rule: &[[f64; 3]], interval: [f64; 2], f: &dyn Fn(f64) -> T) -> ([T; 2], [f64; 2]) {
    let [mut fine, mut coarse] = [T::from(0.0); 2];
    let (half, mut size) = (0.5 * (interval[1] - interval[0]), [0.0; 2]);
    for (place, [_, kronrod, gauss]) in places(rule, interval) {
        let value = f(place);
        fine += value * (half * kronrod).into();
        coarse += value * (half * gauss).into();
        size[0] += half.abs() * kronrod * value.value().abs();
        size[1] += half.abs() * kronrod * value.slope().abs();
    }
    ([fine, coarse], size)
}

/// Whether two sums agree to what is `allowed` of value and slope.
fn agree<T: Real>([fine, coarse]: [T; 2], allowed: [f64; 2]) -> bool {
    let error = fine - coarse;
    !(error.value().abs() > allowed[0] || error.slope().abs() > allowed[1])
}

/// The last bits between which the branch changes first, as far as the points of the rules tell.
fn first_kink(
    interval: [f64; 2],
    branch: &dyn Fn(f64) -> u64,
    argument: &dyn Fn(u32, f64) -> Option<f64>,
) -> Option<[f64; 2]> {
    let mut places = places(&SHORT, interval).map(|(place, _)| place).chain([interval[1]]);
    let mut low = places.next()?;
    let side = branch(low);
    let mut high = places.find(|place| {
        let is_beyond = branch(*place) != side;
        low = if is_beyond { low } else { *place };
        is_beyond
    })?;
    let last_bits = f64::EPSILON * (interval[1] - interval[0]);
    let bit = (side ^ branch(high)).trailing_zeros();
    if let Some([a, b]) = argument(bit, low).zip(argument(bit, high)).map(|(a, b)| [a, b])
        && a * b < 0.0
    {
        // One secant is enough where the argument is a straight line.
        let place = high - b * (high - low) / (b - a);
        let near = [place - last_bits, place + last_bits];
        if branch(near[0]) == side && branch(near[1]) != side {
            return Some(near);
        }
    }
    while (high - low).abs() > last_bits.abs() {
        let middle = 0.5 * (low + high);
        *(if branch(middle) == side { &mut low } else { &mut high }) = middle;
    }
    Some([low, high])
}

/// By the rules of 2 and 5 points where these agree, else by adaptive halving until those of 7 and 15 do, to 1e-14 of ∫|f|; NaN where [`MOST`] uses of them
/// do not do.
pub(crate) fn smooth<T: Real>(whole: [f64; 2], f: &dyn Fn(f64) -> T) -> T {
    let (short, size) = sums(&SHORT, whole, f);
    if agree(short, size.map(|size| 1e-15 * size)) {
        return short[0];
    }
    let (mut sum, mut allowed, mut open) = (T::from(0.0), None, vec![whole]);
    for _ in 0..MOST {
        let Some([start, end]) = open.pop() else { return sum };
        let (long, size) = sums(&KRONROD, [start, end], f);
        if agree(long, *allowed.get_or_insert(size.map(|size| 1e-14 * size))) {
            sum += long[0];
        } else {
            let middle = 0.5 * (start + end);
            open.extend([[middle, end], [start, middle]]);
        }
    }
    f64::NAN.into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::Dual;

    #[test]
    fn integrals_are_known_to_rounding() {
        let (smooth_alone, none) = (|_: f64| 0, |_: u32, _: f64| None);
        let close = |value: f64, wanted: f64| {
            assert!((value - wanted).abs() <= 4e-15 * (1.0 + wanted.abs()), "{value} {wanted}")
        };
        close(between_kinks([0.0, 3.0], &f64::exp, &smooth_alone, &none), 3.0f64.exp_m1());
        close(between_kinks([0.0, -2.0], &|x: f64| x.powi(21), &smooth_alone, &none), 2.0f64.powi(22) / 22.0);
        close(between_kinks([0.0, 1.0], &|x: f64| 1.0 / (x * x + 1e-4), &smooth_alone, &none), 100.0 * 100.0f64.atan());
        // Two kinks, one of which is a jump.
        let bent = |x: f64| (x - 0.3).abs() + if x < 0.7 { 0.0 } else { 5.0 };
        let branch = |x: f64| u64::from(x < 0.3) + 2 * u64::from(x < 0.7);
        close(between_kinks([0.0, 1.0], &bent, &branch, &none), 0.5 * (0.09 + 0.49) + 1.5);
        close(between_kinks([1.0, 0.0], &bent, &branch, &none), -0.5 * (0.09 + 0.49) - 1.5);
        let argument = |bit: u32, x: f64| Some(x - [0.3, 0.7][bit as usize]);
        close(between_kinks([1.0, 0.0], &bent, &branch, &argument), -0.5 * (0.09 + 0.49) - 1.5);
        // The same unseen, to what halving gives.
        assert!((between_kinks([0.0, 1.0], &bent, &smooth_alone, &none) - 1.79).abs() < 1e-12);
        let end = Dual::variable(2.0);
        let derived = end * between_kinks([0.0, 1.0], &|s| (end * s.into()).exp(), &smooth_alone, &none);
        close(derived.slope, 2.0f64.exp());
    }

    #[test]
    fn what_is_noise_ends() {
        let noise = |x: f64| ((x * 1e9).sin() * 1e3).fract();
        assert!(between_kinks([0.0, 1.0], &noise, &|_| 0, &|_, _| None).is_nan());
        assert!(between_kinks([0.0, 1.0], &|x: f64| 1.0 / x, &|_| 0, &|_, _| None).is_nan());
        assert!(between_kinks([0.0, 1.0], &|_: f64| f64::NAN, &|_| 0, &|_, _| None).is_nan());
    }
}
