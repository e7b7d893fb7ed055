//! Friction that sticks, against closed forms: blocks, oscillators, belts, held loads.

use crate::support::forward::{at, every};
use crate::support::{Run, run};

/// Sliders, one on the other along x; `joints` are the rests of their joints' tables.
fn sliders(joints: &[(&str, &str)]) -> String {
    let mut text = "[robot]\ngravity = [0, 0, -9.81]\n".to_owned();
    for (k, (mass, joint)) in joints.iter().enumerate() {
        text += &format!(
            "[[robot.body]]\nname = \"b{k}\"\n\
             joint = {{ name = \"q{k}\", kind = \"prismatic\", axis = [1, 0, 0], {joint} }}\nmass = {mass}\n"
        );
    }
    text
}

/// A spring of the stiffness k between two points on the x axis, at length 8 where the sliders are at 0.
fn spring(name: &str, from: &str, k: f64) -> String {
    format!(
        "[[element]]\nname = \"{name}\"\nfrom = {{ body = \"{from}\", point = [-8, 0, 0] }}\n\
         to = {{ body = \"b0\", point = [0, 0, 0] }}\nrest_length = 8\nlaw = \"spring\"\nparameters = {{ k = {k} }}\n"
    )
}

fn motion(rest: &str) -> String {
    format!("[motion]\nkind = \"forward\"\n{rest}\n")
}

fn sticks(force: f64) -> String {
    format!("friction = {{ force = {force}, stick = true }}")
}

/// Compares a column with a function of time; in units of its largest value.
fn follows(run: &Run, column: &str, wanted: impl Fn(f64) -> f64, tolerance: f64) {
    let (t, values) = (run.column("t"), run.column(column));
    let wanted: Vec<f64> = t.iter().map(|t| wanted(*t)).collect();
    let largest = wanted.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let (mut worst, mut when) = (0.0, 0.0);
    for ((t, value), wanted) in t.iter().zip(&values).zip(&wanted) {
        let off = (value - wanted).abs() / largest;
        if off > worst || off.is_nan() {
            (worst, when) = (off, *t);
        }
    }
    println!("{column}: {worst:.2e} at t = {when}, {:?}", run.report);
    assert!(worst <= tolerance, "{column}: {worst:e} at t = {when}");
}

/// From some row on the column has the same bits, and its velocity is 0.
fn rests(run: &Run, joint: &str, from: f64) {
    let (t, q, v) = (run.column("t"), run.column(&format!("q.{joint}")), run.column(&format!("v.{joint}")));
    let first = t.iter().position(|t| *t > from).unwrap();
    assert!(q[first..].iter().all(|x| x.to_bits() == q[first].to_bits()), "{joint} moves after {from}");
    assert!(v[first..].iter().all(|v| *v == 0.0), "{joint} has a velocity after {from}");
}

#[test]
fn a_block_on_a_rough_floor_stops_and_stays() {
    // 2 kg, mu g = 3 m/s², v0 = 1.5 m/s.
    let text = sliders(&[("2", &sticks(6.0))]) + &motion("start = { v = { q0 = 1.5 } }") + &every(2.0, 0.01, 1e-9);
    let run = run(&text);
    let (stop, rest) = (0.5, 1.5 * 1.5 / 6.0);
    follows(&run, "q.q0", |t| if t < stop { 1.5 * t - 1.5 * t * t } else { rest }, 1e-9);
    follows(&run, "v.q0", |t| if t < stop { 1.5 - 3.0 * t } else { 0.0 }, 1e-9);
    follows(&run, "energy.joints", |t| if t < stop { 6.0 * (1.5 * t - 1.5 * t * t) } else { 6.0 * rest }, 1e-9);
    rests(&run, "q0", 0.5);
    assert!(run.report.energy_residual.unwrap() < 1e-11, "{:?}", run.report);
}

#[test]
fn an_oscillator_loses_the_same_amplitude_every_half_cycle() {
    // 1 kg on 100 N/m, 3 N of friction: dead zone 0.03 m, 0.06 m less every half cycle.
    let (k, force, start) = (100.0, 3.0, 0.5);
    let text = sliders(&[("1", &sticks(force))]) + &spring("s", "world", k) + &motion("start = { q = { q0 = 0.5 } }");
    let run = run(&(text + &every(4.0, 0.01, 1e-9)));
    let (omega, zone) = (10.0, force / k);
    let half = std::f64::consts::PI / omega;
    let exact = |t: f64| {
        let (mut from, mut n, mut sign) = (start, 0.0, 1.0);
        while from > zone && t > (n + 1.0) * half {
            (from, n, sign) = (from - 2.0 * zone, n + 1.0, -sign);
        }
        let s = omega * (t - n * half);
        if from.abs() <= zone { sign * from } else { sign * (zone + (from - zone) * s.cos()) }
    };
    follows(&run, "q.q0", exact, 1e-9);
    rests(&run, "q0", 8.0 * half);
    assert!(run.residual() < 1e-9, "{}", run.residual());
}

#[test]
fn a_ramped_force_breaks_away_where_it_exceeds_friction() {
    // 2 N/s against 3 N: away at 1.5 s, x''' = 2/4.
    let text = sliders(&[("4", &sticks(3.0))]) + &motion("torque = { q0 = \"2*t\" }") + &every(3.0, 0.01, 1e-9);
    let run = run(&text);
    follows(&run, "q.q0", |t| if t < 1.5 { 0.0 } else { (t - 1.5).powi(3) / 12.0 }, 1e-9);
    follows(&run, "v.q0", |t| if t < 1.5 { 0.0 } else { (t - 1.5).powi(2) / 4.0 }, 1e-9);
}

#[test]
fn a_held_load_does_not_move_in_an_hour() {
    let held = |friction: &str| {
        format!(
            "[robot]\n[[robot.body]]\nname = \"b\"\njoint = {{ name = \"q\", kind = \"prismatic\", axis = [0, 0, 1], {friction} }}\n\
             mass = 1\n{}[time]\nend = 3600\noutput_step = 600\n",
            motion("torque = { q = 4.81 }\nstart = { q = { q = 0.3 } }")
        )
    };
    let sticking = run(&held(&sticks(10.0)));
    assert!(sticking.column("q.q").iter().all(|q| *q == 0.3) && sticking.column("v.q").iter().all(|v| *v == 0.0));
    assert!(sticking.report.steps < 100, "{:?}", sticking.report);
    // The smooth law creeps at v_0 artanh(load/force).
    let smooth = run(&held("friction = { force = 10, speed = \"0.1 mm/s\" }"));
    let creep = 1e-4 * f64::atanh(0.5) * 3600.0;
    let sunk = 0.3 - smooth.column("q.q").last().unwrap();
    assert!((sunk / creep - 1.0).abs() < 1e-6, "{sunk} {creep}");
}

#[test]
fn a_mass_on_a_pulled_belt_sticks_and_slips() {
    // The belt pulls a spring of 50 N/m at 0.1 m/s; 1 kg, 2 N: away at t = 0.4 s, then x − ut + F/k = −(u/ω) sin ω(t − 0.4), which
    // comes to rest after every turn of the sine with the spring at F again.
    let (k, u, force) = (50.0f64, 0.1, 2.0);
    let belt = |path: &str| {
        sliders(&[("1", &sticks(force))])
            + "[[robot.body]]\nname = \"belt\"\nparent = \"world\"\n\
               joint = { name = \"p\", kind = \"prismatic\", axis = [1, 0, 0] }\nmass = 1\n"
            + &spring("s", "belt", k)
            + &motion(&format!("prescribed = {{ p = \"{path}\" }}"))
    };
    let pulled = run(&(belt("0.1*t") + &every(5.0, 0.01, 1e-9)));
    let (omega, load) = (k.sqrt(), force / k / u);
    let exact = |t: f64| u * (t - load) - u / omega * (omega * (t - load)).sin();
    follows(&pulled, "q.q0", |t| if t < load { 0.0 } else { exact(t) }, 1e-9);
    assert!(pulled.residual() < 1e-9, "{}", pulled.residual());
    // A belt that goes to and fro takes the mass along and leaves it, again and again.
    let swung = |rtol| run(&(belt("0.1*sin(2*t)") + &every(10.0, 0.01, rtol)));
    let (coarse, fine) = (swung(1e-8), swung(1e-11));
    let v = fine.column("v.q0");
    let stops = v.windows(2).filter(|v| v[0] != 0.0 && v[1] == 0.0).count();
    assert!(stops >= 6 && v.iter().filter(|v| **v == 0.0).count() > 200, "{stops}");
    let apart = crate::support::forward::distance(&coarse.column("q.q0"), &fine.column("q.q0"));
    println!("{stops} stops, {apart:.1e} m, {:?}", fine.report);
    assert!(apart < 1e-8 && fine.residual() < 1e-10, "{apart:e} {}", fine.residual());
}

#[test]
fn rows_at_other_times_change_nothing() {
    let text = sliders(&[("1", &sticks(3.0))]) + &spring("s", "world", 100.0) + &motion("start = { q = { q0 = 0.5 } }");
    let fine = run(&(text.clone() + &at("2", "0.5, 1, 1.5, 2", 1e-9)));
    let coarse = run(&(text + &every(2.0, 0.001, 1e-9)));
    for (k, row) in [500, 1000, 1500, 2000].into_iter().enumerate() {
        let (a, b) = (fine.column("q.q0")[k], coarse.column("q.q0")[row]);
        assert!((a - b).abs() < 1e-10, "{a} {b}");
    }
}

#[test]
fn a_slider_on_a_sliding_one_sticks_until_it_is_pushed_too_hard() {
    // 1 kg with 2 N against a carrier of 3 kg on a smooth floor that 4·t N push: together until the upper one needs 1·(t) > 2 N.
    let text =
        sliders(&[("3", ""), ("1", &sticks(2.0))]) + &motion("torque = { q0 = \"4*t\" }") + &every(4.0, 0.01, 1e-9);
    let run = run(&text);
    // Apart from t = 2 on: a_0 = (4t − 2)/3, a_1 = 2 − a_0.
    let apart = |t: f64| -(t - 2.0).powi(3) * 2.0 / 9.0;
    follows(&run, "q.q1", |t| if t < 2.0 { 0.0 } else { apart(t) }, 1e-9);
    let together = |t: f64| t.powi(3) / 6.0;
    let after = |t: f64| together(2.0) + 2.0 * (t - 2.0) + (t - 2.0).powi(2) + (t - 2.0).powi(3) * 2.0 / 9.0;
    follows(&run, "q.q0", |t| if t < 2.0 { together(t) } else { after(t) }, 1e-9);
    assert!(run.column("q.q1")[..=200].iter().all(|q| *q == 0.0));
    assert!(run.residual() < 1e-9, "{}", run.residual());
}

#[test]
fn a_block_that_a_push_and_pull_moves_reverses_and_sticks_again() {
    // 5 sin t N against 3 N, 1 kg: slides while pushed, stops, is held until the other way.
    let text = sliders(&[("1", &sticks(3.0))]) + &motion("torque = { q0 = \"5*sin(t)\" }") + &every(13.0, 0.01, 1e-9);
    let run = run(&text);
    let begin = f64::asin(0.6);
    let v = |t: f64| 5.0 * (begin.cos() - t.cos()) - 3.0 * (t - begin);
    let q = |t: f64| 5.0 * (begin.cos() * (t - begin) - (t.sin() - begin.sin())) - 1.5 * (t - begin).powi(2);
    let (mut low, mut high) = (2.0, 4.5);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if v(middle) > 0.0 { low = middle } else { high = middle }
    }
    // It is at rest for a while: 5 sin t is still above −3 N where it stops.
    assert!(5.0 * f64::sin(low) > -3.0 && low > std::f64::consts::PI);
    let pi = std::f64::consts::PI;
    let reach = q(low);
    let exact = |t: f64| {
        // Half cycles of alternating sign.
        let half = ((t - begin) / pi).floor();
        if half < 0.0 {
            return 0.0;
        }
        let sign = if half as i64 % 2 == 0 { 1.0 } else { -1.0 };
        let start = if half as i64 % 2 == 0 { 0.0 } else { reach };
        start + sign * q((t - half * pi).min(low))
    };
    follows(&run, "q.q0", exact, 1e-9);
    assert!(run.column("v.q0").iter().filter(|v| **v == 0.0).count() > 100);
    assert!(run.residual() < 1e-9, "{}", run.residual());
}

#[test]
fn torques_that_jump_move_and_hold() {
    // ±4 N in turns of 0.5 s against 3 N, 1 kg; then ±2 N, which hold.
    let torque = "torque = { q0 = \"4*sign(sin(2*pi*t))*step(2 - t) + 2*sign(sin(2*pi*t))*step(t - 2)\" }";
    let text = sliders(&[("1", &sticks(3.0))]) + &motion(torque) + &every(4.0, 0.005, 1e-9);
    let run = run(&text);
    // 1 m/s² for 0.5 s, then −7 m/s² until it stops 0.5/7 s later, then −1 m/s² the other way.
    let first = |t: f64| if t < 0.5 { 0.5 * t * t } else { 0.125 + 0.5 * (t - 0.5) - 3.5 * (t - 0.5).powi(2) };
    let stop = 0.5 + 0.5 / 7.0;
    let q = run.column("q.q0");
    for (t, q) in run.column("t").iter().zip(&q).filter(|(t, _)| **t < stop) {
        assert!((q - first(*t)).abs() < 1e-10, "{t}");
    }
    let back = first(stop) - 0.5 * (1.0 - stop) * (1.0 - stop);
    assert!((q[200] - back).abs() < 1e-10, "{} {back}", q[200]);
    rests(&run, "q0", 2.2);
    assert!(run.residual() < 1e-9, "{}", run.residual());
}

#[test]
fn joints_that_signals_move_rub_both_ways() {
    // The actuator of a prescribed joint makes up for friction: F·sign(v), 0 at rest, and loses F·|v|.
    let text = sliders(&[("2", &sticks(3.0)), ("1", "damping = 1")])
        + &motion("prescribed = { q0 = \"0.3*sin(4*t)\" }")
        + &every(3.0, 0.01, 1e-9);
    let run = run(&text);
    assert!(run.residual() < 1e-9, "{}", run.residual());
    let rubbing = |t: f64| {
        let (quarter, phase) = ((4.0 * t / std::f64::consts::FRAC_PI_2).floor(), 4.0 * t);
        let within = if quarter as i64 % 2 == 0 { phase.sin().abs() } else { 1.0 - phase.sin().abs() };
        3.0 * 0.3 * (quarter + within)
    };
    let joints = run.column("energy.joints");
    // The damper of the other joint takes its share, which is smooth; friction's alone is known.
    let other = {
        let text = sliders(&[("2", ""), ("1", "damping = 1")])
            + &motion("prescribed = { q0 = \"0.3*sin(4*t)\" }")
            + &every(3.0, 0.01, 1e-9);
        crate::support::run(&text).column("energy.joints")
    };
    for ((t, all), damper) in run.column("t").iter().zip(&joints).zip(&other) {
        assert!((all - damper - rubbing(*t)).abs() < 1e-8, "{t}: {all} {damper} {}", rubbing(*t));
    }
}

#[test]
fn a_joint_that_sticks_under_a_relaxing_element_is_let_go_in_time() {
    // A springpot stretched at once by 0.1 m pulls with c·0.1·t^−α/Γ(1−α): more than 2 N at first, so that the slider leaves at once,
    // and holds where it has come to.
    let text = sliders(&[("1", &sticks(2.0))])
        + "[[element]]\nname = \"e\"\nfrom = { body = \"world\", point = [-8, 0, 0] }\nto = { body = \"b0\", point = [0, 0, 0] }\n\
           rest_length = 8\nlaw = \"springpot\"\nderivative = \"riemann-liouville\"\n\
           parameters = { c = 10, alpha = 0.4 }\n"
        + &motion("start = { q = { q0 = 0.1 } }")
        + &every(2.0, 0.01, 1e-8);
    let coarse = run(&text);
    let fine = run(&text.replace("rtol = 1e-8", "rtol = 1e-10"));
    let (a, b) = (coarse.column("q.q0"), fine.column("q.q0"));
    assert!((b[0] - b.last().unwrap()).abs() > 1e-3 && fine.column("v.q0").last() == Some(&0.0));
    for (a, b) in a.iter().zip(&b) {
        assert!((a - b).abs() < 1e-8, "{a} {b}");
    }
}

#[test]
fn a_force_that_grows_from_nothing_moves_what_nothing_holds() {
    // 2 kg from rest under 4·t N, and under 1e-9 of it: x = t³/3.
    for scale in [1.0, 1e-9] {
        let torque = format!("torque = {{ q0 = \"4*{scale:e}*t\" }}");
        let run = run(&(sliders(&[("2", "")]) + &motion(&torque) + &every(2.0, 0.01, 1e-9)));
        follows(&run, "q.q0", |t| scale * t.powi(3) / 3.0, 1e-9);
    }
}
