//! D^a of samples as they come: constant time and memory for each.

use super::along::march::KERNEL_TOLERANCE;
use super::along::{Along, Start};
use super::definition::Definition;
use super::error::DerivativeError;
use super::hermite::stencil::{Equal, QUINTIC_POINTS};
use super::hermite::{Form, Node};
use super::method::Method;
use super::order::Order;
use super::sampled::negligible_slope;

/// One value of a stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Time of the sample, s.
    pub t: f64,
    /// D^a x there; NaN where it is infinite.
    pub value: f64,
}

/// D^a x for −2 ≤ a ≤ 2 of samples that come one by one, on any steps.
///
/// The numbers are those of [`derivative`](super::derivative) with [`Method::Exponential`](super::Method::Exponential),
/// up to the kernel's 1e-12. A row follows its sample after three more, since x' and x'' are taken from three samples
/// on either side; [`Self::finish`] returns the last ones. [`RatedStream`] answers at once where rates are known.
///
/// ```
/// use springpot::fractional::{Definition, Stream};
///
/// // I^½ 1 = 2√(t/π)
/// let mut stream = Stream::new(-0.5, Definition::Caputo)?;
/// let mut rows = Vec::new();
/// for k in 0..1000 {
///     rows.extend_from_slice(stream.push(0.01 * k as f64, 1.0)?);
/// }
/// rows.extend(stream.finish()?);
/// assert_eq!(rows.len(), 1000);
/// assert!(rows.iter().all(|row| (row.value - 2.0 * (row.t / std::f64::consts::PI).sqrt()).abs() < 1e-11));
/// # Ok::<(), springpot::fractional::DerivativeError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Stream {
    spline: Growing,
    /// The last samples, the newest at the end.
    t: Vec<f64>,
    x: Vec<f64>,
    taken: usize,
    equal: Equal,
    rows: Vec<Row>,
}

impl Stream {
    /// A stream that may go on for 10¹² of its steps, by the mean of the first six.
    ///
    /// # Errors
    /// `Order`.
    pub fn new(order: f64, definition: Definition) -> Result<Self, DerivativeError> {
        Self::made(order, definition, None)
    }

    /// A stream that ends at t = `horizon`, s: a third fewer exponentials for a million samples.
    ///
    /// # Errors
    /// `Order`, and `Horizon` where it is not a positive number.
    pub fn until(horizon: f64, order: f64, definition: Definition) -> Result<Self, DerivativeError> {
        check_horizon(horizon)?;
        Self::made(order, definition, Some(horizon))
    }

    fn made(order: f64, definition: Definition, horizon: Option<f64>) -> Result<Self, DerivativeError> {
        let spline = Growing::new(Form::Quintic, order, definition, horizon)?;
        let (t, x) = (Vec::with_capacity(QUINTIC_POINTS + 1), Vec::with_capacity(QUINTIC_POINTS + 1));
        Ok(Self { spline, t, x, taken: 0, equal: Equal::new(QUINTIC_POINTS), rows: Vec::new() })
    }

    /// With a kernel that errs by `tolerance`, 1e-13 … 0.1, in place of 1e-12: fewer exponentials, more speed. It counts from the
    /// first sample on; a tolerance out of range is refused by the second.
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.spline.tolerance = tolerance;
        self
    }

    /// Takes the next sample and returns the rows that are known by it: none for the first six, four then, one for each
    /// later.
    ///
    /// # Errors
    /// `NotFinite`, `OutOfOrder` and `Horizon`, after which the stream stands where it stood and may go on with a
    /// better sample;
    /// `Kernel`, after which it may not.
    pub fn push(&mut self, t: f64, x: f64) -> Result<&[Row], DerivativeError> {
        check(self.taken, self.t.last().copied(), &[("t", t), ("x", x)])?;
        self.spline.check(t)?;
        self.rows.clear();
        self.t.push(t);
        self.x.push(x);
        self.taken += 1;
        if self.t.len() > QUINTIC_POINTS {
            self.t.remove(0);
            self.x.remove(0);
        }
        let middle = QUINTIC_POINTS / 2;
        match self.taken {
            ..QUINTIC_POINTS => {}
            QUINTIC_POINTS => self.settle(0..middle + 1)?,
            _ => self.settle(middle..middle + 1)?,
        }
        Ok(&self.rows)
    }

    /// The rows that waited for samples after them: the last three, or all where there were fewer than seven samples.
    ///
    /// # Errors
    /// `TooShort` where fewer samples came than the method needs, `Kernel`.
    pub fn finish(mut self) -> Result<Vec<Row>, DerivativeError> {
        self.rows.clear();
        let (method, needed) = (Method::Exponential, Method::Exponential.min_rows(0.0));
        match self.taken {
            found if found < needed => return Err(DerivativeError::TooShort { method, needed, found }),
            ..QUINTIC_POINTS => {
                self.equal = Equal::new(self.taken);
                self.settle(0..self.taken)?;
            }
            _ => self.settle(QUINTIC_POINTS / 2 + 1..QUINTIC_POINTS)?,
        }
        Ok(self.rows)
    }

    /// Makes nodes of these places in the window.
    fn settle(&mut self, places: std::ops::Range<usize>) -> Result<(), DerivativeError> {
        let span = self.t[self.t.len() - 1] - self.t[0];
        self.spline.horizon.get_or_insert(BOUNDLESS * span / (self.t.len() - 1) as f64);
        for at in places {
            let [slope, bend] = self.equal.derivatives_at(&self.t, &self.x, at);
            let node = Node { t: self.t[at], x: self.x[at], slope, bend };
            let negligible = if at == 0 { negligible_slope(&self.t, &self.x) } else { 0.0 };
            let value = self.spline.row(node, negligible)?;
            self.rows.push(Row { t: node.t, value });
        }
        Ok(())
    }
}

/// D^a x for −2 ≤ a ≤ 2 of samples that come with their rates, at once.
///
/// The cubic Hermite spline through x and x': order 4 − a, as [`Method::Hermite`](super::Method::Hermite). At a = 2 the
/// row t = 0 is NaN: x'' is not known before the second sample.
///
/// ```
/// use springpot::fractional::{Definition, RatedStream};
///
/// // D^½ t = 2√(t/π), from t and its rate.
/// let mut stream = RatedStream::new(0.5, Definition::Caputo)?;
/// for k in 0..1000 {
///     let t = 0.01 * k as f64;
///     let d = stream.push(t, t, 1.0)?;
///     assert!((d - 2.0 * (t / std::f64::consts::PI).sqrt()).abs() < 1e-11);
/// }
/// # Ok::<(), springpot::fractional::DerivativeError>(())
/// ```
#[derive(Debug, Clone)]
pub struct RatedStream {
    spline: Growing,
    taken: usize,
    last: Option<f64>,
}

impl RatedStream {
    /// A stream that may go on for 10¹² times its first step.
    ///
    /// # Errors
    /// `Order`.
    pub fn new(order: f64, definition: Definition) -> Result<Self, DerivativeError> {
        Ok(Self { spline: Growing::new(Form::Cubic, order, definition, None)?, taken: 0, last: None })
    }

    /// A stream that ends at t = `horizon`, s.
    ///
    /// # Errors
    /// `Order`, and `Horizon` where it is not a positive number.
    pub fn until(horizon: f64, order: f64, definition: Definition) -> Result<Self, DerivativeError> {
        check_horizon(horizon)?;
        Ok(Self { spline: Growing::new(Form::Cubic, order, definition, Some(horizon))?, taken: 0, last: None })
    }

    /// With a kernel that errs by `tolerance`, 1e-13 … 0.1, in place of 1e-12: fewer exponentials, more speed. It counts from the
    /// first sample on; a tolerance out of range is refused by the second.
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.spline.tolerance = tolerance;
        self
    }

    /// Takes x and x' of the next sample and returns D^a x there; NaN where it is infinite.
    ///
    /// # Errors
    /// As [`Stream::push`].
    pub fn push(&mut self, t: f64, x: f64, rate: f64) -> Result<f64, DerivativeError> {
        check(self.taken, self.last, &[("t", t), ("x", x), ("rate", rate)])?;
        self.spline.check(t)?;
        if t > 0.0 {
            self.spline.horizon.get_or_insert(BOUNDLESS * t);
        }
        let value = self.spline.row(Node { t, x, slope: rate, bend: f64::NAN }, 0.0)?;
        self.last = Some(t);
        self.taken += 1;
        Ok(value)
    }
}

/// Steps that a memory without a given horizon holds.
const BOUNDLESS: f64 = 1e12;

/// A spline before and after its first node.
#[derive(Debug, Clone)]
struct Growing {
    form: Form,
    order: Order,
    definition: Definition,
    horizon: Option<f64>,
    tolerance: f64,
    along: Option<Along>,
}

impl Growing {
    fn new(form: Form, order: f64, definition: Definition, horizon: Option<f64>) -> Result<Self, DerivativeError> {
        Ok(Self { form, order: Order::new(order)?, definition, horizon, tolerance: KERNEL_TOLERANCE, along: None })
    }

    fn check(&self, t: f64) -> Result<(), DerivativeError> {
        match self.horizon {
            Some(horizon) if t > horizon * (1.0 + 1e-9) => Err(DerivativeError::Horizon { t, horizon }),
            _ => Ok(()),
        }
    }

    fn row(&mut self, node: Node, negligible_slope: f64) -> Result<f64, DerivativeError> {
        match &mut self.along {
            Some(along) => along.row(node, self.horizon.unwrap_or(BOUNDLESS * node.t)),
            none => {
                let start = Start::new(&self.order, self.definition, &node, negligible_slope);
                *none = Some(Along::new(self.order, self.form, start, node, self.tolerance));
                Ok(start.value)
            }
        }
    }
}

fn check_horizon(horizon: f64) -> Result<(), DerivativeError> {
    if horizon > 0.0 && horizon.is_finite() { Ok(()) } else { Err(DerivativeError::Horizon { t: 0.0, horizon }) }
}

fn check(row: usize, last: Option<f64>, values: &[(&'static str, f64)]) -> Result<(), DerivativeError> {
    if let Some(&(column, value)) = values.iter().find(|(_, value)| !value.is_finite()) {
        return Err(DerivativeError::NotFinite { column, row, value });
    }
    let t = values[0].1;
    let in_order = last.map_or(t == 0.0, |last| t > last);
    if in_order { Ok(()) } else { Err(DerivativeError::OutOfOrder { row, t, previous: last.unwrap_or(-0.0) }) }
}
