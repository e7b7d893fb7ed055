//! `springpot fit`: parameters from measurements.

use crate::support::{Place, ended, signal, testdata, worked};
use serde_json::Value;
use std::fmt::Write as _;
use std::process::Stdio;
use std::time::Instant;

fn place(text: &str) -> Place {
    let place = Place::new();
    place.write("pad.toml", text);
    place
}

/// Normally distributed numbers of a seed (splitmix64, Box–Muller).
struct Noise(u64);

impl Noise {
    fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.share()).ln()).sqrt() * (std::f64::consts::TAU * self.share()).cos()
    }
}

/// An element of this law, all of whose numbers are sought from moduli.
fn pad(law: &str, parameters: &[(&str, f64)]) -> String {
    let values: Vec<String> = parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    let mut text = format!("[[element]]\nname = \"pad\"\n{law}\nparameters = {{ {} }}\n", values.join(", "));
    for (name, _) in parameters {
        _ = write!(text, "[[parameter]]\nname = \"{name}\"\npath = \"element.pad.{name}\"\n");
    }
    text
}

const DMA: &str = "[[data]]\nname = \"dma\"\nkind = \"dma\"\nelement = \"pad\"\ncsv = \"dma.csv\"\ncolumns = { frequency = \"f\", storage = \"K1\", loss = \"K2\" }\n";

/// K = k + c·(iω)^alpha over three decades with noise.
fn moduli(k: f64, c: f64, alpha: f64, noise: f64, seed: u64) -> String {
    let mut noise_of = Noise(seed);
    let mut text = "f [rad/s],K1,K2\n".to_owned();
    for row in 0..40 {
        let omega = 10f64.powf(-1.5 + 3.0 * f64::from(row) / 39.0);
        let (size, turn) = (c * omega.powf(alpha), alpha * std::f64::consts::FRAC_PI_2);
        let mut with = |x: f64| x * (1.0 + noise * noise_of.normal());
        let (storage, loss) = (with(k + size * turn.cos()), with(size * turn.sin()));
        _ = writeln!(text, "{omega},{storage},{loss}");
    }
    text
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

/// Value and standard deviation of a parameter of a record.
fn found(record: &Value, name: &str) -> (f64, f64) {
    let all = record["parameters"].as_array().unwrap();
    let own = all.iter().find(|own| own["name"] == name).unwrap_or_else(|| panic!("{name}: {record}"));
    (number(&own["value"]), number(&own["sd"]))
}

fn record(place: &Place, folder: &str) -> Value {
    serde_json::from_str(&place.read(format!("{folder}/fit.json"))).unwrap()
}

/// Nine rows of RHEOS: the optimum of two springpots was found apart, by Gauss–Newton steps with differences in Python, to 1e-12 of the cost.
#[test]
fn moduli_of_others_to_the_exact_optimum() {
    let network = "network = \"parallel(springpot(c_a, a), springpot(c_b, b))\"";
    let text = pad(network, &[("c_a", 0.5), ("a", 0.1), ("c_b", 0.1), ("b", 0.5)]);
    let data = DMA.replace("\"f\"", "\"frequency\"").replace("K1", "storage").replace("K2", "loss");
    let place = place(&format!("# kept\n{text}{}", data.replace("dma.csv", &testdata("dma/rheos/data_freq.csv"))));
    let told = place.done(&["fit", "pad.toml"]).stdout;
    assert!(told.contains("20 of 20 starts; cost 0.342156, 18 numbers, 4 unknowns"), "{told}");
    let answer = record(&place, "results/pad");
    assert!((number(&answer["cost"]) / 0.342_155_997_665_885 - 1.0).abs() < 1e-11, "{}", answer["cost"]);
    let optimum = [("c_a", 0.913_308_306_5), ("a", 0.100_414_676_3), ("c_b", 0.009_201_342_67), ("b", 0.770_344_490)];
    for (name, exact) in optimum {
        let (value, sd) = found(&answer, name);
        assert!((value / exact - 1.0).abs() < 1e-6 && sd > 0.0, "{name}: {value}");
    }
    assert_eq!((&answer["status"], &answer["n"], &answer["p"]), (&"converged".into(), &18.into(), &4.into()));
    assert_eq!(
        place.files("results/pad"),
        [
            "correlation.csv",
            "figures/dma-residuals.png",
            "figures/dma-residuals.svg",
            "figures/dma.png",
            "figures/dma.svg",
            "files/data_freq.csv",
            "fit.json",
            "fitted.toml",
            "parameters.csv",
            "residuals.csv"
        ]
    );
    let table = place.table("results/pad/parameters.csv");
    assert_eq!(table.numbers("value")[1], found(&answer, "a").0);
    let residuals = place.table("results/pad/residuals.csv");
    let cost: f64 = residuals.numbers("residual").iter().map(|r| r * r).sum();
    assert!((cost / number(&answer["cost"]) - 1.0).abs() < 1e-12 && residuals.numbers("frequency").len() == 18);
    let correlation = place.table("results/pad/correlation.csv");
    let [own, other] = ["a", "c_a"].map(|name| correlation.numbers(name));
    assert!(own[1] == 1.0 && (own[0] - other[1]).abs() < 1e-12 && own[0] < 0.0, "{own:?} {other:?}");
    // The fitted file stands where it is, and begins at the optimum.
    assert!(place.read("results/pad/fitted.toml").starts_with("# kept\n"));
    let again = place.done(&["fit", "results/pad/fitted.toml", "--starts", "1", "--json", "--out", "again"]).stdout;
    let again: Value = serde_json::from_str(&again).unwrap();
    assert!((number(&again["cost"]) / number(&answer["cost"]) - 1.0).abs() < 1e-11);
}

/// Two stiffnesses that follow from one constant, and what is known of alpha beforehand.
#[test]
fn constants_and_priors() {
    let text = "[constants]\nK = \"1 kN/m\"\n[[element]]\nname = \"pad\"\nlaw = \"fractional-kelvin-voigt\"\n\
                parameters = { k = { expression = \"0.1*K\", unit = \"N/m\" }, c = 20, alpha = 0.5 }\n\
                [[parameter]]\npath = \"constants.K\"\nbounds = [1, 1e5]\n[[parameter]]\npath = \"element.pad.c\"\n\
                [[parameter]]\nname = \"alpha\"\npath = \"element.pad.alpha\"\nprior = { mean = 0.32, sd = 1e-4 }\n";
    let place = place(&format!("{text}{DMA}relative_sd = 0.01\n"));
    place.write("dma.csv", moduli(50.0, 60.0, 0.3, 0.01, 4));
    place.done(&["fit", "pad.toml"]);
    let answer = record(&place, "results/pad");
    let ((stiffness, sd), (alpha, _)) = (found(&answer, "constants.K"), found(&answer, "alpha"));
    // The prior holds alpha, and the spring makes up for it.
    assert!(
        (alpha - 0.32).abs() < 5e-3 && (stiffness - 500.0).abs() < 100.0 && sd < 10.0,
        "{alpha} {stiffness} ± {sd}"
    );
    assert!(place.read("results/pad/fitted.toml").contains(&format!("K = \"{stiffness:?} N/m\"")));
}

#[test]
fn what_is_not_determined_is_said() {
    let text = pad(
        "network = \"parallel(spring(k_a), spring(k_b), springpot(c, alpha))\"",
        &[("k_a", 10.0), ("k_b", 30.0), ("c", 40.0), ("alpha", 0.4)],
    );
    let place = place(&format!("{text}{DMA}"));
    place.write("dma.csv", moduli(50.0, 60.0, 0.3, 0.01, 4));
    let told = place.springpot(&["fit", "pad.toml", "--strict"]);
    told.ends(1, &["--strict"]);
    assert!(told.stdout.contains("only k_a + k_b = "), "{}", told.stdout);
    let answer = record(&place, "results/pad");
    let open = answer["undetermined"].as_array().unwrap();
    assert_eq!(open.len(), 1, "{open:?}");
    let parts = open[0]["combination"].as_object().unwrap();
    assert!(parts.len() == 2 && parts.contains_key("k_a") && parts.contains_key("k_b"), "{parts:?}");
    let said = open[0]["text"].as_str().unwrap();
    let sum: f64 = said.split(" = ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((sum - 50.0).abs() < 3.0, "{said}");
    // Known beforehand.
    let told = place.done(&["check", "pad.toml"]);
    told.says(&["k_a and k_b only by k_a + k_b"]);
    for words in ["dma: dma of pad, 40 rows, 0.00503292 Hz to 5.03292 Hz", "expected sd"] {
        assert!(told.stdout.contains(words), "{words}: {}", told.stdout);
    }
}

#[test]
fn the_law_is_chosen_and_what_belongs_at_0_is_there() {
    let text = pad("law = \"fractional-kelvin-voigt\"", &[("k", 10.0), ("c", 40.0), ("alpha", 0.4)]);
    let place = place(&format!("{text}{DMA}[fit]\nelement = \"pad\"\n"));
    place.write("dma.csv", moduli(0.0, 60.0, 0.3, 0.02, 8));
    place.done(&["fit", "pad.toml"]);
    let answer = record(&place, "results/pad");
    let stiffness = &answer["parameters"][0];
    if stiffness["at_bound"] == "lower" {
        assert_eq!((number(&stiffness["value"]), number(&stiffness["sd"])), (0.0, 0.0));
        assert!(number(&stiffness["interval"][1]) > 0.0 && answer["p"] == 2);
    } else {
        assert!(number(&stiffness["value"]) < 3.0 * number(&stiffness["sd"]), "{stiffness}");
    }
    let told = place.done(&["fit", "pad.toml", "--laws", "springpot,fractional-kelvin-voigt,zener", "--out", "laws"]);
    assert!(told.stdout.contains("springpot (chosen)"), "{}", told.stdout);
    let answer = record(&place, "laws");
    assert_eq!((&answer["chosen"], answer["laws"].as_array().unwrap().len()), (&"springpot".into(), 3));
    assert_eq!(answer["parameters"][1]["name"], "alpha");
}

/// Of 30 sets each interval of alpha holds what it should: 95 % of them, and BIC takes the law that there is.
#[test]
fn intervals_hold_what_they_should() {
    let text = pad("law = \"fractional-kelvin-voigt\"", &[("k", 50.0), ("c", 60.0), ("alpha", 0.3)]);
    let place = place(&format!("{text}{DMA}[fit]\nstarts = 1\nelement = \"pad\"\n"));
    let (mut held, mut chosen, sets) = (0, 0, 20);
    for seed in 0..sets {
        place.write("dma.csv", moduli(50.0, 60.0, 0.3, 0.03, 100 + seed));
        let told = place.done(&["fit", "pad.toml", "--json", "--laws", "springpot,fractional-kelvin-voigt"]).stdout;
        let answer: Value = serde_json::from_str(&told).unwrap();
        chosen += u32::from(answer["chosen"] == "fractional-kelvin-voigt");
        let all = answer["parameters"].as_array().unwrap();
        let alpha = all.iter().find(|own| own["name"] == "alpha").unwrap();
        let [low, high] = [0, 1].map(|k| number(&alpha["interval"][k]));
        held += u32::from((low..=high).contains(&0.3));
    }
    // Fewer than 16 of 20 come once in 400 of intervals that hold 95 %.
    assert!(held >= 16 && chosen >= 18, "{held} and {chosen} of {sets}");
}

/// c·D^α alone: G(t) = c t^−α/Γ(1 − α), J(t) = t^α/(c Γ(1 + α)).
#[test]
fn relaxation_creep_and_moduli_in_one_problem() {
    let text = pad("law = \"springpot\"", &[("c", 10.0), ("alpha", 0.3)]);
    let data = DMA
        .replace("\"dma\"\nkind = \"dma\"", "\"relax\"\nkind = \"relaxation\"")
        .replace("dma.csv", "g.csv")
        .replace("frequency = \"f\", storage = \"K1\", loss = \"K2\"", "t = \"t\", relaxation = \"G\"");
    let creep = data
        .replace("relax\"", "creep\"")
        .replace("relaxation\"", "creep\"")
        .replace("relaxation = \"G\"", "compliance = \"J\"");
    let validation = format!("{DMA}use = \"validation\"\n");
    let place = place(&format!("{text}{data}{}{validation}", creep.replace("g.csv", "j.csv")));
    let root = std::f64::consts::PI.sqrt();
    let (mut g, mut j) = ("t,G [N/mm]\n".to_owned(), "t,J\n".to_owned());
    for row in 0..12 {
        let t = 10f64.powf(-2.0 + 0.4 * f64::from(row));
        _ = writeln!(g, "{t},{}", 0.05 * t.powf(-0.5) / root);
        _ = writeln!(j, "{t},{}", t.sqrt() / (50.0 * 0.5 * root));
    }
    place.write("g.csv", g);
    place.write("j.csv", j);
    place.write("dma.csv", moduli(0.0, 50.0, 0.5, 0.0, 1));
    place.done(&["fit", "pad.toml"]);
    let answer = record(&place, "results/pad");
    for (name, exact) in [("c", 50.0), ("alpha", 0.5)] {
        assert!((found(&answer, name).0 / exact - 1.0).abs() < 1e-8, "{name}: {answer}");
    }
    assert_eq!(answer["n"], 24);
    assert!(answer["data"][2]["use"] == "validation" && number(&answer["data"][2]["cost"]) < 1e-12);
}

/// C1 and C2 with the law at once, of a table that was made with C1 = 12, C2 = 80 K.
#[test]
fn shifts_are_found_with_the_law() {
    let shift = "law = \"fractional-zener\"\nshift = { kind = \"wlf\", C1 = 9, C2 = \"60 K\", T_ref = \"20 degC\" }\n";
    let parameters = [("k_e", 1e6), ("k_m", 1e9), ("c", 1e7), ("alpha", 0.4)];
    let mut text = pad(shift, &parameters);
    for name in ["C1", "C2"] {
        _ = write!(text, "[[parameter]]\nname = \"{name}\"\npath = \"element.pad.shift.{name}\"\n");
    }
    let columns =
        "columns = { frequency = \"frequency\", storage = \"E'\", loss = \"E''\", T = \"T\" }\narea = 1\nlength = 1\n";
    let data = format!(
        "[[data]]\nname = \"warm\"\nkind = \"dma\"\nelement = \"pad\"\ncsv = {:?}\n{columns}",
        testdata("dma/fractional_zener_wlf.csv")
    );
    let place = place(&format!("{text}{data}"));
    place.done(&["fit", "pad.toml"]);
    let answer = record(&place, "results/pad");
    for (name, exact) in [("C1", 12.0), ("C2", 80.0), ("alpha", 0.5), ("k_m", 1.5e9), ("k_e", 2e6)] {
        let (value, sd) = found(&answer, name);
        assert!((value - exact).abs() < 3.5 * sd && sd < 0.1 * exact, "{name}: {value} ± {sd}");
    }
}

const SLIDER: &str = r#"[robot]
gravity = [0, 0, 0]
[[robot.body]]
name = "end"
joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }
mass = 1
[[element]]
name = "pad"
joint = "x"
law = "fractional-kelvin-voigt"
parameters = { k = 60, c = 9, alpha = 0.4 }
[motion]
kind = "forward"
start = { q = { x = 0.1 } }
[time]
end = 1.2
output_step = 0.02
[solver]
rtol = 1e-8
"#;

const SOUGHT: &str = r#"
[[parameter]]
name = "k"
path = "element.pad.k"
[[parameter]]
name = "c"
path = "element.pad.c"
[[parameter]]
name = "alpha"
path = "element.pad.alpha"
"#;

/// The rows of columns of a run, late and with a zero of its own, with noise.
fn measured(place: &Place, folder: &str, names: [&str; 2], (late, zero): (usize, f64)) -> String {
    let table = place.table(format!("{folder}/results.csv"));
    let [t, a, b] = ["t", names[0], names[1]].map(|name| table.numbers(name));
    let mut noise = Noise(17);
    let mut text = "t,a,b\n".to_owned();
    for k in 0..t.len() {
        let b = b[k.saturating_sub(late)] + zero;
        let (a, b) = (a[k] + 1e-9 * noise.normal(), b + 1e-3 * noise.normal());
        _ = writeln!(text, "{},{a},{b}", t[k]);
    }
    text
}

#[test]
fn a_robot_from_its_own_record_with_an_unknown_start_and_zero() {
    let place = place(SLIDER);
    place.done(&["run", "pad.toml", "--out", "truth", "--set", "motion.start.v.x=0.3"]);
    place.write("rows.csv", measured(&place, "truth", ["q.x", "pad.force"], (0, 2.5)));
    let data = "[[data]]\nname = \"drop\"\ncsv = \"rows.csv\"\ncolumns = { \"pad.force\" = { column = \"b\", sd = \"1 mN\" } }\n\
                free = \"motion.start.v.x\"\noffset = \"pad.force\"\n[fit]\nstarts = 1\n";
    let off = SLIDER.replace("k = 60, c = 9, alpha = 0.4", "k = 90, c = 5, alpha = 0.55");
    place.write("fit.toml", format!("{off}{SOUGHT}{data}"));
    place.done(&["fit", "fit.toml"]);
    let answer = record(&place, "results/fit");
    assert_eq!(answer["status"], "converged");
    let exact =
        [("k", 60.0), ("c", 9.0), ("alpha", 0.4), ("drop.motion.start.v.x", 0.3), ("drop.offset.pad.force", 2.5)];
    for (name, exact) in exact {
        let (value, sd) = found(&answer, name);
        assert!((value - exact).abs() < 3.5 * sd && sd < 0.02 * exact, "{name}: {value} ± {sd}");
    }
    let told = place.done(&["check", "fit.toml"]);
    for words in ["drop: run, 61 rows, 0 s to 1.2 s", "drop.offset.pad.force from 0 N", "expected sd"] {
        assert!(told.stdout.contains(words), "{words}: {}", told.stdout);
    }
    // What was found is a scenario like any other.
    place.done(&["run", "results/fit/fitted.toml", "--out", "again"]);
}

#[test]
fn a_force_along_a_stroke_that_is_late() {
    let moved = "[motion]\nkind = \"prescribed\"\njoints = { x = \"0.01*sin(9*t + t^2)\" }\n[time]\nend = 2.5\noutput_step = \"8 ms\"\n";
    let head = SLIDER.split("[motion]").next().unwrap();
    let place = place(&format!("{head}{moved}"));
    place.done(&["run", "pad.toml", "--out", "truth"]);
    place.write("rows.csv", measured(&place, "truth", ["q.x", "pad.force"], (1, 0.5)));
    let element = head
        .split("[[element]]")
        .nth(1)
        .unwrap()
        .replace("joint = \"x\"\n", "")
        .replace("k = 60, c = 9, alpha = 0.4", "k = 30, c = 20, alpha = 0.6");
    let data = "[[data]]\nname = \"loops\"\nkind = \"stroke\"\nelement = \"pad\"\ncsv = \"rows.csv\"\ncolumns = { stroke = \"a\", force = \"b\" }\n";
    let fit = |extra: &str, folder: &str| {
        place.write("fit.toml", format!("[[element]]{element}{SOUGHT}{data}{extra}[fit]\nstarts = 2\n"));
        place.done(&["fit", "fit.toml", "--out", folder]);
        record(&place, folder)
    };
    let answer = fit("offset = \"force\"\ndelay = \"force\"\nwindow = [0.1, 2.5]\n", "late");
    let exact = [("k", 60.0), ("c", 9.0), ("alpha", 0.4), ("loops.offset.force", 0.5), ("loops.delay.force", 0.008)];
    for (name, exact) in exact {
        let (value, sd) = found(&answer, name);
        assert!((value - exact).abs() < 4.0 * sd && sd < 0.1 * exact, "{name}: {value} ± {sd}");
    }
    // Without them alpha is far off.
    let plain = found(&fit("", "plain"), "alpha").0;
    assert!((plain - 0.4).abs() > 0.05, "{plain}");
    // An unknown past costs unknowns, and takes nothing away from a record that has one that is known.
    let free = fit("offset = \"force\"\ndelay = \"force\"\nwindow = [0.1, 2.5]\npast = \"free\"\n", "free");
    let (value, sd) = found(&free, "alpha");
    assert!((value - 0.4).abs() < 4.0 * sd && number(&free["p"]) > 9.0, "{value} ± {sd}");
}

#[test]
fn what_no_data_depend_on_and_what_cannot_begin() {
    let text = pad("law = \"fractional-kelvin-voigt\"", &[("k", 10.0), ("c", 40.0), ("alpha", 0.4)]);
    let other = "[[element]]\nname = \"other\"\nlaw = \"spring\"\nparameters = { k = 1 }\n[[parameter]]\npath = \"element.other.k\"\n";
    let place = place(&format!("{text}{other}{DMA}"));
    place.write("dma.csv", moduli(10.0, 60.0, 0.3, 0.02, 8));
    place.springpot(&["fit", "pad.toml"]).ends(2, &["\"element.other.k\" is a parameter that no data see"]);
    let text =
        pad("network = \"parallel(preload(f), springpot(c, alpha))\"", &[("f", 1.0), ("c", 2.0), ("alpha", 0.5)]);
    place.write("pad.toml", format!("{text}{DMA}"));
    place.springpot(&["fit", "pad.toml"]).ends(2, &["no data depend on f"]);
    // A storage that is not positive.
    place.write("pad.toml", format!("{}{DMA}", pad("law = \"dashpot\"", &[("c", 2.0)])));
    place.springpot(&["fit", "pad.toml"]).ends(1, &["no start can be evaluated"]);
    assert_eq!(record(&place, "results/pad")["status"], "failed");
    // An order at its end is sought from where its block says.
    let at_its_end = pad("law = \"springpot\"", &[("c", 40.0), ("alpha", 0.0)]);
    place.write("pad.toml", format!("{at_its_end}{DMA}"));
    place.springpot(&["fit", "pad.toml"]).ends(2, &["it is 0", "start at 0.01 or 0.99"]);
    let starts = at_its_end.replace("path = \"element.pad.alpha\"", "path = \"element.pad.alpha\"\nstart = 0.5");
    assert!(starts != at_its_end);
    place.write("pad.toml", format!("{starts}{DMA}"));
    place.done(&["fit", "pad.toml"]);
    let order = &record(&place, "results/pad")["parameters"][1];
    assert!((0.1..0.9).contains(&number(&order["value"])) && number(&order["start"]) == 0.5, "{order}");
}

#[test]
fn losses_windows_and_starts_that_are_none() {
    let text = pad("law = \"springpot\"", &[("c", 40.0), ("alpha", 0.4)]);
    let place = place(&format!("{text}{DMA}loss = \"huber\"\n"));
    place.write("dma.csv", moduli(50.0, 60.0, 0.3, 0.02, 8));
    place.springpot(&["fit", "pad.toml"]).ends(2, &["is \"huber\", which is no loss", "{ huber = 1.345 }"]);
    place.write("pad.toml", format!("{text}{DMA}loss = 1.345\n"));
    place.springpot(&["fit", "pad.toml"]).ends(2, &["is 1.345, which is no loss", "\"squares\""]);
    place.write("pad.toml", format!("{text}{DMA}"));
    place.springpot(&["fit", "pad.toml", "--starts", "-3"]).ends(2, &["-3 is not in 1..=100000"]);
    place.springpot(&["fit", "pad.toml", "--starts", "0"]).ends(2, &["0 is not in 1..=100000"]);
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_the_best_so_far() {
    let text = pad("law = \"fractional-zener\"", &[("k_e", 10.0), ("k_m", 100.0), ("c", 40.0), ("alpha", 0.4)]);
    let place = place(&format!("{text}{DMA}[fit]\nstarts = 100000\n"));
    place.write("dma.csv", moduli(50.0, 60.0, 0.3, 0.02, 8));
    let begun = Instant::now();
    let child = place.command(&["fit", "pad.toml"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    crate::support::wait_for("work", || worked(&child, begun) > 1.0);
    signal(&child, "-INT");
    let told = ended(child);
    assert_eq!(told.code, Some(130), "{}", told.stderr);
    let answer = record(&place, "results/pad");
    assert_eq!(answer["status"], "interrupted");
    assert!(
        number(&answer["cost"]).is_finite() && told.stderr.contains("interrupted: what was found is the best so far")
    );
}
