//! Equations of small motions with rational memories as x' = A x + B u, y = C x + D u.

use super::power::Power;
use super::{State, StateKind};
use crate::linalg::Lu;
use crate::linear::assembly::{Assembly, Owner, Row};

/// Derivatives of inputs that may come up on the way.
const ORDERS: usize = 5;
/// Next to what stands in its row, an entry is rounding.
const ROUNDING: f64 = 1e-11;

/// x' = A x + B u, y = C x + Σ_k D_k u^(k).
#[derive(Debug, Clone)]
pub(super) struct Realised {
    pub(super) a: Vec<Vec<f64>>,
    pub(super) b: Vec<Vec<f64>>,
    pub(super) c: Vec<Vec<f64>>,
    pub(super) d: [Vec<Vec<f64>>; ORDERS],
    pub(super) states: Vec<State>,
}

/// C x + Σ_k D_k u^(k), of several rows.
#[derive(Debug, Clone)]
struct Map {
    by: Vec<Vec<f64>>,
    inputs: [Vec<Vec<f64>>; ORDERS],
}

fn zeros(rows: usize, columns: usize) -> Vec<Vec<f64>> {
    vec![vec![0.0; columns]; rows]
}

impl Map {
    fn new(rows: usize, states: usize, inputs: usize) -> Self {
        Self { by: zeros(rows, states), inputs: std::array::from_fn(|_| zeros(rows, inputs)) }
    }

    /// Adds factor times row `from` of another map to row `to`.
    fn add(&mut self, to: usize, factor: f64, other: &Self, from: usize) {
        if factor == 0.0 {
            return;
        }
        let add = |sum: &mut [f64], own: &[f64]| sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += factor * own);
        add(&mut self.by[to], &other.by[from]);
        for (sum, own) in self.inputs.iter_mut().zip(&other.inputs) {
            add(&mut sum[to], &own[from]);
        }
    }

    /// Its time derivative, where x' is `rate`.
    fn rate(&self, rate: &Self) -> Self {
        let rows = self.by.len();
        let mut all = Self::new(rows, rate.by.len(), self.inputs[0].first().map_or(0, Vec::len));
        for r in 0..rows {
            for (k, factor) in self.by[r].iter().enumerate() {
                all.add(r, *factor, rate, k);
            }
            for order in 1..ORDERS {
                let own = self.inputs[order - 1][r].clone();
                all.inputs[order][r].iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
            }
        }
        all
    }
}

/// A row with rational memories: by columns and their derivatives, and by the states of the memories.
struct Rational {
    by: [Vec<f64>; 3],
    memories: Vec<f64>,
}

fn rational(assembly: &Assembly, row: &Row, powers: &[Power]) -> Rational {
    let mut by = row.by.clone();
    let mut memories = Vec::new();
    for (j, (springpot, power)) in assembly.springpots.iter().zip(powers).enumerate() {
        let weight = row.springpots.get(j).copied().unwrap_or(0.0);
        let stiff: f64 = power.spring + power.branches.iter().map(|[weight, _]| weight).sum::<f64>();
        for (c, stroke) in springpot.stroke.iter().enumerate() {
            by[0][c] += weight * stiff * stroke;
            by[1][c] += weight * power.dashpot * stroke;
        }
        memories.extend(power.branches.iter().map(|[branch, _]| -weight * branch));
    }
    Rational { by, memories }
}

/// The equations and what is observed, with `powers` in place of the springpots; `None` where they do not determine all unknowns.
///
/// Of the strokes inside series, the inputs that follow from the state and the integrals those are states whose rates the equations hold; the
/// others follow from them.
pub(super) fn realise(assembly: &Assembly, outputs: &[Row], powers: &[Power]) -> Option<Realised> {
    let size = assembly.unknowns.len();
    let inputs = assembly.excitations.len();
    let free = assembly.linear.free.len();
    let inner = size - free;
    let rows: Vec<Rational> = assembly.rows.iter().map(|row| rational(assembly, row, powers)).collect();
    let branches = assembly
        .springpots
        .iter()
        .zip(powers)
        .flat_map(|(springpot, power)| power.branches.iter().map(move |[_, pole]| (springpot, *pole)));
    let branches: Vec<_> = branches.collect();
    // Gauss and Jordan on the rates of inner unknowns: row r belongs to pivot column `of[r]`, or to none.
    let mut of: Vec<Option<usize>> = vec![None; inner];
    let mut rates: Vec<Vec<f64>> = (0..inner).map(|r| rows[free + r].by[1][free..size].to_vec()).collect();
    let mut mixed: Vec<Vec<f64>> =
        (0..inner).map(|r| (0..inner).map(|c| f64::from(u8::from(r == c))).collect()).collect();
    let sizes: Vec<f64> = rates.iter().map(|row| row.iter().fold(0.0, |most: f64, x| most.max(x.abs()))).collect();
    loop {
        let open = (0..inner).filter(|&r| of[r].is_none() && sizes[r] > 0.0);
        let entries = open.flat_map(|r| (0..inner).map(move |c| (r, c)));
        let share = |(r, c): (usize, usize)| rates[r][c].abs() / sizes[r];
        let Some((r, c)) = entries.max_by(|a, b| share(*a).total_cmp(&share(*b))) else { break };
        if share((r, c)) <= ROUNDING {
            break;
        }
        let pivot = rates[r][c];
        rates[r].iter_mut().chain(&mut mixed[r]).for_each(|entry| *entry /= pivot);
        of[r] = Some(c);
        for other in (0..inner).filter(|other| *other != r) {
            let factor = rates[other][c];
            if factor != 0.0 {
                let [own, by] = [rates[r].clone(), mixed[r].clone()];
                rates[other].iter_mut().zip(own).for_each(|(entry, own)| *entry -= factor * own);
                rates[other][c] = 0.0;
                mixed[other].iter_mut().zip(by).for_each(|(entry, own)| *entry -= factor * own);
            }
        }
    }
    let dynamic: Vec<(usize, usize)> = of.iter().enumerate().filter_map(|(r, c)| c.map(|c| (r, c))).collect();
    let still: Vec<usize> = (0..inner).filter(|&r| of[r].is_none()).collect();
    let follow: Vec<usize> = (0..inner).filter(|c| dynamic.iter().all(|(_, own)| own != c)).collect();
    let count = 2 * free + dynamic.len() + branches.len();
    let (first_inner, first_memory) = (2 * free, 2 * free + dynamic.len());
    // Inner unknowns by states and by those that follow: y_c = ỹ_c − Σ G y_f.
    let bent = |c: usize| -> Vec<f64> {
        let own = dynamic.iter().position(|(_, own)| *own == c);
        match own {
            Some(k) => follow.iter().map(|&f| -rates[dynamic[k].0][f]).collect(),
            None => follow.iter().map(|&f| f64::from(u8::from(f == c))).collect(),
        }
    };
    // A combination of rows by states, by unknowns that follow, and by inputs and their derivatives; rates of inner unknowns apart.
    let combined = |weights: &[(usize, f64)]| {
        let (mut by, mut by_follow) = (vec![0.0; count], vec![0.0; follow.len()]);
        let mut by_inputs: [Vec<f64>; ORDERS] = std::array::from_fn(|_| vec![0.0; inputs]);
        for &(r, weight) in weights {
            let Rational { by: columns, memories } = &rows[r];
            for k in 0..free {
                by[k] += weight * columns[0][k];
                by[free + k] += weight * columns[1][k];
            }
            for c in 0..inner {
                let entry = weight * columns[0][free + c];
                if let Some(k) = dynamic.iter().position(|(_, own)| *own == c) {
                    by[first_inner + k] += entry;
                }
                by_follow.iter_mut().zip(bent(c)).for_each(|(sum, bent)| *sum += entry * bent);
            }
            by[first_memory..].iter_mut().zip(memories).for_each(|(sum, own)| *sum += weight * own);
            for (order, by_input) in by_inputs.iter_mut().take(3).enumerate() {
                by_input.iter_mut().zip(&columns[order][size..]).for_each(|(sum, own)| *sum += weight * own);
            }
        }
        (by, by_follow, by_inputs)
    };
    let of_inner = |r: usize| -> Vec<(usize, f64)> {
        mixed[r]
            .iter()
            .enumerate()
            .filter(|(_, weight)| **weight != 0.0)
            .map(|(k, weight)| (free + k, *weight))
            .collect()
    };
    // What follows: 0 = A_2 x + A_22 y + Σ B u^(k).
    let mut following = Map::new(follow.len(), count, inputs);
    if !follow.is_empty() {
        let lines: Vec<_> = still.iter().map(|&r| combined(&of_inner(r))).collect();
        let m = follow.len();
        let mut lu = Lu::default();
        let scales: Vec<f64> =
            lines.iter().map(|(_, own, _)| own.iter().fold(0.0, |most: f64, x| most.max(x.abs()))).collect();
        if !lu.factor(m, |entries| (0..m * m).for_each(|k| entries[k] = lines[k / m].1[k % m] / scales[k / m])) {
            return None;
        }
        let mut solve = |of: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let mut column: Vec<f64> = (0..m).map(|r| -of(r) / scales[r]).collect();
            lu.solve(&mut column);
            column
        };
        for c in 0..count {
            solve(&|r| lines[r].0[c]).into_iter().enumerate().for_each(|(r, x)| following.by[r][c] = x);
        }
        for order in 0..3 {
            for i in 0..inputs {
                let column = solve(&|r| lines[r].2[order][i]);
                column.into_iter().enumerate().for_each(|(r, x)| following.inputs[order][r][i] = x);
            }
        }
    }
    // E x' = right.
    let mut left = zeros(count, count);
    let mut right = Map::new(count, count, inputs);
    for k in 0..free {
        left[k][k] = 1.0;
        right.by[k][free + k] = 1.0;
    }
    for (at, weights, is_mass) in (0..free)
        .map(|k| (free + k, vec![(k, 1.0)], true))
        .chain(dynamic.iter().enumerate().map(|(k, &(r, _))| (first_inner + k, of_inner(r), false)))
    {
        let (by, by_follow, by_inputs) = combined(&weights);
        right.by[at].iter_mut().zip(by).for_each(|(sum, own)| *sum -= own);
        for (order, own) in by_inputs.iter().enumerate() {
            right.inputs[order][at].iter_mut().zip(own).for_each(|(sum, own)| *sum -= own);
        }
        by_follow.iter().enumerate().for_each(|(f, factor)| right.add(at, -factor, &following, f));
        if !is_mass {
            left[at][at] = 1.0;
            continue;
        }
        let Rational { by, .. } = &rows[at - free];
        (0..free).for_each(|k| left[at][free + k] += by[2][k]);
        for c in 0..inner {
            let factor = by[1][free + c];
            if let Some(k) = dynamic.iter().position(|(_, own)| *own == c) {
                left[at][first_inner + k] += factor;
            }
            for (f, bent) in bent(c).into_iter().enumerate().filter(|(_, bent)| factor * bent != 0.0) {
                left[at].iter_mut().zip(&following.by[f]).for_each(|(sum, own)| *sum += factor * bent * own);
                for order in 1..ORDERS {
                    let own = following.inputs[order - 1][f].clone();
                    right.inputs[order][at].iter_mut().zip(own).for_each(|(sum, own)| *sum -= factor * bent * own);
                }
            }
        }
    }
    let column = |c: usize| -> Map {
        // A column of the assembly by states.
        let mut map = Map::new(1, count, inputs);
        if c < free {
            map.by[0][c] = 1.0;
        } else if c < size {
            let own = c - free;
            if let Some(k) = dynamic.iter().position(|(_, pivot)| *pivot == own) {
                map.by[0][first_inner + k] = 1.0;
            }
            bent(own).into_iter().enumerate().for_each(|(f, bent)| map.add(0, bent, &following, f));
        } else {
            map.inputs[0][0][c - size] = 1.0;
        }
        map
    };
    let columns: Vec<Map> = (0..assembly.columns()).map(column).collect();
    for (k, (springpot, pole)) in branches.iter().enumerate() {
        let at = first_memory + k;
        left[at][at] = 1.0;
        right.by[at][at] -= pole;
        for (c, stroke) in springpot.stroke.iter().enumerate() {
            right.add(at, pole * stroke, &columns[c], 0);
        }
    }
    let rate = solved(&left, &right)?;
    let velocity = columns.iter().map(|column| column.rate(&rate)).collect::<Vec<_>>();
    let mut seen = Map::new(outputs.len(), count, inputs);
    for (o, row) in outputs.iter().enumerate() {
        let Rational { by, memories } = rational(assembly, row, powers);
        for c in 0..columns.len() {
            seen.add(o, by[0][c], &columns[c], 0);
            seen.add(o, by[1][c], &velocity[c], 0);
            if by[2][c] != 0.0 {
                seen.add(o, by[2][c], &velocity[c].rate(&rate), 0);
            }
        }
        seen.by[o][first_memory..].iter_mut().zip(&memories).for_each(|(sum, own)| *sum += own);
    }
    let mut states: Vec<State> = Vec::with_capacity(count);
    let named = |kind: StateKind, owner: Owner| State { kind, owner };
    states.extend(assembly.unknowns[..free].iter().map(|own| named(StateKind::Position, *own)));
    states.extend(assembly.unknowns[..free].iter().map(|own| named(StateKind::Velocity, *own)));
    states.extend(dynamic.iter().map(|(_, c)| named(StateKind::Inner, assembly.unknowns[free + c])));
    let of_integral = |stroke: &[f64]| {
        let is_integral =
            |(c, own): (usize, &f64)| *own != 0.0 && matches!(assembly.unknowns.get(c), Some(Owner::Controller(_)));
        stroke.iter().enumerate().any(is_integral)
    };
    states.extend(branches.iter().map(|(springpot, _)| {
        let kind = if of_integral(&springpot.stroke) { StateKind::MemoryOfIntegral } else { StateKind::Memory };
        named(kind, springpot.owner)
    }));
    Some(without_rates(rate, seen, states))
}

/// E⁻¹ times the right side.
fn solved(left: &[Vec<f64>], right: &Map) -> Option<Map> {
    let (n, inputs) = (left.len(), right.inputs[0].first().map_or(0, Vec::len));
    let mut lu = Lu::default();
    if !lu.factor(n, |entries| {
        entries.chunks_exact_mut(n.max(1)).zip(left).for_each(|(to, from)| to.copy_from_slice(from))
    }) {
        return None;
    }
    let mut all = Map::new(n, n, inputs);
    for c in 0..n {
        let mut column: Vec<f64> = right.by.iter().map(|row| row[c]).collect();
        lu.solve(&mut column);
        column.into_iter().enumerate().for_each(|(r, x)| all.by[r][c] = x);
    }
    for order in 0..ORDERS {
        for i in 0..inputs {
            let mut column: Vec<f64> = right.inputs[order].iter().map(|row| row[i]).collect();
            lu.solve(&mut column);
            column.into_iter().enumerate().for_each(|(r, x)| all.inputs[order][r][i] = x);
        }
    }
    let finite = |rows: &[Vec<f64>]| rows.iter().flatten().all(|entry| entry.is_finite());
    (finite(&all.by) && all.inputs.iter().all(|rows| finite(rows))).then_some(all)
}

/// x = x̃ + B_k u^(k−1) takes the derivatives of inputs out of x', the highest first.
fn without_rates(rate: Map, seen: Map, states: Vec<State>) -> Realised {
    let (a, mut b) = (rate.by, rate.inputs);
    let (c, mut d) = (seen.by, seen.inputs);
    for order in (1..ORDERS).rev() {
        let moved = std::mem::replace(&mut b[order], zeros(0, 0));
        for (matrix, target) in [(&a, &mut b[order - 1]), (&c, &mut d[order - 1])] {
            for (row, sum) in matrix.iter().zip(target) {
                for (factor, moved) in row.iter().zip(&moved) {
                    sum.iter_mut().zip(moved).for_each(|(sum, moved)| *sum += factor * moved);
                }
            }
        }
    }
    let [b, ..] = b;
    Realised { a, b, c, d, states }
}
