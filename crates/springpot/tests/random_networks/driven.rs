//! A network along a motion, run as any system.

use crate::make::{Motion, Past, Shape, Tree, entry};
use springpot::driver::run;
use springpot::elements::{Element, Joint};
use springpot::law::Periodic;
use springpot::model::{BodySpec, JointSpec, ModelBuilder, Parent};
use springpot::motion::{JointPath, Trajectory};
use springpot::signal::{Expression, Signal};
use springpot::system::{RowTimes, RunError, Settings, Stop, System};
use std::f64::consts::TAU;

/// Steps after which a run counts as failed.
const MOST_STEPS: u64 = 200_000;

/// The forces at these times, or what stopped the run.
pub(crate) fn forces(tree: &Tree, motion: &Motion, past: Past, times: &[f64]) -> Result<Vec<f64>, RunError> {
    let mut builder = ModelBuilder::new([0.0; 3]);
    let joint = JointSpec::prismatic("x", [1.0, 0.0, 0.0], [0.0; 3]);
    let (com, inertia) = ([0.0; 3], [[0.0; 3]; 3]);
    let body = BodySpec { name: "b".into(), parent: Parent::World, joint, mass: 1.0, com, inertia };
    builder.push(body).expect("a body");
    let model = builder.finish().expect("a model");
    let entry = entry(tree.network(past.derivative()));
    let measure = Joint::new(&model, 0).expect("a joint of one degree");
    let element = Element::new("e", measure, 0.0, &entry, &[], past.derivative()).expect("a law");
    let element = element.with_past(told(past, motion)).expect("a past of linear laws");
    let stroke = Signal::expression(Expression::parse(&motion.text()).expect("an expression"));
    let motion = Trajectory::Prescribed(vec![JointPath::Coordinate(stroke)]);
    let system = System::new(model, vec![element], motion);
    let end = *times.last().expect("times");
    let settings = Settings { max_steps: Some(MOST_STEPS), ..Settings::new(end, RowTimes::Times(times.into())) };
    let mut table = system.table();
    let (_, outcome) = run(&system, &settings, &mut table, &Stop::new(false));
    outcome.map(|()| table.column("e.force").expect("a column of every element"))
}

/// The past as elements are told it.
fn told(past: Past, motion: &Motion) -> springpot::law::Past {
    match past {
        Past::Since | Past::Unloaded => springpot::law::Past::OfDerivative,
        Past::Held(age) => springpot::law::Past::Held(age),
        Past::Steady { period, size } => {
            let stroke = |k: u32| motion.start + size * (TAU * f64::from(k) / 64.0).sin();
            springpot::law::Past::Periodic(Periodic::new(period, &(0..64).map(stroke).collect::<Vec<f64>>()).0)
        }
    }
}

/// The motion that goes on as it was.
pub(crate) fn steady(past: Past, motion: Motion) -> Motion {
    match past {
        Past::Steady { period, size } => Motion { shapes: vec![(size, Shape::Sine(TAU / period), 0.0)], ..motion },
        _ => motion,
    }
}
