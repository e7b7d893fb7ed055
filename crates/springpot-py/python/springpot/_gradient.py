"""Gradients of metrics, and columns as functions of parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ._run import Run, checked, run
from ._scenario import Scenario
from ._springpot import Study

Array = npt.NDArray[np.float64]


def gradient(
    scenario: Scenario,
    metric: str,
    by: str | Sequence[str] | None = None,
    *,
    set: Mapping[str, Any] | None = None,
    method: str = "forward",
) -> tuple[float, dict[str, float]]:
    """Runs a scenario of one case, and gives a metric with its derivatives.

    Args:
        scenario: a path, a text or a dict.
        metric: the name of a [[metric]].
        by: paths of numbers, or names of parameters; default those of the scenario: ``by`` of [sensitivity], or all [[parameter]].
        set: values by path.
        method: ``"forward"``, or ``"adjoint"``: back through the run, whose time does not grow with the number of parameters.

    Returns:
        The value, and by parameter the derivative, SI; NaN where there is none.

    >>> import springpot as sp
    >>> value, by = sp.gradient('''
    ... robot.body = [{ name = "mass", joint = { name = "x", kind = "prismatic", axis = [0, 0, 1] }, mass = 2 }]
    ... element = [{ name = "pad", joint = "x", law = "spring", parameters = { k = 50 } }]
    ... motion = { kind = "forward" }
    ... time = { end = 1, output_step = 0.01 }
    ... metric = [{ name = "depth", of = "q.x", kind = "min" }]
    ... ''', "depth", "element.pad.k")
    >>> bool(value < 0 < by["element.pad.k"])
    True
    """
    settings: dict[str, Any] = {"sensitivity.method": method, **(set or {})}
    asked = [] if by is None else [by] if isinstance(by, str) else list(by)
    if asked:
        settings.setdefault("sensitivity.by", [])
    # No column is to be told: metrics have theirs all the same.
    settings.setdefault("sensitivity.of", ["t"])
    done = run(scenario, settings, sensitivity=asked)
    only = done.case(0) if len(done) == 1 else None
    if only is None:
        raise ValueError(f"the scenario has {len(done)} cases: take the sweeps out with set, or ask run.case(k).gradient(metric)")
    slopes = only.gradient(metric)
    names = [name for name, *_ in done._study.metrics]
    return only._case.metrics[names.index(metric)], slopes


class Columns:
    """Columns of a run as a function of parameters, with their derivatives; what JAX and PyTorch wrap."""

    def __init__(self, scenario: Scenario, by: str | Sequence[str], of: str | Sequence[str], set: Mapping[str, Any] | None) -> None:
        self._scenario, self._set = scenario, dict(set or {})
        self._by = [by] if isinstance(by, str) else list(by)
        self._of = [of] if isinstance(of, str) else list(of)
        study = self._study(None)
        if len(study) != 1:
            raise ValueError(f"the scenario has {len(study)} cases: take the sweeps out with set")
        self._parameters = study.differentiated
        told = {name for name, _, _ in study.columns}
        of_all = [name for name, _, _ in study.columns if f"d({name})/d({self._parameters[0][0]})" in told]
        self.columns: list[str] = of_all
        self.parameters: list[str] = [name for name, *_ in self._parameters]
        self.start: Array = np.array([value for _, _, value, _ in self._parameters])
        self._reference = study
        self._last: tuple[bytes, tuple[Array, Array]] | None = None
        self.rows = int(np.shape(self(self.start)[0])[0])

    def _study(self, assignments: Sequence[str] | None) -> Study:
        settings: dict[str, Any] = {"sensitivity.by": [], "sensitivity.of": self._of, **self._set}
        for assignment in assignments or []:
            path, _, value = assignment.partition("=")
            settings[path] = value.strip('"') if value.startswith('"') else float(value)
        return Study(self._scenario, settings, [], self._by)

    def __call__(self, values: npt.ArrayLike) -> tuple[Array, Array]:
        """Values ``(N, C)`` and derivatives ``(N, C, P)`` at parameters ``(P,)``, SI."""
        p = np.asarray(values, dtype=np.float64)
        if p.shape != self.start.shape:
            raise ValueError(f"{len(self.start)} parameters are wanted, {', '.join(self.parameters)}, not an array of shape {p.shape}")
        key = p.tobytes()
        if self._last is not None and self._last[0] == key:
            return self._last[1]
        study = self._study(self._reference.assignments(p.tolist()))
        done = checked(Run(study, study.cases([0])))
        y = np.stack([done[name] for name in self.columns], axis=1)
        slopes = np.stack([done.sensitivity(name) for name in self.columns], axis=1)
        self._last = (key, (y, slopes))
        return y, slopes
