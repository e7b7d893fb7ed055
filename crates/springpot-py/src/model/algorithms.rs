//! The algorithms of `springpot::dynamics`, on one state or many.

use super::PyModel;
use super::batch::Symbol::{Q, V};
use super::batch::{each, one_by_one, one_result};
use crate::error::model_error;
use pyo3::prelude::*;
use springpot::dynamics::{
    BODY_NUMBERS, RneaSecondDerivatives, aba_derivatives_into, aba_into, batch, centroidal_matrix_into,
    centroidal_matrix_rate_into, christoffel_into, com, com_jacobian_into, coriolis_into, crba_into, gravity_into,
    joint_torque_regressor_into, kinetic_energy, mass_derivative_into, mass_inverse_into, nonlinear_effects_into,
    potential_energy, rnea_derivatives_into, rnea_into, rnea_second_derivatives,
};

type Any<'py> = Bound<'py, PyAny>;

#[pymethods]
impl PyModel {
    /// Inverse dynamics, tau = M(q) a + C(q, v) v + g(q): shape ``(nv,)``, N·m or N.
    ///
    /// >>> import springpot as sp
    /// >>> arm = sp.Model.from_scenario({"robot": {"body": [{"name": "arm", "mass": 2, "com": [0.5, 0, 0],
    /// ...     "joint": {"name": "q1", "kind": "revolute", "axis": [0, 1, 0]}}]}})
    /// >>> arm.rnea([0.0], [0.0], [0.0])
    /// array([-9.81])
    /// >>> arm.rnea([[0.0], [1.5707963267948966]], [0.0], [1.0]).round(6)
    /// array([[-9.31],
    ///        [ 0.5 ]])
    #[pyo3(signature = (q, v, a, out=None))]
    fn rnea<'py>(&self, q: &Any<'py>, v: &Any<'py>, a: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        let inputs = [(q, Q("q")), (v, V("v")), (a, V("a"))];
        one_result(
            &self.core,
            inputs,
            &[self.nv()],
            out,
            |m, w, [q, v, a], [tau]| batch::rnea_into(m, w, q, v, a, tau),
            |model, scratch, [q, v, a], tau| {
                rnea_into(model, q, v, a, &[], &mut scratch.workspace, tau);
            },
        )
    }

    /// C(q, v) v + g(q), what the actuators hold without acceleration: shape ``(nv,)``, N·m or N.
    #[pyo3(signature = (q, v, out=None))]
    fn nonlinear_effects<'py>(&self, q: &Any<'py>, v: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        let inputs = [(q, Q("q")), (v, V("v"))];
        one_result(
            &self.core,
            inputs,
            &[self.nv()],
            out,
            |m, w, [q, v], [tau]| batch::nonlinear_effects_into(m, w, q, v, tau),
            |model, scratch, [q, v], tau| {
                nonlinear_effects_into(model, q, v, &[], &mut scratch.workspace, tau);
            },
        )
    }

    /// Forward dynamics, a = M⁻¹(tau − C v − g): shape ``(nv,)``, rad/s² or m/s².
    #[pyo3(signature = (q, v, tau, out=None))]
    fn aba<'py>(&self, q: &Any<'py>, v: &Any<'py>, tau: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        let inputs = [(q, Q("q")), (v, V("v")), (tau, V("tau"))];
        one_result(
            &self.core,
            inputs,
            &[self.nv()],
            out,
            |m, w, [q, v, tau], [a]| batch::aba_into(m, w, q, v, tau, a),
            |model, scratch, [q, v, tau], a| {
                scratch.kinematics.update_velocity(model, q, v);
                aba_into(model, &scratch.kinematics, tau, &[], &mut scratch.workspace, a);
            },
        )
    }

    /// The mass matrix M(q), the basic metric tensor: shape ``(nv, nv)``.
    #[pyo3(signature = (q, out=None))]
    fn crba<'py>(&self, q: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        let n = self.nv();
        one_result(
            &self.core,
            [(q, Q("q"))],
            &[n, n],
            out,
            |m, w, [q], [mass]| batch::crba_into(m, w, q, mass),
            |model, scratch, [q], mass| {
                scratch.kinematics.update_position(model, q);
                crba_into(model, &scratch.kinematics, &mut scratch.workspace, mass);
            },
        )
    }

    /// M(q)⁻¹: shape ``(nv, nv)``.
    #[pyo3(signature = (q, out=None))]
    fn mass_inverse<'py>(&self, q: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        let n = self.nv();
        one_result(
            &self.core,
            [(q, Q("q"))],
            &[n, n],
            out,
            |m, w, [q], [inverse]| batch::mass_inverse_into(m, w, q, inverse),
            |model, scratch, [q], inverse| {
                scratch.kinematics.update_position(model, q);
                mass_inverse_into(model, &scratch.kinematics, &mut scratch.workspace, &mut scratch.matrix, inverse);
            },
        )
    }

    /// The Coriolis matrix C(q, v), with C v the Coriolis and centrifugal forces: shape ``(nv, nv)``.
    ///
    /// For joints of one degree it is Γ_ab,c v^a; for floating bases the choice that Pinocchio makes too.
    #[pyo3(signature = (q, v, out=None))]
    fn coriolis<'py>(&self, q: &Any<'py>, v: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        let (n, inputs) = (self.nv(), [(q, Q("q")), (v, V("v"))]);
        one_result(
            &self.core,
            inputs,
            &[n, n],
            out,
            |m, w, [q, v], [matrix]| batch::coriolis_into(m, w, q, v, matrix),
            |model, scratch, [q, v], matrix| {
                scratch.kinematics.update_velocity(model, q, v);
                coriolis_into(model, &scratch.kinematics, &mut scratch.workspace, matrix);
            },
        )
    }

    /// The gravity vector g(q) = ∂V/∂q, the forces that hold the robot: shape ``(nv,)``, N·m or N.
    #[pyo3(signature = (q, out=None))]
    fn gravity<'py>(&self, q: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        one_result(
            &self.core,
            [(q, Q("q"))],
            &[self.nv()],
            out,
            |m, w, [q], [forces]| batch::gravity_into(m, w, q, forces),
            |model, scratch, [q], forces| {
                scratch.kinematics.update_position(model, q);
                gravity_into(model, &scratch.kinematics, &mut scratch.workspace, forces);
            },
        )
    }

    /// Christoffel symbols of the first kind Γ_ab,c, the force index c last: shape ``(nv, nv, nv)``.
    ///
    /// Raises:
    ///     ModelError: where a joint has several degrees of freedom.
    #[pyo3(signature = (q, out=None))]
    fn christoffel<'py>(&self, q: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        if !self.core.model.is_one_degree() {
            let why = "Christoffel symbols exist where every joint has one degree of freedom; take coriolis(q, v)";
            return Err(model_error(q.py(), why));
        }
        let n = self.nv();
        one_result(
            &self.core,
            [(q, Q("q"))],
            &[n, n, n],
            out,
            |m, w, [q], [gamma]| batch::christoffel_into(m, w, q, gamma),
            |model, scratch, [q], gamma| {
                scratch.kinematics.update_position(model, q);
                christoffel_into(model, &scratch.kinematics, &mut scratch.workspace, gamma);
            },
        )
    }

    /// ∂tau/∂q and ∂tau/∂v of :meth:`rnea`, each of shape ``(nv, nv)``: row b belongs to tau_b. ∂tau/∂a is :meth:`crba`.
    #[pyo3(signature = (q, v, a, out=None))]
    fn rnea_derivatives<'py>(
        &self,
        q: &Any<'py>,
        v: &Any<'py>,
        a: &Any<'py>,
        out: Option<&Any<'py>>,
    ) -> PyResult<[Any<'py>; 2]> {
        let (n, inputs) = (self.nv(), [(q, Q("q")), (v, V("v")), (a, V("a"))]);
        each(
            &self.core,
            inputs,
            [&[n, n]; 2],
            out,
            |m, w, [q, v, a], [by_q, by_v]| batch::rnea_derivatives_into(m, w, q, v, a, by_q, by_v),
            |model, scratch, [q, v, a], [by_q, by_v]| {
                scratch.kinematics.update_velocity(model, q, v);
                let slopes = &mut scratch.inverse_slopes;
                rnea_derivatives_into(model, &scratch.kinematics, a, &[], &mut scratch.workspace, slopes);
                by_q.copy_from_slice(&slopes.d_q);
                by_v.copy_from_slice(&slopes.d_v);
            },
        )
    }

    /// ∂a/∂q and ∂a/∂v of :meth:`aba`, each of shape ``(nv, nv)``: row b belongs to a_b. ∂a/∂tau is :meth:`mass_inverse`.
    #[pyo3(signature = (q, v, tau, out=None))]
    fn aba_derivatives<'py>(
        &self,
        q: &Any<'py>,
        v: &Any<'py>,
        tau: &Any<'py>,
        out: Option<&Any<'py>>,
    ) -> PyResult<[Any<'py>; 2]> {
        let (n, inputs) = (self.nv(), [(q, Q("q")), (v, V("v")), (tau, V("tau"))]);
        each(
            &self.core,
            inputs,
            [&[n, n]; 2],
            out,
            |m, w, [q, v, tau], [by_q, by_v]| batch::aba_derivatives_into(m, w, q, v, tau, by_q, by_v),
            |model, scratch, [q, v, tau], [by_q, by_v]| {
                scratch.kinematics.update_velocity(model, q, v);
                let slopes = &mut scratch.forward_slopes;
                aba_derivatives_into(model, &scratch.kinematics, tau, &[], &mut scratch.workspace, slopes);
                by_q.copy_from_slice(&slopes.d_q);
                by_v.copy_from_slice(&slopes.d_v);
            },
        )
    }

    /// The centre of mass of all that moves: shape ``(3,)``, m.
    #[pyo3(signature = (q, out=None))]
    fn com<'py>(&self, q: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        one_result(
            &self.core,
            [(q, Q("q"))],
            &[3],
            out,
            |m, w, [q], [centre]| batch::com_into(m, w, q, centre),
            |model, scratch, [q], centre| {
                scratch.kinematics.update_position(model, q);
                centre.copy_from_slice(&com(model, &scratch.kinematics).0);
            },
        )
    }

    /// The Jacobian of the centre of mass: shape ``(3, nv)``.
    #[pyo3(signature = (q, out=None))]
    fn com_jacobian<'py>(&self, q: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        let n = self.nv();
        one_result(
            &self.core,
            [(q, Q("q"))],
            &[3, n],
            out,
            |m, w, [q], [jacobian]| batch::com_jacobian_into(m, w, q, jacobian),
            |model, scratch, [q], jacobian| {
                scratch.kinematics.update_position(model, q);
                com_jacobian_into(model, &scratch.kinematics, &mut scratch.workspace, jacobian);
            },
        )
    }

    /// The centroidal momentum matrix A(q): shape ``(6, nv)``; A v is the momentum of the robot, linear above angular about the centre of mass, world axes.
    #[pyo3(signature = (q, out=None))]
    fn centroidal_matrix<'py>(&self, q: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        let n = self.nv();
        one_result(
            &self.core,
            [(q, Q("q"))],
            &[6, n],
            out,
            |m, w, [q], [matrix]| batch::centroidal_matrix_into(m, w, q, matrix),
            |model, scratch, [q], matrix| {
                scratch.kinematics.update_position(model, q);
                centroidal_matrix_into(model, &scratch.kinematics, &mut scratch.workspace, matrix);
            },
        )
    }

    /// Its time derivative: shape ``(6, nv)``; A a + Ȧ v are the forces from outside, and their moment about the centre of mass.
    #[pyo3(signature = (q, v, out=None))]
    fn centroidal_matrix_rate<'py>(&self, q: &Any<'py>, v: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        let (n, inputs) = (self.nv(), [(q, Q("q")), (v, V("v"))]);
        one_result(
            &self.core,
            inputs,
            &[6, n],
            out,
            |m, w, [q, v], [rate]| batch::centroidal_matrix_rate_into(m, w, q, v, rate),
            |model, scratch, [q, v], rate| {
                scratch.kinematics.update_velocity(model, q, v);
                centroidal_matrix_rate_into(model, &scratch.kinematics, &mut scratch.workspace, rate);
            },
        )
    }

    /// The joint torque regressor Y(q, v, a): shape ``(nv, 10 bodies)``, so that ``Y @ body_numbers`` is :meth:`rnea` without what armatures ask for.
    ///
    /// Bodies stand in the order of :attr:`body_names`, each with its mass, first moment (x, y, z) and inertia about the origin of its frame (xx, xy, yy,
    /// xz, yz, zz). What elements ask for is linear too: :func:`springpot.element_regressor`.
    ///
    /// >>> import springpot as sp
    /// >>> arm = sp.Model.from_scenario({"robot": {"body": [{"name": "arm", "mass": 2, "com": [0.5, 0, 0],
    /// ...     "joint": {"name": "q1", "kind": "revolute", "axis": [0, 1, 0]}}]}})
    /// >>> (arm.joint_torque_regressor([0.0], [0.0], [0.0]) @ arm.body_numbers).round(9)
    /// array([-9.81])
    #[pyo3(signature = (q, v, a, out=None))]
    fn joint_torque_regressor<'py>(
        &self,
        q: &Any<'py>,
        v: &Any<'py>,
        a: &Any<'py>,
        out: Option<&Any<'py>>,
    ) -> PyResult<Any<'py>> {
        let inputs = [(q, Q("q")), (v, V("v")), (a, V("a"))];
        one_result(
            &self.core,
            inputs,
            &[self.nv(), BODY_NUMBERS * self.core.model.body_names().len()],
            out,
            |m, w, [q, v, a], [regressor]| batch::joint_torque_regressor_into(m, w, q, v, a, regressor),
            |model, scratch, [q, v, a], regressor| {
                scratch.kinematics.update_velocity(model, q, v);
                joint_torque_regressor_into(model, &scratch.kinematics, a, &mut scratch.workspace, regressor);
            },
        )
    }

    /// ∂M/∂q of :meth:`crba`: shape ``(nv, nv, nv)``, the coordinate last; of joints of several degrees along their velocities.
    #[pyo3(signature = (q, out=None))]
    fn mass_derivative<'py>(&self, q: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        let n = self.nv();
        one_result(
            &self.core,
            [(q, Q("q"))],
            &[n, n, n],
            out,
            |m, w, [q], [derivative]| batch::mass_derivative_into(m, w, q, derivative),
            |model, scratch, [q], derivative| {
                scratch.kinematics.update_position(model, q);
                mass_derivative_into(model, &scratch.kinematics, &mut scratch.workspace, derivative);
            },
        )
    }

    /// Second derivatives of :meth:`rnea`: of ∂tau/∂q by q, of ∂tau/∂v by q, of ∂tau/∂v by v, of ∂tau/∂a by q, each of shape ``(nv, nv, nv)``, that by
    /// which is differentiated last at the end; by q along the velocities.
    #[pyo3(signature = (q, v, a, out=None))]
    fn rnea_second_derivatives<'py>(
        &self,
        q: &Any<'py>,
        v: &Any<'py>,
        a: &Any<'py>,
        out: Option<&Any<'py>>,
    ) -> PyResult<[Any<'py>; 4]> {
        let (n, inputs) = (self.nv(), [(q, Q("q")), (v, V("v")), (a, V("a"))]);
        each(
            &self.core,
            inputs,
            [&[n, n, n]; 4],
            out,
            batch::rnea_second_derivatives_into,
            |model, _, [q, v, a], cubes| {
                let RneaSecondDerivatives { d_q_q, d_v_q, d_v_v, d_a_q } = rnea_second_derivatives(model, q, v, a);
                for (cube, found) in cubes.into_iter().zip([d_q_q, d_v_q, d_v_v, d_a_q]) {
                    cube.copy_from_slice(&found);
                }
            },
        )
    }

    /// Kinetic energy, J: a float, or shape ``(N,)``.
    #[pyo3(signature = (q, v, out=None))]
    fn kinetic_energy<'py>(&self, q: &Any<'py>, v: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        let inputs = [(q, Q("q")), (v, V("v"))];
        one_result(
            &self.core,
            inputs,
            &[],
            out,
            |m, w, [q, v], [energy]| batch::kinetic_energy_into(m, w, q, v, energy),
            |model, scratch, [q, v], energy| {
                scratch.kinematics.update_velocity(model, q, v);
                energy[0] = kinetic_energy(model, &scratch.kinematics);
            },
        )
    }

    /// Potential energy in the field of gravity, J, 0 at the world's origin: a float, or shape ``(N,)``.
    #[pyo3(signature = (q, out=None))]
    fn potential_energy<'py>(&self, q: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        one_result(
            &self.core,
            [(q, Q("q"))],
            &[],
            out,
            |m, w, [q], [energy]| batch::potential_energy_into(m, w, q, energy),
            |model, scratch, [q], energy| {
                scratch.kinematics.update_position(model, q);
                energy[0] = potential_energy(model, &scratch.kinematics);
            },
        )
    }

    /// q ⊕ v: the configuration after one second at the constant velocities v: shape ``(nq,)``.
    #[pyo3(signature = (q, v, out=None))]
    fn integrate<'py>(&self, q: &Any<'py>, v: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        let inputs = [(q, Q("q")), (v, V("v"))];
        one_by_one(&self.core, inputs, &[self.nq()], out, |model, _, [q, v], moved| {
            model.integrate_into(q, v, moved);
        })
    }

    /// to ⊖ from\_: the velocities that lead from one configuration to the other in one second, the shorter way round: shape ``(nv,)``.
    #[pyo3(signature = (from_, to, out=None))]
    fn difference<'py>(&self, from_: &Any<'py>, to: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        let inputs = [(from_, Q("from_")), (to, Q("to"))];
        one_by_one(&self.core, inputs, &[self.nv()], out, |model, _, [from, to], v| {
            model.difference_into(from, to, v);
        })
    }

    /// q with quaternions of length 1 (qw ≥ 0) and angles of continuous joints in (−π, π]: shape ``(nq,)``.
    #[pyo3(signature = (q, out=None))]
    fn normalise<'py>(&self, q: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        one_by_one(&self.core, [(q, Q("q"))], &[self.nq()], out, |model, _, [q], normal| {
            normal.copy_from_slice(q);
            model.normalise(normal);
        })
    }
}
