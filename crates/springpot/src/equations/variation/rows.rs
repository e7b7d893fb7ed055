//! What parameters change of what rows tell.

use super::{ElementVariation, ROW, Variation, of_step};
use crate::dynamics::point_jacobian;
use crate::equations::assembly::Equations;
use crate::equations::node::Node;
use crate::law::Point;
use crate::law::variation::{ObservationVariation, PointVariation};
use crate::model::Model;
use crate::observe::{ElementQuantity, EnergyQuantity, LeafQuantity, Quantity, Snapshot};
use crate::system::sensitivity::Seed;

impl ElementVariation {
    /// What it is told of node `i`, of the step at hand where it is within one.
    pub(super) fn told(&self, count: usize, i: usize, theta: Option<f64>) -> PointVariation<'_> {
        let Self { stroke, rate, inputs, .. } = self;
        let blocks = inputs.each_ref().map(|blocks| {
            let own = blocks.len() / (ROW + 1);
            &blocks[i * own..(i + 1) * own]
        });
        PointVariation {
            stroke: &stroke[i * count..(i + 1) * count],
            rate: &rate[i * count..(i + 1) * count],
            inputs: blocks,
            step: theta.map(|_| of_step(count, [stroke, rate], inputs)),
            passed: None,
        }
    }
}

impl Variation {
    /// Whether what changes of a quantity is what changes of the motion alone.
    pub(crate) fn is_of_motion(model: &Model, of: Quantity) -> bool {
        match of {
            Quantity::Time | Quantity::Velocity(_) | Quantity::Acceleration(_) => true,
            // Of a quaternion it is what changes of the turn, seen from where that is.
            Quantity::Coordinate(_) => model.is_one_degree(),
            _ => false,
        }
    }

    /// What changes of coordinate `k` of the run at the row.
    fn coordinate(&self, k: usize) -> Vec<f64> {
        let (count, model, node, place) = (self.count(), &self.system.model, &self.nodes[ROW], self.coordinates.own[k]);
        let joint = model.own_joints().find(|&j| model.q_range(j).contains(&place)).expect("a coordinate of a joint");
        let (q, v) = (model.q_range(joint), model.v_range(joint));
        let slopes = model.joint_space(joint).slopes(&node.q_now[q.clone()], place - q.start);
        let mut sum = vec![0.0; count];
        for (slope, block) in slopes.iter().zip(node.q[v.start * count..v.end * count].chunks_exact(count.max(1))) {
            sum.iter_mut().zip(block).for_each(|(sum, turn)| *sum += slope * turn);
        }
        sum
    }

    /// Works out what changes at a row where the run is at `snapshot`, whose motion changes as node [`ROW`] has it: at θ of the step at hand, or
    /// between two.
    pub(crate) fn read(&mut self, equations: &Equations, theta: Option<f64>, snapshot: &Snapshot) {
        self.catch_up(equations);
        let evaluation = &snapshot.evaluation;
        let force: Vec<f64> = (0..self.elements.len()).map(|e| snapshot.force(e)).collect();
        if let Some(before) = self.before_kick.as_ref().filter(|_| evaluation.t == 0.0) {
            self.nodes[ROW].v.copy_from_slice(before);
        }
        self.move_row(equations, theta, snapshot);
        self.see(
            equations,
            ROW,
            Node { t: evaluation.t, q: &evaluation.q, v: &evaluation.v, a: &evaluation.a },
            &force,
        );
        self.steer(ROW, equations, &force);
        self.feed_back(ROW);
        self.push_at(ROW, theta, equations);
        self.read_works(equations, theta);
        for e in 0..self.elements.len() {
            self.measure(e, ROW);
            self.observe(equations, (e, ROW), theta, &evaluation.elements[e].point(evaluation.t));
        }
    }

    /// What changes of element `e` at node `i`, at θ of the step at hand or between two, where it is told `at`; strokes, rates and inputs there are known.
    pub(super) fn observe(&mut self, equations: &Equations, (e, i): (usize, usize), theta: Option<f64>, at: &Point) {
        let count = self.count();
        let mut row = std::mem::take(&mut self.elements[e].row);
        row.iter_mut().for_each(|blocks| {
            blocks.clear();
            blocks.resize(count, 0.0);
        });
        let mut tells = std::mem::take(&mut self.elements[e].told);
        tells.clear();
        let mut kept = std::mem::take(&mut self.elements[e].leaves);
        kept.clear();
        let is_of = |of: Quantity| matches!(of, Quantity::Element(own, ElementQuantity::Leaf(..)) if own == e);
        let gone_back = self.by.adjoint.iter().flatten().copied();
        let leaves = self.by.columns.iter().map(|column| column.of).chain(gone_back).any(is_of).then_some(&mut kept);
        let (own, [force, stored, derivative]) = (&self.elements[e], &mut row);
        let mut sum = ObservationVariation { force, stored, derivative, told: &mut tells, leaves };
        let told = own.told(count, i, theta);
        match theta {
            Some(theta) => equations.bank.vary_at(e, (theta, at), &told, &own.law, &mut sum),
            None => equations.bank.vary_now(e, (at, true), &told, &own.law, &mut sum),
        }
        if self.singular.is_there {
            let [change, ..] = self.singular_at(equations, (e, i), at.t, at);
            let [force, ..] = &mut row;
            force.iter_mut().zip(change).for_each(|(force, change)| *force += change);
        }
        (self.elements[e].row, self.elements[e].told, self.elements[e].leaves) = (row, tells, kept);
    }

    /// What changes of a quantity at the row that was read last, parameter by parameter, no number where that is lost; `None` where nothing is known
    /// of it.
    pub(crate) fn values(&self, quantity: Quantity, snapshot: &Snapshot) -> Option<Vec<f64>> {
        let mut values = self.finite_values(quantity, snapshot)?;
        values
            .iter_mut()
            .zip(&self.saltation.lost)
            .filter(|(_, lost)| lost.is_some())
            .for_each(|(value, _)| *value = f64::NAN);
        Some(values)
    }

    pub(super) fn finite_values(&self, quantity: Quantity, snapshot: &Snapshot) -> Option<Vec<f64>> {
        let (count, node, model) = (self.count(), &self.nodes[ROW], &self.system.model);
        let block = |blocks: &[f64], k: usize| blocks[k * count..(k + 1) * count].to_vec();
        let of_velocity = |blocks: &[f64], k: usize| block(blocks, self.own_v[k]);
        let each = |value: &dyn Fn(usize) -> f64| (0..count).map(value).collect();
        let along = |slopes: &[f64], blocks: &[f64], p: usize| -> f64 {
            slopes.iter().enumerate().map(|(k, slope)| slope * blocks[k * count + p]).sum()
        };
        Some(match quantity {
            Quantity::Time => vec![0.0; count],
            // Of joints of one degree coordinates and velocities go together.
            Quantity::Coordinate(k) if model.is_one_degree() => of_velocity(&node.q, k),
            Quantity::Coordinate(k) => self.coordinate(k),
            Quantity::Velocity(k) => of_velocity(&node.v, k),
            Quantity::Acceleration(k) => of_velocity(&node.a, k),
            Quantity::Torque(k) if snapshot.evaluation.driven[k].is_some() => {
                each(&|p| self.driven(k, p, node.t) + self.steered(k, p, snapshot))
            }
            Quantity::Torque(k) => {
                let row = self.own_v[k];
                let mut sum = vec![0.0; count];
                self.add_unbalanced(ROW, row, &mut sum);
                self.add_pulled(ROW, row, |e| &self.elements[e].row[0], &mut sum);
                sum
            }
            Quantity::Element(e, of) => {
                let (element, [gradient, _]) = (&self.elements[e], &node.gradients[e]);
                match of {
                    ElementQuantity::Length => each(&|p| along(gradient, &node.q, p)),
                    ElementQuantity::Stroke => block(&element.stroke, ROW),
                    ElementQuantity::Rate => block(&element.rate, ROW),
                    ElementQuantity::Force => element.row[0].clone(),
                    ElementQuantity::GeneralizedForce(k) => {
                        // Q_k = −F·∂y/∂q_k.
                        let (row, n) = (self.own_v[k], self.nv());
                        let turned = &node.hessians[e][row * n..(row + 1) * n];
                        let force = snapshot.force(e);
                        each(&|p| -(element.row[0][p] * gradient[row] + force * along(turned, &node.q, p)))
                    }
                    ElementQuantity::Stored => element.row[1].clone(),
                    ElementQuantity::Derivative => {
                        let law = &self.system.elements[e].law;
                        let order = law.reported_order(&snapshot.evaluation.elements[e].point(node.t));
                        match (law.has_memories(), law.as_heated().is_some()) {
                            (true, _) => element.row[2].clone(),
                            // Of a dashpot the rate by another clock.
                            (false, true) if order > 0.0 => return None,
                            _ => block(if order > 0.0 { &element.rate } else { &element.stroke }, ROW),
                        }
                    }
                    ElementQuantity::Told(i) => {
                        let place = self.system.elements[e].law.places_of_told()[i];
                        block(&element.told, place)
                    }
                    ElementQuantity::InputValue(i) => {
                        let [values, _] = &element.inputs;
                        let inputs = values.len() / ((ROW + 1) * count);
                        if inputs == 0 { vec![0.0; count] } else { block(values, ROW * inputs + i) }
                    }
                    ElementQuantity::Dissipated => return self.work(e, 0),
                    ElementQuantity::Input => return self.work(e, 1),
                    ElementQuantity::Leaf(leaf, quantity) => {
                        let place = LeafQuantity::ALL.iter().position(|own| *own == quantity)?;
                        block(&element.leaves, LeafQuantity::ALL.len() * leaf + place)
                    }
                }
            }
            Quantity::Gripper(axis) => {
                let jacobian = point_jacobian(model, &node.kinematics, self.system.gripper.as_ref()?);
                let line = &jacobian[axis.index() * self.nv()..][..self.nv()];
                each(&|p| along(line, &node.q, p))
            }
            Quantity::Energy(of) => match of {
                EnergyQuantity::Kinetic | EnergyQuantity::Potential => {
                    let [kinetic, potential] = self.mechanical(ROW);
                    if of == EnergyQuantity::Kinetic { kinetic } else { potential }
                }
                // Where none has done any, none does under other values.
                EnergyQuantity::Actuators if snapshot.actuators == 0.0 => vec![0.0; count],
                EnergyQuantity::Actuators => return self.work_of_actuators(),
                EnergyQuantity::Joints => return self.lost_in_joints(),
                EnergyQuantity::Residual => return None,
            },
            Quantity::GripperError => {
                // (H − H_d)·(δH − δH_d)/|H − H_d|. Along a given motion nothing moves.
                let Some(control) = &self.control else { return Some(vec![0.0; count]) };
                let (wanted, moves) = control.gripper();
                let site = self.system.gripper.as_ref()?;
                let (jacobian, at) = (point_jacobian(model, &node.kinematics, site), node.kinematics.position(site).0);
                let off: [f64; 3] = std::array::from_fn(|axis| at[axis] - wanted[axis]);
                let distance = off.iter().map(|off| off * off).sum::<f64>().sqrt();
                let moved = |axis: usize, p: usize| {
                    along(&jacobian[axis * self.nv()..][..self.nv()], &node.q, p) - moves[axis][p]
                };
                each(&|p| {
                    let moved: [f64; 3] = std::array::from_fn(|axis| moved(axis, p));
                    let stays = moved == [0.0; 3];
                    let sum: f64 = off.iter().zip(moved).map(|(off, moved)| off * moved).sum();
                    if stays { 0.0 } else { sum / distance }
                })
            }
            Quantity::Derivative(_) => return None,
        })
    }

    /// What changes of the force of the actuator of velocity `k`.
    fn driven(&self, k: usize, p: usize, t: f64) -> f64 {
        if let Some(held) = self.saltation.held.drive(k) {
            return held[p];
        }
        let seeds = self.by.parameters[p].seeds.iter();
        seeds
            .map(|seed| match seed {
                Seed::Drive { velocity, by } if *velocity == k => by.value(t),
                _ => 0.0,
            })
            .sum()
    }
}
