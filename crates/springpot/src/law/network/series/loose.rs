//! Parts of a series that let go: a play, which is free at some strokes, and friction, which slides at any rate.
//!
//! At the nodes of a step the other parts stretch by C·F; what they leave, g − C·F, is the stroke X of the play and what the friction has slid.

use super::Matrix;
use super::play::{self, Play, Side};
use super::slide::{self, Friction};
use super::solve::{Inner, invert};
use crate::collocation::MAX_NODES;
use crate::law::leaf::Holds;
use crate::law::network::{MOST_IN_SERIES, Network};
use crate::law::step::Step;

/// Rounds in which nodes change sides, before all ways are tried.
const MOST_ROUNDS: usize = 12;

type Nodes = [f64; MAX_NODES];

/// Which strokes are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sought {
    /// Those that fit.
    Fit,
    /// Those of a play that stays on the side on which the step starts, whether they fit or not: smooth, as its guards are to be.
    Held,
}

/// The parts of a series that let go.
#[derive(Debug, Clone)]
pub(super) struct Loose {
    pub(super) play: Option<Play>,
    /// Those that slide.
    friction: Vec<usize>,
}

/// What of a step they are asked.
pub(super) struct Gap<'a> {
    pub(super) parts: &'a [Network],
    pub(super) step: &'a Step<'a>,
    /// C, by which the others stretch.
    pub(super) compliance: &'a Matrix,
    /// g, what they and friction leave without a force, and where nothing slides.
    pub(super) stroke: Nodes,
    /// X at the start of the step.
    pub(super) start: f64,
}

/// Forces and what follows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Engaged {
    pub(super) force: Nodes,
    /// X at the nodes.
    stroke: Nodes,
    /// Rates of friction at the nodes, by the places of the parts.
    rates: [[f64; MOST_IN_SERIES]; MAX_NODES],
    /// ∂F/∂g.
    pub(super) tangent: Matrix,
    pub(super) sides: [Side; MAX_NODES],
}

impl Loose {
    /// Those of `parts`, where there are any.
    pub(super) fn of(parts: &[Network]) -> Option<Self> {
        let slides = |part: &Network| part.holds() == Holds::LetsGo && part.free().is_none();
        let friction = parts.iter().enumerate().filter(|(_, part)| slides(part)).map(|(k, _)| k).collect();
        let own = Self { play: Play::of(parts), friction };
        (own.play.is_some() || !own.friction.is_empty()).then_some(own)
    }

    /// Whether part `k` of the series is one of them.
    pub(super) fn has(&self, k: usize) -> bool {
        self.is_free(k) || self.friction.contains(&k)
    }

    /// Whether part `k` is free at some strokes.
    pub(super) fn is_free(&self, k: usize) -> bool {
        self.play.as_ref().is_some_and(|play| play.has(k))
    }

    /// Where a play is that has the stroke `x`; `None` on an end.
    fn side(&self, x: f64, near: f64) -> Option<Side> {
        self.play.as_ref().map_or(Some(1), |play| play.side(x, near))
    }

    /// The forces that are `sought`; `None` where there are none.
    pub(super) fn solve(&self, gap: &Gap, sought: Sought) -> Option<Engaged> {
        let from = self.side(gap.start, play::near(gap.step));
        match sought {
            Sought::Fit => self.fit(gap, from.unwrap_or(0)),
            Sought::Held => {
                // On an end it is the first node that says where it goes.
                let side = from.or_else(|| Some(self.fit(gap, 0)?.sides[0]))?;
                self.on(&[side; MAX_NODES], gap)
            }
        }
    }

    /// Each node on the side where it is, beginning with all of them on the side `from`.
    fn fit(&self, gap: &Gap, from: Side) -> Option<Engaged> {
        let Some(play) = &self.play else { return self.on(&[from; MAX_NODES], gap) };
        let (count, near) = (gap.step.nodes.count(), play::near(gap.step));
        let fits = |found: &Engaged| play.sides(&found.sides, &found.stroke, &found.force, count, near);
        let mut sides = [from; MAX_NODES];
        for _ in 0..MOST_ROUNDS {
            let found = self.on(&sides, gap)?;
            let next = fits(&found);
            if next == sides {
                return Some(found.settled());
            }
            sides = next;
        }
        // Not every order of changing sides ends; there are few ways in all.
        (0..3usize.pow(count as u32)).find_map(|way| {
            let side = |i: usize| if i < count { (way / 3usize.pow(i as u32) % 3) as Side - 1 } else { from };
            let sides: [Side; MAX_NODES] = std::array::from_fn(side);
            if sides.iter().any(|side| *side != 0 && !play.end(*side).is_finite()) {
                return None;
            }
            let found = self.on(&sides, gap)?;
            (fits(&found) == sides).then(|| found.settled())
        })
    }

    /// The forces with every node on a given side.
    fn on(&self, sides: &[Side; MAX_NODES], gap: &Gap) -> Option<Engaged> {
        let count = gap.step.nodes.count();
        let (end, softness) = match &self.play {
            Some(play) => (sides.map(|side| if side == 0 { 0.0 } else { play.end(side) }), play.stiffness().recip()),
            None => ([0.0; MAX_NODES], 0.0),
        };
        // F_i/K + (C F)_i = g_i − end where a node is engaged, F_i = 0 where it is not.
        let mut compliance = *gap.compliance;
        (0..count).for_each(|i| compliance[i][i] += softness);
        let over: Nodes = std::array::from_fn(|i| gap.stroke[i] - end[i]);
        let carried = sides.map(|side| side != 0);
        let (force, tangent, rates) = match self.friction.is_empty() {
            true => {
                let tangent = elastic(&compliance, &carried, count);
                (times(&tangent, &over, count), tangent, [[0.0; MOST_IN_SERIES]; MAX_NODES])
            }
            false => self.slide(gap, &compliance, &over, &carried)?,
        };
        let stretched = times(gap.compliance, &force, count);
        let slid = self.slid(gap, &rates);
        let stroke = std::array::from_fn(|i| match sides[i] {
            _ if i >= count => 0.0,
            0 => gap.stroke[i] - slid[i] - stretched[i],
            _ => end[i] + softness * force[i],
        });
        Some(Engaged { force, stroke, rates, tangent, sides: *sides })
    }

    /// Forces, ∂F/∂g and the rates of friction.
    fn slide(
        &self,
        gap: &Gap,
        compliance: &Matrix,
        over: &Nodes,
        carried: &[bool; MAX_NODES],
    ) -> Option<(Nodes, Matrix, [[f64; MOST_IN_SERIES]; MAX_NODES])> {
        let count = gap.step.nodes.count();
        let mut friction = [Friction::default(); MAX_NODES];
        for (i, friction) in friction.iter_mut().enumerate().take(count) {
            let inputs = gap.step.inputs_at(i + 1);
            let each = self.friction.iter().map(|&k| Some((k, gap.parts[k].ask().slides(inputs)?)));
            *friction = Friction::of(each.collect::<Option<Vec<_>>>()?.into_iter());
        }
        let moved = gap.step.matrix().map(|row| row.map(|entry| gap.step.h * entry));
        let found = slide::solve(&friction, &moved, compliance, over, carried, count)?;
        let rates = std::array::from_fn(|i| match i < count && carried[i] {
            true => friction[i].rates(found.rate[i]),
            false => [0.0; MOST_IN_SERIES],
        });
        Some((found.force, found.tangent, rates))
    }

    /// What friction has slid at the nodes since the start, all together.
    fn slid(&self, gap: &Gap, rates: &[[f64; MOST_IN_SERIES]; MAX_NODES]) -> Nodes {
        let sums = rates.map(|each| each.iter().sum::<f64>());
        let moved = times(&gap.step.matrix(), &sums, gap.step.nodes.count());
        moved.map(|moved| gap.step.h * moved)
    }

    /// Puts its parts where they are found to be, from their strokes at the start.
    pub(super) fn place(&self, found: &Engaged, gap: &Gap, starts: &[f64], inner: &mut [Inner; MOST_IN_SERIES]) {
        let step = gap.step;
        let count = step.nodes.count();
        if let Some(play) = &self.play {
            for i in 0..count {
                let strokes = play.spread(found.stroke[i], found.force[i], found.sides[i]);
                (0..gap.parts.len()).filter(|k| play.has(*k)).for_each(|k| inner[k].stroke[i + 1] = strokes[k]);
            }
        }
        for &k in &self.friction {
            let rates = found.rates.map(|each| each[k]);
            let moved = times(&step.matrix(), &rates, count);
            (0..count).for_each(|i| inner[k].stroke[i + 1] = starts[k] + step.h * moved[i]);
        }
        (0..gap.parts.len()).filter(|k| self.has(*k)).for_each(|k| inner[k].take_rates(step.nodes, step.h));
        // Differences of strokes know them less well.
        for &k in &self.friction {
            (0..count).for_each(|i| inner[k].rate[i + 1] = found.rates[i][k]);
        }
    }

    /// The force of part `k` of a play at `stroke`, on the side on which it is held.
    pub(super) fn held_force(&self, start: f64, near: f64, stroke: f64) -> Option<f64> {
        let play = self.play.as_ref()?;
        let side = play.side(start, near)?;
        Some(if side == 0 { 0.0 } else { play.stiffness() * (stroke - play.end(side)) })
    }
}

impl Engaged {
    /// What engages never does the opposite, not by rounding either.
    fn settled(mut self) -> Self {
        for (force, side) in self.force.iter_mut().zip(self.sides) {
            *force = if side > 0 { force.max(0.0) } else { force.min(0.0) };
        }
        self
    }
}

/// ∂F/∂g where nothing slides.
fn elastic(compliance: &Matrix, carried: &[bool; MAX_NODES], count: usize) -> Matrix {
    let mut tangent = Matrix::default();
    for i in 0..count {
        match carried[i] {
            true => tangent[i][..count].copy_from_slice(&compliance[i][..count]),
            false => tangent[i][i] = 1.0,
        }
    }
    invert(&mut tangent, count, f64::MIN_POSITIVE);
    for (row, carries) in tangent.iter_mut().zip(carried) {
        for (entry, on) in row.iter_mut().zip(carried) {
            *entry = if *carries && *on { *entry } else { 0.0 };
        }
    }
    tangent
}

fn times(matrix: &Matrix, vector: &Nodes, count: usize) -> Nodes {
    std::array::from_fn(|i| if i < count { (0..count).map(|j| matrix[i][j] * vector[j]).sum() } else { 0.0 })
}
