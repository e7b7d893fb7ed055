//! Every law on robots that are not the papers': sliding joints, branches, elements to the world, random smooth motions. Every
//! D^alpha x, force and generalized force within 1e-9 of the largest of its curve against quadrature and the law's equation.

use crate::support::robots::every;
use crate::support::truth::{derivatives, pair_at};
use crate::support::{cases, largest, run, run_case};
use springpot::law::{Catalog, Derivative, Point};
use std::fmt::Write as _;

const TOLERANCE: f64 = 1e-9;

/// The same numbers on every machine.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn vector(&mut self, size: f64) -> [f64; 3] {
        std::array::from_fn(|_| self.between(-size, size))
    }
}

/// A tree of revolute and prismatic joints; body k hangs on an earlier one or on the world.
fn robot(random: &mut Random, bodies: usize) -> String {
    let mut text = String::new();
    for k in 0..bodies {
        let kind = if random.unit() < 0.6 { "revolute" } else { "prismatic" };
        let parent = match k {
            0 => "world".to_owned(),
            _ => format!("b{}", (random.unit() * k as f64) as usize),
        };
        let [axis, origin, com] = [1.0, 0.4, 0.1].map(|size| random.vector(size));
        let (rpy, mass) = (random.vector(1.5), random.between(0.5, 4.0));
        writeln!(
            text,
            "[[robot.body]]\nname = \"b{k}\"\nparent = \"{parent}\"\nmass = {mass}\ncom = {com:?}\n\
             joint = {{ name = \"j{k}\", kind = \"{kind}\", axis = {axis:?}, origin = {origin:?}, rpy = {rpy:?} }}\n\
             inertia = {{ xx = 0.02, yy = 0.03, zz = 0.04, xy = 0.002, xz = -0.001, yz = 0.003 }}"
        )
        .unwrap();
    }
    text
}

/// Sums of a few sines per joint.
fn motion(random: &mut Random, bodies: usize) -> String {
    let signal = |random: &mut Random| {
        let terms: Vec<String> = (0..3)
            .map(|_| {
                let (size, rate, phase) =
                    (random.between(0.02, 0.15), random.between(0.5, 12.0), random.between(0.0, 6.0));
                format!("{size}*sin({rate}*t + {phase})")
            })
            .collect();
        terms.join(" + ")
    };
    let joints: Vec<String> = (0..bodies).map(|k| format!("j{k} = \"{}\"", signal(random))).collect();
    format!("[motion]\nkind = \"prescribed\"\njoints = {{ {} }}\n", joints.join(", "))
}

/// F of a law from x, x', D^alpha x and t.
type Force = fn(x: f64, rate: f64, derivative: f64, t: f64) -> f64;

/// Law, parameters, inputs and its equation, written out once more; `{a}` stands for alpha.
const LAWS: [(&str, &str, &str, Force); 10] = [
    ("spring", "k = \"3 N/mm\"", "", |x, _, _, _| 3000.0 * x),
    ("dashpot", "c = \"2 N*s/cm\"", "", |_, rate, _, _| 200.0 * rate),
    ("springpot", "c = \"5 N*s^alpha/cm\", alpha = {a}", "", |_, _, d, _| 500.0 * d),
    ("kelvin-voigt", "k = 300, c = 20", "", |x, rate, _, _| 300.0 * x + 20.0 * rate),
    ("fractional-kelvin-voigt", "k = 300, c = 20, alpha = {a}", "", |x, _, d, _| 300.0 * x + 20.0 * d),
    (
        "thermoviscoelastic",
        "E_c = 30, E_kv = 20, E_d = 50, alpha = {a}, a_kv = 0.0007",
        "T = { expression = \"25 + 10*sin(t)\", unit = \"degC\" }",
        |x, _, d, t| 50.0 * x + 50.0 * d - 0.014 * (25.0 + 10.0 * t.sin()),
    ),
    (
        "thermoviscoelastic",
        "E_c = 30, E_kv = 20, E_d = 50, alpha = {a}, a_kv = 0.0007, T_ref = \"20 degC\"",
        "T = 310",
        |x, _, d, _| 50.0 * x + 50.0 * d - 0.014 * (310.0 - 293.15),
    ),
    (
        "piezo-kelvin-voigt",
        "E_c = 2000, E_pz = 3000, E_d = 5000, alpha = {a}, alpha_pz = \"10 um/V\"",
        "U = \"60*sin(50*t)\"",
        |x, _, d, t| 5000.0 * x + 5000.0 * d - 0.03 * 60.0 * (50.0 * t).sin(),
    ),
    (
        "magnetorheological",
        "E_c = 2500, mu_0 = 5000, mu = 1000, alpha = {a}",
        "u = \"1 + 0.9*cos(7*t)\"",
        |x, _, d, t| 2500.0 * x + (5000.0 + 1000.0 * (1.0 + 0.9 * (7.0 * t).cos())) * d,
    ),
    ("magnetorheological", "E_c = 2500, mu_0 = 5000, mu = -1000, alpha = {a}", "u = 2", |x, _, d, _| {
        2500.0 * x + 3000.0 * d
    }),
];

#[test]
fn every_law_on_random_robots() {
    let (mut compared, mut worst) = (0, [0.0f64; 3]);
    let (mut ledger, mut ledgers) = (0.0f64, 0);
    for (seed, alpha) in [(1, 0.1), (2, 0.3), (3, 0.5), (4, 0.7), (5, 0.9), (6, 0.0), (7, 1.0), (8, 0.02), (9, 0.98)] {
        let mut random = Random(seed);
        let bodies = 2 + (seed as usize) % 4;
        let (robot, motion) = (robot(&mut random, bodies), motion(&mut random, bodies));
        for derivative in ["caputo", "riemann-liouville"] {
            let mut elements = String::new();
            for (k, (law, parameters, inputs, _)) in LAWS.iter().enumerate() {
                let from = if k % 3 == 0 { "world".to_owned() } else { format!("b{}", k % (bodies - 1)) };
                let to = format!("b{}", bodies - 1);
                let (a, b) = (random.vector(0.3), random.vector(0.3));
                let inputs = if inputs.is_empty() { String::new() } else { format!("inputs = {{ {inputs} }}\n") };
                writeln!(
                    elements,
                    "[[element]]\nname = \"e{k}\"\nfrom = {{ body = \"{from}\", point = [{}, {}, {}] }}\n\
                     to = {{ body = \"{to}\", point = {b:?} }}\nrest_length = 1.1\nlaw = \"{law}\"\n{inputs}\
                     parameters = {{ {} }}\nderivative = \"{derivative}\"",
                    a[0] + 0.8,
                    a[1] - 0.9,
                    a[2] + 1.0,
                    parameters.replace("{a}", &alpha.to_string()),
                )
                .unwrap();
            }
            let text = format!("{robot}{elements}{motion}{}", every(3.0, 0.11));
            let cases = cases(&text);
            let system = cases.plan(0).unwrap().system();
            let run = run_case(&cases, 0);
            assert!(run.error.is_none(), "seed {seed}: {:?}\n{text}", run.error);
            if let Some(residual) = run.report.energy_residual {
                let share = residual / run.report.energy_turned_over.unwrap();
                assert!(share <= 1e-7, "seed {seed}, alpha = {alpha}: the ledger leaves {share:.1e}");
                ledger = ledger.max(share);
                ledgers += 1;
            }
            let times = &run.t()[1..];
            for (k, (law, _, _, force)) in LAWS.iter().enumerate() {
                let case = format!("seed {seed}, alpha = {alpha}, {derivative}, {law}");
                let mut check = |kind: usize, exact: &[f64], column: &str| {
                    let values = &run.column(column)[1..];
                    let error = crate::support::relative_difference(exact, values);
                    assert!(error < TOLERANCE, "{case}: {column} errs by {error:.1e} of {:e}", largest(exact));
                    worst[kind] = worst[kind].max(error);
                    compared += values.len();
                };
                let mut exact = derivatives(&system, k, times, 0.1, &[]);
                let pairs: Vec<_> = times.iter().map(|t| pair_at(&system, &system.elements[k], *t)).collect();
                // Without a fractional derivative a law reports its stroke.
                if *law == "spring" {
                    exact = pairs.iter().map(|(length, ..)| length - 1.1).collect();
                }
                check(0, &exact, &format!("e{k}.derivative"));
                let forces: Vec<f64> = pairs
                    .iter()
                    .zip(&exact)
                    .zip(times)
                    .map(|(((length, rate, _), d), t)| force(length - 1.1, *rate, *d, *t))
                    .collect();
                check(1, &forces, &format!("e{k}.force"));
                for j in 0..bodies {
                    let q: Vec<f64> = pairs.iter().zip(&forces).map(|((.., gradient), f)| -f * gradient[j]).collect();
                    let name = format!("e{k}.Q.j{j}");
                    if largest(&q) > 1e-12 {
                        check(2, &q, &name);
                    } else {
                        assert!(largest(&run.column(&name)[1..]) <= 1e-12, "{case}: {name}");
                    }
                }
            }
        }
    }
    println!("{compared} numbers; worst derivative {:.1e}, force {:.1e}, Q {:.1e}", worst[0], worst[1], worst[2]);
    println!("{ledgers} ledgers, worst residual {ledger:.1e}");
    // Riemann–Liouville with x(0) ≠ 0 has a ledger at the orders 0 and 1 alone.
    assert_eq!(ledgers, 9 + 2);
    assert!(compared > 9 * 2 * 10 * 28 * 3);
}

/// A springpot behind a spring that jumps: its stroke begins alike on every scale of time, the more so the smaller alpha is.
#[test]
fn relaxation_of_a_series_from_its_jump_on() {
    let entry = Catalog::standard();
    let entry = entry.get("fractional-zener").unwrap();
    let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &[] };
    for (alpha, rtol) in [(0.005, 1e-6_f64), (0.01, 1e-6), (0.01, 1e-9), (0.02, 1e-9), (0.3, 1e-9)] {
        let law = entry.build(&[2.0, 30.0, 5.0, alpha], Derivative::Caputo).unwrap();
        let run = run(&format!(
            "[[robot.body]]\nname = \"a\"\njoint = {{ name = \"x\", kind = \"prismatic\", axis = [1, 0, 0] }}\nmass = 1\n\
             [[element]]\nname = \"s\"\njoint = \"x\"\nlaw = \"fractional-zener\"\npast = \"unloaded\"\n\
             parameters = {{ k_e = 2, k_m = 30, c = 5, alpha = {alpha} }}\n[motion]\nkind = \"prescribed\"\njoints = {{ x = 1 }}\n\
             [time]\nend = 10\noutput_times = {{ from = 1e-5, to = 10, count = 13, scale = \"log\" }}\n[solver]\nrtol = {rtol:e}\n"
        ));
        for (t, force) in run.t().into_iter().zip(run.column("s.force")) {
            let [exact, _] = law.relaxation(&at, t, 0.0).unwrap();
            let error = (force / exact - 1.0).abs();
            assert!(error < 10.0 * rtol.min(1e-8), "{alpha} {rtol:e} {t:e}: {error:e}");
        }
    }
}
