//! Forces on the coordinates of joints: generalized forces, exact motions, tangents, energies.

use crate::support::largest;
use crate::systems::*;
use springpot::elements::Line;
use springpot::fractional::mittag_leffler::MittagLeffler;
use springpot::methods::fixed::{Loop, MemorySettings, Method};
use springpot::model::{Anchor, JointKind, Parent};
use springpot::system::{Settings, System};

const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];
const LAWS: [(&str, &[f64]); 3] = [("spring", &[40.0]), ("dashpot", &[3.0]), ("springpot", &[20.0, 0.4])];
/// Joint, the velocity that moves it, and ∂y/∂q.
const JOINTS: [(&str, usize, f64); 4] =
    [("turn", 0, 1.0), ("rail", 1, 1.0), ("knee", 2, 1.0), ("follower", 2, FOLLOWS.0)];
const METHODS: [Method; 2] = [Method::BackwardEuler, Method::Midpoint];

/// Q_b = −F ∂y/∂q_b, stroke and rate are those of the joint, and the law is the one on a stroke; of every row.
fn check_rows(system: &System, settings: &Settings, rest: f64, (law, parameters): (&str, &[f64]), at: (usize, f64)) {
    let run = run(system, settings);
    let force = run.column("e.force");
    let (q, v) = (
        run.column(&format!("q.{}", ["turn", "rail", "knee"][at.0])),
        run.column(&format!("v.{}", ["turn", "rail", "knee"][at.0])),
    );
    for (k, name) in ["turn", "rail", "knee"].iter().enumerate() {
        let slope = if k == at.0 { at.1 } else { 0.0 };
        for (q_force, force) in run.column(&format!("e.Q.{name}")).iter().zip(&force) {
            assert_eq!(*q_force, -force * slope, "{law} on {name}");
        }
    }
    let offset = if at.1 == 1.0 { 0.0 } else { FOLLOWS.1 };
    for k in 0..force.len() {
        let y = at.1 * q[k] + offset;
        let [length, stroke, rate] = ["length", "stroke", "rate"].map(|of| run.column(&format!("e.{of}"))[k]);
        assert!((length - y).abs() < 1e-14 && (stroke - (y - rest)).abs() < 1e-14, "{law}: {length} {stroke} {y}");
        assert!((rate - at.1 * v[k]).abs() < 1e-14, "{law}: {rate}");
        let expected = match law {
            "spring" => parameters[0] * stroke,
            "dashpot" => parameters[0] * rate,
            _ => parameters[0] * run.column("e.derivative")[k],
        };
        // In fixed steps forces are means over steps at their ends.
        let tolerance = if settings.fixed_step.is_some() { 0.1 } else { 1e-10 };
        assert!((force[k] - expected).abs() <= tolerance * (1.0 + expected.abs()), "{law}: {} {expected}", force[k]);
    }
    assert!(largest(&force) > 0.1, "{law}");
}

#[test]
fn act_against_the_joint_alone() {
    for (name, velocity, slope) in JOINTS {
        for (law, parameters) in LAWS {
            let of = |motion: springpot::system::Motion| {
                let model = arm(GRAVITY);
                let e = element("e", joint(&model, name), 0.2, law, parameters);
                system(model, vec![e], motion)
            };
            let at = (velocity, slope);
            let paths = ["0.3*sin(3*t)", "0.1*sin(5*t) + 0.05*t", "0.4*cos(4*t)"];
            check_rows(&of(given(&paths).into()), &settings(1.0, 1e-10), 0.2, (law, parameters), at);
            let fall = of(free(&[0.1, 0.0, 0.3], &[0.5, 0.2, -1.0]).into());
            check_rows(&fall, &settings(0.5, 1e-9), 0.2, (law, parameters), at);
            for method in METHODS {
                check_rows(&fall, &in_steps(0.5, method, 1e-3), 0.2, (law, parameters), at);
            }
        }
    }
}

#[test]
fn actuators_of_a_given_motion_balance_them() {
    let paths = ["0.3*sin(3*t)", "0.1*sin(5*t)", "0.4*cos(4*t)"];
    let model = arm(GRAVITY);
    let elements = JOINTS.map(|(name, ..)| element(name, joint(&model, name), 0.1, "springpot", &[20.0, 0.4])).to_vec();
    let settings = settings(1.0, 1e-10);
    let bare = run(&system(arm(GRAVITY), Vec::new(), given(&paths)), &settings);
    let run = run(&system(model, elements, given(&paths)), &settings);
    for (k, joint) in ["turn", "rail", "knee"].into_iter().enumerate() {
        let tau = format!("tau.{joint}");
        for (row, (with, without)) in run.column(&tau).into_iter().zip(bare.column(&tau)).enumerate() {
            let pull = |(name, at, slope): &(&str, usize, f64)| {
                if *at == k { slope * run.column(&format!("{name}.force"))[row] } else { 0.0 }
            };
            let pulls: f64 = JOINTS.iter().map(pull).sum();
            assert!((with - without - pulls).abs() < 1e-11, "{joint}: {with} {without} {pulls}");
        }
    }
}

/// I q̈ + c D^alpha q = 0 from q = 0, q̇ = v has q = v t E_{2−alpha,2}(−(c/I) t^{2−alpha}): alpha = 0 for a spring, 1 for a
/// dashpot.
#[test]
fn one_joint_moves_as_it_must() {
    let (inertia, v, end) = (0.5, 0.8, 2.0);
    for kind in [JointKind::Revolute, JointKind::Continuous, JointKind::Prismatic] {
        for (law, parameters, alpha) in [
            ("spring", &[6.0][..], 0.0),
            ("springpot", &[2.0, 0.5], 0.5),
            ("springpot", &[2.0, 0.8], 0.8),
            ("dashpot", &[0.7], 1.0),
        ] {
            let model = single(kind);
            let e = element("e", joint(&model, "q"), 0.0, law, parameters);
            let system = system(model, vec![e], free(&[0.0], &[v]));
            let exact = MittagLeffler::new(2.0 - alpha, 2.0).unwrap();
            let exact = |t: f64| v * t * exact.real(-parameters[0] / inertia * t.powf(2.0 - alpha));
            let off = |settings: &Settings| {
                let run = run(&system, settings);
                let rows = run.t().into_iter().zip(run.column("q.q"));
                rows.fold(0.0, |off: f64, (t, q)| off.max((q - exact(t)).abs()))
            };
            let adaptive = off(&settings(end, 1e-10));
            assert!(adaptive < 1e-8, "{law} {alpha}: {adaptive:e}");
            let fixed = METHODS.map(|method| [2e-3, 1e-3].map(|step| off(&in_steps(end, method, step))));
            println!("{kind:?} {law} {alpha}: {adaptive:.1e}, {fixed:?}");
            let [euler, midpoint] = fixed;
            assert!(euler[1] < 4e-3 && euler[1] < 0.6 * euler[0], "{law} {alpha}: {euler:?}");
            assert!(midpoint[1] < 1e-4 && midpoint[1] < 0.5 * midpoint[0], "{law} {alpha}: {midpoint:?}");
        }
    }
}

/// A spring of the follower is one of its leader, ratio² as stiff, that rests where the follower does.
#[test]
fn a_follower_pulls_its_leader() {
    let ((ratio, offset), k, rest) = (FOLLOWS, 30.0, 0.5);
    let of = |name: &str, k: f64, rest: f64| {
        let model = arm(GRAVITY);
        let e = element("e", joint(&model, name), rest, "kelvin-voigt", &[k, 0.01 * k]);
        system(model, vec![e], free(&[0.1, 0.0, 0.3], &[0.5, 0.2, -1.0]))
    };
    let (by_follower, by_leader) = (of("follower", k, rest), of("knee", ratio * ratio * k, (rest - offset) / ratio));
    for (settings, tolerance) in [
        (settings(1.0, 1e-11), 1e-9),
        (in_steps(1.0, METHODS[0], 1e-3), 1e-12),
        (in_steps(1.0, METHODS[1], 1e-3), 1e-12),
    ] {
        let runs = [&by_follower, &by_leader].map(|system| run(system, &settings));
        for column in ["q.turn", "q.rail", "q.knee", "e.Q.knee", "e.stored", "energy.actuators"] {
            let [a, b] = [0, 1].map(|k| runs[k].column(column));
            let scale = largest(&a).max(1.0);
            for (a, b) in a.iter().zip(&b) {
                assert!((a - b).abs() <= tolerance * scale, "{column}: {a} {b}");
            }
        }
    }
}

#[test]
fn stiff_joints_converge_in_fixed_steps() {
    let memory = MemorySettings { tolerance: 1e-10, horizon: 10.0 };
    for (name, velocity, slope) in JOINTS {
        for (law, parameters) in [("spring", &[1e9][..]), ("kelvin-voigt", &[1e9, 1e6]), ("springpot", &[1e9, 0.5])] {
            let model = arm(GRAVITY);
            let measure = joint(&model, name);
            let rest = if slope == 1.0 { 0.0 } else { FOLLOWS.1 };
            let e = element("e", measure, rest, law, parameters);
            let mut v = [0.5, 0.2, -1.0];
            v[velocity] = 0.0;
            let system = system(model, vec![e], free(&[0.0; 3], &v));
            let mut robot = Loop::new(&system, Method::BackwardEuler, 1e-3, memory).unwrap();
            for _ in 0..500 {
                robot.advance(&[0.0; 3]).unwrap_or_else(|error| panic!("{name} {law}: {error}"));
                let (stroke, correction) = (robot.stroke(0), robot.correction());
                assert!(stroke.abs() < 1e-5 && correction < 1e-3, "{name} {law}: {stroke} {correction}");
            }
        }
    }
}

#[test]
fn the_balance_closes() {
    let laws: [(&str, &[f64]); 4] = [
        ("fractional-kelvin-voigt", &[60.0, 20.0, 0.3]),
        ("springpot", &[50.0, 0.7]),
        ("dashpot", &[2.0]),
        ("spring", &[90.0]),
    ];
    for turn in 0..4 {
        let build = |motion: springpot::system::Motion| {
            let model = arm(GRAVITY);
            let site = |body, point| model.resolve(&Anchor { body, point }).unwrap();
            let line = Line { from: site(Parent::World, [0.1, 0.3, -0.4]), to: site(Parent::Body(2), [0.2, 0.1, 0.1]) };
            let mut elements: Vec<_> = JOINTS
                .iter()
                .enumerate()
                .map(|(k, (name, ..))| {
                    let (law, parameters) = laws[(k + turn) % 4];
                    element(name, joint(&model, name), 0.1, law, parameters)
                })
                .collect();
            elements.push(element("strut", line, 0.8, "springpot", &[30.0, 0.5]));
            system(model, elements, motion)
        };
        let forward = build(free(&[0.1, 0.0, 0.3], &[0.5, 0.2, -1.0]).into());
        let given = build(given(&["0.3*sin(3*t)", "0.1*sin(5*t)", "0.4*cos(4*t)"]).into());
        for (system, rtol) in [(&forward, 1e-9), (&given, 1e-9)] {
            let residual = run(system, &settings(1.0, rtol)).residual();
            println!("{residual:.1e}");
            assert!(residual < 10.0 * rtol, "{residual:e}");
        }
        let [coarse, fine] = [1e-3, 5e-4].map(|step| run(&forward, &in_steps(0.5, METHODS[1], step)).residual());
        println!("midpoint {coarse:.1e} {fine:.1e}");
        assert!(coarse < 1e-3 && fine < 0.5 * coarse, "{coarse:e} {fine:e}");
        let equation = forward.equation(&settings(1.0, 1e-9), 0.375).unwrap();
        let off = largest(&equation.residual()) / equation.largest_term();
        assert!(off < 1e-11, "{off:e}");
    }
}
