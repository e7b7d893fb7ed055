"""Scenarios as paths, texts and dicts; exceptions; the command line; types; doctests; examples."""

from __future__ import annotations

import doctest
import importlib
import json
import os
import pickle
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ARM, PACKAGE, ROOT, follow, oracle

import springpot as sp
from springpot._scenario import described
from springpot._tables import Metrics, Rows
from springpot._toml import dumps


def test_dicts_are_their_text() -> None:
    table = tomllib.loads(ARM)
    assert tomllib.loads(dumps(table)) == table
    one, two = sp.Simulation(table), sp.Simulation(ARM)
    one.step_to(0.3)
    two.step_to(0.3)
    assert np.array_equal(one.q, two.q)


@pytest.mark.parametrize("path", sorted(ROOT.glob("scenarios/*.toml")), ids=lambda path: path.stem)
def test_shipped_scenarios_survive_the_way_through_a_dict(path: Path) -> None:
    table = tomllib.loads(path.read_text())
    assert tomllib.loads(dumps(table)) == table


def test_toml_values() -> None:
    odd = {
        "a b": 'quote " back \\ tab \t newline \n bell \x07 é',
        "numbers": [1, -2, 0.1, 1e300, 5e-324, True],
        "numpy": np.arange(3),
        "scalar": np.float32(0.5),
        "flag": np.bool_(True),
        "whole": np.int64(-3),
        "deep": {"x": {"y": [{"z": 1}, {"z": 2}], "": 0}},
        "tuple": (1, (2, 3)),
        "path": Path("a") / "b",
        "empty": {},
        "none": [],
        "tables": [{"k": 1, "l": {"m": 2}}, {}],
    }
    found = tomllib.loads(dumps(odd))
    assert found["a b"] == odd["a b"] and found["numbers"] == odd["numbers"] and found["numpy"] == [0, 1, 2]
    assert found["flag"] is True and found["whole"] == -3 and found["deep"]["x"][""] == 0 and found["path"] == os.path.join("a", "b")
    assert found["tables"] == odd["tables"] and found["tuple"] == [1, [2, 3]]
    for bad in (float("nan"), float("inf"), 2**64, np.array([np.nan])):
        with pytest.raises(ValueError):
            dumps({"x": bad})
    for worse in (None, object(), {1: 2}, 1j, b"x", {1, 2}):
        with pytest.raises(TypeError):
            dumps({"x": worse})
    circle: list[Any] = []
    circle.append(circle)
    with pytest.raises(ValueError, match="deep"):
        dumps({"x": circle})


def test_path_or_text(tmp_path: Path) -> None:
    assert described("arm.toml")["text"] is None
    assert described("a = 1")["text"] == "a = 1"
    odd = tmp_path / "a=b.toml"
    odd.write_text(ARM)
    assert sp.Simulation(odd).end == 2.0
    with pytest.raises(sp.ScenarioError, match="cannot be opened"):
        sp.Simulation("nothing.toml")
    with pytest.raises(sp.ScenarioError):
        sp.Simulation("")
    with pytest.raises(TypeError):
        sp.Simulation(ARM, set=["a"])  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="finite"):
        sp.Simulation(ARM, set={"time.end": float("nan")})


def test_exceptions() -> None:
    assert issubclass(sp.ScenarioError, sp.SpringpotError) and issubclass(sp.SpringpotError, Exception)
    for error in (sp.SpringpotError("a"), sp.ModelError("b"), sp.RunError("c", t=1.5), sp.ScenarioError("d", line=3, refusals=(("f", 1, 2, "m", None),))):
        copy = pickle.loads(pickle.dumps(error))
        assert type(copy) is type(error) and str(copy) == str(error) and copy.__dict__ == error.__dict__


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, timeout=120)


def test_command_line(tmp_path: Path) -> None:
    done = run("-m", "springpot", "--version")
    assert done.returncode == 0 and done.stdout.strip() == f"springpot {sp.__version__}"
    (tmp_path / "arm.toml").write_text(ARM)
    done = run("-m", "springpot", "run", str(tmp_path / "arm.toml"), "--out", str(tmp_path / "out"))
    assert done.returncode == 0 and json.loads((tmp_path / "out" / "run.json").read_text())["status"] == "done"
    refused = run("-m", "springpot", "check", str(tmp_path / "nothing.toml"))
    assert refused.returncode == 2 and "nothing.toml" in refused.stderr


PRIVATE = ["_springpot", "_law", "_regressor", "_run", "_sweeps", "_toml", "_scenario"]
MODULES = ["springpot", *(f"springpot.{name}" for name in [*PRIVATE, "fractional", "units"])]


@pytest.mark.parametrize("name", MODULES)
def test_doctests(name: str) -> None:
    found = doctest.testmod(importlib.import_module(name))
    assert found.attempted > 0 and found.failed == 0


def test_the_lines_of_the_readme(monkeypatch: pytest.MonkeyPatch) -> None:
    assert follow(PACKAGE / "README.md", monkeypatch) > 10


def test_everything_has_a_docstring() -> None:
    for name in sp.__all__:
        thing = getattr(sp, name)
        assert name == "__version__" or thing.__doc__, name
        if isinstance(thing, type):
            public = [own for own in vars(thing) if not own.startswith("_")]
            bare = [own for own in public if not getattr(thing, own).__doc__]
            assert not bare, (name, bare)


def test_the_typed_script_uses_everything() -> None:
    script = (PACKAGE / "tests" / "typed.py").read_text(encoding="utf-8")
    names = [f"sp.{name}" for name in sp.__all__]
    for module in ("fractional", "units"):
        names += [f"sp.{module}.{name}" for name in getattr(sp, module).__all__]
    for name in sp.__all__:
        thing = getattr(sp, name)
        if isinstance(thing, type) and not issubclass(thing, Exception):
            names += [f".{own}" for own in vars(thing) if not own.startswith("_")]
    for table in (Rows, Metrics):
        names += [table.__name__, *(f".{own}" for own in vars(table) if not own.startswith("_"))]
    assert [name for name in names if not re.search(rf"{re.escape(name)}\b", script)] == []


def test_types(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    found = run("-m", "mypy", "--strict", "--cache-dir", str(tmp_path), str(PACKAGE / "tests" / "typed.py"))
    assert found.returncode == 0, found.stdout
    settings = ["--config-file", str(PACKAGE / "pyproject.toml"), "--cache-dir", str(tmp_path)]
    whole = run("-m", "mypy", "--strict", *settings, str(PACKAGE / "python" / "springpot"))
    assert whole.returncode == 0, whole.stdout
    assert run(str(PACKAGE / "tests" / "typed.py")).returncode == 0
    # What the stubs say of names and arguments is what there is; `__all__` and the types of the stubs alone are not compared.
    stubs = run("-m", "mypy.stubtest", "springpot._springpot").stdout
    wrong = [line for line in stubs.splitlines() if "is inconsistent" in line or "is not present in stub" in line]
    assert [line for line in wrong if "__all__" not in line and "Snapshot.get" not in line] == [], stubs


@pytest.mark.parametrize("row", oracle("papers", "one_mass_exact.json")["cases"])
def test_one_mass(row: dict[str, Any]) -> None:
    if row["kind"] != "Caputo":
        pytest.skip("the example takes the Caputo derivative")
    numbers = [str(float(row[key])) for key in ("m", "C", "lambda", "K", "f", "x0", "v0")]
    done = run(str(PACKAGE / "examples" / "one_mass.py"), *numbers, *row["x"])
    assert done.returncode == 0, done.stderr
    lines = done.stdout.split()
    assert lines[0] == "t,x"
    for line, wanted in zip(lines[1:], row["x"].values(), strict=True):
        assert float(line.split(",")[1]) == pytest.approx(float(wanted), abs=1e-8)


@pytest.mark.parametrize("alpha", [0.0, 0.3, 0.5, 0.8, 1.0])
def test_one_mass_without_mass_forces(alpha: float) -> None:
    """m x'' + c D^alpha x = 0, x' (0) = v: x = x0 + v t E_{2−alpha,2}(−(c/m) t^{2−alpha})."""
    sys.path.insert(0, str(PACKAGE / "examples"))
    try:
        import one_mass
    finally:
        sys.path.pop(0)
    times = [0.0, 0.01, 0.4, 3.0, 10.0]
    found = one_mass.solve(2.0, 3.0, alpha, 0.0, 0.0, 0.2, 0.7, times)
    for t in times:
        exact = 0.2 + 0.7 * t * sp.fractional.mittag_leffler(-1.5 * t ** (2 - alpha), 2 - alpha, 2.0)
        assert found[t] == pytest.approx(exact, abs=1e-6)
    assert one_mass.main(["1"]) == 2 and one_mass.main(["0", "1", "0.5", "1", "1", "0", "0", "1"]) == 2
    assert one_mass.main(["1", "1", "1.5", "1", "1", "0", "0", "1"]) == 2
    free = one_mass.solve(2.0, 0.0, 0.5, 0.0, 3.0, 0.1, 0.2, [2.0])
    assert free[2.0] == pytest.approx(0.1 + 0.4 + 0.75 * 4)
