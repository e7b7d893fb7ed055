//! run.json of somebody else, in the hands of all that read it.

use crate::mutation::{Dice, mutated};
use crate::trial::alone;

/// A swept run with figures, metrics and an event's file.
const SCENARIO: &str = r#"
[[robot.body]]
name = "arm"
joint = { name = "q1", kind = "revolute", axis = [0, 1, 0], origin = [0, 0, 0.5] }
mass = 2
com = [0.2, 0, 0]
inertia = { xx = 0.01, yy = 0.05, zz = 0.05 }
[[element]]
name = "strut"
from = { body = "world", point = [0, 0.1, 0] }
to = { body = "arm", point = [0.3, 0, 0] }
rest_length = "55 cm"
law = "fractional-kelvin-voigt"
parameters = { k = 30, c = 5, alpha = 0.5 }
[motion]
kind = "forward"
[time]
end = 0.2
output_step = 0.05
[[sweep]]
parameter = "element.strut.alpha"
values = [0.2, 0.5]
[[sweep]]
parameter = ["element.strut.k", "element.strut.c"]
values = [[10, 20], [1, 2]]
[[metric]]
name = "swing"
of = "q.q1"
kind = "max"
"#;

const PIECES: &str = "{¦}¦[¦]¦,¦:¦null¦true¦\"\"¦\"labels\": []¦\"values\": [[1, 2], [3, 4]]¦\"count\": 1e9¦-1¦\"sweeps\": [],¦\
\"columns\": [],¦\"cases\": [],¦\"scenes\": [],¦\"rows\": 18446744073709551615,¦{}¦[[]]¦[null]¦\
\"status\": \"done\",¦\"figures/../../x\"¦\"strut.force\"¦\"index\": 99,¦\"\\ud800\"";

fn try_records(name: &str, count: usize, seed: u64) {
    alone(name, |trial| {
        trial.write("arm.toml", SCENARIO);
        let (toml, out, to) = (trial.path("arm.toml"), trial.path("out"), trial.path("to"));
        let [toml, out] = [&toml, &out].map(|path| path.to_str().unwrap());
        assert_eq!(trial.springpot(&["run", toml, "--out", out, "--quiet"]), 0);
        std::fs::create_dir(&to).unwrap();
        let file = |name: &str| to.join(name).to_str().unwrap().to_owned();
        let (svg, page, csv) = (file("p.svg"), file("p.html"), file("m.csv"));
        let (mcap, model) = (file("o.mcap"), file("o.gltf"));
        let record = trial.path("out/run.json");
        let whole = std::fs::read_to_string(&record).unwrap();
        let (mut dice, mut codes) = (Dice::new(seed), [0; 3]);
        for k in 0..count {
            let text = mutated(&whole, PIECES, &mut dice);
            std::fs::write(&record, &text).unwrap();
            let arguments: &[&str] = match k % 7 {
                0 => &["plot", out, "strut.force", "--out", &svg],
                1 => &["plot", out, "max(strut.force)", "--x", "element.strut.alpha", "--out", &svg],
                2 => &["view", out, "--out", &page],
                3 => &["report", out, "--out", &page],
                4 => &["metrics", out, "--metric", "rms(strut.force)", "--out", &csv],
                5 => &["export", out, &mcap],
                _ => &["export", out, &model],
            };
            let note = format!("{arguments:?}\n{text}");
            codes[usize::from(trial.one(&note, || trial.springpot(arguments)))] += 1;
        }
        println!("tried {count} records, ends {codes:?}");
        assert!(codes[0] > count / 20 && codes[2] > count / 20, "{codes:?}");
    });
}

#[test]
fn damaged_records_are_answered() {
    try_records("records::damaged_records_are_answered", 350, 7);
}

#[test]
#[ignore = "some minutes"]
fn a_hundred_thousand_damaged_records_are_answered() {
    try_records("records::a_hundred_thousand_damaged_records_are_answered", 100_000, 8);
}
