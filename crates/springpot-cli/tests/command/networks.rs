//! Laws of a scenario's own: networks as text, laws with lists.

use crate::support::{ARM, Place};

const LAW: &str = "law = \"magnetorheological\"\n\
                   parameters = { E_c = \"20 N/m\", mu_0 = 10, mu = 4, alpha = 0.5 }\n\
                   inputs = { u = \"1 + 0.5*sin(20*t)\" }\n";

/// The arm with another law in its damper.
fn with(law: &str) -> Place {
    assert!(ARM.contains(LAW));
    Place::with(&ARM.replace(LAW, law))
}

fn forces(place: &Place) -> Vec<f64> {
    place.done(&["run", "arm.toml"]);
    place.table("results/arm/results.csv").numbers("damper.force")
}

#[test]
fn a_network_is_the_law_of_its_name() {
    let parameters = "parameters = { k_e = \"200 N/m\", k_m = \"3 kN/m\", c = \"80 N*s^alpha/m\", alpha = 0.4 }\n";
    let named = forces(&with(&format!("law = \"fractional-zener\"\n{parameters}")));
    for network in [
        "parallel(spring(k_e), series(spring(k_m), springpot(c, alpha)))",
        " parallel ( series(slow: springpot(c,alpha), spring(k_m) ),spring(k_e) ) ",
    ] {
        let written = forces(&with(&format!("network = \"{network}\"\n{parameters}")));
        let size = named.iter().fold(0.0f64, |most, force| most.max(force.abs()));
        assert!(
            size > 1.0 && named.iter().zip(&written).all(|(a, b)| (a - b).abs() < 1e-9 * size),
            "{named:?} {written:?}"
        );
    }
}

#[test]
fn check_and_the_record_say_what_was_written() {
    let network = "series(spring(k), springpot(c, a))";
    let law = format!("network = \"{network}\"\nparameters = {{ k = \"3 kN/m\", c = \"80 N*s^a/m\", a = 0.4 }}\n");
    let place = with(&law);
    let checked = place.done(&["check", "arm.toml"]);
    for words in ["damper: network, caputo", network, "k = 3000 N/m, c = 80 N*s^a/m, a = 0.4"] {
        assert!(checked.stdout.contains(words), "{words}: {}", checked.stdout);
    }
    place.done(&["run", "arm.toml", "--set", "element.damper.c=40"]);
    let element = &place.record("results/arm")["plan"]["elements"][0];
    assert_eq!(element["network"], network);
    assert_eq!(element["parameters"]["c"], 40.0);
    assert!(element.get("law").is_none());
}

#[test]
fn lists_are_arrays_or_columns() {
    let place = with("law = \"prony\"\nparameters = { k_e = 100, k = [\"3 kN/m\", 500], tau = [0.1, \"10 ms\"] }\n");
    place.write("terms.csv", "i,k in N/m,tau\n0,3000,0.1\n1,500,0.01\n");
    let written = forces(&place);
    let element = &place.record("results/arm")["plan"]["elements"][0];
    assert_eq!(element["parameters"]["k"], serde_json::json!([3000.0, 500.0]));
    let read = forces(&{
        let table = "table = { csv = \"terms.csv\", k = \"k in N/m\", tau = \"tau\" }";
        let other = with(&format!("law = \"prony\"\nparameters = {{ k_e = 100, {table} }}\n"));
        other.write("terms.csv", place.read("terms.csv"));
        other
    });
    assert_eq!(written, read);
    // A path counts from 0, and a sweep of a value has its unit.
    let swept = place.done(&["run", "arm.toml", "--sweep", "element.damper.tau.1=10 ms,20 ms"]);
    assert_eq!(swept.code, Some(0));
    let rows = place.table("results/arm/results.csv");
    assert_eq!(rows.header[0], "element.damper.tau.1");
    assert_eq!(rows.numbers("element.damper.tau.1").last(), Some(&0.02));
}

#[test]
fn leaves_that_are_not_linear() {
    // A table of a line is a spring, and so are the two halves of one, and a stop without room.
    let (rate, spring) = ("200 N/m", forces(&with("law = \"spring\"\nparameters = { k = \"200 N/m\" }\n")));
    for (network, parameters) in [
        ("pad: table(file)", "file = \"pad.csv\"".to_owned()),
        ("parallel(tension(k), compression(k))", format!("k = \"{rate}\"")),
        ("stop(k, none, none)", format!("k = \"{rate}\", none = \"0 mm\"")),
        ("polynomial(k, none, nil)", format!("k = \"{rate}\", none = 0, nil = \"0 N/m^3\"")),
        ("parallel(spring(k), friction(f, v0), preload(p))", format!("k = \"{rate}\", f = 0, p = 0, v0 = \"1 mm/s\"")),
    ] {
        let place = with(&format!("network = \"{network}\"\nparameters = {{ {parameters} }}\n"));
        place.write("pad.csv", "F,x,note\n-200,-1,a\n0,0,b\n300,1.5,c\n");
        let written = forces(&place);
        let off = spring.iter().zip(&written).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-6, "{network}: {off:e}");
    }
    let hysteresis = "alpha_h = \"3 kN/m\", A = 1, beta = \"2000 1/m^2\", gamma = \"3000 1/m^2\", n = 2";
    let named = forces(&with(&format!("law = \"bouc-wen\"\nparameters = {{ {hysteresis} }}\n")));
    let written = forces(&with(&format!(
        "network = \"bouc-wen(alpha_h, A, beta, gamma, n)\"\nparameters = {{ {hysteresis} }}\n"
    )));
    assert_eq!(named, written);
    let mixed = forces(&with(&format!(
        "law = \"magnetorheological-bouc-wen\"\ninputs = {{ u = 1 }}\n\
         parameters = {{ E_c = 0, mu_0 = 0, mu = 0, alpha = 0.5, {hysteresis} }}\n"
    )));
    assert!(named.iter().zip(&mixed).all(|(a, b)| (a - b).abs() < 1e-6), "{named:?} {mixed:?}");
}

#[test]
fn the_file_of_a_table_is_named_and_refused() {
    let place = with("network = \"parallel(spring(k), table(pad))\"\nparameters = { k = 100, pad = \"pad.csv\" }\n");
    place.write("pad.csv", "x,F\n-1,-5\n0,0\n1,20\n");
    place.write("soft.csv", "x,F\n-1,-1\n0,0\n1,1\n");
    let checked = place.done(&["check", "arm.toml"]);
    assert!(checked.stdout.contains("pad = pad.csv"), "{}", checked.stdout);
    let hard = forces(&place);
    let element = &place.record("results/arm")["plan"]["elements"][0];
    assert_eq!(element["parameters"], serde_json::json!({ "k": 100.0, "pad": "pad.csv" }));
    place.done(&["run", "arm.toml", "--set", "element.damper.pad=\"soft.csv\""]);
    assert_ne!(place.table("results/arm/results.csv").numbers("damper.force"), hard);
    for (name, text) in [
        ("one", "x,F\n0,0\n"),
        ("back", "x,F\n0,0\n1,1\n1,2\n"),
        ("word", "x,F\n0,0\n1,soft\n"),
        ("other", "x,force\n0,0\n1,1\n"),
    ] {
        place.write(&format!("{name}.csv"), text);
    }
    for (set, words) in [
        ("pad=\"one.csv\"", &["`pad`", "one.csv", "two rows"][..]),
        ("pad=\"back.csv\"", &["it is no function: x must increase, but in row 3 it is 1 after 1"]),
        ("pad=\"word.csv\"", &["soft"]),
        ("pad=\"other.csv\"", &["`F`"]),
        ("pad=\"none.csv\"", &["none.csv", "cannot be read"]),
        ("pad=3", &["must be the name of a file, not the number 3"]),
        ("parameters={ k = 100 }", &["needs the parameter pad", "columns x and F"]),
        ("network=\"parallel(spring(pad), table(pad))\"", &["`pad` is a file here, but a number before"]),
        ("network=\"parallel(table(pad), spring(pad))\"", &["`pad` is a number here, but a file before"]),
        ("network=\"series(spring(k), table(pad, k))\"", &["`table` takes 1 name, not 2", "table(file)"]),
    ] {
        refused(&place, set, words);
    }
}

#[test]
fn a_text_says_the_force_of_a_leaf() {
    let place = with(
        "network = \"parallel(expression(f), dashpot(c))\"\nparameters = { f = \"k*x + b*x^3\", k = \"3 kN/m\", b = 5e4, c = 5 }\n",
    );
    place.done(&["run", "arm.toml"]);
    place.done(&["run", "arm.toml", "--set", "element.damper.f=\"k*sinh(x/b)\"", "--set", "element.damper.b=1 cm"]);
    place.done(&["run", "arm.toml", "--sweep", "element.damper.k=1 kN/m,2 kN/m"]);
    for (set, words) in [
        ("f=\"k*x + b*y\"", &["needs the parameters y", "y [a number]: parameter of an expression"][..]),
        ("f=\"k*x*t + b\"", &["`f` of `network`", "`t` has no place here"]),
        ("f=\"k*x + b*sine(x)\"", &["did you mean `sin`?"]),
        ("f=\"k*x\"", &["unknown key `b`"]),
        ("f=3", &["must be an expression in quotes, not the number 3", "k*x + c*v"]),
        ("parameters={ k = 3, c = 5 }", &["needs the parameter f"]),
        ("b=\"5 bananas\"", &["bananas"]),
        ("c=\"5 N\"", &["`c` of `parameters`"]),
        ("network='expression(\"k*x\", k, b)'", &["--set:1:", "`b` does not occur"]),
    ] {
        refused(&place, set, words);
    }
    // Friction that turns round at once finds no way where it should stick.
    let place = Place::with(
        "[robot]\n[[robot.body]]\nname = \"slide\"\nmass = 2\n\
         joint = { name = \"s\", kind = \"prismatic\", axis = [1, 0, 0] }\n\
         [[element]]\nname = \"e\"\njoint = \"s\"\nnetwork = \"expression(f)\"\n\
         parameters = { f = \"k*x + mu*sign(v)\", k = \"0.3 kN/m\", mu = \"2 N\" }\n\
         [motion]\nkind = \"forward\"\nstart = { v = { s = 0.3 } }\n[time]\nend = 1\noutput_step = 0.1\n",
    );
    let failed = place.springpot(&["run", "arm.toml"]);
    assert_eq!(failed.code, Some(1), "{}", failed.stderr);
    assert!(failed.said().contains("arm.toml:10:"), "{}", failed.stderr);
    assert!(failed.said().contains("jumps again and again without getting on"), "{}", failed.stderr);
}

#[test]
fn leaves_that_yield_stand_beside_others() {
    let parameters =
        "parameters = { k = 100, f = 5, v0 = 0.01, lower = -0.1, upper = 0.1, h = 1, A = 1, b = 1, g = 2, n = 2 }\n";
    let place = with(&format!(
        "network = \"series(spring(k), parallel(spring(k), friction(f, v0), stop(k, lower, upper), bouc-wen(h, A, b, g, n)))\"\n{parameters}"
    ));
    place.done(&["run", "arm.toml"]);
    let yields = "does not hold at times: what stands behind it would be free";
    for (leaf, given, words) in [
        ("tension(k), compression(l)", "k = 100, l = 5", "`tension(k)` only pulls and `compression(l)` only pushes"),
        ("series(compression(l), series(spring(k), tension(k)))", "k = 100, l = 5", "only pulls and"),
        (
            "parallel(tension(k), compression(l))",
            "k = 100, l = 5",
            "has parts beside each other of which one lets go: in a series that has to stand by itself",
        ),
        ("tension(l)", "k = 100, l = 0", "`tension(l)` gives none"),
        ("preload(f)", "k = 100, f = 1", yields),
        ("polynomial(k, l, m)", "k = 100, l = 1, m = 0", yields),
        ("bouc-wen(k, A, b, g, n)", "k = 100, A = 1, b = 1, g = 1, n = 1", yields),
        ("stop(k, a, b)", "k = 100, a = 1, b = -1", "lower ≤ upper in `stop(k, a, b)`"),
        ("friction(f, v0)", "k = 100, f = -1, v0 = 1", "is -1 N"),
        ("friction(f, v0)", "k = 100, f = 1, v0 = 0", "is 0 m/s"),
        ("bouc-wen(k, A, b, g, n)", "k = 100, A = 0, b = 1, g = 1, n = 1", "`A`"),
        ("bouc-wen(k, A, b, g, n)", "k = 100, A = 1, b = 1, g = 1, n = 0.5", "`n`"),
        ("bouc-wen(k, A, b, g, n)", "k = 100, A = 1, b = 3, g = 1, n = 1", "gamma ≥ |beta|"),
        ("bouc-wen(k, A, b, g, n)", "k = 100, A = 1, b = -1, g = 1, n = 1", "gamma + beta > 0"),
        ("preload(f)", "k = 100, f = 0", "`preload(f)` gives none"),
    ] {
        let law = format!("network = \"series(spring(k), {leaf})\"\nparameters = {{ {given} }}\n");
        refused(&with(&law), "name=\"damper\"", &[words]);
    }
}

#[test]
fn leaves_that_let_go_stand_in_series() {
    for (network, given) in [
        ("series(tension(k), springpot(c, alpha))", "k = 100, c = 40, alpha = 0.5"),
        ("series(compression(k), parallel(spring(l), springpot(c, alpha)))", "k = 900, l = 30, c = 40, alpha = 0.4"),
        ("series(rope: stop(k, a, b), springpot(c, alpha))", "k = 100, a = -0.02, b = 0.01, c = 40, alpha = 0.5"),
        ("series(spring(k), friction(f, v0))", "k = 100, f = 1, v0 = 0.01"),
        ("series(tension(k), dashpot(c), friction(f, v0))", "k = 100, c = 40, f = 1, v0 = 0.01"),
    ] {
        let place = with(&format!("network = \"{network}\"\nparameters = {{ {given} }}\n"));
        place.done(&["run", "arm.toml"]);
        place.done(&["check", "arm.toml"]);
    }
}

fn refused(place: &Place, set: &str, words: &[&str]) {
    let refused = place.springpot(&["check", "arm.toml", "--set", &format!("element.damper.{set}")]);
    let said = refused.said();
    assert_eq!(refused.code, Some(2), "{set}: {}", refused.stderr);
    words.iter().for_each(|words| assert!(said.contains(words), "{set}: {words:?} is not in {}", refused.stderr));
}

#[test]
fn what_is_wrong_with_a_network_is_said_where_it_is() {
    let place = with("network = \"series(spring(k), dashpot(c))\"\nparameters = { k = 100, c = 5 }\n");
    for (set, words) in [
        ("network=\"series(sprng(k), dashpot(c))\"", &["there is no leaf `sprng`", "did you mean `spring`?"][..]),
        ("network=\"series(spring(k), dashpot(c)\"", &["--set:1:31:", "this parenthesis is never closed"]),
        ("network=\"series(spring(k), dashpot(c)))\"", &["nothing may follow the network, not `)`"]),
        ("network=\"series(spring(100), dashpot(c))\"", &["not `100`", "their values in `parameters`"]),
        ("network=\"series(spring(k), springpot(c))\"", &["`springpot` takes 2 names, not 1", "springpot(c, alpha)"]),
        ("network=\"series(spring(k), dashpot(k))\"", &["`k` is in N*s/m here, but N/m before"]),
        ("network=\"a: series(spring(k), dashpot(c))\"", &["only leaves have names"]),
        ("network=\"series(a: spring(k), a: dashpot(c))\"", &["there are two leaves `a`"]),
        ("network=\"series(force: spring(k), dashpot(c))\"", &["`force` is a column of every element"]),
        ("network=\"\"", &["a part is wanted, not the end"]),
        ("parameters={ k = 100, c = 0 }", &["every part of a series to carry its force, but `dashpot(c)` gives none"]),
        ("parameters={ k = 100 }", &["needs the parameters c"]),
        ("parameters={ k = -1, c = 5 }", &["`k`", "is -1"]),
        ("law=spring", &["`network` of element \"damper\" stands beside a `law`"]),
        ("kc=3", &["has no `kc`"]),
    ] {
        refused(&place, set, words);
    }
    let place = with("law = \"prony\"\nparameters = { k_e = 1, k = [1, 2], tau = [1, 2] }\n");
    for (set, words) in [
        ("k=[1, 2, 3]", &["`tau`", "has 2 values, but `k` has 3"][..]),
        ("k=3", &["must be an array of values, not the number 3"]),
        ("tau.1=0", &["`tau`", "is 0 s"]),
        ("parameters={ k_e = 1 }", &["needs the parameters k and tau"]),
        ("parameters={ k_e = 1, table = { csv = \"no.csv\", k = \"k\", tau = \"t\" } }", &["no.csv", "cannot be read"]),
        (
            "parameters={ k_e = 1, k = [1], table = { csv = \"no.csv\", k = \"k\", tau = \"t\" } }",
            &["stands beside `k`"],
        ),
    ] {
        refused(&place, set, words);
    }
}

#[test]
fn leaves_have_columns_of_their_own() {
    let parameters = "parameters = { k_e = \"200 N/m\", k_m = \"3 kN/m\", c = \"80 N*s^a/m\", a = 0.4, eta = 2 }\n";
    let network = "parallel(spring(k_e), series(glass: spring(k_m), springpot(c, a), dashpot(eta)))";
    let place = with(&format!("network = \"{network}\"\n{parameters}"));
    place.done(&["run", "arm.toml", "--set", "output.leaves=true"]);
    let rows = place.table("results/arm/results.csv");
    let of = |leaf: &str, what: &str| rows.numbers(&format!("damper.{leaf}.{what}"));
    let near = |a: f64, b: f64, size: f64| assert!((a - b).abs() < 1e-9 * size, "{a} {b}");
    let (stroke, force) = (rows.numbers("damper.stroke"), rows.numbers("damper.force"));
    let size = force.iter().fold(0.0f64, |most, force| most.max(force.abs()));
    for k in 0..stroke.len() {
        // One stroke in parallel, one force in series; each leaf by its own law.
        near(of("spring1", "stroke")[k], stroke[k], 1.0);
        near(of("glass", "stroke")[k] + of("springpot1", "stroke")[k] + of("dashpot1", "stroke")[k], stroke[k], 1.0);
        near(of("spring1", "force")[k] + of("glass", "force")[k], force[k], size);
        near(of("springpot1", "force")[k], of("glass", "force")[k], 1e3 * size);
        near(of("springpot1", "force")[k], 80.0 * of("springpot1", "derivative")[k], size);
        near(of("dashpot1", "force")[k], 2.0 * of("dashpot1", "rate")[k], size);
        near(of("springpot1", "derivative")[k], rows.numbers("damper.derivative")[k], 1.0);
    }
    assert_eq!(rows.header.iter().filter(|name| name.starts_with("damper.spring1.")).count(), 4);
}

#[test]
fn there_is_a_derivative_where_one_springpot_is() {
    for (network, parameters, is_there) in [
        ("series(spring(k), springpot(c, a))", "k = 100, c = 5, a = 0.5", true),
        ("parallel(springpot(c, a), springpot(d, b))", "c = 5, a = 0.5, d = 3, b = 0.2", false),
        ("series(spring(k), dashpot(d))", "k = 100, d = 3", false),
    ] {
        let place = with(&format!("network = \"{network}\"\nparameters = {{ {parameters} }}\n"));
        place.done(&["run", "arm.toml"]);
        let header = place.table("results/arm/results.csv").header;
        assert_eq!(header.contains(&"damper.derivative".to_owned()), is_there, "{network}");
        let scheme = place.springpot(&["check", "arm.toml", "--set", "element.damper.scheme=l1"]);
        assert_eq!(scheme.code, Some(if network.starts_with("series") { 2 } else { 0 }), "{}", scheme.stderr);
    }
}

#[test]
fn pasts_are_said_and_judged() {
    let law = "law = \"fractional-zener\"\nparameters = { k_e = 100, k_m = 300, c = 80, alpha = 0.4 }\n";
    let place = with(law);
    let run = |past: &str| {
        let set = |key: &str| format!("element.damper.{key}");
        let sets: Vec<String> = past.split(';').map(set).collect();
        let arguments: Vec<&str> =
            ["run", "arm.toml"].into_iter().chain(sets.iter().flat_map(|set| ["--set", set])).collect();
        place.springpot(&arguments)
    };
    let force = || place.table("results/arm/results.csv").numbers("damper.force");
    for (past, derivative) in [("held", "caputo"), ("unloaded", "riemann-liouville")] {
        assert_eq!(run(&format!("rest_length=0.4;past={past}")).code, Some(0));
        let said = force();
        assert_eq!(run(&format!("rest_length=0.4;derivative={derivative}")).code, Some(0));
        assert_eq!(said, force(), "{past}");
    }
    // Between them.
    assert_eq!(run("rest_length=0.4;past={ held = \"10 s\" }").code, Some(0));
    let (first, element) = (force()[0], place.record("results/arm")["plan"]["elements"][0].clone());
    assert!(10.0 < first && first < 40.0, "{first}");
    assert_eq!(element["past"], serde_json::json!({ "held": 10.0 }));
    let checked = place.done(&["check", "arm.toml", "--set", "element.damper.past={ held = \"10 s\" }"]);
    assert!(checked.stdout.contains("held at x(0) for 10 s before t = 0"), "{}", checked.stdout);
    for (past, words) in [
        ("past=steady", &["has no `period`"][..]),
        ("past=\"steady\";period=0.3", &["the stroke is not periodic with 0.3 s", "{ held ="]),
        ("past=held;period=1", &["has no meaning without past = \"steady\""]),
        ("past=held;derivative=caputo", &["`derivative`", "stands beside a `past`"]),
        ("past=hold", &["is no past", "did you mean `held`?"]),
        ("past={ held = 0 }", &["`held`", "must be positive"]),
        (
            "law=springpot;parameters={ c = 1, alpha = 0.5 };scheme=l1;past={ held = 1 }",
            &["knows nothing before t = 0"],
        ),
    ] {
        let refused = run(past);
        let said = refused.said();
        assert_eq!(refused.code, Some(2), "{past}: {}", refused.stderr);
        words.iter().for_each(|words| assert!(said.contains(words), "{past}: {words:?} is not in {}", refused.stderr));
    }
}

#[test]
fn a_jump_is_infinite_only_where_nothing_yields() {
    for (law, is_infinite) in [
        ("law = \"springpot\"\nparameters = { c = 80, alpha = 0.4 }\n", true),
        ("law = \"fractional-maxwell\"\nparameters = { k = 300, c = 80, alpha = 0.4 }\n", false),
    ] {
        let said = with(law).done(&[
            "check",
            "arm.toml",
            "--set",
            "element.damper.rest_length=0.45",
            "--set",
            "element.damper.past=unloaded",
        ]);
        let words = said.said();
        assert!(words.contains("its energy is not known") && words.contains("past = { held"), "{words}");
        assert_eq!(words.contains("its force is infinite"), is_infinite, "{words}");
    }
}
