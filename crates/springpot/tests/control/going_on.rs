//! Runs under control that go on from a state, to the bit.

use super::arm::scenario;
use super::support::{
    cases,
    forward::{every, slider, state},
};
use springpot::Simulation;
use springpot::driver::{Checkpoint, Rows, resume, run};
use springpot::system::Stop;

/// Rows, and states with how many rows were written before them.
#[derive(Debug, Default)]
struct Kept {
    rows: Vec<Vec<f64>>,
    states: Vec<(Checkpoint, usize)>,
}

impl Rows for Kept {
    fn row(&mut self, values: &[f64]) -> std::io::Result<()> {
        self.rows.push(values.to_vec());
        Ok(())
    }

    fn wants_checkpoint(&mut self, _: f64, _: bool) -> bool {
        true
    }

    fn checkpoint(&mut self, state: Checkpoint) -> std::io::Result<()> {
        self.states.push((state, self.rows.len()));
        Ok(())
    }
}

fn bits(rows: &[Vec<f64>]) -> Vec<Vec<u64>> {
    rows.iter().map(|row| row.iter().map(|value| value.to_bits()).collect()).collect()
}

fn scenarios() -> Vec<String> {
    let free = "law = \"magnetorheological\"\nparameters = { E_c = 50, mu_0 = 5, mu = 3, alpha = 0.6 }\n\
                inputs = { u = { expression = \"step(e.rate*v.q)\", unit = \"V\", sample = \"5 ms\" } }";
    let slider = |torque: &str| {
        format!(
            "{}torque = {{ q = {torque} }}\n{}",
            slider("2", -9.81, free, &state("0.1", "0")),
            every(0.6, 0.02, 1e-9)
        )
    };
    let kp = "kp = { q1 = 200, q2 = 300, q3 = 120 }\nkd = { q1 = 20, q2 = 30, q3 = 8 }";
    vec![
        slider("\"-50*abs(q.q) - 3*v.q + 2*abs(sin(40*t)) + step(t - 0.31)\""),
        scenario(
            &format!(
                "kind = \"pid\"\n{kp}\nki = {{ q1 = 400, q2 = 2500, q3 = 300 }}\nlimits = {{ q1 = 6, q2 = 26, q3 = 7 }}"
            ),
            0.1,
        ),
        scenario(
            &format!("kind = \"fractional-pid\"\n{kp}\nki = 50\nlambda = 0.5\nmu = 0.8\nlimits = {{ q2 = 40 }}"),
            0.1,
        ),
        scenario(&format!("kind = \"pd-gravity\"\n{kp}\nrate_limits = {{ q2 = 150 }}"), 0.1),
        scenario(
            "kind = \"pid\"\nkp = { q1 = 40, q2 = 60, q3 = 8 }\nkd = { q1 = 4, q2 = 6, q3 = 0.4 }\nki = 10\nlimits = { q2 = 12 }\nsample = \"10 ms\"\ndelay = \"20 ms\"",
            0.1,
        ),
        scenario("kind = \"computed-torque\"\nkp = 80\nkd = 15\ncompensate_elements = true", 0.1),
    ]
}

#[test]
fn runs_go_on_from_any_state() {
    for (k, text) in scenarios().into_iter().enumerate() {
        let plan = cases(&text).plan(0).unwrap();
        let system = plan.system();
        let mut whole = Kept::default();
        run(&system, &plan.settings, &mut whole, &Stop::new(false)).1.unwrap();
        assert!(whole.states.len() > 5);
        // Of the first, each state: those between two branches are among them.
        let every = if k == 0 { 1 } else { 1 + whole.states.len() / 6 };
        for (state, written) in whole.states.iter().step_by(every) {
            let mut rest = Kept::default();
            resume(&system, &plan.settings, state.clone(), &mut rest, &Stop::new(false)).1.unwrap();
            for (got, wanted) in rest.rows.iter().zip(&whole.rows[*written..]) {
                let names = system.columns();
                let other = got.iter().zip(wanted).position(|(a, b)| a.to_bits() != b.to_bits());
                let where_ = other.map(|k| (&names[k].name, got[k], wanted[k]));
                assert!(other.is_none(), "from t = {}, row t = {}: {where_:?}: {text}", state.t(), got[0]);
            }
            assert_eq!(rest.rows.len(), whole.rows.len() - written);
        }
    }
}

#[test]
fn simulations_go_back() {
    for text in scenarios() {
        let plan = cases(&text).plan(0).unwrap();
        let mut robot = Simulation::new(plan.system(), plan.settings.clone()).unwrap();
        robot.step_to(0.15).unwrap();
        let before = robot.state().unwrap();
        robot.step_to(0.45).unwrap();
        let there = [robot.q().to_vec(), robot.v().to_vec()].concat();
        robot.set_state(&before).unwrap();
        robot.step_to(0.45).unwrap();
        let again = [robot.q().to_vec(), robot.v().to_vec()].concat();
        assert!(bits(&[there]) == bits(&[again]), "{text}");
    }
}
