//! URDF files, described and let go.

use crate::mutation::{Dice, mutated};
use crate::trial::alone;

const ROBOTS: [&str; 3] = ["double_pendulum", "ur5", "solo12"];

const PIECES: &str = "<¦>¦/>¦\"¦&¦&#0;¦&amp;¦<!--¦-->¦]]>¦<?x?>¦<link name=\"a\"/>¦</link>¦<robot>¦</robot>¦\
<mimic joint=\"joint1\" multiplier=\"1e9\"/>¦<limit lower=\"1\" upper=\"-1\"/>¦type=\"floating\"¦0 0 0¦1e300¦\
<inertial/>¦<origin rpy=\"nan 0 0\"/>";

fn try_robots(name: &str, count: usize, seed: u64) {
    let texts = ROBOTS.map(|robot| {
        let file = format!("{}/../../testdata/multibody/{robot}.urdf", env!("CARGO_MANIFEST_DIR"));
        std::fs::read_to_string(file).unwrap()
    });
    alone(name, |trial| {
        let (mut dice, mut codes) = (Dice::new(seed), [0; 3]);
        let scenario = "robot = { urdf = \"r.urdf\", accept_inertia = true }\n[motion]\nkind = \"forward\"\n\
                        [time]\nend = 1e-3\noutput_step = 1e-3\n[solver]\nmax_steps = 50\n";
        trial.write("r.toml", scenario);
        for k in 0..count {
            let base: &str = &texts[dice.roll(texts.len())];
            let text = mutated(base, PIECES, &mut dice);
            trial.write("r.urdf", &text);
            let (urdf, toml, out) = (trial.path("r.urdf"), trial.path("r.toml"), trial.path("out"));
            let [urdf, toml, out] = [&urdf, &toml, &out].map(|path| path.to_str().unwrap());
            let arguments: &[&str] = match k % 4 {
                0 => &["info", urdf],
                1 => &["info", urdf, "--json", "--floating-base", "--accept-inertia"],
                2 => &["check", toml],
                _ => &["run", toml, "--out", out, "--quiet"],
            };
            codes[usize::from(trial.one(&text, || trial.springpot(arguments)))] += 1;
        }
        println!("tried {count} robots, ends {codes:?}");
        assert!(codes[0] > count / 20 && codes[2] > count / 20, "{codes:?}");
    });
}

#[test]
fn damaged_robots_are_answered() {
    try_robots("robots::damaged_robots_are_answered", 200, 5);
}

#[test]
#[ignore = "some minutes"]
fn a_hundred_thousand_damaged_robots_are_answered() {
    try_robots("robots::a_hundred_thousand_damaged_robots_are_answered", 100_000, 6);
}
