"""The lines of Python in the README of the repository give the numbers that it prints."""

from __future__ import annotations

import re

import pytest
from conftest import ROOT, follow

README = ROOT / "README.md"


def test_the_lines_of_the_readme_of_the_repository(monkeypatch: pytest.MonkeyPatch) -> None:
    assert follow(README, monkeypatch) >= 8


def test_the_readme_says_how_to_install_and_where_more_is() -> None:
    section = README.read_text(encoding="utf-8").split("\n## In Python\n")[1].split("\n## ")[0]
    assert "pip install ./crates/springpot-py" in section
    links = re.findall(r"\]\(([^)#]+)\)", section)
    assert "crates/springpot-py/README.md" in links
    assert [link for link in links if not (ROOT / link).exists()] == []
    # What is not in a block of Python is not tested.
    assert section.count(">>>") == sum(block.count(">>>") for block in re.findall(r"```pycon\n(.*?)```", section, re.DOTALL))
