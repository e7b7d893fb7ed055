"""One case of a run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import numpy.typing as npt

from . import _html
from ._springpot import Case as _Case
from ._springpot import Stored, Study
from ._tables import unknown

if TYPE_CHECKING:
    from ._errors import RunError

Column: TypeAlias = npt.NDArray[np.float64]


class Case(Mapping[str, Column]):
    """One case of a run: its columns as read-only arrays ``(rows,)``, without a copy; NaN where a cell is empty."""

    def __init__(self, study: Study | Stored, case: _Case, units: Mapping[str, str]) -> None:
        # The columns of all cases are the same, and asked for once.
        self._study, self._case, self._units = study, case, units
        self._found: dict[str, Column] = {}
        # Of a sweep that brings some columns back alone the others are known by name.
        self._held = list(units) if case.is_whole else [name for k, name in enumerate(units) if case.has_column(k)]

    @property
    def index(self) -> int:
        """Index in the grid of the sweeps."""
        return self._case.index

    @property
    def name(self) -> str:
        """What it is called: the names of its swept values, else paths and values as written; empty where nothing is swept."""
        return self._study.name(self.index)

    @property
    def parameters(self) -> dict[str, float | str]:
        """The swept values by path: numbers in SI units, or texts."""
        return dict(zip(self._study.parameters, self._study.values(self.index)))

    @property
    def error(self) -> RunError | None:
        """Why it failed, and when; ``None`` where it did not. Its rows go up to there."""
        return self._case.error

    @property
    def rows(self) -> int:
        """Number of rows."""
        return self._case.rows

    @property
    def statistics(self) -> list[tuple[float, float, float]]:
        """The smallest, largest and root-mean-square value of every column, as in summary.csv."""
        return self._case.statistics

    @property
    def report(self) -> dict[str, Any]:
        """Steps, rows, energies, as in run.json."""
        return self._case.report

    @property
    def limits(self) -> list[str]:
        """The limits of joints that it passes, in words."""
        return self._case.limits

    @property
    def units(self) -> dict[str, str]:
        """The unit of every column."""
        return dict(self._units)

    def sensitivity(self, column: str, parameter: str | None = None) -> Column:
        """The derivative ``(rows,)`` of a column by a parameter, or ``(rows, P)`` by all that the run is differentiated by."""
        names = [name for name, *_ in self._study.differentiated]
        if not names:
            raise ValueError("the run is not differentiated: sp.run(…, sensitivity=[…])")
        if column not in self._units:
            raise KeyError(unknown("column", column, list(self._units)))
        if parameter is not None and parameter not in names:
            raise KeyError(unknown("parameter", parameter, names))
        wanted = names if parameter is None else [parameter]
        missing = [f"d({column})/d({name})" for name in wanted if f"d({column})/d({name})" not in self._units]
        if missing:
            raise KeyError(f"the run does not tell {missing[0]}: name {column!r} in `of` of [sensitivity]")
        found = [self[f"d({column})/d({name})"] for name in wanted]
        return np.stack(found, axis=1) if parameter is None else found[0]

    def gradient(self, metric: str) -> dict[str, float]:
        """The derivatives of a metric by parameter, as gradient.csv has them; NaN where there is none."""
        names = [name for name, *_ in self._study.differentiated]
        if not names:
            raise ValueError("the run is not differentiated: sp.run(…, sensitivity=[…])")
        metrics = [name for name, *_ in self._study.metrics]
        if metric not in metrics:
            raise KeyError(unknown("metric", metric, metrics))
        found = self._case.gradients
        return dict(zip(names, found[metrics.index(metric)] if found else [float("nan")] * len(names)))

    @property
    def lost(self) -> list[tuple[str, float, str]]:
        """Where derivatives end before the run does: parameter, t in s, why."""
        names = [name for name, *_ in self._study.differentiated]
        return [(names[parameter], t, why) for parameter, t, why in self._case.lost]

    def __getitem__(self, column: str) -> Column:
        found = self._found.get(column)
        if found is None:
            names = list(self._units)
            if column not in self._units:
                raise KeyError(unknown("column", column, names))
            if column not in self._held:
                raise KeyError(f"column {column!r} was not brought back: name it in `columns` of the sweep")
            found = np.asarray(self._case.column(names.index(column)))
            self._found[column] = found
        return found

    def __iter__(self) -> Iterator[str]:
        return iter(self._held)

    def __len__(self) -> int:
        return len(self._held)

    def __repr__(self) -> str:
        name = self._study.name(self.index)
        of = f" {name}" if name else ""
        failed = ", failed" if self._case.has_failed else ""
        return f"<Case {self.index}{of}: {self.rows} rows, {len(self)} columns{failed}>"

    def _repr_html_(self) -> str:
        return _html.case(self)

    def _ipython_key_completions_(self) -> list[str]:
        return list(self._held)

    def __eq__(self, other: object) -> bool:
        """Whether both have the same parameters and the same numbers, to the bit, under the same names; NaN is equal to NaN."""
        if not isinstance(other, Case):
            return NotImplemented
        if (self.index, self.parameters, self._units, self.rows, self._held) != (
            other.index,
            other.parameters,
            other._units,
            other.rows,
            other._held,
        ):
            return False
        return str(self.error) == str(other.error) and all(np.array_equal(self[name], other[name], equal_nan=True) for name in self)

    def __hash__(self) -> int:
        return hash((self.index, tuple(self._units), self.rows))

    def __reduce__(self) -> tuple[Any, ...]:
        return Case, (self._study, self._case, self._units)
