"""Elements for other people's integrators."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from conftest import oracle

import springpot as sp


def power_derivative(k: int, alpha: float, t: float) -> float:
    return math.gamma(k + 1) / math.gamma(k + 1 - alpha) * t ** (k - alpha)


@pytest.mark.parametrize("alpha", [0.0, 0.1, 0.5, 0.9, 1.0])
@pytest.mark.parametrize("nodes", ["radau", "end", "midpoint"])
def test_forces_are_those_of_the_derivative(alpha: float, nodes: str) -> None:
    bank = sp.Bank([sp.law("springpot", c=3.0, alpha=alpha)], nodes=nodes, motion="given", step=0.002, horizon=1.0)
    bank.begin([0.0])
    for n in range(500):
        t = 0.002 * (n + bank.nodes)
        force, by_stroke, by_rate = bank.evaluate(0.002 * n, 0.002, [t**2], [2 * t])
        bank.commit()
    at = 0.002 * (499 + bank.nodes[-1])
    tolerance = {"radau": 1e-7, "end": 1e-2, "midpoint": 1e-2}[nodes]
    assert force[0, -1] == pytest.approx(3 * power_derivative(2, alpha, at), rel=tolerance)
    assert force.shape == (1, len(bank.nodes)) and by_stroke.shape == by_rate.shape == (1, len(bank.nodes), len(bank.nodes))
    assert bank.t == pytest.approx(1.0)


def two() -> sp.Bank:
    bank = sp.Bank(
        [
            {"law": "thermoviscoelastic", "name": "rubber", "parameters": {"E_c": "30 N/m", "E_kv": 20, "E_d": 50, "alpha": 0.5, "a_kv": 7e-4}},
            {"network": "series(spring(k), springpot(c, alpha))", "parameters": {"k": 90, "c": 4, "alpha": 0.3}, "derivative": "riemann-liouville"},
        ]
    )  # fmt: skip
    bank.begin([0.01, 0.0], inputs={"rubber.T": "25 degC"})
    return bank


def walk(bank: sp.Bank, n: int) -> np.ndarray:
    t = 0.01 * (n + bank.nodes)
    strokes = np.array([0.01 + 0.02 * np.sin(3 * t), 0.01 * t])
    rates = np.array([0.06 * np.cos(3 * t), np.full(3, 0.01)])
    forces, _, _ = bank.evaluate(0.01 * n, 0.01, strokes, rates, {"rubber.T": 298.15 + t})
    bank.commit()
    return forces


def test_state_goes_on_to_the_bit() -> None:
    bank = two()
    assert bank.names == ["rubber", "1"] and bank.inputs == ["rubber.T"] and len(bank) == 2 and bank.modes > 20
    for n in range(30):
        walk(bank, n)
    state = pickle.loads(pickle.dumps(bank.state()))
    later = [walk(bank, n) for n in range(30, 40)]
    energies = bank.stored, bank.dissipated, bank.supplied
    assert all(np.isfinite(energy).all() for energy in energies) and (bank.dissipated > 0).all()
    for other in (two(), bank):
        other.set_state(state)
        assert other.t == pytest.approx(0.3)
        assert all(np.array_equal(walk(other, n), force) for n, force in zip(range(30, 40), later))
        assert all(np.array_equal(own, e) for own, e in zip((other.stored, other.dissipated, other.supplied), energies))
    fresh = sp.Bank([sp.law("springpot", c=1, alpha=0.5)])
    with pytest.raises(ValueError, match="has not begun"):
        fresh.state()
    for bad in (state[:-1], state[:3], np.append(state, 0.0)):
        with pytest.raises(ValueError, match="another bank"):
            two().set_state(bad)


def test_evaluation_is_pure_and_tangents_are_derivatives() -> None:
    bank = two()
    for n in range(5):
        walk(bank, n)
    x, v = np.full((2, 3), 0.012), np.full((2, 3), 0.3)
    force, by_stroke, by_rate = bank.evaluate(0.05, 0.01, x, v)
    assert np.array_equal(force, bank.evaluate(0.05, 0.01, x, v)[0])
    for j in range(3):
        d = np.zeros((2, 3))
        d[:, j] = 1e-6
        slope = (bank.evaluate(0.05, 0.01, x + d, v)[0] - bank.evaluate(0.05, 0.01, x - d, v)[0]) / 2e-6
        np.testing.assert_allclose(by_stroke[:, :, j], slope, atol=1e-4)
        slope = (bank.evaluate(0.05, 0.01, x, v + d)[0] - bank.evaluate(0.05, 0.01, x, v - d)[0]) / 2e-6
        np.testing.assert_allclose(by_rate[:, :, j], slope, atol=1e-6)
        # Where rates follow from strokes, the first tangent has all of it.
        whole, none = bank.evaluate(0.05, 0.01, x)[1:]
        slope = (bank.evaluate(0.05, 0.01, x + d)[0] - bank.evaluate(0.05, 0.01, x - d)[0]) / 2e-6
        np.testing.assert_allclose(whole[:, :, j], slope, rtol=1e-5, atol=1e-2)
        assert not none.any()


def test_energy_balances() -> None:
    """What goes in is stored or dissipated, to the error of the quadrature."""
    bank = sp.Bank([sp.law("fractional-kelvin-voigt", k=20.0, c=5.0, alpha=0.5)], motion="given")
    bank.begin([0.0])
    work, h = 0.0, 1e-3
    weights = np.array([(16 - 6**0.5) / 36, (16 + 6**0.5) / 36, 1 / 9])
    for n in range(2000):
        t = h * (n + bank.nodes)
        x, v = np.sin(4 * t) ** 2, 4 * np.sin(8 * t)
        force, _, _ = bank.evaluate(h * n, h, [x], [v])
        bank.commit()
        work += h * weights @ (force[0] * v)
    assert work == pytest.approx(bank.stored[0] + bank.dissipated[0], rel=1e-6)


def test_with_solve_ivp() -> None:
    """The recipe of the docstring, against the exact solution; the memory is of order 2 − alpha in the stretch."""
    row = next(row for row in oracle("fractional", "oscillators.json")["kv"] if row["t"] == 1 or float(row["t"]) == 1.0)
    m, c, k, alpha = (float(row[key]) for key in ("m", "c", "k", "alpha"))
    errors = []
    for count in (50, 100):
        bank = sp.Bank([sp.law("fractional-kelvin-voigt", k=k, c=c, alpha=alpha)], nodes="end")
        bank.begin([1.0], [0.0])
        x, v, h = 1.0, 0.0, 1.0 / count
        for n in range(count):
            t0 = n * h

            def rhs(t: float, y: np.ndarray, t0: float = t0) -> list[float]:
                at = max(t - t0, 1e-12)
                force, _, _ = bank.evaluate(t0, at, y[:1], y[1:])
                return [y[1], -force[0, 0] / m]

            x, v = solve_ivp(rhs, (t0, t0 + h), [x, v], rtol=1e-9, atol=1e-12).y[:, -1]
            bank.evaluate(t0, h, [x], [v])
            bank.commit()
        errors.append(abs(x - float(row["free_caputo"])))
    assert errors[1] < 1e-3 and errors[1] < 0.5 * errors[0]


def test_bad_arguments() -> None:
    with pytest.raises(ValueError, match='no law "sprinpot".*springpot'):
        sp.Bank([{"law": "sprinpot"}])
    with pytest.raises(ValueError, match='no key "params"'):
        sp.Bank([{"law": "spring", "params": {"k": 1}}])
    with pytest.raises(ValueError, match='either "law" or "network"'):
        sp.Bank([{"parameters": {}}])
    with pytest.raises(ValueError, match="alpha is 1.5; it must be between 0 and 1"):
        sp.Bank([{"law": "springpot", "parameters": {"c": 1, "alpha": 1.5}}])
    with pytest.raises(ValueError, match='parameter "alpha" is missing'):
        sp.Bank([{"law": "springpot", "parameters": {"c": 1}}])
    with pytest.raises(TypeError):
        sp.Bank([3])  # type: ignore[list-item]
    with pytest.raises(ValueError, match="two elements"):
        sp.Bank([{"law": "spring", "parameters": {"k": 1}, "name": "1"}, sp.law("spring", k=1)])
    for bad in ({"nodes": "gauss"}, {"form": "x"}, {"motion": "x"}, {"tolerance": 1.0}, {"step": 0}, {"step": "1 m"}, {"horizon": -1}):
        with pytest.raises(ValueError):
            sp.Bank([sp.law("spring", k=1)], **bad)  # type: ignore[arg-type]
    bank = sp.Bank([sp.law("springpot", c=1, alpha=0.5)])
    with pytest.raises(ValueError, match="has not begun"):
        bank.evaluate(0, 1, [[0, 0, 0]])
    with pytest.raises(ValueError, match="no step was evaluated"):
        bank.commit()
    for strokes in ([0.0, 0.0], [[0.0]], 0.0):
        with pytest.raises(ValueError, match=r"strokes has shape"):
            bank.begin(strokes)
    bank.begin([0.0])
    for h in (0.0, -1.0, math.nan, math.inf, 1e-300):
        with pytest.raises(ValueError, match="h positive"):
            bank.evaluate(0, h, [[0, 0, 0]])
    with pytest.raises(ValueError, match="a step from t = 5 s, but the last one ended at 0 s"):
        bank.evaluate(5, 1, [[0, 0, 0]])
    bank.evaluate(0, 1, [[0, 0, 0]])
    bank.commit()
    with pytest.raises(ValueError, match="a step from t = 0 s, but the last one ended at 1 s"):
        bank.evaluate(0, 1, [[0, 0, 0]])
    bank.evaluate(1 + 1e-12, 1, [[0, 0, 0]])
    bank.begin([0.0])
    with pytest.raises(ValueError, match=r"strokes has shape \(3,\); it must have shape \(1, 3\)"):
        bank.evaluate(0, 1, [0, 0, 0])
    with pytest.raises(ValueError, match="finite"):
        bank.evaluate(0, 1, [[0, math.nan, 0]])
    with pytest.raises(TypeError):
        bank.evaluate(0, 1, [[0, 1j, 0]])
    with pytest.raises(ValueError, match='input "0.T" is missing'):
        sp.Bank([sp.law("thermoviscoelastic", E_c=30, E_kv=20, E_d=50, alpha=0.5, a_kv=7e-4)]).begin([0.0])
    damper = sp.Bank([sp.law("magnetorheological", E_c=1, mu_0=1, mu=1, alpha=0.5)], nodes="end")
    damper.begin([0.0], inputs=[0.0])
    with pytest.raises(sp.RunError, match="mu"):
        damper.evaluate(0, 1, [0.0], inputs={"0.u": -2.0})
    with pytest.raises(ValueError, match="finite"):
        damper.evaluate(0, 1, [0.0], inputs=[math.nan])
    with pytest.raises(ValueError, match="no input"):
        damper.evaluate(0, 1, [0.0], inputs={"0.v": -2.0})
