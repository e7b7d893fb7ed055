"""Derivatives of runs: columns, gradients of metrics, simulations, JAX and PyTorch."""

import importlib.util
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import springpot as sp

ARM = """
[[robot.body]]
name = "arm"
joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }
mass = 1
com = [0.2, 0, 0]
[[element]]
name = "strut"
from = { body = "world", point = [0, 0, -0.3] }
to = { body = "arm", point = [0.3, 0, 0] }
rest_length = "42 cm"
law = "fractional-kelvin-voigt"
parameters = { k = "60 N/m", c = "20 N*s^alpha/m", alpha = 0.4 }
[motion]
kind = "forward"
start = { q = { q1 = 0.1 } }
[time]
end = 0.5
output_step = 0.05
[[metric]]
name = "deep"
of = "q.q1"
kind = "rms"
[[metric]]
name = "pull"
of = "strut.force"
kind = "max"
"""
BY = ["element.strut.alpha", "motion.start.q.q1"]
VALUES = [0.4, 0.1]


def difference(of: Callable[[list[float]], Any], k: int, step: float = 1e-3) -> Any:
    def at(steps: float) -> Any:
        return of([value + steps * step * (j == k) for j, value in enumerate(VALUES)])

    return (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * step)


def test_columns_by_parameters() -> None:
    run = sp.run(ARM, sensitivity=BY)
    assert run.parameters == BY and run.case(0).parameters == {}
    slopes = run.sensitivity("q.q1")
    assert slopes.shape == (11, 2) and slopes[0].tolist() == [0.0, 1.0]
    for k, name in enumerate(BY):
        truth = difference(lambda p: sp.run(ARM, dict(zip(BY, p)))["q.q1"], k)
        assert run.sensitivity("q.q1", name) == pytest.approx(truth, abs=1e-6 * np.abs(truth).max())
        assert np.array_equal(slopes[:, k], run[f"d(q.q1)/d({name})"])
        deep = difference(lambda p: sp.run(ARM, dict(zip(BY, p))).metrics["deep"], k)
        assert run.gradient("deep")[name] == pytest.approx(deep, rel=1e-6)
    assert run.case(0).lost == []
    with pytest.raises(KeyError, match="no parameter"):
        run.sensitivity("q.q1", "element.strut.k")
    with pytest.raises(KeyError, match="no metric"):
        run.gradient("shallow")
    with pytest.raises(KeyError, match="does not tell"):
        run.sensitivity("energy.residual")
    with pytest.raises(ValueError, match="not differentiated"):
        sp.run(ARM).sensitivity("q.q1")
    both = sp.run(ARM, sweep={"element.strut.k": [50, 60]}, sensitivity=BY)
    assert both.parameters == BY and both.case(1).sensitivity("q.q1").shape == (11, 2)
    assert both.case(1).gradient("pull") == run.gradient("pull")
    assert len(both.table()["element.strut.k"]) == 22
    with pytest.raises(sp.SpringpotError, match="2 cases"):
        both.gradient("pull")


def test_gradient_of_a_metric() -> None:
    value, by = sp.gradient(ARM, "deep", BY)
    run = sp.run(ARM, sensitivity=BY)
    assert value == run.metrics["deep"] and by == run.gradient("deep")
    assert sp.gradient(ARM, "deep", BY[0], set={"element.strut.k": 80})[0] != value
    block = '[[parameter]]\nname = "order"\npath = "element.strut.alpha"\n'
    assert sp.gradient(ARM + block, "deep")[1] == {"order": pytest.approx(by[BY[0]], rel=1e-7)}
    with pytest.raises(sp.ScenarioError, match="no parameter"):
        sp.gradient(ARM, "deep")
    with pytest.raises(KeyError, match="no metric"):
        sp.gradient(ARM, "deeper", BY)


def test_simulations_have_tangents() -> None:
    arm = sp.Simulation(ARM, sensitivity=BY)
    assert arm.parameters == BY and arm.dq.shape == (1, 2) and arm.dq.tolist() == [[0.0, 1.0]]
    while arm.t < 0.2:
        arm.step()
    kept, at = arm.state(), arm.t
    told = arm.snapshot()
    assert arm.dq[0].tolist() == [told[f"d(q.q1)/d({name})"] for name in BY]
    assert arm.dv[0].tolist() == [told[f"d(v.q1)/d({name})"] for name in BY]
    assert told.units[f"d(strut.force)/d({BY[0]})"] == "N"
    arm.step_to(0.5)
    end = (arm.dq.tolist(), arm.dv.tolist())
    run = sp.run(ARM, sensitivity=BY)
    assert arm.dq[0] == pytest.approx(run.sensitivity("q.q1")[-1], rel=1e-7)
    # In this simulation and in another one it goes on to the bit.
    other = sp.Simulation(ARM, sensitivity=BY)
    for one in (arm, other):
        one.set_state(kept)
        assert one.t == at
        one.step_to(0.5)
        assert (one.dq.tolist(), one.dv.tolist()) == end
    plain = sp.Simulation(ARM)
    assert plain.parameters == [] and plain.dq.shape == (1, 0)
    with pytest.raises(ValueError, match="another"):
        other.set_state(plain.state())
    with pytest.raises(ValueError, match="leave `motions` out"):
        sp.Simulation(ARM, sensitivity=BY, motions={"q1": lambda t: 0.1 * t})


def test_designs_move_parameters() -> None:
    tables = '[[parameter]]\nname = "order"\npath = "element.strut.alpha"\nbounds = [0.2, 0.8]\n[design]\nminimise = "deep"\n'
    found = sp.design(ARM + tables, starts=2)
    order = found.parameters["order"]
    assert found.status == "converged" and order.path == BY[0] and found.runs == len(found.steps["objective"])
    at = [sp.run(ARM, {BY[0]: order.value + step}).metrics["deep"] for step in (-0.01, 0.0, 0.01)]
    assert found.objective["after"] == pytest.approx(at[1], rel=1e-8)
    if order.at_bound is None:
        assert at[0] > at[1] < at[2]
    else:
        assert order.value == {"lower": 0.2, "upper": 0.8}[order.at_bound]
    assert found.run().metrics["deep"] == pytest.approx(at[1], rel=1e-8)
    with pytest.raises(sp.ScenarioError, match="no \\[design\\]"):
        sp.design(ARM)


@pytest.mark.skipif(importlib.util.find_spec("jax") is None, reason="JAX is not installed")
def test_jax_differentiates_columns() -> None:
    import jax
    import jax.numpy as jnp

    import springpot.jax

    jax.config.update("jax_enable_x64", True)
    columns: Any = springpot.jax.columns(ARM, BY, ["q.q1", "strut.force"])
    p = jnp.array(columns.start)
    run = sp.run(ARM, sensitivity=BY)
    slopes = np.stack([run.sensitivity(name) for name in columns.columns], axis=1)
    assert columns.columns == ["q.q1", "strut.force"] and columns.parameters == BY
    assert columns(p) == pytest.approx(np.stack([run["q.q1"], run["strut.force"]], axis=1), rel=1e-7)
    y, dy = jax.jvp(columns, (p,), (jnp.array([0.0, 1.0]),))
    assert dy == pytest.approx(slopes[:, :, 1], abs=1e-6 * np.abs(slopes).max())
    y, back = jax.vjp(columns, p)
    outer = jnp.cos(jnp.arange(22.0)).reshape(11, 2)
    assert back(outer)[0] == pytest.approx(np.einsum("nc,ncp->p", outer, slopes), rel=1e-5)
    loss = jax.jit(lambda p: jnp.sum(columns(p)[:, 0] ** 2))
    at = jax.jit(jax.grad(loss))(p)
    assert at == pytest.approx(2 * run["q.q1"] @ run.sensitivity("q.q1"), rel=1e-6)
    many = jax.jit(jax.vmap(jax.grad(loss)))(jnp.stack([p, p * 1.01]))
    assert many.shape == (2, 2) and np.asarray(many)[0] == pytest.approx(np.asarray(at), rel=1e-12)


@pytest.mark.skipif(importlib.util.find_spec("torch") is None, reason="PyTorch is not installed")
@pytest.mark.filterwarnings("default")
def test_torch_differentiates_columns() -> None:
    import torch

    import springpot.torch

    columns: Any = springpot.torch.columns(ARM, BY, ["q.q1", "strut.force"])
    p = torch.tensor(columns.start, requires_grad=True)
    run = sp.run(ARM, sensitivity=BY)
    y = columns(p)
    assert y.shape == (11, 2) and columns.parameters == BY
    (y[:, 0] ** 2).sum().backward()
    truth = 2 * run["q.q1"] @ run.sensitivity("q.q1")
    assert p.grad.numpy() == pytest.approx(truth, rel=1e-6)
    dy = torch.func.jvp(columns, (p.detach(),), (torch.tensor([0.0, 1.0], dtype=torch.float64),))[1]
    slopes = run.sensitivity("q.q1")[:, 1]
    assert dy[:, 0].numpy() == pytest.approx(slopes, abs=1e-6 * np.abs(slopes).max())
    back = torch.func.vjp(columns, p.detach())[1](torch.ones(11, 2, dtype=torch.float64))[0]
    assert back.shape == (2,)
    many = torch.func.vmap(columns)(torch.stack([p.detach(), 1.01 * p.detach()]))
    assert many.shape == (2, 11, 2) and torch.equal(many[0], y.detach())
