"""Nothing is kept that is no longer needed."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import ARM, ROOT

import springpot as sp


def resident() -> int:
    """Bytes of this process that are in memory."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


def refused() -> None:
    for bad in (lambda: sp.Simulation("a = 1"), lambda: sp.law("nothing"), lambda: MODEL.rnea([1], [2], [3])):
        try:
            bad()
        except (ValueError, sp.SpringpotError):
            pass


def raising() -> None:
    arm = sp.Simulation(ARM, controller=lambda t, q, v: 1 / 0, sample=0.1)
    try:
        arm.step()
    except ZeroDivisionError:
        pass


MODEL = sp.Model.from_urdf(ROOT / "testdata/multibody/ur5.urdf")
STATES = np.zeros((600, 6))
WORK: dict[str, tuple[int, Callable[[], object]]] = {
    "rnea": (2000, lambda: MODEL.rnea(STATES, STATES, STATES)),
    "converted": (2000, lambda: MODEL.gravity([0, 0, 0, 0, 0, 0])),
    "derivatives": (300, lambda: MODEL.aba_derivatives(STATES, STATES, STATES)),
    "simulation": (60, lambda: sp.Simulation(ARM, controller=lambda t, q, v: -q, sample=0.1).step_to(0.3)),
    "raising": (100, raising),
    "refused": (300, refused),
    "bank": (60, lambda: sp.Bank([sp.law("springpot", c=1, alpha=0.5)]).begin([0.0])),
    "series": (20, lambda: sp.prony(sp.law("springpot", c=1, alpha=0.5), (1e-2, 1.0))),
}


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
@pytest.mark.parametrize("name", WORK)
def test_nothing_leaks(name: str) -> None:
    count, work = WORK[name]
    for _ in range(count // 4):
        work()
    gc.collect()
    before = resident()
    for _ in range(count):
        work()
    gc.collect()
    assert resident() - before < 4e6
