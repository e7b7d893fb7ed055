//! Gripper paths with loops and pulses that are short against the run; how much a path may take, and its interruption.

use crate::support::{cases, run, run_case};
use springpot::motion::gripper_path::{Course, GripperPath, Task};
use springpot::motion::{PathError, Source};
use springpot::signal::{Expression, Signal};
use springpot::system::{RunError, Stop};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// The plane arm of testdata/silent/d2d_redundant_loop.toml.
const LINKS: [f64; 4] = [0.4, 0.35, 0.3, 0.2];

fn silent() -> String {
    let file = format!("{}/../../testdata/silent/d2d_redundant_loop.toml", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// Its gripper at q, and the Jacobian of x and z.
fn gripper(q: &[f64; 4]) -> ([f64; 2], [[f64; 4]; 2]) {
    let (mut at, mut angle, mut joints) = ([0.0, 0.0], 0.0, [[0.0; 2]; 4]);
    for (k, link) in LINKS.into_iter().enumerate() {
        joints[k] = at;
        angle += q[k];
        at = [at[0] + link * angle.cos(), at[1] - link * angle.sin()];
    }
    (at, [joints.map(|joint| at[1] - joint[1]), joints.map(|joint| joint[0] - at[0])])
}

/// J⁺ r.
fn least(jacobian: &[[f64; 4]; 2], r: [f64; 2]) -> [f64; 4] {
    let dot = |i: usize, j: usize| (0..4).map(|k| jacobian[i][k] * jacobian[j][k]).sum::<f64>();
    let (a, b, c) = (dot(0, 0), dot(0, 1), dot(1, 1));
    let determinant = a * c - b * b;
    let y = [(c * r[0] - b * r[1]) / determinant, (a * r[1] - b * r[0]) / determinant];
    std::array::from_fn(|k| y[0] * jacobian[0][k] + y[1] * jacobian[1][k])
}

/// A loop: when, how long, how far.
#[derive(Debug, Clone, Copy)]
struct Loop {
    at: f64,
    width: f64,
    size: [f64; 2],
}

impl Loop {
    /// r and ṙ, with the shape of `silent`.
    fn rates(&self, t: f64) -> [[f64; 2]; 2] {
        let u = (t - self.at) / self.width;
        let g = 1.0 - u * u;
        if g <= 0.0 {
            return [[0.0; 2]; 2];
        }
        let slope = -6.0 * u * g * g;
        let [x, z] = self.size;
        [[x * g.powi(3), z * u * g.powi(3)], [x * slope / self.width, z * (g.powi(3) + u * slope) / self.width]]
    }

    fn written(&self) -> [String; 2] {
        let Self { at, width, size: [x, z] } = self;
        let pulse = format!("max(0,1-((t-{at:?})/{width:?})^2)^3");
        [format!("{x:?}*{pulse}"), format!("{z:?}*(t-{at:?})/{width:?}*{pulse}")]
    }
}

/// q' = J⁺ṙ by the classical method of order 4, from q along x = 0.8 + 0.1 sin(t/2), z = 0 and the loops.
fn integrated(mut q: [f64; 4], loops: &[Loop], end: f64) -> [f64; 4] {
    let wanted = |t: f64| {
        let mut r = [[0.8 + 0.1 * (0.5 * t).sin(), 0.0], [0.05 * (0.5 * t).cos(), 0.0]];
        for rates in loops.iter().map(|l| l.rates(t)) {
            (0..2).for_each(|i| (0..2).for_each(|j| r[i][j] += rates[i][j]));
        }
        r
    };
    let rate = |t: f64, q: &[f64; 4]| least(&gripper(q).1, wanted(t)[1]);
    let add = |q: &[f64; 4], v: &[f64; 4], h: f64| -> [f64; 4] { std::array::from_fn(|j| q[j] + h * v[j]) };
    let mut ends: Vec<f64> = loops.iter().flat_map(|l| [l.at - l.width, l.at + l.width]).chain([0.0, end]).collect();
    ends.sort_by(f64::total_cmp);
    for pair in ends.windows(2) {
        let steps = 600;
        let h = (pair[1] - pair[0]) / f64::from(steps);
        for k in 0..steps {
            let t = pair[0] + f64::from(k) * h;
            let k1 = rate(t, &q);
            let k2 = rate(t + 0.5 * h, &add(&q, &k1, 0.5 * h));
            let k3 = rate(t + 0.5 * h, &add(&q, &k2, 0.5 * h));
            let k4 = rate(t + h, &add(&q, &k3, h));
            q = std::array::from_fn(|j| q[j] + h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]));
        }
    }
    // Back onto the path.
    for _ in 0..3 {
        let (at, jacobian) = gripper(&q);
        let [r, _] = wanted(end);
        q = add(&q, &least(&jacobian, [r[0] - at[0], r[1] - at[1]]), 1.0);
    }
    q
}

#[test]
fn a_short_loop_of_a_redundant_arm_is_not_missed() {
    let run = run(&silent());
    // q' = J⁺ṙ by the classical method of order 4 with 20 000 steps in the loop, extrapolated; q, then v, in the loop and after it.
    let right = [
        (
            [0.5724984542088251, -1.9455954859211324, 2.029079018020669, -0.7275679454109124],
            Some([-0.7710811565083606, 18.223671246792932, -14.124340424569072, 2.0893047139023793]),
        ),
        (
            [0.5139257536727785, -1.7864437409975837, 1.8543317522477873, -0.7170080561377076],
            Some([-4.584054995652356, -1.919480496603828, -2.910439233648794, -0.8873222740291297]),
        ),
        (
            [0.5209670666584387, -1.9761361218875262, 1.9793531189174058, -0.7447904989491845],
            Some([5.641532159930696, -17.20820975009479, 15.29550398121986, -1.9155865342661507]),
        ),
        ([0.5783683505569008, -2.0988099438789622, 2.103662591195457, -0.7556826179506847], None),
        ([0.5783683505569008, -2.0988099438789622, 2.103662591195457, -0.7556826179506847], None),
    ];
    let (mut q, mut v) = (0.0f64, 0.0f64);
    for (k, (place, rate)) in right.into_iter().enumerate() {
        for j in 0..4 {
            q = q.max((run.column(&format!("q.q{j}"))[k + 2] - place[j]).abs());
            v = v.max((run.column(&format!("v.q{j}"))[k + 2] - rate.unwrap_or([0.0; 4])[j]).abs());
        }
    }
    println!("q {q:.1e}, v {v:.1e}");
    assert!(q < 1e-10 && v < 1e-8, "{q:.1e} {v:.1e}");
}

/// Numbers between 0 and 1, the same in every run.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[test]
fn random_loops() {
    loops_are_followed(8, 11);
}

#[test]
#[ignore = "long"]
fn many_random_loops() {
    loops_are_followed(200, 12);
}

/// q at the end of paths with one to three loops each, 2 to 300 ms wide in a minute, against the integration of q' = J⁺ṙ.
fn loops_are_followed(count: usize, seed: u64) {
    let end = 60.0;
    let text = silent();
    let (head, _) = text.split_at(text.find("[motion]").unwrap());
    let (mut dice, mut worst, mut drift) = (Dice(seed), 0.0f64, f64::INFINITY);
    for case in 0..count {
        let width = 10f64.powf(-2.7 + 2.2 * dice.roll());
        let count = 1 + case % 3;
        let loops: Vec<Loop> = (0..count)
            .map(|k| {
                let cell = end / count as f64;
                let at = (k as f64 + 0.1 + 0.8 * dice.roll()) * cell;
                let size = [0.06 + 0.1 * dice.roll(), 0.25 * (dice.roll() - 0.5).signum()];
                Loop { at, width, size }
            })
            .collect();
        let written: Vec<[String; 2]> = loops.iter().map(Loop::written).collect();
        let sum = |k: usize| written.iter().map(|w| w[k].clone()).collect::<Vec<_>>().join(" + ");
        let text = format!(
            "{head}[motion]\nkind = \"gripper-path\"\nx = \"0.8 + 0.1*sin(0.5*t) + {}\"\ny = 0\nz = \"{}\"\n\
             guess = {{ q0 = 0.3, q1 = -0.8, q2 = 0.9, q3 = -0.5 }}\n[time]\nend = {end}\noutput_times = [0, {end}]\n",
            sum(0),
            sum(1)
        );
        let system = cases(&text).plan(0).unwrap().system();
        let at = |t: f64| -> [f64; 4] { system.state(t).unwrap().q.try_into().unwrap() };
        let (start, found) = (at(0.0), at(end));
        let gap = |a: [f64; 4], b: [f64; 4]| (0..4).map(|j| (a[j] - b[j]).abs()).fold(0.0, f64::max);
        let right = integrated(start, &loops, end);
        let error = gap(found, right);
        worst = worst.max(error);
        drift = drift.min(gap(right, integrated(start, &[], end)));
        assert!(error < 1e-8, "case {case}, {loops:?}: {error:.1e}");
    }
    println!("worst {worst:.1e}; without the loops at least {drift:.1e}");
    assert!(drift > 1e-5, "the loops must lead elsewhere: {drift:.1e}");
}

/// A path of the arm of `silent`, not yet solved: its model and task.
fn task(x: &str) -> (std::sync::Arc<springpot::model::Model>, Task) {
    let text = silent();
    let system = cases(&text).plan(0).unwrap().system();
    assert!(system.motion.has_path());
    let body = springpot::model::Parent::Body(3);
    let written = |text: &str| Signal::expression(Expression::parse(text).unwrap());
    let task = Task {
        site: system.gripper.unwrap(),
        frame: system.model.frame(body).unwrap(),
        position: [written(x), Signal::constant(0.0), Signal::constant(0.0)],
        rpy: None,
    };
    (system.model, task)
}

const GUESS: [f64; 4] = [0.3, -0.8, 0.9, -0.5];

#[test]
fn a_path_hears_an_interrupt() {
    // Half a minute of work, and nearly as many stretches as a path may have.
    let (model, task) = task("0.8 + 0.05*sin(t)");
    let (end, max_step) = (40.0, Some(1e-4));
    let interrupted_after = |wait: Duration| {
        let stop = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                std::thread::sleep(wait);
                stop.store(true, Ordering::Relaxed);
            });
            GripperPath::new(&model, task.clone(), &GUESS, &Course { end, max_step, stop: &stop })
        })
    };
    // Where the machine is busy the first interrupts may come before it begins.
    let late = |path: &GripperPath| !matches!(path.failure(), Some(PathError::Interrupted { t: 0.0 }));
    let path = (1..12).map(|k| interrupted_after(Duration::from_millis(20 << k))).find(late).unwrap();
    let failure = path.failure();
    let Some(PathError::Interrupted { t }) = failure else { panic!("{failure:?}") };
    assert!(0.0 < t && t < end, "{t}");
    // A run along it is interrupted, and has not failed.
    let error: RunError = PathError::Interrupted { t }.into();
    assert!(matches!(error, RunError::Interrupted { .. }));
    let (mut q, mut v, mut a) = ([0.0; 4], [0.0; 4], [0.0; 4]);
    assert_eq!(path.at(&model, end, &mut q, &mut v, &mut a).unwrap_err(), PathError::Interrupted { t });
}

#[test]
#[ignore = "long"]
fn a_path_that_swings_too_often_is_given_up() {
    let (model, task) = task("0.8 + 1e-3*sin(5e5*t)");
    let begun = Instant::now();
    let path = GripperPath::new(&model, task, &GUESS, &Course { end: 10.0, max_step: None, stop: &Stop::new(false) });
    let failure = path.failure().expect("too much");
    println!("{failure} ({:?})", begun.elapsed());
    assert!(matches!(failure, PathError::TooManyStretches { .. }), "{failure}");
    assert!(failure.to_string().contains("shorten the motion"), "{failure}");
}

#[test]
fn the_longest_step_holds_for_stretches_too() {
    let (model, task) = task("0.8");
    let path = |max_step| {
        GripperPath::new(&model, task.clone(), &GUESS, &Course { end: 10.0, max_step, stop: &Stop::new(false) })
    };
    assert!(path(None).failure().is_none() && path(Some(1e-3)).failure().is_none());
    let failure = path(Some(1e-6)).failure();
    assert!(matches!(failure, Some(PathError::TooManyStretches { t: 0.0, .. })), "{failure:?}");
    assert!(failure.unwrap().to_string().contains("shorten the motion"));
}

#[test]
fn whole_turns_in_a_guess_change_nothing() {
    let plain = silent();
    let turned = |turns: f64| plain.replace("q1=-0.8", &format!("q1={:?}", -0.8 + std::f64::consts::TAU * turns));
    let right = run_case(&cases(&plain), 0);
    for turns in [3.0, 1_000.0, -5_000.0, 40_000.0] {
        let begun = Instant::now();
        let run = run_case(&cases(&turned(turns)), 0);
        assert!(run.error.is_none(), "{:?}", run.error);
        let way = std::f64::consts::TAU * turns;
        let worst = |name: &str, way: f64| {
            let pairs = run.column(name).into_iter().zip(right.column(name));
            pairs.map(|(x, y)| (x - way - y).abs()).fold(0.0, f64::max)
        };
        let (q, others) = (worst("q.q1", way), worst("q.q0", 0.0).max(worst("q.q3", 0.0)));
        println!("{turns} turns: {q:.1e}, {others:.1e}, {:?}", begun.elapsed());
        // As far as the coordinate itself is rounded.
        let rounding = 1e-9 + 1e4 * f64::EPSILON * way.abs();
        assert!(q < rounding && others < rounding, "{turns} turns: {q:.1e} {others:.1e}");
    }
}
