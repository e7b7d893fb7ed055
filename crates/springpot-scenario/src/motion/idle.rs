//! Joints whose motion no equation tells: the mass matrix is singular along them.

use crate::robot::{OwnJoint, Robot};
use springpot::dynamics::{Kinematics, crba};

/// Below this share of its own inertia, what a joint moves that others do not is what rounded angles leave (1.5708 for a right one); a chain of 1000
/// equal links has 3e-9.
const NOTHING: f64 = 1e-10;

/// Indices of the joints of one degree that may stay (`is_idle`) and that carry nothing where the robot starts, or nothing that the joints behind them
/// do not move alike: a point mass on three axes through one point. Joints that are led take no part.
///
/// They are the pivots that vanish where M is eliminated from the tips to the root.
pub(super) fn joints(
    robot: &Robot,
    start: Option<&[f64]>,
    is_led: impl Fn(&OwnJoint<'_>) -> bool,
    is_idle: impl Fn(&OwnJoint<'_>) -> bool,
) -> Vec<usize> {
    let model = robot.model();
    let neutral = model.neutral();
    let n = model.nv();
    let mut mass = crba(model, &Kinematics::at_position(model, start.unwrap_or(&neutral)));
    let diagonal: Vec<f64> = (0..n).map(|k| mass[k * n + k]).collect();
    let mut still = Vec::new();
    for (j, joint) in model.own_joints().zip(robot.own_joints()).collect::<Vec<_>>().into_iter().rev() {
        for k in model.v_range(j).rev() {
            let pivot = mass[k * n + k];
            if is_led(&joint) {
                continue;
            }
            if pivot.abs() <= NOTHING * diagonal[k] {
                if joint.units().is_some() && is_idle(&joint) {
                    still.push(j);
                }
                continue;
            }
            for row in 0..k {
                let share = mass[row * n + k] / pivot;
                for column in 0..k {
                    mass[row * n + column] -= share * mass[k * n + column];
                }
            }
        }
    }
    still.reverse();
    still
}
