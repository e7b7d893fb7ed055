//! The `_into` algorithms do not allocate, nor do memories and their derivatives once they have begun; alike elements share what they can.

#![allow(unsafe_code, reason = "a global allocator that counts")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use springpot::collocation::{Nodes, RADAU_NODES};
use springpot::dynamics::{
    AbaDerivatives, Kinematics, PairForce, RneaDerivatives, Workspace, aba_derivatives_into, aba_into, add_wrench,
    add_wrench_derivative, angular_jacobian_into, angular_jacobian_rate_into, cholesky_into, cholesky_solve_into,
    christoffel_into, com, com_jacobian_into, coriolis_into, crba_into, frame_jacobian_into, frame_jacobian_rate_into,
    gravity_into, inverse_from_cholesky_into, kinetic_energy, mass_inverse_into, nonlinear_effects_into,
    pair_hessian_into, pair_into, point_jacobian_into, point_jacobian_rate_into, potential_energy,
    rnea_derivatives_into, rnea_into,
};
use springpot::elements::{ElementBank, MemoryRange};
use springpot::fractional::{
    EnergyTangent, Form, Kind, Memory, MemoryTangent, RatePolynomial, Singular, StepStart, TangentEnd, TangentPoint,
    TangentSeeds, TangentStep,
};
use springpot::law::{Derivative, Network, Start};
use springpot::model::{Anchor, BodySpec, JointSpec, Mimic, Model, ModelBuilder, Parent};
use springpot::spatial::{Force, Vec3};

struct Counting;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
    /// Bytes that are not given back.
    static HELD: Cell<isize> = const { Cell::new(0) };
}

// SAFETY: every call is handed to the system allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        hold(layout.size(), 0);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        hold(0, layout.size());
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        hold(size, layout.size());
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn hold(taken: usize, given: usize) {
    HELD.with(|held| held.set(held.get() + taken as isize - given as isize));
}

fn allocations(work: impl FnOnce()) -> usize {
    let before = COUNT.with(Cell::get);
    work();
    COUNT.with(Cell::get) - before
}

/// Seven joints on two branches, revolute and prismatic.
fn specs() -> Vec<BodySpec> {
    let spec = |k: usize| {
        let (name, axis) = (format!("q{k}"), [1.0, k as f64, 0.5]);
        let joint = if k % 3 == 2 { JointSpec::prismatic } else { JointSpec::revolute };
        BodySpec {
            name: format!("b{k}"),
            parent: match k {
                0 => Parent::World,
                4 => Parent::Body(1),
                _ => Parent::Body(k - 1),
            },
            joint: joint(name, axis, [0.3, 0.1, 0.2]),
            mass: 1.0,
            com: [0.1, 0.0, 0.05],
            inertia: [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]],
        }
    };
    (0..7).map(spec).collect()
}

fn build(specs: Vec<BodySpec>) -> Model {
    let mut builder = ModelBuilder::new([0.0, 0.0, -9.81]);
    for spec in specs {
        builder.push(spec).unwrap();
    }
    builder.finish().unwrap()
}

#[test]
fn algorithms_do_not_allocate() {
    check(&build(specs()));
}

#[test]
fn nor_with_a_floating_base() {
    let mut floating = specs();
    floating[0].joint = JointSpec::floating("base", [0.0; 3]);
    check(&build(floating));
}

#[test]
fn nor_where_a_joint_follows_another() {
    let mut following = specs();
    following[6].joint.mimic = Some(Mimic { joint: "q3".into(), multiplier: -0.5, offset: 0.1 });
    check(&build(following));
}

#[test]
fn nor_do_memories_and_their_derivatives() {
    let zeros = [0.0; 9];
    let mut memory = Memory::new(0.4, Kind::RiemannLiouville, 0.1, 0.1, 1e-9, 1e-3, 10.0).unwrap();
    let seeds = TangentSeeds { alpha: &[0.5; 9], origin: &[1.0; 9], jump: &[1.0; 9] };
    let mut tangent = MemoryTangent::new(&memory, &seeds).unwrap();
    let (mut explicit, mut at) = ([0.0; 27], [0.0; 9]);
    let [mut stored, mut dissipation] = [zeros; 2];
    let (delta_u, mut t) = ([0.3; 36], 0.0f64);
    let mut step = |h: f64| {
        let mut rates = [(3.0 * t).cos(); 4];
        rates.iter_mut().skip(1).zip(RADAU_NODES).for_each(|(rate, c)| *rate = (3.0 * (t + c * h)).cos());
        let polynomial = RatePolynomial::through_rates(h, Nodes::Radau, &rates);
        let start = StepStart { t, h, stroke: 0.1, rate: rates[0] };
        let step = TangentStep { start, nodes: Nodes::Radau, places: None, form: Form::Rates, polynomial };
        let point = TangentPoint { stroke: 0.1, rate: rates[0], delta_stroke: &zeros, delta_rate: &zeros };
        memory.prepare(&start, Nodes::Radau, Form::Rates);
        tangent.explicit(&memory, &step, Singular::Moments, &point, &mut explicit);
        tangent.at(&memory, &step, 0.3, &point, &delta_u, &mut at);
        let mut out = EnergyTangent { stored: &mut stored, dissipation: &mut dissipation };
        tangent.energy(&memory, &step, 0.3, &point, &delta_u, &mut out);
        let end = TangentEnd { stroke: 0.2, delta_stroke: &zeros, resolution: 1e-16 };
        tangent.commit(&memory, &step, &delta_u, Some(&end));
        memory.commit_rates(&polynomial, None, 0.2, 1e-16);
        t += h;
    };
    // Tables of eight sizes of steps are kept.
    (0..9).for_each(|k| step(0.01 + 1e-4 * f64::from(k)));
    let count = allocations(|| (0..50).for_each(|k| step(0.02 + 1e-4 * f64::from(k))));
    assert_eq!(count, 0);
    assert!(explicit.iter().chain(&at).all(|x| x.is_finite()));
}

/// A bank of equal springpots after steps of several sizes: its elements share kernel and tables.
#[test]
fn alike_elements_hold_little_memory() {
    let held = |count: usize| {
        let before = HELD.with(Cell::get);
        let law = Network::springpot(3.0, 0.4, Derivative::Caputo);
        let mut bank = ElementBank::new(vec![law; count], Nodes::Radau, Form::Rates);
        let start = Start { stroke: 0.0, jump: 0.0, inputs: &[] };
        let range = MemoryRange { tolerance: 1e-11, shortest: 1e-3, horizon: 10.0 };
        bank.begin(&vec![start; count], range).unwrap();
        let mut t = 0.0f64;
        for n in 0..12 {
            let h = 1e-3 * f64::from(n % 4 + 1);
            bank.start(t, h);
            for e in 0..count {
                for (k, c) in [0.0].iter().chain(Nodes::Radau.positions()).enumerate() {
                    bank.set(e, k, (t + c * h).sin(), (t + c * h).cos(), &[]);
                }
            }
            bank.evaluate();
            bank.commit();
            t += h;
        }
        (HELD.with(Cell::get) - before, bank.force(count - 1))
    };
    let ((one, force), (many, same)) = (held(1), held(1001));
    assert_eq!(force, same);
    assert!((many - one) / 1000 < 4096, "{} bytes for each", (many - one) / 1000);
}

fn check(model: &Model) {
    let n = model.nv();
    let (q, v, a) = (model.random(1), vec![-0.4; n], vec![0.5; n]);
    let next = &mut q.clone();
    let site = |body, point| model.resolve(&Anchor { body: Parent::Body(body), point }).unwrap();
    let (from, to) = (site(3, [0.1, 0.2, 0.3]), site(6, [0.0, -0.1, 0.2]));
    let pairs = [PairForce { from, to, force: 10.0, d_length: 3.0, d_rate: 2.0 }];
    let (mut kinematics, mut workspace) = (Kinematics::new(model), Workspace::new(model));
    let (mut vector, mut jacobian) = (vec![0.0; n], vec![0.0; 3 * n]);
    let (mut matrix, mut gamma) = (vec![0.0; n * n], vec![0.0; n * n * n]);
    let (mut factor, mut frame_jacobian) = (vec![0.0; n * n], vec![0.0; 6 * n]);
    let frame = model.frame(Parent::Body(6)).unwrap();
    let wrench = Force { linear: Vec3([1.0, 2.0, 3.0]), angular: Vec3([0.1, 0.2, 0.3]) };
    let (mut inverse_slopes, mut forward_slopes) = (RneaDerivatives::new(model), AbaDerivatives::new(model));
    let (mut energy, mut centre) = (0.0, Vec3([0.0; 3]));

    assert!(allocations(|| drop(std::hint::black_box(vec![1u8; 9]))) > 0, "the counter counts");
    let count = allocations(|| {
        kinematics.update_position(model, &q);
        kinematics.update_velocity(model, &q, &v);
        kinematics.update_acceleration(model, &q, &v, &a);
        point_jacobian_into(model, &kinematics, &to, &mut jacobian);
        point_jacobian_rate_into(model, &kinematics, &to, &mut jacobian);
        angular_jacobian_into(model, &kinematics, &to, &mut jacobian);
        angular_jacobian_rate_into(model, &kinematics, &to, &mut jacobian);
        crba_into(model, &kinematics, &mut workspace, &mut matrix);
        if model.is_one_degree() {
            christoffel_into(model, &kinematics, &mut workspace, &mut gamma);
        }
        gravity_into(model, &kinematics, &mut workspace, &mut vector);
        pair_into(model, &kinematics, &from, &to, &mut vector);
        pair_hessian_into(model, &kinematics, &from, &to, &mut workspace, &mut matrix);
        rnea_into(model, &q, &v, &a, &pairs, &mut workspace, &mut vector);
        nonlinear_effects_into(model, &q, &v, &pairs, &mut workspace, &mut vector);
        aba_into(model, &kinematics, &a, &pairs, &mut workspace, &mut vector);
        coriolis_into(model, &kinematics, &mut workspace, &mut matrix);
        com_jacobian_into(model, &kinematics, &mut workspace, &mut jacobian);
        frame_jacobian_into(model, &kinematics, &frame, &mut frame_jacobian);
        frame_jacobian_rate_into(model, &kinematics, &frame, &mut frame_jacobian);
        crba_into(model, &kinematics, &mut workspace, &mut factor);
        cholesky_into(model, &mut factor);
        cholesky_solve_into(model, &factor, &mut vector);
        inverse_from_cholesky_into(model, &factor, &mut matrix);
        mass_inverse_into(model, &kinematics, &mut workspace, &mut factor, &mut matrix);
        add_wrench(model, &kinematics, &to, wrench, &mut vector);
        add_wrench_derivative(model, &kinematics, &to, wrench, &mut matrix);
        rnea_derivatives_into(model, &kinematics, &a, &pairs, &mut workspace, &mut inverse_slopes);
        aba_derivatives_into(model, &kinematics, &a, &pairs, &mut workspace, &mut forward_slopes);
        model.integrate_into(&q, &v, next);
        model.difference_into(&q, next, &mut vector);
        model.normalise(next);
        centre = com(model, &kinematics);
        energy = kinetic_energy(model, &kinematics) + potential_energy(model, &kinematics);
    });
    assert_eq!(count, 0);
    assert!(energy.is_finite() && centre.is_finite() && frame_jacobian.iter().all(|x| x.is_finite()));
    assert!(
        vector
            .iter()
            .chain(&gamma)
            .chain(&inverse_slopes.d_q)
            .chain(&forward_slopes.d_q)
            .chain(&matrix)
            .all(|x| x.is_finite())
    );
}
