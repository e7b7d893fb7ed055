//! What signals do between two times, known before a run steps through them.
//!
//! A step looks at a signal at a few nodes; what happens between them it cannot see. So the whole run is looked through beforehand,
//! cell by cell, with bounds instead of samples (`Expression::look`): where no kink switches and the signal is a polynomial up to a
//! small share of its own range, the cell is done; where a kink switches once it is located to the last bit; else the cell is halved.
//! No pulse is too narrow to be found, down to [`FINEST`] of the run. The outcome is a list of *stops*, where steps end, and of
//! *windows* that bound the steps in them.

use super::expression::{Branch, Expression};
use super::function::{Kind, Signal};
use super::series::Series;
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Cells into which a run is divided at first, and how many times shorter steps are nothing to speak of.
const CELLS: usize = 32;
const SHORT: f64 = 512.0;

/// The narrowest cell, as a share of the run; what is narrower may be missed.
pub const FINEST: f64 = 1.0 / (1u64 << 30) as f64;

/// The narrowest cell in which kinks are told apart, as a share of the run.
const FINEST_KINK: f64 = 1.0 / (1u64 << 42) as f64;

/// Cells after which a signal is given up: a run would take as many steps.
const MOST_CELLS: u64 = 20_000_000;

/// What may be added to them for every kink found.
const CELLS_PER_KINK: u64 = 64;

/// A settled cell that asks for more steps than this is tried for evenness, and where in it.
const MANY: f64 = 0.5;
const PROBES: [f64; 5] = [0.13, 0.37, 0.61, 0.83, 0.97];

/// Expressions with more kinks than this are looked at cell by cell as far as each cell sees them, down to so many kinks that take no time; and so many
/// kinks of one cell are located in it.
const MANY_KINKS: usize = 64;
const FEW_KINKS: usize = 8;
const FEW_CROSSING: usize = 3;

/// Cells between two looks at the flag that interrupts.
const PATIENCE: u64 = 1 << 12;

/// A signal, and what it is to the run.
#[derive(Debug, Clone, Copy)]
pub struct Watched<'a> {
    /// The signal.
    pub signal: &'a Signal,
    /// Whether it is a position, whose rates count; else it counts itself (a force, a voltage).
    pub is_position: bool,
    /// How many times more than others it may hide: 1 where the motion follows from it.
    pub slack: f64,
}

/// What a run must not step over.
#[derive(Debug, Clone, Default)]
pub struct Agenda {
    /// The first times after kinks, ascending.
    kinks: Vec<f64>,
    /// Times at which a derivative of samples jumps, ascending.
    breaks: Vec<f64>,
    windows: Vec<Window>,
    /// Widths below which kinks and the start are one.
    tiny: f64,
}

/// A stretch of time with a longest step, up to the next window.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Window {
    start: f64,
    longest: f64,
}

/// Where a step must end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// The last time that belongs to the step.
    pub before: f64,
    /// The first time on the other side of a kink or jump; `None` where a derivative of samples jumps at `before` itself.
    pub after: Option<f64>,
}

/// Why a run cannot be looked through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum AgendaError {
    /// A signal switches or swings too often.
    #[error("changes more often than a run can follow: over {cells} times")]
    TooBusy {
        /// Index of the signal.
        signal: usize,
        /// Cells looked at.
        cells: u64,
    },
    /// Interrupted by the user.
    #[error("interrupted")]
    Interrupted,
}

impl Agenda {
    /// Looks through `signals` from 0 to `end`.
    ///
    /// `tolerance` is the share of a signal's own range (and of its integral's) that may stay unseen between the nodes of a step.
    ///
    /// # Errors
    /// [`AgendaError`] where a signal changes more often than any run could follow, or where `stop` is set.
    pub fn new(
        signals: &[Watched<'_>],
        end: f64,
        tolerance: f64,
        stop: Option<&AtomicBool>,
    ) -> Result<Self, AgendaError> {
        let mut agenda = Self { tiny: f64::EPSILON * f64::EPSILON * end, ..Self::default() };
        for (index, watched) in signals.iter().enumerate() {
            match &watched.signal.kind {
                Kind::Constant(_) => {}
                Kind::Samples(samples) => {
                    agenda.breaks.extend_from_slice(samples.break_points());
                    agenda.kinks.extend(samples.kinks());
                }
                Kind::Expression(expression) => {
                    let mut scan = Scan::new(expression, watched, end, tolerance, stop);
                    scan.run().map_err(|error| match error {
                        AgendaError::TooBusy { cells, .. } => AgendaError::TooBusy { signal: index, cells },
                        AgendaError::Interrupted => error,
                    })?;
                    agenda.kinks.append(&mut scan.kinks);
                    agenda.windows = meet(&agenda.windows, &scan.windows);
                }
            }
        }
        for times in [&mut agenda.kinks, &mut agenda.breaks] {
            times.retain(|t| 0.0 < *t && *t <= end);
            times.sort_by(f64::total_cmp);
            times.dedup();
        }
        Ok(agenda)
    }

    /// Number of kinks and jumps of expressions.
    pub fn switches(&self) -> u64 {
        self.kinks.len() as u64
    }

    /// The shortest of the longest steps, s; `None` where nothing but the stops bounds the steps.
    pub fn finest(&self) -> Option<f64> {
        let finest = self.windows.iter().map(|window| window.longest).fold(f64::INFINITY, f64::min);
        finest.is_finite().then_some(finest)
    }

    /// At least as many steps does a run to `end` take whose own longest step is `longest`.
    pub fn least_steps(&self, end: f64, longest: f64) -> f64 {
        let ends = self.windows.iter().skip(1).map(|window| window.start).chain([end]);
        let bounded =
            self.windows.iter().zip(ends).map(|(window, to)| (to - window.start) / window.longest.min(longest));
        let even = if self.windows.is_empty() { end / longest } else { bounded.sum() };
        even + self.kinks.len() as f64
    }

    /// How long a step from `t` may be, at most `h`, so that its nodes see all that happens in it. It may end where a window with
    /// shorter steps begins.
    pub fn reach(&self, t: f64, h: f64) -> f64 {
        let first = self.windows.partition_point(|window| window.start <= t).saturating_sub(1);
        let mut reach = h;
        for window in self.windows.get(first..).unwrap_or_default() {
            let ahead = window.start - t;
            if ahead >= reach {
                break;
            }
            reach = reach.min(window.longest.max(ahead));
        }
        reach
    }

    /// The first stop at or after `t`; kinks that only rounding tells apart are one.
    pub fn next_stop(&self, t: f64) -> Option<Stop> {
        let k = self.kinks.partition_point(|after| self.before(*after) < t);
        let kink = self.kinks.get(k).map(|&after| {
            let next = self.kinks[k + 1..].iter().take_while(|next| **next - after <= 8.0 * f64::EPSILON * after);
            Stop { before: self.before(after), after: Some(next.last().copied().unwrap_or(after)) }
        });
        let breaks = self.breaks.get(self.breaks.partition_point(|at| *at <= t)).copied();
        match (kink, breaks) {
            (Some(kink), Some(at)) if at < kink.before => Some(Stop { before: at, after: None }),
            (None, Some(at)) => Some(Stop { before: at, after: None }),
            (kink, _) => kink,
        }
    }

    /// The last time before a kink.
    fn before(&self, after: f64) -> f64 {
        if after <= self.tiny { 0.0 } else { after.next_down() }
    }
}

/// The shorter of the longest steps at each time.
fn meet(a: &[Window], b: &[Window]) -> Vec<Window> {
    if a.is_empty() || b.is_empty() {
        return if a.is_empty() { b.to_vec() } else { a.to_vec() };
    }
    let (mut met, mut i, mut j): (Vec<Window>, usize, usize) = (Vec::new(), 0, 0);
    loop {
        let window = Window { start: a[i].start.max(b[j].start), longest: a[i].longest.min(b[j].longest) };
        if met.last().is_none_or(|last| last.longest != window.longest) {
            met.push(window);
        }
        match (a.get(i + 1), b.get(j + 1)) {
            (None, None) => return met,
            (Some(next), other) if other.is_none_or(|other| next.start <= other.start) => {
                j += usize::from(other.is_some_and(|other| other.start == next.start));
                i += 1;
            }
            _ => j += 1,
        }
    }
}

/// How large a signal and its integral become.
#[derive(Debug, Clone, Copy)]
struct Scale {
    first: f64,
    low: f64,
    high: f64,
    integral: f64,
}

impl Scale {
    const NONE: Self = Self { first: f64::NAN, low: f64::INFINITY, high: f64::NEG_INFINITY, integral: 0.0 };

    fn take(&mut self, value: f64) {
        if value.is_finite() {
            if self.first.is_nan() {
                self.first = value;
            }
            (self.low, self.high) = (self.low.min(value), self.high.max(value));
        }
    }

    /// The range, not below what rounding makes of the values.
    fn range(&self) -> f64 {
        let rounding = 64.0 * f64::EPSILON * self.low.abs().max(self.high.abs());
        (self.high - self.low).max(rounding).max(f64::MIN_POSITIVE)
    }
}

/// The look through one expression.
struct Scan<'a> {
    expression: &'a Expression,
    /// The same, where it has many kinks.
    many: Option<Rc<Expression>>,
    signal: &'a Signal,
    is_position: bool,
    end: f64,
    tolerance: f64,
    stop: Option<&'a AtomicBool>,
    kinks: Vec<f64>,
    windows: Vec<Window>,
    cells: u64,
    /// Of the signal or its rate: what cells are measured by, and what was seen.
    used: Scale,
    seen: Scale,
    /// Of a position.
    positions: Scale,
}

/// Times from `a` to `b`, and the branches of the expression there.
#[derive(Debug, Clone)]
struct Cell {
    a: f64,
    b: f64,
    sides: [Branch; 2],
    /// Of an expression of many kinks what is seen of it here.
    part: Option<Rc<Expression>>,
}

impl Cell {
    /// Of an expression; where that has many kinks, what is seen of them in `part`, which holds the cell.
    fn new(
        whole: &Expression,
        part: Option<&Rc<Expression>>,
        [a, b]: [f64; 2],
        sides: impl FnOnce(&Expression) -> [Branch; 2],
    ) -> Self {
        let Some(part) = part else { return Self { a, b, sides: sides(whole), part: None } };
        let ends = |part: &Expression| [a, b].map(|t| part.branch(t));
        let part = if part.kink_count() > FEW_KINKS { Rc::new(part.within(a, b, &ends(part))) } else { part.clone() };
        Self { a, b, sides: ends(&part), part: Some(part) }
    }
}

impl<'a> Scan<'a> {
    fn new(
        expression: &'a Expression,
        watched: &Watched<'a>,
        end: f64,
        tolerance: f64,
        stop: Option<&'a AtomicBool>,
    ) -> Self {
        Self {
            expression,
            many: (expression.kink_count() > MANY_KINKS).then(|| Rc::new(expression.clone())),
            signal: watched.signal,
            is_position: watched.is_position,
            end,
            tolerance: watched.slack * tolerance,
            stop,
            kinks: Vec::new(),
            windows: Vec::new(),
            cells: 0,
            used: Scale::NONE,
            seen: Scale::NONE,
            positions: Scale::NONE,
        }
    }

    fn run(&mut self) -> Result<(), AgendaError> {
        self.sample();
        // What a first look finds may be much larger than what samples showed.
        for attempt in 0.. {
            self.used = Scale { integral: self.integral_scale(), ..self.seen };
            let outcome = self.look_through();
            let grew = self.seen.range() > 4.0 * self.used.range() || self.integral_scale() > 4.0 * self.used.integral;
            if !grew || attempt == 3 || outcome == Err(AgendaError::Interrupted) {
                return outcome;
            }
        }
        Ok(())
    }

    /// The scales as samples show them.
    fn sample(&mut self) {
        let count = 4 * CELLS;
        let step = self.end / count as f64;
        for k in 0..count {
            let jet = self.signal.at((k as f64 + 0.5) * step);
            self.take(jet.value, jet.first, step);
        }
    }

    fn take(&mut self, value: f64, rate: f64, width: f64) {
        self.positions.take(value);
        let counted = if self.is_position { rate } else { value };
        self.seen.take(counted);
        let changed = (counted - self.seen.first).abs();
        if changed.is_finite() {
            self.seen.integral += width * changed;
        }
    }

    /// Of the integral: the range of a position, at most 1 rad or 1 m, since strokes turn and bend with it; the area of others.
    fn integral_scale(&self) -> f64 {
        if self.is_position { self.positions.range().min(1.0) } else { self.seen.integral }
    }

    fn look_through(&mut self) -> Result<(), AgendaError> {
        (self.cells, self.seen.integral) = (0, 0.0);
        self.kinks.clear();
        self.windows.clear();
        let mut open: Vec<Cell> = Vec::new();
        let width = self.end / CELLS as f64;
        let mut left = self.expression.branch(0.0);
        for k in 0..CELLS {
            let (a, b) = (k as f64 * width, if k + 1 == CELLS { self.end } else { (k + 1) as f64 * width });
            let right = self.expression.branch(b);
            let sides = |_: &Expression| [left, right.clone()];
            open.push(Cell::new(self.expression, self.many.as_ref(), [a, b], sides));
            left = right;
            while let Some(cell) = open.pop() {
                self.cells += 1;
                if self.cells.is_multiple_of(PATIENCE) && self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
                    return Err(AgendaError::Interrupted);
                }
                if self.cells > MOST_CELLS + CELLS_PER_KINK * self.kinks.len() as u64 {
                    return Err(AgendaError::TooBusy { signal: 0, cells: self.cells });
                }
                self.look_at(cell, &mut open);
            }
        }
        Ok(())
    }

    /// Settles a cell, or leaves its parts open, the earlier one on top.
    fn look_at(&mut self, cell: Cell, open: &mut Vec<Cell>) {
        let whole = self.expression;
        let expression = cell.part.as_deref().unwrap_or(whole);
        let Cell { a, b, sides: [left, right], part } = &cell;
        let (a, b, part) = (*a, *b, part.as_ref());
        let width = b - a;
        let look = expression.look(a, b, &cell.sides);
        let middle = a + 0.5 * width;
        let end = self.end;
        let halve = |finest: f64| width > finest * end && a < middle && middle < b;
        // Where many switch they are told apart first: to locate each of them here would take as often as there are others.
        let is_crowded = part.is_some() && look.crossing.below().nth(FEW_CROSSING).is_some() && halve(FINEST_KINK);
        if !look.crossing.is_empty() && !is_crowded {
            let kinks = look.crossing.below().map(|kink| self.locate(&cell, kink));
            let (before, after) = kinks.min_by(|x, y| x.1.total_cmp(&y.1)).expect("a kink");
            self.kinks.push(after);
            if after < b {
                open.push(Cell::new(whole, part, [after, b], |whole| [whole.branch(after), right.clone()]));
            }
            if a < before {
                open.push(Cell::new(whole, part, [a, before], |whole| [left.clone(), whole.branch(before)]));
            }
            return;
        }
        if look.is_unsettled && !is_crowded && !halve(FINEST_KINK) {
            // A kink that turns back at once, or several at the same time.
            self.kinks.push(b);
            return self.close(a, f64::INFINITY);
        }
        let series = look.series.scaled(self.signal.scale, self.signal.offset);
        // What is no number stops the run; nothing is to be seen there.
        let value = || part.map_or_else(|| self.signal.value(middle), |part| part.value(middle));
        let room = match look.is_unsettled || is_crowded {
            true => 0.0,
            false if !value().is_finite() => f64::INFINITY,
            false => self.room(&series, width),
        };
        if look.is_unsettled || is_crowded || (room < 1.0 && halve(FINEST) && !self.is_even(&cell, room)) {
            let branch = if whole.has_kinks() && part.is_none() { whole.branch(middle) } else { Branch::default() };
            let sides = |_: &Expression| [branch.clone(), right.clone()];
            open.push(Cell::new(whole, part, [middle, b], sides));
            open.push(Cell::new(whole, part, [a, middle], |_| [left.clone(), branch.clone()]));
            return;
        }
        let [value, rate] = series.middle();
        self.take(value, rate, width);
        // What cannot be halved any more is stepped over as it is.
        self.close(a, if room < 1.0 && !halve(FINEST) { width } else { width * room });
    }

    /// The longest step, in units of the cell's width, from which the signal hides nothing.
    ///
    /// With f_k bounds of f^(k)/k! over a cell of width w, f departs by (w/2)^k·(width of f_k)/2 from a polynomial of degree k, and
    /// by 2(w/4)^4·|f_4| from a cubic; in shorter steps by as much less as the order says.
    fn room(&self, series: &Series, width: f64) -> f64 {
        let first = usize::from(self.is_position);
        let bounds = |k: usize| series.at[k + first].scale(if self.is_position { (k + 1) as f64 } else { 1.0 });
        let rounding = 64.0 * f64::EPSILON * bounds(0).magnitude();
        let room = |departs: f64, order: f64| {
            let value = self.tolerance * self.used.range() / departs;
            let integral = self.tolerance * self.used.integral / (departs * width);
            if departs <= rounding {
                f64::INFINITY
            } else if order == 0.0 {
                // Of the range alone nothing follows for other steps.
                f64::from(value >= 1.0 && integral >= 1.0)
            } else {
                value.powf(1.0 / order).min(integral.powf(1.0 / (order + 1.0)))
            }
        };
        let even = (0..4).map(|k| room((0.5 * width).powi(k as i32) * bounds(k).radius(), k as f64));
        let cubic = room(2.0 * (0.25 * width).powi(4) * bounds(4).magnitude(), 4.0);
        // Of NaN, which stands for no bound, nothing is taken.
        even.fold(if cubic.is_nan() { 0.0 } else { cubic }, f64::max)
    }

    /// Whether the signal needs steps of about `room` of a settled cell nearly everywhere in it, as a steady swing does: then it need
    /// not be looked at swing by swing.
    fn is_even(&self, Cell { a, b, part, .. }: &Cell, room: f64) -> bool {
        let (a, b, expression) = (*a, *b, part.as_deref().unwrap_or(self.expression));
        if room > MANY || room == 0.0 {
            return false;
        }
        let step = (b - a) * room;
        let needs = PROBES.into_iter().filter(|share| {
            let from = a + share * (b - a - step);
            let sides = [from, from + step].map(|t| expression.branch(t));
            let look = expression.look(from, from + step, &sides);
            let series = look.series.scaled(self.signal.scale, self.signal.offset);
            self.room(&series, step) <= 3.0
        });
        needs.count() + 1 >= PROBES.len()
    }

    /// A cell that hides nothing, whose steps may be this long.
    fn close(&mut self, a: f64, longest: f64) {
        let longest = if longest < 0.9 * self.end / SHORT { longest } else { f64::INFINITY };
        match self.windows.last() {
            // Not a window for every cell of a wave.
            Some(last) if last.longest <= longest && longest <= 4.0 * last.longest => {}
            _ => self.windows.push(Window { start: a, longest }),
        }
    }

    /// The neighbouring times between which a kink that switches once in the cell does so.
    fn locate(&self, cell: &Cell, kink: usize) -> (f64, f64) {
        let expression = cell.part.as_deref().unwrap_or(self.expression);
        let side = |t: f64| expression.branch(t).is_below(kink);
        let from = cell.sides[0].is_below(kink);
        let (mut low, mut high) = (cell.a, cell.b);
        let take = |t: f64, low: &mut f64, high: &mut f64| {
            if *low < t && t < *high {
                *(if side(t) == from { low } else { high }) = t;
            }
        };
        // Newton's method, and a probe on either side of where it settles.
        let mut t = low + 0.5 * (high - low);
        for _ in 0..6 {
            take(t, &mut low, &mut high);
            let (value, slope) = expression.kink_argument(kink, t);
            let next = t - value / slope;
            let near = (next - t).abs();
            t = next;
            if !(low < t && t < high) {
                break;
            }
            if near <= 1e-12 * self.end.min(1e3 * (cell.b - cell.a)) {
                for ulps in [2.0, 16.0, 256.0] {
                    let reach = ulps * f64::EPSILON * t;
                    take(t - reach, &mut low, &mut high);
                    take(t + reach, &mut low, &mut high);
                    if high - low <= 2.0 * reach {
                        break;
                    }
                }
                break;
            }
        }
        while low.next_up() < high && high - low > f64::EPSILON * f64::EPSILON * self.end {
            let middle = low + 0.5 * (high - low);
            if side(middle) == from { low = middle } else { high = middle }
        }
        (low, high)
    }
}
