"""The notebooks run from any folder, say what they teach, and fail where their main number does not hold."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import PACKAGE

EXAMPLES = PACKAGE / "examples"
NOTEBOOKS = [
    "a_strut_by_design",
    "controller_in_python",
    "half_derivative_of_my_data",
    "mr_damper_from_its_record",
    "papers_in_ten_cells",
    "ur5_mount_from_its_record",
    "ur5_rubber_mount",
]
SECONDS = 20  # of two cores


def cells(name: str, kind: str) -> list[str]:
    """The cells of a notebook in jupytext's percent format: "code" or "markdown"."""
    text = (EXAMPLES / f"{name}.py").read_text(encoding="utf-8")
    parts = re.split(r"^# %%(.*)\n", text, flags=re.MULTILINE)[1:]
    return [body for title, body in zip(parts[::2], parts[1::2]) if ("[markdown]" in title) == (kind == "markdown")]


def run(file: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    # Two cores and no window: what a batch system has.
    environment = {**os.environ, "MPLBACKEND": "Agg", "PYTHONWARNINGS": "error::UserWarning", "OMP_NUM_THREADS": "2"}
    return subprocess.run(
        [sys.executable, str(file)], cwd=folder, env=environment, capture_output=True, text=True, timeout=900
    )


def worked() -> float:
    """Processor time of the programs that have ended, s."""
    return os.times().children_user + os.times().children_system


def test_all_notebooks_are_tested() -> None:
    assert sorted(file.stem for file in EXAMPLES.glob("*.py") if "# %%" in file.read_text(encoding="utf-8")) == NOTEBOOKS


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_notebooks_run(name: str, tmp_path: Path) -> None:
    for library in ("matplotlib", "scipy"):
        pytest.importorskip(library)
    begun = worked()
    done = run(EXAMPLES / f"{name}.py", tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout and not done.stderr
    assert worked() - begun < 2 * SECONDS
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_notebooks_say_what_one_learns_and_end_with_what_must_hold(name: str) -> None:
    title, learned = cells(name, "markdown")[0].removeprefix("# # ").split("\n#\n")[:2]
    assert title and learned.startswith("# You learn")
    assert cells(name, "code")[-1].count("assert ") >= 3


def test_the_papers_are_ten_cells() -> None:
    assert len(cells("papers_in_ten_cells", "code")) == 10


def test_a_number_that_is_wrong_fails(tmp_path: Path) -> None:
    pytest.importorskip("scipy")
    pytest.importorskip("matplotlib")
    text = (EXAMPLES / "half_derivative_of_my_data.py").read_text(encoding="utf-8")
    wrong = text.replace("half = sp.fractional.derivative(t, x, 0.5)", "half = sp.fractional.derivative(t, x, 0.51)")
    assert wrong != text
    (tmp_path / "wrong.py").write_text(wrong, encoding="utf-8")
    done = run(tmp_path / "wrong.py", tmp_path)
    assert done.returncode == 1 and "AssertionError" in done.stderr
