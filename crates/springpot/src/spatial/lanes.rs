//! Several states side by side in one register.
//!
//! Products and sums are joined into one rounding wherever [`Scalar::times_plus`] says that they may be, but in lanes that keep apart what one
//! state keeps apart.

#![expect(
    unsafe_code,
    reason = "instructions that not every processor has; `dispatch` looks whether this one has them"
)]

use std::arch::x86_64::*;
use std::fmt;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use super::columns::{ColumnWork, Columns, Numbers, Rows};
use super::dispatch::{self, Task};
use super::scalar::Scalar;

/// One register of numbers. What it does is right on processors alone that have its instructions, and fast where it is inlined into a
/// function that was compiled for them: values are made behind the doors of [`dispatch`] and nowhere else.
pub(crate) trait Register: Copy + Send + Sync + 'static {
    /// Numbers in it.
    const WIDTH: usize;
    const ZERO: Self;
    const ONE: Self;
    fn splat(x: f64) -> Self;
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    fn over(self, other: Self) -> Self;
    /// self · factor + term in one rounding.
    fn times_plus(self, factor: Self, term: Self) -> Self;
    fn sqrt(self) -> Self;
    /// The first numbers of a slice of [`Self::WIDTH`] at least.
    fn load(from: &[f64]) -> Self;
    fn store(self, to: &mut [f64]);
    /// As many numbers as there are, [`Self::WIDTH`] at most; the rest 0.
    fn load_some(from: &[f64]) -> Self;
    /// Into as many numbers as there are.
    fn store_some(self, to: &mut [f64]);
    /// Exchanges rows and columns of [`Self::WIDTH`] registers.
    fn transpose(block: &mut [Self]);
    /// Runs a task that was compiled for these registers.
    fn enter(task: impl Task);
}

impl Register for __m256d {
    const WIDTH: usize = 4;
    // SAFETY: four numbers are as wide as the register.
    const ZERO: Self = unsafe { std::mem::transmute([0.0_f64; 4]) };
    // SAFETY: as above.
    const ONE: Self = unsafe { std::mem::transmute([1.0_f64; 4]) };

    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: the processor has the instruction.
        unsafe { _mm256_set1_pd(x) }
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        // SAFETY: the processor has the instruction.
        unsafe { _mm256_add_pd(self, other) }
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        // SAFETY: the processor has the instruction.
        unsafe { _mm256_sub_pd(self, other) }
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        // SAFETY: the processor has the instruction.
        unsafe { _mm256_mul_pd(self, other) }
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        // SAFETY: the processor has the instruction.
        unsafe { _mm256_div_pd(self, other) }
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        // SAFETY: the processor has the instruction.
        unsafe { _mm256_fmadd_pd(self, factor, term) }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: the processor has the instruction.
        unsafe { _mm256_sqrt_pd(self) }
    }

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        // SAFETY: the slice is as long as the register.
        unsafe { from[..4].as_ptr().cast::<Self>().read_unaligned() }
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        // SAFETY: the slice is as long as the register.
        unsafe { to[..4].as_mut_ptr().cast::<Self>().write_unaligned(self) }
    }

    #[inline(always)]
    fn load_some(from: &[f64]) -> Self {
        // SAFETY: nothing is read where the mask is 0.
        unsafe { _mm256_maskload_pd(from.as_ptr(), first_of_4(from.len())) }
    }

    #[inline(always)]
    fn store_some(self, to: &mut [f64]) {
        // SAFETY: nothing is written where the mask is 0.
        unsafe { _mm256_maskstore_pd(to.as_mut_ptr(), first_of_4(to.len()), self) }
    }

    #[inline(always)]
    fn transpose(block: &mut [Self]) {
        let &mut [a, b, c, d] = block else { unreachable!("four registers") };
        // SAFETY: the processor has the instructions.
        unsafe {
            let (p, q) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
            let (r, s) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
            block[0] = _mm256_permute2f128_pd::<0x20>(p, r);
            block[1] = _mm256_permute2f128_pd::<0x20>(q, s);
            block[2] = _mm256_permute2f128_pd::<0x31>(p, r);
            block[3] = _mm256_permute2f128_pd::<0x31>(q, s);
        }
    }

    fn enter(task: impl Task) {
        // SAFETY: whoever has such registers has found that the processor has them.
        unsafe { dispatch::avx2(task) }
    }
}

impl Register for __m512d {
    const WIDTH: usize = 8;
    // SAFETY: eight numbers are as wide as the register.
    const ZERO: Self = unsafe { std::mem::transmute([0.0_f64; 8]) };
    // SAFETY: as above.
    const ONE: Self = unsafe { std::mem::transmute([1.0_f64; 8]) };

    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: the processor has the instruction.
        unsafe { _mm512_set1_pd(x) }
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        // SAFETY: the processor has the instruction.
        unsafe { _mm512_add_pd(self, other) }
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        // SAFETY: the processor has the instruction.
        unsafe { _mm512_sub_pd(self, other) }
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        // SAFETY: the processor has the instruction.
        unsafe { _mm512_mul_pd(self, other) }
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        // SAFETY: the processor has the instruction.
        unsafe { _mm512_div_pd(self, other) }
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        // SAFETY: the processor has the instruction.
        unsafe { _mm512_fmadd_pd(self, factor, term) }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: the processor has the instruction.
        unsafe { _mm512_sqrt_pd(self) }
    }

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        // SAFETY: the slice is as long as the register.
        unsafe { from[..8].as_ptr().cast::<Self>().read_unaligned() }
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        // SAFETY: the slice is as long as the register.
        unsafe { to[..8].as_mut_ptr().cast::<Self>().write_unaligned(self) }
    }

    #[inline(always)]
    fn load_some(from: &[f64]) -> Self {
        // SAFETY: nothing is read where the mask is 0.
        unsafe { _mm512_maskz_loadu_pd(first_of_8(from.len()), from.as_ptr()) }
    }

    #[inline(always)]
    fn store_some(self, to: &mut [f64]) {
        // SAFETY: nothing is written where the mask is 0.
        unsafe { _mm512_mask_storeu_pd(to.as_mut_ptr(), first_of_8(to.len()), self) }
    }

    #[inline(always)]
    fn transpose(block: &mut [Self]) {
        let &mut [a, b, c, d, e, f, g, h] = block else { unreachable!("eight registers") };
        let ([ab0, ab1], [cd0, cd1]) = (pairs(a, b), pairs(c, d));
        let ([ef0, ef1], [gh0, gh1]) = (pairs(e, f), pairs(g, h));
        let ([abcd04, abcd26], [efgh04, efgh26]) = (quarters(ab0, cd0), quarters(ef0, gh0));
        let ([abcd15, abcd37], [efgh15, efgh37]) = (quarters(ab1, cd1), quarters(ef1, gh1));
        [block[0], block[4]] = quarters(abcd04, efgh04);
        [block[1], block[5]] = quarters(abcd15, efgh15);
        [block[2], block[6]] = quarters(abcd26, efgh26);
        [block[3], block[7]] = quarters(abcd37, efgh37);
    }

    fn enter(task: impl Task) {
        // SAFETY: whoever has such registers has found that the processor has them.
        unsafe { dispatch::avx512(task) }
    }
}

/// Numbers of two registers in turn: those in even places, and those in odd ones.
#[inline(always)]
fn pairs(x: __m512d, y: __m512d) -> [__m512d; 2] {
    // SAFETY: the processor has the instructions.
    unsafe { [_mm512_unpacklo_pd(x, y), _mm512_unpackhi_pd(x, y)] }
}

/// Quarters of two registers: those in even places, and those in odd ones.
#[inline(always)]
fn quarters(x: __m512d, y: __m512d) -> [__m512d; 2] {
    // SAFETY: the processor has the instructions.
    unsafe { [_mm512_shuffle_f64x2::<0x88>(x, y), _mm512_shuffle_f64x2::<0xdd>(x, y)] }
}

/// All ones in the first `count` numbers.
#[inline(always)]
fn first_of_4(count: usize) -> __m256i {
    const ONES: [i64; 8] = [-1, -1, -1, -1, 0, 0, 0, 0];
    // SAFETY: four of eight numbers are read.
    unsafe { _mm256_loadu_si256(ONES[4 - count.min(4)..].as_ptr().cast()) }
}

/// All ones in the first `count` bits.
#[inline(always)]
fn first_of_8(count: usize) -> u8 {
    ((1u16 << count.min(8)) - 1) as u8
}

/// Several states side by side; `JOINS`: products and sums are joined into one rounding, else lanes have the bits of one state.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Lanes<R, const JOINS: bool = true>(R);

/// Four states.
pub(crate) type Lanes4 = Lanes<__m256d>;
/// Eight states.
pub(crate) type Lanes8 = Lanes<__m512d>;
/// Four states, each with the bits that it has alone.
pub(crate) type Apart4 = Lanes<__m256d, false>;

/// The numbers of all lanes, one after the other.
#[inline(always)]
fn flat<R: Register, const JOINS: bool>(lanes: &[Lanes<R, JOINS>]) -> &[f64] {
    // SAFETY: lanes are nothing but their register, and that is nothing but its numbers.
    unsafe { std::slice::from_raw_parts(lanes.as_ptr().cast(), lanes.len() * R::WIDTH) }
}

/// As [`flat`].
#[inline(always)]
fn flat_mut<R: Register, const JOINS: bool>(lanes: &mut [Lanes<R, JOINS>]) -> &mut [f64] {
    // SAFETY: as above.
    unsafe { std::slice::from_raw_parts_mut(lanes.as_mut_ptr().cast(), lanes.len() * R::WIDTH) }
}

impl<R: Register, const JOINS: bool> Rows for Lanes<R, JOINS> {
    const COUNT: usize = R::WIDTH;

    #[inline(always)]
    fn read(rows: &[f64], count: usize, into: &mut [Self]) {
        let width = into.len();
        if width < R::WIDTH {
            return read_some(rows, count, into);
        }
        for from in (0..width).step_by(R::WIDTH) {
            // The last block begins within the one before it.
            let from = from.min(width - R::WIDTH);
            let mut block = [R::ZERO; 8];
            for lane in 0..R::WIDTH {
                block[lane] = R::load(&rows[lane.min(count - 1) * width + from..]);
            }
            R::transpose(&mut block[..R::WIDTH]);
            for (number, register) in into[from..from + R::WIDTH].iter_mut().zip(block) {
                *number = Self(register);
            }
        }
    }

    #[inline(always)]
    fn write(values: &(impl Numbers<Self> + ?Sized), count: usize, rows: &mut [f64]) -> Self {
        let width = values.count();
        // Nothing times a number that is not finite is not a number; several sums, so that none waits for the one before.
        let mut nothing = [Self::ZERO; 4];
        for from in (0..width).step_by(R::WIDTH) {
            // The last block begins within the one before it, if there is one.
            let from = from.min(width.saturating_sub(R::WIDTH));
            let here = R::WIDTH.min(width);
            let mut block = [R::ZERO; 8];
            for (k, register) in block.iter_mut().enumerate().take(here) {
                let number = values.at(from + k);
                nothing[k % 4] = number.times_plus(Self::ZERO, nothing[k % 4]);
                *register = number.0;
            }
            R::transpose(&mut block[..R::WIDTH]);
            for (lane, register) in block[..count].iter().enumerate() {
                if here == R::WIDTH {
                    register.store(&mut rows[lane * width + from..]);
                } else {
                    register.store_some(&mut rows[lane * width..][..width]);
                }
            }
        }
        nothing[0] + nothing[1] + (nothing[2] + nothing[3])
    }

    fn enter(task: impl Task) {
        R::enter(task);
    }
}

/// Rows that are shorter than a register.
#[inline(always)]
fn read_some<R: Register, const JOINS: bool>(rows: &[f64], count: usize, into: &mut [Lanes<R, JOINS>]) {
    let width = into.len();
    let mut block = [R::ZERO; 8];
    for lane in 0..R::WIDTH {
        block[lane] = R::load_some(&rows[lane.min(count - 1) * width..][..width]);
    }
    R::transpose(&mut block[..R::WIDTH]);
    for (number, register) in into.iter_mut().zip(block) {
        *number = Lanes(register);
    }
}

impl<R: Register, const JOINS: bool> Scalar for Lanes<R, JOINS> {
    const ZERO: Self = Self(R::ZERO);
    const ONE: Self = Self(R::ONE);

    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        Self(R::splat(x))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (mut sine, mut cosine) = ([Self::ZERO], [Self::ZERO]);
        Self::sin_cos_each(&[self], &mut sine, &mut cosine);
        (sine[0], cosine[0])
    }

    #[inline(always)]
    fn sin_cos_each(angles: &[Self], sines: &mut [Self], cosines: &mut [Self]) {
        f64::sin_cos_each(flat(angles), flat_mut(sines), flat_mut(cosines));
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        // As of one state.
        let joins = JOINS || cfg!(target_feature = "fma");
        if joins { Self(self.0.times_plus(factor.0, term.0)) } else { self * factor + term }
    }
}

impl<R: Register, const JOINS: bool> Add for Lanes<R, JOINS> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0.plus(other.0))
    }
}

impl<R: Register, const JOINS: bool> Sub for Lanes<R, JOINS> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0.minus(other.0))
    }
}

impl<R: Register, const JOINS: bool> Mul for Lanes<R, JOINS> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0.times(other.0))
    }
}

impl<R: Register, const JOINS: bool> Div for Lanes<R, JOINS> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(self.0.over(other.0))
    }
}

impl<R: Register, const JOINS: bool> Neg for Lanes<R, JOINS> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(R::splat(-0.0).minus(self.0))
    }
}

impl<R: Register, const JOINS: bool> AddAssign for Lanes<R, JOINS> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<R: Register, const JOINS: bool> SubAssign for Lanes<R, JOINS> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<R: Register, const JOINS: bool> Default for Lanes<R, JOINS> {
    fn default() -> Self {
        Self(R::ZERO)
    }
}

impl<R: Register, const JOINS: bool> PartialEq for Lanes<R, JOINS> {
    fn eq(&self, other: &Self) -> bool {
        flat(&[*self]) == flat(&[*other])
    }
}

impl<R: Register, const JOINS: bool> fmt::Debug for Lanes<R, JOINS> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        flat(&[*self]).fmt(f)
    }
}

/// One state in whose rows several columns are worked on at once, without joining products and sums: the same bits as one by one.
impl<R: Register, const JOINS: bool> Columns<f64> for Lanes<R, JOINS> {
    const WIDTH: usize = R::WIDTH;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self(R::splat(x))
    }

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        Self(R::load(from))
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        self.0.store(to);
    }

    #[inline(always)]
    fn load_some(from: &[f64]) -> Self {
        Self(R::load_some(from))
    }

    #[inline(always)]
    fn store_some(self, to: &mut [f64]) {
        self.0.store_some(to);
    }

    #[inline(always)]
    fn times(self, factor: Self) -> Self {
        self * factor
    }

    #[inline(always)]
    fn minus_product(self, factor: Self, other: Self) -> Self {
        self - factor * other
    }
}

/// [`ColumnWork`] compiled for a level.
struct InColumns<W, C> {
    work: W,
    columns: std::marker::PhantomData<C>,
}

impl<W: ColumnWork<f64>, C: Columns<f64>> Task for InColumns<W, C> {
    #[inline(always)]
    fn run(self) {
        self.work.run::<C>();
    }
}

/// Work on rows of one state, as many columns at a time as there are lanes.
pub(super) fn in_columns<L: Rows + Columns<f64>>(work: impl ColumnWork<f64>) {
    L::enter(InColumns { work, columns: std::marker::PhantomData::<L> });
}
