//! The equations of small motions with strokes inside series, inputs that follow from the state and integrals as unknowns of their own, and
//! what is observed of them: polynomials of s and powers of it, nothing else.

use super::linearisation::Linearisation;
use super::response::Excitation;
use crate::law::{Tangent, Term};
use num_complex::Complex64;

/// Σ_k s^k by_k·x + Σ_j weight_j s^α_j (stroke_j·x): a force, or something observed.
#[derive(Debug, Clone, Default)]
pub(super) struct Row {
    pub(super) by: [Vec<f64>; 3],
    /// By the springpots of the assembly; those behind its end count for nothing.
    pub(super) springpots: Vec<f64>,
}

/// s^order of a stroke.
#[derive(Debug, Clone)]
pub(super) struct Springpot {
    pub(super) order: f64,
    /// Over the columns.
    pub(super) stroke: Vec<f64>,
    pub(super) owner: Owner,
}

/// To whom an unknown or a springpot belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Owner {
    /// A velocity that forces move.
    Velocity(usize),
    /// An element.
    Element(usize),
    /// The controller of a velocity.
    Controller(usize),
    /// The filter of its derivative.
    Filter(usize),
}

/// A leaf of a law under small motions.
#[derive(Debug, Clone)]
pub(super) struct Leaf {
    pub(super) order: f64,
    pub(super) stroke: Row,
    pub(super) force: Row,
    pub(super) derivative: Row,
}

/// T(s) x + U(s) u = 0 with x the unknowns and u what is excited.
#[derive(Debug, Clone)]
pub(super) struct Assembly<'a> {
    pub(super) linear: &'a Linearisation,
    /// To whom each unknown belongs: coordinates that forces move first.
    pub(super) unknowns: Vec<Owner>,
    pub(super) excitations: Vec<Excitation>,
    /// An equation for each unknown.
    pub(super) rows: Vec<Row>,
    pub(super) springpots: Vec<Springpot>,
    /// Of every velocity, the force that its actuator needs, and what its controller says.
    pub(super) needed: Vec<Row>,
    pub(super) said: Vec<Row>,
    pub(super) forces: Vec<Row>,
    pub(super) leaves: Vec<Vec<Leaf>>,
}

/// What laws are assembled as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Parts {
    /// As few as it takes: no leaves are told.
    Reduced,
    /// All of them.
    All,
}

impl Row {
    fn new(columns: usize) -> Self {
        Self { by: std::array::from_fn(|_| vec![0.0; columns]), springpots: Vec::new() }
    }

    /// factor·s^power of column `column`.
    fn unit(columns: usize, power: usize, column: Option<usize>, factor: f64) -> Self {
        let mut row = Self::new(columns);
        column.into_iter().for_each(|column| row.by[power][column] = factor);
        row
    }

    fn add(&mut self, factor: f64, other: &Self) {
        if factor == 0.0 {
            return;
        }
        for (sum, own) in self.by.iter_mut().zip(&other.by) {
            sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += factor * own);
        }
        self.springpots.resize(self.springpots.len().max(other.springpots.len()), 0.0);
        self.springpots.iter_mut().zip(&other.springpots).for_each(|(sum, own)| *sum += factor * own);
    }

    /// Its value where the columns have these values.
    pub(super) fn times(
        &self,
        s: Complex64,
        springpots: &[Springpot],
        powers: &[Complex64],
        columns: &[Complex64],
    ) -> Complex64 {
        self.at(s, springpots, powers).iter().zip(columns).map(|(row, column)| row * column).sum()
    }

    /// s times the row; `None` where that is no such row.
    pub(super) fn rate(&self) -> Option<Self> {
        let [zeroth, first, second] = &self.by;
        let is_plain = second.iter().chain(&self.springpots).all(|entry| *entry == 0.0);
        is_plain.then(|| Self { by: [vec![0.0; zeroth.len()], zeroth.clone(), first.clone()], springpots: Vec::new() })
    }

    /// Over the columns, where springpots are `powers` of s.
    pub(super) fn at(&self, s: Complex64, springpots: &[Springpot], powers: &[Complex64]) -> Vec<Complex64> {
        let [zeroth, first, second] = &self.by;
        let polynomial = |c: usize| s * (s * second[c] + first[c]) + zeroth[c];
        let mut row: Vec<Complex64> = (0..zeroth.len()).map(polynomial).collect();
        for ((weight, springpot), power) in self.springpots.iter().zip(springpots).zip(powers) {
            if *weight != 0.0 {
                row.iter_mut().zip(&springpot.stroke).for_each(|(sum, stroke)| *sum += power * (weight * stroke));
            }
        }
        row
    }
}

impl<'a> Assembly<'a> {
    /// The equations under `excitations`; with `opened`, what the controller says of that velocity does not reach it.
    pub(super) fn new(
        linear: &'a Linearisation,
        excitations: &[Excitation],
        parts: Parts,
        opened: Option<usize>,
    ) -> Self {
        let (n, control) = (linear.left_over.len(), &linear.control);
        let reads_inputs = |e: usize| {
            let excites = |excitation: &Excitation| matches!(excitation, Excitation::Input(own, _) if *own == e);
            control.inputs.iter().any(|own| own.element == e) || excitations.iter().any(excites)
        };
        let tangent = |e: usize| match parts {
            Parts::Reduced if !reads_inputs(e) => linear.elements[e].tangent.reduced(),
            _ => linear.elements[e].tangent.clone(),
        };
        let tangents: Vec<Tangent> = (0..linear.elements.len()).map(tangent).collect();
        let mut unknowns: Vec<Owner> = linear.free.iter().map(|&k| Owner::Velocity(k)).collect();
        let mut first = Vec::new();
        for (e, tangent) in tangents.iter().enumerate() {
            first.push(unknowns.len());
            unknowns.extend((0..inner(tangent)).map(|_| Owner::Element(e)));
        }
        let fed = unknowns.len();
        unknowns.extend(control.inputs.iter().map(|own| Owner::Element(own.element)));
        let integrals = unknowns.len();
        unknowns.extend(control.kept().map(|term| match term.order > 0.0 {
            true => Owner::Filter(term.velocity),
            false => Owner::Controller(term.velocity),
        }));
        let size = unknowns.len();
        let mut builder = Builder { columns: size + excitations.len(), springpots: Vec::new() };
        let columns = builder.columns;
        let excited = |what: Excitation| excitations.iter().position(|own| *own == what).map(|k| size + k);
        // Where the coordinate of a velocity stands, if it moves.
        let place = |k: usize| linear.free.iter().position(|free| *free == k).or(excited(Excitation::Motion(k)));
        let over_velocities = |matrices: &[(&[f64], usize)]| {
            let mut row = Row::new(columns);
            for (line, power) in matrices {
                for (k, entry) in line.iter().enumerate().filter(|(_, entry)| **entry != 0.0) {
                    place(k).into_iter().for_each(|column| row.by[*power][column] += entry);
                }
            }
            row
        };
        let (mut forces, mut leaves) = (Vec::new(), Vec::new());
        let mut rows = vec![Row::new(columns); size];
        for (e, (element, tangent)) in linear.elements.iter().zip(&tangents).enumerate() {
            let inputs = |i: usize| -> Vec<usize> {
                let own = control.inputs.iter().position(|own| (own.element, own.input) == (e, i));
                own.map(|k| fed + k).into_iter().chain(excited(Excitation::Input(e, i))).collect()
            };
            let mut stroke = over_velocities(&[(&element.gradient, 0)]).by[0].clone();
            if let Some((input, stretch)) = element.stretch {
                inputs(input).into_iter().for_each(|column| stroke[column] += stretch);
            }
            let mut told = Vec::new();
            let mut law = OfLaw { builder: &mut builder, next: first[e], e, inputs: &inputs, told: &mut told };
            let force = law.add(tangent, &stroke, &mut rows);
            forces.push(force);
            leaves.push(told);
        }
        let line = |matrix: &'a [f64], k: usize| matrix.get(k * n..(k + 1) * n).unwrap_or_default();
        let mut needed: Vec<Row> = (0..n)
            .map(|k| {
                let own = [(line(&linear.stiffness, k), 0), (line(&linear.damping, k), 1), (line(&linear.mass, k), 2)];
                let mut row = over_velocities(&own);
                linear.elements.iter().zip(&forces).for_each(|(element, force)| row.add(element.gradient[k], force));
                row
            })
            .collect();
        needed.iter_mut().for_each(|row| row.springpots.resize(builder.springpots.len(), 0.0));
        let mut said: Vec<Row> = (0..n)
            .map(|k| {
                let mut row = over_velocities(&[(line(&control.by_q, k), 0), (line(&control.by_v, k), 1)]);
                if control.relieved.get(k) == Some(&true) {
                    for (element, force) in linear.elements.iter().zip(&forces) {
                        row.add(element.gradient[k], force);
                        let bends = over_velocities(&[(&element.hessian[k * n..(k + 1) * n], 0)]);
                        row.add(element.force, &bends);
                    }
                }
                for aim in &control.aims {
                    let column = excited(Excitation::Reference(aim.velocity));
                    (0..3).for_each(|power| row.add(1.0, &Row::unit(columns, power, column, aim.torque[power][k])));
                }
                row
            })
            .collect();
        let mut integral = integrals;
        for term in &control.terms {
            let k = term.velocity;
            let mut error = Row::unit(columns, 0, place(k), -1.0);
            if term.order < 0.0 || !control.on_measurement {
                error.add(1.0, &Row::unit(columns, 0, excited(Excitation::Reference(k)), 1.0));
            }
            let [error, ..] = error.by;
            let owner = Owner::Controller(k);
            if term.order > 0.0 {
                let own = builder.leaf(Term { coefficient: term.gain, order: term.order }, &error, owner);
                let Some(time) = control.filter else {
                    said[k].add(1.0, &own);
                    continue;
                };
                // T·y' + y = gain·D^order e.
                said[k].add(1.0, &Row::unit(columns, 0, Some(integral), 1.0));
                rows[integral].add(1.0, &Row::unit(columns, 0, Some(integral), 1.0));
                rows[integral].add(time, &Row::unit(columns, 1, Some(integral), 1.0));
                rows[integral].add(-1.0, &own);
                integral += 1;
                continue;
            }
            // gain·D^(1 + order) z with z' = e.
            let z = Row::unit(columns, 0, Some(integral), 1.0);
            let own = builder.leaf(Term { coefficient: term.gain, order: 1.0 + term.order }, &z.by[0], owner);
            said[k].add(1.0, &own);
            rows[integral].add(term.gain, &Row::unit(columns, 1, Some(integral), 1.0));
            rows[integral].by[0].iter_mut().zip(&error).for_each(|(sum, error)| *sum -= term.gain * error);
            integral += 1;
        }
        for (f, own) in control.inputs.iter().enumerate() {
            let follows = over_velocities(&[(&own.by_q, 0), (&own.by_v, 1)]);
            rows[fed + f] = Row::unit(columns, 0, Some(fed + f), 1.0);
            rows[fed + f].add(-1.0, &follows);
        }
        for (r, &k) in linear.free.iter().enumerate() {
            rows[r].add(1.0, &needed[k]);
            if opened != Some(k) {
                rows[r].add(-1.0, &said[k]);
            }
            rows[r].add(-1.0, &Row::unit(columns, 0, excited(Excitation::Torque(k)), 1.0));
        }
        let springpots = builder.springpots;
        Self { linear, unknowns, excitations: excitations.to_vec(), rows, springpots, needed, said, forces, leaves }
    }

    /// All columns: unknowns, and what is excited.
    pub(super) fn columns(&self) -> usize {
        self.unknowns.len() + self.excitations.len()
    }

    /// The column of the coordinate of velocity `k`; `None` where it stands still.
    pub(super) fn place(&self, k: usize) -> Option<usize> {
        let free = self.linear.free.iter().position(|free| *free == k);
        free.or_else(|| self.excited(Excitation::Motion(k)))
    }

    fn excited(&self, what: Excitation) -> Option<usize> {
        self.excitations.iter().position(|own| *own == what).map(|k| self.unknowns.len() + k)
    }

    /// The columns in which input `i` of element `e` is: where it follows from the state, and where it is excited.
    pub(super) fn input(&self, e: usize, i: usize) -> impl Iterator<Item = usize> {
        let fed: Vec<usize> = {
            let integrals = self.linear.control.kept().count();
            let first = self.unknowns.len() - integrals - self.linear.control.inputs.len();
            let own = self.linear.control.inputs.iter().position(|own| (own.element, own.input) == (e, i));
            own.map(|k| first + k).into_iter().collect()
        };
        fed.into_iter().chain(self.excited(Excitation::Input(e, i)))
    }

    /// A row of the coordinates of velocities: `weights` (nv) of s^power of them.
    pub(super) fn of_velocities(&self, weights: &[f64], power: usize) -> Row {
        let mut row = Row::new(self.columns());
        for (k, weight) in weights.iter().enumerate() {
            self.place(k).into_iter().for_each(|column| row.by[power][column] += weight);
        }
        row
    }

    /// The sum of rows with factors.
    pub(super) fn sum<'r>(&self, rows: impl IntoIterator<Item = (f64, &'r Row)>) -> Row {
        let mut sum = Row::new(self.columns());
        rows.into_iter().for_each(|(factor, row)| sum.add(factor, row));
        sum
    }

    /// Factor times what is in a column.
    pub(super) fn of_columns(&self, columns: impl IntoIterator<Item = usize>) -> Row {
        let mut row = Row::new(self.columns());
        columns.into_iter().for_each(|column| row.by[0][column] += 1.0);
        row
    }

    /// The powers of the springpots.
    pub(super) fn powers(&self, s: Complex64) -> Vec<Complex64> {
        self.springpots.iter().map(|own| s.powf(own.order)).collect()
    }

    /// What all columns are for a unit of each excitation, where the springpots answer with `powers`: of excitation k the k-th.
    pub(super) fn solve(&self, s: Complex64, powers: &[Complex64]) -> Vec<Vec<Complex64>> {
        let (size, columns) = (self.unknowns.len(), self.columns());
        let (mut matrix, mut right) = (Vec::with_capacity(size * size), vec![Vec::new(); columns - size]);
        for row in &self.rows {
            let row = row.at(s, &self.springpots, powers);
            matrix.extend_from_slice(&row[..size]);
            right.iter_mut().zip(&row[size..]).for_each(|(right, entry)| right.push(-entry));
        }
        let lu = crate::linalg::ComplexLu::new(size, matrix);
        let whole = |(k, right): (usize, &Vec<Complex64>)| {
            let mut x = lu.solve(right);
            x.resize(columns, Complex64::ZERO);
            x[size + k] = Complex64::ONE;
            x
        };
        right.iter().enumerate().map(whole).collect()
    }
}

/// What is common to all laws while they are added.
struct Builder {
    columns: usize,
    springpots: Vec<Springpot>,
}

impl Builder {
    /// The force of c·s^order under a stroke.
    fn leaf(&mut self, term: Term, stroke: &[f64], owner: Owner) -> Row {
        let mut force = Row::new(self.columns);
        if term.order == 0.0 || term.order == 1.0 {
            let by = &mut force.by[usize::from(term.order == 1.0)];
            by.iter_mut().zip(stroke).for_each(|(entry, stroke)| *entry = term.coefficient * stroke);
            return force;
        }
        if term.coefficient == 0.0 {
            return force;
        }
        let (springpot, factor) = self.springpot(term.order, stroke, owner);
        force.springpots = vec![0.0; springpot + 1];
        force.springpots[springpot] = term.coefficient * factor;
        force
    }

    /// The springpot of a stroke and by how much it is to be multiplied: those of one order and of proportional strokes are one.
    fn springpot(&mut self, order: f64, stroke: &[f64], owner: Owner) -> (usize, f64) {
        let largest = (0..stroke.len()).max_by(|&a, &b| stroke[a].abs().total_cmp(&stroke[b].abs())).unwrap_or(0);
        let is_multiple = |own: &Springpot| {
            let factor = stroke[largest] / own.stroke[largest];
            let same = own.stroke.iter().zip(stroke).all(|(own, new)| own * factor == *new);
            (own.order == order && factor.is_finite() && factor != 0.0 && same).then_some(factor)
        };
        let found = self.springpots.iter().enumerate().find_map(|(k, own)| is_multiple(own).map(|factor| (k, factor)));
        found.unwrap_or_else(|| {
            self.springpots.push(Springpot { order, stroke: stroke.to_vec(), owner });
            (self.springpots.len() - 1, 1.0)
        })
    }
}

/// A law while it is added.
struct OfLaw<'b> {
    builder: &'b mut Builder,
    /// The next stroke inside series.
    next: usize,
    e: usize,
    inputs: &'b dyn Fn(usize) -> Vec<usize>,
    told: &'b mut Vec<Leaf>,
}

impl OfLaw<'_> {
    /// The force of a part under `stroke`; of parts in series all but the last have strokes of their own, whose balance is in `rows`.
    fn add(&mut self, tangent: &Tangent, stroke: &[f64], rows: &mut [Row]) -> Row {
        let columns = self.builder.columns;
        let plain = |stroke: &[f64]| {
            let mut row = Row::new(columns);
            row.by[0].copy_from_slice(stroke);
            row
        };
        match tangent {
            Tangent::Leaf(term, source) => {
                let mut force = self.builder.leaf(*term, stroke, Owner::Element(self.e));
                let unit = Term { coefficient: 1.0, order: term.order };
                let derivative = if term.coefficient == 0.0 || term.order == 0.0 {
                    plain(stroke)
                } else {
                    self.builder.leaf(unit, stroke, Owner::Element(self.e))
                };
                if let Some((input, gain)) = source {
                    (self.inputs)(*input).into_iter().for_each(|column| force.by[0][column] += gain);
                }
                self.told.push(Leaf { order: term.order, stroke: plain(stroke), force: force.clone(), derivative });
                force
            }
            Tangent::Whole(parts) => {
                let before = self.told.len();
                let force = self.add(parts, stroke, rows);
                self.told.truncate(before);
                let [own, derivative] = [plain(stroke), plain(stroke)];
                self.told.push(Leaf { order: 0.0, stroke: own, force: force.clone(), derivative });
                force
            }
            Tangent::Parallel(parts) => {
                let mut sum = Row::new(columns);
                for part in parts {
                    let own = self.add(part, stroke, rows);
                    sum.add(1.0, &own);
                }
                sum
            }
            Tangent::Series(parts) => {
                let Some((last, others)) = parts.split_last() else { return Row::new(columns) };
                let mut rest = stroke.to_vec();
                let mut each = Vec::new();
                for part in others {
                    let mut own = vec![0.0; columns];
                    let place = self.next;
                    own[place] = 1.0;
                    rest[place] -= 1.0;
                    self.next += 1;
                    each.push((place, self.add(part, &own, rows)));
                }
                let force = self.add(last, &rest, rows);
                for (place, own) in each {
                    rows[place].add(1.0, &own);
                    rows[place].add(-1.0, &force);
                }
                force
            }
        }
    }
}

/// Unknowns inside a law.
fn inner(tangent: &Tangent) -> usize {
    match tangent {
        Tangent::Leaf(..) => 0,
        Tangent::Whole(parts) => inner(parts),
        Tangent::Parallel(parts) => parts.iter().map(inner).sum(),
        Tangent::Series(parts) => parts.len().saturating_sub(1) + parts.iter().map(inner).sum::<usize>(),
    }
}
