//! Expressions of time, as a motion and as a torque, looked through as before a run.

use crate::mutation::{Dice, mutated};
use crate::trial::alone;

const EXPRESSIONS: [&str; 12] = [
    "0.05 - 0.05*cos(6*t) + 0.001*sin(60*t)",
    "0.1*min(1, max(0, t - 0.2))*sin(3*t)",
    "0.02*abs(sin(5*t))",
    "0.01*exp(-((t - 0.3)/0.05)^2)",
    "0.1*sqrt(t + 0.01)/(1 + t^2)",
    "0.03*tanh(10*(t - 0.25))",
    "0.02*sin(2*pi*3*t + 0.1*t^2)",
    "max(0.01, min(0.02, 0.1*t))",
    "0.1*(t*(t < 0.2) + 0.2*(t >= 0.2))",
    "0.001*atan2(sin(t), cos(t))",
    "0.1*sign(t - 0.2)*(t - 0.2)^2",
    "0.01*floor(4*t) + 0.01*t",
];

const PIECES: &str = "sin(¦cos(¦tan(¦exp(¦log(¦sqrt(¦abs(¦min(¦max(¦sign(¦step(¦floor(¦tanh(¦atan2(¦t¦pi¦e¦(¦)¦,¦+¦-¦*¦/¦^¦**¦<¦>=¦\
1/t¦t^t¦max(0, ¦*sin(300*t)¦mod(t, 0.1)¦q.x";

fn scenario(motion: &str) -> String {
    format!(
        "[[robot.body]]\nname = \"b\"\njoint = {{ name = \"x\", kind = \"prismatic\", axis = [1, 0, 0] }}\nmass = 1\n\
         [[element]]\nname = \"e\"\njoint = \"x\"\nlaw = \"fractional-kelvin-voigt\"\nparameters = {{ k = 4, c = 0.2, alpha = 0.5 }}\n\
         [motion]\n{motion}\n[time]\nend = 0.5\noutput_step = 0.25\n[solver]\nmax_steps = 2000\n"
    )
}

fn try_expressions(name: &str, count: usize, seed: u64) {
    alone(name, |trial| {
        let (mut dice, mut codes) = (Dice::new(seed), [0; 3]);
        for k in 0..count {
            let base = dice.pick(&EXPRESSIONS);
            let text = serde_json::to_string(&mutated(base, PIECES, &mut dice)).unwrap();
            let text = scenario(&match k % 3 {
                0 => format!("kind = \"forward\"\ntorque = {{ x = {text} }}"),
                _ => format!("kind = \"prescribed\"\njoints = {{ x = {text} }}"),
            });
            trial.write("e.toml", &text);
            let (file, out) = (trial.path("e.toml"), trial.path("out"));
            let (file, out) = (file.to_str().unwrap(), out.to_str().unwrap());
            let arguments: &[&str] = match k % 2 {
                0 => &["check", file],
                _ => &["run", file, "--out", out, "--quiet", "--jobs", "1"],
            };
            codes[usize::from(trial.one(&text, || trial.springpot(arguments)))] += 1;
        }
        println!("tried {count} expressions, ends {codes:?}");
        assert!([codes[0], codes[2]].iter().all(|ended| *ended > count / 100), "{codes:?}");
    });
}

#[test]
fn damaged_expressions_are_answered() {
    try_expressions("expressions::damaged_expressions_are_answered", 300, 3);
}

#[test]
#[ignore = "some minutes"]
fn a_hundred_thousand_damaged_expressions_are_answered() {
    try_expressions("expressions::a_hundred_thousand_damaged_expressions_are_answered", 100_000, 4);
}
