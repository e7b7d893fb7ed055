"""Cases of a run by what was swept."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from . import units
from ._case import Case
from ._tables import unknown

NEAR = 1e-12
"""Values are one where they differ by less than this share of the largest one: what rounding does to sums and products of a few numbers."""

MOST_SHOWN = 12


def short_names(paths: Sequence[str]) -> dict[str, str]:
    """The last part of every path where no other has it, else the whole path."""
    last = [path.rpartition(".")[2] for path in paths]
    return {path: name if last.count(name) == 1 else path for path, name in zip(paths, last)}


def chosen(cases: Sequence[Case], columns: Mapping[str, str], wanted: Mapping[str, Any], name: str | None) -> Case:
    """The only case of that name and with these values, by path or by the last part of one; ``columns`` are the swept paths with their units."""
    if not wanted and name is None:
        raise TypeError("a case is chosen by its number, its name, or swept values: run.case(alpha=0.5)")
    values = {path_of(key, list(columns)): value for key, value in wanted.items()}
    if len(values) < len(wanted):
        raise ValueError(f"one path is named twice: {', '.join(wanted)}")
    left = list(cases)
    if name is not None:
        left = [case for case in cases if name in (case.name, *case.name.split(", "))]
        if not left:
            raise KeyError(unknown("case", name, list(dict.fromkeys(case.name for case in cases))))
    for path, value in values.items():
        known = [case.parameters[path] for case in cases]
        left = [case for case in left if is_one(case.parameters[path], value, known, columns[path])]
    if len(left) == 1:
        return left[0]
    asked = ", ".join([*([name] if name is not None else []), *(f"{path} = {value!r}" for path, value in values.items())])
    if not left:
        there = "; ".join(f"{path} has {_listed(case.parameters[path] for case in cases)}" for path in values)
        raise KeyError(f"no case has {asked}; {there}")
    open_paths = [path for path in columns if len({case.parameters[path] for case in left}) > 1]
    more = "; ".join(f"{path} is {_listed(case.parameters[path] for case in left)}" for path in open_paths)
    raise KeyError(f"{len(left)} cases have {asked}: {more or 'they are equal, choose one by its number'}")


def path_of(key: str, paths: Sequence[str]) -> str:
    """The path that is meant by itself, or by its end where no other ends so."""
    if not isinstance(key, str):
        raise TypeError(f"swept values are named by their paths, not by {key!r}")
    if key in paths:
        return key
    found = [path for path in paths if path.rpartition(".")[2] == key or path.endswith(f".{key}")]
    if len(found) == 1:
        return found[0]
    if found:
        raise KeyError(f"{key!r} is the end of {' and '.join(found)}: name one of them whole")
    raise KeyError(unknown("swept path", key, paths))


def is_one(known: float | str, wanted: Any, all: Sequence[float | str], unit: str) -> bool:
    """Whether a swept value, one of ``all``, is the one that is wanted."""
    if isinstance(known, str):
        return bool(known == wanted)
    if isinstance(wanted, str):
        try:
            wanted = units.parse(wanted, "" if "alpha" in unit else unit)
        except ValueError:
            return False
    size = max((abs(value) for value in all if not isinstance(value, str)), default=0.0)
    return math.isclose(known, float(wanted), rel_tol=NEAR, abs_tol=NEAR * size)


def _listed(values: Any) -> str:
    each = list(dict.fromkeys(values))
    shown = ", ".join(value if isinstance(value, str) else f"{value:.12g}" for value in each[:MOST_SHOWN])
    return shown if len(each) <= MOST_SHOWN else f"{shown}, … ({len(each)} values)"
