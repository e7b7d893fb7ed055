"""Runs as data sets of xarray."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ._chosen import short_names
from ._tables import swept_column

if TYPE_CHECKING:
    import xarray

    from ._run import Run


def dataset(run: Run) -> xarray.Dataset:
    """The columns over the sweeps and time; cases that have fewer rows end in NaN."""
    try:
        import xarray
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError("to_xarray takes xarray: pip install xarray", name="xarray") from error
    axes = run._study.axes
    count = math.prod(length for _, length, _ in axes)
    short = short_names(run._swept)
    taken = {"t", "row", *run.columns}
    called = {path: path if name in taken else name for path, name in short.items()}
    dims = ["_".join(called[path] for path in paths) for paths, _, _ in axes]
    lengths = [length for _, length, _ in axes]
    coords: dict[str, Any] = {}
    cases = {case.index: case for case in run.cases}
    strides = [math.prod(lengths[k + 1 :]) for k in range(len(lengths))]
    for (paths, length, names), dim, stride in zip(axes, dims, strides):
        # Of a run that was broken off the first case with this value may not be there.
        at = [next((case for index, case in cases.items() if index // stride % length == k), None) for k in range(length)]
        for path in paths:
            values = [None if case is None else case.parameters[path] for case in at]
            plain = swept_column([float("nan") if value is None else value for value in values])
            attrs = {"units": run.units[path], "long_name": path}
            coords[called[path]] = (dim, plain, attrs)
        if names is not None:
            coords[f"{dim}_name"] = (dim, np.asarray(names))
    rows = max((case.rows for case in run.cases), default=0)
    held = [name for name in run.columns if name != "t"]
    times = {index: case["t"] for index, case in cases.items()} if "t" in run.columns else {}
    longest = max(times.values(), key=len, default=np.empty(0))
    shared = bool(times) and all(np.array_equal(t, longest[: len(t)]) for t in times.values())
    dim = "t" if shared else "row"
    variables: dict[str, Any] = {}
    shape = [*lengths, rows]
    for name in [*([] if shared or not times else ["t"]), *held]:
        grid = np.full((count, rows), np.nan)
        for index, case in cases.items():
            grid[index, : case.rows] = case[name]
        attrs = {"units": run.units[name], "long_name": run.meanings[name]}
        variables[name] = ([*dims, dim], grid.reshape(shape), attrs)
    if shared:
        coords["t"] = ("t", longest, {"units": run.units["t"], "long_name": run.meanings["t"]})
    for k, (name, column, unit) in enumerate(run._study.metrics):
        found = np.full(count, np.nan)
        for index, case in cases.items():
            metrics = case._case.metrics
            found[index] = metrics[k] if metrics else float("nan")
        variables[f"metric({name})"] = (dims, found.reshape(lengths), {"units": unit, "long_name": f"{name} of {column}"})
    if not shared and times:
        coords["t"] = variables.pop("t")
    return xarray.Dataset(variables, coords, attrs={"title": run.title} if run.title else {})
