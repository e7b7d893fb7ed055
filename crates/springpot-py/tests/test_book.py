"""The lines of Python in the book give the numbers that it prints."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import ROOT, follow

PAGES = [path for path in sorted((ROOT / "docs").rglob("*.md")) if "```pycon\n" in path.read_text(encoding="utf-8")]


def test_there_are_pages_with_python() -> None:
    assert len(PAGES) >= 5


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_the_lines_of_a_page(page: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # A block of another kind is not tested.
    assert follow(page, monkeypatch) == page.read_text(encoding="utf-8").count(">>>")
