//! Rows of matrices, several columns at a time, and rows of states, several states at a time.

use super::dispatch::Task;
use super::scalar::Scalar;

/// Columns of a row of numbers `T` that are worked on together.
pub trait Columns<T>: Copy {
    /// How many.
    const WIDTH: usize;
    /// The same in every column.
    fn splat(x: T) -> Self;
    /// The first of a slice that holds as many at least.
    fn load(from: &[T]) -> Self;
    /// Into the first of a slice that holds as many at least.
    fn store(self, to: &mut [T]);
    /// From a slice of at most as many; the rest 0.
    fn load_some(from: &[T]) -> Self;
    /// Into a slice of at most as many.
    fn store_some(self, to: &mut [T]);
    /// self · factor.
    fn times(self, factor: Self) -> Self;
    /// self − factor · other.
    fn minus_product(self, factor: Self, other: Self) -> Self;
}

/// Work on rows of numbers `T`.
pub trait ColumnWork<T> {
    /// Does it, so many columns at a time as `C` holds.
    fn run<C: Columns<T>>(self);
}

/// One column at a time.
impl<T: Scalar> Columns<T> for T {
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat(x: T) -> Self {
        x
    }

    #[inline(always)]
    fn load(from: &[T]) -> Self {
        from[0]
    }

    #[inline(always)]
    fn store(self, to: &mut [T]) {
        to[0] = self;
    }

    #[inline(always)]
    fn load_some(from: &[T]) -> Self {
        from[0]
    }

    #[inline(always)]
    fn store_some(self, to: &mut [T]) {
        to[0] = self;
    }

    #[inline(always)]
    fn times(self, factor: Self) -> Self {
        self * factor
    }

    #[inline(always)]
    fn minus_product(self, factor: Self, other: Self) -> Self {
        (-factor).times_plus(other, self)
    }
}

/// Numbers of a row.
pub(crate) trait Numbers<T> {
    fn count(&self) -> usize;
    fn at(&self, k: usize) -> T;
    /// All of them, into a slice of as many.
    fn copy_into(&self, row: &mut [T]);
}

impl<T: Copy> Numbers<T> for [T] {
    #[inline(always)]
    fn count(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn at(&self, k: usize) -> T {
        self[k]
    }

    #[inline(always)]
    fn copy_into(&self, row: &mut [T]) {
        row.copy_from_slice(self);
    }
}

/// Each from its place.
pub(crate) struct Placed<'a, T> {
    pub(crate) values: &'a [T],
    pub(crate) places: &'a [u32],
}

impl<T: Scalar> Numbers<T> for Placed<'_, T> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.places.len()
    }

    /// 0 from a place beyond all values.
    #[inline(always)]
    fn at(&self, k: usize) -> T {
        let place = self.places[k] as usize;
        if place < self.values.len() { self.values[place] } else { T::ZERO }
    }

    #[inline(always)]
    fn copy_into(&self, row: &mut [T]) {
        for (k, number) in row.iter_mut().enumerate() {
            *number = self.at(k);
        }
    }
}

/// States side by side, which lie one after the other outside.
pub(crate) trait Rows: Scalar {
    /// States side by side.
    const COUNT: usize;
    /// The numbers of `count` states; lanes beyond them repeat the last one. `rows` has `into.len()` numbers for each.
    fn read(rows: &[f64], count: usize, into: &mut [Self]);
    /// The numbers of the first `count` states into as many `rows`; returned: 0 in lanes in which all are finite, else NaN. One state is not
    /// looked at: 0.
    fn write(values: &(impl Numbers<Self> + ?Sized), count: usize, rows: &mut [f64]) -> Self;
    /// Runs a task compiled for these lanes.
    fn enter(task: impl Task);
}

impl Rows for f64 {
    const COUNT: usize = 1;

    fn read(rows: &[f64], _: usize, into: &mut [Self]) {
        into.copy_from_slice(&rows[..into.len()]);
    }

    fn write(values: &(impl Numbers<Self> + ?Sized), _: usize, rows: &mut [f64]) -> Self {
        values.copy_into(&mut rows[..values.count()]);
        0.0
    }

    fn enter(task: impl Task) {
        task.run();
    }
}
