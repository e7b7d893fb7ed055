//! The look through one expression, cell by cell.

use super::expression::{Branch, Expression};
use super::function::Signal;
use super::series::Series;
use super::watched::{AgendaError, FINEST, Watched, Window};
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Cells into which a run is divided at first, and how many times shorter steps are nothing to speak of.
const CELLS: usize = 32;
const SHORT: f64 = 512.0;

/// The narrowest cell in which kinks are told apart, as a share of the run.
const FINEST_KINK: f64 = 1.0 / (1u64 << 42) as f64;

/// Cells after which a signal is given up, seconds of work: a run would take as many steps. Where fewer steps are allowed, fewer cells.
const MOST_CELLS: u64 = 700_000;

/// What may be added to them for every kink found.
const CELLS_PER_KINK: u64 = 64;

/// A settled cell that asks for more steps than this is tried for evenness, and where in it.
const MANY: f64 = 0.5;
const PROBES: [f64; 5] = [0.13, 0.37, 0.61, 0.83, 0.97];

/// The shortest stretch that is tried for evenness, in last bits of its time.
const SHORTEST_SWING: f64 = 64.0;

/// Expressions with more kinks than this are looked at cell by cell as far as each cell sees them, down to so many kinks that take no time; and so many
/// kinks of one cell are located in it.
pub(super) const MANY_KINKS: usize = 64;
const FEW_KINKS: usize = 8;
const FEW_CROSSING: usize = 3;

/// After so many cells it is asked how many kinks there will be: of those found in short stretches, one in each of so many parts of the run, each looked
/// at in so many cells at most and chosen to hold about so many kinks.
const ESTIMATED_AT: u64 = 1 << 17;
const STRETCHES: usize = 16;
const STRETCH_CELLS: u64 = 1 << 12;
const STRETCH_KINKS: f64 = 32.0;

/// An estimate counts that says so many times more than are allowed.
const SURELY: f64 = 2.0;

/// How large a signal and its integral become.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
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
    pub(super) fn range(&self) -> f64 {
        let rounding = 64.0 * f64::EPSILON * self.low.abs().max(self.high.abs());
        (self.high - self.low).max(rounding).max(f64::MIN_POSITIVE)
    }
}

/// The look through one expression.
pub(super) struct Scan<'a> {
    expression: &'a Expression,
    /// The same, where it has many kinks.
    many: Option<Rc<Expression>>,
    signal: &'a Signal,
    is_position: bool,
    end: f64,
    pub(super) tolerance: f64,
    /// How many kinks a run can follow.
    pub(super) most: u64,
    stop: Option<&'a AtomicBool>,
    pub(super) kinks: Vec<f64>,
    pub(super) windows: Vec<Window>,
    cells: u64,
    /// Of the signal or its rate: what cells are measured by, and what was seen.
    used: Scale,
    pub(super) seen: Scale,
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
    pub(super) fn new(
        expression: &'a Expression,
        watched: &Watched<'a>,
        end: f64,
        tolerance: f64,
        (most, stop): (u64, Option<&'a AtomicBool>),
    ) -> Self {
        Self {
            expression,
            many: (expression.kink_count() > MANY_KINKS).then(|| Rc::new(expression.clone())),
            signal: watched.signal,
            is_position: watched.is_position,
            end,
            tolerance: watched.slack * tolerance,
            most,
            stop,
            kinks: Vec::new(),
            windows: Vec::new(),
            cells: 0,
            used: Scale::NONE,
            seen: Scale::NONE,
            positions: Scale::NONE,
        }
    }

    pub(super) fn run(&mut self) -> Result<(), AgendaError> {
        self.sample();
        self.run_sampled()
    }

    pub(super) fn run_sampled(&mut self) -> Result<(), AgendaError> {
        // What a first look finds may be much larger than what samples showed.
        for attempt in 0.. {
            self.used = Scale { integral: self.integral_scale(), ..self.seen };
            let outcome = self.look_through();
            let grew = self.seen.range() > 4.0 * self.used.range() || self.integral_scale() > 4.0 * self.used.integral;
            let gives_up = outcome == Err(AgendaError::Interrupted) || (outcome.is_err() && attempt > 0);
            if !grew || attempt == 3 || gives_up {
                return outcome;
            }
        }
        Ok(())
    }

    /// The scales as samples show them.
    pub(super) fn sample(&mut self) {
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
    pub(super) fn integral_scale(&self) -> f64 {
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
                self.count_cell(cell.a)?;
                self.look_at(cell, &mut open);
            }
        }
        Ok(())
    }

    /// Counts the next cell, which begins at `a`, and gives up where there are too many.
    fn count_cell(&mut self, a: f64) -> Result<(), AgendaError> {
        self.cells += 1;
        if self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
            return Err(AgendaError::Interrupted);
        }
        let kinks = self.kinks.len() as u64;
        let too_busy = |times: f64| Err(AgendaError::TooBusy { signal: 0, times });
        if kinks > self.most {
            return too_busy(kinks as f64);
        }
        let most_cells = MOST_CELLS.min(CELLS_PER_KINK.saturating_mul(self.most).max(ESTIMATED_AT));
        if self.cells > most_cells + CELLS_PER_KINK * kinks {
            // As many as there would be until the end.
            let share = (a / self.end).max(f64::EPSILON);
            return too_busy(self.cells as f64 / share);
        }
        if self.cells == ESTIMATED_AT {
            let estimate = self.estimate()?;
            if estimate > SURELY * self.most as f64 {
                return too_busy(estimate);
            }
        }
        Ok(())
    }

    /// How many kinks there will be, about, as those in a stretch of each part of the run tell.
    fn estimate(&self) -> Result<f64, AgendaError> {
        let Some(last) = self.kinks.last() else { return Ok(0.0) };
        let usual = STRETCH_KINKS * last / self.kinks.len() as f64;
        let part = self.end / STRETCHES as f64;
        let mut sum = 0.0;
        for k in 0..STRETCHES {
            let from = part * (k as f64 + PROBES[k % PROBES.len()]);
            let mut width = usual.min(part * (1.0 - PROBES[k % PROBES.len()]));
            let finest = (FINEST_KINK * self.end).max(4.0 * f64::EPSILON * from);
            loop {
                width = width.max(finest);
                let mut stretch = Self { kinks: Vec::new(), windows: Vec::new(), many: self.many.clone(), ..*self };
                match stretch.count_between(from, from + width)? {
                    Some(kinks) => break sum += kinks as f64 / width * part,
                    None if width == finest => break sum += 1.0 / width * part,
                    None => width *= 1.0 / 16.0,
                }
            }
        }
        Ok(sum)
    }

    /// The number of kinks between two times; `None` where that takes many cells.
    fn count_between(&mut self, a: f64, b: f64) -> Result<Option<usize>, AgendaError> {
        let sides = |expression: &Expression| [a, b].map(|t| expression.branch(t));
        let mut open = vec![Cell::new(self.expression, self.many.as_ref(), [a, b], sides)];
        for _ in 0..STRETCH_CELLS {
            let Some(cell) = open.pop() else { return Ok(Some(self.kinks.len())) };
            if self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
                return Err(AgendaError::Interrupted);
            }
            self.look_at(cell, &mut open);
        }
        Ok(None)
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
        let value = |t: f64| part.map_or_else(|| self.signal.value(t), |part| part.value(t));
        if look.is_unsettled && !is_crowded && [a, middle, b].into_iter().all(|t| value(t).is_nan()) {
            // What is no number stops the run; nothing is to be seen there.
            return self.close(a, f64::INFINITY);
        }
        if look.is_unsettled && !is_crowded && !halve(FINEST_KINK) {
            // A kink that turns back at once, or several at the same time.
            self.kinks.push(b);
            return self.close(a, f64::INFINITY);
        }
        let series = look.series.scaled(self.signal.scale, self.signal.offset);
        let room = match look.is_unsettled || is_crowded {
            true => 0.0,
            false if !value(middle).is_finite() => f64::INFINITY,
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
        if room > MANY {
            return false;
        }
        // What swings faster than times can be told apart does so over stretches of a few bits.
        let step = ((b - a) * room).max(SHORTEST_SWING * f64::EPSILON * b).min(b - a);
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
