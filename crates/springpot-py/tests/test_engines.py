"""Without the engines."""

from __future__ import annotations

import sys

import pytest

import springpot.mujoco
import springpot.pinocchio


def test_engines_are_optional(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("mujoco", "pinocchio"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(ImportError, match=r"pip install springpot\[mujoco\]"):
        springpot.mujoco.Elements(None, None, [])
    with pytest.raises(ImportError, match=r"pip install springpot\[pinocchio\]"):
        springpot.pinocchio.Elements(None, [])
