"""Small motions about rest: eigenvalues, answers to sines, linear models."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _springpot
from ._scenario import Scenario
from .units import parse

_Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinearModel:
    """x' = A x + B u, y = C x + D u of small motions about rest, in SI units.

    Attributes:
        A, B, C, D: shapes ``(n, n)``, ``(n, inputs)``, ``(outputs, n)``, ``(outputs, inputs)``.
        inputs, outputs, states: their names.
        units: the unit of every name.
        band: Hz, between which it is exact.
        error: the largest relative deviation of a channel from the exact frequency response there.
        about: ``{"t": s, "q": coordinates}``.
    """

    A: _Array
    B: _Array
    C: _Array
    D: _Array
    inputs: list[str]
    outputs: list[str]
    states: list[str]
    units: dict[str, str]
    band: tuple[float, float]
    error: float
    about: dict[str, Any]

    def to_scipy(self) -> Any:
        """As ``scipy.signal.StateSpace``."""
        from scipy.signal import StateSpace

        return StateSpace(self.A, self.B, self.C, self.D)

    def to_control(self) -> Any:
        """As ``control.StateSpace`` of the package ``control``, with the names."""
        import control

        return control.ss(
            self.A, self.B, self.C, self.D, inputs=self.inputs, outputs=self.outputs, states=self.states
        )


def linearise(
    scenario: Scenario,
    inputs: Sequence[str],
    outputs: Sequence[str],
    at: float | str | None = None,
    equilibrium: bool = False,
    band: tuple[float | str, float | str] = (0.1, 100.0),
    tolerance: float = 1e-4,
    open: bool = False,
    set: Mapping[str, Any] | None = None,
) -> LinearModel:
    """The linear model of first order of a scenario about rest, with memories as few decays.

    Args:
        scenario: a path, a text or a dict; of its sweeps the first values count.
        inputs: ``tau.JOINT``, ``ELEMENT.INPUT``, ``q.JOINT`` of a prescribed joint, ``reference.JOINT`` of a controller.
        outputs: columns of the results but energies.
        at: time of the motion, s.
        equilibrium: go to the static equilibrium from there.
        band: Hz, between which every channel is exact.
        tolerance: relative deviation that a channel may have at any frequency of the band.
        open: leave feedback and controllers out.
        set: values by dotted paths.

    Raises:
        ScenarioError: the scenario is refused.
        ValueError: an input, output or the band is not known; sampled controllers without ``open``.
        SpringpotError: the tolerance is out of reach.

    >>> import springpot as sp
    >>> mass = {"robot": {"gravity": [0, 0, 0], "body": [{"name": "b", "mass": 2,
    ...     "joint": {"name": "x", "kind": "prismatic", "axis": [1, 0, 0]}}]},
    ...     "element": [{"name": "e", "joint": "x", "law": "kelvin-voigt", "parameters": {"k": 50, "c": 4}}],
    ...     "motion": {"kind": "forward"}, "time": {"end": 1, "output_step": 0.5}}
    >>> model = sp.linearise(mass, ["tau.x"], ["q.x"])
    >>> model.A.tolist(), model.B.tolist(), model.states
    ([[0.0, 1.0], [-25.0, -2.0]], [[0.0], [0.5]], ['q.x', 'v.x'])
    """
    ends = [_hertz(frequency) for frequency in band]
    place = (_time(at), bool(equilibrium), bool(open))
    channels = (list(inputs), list(outputs))
    text = _springpot.linear_model(scenario, channels, place, ends, float(tolerance), set)
    found = json.loads(text)
    low, high = found["band"]

    def matrix(name: str, columns: str) -> _Array:
        return np.array(found[name], dtype=float).reshape(-1, len(found[columns]))

    return LinearModel(
        A=matrix("A", "states"),
        B=matrix("B", "inputs"),
        C=matrix("C", "states"),
        D=matrix("D", "inputs"),
        inputs=found["inputs"],
        outputs=found["outputs"],
        states=found["states"],
        units=found["units"],
        band=(low, high),
        error=found["error"],
        about=found["about"],
    )


def modes(
    scenario: Scenario,
    at: float | str | None = None,
    equilibrium: bool = False,
    open: bool = False,
    set: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """The eigenvalues of small motions, as the command ``modes --json`` has them.

    Returns:
        ``eigenvalues``, 1/s, complex, shape ``(n,)``; ``frequency`` and ``damped_frequency``, Hz, ``damping_ratio``; ``shapes``, complex,
        ``(n, nv)``; ``unstable``; and what the command says beside them: ``t``, ``q``, ``velocities``, ``free_motions``, ``complete``, ….
    """
    found = json.loads(_springpot.linear_modes(scenario, (_time(at), bool(equilibrium), bool(open)), set))
    rows = found.pop("modes")

    def column(name: str) -> _Array:
        return np.array([row[name] for row in rows], dtype=float)

    shapes = [np.array(row["shape_re"]) + 1j * np.array(row["shape_im"]) for row in rows]
    count = len(found["velocities"])
    found["eigenvalues"] = column("re") + 1j * column("im")
    for name in ("frequency", "damped_frequency", "damping_ratio"):
        found[name] = column(name)
    found["unstable"] = np.array([row["unstable"] for row in rows], dtype=bool)
    found["shapes"] = np.array(shapes, dtype=complex).reshape(len(rows), count)
    for name in ("q", "left_over"):
        found[name] = np.array(found[name], dtype=float)
    return dict(found)


def frequency_response(
    scenario: Scenario,
    input: str,
    column: str,
    frequency: ArrayLike,
    at: float | str | None = None,
    equilibrium: bool = False,
    open: bool = False,
    set: Mapping[str, Any] | None = None,
) -> NDArray[np.complex128]:
    """The exact complex amplitude of a column under a small steady sine of an input, of amplitude 1.

    Args:
        frequency: Hz, any shape.

    Returns:
        complex, the shape of ``frequency``: of Re(A e^{iωt}) under cos ωt.
    """
    hertz = np.asarray(frequency, dtype=float)
    place = (_time(at), bool(equilibrium), bool(open))
    found = json.loads(_springpot.linear_response(scenario, (input, column), hertz.ravel().tolist(), place, set))
    answers = np.array(found["real"]) + 1j * np.array(found["imaginary"])
    return np.asarray(answers, dtype=np.complex128).reshape(hertz.shape)


def _time(at: float | str | None) -> float | None:
    return None if at is None else parse(at, "s")


def _hertz(frequency: float | str) -> float:
    counts_radians = isinstance(frequency, str) and ("rad" in frequency or "deg" in frequency)
    return parse(frequency, "Hz") / (2 * np.pi if counts_radians else 1.0)
