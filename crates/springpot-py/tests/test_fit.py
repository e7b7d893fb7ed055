"""Fits of scenarios: values, residuals and their derivatives, for other minimisers too."""

import json

import numpy as np
import pytest
import springpot as sp
from scipy.optimize import least_squares

SCENARIO = {
    "element": [{"name": "pad", "law": "fractional-kelvin-voigt", "parameters": {"k": 30, "c": 40, "alpha": 0.4}}],
    "parameter": [
        {"name": "k", "path": "element.pad.k"},
        {"name": "c", "path": "element.pad.c"},
        {"name": "alpha", "path": "element.pad.alpha"},
    ],
    "data": [
        {
            "name": "shaker",
            "kind": "dma",
            "element": "pad",
            "csv": "none.csv",
            "columns": {"frequency": {"column": "omega", "unit": "rad/s"}, "storage": "storage", "loss": "loss"},
        }
    ],
}


def measured() -> dict[str, dict[str, np.ndarray]]:
    random = np.random.default_rng(5)
    omega = np.geomspace(0.03, 30.0, 30)
    modulus = 50.0 + 60.0 * (1j * omega) ** 0.3
    noise = 1.0 + 0.02 * random.normal(size=(2, omega.size))
    storage = modulus.real * noise[0]
    storage[4] = np.nan
    return {"shaker": {"omega": omega, "storage": storage, "loss": modulus.imag * noise[1]}}


def test_a_fit_and_its_files(tmp_path):
    found = sp.fit(SCENARIO, measured())
    assert found.status == "converged" and list(found.parameters) == ["k", "c", "alpha"]
    for name, exact in [("k", 50.0), ("c", 60.0), ("alpha", 0.3)]:
        own = found.parameters[name]
        assert abs(own.value - exact) < 4.0 * own.sd and own.interval[0] < own.value < own.interval[1], own
    assert np.allclose(np.sqrt(np.diag(found.covariance)), [own.sd for own in found.parameters.values()])
    assert np.allclose(np.diag(found.correlation), 1.0)
    residuals = found.residuals["shaker"]
    assert found.record["data"][0]["skipped"] == 1 and residuals["storage"].shape == (29,)
    cost = sum(np.sum(own**2) for own in residuals.values())
    assert np.isclose(cost, found.record["cost"])
    found.save(tmp_path / "fit")
    assert json.loads((tmp_path / "fit" / "fit.json").read_text())["cost"] == found.record["cost"]
    assert "alpha" in str(found) and "Fit(converged" in repr(found) and "parameter" in found.scenario


def test_other_minimisers_find_the_same():
    found = sp.fit(SCENARIO, measured())
    problem = sp.problem(SCENARIO, measured())
    start = problem.start
    exact = problem.jacobian(start)
    for j, size in enumerate(start):
        step = np.zeros_like(start)
        step[j] = 1e-5 * size
        difference = (problem.residuals(start + step) - problem.residuals(start - step)) / (2.0 * step[j])
        assert np.allclose(exact[:, j], difference, rtol=1e-6, atol=1e-9)
    other = least_squares(problem.residuals, start, problem.jacobian, bounds=problem.bounds, x_scale="jac", xtol=1e-12, ftol=1e-14)
    values = np.array([own.value for own in found.parameters.values()])
    assert np.allclose(other.x, values, rtol=1e-5) and np.isclose(2.0 * other.cost, found.record["cost"], rtol=1e-9)


def test_what_cannot_be():
    with pytest.raises(sp.ScenarioError, match="no such column"):
        sp.fit(SCENARIO, {"shaker": {"omega": [1.0, 2.0], "storage": [1.0, 2.0]}})
    problem = sp.problem(SCENARIO, measured())
    with pytest.raises(ValueError, match="p has 2 values"):
        problem.residuals([1.0, 2.0])
    with pytest.raises(sp.RunError):
        problem.residuals([1.0, 2.0, 2.0])
