//! Cables and bushings: derivatives, what they must reduce to, forces and energies in runs.

use crate::random::{Case, case, close, config, difference, largest, one_degree_case, time_difference};
use crate::support::run_system;
use crate::systems::*;
use proptest::prelude::*;
use springpot::dynamics::Kinematics;
use springpot::elements::{Bushing, Cable, CableError, Component, Element, Line, Measure};
use springpot::methods::fixed::Method;
use springpot::model::{Anchor, BodySpec, Frame, JointKind, JointSpec, Model, ModelBuilder, Parent, Site};
use springpot::spatial::{Rotation, Vec3};
use springpot::system::{Motion, RunError, Settings, System};

const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// Any body of a case and a point of it, the world included.
fn anchors(case: &Case, draws: &[(usize, [f64; 3])]) -> Vec<Anchor> {
    let count = case.bodies.len();
    let body = |drawn: usize| match drawn % (count + 1) {
        0 => Parent::World,
        number => Parent::Body(number - 1),
    };
    draws.iter().map(|&(drawn, point)| Anchor { body: body(drawn), point }).collect()
}

fn at(model: &Model, q: &[f64], v: &[f64], measure: &Measure) -> (f64, Vec<f64>) {
    let (reading, gradient) = measure.read(model, &Kinematics::at_velocity(model, q, v));
    (reading.coordinate, gradient)
}

/// Gradient, rate and second derivatives against differences.
fn check(case: &Case, model: &Model, measure: &Measure, tolerance: f64) -> Result<(), TestCaseError> {
    let kinematics = Kinematics::at_velocity(model, &case.q, &case.v);
    let (reading, gradient) = measure.read(model, &kinematics);
    let n = model.nv();
    let slopes: Vec<f64> =
        (0..n).map(|k| difference(model, &case.q, k, |q| vec![at(model, q, &case.v, measure).0])[0]).collect();
    close("gradient", &gradient, &slopes, tolerance, largest(&gradient).max(1.0));
    let along: f64 = gradient.iter().zip(&case.v).map(|(g, v)| g * v).sum();
    prop_assert!((reading.rate - along).abs() <= 1e-12 * (1.0 + along.abs()), "{} {along}", reading.rate);
    let by_time = time_difference(model, case, |q, _| vec![at(model, q, &case.v, measure).0])[0];
    let off = (reading.rate - by_time).abs();
    prop_assert!(off <= 100.0 * tolerance * (1.0 + by_time.abs()), "{} {by_time}", reading.rate);
    let hessian = measure.hessian(model, &kinematics);
    for b in 0..n {
        let column = difference(model, &case.q, b, |q| at(model, q, &case.v, measure).1);
        let own: Vec<f64> = (0..n).map(|a| hessian[a * n + b]).collect();
        close("second derivatives", &own, &column, 10.0 * tolerance, largest(&hessian).max(1.0));
    }
    Ok(())
}

/// Whether differences around q are good ones: no segment is short.
fn is_taut(model: &Model, q: &[f64], points: &[Site]) -> bool {
    let kinematics = Kinematics::at_position(model, q);
    let length = |two: &[Site]| (kinematics.position(&two[1]) - kinematics.position(&two[0])).norm();
    points.windows(2).all(|two| length(two) > 0.15)
}

fn frames(case: &Case, model: &Model, turns: [[f64; 3]; 2]) -> [Frame; 2] {
    let [from, to] = case.anchors;
    [(from, turns[0]), (to, turns[1])]
        .map(|(anchor, rpy)| model.resolve_frame(&anchor, &Rotation::from_rpy(rpy)).unwrap())
}

fn turn_of(model: &Model, q: &[f64], [from, to]: [Frame; 2]) -> Vec3 {
    let kinematics = Kinematics::at_position(model, q);
    (kinematics.frame(&from).rotation.transpose() * kinematics.frame(&to).rotation).rotation_vector()
}

fn point() -> impl Strategy<Value = (usize, [f64; 3])> {
    (0usize..9, proptest::array::uniform3(-0.5..0.5))
}

fn turns() -> impl Strategy<Value = [[f64; 3]; 2]> {
    proptest::array::uniform2(proptest::array::uniform3(-3.0..3.0))
}

proptest! {
    #![proptest_config(config(0x5eed_0051))]

    #[test]
    fn derivatives_of_cables(case in case(), draws in proptest::collection::vec(point(), 2..5)) {
        let model = case.model();
        let points: Vec<Site> =
            anchors(&case, &draws).iter().map(|anchor| model.resolve(anchor).unwrap()).collect();
        prop_assume!(is_taut(&model, &case.q, &points));
        let Ok(cable) = Cable::new(points) else { return Ok(()) };
        check(&case, &model, &cable.into(), 1e-7)?;
    }

    #[test]
    fn derivatives_of_bushings(case in case(), turns in turns()) {
        let model = case.model();
        let [from, to] = frames(&case, &model, turns);
        let near = turn_of(&model, &case.q, [from, to]).norm();
        for component in Component::ALL {
            if component.is_rotation() && near > 2.9 {
                continue;
            }
            check(&case, &model, &Bushing::new(&model, from, to, component).into(), 1e-7)?;
        }
    }

    #[test]
    fn derivatives_where_joints_follow(case in one_degree_case(), turns in turns(), via in point()) {
        let model = case.model();
        let [from, to] = frames(&case, &model, turns);
        let [first, last] = case.sites(&model);
        let points = vec![first, model.resolve(&anchors(&case, &[via])[0]).unwrap(), last];
        if turn_of(&model, &case.q, [from, to]).norm() < 2.9 {
            for component in Component::ALL {
                check(&case, &model, &Bushing::new(&model, from, to, component).into(), 1e-7)?;
            }
        }
        prop_assume!(is_taut(&model, &case.q, &points));
        if let Ok(cable) = Cable::new(points) {
            check(&case, &model, &cable.into(), 1e-7)?;
        }
    }

    /// A floating base carries everything: where it is does not matter, and its velocities have no share.
    #[test]
    fn a_rigid_motion_of_everything_changes_nothing(
        case in case(),
        pose in proptest::array::uniform7(-1.0..1.0f64),
        draws in proptest::collection::vec(point(), 3),
        turns in turns(),
    ) {
        let base = BodySpec {
            name: "base".into(),
            joint: JointSpec { kind: JointKind::Floating, ..JointSpec::revolute("base", [0.0; 3], [0.0; 3]) },
            ..case.bodies[0].clone()
        };
        let carried = case.bodies.iter().map(|body| BodySpec {
            parent: match body.parent {
                Parent::World => Parent::Body(0),
                Parent::Body(k) => Parent::Body(k + 1),
            },
            ..body.clone()
        });
        let mut builder = ModelBuilder::new(GRAVITY);
        for body in [base].into_iter().chain(carried) {
            builder.push(body).unwrap();
        }
        let model = builder.finish().unwrap();
        let up = |anchor: &Anchor| Anchor {
            body: match anchor.body {
                Parent::World => Parent::Body(0),
                Parent::Body(k) => Parent::Body(k + 1),
            },
            ..*anchor
        };
        let place = |pose: [f64; 7]| {
            let mut q: Vec<f64> = pose.into_iter().chain(case.q.iter().copied()).collect();
            model.normalise(&mut q);
            q
        };
        let (here, there) = (place([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]), place(pose));
        let points: Vec<Site> = anchors(&case, &draws).iter().map(|anchor| model.resolve(&up(anchor)).unwrap()).collect();
        let [from, to] = [(0, 0), (1, 1)].map(|(k, turn)| {
            model.resolve_frame(&up(&case.anchors[k]), &Rotation::from_rpy(turns[turn])).unwrap()
        });
        let mut measures: Vec<Measure> =
            Component::ALL.iter().map(|&component| Bushing::new(&model, from, to, component).into()).collect();
        if let Ok(cable) = Cable::new(points.clone()) && is_taut(&model, &here, &points) {
            measures.push(cable.into());
        }
        prop_assume!(turn_of(&model, &here, [from, to]).norm() < 2.9);
        let v = vec![0.0; model.nv()];
        for measure in measures {
            let [(y, gradient), (moved, other)] = [&here, &there].map(|q| at(&model, q, &v, &measure));
            prop_assert!((y - moved).abs() < 1e-12, "{y} {moved}");
            close("gradient", &gradient, &other, 1e-12, 10.0);
            prop_assert_eq!(&gradient[..6], &[0.0; 6]);
        }
    }
}

fn site(model: &Model, body: Parent, point: [f64; 3]) -> Site {
    model.resolve(&Anchor { body, point }).unwrap()
}

/// World, the three moving bodies of [`arm`], and the world again.
fn cable(model: &Model) -> Cable {
    let points = [
        site(model, Parent::World, [0.1, 0.3, -0.4]),
        site(model, Parent::Body(0), [0.2, -0.2, 0.1]),
        site(model, Parent::Body(0), [0.3, 0.2, 0.1]),
        site(model, Parent::Body(2), [0.2, 0.1, 0.3]),
        site(model, Parent::World, [1.5, 0.4, 0.8]),
    ];
    Cable::new(points.to_vec()).unwrap()
}

fn bushing(model: &Model, component: Component) -> Bushing {
    let frame = |body, point, rpy| model.resolve_frame(&Anchor { body, point }, &Rotation::from_rpy(rpy)).unwrap();
    let from = frame(Parent::Body(0), [0.1, 0.0, 0.2], [0.3, -0.4, 0.2]);
    let to = frame(Parent::Body(2), [0.2, 0.1, -0.1], [0.1, 0.2, 0.7]);
    Bushing::new(model, from, to, component)
}

#[test]
fn cables_need_two_points_apart() {
    let model = arm(GRAVITY);
    let point = |body| site(&model, body, [0.1; 3]);
    let [world, first] = [Parent::World, Parent::Body(0)].map(point);
    assert_eq!(Cable::new(vec![world]), Err(CableError::TooFew { count: 1 }));
    assert_eq!(Cable::new(vec![world, first, first]), Err(CableError::Coincident { segment: 2 }));
    assert_eq!(Cable::new(vec![world, site(&model, Parent::World, [0.0; 3])]), Err(CableError::Rigid));
}

/// A via point on the straight line between two points of the other body changes nothing.
#[test]
fn a_cable_through_a_point_of_the_line_is_the_line() {
    let model = arm(GRAVITY);
    let [from, to] = [site(&model, Parent::World, [0.1, 0.3, -0.4]), site(&model, Parent::Body(2), [0.2, 0.1, 0.1])];
    let line = Measure::from(Line { from, to });
    let plain = Measure::from(Cable::new(vec![from, to]).unwrap());
    let (q, v) = ([0.1, 0.0, 0.3], [0.5, 0.2, -1.0]);
    let kinematics = Kinematics::at_velocity(&model, &q, &v);
    let [a, b] = [from, to].map(|site| kinematics.position(&site));
    let middle = site(&model, Parent::World, (a + (b - a) * 0.4).0);
    let through = Measure::from(Cable::new(vec![from, middle, to]).unwrap());
    let ((first, gradient), (second, other)) = (at(&model, &q, &v, &line), at(&model, &q, &v, &through));
    assert!((first - second).abs() < 1e-14);
    close("gradient", &gradient, &other, 1e-14, 1.0);
    // And everywhere without one.
    let of = |measure: Measure| {
        let e = element("e", measure, 0.8, "fractional-kelvin-voigt", &[60.0, 20.0, 0.3]);
        run(&system(arm(GRAVITY), vec![e], free(&q, &v)), &settings(1.0, 1e-10))
    };
    let [line, cable] = [of(line), of(plain)];
    for name in line.names.iter().filter(|name| *name != "energy.residual") {
        let (a, b) = (line.column(name), cable.column(name));
        close(name, &a, &b, 1e-8, largest(&a).max(1.0));
    }
}

#[test]
fn a_cable_over_a_fixed_point_is_two_lines_with_one_tension() {
    let model = arm(GRAVITY);
    let [from, to] = [site(&model, Parent::Body(0), [0.3, 0.3, -0.4]), site(&model, Parent::Body(2), [0.2, 0.1, 0.1])];
    let over = site(&model, Parent::World, [0.5, -0.6, 0.2]);
    let (q, v) = ([0.1, 0.1, 0.3], [0.5, 0.2, -1.0]);
    let of = |measure: Measure| at(&model, &q, &v, &measure);
    let (length, gradient) = of(Cable::new(vec![from, over, to]).unwrap().into());
    let lines = [of(Line { from, to: over }.into()), of(Line { from: over, to }.into())];
    let sum: Vec<f64> = (0..3).map(|k| lines[0].1[k] + lines[1].1[k]).collect();
    assert!((length - lines[0].0 - lines[1].0).abs() < 1e-15);
    close("gradient", &gradient, &sum, 1e-15, 1.0);
}

/// Between the parts of one joint the relative coordinate along its axis is the joint's.
#[test]
fn a_bushing_at_a_joint_measures_the_joint() {
    for (kind, component) in [(JointKind::Revolute, Component::Rx), (JointKind::Prismatic, Component::X)] {
        let model = single(kind);
        let frame = |body| model.frame(body).unwrap();
        let own = Measure::from(Bushing::new(&model, frame(Parent::World), frame(Parent::Body(0)), component));
        let joint = Measure::from(joint(&model, "q"));
        assert_eq!(own.is_rotation(), kind == JointKind::Revolute);
        let rest = 0.1;
        let of = |measure: Measure| {
            let e = element("e", measure, rest, "fractional-kelvin-voigt", &[6.0, 1.0, 0.4]);
            run(&system(single(kind), vec![e], free(&[0.4], &[1.5])), &settings(1.0, 1e-10))
        };
        let [bushing, joint] = [own, joint].map(of);
        assert_eq!(bushing.names, joint.names);
        for name in bushing.names.iter().filter(|name| *name != "energy.residual") {
            let (a, b) = (bushing.column(name), joint.column(name));
            close(name, &a, &b, 1e-8, largest(&a).max(1.0));
        }
    }
}

/// For small turns the rotation vector is the sum of the turns about each axis.
#[test]
fn small_turns_add_up() {
    let mut builder = ModelBuilder::new([0.0; 3]);
    let mut parent = Parent::World;
    for (k, axis) in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].into_iter().enumerate() {
        let joint = JointSpec::revolute(format!("q{k}"), axis, [0.0; 3]);
        parent = Parent::Body(builder.push(body(&format!("b{k}"), parent, joint)).unwrap());
    }
    let model = builder.finish().unwrap();
    let [from, to] = [Parent::World, parent].map(|body| model.frame(body).unwrap());
    let small = 1e-5;
    let q = [small, -2.0 * small, 3.0 * small];
    for (k, component) in [Component::Rx, Component::Ry, Component::Rz].into_iter().enumerate() {
        let (y, gradient) = at(&model, &q, &[0.0; 3], &Bushing::new(&model, from, to, component).into());
        assert!((y - q[k]).abs() < 10.0 * small * small, "{y} {}", q[k]);
        let unit: Vec<f64> = (0..3).map(|j| f64::from(u8::from(j == k))).collect();
        close("gradient", &gradient, &unit, 10.0 * small, 1.0);
    }
}

fn everything(motion: impl Into<Motion>) -> System {
    let model = arm(GRAVITY);
    let laws: [(&str, &[f64]); 4] = [
        ("fractional-kelvin-voigt", &[60.0, 20.0, 0.3]),
        ("springpot", &[50.0, 0.7]),
        ("dashpot", &[2.0]),
        ("kelvin-voigt", &[90.0, 3.0]),
    ];
    let mut elements: Vec<Element> = Component::ALL
        .into_iter()
        .enumerate()
        .map(|(k, component)| {
            let (law, parameters) = laws[k % 4];
            element(&format!("mount.{}", component.name()), bushing(&model, component), 0.1, law, parameters)
        })
        .collect();
    elements.push(element("cable", cable(&model), 3.0, "fractional-kelvin-voigt", &[40.0, 30.0, 0.5]));
    system(model, elements, motion)
}

/// F y' = −Q·v in every row, and nothing is lost in the balance.
#[test]
fn power_and_energy_balance() {
    let forward = everything(free(&[0.1, 0.0, 0.3], &[0.5, 0.2, -1.0]));
    let given = everything(given(&["0.3*sin(3*t)", "0.1*sin(5*t)", "0.4*cos(4*t)"]));
    let check = |system: &System, settings: &Settings, share: f64| {
        let run = run(system, settings);
        let residual = run.residual();
        println!("{residual:.1e}");
        assert!(residual < share, "{residual:e}");
        for element in &system.elements {
            let of = |key: &str| run.column(&format!("{}.{key}", element.name));
            let (force, rate) = (of("force"), of("rate"));
            for k in 0..force.len() {
                let power: f64 = ["turn", "rail", "knee"]
                    .iter()
                    .map(|joint| of(&format!("Q.{joint}"))[k] * run.column(&format!("v.{joint}"))[k])
                    .sum();
                let scale = 1.0 + (force[k] * rate[k]).abs();
                assert!((power + force[k] * rate[k]).abs() < 1e-11 * scale, "{}: {power}", element.name);
            }
        }
    };
    check(&forward, &settings(1.0, 1e-9), 1e-8);
    check(&given, &settings(1.0, 1e-9), 1e-8);
    let [coarse, fine] = [1e-3, 5e-4].map(|step| run(&forward, &in_steps(0.5, Method::Midpoint, step)).residual());
    println!("midpoint {coarse:.1e} {fine:.1e}");
    assert!(coarse < 1e-3 && fine < 0.5 * coarse, "{coarse:e} {fine:e}");
    let equation = forward.equation(&settings(1.0, 1e-9), 0.375).unwrap();
    let off = largest(&equation.residual()) / equation.largest_term();
    assert!(off < 1e-10, "{off:e}");
}

/// Backward Euler of order one: its iteration has the exact tangents.
#[test]
fn methods_agree() {
    let system = everything(free(&[0.1, 0.0, 0.3], &[0.5, 0.2, -1.0]));
    let exact = run(&system, &settings(0.4, 1e-10));
    for (method, order) in [(Method::BackwardEuler, 1.0), (Method::Midpoint, 1.3)] {
        let off = [2e-3, 1e-3].map(|step| {
            let by_steps = run(&system, &in_steps(0.4, method, step));
            let [a, b] = [&exact, &by_steps].map(|run| run.column("q.knee"));
            a.iter().zip(&b).fold(0.0, |off: f64, (a, b)| off.max((a - b).abs()))
        });
        println!("{method:?} {off:?}");
        assert!(off[1] < 1.2 * 0.5f64.powf(order) * off[0] && off[1] < 5e-3, "{method:?}: {off:?}");
    }
}

#[test]
fn half_a_turn_stops_a_run() {
    let of = |motion: Motion| {
        let model = single(JointKind::Continuous);
        let frame = |body| model.frame(body).unwrap();
        let about = Bushing::new(&model, frame(Parent::World), frame(Parent::Body(0)), Component::Rx);
        system(model, vec![element("mount.rx", about, 0.0, "springpot", &[0.01, 0.5])], motion)
    };
    let stopped = |motion: Motion, settings: &Settings| {
        let run = run_system(&of(motion), settings);
        let RunError::HalfTurn { t, element, angle } = run.error.unwrap() else { panic!("not half a turn") };
        assert_eq!(element, "mount.rx");
        (t, angle)
    };
    let (t, _) = stopped(given(&["4*t"]).into(), &settings(1.0, 1e-9));
    assert!((t - 0.785).abs() < 2e-3, "{t}");
    let spin = || free(&[0.0], &[4.0]).into();
    let adaptive = stopped(spin(), &settings(1.0, 1e-9));
    let fixed = [Method::BackwardEuler, Method::Midpoint].map(|method| stopped(spin(), &in_steps(1.0, method, 1e-3)));
    for (t, angle) in [adaptive].into_iter().chain(fixed) {
        assert!((0.75..0.85).contains(&t) && angle > 3.1, "{t} {angle}");
    }
}

/// The ends of a segment meet while the cable as a whole keeps its length.
#[test]
fn a_segment_of_no_length_stops_a_run() {
    let model = single(JointKind::Prismatic);
    let [from, to] = [[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]].map(|point| site(&model, Parent::World, point));
    let over = site(&model, Parent::Body(0), [0.0; 3]);
    let cable = Cable::new(vec![from, over, to]).unwrap();
    let motions: [Motion; 2] = [given(&["0.4*t"]).into(), free(&[0.0], &[0.4]).into()];
    for motion in motions {
        let e = element("e", cable.clone(), 0.9, "dashpot", &[0.01]);
        let run = run_system(&system(single(JointKind::Prismatic), vec![e], motion), &settings(2.0, 1e-9));
        let RunError::SegmentLength { t, segment, .. } = run.error.unwrap() else { panic!("no segment met") };
        assert!(segment == 2 && (t - 1.25).abs() < 0.01, "{segment} {t}");
    }
}
