"""Scenarios as Python has them: a path, a text or a dict."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, TypeAlias

from ._toml import dumps, value_text

Scenario: TypeAlias = "str | os.PathLike[str] | Mapping[str, Any]"


def described(scenario: Scenario, set: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Where a scenario is to be read, or its text, and its overrides as ``PATH=VALUE``.

    A ``str`` with a line break or ``=`` is the text itself, else a path; ``os.PathLike`` is always a path. Paths that a text or a dict names
    count from the current folder.

    >>> described("arm.toml", {"element.strut.alpha": 0.5})["assignments"]
    ['element.strut.alpha=0.5']
    """
    assignments = [] if set is None else [_assignment(path, value) for path, value in _items(set)]
    if isinstance(scenario, Mapping):
        return {"path": "<dict>", "text": dumps(scenario), "assignments": assignments}
    if isinstance(scenario, str) and ("\n" in scenario or "=" in scenario):
        return {"path": "<text>", "text": scenario, "assignments": assignments}
    if isinstance(scenario, (str, os.PathLike)):
        return {"path": os.fspath(scenario), "text": None, "assignments": assignments}
    raise TypeError(f"a scenario is a path, a text or a dict, not {type(scenario).__name__}")


def _items(set: Mapping[str, Any]) -> list[tuple[str, Any]]:
    if not isinstance(set, Mapping):
        raise TypeError(f"set is a dict of dotted paths and values, not {type(set).__name__}")
    return list(set.items())


def _assignment(path: str, value: Any) -> str:
    if not isinstance(path, str):
        raise TypeError(f"paths of set must be strings, not {path!r}")
    return f"{path}={value_text(value, path)}"
