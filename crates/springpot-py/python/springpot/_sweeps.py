"""Sweeps as Python has them: sequences by path."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ._toml import value_text


def sweeps_of(sweep: Mapping[str | tuple[str, ...], Any] | None) -> list[str]:
    """``PATH=v1,v2,…`` for every sweep; paths that move together are ``[PATH, PATH]=[v, w],…``.

    >>> sweeps_of({"element.strut.alpha": [0.2, 0.5]})
    ['element.strut.alpha=0.2,0.5']
    """
    if sweep is None:
        return []
    if not isinstance(sweep, Mapping):
        raise TypeError(f"sweep is a dict of dotted paths and sequences, not {type(sweep).__name__}")
    return [_one(path, values) for path, values in sweep.items()]


def _one(path: str | tuple[str, ...], values: Any) -> str:
    values = _listed(path, values)
    if isinstance(path, str):
        return f"{path}=" + ",".join(value_text(value, path) for value in values)
    if not isinstance(path, tuple) or not path or not all(isinstance(part, str) for part in path):
        raise TypeError(f"paths of sweep are strings or tuples of strings, not {path!r}")
    rows = []
    for value in values:
        row = _listed(path, value)
        if len(row) != len(path):
            raise ValueError(f"sweep of {path}: {row!r} has {len(row)} values for {len(path)} paths")
        rows.append("[" + ", ".join(value_text(one, name) for name, one in zip(path, row)) + "]")
    return "[" + ", ".join(path) + "]=" + ",".join(rows)


def _listed(path: object, values: Any) -> list[Any]:
    if isinstance(values, (str, bytes, Mapping)) or not hasattr(values, "__iter__"):
        raise TypeError(f"sweep of {path!r}: a sequence of values, not {type(values).__name__}")
    listed = values.tolist() if hasattr(values, "tolist") else list(values)
    if not listed:
        raise ValueError(f"sweep of {path!r}: no values")
    return list(listed)
