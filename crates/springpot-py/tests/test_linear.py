"""Small motions from Python: eigenvalues, answers to sines, linear models."""

from __future__ import annotations

import numpy as np
import pytest

import springpot as sp

MASS = """
[robot]
gravity = [0, 0, 0]
[[robot.body]]
name = "b"
mass = 2
joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }
[[element]]
name = "e"
joint = "x"
law = "fractional-kelvin-voigt"
parameters = { k = 50, c = 4, alpha = 0.5 }
[motion]
kind = "forward"
[motion.controller]
kind = "pid"
kp = 20
ki = 30
kd = 4
reference = { kind = "joints", x = 0 }
[time]
end = 1
output_step = 0.5
"""


def test_models_are_exact_over_the_band() -> None:
    inputs, outputs, tolerance = ["tau.x", "reference.x"], ["q.x"], 1e-5
    model = sp.linearise(MASS, inputs, outputs, band=("0.2 Hz", 20), tolerance=tolerance)
    n = len(model.states)
    shapes = [matrix.shape for matrix in (model.A, model.B, model.C, model.D)]
    assert shapes == [(n, n), (n, 2), (1, n), (1, 2)] and model.error <= tolerance
    assert model.inputs == inputs and model.outputs == outputs and model.units["tau.x"] == "N"
    assert np.linalg.eigvals(model.A).real.max() < 0
    for k, name in enumerate(inputs):
        for hertz in (0.2, 1.0, 20.0):
            exact = sp.frequency_response(MASS, name, "q.x", hertz)
            s = 2j * np.pi * hertz
            own = model.C @ np.linalg.solve(s * np.eye(n) - model.A, model.B[:, k]) + model.D[:, k]
            assert abs(own[0] / exact - 1) <= tolerance


def test_answers_and_eigenvalues_are_those_of_the_equation() -> None:
    s = 2j * np.pi * np.array([[0.3, 1.0], [3.0, 9.0]])
    own = sp.frequency_response(MASS, "tau.x", "q.x", s.imag / (2 * np.pi), open=True)
    assert own.shape == (2, 2)
    np.testing.assert_allclose(own, 1 / (2 * s**2 + 4 * s**0.5 + 50), rtol=1e-12)
    modes = sp.modes(MASS, set={"element.e.alpha": 0.4})
    for root in modes["eigenvalues"]:
        terms = np.array([2 * root**2, 4 * root**0.4, 70, 4 * root, 30 / root])
        assert abs(terms.sum()) < 1e-12 * abs(terms).sum()
    assert modes["complete"] and modes["shapes"].shape == (len(modes["eigenvalues"]), 1)


def test_what_is_refused() -> None:
    with pytest.raises(ValueError, match="no such input"):
        sp.linearise(MASS, ["tau.y"], ["q.x"])
    with pytest.raises(ValueError, match="answers to how fast"):
        sp.linearise(MASS, ["reference.x"], ["tau.x"])
    with pytest.raises(ValueError, match="sample"):
        sp.linearise(MASS, ["tau.x"], ["q.x"], set={"motion.controller.sample": "10 ms"})
    with pytest.raises(sp.SpringpotError, match="is reached"):
        sp.linearise(MASS, ["tau.x"], ["q.x"], band=(1e-9, 1e9), tolerance=1e-11)


def test_other_packages_take_models() -> None:
    model = sp.linearise(MASS, ["tau.x"], ["q.x"], tolerance=1e-2)
    signal = pytest.importorskip("scipy.signal")
    assert isinstance(model.to_scipy(), signal.StateSpace)
    control = pytest.importorskip("control")
    assert isinstance(model.to_control(), control.StateSpace)
