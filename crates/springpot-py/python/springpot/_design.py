"""Designs: parameters moved until a metric is as small, or as large, as constraints let it be."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ._run import Run, run
from ._scenario import Scenario
from ._springpot import designed

__all__ = ["Design", "DesignedParameter", "design"]


@dataclass(frozen=True)
class DesignedParameter:
    """A parameter of a design, SI."""

    name: str
    path: str
    value: float
    unit: str
    before: float
    at_bound: str | None
    gradient: float


class Design:
    """What a design came to: design.json, steps.csv, and the scenario with the values that were found.

    ``status`` is ``"converged"``, ``"not-converged"``, ``"stalled"`` (at a kink of a metric) or ``"infeasible"``.
    """

    def __init__(self, told: str, steps: str, text: str) -> None:
        found: dict[str, Any] = json.loads(told)
        self._found = found
        self.status: str = found["status"]
        self.objective: dict[str, Any] = found["objective"]
        self.parameters: dict[str, DesignedParameter] = {one["name"]: DesignedParameter(**one) for one in found["parameters"]}
        self.constraints: list[dict[str, Any]] = found["constraints"]
        self.starts: list[dict[str, Any]] = found["starts"]
        self.runs: int = found["runs"]
        self.scenario: str = text
        rows = list(csv.reader(io.StringIO(steps)))
        cells = [[float(cell) if cell else float("nan") for cell in row] for row in rows[1:]]
        self.steps: dict[str, npt.NDArray[np.float64]] = {name: np.array([row[k] for row in cells]) for k, name in enumerate(rows[0])}

    def run(self, **options: Any) -> Run:
        """Runs the designed scenario, with the options of :func:`springpot.run`."""
        return run(self.scenario, **options)

    def __repr__(self) -> str:
        values = ", ".join(f"{one.name} = {one.value:.6g} {one.unit}".rstrip() for one in self.parameters.values())
        objective = self.objective
        return f"<Design {self.status}: {objective['metric']} {objective['before']:.6g} -> {objective['after']:.6g} {objective['unit']}, {values}>"


def design(
    scenario: Scenario, *, set: Mapping[str, Any] | None = None, starts: int | None = None, jobs: int | None = None
) -> Design:
    """Moves every [[parameter]] of a scenario by exact gradients for its [design], as ``springpot design`` does.

    Args:
        scenario: a path, a text or a dict.
        set: values by path.
        starts: in place of those of the scenario.
        jobs: starts at a time, default all cores; bits do not depend on it.

    Raises:
        ScenarioError: the scenario is refused.
        RunError: no start could be run.
    """
    return Design(*designed(scenario, set, starts, jobs or 0))
