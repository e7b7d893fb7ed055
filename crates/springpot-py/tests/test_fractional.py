"""Fractional calculus against the reference values."""

from __future__ import annotations

import math
import signal
import threading
import time

import numpy as np
import pytest
from conftest import oracle

import springpot as sp


def test_mittag_leffler() -> None:
    rows = oracle("fractional", "mittag_leffler.json")["rows"]
    for row in rows:
        z, wanted = (complex(*map(float, row[key])) if isinstance(row[key], list) else complex(float(row[key])) for key in ("z", "re_im"))
        found = sp.fractional.mittag_leffler(z, float(row["a"]), float(row["b"]))
        assert abs(found - wanted) <= 1e-11 * max(1.0, abs(wanted)), row
        if z.imag == 0:
            assert abs(sp.fractional.mittag_leffler(z.real, float(row["a"]), float(row["b"])) - wanted.real) <= 1e-11 * max(1, abs(wanted))
    assert len(rows) > 200


def test_mittag_leffler_takes_arrays() -> None:
    z = -np.linspace(0, 5, 12).reshape(3, 4)
    values = sp.fractional.mittag_leffler(z.T, 1.0)
    assert values.dtype == np.float64 and np.allclose(values, np.exp(z.T), rtol=1e-12)
    assert np.allclose(sp.fractional.mittag_leffler([1j, 2], 2.0), np.cosh(np.sqrt([1j, 2])), rtol=1e-12)
    assert sp.fractional.mittag_leffler(2, 1, derivative=1) == pytest.approx(math.exp(2))
    assert math.isnan(sp.fractional.mittag_leffler(math.nan, 0.5))
    for bad in ({"a": 0.0}, {"a": -1.0}, {"a": 0.5, "b": math.nan}):
        with pytest.raises(ValueError):
            sp.fractional.mittag_leffler(1.0, **bad)
    with pytest.raises(TypeError):
        sp.fractional.mittag_leffler("x", 0.5)  # type: ignore[arg-type]
    with pytest.raises((OverflowError, TypeError, ValueError)):
        sp.fractional.mittag_leffler(1.0, 0.5, derivative=-1)


@pytest.mark.parametrize("definition", ["caputo", "riemann-liouville"])
def test_derivatives(definition: str) -> None:
    functions = {
        "0.7*sin(8t)+0.1*t": lambda t: 0.7 * np.sin(8 * t) + 0.1 * t,
        "1+sin(3t)": lambda t: 1 + np.sin(3 * t),
        "cos(3t)": lambda t: np.cos(3 * t),
        "exp(-t)": lambda t: np.exp(-t),
    }
    data, compared = oracle("fractional", "derivatives.json")["functions"], 0
    for name, of in functions.items():
        for row in data[name]:
            t, alpha = float(row["t"]), float(row["alpha"])
            grid = np.linspace(0, t, 8001)
            found = sp.fractional.derivative(grid, of(grid), alpha, definition)[-1]
            wanted = float(row["caputo" if definition == "caputo" else "rl"])
            assert abs(found - wanted) <= 1e-8 * max(1.0, abs(wanted)), row
            compared += 1
    assert compared > 200


def test_columns_methods_and_errors() -> None:
    t = np.linspace(3.0, 4.0, 201)
    x = np.stack([(t - 3) ** 2, (t - 3) ** 3], axis=1)
    both = sp.fractional.derivative(t, x, 0.5)
    assert both.shape == (201, 2)
    assert np.array_equal(both[:, 1], sp.fractional.derivative(t, x[:, 1], 0.5))
    for method in ("hermite", "exponential", "l1", "l1-2", "grunwald-letnikov", "fbdf-3", "expansion-2004(30)"):
        found = sp.fractional.derivative(t, x[:, 0], 0.5, method=method)
        assert found[-1] == pytest.approx(both[-1, 0], rel=3e-2), method
    values, error = sp.fractional.derivative(t, x, 0.5, with_error=True)
    assert np.array_equal(values, both) and error.shape == (201, 2)
    rated = sp.fractional.derivative(t, x, 0.5, method="hermite", rates=np.stack([2 * (t - 3), 3 * (t - 3) ** 2], axis=1))
    np.testing.assert_allclose(rated, both, rtol=1e-9, atol=1e-12)
    integral = sp.fractional.derivative(t, x[:, 0], -1.0)
    np.testing.assert_allclose(integral, (t - 3) ** 3 / 3, atol=1e-12)
    for bad in (
        lambda: sp.fractional.derivative(t, x[:-1], 0.5),
        lambda: sp.fractional.derivative(t, x, 3.0),
        lambda: sp.fractional.derivative(t, x, 0.5, "weyl"),
        lambda: sp.fractional.derivative(t, x, 0.5, method="l2"),
        lambda: sp.fractional.derivative(t[::-1], x, 0.5),
        lambda: sp.fractional.derivative(t[:1], x[:1], 0.5),
        lambda: sp.fractional.derivative([], [], 0.5),
        lambda: sp.fractional.derivative(t, x * np.nan, 0.5),
        lambda: sp.fractional.derivative(x, x, 0.5),
        lambda: sp.fractional.derivative(t, x, 0.5, rates=x[:, 0]),
    ):
        with pytest.raises(ValueError):
            bad()
    with pytest.raises(TypeError):
        sp.fractional.derivative(t, x + 1j, 0.5)


def test_ctrl_c_ends_a_long_derivative() -> None:
    t = np.arange(20_000) * 1e-3
    t[1] *= 1.0000001
    # A sum over all pairs of rows, some seconds of work, which cannot be told to stop.
    timer = threading.Timer(0.2, signal.raise_signal, [signal.SIGINT])
    timer.start()
    begun = time.monotonic()
    try:
        with pytest.raises(KeyboardInterrupt):
            for _ in range(1000):
                sp.fractional.derivative(t, np.sin(t), 0.5, method="l1")
    finally:
        timer.cancel()
    assert time.monotonic() - begun < 30


def test_long_columns_are_those_of_short_ones() -> None:
    # On a thread of their own, and not.
    t = np.linspace(0, 1, 3001)
    x = np.stack([t**2, np.sin(t), t], axis=1)
    whole, errors = sp.fractional.derivative(t, x, 0.5, with_error=True)
    for k in range(3):
        one, error = sp.fractional.derivative(t, x[:, k], 0.5, with_error=True)
        assert np.array_equal(whole[:, k], one) and np.array_equal(errors[:, k], error, equal_nan=True)
    with pytest.raises(ValueError, match="must lie between"):
        sp.fractional.derivative(t, x, 3.0)
