"""Rigid-body algorithms against the reference values, one state or many."""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys
import threading
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, oracle

import springpot as sp

ROBOTS = ["double_pendulum", "ur5", "panda", "panda_mimic", "simple_humanoid", "simple_humanoid_ff", "anymal_b_ff", "solo12_ff"]


def robot(name: str) -> tuple[sp.Model, dict[str, Any]]:
    data = oracle("multibody", f"{name}.json")
    path = ROOT / "testdata" / "multibody" / data["urdf"]
    return sp.Model.from_urdf(path, floating_base=data["floating_base"], ignore_mimic=name == "panda"), data


def order(model: sp.Model, data: dict[str, Any]) -> tuple[list[int], list[int]]:
    """Where the reference has our coordinates and velocities: its joints may stand in another order."""
    joints = {joint["name"]: joint for joint in data["model"]["joints"]}
    own = [name for name in model.joint_names if f"{name}" in model.v_names or f"{name}.vx" in model.v_names]
    q = [joints[name]["idx_q"] + k for name in own for k in range(7 if joints[name]["type"] == "FF" else 1)]
    v = [joints[name]["idx_v"] + k for name in own for k in range(6 if joints[name]["type"] == "FF" else 1)]
    return q, v


@pytest.fixture(scope="module")
def ur5() -> sp.Model:
    return sp.Model.from_urdf(ROOT / "testdata" / "multibody" / "ur5.urdf")


def states(model: sp.Model, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(7)
    return model.random(1, count), rng.normal(size=(count, model.nv)), rng.normal(size=(count, model.nv))


def close(found: Any, wanted: Any) -> None:
    wanted = np.asarray(wanted, dtype=float)
    assert np.shape(found) == wanted.shape
    np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-10 * max(1.0, float(np.abs(wanted).max(initial=0.0))))


def few_ulps(many: Any, one: Any) -> None:
    """Rows are worked out side by side, with products and sums in one rounding."""
    np.testing.assert_allclose(many, one, rtol=0, atol=1e-12 * max(1.0, float(np.abs(one).max(initial=0.0))))


@pytest.mark.parametrize("name", ROBOTS)
def test_reference_values(name: str) -> None:
    model, data = robot(name)
    compared = 0
    in_q, in_v = order(model, data)
    frame = data["model"]["ee"]["frame"]
    square = np.ix_(in_v, in_v)
    for state in data["states"]:
        q = np.array(state["q"], dtype=float)[in_q]
        v, a, tau = (np.array(state[key], dtype=float)[in_v] for key in ("qd", "qdd", "tau"))
        rnea_slopes, aba_slopes = model.rnea_derivatives(q, v, a), model.aba_derivatives(q, v, tau)
        found = {
            "M": (model.crba(q), square),
            "C_matrix": (model.coriolis(q, v), square),
            "Cqd": (model.coriolis(q, v) @ v, in_v),
            "g": (model.gravity(q), in_v),
            "nle": (model.nonlinear_effects(q, v), in_v),
            "rnea": (model.rnea(q, v, a), in_v),
            "aba": (model.aba(q, v, tau), in_v),
            "drnea_dq": (rnea_slopes[0], square),
            "drnea_dqd": (rnea_slopes[1], square),
            "daba_dq": (aba_slopes[0], square),
            "daba_dqd": (aba_slopes[1], square),
            "daba_dtau": (model.mass_inverse(q), square),
            "ee_R": (model.frame_placement(frame, q)[0], ...),
            "ee_p": (model.frame_placement(frame, q)[1], ...),
            "ee_J_lwa": (model.frame_jacobian(frame, q), (slice(None), in_v)),
            "ee_Jdot_lwa": (model.frame_jacobian_rate(frame, q, v), (slice(None), in_v)),
            "com": (model.com(q), ...),
            "kinetic": (model.kinetic_energy(q, v), ...),
            "potential": (model.potential_energy(q), ...),
        }
        if state.get("christoffel1") is not None:
            # There the force index comes first.
            found["christoffel1"] = (np.moveaxis(model.christoffel(q), -1, 0), np.ix_(in_v, in_v, in_v))
        for key, (value, place) in found.items():
            if state.get(key) is not None:
                close(value, np.array(state[key], dtype=float)[place])
                compared += 1
    assert compared >= 17 * len(data["states"])


def test_identities(ur5: sp.Model) -> None:
    for q, v, a in zip(*states(ur5, 20)):
        mass = ur5.crba(q)
        close(ur5.mass_inverse(q) @ mass, np.eye(6))
        close(np.einsum("abc,a,b->c", ur5.christoffel(q), v, v), ur5.coriolis(q, v) @ v)
        close(ur5.aba(q, v, ur5.rnea(q, v, a)), a)
        assert abs(ur5.kinetic_energy(q, v) - 0.5 * v @ mass @ v) < 1e-9
        close(ur5.difference(q, ur5.integrate(q, 0.1 * v)), 0.1 * v)
        # Derivatives against central differences.
        by_q, by_v = ur5.rnea_derivatives(q, v, a)
        step = 1e-6
        for k in range(6):
            d = step * np.eye(6)[k]
            np.testing.assert_allclose(by_q[:, k], (ur5.rnea(q + d, v, a) - ur5.rnea(q - d, v, a)) / (2 * step), atol=1e-5)
            np.testing.assert_allclose(by_v[:, k], (ur5.rnea(q, v + d, a) - ur5.rnea(q, v - d, a)) / (2 * step), atol=1e-5)
            slope = (ur5.potential_energy(q + d) - ur5.potential_energy(q - d)) / (2 * step)
            assert abs(slope - ur5.gravity(q)[k]) < 1e-6
        inverse = ur5.mass_inverse(q)
        by_q, by_v = ur5.aba_derivatives(q, v, ur5.rnea(q, v, a))
        np.testing.assert_allclose(by_q, -inverse @ ur5.rnea_derivatives(q, v, a)[0], atol=1e-8)
        length, gradient = ur5.pair_length(("forearm_link", [0.1, 0, 0]), ("world", (0.0, 0.2, 0.3)), q)
        d = step * v
        there = [ur5.pair_length(("forearm_link", [0.1, 0, 0]), ("world", [0, 0.2, 0.3]), q + s * d)[0] for s in (1, -1)]
        assert length > 0 and abs((there[0] - there[1]) / (2 * step) - gradient @ v) < 1e-6
        rate = ur5.frame_jacobian_rate("wrist_3_link", q, v)
        there = [ur5.frame_jacobian("wrist_3_link", q + s * d) for s in (1, -1)]
        np.testing.assert_allclose(rate, (there[0] - there[1]) / (2 * step), atol=1e-6)


def test_bodies_and_materials_are_one_least_squares_problem() -> None:
    path = ROOT / "scenarios" / "thermoviscoelastic_order.toml"
    arm = sp.Model.from_scenario(path)
    t = np.linspace(0.0, 2.0, 801)
    q = 0.4 * np.sin(np.outer(t, [3.0, 4.1, 5.3])) + np.outer(t**2, [0.1, -0.2, 0.15])
    v = 0.4 * np.cos(np.outer(t, [3.0, 4.1, 5.3])) * [3.0, 4.1, 5.3] + np.outer(2 * t, [0.1, -0.2, 0.15])
    a = -0.4 * np.sin(np.outer(t, [3.0, 4.1, 5.3])) * np.array([3.0, 4.1, 5.3]) ** 2 + [0.2, -0.4, 0.3]
    last = arm.body_names[-1]
    columns = sp.element_regressor(arm, ("world", [0.3, 0.2, 0.5]), (last, [0.05, 0.0, 0.02]), t, q, 0.4, [0, 0.5, 1])
    assert columns.shape == (801, arm.nv, 3)
    bodies = arm.joint_torque_regressor(q, v, a)
    np.testing.assert_allclose(bodies @ arm.body_numbers + arm.armature * a, arm.rnea(q, v, a), atol=1e-10)
    wanted = np.array([300.0, 40.0, 6.0])
    torque = bodies @ arm.body_numbers + columns @ wanted
    both = np.concatenate([bodies, columns], axis=2).reshape(-1, bodies.shape[2] + 3)
    found = np.linalg.lstsq(both, torque.reshape(-1), rcond=1e-12)[0]
    np.testing.assert_allclose(found[-3:], wanted, rtol=1e-6)


CALLS = [
    ("rnea", "qva"), ("nonlinear_effects", "qv"), ("aba", "qva"), ("crba", "q"), ("mass_inverse", "q"), ("coriolis", "qv"),
    ("gravity", "q"), ("rnea_derivatives", "qva"), ("aba_derivatives", "qva"), ("com", "q"), ("com_jacobian", "q"),
    ("centroidal_matrix", "q"), ("centroidal_matrix_rate", "qv"), ("joint_torque_regressor", "qva"), ("mass_derivative", "q"),
    ("rnea_second_derivatives", "qva"), ("kinetic_energy", "qv"), ("potential_energy", "q"), ("integrate", "qv"), ("normalise", "q"), ("difference", "qq"),
]  # fmt: skip


def as_tuple(result: Any) -> tuple[Any, ...]:
    return result if isinstance(result, (tuple, list)) else (result,)


@pytest.mark.parametrize("name", ["ur5", "anymal_b_ff"])
@pytest.mark.parametrize(("method", "arguments"), CALLS)
def test_many_states_are_each_state(name: str, method: str, arguments: str) -> None:
    model, _ = robot(name)
    q, v, a = states(model, 700)
    of = {"q": q, "v": v, "a": a}
    call = getattr(model, method)
    together = as_tuple(call(*(of[key] for key in arguments)))
    for k in range(0, 700, 97):
        alone = as_tuple(call(*(of[key][k] for key in arguments)))
        for many, one in zip(together, alone):
            few_ulps(many[k], one)
    # Strided, reversed, Fortran order, read-only: the same bits.
    wide = {key: np.repeat(value, 2, axis=1) for key, value in of.items()}
    frozen = {key: value.copy() for key, value in of.items()}
    for value in frozen.values():
        value.flags.writeable = False
    forms = [
        {key: np.asfortranarray(value) for key, value in of.items()},
        {key: value[:, ::2] for key, value in wide.items()},
        frozen,
        {key: value.tolist() for key, value in of.items()},
        {key: value.astype(">f8") for key, value in of.items()},
    ]
    for form in forms:
        for many, same in zip(together, as_tuple(call(*(form[key] for key in arguments)))):
            assert np.array_equal(many, same)
    backwards = as_tuple(call(*(of[key][::-1] for key in arguments)))
    assert all(np.array_equal(many, back[::-1]) for many, back in zip(together, backwards))
    assert all(np.shape(empty)[0] == 0 for empty in as_tuple(call(*(of[key][:0] for key in arguments))))


def test_one_dimension_goes_with_every_row(ur5: sp.Model) -> None:
    q, v, a = states(ur5, 5)
    mixed = ur5.rnea(q, v[0], a)
    few_ulps(mixed, np.array([ur5.rnea(q[k], v[0], a[k]) for k in range(5)]))
    assert np.array_equal(mixed, ur5.rnea(q, np.repeat(v[:1], 5, axis=0), a))


def test_levels_of_simd() -> None:
    program = """
import sys, numpy as np, springpot as sp
arm = sp.Model.from_urdf(sys.argv[1])
q = arm.random(3, 21)
still = np.zeros_like(q)
print(np.array_equal(arm.rnea(q, still, still), [arm.rnea(one, still[0], still[0]) for one in q]))
"""
    urdf = str(ROOT / "testdata" / "multibody" / "ur5.urdf")
    run = [sys.executable, "-c", program, urdf]
    alone = subprocess.run(run, env={**os.environ, "SPRINGPOT_SIMD": "baseline"}, capture_output=True, text=True, check=True)
    assert alone.stdout.strip() == "True"
    refused = subprocess.run(run, env={**os.environ, "SPRINGPOT_SIMD": "sse"}, capture_output=True, text=True, check=False)
    assert 'ValueError: SPRINGPOT_SIMD is "sse"; it must be baseline, avx2 or avx512' in refused.stderr


def test_out(ur5: sp.Model) -> None:
    q, v, a = states(ur5, 5)
    out = np.empty((5, 6))
    assert ur5.rnea(q, v, a, out=out) is out
    assert np.array_equal(out, ur5.rnea(q, v, a))
    slopes = np.empty((6, 6)), np.empty((6, 6))
    found = ur5.rnea_derivatives(q[0], v[0], a[0], out=slopes)
    assert found[0] is slopes[0] and np.array_equal(slopes[1], ur5.rnea_derivatives(q[0], v[0], a[0])[1])
    # In the place of an argument.
    own = a.copy()
    assert np.array_equal(ur5.rnea(q, v, own, out=own), out)
    frozen = np.empty(6)
    frozen.flags.writeable = False
    room = np.empty((6, 6))
    for bad in (np.empty(5), np.empty((1, 6)), frozen, np.empty((6, 2))[:, 0]):
        with pytest.raises(ValueError, match="out"):
            ur5.rnea(q[0], v[0], a[0], out=bad)
    for worse in (np.empty(6, dtype=np.float32), [0.0] * 6, 3):
        with pytest.raises(TypeError, match="out must be a float64 array"):
            ur5.rnea(q[0], v[0], a[0], out=worse)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="shares memory"):
        ur5.rnea(room[:5], v, a, out=room[1:])


def test_bad_arguments(ur5: sp.Model) -> None:
    zero = np.zeros(6)
    with pytest.raises(ValueError, match=r"q has shape \(5,\); it must have shape \(6,\) or \(N, 6\)"):
        ur5.rnea(np.zeros(5), zero, zero)
    with pytest.raises(ValueError, match=r"v has shape \(2, 3, 6\)"):
        ur5.rnea(zero, np.zeros((2, 3, 6)), zero)
    with pytest.raises(ValueError, match="q has 2 rows, and v has 3"):
        ur5.rnea(np.zeros((2, 6)), np.zeros((3, 6)), zero)
    for bad in (np.zeros(6, complex), ["a"] * 6, np.array([object()] * 6), np.zeros(6, "M8[s]"), None, "q"):
        with pytest.raises(TypeError, match="v must be an array of real numbers"):
            ur5.rnea(zero, bad, zero)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="q.elbow_joint is NaN; it must be finite"):
        ur5.gravity([0, 0, np.nan, 0, 0, 0])
    many = np.zeros((1000, 6))
    many[713, 1] = np.inf
    many[900, 1] = np.inf
    with pytest.raises(ValueError, match="row 713: a.shoulder_lift_joint is inf"):
        ur5.rnea(np.zeros((1000, 6)), zero, many)
    with pytest.raises(ValueError, match="numbers of the state are too large"):
        ur5.rnea(zero, np.full(6, 1e308), zero)
    many[:] = 0.0
    many[41] = 1e308
    with pytest.raises(ValueError, match="row 41: the result holds"):
        ur5.rnea(np.zeros((1000, 6)), many, zero)
    read_only = np.zeros(6)
    read_only.flags.writeable = False
    for out in (read_only, np.zeros(12)[::2], np.zeros(49, np.uint8)[1:].view(np.float64)):
        with pytest.raises(ValueError, match="out must be C-contiguous and writeable"):
            ur5.rnea(zero, zero, zero, out=out)
    with pytest.raises(sp.ModelError, match="no frame is called \"wrist\""):
        ur5.frame_jacobian("wrist", zero)
    assert np.array_equal(ur5.gravity(np.zeros(6, dtype=np.int8)), ur5.gravity(zero))
    assert np.array_equal(ur5.gravity(np.zeros(6, dtype=np.float32)), ur5.gravity(zero))
    with pytest.raises(MemoryError):
        ur5.gravity(np.broadcast_to(zero, (2**52, 6)))
    with pytest.raises(MemoryError):
        ur5.random(0, 2**60)
    base, _ = robot("anymal_b_ff")
    with pytest.raises(sp.ModelError, match="one degree of freedom"):
        base.christoffel(base.neutral())
    with pytest.raises(ValueError, match="quaternion"):
        base.com(np.zeros(base.nq))


def test_facts(ur5: sp.Model) -> None:
    assert (ur5.nq, ur5.nv, ur5.name) == (6, 6, "ur5")
    assert ur5.q_names == ur5.v_names == ur5.joint_names
    assert set(ur5.joint_kinds) == {"revolute"}
    assert ur5.lower_limits.shape == ur5.velocity_limits.shape == (6,)
    assert (ur5.lower_limits < ur5.upper_limits).all() and (ur5.effort_limits > 0).all()
    assert ur5.masses.shape == (len(ur5.body_names),) and ur5.inertias.shape == (len(ur5.body_names), 3, 3)
    assert ur5.mass == pytest.approx(ur5.masses.sum())
    assert ur5.frame_names[0] == "world" and "gripper" not in ur5.frame_names
    assert np.array_equal(ur5.gravity_vector, [0, 0, -9.81])
    base, _ = robot("anymal_b_ff")
    assert base.q_names[6] == "floating_base.qw" and base.v_names[5] == "floating_base.wz" and base.neutral()[6] == 1.0
    assert np.isinf(base.lower_limits[:7]).all()
    moon = sp.Model.from_urdf(ROOT / "testdata/multibody/ur5.urdf", gravity=(0, 0, -1.62))
    np.testing.assert_allclose(moon.gravity(np.ones(6)), ur5.gravity(np.ones(6)) * 1.62 / 9.81)


def test_joints_of_several_coordinates() -> None:
    inertia = {"xx": 0.1, "yy": 0.1, "zz": 0.1}
    joints = [
        {"name": "c", "kind": "cylindrical", "axis": [0, 0, 1], "armature": {"rz": 0.5}, "upper": {"z": 0.3}},
        {"name": "s", "kind": "spherical"},
    ]
    bodies = [{"name": f"b{k}", "joint": joint, "mass": 1, "inertia": inertia} for k, joint in enumerate(joints)]
    model = sp.Model.from_scenario({"robot": {"body": bodies}})
    assert model.joint_names == ["c.z", "c.rz", "s"] and model.joint_kinds == ["cylindrical", "cylindrical", "spherical"]
    assert model.q_names == ["c.z", "c.rz", "s.qx", "s.qy", "s.qz", "s.qw"]
    assert model.v_names == ["c.vz", "c.wz", "s.wx", "s.wy", "s.wz"]
    assert np.array_equal(model.armature, [0, 0.5, 0, 0, 0]) and model.upper_limits[0] == 0.3
    q, v = model.random(1), np.arange(5.0)
    np.testing.assert_allclose(model.difference(q, model.integrate(q, 0.1 * v)), 0.1 * v, atol=1e-14)
    np.testing.assert_allclose(model.rnea(q, v, model.aba(q, v, -v)), -v, atol=1e-12)
    again = pickle.loads(pickle.dumps(model))
    assert again.q_names == model.q_names and np.array_equal(again.crba(q), model.crba(q))


def test_from_scenario() -> None:
    model = sp.Model.from_scenario(ROOT / "scenarios" / "falling_piezo.toml", set={"robot.gravity": [0, 0, -1]})
    assert model.gravity_vector[2] == -1 and model.gripper_body == "forearm"
    rotation, position = model.frame_placement("gripper", model.neutral())
    assert np.array_equal(rotation, np.eye(3)) and position.shape == (3,)


def test_models_are_sent_to_other_processes(tmp_path: Any) -> None:
    file = tmp_path / "ur5.urdf"
    file.write_bytes((ROOT / "testdata/multibody/ur5.urdf").read_bytes())
    robot = sp.Model.from_urdf(file, floating_base=True, gravity=[0, 1, -2])
    packed = pickle.dumps(robot)
    # The file itself is not needed any more.
    file.unlink()
    scenario = ROOT / "scenarios/thermoviscoelastic_order.toml"
    of_scenario = sp.Model.from_scenario(scenario, set={"robot.gravity": [0, 0, -1.62]})
    simulated = sp.Simulation(scenario).model
    for one, other in [(robot, pickle.loads(packed))] + [(m, pickle.loads(pickle.dumps(m))) for m in (of_scenario, simulated)]:
        q, v = one.random(seed=3), np.linspace(-1, 1, one.nv)
        assert np.array_equal(one.rnea(q, v, v), other.rnea(q, v, v))
        assert (other.name, other.joint_names, other.frame_names) == (one.name, one.joint_names, one.frame_names)
    with pytest.raises(ValueError, match="no model"):
        sp.Model._from_bytes(b"nonsense")  # type: ignore[attr-defined]


def test_threads_share_a_model(ur5: sp.Model) -> None:
    q, v, a = states(ur5, 300)
    wanted, wrong = ur5.rnea(q, v, a), []
    alone = [ur5.rnea(q[k], v[k], a[k]) for k in range(300)]

    def work() -> None:
        for k in range(300):
            if not (np.array_equal(ur5.rnea(q, v, a), wanted) and np.array_equal(ur5.rnea(q[k], v[k], a[k]), alone[k])):
                wrong.append(k)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_mjcf_files() -> None:
    """Gravity is the file's, mass matrix and bias forces MuJoCo's (testdata/mjcf/reference.py)."""
    folder = ROOT / "testdata" / "mjcf"
    for of in json.loads((folder / "reference.json").read_text())["robots"]:
        robot = sp.Model.from_mjcf(folder / of["file"])
        assert robot.gravity_vector[2] != -9.81
        for state in of["states"]:
            q, v = (np.array(state[key]) for key in ["q", "v"])
            mass, bias = np.array(state["M"]), np.array(state["bias"])
            sizes = np.sqrt(np.outer(np.diag(mass), np.diag(mass)))
            assert np.all(np.abs(robot.crba(q) - mass) < 1e-13 * sizes)
            assert np.all(np.abs(robot.rnea(q, v, np.zeros(robot.nv)) - bias) < 1e-13 * np.abs(bias).max())
    weightless = sp.Model.from_mjcf(folder / "arm.xml", gravity=(0, 0, 0))
    assert np.all(weightless.gravity_vector == 0)


def test_bad_files(tmp_path: Any) -> None:
    with pytest.raises(sp.ModelError, match="nothing.xml"):
        sp.Model.from_mjcf(tmp_path / "nothing.xml")
    with pytest.raises(sp.ModelError, match="nothing.urdf"):
        sp.Model.from_urdf(tmp_path / "nothing.urdf")
    with pytest.raises(sp.ScenarioError) as refused:
        sp.Model.from_scenario("[robot]\nbody = []\ngravty = 3\n")
    of_key = next(found for found in refused.value.refusals if "gravty" in found[3])
    assert of_key[:3] == ("<text>", 3, 1) and of_key[4] is not None and "gravity" in of_key[4]
    with pytest.raises(TypeError, match="a scenario is a path"):
        sp.Model.from_scenario(3)  # type: ignore[arg-type]
