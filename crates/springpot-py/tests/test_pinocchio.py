"""Elements on Pinocchio models: forces against springpot's own, tangents against differences."""

from __future__ import annotations

import pathlib
from typing import Any

import arms
import numpy as np
import pytest

import springpot as sp

pin = pytest.importorskip("pinocchio")

import springpot.pinocchio  # noqa: E402


def body(model: Any, parent: int, joint: Any, name: str, at: tuple[float, float, float]) -> int:
    placement = pin.SE3(np.eye(3), np.array(at))
    number = model.addJoint(parent, joint, placement, name)
    model.addFrame(pin.Frame(name, number, placement.Identity(), pin.FrameType.BODY))
    return int(number)


def arm() -> Any:
    model = pin.Model()
    upper = body(model, 0, pin.JointModelRY(), "upper", (0.0, 0.0, 0.0))
    body(model, upper, pin.JointModelRevoluteUnaligned(np.array([0.6, 0.8, 0.0])), "lower", (0.3, 0.0, 0.0))
    return model


def zoo() -> Any:
    """Joints of several degrees of freedom, and a branch."""
    model = pin.Model()
    base = body(model, 0, pin.JointModelFreeFlyer(), "base", (0.0, 0.0, 0.0))
    ball = body(model, base, pin.JointModelSpherical(), "ball", (0.3, 0.1, 0.0))
    body(model, ball, pin.JointModelPX(), "slide", (0.0, 0.2, 0.1))
    other = body(model, base, pin.JointModelPlanar(), "plate", (-0.2, 0.0, 0.3))
    body(model, other, pin.JointModelRZ(), "wheel", (0.1, 0.1, 0.1))
    return model


ENDS = {"from": {"frame": "universe", "point": [0.05, 0.1, -0.35]}, "to": {"frame": "lower", "point": [0.12, 0.03, 0.02]}}


@pytest.mark.parametrize("alpha", [0.2, 0.5, 0.9])
def test_forces_are_springpots_own(alpha: float) -> None:
    h, steps = 0.004, 125
    run = sp.run(arms.prescribed(alpha, h * steps))
    wanted = np.stack([run["strut.Q.q1"], run["strut.Q.q2"]], axis=1)
    elements = springpot.pinocchio.Elements(
        arm(), [arms.strut(alpha, **ENDS)], nodes="radau", motion="given", tolerance=1e-12, step=h / 10
    )

    def motion(t: Any) -> tuple[Any, Any]:
        q = np.stack([0.4 + 0.5 * np.sin(5 * t), -0.9 + 0.3 * np.sin(8 * t)], axis=-1)
        return q, np.stack([2.5 * np.cos(5 * t), 2.4 * np.cos(8 * t)], axis=-1)

    elements.begin(*motion(0.0))
    found = []
    for n in range(steps):
        # Inside, steps are shorter than rows: their error is to stay below what is compared.
        for part in range(8):
            t = h * (n + part / 8)
            forces, _, _ = elements.evaluate(t, h / 8, *motion(t + h / 8 * elements.bank.nodes))
            elements.commit()
        found.append(forces[-1])
    scale = np.abs(wanted).max()
    assert scale > 1.0
    np.testing.assert_allclose(np.array(found), wanted[1:], rtol=0.0, atol=1e-9 * scale)
    assert elements.forces[0] == pytest.approx(run["strut.force"][-1], rel=1e-9)
    assert elements.lengths[0] == pytest.approx(run["strut.length"][-1], rel=1e-12)


def springs() -> list[dict[str, Any]]:
    return [
        arms.strut(0.5, **{"from": "universe", "to": {"frame": "slide", "point": [0.1, 0.2, -0.1]}}),
        {"name": "tie", "from": {"frame": "slide", "point": [0.0, 0.1, 0.0]}, "to": {"frame": "wheel", "point": [0.2, 0.0, 0.1]}, "rest_length": "start",
         "law": "kelvin-voigt", "parameters": {"k": "90 N/m", "c": 7}},
        {"from": "ball", "to": {"frame": "plate", "point": [0.1, 0.0, 0.2]}, "rest_length": 0.1, "law": sp.law("fractional-zener", k_e=20, k_m=50, c=9, alpha=0.4)},
    ]  # fmt: skip


@pytest.mark.parametrize("nodes", ["end", "radau"])
def test_tangents_are_derivatives(nodes: str) -> None:
    model, h = zoo(), 0.01
    elements = springpot.pinocchio.Elements(model, springs(), nodes=nodes)
    rng = np.random.default_rng(7)
    s = len(elements.bank.nodes)
    start = pin.integrate(model, pin.neutral(model), rng.normal(size=model.nv))
    elements.begin(start, rng.normal(size=model.nv))
    q = np.array([pin.integrate(model, start, 0.05 * rng.normal(size=model.nv)) for _ in range(s)])
    v = rng.normal(size=(s, model.nv))

    def asked(q: Any, v: Any) -> Any:
        forces, by_q, by_v = elements.evaluate(0.0, h, q if s > 1 else q[0], v if s > 1 else v[0])
        shape = (s, s, model.nv, model.nv)
        return forces.reshape(s, model.nv), by_q.reshape(shape), by_v.reshape(shape)

    def forces(q: Any, v: Any) -> Any:
        return asked(q, v)[0]

    _, by_q, by_v = asked(q, v)
    eps = 1e-5
    for j in range(s):
        for k in range(model.nv):
            turn = np.zeros(model.nv)
            turn[k] = eps

            def moved(way: float) -> Any:
                there = q.copy()
                there[j] = pin.integrate(model, q[j], way * turn)
                return forces(there, v)

            # Central differences of two sizes, extrapolated: their own error is far below 1e-6.
            slope = (8 * (moved(1.0) - moved(-1.0)) - (moved(2.0) - moved(-2.0))) / (12 * eps)
            np.testing.assert_allclose(by_q[:, j, :, k], slope, rtol=0.0, atol=1e-6 * np.abs(by_q).max())
            faster, slower = v.copy(), v.copy()
            faster[j, k] += eps
            slower[j, k] -= eps
            slope = (forces(q, faster) - forces(q, slower)) / (2 * eps)
            np.testing.assert_allclose(by_v[:, j, :, k], slope, rtol=0.0, atol=1e-6 * np.abs(by_v).max())


def test_one_joint() -> None:
    """A pendulum on a spring of rest length 0: l² = a² + r² − 2 a r cos q, Q = −k a r sin q."""
    model = pin.Model()
    body(model, 0, pin.JointModelRY(), "pendulum", (0.0, 0.0, 0.0))
    spring = {"from": {"frame": "universe", "point": [0.0, 0.0, 0.5]}, "to": {"frame": "pendulum", "point": [0.0, 0.0, 0.3]}, "rest_length": 0.0}
    elements = springpot.pinocchio.Elements(model, [{**spring, "law": "spring", "parameters": {"k": 40.0}}])
    elements.begin([0.2])
    forces, by_q, by_v = elements.evaluate(0.0, 0.01, [0.7], [2.0])
    assert forces == pytest.approx([-6.0 * np.sin(0.7)]) and by_q[0] == pytest.approx([-6.0 * np.cos(0.7)]) and not by_v.any()


def test_geometric_stiffness_alone() -> None:
    """A constant force: all of ∂Q/∂q is −F ∂²l/∂q², symmetric for joints of one degree of freedom."""
    preload = {"from": "universe", "to": {"frame": "lower", "point": [0.1, 0.2, 0.0]}, "rest_length": 0.0, "network": "preload(f)", "parameters": {"f": 5.0}}
    elements = springpot.pinocchio.Elements(arm(), [preload])
    elements.begin([0.3, 0.2])
    _, by_q, by_v = elements.evaluate(0.0, 0.01, [0.3, 0.2], [1.0, -1.0])
    assert np.abs(by_q).max() > 0.1 and not by_v.any()
    np.testing.assert_allclose(by_q, by_q.T, atol=1e-14)


def test_state_and_inputs() -> None:
    damper = {"name": "damper", "law": "magnetorheological", "parameters": {"E_c": 30, "mu_0": 50, "mu": 10, "alpha": 0.4}, "rest_length": "start"}
    elements = springpot.pinocchio.Elements(arm(), [{**damper, **ENDS, "inputs": {"u": lambda t: 1.0 + t}}])

    def walk(n: int) -> Any:
        found = elements.evaluate(0.01 * n, 0.01, [0.4 + 0.01 * n, -0.9], [1.0, 0.0])[0]
        elements.commit()
        return found

    elements.begin([0.4, -0.9])
    [walk(n) for n in range(10)]
    kept = elements.state()
    later = [walk(n) for n in range(10, 15)]
    elements.set_state(kept)
    assert all(np.array_equal(walk(n), forces) for n, forces in zip(range(10, 15), later))
    elements.set_state(kept)
    elements.set_input("damper", "u", "9 V")
    assert not np.array_equal(walk(10), later[0])
    with pytest.raises(ValueError, match="other elements"):
        elements.set_state((np.zeros(2), kept[1]))


def test_bad_arguments() -> None:
    good = arms.strut(0.5, **ENDS)

    def made(**changes: Any) -> Any:
        return springpot.pinocchio.Elements(arm(), [{**good, **changes}])

    with pytest.raises(ValueError, match='"strut": there is no frame "lowr"; there are universe'):
        made(to="lowr")
    with pytest.raises(ValueError, match='no key "rest_lenght"; did you mean "rest_length"'):
        made(rest_lenght=3)
    with pytest.raises(ValueError, match='"point"'):
        made(to={"frame": "lower", "offset": [0, 0, 0]})
    with pytest.raises(ValueError, match="three finite numbers"):
        made(to={"frame": "lower", "point": [0, 0]})
    with pytest.raises(ValueError, match="rest_length is -1"):
        made(rest_length=-1)
    with pytest.raises(ValueError, match="rest_length"):
        made(rest_length="1 kg")
    with pytest.raises(ValueError, match='"rest_length" is missing'):
        springpot.pinocchio.Elements(arm(), [{"from": "upper", "to": "lower", "law": "spring", "parameters": {"k": 1}}])
    with pytest.raises(ValueError, match="no input"):
        made(inputs={"u": 1})
    with pytest.raises(ValueError, match='the input "T" is missing'):
        made(law="thermoviscoelastic", parameters={"E_c": 30, "E_kv": 20, "E_d": 50, "alpha": 0.5, "a_kv": 7e-4})
    with pytest.raises(TypeError, match="an element is a dict"):
        springpot.pinocchio.Elements(arm(), ["strut"])
    elements = made()
    with pytest.raises(ValueError, match="has not begun"):
        elements.evaluate(0, 1, [0, 0], [0, 0])
    with pytest.raises(ValueError, match=r"q has shape \(3,\); it must have shape \(2,\)"):
        elements.begin([0, 0, 0])
    elements.begin([0, 0])
    with pytest.raises(ValueError, match="finite"):
        elements.evaluate(0, 1, [0, np.nan], [0, 0])
    with pytest.raises(sp.RunError, match="has no direction"):
        made(**{"from": "lower", "to": "lower"}).begin([0, 0])
    turning = arm()
    body(turning, 1, pin.JointModelSphericalZYX(), "turning", (0.0, 0.0, 0.0))
    with pytest.raises(ValueError, match='joint "turning".*no tangents'):
        springpot.pinocchio.Elements(turning, [])


ROBOTS = pathlib.Path(__file__).parents[3] / "testdata" / "multibody"


@pytest.mark.parametrize("name", ["ur5", "anymal_b"])
def test_momenta_regressors_and_second_derivatives_are_pinocchios(name: str) -> None:
    path = ROBOTS / f"{name}.urdf"
    ours = sp.Model.from_urdf(path)
    theirs = pin.buildModelFromUrdf(str(path))
    data = theirs.createData()
    order = [ours.v_names.index(name) for name in list(theirs.names)[1:]]
    rng = np.random.default_rng(31)
    for _ in range(5):
        q, v, a = rng.uniform(-1.0, 1.0, (3, ours.nv))
        p, w, u = q[order], v[order], a[order]
        pin.dccrba(theirs, data, p, w)
        np.testing.assert_allclose(ours.centroidal_matrix(q)[:, order], data.Ag, atol=1e-12)
        np.testing.assert_allclose(ours.centroidal_matrix_rate(q, v)[:, order], data.dAg, atol=1e-11)
        theirs_y = pin.computeJointTorqueRegressor(theirs, data, p, w, u)
        theirs_pi = np.concatenate([inertia.toDynamicParameters() for inertia in list(theirs.inertias)[1:]])
        ours_tau = ours.joint_torque_regressor(q, v, a) @ ours.body_numbers
        np.testing.assert_allclose(ours_tau[order], theirs_y @ theirs_pi, atol=1e-10)
        if hasattr(pin, "ComputeRNEASecondOrderDerivatives"):
            by_q, by_v, by_qv, by_aq = pin.ComputeRNEASecondOrderDerivatives(theirs, data, p, w, u)
            found = [cube[np.ix_(order, order, order)] for cube in ours.rnea_second_derivatives(q, v, a)]
            np.testing.assert_allclose(found[0], by_q, atol=1e-9)
            np.testing.assert_allclose(found[2], by_v, atol=1e-9)
            np.testing.assert_allclose(found[1], np.swapaxes(by_qv, 1, 2), atol=1e-9)
            np.testing.assert_allclose(found[3], np.swapaxes(by_aq, 1, 2), atol=1e-9)
