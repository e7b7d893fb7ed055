//! Springs that slip, and filled rubber: closed forms by Masing's rules, which know nothing of what has slipped; energies; pasts.

use crate::{along, departure, force, pasts, slider, solved};
use springpot::collocation::Nodes;
use springpot::fractional::Form;
use springpot::fractional::mittag_leffler::MittagLeffler;
use springpot::law::leaf::Jenkins;
use springpot::law::{Course, Derivative, Network, NetworkText, Point, Power, Start, Step};
use std::f64::consts::PI;

/// Force and lost energy of a spring k that slips at F_y after it has gone from 0 to each of `strokes` on one way: dF = k·dx between two turns, cut at ±F_y.
pub(crate) fn cut(k: f64, yields: f64, strokes: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let (mut at, mut force, mut lost) = (0.0, 0.0f64, 0.0);
    for x in strokes {
        let elastic = force + k * (x - at);
        let next = elastic.clamp(-yields, yields);
        lost += yields * (elastic - next).abs() / k;
        (at, force) = (x, next);
    }
    [force, lost]
}

/// Where A·sin ωt has turned round until t, and where it is.
pub(crate) fn sine(amplitude: f64, omega: f64, t: f64) -> impl Iterator<Item = f64> {
    let turns = ((omega * t / PI + 0.5).floor()).max(0.0) as i32;
    let turn = move |k: i32| if k % 2 == 0 { amplitude } else { -amplitude };
    (0..turns).map(turn).chain([amplitude * (omega * t).sin()])
}

fn jenkins(k: f64, yields: f64) -> Network {
    Network::leaf(Jenkins::new(k, yields).unwrap())
}

#[test]
fn along_sines_it_goes_by_masings_rules() {
    let (k, yields, omega) = (2e4, 12.0, 7.0);
    // Below, a little above, and far above the stroke at which it yields, 0.6 mm.
    for amplitude in [0.4e-3, 0.7e-3, 9e-3] {
        for rtol in [1e-6, 1e-9] {
            let run = slider(&[jenkins(k, yields)], &along(&format!("{amplitude}*sin({omega}*t)")), 3.0, 300, rtol);
            let exact: Vec<[f64; 2]> = run.t().iter().map(|t| cut(k, yields, sine(amplitude, omega, *t))).collect();
            let of = |which: usize| exact.iter().map(|both| both[which]).collect::<Vec<f64>>();
            let error = departure(&force(&run), &of(0));
            assert!(error < 1e-8, "{amplitude} at {rtol:e}: {error:e}");
            let stored: Vec<f64> = of(0).iter().map(|force| 0.5 * force * force / k).collect();
            let error = departure(&run.column("e0.stored"), &stored);
            assert!(error < 2e-8, "{amplitude} at {rtol:e}: stored {error:e}");
            let lost = run.column("e0.dissipated");
            assert!(lost.is_sorted(), "{amplitude} at {rtol:e}");
            match amplitude * k < yields {
                true => assert!(lost.iter().all(|lost| *lost == 0.0)),
                false => assert!(departure(&lost, &of(1)) < 1e-6, "{amplitude}: {:e}", departure(&lost, &of(1))),
            }
            // At the ends of steps alone: the last row is one.
            assert!((lost.last().unwrap() - of(1).last().unwrap()).abs() <= 1e-8 * lost.last().unwrap());
            assert!(run.residual() < 10.0 * rtol, "{amplitude}: {:e} at {rtol:e}", run.residual());
        }
    }
}

#[test]
fn filled_rubber_is_the_sum_of_its_parts() {
    let (k, c, alpha, omega) = (3e4, 900.0, 0.3, 11.0);
    let fillers = [[4e4, 6.0], [2e4, 15.0], [1e4, 40.0]];
    let law = format!(
        "law = \"filled-rubber\"\nparameters = {{ k = {k}, c = {c}, alpha = {alpha}, \
         k_f = [4e4, 2e4, 1e4], F_f = [6, 15, 40] }}"
    );
    let derivative = MittagLeffler::new(2.0, 2.0 - alpha).unwrap();
    for amplitude in [0.1e-3, 1e-3, 5e-3] {
        // At rest before: D^α sin ωt = ω t^(1−α) E_{2,2−α}(−ω²t²).
        let run = pasts::slider(&law, &format!("{amplitude}*sin({omega}*t)"), 2.0);
        let exact: Vec<f64> = run
            .t()
            .iter()
            .map(|t| {
                let slips: f64 = fillers.iter().map(|[k, f]| cut(*k, *f, sine(amplitude, omega, *t))[0]).sum();
                let rate = omega * t.powf(1.0 - alpha) * derivative.real(-(omega * t).powi(2));
                k * amplitude * (omega * t).sin() + c * amplitude * rate + slips
            })
            .collect();
        let error = departure(&run.column("e.force"), &exact);
        assert!(error < 1e-8, "{amplitude}: {error:e}");
        // Since ever: D^α sin ωt = ω^α sin(ωt + απ/2), on the steady loop.
        let past = format!("past = \"steady\"\nperiod = {}", 2.0 * PI / omega);
        let run = pasts::slider(&format!("{law}\n{past}"), &format!("{amplitude}*sin({omega}*t + 0.4)"), 2.0);
        let exact: Vec<f64> = run
            .t()
            .iter()
            .map(|t| {
                let phase = omega * t + 0.4;
                // Some periods later the first way is forgotten.
                let later = (phase + 4.0 * PI) / omega;
                let slips: f64 = fillers.iter().map(|[k, f]| cut(*k, *f, sine(amplitude, omega, later))[0]).sum();
                amplitude * (k * phase.sin() + c * omega.powf(alpha) * (phase + 0.5 * alpha * PI).sin()) + slips
            })
            .collect();
        let error = departure(&run.column("e.force"), &exact);
        assert!(error < 1e-8, "steady, {amplitude}: {error:e}");
    }
}

/// A kilogramme on a spring and one that slips: arcs about 0, p, or ∓F_y/k.
#[test]
fn it_swings_freely_by_arcs() {
    let (beside, k, yields) = (40.0, 160.0, 3.0);
    let reach = yields / k;
    let laws = [Network::spring(beside), jenkins(k, yields)];
    for (x, v) in [(0.0, 4.0), (0.0, 0.2), (0.1, 0.0), (-0.2, 1.0)] {
        for rtol in [1e-6, 1e-9] {
            let motion = format!("kind = \"forward\"\nstart = {{ q = {{ q = {x} }}, v = {{ q = {v} }} }}");
            let run = slider(&laws, &motion, 4.0, 100, rtol);
            let exact = arcs(beside, k, reach, [x, v], &run.t());
            let error = departure(&run.column("q.q"), &exact);
            assert!(error < 30.0 * rtol, "{x} {v}: {error:e} at {rtol:e}");
            assert!(run.residual() < 10.0 * rtol, "{x} {v}: {:e} at {rtol:e}", run.residual());
            assert!(run.column("e1.dissipated").is_sorted());
        }
    }
}

/// x'' = −beside·x − k·(x − p) while it sticks, −beside·x ∓ k·reach while it slips.
fn arcs(beside: f64, k: f64, reach: f64, [x, v]: [f64; 2], times: &[f64]) -> Vec<f64> {
    let (mut t, mut at, mut slipped) = (0.0, [x, v], 0.0f64.clamp(x - reach, x + reach));
    // 0 sticks, ±1 slips.
    let mut side = if (x - slipped).abs() >= reach && v * (x - slipped) > 0.0 { v.signum() } else { 0.0 };
    let mut rows = times.iter().copied().peekable();
    let mut wanted = Vec::new();
    loop {
        let (omega, centre) = match side {
            0.0 => ((beside + k).sqrt(), k * slipped / (beside + k)),
            side => (beside.sqrt(), -side * k * reach / beside),
        };
        let [from, start] = [at, [at[0] - centre, at[1] / omega]];
        let go = |s: f64| {
            let (sine, cosine) = (omega * s).sin_cos();
            [centre + start[0] * cosine + start[1] * sine, omega * (start[1] * cosine - start[0] * sine)]
        };
        // Where it yields, or turns round: x or v on a circle about the centre.
        let (radius, phase) = (start[0].hypot(start[1]), start[1].atan2(start[0]));
        let until = match side {
            0.0 => {
                let reached = [slipped + reach, slipped - reach].into_iter().filter_map(|x| {
                    let share = (x - centre) / radius;
                    (share.abs() <= 1.0).then_some(())?;
                    let angles = [phase + share.acos(), phase - share.acos()].map(|angle| angle.rem_euclid(2.0 * PI));
                    // On the end at the start it goes inwards.
                    angles.into_iter().filter(|angle| *angle > 1e-6 && *angle < 2.0 * PI - 1e-6).reduce(f64::min)
                });
                reached.fold(f64::INFINITY, f64::min) / omega
            }
            _ => {
                let angle = phase.rem_euclid(PI);
                (if angle < 1e-6 { angle + PI } else { angle }) / omega
            }
        };
        while rows.peek().is_some_and(|row| *row <= t + until) {
            wanted.push(go(rows.next().unwrap() - t)[0]);
        }
        if rows.peek().is_none() {
            return wanted;
        }
        at = go(until);
        side = match side {
            0.0 => (at[0] - slipped).signum(),
            side => {
                slipped = at[0] - side * reach;
                0.0
            }
        };
        assert!(from != at);
        t += until;
    }
}

#[test]
fn rubber_mounts_ring_down_and_lose_what_they_lose() {
    let parts = [
        Network::spring(300.0),
        Network::springpot(20.0, 0.3, Derivative::Caputo),
        jenkins(400.0, 2.0),
        jenkins(150.0, 7.0),
    ];
    let law = Network::parallel(parts);
    for (x, v, torque) in [("0.1", "0", "0"), ("0", "2", "0"), ("0", "0", "20*sin(9*t)"), ("-0.05", "0.3", "-9.81")] {
        for rtol in [1e-6, 1e-8] {
            let motion = format!(
                "kind = \"forward\"\nstart = {{ q = {{ q = {x} }}, v = {{ q = {v} }} }}\ntorque = {{ q = \"{torque}\" }}"
            );
            let run = slider(std::slice::from_ref(&law), &motion, 3.0, 100, rtol);
            assert!(run.residual() < 10.0 * rtol, "{x} {v} {torque}: {:e} at {rtol:e}", run.residual());
            assert!(run.column("e0.dissipated").is_sorted(), "{x} {v} {torque} at {rtol:e}");
        }
    }
}

#[test]
fn whatever_was_before_it_starts_from_the_stroke() {
    let law = "law = \"filled-rubber\"\nparameters = { k = 1, c = 2, alpha = 0.4, k_f = [100, 300], F_f = [5, 9] }";
    for (x, slips) in [(0.02, 2.0 + 6.0), (0.04, 4.0 + 9.0), (-0.3, -5.0 - 9.0)] {
        for past in ["\"held\"", "\"unloaded\"", "{ held = 3 }"] {
            let run = pasts::slider(&format!("{law}\npast = {past}"), &format!("{x}"), 1.0);
            let plain = pasts::slider(
                &format!(
                    "law = \"fractional-kelvin-voigt\"\nparameters = {{ k = 1, c = 2, alpha = 0.4 }}\npast = {past}"
                ),
                &format!("{x}"),
                1.0,
            );
            for (row, (own, plain)) in run.column("e.force").iter().zip(plain.column("e.force")).enumerate() {
                // Unloaded before, the force is infinite at t = 0.
                if row > 0 || past != "\"unloaded\"" {
                    assert!((own - plain - slips).abs() < 1e-12, "{past} {x}: {own} {plain}");
                }
            }
            // The springpot takes infinite work where it was unloaded before.
            assert!(past == "\"unloaded\"" || run.column("e.dissipated")[0] == 0.0, "{past} {x}");
        }
    }
    let run = slider(&[jenkins(300.0, 9.0)], &along("0.04"), 1.0, 2, 1e-6);
    let [stored, lost] = ["e0.stored", "e0.dissipated"].map(|name| run.column(name)[2]);
    assert!((stored - 0.5 * 81.0 / 300.0).abs() < 1e-14 && lost == 0.0, "{stored} {lost}");
    // What is not linear and no such spring has no steady past.
    let element = pasts::element("law = \"bouc-wen\"\nparameters = { alpha_h = 1, A = 1, beta = 1, gamma = 2, n = 1 }");
    let refused = element.with_past(springpot::law::Past::Periodic(springpot::law::Periodic::new(1.0, &[0.0; 8]).0));
    assert!(refused.unwrap_err().rule.contains("jenkins"));
}

/// The same force and losses in steps of any method: between nodes strokes go one way.
#[test]
fn steps_of_all_nodes_agree() {
    let (k, yields, h) = (50.0, 1.0, 1e-3);
    let law = jenkins(k, yields);
    let [stroke, rate] = [|t: f64| 0.1 * (5.0 * t).sin(), |t: f64| 0.5 * (5.0 * t).cos()];
    for nodes in [Nodes::Radau, Nodes::Midpoint, Nodes::One] {
        let mut state = law.begin(&Start { stroke: 0.0, jump: 0.0, inputs: &[] }).unwrap();
        let mut dissipated = 0.0;
        for n in 0..2000 {
            let t = f64::from(n) * h;
            let times: Vec<f64> = [0.0].iter().chain(nodes.positions()).map(|c| t + c * h).collect();
            let [strokes, rates] = [stroke, rate].map(|of| times.iter().map(|t| of(*t)).collect::<Vec<_>>());
            let step = Step {
                t,
                h,
                nodes,
                places: None,
                form: Form::Strokes,
                stroke: &strokes,
                rate: &rates,
                inputs: &[],
                resolution: 0.0,
                course: Course::Given,
            };
            dissipated += Power::integrate(&law.powers(&step, &state), nodes, h, 1.0).dissipation;
            law.commit(&step, &mut state);
            let [exact, lost] = cut(k, yields, sine(0.1, 5.0, t + h));
            let end = Point { t: t + h, stroke: stroke(t + h), rate: 0.0, inputs: &[] };
            // A turn that lies within a step is seen at its nodes alone.
            let [off, missed] = [law.now(&end, &state).force() - exact, dissipated - lost].map(f64::abs);
            assert!(off < 2e-4 && missed < 1e-4, "{nodes:?} {t}: {off:e} {missed:e}");
        }
    }
}

#[test]
fn steps_need_not_be_many() {
    let law = Network::parallel([Network::spring(100.0), jenkins(50.0, 1.0)]);
    let run = slider(std::slice::from_ref(&law), &along("0.1*sin(5*t)"), 10.0, 10, 1e-6);
    // 16 turns, each with a kink behind it and two where it yields.
    assert!(run.effort() < 1500, "{}", run.effort());
    let run = solved(&[law], "kind = \"forward\"\nstart = { v = { q = 1 } }", 10.0, 10, "rtol = 1e-6");
    assert!(run.effort() < 1500, "{}", run.effort());
}

#[test]
fn springs_behind_it_are_part_of_it() {
    let network =
        |text: &str, values: &[f64]| NetworkText::parse(text).unwrap().entry().build(values, Derivative::Caputo);
    // 1/k = 1/300 + 1/600 + 1/200, and the weaker of both slips alone.
    let chain = network(
        "series(spring(a), slow: jenkins(k, f), series(spring(b), jenkins(a, g)))",
        &[300.0, 1200.0, 4.0, 400.0, 9.0],
    );
    let chain = chain.unwrap();
    assert_eq!(chain.leaf_names(), ["slow"]);
    let k = (1.0 / 300.0 + 1.0 / 1200.0 + 1.0 / 400.0 + 1.0f64 / 300.0).recip();
    let run = slider(&[chain], &along("0.1*sin(5*t)"), 3.0, 60, 1e-9);
    let exact: Vec<f64> = run.t().iter().map(|t| cut(k, 4.0, sine(0.1, 5.0, *t))[0]).collect();
    assert!(departure(&force(&run), &exact) < 1e-9);
    // Side by side they would leave what is behind them free while all of them slip, and so would a play.
    for text in ["series(parallel(jenkins(k, f), jenkins(k, f)), spring(c))", "series(jenkins(k, f), tension(c))"] {
        let refused = network(text, &[10.0, 1.0, 5.0]).unwrap_err();
        assert!(refused.rule.contains("jenkins(k, f)") && refused.rule.contains("would be free"), "{}", refused.rule);
    }
    assert!(
        network("series(parallel(jenkins(k, f), spring(b)), springpot(c, a))", &[10.0, 1.0, 4.0, 5.0, 0.5]).is_ok()
    );
    for (values, rule) in [([0.0, 1.0], "k > 0"), ([1.0, 0.0], "F_y > 0"), ([1.0, f64::NAN], "F_y > 0")] {
        assert_eq!(Jenkins::new(values[0], values[1]).unwrap_err().rule, rule);
    }
}

/// y' = x' − F(y)/c by Runge and Kutta's steps far shorter than any error that counts, F that of a spring that slips and of one beside it: the force behind a
/// dashpot along A·sin ωt.
fn behind_a_dashpot(own: Jenkins, beside: f64, c: f64, [amplitude, omega, end]: [f64; 3], rows: usize) -> Vec<f64> {
    const FINE: usize = 40_000;
    let (mut y, mut slipped, mut forces) = (0.0f64, 0.0f64, vec![0.0]);
    let h = end / (rows * FINE) as f64;
    for n in 0..rows * FINE {
        let t = n as f64 * h;
        let slope = |t: f64, y: f64| amplitude * omega * (omega * t).cos() - (own.force(slipped, y) + beside * y) / c;
        let k1 = slope(t, y);
        let k2 = slope(t + 0.5 * h, y + 0.5 * h * k1);
        let k3 = slope(t + 0.5 * h, y + 0.5 * h * k2);
        let k4 = slope(t + h, y + h * k3);
        y += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        slipped = own.slipped(slipped, y);
        if (n + 1) % FINE == 0 {
            forces.push(own.force(slipped, y) + beside * y);
        }
    }
    forces
}

#[test]
fn in_a_series_it_takes_what_the_others_leave() {
    let build = |text: &str, values: &[f64]| {
        NetworkText::parse(text).unwrap().entry().build(values, Derivative::Caputo).unwrap()
    };
    let own = Jenkins::new(60.0, 2.0).unwrap();
    let motion = along("0.2*sin(5*t)");
    for (law, beside) in [
        (build("series(parallel(jenkins(k, f), spring(b)), dashpot(c))", &[60.0, 2.0, 25.0, 9.0]), 25.0),
        (build("series(jenkins(k, f), dashpot(c))", &[60.0, 2.0, 9.0]), 0.0),
        (build("series(series(jenkins(k, f), dashpot(c)), jenkins(k, g), dashpot(c))", &[120.0, 2.0, 18.0, 5.0]), 0.0),
        (build("series(spring(b), dashpot(c), jenkins(k, f))", &[120.0, 9.0, 120.0, 2.0]), 0.0),
    ] {
        let run = slider(std::slice::from_ref(&law), &motion, 3.0, 30, 1e-9);
        let error = departure(&force(&run), &behind_a_dashpot(own, beside, 9.0, [0.2, 5.0, 3.0], 30));
        assert!(error < 1e-7, "{error:e}: {law:?}");
        assert!(run.residual() < 1e-7, "{:e}", run.residual());
        assert!(run.column("e0.dissipated").is_sorted());
    }
    // At the start it gives what it can, and the others follow.
    for k in [60.0, 6e4] {
        let text = "series(jenkins(k, f), parallel(spring(b), dashpot(c)))";
        let law = build(text, &[k, 2.0, 25.0, 9.0]);
        for x in [0.04, 0.5, -0.5] {
            let run = slider(std::slice::from_ref(&law), &along(&format!("{x}")), 1.0, 4, 1e-9);
            let exact = (x / (1.0 / k + 1.0 / 25.0)).clamp(-2.0, 2.0);
            let error = departure(&force(&run), &[exact; 5]);
            assert!(error < 1e-9, "{k} {x}: {error:e}");
        }
    }
    // Behind a springpot: F_y while it slips, and the same at both tolerances and in forward runs.
    let law = build("series(jenkins(k, f), springpot(c, a))", &[60.0, 2.0, 30.0, 0.4]);
    for motion in [motion, "kind = \"forward\"\nstart = { v = { q = 1 } }\ntorque = { q = \"-30*q.q\" }".into()] {
        let [coarse, fine] = [1e-6, 1e-9].map(|rtol| slider(std::slice::from_ref(&law), &motion, 3.0, 60, rtol));
        let error = departure(&force(&coarse), &force(&fine));
        assert!(error < 1e-4, "{error:e}");
        assert!(force(&fine).iter().filter(|force| (force.abs() - 2.0).abs() < 1e-9).count() > 5);
        assert!(fine.residual() < 1e-6 && coarse.residual() < 1e-4, "{:e} {:e}", fine.residual(), coarse.residual());
        assert!(fine.column("e0.dissipated").is_sorted());
    }
}

/// Networks of springs that slip, side by side, behind dashpots and in one another, along and under random sums of sines: the balance closes and nothing
/// that was lost comes back.
#[test]
fn random_networks_of_them_balance() {
    for seed in 0..10 {
        let mut seed = 0x9e37_79b9_7f4a_7c15u64.wrapping_mul(2 * seed + 1);
        let mut within = |low: f64, high: f64| {
            seed ^= seed >> 12;
            seed ^= seed << 25;
            seed ^= seed >> 27;
            low + (high - low) * (seed.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut parts = vec![
            Network::spring(within(20.0, 60.0)),
            Network::springpot(within(2.0, 20.0), within(0.1, 0.9), Derivative::Caputo),
        ];
        for _ in 0..within(1.0, 4.0) as usize {
            parts.push(jenkins(within(20.0, 200.0), within(0.3, 6.0)));
        }
        let behind =
            Network::parallel([Network::spring(within(20.0, 90.0)), jenkins(within(30.0, 90.0), within(0.3, 3.0))]);
        parts.push(Network::series([behind, Network::dashpot(within(3.0, 20.0))]));
        parts.push(Network::series([
            jenkins(within(30.0, 90.0), within(0.3, 3.0)),
            Network::dashpot(within(3.0, 20.0)),
        ]));
        let law = Network::parallel(parts);
        let mut sines = |size: f64| {
            let one = |k: usize| format!("{}*sin({}*t)", size * within(0.3, 1.0), within(2.0, 5.0) * (k + 1) as f64);
            (0..3).map(one).collect::<Vec<_>>().join(" + ")
        };
        let motions = [
            along(&sines(0.1)),
            format!("kind = \"forward\"\nstart = {{ v = {{ q = 1 }} }}\ntorque = {{ q = \"{}\" }}", sines(6.0)),
        ];
        for motion in motions {
            let run = slider(std::slice::from_ref(&law), &motion, 3.0, 60, 1e-7);
            assert!(run.residual() < 1e-6, "{:e}: {law:?} {motion}", run.residual());
            let lost = run.column("e0.dissipated");
            assert!(lost.is_sorted() && lost[0] == 0.0 && lost[60] > 0.0, "{law:?} {motion}");
        }
    }
}
