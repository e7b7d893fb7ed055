//! A robot of which joints may stand still, in several states side by side: how the inverse dynamics answer to the motion and to what inertias and gravity
//! change, and two derivatives of distances.
//!
//! Lanes here do not join products and sums, so that every state has the bits that it has alone, on every processor.

use super::forces::pair::{pair_hessian_of_moving, pair_into};
use super::kinematics::Kinematics;
use super::regressor::{LinkMotion, add_gravity_efforts, add_inertia_efforts};
use super::rnea_derivatives::{RneaDerivatives, Weighed, rnea_derivatives_of_moving, weigh_places};
use super::workspace::Workspace;
use crate::model::{Model, Site};
use crate::spatial::columns::Rows;
use crate::spatial::dispatch::Task;
#[cfg(target_arch = "x86_64")]
use crate::spatial::lanes::Apart4;
use crate::spatial::{Inertia, Scalar, SimdLevel, Vec3};

/// What is asked of a robot.
#[derive(Debug, Default)]
pub(crate) struct Sought {
    /// Which velocities move; the other joints stand where they are neutral.
    pub(crate) moves: Vec<bool>,
    /// By how much inertias change, joint by joint.
    pub(crate) links: Vec<(usize, Vec<Inertia>)>,
    /// By how much gravity changes, m/s², world axes.
    pub(crate) fields: Vec<[f64; 3]>,
    /// Points whose distances are asked for, and which they are among all measures.
    pub(crate) lines: Vec<(usize, [Site; 2])>,
}

/// q (nq), v and a (nv).
type State<'a> = [&'a [f64]; 3];

/// What is found in one state, in the rows of the velocities that move: other rows stay.
pub(crate) struct Found<'a> {
    pub(crate) slopes: &'a mut RneaDerivatives,
    /// nv × [`Sought::changes`].
    pub(crate) efforts: &'a mut [f64],
    /// Of every measure: y and y', ∂y/∂q and ∂y'/∂q, ∂²y/∂q².
    pub(crate) readings: &'a mut [[f64; 2]],
    pub(crate) gradients: &'a mut [[Vec<f64>; 2]],
    pub(crate) hessians: &'a mut [Vec<f64>],
}

impl Sought {
    /// How many changes of inertias and gravity there are.
    pub(crate) fn changes(&self) -> usize {
        self.links.iter().map(|(_, changes)| changes.len()).sum::<usize>() + self.fields.len()
    }

    /// ∂τ/∂q, ∂τ/∂v, ∂τ/∂a as [`rnea_derivatives_of_moving`] has them, and by each change into rows of as many numbers, those of links first.
    #[inline(always)]
    pub(crate) fn slopes_into<T: Scalar>(
        &self,
        model: &Model,
        kinematics: &Kinematics<T>,
        a: &[T],
        workspace: &mut Workspace<T>,
        (slopes, efforts): (&mut RneaDerivatives<T>, &mut [T]),
    ) {
        rnea_derivatives_of_moving(model, kinematics, a, &self.moves, workspace, slopes);
        let (count, mut first) = (self.changes(), 0);
        if count == 0 {
            return;
        }
        for row in 0..self.moves.len() {
            if self.moves[row] {
                efforts[row * count..(row + 1) * count].fill(T::ZERO);
            }
        }
        for (joint, changes) in &self.links {
            let wanted = |k: usize| self.moves[k];
            add_inertia_efforts(model, kinematics, workspace, (*joint, changes), wanted, (efforts, count, first));
            first += changes.len();
        }
        add_gravity_efforts(model, workspace, &self.fields, |k| self.moves[k], (efforts, count, first));
    }
}

/// What states are worked out in.
#[derive(Debug)]
pub(crate) struct Abreast {
    pub(crate) sought: Sought,
    lanes: Lanes,
    /// Numbers of states, row by row.
    rows: Vec<f64>,
}

#[derive(Debug)]
enum Lanes {
    One(Box<Room<f64>>),
    #[cfg(target_arch = "x86_64")]
    Four(Box<Room<Apart4>>),
}

#[derive(Debug)]
struct Room<T> {
    state: [Vec<T>; 3],
    kinematics: Kinematics<T>,
    workspace: Workspace<T>,
    slopes: RneaDerivatives<T>,
    efforts: Vec<T>,
    gradient: Vec<T>,
    bend: Vec<T>,
    hessian: Vec<T>,
    /// What is weighed: weights, what they carry, and sums.
    weights: Vec<T>,
    weighed: Weighed<T>,
    sums: Vec<T>,
}

/// A room, in which kinematics stand at once.
struct Make<'a, T> {
    model: &'a Model,
    changes: usize,
    made: &'a mut Option<Box<Room<T>>>,
}

impl<T: Rows> Task for Make<'_, T> {
    #[inline(always)]
    fn run(self) {
        let Self { model, changes, made } = self;
        let n = model.nv();
        let zeros = |count: usize| vec![T::ZERO; count];
        *made = Some(Box::new(Room {
            state: [zeros(model.nq()), zeros(n), zeros(n)],
            kinematics: Kinematics::neutral(model),
            workspace: Workspace::new(model),
            slopes: RneaDerivatives::new(model),
            efforts: zeros(n * changes),
            gradient: zeros(n),
            bend: zeros(n),
            hessian: zeros(n * n),
            weights: Vec::new(),
            weighed: Weighed::of_nothing(),
            sums: Vec::new(),
        }));
    }
}

fn make<T: Rows>(model: &Model, changes: usize) -> Box<Room<T>> {
    let mut made = None;
    T::enter(Make { model, changes, made: &mut made });
    made.expect("the task is run")
}

impl Abreast {
    /// For `model`, as many states at a time as the level has lanes, four at most.
    pub(crate) fn new(model: &Model, sought: Sought) -> Self {
        Self::at(model, sought, SimdLevel::chosen().unwrap_or(SimdLevel::Baseline))
    }

    fn at(model: &Model, sought: Sought, level: SimdLevel) -> Self {
        let changes = sought.changes();
        let lanes = match level {
            #[cfg(target_arch = "x86_64")]
            SimdLevel::Avx2 | SimdLevel::Avx512 => Lanes::Four(make(model, changes)),
            _ => Lanes::One(make(model, changes)),
        };
        Self { sought, lanes, rows: Vec::new() }
    }

    /// Works out what is asked in all `states`.
    pub(crate) fn see(&mut self, model: &Model, states: &[State], found: &mut [Found]) {
        let Self { sought, lanes, rows } = self;
        match lanes {
            Lanes::One(room) => f64::enter(All { model, sought, room, rows, states, found }),
            #[cfg(target_arch = "x86_64")]
            Lanes::Four(room) => Apart4::enter(All { model, sought, room, rows, states, found }),
        }
    }
}

/// What M numbers weigh in a state, one row of numbers a state.
pub(crate) struct Weights<'a> {
    /// M.
    pub(crate) count: usize,
    /// M for the effort of each velocity; for each line M for its length, M for its rate, and its force.
    pub(crate) rows: &'a [f64],
}

impl Sought {
    /// How many numbers a row of [`Weights`] has.
    pub(crate) fn weights(&self, count: usize) -> usize {
        self.moves.len() * count + self.lines.len() * (2 * count + 1)
    }

    /// How many sums [`Abreast::weigh`] makes.
    pub(crate) fn sums(&self, count: usize) -> usize {
        (self.moves.len() + self.changes()) * count
    }
}

impl Abreast {
    /// Adds what all `states` have in sum of Σ μ τ + s y + r y', τ with the forces of the lines, by each velocity that stands still, and by each change:
    /// M numbers each.
    pub(crate) fn weigh(&mut self, model: &Model, states: &[State], weights: &Weights, sums: &mut [f64]) {
        let Self { sought, lanes, rows } = self;
        match lanes {
            Lanes::One(room) => f64::enter(Weigh { model, sought, room, rows, states, weights, sums }),
            #[cfg(target_arch = "x86_64")]
            Lanes::Four(room) => Apart4::enter(Weigh { model, sought, room, rows, states, weights, sums }),
        }
    }
}

/// [`Abreast::weigh`].
struct Weigh<'a, 's, T> {
    model: &'a Model,
    sought: &'a Sought,
    room: &'a mut Room<T>,
    rows: &'a mut Vec<f64>,
    states: &'a [State<'s>],
    weights: &'a Weights<'a>,
    sums: &'a mut [f64],
}

impl<T: Rows> Task for Weigh<'_, '_, T> {
    #[inline(always)]
    fn run(self) {
        let Self { model, sought, room, rows, states, weights: Weights { count, rows: weights }, sums } = self;
        let (n, count, moves) = (model.nv(), *count, &sought.moves[..]);
        let width = sought.weights(count);
        room.weights.resize(width, T::ZERO);
        room.sums.resize(sought.sums(count), T::ZERO);
        rows.resize(rows.len().max(T::COUNT * model.nq().max(n).max(room.sums.len())), 0.0);
        let mut first = 0;
        while first < states.len() {
            let here = T::COUNT.min(states.len() - first);
            read(&mut room.state, rows, &states[first..first + here]);
            T::read(&weights[first * width..(first + here) * width], here, &mut room.weights);
            room.sums.fill(T::ZERO);
            let ([q, v, a], (own, of_lines)) = (&room.state, room.weights.split_at(n * count));
            let (by_place, by_change) = room.sums.split_at_mut(n * count);
            room.kinematics.update_velocity_of_moving(model, q, v, moves);
            let standing = (moves, &mut room.workspace);
            weigh_places(model, &room.kinematics, a, standing, (own, count), &mut room.weighed, by_place);
            let mut changes = by_change.chunks_exact_mut(count);
            for (joint, inertias) in &sought.links {
                let link = LinkMotion::of(&room.kinematics, &room.workspace, *joint);
                for (inertia, sums) in inertias.iter().zip(changes.by_ref()) {
                    for (sum, along) in sums.iter_mut().zip(&room.weighed.motions[(joint + 1) * count..]) {
                        link.add_along(*along, std::slice::from_ref(inertia), std::iter::once(sum));
                    }
                }
            }
            for (field, sums) in sought.fields.iter().zip(changes) {
                for (sum, momentum) in sums.iter_mut().zip(&room.weighed.momenta) {
                    *sum -= momentum.linear.dot(Vec3::from_f64(Vec3(*field)));
                }
            }
            for ((_, [from, to]), weights) in sought.lines.iter().zip(of_lines.chunks_exact(2 * count + 1)) {
                let (hessian, moving) = (&mut room.hessian[..], |velocity: usize| moves[velocity]);
                pair_into(model, &room.kinematics, from, to, &mut room.gradient);
                pair_hessian_of_moving(model, &room.kinematics, [from, to], moving, &mut room.workspace, hessian);
                weigh_measure((moves, v, own), weights, [&room.gradient, hessian], by_place);
            }
            T::write(&room.sums[..], here, &mut rows[..here * room.sums.len()]);
            for row in rows.chunks_exact(room.sums.len()).take(here) {
                sums.iter_mut().zip(row).for_each(|(sum, own)| *sum += own);
            }
            first += here;
        }
    }
}

/// Adds what M numbers have of a measure y by each velocity that stands still, M numbers each: s ∂y/∂q + Σ_b (r v_b + F μ_b) ∂²y/∂q_b∂q, with v and μ of
/// the velocities that move, weights s and r, and F behind them.
#[inline(always)]
pub(crate) fn weigh_measure<T: Scalar>(
    (moves, v, own): (&[bool], &[T], &[T]),
    weights: &[T],
    [gradient, hessian]: [&[T]; 2],
    by_place: &mut [T],
) {
    let (n, count) = (moves.len(), weights.len() / 2);
    let force = weights[2 * count];
    for k in (0..n).filter(|k| !moves[*k]) {
        for m in 0..count {
            let mut sum = weights[m] * gradient[k];
            for row in (0..n).filter(|row| moves[*row]) {
                sum += (weights[count + m] * v[row] + force * own[row * count + m]) * hessian[row * n + k];
            }
            by_place[k * count + m] += sum;
        }
    }
}

/// Takes in states side by side.
#[inline(always)]
fn read<T: Rows>(into: &mut [Vec<T>; 3], rows: &mut [f64], states: &[State]) {
    for (which, numbers) in into.iter_mut().enumerate() {
        let width = numbers.len();
        for (row, state) in rows.chunks_exact_mut(width.max(1)).zip(states) {
            row.copy_from_slice(state[which]);
        }
        T::read(&rows[..states.len() * width], states.len(), numbers);
    }
}

/// All states.
struct All<'a, 's, 'f, T> {
    model: &'a Model,
    sought: &'a Sought,
    room: &'a mut Room<T>,
    rows: &'a mut Vec<f64>,
    states: &'a [State<'s>],
    found: &'a mut [Found<'f>],
}

impl<T: Rows> Task for All<'_, '_, '_, T> {
    #[inline(always)]
    fn run(self) {
        let Self { model, sought, room, rows, states, found } = self;
        let n = model.nv();
        let changes = sought.changes();
        // A line has two numbers.
        rows.resize(T::COUNT * model.nq().max(n).max(changes).max(2), 0.0);
        let mut first = 0;
        while first < states.len() {
            let here = T::COUNT.min(states.len() - first);
            read(&mut room.state, rows, &states[first..first + here]);
            let found = &mut found[first..first + here];
            let [q, v, a] = &room.state;
            room.kinematics.update_velocity_of_moving(model, q, v, &sought.moves);
            let all = (&mut room.slopes, &mut room.efforts[..]);
            sought.slopes_into(model, &room.kinematics, a, &mut room.workspace, all);
            for row in 0..n {
                if !sought.moves[row] {
                    continue;
                }
                let own = row * n..(row + 1) * n;
                hand_on(&room.slopes.d_q[own.clone()], rows, found, |found| &mut found.slopes.d_q[own.clone()]);
                hand_on(&room.slopes.d_v[own.clone()], rows, found, |found| &mut found.slopes.d_v[own.clone()]);
                hand_on(&room.slopes.d_a[own.clone()], rows, found, |found| &mut found.slopes.d_a[own.clone()]);
                let own = row * changes..(row + 1) * changes;
                hand_on(&room.efforts[own.clone()], rows, found, |found| &mut found.efforts[own.clone()]);
            }
            for (e, [from, to]) in &sought.lines {
                let sites = [from, to];
                let pair = pair_into(model, &room.kinematics, from, to, &mut room.gradient);
                let (hessian, moves) = (&mut room.hessian[..], |velocity: usize| sought.moves[velocity]);
                pair_hessian_of_moving(model, &room.kinematics, sites, moves, &mut room.workspace, hessian);
                // y'_b = Σ_a ∂(∂y/∂q_a)/∂q_b v_a.
                let [_, v, _] = &room.state;
                room.bend.fill(T::ZERO);
                for row in 0..n {
                    if !sought.moves[row] {
                        continue;
                    }
                    let own = row * n..(row + 1) * n;
                    for (bend, second) in room.bend.iter_mut().zip(&room.hessian[own.clone()]) {
                        *bend += *second * v[row];
                    }
                    hand_on(&room.hessian[own.clone()], rows, found, |found| &mut found.hessians[*e][own.clone()]);
                }
                hand_on(&[pair.length, pair.rate], rows, found, |found| &mut found.readings[*e][..]);
                hand_on(&room.gradient, rows, found, |found| &mut found.gradients[*e][0][..]);
                hand_on(&room.bend, rows, found, |found| &mut found.gradients[*e][1][..]);
            }
            first += here;
        }
    }
}

/// Hands each state its own of `values`.
#[inline(always)]
fn hand_on<'f, T: Rows>(
    values: &[T],
    rows: &mut [f64],
    found: &mut [Found<'f>],
    place: impl for<'a> Fn(&'a mut Found<'f>) -> &'a mut [f64],
) {
    let width = values.len();
    if width == 0 {
        return;
    }
    T::write(values, found.len(), &mut rows[..found.len() * width]);
    for (row, found) in rows.chunks_exact(width).zip(found) {
        place(found).copy_from_slice(row);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Anchor, BodySpec, JointSpec, Mimic, ModelBuilder, Parent};
    use crate::random::Random;
    use crate::spatial::{Symmetric3, Vec3};

    fn vector(random: &mut Random) -> [f64; 3] {
        std::array::from_fn(|_| 2.0 * random.share() - 1.0)
    }

    /// A robot of so many joints of all kinds in any order, branched, one of them following another.
    fn robot(count: usize, random: &mut Random) -> Model {
        let mut builder = ModelBuilder::new([0.2, -0.1, -9.81]);
        let order = random.permutation(9);
        for (k, kind) in order.iter().enumerate().take(count) {
            let (name, axis, origin) = (format!("j{k}"), vector(random), vector(random));
            let mut joint = match kind {
                0 => JointSpec::revolute(name, axis, origin),
                1 => JointSpec::prismatic(name, axis, origin),
                2 => JointSpec::helical(name, axis, 0.3, origin),
                3 => JointSpec::cylindrical(name, axis, origin),
                4 => JointSpec::universal(name, [[1.0, 0.0, 0.0], [0.0, 0.6, 0.8]], origin),
                5 => JointSpec::planar(name, axis, origin),
                6 => JointSpec::spherical(name, origin),
                7 => JointSpec::floating(name, origin),
                _ => JointSpec::revolute(name, axis, origin),
            };
            if let (8, Some(leader)) = (kind, order[..k].iter().position(|kind| *kind < 2)) {
                joint.mimic = Some(Mimic { joint: format!("j{leader}"), multiplier: -0.7, offset: 0.1 });
            }
            let parent = if k == 0 { Parent::World } else { Parent::Body(random.below(k)) };
            let inertia = [[0.2, 0.01, 0.0], [0.01, 0.3, 0.02], [0.0, 0.02, 0.25]];
            let body = BodySpec { name: format!("b{k}"), parent, joint, mass: 1.0, com: vector(random), inertia };
            builder.push(body).unwrap();
        }
        builder.finish().unwrap()
    }

    fn sought(model: &Model, random: &mut Random) -> Sought {
        // Joints whose velocities stand still do so as a whole.
        let mut moves = vec![true; model.nv()];
        for j in model.own_joints() {
            let stands = random.share() < 0.3;
            model.v_range(j).for_each(|k| moves[k] = !stands);
        }
        let change = |random: &mut Random| Inertia {
            mass: random.share(),
            first_moment: Vec3(vector(random)),
            rotational: Symmetric3::from_upper([vector(random), vector(random), vector(random)]),
        };
        let links = (0..model.joint_count()).step_by(2).map(|j| (j, (0..=j % 3).map(|_| change(random)).collect()));
        let links = links.collect();
        let bodies = model.body_names().len();
        let mut site = |body| model.resolve(&Anchor { body, point: vector(random) }).unwrap();
        let lines = vec![
            (0, [site(Parent::World), site(Parent::Body(bodies - 1))]),
            (1, [site(Parent::Body(bodies / 2)), site(Parent::Body(bodies / 3))]),
        ];
        Sought { moves, links, fields: vec![vector(random), vector(random)], lines }
    }

    /// All that is found in these states at a level.
    fn all(model: &Model, sought: Sought, level: SimdLevel, states: &[[Vec<f64>; 3]]) -> Vec<Vec<f64>> {
        let (n, lines, changes) = (model.nv(), sought.lines.len(), sought.changes());
        let mut abreast = Abreast::at(model, sought, level);
        let mut found: Vec<_> = states
            .iter()
            .map(|_| {
                let gradients = vec![[vec![0.0; n], vec![0.0; n]]; lines];
                let (readings, hessians) = (vec![[0.0; 2]; lines], vec![vec![0.0; n * n]; lines]);
                (RneaDerivatives::new(model), vec![0.0; n * changes], readings, gradients, hessians)
            })
            .collect();
        let mut into: Vec<_> = found
            .iter_mut()
            .map(|(slopes, efforts, readings, gradients, hessians)| Found {
                slopes,
                efforts,
                readings,
                gradients,
                hessians,
            })
            .collect();
        let states: Vec<State> = states.iter().map(|state| state.each_ref().map(Vec::as_slice)).collect();
        abreast.see(model, &states, &mut into);
        let flat = found.into_iter().map(|(slopes, efforts, readings, gradients, hessians)| {
            let RneaDerivatives { d_q, d_v, d_a } = slopes;
            let gradients = gradients.into_iter().flatten().flatten();
            let rest = readings.into_iter().flatten().chain(gradients).chain(hessians.into_iter().flatten());
            [d_q, d_v, d_a, efforts].into_iter().flatten().chain(rest).collect()
        });
        flat.collect()
    }

    #[test]
    fn states_side_by_side_have_the_bits_that_they_have_alone() {
        for seed in 0..18 {
            let random = &mut Random::of(seed);
            let model = robot(1 + seed as usize % 9, random);
            let n = model.nv();
            for count in [1, 3, 6] {
                let states: Vec<[Vec<f64>; 3]> = (0..count)
                    .map(|_| {
                        let mut numbers = || (0..n).map(|_| 2.0 * random.share() - 1.0).collect::<Vec<f64>>();
                        [model.integrate(&model.neutral(), &numbers()), numbers(), numbers()]
                    })
                    .collect();
                let stream = seed * 10 + count;
                let of = |level| all(&model, sought(&model, &mut Random::of(stream)), level, &states);
                let alone = of(SimdLevel::Baseline);
                let one_by_one = states.iter().flat_map(|state| {
                    all(
                        &model,
                        sought(&model, &mut Random::of(stream)),
                        SimdLevel::Baseline,
                        std::slice::from_ref(state),
                    )
                });
                let bits = |rows: &[Vec<f64>]| -> Vec<u64> { rows.iter().flatten().map(|x| x.to_bits()).collect() };
                assert_eq!(bits(&alone), bits(&one_by_one.collect::<Vec<_>>()));
                assert!(alone.iter().flatten().all(|x| x.is_finite()), "seed {seed}");
                for level in SimdLevel::ALL.into_iter().filter(|level| level.available().is_ok()) {
                    assert_eq!(bits(&of(level)), bits(&alone), "{level}, seed {seed}, {count} states");
                }
            }
        }
    }

    /// Weighed in one pass over the links, rows have in sum what they have one by one.
    #[test]
    fn what_is_weighed_is_the_sum_of_the_rows() {
        let count = 2;
        for seed in 0..18 {
            let random = &mut Random::of(100 + seed);
            let model = robot(1 + seed as usize % 9, random);
            let n = model.nv();
            let states: Vec<[Vec<f64>; 3]> = (0..5)
                .map(|_| {
                    let mut numbers = || (0..n).map(|_| 2.0 * random.share() - 1.0).collect::<Vec<f64>>();
                    let v = numbers();
                    [model.integrate(&model.neutral(), &numbers()), v, numbers()]
                })
                .collect();
            let asked = || sought(&model, &mut Random::of(seed));
            let Sought { moves, .. } = asked();
            // What stands still has no velocity.
            let states: Vec<[Vec<f64>; 3]> = states
                .into_iter()
                .map(|[q, mut v, mut a]| {
                    (0..n).filter(|k| !moves[*k]).for_each(|k| (v[k], a[k]) = (0.0, 0.0));
                    [q, v, a]
                })
                .collect();
            let (width, sums) = (asked().weights(count), asked().sums(count));
            let changes = asked().changes();
            let weights: Vec<f64> = (0..states.len() * width).map(|_| 2.0 * random.share() - 1.0).collect();
            let mut expected = vec![0.0; sums];
            for ([_, v, _], (row, found)) in
                states.iter().zip(weights.chunks(width).zip(all(&model, asked(), SimdLevel::Baseline, &states)))
            {
                let (d_q, efforts) = (&found[..n * n], &found[3 * n * n..][..n * changes]);
                let of_lines = &found[3 * n * n + n * changes + 4..];
                for (m, b) in (0..count).flat_map(|m| (0..n).filter(|b| moves[*b]).map(move |b| (m, b))) {
                    let weight = row[b * count + m];
                    for k in (0..n).filter(|k| !moves[*k]) {
                        expected[k * count + m] += weight * d_q[b * n + k];
                        for line in 0..2 {
                            let own = &row[n * count + line * (2 * count + 1)..];
                            let second = of_lines[4 * n + line * n * n + b * n + k];
                            expected[k * count + m] += (own[count + m] * v[b] + own[2 * count] * weight) * second;
                        }
                    }
                    for change in 0..changes {
                        expected[(n + change) * count + m] += weight * efforts[b * changes + change];
                    }
                }
                for (m, k) in (0..count).flat_map(|m| (0..n).filter(|k| !moves[*k]).map(move |k| (m, k))) {
                    for line in 0..2 {
                        let own = &row[n * count + line * (2 * count + 1)..];
                        expected[k * count + m] += own[m] * of_lines[2 * line * n + k];
                    }
                }
            }
            let largest = expected.iter().fold(1.0, |largest: f64, x| largest.max(x.abs()));
            let mut bits = None;
            for level in SimdLevel::ALL.into_iter().filter(|level| level.available().is_ok()) {
                let mut own = vec![0.0; sums];
                let mut abreast = Abreast::at(&model, asked(), level);
                let states: Vec<State> = states.iter().map(|state| state.each_ref().map(Vec::as_slice)).collect();
                abreast.weigh(&model, &states, &Weights { count, rows: &weights }, &mut own);
                for (own, expected) in own.iter().zip(&expected) {
                    assert!((own - expected).abs() < 1e-12 * largest, "seed {seed}, {level}: {own} for {expected}");
                }
                let found: Vec<u64> = own.iter().map(|x| x.to_bits()).collect();
                assert_eq!(*bits.get_or_insert_with(|| found.clone()), found, "seed {seed}, {level}");
            }
        }
    }
}
