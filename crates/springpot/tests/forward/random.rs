//! Random robots with everything that may act on them: the energy balance closes.

use crate::support::forward::{distance, every};
use crate::support::run;
use std::fmt::Write as _;

/// The next number in [0, 1) of splitmix64.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn vector(&mut self, size: f64) -> [f64; 3] {
        [0; 3].map(|_| self.within(-size, size))
    }

    fn pick<'a>(&mut self, from: &[&'a str]) -> &'a str {
        from[(self.unit() * from.len() as f64) as usize]
    }
}

/// What a random robot is made of.
struct Options {
    floating: bool,
    friction: bool,
    sticks: bool,
    kinks: bool,
    held: bool,
    varying: bool,
}

fn element(random: &mut Random, k: usize, bodies: usize, varying: bool) -> String {
    let (a, b, c) = (random.within(5.0, 200.0), random.within(5.0, 100.0), random.within(5.0, 100.0));
    let alpha = random.within(0.02, 0.98);
    let input = |base: f64| if varying { format!("\"{base} + 0.2*{base}*sin(25*t)\"") } else { base.to_string() };
    let law = match (random.unit() * 6.0) as usize {
        0 => format!("law = \"spring\"\nparameters = {{ k = {a} }}"),
        1 => format!("law = \"kelvin-voigt\"\nparameters = {{ k = {a}, c = {b} }}"),
        2 => format!("law = \"fractional-kelvin-voigt\"\nparameters = {{ k = {a}, c = {b}, alpha = {alpha} }}"),
        3 => format!(
            "law = \"thermoviscoelastic\"\ninputs = {{ T = {} }}\n\
             parameters = {{ E_c = {a}, E_kv = {b}, E_d = {c}, alpha = {alpha}, a_kv = 0.001 }}",
            input(300.0)
        ),
        4 => format!(
            "law = \"piezo-kelvin-voigt\"\ninputs = {{ U = {} }}\n\
             parameters = {{ E_c = {a}, E_pz = {b}, E_d = {c}, alpha = {alpha}, alpha_pz = 0.0005 }}",
            input(60.0)
        ),
        _ => format!(
            "law = \"magnetorheological\"\ninputs = {{ u = {} }}\n\
             parameters = {{ E_c = {a}, mu_0 = {b}, mu = {c}, alpha = {alpha} }}",
            input(1.0)
        ),
    };
    let mut from = random.vector(3.0);
    from[2] += if from[2] < 0.0 { -6.0 } else { 6.0 };
    let length = from.iter().map(|x| x * x).sum::<f64>().sqrt() * random.within(0.8, 1.1);
    let (to, body) = (random.vector(0.2), (random.unit() * bodies as f64) as usize);
    format!(
        "[[element]]\nname = \"e{k}\"\nfrom = {{ body = \"world\", point = {from:?} }}\n\
         to = {{ body = \"b{body}\", point = {to:?} }}\nrest_length = {length}\n{law}\n"
    )
}

fn robot(random: &mut Random, options: &Options) -> String {
    let mut text = "[robot]\n".to_owned();
    let (mut torques, mut prescribed, mut locked, mut q, mut v) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let bodies = 2 + (random.unit() * 4.0) as usize;
    for k in 0..bodies {
        let kind =
            if options.floating && k == 0 { "floating" } else { random.pick(&["revolute", "prismatic", "continuous"]) };
        let _ = writeln!(text, "[[robot.body]]\nname = \"b{k}\"");
        if k > 0 {
            let _ = writeln!(text, "parent = \"b{}\"", (random.unit() * k as f64) as usize);
        }
        let mut joint = format!("name = \"j{k}\", kind = \"{kind}\", origin = {:?}", random.vector(0.3));
        if kind != "floating" {
            let _ = write!(joint, ", axis = {:?}, damping = {}", random.vector(1.0), random.within(0.0, 0.5));
            if options.friction {
                let force = random.within(0.1, 2.0) * if options.sticks { 5.0 } else { 1.0 };
                let _ = match options.sticks {
                    true => write!(joint, ", friction = {{ force = {force}, stick = true }}"),
                    false => write!(joint, ", friction = {force}"),
                };
            }
        }
        let inertia = [0; 3].map(|_| random.within(0.05, 0.08));
        let _ =
            writeln!(text, "joint = {{ {joint} }}\nmass = {}\ncom = {:?}", random.within(0.5, 5.0), random.vector(0.2));
        let _ = writeln!(text, "inertia = {{ xx = {}, yy = {}, zz = {} }}", inertia[0], inertia[1], inertia[2]);
        if kind == "floating" {
            torques.push(format!("j{k} = {{ vx = \"3*sin(5*t)\", wz = 0.5 }}"));
            q.push(format!("j{k} = {{ x = 0.1, rpy = [0.3, -0.4, 1.0] }}"));
            v.push(format!("j{k} = {{ vy = 0.5, wx = 2, wz = -3 }}"));
            continue;
        }
        let choice = random.unit();
        if options.held && k > 0 && choice < 0.3 {
            let path = if options.kinks { "0.2*abs(sin(6*t))" } else { "0.2*sin(6*t)" };
            prescribed.push(format!("j{k} = \"{path}\""));
            continue;
        } else if options.held && k > 0 && choice < 0.5 {
            locked.push(format!("\"j{k}\""));
        } else {
            let torque = if options.kinks {
                random.pick(&["4*abs(sin(9*t))", "3*step(t - 0.2)", "min(5*t, 1)", "2*sign(cos(13*t))"])
            } else {
                random.pick(&["2*sin(7*t)", "0", "exp(-t)"])
            };
            torques.push(format!("j{k} = \"{torque}\""));
            v.push(format!("j{k} = {}", random.within(-2.0, 2.0)));
        }
        q.push(format!("j{k} = {}", random.within(-1.0, 1.0)));
    }
    for k in 0..1 + (random.unit() * 3.0) as usize {
        text.push_str(&element(random, k, bodies, options.varying));
    }
    let _ = writeln!(text, "[motion]\nkind = \"forward\"\ntorque = {{ {} }}", torques.join(", "));
    let _ = writeln!(text, "start = {{ q = {{ {} }}, v = {{ {} }} }}", q.join(", "), v.join(", "));
    let _ = writeln!(text, "prescribed = {{ {} }}\nlocked = [{}]", prescribed.join(", "), locked.join(", "));
    text
}

fn balances(name: &str, seed: u64, count: usize, options: &Options) {
    let mut random = Random(seed);
    let mut worst = 0.0f64;
    for _ in 0..count {
        let robot = robot(&mut random, options);
        for rtol in [1e-6, 1e-8] {
            let text = robot.clone() + &every(0.6, 0.05, rtol) + "max_step = 0.6\n";
            let run = run(&text);
            assert!(run.rows.iter().flatten().all(|x| x.is_finite()), "{text}");
            let share = run.residual() / rtol;
            if share > worst {
                println!(
                    "{name}: {share:.2} rtol at {rtol:e}, {} + {} steps",
                    run.report.steps, run.report.rejected_steps
                );
            }
            worst = worst.max(share);
            assert!(share <= 10.0, "{share} rtol at {rtol:e}: {:?}\n{text}", run.report);
        }
    }
    println!("{name}: worst {worst:.2} rtol of the energy turned over");
}

const PLAIN: Options =
    Options { floating: false, friction: false, sticks: false, kinks: false, held: false, varying: false };

#[test]
fn the_balance_closes_with_damping_and_torques() {
    balances("plain", 1, 12, &PLAIN);
}

#[test]
fn the_balance_closes_with_friction() {
    balances("friction", 2, 8, &Options { friction: true, ..PLAIN });
}

#[test]
fn the_balance_closes_with_kinks_and_varying_inputs() {
    balances("kinks", 3, 8, &Options { kinks: true, varying: true, ..PLAIN });
}

#[test]
fn the_balance_closes_with_prescribed_and_locked_joints() {
    balances("held", 4, 12, &Options { held: true, varying: true, ..PLAIN });
    balances("held with kinks", 5, 8, &Options { held: true, kinks: true, ..PLAIN });
}

#[test]
fn the_balance_closes_with_floating_bases() {
    balances("floating", 6, 8, &Options { floating: true, ..PLAIN });
    balances("everything", 7, 8, &EVERYTHING);
}

const EVERYTHING: Options =
    Options { floating: true, friction: true, sticks: false, kinks: true, held: true, varying: true };

#[test]
fn the_balance_closes_with_friction_that_sticks() {
    balances("sticking", 8, 12, &Options { friction: true, sticks: true, kinks: true, ..PLAIN });
    balances("sticking with everything", 9, 16, &Options { sticks: true, ..EVERYTHING });
}

#[test]
fn smooth_friction_tends_to_friction_that_sticks() {
    let mut random = Random(10);
    let (mut worst, mut stops) = (0.0f64, 0);
    for _ in 0..6 {
        let text = robot(&mut random, &Options { friction: true, sticks: true, kinks: true, ..PLAIN });
        let text = text + &every(0.8, 0.01, 1e-8);
        let sticking = run(&text);
        let columns: Vec<&String> = sticking.names.iter().filter(|name| name.starts_with("q.")).collect();
        let off = |speed: &str| {
            let smooth = run(&text.replace("stick = true", &format!("speed = {speed}")));
            columns.iter().map(|q| distance(&sticking.column(q), &smooth.column(q))).fold(0.0, f64::max)
        };
        let apart = ["1e-4", "1e-6"].map(off);
        println!("{apart:?}");
        // The smooth law creeps at its speed.
        assert!(apart[0] < 3e-3 && apart[1] < 0.03 * apart[0] + 1e-7, "{apart:?}\n{text}");
        worst = worst.max(apart[1]);
        for name in sticking.names.iter().filter(|name| name.starts_with("v.")) {
            stops += sticking.column(name).windows(2).filter(|v| v[0] != 0.0 && v[1] == 0.0).count();
        }
    }
    println!("worst {worst:.1e}, {stops} stops");
    assert!(stops > 5, "{stops}");
}
