//! Dampers behind a driver: Spencer's against an integration of its own, the others against closed forms, tangents, energies, rules.

use crate::support::oracle::{column, file};
use crate::support::{Run, run, try_run};
use crate::{along, departure};
use num_complex::Complex64;
use springpot::collocation::Nodes;
use springpot::elements::{ElementBank, MemoryRange};
use springpot::fractional::Form;
use springpot::law::{
    Catalog, Course, Derivative, InputValue, LeafState, Network, NetworkText, Point, Start, State, Step, When,
};

/// The published set of the prototype, N, m, s, V.
pub(crate) const SPENCER: &str = "c_0a = \"21 N*s/cm\", c_0b = \"3.5 N*s/(cm*V)\", c_1a = \"283 N*s/cm\", \
    c_1b = \"2.95 N*s/(cm*V)\", k_0 = \"46.9 N/cm\", k_1 = \"5 N/cm\", x_0 = \"14.3 cm\", alpha_a = \"140 N/cm\", \
    alpha_b = \"695 N/(cm*V)\", A = 301, beta = 3.63e6, gamma = 3.63e6, n = 2, eta = \"190 1/s\"";

const SPENCER_SI: [f64; 14] =
    [2100.0, 350.0, 28300.0, 295.0, 4690.0, 500.0, 0.143, 14000.0, 69500.0, 301.0, 3.63e6, 3.63e6, 2.0, 190.0];

/// A slider with one element on its joint.
fn slider(law: &str, parameters: &str, u: &str, motion: &str, time: &str, rtol: f64) -> String {
    format!(
        "[robot]\ngravity = [0, 0, 0]\n[[robot.body]]\nname = \"b\"\nmass = 10\n\
         joint = {{ name = \"q\", kind = \"prismatic\", axis = [1, 0, 0] }}\n\
         [[element]]\nname = \"d\"\njoint = \"q\"\nlaw = \"{law}\"\nparameters = {{ {parameters} }}\ninputs = {{ u = \"{u}\" }}\n\
         [motion]\n{motion}\n[time]\n{time}\n[solver]\nrtol = {rtol:e}\nmax_steps = 400000\n"
    )
}

const SINE: &str = "kind = \"prescribed\"\njoints = { q = \"0.015*sin(5*pi*t)\" }";

fn tested(u: &str, rtol: f64) -> Run {
    run(&slider("spencer", SPENCER, u, SINE, "end = 1\noutput_step = 0.005", rtol))
}

/// 2.5 Hz, 1.5 cm, 0 … 2.25 V, and a command that is switched (testdata/dampers): forces and energies of every row.
#[test]
fn spencers_damper_under_the_standard_test() {
    let reference = file("dampers/spencer.json");
    let commands = [
        ("sine 0.0 V", "0"),
        ("sine 0.75 V", "0.75"),
        ("sine 1.5 V", "1.5"),
        ("sine 2.25 V", "2.25"),
        ("steps", "2.25*step(t - 0.3) - 1.75*step(t - 0.7)"),
    ];
    for (case, u) in commands {
        let rows = &reference["cases"][case];
        for rtol in [1e-6, 1e-9] {
            let run = tested(u, rtol);
            let off = |name: &str, index: usize| departure(&run.column(name), &column(rows, index));
            let force = off("d.force", 1);
            let energies = [off("d.stored", 5), off("d.dissipated", 6)];
            println!(
                "{case} {rtol:e}: force {force:.1e}, stored and dissipated {:.1e} {:.1e}, residual {:.1e}, {} steps",
                energies[0],
                energies[1],
                run.residual(),
                run.effort()
            );
            assert!(force < rtol, "{case}: {force:e} at {rtol:e}");
            assert!(energies.iter().all(|error| *error < 0.1 * rtol), "{case}: {energies:?} at {rtol:e}");
            assert!(run.residual() < 10.0 * rtol, "{case}: {:e} at {rtol:e}", run.residual());
            if case != "steps" {
                // A turn of the loop: the work of the actuators is what is lost and held.
                let turn = |name: &str| run.column(name)[200] - run.column(name)[120];
                let [area, lost, held] = ["energy.actuators", "d.dissipated", "d.stored"].map(turn);
                assert!((area - lost - held).abs() < 1e-8 * area, "{case}: {area} J, {lost} J");
            } else {
                let input = off("d.input", 7);
                assert!(input < 100.0 * rtol, "{input:e}");
            }
        }
    }
}

fn law(name: &str, values: &[f64]) -> Network {
    Catalog::standard().get(name).unwrap().build(values, Derivative::Caputo).unwrap()
}

/// Every law with an input of its own driver or circuit, of sizes that matter at strokes of some 0.1 m and rates of some 1 m/s.
fn laws() -> Vec<Network> {
    let loops = [50.0, 80.0, 20.0, 0.9, 120.0, 300.0, 2.0, 30.0];
    let damper = |first: &[f64]| [first, &[40.0, 0.02], &loops[..2], &loops[3..]].concat();
    let stack = [90.0, 1.5, 8.0, -1.0, 6.0, 0.4, 0.03, 5.0, 0.0, 0.1];
    let hysteretic = |more: &[f64]| [&stack[..], more].concat();
    let plays = hysteretic(&[0.2, 0.3, 0.1, 0.25]);
    vec![
        law("spencer", &[8.0, 2.0, 90.0, 7.0, 30.0, 12.0, 0.05, 40.0, 60.0, 3.0, 120.0, 300.0, 1.5, 30.0]),
        law("bouc-wen-damper", &damper(&[3.0, 1.5])),
        law("fractional-bouc-wen-damper", &damper(&[3.0, 1.5, 0.4])),
        law("bingham", &[2.0, 3.0, 0.3, 4.0, 1.0, 7.0, 30.0]),
        law("fractional-bingham", &[2.0, 3.0, 0.3, 4.0, 1.0, 0.6, 7.0, 30.0]),
        law("piezo-stack", &stack),
        law("piezo-stack-bouc-wen", &hysteretic(&[0.4, 0.8, 0.1, 0.5, 2.0])),
        law("piezo-stack-prandtl-ishlinskii", &plays),
        law("piezo-stack-feed-forward", &plays),
    ]
}

/// A step of a law, as it is told it.
#[derive(Clone)]
struct Told {
    nodes: Nodes,
    data: [Vec<f64>; 3],
}

impl Told {
    fn of<T>(&self, ask: impl FnOnce(&Step) -> T) -> T {
        let inputs: Vec<InputValue> =
            self.data[2].iter().map(|value| InputValue { value: *value, rate: 2.0 }).collect();
        ask(&Step {
            t: 0.0,
            h: 0.04,
            nodes: self.nodes,
            places: None,
            form: Form::Rates,
            stroke: &self.data[0],
            rate: &self.data[1],
            inputs: &inputs,
            resolution: 1e-17,
            course: Course::Given,
        })
    }
}

#[test]
fn tangents_are_those_of_differences() {
    let behind = |law: &Network| {
        let beside = Network::parallel([law.clone(), Network::springpot(40.0, 0.4, Derivative::Caputo)]);
        Network::series([Network::spring(70.0), beside])
    };
    for law in laws().iter().flat_map(|law| [law.clone(), behind(law)]) {
        for nodes in [Nodes::Radau, Nodes::Inner, Nodes::Midpoint, Nodes::One] {
            let count = nodes.count();
            let data = [[0.03, 0.032, 0.045, 0.071, 0.08], [0.4, 0.51, 0.2, 0.33, 0.25], [0.6, 0.7, 0.66, 0.8, 0.76]];
            let told = Told { nodes, data: data.map(|values| values[..=count].to_vec()) };
            let start = InputValue { value: 0.6, rate: 0.0 };
            let mut state = law.begin(&Start { stroke: 0.03, jump: 0.0, inputs: &[start] }).unwrap();
            state.open(1e-10, 1e-3, 1.0).unwrap();
            told.of(|step| law.prepare(step, &mut state));
            let response = told.of(|step| law.evaluate(step, &state));
            let by_input = told.of(|step| law.by_input(step, &state, 0));
            for j in 0..count {
                for (which, exact) in [response.d_stroke, response.d_rate, by_input].iter().enumerate() {
                    let size = 1e-6;
                    let sides = [size, -size].map(|size| {
                        let mut moved = told.clone();
                        moved.data[which][j + 1] += size;
                        moved.of(|step| law.evaluate(step, &state)).force
                    });
                    for i in 0..count {
                        let difference = (sides[0][i] - sides[1][i]) / (2.0 * size);
                        let off = (exact[i][j] - difference).abs();
                        let case = format!("{law:?} {nodes:?} {which} {i} {j}");
                        assert!(off < 1e-5 * (1.0 + difference.abs()), "{} {difference}: {case}", exact[i][j]);
                    }
                }
            }
        }
    }
}

/// A stack behind a spring tells of its own circuit: R·q' + V = U, F = k·x − T·V of its own stroke.
#[test]
fn a_stack_in_a_series_tells_its_voltage() {
    let (values, u) = ([90.0, 1.5, 8.0, -1.0, 0.0, 1.0, 0.03, 5.0, 0.0, 0.1], 0.6);
    let [k, t, r] = [90.0 / 1.5, 90.0 / 8.0, 5.0];
    let law = Network::series([Network::spring(70.0), law("piezo-stack", &values)]);
    assert_eq!(law.tells().iter().map(|told| told.key).collect::<Vec<_>>(), ["voltage", "charge", "current"]);
    let inputs = [InputValue { value: u, rate: 0.0 }];
    let mut state = law.begin(&Start { stroke: 0.0, jump: 0.0, inputs: &inputs }).unwrap();
    let told = Told { nodes: Nodes::Radau, data: [vec![0.0, 0.01, 0.02, 0.03], vec![0.75; 4], vec![u; 4]] };
    let check = |when: When, at: &Point, state: &State, leaves: &[LeafState], force: f64| {
        let mut own = Vec::new();
        law.tell(when, at, state, &mut own);
        let [voltage, _, current] = own[..] else { panic!("a stack has a circuit: {own:?}") };
        let stack: f64 = leaves[1..].iter().map(|leaf| leaf.force).sum();
        assert!((voltage - (k * leaves[1].stroke - force) / t).abs() < 1e-12 && voltage != 0.0, "{own:?}");
        assert!((r * current + voltage - u).abs() < 1e-12 && (stack - force).abs() < 1e-12, "{own:?} {leaves:?}");
    };
    told.of(|step| {
        let (at, mut leaves) = (step.point(3), Vec::new());
        law.leaves_at(step, 1.0, &at, &state, &mut leaves);
        let force = law.at(step, 1.0, &at, &state).force();
        check(When::Within(step, 1.0), &at, &state, &leaves, force);
    });
    told.of(|step| law.commit(step, &mut state));
    let (at, mut leaves) = (Point { t: 0.04, stroke: 0.03, rate: 0.75, inputs: &inputs }, Vec::new());
    law.leaves_now(&at, &state, &mut leaves);
    check(When::Between, &at, &state, &leaves, law.now(&at, &state).force());
}

/// Bouc-Wen along the motion of the papers: for beta = gamma and n = 2, z = Z tanh(x/Z) away from 0 and straight back to it.
#[test]
fn bouc_wen_along_the_motion_of_the_papers() {
    let (gamma, stiffness) = (300.0f64, 5000.0);
    let mut text = std::fs::read_to_string(crate::support::scenarios().join("thermoviscoelastic_order.toml")).unwrap();
    text.truncate(text.find("[[sweep]]").unwrap());
    let from = text.find("law = ").unwrap();
    let to = from + text[from..].find("[motion]").unwrap();
    text.replace_range(
        from..to,
        "law = \"bouc-wen\"\nparameters = { alpha_h = 5000, A = 1, beta = 300, gamma = 300, n = 2 }\n",
    );
    let text = text.replace("output_step = \"10 ms\"", "output_step = \"1 ms\"")
        + "[solver]\nrtol = 1e-11\nmax_steps = 1000000\n";
    let run = run(&text);
    let name = run.names.iter().find_map(|name| name.strip_suffix(".stroke")).unwrap().to_owned();
    let [x, v, forces] = ["stroke", "rate", "force"].map(|what| run.column(&format!("{name}.{what}")));
    let top = (2.0 * gamma).sqrt().recip();
    let (mut z, mut exact) = (0.0f64, vec![0.0]);
    let start = x[0];
    let go = |z: &mut f64, mut left: f64| {
        if *z * left < 0.0 {
            let to_zero = z.abs().min(left.abs()).copysign(left);
            *z += to_zero;
            left -= to_zero;
        }
        if left != 0.0 {
            *z = top * ((*z / top).atanh() + left / top).tanh();
        }
    };
    let h = 1e-3;
    let mut turns = 0;
    for k in 1..x.len() {
        if v[k - 1] * v[k] < 0.0 {
            // The stroke where it turns round, of the cubic through strokes and rates.
            let cubic = |s: f64| {
                let (a, b) = (x[k - 1], x[k]);
                let (p, q) = (h * v[k - 1], h * v[k]);
                a + s * p + s * s * (3.0 * (b - a) - 2.0 * p - q) + s * s * s * (2.0 * (a - b) + p + q)
            };
            let slope = |s: f64| (cubic(s + 1e-6) - cubic(s - 1e-6)) / 2e-6;
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if slope(middle) * v[k - 1] > 0.0 { low = middle } else { high = middle }
            }
            let turn = cubic(low);
            go(&mut z, turn - x[k - 1]);
            go(&mut z, x[k] - turn);
            turns += 1;
        } else {
            go(&mut z, x[k] - x[k - 1]);
        }
        exact.push(stiffness * z);
    }
    let error = departure(&forces, &exact);
    println!("{error:.1e} over {turns} turns from {start}, {} steps", run.effort());
    assert!(error < 1e-10 && turns > 20, "{error:e} over {turns} turns");
    assert!(run.residual() < 1e-10, "{:e}", run.residual());
}

/// At a constant rate behind a driver that is switched: w is an exponential.
#[test]
fn bingham_follows_its_driver() {
    let (v, eta, switched) = (0.1, 40.0, 0.3);
    let u = "0.5 + 1.5*step(t - 0.3)";
    let w = |t: f64| if t < switched { 0.5 } else { 2.0 - 1.5 * (-eta * (t - switched)).exp() };
    for (name, order) in [("bingham", 1.0), ("fractional-bingham", 0.4f64)] {
        let of_order = if order == 1.0 { String::new() } else { format!(", alpha = {order}") };
        let parameters =
            format!("F_ya = 20, F_yb = 30, v_0 = 0.02, c_a = 100, c_b = 50, F_0 = -7, eta = {eta}{of_order}");
        let run = run(&slider(name, &parameters, u, &along("0.1*t"), "end = 1\noutput_step = 0.02", 1e-9));
        let derivative = |t: f64| v * t.powf(1.0 - order) / springpot::fractional::gamma::gamma(2.0 - order);
        let exact = |t: f64| (20.0 + 30.0 * w(t)) * (v / 0.02f64).tanh() + (100.0 + 50.0 * w(t)) * derivative(t) - 7.0;
        let wanted: Vec<f64> = run.t().iter().map(|t| exact(*t)).collect();
        let error = departure(&run.column("d.force")[1..], &wanted[1..]);
        assert!(error < 1e-8, "{name}: {error:e}");
        assert!(run.residual() < 1e-8, "{name}: {:e}", run.residual());
    }
}

/// Under a constant command they are networks of leaves; a springpot of the order 1 is a dashpot.
#[test]
fn under_a_constant_command_they_are_networks() {
    let loops = "alpha_a = 900, alpha_b = 400, A = 1.2, beta = 3e4, gamma = 6e4, n = 2, eta = 50";
    let parameters = format!("c_0a = 150, c_0b = 40, k_0 = 700, x_0 = 0.01, {loops}");
    let fractional = format!("{parameters}, alpha = 1");
    let ran = |law: &str, parameters: &str, u: &str| {
        let run = run(&slider(law, parameters, u, SINE, "end = 1\noutput_step = 0.01", 1e-9));
        assert!(run.residual() < 1e-8, "{law}: {:e}", run.residual());
        run.column("d.force")
    };
    let alone = ran("bouc-wen-damper", &parameters, "2");
    let text = "parallel(dashpot(c), spring(k), preload(f), bouc-wen(a, A, b, g, n))";
    let network = NetworkText::parse(text)
        .unwrap()
        .entry()
        .build(&[230.0, 700.0, -7.0, 1700.0, 1.2, 3e4, 6e4, 2.0], Derivative::Caputo);
    let parts = crate::slider(&[network.unwrap()], &along("0.015*sin(5*pi*t)"), 1.0, 100, 1e-9);
    assert!(departure(&alone, &crate::force(&parts)) < 1e-9);
    let [integer, fractional] = [("bouc-wen-damper", &parameters), ("fractional-bouc-wen-damper", &fractional)]
        .map(|(law, parameters)| ran(law, parameters, "1 + sin(9*t)"));
    assert!(departure(&fractional, &integer) < 1e-8);
}

/// About rest Spencer's damper is k_1 beside c_1 in series with c_0, k_0 and alpha·A, side by side: under small sines as well.
#[test]
fn spencers_damper_about_rest() {
    let u = [InputValue { value: 1.5, rate: 0.0 }];
    let at = Point { t: 0.0, stroke: 0.2, rate: 0.0, inputs: &u };
    let rest = law("spencer", &SPENCER_SI).at_rest(&at, 0.0).unwrap();
    assert!((rest.force - 500.0 * (0.2 - 0.143)).abs() < 1e-12 && rest.stiffness == Some(500.0), "{rest:?}");
    let (c_0, c_1, alpha) = (2100.0 + 350.0 * 1.5, 28300.0 + 295.0 * 1.5, 14000.0 + 69500.0 * 1.5);
    let s = Complex64::new(0.0, 300.0);
    let inner = c_0 * s + 4690.0 + 301.0 * alpha;
    let exact = 500.0 + (inner.inv() + (c_1 * s).inv()).inv();
    assert!((rest.tangent.modulus(s) - exact).norm() < 1e-12 * exact.norm());
    assert!((rest.tangent.reduced().modulus(s) - exact).norm() < 1e-12 * exact.norm());
    assert_eq!(rest.tangent.gain(s, 0), Complex64::ZERO);
    let motion = along("1e-8*sin(300*t)");
    let run = run(&slider("spencer", SPENCER, "1.5", &motion, "end = 0.4\noutput_step = 1e-3", 1e-9));
    let force: Vec<f64> = run.column("d.force")[200..].iter().map(|f| f + 500.0 * 0.143).collect();
    let wanted: Vec<f64> = run.t()[200..].iter().map(|t| (exact * 1e-8 * (s * *t).exp()).im).collect();
    let error = departure(&force, &wanted);
    assert!(error < 1e-5, "{error:e}");
}

#[test]
fn it_brakes_a_mass_in_forward_runs() {
    let motion = "kind = \"forward\"\nstart = { v = { q = 0.5 } }\ntorque = { q = \"800*sin(12*t)\" }";
    let moved = |rtol| {
        let text = slider("spencer", SPENCER, "1 + 0.8*sin(20*t)", motion, "end = 1\noutput_step = 0.02", rtol);
        let run = run(&text);
        assert!(run.residual() < 10.0 * rtol, "{:e} at {rtol:e}", run.residual());
        run
    };
    let [rough, fine] = [1e-7, 1e-10].map(moved);
    let errors = ["q.q", "d.force"].map(|name| departure(&rough.column(name), &fine.column(name)));
    println!("{errors:?} in {} and {} steps", rough.effort(), fine.effort());
    assert!(errors[0] < 1e-6 && errors[1] < 1e-5, "{errors:?}");
}

/// With one node a step the stored energy comes nearer with the order of the step.
#[test]
fn steps_with_one_node_converge() {
    let reference = column(&file("dampers/spencer.json")["cases"]["sine 1.5 V"], 5);
    let omega = 5.0 * std::f64::consts::PI;
    for (nodes, order) in [(Nodes::One, 0.9), (Nodes::Midpoint, 1.7)] {
        let error = |steps: usize| {
            let h = 1.0 / steps as f64;
            let mut bank = ElementBank::new(vec![law("spencer", &SPENCER_SI)], nodes, Form::Strokes);
            let u = [InputValue { value: 1.5, rate: 0.0 }];
            let memory = MemoryRange { tolerance: 1e-9, shortest: h, horizon: 1.0 };
            bank.begin(&[Start { stroke: 0.0, jump: 0.0, inputs: &u }], memory).unwrap();
            let x = |t: f64| 0.015 * (omega * t).sin();
            let mut worst = 0.0f64;
            for n in 0..steps {
                let (t, from, to) = (n as f64 * h, x(n as f64 * h), x((n + 1) as f64 * h));
                bank.start(t, h);
                bank.set(0, 0, from, 0.015 * omega * (omega * t).cos(), &u);
                let c = nodes.positions()[0];
                bank.set(0, 1, from + c * (to - from), (to - from) / h, &u);
                bank.evaluate();
                bank.commit();
                if (n + 1) % (steps / 200) == 0 {
                    // Between two steps it is asked at the stroke of the end.
                    bank.set(0, 1, to, 0.0, &u);
                    worst = worst.max((bank.stored(0).unwrap() - reference[(n + 1) / (steps / 200)]).abs());
                }
            }
            worst
        };
        let found = (error(2000) / error(8000)).log2() / 2.0;
        assert!(found > order, "{nodes:?}: order {found}");
    }
}

/// What is not passive is refused, with its rule: when it is built, and when the command makes it so.
#[test]
fn what_makes_energy_is_refused() {
    let broken = |k: usize, value: f64| {
        let mut values = SPENCER_SI;
        values[k] = value;
        let entry = Catalog::standard().get("spencer").unwrap().clone();
        entry.build(&values, Derivative::Caputo).unwrap_err()
    };
    for (k, value, rule, parameter) in [
        (0, -1.0, "c_0a + u·c_0b ≥ 0", "c_0b"),
        (2, -1.0, "c_1a + u·c_1b ≥ 0", "c_1b"),
        (7, -1.0, "alpha_a + u·alpha_b ≥ 0", "alpha_b"),
        (9, 0.0, "A > 0", "A"),
        (11, 1e6, "gamma ≥ |beta|", "gamma"),
        (12, 0.5, "n ≥ 1", "n"),
        (13, 0.0, "eta > 0", "eta"),
    ] {
        let error = broken(k, value);
        assert_eq!((&*error.rule, &*error.parameter), (rule, parameter));
    }
    let run = try_run(&slider("spencer", SPENCER, "0.5 - t", SINE, "end = 1\noutput_step = 0.005", 1e-6));
    let error = run.error.expect("alpha < 0").to_string();
    assert!(error.contains("alpha_a + u·alpha_b ≥ 0 is broken: alpha is -"), "{error}");
    let bingham = "F_ya = 20, F_yb = -30, v_0 = 0.02, c_a = 100, c_b = 50, F_0 = -7, eta = 40";
    let run = try_run(&slider("bingham", bingham, "t", SINE, "end = 1\noutput_step = 0.005", 1e-6));
    let error = run.error.expect("F_y < 0").to_string();
    assert!(error.contains("F_ya + u·F_yb ≥ 0 is broken"), "{error}");
    // A coefficient that lags says nothing of a stretch before t = 0.
    let entry = Catalog::standard().get("fractional-bingham").unwrap().clone();
    let refused = entry.build(&[2.0, 3.0, 0.3, 4.0, 1.0, 0.6, 7.0, 30.0], Derivative::RiemannLiouville).unwrap_err();
    assert!(refused.rule.starts_with("derivative = \"caputo\""), "{refused}");
}
