//! A mass or a given motion on a slider: rows beside ends of steps, remnants, motions without bound, kinks that name a state, followers.

use crate::cases::holds;
use crate::support::{Run, try_run};

const SLIDER: &str = r#"
[robot]
gravity = [0, 0, 0]
[[robot.body]]
name = "b"
joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }
mass = 1
"#;

const SPRING: &str =
    "[[element]]\nname = \"e\"\njoint = \"x\"\nlaw = \"kelvin-voigt\"\nparameters = { k = 4, c = 0.3 }\n";

fn ran(parts: &[&str]) -> Run {
    try_run(&[&[SLIDER], parts].concat().concat())
}

fn column_of(run: &Run, column: &str) -> Vec<(f64, f64)> {
    assert!(run.error.is_none(), "{}", run.error.as_ref().unwrap());
    run.column("t").into_iter().zip(run.column(column)).collect()
}

/// Rows that lie beside ends of steps by rounding alone: rates of parts are no differences of rounded strokes.
#[test]
fn a_series_behind_a_kink_is_right_in_every_row() {
    let element =
        "[[element]]\nname = \"e\"\njoint = \"x\"\nlaw = \"jeffreys\"\nparameters = { c_1 = 1, k = 2, c_2 = 3 }\n";
    let motion = "[motion]\nkind = \"prescribed\"\njoints = { x = \"1 + 0.01*max(0, t - 0.3)\" }\n";
    for step in ["0.02", "0.01", "0.007", "0.1"] {
        let run = ran(&[element, motion, "[time]\nend = 2\noutput_step = ", step, "\n"]);
        let times = run.column("t");
        let force = |t: f64| if t > 0.3 { 0.01 * (1.0 - 0.25 * (-(t - 0.3) / 2.0).exp()) } else { 0.0 };
        let expected: Vec<_> = times.iter().filter(|t| (**t - 0.3).abs() > 1e-9).map(|t| (*t, force(*t))).collect();
        holds(&run, "e.force", &expected, 1e-9);
    }
}

/// What has relaxed is known to the rounding of spring times stroke, and no better by shorter steps.
#[test]
fn a_remnant_is_no_work_for_ever() {
    let motion = "[motion]\nkind = \"prescribed\"\njoints = { x = 0.5 }\n[time]\nend = 2\noutput_step = 0.5\n";
    for held in [18.0, 22.0, 25.0, 33.0, 60.0] {
        let element = format!(
            "[[element]]\nname = \"e\"\njoint = \"x\"\nlaw = \"maxwell\"\nparameters = {{ k = 1, c = 1 }}\npast = {{ held = {held} }}\n"
        );
        let run = ran(&[&element, motion]);
        for (t, force) in column_of(&run, "e.force") {
            assert!((force - 0.5 * (-held - t).exp()).abs() < 5e-14, "held {held}, {t}: {force}");
        }
        assert!(run.report.steps < 2000, "held {held}: {} steps", run.report.steps);
    }
}

/// The end is told where a motion grows without bound, kinks of the state in its expression or none.
#[test]
fn a_motion_without_bound_ends_the_run() {
    for torque in ["max(0, t - 2) + 20*q.x^3", "max(0, t - 2) + 20*abs(q.x)^3", "1 + q.x^2*step(q.x)"] {
        let run = ran(&[
            "[motion]\nkind = \"forward\"\ntorque = { x = \"",
            torque,
            "\" }\n[time]\nend = 10\noutput_step = 0.5\n",
        ]);
        let error = run.error.as_ref().unwrap_or_else(|| panic!("{torque} has no bound"));
        assert!(error.time().is_some_and(|t| (1.0..9.0).contains(&t)), "{torque}: {error}");
        assert!(run.effort() < 10_000, "{torque}");
    }
}

/// A kink whose place does not hang on the state that it names is crossed once.
#[test]
fn a_kink_that_names_a_state_in_vain_switches_once() {
    let motion = |torque: &str| {
        format!(
            "[motion]\nkind = \"forward\"\nstart = {{ q = {{ x = 0.3 }} }}\ntorque = {{ x = \"{torque}\" }}\n[time]\nend = 10\noutput_step = 0.5\n"
        )
    };
    for at in ["3.52", "2.84", "6.42", "0.7", "5.1"] {
        let plain = ran(&[SPRING, &motion(&format!("step(t - {at})"))]);
        for torque in
            ["step(t - @ + 0*q.x)", "step((t - @)*(1 + q.x^2))", "0.5 + 0.5*sign(t - @ - min(0.1, q.x + 9) + 0.1)"]
        {
            let run = ran(&[SPRING, &motion(&torque.replace('@', at))]);
            holds(&run, "q.x", &column_of(&plain, "q.x"), 1e-7);
        }
    }
}

/// What rests until a feedback from another joint moves it, which itself only begins.
#[test]
fn a_follower_starts() {
    let second = "[[robot.body]]\nname = \"c\"\nparent = \"world\"\njoint = { name = \"y\", kind = \"prismatic\", axis = [0, 1, 0] }\nmass = 1\n";
    let motion = |x: &str, y: &str| {
        format!(
            "[motion]\nkind = \"forward\"\ntorque = {{ x = \"{x}\", y = \"{y}\" }}\n[time]\nend = 5\noutput_step = 0.5\n"
        )
    };
    // The leader's torque, and its place and speed.
    for (y, [q, v]) in [
        ("t", ["t^3/6", "t^2/2"]),
        ("max(0, t - 1)", ["max(0, t - 1)^3/6", "max(0, t - 1)^2/2"]),
        ("max(0, t - 1)^2", ["max(0, t - 1)^4/12", "max(0, t - 1)^3/3"]),
        ("1 - cos(t)", ["t^2/2 + cos(t) - 1", "t - sin(t)"]),
    ] {
        for x in ["10*(q.y - q.x) + 2*(v.y - v.x)", "q.y", "v.y - q.x"] {
            let run = ran(&[second, &motion(x, y)]);
            let told = x.replace("q.y", &format!("({q})")).replace("v.y", &format!("({v})"));
            let plain = ran(&[second, &motion(&told, y)]);
            holds(&run, "q.x", &column_of(&plain, "q.x"), 1e-6);
        }
    }
}

/// Forces of a series begin like a power of t below one where a stroke is there at once.
#[test]
fn an_unloaded_zener_of_low_order_starts() {
    for alpha in ["0.05", "0.1", "0.2", "0.3", "0.5"] {
        let parts = |rtol: &str| {
            format!(
                "[[element]]\nname = \"e\"\njoint = \"x\"\nlaw = \"fractional-zener\"\nparameters = {{ k_e = 2, k_m = 5, c = 1, alpha = {alpha} }}\n\
                 past = \"unloaded\"\n[motion]\nkind = \"forward\"\nstart = {{ q = {{ x = 0.4 }} }}\n[time]\nend = 5\noutput_step = 0.5\n[solver]\nrtol = {rtol}\n"
            )
        };
        let [rough, fine] = ["1e-6", "1e-9"].map(|rtol| ran(&[&parts(rtol)]));
        holds(&rough, "q.x", &column_of(&fine, "q.x"), 1e-5);
    }
}

/// What rests until late in a long run is measured by what it does in the time in which it answers, not in the longest step: the same
/// motion begins a short run at once.
#[test]
fn a_late_start_is_as_good_as_an_early_one() {
    let chain = "[[robot.body]]\nname = \"c\"\njoint = { name = \"y\", kind = \"prismatic\", axis = [1, 0, 0] }\nmass = 0.01\n\
                 [[element]]\nname = \"f\"\njoint = \"y\"\nlaw = \"kelvin-voigt\"\nparameters = { k = 40, c = 0.1 }\n";
    for (end, forces) in [(1e4, ["@", "@^2", "@^3"]), (1e5, ["@^1.5", "@^2", "@^3"]), (1e6, ["@", "@^2", "1 - cos(@)"])]
    {
        let late = end - 12.0;
        for force in forces {
            for bodies in ["", chain] {
                let run = |from: f64, end: f64| {
                    let times: Vec<String> = [0.5, 1.0, 5.0, 10.0].iter().map(|t| (from + t).to_string()).collect();
                    let torque = force.replace('@', &format!("max(0, t - {from})"));
                    ran(&[
                        bodies,
                        SPRING,
                        &format!(
                            "[motion]\nkind = \"forward\"\ntorque = {{ x = \"{torque}\" }}\n[time]\nend = {end}\noutput_times = [{}]\n",
                            times.join(", ")
                        ),
                    ])
                };
                let early = run(0.0, 12.0);
                let expected: Vec<_> =
                    column_of(&early, "q.x").into_iter().map(|(t, value)| (t + late, value)).collect();
                // The time itself is known to 1e-10 s there.
                holds(&run(late, end), "q.x", &expected, 1e-8);
            }
        }
    }
}

/// The part that takes a jump at once tells the force behind it, wherever it stands in the series.
#[test]
fn an_unloaded_series_starts_in_any_order() {
    let run = |network: &str| {
        ran(&[&format!(
            "[[element]]\nname = \"e\"\njoint = \"x\"\nnetwork = \"{network}\"\nparameters = {{ k = 2, c = 3, alpha = 0.5 }}\npast = \"unloaded\"\n\
             [motion]\nkind = \"forward\"\nstart = {{ q = {{ x = 0.1 }} }}\n[time]\nend = 5\noutput_step = 0.5\n"
        )])
    };
    let expected = run("series(spring(k), springpot(c, alpha))");
    holds(&run("series(springpot(c, alpha), spring(k))"), "q.x", &column_of(&expected, "q.x"), 1e-9);
    assert!(column_of(&expected, "q.x").len() == 11);
}

/// Energies of springpots in series behind a kink: a step there is much shorter than the lags that are kept.
#[test]
fn springpots_in_series_lose_at_a_kink_what_they_should() {
    for (mass, end) in [("1", "2"), ("2000", "10"), ("1e5", "100")] {
        let run = try_run(
            &[
                &SLIDER.replace("mass = 1", &format!("mass = {mass}")),
                "[[element]]\nname = \"e\"\njoint = \"x\"\nnetwork = \"series(springpot(p, a), springpot(q, b))\"\n",
                "parameters = { p = 50, a = 0.5, q = 0.1, b = 0.7 }\n[motion]\nkind = \"prescribed\"\n",
                "joints = { x = \"max(0, 1 - abs(t - 0.8)/0.5)\" }\n[time]\nend = ",
                end,
                "\noutput_times = [0.799, 0.801, 1.31, ",
                end,
                "]\n",
            ]
            .concat(),
        );
        assert!(run.error.is_none(), "{mass}: {}", run.error.as_ref().unwrap());
        let lost = run.column("e.dissipated");
        let stored = run.column("e.stored");
        let work = run.column("energy.actuators");
        // Once the joint has come back, what the actuators did to the mass is 0.
        let last = lost.len() - 1;
        assert!((lost[last] + stored[last] - work[last]).abs() < 1e-9, "{mass}: {} {}", lost[last], work[last]);
        assert!((work[last] - 0.213_447_448).abs() < 2e-8, "{mass}: {}", work[last]);
    }
}

/// Series whose force is without bound behind a jump push a mass from the first; right is an inverse Laplace transform of
/// (s m + c₁) x(0)/(m s² + K), c₁ being the impulse of a dashpot, which is not told (Weideman's contour, 40 digits, two depths agree).
#[test]
fn series_that_jolt_push_a_mass() {
    for (network, expected) in [
        (
            "series(springpot(c, a), springpot(k, b))",
            [0.099994616937247, 0.098535345864047, 0.066935795902471, -0.01377310884473, -0.003426951712594],
        ),
        (
            "series(springpot(c, a), dashpot(k))",
            [0.099993082388307, 0.097957307226432, 0.061049072412213, -0.0022815484171528, -0.001599129799396],
        ),
        (
            "series(parallel(springpot(c, a), dashpot(k)), parallel(springpot(k_2, b), dashpot(c_2)))",
            [0.099994016648461, 0.098574859734678, 0.072514042482326, 0.032788061692983, 0.026360930863227],
        ),
        (
            "parallel(springpot(c_2, b_2), series(springpot(c, a), springpot(k, b)))",
            [0.099962250840138, 0.093452679433682, 0.012830735247207, -0.0037672669981968, -0.00071233819818743],
        ),
    ] {
        let known = [("c", 3.0), ("a", 0.5), ("k", 2.0), ("b", 0.7), ("c_2", 3.0), ("k_2", 2.0), ("b_2", 0.7)];
        let named = known
            .iter()
            .filter(|(name, _)| network.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|word| word == *name));
        let parameters: Vec<String> = named.map(|(name, value)| format!("{name} = {value}")).collect();
        let run = ran(&[&format!(
            "[[element]]\nname = \"e\"\njoint = \"x\"\nnetwork = \"{network}\"\nparameters = {{ {} }}\npast = \"unloaded\"\n\
             [motion]\nkind = \"forward\"\nstart = {{ q = {{ x = 0.1 }} }}\n[time]\nend = 5\noutput_times = [0.001, 0.05, 0.5, 2, 5]\n",
            parameters.join(", ")
        )]);
        let rows: Vec<_> = [0.001, 0.05, 0.5, 2.0, 5.0].into_iter().zip(expected).collect();
        holds(&run, "q.x", &rows, 2e-9);
    }
}
