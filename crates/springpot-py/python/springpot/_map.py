"""Maps: a number of every case over two swept values, in coloured cells."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import units
from ._chosen import is_one, path_of
from ._figure import Figure
from ._springpot import map_figure
from ._tables import unknown

if TYPE_CHECKING:
    from ._case import Case, Column
    from ._run import Run

STATISTICS: dict[str, Callable[[Column], float]] = {
    "min": lambda values: float(values.min()),
    "max": lambda values: float(values.max()),
    "mean": lambda values: float(values.mean()),
    "rms": lambda values: math.sqrt(float(np.square(values).mean())),
}


def drawn(
    run: Run,
    z: str,
    x: str,
    y: str,
    where: Mapping[str, Any],
    unit: str | None,
    title: str | None,
    scales: Sequence[str],
    size: Sequence[str | float] | None,
) -> Figure:
    """The figure that :meth:`Run.map` gives."""
    axes = run._study.axes
    paths = [path for own, _, _ in axes for path in own]
    fixed = {path_of(path, paths): value for path, value in where.items()}
    sides = [path_of(x, paths), path_of(y, paths)]
    at = [next(k for k, (own, _, _) in enumerate(axes) if path in own) for path in sides]
    if at[0] == at[1]:
        raise ValueError(f"{sides[0]} and {sides[1]} are swept together, and a map takes two sweeps")
    for k, (own, length, _) in enumerate(axes):
        if k in at and any(path in fixed for path in own):
            raise ValueError(f"`where` chooses one value of {sides[at.index(k)]}, over which the map is drawn")
        if k not in at and length > 1 and not any(path in fixed for path in own):
            raise ValueError(f"{own[0]} is swept too, and a map shows one value of it: where={{{own[0]!r}: …}}")
    cases = [case for case in run.cases if _fits(run, case, fixed)]
    if not cases:
        raise ValueError(f"no case has {', '.join(f'{path} = {value!r}' for path, value in fixed.items())}")
    number, label = _number(run, z, unit)
    strides = [math.prod(length for _, length, _ in axes[k + 1 :]) for k in range(len(axes))]
    places = [{case.index: case.index // strides[k] % axes[k][1] for case in cases} for k in at]
    told: list[tuple[str, list[float], list[str], bool]] = []
    orders: list[dict[int, int]] = []
    for path, k, place, scale in zip(sides, at, places, scales):
        if scale not in ("linear", "log"):
            raise ValueError(f'a scale is "linear" or "log", not {scale!r}')
        values = {place[case.index]: case.parameters[path] for case in cases}
        names = axes[k][2]
        short, si = path.rpartition(".")[2].replace("alpha", "α"), run.units[path].replace("*", "·")
        plain = [value for value in values.values() if not isinstance(value, str)]
        if names is not None or len(plain) < len(values):
            order = sorted(values)
            called = [names[one] if names is not None else str(values[one]) for one in order]
            told.append((short, [float(one) for one in range(len(order))], called, scale == "log"))
        else:
            order = sorted(values, key=lambda one: values[one])
            told.append((f"{short}, {si}" if si else short, [float(values[one]) for one in order], [f"{values[one]:.4g}" for one in order], scale == "log"))
        orders.append({one: row for row, one in enumerate(order)})
    cells = np.full((len(orders[1]), len(orders[0])), np.nan)
    for case in cases:
        if case.error is None:
            column, row = (order[place[case.index]] for order, place in zip(orders, places))
            cells[row, column] = number(case)
    page = None if size is None else [1e3 * units.parse(side, "m") for side in size]
    svg, png, pdf, remarks = map_figure(title if title is not None else run.title, told[0], told[1], label, cells.ravel().tolist(), page)
    return Figure(svg, bytes(png), bytes(pdf), tuple(remarks))


def _fits(run: Run, case: Case, fixed: Mapping[str, Any]) -> bool:
    named = {path: names for own, _, names in run._study.axes for path in own if names is not None}
    for path, value in fixed.items():
        known = [other.parameters[path] for other in run.cases]
        by_name = path in named and value in named[path] and value in case.name.split(", ")
        if not by_name and not is_one(case.parameters[path], value, known, run.units[path]):
            return False
    return True


def _number(run: Run, z: str, unit: str | None) -> tuple[Callable[[Case], float], str]:
    """What gives the number of a case, and what stands at the bar."""
    found = re.fullmatch(r"\s*([\w-]+)\((.*)\)\s*", z)
    if found is None or found[1] not in (*STATISTICS, "final", "metric"):
        raise ValueError(f"z is {z!r}; write \"metric(NAME)\", or min, max, mean, rms or final of a column, \"max(strut.force)\"")
    what, of = found[1], found[2].strip()
    if what == "metric":
        metrics = run._study.metrics
        names = [name for name, _, _ in metrics]
        if of not in names:
            raise KeyError(unknown("metric", of, names))
        place, own, label = names.index(of), metrics[names.index(of)][2], of
    else:
        if of not in run.columns:
            raise KeyError(unknown("column", of, run.columns))
        own = run.units[of]
        axis = run._study.axis([name for name, _, _ in run._study.columns].index(of))
        label = f"{what} of {axis.rsplit(', ', 1)[0] if own else axis}"

    def number(case: Case) -> float:
        if what == "metric":
            values = case._case.metrics
            value = values[place] if values else math.nan
        elif what == "final":
            value = float(case[of][-1]) if case.rows else math.nan
        else:
            held = case[of][np.isfinite(case[of])]
            value = STATISTICS[what](held) if len(held) else math.nan
        return value if unit is None else units.convert(value, own, unit)

    shown = own if unit is None else unit
    if unit is not None:
        try:
            units.convert(1.0, own, unit)
        except ValueError as error:
            raise ValueError(f"{z} is in {own or 'pure numbers'}: {error}") from error
    return number, f"{label}, {shown.replace('*', '·')}" if shown else label
