"""The lines of Python in the book give the numbers that it prints."""

from __future__ import annotations

import inspect
import re
import runpy
from pathlib import Path

import pytest
from conftest import ROOT, follow

import springpot as sp

PAGES = [path for path in sorted((ROOT / "docs").rglob("*.md")) if "```pycon\n" in path.read_text(encoding="utf-8")]


def test_there_are_pages_with_python() -> None:
    assert len(PAGES) >= 5


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_the_lines_of_a_page(page: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # A block of another kind is not tested.
    assert follow(page, monkeypatch) == page.read_text(encoding="utf-8").count(">>>")


def test_the_page_of_the_package_has_all_of_it() -> None:
    """Every class, function and member that is public, and none that is not there."""
    page = (ROOT / "docs/reference/python.md").read_text(encoding="utf-8")
    public = [name for name in sp.__all__ if name not in ("__version__", "fractional", "units")]
    functions = ["fractional.derivative", "fractional.mittag_leffler", "units.parse", "units.convert"]
    assert [name for name in [*public, *functions] if f"`sp.{name}" not in page] == []
    found = set(re.findall(r"`sp\.([\w.]+)", page))
    missing = [name for name in found if not hasattr(sp, name.split(".")[0])]
    assert missing == []
    # Methods of mappings are everybody's.
    everybodys = {"get", "items", "keys", "values", "add_note", "with_traceback", "args"}
    for name in public:
        row = next((line for line in page.splitlines() if line.startswith(f"| `sp.{name}` |")), "")
        if name == "Model":
            row = page.split("\n## Model")[1]
        if inspect.isclass(getattr(sp, name)) and not issubclass(getattr(sp, name), BaseException):
            members = {member for member in dir(getattr(sp, name)) if not member.startswith("_")} - everybodys
            # A default of a data class, or none, is a member of its objects alone.
            known = set(re.findall(r"`([\w]+)[`(]|([\w]+)\([^`]*\)`", row))
            words = {word for pair in known for word in pair if word}
            assert members <= words, (name, members - words)


def test_the_page_of_members_is_what_the_docstrings_say() -> None:
    """Where it is not, ``python crates/springpot-py/reference.py`` writes it anew."""
    made = runpy.run_path(str(ROOT / "crates/springpot-py/reference.py"))["page"]()
    assert (ROOT / "docs/reference/api.md").read_text(encoding="utf-8") == made
    for name in ("sp.run(scenario, set=None", "sp.Model.rnea(q, v, a, out=None)", "sp.Run.cases", "sp.units.parse("):
        assert f"```text\n{name}" in made, name
