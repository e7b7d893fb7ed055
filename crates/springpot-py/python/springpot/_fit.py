"""Fits of scenarios to measurements."""

from __future__ import annotations

import csv
import json
import os
import pathlib
import re
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _law, _springpot
from ._scenario import Scenario
from ._springpot import Law

if TYPE_CHECKING:
    import matplotlib.figure

Number: TypeAlias = "float | str"
Records: TypeAlias = "Mapping[str, Any]"


@dataclass(frozen=True)
class Parameter:
    """A parameter that was fitted.

    Attributes:
        name, path, unit: what it is; several paths move together, and zeros and delays of columns have none.
        value, sd: SI; ``sd`` is ``nan`` where the data leave it open, 0 at a bound.
        interval: at the ``confidence`` of ``[fit]``.
        start: where the search began.
        at_bound: ``"lower"``, ``"upper"`` or ``None``.
    """

    name: str
    path: str | list[str] | None
    value: float
    unit: str
    sd: float
    interval: tuple[float, float]
    start: float
    at_bound: str | None


class Fit:
    """What :func:`springpot.fit` found of a scenario."""

    def __init__(self, found: _springpot.Fitted) -> None:
        self._found = found
        self.record: dict[str, Any] = json.loads(found.json())

    @property
    def status(self) -> str:
        """``"converged"``, or ``"not-converged"``: the best so far."""
        return str(self.record["status"])

    @property
    def parameters(self) -> dict[str, Parameter]:
        """The parameters by name."""
        found = {}
        for own in self.record["parameters"]:
            low, high = own["interval"]
            numbers = {key: _number(own[key]) for key in ("value", "sd", "start")}
            interval = (_number(low, -np.inf), _number(high, np.inf))
            found[own["name"]] = Parameter(own["name"], own["path"], unit=own["unit"], interval=interval, at_bound=own["at_bound"], **numbers)
        return found

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Of the parameters in their order, shape ``(P, P)``; 0 beside what is at a bound."""
        count = len(self.record["parameters"])
        return self._found.covariance().reshape(count, count)

    @property
    def correlation(self) -> NDArray[np.float64]:
        """Of the parameters in their order, shape ``(P, P)``; ``nan`` beside what is at a bound."""
        covariance = self.covariance
        with np.errstate(divide="ignore", invalid="ignore"):
            sd = np.sqrt(np.diag(covariance))
            correlation: NDArray[np.float64] = covariance / np.outer(sd, sd)
        return correlation

    @property
    def residuals(self) -> dict[str, dict[str, NDArray[np.float64]]]:
        """By record and column, as the cost has them, shape ``(N,)``."""
        return {name: {column: told["residual"] for column, told in own.items()} for name, own in self.columns.items()}

    @property
    def columns(self) -> dict[str, dict[str, dict[str, Any]]]:
        """By record and column ``at`` (s or rad/s), ``measured``, ``model``, ``residual`` and ``unit``."""
        return self._found.columns()

    @property
    def undetermined(self) -> list[dict[str, Any]]:
        """Combinations that the data leave open: ``combination`` and ``text``."""
        return list(self.record["undetermined"])

    @property
    def scenario(self) -> str:
        """The scenario with the values put in, its comments kept."""
        return self._found.scenario()

    def plot(self) -> matplotlib.figure.Figure:
        """Every column as it was measured and as the model has it."""
        import matplotlib.pyplot as plt

        panels = [(name, column, told) for name, own in self.columns.items() for column, told in own.items()]
        kinds = {own["name"]: own["kind"] for own in self.record["data"]}
        figure, axes = plt.subplots(len(panels), 1, squeeze=False, figsize=(7.0, 2.6 * len(panels)), layout="constrained")
        for axis, (name, column, told) in zip(axes[:, 0], panels, strict=True):
            order = np.argsort(told["at"], kind="stable")
            is_dma = kinds[name] == "dma"
            at = told["at"][order] / (2.0 * np.pi if is_dma else 1.0)
            axis.plot(at, told["measured"][order], ".", label="measured")
            axis.plot(at, told["model"][order], label="model")
            axis.set_xlabel("frequency, Hz" if is_dma else "t, s")
            axis.set_ylabel(f"{column}, {told['unit']}" if told["unit"] else column)
            if kinds[name] in ("dma", "relaxation", "creep"):
                axis.set_xscale("log")
                axis.set_yscale("log")
            axis.set_title(name)
            axis.legend()
        return figure

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes fit.json, parameters.csv, correlation.csv, residuals.csv, fitted.toml and figures, as ``springpot fit`` does."""
        self._found.save(pathlib.Path(folder))

    def __repr__(self) -> str:
        values = ", ".join(f"{own.name}={own.value:.6g}±{own.sd:.2g}" for own in self.parameters.values())
        return f"Fit({self.status}, {values})"

    def __str__(self) -> str:
        return self._found.told()


class Problem:
    """The residuals of a fit and their derivatives, for SciPy, lmfit or emcee.

    >>> import springpot as sp
    >>> problem = sp.problem({
    ...     "element": [{"name": "pad", "law": "springpot", "parameters": {"c": 10, "alpha": 0.4}}],
    ...     "parameter": [{"name": "c", "path": "element.pad.c"}, {"name": "alpha", "path": "element.pad.alpha"}],
    ...     "data": [{"name": "tap", "kind": "relaxation", "element": "pad", "csv": "tap.csv", "columns": {"t": "t", "relaxation": "G"}}],
    ... }, data={"tap": {"t": [0.1, 1.0, 10.0], "G": [20.0, 6.0, 2.0]}})
    >>> problem.names, problem.residuals(problem.start).shape, problem.jacobian(problem.start).shape
    (['c', 'alpha'], (3,), (3, 2))
    """

    def __init__(self, found: _springpot.Residuals) -> None:
        self._found = found

    @property
    def names(self) -> list[str]:
        """Names of the parameters."""
        return self._found.names

    @property
    def units(self) -> list[str]:
        """Their units, SI."""
        return self._found.units

    @property
    def start(self) -> NDArray[np.float64]:
        """Where they begin, shape ``(P,)``."""
        return self._found.start

    @property
    def bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Their least and their largest values, shape ``(P,)`` each, as ``scipy.optimize.least_squares`` takes them."""
        low, high = self._found.bounds
        return low, high

    def residuals(self, p: ArrayLike) -> NDArray[np.float64]:
        """The residuals at p, priors behind all others, shape ``(N,)``; a model that cannot be evaluated there raises ``RunError``."""
        return self._found.residuals(p)

    def jacobian(self, p: ArrayLike) -> NDArray[np.float64]:
        """Their derivatives by p, in the parameters' own units, shape ``(N, P)``."""
        return self._found.jacobian(p).reshape(-1, len(self.names))


@overload
def fit(
    scenario: Scenario, data: Records | None = None, *, set: Mapping[str, Any] | None = None
) -> Fit: ...
@overload
def fit(
    scenario: ArrayLike,
    data: ArrayLike,
    law: str = ...,
    *,
    area: Number | None = None,
    length: Number | None = None,
) -> tuple[Law, float, dict[str, float | None]]: ...
def fit(
    scenario: Any,
    data: Any = None,
    law: str = "fractional-kelvin-voigt",
    *,
    set: Mapping[str, Any] | None = None,
    area: Number | None = None,
    length: Number | None = None,
) -> Any:
    """Fits the ``[[parameter]]`` of a scenario to its ``[[data]]``, as ``springpot fit`` does; or, of arrays, a law to a measured modulus.

    Args:
        scenario: a path, a text or a dict.
        data: DataFrames or dicts of arrays by the name of a record, in place of its file; ``nan`` is a missing cell.
        set: values by path.

    A fit that does not converge is returned with that status.

    Of arrays ``fit(omega, modulus, law)``: rad/s, shape ``(N,)``, and K* = K' + iK'', N/m, complex, or E* with ``area`` and ``length`` of the sample
    (m², m); what is returned are the law, the root mean square of its relative deviations, and one standard deviation of each parameter (``None`` for
    one at an end of its range).

    >>> import springpot as sp
    >>> t = [0.01, 0.1, 1.0, 10.0, 100.0]
    >>> found = sp.fit({
    ...     "element": [{"name": "pad", "law": "springpot", "parameters": {"c": 10, "alpha": 0.4}}],
    ...     "parameter": [{"name": "c", "path": "element.pad.c"}, {"name": "alpha", "path": "element.pad.alpha"}],
    ...     "data": [{"name": "tap", "kind": "relaxation", "element": "pad", "csv": "tap.csv", "columns": {"t": "t", "relaxation": "G"}}],
    ... }, data={"tap": {"t": t, "G": [50.0 * x**-0.5 / 3.141592653589793**0.5 for x in t]}})
    >>> round(found.parameters["c"].value, 6), round(found.parameters["alpha"].value, 6)
    (50.0, 0.5)

    Raises:
        ScenarioError: the scenario or its data are refused.
        RunError: no start can be evaluated.
    """
    if not isinstance(scenario, (str, os.PathLike, Mapping)):
        return _law.fit(scenario, data, law, area=area, length=length)
    with _files(data) as paths:
        return Fit(_springpot.fit_scenario(scenario, {**(set or {}), **paths}))


def problem(scenario: Scenario, data: Records | None = None, *, set: Mapping[str, Any] | None = None) -> Problem:
    """The residuals of a scenario's ``[[data]]`` and their exact derivatives by its ``[[parameter]]``; arguments as of :func:`springpot.fit`."""
    with _files(data) as paths:
        return Problem(_springpot.Residuals(scenario, {**(set or {}), **paths}))


@contextmanager
def _files(data: Records | None) -> Iterator[dict[str, str]]:
    """Records as files, by the paths of their names in the scenario."""
    if not data:
        yield {}
        return
    with tempfile.TemporaryDirectory() as folder:
        paths: dict[str, str] = {}
        for name, table in data.items():
            columns = {str(key): np.asarray(table[key], dtype=np.float64) for key in table}
            file = pathlib.Path(folder, f"{len(paths)}.csv")
            with file.open("w", newline="", encoding="utf-8") as stream:
                writer = csv.writer(stream)
                writer.writerow(columns)
                for row in zip(*columns.values(), strict=True):
                    writer.writerow("" if np.isnan(x) else repr(float(x)) for x in row)
            unnamed = re.fullmatch(r"data-(\d+)", name)
            paths[f"data.{int(unnamed[1]) - 1 if unnamed else name}.csv"] = str(file)
        yield paths


def _number(value: float | None, lost: float = np.nan) -> float:
    return lost if value is None else float(value)
