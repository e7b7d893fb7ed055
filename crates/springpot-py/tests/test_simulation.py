"""Simulations stepped from Python: callables, states, threads, signals."""

from __future__ import annotations

import gc
import os
import pickle
import signal
import threading
import time
import weakref
from collections.abc import Mapping

import numpy as np
import pytest
from conftest import ARM, FIXED, ROOT

import springpot as sp


def test_steps() -> None:
    arm = sp.Simulation(ARM)
    assert (arm.t, arm.end, arm.element_names) == (0.0, 2.0, ["strut"])
    assert arm.step() and 0 < arm.t <= 2
    middle = 0.5 * (arm.t_before + arm.t)
    assert arm.interpolate(middle).t == middle
    arm.step_to("500 ms")
    assert arm.t == 0.5
    now = arm.snapshot()
    assert isinstance(now, Mapping) and now.t == now["t"] == 0.5
    assert list(now) == arm.columns == list(now.keys()) and len(now) == len(arm.columns)
    assert now["q.q1"] == arm.q[0] == now.q[0] and now["v.q1"] == arm.v[0]
    assert now.units["strut.force"] == "N" and now.units == arm.units
    assert dict(now)["strut.force"] == now["strut.force"] and now.get("nothing") is None
    assert "strut.u" in now and "nothing" not in now and now["strut.u"] == 1.0
    with pytest.raises(KeyError, match="strut.force"):
        now["strut.forc"]
    arm.step_to(arm.end)
    assert not arm.step() and arm.report["steps"] > 3
    for bad in (0.1, 3.0):
        with pytest.raises(ValueError, match="outside"):
            arm.step_to(bad)
    assert arm.model.joint_names == ["q1"]


def test_rows_of_a_run_are_its_snapshots(tmp_path: object) -> None:
    """The shipped scenario, at the same times, to the last bit."""
    path = ROOT / "scenarios" / "falling_piezo.toml"
    one, two = sp.Simulation(path), sp.Simulation(path)
    one.step_to(0.5)
    while two.t < 0.5 and two.step():
        pass
    # Steps that end elsewhere agree within the tolerance.
    assert abs(two.interpolate(0.5)["q.q2"] - one.q[1]) < 1e-7


def test_events_happen_as_in_a_run() -> None:
    events = """
    [[event]]
    name = "on"
    when = "t - 0.3"
    action = { set = { "strut.u" = "3 V" } }
    [[event]]
    name = "low"
    when = "q.q1 - 0.3"
    [[event]]
    name = "half"
    when = "t - 0.55"
    action = "stop"
    """
    text = ARM + events
    ran = sp.run(text)
    wanted = [(str(name), float(t)) for name, t in zip(ran.events["event"], ran.events["t"], strict=True)]
    arm = sp.Simulation(text)
    passed = []
    while arm.step():
        passed += arm.passed
    assert [name for name, _ in passed] == [name for name, _ in wanted] and len(passed) >= 2
    assert np.allclose([t for _, t in passed], [t for _, t in wanted], rtol=0, atol=1e-6)
    assert (arm.t, arm.stopped_by, arm.snapshot()["strut.u"]) == (0.55, "half", 3.0)
    arm.step_to(1.0)
    assert arm.t == 0.55


def test_torques_and_inputs() -> None:
    arm = sp.Simulation(ARM)
    arm.set_torque("q1", "2 N*m")
    assert arm.snapshot()["tau.q1"] == pytest.approx(2.0)
    arm.set_torques([3.0])
    assert arm.snapshot()["tau.q1"] == pytest.approx(3.0)
    arm.set_torque(0, 0.0)
    arm.set_input("strut", "u", "500 mV")
    assert arm.snapshot()["strut.u"] == 0.5
    arm.set_input("strut", "u", None)
    assert arm.snapshot()["strut.u"] == 1.0
    with pytest.raises(ValueError, match="q1"):
        arm.set_torque("q2", 0)
    with pytest.raises(ValueError, match="no velocity 1"):
        arm.set_torque(1, 0)
    with pytest.raises(ValueError, match="strut"):
        arm.set_input("strat", "u", 0)
    with pytest.raises(ValueError, match='no input "v"'):
        arm.set_input("strut", "v", 0)
    with pytest.raises(ValueError, match="finite"):
        arm.set_torque(0, float("nan"))
    with pytest.raises(ValueError, match="torque"):
        arm.set_torque(0, "2 N")
    with pytest.raises(ValueError, match=r"\(1,\)"):
        arm.set_torques([1.0, 2.0])
    with pytest.raises(TypeError):
        arm.set_torque(0, None)  # type: ignore[arg-type]
    with pytest.raises(sp.RunError):
        # mu_0 + u·mu ≥ 0
        arm.set_input("strut", "u", -10.0)
    assert arm.snapshot()["strut.u"] == 1.0


def test_state_goes_on_to_the_bit() -> None:
    def f(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return -10 * q - v

    arm = sp.Simulation(ARM, controller=f, sample=0.01)
    arm.set_input("strut", "u", 2.0)
    arm.step_to(0.505)
    state = pickle.loads(pickle.dumps(arm.state()))
    assert state.t == 0.505
    arm.step_to(1.0)
    other = sp.Simulation(ARM, controller=f, sample=0.01)
    other.set_state(state)
    other.step_to(1.0)
    assert np.array_equal(arm.q, other.q) and np.array_equal(arm.v, other.v)
    arm.set_state(state)
    arm.step_to(1.0)
    assert np.array_equal(arm.q, other.q)
    with pytest.raises(ValueError, match="another"):
        sp.Simulation(ARM).set_state(state)
    with pytest.raises(ValueError, match="another run"):
        sp.Simulation(ARM, set={"robot.body.arm.mass": 2}, controller=f, sample=0.01).set_state(state)
    with pytest.raises(ValueError, match="no state"):
        sp.SimulationState.from_bytes(b"\x01\x02")


def test_controller_at_every_step_of_a_fixed_run() -> None:
    times = []

    def brake(t: float, q: np.ndarray, v: np.ndarray) -> float:
        assert q.shape == v.shape == (1,)
        times.append(t)
        return float(-2 * v[0])

    arm = sp.Simulation(FIXED, controller=brake)
    arm.step_to(0.1)
    assert times == [k / 1000 for k in range(100)]
    # The same as the scenario's own feedback, which is sampled at every step too.
    own = sp.Simulation(FIXED.replace('kind = "forward"', 'kind = "forward"\ntorque = { q1 = "-2*v.q1" }'))
    own.step_to(0.1)
    assert np.array_equal(arm.q, own.q) and np.array_equal(arm.v, own.v)


def test_sampled_callables_are_those_of_the_scenario() -> None:
    arm = sp.Simulation(
        ARM,
        controller=lambda t, q, v: -20 * q - v,
        inputs={"strut.u": (lambda t, q, v: 1 + abs(v[0]), "20 ms")},
        sample="10 ms",
    )
    text = ARM.replace(
        'kind = "forward"', 'kind = "forward"\ntorque = { q1 = { expression = "-20*q.q1-v.q1", sample = "10 ms" } }'
    )
    text = text.replace('u = "1 V"', 'u = { expression = "1+abs(v.q1)", unit = "V", sample = "20 ms" }')
    own = sp.Simulation(text)
    arm.step_to(1.0)
    own.step_to(1.0)
    np.testing.assert_allclose(arm.q, own.q, rtol=1e-7)
    np.testing.assert_allclose(arm.v, own.v, rtol=1e-6)


def test_inputs_that_are_numbers() -> None:
    arm = sp.Simulation(ARM, inputs={"strut.u": "250 mV"})
    assert arm.snapshot()["strut.u"] == 0.25
    for bad in ({"strut": 1.0}, {"strut.w": 1.0}, {"strat.u": 1.0}, {"strut.u": "3 N"}):
        with pytest.raises(ValueError):
            sp.Simulation(ARM, inputs=bad)
    with pytest.raises(ValueError, match="sample"):
        sp.Simulation(ARM, inputs={"strut.u": lambda t, q, v: 1.0})


def test_motions() -> None:
    t = np.linspace(0, 2, 401)
    for motion in (lambda t: 0.1 * np.sin(3 * t), (t, 0.1 * np.sin(3 * t))):
        arm = sp.Simulation(ARM, motions={"q1": motion})
        arm.step_to(1.3)
        now = arm.snapshot()
        assert now["q.q1"] == pytest.approx(0.1 * np.sin(3.9), abs=1e-9)
        assert now["v.q1"] == pytest.approx(0.3 * np.cos(3.9), abs=1e-6)
        assert now["a.q1"] == pytest.approx(-0.9 * np.sin(3.9), abs=1e-3)
    given = ARM.replace('kind = "forward"', 'kind = "prescribed"\njoints = { q1 = 0 }')
    arm = sp.Simulation(given, motions={"q1": lambda t: 0.1 * np.sin(3 * t)}, motion_step="1 ms")
    wanted = sp.Simulation(given.replace("q1 = 0 }", 'q1 = "0.1*sin(3*t)" }'))
    arm.step_to(1.3)
    wanted.step_to(1.3)
    assert arm.snapshot()["strut.force"] == pytest.approx(wanted.snapshot()["strut.force"], rel=1e-7)
    with pytest.raises(ValueError, match="q1"):
        sp.Simulation(ARM, motions={"q2": lambda t: 0.0})
    with pytest.raises(ValueError, match="finite"):
        sp.Simulation(ARM, motions={"q1": lambda t: float("nan")})
    with pytest.raises(TypeError, match="callable"):
        sp.Simulation(ARM, motions={"q1": 3.0})  # type: ignore[dict-item]
    with pytest.raises(ZeroDivisionError):
        sp.Simulation(ARM, motions={"q1": lambda t: 1 / 0})
    with pytest.raises(ValueError, match="controller needs joints"):
        sp.Simulation(given, controller=lambda t, q, v: 0.0, sample=0.1)


class Odd(Exception):
    pass


def test_exceptions_of_callables_come_through() -> None:
    raised = Odd("unchanged")

    def fails_at_half(t: float, q: np.ndarray, v: np.ndarray) -> float:
        if t >= 0.5 and fails_at_half.fails:  # type: ignore[attr-defined]
            raise raised
        return 0.0

    fails_at_half.fails = True  # type: ignore[attr-defined]
    arm = sp.Simulation(ARM, controller=fails_at_half, sample=0.1)
    with pytest.raises(Odd) as caught:
        arm.step_to(2.0)
    assert caught.value is raised and arm.t == 0.5
    fails_at_half.fails = False  # type: ignore[attr-defined]
    arm.step_to(2.0)
    straight = sp.Simulation(ARM, controller=fails_at_half, sample=0.1)
    straight.step_to(2.0)
    assert np.array_equal(arm.q, straight.q)


@pytest.mark.parametrize(
    ("said", "error"),
    [([1.0, 2.0], ValueError), ("x", TypeError), (None, TypeError), (float("nan"), sp.RunError), (1j, TypeError)],
)
def test_bad_controllers(said: object, error: type[Exception]) -> None:
    arm = sp.Simulation(ARM, controller=lambda t, q, v: said, sample=0.1)  # type: ignore[arg-type, return-value]
    with pytest.raises(error):
        arm.step_to(1.0)
    assert arm.t == 0.0
    with pytest.raises(TypeError, match="callable"):
        sp.Simulation(ARM, controller=3, sample=0.1)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="positive"):
        sp.Simulation(ARM, controller=lambda t, q, v: 0.0, sample=0)


def test_a_callable_may_not_step_its_own_simulation() -> None:
    seen: list[Exception] = []

    def curious(t: float, q: np.ndarray, v: np.ndarray) -> float:
        for call in (arm.step, arm.snapshot, lambda: arm.t, arm.state):
            try:
                call()
            except sp.RunError as error:
                seen.append(error)
        assert "at work" in repr(arm)
        return 0.0

    arm = sp.Simulation(ARM, controller=curious, sample=0.5)
    arm.step_to(1.0)
    assert len(seen) == 8 and "at work" in str(seen[0])


def test_two_threads_on_one_simulation() -> None:
    inside, go = threading.Event(), threading.Event()

    def waits(t: float, q: np.ndarray, v: np.ndarray) -> float:
        inside.set()
        assert go.wait(10)
        return 0.0

    arm = sp.Simulation(ARM, controller=waits, sample=1.0)
    thread = threading.Thread(target=arm.step_to, args=(1.0,))
    thread.start()
    assert inside.wait(10)
    with pytest.raises(sp.RunError, match="at work"):
        arm.step()
    go.set()
    thread.join(10)
    assert not thread.is_alive() and arm.t == 1.0


def test_other_threads_run_meanwhile() -> None:
    arm = sp.Simulation(FIXED, set={"time.end": 1e5})
    count, stop = 0, threading.Event()

    def counts() -> None:
        nonlocal count
        while not stop.is_set():
            count += 1
            time.sleep(0.001)

    thread = threading.Thread(target=counts)
    thread.start()
    # Longer and longer, so that the machine comes to run both within one call.
    for t in (10.0 * 2**k for k in range(13)):
        before = count
        arm.step_to(t)
        if count > before + 5:
            break
    stop.set()
    thread.join()
    assert count > before + 5


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timers here")
def test_ctrl_c_ends_a_long_step() -> None:
    arm = sp.Simulation(FIXED, set={"time.end": 1e5})
    begun = time.process_time()

    def once_it_works() -> None:
        while time.process_time() - begun < 0.2:
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        threading.Thread(target=once_it_works, daemon=True).start()
        arm.step_to(1e5)
    assert time.process_time() - begun < 10 and 0 < arm.t < 1e5
    t = arm.t
    assert arm.step() and arm.t > t


def test_refusals() -> None:
    with pytest.raises(sp.ScenarioError) as refused:
        sp.Simulation(ARM.replace("alpha = 0.4", "alpha = 1.4"))
    assert refused.value.line == 18 and len(refused.value.refusals) == 1
    copy = pickle.loads(pickle.dumps(refused.value))
    assert (str(copy), copy.line, copy.help) == (str(refused.value), refused.value.line, refused.value.help)
    with pytest.raises(sp.ScenarioError, match="--set"):
        sp.Simulation(ARM, set={"element.strut.alpa": 0.3})
    with pytest.raises(TypeError):
        sp.Simulation(ARM, 3)  # type: ignore[call-arg]


def test_run_errors_have_their_time() -> None:
    falls = ARM.replace("[time]", "[solver]\nmax_steps = 60\nrtol = 1e-11\n[time]")
    arm = sp.Simulation(falls)
    with pytest.raises(sp.RunError) as failed:
        arm.step_to(2.0)
    assert failed.value.t is not None and 0 < failed.value.t < 2
    assert pickle.loads(pickle.dumps(failed.value)).t == failed.value.t


def test_a_cycle_through_a_callable_is_collected() -> None:
    class Holder:
        arm: sp.Simulation

        def __call__(self, t: float, q: np.ndarray, v: np.ndarray) -> float:
            return 0.0

    holder = Holder()
    holder.arm = sp.Simulation(ARM, controller=holder, sample=0.5)
    gone = weakref.ref(holder)
    del holder
    gc.collect()
    assert gone() is None
