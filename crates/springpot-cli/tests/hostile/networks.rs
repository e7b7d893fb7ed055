//! Networks of laws as text.

use crate::mutation::{Dice, mutated};
use crate::trial::alone;

/// What an element is made of: a network and its parameters.
const NETWORKS: [&str; 8] = [
    "network = \"parallel(spring(k), series(spring(m), springpot(c, a)))\"\nparameters = { k = \"1 N/cm\", m = 500, c = 20, a = 0.4 }",
    "network = \"series(spring(k), parallel(springpot(c, a), dashpot(d)))\"\nparameters = { k = 400, c = 20, a = 0.4, d = \"3 N*s/m\" }",
    "network = \"parallel(spring(k), springpot(c, a))\"\nparameters = { k = 5, c = \"2 N*s^a/m\", a = 0.9 }",
    "network = \"series(spring(k), dashpot(d), springpot(c, a), parallel(spring(m), dashpot(e)))\"\nparameters = { k = 9, d = 3, c = 2, a = 0.5, m = 5, e = 2 }",
    "network = \"series(glass: spring(k), dashpot(d))\"\nparameters = { k = 1e3, d = 9 }",
    "network = \"parallel(spring(k), friction(f, v))\"\nparameters = { k = 20, f = 2, v = \"1 mm/s\" }",
    "network = \"parallel(tension(k), compression(m))\"\nparameters = { k = 20, m = 30 }",
    "network = \"series(springpot(c, a), springpot(d, b))\"\nparameters = { c = 5, a = 0.9, d = 4, b = 0.8 }",
];

const PIECES: &str = "(¦)¦,¦ = ¦parallel(¦series(¦spring(k)¦dashpot(d)¦springpot(c, a)¦k¦c¦a¦N/m¦N*s^a/m¦friction(¦\
polynomial(¦stop(¦bouc-wen(¦\\\"¦\\u00e9¦glass: ¦0.5 N/cm¦+¦*2¦x¦k = ";

const SCENARIO: &str = "[[robot.body]]\nname = \"b\"\njoint = { name = \"x\", kind = \"prismatic\", axis = [1, 0, 0] }\nmass = 1\n\
                        [[element]]\nname = \"e\"\njoint = \"x\"\nrest = 0\nNETWORK\n\
                        [motion]\nkind = \"prescribed\"\njoints = { x = \"0.01*sin(4*t)\" }\n[time]\nend = 0.1\noutput_step = 0.05\n";

fn try_networks(name: &str, count: usize, seed: u64) {
    alone(name, |trial| {
        let (mut dice, mut codes) = (Dice::new(seed), [0; 3]);
        for _ in 0..count {
            let base = dice.pick(&NETWORKS);
            let text = SCENARIO.replace("NETWORK", &mutated(base, PIECES, &mut dice));
            trial.write("n.toml", &text);
            let file = trial.path("n.toml");
            codes[usize::from(trial.one(&text, || trial.springpot(&["check", file.to_str().unwrap()])))] += 1;
        }
        println!("tried {count} networks, ends {codes:?}");
        assert!(codes[0] > count / 50 && codes[2] > count / 5, "{codes:?}");
    });
}

#[test]
fn damaged_networks_are_answered() {
    try_networks("networks::damaged_networks_are_answered", 400, 1);
}

#[test]
#[ignore = "some minutes"]
fn a_hundred_thousand_damaged_networks_are_answered() {
    try_networks("networks::a_hundred_thousand_damaged_networks_are_answered", 100_000, 2);
}
