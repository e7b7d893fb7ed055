//! Limits of joints as end stops, against closed forms.

use springpot::actuation::{Drive, Forward};
use springpot::driver::{Report, run};
use springpot::methods::fixed::Method;
use springpot::model::{BodySpec, JointSpec, Limits, ModelBuilder, Parent};
use springpot::motion::{JointPath, Trajectory};
use springpot::observe::Table;
use springpot::signal::{Expression, Signal};
use springpot::system::{FixedStep, Motion, RowTimes, Settings, Stop, System};

const MASS: f64 = 2.0;
const UPPER: f64 = 0.5;

/// A mass on a slide with an end at x = 0.5, along which `gravity` pulls.
fn system(gravity: f64, lower: f64, motion: impl FnOnce() -> Motion, stiffness: f64, damping: f64) -> System {
    let mut builder = ModelBuilder::new([gravity, 0.0, 0.0]);
    let limits = Limits { lower, upper: UPPER, ..Limits::NONE };
    let joint = JointSpec { limits: [limits; 3], ..JointSpec::prismatic("q", [1.0, 0.0, 0.0], [0.0; 3]) };
    let body =
        BodySpec { name: "m".into(), parent: Parent::World, joint, mass: MASS, com: [0.0; 3], inertia: [[0.0; 3]; 3] };
    builder.push(body).unwrap();
    let system = System::new(builder.finish().unwrap(), Vec::new(), motion());
    System { tells_joint_losses: true, ..system }.with_end_stops(stiffness, damping).unwrap()
}

fn moving(v: f64) -> Motion {
    Forward { q: vec![0.0], v: vec![v], drives: vec![Drive::Force(vec![Signal::constant(0.0)])] }.into()
}

fn done(system: &System, end: f64, rtol: f64, fixed_step: Option<FixedStep>) -> (Table, Report) {
    let settings = Settings { rtol, fixed_step, ..Settings::new(end, RowTimes::Step { step: end / 100.0, end }) };
    let mut table = system.table();
    let (report, outcome) = run(system, &settings, &mut table, &Stop::new(false));
    assert!(outcome.is_ok(), "{outcome:?}");
    (table, report)
}

/// e(t) and e'(t) in contact and behind it, reached at speed v at t = 0, and the time of the last contact.
fn contact(v: f64, k: f64, d: f64) -> (impl Fn(f64) -> [f64; 2], f64) {
    let a = d / (2.0 * MASS);
    let b = (k / MASS - a * a).sqrt();
    let at = move |t: f64| {
        let (sin, cos) = (b * t).sin_cos();
        [v / b * (-a * t).exp() * sin, v / b * (-a * t).exp() * (b * cos - a * sin)]
    };
    let last = if d == 0.0 { std::f64::consts::PI / b } else { (2.0 * a * b).atan2(a * a - b * b) / b };
    let path = move |t: f64| {
        let [e, v] = at(t.min(last));
        [e + v * (t - last).max(0.0), v]
    };
    (path, last)
}

fn residual(report: &Report) -> f64 {
    report.energy_residual.unwrap() / report.energy_turned_over.unwrap()
}

#[test]
fn a_mass_bounces_off_the_end_of_its_slide() {
    for (k, d) in [(800.0, 0.0), (800.0, 8.0), (5e4, 30.0), (200.0, 36.0)] {
        let (path, last) = contact(1.0, k, d);
        let system = system(0.0, f64::NEG_INFINITY, || moving(1.0), k, d);
        for rtol in [1e-6, 1e-9] {
            let (table, report) = done(&system, 0.5 + 2.0 * last, rtol, None);
            let [t, q, v, lost, tau] =
                ["t", "q.q", "v.q", "energy.joints", "tau.q"].map(|name| table.column(name).unwrap());
            for (row, t) in t.iter().enumerate() {
                let [x, rate] = if *t <= 0.5 { [t - 0.5, 1.0] } else { path(t - 0.5) };
                let off = (q[row] - 0.5 - x).abs().max((v[row] - rate).abs());
                assert!(off < 100.0 * rtol, "{k} {d} {rtol}: {off:e} at {t}");
                assert_eq!(tau[row], 0.0);
            }
            assert!(residual(&report) <= 10.0 * rtol, "{k} {d} {rtol}: {:e}", residual(&report));
            let kept = 1.0 - v.last().unwrap().powi(2);
            assert!((lost.last().unwrap() - kept).abs() < 100.0 * rtol, "{lost:?}");
        }
        let by = FixedStep { step: 1e-4, method: Method::Midpoint };
        let (table, report) = done(&system, 0.5 + 2.0 * last, 1e-9, Some(by));
        let v = *table.column("v.q").unwrap().last().unwrap();
        assert!((v - path(1.0)[1]).abs() < 0.02, "{v}");
        assert!(residual(&report) < 0.02, "{:e}", residual(&report));
    }
}

#[test]
fn a_mass_comes_to_rest_on_its_stop() {
    // Gravity of 10 m/s² along the slide: it bounces and rests at e = m·g/k.
    let system = system(10.0, -1.0, || moving(0.0), 2000.0, 60.0);
    let (table, report) = done(&system, 4.0, 1e-8, None);
    let q = *table.column("q.q").unwrap().last().unwrap();
    assert!((q - 0.51).abs() < 1e-6, "{q}");
    assert!(residual(&report) <= 1e-7, "{:e}", residual(&report));
    assert!(report.steps < 3000, "{report:?}");
}

#[test]
fn a_motion_that_is_given_needs_the_force_against_the_stops() {
    let path = || {
        let q = JointPath::Coordinate(Signal::expression("0.6*sin(3*t)".parse::<Expression>().unwrap()));
        Motion::from(Trajectory::Prescribed(vec![q]))
    };
    let system = system(0.0, -0.55, path, 1000.0, 20.0);
    let (table, report) = done(&system, 4.0, 1e-8, None);
    let [t, tau] = ["t", "tau.q"].map(|name| table.column(name).unwrap());
    for (t, tau) in t.iter().zip(tau) {
        let (x, v) = (0.6 * (3.0 * t).sin(), 1.8 * (3.0 * t).cos());
        let push = match x {
            x if x > UPPER => (1000.0 * (x - UPPER) + 20.0 * v).max(0.0),
            x if x < -0.55 => (1000.0 * (x + 0.55) + 20.0 * v).min(0.0),
            _ => 0.0,
        };
        let wanted = -MASS * 9.0 * x + push;
        assert!((tau - wanted).abs() < 1e-9, "{tau} is not {wanted} at {t}");
    }
    assert!(residual(&report) <= 1e-7, "{:e}", residual(&report));
}
