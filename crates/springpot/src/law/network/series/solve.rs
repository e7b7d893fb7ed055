//! The strokes of the parts at which all have one force.

use super::loose::{Gap, Loose, Sought};
use super::play::{self, Side};
use super::{ENOUGH, MOST_HALVINGS, MOST_ITERATIONS, Matrix, Series, Values};
use crate::collocation::{MAX_NODES, Nodes};
use crate::fractional::{Form, RatePolynomial};
use crate::law::network::{MOST_IN_SERIES, Network};
use crate::law::state::StateRef;
use crate::law::step::{Course, Response, Step};

/// Change of the strokes, in units of the largest, at which nonlinear parts end where rounding lets them come no nearer.
const NEARLY: f64 = 1e-9;

/// Square of what counts as rounding of forces.
const ROUNDED: f64 = 1e-28;

/// Rounding of a stroke of its own, in units of it.
const STROKES: f64 = 8.0 * f64::EPSILON;

/// A part that is softer than this share of the stiffest counts as that soft; a spring that slips as this share of its own stiffness, since what it slips is as
/// well known as forces over that.
const SOFTEST: f64 = 1e-30;
pub(super) const SLIPPING: f64 = 1e-5;

/// One part over a step, as it is told of it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Inner {
    pub(super) stroke: Values,
    pub(super) rate: Values,
}

/// The inner strokes that fit, and what follows.
pub(super) struct Solved {
    pub(super) inner: [Inner; MOST_IN_SERIES],
    pub(super) force: [f64; MAX_NODES],
    pub(super) tangent: Matrix,
    /// By how much the force at the end follows an error of that of each part; of friction the compliance of the others there.
    pub(super) shares: [f64; MOST_IN_SERIES],
    /// Where a play is at the end.
    pub(super) side: Side,
}

impl Inner {
    /// Rates of the polynomial through the strokes.
    pub(super) fn take_rates(&mut self, nodes: Nodes, h: f64) {
        let count = nodes.count();
        for (i, row) in nodes.inverse().iter().enumerate().take(count) {
            self.rate[i + 1] = (0..count).map(|j| row[j] * (self.stroke[j + 1] - self.stroke[0])).sum::<f64>() / h;
        }
        self.rate[0] = RatePolynomial::through_strokes(h, nodes, &self.stroke).u[0];
    }

    pub(super) fn step<'a>(&'a self, whole: &Step<'a>) -> Step<'a> {
        let count = whole.nodes.count() + 1;
        Step { form: Form::Strokes, stroke: &self.stroke[..count], rate: &self.rate[..count], ..*whole }
    }
}

/// Parts about strokes of theirs: F = F_m + C_m⁻¹ δ_m.
#[derive(Debug, Clone, Default)]
pub(super) struct Lines {
    each: Vec<Line>,
    /// (Σ C_m)⁻¹; beside parts that let go Σ C_m of the others.
    tangent: Matrix,
}

/// A spring that slips, where its stiffness has no inverse: F = G x + e, and the others leave it x = r − C F, so that F = (1 + G C)⁻¹ (G r + e).
#[derive(Debug, Clone, Copy)]
pub(super) struct Slip {
    pub(super) part: usize,
    pub(super) stiffness: Matrix,
    /// C.
    pub(super) others: Matrix,
    /// (1 + G C)⁻¹.
    pub(super) system: Matrix,
    /// ∂F/∂r.
    pub(super) tangent: Matrix,
}

#[derive(Debug, Clone, Copy, Default)]
struct Line {
    force: [f64; MAX_NODES],
    compliance: Matrix,
}

impl Lines {
    /// Forces and stiffnesses of all parts about `inner`; compliances are still to be found.
    pub(super) fn look(&mut self, series: &Series, inner: &[Inner; MOST_IN_SERIES], step: &Step, state: StateRef) {
        self.look_by(series, inner, step, state, &|part, step, state, response| {
            part.ask().evaluate(step, state, response)
        });
    }

    /// The same with the tangents of parts themselves, where iterations take others.
    pub(super) fn look_exactly(
        &mut self,
        series: &Series,
        inner: &[Inner; MOST_IN_SERIES],
        step: &Step,
        state: StateRef,
    ) {
        self.look_by(series, inner, step, state, &|part, step, state, response| {
            part.ask().evaluate_exactly(step, state, response)
        });
    }

    fn look_by(
        &mut self,
        series: &Series,
        inner: &[Inner; MOST_IN_SERIES],
        step: &Step,
        mut state: StateRef,
        evaluate: &dyn Fn(&Network, &Step, &mut StateRef, &mut Response),
    ) {
        let (count, inverse) = (step.nodes.count(), step.nodes.inverse());
        self.each.clear();
        for (k, (part, inner)) in series.parts.iter().zip(inner).enumerate() {
            let mut response = Response::default();
            evaluate(part, &inner.step(step), &mut state, &mut response);
            if series.lets_go(k) {
                self.each.push(Line { force: response.force, compliance: Matrix::default() });
                continue;
            }
            let mut stiffness = response.d_stroke;
            for i in 0..count {
                for j in 0..count {
                    let through_rates: f64 = (0..count).map(|m| response.d_rate[i][m] * inverse[m][j]).sum();
                    stiffness[i][j] += through_rates / step.h;
                }
            }
            self.each.push(Line { force: response.force, compliance: stiffness });
        }
    }

    /// Makes compliances of the stiffnesses.
    pub(super) fn turn(&mut self, series: &Series, count: usize) {
        let entries = self.each.iter().flat_map(|line| line.compliance[..count].iter().flat_map(|row| &row[..count]));
        let stiffest = entries.fold(0.0f64, |stiffest, entry| stiffest.max(entry.abs()));
        let floor = (SOFTEST * stiffest).max(f64::MIN_POSITIVE);
        self.tangent = Matrix::default();
        for (k, Line { compliance, .. }) in self.each.iter_mut().enumerate() {
            if series.lets_go(k) {
                continue;
            }
            if let Some(own) = series.slips(k) {
                for (i, row) in
                    compliance.iter_mut().enumerate().take(count).filter(|(_, row)| **row == [0.0; MAX_NODES])
                {
                    row[i] = SLIPPING * own.stiffness();
                }
            }
            invert(compliance, count, floor);
            for (row, own) in self.tangent.iter_mut().zip(&*compliance) {
                row.iter_mut().zip(own).for_each(|(entry, own)| *entry += own);
            }
        }
        if series.loose.is_none() {
            invert(&mut self.tangent, count, f64::MIN_POSITIVE);
        }
    }

    /// What of the step parts that let go are asked: the others leave them `missing` and by what their forces shorten them; `start` is X.
    fn gap<'a>(&'a self, series: &'a Series, step: &'a Step<'a>, mut missing: [f64; MAX_NODES], start: f64) -> Gap<'a> {
        for (_, Line { force, compliance }) in self.each.iter().enumerate().filter(|(k, _)| !series.lets_go(*k)) {
            missing.iter_mut().zip(times(compliance, force)).for_each(|(missing, own)| *missing += own);
        }
        Gap { parts: &series.parts, step, compliance: &self.tangent, stroke: missing, start }
    }

    /// The force at which the strokes of the parts are longer by `missing` in all.
    fn force(&self, mut missing: [f64; MAX_NODES]) -> [f64; MAX_NODES] {
        for Line { force, compliance } in &self.each {
            missing.iter_mut().zip(times(compliance, force)).for_each(|(missing, own)| *missing += own);
        }
        times(&self.tangent, &missing)
    }

    /// By how much the stroke of part `k` is longer under the force `force`.
    fn longer(&self, k: usize, force: &[f64; MAX_NODES]) -> [f64; MAX_NODES] {
        let Line { force: own, compliance } = &self.each[k];
        times(compliance, &std::array::from_fn(|i| force[i] - own[i]))
    }

    /// Moves the strokes of all parts, but those that let go, to where they are under the force `force`.
    #[inline]
    fn stretch(&self, series: &Series, force: &[f64; MAX_NODES], step: &Step, inner: &mut [Inner; MOST_IN_SERIES]) {
        let count = step.nodes.count();
        for (k, inner) in inner.iter_mut().enumerate().take(self.each.len()).filter(|(k, _)| !series.lets_go(*k)) {
            inner.stroke[1..=count].iter_mut().zip(self.longer(k, force)).for_each(|(x, delta)| *x += delta);
            inner.take_rates(step.nodes, step.h);
        }
    }

    /// Gives the parts of a play, of the stroke `start` at the start, the force of the side on which it is held.
    fn hold(&mut self, loose: &Loose, start: f64, step: &Step, inner: &[Inner; MOST_IN_SERIES]) {
        let Some(play) = &loose.play else { return };
        for i in 0..step.nodes.count() {
            let stroke = play.stroke(|k| inner[k].stroke[i + 1]);
            let Some(force) = loose.held_force(start, play::near(step), stroke) else { return };
            let own = self.each.iter_mut().enumerate().filter(|(k, _)| play.has(*k));
            own.for_each(|(_, line)| line.force[i] = force);
        }
    }

    /// What slips, beside the others about the strokes of these; the state is at the shares of the parts.
    pub(super) fn slip(
        &self,
        series: &Series,
        step: &Step,
        inner: &[Inner; MOST_IN_SERIES],
        mut state: StateRef,
    ) -> Option<Slip> {
        let slipping = (0..series.parts.len()).find(|&k| series.slips(k).is_some())?;
        series.parts[..slipping].iter().for_each(|part| part.ask().pass(&mut state));
        let mut response = Response::default();
        series.parts[slipping].ask().evaluate(&inner[slipping].step(step), &mut state, &mut response);
        let mut others = Matrix::default();
        for (_, line) in self.each.iter().enumerate().filter(|(k, _)| *k != slipping) {
            others.iter_mut().flatten().zip(line.compliance.iter().flatten()).for_each(|(sum, own)| *sum += own);
        }
        let mut system = product(&response.d_stroke, &others);
        system.iter_mut().enumerate().for_each(|(i, row)| row[i] += 1.0);
        invert(&mut system, step.nodes.count(), f64::MIN_POSITIVE);
        let tangent = product(&system, &response.d_stroke);
        Some(Slip { tangent, part: slipping, stiffness: response.d_stroke, others, system })
    }

    /// (Σ C)⁻¹.
    pub(super) fn tangent(&self) -> Matrix {
        self.tangent
    }

    /// C of part `k`.
    pub(super) fn compliance(&self, k: usize) -> Matrix {
        self.each[k].compliance
    }

    fn share(&self, tangent: &Matrix, k: usize, count: usize) -> f64 {
        (0..count).map(|j| tangent[count - 1][j] * self.each[k].compliance[j][count - 1]).sum::<f64>().abs()
    }
}

/// What linear parts answer in a step under way, worked out once for however often they are asked.
#[derive(Debug, Clone, Default)]
pub(in crate::law) struct Ready {
    /// Start, size, nodes and course of the step; none where the state has changed.
    step: Option<(f64, f64, Nodes, Course)>,
    /// [`super::is_yielding`].
    pub(super) is_yielding: bool,
    /// About the strokes at the start of the step.
    lines: Lines,
}

impl Ready {
    /// Gets ready for `step`, whose nodes are those of the parts; nothing where its answers are not the same however often it is asked.
    pub(super) fn get(&mut self, series: &Series, is_yielding: bool, step: &Step, starts: &[f64], state: StateRef) {
        let is_ready = self.lines(step).is_some();
        if !is_ready && step.inputs.is_empty() && series.others_are_linear() {
            self.lines.look(series, &resting(starts, step), step, state);
            self.lines.turn(series, step.nodes.count());
            (self.step, self.is_yielding) = (Some((step.t, step.h, step.nodes, step.course)), is_yielding);
        }
    }

    /// The state changes.
    pub(super) fn forget(&mut self) {
        self.step = None;
    }

    pub(super) fn is_for(&self, t: f64, h: f64) -> bool {
        self.step.is_some_and(|(at, size, ..)| (at, size) == (t, h))
    }

    fn lines(&self, step: &Step) -> Option<&Lines> {
        (self.step == Some((step.t, step.h, step.nodes, step.course))).then_some(&self.lines)
    }
}

/// Parts that stay where they are.
#[inline]
fn resting(starts: &[f64], step: &Step) -> [Inner; MOST_IN_SERIES] {
    let mut inner = [Inner::default(); MOST_IN_SERIES];
    let last = step.nodes.count();
    inner.iter_mut().zip(starts).for_each(|(inner, start)| inner.stroke[..=last].fill(*start));
    inner
}

/// Finds the strokes of the parts under the strokes of `step`, whose nodes are theirs, from those at its start.
pub(super) fn solve(
    series: &Series,
    step: &Step,
    starts: &[f64],
    ready: Option<&Ready>,
    state: StateRef,
    sought: Sought,
) -> Solved {
    if let Some(lines) = ready.and_then(|ready| ready.lines(step)) {
        return along(lines, series, step, starts, sought);
    }
    if series.others_are_linear() {
        let mut lines = Lines::default();
        lines.look(series, &resting(starts, step), step, state);
        lines.turn(series, step.nodes.count());
        return along(&lines, series, step, starts, sought);
    }
    search(series, step, starts, state, sought)
}

/// The strokes of parts that are linear but for those that let go.
fn along(lines: &Lines, series: &Series, step: &Step, starts: &[f64], sought: Sought) -> Solved {
    let count = step.nodes.count();
    let [rest, start] = series.split(starts);
    let missing = std::array::from_fn(|i| if i < count { step.stroke[i + 1] - rest } else { 0.0 });
    let Some(loose) = &series.loose else {
        let mut solved = Solved {
            inner: resting(starts, step),
            force: lines.force(missing),
            tangent: lines.tangent,
            shares: [0.0; MOST_IN_SERIES],
            side: 1,
        };
        lines.stretch(series, &solved.force, step, &mut solved.inner);
        (0..starts.len()).for_each(|k| solved.shares[k] = lines.share(&lines.tangent, k, count));
        return solved;
    };
    let mut inner = resting(starts, step);
    let gap = lines.gap(series, step, missing, start);
    let Some(found) = loose.solve(&gap, sought) else { return Solved::unknown(inner, count) };
    lines.stretch(series, &found.force, step, &mut inner);
    loose.place(&found, &gap, starts, &mut inner);
    finish(series, lines, step, inner, found.force, found.tangent, found.sides[count - 1])
}

/// By how much the force follows each part.
#[inline]
fn finish(
    series: &Series,
    lines: &Lines,
    step: &Step,
    inner: [Inner; MOST_IN_SERIES],
    force: [f64; MAX_NODES],
    tangent: Matrix,
    side: Side,
) -> Solved {
    let mut shares = [0.0; MOST_IN_SERIES];
    let last = step.nodes.count() - 1;
    let slips = |(k, line): (usize, &Line)| {
        series.slips(k).is_some_and(|own| line.compliance[last][last] * own.stiffness() > 2.0)
    };
    let is_slipping = lines.each.iter().enumerate().any(slips);
    for (k, share) in shares.iter_mut().enumerate().take(series.parts.len()) {
        // Where nothing is carried, or no more than what slips does, what the others err shows later, in how they come back.
        *share = match side {
            _ if is_slipping => 1.0,
            _ if series.slides(k) => series.softness(lines.tangent[step.nodes.count() - 1][step.nodes.count() - 1]),
            0 => 1.0,
            _ => lines.share(&tangent, k, step.nodes.count()),
        };
    }
    Solved { inner, force, tangent, shares, side }
}

impl Solved {
    /// Where no force is found.
    fn unknown(mut inner: [Inner; MOST_IN_SERIES], count: usize) -> Self {
        inner.iter_mut().for_each(|inner| inner.stroke[1..=count].fill(f64::NAN));
        let (force, tangent) = ([f64::NAN; MAX_NODES], Matrix::default());
        Self { inner, force, tangent, shares: [f64::NAN; MOST_IN_SERIES], side: 1 }
    }
}

/// The strokes of parts that are not all linear, by Newton's method.
fn search(series: &Series, step: &Step, starts: &[f64], state: StateRef, sought: Sought) -> Solved {
    let (count, parts) = (step.nodes.count(), series.parts.len());
    // Spread evenly a nonlinear part would begin far from where it is: the stiffness where it was shares the way out.
    let mut inner = resting(starts, step);
    let slipping = (0..parts).find(|k| series.slips(*k).is_some());
    let (mut search, mut lines) = (Search { slips: slipping.is_some(), ..Search::default() }, Lines::default());
    let [_, start] = series.split(starts);
    let mut side = 1;
    let (mut force, mut tangent) = ([0.0; MAX_NODES], Matrix::default());
    let mut is_found = false;
    while search.ways <= MOST_ITERATIONS {
        lines.look(series, &inner, step, state);
        if let Some(loose) = series.loose.as_ref().filter(|_| sought == Sought::Held) {
            lines.hold(loose, start, step, &inner);
        }
        if !search.goes_on(&lines.each, count, &mut inner) {
            inner.iter_mut().take(parts).for_each(|inner| inner.take_rates(step.nodes, step.h));
            if search.halvings > MOST_HALVINGS {
                is_found = search.change <= NEARLY;
                break;
            }
            continue;
        }
        lines.turn(series, count);
        let point = |k: usize, i: usize| if series.slides(k) { starts[k] } else { inner[k].stroke[i + 1] };
        let gathered = |i: usize| match series.loose {
            None => inner.iter().take(parts).map(|inner| inner.stroke[i + 1]).sum::<f64>(),
            Some(_) => (0..parts).filter(|k| !series.is_free(*k)).map(|k| point(k, i)).sum(),
        };
        let missing = std::array::from_fn(|i| if i < count { step.stroke[i + 1] - gathered(i) } else { 0.0 });
        search.from = inner;
        match &series.loose {
            None => {
                (force, tangent) = (lines.force(missing), lines.tangent);
                lines.stretch(series, &force, step, &mut inner);
                // What slips takes what is left, which no force tells so well.
                if let Some(k) = slipping {
                    for i in 1..=count {
                        let others = (0..parts).filter(|other| *other != k).map(|other| inner[other].stroke[i]);
                        inner[k].stroke[i] = step.stroke[i] - others.sum::<f64>();
                    }
                    inner[k].take_rates(step.nodes, step.h);
                }
            }
            Some(loose) => {
                let gap = lines.gap(series, step, missing, start);
                let Some(found) = loose.solve(&gap, sought) else { break };
                (force, tangent, side) = (found.force, found.tangent, found.sides[count - 1]);
                lines.stretch(series, &force, step, &mut inner);
                loose.place(&found, &gap, starts, &mut inner);
            }
        }
        let (mut change, mut size) = (0.0f64, step.resolution);
        for (inner, from) in inner.iter().zip(&search.from).take(parts) {
            for (x, from) in inner.stroke[1..=count].iter().zip(&from.stroke[1..=count]) {
                let delta = (x - from).abs();
                // Not `max`, which would pass over what is no number.
                change = if delta > change || delta.is_nan() { delta } else { change };
                size = size.max(x.abs());
            }
        }
        // Where nothing moves and nothing has moved there is nothing left to find.
        search.change = if change == 0.0 { 0.0 } else { change / size };
        if search.change <= search.enough() {
            is_found = true;
            break;
        }
    }
    if !is_found {
        return Solved::unknown(inner, count);
    }
    finish(series, &lines, step, inner, force, tangent, side)
}

/// ∂F_i/∂u_j of an input at the nodes of the parts, about strokes of theirs that fit: (Σ C_m)⁻¹ Σ C_m ∂F_m/∂u.
pub(super) fn by_input(
    series: &Series,
    step: &Step,
    Solved { inner, tangent, .. }: &Solved,
    input: usize,
    mut state: StateRef,
) -> Matrix {
    let count = step.nodes.count();
    let mut lines = Lines::default();
    lines.look(series, inner, step, state);
    lines.turn(series, count);
    let mut moved = Matrix::default();
    for ((part, inner), line) in series.parts.iter().zip(inner).zip(&lines.each) {
        let mut own = Matrix::default();
        part.ask().by_input(&inner.step(step), &mut state, input, &mut own);
        let longer = product(&line.compliance, &own);
        moved.iter_mut().flatten().zip(longer.iter().flatten()).for_each(|(sum, own)| *sum += own);
    }
    product(tangent, &moved)
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| std::array::from_fn(|j| row.iter().zip(b).map(|(entry, other)| entry * other[j]).sum()))
}

pub(super) fn times(matrix: &Matrix, vector: &[f64; MAX_NODES]) -> [f64; MAX_NODES] {
    matrix.each_ref().map(|row| row.iter().zip(vector).map(|(entry, value)| entry * value).sum())
}

/// A search for the strokes at which nonlinear parts have one force: along Newton's way, in halves where the whole does not bring
/// their forces together.
#[derive(Default)]
struct Search {
    /// Where the way begins.
    from: [Inner; MOST_IN_SERIES],
    /// How far the forces were apart there, N²; none before the first way, on which the strokes begin to add up.
    apart: Option<f64>,
    halvings: usize,
    ways: usize,
    /// Whether a part slips, so that what is beside it may be as stiff as it likes where its forces do not come nearer.
    slips: bool,
    is_rounding: bool,
    /// Change of the strokes on the last whole way, in units of the largest.
    change: f64,
}

impl Search {
    /// Whether forces are nearer each other than where the way began; else `inner` is half as far on it. Far from rounding only: there
    /// nothing brings them nearer.
    fn goes_on(&mut self, lines: &[Line], count: usize, inner: &mut [Inner; MOST_IN_SERIES]) -> bool {
        let (mut apart, mut size) = (0.0, 0.0);
        for i in 0..count {
            let mean = lines.iter().map(|line| line.force[i]).sum::<f64>() / lines.len() as f64;
            apart += lines.iter().map(|line| (line.force[i] - mean).powi(2)).sum::<f64>();
            size += lines.iter().map(|line| line.force[i].powi(2)).sum::<f64>();
        }
        let is_rounding = apart <= ROUNDED * size || (self.slips && apart <= of_strokes(lines, count, inner));
        self.is_rounding = self.ways > 1 && is_rounding;
        let is_nearer = match self.apart {
            _ if self.ways < 2 => apart.is_finite(),
            Some(before) => apart < before || self.is_rounding,
            None => true,
        };
        if is_nearer {
            (self.apart, self.halvings) = (Some(apart), 0);
            self.ways += 1;
            return true;
        }
        self.halvings += 1;
        for (inner, from) in inner.iter_mut().zip(&self.from) {
            for (stroke, from) in inner.stroke.iter_mut().zip(from.stroke) {
                *stroke = 0.5 * (*stroke + from);
            }
        }
        false
    }

    /// Change at which the search ends: forces that are one but for rounding come no nearer.
    fn enough(&self) -> f64 {
        if self.is_rounding { NEARLY } else { ENOUGH }
    }
}

/// Square of what rounding of the strokes makes of the forces.
fn of_strokes(lines: &[Line], count: usize, inner: &[Inner; MOST_IN_SERIES]) -> f64 {
    let of = |(line, inner): (&Line, &Inner)| {
        let rounding = |j: usize| STROKES * inner.stroke[0].abs().max(inner.stroke[j + 1].abs());
        let row = |row: &[f64; MAX_NODES]| (0..count).map(|j| row[j].abs() * rounding(j)).sum::<f64>().powi(2);
        line.compliance[..count].iter().map(row).sum::<f64>()
    };
    lines.iter().zip(inner).map(of).sum()
}

/// The inverse of the leading `count` rows and columns, by elimination with pivots; a pivot below `floor` counts as that.
pub(super) fn invert(matrix: &mut Matrix, count: usize, floor: f64) {
    let mut inverse: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for k in 0..count {
        let pivot = (k..count).max_by(|&a, &b| matrix[a][k].abs().total_cmp(&matrix[b][k].abs())).unwrap_or(k);
        matrix.swap(k, pivot);
        inverse.swap(k, pivot);
        // What is no number stays none.
        if matrix[k][k].abs() < floor {
            matrix[k][k] = floor;
        }
        let scale = matrix[k][k].recip();
        (matrix[k], inverse[k]) = (matrix[k].map(|x| x * scale), inverse[k].map(|x| x * scale));
        for i in (0..count).filter(|&i| i != k) {
            let factor = matrix[i][k];
            for j in 0..count {
                matrix[i][j] -= factor * matrix[k][j];
                inverse[i][j] -= factor * inverse[k][j];
            }
        }
    }
    *matrix = inverse;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverses_undo() {
        let matrix: Matrix =
            [[1e-3, 2.0, 0.5, 0.1], [3.0, -1.0, 2.0, 0.7], [0.1, 0.2, 5.0, -2.0], [0.4, 0.3, -0.2, 1.0]];
        for count in 1..=MAX_NODES {
            let mut inverse = matrix;
            invert(&mut inverse, count, f64::MIN_POSITIVE);
            for i in 0..count {
                for j in 0..count {
                    let product: f64 = (0..count).map(|k| matrix[i][k] * inverse[k][j]).sum();
                    assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12, "{count}: {product}");
                }
            }
        }
    }
}
