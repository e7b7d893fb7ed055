//! What batches are worked out in, and the loop over their states.

use super::error::BatchError;
use crate::dynamics::crba::couples;
use crate::dynamics::rnea_second_derivatives::SecondRoom;
use crate::dynamics::{AbaDerivatives, Kinematics, RneaDerivatives, RneaSecondDerivatives, Workspace};
use crate::model::Model;
use crate::spatial::columns::{Placed, Rows};
use crate::spatial::dispatch::Task;
#[cfg(target_arch = "x86_64")]
use crate::spatial::lanes::{Lanes4, Lanes8};
use crate::spatial::{Scalar, SimdError, SimdLevel};

/// What a thread works out batches of one [`Model`] in; it carries nothing from one call to the next.
#[derive(Debug, Clone)]
pub struct BatchWorkspace {
    level: SimdLevel,
    lanes: Lanes,
}

/// As many states side by side as the level has.
#[derive(Debug, Clone)]
enum Lanes {
    One(Box<Scratch<f64>>),
    #[cfg(target_arch = "x86_64")]
    Four(Box<Scratch<Lanes4>>),
    #[cfg(target_arch = "x86_64")]
    Eight(Box<Scratch<Lanes8>>),
}

#[derive(Debug, Clone)]
struct Scratch<T> {
    inputs: [Vec<T>; 3],
    room: Room<T>,
    symmetric: Symmetric,
}

/// Where the numbers of symmetric matrices stand, of which one triangle is worked out; nv × nv each.
#[derive(Debug, Clone)]
pub(super) struct Symmetric {
    /// Of the mass matrix, whose lower triangle has numbers where joints couple; beyond all numbers for 0.
    mass: Vec<u32>,
    /// Of a matrix whose upper triangle is full.
    upper: Vec<u32>,
}

impl Symmetric {
    fn new(model: &Model) -> Self {
        let n = model.nv();
        let place = |row: usize, column: usize| u32::try_from(row * n + column).unwrap_or(u32::MAX);
        let upper = (0..n * n).map(|k| place((k / n).min(k % n), (k / n).max(k % n))).collect();
        let mut mass = vec![u32::MAX; n * n];
        for k in 0..n {
            mass[k * n + k] = place(k, k);
        }
        // With followers both triangles are written.
        couples(model, |row, column| {
            mass[row * n + column] = place(row, column);
            mass[column * n + row] = place(row, column);
        });
        Self { mass, upper }
    }
}

/// Of which numbers a result consists.
#[derive(Clone, Copy)]
pub(super) enum Shape {
    /// Of those that are left, in their order.
    AsItIs,
    /// As [`Symmetric::mass`] says.
    Mass,
    /// As [`Symmetric::upper`] says.
    Upper,
}

/// Where an algorithm works, and leaves its results.
#[derive(Debug, Clone)]
pub(super) struct Room<T> {
    pub(super) kinematics: Kinematics<T>,
    pub(super) workspace: Workspace<T>,
    pub(super) inverse_slopes: RneaDerivatives<T>,
    pub(super) forward_slopes: AbaDerivatives<T>,
    /// 6 × nv.
    pub(super) matrix: Vec<T>,
    /// nv × nv.
    pub(super) square: Vec<T>,
    /// nv × nv × nv or a regressor, made when it is first asked for.
    pub(super) cube: Vec<T>,
    /// nv or 3, whichever is more.
    pub(super) vector: Vec<T>,
    /// Made when it is first asked for.
    pub(super) second: Option<Box<(SecondRoom<T>, RneaSecondDerivatives<T>)>>,
    pub(super) scalar: [T; 1],
    pub(super) more: [T; 9],
}

impl<T: Rows> Scratch<T> {
    fn behind_the_door(model: &Model) -> Box<Self> {
        let mut made = None;
        T::enter(Make { model, made: &mut made });
        made.expect("the task is run")
    }

    #[inline(always)]
    fn new(model: &Model) -> Self {
        let n = model.nv();
        let zeros = |count: usize| vec![T::ZERO; count];
        let room = Room {
            kinematics: Kinematics::neutral(model),
            workspace: Workspace::new(model),
            inverse_slopes: RneaDerivatives::new(model),
            forward_slopes: AbaDerivatives::new(model),
            matrix: zeros(6 * n),
            square: zeros(n * n),
            cube: Vec::new(),
            vector: zeros(n.max(3)),
            second: None,
            scalar: [T::ZERO],
            more: [T::ZERO; 9],
        };
        let width = model.nq().max(n);
        let inputs = [zeros(width), zeros(width), zeros(width)];
        Self { inputs, room, symmetric: Symmetric::new(model) }
    }
}

/// A scratch, in which kinematics stand at once.
struct Make<'a, T> {
    model: &'a Model,
    made: &'a mut Option<Box<Scratch<T>>>,
}

impl<T: Rows> Task for Make<'_, T> {
    #[inline(always)]
    fn run(self) {
        *self.made = Some(Box::new(Scratch::new(self.model)));
    }
}

impl BatchWorkspace {
    /// For `model`, at the level that `SPRINGPOT_SIMD` says, else the best of this processor.
    ///
    /// # Errors
    /// [`SimdError`]: the variable has another word, or a level that this processor has not.
    pub fn new(model: &Model) -> Result<Self, SimdError> {
        Self::at(model, SimdLevel::chosen()?)
    }

    /// For `model`, at a level.
    ///
    /// # Errors
    /// [`SimdError::Missing`]: this processor has it not.
    pub fn at(model: &Model, level: SimdLevel) -> Result<Self, SimdError> {
        let lanes = match level.available()? {
            #[cfg(target_arch = "x86_64")]
            SimdLevel::Avx512 => Lanes::Eight(Scratch::behind_the_door(model)),
            #[cfg(target_arch = "x86_64")]
            SimdLevel::Avx2 => Lanes::Four(Scratch::behind_the_door(model)),
            _ => Lanes::One(Scratch::behind_the_door(model)),
        };
        Ok(Self { level, lanes })
    }

    /// The level at which it works.
    pub fn level(&self) -> SimdLevel {
        self.level
    }
}

/// One algorithm, on states side by side.
pub(super) trait Algorithm<const I: usize, const O: usize> {
    /// How the results are laid out.
    const SHAPE: Shape = Shape::AsItIs;

    /// Works from `inputs`, and says where in the room the results are. Inlined, as all that it calls.
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, inputs: [&[T]; I]) -> [&'r [T]; O];
}

/// An argument or a result: its name, its numbers, and how many of them belong to one state.
pub(super) type Named<N> = (&'static str, N, usize);

/// Works out all states, then says which is the first without finite results.
pub(super) fn run<const I: usize, const O: usize>(
    algorithm: &impl Algorithm<I, O>,
    model: &Model,
    workspace: &mut BatchWorkspace,
    inputs: [Named<&[f64]>; I],
    outputs: [Named<&mut [f64]>; O],
) -> Result<(), BatchError> {
    let shapes = inputs.iter().map(|(name, numbers, width)| (*name, numbers.len(), *width));
    let count =
        common_count(shapes.chain(outputs.iter().map(|(name, numbers, width)| (*name, numbers.len(), *width))))?;
    let Some(count) = count.filter(|count| *count > 0) else { return Ok(()) };
    let inputs = inputs.map(|(_, numbers, width)| (numbers, width));
    let mut outputs = outputs.map(|(_, numbers, width)| (numbers, width));
    let is_finite = match &mut workspace.lanes {
        Lanes::One(scratch) => enter(algorithm, model, scratch, inputs, &mut outputs, count),
        #[cfg(target_arch = "x86_64")]
        Lanes::Four(scratch) => enter(algorithm, model, scratch, inputs, &mut outputs, count),
        #[cfg(target_arch = "x86_64")]
        Lanes::Eight(scratch) => enter(algorithm, model, scratch, inputs, &mut outputs, count),
    };
    if is_finite {
        return Ok(());
    }
    let bad = |(numbers, width): &(&mut [f64], usize)| {
        let place = if numbers.iter().fold(true, |all, number| all & number.is_finite()) {
            None
        } else {
            numbers.iter().position(|number| !number.is_finite())
        };
        place.map(|k| (k / (*width).max(1), numbers[k]))
    };
    match outputs.iter().filter_map(bad).min_by_key(|(row, _)| *row) {
        Some((row, value)) => Err(BatchError::NotFinite { row, value }),
        None => Ok(()),
    }
}

/// How many rows all arguments hold; `None`: none of them has a number.
fn common_count(shapes: impl Iterator<Item = (&'static str, usize, usize)>) -> Result<Option<usize>, BatchError> {
    let mut common: Option<(&'static str, usize)> = None;
    for (name, found, width) in shapes {
        if (width == 0 && found > 0) || (width > 0 && !found.is_multiple_of(width)) {
            return Err(BatchError::NoWholeRows { name, found, width });
        }
        let Some(count) = found.checked_div(width) else { continue };
        match common {
            Some((first, rows)) if rows != count => {
                return Err(BatchError::OtherRows { name, found: count, width, first, rows });
            }
            _ => common = common.or(Some((name, count))),
        }
    }
    Ok(common.map(|(_, count)| count))
}

/// Whether all results are known to be finite.
fn enter<T: Rows, const I: usize, const O: usize>(
    algorithm: &impl Algorithm<I, O>,
    model: &Model,
    scratch: &mut Scratch<T>,
    inputs: [(&[f64], usize); I],
    outputs: &mut [(&mut [f64], usize); O],
    count: usize,
) -> bool {
    let mut is_finite = false;
    T::enter(All { algorithm, model, scratch, inputs, outputs, count, is_finite: &mut is_finite });
    is_finite
}

/// All states of a batch.
struct All<'a, 'o, A, T, const I: usize, const O: usize> {
    algorithm: &'a A,
    model: &'a Model,
    scratch: &'a mut Scratch<T>,
    inputs: [(&'a [f64], usize); I],
    outputs: &'a mut [(&'o mut [f64], usize); O],
    count: usize,
    is_finite: &'a mut bool,
}

impl<A: Algorithm<I, O>, T: Rows, const I: usize, const O: usize> Task for All<'_, '_, A, T, I, O> {
    #[inline(always)]
    fn run(self) {
        let Scratch { inputs: lanes, room, symmetric } = self.scratch;
        // One state at a time is looked at faster outside.
        let mut nothing = T::ZERO;
        let mut first = 0;
        while first < self.count {
            let here = T::COUNT.min(self.count - first);
            let mut states: [&[T]; I] = [&[]; I];
            for (k, lanes) in lanes.iter_mut().enumerate().take(I) {
                let (numbers, width) = self.inputs[k];
                let lanes = &mut lanes[..width];
                T::read(&numbers[first * width..][..here * width], here, lanes);
                states[k] = lanes;
            }
            let results = self.algorithm.work(self.model, room, states);
            for k in 0..O {
                let (numbers, width) = &mut self.outputs[k];
                let width = *width;
                let rows = &mut numbers[first * width..][..here * width];
                nothing += match A::SHAPE {
                    Shape::AsItIs => T::write(&results[k][..width], here, rows),
                    Shape::Mass => T::write(&Placed { values: results[k], places: &symmetric.mass }, here, rows),
                    Shape::Upper => T::write(&Placed { values: results[k], places: &symmetric.upper }, here, rows),
                };
            }
            first += here;
        }
        let mut lanes = [0.0; 8];
        T::write([nothing].as_slice(), T::COUNT, &mut lanes[..T::COUNT]);
        *self.is_finite = T::COUNT > 1 && lanes == [0.0; 8];
    }
}
