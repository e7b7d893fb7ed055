"""Dicts as the TOML text of a scenario: strings, numbers, booleans, lists and tables, and nothing else."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

_BARE = re.compile(r"[A-Za-z0-9_-]+\Z")
_ESCAPES = {'"': '\\"', "\\": "\\\\", "\b": "\\b", "\t": "\\t", "\n": "\\n", "\f": "\\f", "\r": "\\r"}
_DEEPEST = 100


def dumps(table: Mapping[str, Any]) -> str:
    r"""The text of a table.

    Strings, ints, floats, bools, lists, tuples, dicts, NumPy scalars and arrays, and paths may stand in it. Values of the top level keep
    their order, tables after them.

    >>> print(dumps({"title": "drop", "time": {"end": "1 s"}, "element": [{"name": "strut", "past": {"held": "3 s"}}]}))
    title = "drop"
    <BLANKLINE>
    [time]
    end = "1 s"
    <BLANKLINE>
    [[element]]
    name = "strut"
    past = { held = "3 s" }
    <BLANKLINE>
    """
    plain: list[str] = []
    tables: list[str] = []
    for key, value in table.items():
        name = _key(key, "")
        if isinstance(value, Mapping):
            tables.append(f"\n[{name}]\n" + _entries(value, name))
        elif isinstance(value, (list, tuple)) and value and all(isinstance(item, Mapping) for item in value):
            tables.extend(f"\n[[{name}]]\n" + _entries(item, f"{name}[{k}]") for k, item in enumerate(value))
        else:
            plain.append(f"{name} = {value_text(value, name)}\n")
    return "".join(plain + tables)


def _entries(table: Mapping[str, Any], place: str) -> str:
    lines = (f"{_key(key, place)} = {value_text(value, f'{place}.{key}')}\n" for key, value in table.items())
    return "".join(lines)


def _key(key: Any, place: str) -> str:
    if not isinstance(key, str):
        where = f" of {place}" if place else ""
        raise TypeError(f"keys{where} must be strings, not {key!r}")
    return key if _BARE.match(key) else _string(key)


def _string(text: str) -> str:
    escaped = (
        _ESCAPES.get(c) or (f"\\u{ord(c):04x}" if ord(c) < 0x20 or ord(c) == 0x7F else c) for c in text
    )
    return '"' + "".join(escaped) + '"'


def value_text(value: Any, place: str = "the value", depth: int = 0) -> str:
    """A value as TOML writes it; ``place`` is where it stands, for messages.

    >>> value_text({"values": (0.1, 1), "unit": "N/m"})
    '{ values = [0.1, 1], unit = "N/m" }'
    """
    if depth > _DEEPEST:
        raise ValueError(f"{place} is nested more than {_DEEPEST} deep")
    if isinstance(value, np.generic):
        value = value.item()
    elif isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _string(value)
    if isinstance(value, int):
        if not -(2**63) <= value < 2**63:
            raise ValueError(f"{place} is {value}, beyond 64 bits; write a float")
        return repr(int(value))
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ValueError(f"{place} is {value}; it must be finite")
        return repr(float(value))
    if isinstance(value, os.PathLike):
        return _string(os.fsdecode(value))
    if isinstance(value, Mapping):
        if not value:
            return "{}"
        entries = (
            f"{_key(key, place)} = {value_text(item, f'{place}.{key}', depth + 1)}" for key, item in value.items()
        )
        return "{ " + ", ".join(entries) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(value_text(item, f"{place}[{k}]", depth + 1) for k, item in enumerate(value)) + "]"
    raise TypeError(f"{place} is {type(value).__name__}; a scenario holds str, int, float, bool, list and dict")
