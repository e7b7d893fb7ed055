"""Elements on MuJoCo models: springpot's own motion, energy, memories under every way of asking for forces, errors."""

from __future__ import annotations

import concurrent.futures
import copy
import gc
import math
import pickle
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import arms
import numpy as np
import pytest

import springpot as sp

mujoco = pytest.importorskip("mujoco")

import springpot.mujoco  # noqa: E402

SITES = {"from": "base", "to": "tip"}
INTEGRATORS = ["Euler", "implicitfast", "RK4"]


@pytest.fixture(autouse=True)
def nothing_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    # MuJoCo writes its warnings to a file in the current folder.
    monkeypatch.chdir(tmp_path)
    yield
    gc.collect()
    left = mujoco.get_mjcb_passive()
    mujoco.set_mjcb_passive(None)
    assert left is None and not springpot.mujoco._active


def arm(h: float, integrator: str, q: tuple[float, float] = arms.START) -> tuple[Any, Any]:
    model = mujoco.MjModel.from_xml_string(arms.mjcf(h, integrator))
    data = mujoco.MjData(model)
    data.qpos[:] = q
    return model, data


def error(alpha: float, integrator: str, h: float, end: float, wanted: np.ndarray, **settings: Any) -> float:
    """Largest deviation of a joint from springpot's own motion, rad."""
    model, data = arm(h, integrator)
    every, worst = round(0.004 / h), 0.0
    with springpot.mujoco.Elements(model, data, [arms.strut(alpha, **SITES)], **settings):
        for n in range(1, round(end / h) + 1):
            mujoco.mj_step(model, data)
            if n % every == 0:
                worst = max(worst, float(np.abs(data.qpos - wanted[n // every]).max()))
    return worst


# Integrator, form of the memory, and the order as a function of alpha.
ORDERS: list[tuple[str, str | None, Any]] = [
    ("Euler", None, lambda alpha: 1.0),
    ("implicitfast", None, lambda alpha: 1.0),
    ("RK4", None, lambda alpha: 3.0 - alpha),
    ("RK4", "strokes", lambda alpha: 2.0 - alpha),
]


def test_converges_to_springpots_own_motion() -> None:
    """The table of docs/ENGINES.md."""
    sizes, end = (4e-3, 2e-3, 1e-3, 5e-4), 0.48
    print(f"\n{'integrator':<14}{'memory':<9}{'alpha':>5}" + "".join(f"{1e3 * h:>9g} ms" for h in sizes) + "   order")
    for alpha in (0.3, 0.5, 0.8):
        run = sp.run(arms.scenario(alpha, end))
        wanted = np.stack([run["q.q1"], run["q.q2"]], axis=1)
        assert np.abs(wanted - wanted[0]).max() > 0.5
        for integrator, form, order in ORDERS:
            errors = [error(alpha, integrator, h, end, wanted, form=form) for h in sizes]
            orders = np.log2(np.array(errors[:-1]) / errors[1:])
            memory = form or ("rates" if integrator == "RK4" else "strokes")
            print(f"{integrator:<14}{memory:<9}{alpha:>5}" + "".join(f"{e:>12.2e}" for e in errors) + f"   {orders[-1]:.2f}")
            assert orders[-1] == pytest.approx(order(alpha), abs=0.06), (integrator, form, alpha, orders)
            assert errors[0] < 0.03


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("alpha", [0.3, 0.9])
def test_energy_is_kept_and_never_grows(integrator: str, alpha: float) -> None:
    """Kinetic + potential + stored + dissipated stays to the order of the integrator; without what is dissipated it does not grow."""

    def ledger(h: float) -> tuple[np.ndarray, np.ndarray]:
        model, data = arm(h, integrator)
        rows = []
        with springpot.mujoco.Elements(model, data, [arms.strut(alpha, **SITES)]) as elements:
            for _ in range(round(2.0 / h)):
                mujoco.mj_forward(model, data)
                rows.append((data.energy.sum() + elements.stored[0], elements.dissipated[0]))
                mujoco.mj_step(model, data)
        return tuple(np.array(rows).T)  # type: ignore[return-value]

    balances = []
    for h in (4e-3, 2e-3):
        usable, dissipated = ledger(h)
        balances.append(float(np.abs(usable + dissipated - usable[0]).max()))
        assert (np.diff(dissipated) >= 0.0).all() and dissipated[-1] > 1.0
        # What the arm has lost by the end it does not get back, and at no time it has more than at first.
        growth = np.maximum.accumulate(usable[::-1])[::-1] - usable
        assert usable.max() - usable[0] <= balances[-1] and growth.max() <= 2.0 * balances[-1]
    coarse, fine = balances
    assert fine < (0.6 if integrator != "RK4" else 0.3) * coarse
    assert fine < (0.05 if integrator != "RK4" else 1e-3) * dissipated[-1]


def walk(model: Any, data: Any, steps: int) -> np.ndarray:
    rows = []
    for _ in range(steps):
        mujoco.mj_step(model, data)
        rows.append(np.concatenate([data.qpos, data.qvel]))
    return np.array(rows)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_reset_gives_the_same_bits(integrator: str) -> None:
    model, data = arm(2e-3, integrator)
    with springpot.mujoco.Elements(model, data, [arms.strut(0.5, **SITES, rest_length="start")]) as elements:
        first = walk(model, data, 100)
        force = elements.forces
        for steps in (1, 2, 3, 50):
            mujoco.mj_resetData(model, data)
            data.qpos[:] = 0.1, 0.2
            walk(model, data, steps)
            mujoco.mj_resetData(model, data)
            data.qpos[:] = arms.START
            assert np.array_equal(walk(model, data, 100), first) and np.array_equal(elements.forces, force)
        # A state that is set at the time that the data has already is not seen; `reset` says it.
        data.qpos[:], data.qvel[:] = arms.START, 0.0
        elements.reset()
        assert math.isnan(elements.t) and np.isnan(elements.rest_lengths).all()
        np.testing.assert_allclose(walk(model, data, 100), first, rtol=1e-9)
        assert elements.begun_at == pytest.approx(0.2)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_asking_in_between_changes_nothing(integrator: str) -> None:
    kind = mujoco.mjtState.mjSTATE_INTEGRATION

    def course(disturbed: bool) -> np.ndarray:
        model, data = arm(2e-3, integrator)
        numbers = np.zeros(mujoco.mj_stateSize(model, kind))
        rows = []
        with springpot.mujoco.Elements(model, data, [arms.strut(0.5, **SITES)]) as elements:
            for n in range(60):
                if disturbed:
                    for _ in range(n % 3):
                        mujoco.mj_forward(model, data)
                    assert n < 2 or np.isfinite(list(elements["strut"].values())).all()
                    if n % 5 == 0 and integrator != "RK4":
                        mujoco.mjd_transitionFD(model, data, 1e-6, True, np.zeros((4, 4)), None, None, None)
                    if n % 7 == 0:
                        mujoco.mj_inverse(model, data)
                    if n % 4 == 0:
                        # A step that is tried, looked at, and taken back.
                        mujoco.mj_getState(model, data, numbers, kind)
                        data.qvel[:] += 0.1
                        mujoco.mj_step(model, data)
                        mujoco.mj_forward(model, data)
                        mujoco.mj_setState(model, data, numbers, kind)
                mujoco.mj_step(model, data)
                rows.append(np.concatenate([data.qpos, data.qvel, elements.forces]))
        return np.array(rows)

    assert np.array_equal(course(True), course(False))


def test_step_in_two_halves() -> None:
    model, data = arm(2e-3, "Euler")
    with springpot.mujoco.Elements(model, data, [arms.strut(0.5, **SITES)]):
        whole = walk(model, data, 50)
        mujoco.mj_resetData(model, data)
        data.qpos[:] = arms.START
        for row in whole:
            mujoco.mj_step1(model, data)
            mujoco.mj_step2(model, data)
            assert np.array_equal(data.qpos, row[:2])


def test_timestep_may_change() -> None:
    """Steps that change from one to the next neither begin anew nor lose the past."""
    model, data = arm(1e-3, "RK4")
    run = sp.run(arms.scenario(0.5, 0.4))
    with springpot.mujoco.Elements(model, data, [arms.strut(0.5, **SITES)]) as elements:
        for n in range(200):
            model.opt.timestep = 1e-3 if n % 2 == 0 else 3e-3
            mujoco.mj_step(model, data)
        assert elements.begun_at == 0.0 and data.time == pytest.approx(0.4)
        np.testing.assert_allclose(data.qpos, [run["q.q1"][-1], run["q.q2"][-1]], atol=1e-5)
        assert elements.strokes[0] == pytest.approx(run["strut.stroke"][-1], abs=2e-3)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_states_beside_the_data(integrator: str) -> None:
    model, data = arm(2e-3, integrator)
    elements = springpot.mujoco.Elements(model, data, [arms.strut(0.5, **SITES)])
    walk(model, data, 40)
    kind = mujoco.mjtState.mjSTATE_INTEGRATION
    numbers = np.zeros(mujoco.mj_stateSize(model, kind))
    mujoco.mj_getState(model, data, numbers, kind)
    kept = pickle.loads(pickle.dumps(elements.state()))
    twin = copy.copy(data)
    other = elements.copy(twin)
    later = walk(model, data, 40)
    # Several data at once, each with a past of its own.
    assert np.array_equal(walk(model, twin, 40), later) and np.array_equal(other.dissipated, elements.dissipated)
    mujoco.mj_setState(model, data, numbers, kind)
    elements.set_state(kept)
    assert np.array_equal(walk(model, data, 40), later)
    # Without its state the strut has forgotten.
    mujoco.mj_setState(model, data, numbers, kind)
    assert not np.array_equal(walk(model, data, 40), later) and elements.begun_at == pytest.approx(0.08)
    elements.disable()
    other.disable()
    two = springpot.mujoco.Elements(model, data, [arms.strut(0.5, **SITES), {**arms.strut(0.5, **SITES), "name": "b"}])
    with two, pytest.raises(ValueError, match="other elements"):
        two.set_state(kept)


def test_data_of_several_threads() -> None:
    models = [arm(2e-3, integrator) for integrator in INTEGRATORS * 2]
    made = [springpot.mujoco.Elements(model, data, [arms.strut(0.5, **SITES)]) for model, data in models]
    wanted = [walk(model, data, 200) for model, data in models]
    for model, data in models:
        mujoco.mj_resetData(model, data)
        data.qpos[:] = arms.START
    with concurrent.futures.ThreadPoolExecutor(6) as pool:
        found = list(pool.map(lambda pair: walk(*pair, 200), models))
    assert all(np.array_equal(own, other) for own, other in zip(found, wanted))
    [elements.disable() for elements in made]


def test_enabling() -> None:
    model, data = arm(2e-3, "Euler")
    free = walk(model, data, 20)
    calls = []

    def others(model: Any, data: Any) -> None:
        calls.append(data.time)

    mujoco.set_mjcb_passive(others)
    with springpot.mujoco.Elements(model, data, [arms.strut(0.5, **SITES)]) as elements:
        assert elements.enabled and "enabled" in repr(elements)
        mujoco.mj_resetData(model, data)
        data.qpos[:] = arms.START
        assert not np.array_equal(walk(model, data, 20), free) and len(calls) == 20
        mujoco.set_mjcb_passive(None)
        assert not elements.enabled
        elements.enable()
        assert elements.enabled
        mujoco.set_mjcb_passive(None)
        mujoco.set_mjcb_passive(others)
        elements.enable()
    assert not elements.enabled and mujoco.get_mjcb_passive() is others
    mujoco.set_mjcb_passive(None)
    mujoco.mj_resetData(model, data)
    data.qpos[:] = arms.START
    assert np.array_equal(walk(model, data, 20), free)
    # Elements end with their data.
    springpot.mujoco.Elements(model, data, [arms.strut(0.5, **SITES)])
    assert springpot.mujoco._active
    del data
    gc.collect()
    assert not springpot.mujoco._active


def test_forces_are_applied_at_the_sites() -> None:
    """F by its own virtual work, on joints that MuJoCo knows: against `mj_applyFT`."""
    model, data = arm(2e-3, "Euler")
    spring = {"name": "spring", "rest_length": 0.1, "law": "kelvin-voigt", "parameters": {"k": 300, "c": 4}}
    data.qvel[:] = 0.7, -0.4
    with springpot.mujoco.Elements(model, data, [{**spring, **SITES}]) as elements:
        mujoco.mj_forward(model, data)
        row = elements["spring"]
    start, end = data.site("base").xpos, data.site("tip").xpos
    unit = (end - start) / np.linalg.norm(end - start)
    velocity = np.zeros(6)
    mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_SITE, model.site("tip").id, velocity, 0)
    assert row["length"] == pytest.approx(np.linalg.norm(end - start)) and row["rate"] == pytest.approx(unit @ velocity[3:])
    assert row["force"] == pytest.approx(300 * (row["length"] - 0.1) + 4 * row["rate"], rel=1e-12)
    applied = np.zeros(2)
    mujoco.mj_applyFT(model, data, -row["force"] * unit, np.zeros(3), end, model.site("tip").bodyid[0], applied)
    np.testing.assert_allclose(data.qfrc_passive, applied, rtol=1e-12)


def test_on_all_joints() -> None:
    """A free body with a ball joint, a slide and a hinge on it: the gradient is that of MuJoCo's own Jacobians."""
    model = mujoco.MjModel.from_xml_string("""
    <mujoco><worldbody>
      <body name="turntable"><joint type="hinge" axis="0 0 1"/><geom size=".1"/><site name="a" pos=".3 0 .1"/></body>
      <body pos="0 0 1"><freejoint/><geom size=".1"/>
        <body pos=".2 .1 0"><joint type="ball"/><geom size=".1"/>
          <body pos="0 .2 .1"><joint type="slide" axis="1 1 0"/><joint type="hinge" axis="0 1 1"/><geom size=".1"/>
            <body pos=".1 0 0"><geom size=".1"/><site name="b" pos=".1 .1 0"/></body>
    </body></body></body></worldbody></mujoco>""")
    data = mujoco.MjData(model)
    rng = np.random.default_rng(3)
    mujoco.mj_integratePos(model, data.qpos, rng.normal(size=model.nv), 1.0)
    data.qvel[:] = rng.normal(size=model.nv)
    pulled = {"from": "a", "to": "b", "rest_length": 0.0, "network": "preload(f)", "parameters": {"f": 1.0}}
    with springpot.mujoco.Elements(model, data, [pulled]) as elements:
        mujoco.mj_forward(model, data)
        jacobians = np.zeros((2, 3, model.nv))
        for jacobian, site in zip(jacobians, ("a", "b")):
            mujoco.mj_jacSite(model, data, jacobian, None, model.site(site).id)
        stretch = data.site("b").xpos - data.site("a").xpos
        gradient = stretch / np.linalg.norm(stretch) @ (jacobians[1] - jacobians[0])
        np.testing.assert_allclose(data.qfrc_passive, -gradient, atol=1e-14)
        assert elements.rates[0] == pytest.approx(gradient @ data.qvel, rel=1e-12)


def test_inputs_follow_time() -> None:
    model, data = arm(2e-3, "Euler")
    damper = {"name": "d", "rest_length": "42 cm", "law": "magnetorheological", "parameters": {"E_c": 30, "mu_0": 5, "mu": 10, "alpha": 0.4}, **SITES}
    with springpot.mujoco.Elements(model, data, [{**damper, "inputs": {"u": lambda t: 2.0 * (t > 0.1)}}]) as elements:
        switched = walk(model, data, 100)
        mujoco.mj_resetData(model, data)
        data.qpos[:] = arms.START
        elements.set_input("d", "u", "0 V")
        off = walk(model, data, 100)
        assert np.array_equal(switched[:50], off[:50]) and not np.array_equal(switched[60], off[60])
        with pytest.raises(ValueError, match="no input"):
            elements.set_input("d", "T", 3)
        # A rule of the law is broken under way; memories stay, and go on with a better value.
        elements.set_input("d", "u", -3.0)
        with pytest.raises(sp.RunError, match="mu_0"):
            mujoco.mj_step(model, data)
        elements.set_input("d", "u", 0.0)
        t = data.time
        mujoco.mj_step(model, data)
        assert data.time == pytest.approx(t + 2e-3) and elements.begun_at == 0.0


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_exceptions_come_through(integrator: str) -> None:
    class Trouble(Exception):
        pass

    def signal(t: float) -> float:
        if 0.0205 < t < 0.0235:
            raise Trouble("here")
        return 1.0

    model, data = arm(2e-3, integrator)
    damper = {"name": "d", "rest_length": "start", "law": "magnetorheological", "parameters": {"E_c": 30, "mu_0": 5, "mu": 10, "alpha": 0.4}, **SITES}
    with springpot.mujoco.Elements(model, data, [{**damper, "inputs": {"u": signal}}]) as elements:
        with pytest.raises(Trouble, match="here"):
            walk(model, data, 50)
        assert 0.018 < data.time < 0.023
        # The same data goes on after a reset, as if nothing had been.
        mujoco.mj_resetData(model, data)
        elements.set_input("d", "u", 1.0)
        again = walk(model, data, 50)
    model, data = arm(2e-3, integrator, (0.0, 0.0))
    with springpot.mujoco.Elements(model, data, [{**damper, "inputs": {"u": 1.0}}]):
        assert np.array_equal(walk(model, data, 50), again)


def test_jump_of_the_papers_derivative() -> None:
    """Riemann–Liouville and x(0) ≠ 0: infinite at once, of finite impulse; c x(0) t^−alpha/Γ(1 − alpha) later."""
    model, data = arm(1e-3, "Euler")
    potted = {"rest_length": 0.0, "law": "springpot", "parameters": {"c": 5.0, "alpha": 0.5}, "derivative": "riemann-liouville", **SITES}
    model.opt.gravity[:] = 0.0
    model.dof_armature[:] = 1e9
    with springpot.mujoco.Elements(model, data, [potted]) as elements:
        mujoco.mj_forward(model, data)
        first = elements.forces[0]
        length = elements.lengths[0]
        walk(model, data, 101)
        assert np.isfinite(first) and first > elements.forces[0]
        assert elements.forces[0] == pytest.approx(5.0 * length * 0.1**-0.5 / math.gamma(0.5), rel=2e-2)


@pytest.mark.parametrize("alpha", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_stable_where_the_docstring_says(alpha: float, integrator: str) -> None:
    h = 1e-3
    model = mujoco.MjModel.from_xml_string(f"""
    <mujoco><option timestep="{h}" gravity="0 0 0" integrator="{integrator}"/><worldbody><site name="a"/>
      <body pos="1 0 0"><joint type="slide" axis="1 0 0"/><geom size=".1" mass="2"/><site name="b"/></body>
    </worldbody></mujoco>""")

    def speeds(c: float) -> np.ndarray:
        data = mujoco.MjData(model)
        data.qvel[0] = 0.1
        potted = {"from": "a", "to": "b", "rest_length": "start", "law": "springpot", "parameters": {"c": c, "alpha": alpha}}
        with springpot.mujoco.Elements(model, data, [potted]):
            return np.abs(walk(model, data, 200)[:, 1])

    stable = speeds(1.45 * 2 / h ** (2 - alpha))
    assert stable.max() < 0.2 and stable[100:].max() < 0.02
    assert speeds(6.0 * 2 / h ** (2 - alpha)).max() > 1.0


def test_bad_arguments() -> None:
    model, data = arm(2e-3, "Euler")
    for changes, what in (
        ({"to": "tipp"}, 'element "strut": there is no site "tipp"; there are base, tip'),
        ({"rest_lenght": 1}, "did you mean"),
        ({"rest_length": float("nan")}, "finite"),
        ({"law": "sprinpot"}, "springpot"),
        ({"inputs": {"u": 1}}, "no input"),
    ):
        with pytest.raises(ValueError, match=what):
            springpot.mujoco.Elements(model, data, [{**arms.strut(0.5, **SITES), **changes}])
    with pytest.raises(sp.RunError, match="has no direction"):
        with springpot.mujoco.Elements(model, data, [arms.strut(0.5, **{"from": "tip", "to": "tip"})]):
            mujoco.mj_step(model, data)
    with springpot.mujoco.Elements(model, data, [arms.strut(0.5, **SITES)]) as elements:
        with pytest.raises(KeyError, match="strut"):
            elements["damper"]
    other, _ = arm(2e-3, "Euler")
    with springpot.mujoco.Elements(model, data, [arms.strut(0.5, **SITES)]), pytest.raises(sp.RunError, match="another model"):
        mujoco.mj_step(other, data)
