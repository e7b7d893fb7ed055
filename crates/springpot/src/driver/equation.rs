//! The equations of motion at one time, term by term.

use super::report::Report;
use super::run::run;
use crate::dynamics::{Kinematics, christoffel, coriolis, crba, gravity};
use crate::equations::State;
use crate::equations::resistance::{add_resistance, holding_forces};
use crate::observe::{ElementQuantity, Quantity, Table};
use crate::system::error::RunError;
use crate::system::row_times::RowTimes;
use crate::system::settings::{Settings, Stop};
use crate::system::{Motion, System};
use std::sync::atomic::Ordering;

/// Most velocities for which Christoffel symbols are kept.
const MOST_WITH_CHRISTOFFEL: usize = 256;

/// a_ac q̈^a + Γ_ab,c q̇^a q̇^b = Q_c at one time of a motion, Q from gravity, elements, joints and actuators.
///
/// Vectors have nv entries, N·m or N; matrices are row-major. What a singular Riemann–Liouville start leaves unknown at t = 0 is
/// NaN.
#[derive(Debug, Clone, PartialEq)]
pub struct Equation {
    /// Time, s.
    pub t: f64,
    /// q, q̇ and q̈.
    pub state: State,
    /// a_ab, nv × nv.
    pub mass: Vec<f64>,
    /// Γ_ab,c at (a·nv + b)·nv + c; `None` where a joint has several degrees of freedom, or nv is above 256.
    pub christoffel: Option<Vec<f64>>,
    /// Coriolis matrix C, nv × nv.
    pub coriolis: Vec<f64>,
    /// a_ac q̈^a.
    pub inertia: Vec<f64>,
    /// Γ_ab,c q̇^a q̇^b; C q̇ where there are no Christoffel symbols.
    pub velocity: Vec<f64>,
    /// Q of gravity.
    pub gravity: Vec<f64>,
    /// The elements, in their order.
    pub elements: Vec<ElementTerm>,
    /// Q of the joints' damping and friction; of a joint at rest that friction may hold, what closes the equation.
    pub joints: Vec<f64>,
    /// Q of the actuators.
    pub tau: Vec<f64>,
}

/// One element in [`Equation`].
#[derive(Debug, Clone, PartialEq)]
pub struct ElementTerm {
    /// Its name.
    pub name: String,
    /// y: the length of a line, m, or the coordinate of a joint, m or rad. On an angle m reads rad and N reads N·m in what
    /// follows.
    pub length: f64,
    /// x = y − y0, m.
    pub stroke: f64,
    /// x', m/s.
    pub rate: f64,
    /// D^alpha x, m/s^alpha; NaN at a singular start, and of a law that has none to tell.
    pub derivative: f64,
    /// F, N, positive in tension.
    pub force: f64,
    /// Q_b = −F ∂y/∂q_b.
    pub q_force: Vec<f64>,
    /// Values of its inputs in the order of its law, SI.
    pub inputs: Vec<f64>,
}

/// Why there is no [`Equation`] at a time.
#[derive(Debug, thiserror::Error)]
pub enum EquationError {
    /// The motion does not last that long.
    #[error("t = {t} s is outside the motion, which lasts from 0 to {end} s")]
    Outside {
        /// Time, s.
        t: f64,
        /// End of the motion, s.
        end: f64,
    },
    /// A named scheme knows its element at the rows alone.
    #[error(
        "element \"{element}\" has a named scheme, which is known at the rows alone: t = {t} s is none, t = {nearest} s is"
    )]
    NotARow {
        /// Element.
        element: String,
        /// Time, s.
        t: f64,
        /// Time of the nearest row, s.
        nearest: f64,
    },
    /// The run does not come as far.
    #[error(transparent)]
    Run(#[from] RunError),
}

impl System {
    /// The equations of motion at time `t`, the forces with the whole memory of a run until then: the numbers are those of the row
    /// that a run with these `settings` writes at that time; of forward dynamics, at the times of its rows, and elsewhere
    /// within the tolerance.
    ///
    /// # Errors
    /// [`EquationError`].
    pub fn equation(&self, settings: &Settings, t: f64) -> Result<Equation, EquationError> {
        let table = self.row(settings, t)?;
        let (nq, n) = (self.model.nq(), self.model.nv());
        let at = |quantity| table.value(0, quantity).expect("rows are complete");
        let all = |quantity: fn(usize) -> Quantity, count: usize| (0..count).map(quantity).map(at).collect();
        let t = at(Quantity::Time);
        let state = State {
            q: all(Quantity::Coordinate, nq),
            v: all(Quantity::Velocity, n),
            a: all(Quantity::Acceleration, n),
        };
        let tau = all(Quantity::Torque, n);
        let elements = self.elements.iter().enumerate().map(|(e, element)| {
            let of = |quantity| at(Quantity::Element(e, quantity));
            ElementTerm {
                name: element.name.clone(),
                length: of(ElementQuantity::Length),
                stroke: of(ElementQuantity::Stroke),
                rate: of(ElementQuantity::Rate),
                // Laws with several springpots, and those that are not linear, have none to tell.
                derivative: table.value(0, Quantity::Element(e, ElementQuantity::Derivative)).unwrap_or(f64::NAN),
                force: of(ElementQuantity::Force),
                q_force: (0..n).map(ElementQuantity::GeneralizedForce).map(of).collect(),
                inputs: (0..element.entry.inputs.len()).map(ElementQuantity::InputValue).map(of).collect(),
            }
        });
        let elements = elements.collect();

        let kinematics = Kinematics::at_velocity(&self.model, &state.q, &state.v);
        let mass = crba(&self.model, &kinematics);
        let coriolis = coriolis(&self.model, &kinematics);
        let christoffel =
            (self.model.is_one_degree() && n <= MOST_WITH_CHRISTOFFEL).then(|| christoffel(&self.model, &kinematics));
        let velocity = christoffel.as_ref().map_or_else(|| times(&coriolis, &state.v), |gamma| twice(gamma, &state.v));
        let mut losses = vec![0.0; n];
        add_resistance(self, &state.v, &mut losses);
        let mut equation = Equation {
            t,
            inertia: times(&mass, &state.a),
            velocity,
            gravity: gravity(&self.model, &kinematics).into_iter().map(|g| 0.0 - g).collect(),
            joints: losses.into_iter().map(|loss| 0.0 - loss).collect(),
            state,
            mass,
            christoffel,
            coriolis,
            elements,
            tau,
        };
        self.hold(&mut equation);
        Ok(equation)
    }

    /// What holds a joint at rest by friction follows from all else.
    fn hold(&self, equation: &mut Equation) {
        let Motion::Forward(forward) = &self.motion else { return };
        let limits = holding_forces(&self.model);
        let at_rest = |k: &usize| limits[*k] > 0.0 && equation.state.v[*k] == 0.0;
        let held: Vec<usize> = forward.free_velocities(&self.model).into_iter().filter(at_rest).collect();
        if held.is_empty() {
            return;
        }
        for &k in &held {
            equation.joints[k] = 0.0;
        }
        let missing = equation.residual();
        for &k in &held {
            equation.joints[k] = missing[k];
        }
    }

    /// The row of a run at time `t`, alone in its table.
    fn row(&self, settings: &Settings, t: f64) -> Result<Table, EquationError> {
        if !(0.0..=settings.end).contains(&t) {
            return Err(EquationError::Outside { t, end: settings.end });
        }
        let nearest_row = nearest(&settings.rows, t);
        // Where steps may end on rows, those of the run are kept.
        let of_the_run = matches!(self.motion, Motion::Forward(_)) && nearest_row == t;
        let (rows, t) = match self.elements.iter().find(|element| element.scheme.is_some()) {
            None if of_the_run => (settings.rows.clone(), t),
            None => (RowTimes::Times([t].into()), t),
            Some(element) => {
                let nearest = nearest_row;
                if (nearest - t).abs() > 1e-12 * settings.end {
                    return Err(EquationError::NotARow { element: element.name.clone(), t, nearest });
                }
                (settings.rows.clone(), nearest)
            }
        };
        let stop = Stop::new(false);
        let observables = self.observables();
        let time = observables.position(Quantity::Time).expect("every row has its time");
        let mut table = Table::new(&observables);
        let mut keep = |row: &[f64]| -> std::io::Result<()> {
            if table.is_empty() && row[time] == t {
                table.push(row);
                stop.store(true, Ordering::Relaxed);
            }
            Ok(())
        };
        let (Report { t_reached, .. }, outcome) = run(self, &Settings { rows, ..settings.clone() }, &mut keep, &stop);
        match outcome {
            _ if !table.is_empty() => Ok(table),
            Err(error) => Err(error.into()),
            // An event has stopped it.
            Ok(()) => Err(EquationError::Outside { t, end: t_reached.unwrap_or(0.0) }),
        }
    }
}

impl Equation {
    /// Q of all elements together.
    pub fn sum_of_elements(&self) -> Vec<f64> {
        let sum = |c: usize| self.elements.iter().map(|element| element.q_force[c]).sum();
        (0..self.tau.len()).map(sum).collect()
    }

    /// What is left of the equation: a_ac q̈^a + Γ_ab,c q̇^a q̇^b less all Q. Rounding alone, where nothing is wrong; NaN where a term
    /// is.
    pub fn residual(&self) -> Vec<f64> {
        let terms = |(c, elements): (usize, f64)| {
            self.inertia[c] + self.velocity[c] - (self.gravity[c] + elements + self.joints[c] + self.tau[c])
        };
        self.sum_of_elements().into_iter().enumerate().map(terms).collect()
    }

    /// The largest of all terms, what [`Equation::residual`] is to be measured by; 0 where all are.
    pub fn largest_term(&self) -> f64 {
        let own = [&self.inertia, &self.velocity, &self.gravity, &self.joints, &self.tau];
        let all = own.into_iter().chain(self.elements.iter().map(|element| &element.q_force)).flatten();
        all.fold(0.0, |largest, term| term.abs().max(largest))
    }
}

/// The row time nearest to `t`.
fn nearest(rows: &RowTimes, t: f64) -> f64 {
    let times = (0..rows.count()).map(|k| rows.at(k));
    times.min_by(|a, b| (a - t).abs().total_cmp(&(b - t).abs())).unwrap_or(f64::NAN)
}

/// A matrix times a vector.
fn times(matrix: &[f64], vector: &[f64]) -> Vec<f64> {
    matrix.chunks(vector.len().max(1)).map(|row| row.iter().zip(vector).map(|(m, v)| m * v).sum()).collect()
}

/// Γ_ab,c v^a v^b.
fn twice(gamma: &[f64], v: &[f64]) -> Vec<f64> {
    let n = v.len();
    let mut sum = vec![0.0; n];
    for (ab, row) in gamma.chunks(n.max(1)).enumerate() {
        let factor = v[ab / n] * v[ab % n];
        for (sum, entry) in sum.iter_mut().zip(row) {
            *sum += entry * factor;
        }
    }
    sum
}
