"""Where the reference values of the repository are."""

from __future__ import annotations

import doctest
import json
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[3]
PACKAGE = Path(__file__).resolve().parents[1]

ARM = """
[[robot.body]]
name = "arm"
joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }
mass = 1
com = [0.2, 0, 0]
[motion]
kind = "forward"
[time]
end = "2 s"
output_step = "10 ms"
[[element]]
name = "strut"
from = { body = "world", point = [0, 0, -0.3] }
to = { body = "arm", point = [0.3, 0, 0] }
rest_length = "42 cm"
law = "magnetorheological"
parameters = { E_c = 30, mu_0 = 50, mu = 10, alpha = 0.4 }
inputs = { u = "1 V" }
"""
FIXED = ARM + '[solver]\nmethod = "backward-euler"\nstep = "1 ms"\n'


@pytest.fixture(scope="session")
def testdata() -> Path:
    return ROOT / "testdata"


def oracle(*path: str) -> Any:
    return json.loads(ROOT.joinpath("testdata", *path).read_text())


def follow(page: Path, monkeypatch: pytest.MonkeyPatch) -> int:
    """Runs the lines of Python in a page, from the root of the repository, and counts them."""
    monkeypatch.chdir(ROOT)
    options = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    found = doctest.testfile(str(page), module_relative=False, optionflags=options, encoding="utf-8")
    assert found.failed == 0
    return found.attempted
